//! The number types that the core runs on.
//!
//! From kinematics to the slacks of the modes, every algorithm is written once over [`Real`]. These algorithms neither
//! branch on a number nor take a root, so that a ball, a double-double or an interval runs the same code as `f64`. Only
//! the stage that turns numbers into signs inspects them.
//!
//! | Number | Encloses | Cost of an operation |
//! | --- | --- | --- |
//! | `f64` | nothing | 1 |
//! | [`DoubleDouble`] | nothing; 106 bits | about 20 |
//! | [`Rounded`] | the exact result of its operations; overflow is noticed at the end | about 3 |
//! | [`Ball`] | the exact result of its operations, over f64 or [`DoubleDouble`] | about 5, or 30 |
//! | [`Interval`] | the exact result of its operations, with any number of bits | an allocation, about 100 |
//! | [`Residue`] | nothing; knows whether the exact result is zero | about 20; a quotient by a new divisor about 500 |
//! | [`Certified`] | an enclosure and a residue of the same number | both |
//! | [`Magnitude`] | nothing; the sum of the magnitudes of all terms of an `f64` | 1 |
//! | [`Affine`] | results for uncertain data, linear in N common causes | N |

/// Implements the operators of a number type by its methods `plus`, `minus`, `times`, `over` and `negated`.
macro_rules! operators {
    ([$($parameters:tt)*] $number:ty) => {
        operators!(@ [$($parameters)*] $number, Add add plus);
        operators!(@ [$($parameters)*] $number, Sub sub minus);
        operators!(@ [$($parameters)*] $number, Mul mul times);
        operators!(@ [$($parameters)*] $number, Div div over);
        impl<$($parameters)*> std::ops::Neg for $number {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                self.negated()
            }
        }
    };
    (@ [$($parameters:tt)*] $number:ty, $operator:ident $function:ident $method:ident) => {
        impl<$($parameters)*> std::ops::$operator for $number {
            type Output = Self;
            #[inline]
            fn $function(self, other: Self) -> Self {
                self.$method(other)
            }
        }
    };
}

mod double;
mod series;
mod rounded;
mod ball;
mod interval;
mod residue;
mod certified;
mod affine;
mod magnitude;

pub use affine::Affine;
pub use ball::Ball;
pub use certified::Certified;
pub use double::DoubleDouble;
pub(crate) use double::two_sum;
pub use interval::Interval;
pub use magnitude::{Magnitude, UNDERFLOW};
pub use residue::Residue;
pub use rounded::Rounded;

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number type of the core: `Copy`, with the four operations and negation. It represents every `f64` exactly.
///
/// A type that stores its numbers on the heap, such as [`Interval`], implements this by a `Copy` handle, so that the
/// algorithms need no borrows. `Default` only fills memory before its first use; its value is never read.
pub trait Real:
    Copy
    + Default
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The number that is exactly `value`.
    fn from_f64(value: f64) -> Self;

    /// Exactly 0.
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// Exactly 1.
    fn one() -> Self {
        Self::from_f64(1.0)
    }

    /// The product with exactly `factor`.
    #[inline]
    fn scaled(self, factor: f64) -> Self {
        Self::from_f64(factor) * self
    }
}

impl Real for f64 {
    fn from_f64(value: f64) -> Self {
        value
    }
}

/// The scalar product of two vectors of the same length.
pub fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (&a, &b)| sum + a * b)
}

/// Subtracts `factor` times `z` from `y`.
#[inline]
pub fn subtract<T: Real>(y: &mut [T], z: &[T], factor: T) {
    for (y, &z) in y.iter_mut().zip(z) {
        *y = *y - factor * z;
    }
}

/// The sign of a number that may be known inexactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sign {
    /// The number is negative.
    Negative,
    /// The number is exactly zero.
    Zero,
    /// The number is positive.
    Positive,
    /// The error bound does not exclude zero.
    Undecided,
}

impl Sign {
    /// The sign of a number with an absolute error of at most `error`.
    #[inline]
    pub fn within(number: f64, error: f64) -> Self {
        if number > error {
            Sign::Positive
        } else if number < -error {
            Sign::Negative
        } else if number == 0.0 && error == 0.0 {
            Sign::Zero
        } else {
            Sign::Undecided
        }
    }
}

/// A number with an error bound, whose sign is either proven or undecided.
pub trait Ordered: Real {
    /// The sign of the number; never guessed.
    fn sign(self) -> Sign;

    /// The nearest f64, or the closest one that the known digits give; NaN if nothing is known.
    fn to_f64(self) -> f64;

    /// Runs `work` and frees the storage of all numbers that it created. None of them may be used afterward.
    fn freeing<R>(work: impl FnOnce() -> R) -> R {
        work()
    }

