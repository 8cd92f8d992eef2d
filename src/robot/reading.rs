//! How a file was read: what was chosen, why, and what became of joints that have no coordinate.

use super::plane::Plane;
use crate::description::JointKind;

/// How a file was read.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// The plane.
    pub plane: Plane,
    /// Why it was taken.
    pub plane_because: PlaneReason,
    /// The plane that would keep most joints and how many, where that is more than in this one.
    pub better_plane: Option<(Plane, usize)>,
    /// Why the base is floating or fixed.
    pub base_because: String,
    /// Joints of the file that have no coordinate, in its order.
    pub held: Vec<HeldJoint>,
    /// Links of the file that are not part of the robot but of the base, in its order.
    pub outside: Vec<String>,
    /// What a user must know before trusting the reduced robot, each with its remedy.
    pub cautions: Vec<String>,
}

/// Why a plane was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PlaneReason {
    /// It was asked for.
    Asked,
    /// All axes of revolute and continuous joints are parallel to its normal.
    CommonAxis,
    /// It is URDF's usual sagittal plane, and the axes have no common direction.
    #[default]
    Usual,
}

/// A joint of the file that has no coordinate in the reduced robot.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldJoint {
    /// Its name.
    pub name: String,
    /// Why it has none.
    pub still: Still,
    /// The body that its child is welded into; for a joint of the base the robot's root link.
    pub body: String,
    /// False where its child is kept apart as a body of its own, `body`.
    pub welded: bool,
}

/// Why a joint has no coordinate.
#[derive(Debug, Clone, PartialEq)]
pub enum Still {
    /// It is fixed.
    Fixed,
    /// The user holds it.
    Asked {
        /// At this value \[rad or m\].
        value: f64,
    },
    /// It would lead out of the plane, and is held at zero.
    OffPlane {
        /// The angle from a hinge's axis to the plane's normal, or from a slide's to the plane \[rad\].
        angle: f64,
        /// True for a slide.
        slides: bool,
    },
    /// It follows a joint that is held.
    Follows {
        /// That joint.
        leader: String,
    },
    /// A joint of this kind is held at zero wherever it is not the base.
    Kind(JointKind),
    /// It is part of the floating base itself, whose coordinates are x, z and pitch.
    Base,
}

impl HeldJoint {
    /// Why it has no coordinate, in words.
    pub fn why(&self) -> String {
        let Self { body, still, .. } = self;
        let kept = if self.welded { "welded into" } else { "without a coordinate, but moves a body of its own," };
        match still {
            Still::Fixed => format!("fixed: {kept} {body}"),
            Still::Asked { value } => format!("held at {value} as asked: {kept} {body}"),
            Still::OffPlane { angle, slides } => {
                let wanted = if *slides { "the plane" } else { "the plane's normal" };
                let angle = angle.to_degrees();
                format!("held at zero, its axis is {angle:.2} degrees off {wanted}: {kept} {body}")
            }
            Still::Follows { leader } => format!("held like {leader}, which it follows: {kept} {body}"),
            Still::Kind(kind) => format!("held at zero, being {}: {kept} {body}", kind.name()),
            Still::Base => format!("part of the floating base: x, z and pitch of {body} take its place"),
        }
    }
}
