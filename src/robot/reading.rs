//! Report of how a file was read: the choices with reasons, and the joints that have no coordinate.

use super::plane::Plane;
use crate::description::JointKind;
use std::fmt;

/// Report of how a file was read.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct Reading {
    /// The plane that the robot was reduced to.
    pub plane: Plane,
    /// Why this plane was chosen.
    pub plane_because: PlaneReason,
    /// The plane that would keep the most joints, and their number, if they are more than in this plane.
    pub better_plane: Option<(Plane, usize)>,
    /// Why the base is floating or fixed.
    pub base_because: String,
    /// Joints of the file that have no coordinate, in the file's order.
    pub frozen: Vec<FrozenJoint>,
    /// Links of the file that belong to the base and not to the robot, in the file's order.
    pub outside: Vec<String>,
    /// Facts that a user must know before trusting the reduced robot, each with a remedy.
    pub cautions: Vec<String>,
}

/// Why a plane was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum PlaneReason {
    /// The user asked for it.
    Asked,
    /// All axes of revolute and continuous joints are parallel to its normal.
    CommonAxis,
    /// Among x-z and y-z, more revolute and continuous joints on the paths to the lowest links rotate in this plane, or
    /// equally many and it is x-z.
    Legs,
    /// No revolute or continuous joint on the paths to the lowest links rotates in x-z or y-z, and y-z keeps more of
    /// all of them than x-z.
    Most,
    /// It is the usual sagittal plane (x-z), and the axes do not suggest another.
    #[default]
    Usual,
}

/// A joint of the file that has no coordinate in the reduced robot.
#[derive(Debug, Clone, PartialEq)]
pub struct FrozenJoint {
    /// The joint's name in the file.
    pub name: String,
    /// Why it has no coordinate.
    pub reason: FreezeReason,
    /// The body that the joint's child is welded into. For a joint of the base, the robot's root link.
    pub body: String,
    /// Whether the joint's child is part of `body`; if false, the child is a separate body, which is `body`.
    pub welded: bool,
}

/// Why a joint has no coordinate.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
#[non_exhaustive]
pub enum FreezeReason {
    /// The joint is fixed.
    Fixed,
    /// The user froze the joint at this value \[rad or m\].
    Asked { value: f64 },
    /// The joint would leave the plane, and is frozen at zero. `angle` is that between a revolute axis and the plane's
    /// normal, or between a prismatic axis (`slides`) and the plane \[rad\].
    OffPlane { angle: f64, slides: bool },
    /// The joint mimics a frozen joint, which puts it at this value \[rad or m\].
    Follows { mimicked: String, value: f64 },
    /// The joint is of a kind that is frozen at zero unless it is the base.
    Kind(JointKind),
    /// The joint is part of the floating base, whose coordinates are x, z and pitch.
    Base,
}

impl Reading {
    /// Returns why the plane was chosen, and whether another one would keep more joints.
    pub fn plane_in_words(&self) -> String {
        let because = match self.plane_because {
            PlaneReason::Asked => "as asked",
            PlaneReason::CommonAxis => "all hinges of the file turn in it",
            PlaneReason::Legs => "most hinges on the way to the lowest links turn in it",
            PlaneReason::Most => "more hinges of the file turn in it than in x-z",
            PlaneReason::Usual => "the usual one, as the file's hinges have no common direction",
        };
        match self.better_plane {
            Some((plane, joints)) => format!("{because}; plane {} would keep {joints} joints", plane.name()),
            None => because.to_owned(),
        }
    }
}

impl FrozenJoint {
    /// Returns why the joint has no coordinate, and what happened to its child.
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
