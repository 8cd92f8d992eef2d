//! Enclosures that know when they are exactly zero.

use super::{Ordered, Real, Residue, Sign, Trigonometry};

/// An enclosure together with the [`Residue`] of the same number.
///
/// The enclosure proves the signs except zero. The residue proves that a number is not zero, and finds that it is (how
/// surely is said there). If the residue finds a number zero, the enclosure becomes exactly zero as well. So more
/// digits decide every sign that is [`Sign::Undecided`] although [`Certified::is_nonzero`] holds.
///
/// Cost: that of both numbers.
#[derive(Debug, Clone, Copy)]
pub struct Certified<B> {
    enclosure: B,
    residue: Residue,
}

impl<B: Ordered> Certified<B> {
    /// The enclosure.
    pub fn enclosure(self) -> B {
        self.enclosure
    }

    /// The residue.
    pub fn residue(self) -> Residue {
        self.residue
    }

    /// Whether the number is proved to differ from zero.
    pub fn is_nonzero(self) -> bool {
        self.residue.is_zero() == Some(false) || matches!(self.enclosure.sign(), Sign::Negative | Sign::Positive)
    }

    /// The number of a residue: zero, unknown (after a division by zero), or in the enclosure.
    #[inline]
    fn paired(residue: Residue, enclosure: impl FnOnce() -> B) -> Self {
        let enclosure = match residue.is_zero() {
            Some(false) => enclosure(),
            Some(true) => B::zero(),
            None => B::from_f64(f64::NAN),
        };
        Self { enclosure, residue }
    }
}

impl<B: Ordered> Real for Certified<B> {
    fn from_f64(value: f64) -> Self {
        Self { enclosure: B::from_f64(value), residue: Residue::from_f64(value) }
    }
}

impl<B: Ordered> Ordered for Certified<B> {
    fn sign(self) -> Sign {
        if self.residue.is_zero() == Some(true) { Sign::Zero } else { self.enclosure.sign() }
    }

    fn to_f64(self) -> f64 {
        self.enclosure.to_f64()
    }

    fn freeing<R>(work: impl FnOnce() -> R) -> R {
        B::freeing(work)
    }

    fn error(self) -> f64 {
        self.enclosure.error()
    }
}

impl<B: Ordered + Trigonometry> Trigonometry for Certified<B> {
    fn cos_sin(angle: f64) -> [Self; 2] {
        let ([cos, sin], residues) = (B::cos_sin(angle), Residue::cos_sin(angle));
        [Self { enclosure: cos, residue: residues[0] }, Self { enclosure: sin, residue: residues[1] }]
    }
}

impl<B: Ordered> Certified<B> {
    fn plus(self, other: Self) -> Self {
        Self::paired(self.residue + other.residue, || self.enclosure + other.enclosure)
    }

    fn minus(self, other: Self) -> Self {
        Self::paired(self.residue - other.residue, || self.enclosure - other.enclosure)
    }

    fn times(self, other: Self) -> Self {
        Self::paired(self.residue * other.residue, || self.enclosure * other.enclosure)
    }

    fn over(self, other: Self) -> Self {
        Self::paired(self.residue / other.residue, || self.enclosure / other.enclosure)
    }

    fn negated(self) -> Self {
        Self { enclosure: -self.enclosure, residue: -self.residue }
    }
}

operators!([B: Ordered] Certified<B>);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::{Ball, DoubleDouble, Interval};

    fn decisions<B: Ordered + Trigonometry>() -> [Sign; 6] {
        let number = Certified::<B>::from_f64;
        let angle = 0.7391;
        let [cos, sin] = Certified::<B>::cos_sin(angle);
        let [twice, _] = Certified::<B>::cos_sin(2.0 * angle);
        let third = number(1.0) / number(3.0);
        let nothing = number(1.0) / (third * number(3.0) - number(1.0));
        [
            (third * number(3.0) - number(1.0)).sign(),
            (cos * cos + sin * sin - number(1.0)).sign(),
            (twice - (number(2.0) * cos * cos - number(1.0))).sign(),
            (number(0.0) * nothing).sign(),
            (nothing + number(1.0)).sign(),
            (cos - sin).sign(),
        ]
    }

    #[test]
    fn identities_are_found_zero() {
        use Sign::{Positive, Undecided, Zero};
        let expected = [Zero, Zero, Zero, Undecided, Undecided, Positive];
        assert_eq!(decisions::<Ball>(), expected);
        assert_eq!(decisions::<Ball<DoubleDouble>>(), expected);
        assert_eq!(Interval::scope(200, decisions::<Interval>), expected);
    }

    #[test]
    fn more_digits_decide_what_is_not_zero() {
        fn off<B: Ordered + Trigonometry>() -> (Sign, bool) {
            let off = Certified::<B>::cos_sin(std::f64::consts::FRAC_PI_3)[0] - Certified::from_f64(0.5);
            (off.sign(), off.is_nonzero())
        }
        // The f64 next to a third of pi lies above it by 1e-16.
        assert_eq!(off::<Ball>(), (Sign::Undecided, true));
        assert_eq!(off::<Ball<DoubleDouble>>(), (Sign::Negative, true));
        assert_eq!(Interval::scope(40, off::<Interval>), (Sign::Undecided, true));
        assert_eq!(Interval::scope(200, off::<Interval>), (Sign::Negative, true));
    }

    #[test]
    fn products_with_a_certified_zero_are_zero() {
        let tiny = Certified::<Ball>::from_f64(1.0) / Certified::from_f64(3.0);
        let hidden = tiny * tiny * Certified::from_f64(9.0) - Certified::from_f64(1.0 - f64::EPSILON);
        let zero = tiny * Certified::from_f64(3.0) - Certified::one();
        assert_eq!((zero / hidden).sign(), Sign::Zero);
        assert_eq!((zero * hidden).enclosure(), Ball::zero());
    }
}
