//! Enclosures that recognize an exact zero.

use super::{Ordered, Real, Residue, Sign, Trigonometry};

/// An enclosure together with the [`Residue`] of the same number.
///
/// The enclosure proves all signs except zero. The residue proves that a number is not zero, and shows that it is zero
/// with the certainty stated there. If the residue is zero, the enclosure becomes exactly zero as well. Thus every sign
/// that is [`Sign::Undecided`] although the residue is not zero can be decided with more digits.
#[derive(Debug, Clone, Copy, Default)]
pub struct Certified<B> {
    /// The enclosure of the number.
    pub enclosure: B,
    /// The residue of the number, which shows whether it is zero.
    pub residue: Residue,
}

impl<B: Ordered> Certified<B> {
    /// Pairs a residue with its enclosure: zero for a residue of zero, unknown after a division by zero.
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

    fn keeping<E>(work: impl FnOnce() -> Result<Vec<Self>, E>) -> Result<Vec<Self>, E> {
        let mut residues = Vec::new();
        let enclosures = B::keeping(|| {
            let kept = work()?;
            residues.extend(kept.iter().map(|number| number.residue));
            Ok(kept.into_iter().map(|number| number.enclosure).collect())
        })?;
        Ok(enclosures.into_iter().zip(residues).map(|(enclosure, residue)| Self { enclosure, residue }).collect())
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
    #[inline(never)]
    fn plus(self, other: Self) -> Self {
        if other.residue == Residue::ZERO {
            return self;
        }
        if self.residue == Residue::ZERO {
            return other;
        }
        Self::paired(self.residue + other.residue, || self.enclosure + other.enclosure)
    }

    #[inline(never)]
    fn minus(self, other: Self) -> Self {
        if other.residue == Residue::ZERO {
            return self;
        }
        Self::paired(self.residue - other.residue, || self.enclosure - other.enclosure)
    }

    #[inline(never)]
    fn times(self, other: Self) -> Self {
        let is_known = |number: Self| number.residue.is_zero().is_some();
        if self.residue == Residue::ZERO && is_known(other) || other.residue == Residue::ZERO && is_known(self) {
            return Self::zero();
        }
        Self::paired(self.residue * other.residue, || self.enclosure * other.enclosure)
    }

    #[inline(never)]
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
    use crate::scalar::Ball;

    #[test]
    fn residue_shows_what_the_enclosure_does_not() {
        let number = Certified::<Ball>::from_f64;
        let tiny = number(1.0) / number(3.0);
        let hidden = tiny * tiny * number(9.0) - number(1.0 - f64::EPSILON);
        assert_eq!((hidden.sign(), hidden.residue.is_zero()), (Sign::Undecided, Some(false)));
        let zero = tiny * number(3.0) - number(1.0);
        assert_eq!((zero / hidden).sign(), Sign::Zero);
        assert_eq!((zero * hidden).enclosure, Ball::zero());
    }
}
