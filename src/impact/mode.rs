//! How a contact ends, and how much friction it has.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How a contact ends; strict, so that every velocity after the impact has exactly one list of modes (paper, section 2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Mode {
    /// It leaves: xi_n > 0, L = 0.
    #[serde(rename = "separate")]
    Separate,
    /// It stays: c+ = 0 (with restitution: xi_n = 0), L anywhere in its cone.
    #[serde(rename = "stick")]
    Stick,
    /// It moves along +t: c_t+ > 0, L on the edge of its cone with L_t <= 0.
    #[serde(rename = "slide+")]
    SlidePlus,
    /// It moves along -t: c_t+ < 0, L on the edge of its cone with L_t >= 0.
    #[serde(rename = "slide-")]
    SlideMinus,
}

impl Mode {
    /// All modes, in the order in which combinations are tried.
    pub const ALL: [Mode; 4] = [Mode::Separate, Mode::Stick, Mode::SlidePlus, Mode::SlideMinus];

    /// The sign of the sliding velocity along t: +1, -1, or 0 where the contact does not slide.
    pub fn direction(self) -> f64 {
        match self {
            Mode::SlidePlus => 1.0,
            Mode::SlideMinus => -1.0,
            Mode::Separate | Mode::Stick => 0.0,
        }
    }

    /// Whether the contact slides.
    pub fn slides(self) -> bool {
        matches!(self, Mode::SlidePlus | Mode::SlideMinus)
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Mode::Separate => "separate",
            Mode::Stick => "stick",
            Mode::SlidePlus => "slide+",
            Mode::SlideMinus => "slide-",
        })
    }
}

/// Coulomb friction of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction {
    /// The coefficient mu, from 0 on.
    Finite(f64),
    /// No bound on the tangential impulse; a case of its own, not a big number (paper, section 2).
    Infinite,
}

impl Friction {
    /// No friction at all.
    pub const ZERO: Friction = Friction::Finite(0.0);

    /// The homogeneous pair (a, b) of the cone a L_n >= b |L_t|: (mu, 1), or (1, 0) where mu is infinite.
    pub fn pair(self) -> (f64, f64) {
        match self {
            Friction::Finite(mu) => (mu, 1.0),
            Friction::Infinite => (1.0, 0.0),
        }
    }

    /// Whether mu = 0.
    pub fn is_zero(self) -> bool {
        self == Friction::ZERO
    }
}

impl fmt::Display for Friction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Friction::Finite(mu) => mu.fmt(f),
            Friction::Infinite => f.pad("infinite"),
        }
    }
}
