//! Which inequality of a contact holds, is zero or is violated: one list for reasons, borders and transitions.

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
}

impl Inequality {
    /// Those of impulses.
    pub const OF_IMPULSES: [Self; 3] = [Self::NormalImpulse, Self::TangentialImpulse, Self::FrictionCone];

    /// Whether it is about a velocity. It is strict then: a velocity of zero belongs to another mode.
    pub fn is_strict(self) -> bool {
        matches!(self, Self::NormalVelocity | Self::TangentialVelocity)
    }

    /// The row that it is scaled by: 0 tangential, 1 normal.
    pub(super) fn row(self) -> usize {
        match self {
            Self::TangentialVelocity | Self::TangentialImpulse => 0,
            Self::NormalVelocity | Self::NormalImpulse | Self::FrictionCone => 1,
        }
    }

    /// What its violation means, as a clause about the contact of this name.
    pub fn violated_by(self, name: &str) -> String {
        match self {
            Self::NormalVelocity => format!("{name} moves into the ground"),
            Self::NormalImpulse => format!("{name} is pulled toward the ground"),
            Self::FrictionCone => format!("{name} needs more friction than there is"),
            Self::TangentialVelocity => format!("{name} moves against its own sliding direction"),
            Self::TangentialImpulse => format!("friction at {name} drives the slide"),
        }
    }

    /// What its violation means, of no contact in particular.
    pub fn violation(self) -> &'static str {
        match self {
            Self::NormalVelocity => "a contact would move into the ground",
            Self::NormalImpulse => "the ground would have to pull",
            Self::FrictionCone => "sticking would need more friction",
            Self::TangentialVelocity => "a contact would slide against its own direction",
            Self::TangentialImpulse => "friction would drive the slide",
        }
    }
}

impl fmt::Display for Inequality {
    /// As the equation that holds on its border.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::NormalVelocity => "c_n+ = 0",
            Self::NormalImpulse => "L_n = 0",
            Self::FrictionCone => "|L_t| = mu L_n",
            Self::TangentialVelocity => "c_t+ = 0",
            Self::TangentialImpulse => "L_t = 0",
        })
    }
}
