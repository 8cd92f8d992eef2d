//! What a drawing spans, and the ground under it.

use crate::planar::Vector;
use crate::state::Ground;

/// The least rectangle about some points \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Its lower left corner.
    pub low: Vector<f64>,
    /// Its upper right corner.
    pub high: Vector<f64>,
}

/// How far the ground goes beyond the robot on either side, as a part of its size.
const BESIDE: f64 = 2.0;

impl Extent {
    /// About these points; of none a point at the origin.
    pub fn of(points: impl Iterator<Item = Vector<f64>>) -> Self {
        let start = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        let spans = points.fold(start, |spans, point| {
            std::array::from_fn(|axis| [spans[axis][0].min(point[axis]), spans[axis][1].max(point[axis])])
        });
        match spans {
            [[left, right], [bottom, top]] if left <= right => Self { low: [left, bottom], high: [right, top] },
            _ => Self { low: [0.0; 2], high: [0.0; 2] },
        }
    }

    /// The diagonal \[m\].
    pub fn size(self) -> f64 {
        libm::hypot(self.high[0] - self.low[0], self.high[1] - self.low[1])
    }

    /// Whether a point lies in it.
    pub(super) fn holds(self, point: Vector<f64>) -> bool {
        (0..2).all(|axis| (self.low[axis]..=self.high[axis]).contains(&point[axis]))
    }

    /// The same with `room` \[m\] on every side.
    pub(super) fn widened(self, room: f64) -> Self {
        Self { low: self.low.map(|entry| entry - room), high: self.high.map(|entry| entry + room) }
    }

    /// The ground's surface below a robot of this size, and well beside it.
    pub(super) fn surface(self, ground: &Ground, size: f64) -> Vec<Vector<f64>> {
        let (left, right) = (self.low[0] - BESIDE * size, self.high[0] + BESIDE * size);
        match ground {
            Ground::Slope(slope) => [left, right].map(|x| [x, libm::tan(*slope) * x]).to_vec(),
            Ground::Profile(profile) => {
                let mut surface: Vec<Vector<f64>> = Vec::new();
                for pair in profile.points().windows(2) {
                    let &[[x0, z0], [x1, z1]] = pair else { continue };
                    if x1 < left || x0 > right {
                        continue;
                    }
                    let at = |x: f64| [x, z0 + (x - x0) / (x1 - x0) * (z1 - z0)];
                    if surface.is_empty() {
                        surface.push(if x0 < left { at(left) } else { [x0, z0] });
                    }
                    surface.push(if x1 > right { at(right) } else { [x1, z1] });
                }
                surface
            }
        }
    }
}
