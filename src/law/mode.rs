//! The modes in which a contact can end, and the velocity conditions of each.

use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::fmt;
use std::sync::LazyLock;

/// How a contact ends; strict, so that every velocity after it has exactly one list of modes (paper, section 2).
///
/// ```
/// assert_eq!(heelstrike::Mode::SlidePlus.to_string(), "slide+");
/// ```
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

    /// The name in results, such as `slide+`.
    pub fn name(self) -> &'static str {
        static NAMES: LazyLock<[String; 4]> = LazyLock::new(|| Mode::ALL.map(|mode| mode.to_string()));
        &NAMES[self as usize]
    }

    /// The signs that the mode requires of [c_t, xi_n] after the impact; `None` for an entry of any sign.
    pub fn velocity(self) -> [Option<Ordering>; 2] {
        match self {
            Mode::Separate => [None, Some(Ordering::Greater)],
            Mode::Stick => [Some(Ordering::Equal); 2],
            Mode::SlidePlus => [Some(Ordering::Greater), Some(Ordering::Equal)],
            Mode::SlideMinus => [Some(Ordering::Less), Some(Ordering::Equal)],
        }
    }

    /// The mode seen with the tangent reversed.
    pub fn mirrored(self) -> Self {
        match self {
            Mode::SlidePlus => Mode::SlideMinus,
            Mode::SlideMinus => Mode::SlidePlus,
            Mode::Separate | Mode::Stick => self,
        }
    }

    /// The mode of a closed contact whose tangential velocity has this sign.
    pub fn closed(velocity: Ordering) -> Self {
        match velocity {
            Ordering::Greater => Mode::SlidePlus,
            Ordering::Equal => Mode::Stick,
            Ordering::Less => Mode::SlideMinus,
        }
    }

    /// The sign of the sliding velocity along t: +1, -1, or 0 if the contact does not slide.
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
        self.serialize(f)
    }
}
