//! Collision shapes where they are.

use crate::contact::Placement;
use crate::planar::Vector;
use crate::robot::{FootShape, Rim};
use serde::Serialize;

/// A collision shape in the world.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum Outline {
    /// A disc, or with radius 0 a point.
    Disc {
        /// Its center \[m\].
        center: Vector<f64>,
        /// Its radius \[m\].
        radius: f64,
    },
    /// A polygon; its corners \[m\].
    Polygon(Vec<Vector<f64>>),
}

/// Directions in which a round shape is touched to draw it.
const DIRECTIONS: u32 = 48;

impl Outline {
    /// The outline of a shape that is rigid in the frame of `body`.
    pub(super) fn of_shape(shape: &FootShape, placement: &Placement, body: usize) -> Self {
        match (shape.corners(), shape.rim()) {
            (&[center], Rim::Circle { radius }) => Self::Disc { center: placement.world(body, center), radius },
            (corners, rim) => {
                let corners = if rim.bound() == 0.0 { corners.to_vec() } else { swept(corners, rim) };
                let world: Vec<Vector<f64>> = corners.iter().map(|&corner| placement.world(body, corner)).collect();
                Self::Polygon(world)
            }
        }
    }

    /// Points that it lies between.
    pub(super) fn corners(&self) -> Vec<Vector<f64>> {
        match self {
            &Self::Disc { center, radius } => [(-radius, 0.0), (radius, 0.0), (0.0, -radius), (0.0, radius)]
                .map(|(x, z)| center + Vector::new(x, z))
                .to_vec(),
            Self::Polygon(corners) => corners.clone(),
        }
    }

    /// The middle of what it spans.
    pub(super) fn center(&self) -> Vector<f64> {
        match self {
            Self::Disc { center, .. } => *center,
            Self::Polygon(corners) => {
                let share = 1.0 / corners.len().max(1) as f64;
                corners.iter().fold(Vector::zero(), |middle, corner| middle + *corner * share)
            }
        }
    }

    /// Changes every place.
    pub(super) fn places(&mut self, change: impl FnMut(&mut Vector<f64>)) {
        match self {
            Self::Disc { center, .. } => std::slice::from_mut(center).iter_mut().for_each(change),
            Self::Polygon(corners) => corners.iter_mut().for_each(change),
        }
    }
}

/// The corners with their rims as a polygon: its farthest point in each of many directions.
fn swept(corners: &[Vector<f64>], rim: Rim) -> Vec<Vector<f64>> {
    let mut polygon: Vec<Vector<f64>> = (0..DIRECTIONS)
        .filter_map(|at| {
            let (sin, cos) = libm::sincos(f64::from(at) * std::f64::consts::TAU / f64::from(DIRECTIONS));
            let direction = Vector::new(cos, sin);
            let farthest = corners.iter().max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)));
            farthest.map(|&corner| corner + rim.support(direction))
        })
        .collect();
    polygon.dedup();
    polygon
}
