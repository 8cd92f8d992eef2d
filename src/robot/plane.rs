//! The plane that a robot moves in: axes of the joints -> forward, normal and up.
//!
//! ```text
//!     rows of P = forward, n, up          n = up x forward        P w: a vector w of the root link in the plane's axes
//! ```
//!
//! P only picks components and changes signs, so it costs no digit.

use crate::description::{Matrix, apply};

/// The greatest angle between two directions that still count as parallel \[rad\]: files round their axes.
pub(super) const PARALLEL: f64 = 1e-3;

/// The same of shapes: pi is often written as 3.14.
pub(super) const PARALLEL_SHAPE: f64 = 2e-3;

/// A plane through the root link's origin, named by the root link's axes that point forward and up.
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
    /// All planes, the usual one first.
    pub const ALL: [Self; 6] = [Self::XZ, Self::YZ, Self::XY, Self::ZY, Self::ZX, Self::YX];

    /// Its name, forward before up: `xz`, `yz` and so on.
    pub fn name(self) -> &'static str {
        ["xz", "yz", "xy", "zy", "zx", "yx"][self as usize]
    }

    /// Its normal among the root link's axes: `+y`, `-x` and so on.
    pub fn normal(self) -> &'static str {
        ["+y", "-x", "-z", "+x", "-y", "+z"][self as usize]
    }

    /// Forward, normal and up as rows: takes vectors of the root link into the plane's axes.
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

    /// The plane whose normal all of these unit vectors are parallel to within `tolerance` \[rad\]; `None` without any.
    pub(super) fn normal_to(axes: impl Iterator<Item = [f64; 3]> + Clone, tolerance: f64) -> Option<Self> {
        axes.clone().next()?;
        Self::ALL.into_iter().find(|plane| axes.clone().all(|axis| plane.off_normal(axis) <= tolerance))
    }

    /// The angle between a vector of the root link's axes and the plane's normal, whichever way either points \[rad\].
    pub(super) fn off_normal(self, axis: [f64; 3]) -> f64 {
        let [x, n, z] = apply(&self.axes(), axis);
        libm::atan2(libm::hypot(x, z), n.abs())
    }

    /// The angle between a vector of the root link's axes and the plane \[rad\].
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
            // The names say the same as the rows.
            let letter =
                |row: [f64; 3]| "xyz".chars().zip(row).find(|(_, entry)| *entry != 0.0).expect("a unit vector");
            let [forward, normal, up] = plane.axes().map(letter);
            assert_eq!(plane.name(), format!("{}{}", forward.0, up.0));
            assert_eq!(plane.normal(), format!("{}{}", if normal.1 < 0.0 { '-' } else { '+' }, normal.0));
        }
    }
}
