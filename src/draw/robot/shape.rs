//! Collision shapes as they are drawn.

use crate::planar::Vector;
use crate::robot::{FootShape, Rim};
use serde::Serialize;

/// A collision shape in the frame of its body \[m\].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DrawnShape {
    /// A disc, or with radius 0 a point.
    Disc { center: Vector<f64>, radius: f64 },
    /// By its corners.
    Polygon(Vec<Vector<f64>>),
}

/// Directions in which a round shape is touched to draw it.
const DIRECTIONS: u32 = 48;

impl DrawnShape {
    pub(super) fn new(shape: &FootShape) -> Self {
        match (shape.corners(), shape.rim) {
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
    let farthest = |at: u32| {
        let (sin, cos) = libm::sincos(f64::from(at) * std::f64::consts::TAU / f64::from(DIRECTIONS));
        let direction = Vector::new(cos, sin);
        let corner = corners.iter().max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)))?;
        Some(*corner + rim.support(direction))
    };
    let mut polygon: Vec<Vector<f64>> = (0..DIRECTIONS).filter_map(farthest).collect();
    polygon.dedup();
    polygon
}
