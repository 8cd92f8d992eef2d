//! Where the robot touches the ground (the only user of parry).
//!
//! ```text
//!     body poses + feet + ground --> closed contacts
//! ```

mod face;
mod feet;
mod point;
mod placement;
mod outline;
mod sole;
mod plane;
mod terrain;
mod profile;
mod surface;
mod merge;
mod level;
mod detect;
mod nearest;

pub(crate) use detect::Footing;
pub use feet::{Feet, Foot};
pub(crate) use level::{Level, RigidParts, level};
pub use merge::Merged;
pub use placement::Placement;
pub(crate) use plane::HalfPlane;
pub(crate) use point::{Circle, Point, points};
pub(crate) use surface::Surface;

use crate::planar::{Rotation, Vector};
use std::sync::Arc;

/// A closed contact of one state; [`Pipeline`](crate::Pipeline) has an example.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Contact {
    /// Index into [`Robot::links`](crate::Robot) of the URDF link that carries the shape; the link may be merged into
    /// the body of another.
    pub link: usize,
    /// The link's name; link/0, link/1 ... if it has several contacts, or link//0 if other links are called link/0.
    pub name: Arc<str>,
    /// Index of the body to which the contact is fixed.
    pub body: usize,
    /// The point, or the center of the circle, in the body's frame \[m\].
    pub center: Vector<f64>,
    /// The center in the link's own 3-D frame \[m\], as it was named; `None` for a shape of the robot.
    pub offset: Option<[f64; 3]>,
    /// Radius of the circle \[m\]: the contact point lies at this distance against the normal; 0 for a point.
    pub radius: f64,
    /// The contact point in the world \[m\].
    pub point: Vector<f64>,
    /// Rotation from the world's axes to the ground's (tangent, normal) at the contact.
    pub ground: Rotation<f64>,
    /// Height above the ground along the normal \[m\], negative below it.
    pub gap: f64,
}