    /// Runs `work` and frees the storage of the numbers that it created, except those that it returns.
    fn keeping<E>(work: impl FnOnce() -> Result<Vec<Self>, E>) -> Result<Vec<Self>, E> {
        work()
    }

    /// A bound of the distance from [`Ordered::to_f64`], apart from its rounding to f64; infinite if nothing is known.
    fn error(self) -> f64;
}

/// A number type with the cosine and sine of an f64 angle.
pub trait Trigonometry: Real {
    /// The cosine and sine of exactly the f64 `angle` \[rad\].
    fn cos_sin(angle: f64) -> [Self; 2];
}

impl Trigonometry for f64 {
    fn cos_sin(angle: f64) -> [Self; 2] {
        let (sin, cos) = libm::sincos(angle);
        [cos, sin]
    }
}

/// A number with an error bound that can be widened.
pub trait Enclosure: Ordered {
    /// The number with its error bound enlarged by at least the magnitude of `by`.
    fn widened(self, by: Self) -> Self;
}

/// A floating-point number that can be the center of a [`Ball`].
pub trait Midpoint: Real {
    /// The greatest relative error of a product or a quotient.
    const ROUNDING: f64;

    /// The nearest f64 and the remainder; their sum is the number.
    fn parts(self) -> [f64; 2];

    /// An upper bound of the absolute value.
    fn magnitude(self) -> f64 {
        self.parts()[0].abs()
    }

    /// A lower bound of the absolute value.
    fn least_magnitude(self) -> f64 {
        self.parts()[0].abs()
    }

    /// The sum and a bound of its error. The bound is accurate to a relative 2^-52, and zero if the sum is exact.
    fn sum(self, other: Self) -> (Self, f64);

    /// The sign of any number at most `radius` away from this one.
    fn sign_within(self, radius: f64) -> Sign {
        Sign::within(self.parts()[0], radius)
    }

    /// A bound of the error of a product that was rounded to this number. The last term covers underflow.
    fn rounding(self) -> f64 {
        self.magnitude() * Self::ROUNDING + f64::MIN_POSITIVE
    }

    /// A bound of the error of a quotient that was rounded to this number; the divisor is no smaller than `divisor`.
    fn quotient_rounding(self, _divisor: f64) -> f64 {
        self.rounding()
    }
}

#[cfg(test)]
mod tests {
    //! Tests of what all number types promise. The tests of a single type are in its file.

    use super::*;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    pub fn exact(value: f64) -> RBig {
        RBig::try_from(value).expect("finite")
    }

    pub fn magnitude(value: RBig) -> RBig {
        if value < RBig::ZERO { -value } else { value }
    }

    pub trait Bounded: Ordered + Trigonometry {
        /// The center and radius of the enclosure; `None` if nothing is known.
        fn bounds(self) -> Option<[RBig; 2]>;
    }

    impl<M: Midpoint> Bounded for Ball<M>
    where
        Self: Trigonometry,
    {
        fn bounds(self) -> Option<[RBig; 2]> {
            let [hi, lo] = self.mid.parts().map(exact);
            self.radius.is_finite().then(|| [hi + lo, exact(self.radius)])
        }
    }

    /// Checks that the operations on three numbers, each the sum of two f64, enclose the exact results.
    fn check<N: Bounded>(numbers: [[f64; 2]; 3]) -> Result<(), TestCaseError> {
        let [x, y, z] = numbers.map(|[hi, lo]| N::from_f64(hi) + N::from_f64(lo));
        let [p, q, r] = numbers.map(|[hi, lo]| exact(hi) + exact(lo));
        let mut results = vec![
            (x, p.clone()),
            (x * y + z, &p * &q + &r),
            (-(x + y) * (z - x), -(&p + &q) * (&r - &p)),
            (x * y - y * z, &p * &q - &q * &r),
        ];
        if q != RBig::ZERO {
            results.push((x * x / y, &p * &p / &q));
            results.push(((x + y) * (x + y) / y, (&p + &q) * (&p + &q) / &q));
        }
        if p != RBig::ZERO && q != RBig::ZERO {
            results.push((y / (x * y), RBig::ONE / &p));
        }
        if q != RBig::ZERO && r != RBig::ZERO && &p + &r != RBig::ZERO {
            let (quotient, truth) = ((x + z) / y / z, (&p + &r) / &q / &r);
            results.push((quotient * quotient - x, &truth * &truth - &p));
            results.push(((quotient - x) / (quotient * y), (&truth - &p) / (&truth * &q)));
            results.push((quotient, truth));
        }
        for (index, (found, truth)) in results.iter().enumerate() {
            let encloses = found.bounds().is_none_or(|[mid, radius]| magnitude(mid - truth) <= radius);
            prop_assert!(encloses, "result {index} of {numbers:?}");
        }
        Ok(())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]
        #[test]
        fn operations_enclose_exact_results(
            a in -1e3..1e3f64, b in -1e3..1e3f64, c in -1e-3..1e-3f64, d in -1e-15..1e-15f64,
            k in -300..300i32, bits in 20..400usize,
        ) {
            let scale = f64::from(k).exp2();
            check::<Ball>([[a, 0.0], [b * scale, 0.0], [c, 0.0]])?;
            let wide = [[a, d], [b * scale, d * scale], [c, d / 1e3]];
            check::<Ball<DoubleDouble>>(wide)?;
            Interval::scope(bits, || check::<Interval>(wide))?;
        }

