//! The inequalities of a contact: one list for the reasons of rejections, for borders and for transitions.

use serde::{Deserialize, Serialize};
use std::fmt;

/// An inequality of a contact's mode.
///
/// ```
/// assert!(heelstrike::Inequality::NormalImpulse.violated_by("left_foot").contains("left_foot"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Inequality {
    /// xi_n > 0 of a contact that separates.
    NormalVelocity,
    /// L_n >= 0 of a closed contact.
    NormalImpulse,
    /// |L_t| <= mu L_n of a sticking contact.
    FrictionCone,
    /// c_t+ of a sliding contact points along its slide.
    TangentialVelocity,
    /// With infinite friction: L_t of a sliding contact acts against its slide.
    TangentialImpulse,
    /// a_n > 0 of a contact that separates, in sustained contact.
    NormalAcceleration,
    /// f_n >= 0 of a closed contact, in sustained contact.
    NormalForce,
    /// a_t of a contact that begins to slide points along its slide.
    TangentialAcceleration,
    /// With infinite friction: f_t acts against the slide, in sustained contact.
    TangentialForce,
    /// f is finite: in sustained contact it may grow without bound and change its sign at the pole.
    UnboundedForce,
}

impl Inequality {
    /// The inequalities of impulses and forces that an outcome's border can have.
    pub const OF_IMPULSES: [Self; 5] =
        [Self::NormalImpulse, Self::TangentialImpulse, Self::FrictionCone, Self::NormalForce, Self::TangentialForce];

    /// The corresponding inequality of sustained contact.
    pub fn of_forces(self) -> Self {
        match self {
            Self::NormalVelocity => Self::NormalAcceleration,
            Self::NormalImpulse => Self::NormalForce,
            Self::TangentialVelocity => Self::TangentialAcceleration,
            Self::TangentialImpulse => Self::TangentialForce,
            other => other,
        }
    }

    /// Whether the inequality is one of velocities or accelerations. These are strict: zero belongs to another mode.
    pub fn is_strict(self) -> bool {
        matches!(self.of_forces(), Self::NormalAcceleration | Self::TangentialAcceleration)
    }

    /// The row whose mobility scales the inequality: 0 tangential, 1 normal.
    pub(super) fn row(self) -> usize {
        usize::from(!matches!(self.of_forces(), Self::TangentialAcceleration | Self::TangentialForce))
    }

    /// Describes its violation, as a clause about the contact named `name`.
    pub fn violated_by(self, name: &str) -> String {
        match self {
            Self::NormalVelocity => format!("{name} moves into the ground"),
            Self::NormalAcceleration => format!("{name} accelerates into the ground"),
            Self::NormalImpulse | Self::NormalForce => format!("{name} is pulled toward the ground"),
            Self::FrictionCone => format!("{name} needs more friction than there is"),
            Self::TangentialVelocity => format!("{name} moves against its own sliding direction"),
            Self::TangentialAcceleration => format!("{name} accelerates against its own sliding direction"),
            Self::TangentialImpulse | Self::TangentialForce => format!("friction at {name} drives the slide"),
            Self::UnboundedForce => format!("the force on {name} has no bound"),
        }
    }

    /// Describes its border, as a clause about the contact named `name`.
    pub fn reached_by(self, name: &str) -> String {
        let zero = |what: &str| format!("the {what} of {name} reaches zero");
        match self {
            Self::NormalVelocity => zero("normal velocity"),
            Self::NormalImpulse => zero("normal impulse"),
            Self::FrictionCone => format!("{name} needs all the friction that there is"),
            Self::TangentialVelocity => zero("tangential velocity"),
            Self::TangentialImpulse => zero("tangential impulse"),
            Self::NormalAcceleration => zero("normal acceleration"),
            Self::NormalForce => zero("normal force"),
            Self::TangentialAcceleration => zero("tangential acceleration"),
            Self::TangentialForce => zero("tangential force"),
            Self::UnboundedForce => format!("the force on {name} grows without bound"),
        }
    }

    /// Describes its violation, without naming a contact.
    pub fn violation(self) -> &'static str {
        match self {
            Self::NormalVelocity => "a contact would move into the ground",
            Self::NormalAcceleration => "a contact would accelerate into the ground",
            Self::NormalImpulse | Self::NormalForce => "the ground would have to pull",
            Self::FrictionCone => "sticking would need more friction",
            Self::TangentialVelocity => "a contact would slide against its own direction",
            Self::TangentialAcceleration => "a contact would begin to slide against its own direction",
            Self::TangentialImpulse | Self::TangentialForce => "friction would drive the slide",
            Self::UnboundedForce => "a force would have no bound",
        }
    }
}

impl fmt::Display for Inequality {
    /// Writes the equation that holds on its border.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::NormalVelocity => "c_n+ = 0",
            Self::NormalImpulse => "L_n = 0",
            Self::FrictionCone => "|L_t| = mu L_n",
            Self::TangentialVelocity => "c_t+ = 0",
            Self::TangentialImpulse => "L_t = 0",
            Self::NormalAcceleration => "a_n = 0",
            Self::NormalForce => "f_n = 0",
            Self::TangentialAcceleration => "a_t = 0",
            Self::TangentialForce => "f_t = 0",
            Self::UnboundedForce => "f without bound",
        })
    }
}
