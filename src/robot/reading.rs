//! How a file was read: what was chosen, why, and what became of joints that have no coordinate.

use super::plane::Plane;
use crate::description::JointKind;
use std::fmt;

/// How a file was read.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Reading {
    /// The plane that the robot was reduced to.
    pub plane: Plane,
    /// Why that plane was taken.
    pub plane_because: PlaneReason,
    /// The plane that would keep most joints and how many, where that is more than in this one.
    pub better_plane: Option<(Plane, usize)>,
    /// Why the base is floating or fixed.
    pub base_because: String,
    /// Joints of the file without a coordinate, in its order.
    pub frozen: Vec<FrozenJoint>,
    /// Links of the file that are not part of the robot but of the base, in its order.
    pub outside: Vec<String>,
    /// What a user must know before trusting the reduced robot, each with its remedy.
    pub cautions: Vec<String>,
}

/// Why a plane was taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum PlaneReason {
    /// It was asked for.
    Asked,
    /// All axes of revolute and continuous joints are parallel to its normal.
    CommonAxis,
    /// More revolute and continuous joints on the way to the lowest links turn in it than in another.
    Legs,
    /// It is URDF's usual sagittal plane, and the axes do not suggest another.
    #[default]
    Usual,
}

/// A joint of the file that has no coordinate in the reduced robot.
#[derive(Debug, Clone, PartialEq)]
pub struct FrozenJoint {
    /// Its name in the file.
    pub name: String,
    /// Why it has no coordinate.
    pub reason: FreezeReason,
    /// The body that its child is welded into; for a joint of the base the robot's root link.
    pub body: String,
    /// False where its child is kept apart as a body of its own, `body`.
    pub welded: bool,
}

/// Why a joint has no coordinate.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
#[non_exhaustive]
pub enum FreezeReason {
    /// It is fixed.
    Fixed,
    /// The user froze it at this value \[rad or m\].
    Asked { value: f64 },
    /// It would lead out of the plane, and is frozen at zero: the angle from a revolute joint's axis to the plane's
    /// normal, or from a prismatic one's (which `slides`) to the plane \[rad\].
    OffPlane { angle: f64, slides: bool },
    /// It mimics a joint that is frozen, which puts it at this value \[rad or m\].
    Follows { mimicked: String, value: f64 },
    /// A joint of this kind is frozen at zero unless it is the base.
    Kind(JointKind),
    /// It is part of the floating base itself, whose coordinates are x, z and pitch.
    Base,
}

impl Reading {
    /// Why the plane was taken, and whether another one would keep more joints.
    pub fn plane_in_words(&self) -> String {
        let because = match self.plane_because {
            PlaneReason::Asked => "as asked",
            PlaneReason::CommonAxis => "all hinges of the file turn in it",
            PlaneReason::Legs => "most hinges on the way to the lowest links turn in it",
            PlaneReason::Usual => "the usual one, as the file's hinges have no common direction",
        };
        match self.better_plane {
            Some((plane, joints)) => format!("{because}; plane {} would keep {joints} joints", plane.name()),
            None => because.to_owned(),
        }
    }
}

impl FrozenJoint {
    /// Why it has no coordinate and what became of its child, in words.
    pub fn why(&self) -> String {
        let Self { body, reason, .. } = self;
        match reason {
            FreezeReason::Base => format!("{reason}: x, z and pitch of {body} take its place"),
            _ if self.welded => format!("{reason}: welded into {body}"),
            _ => format!("{reason}: it has no coordinate, and moves a body of its own, {body}"),
        }
    }
}

impl fmt::Display for FreezeReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fixed => f.write_str("fixed"),
            Self::Asked { value } => write!(f, "frozen at {value} as asked"),
            Self::OffPlane { angle, slides } => {
                let wanted = if *slides { "the plane" } else { "the plane's normal" };
                write!(f, "frozen at zero, its axis being {:.2} degrees off {wanted}", angle.to_degrees())
            }
            Self::Follows { mimicked, value: 0.0 } => write!(f, "frozen like {mimicked}, which it follows"),
            Self::Follows { mimicked, value } => write!(f, "frozen at {value} by {mimicked}, which it follows"),
            Self::Kind(kind) => write!(f, "frozen at zero, being {}", kind.name()),
            Self::Base => f.write_str("part of the floating base"),
        }
    }
}
