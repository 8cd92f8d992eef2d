//! A straight piece of a boundary: a segment of the ground, or a side of a foot.
//!
//! ```text
//!              normal, away from the solid
//!                 ^
//!     from -------+-------> to          height, before, beyond: where a point is, from the line, from `from`, from `to`
//!     ///// solid /////
//! ```

use crate::planar::{Rotation, Vector};

/// Greatest sine of the angle at which two boundaries that meet still count as lying flat on each other.
const FLAT: f64 = 0.1;

/// Normals whose angle has a smaller sine are the same: they come from sums of positions, and a foot's turn.
pub(super) const PARALLEL: f64 = 1e-9;

#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub from: Vector<f64>,
    pub to: Vector<f64>,
    /// Unit vector from `from` to `to`.
    pub tangent: Vector<f64>,
    /// Unit vector away from the solid.
    pub normal: Vector<f64>,
}

impl Face {
    /// The side between two different points, its solid to the right of the way from one to the other, seen with
    /// forward to the right and up upward.
    pub fn of_ground(from: Vector<f64>, to: Vector<f64>) -> Self {
        let Vector { x, z } = unit(to - from);
        Self { from, to, tangent: Vector::new(x, z), normal: Vector::new(-z, x) }
    }

    /// The same with its solid to the left.
    pub fn of_foot(from: Vector<f64>, to: Vector<f64>) -> Self {
        let Self { tangent: Vector { x, z }, .. } = Self::of_ground(from, to);
        Self { from, to, tangent: Vector::new(x, z), normal: Vector::new(z, -x) }
    }

    /// Turn from the world's axes to (tangent, normal) of a contact with this normal.
    pub fn axes(&self) -> Rotation<f64> {
        upright(self.normal)
    }

    /// Height of a point above the line \[m\].
    pub fn height(&self, point: Vector<f64>) -> f64 {
        self.normal.dot(point - self.from)
    }

    /// How far a point is past the beginning, along the tangent \[m\].
    pub fn past_begin(&self, point: Vector<f64>) -> f64 {
        self.tangent.dot(point - self.from)
    }

    /// How far a point is past the end \[m\].
    pub fn past_end(&self, point: Vector<f64>) -> f64 {
        self.tangent.dot(point - self.to)
    }

    /// Whether a point is above the side or below it, and past none of its ends.
    pub fn faces(&self, point: Vector<f64>) -> bool {
        self.past_begin(point) >= 0.0 && self.past_end(point) <= 0.0
    }

    /// Whether a boundary that goes on straight from `point`, which is at this side, to `neighbor` stays in front of
    /// the side: it may go behind it by `slack` \[m\] where both lie flat on each other, as a `sole` that ends above
    /// the side does up to 45 degrees.
    pub fn clears(&self, point: Vector<f64>, neighbor: Vector<f64>, slack: f64, sole: bool) -> bool {
        let way = unit(neighbor - point);
        let [along, descent] = [self.tangent.dot(way), -self.normal.dot(way)];
        let is_flat = descent <= FLAT || sole && descent < along.abs() && self.faces(neighbor);
        if descent <= 0.0 || !is_flat {
            return descent <= 0.0;
        }
        let room = if along > 0.0 { -self.past_end(point) } else { self.past_begin(point) };
        descent * (room / along.abs()).min((neighbor - point).length()) <= slack
    }
}

/// The turn from the world's axes to those whose second one is this unit vector.
pub(super) fn upright(Vector { x, z }: Vector<f64>) -> Rotation<f64> {
    Rotation { cos: z, sin: x }
}

/// The vector of length one in this direction; it may be as short as it likes, but not zero.
pub(super) fn unit(vector: Vector<f64>) -> Vector<f64> {
    let size = vector.x.abs().max(vector.z.abs());
    let scaled = vector.map(|entry| entry / size);
    let length = scaled.length();
    scaled.map(|entry| entry / length)
}
