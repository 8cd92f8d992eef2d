//! How much friction a contact has.

use std::fmt;

/// Coulomb friction of a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction<T = f64> {
    /// The coefficient mu, from 0 on.
    Finite(T),
    /// No bound on the tangential impulse; a case of its own, not a big number (paper, section 2).
    Infinite,
}

impl Friction {
    /// No friction at all.
    pub const ZERO: Friction = Friction::Finite(0.0);

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
