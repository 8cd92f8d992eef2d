//! The outline of a collision shape in the plane.
//!
//! ```text
//!     outline = convex polygon of corners + rim          (the sum of each point of one and each of the other)
//!
//!     corners  rim      shape                            corners  rim      shape
//!     one      point    point                            three +  point    box, cylinder in the plane, mesh
//!     one      circle   sphere, cylinder along n         two      ellipse  cylinder oblique to the plane
//!     two      point    flat plate, upright
//!     two      circle   capsule
//! ```

use crate::planar::Vector;

/// The outline of a collision shape in the plane, rigid in its body's frame: a convex polygon of corners swept by a
/// rim.
#[derive(Debug, Clone)]
pub struct FootShape {
    corners: Vec<Vector<f64>>,
    /// The rim about each corner.
    pub rim: Rim,
    /// The file name of the mesh, if the outline is the hull of one.
    pub mesh: Option<String>,
}

/// The curve about each corner of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Rim {
    /// A circle of this radius \[m\]. A radius of 0 means the corner itself.
    Circle { radius: f64 },
    /// The projection of a circle in space: `cos(s) a + sin(s) b` for all s, with two conjugate half diameters a, b in
    /// the body's frame \[m\].
    Ellipse { half_diameters: [Vector<f64>; 2] },
}

impl Rim {
    /// Returns the rim's point that is farthest along the unit vector `direction`, from the rim's center \[m\].
    ///
    /// For an ellipse this is `(a (a.d) + b (b.d)) / |(a.d, b.d)|`, the gradient of its support function |(a.d, b.d)|.
    pub fn support(&self, direction: Vector<f64>) -> Vector<f64> {
        match *self {
            Self::Circle { radius } => direction * radius,
            Self::Ellipse { half_diameters: [a, b] } => {
                let along = [a.dot(direction), b.dot(direction)];
                let reach = libm::hypot(along[0], along[1]);
                if reach == 0.0 { Vector::zero() } else { a * (along[0] / reach) + b * (along[1] / reach) }
            }
        }
    }

    /// Returns how far the rim extends from its center along the unit vector `direction` \[m\].
    pub fn reach(&self, direction: Vector<f64>) -> f64 {
        match *self {
            Self::Circle { radius } => radius,
            Self::Ellipse { half_diameters: [a, b] } => libm::hypot(a.dot(direction), b.dot(direction)),
        }
    }

    /// Returns an upper bound on the distance of the rim's points from its center \[m\].
    pub fn bound(&self) -> f64 {
        match *self {
            Self::Circle { radius } => radius,
            Self::Ellipse { half_diameters: [a, b] } => libm::hypot(a.length(), b.length()),
        }
    }
}

impl FootShape {
    /// Creates a disc, or a point if the radius is 0. `center` is in the body's frame; both are in meters.
    pub fn disc(center: Vector<f64>, radius: f64) -> Self {
        Self { corners: vec![center], rim: Rim::Circle { radius }, mesh: None }
    }

    /// Creates the polygon of `corners` \[m\] in the body's frame with `rim` about each. The corners must be convex and
    /// counter-clockwise, where forward points right and up points up. Two corners are a line, one is a point. `None`
    /// if there is no corner, or if neighbors coincide or their distance exceeds the range of f64.
    pub fn swept(corners: Vec<Vector<f64>>, rim: Rim) -> Option<Self> {
        let side = |at: usize| (corners[(at + 1) % corners.len()] - corners[at]).length();
        let distinct = corners.len() == 1 || (0..corners.len()).all(|at| side(at) > 0.0 && side(at).is_finite());
        (distinct && !corners.is_empty()).then_some(Self { corners, rim, mesh: None })
    }

    /// Returns the polygon's corners in the body's frame \[m\]; at least one.
    pub fn corners(&self) -> &[Vector<f64>] {
        &self.corners
    }

    /// Returns center and radius of a circle that contains the whole shape, in the body's frame \[m\].
    pub fn bounding_circle(&self) -> (Vector<f64>, f64) {
        let (low, high) = self.corners.iter().fold((self.corners[0], self.corners[0]), |(low, high), &corner| {
            (low.least(corner), high.greatest(corner))
        });
        let center = low * 0.5 + high * 0.5;
        let farthest = self.corners.iter().map(|&corner| (corner - center).length());
        (center, farthest.fold(0.0, f64::max) + self.rim.bound())
    }

    /// Returns the shape scaled by the positive `factor`; `None` if neighboring corners coincide or overflow.
    pub fn resized(&self, factor: f64) -> Option<Self> {
        let rim = match self.rim {
            Rim::Circle { radius } => Rim::Circle { radius: radius * factor },
            Rim::Ellipse { half_diameters } => {
                Rim::Ellipse { half_diameters: half_diameters.map(|half| half * factor) }
            }
        };
        let resized = Self::swept(self.corners.iter().map(|&corner| corner * factor).collect(), rim)?;
        Some(Self { mesh: self.mesh.clone(), ..resized })
    }
}
