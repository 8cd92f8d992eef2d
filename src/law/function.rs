//! Inequalities as linear functions of the two numbers of a contact that an elimination yields.
//!
//! ```text
//!     [first, second] = [c_t, xi_n] if L = 0,   [c_t, lambda] if L lies along a ray,   [L_t, L_n] if L is free
//! ```

use super::inequality::Inequality;
use crate::scalar::Real;

/// A linear function of a contact's two numbers; `T` is the number type of its coefficient.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Function<T = f64> {
    /// The first number.
    First,
    /// Minus the first number.
    MinusFirst,
    /// The second number.
    Second,
    /// mu second - first: the slack of the friction cone on the side of +t.
    ConeMinus(T),
    /// mu second + first: the slack of the friction cone on the side of -t.
    ConePlus(T),
}

impl<T: Real> Function<T> {
    /// Evaluates the function of the contact's first (0) and second (1) `number`; `scaled` multiplies one by mu.
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
    /// The factor that makes the value of an `inequality` free of units once it is divided by S; `mobility` is
    /// sqrt(G_ii) of the contact's rows \[1/sqrt(kg)\]. A velocity is scaled as c_i / sqrt(G_ii), an impulse as L_i
    /// sqrt(G_ii), a cone as (mu L_n - |L_t|) / sqrt(mu^2 / G_nn + 1 / G_tt).
    #[inline]
    pub fn scale(self, inequality: Inequality, mobility: [f64; 2]) -> f64 {
        let row_mobility = mobility[inequality.row()];
        match self {
            Self::ConeMinus(mu) | Self::ConePlus(mu) => {
                let size = libm::hypot(mu / mobility[1], 1.0 / mobility[0]);
                if size.is_finite() { 1.0 / size } else { mobility[1] / mu }
            }
            _ if inequality.is_strict() => 1.0 / row_mobility,
            _ => row_mobility,
        }
    }
}
