//! Coulomb friction of a contact: a finite coefficient or infinite.

use std::fmt;
use std::str::FromStr;

/// The Coulomb friction of a contact.
///
/// ```
/// use heelstrike::Friction;
///
/// assert_eq!("0.8".parse(), Ok(Friction::from(0.8)));
/// assert_eq!("infinite".parse(), Ok(Friction::Infinite));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Friction<T = f64> {
    /// The coefficient mu, at least 0.
    Finite(T),
    /// No bound on the tangential impulse. This is a case of its own, not a large mu (paper, section 2).
    Infinite,
}

impl Friction {
    /// No friction: mu = 0.
    pub const ZERO: Friction = Friction::Finite(0.0);

    /// Whether mu = 0.
    pub fn is_zero(self) -> bool {
        self == Friction::ZERO
    }

    /// The smaller of a ratio |L_t| / L_n and mu.
    pub(crate) fn limit(self, ratio: f64) -> f64 {
        match self {
            Self::Finite(mu) => ratio.min(mu),
            Self::Infinite => ratio,
        }
    }

    /// Converts the coefficient to another number type.
    pub(crate) fn map<T>(self, number: impl FnOnce(f64) -> T) -> Friction<T> {
        match self {
            Self::Finite(mu) => Friction::Finite(number(mu)),
            Self::Infinite => Friction::Infinite,
        }
    }
}

impl From<f64> for Friction {
    /// Takes mu; [`f64::INFINITY`] becomes [`Friction::Infinite`].
    fn from(mu: f64) -> Self {
        if mu == f64::INFINITY { Self::Infinite } else { Self::Finite(mu) }
    }
}

impl FromStr for Friction {
    type Err = String;

    /// Parses a number of at least 0, or `infinite`.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<f64>() {
            _ if text == "infinite" => Ok(Self::Infinite),
            Ok(mu) if mu >= 0.0 && mu.is_finite() => Ok(Self::Finite(mu)),
            _ => Err("expected a number from 0 on, or \"infinite\"".to_owned()),
        }
    }
}

impl fmt::Display for Friction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            // Without an exponent, a very small or very large mu would be mostly zeros.
            Friction::Finite(mu) if mu != 0.0 && !(1e-5..1e16).contains(&mu) => f.pad(&format!("{mu:e}")),
            Friction::Finite(mu) => mu.fmt(f),
            Friction::Infinite => f.pad("infinite"),
        }
    }
}
