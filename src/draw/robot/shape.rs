//! Collision shapes as they are drawn.

use crate::planar::Vector;
use crate::robot::{FootShape, Rim};
use serde::Serialize;

/// A collision shape in the frame of its body.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DrawnShape {
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

impl DrawnShape {
    pub(super) fn new(shape: &FootShape) -> Self {
        match (shape.corners(), shape.rim()) {
            (&[center], Rim::Circle { radius }) => Self::Disc { center, radius },
            (corners, rim) if rim.bound() == 0.0 => Self::Polygon(corners.to_vec()),
            (corners, rim) => Self::Polygon(swept(corners, rim)),
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
