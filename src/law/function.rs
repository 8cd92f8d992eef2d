//! An inequality as a linear function of the two numbers that an elimination leaves of a contact.
//!
//! ```text
//!     [first, second] = [c_t, xi_n] if L = 0,   [c_t, lambda] if L lies along a ray,   [L_t, L_n] if L is free
//! ```

use super::inequality::Inequality;
use crate::scalar::Real;

/// A linear function of a contact's two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Function<T = f64> {
    /// The first number.
    First,
    /// The first number times -1.
    MinusFirst,
    /// The second number.
    Second,
    /// mu second - first: the distance from the edge of the friction cone on the side of +t.
    ConeMinus(T),
    /// mu second + first: that on the side of -t.
    ConePlus(T),
}

impl<T: Real> Function<T> {
    /// The value at the contact's numbers, first (0) and second (1), which are `scaled` by the law's coefficients.
    #[inline]
    pub fn at<N: Real>(self, number: impl Fn(usize) -> N, scaled: impl Fn(T, N) -> N) -> N {
        match self {
            Self::First => number(0),
            Self::MinusFirst => -number(0),
            Self::Second => number(1),
            Self::ConeMinus(mu) => scaled(mu, number(1)) - number(0),
            Self::ConePlus(mu) => scaled(mu, number(1)) + number(0),
        }
    }
}

impl Function {
    /// What the value of an `inequality` is multiplied by to be free of units, once divided by S; `mobility` is
    /// sqrt(G_ii) of the contact's rows \[1/sqrt(kg)\]. A velocity counts c_i / sqrt(G_ii), an impulse L_i sqrt(G_ii), a
    /// cone (mu L_n - |L_t|) / sqrt(mu^2 / G_nn + 1 / G_tt).
    #[inline]
    pub fn scale(self, inequality: Inequality, mobility: [f64; 2]) -> f64 {
        let own = mobility[inequality.row()];
        match self {
            Self::ConeMinus(mu) | Self::ConePlus(mu) => {
                let size = libm::hypot(mu / mobility[1], 1.0 / mobility[0]);
                if size.is_finite() { 1.0 / size } else { mobility[1] / mu }
            }
            _ if inequality.is_strict() => 1.0 / own,
            _ => own,
        }
    }
}
