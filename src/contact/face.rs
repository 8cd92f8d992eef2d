//! A straight piece of a boundary: a segment of the ground, or a side of a foot.
//!
//! ```text
//!              normal, away from the solid
//!                 ^
//!     from -------+-------> to          of a point: height above the line, past_begin from `from`, past_end from `to`
//!     ///// solid /////
//! ```

use crate::planar::{Rotation, Vector};

/// Greatest sine of the angle at which two boundaries that meet still count as lying flat on each other.
const FLAT: f64 = 0.1;

/// Greatest sine of the angle between normals that count as the same. Normals are computed from sums of positions and
/// from the rotation of a foot, so they are rounded.
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
    /// Creates the face between two different points. Its solid is to the right of the direction from `from` to `to`,
    /// where forward points right and up points up.
    pub fn of_ground(from: Vector<f64>, to: Vector<f64>) -> Self {
        let tangent = unit(to - from);
        Self { from, to, tangent, normal: -tangent.perpendicular() }
    }

    /// Does the same as [`Face::of_ground`] with the solid to the left.
    pub fn of_foot(from: Vector<f64>, to: Vector<f64>) -> Self {
        let tangent = unit(to - from);
        Self { from, to, tangent, normal: tangent.perpendicular() }
    }

    /// Returns the rotation from the world's axes to (tangent, normal) of a contact with this normal.
    pub fn axes(&self) -> Rotation<f64> {
        upright(self.normal)
    }

    /// Returns the height of a point above the line \[m\].
    pub fn height(&self, point: Vector<f64>) -> f64 {
        self.normal.dot(point - self.from)
    }

    /// Returns how far a point is past `from` along the tangent \[m\].
    pub fn past_begin(&self, point: Vector<f64>) -> f64 {
        self.tangent.dot(point - self.from)
    }

    /// Returns how far a point is past `to` along the tangent \[m\].
    pub fn past_end(&self, point: Vector<f64>) -> f64 {
        self.tangent.dot(point - self.to)
    }

    /// Returns whether a point lies between the ends of the face along the tangent, at any height.
    pub fn faces(&self, point: Vector<f64>) -> bool {
        self.past_begin(point) >= 0.0 && self.past_end(point) <= 0.0
    }

    /// Returns whether the other boundary's straight piece from `point`, which is at this face, to `neighbor` stays in
    /// front of the face. It may go behind the face by `slack` \[m\] if both lie nearly flat on each other; a `sole`
    /// counts as flat at up to 45 degrees if `neighbor` lies between the face's ends.
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

/// Returns the rotation from the world's axes to axes of which this unit vector is the second.
pub(super) fn upright(Vector { x, z }: Vector<f64>) -> Rotation<f64> {
    Rotation { cos: z, sin: x }
}

/// Returns the unit vector in this direction. The vector may be arbitrarily short, but not zero.
pub(super) fn unit(vector: Vector<f64>) -> Vector<f64> {
    let size = vector.x.abs().max(vector.z.abs());
    let scaled = vector.map(|entry| entry / size);
    let length = scaled.length();
    scaled.map(|entry| entry / length)
}
