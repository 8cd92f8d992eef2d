//! The outline of a collision shape in the plane.
//!
//! ```text
//!     outline = convex polygon of corners + rim          (every point of the one added to every point of the other)
//!
//!     corners  rim      shape                            corners  rim      shape
//!     one      point    point                            three +  point    box, convex hull of a mesh
//!     one      circle   sphere, cylinder along n         two      ellipse  cylinder oblique to the plane
//!     two      point    flat plate, upright
//!     two      circle   capsule
//! ```

use crate::planar::Vector;

/// A collision shape in the plane, rigid in its body's frame: a convex polygon of corners swept by a rim.
#[derive(Debug, Clone)]
pub struct FootShape {
    corners: Vec<Vector<f64>>,
    /// What stands about each corner.
    pub rim: Rim,
    /// The file of the mesh whose hull it is.
    pub mesh: Option<String>,
}

/// What stands about each corner of a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Rim {
    /// A circle of this radius \[m\]; of radius 0, the corner itself.
    Circle { radius: f64 },
    /// The projection of a circle in space: `cos(s) a + sin(s) b` for all s, with two conjugate half diameters a, b in
    /// the body's frame \[m\].
    Ellipse { half_diameters: [Vector<f64>; 2] },
}

impl Rim {
    /// The rim's point that lies farthest along the unit vector `direction`, seen from its center \[m\].
    ///
    /// Of an ellipse: `(a (a.d) + b (b.d)) / |(a.d, b.d)|`, the gradient of its support function |(a.d, b.d)|.
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

    /// How far it reaches along the unit vector `direction` \[m\].
    pub fn reach(&self, direction: Vector<f64>) -> f64 {
        match *self {
            Self::Circle { radius } => radius,
            Self::Ellipse { half_diameters: [a, b] } => libm::hypot(a.dot(direction), b.dot(direction)),
        }
    }

    /// No point of it is farther from its center \[m\].
    pub fn bound(&self) -> f64 {
        match *self {
            Self::Circle { radius } => radius,
            Self::Ellipse { half_diameters: [a, b] } => libm::hypot(a.length(), b.length()),
        }
    }
}

impl FootShape {
    /// A disc; of radius 0, a point. `center` in the body's frame, both in meters.
    pub fn disc(center: Vector<f64>, radius: f64) -> Self {
        Self { corners: vec![center], rim: Rim::Circle { radius }, mesh: None }
    }

    /// The polygon of `corners` \[m\] in the body's frame, convex and counter-clockwise seen with forward to the right
    /// and up upward, with `rim` about each; two corners are a line, one is a point. None for no corner, or for
    /// neighbors that coincide or whose distance exceeds f64.
    pub fn swept(corners: Vec<Vector<f64>>, rim: Rim) -> Option<Self> {
        let side = |at: usize| (corners[(at + 1) % corners.len()] - corners[at]).length();
        let distinct = corners.len() == 1 || (0..corners.len()).all(|at| side(at) > 0.0 && side(at).is_finite());
        (distinct && !corners.is_empty()).then_some(Self { corners, rim, mesh: None })
    }

    /// The polygon's corners in the body's frame \[m\]; at least one.
    pub fn corners(&self) -> &[Vector<f64>] {
        &self.corners
    }

    /// Center and radius of a circle about the whole shape, in the body's frame \[m\].
    pub fn bounding_circle(&self) -> (Vector<f64>, f64) {
        let (low, high) = self.corners.iter().fold((self.corners[0], self.corners[0]), |(low, high), &corner| {
            (low.least(corner), high.greatest(corner))
        });
        let center = low * 0.5 + high * 0.5;
        let farthest = self.corners.iter().map(|&corner| (corner - center).length());
        (center, farthest.fold(0.0, f64::max) + self.rim.bound())
    }

    /// The shape with all lengths times `factor`, which is positive.
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
