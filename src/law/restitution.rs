//! Restitution: Newton's law in Moreau's form.
//!
//! ```text
//!     xi_n = c_n+ + e min(c_n-, 0)      takes the place of c_n+ in every mode
//! ```

use crate::scalar::{Ordered, Real, Sign};

/// The normal velocity of a contact that approaches, else zero: min(c_n-, 0) \[m/s\].
pub fn approach<T: Ordered>(before: T) -> T {
    match before.sign() {
        Sign::Negative => before,
        Sign::Zero | Sign::Positive => T::zero(),
        // Not a number, so that everything that depends on it stays open.
        Sign::Undecided => T::one() / T::zero(),
    }
}

/// What the law adds to c_n+, with e the coefficient of restitution, 0 to 1 \[m/s\].
pub fn bounce<T: Real>(e: f64, approach: T) -> T {
    T::from_f64(e) * approach
}