        #[test]
        fn underflow_is_enclosed(a in 1.0..2.0f64, b in 1.0..2.0f64, i in -1074..100i32, j in -1074..100i32) {
            let numbers = [[libm::scalbn(a, i), 0.0], [libm::scalbn(b, j), 0.0], [0.0; 2]];
            check::<Ball>(numbers)?;
            check::<Ball<DoubleDouble>>(numbers)?;
        }
    }

    /// Asserts the signs that all number types must share; returns those of three identities and of a small number.
    fn signs<N: Ordered + Trigonometry>() -> ([Sign; 3], Sign) {
        let number = N::from_f64;
        let [zero, one, two, three] = [0.0, 1.0, 2.0, 3.0].map(number);
        let (third, [cos, sin]) = (one / three, N::cos_sin(0.7391));
        let nothing = one / (third * three - one);
        let [at_zero, at_infinity, at_nan] = [-0.0, f64::INFINITY, f64::NAN].map(N::cos_sin);
        let known = [number(0.5) - number(0.5), number(-0.0), zero * third, zero / third, -third, cos - sin];
        assert_eq!(
            known.map(N::sign),
            [Sign::Zero, Sign::Zero, Sign::Zero, Sign::Zero, Sign::Negative, Sign::Positive]
        );
        assert_eq!(at_zero.map(N::sign), [Sign::Positive, Sign::Zero]);
        let unknown = [nothing, nothing + one, one / zero, number(f64::NAN), number(f64::INFINITY)];
        assert!(unknown.iter().all(|number| number.to_f64().is_nan()));
        assert!(unknown.into_iter().chain(at_infinity).chain(at_nan).all(|number| number.sign() == Sign::Undecided));
        let identities =
            [third * three - one, cos * cos + sin * sin - one, N::cos_sin(1.4782)[0] - (two * cos * cos - one)];
        // The f64 next to a third of pi lies above it by 1e-16.
        let small = N::cos_sin(std::f64::consts::FRAC_PI_3)[0] - number(0.5);
        (identities.map(N::sign), small.sign())
    }

    #[test]
    fn signs_are_known_or_undecided() {
        use Sign::{Negative, Undecided, Zero};
        assert_eq!(signs::<Ball>(), ([Undecided; 3], Undecided));
        assert_eq!(signs::<Affine<1>>(), ([Undecided; 3], Undecided));
        assert_eq!(signs::<Ball<DoubleDouble>>(), ([Undecided; 3], Negative));
        assert_eq!(Interval::scope(40, signs::<Interval>), ([Undecided; 3], Undecided));
        assert_eq!(Interval::scope(200, signs::<Interval>), ([Undecided; 3], Negative));
        assert_eq!(signs::<Certified<Ball>>(), ([Zero; 3], Undecided));
        assert_eq!(signs::<Certified<Ball<DoubleDouble>>>(), ([Zero; 3], Negative));
        assert_eq!(Interval::scope(200, signs::<Certified<Interval>>), ([Zero; 3], Negative));
        let huge = [1e305, f64::MAX].map(Ball::<DoubleDouble>::from_f64);
        let overflown = [huge[0] * Real::one(), huge[1] + huge[1], huge[0] / huge[0]];
        assert_eq!(overflown.map(Ordered::sign), [Undecided; 3]);
    }

    #[test]
    fn sign_within_the_error_is_undecided() {
        assert_eq!([1e-3, -1e-3].map(|number| Sign::within(number, 1e-4)), [Sign::Positive, Sign::Negative]);
        assert_eq!([1e-5, 0.0, f64::NAN].map(|number| Sign::within(number, 1e-4)), [Sign::Undecided; 3]);
        assert_eq!([0.0, f64::NAN].map(|number| Sign::within(number, 0.0)), [Sign::Zero, Sign::Undecided]);
        assert_eq!(Sign::within(1.0, f64::INFINITY), Sign::Undecided);
    }
}
