//! The plane that a robot moves in: finds forward, normal and up from the axes of the joints.
//!
//! ```text
//!     rows of P = forward, n, up        n = up x forward        P w: vector w of the root link, in the plane's axes
//! ```
//!
//! P only selects components and changes signs, so it is exact.

use crate::description::{Matrix, apply};

/// Greatest angle between two joint axes that count as parallel, because files round their axes \[rad\].
pub(super) const PARALLEL: f64 = 1e-3;

/// Greatest angle between two directions of shapes that count as parallel: many files write pi as 3.14 \[rad\].
pub(super) const PARALLEL_SHAPE: f64 = 2e-3;

/// A leg's axis that is off the normal by at most this angle rotates more in the plane than out of it \[rad\].
pub(super) const OBLIQUE: f64 = 0.9;

/// A plane through the root link's origin, named by the axes of the root link that point forward and up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Plane {
    /// x forward, z up, pitch about +y.
    #[default]
    XZ,
    /// y forward, z up, pitch about -x.
    YZ,
    /// x forward, y up, pitch about -z.
    XY,
    /// z forward, y up, pitch about +x.
    ZY,
    /// z forward, x up, pitch about -y.
    ZX,
    /// y forward, x up, pitch about +z.
    YX,
}

impl Plane {
    /// All planes, the most common first.
    pub const ALL: [Self; 6] = [Self::XZ, Self::YZ, Self::XY, Self::ZY, Self::ZX, Self::YX];

    /// Returns the plane's name, forward before up: `xz`, `yz` and so on.
    pub fn name(self) -> &'static str {
        ["xz", "yz", "xy", "zy", "zx", "yx"][self as usize]
    }

    /// Returns the plane's normal in the axes of the root link: `+y`, `-x` and so on.
    pub fn normal(self) -> &'static str {
        ["+y", "-x", "-z", "+x", "-y", "+z"][self as usize]
    }

    /// Returns forward, normal and up as rows. This matrix transforms vectors of the root link into the plane's axes.
    pub(crate) fn axes(self) -> Matrix {
        match self {
            Self::XZ => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            Self::YZ => [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            Self::XY => [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
            Self::ZY => [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            Self::ZX => [[0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [1.0, 0.0, 0.0]],
            Self::YX => [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        }
    }

    /// Returns the plane whose normal is parallel to all of these unit vectors within `tolerance`, if there are any.
    pub(super) fn normal_to(axes: impl Iterator<Item = [f64; 3]> + Clone, tolerance: f64) -> Option<Self> {
        axes.clone().next()?;
        Self::ALL.into_iter().find(|plane| axes.clone().all(|axis| plane.off_normal(axis) <= tolerance))
    }

    /// Returns the angle, at most pi/2 \[rad\], between the line of a vector in the root link's axes and the normal.
    pub(super) fn off_normal(self, axis: [f64; 3]) -> f64 {
        let [x, n, z] = apply(&self.axes(), axis);
        libm::atan2(libm::hypot(x, z), n.abs())
    }

    /// Returns the angle between a vector in the root link's axes and the plane \[rad\].
    pub(super) fn off_plane(self, axis: [f64; 3]) -> f64 {
        let [x, n, z] = apply(&self.axes(), axis);
        libm::atan2(n.abs(), libm::hypot(x, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_plane_is_right_handed() {
        for plane in Plane::ALL {
            let [[fx, fy, fz], normal, [ux, uy, uz]] = plane.axes();
            assert_eq!(normal, [uy * fz - uz * fy, uz * fx - ux * fz, ux * fy - uy * fx], "{plane:?}");
            // Name and normal agree with the rows.
            let letter =
                |row: [f64; 3]| "xyz".chars().zip(row).find(|(_, entry)| *entry != 0.0).expect("a unit vector");
            let [forward, normal, up] = plane.axes().map(letter);
            assert_eq!(plane.name(), format!("{}{}", forward.0, up.0));
            assert_eq!(plane.normal(), format!("{}{}", if normal.1 < 0.0 { '-' } else { '+' }, normal.0));
        }
    }
}
