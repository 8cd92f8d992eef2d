//! What a drawing spans, and the ground under it.

use crate::planar::Vector;
use crate::state::Ground;

/// The smallest upright rectangle around some points \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    pub low: Vector<f64>,
    pub high: Vector<f64>,
}

/// How far the ground reaches beyond the robot on either side, as a share of its size.
const BEYOND: f64 = 2.0;

impl Extent {
    /// Around these points; without points the origin.
    pub fn of(points: impl Iterator<Item = Vector<f64>>) -> Self {
        let infinite = Vector::new(f64::INFINITY, f64::INFINITY);
        let (low, high) =
            points.fold((infinite, -infinite), |(low, high), point| (low.least(point), high.greatest(point)));
        if low.x <= high.x { Self { low, high } } else { Self { low: Vector::zero(), high: Vector::zero() } }
    }

    /// The diagonal \[m\].
    pub fn size(self) -> f64 {
        (self.high - self.low).length()
    }

    /// Whether a point lies in it.
    pub(super) fn holds(self, point: Vector<f64>) -> bool {
        (self.low.x..=self.high.x).contains(&point.x) && (self.low.z..=self.high.z).contains(&point.z)
    }

    /// The same with `room` \[m\] on every side.
    pub(super) fn widened(self, room: f64) -> Self {
        Self { low: self.low.map(|entry| entry - room), high: self.high.map(|entry| entry + room) }
    }

    /// The ground's surface below a robot of this size, and well to both sides.
    pub(super) fn surface(self, ground: &Ground, size: f64) -> Vec<Vector<f64>> {
        let (left, right) = (self.low.x - BEYOND * size, self.high.x + BEYOND * size);
        match ground {
            Ground::Slope(slope) => [left, right].map(|x| Vector::new(x, libm::tan(*slope) * x)).to_vec(),
            Ground::Profile(profile) => {
                let mut surface: Vec<Vector<f64>> = Vec::new();
                for pair in profile.points().windows(2) {
                    let &[Vector { x: x0, z: z0 }, Vector { x: x1, z: z1 }] = pair else { continue };
                    if x1 < left || x0 > right {
                        continue;
                    }
                    let at = |x: f64| Vector::new(x, z0 + (x - x0) / (x1 - x0) * (z1 - z0));
                    if surface.is_empty() {
                        surface.push(if x0 < left { at(left) } else { Vector::new(x0, z0) });
                    }
                    surface.push(if x1 > right { at(right) } else { Vector::new(x1, z1) });
                }
                surface
            }
        }
    }
}
