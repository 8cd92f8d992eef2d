//! Numbers modulo two primes, which show whether a number is exactly zero.

use super::{Real, Trigonometry};
use std::cell::Cell;

/// A number modulo two primes just below 2^61; points of a circle replace cosines and sines.
///
/// It shows whether a number that was computed from f64 and from cosines and sines of f64 angles is zero. All these
/// angles are multiples of one 2^-k, so such a number is a rational function R, with rational coefficients, of w = e^(i
/// 2^-k). By the theorem of Lindemann and Weierstrass w is transcendental, so R(w) is zero only if R is identically
/// zero. Here R is evaluated not at w but at a point of the circle x^2 + y^2 = 1 over a finite field. A nonzero residue
/// therefore proves that the number is not zero.
///
/// Zero modulo both primes proves that the number is zero, except for chance: a nonzero R would have to vanish at both
/// points, which are fixed but unrelated to any robot. For random points the probability is (degree of R / 2^59)^2,
/// about 2^-100 at a degree of a few hundred. (Coefficients that are all divisible by both primes are as unlikely.)
///
/// After a division by a residue of zero, nothing is known modulo that prime.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Residue([u64; 2]);

/// The primes are 2^61 - c for these c: the largest that are 3 modulo 8 and whose (p + 1) / 4 is prime, too. So -1 is
/// not a square, the circle has p + 1 points, and the order of a point is a divisor of 4, or 1, 2 or 4 times that
/// prime.
const FIRST: u64 = 11_029;
const SECOND: u64 = 13_669;

type FirstField = Modulus<61, FIRST>;
type SecondField = Modulus<61, SECOND>;
/// The orders (p + 1) / 4 = 2^59 - (c - 1) / 4 of the points that represent angles.
type FirstOrder = Modulus<59, { (FIRST - 1) / 4 }>;
type SecondOrder = Modulus<59, { (SECOND - 1) / 4 }>;

/// Marks an unknown residue.
const NONE: u64 = u64::MAX;

static FIRST_TABLES: Tables =
    FirstField::tables::<59, { (FIRST - 1) / 4 }>([0x243F_6A88_85A3_08D3, 0x1319_8A2E_0370_7344]);
static SECOND_TABLES: Tables =
    SecondField::tables::<59, { (SECOND - 1) / 4 }>([0xA409_3822_299F_31D0, 0x082E_FA98_EC4E_6C89]);

/// The powers of two are tabulated in steps of this many exponents.
const STEP: i32 = 32;
const STEPS: usize = 65;
/// The least tabulated exponent, below that of the least f64.
const LEAST: i32 = -1088;
/// The number of four-bit digits by which a multiple of the angle 1 is computed.
const DIGITS: usize = 15;

/// The numbers that were inverted last, with their inverses, at their remainders modulo [`KEPT`]. Eliminations divide
/// whole rows by the same pivot.
type Inverses = [Cell<(u64, u64)>; KEPT];

const KEPT: usize = 32;

thread_local! {
    static INVERSES: [Inverses; 2] = const { [const { [const { Cell::new((0, 0)) }; KEPT] }; 2] };
}

/// The constants of a prime.
struct Tables {
    /// 2^(LEAST + STEP i) modulo the prime and modulo the order of the points.
    powers: [[u64; 2]; STEPS],
    /// The point of the angle 1 to the power j 16^i.
    turns: [[[u64; 2]; 16]; DIGITS],
}

/// Arithmetic modulo 2^BITS - C, with a small C.
struct Modulus<const BITS: u32, const C: u64>;

impl<const BITS: u32, const C: u64> Modulus<BITS, C> {
    const PRIME: u64 = (1 << BITS) - C;
    const HALF: u64 = Self::PRIME.div_ceil(2);
    const MASK: u64 = (1 << BITS) - 1;

    /// Reduces a number below 2^(2 BITS + 1), using 2^BITS = C.
    #[inline]
    const fn reduced(number: u128) -> u64 {
        let folded = (number as u64 & Self::MASK) as u128 + (number >> BITS) * C as u128;
        let folded = (folded as u64 & Self::MASK) + (folded >> BITS) as u64 * C;
        if folded >= Self::PRIME { folded - Self::PRIME } else { folded }
    }

    #[inline]
    const fn times(a: u64, b: u64) -> u64 {
        Self::reduced(a as u128 * b as u128)
    }

    #[inline]
    const fn plus(a: u64, b: u64) -> u64 {
        let sum = a + b;
        if sum >= Self::PRIME { sum - Self::PRIME } else { sum }
    }

    const fn minus(a: u64, b: u64) -> u64 {
        if a >= b { a - b } else { a + Self::PRIME - b }
    }

    const fn power(base: u64, mut exponent: u64) -> u64 {
        let (mut result, mut square) = (1, base);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = Self::times(result, square);
            }
            square = Self::times(square, square);
            exponent >>= 1;
        }
        result
    }

    /// The inverse of a nonzero number, by Euclid's algorithm.
    fn inverse(number: u64) -> u64 {
        let (mut last, mut rest) = (Self::PRIME, number);
        // `factor * number` equals `rest` modulo the prime; no factor exceeds the prime.
        let (mut last_factor, mut factor) = (0i64, 1i64);
        while rest > 1 {
            let quotient = last / rest;
            (last, rest) = (rest, last - quotient * rest);
            (last_factor, factor) = (factor, last_factor - quotient as i64 * factor);
        }
        if factor < 0 { factor.wrapping_add(Self::PRIME as i64) as u64 } else { factor as u64 }
    }

    /// The product of two points of the circle, taken as complex numbers.
    #[inline]
    const fn turned([a, b]: [u64; 2], [c, d]: [u64; 2]) -> [u64; 2] {
        [
            Self::minus(Self::times(a, c), Self::times(b, d)),
            Self::reduced(a as u128 * d as u128 + b as u128 * c as u128),
        ]
    }

    /// The tables of the point ((a + ib)^2 / (a^2 + b^2))^4, where a and b are digits of pi.
    const fn tables<const ORDER_BITS: u32, const ORDER_C: u64>([a, b]: [u64; 2]) -> Tables {
        let least = LEAST.unsigned_abs() as u64;
        let order = Modulus::<ORDER_BITS, ORDER_C>::power(Modulus::<ORDER_BITS, ORDER_C>::HALF, least);
        let mut powers = [[Self::power(Self::HALF, least), order]; STEPS];
        let mut i = 1;
        while i < STEPS {
            let [last, order] = powers[i - 1];
            powers[i] = [Self::times(last, 1 << STEP), Modulus::<ORDER_BITS, ORDER_C>::times(order, 1 << STEP)];
            i += 1;
        }
        let (a, b) = (Self::reduced(a as u128), Self::reduced(b as u128));
        let [x, y] = Self::turned([a, b], [a, b]);
        let square = Self::reduced(a as u128 * a as u128 + b as u128 * b as u128);
        let inverse = Self::power(square, Self::PRIME - 2);
        let point = [Self::times(x, inverse), Self::times(y, inverse)];
        let twice = Self::turned(point, point);
        let mut point = Self::turned(twice, twice);
        let mut turns = [[[1, 0]; 16]; DIGITS];
        let mut i = 0;
        while i < DIGITS {
            let mut j = 1;
            while j < 16 {
                turns[i][j] = Self::turned(turns[i][j - 1], point);
                j += 1;
            }
            point = Self::turned(turns[i][15], point);
            i += 1;
        }
        Tables { powers, turns }
    }

    /// `value` modulo [`Self::PRIME`]; `part` selects the powers in `tables`: 0 modulo the prime, 1 modulo the order.
    #[inline]
    fn of(value: f64, tables: &Tables, part: usize) -> u64 {
        let (integer, exponent) = decomposed(value);
        let from_least = exponent - LEAST;
        let scaled = Self::reduced(u128::from(integer) << (from_least % STEP));
        let residue = Self::times(scaled, tables.powers[(from_least / STEP) as usize][part]);
        if value < 0.0 { Self::minus(0, residue) } else { residue }
    }

    /// The point of `multiple` times the angle 1.
    fn point(multiple: u64, tables: &Tables) -> [u64; 2] {
        let (mut point, mut rest) = ([1, 0], multiple);
        for digit in &tables.turns {
            point = Self::turned(point, digit[(rest & 15) as usize]);
            rest >>= 4;
        }
        point
    }

    fn over(a: u64, b: u64, inverses: &Inverses) -> u64 {
        if b == 0 {
            return NONE;
        }
        if a == 0 {
            return 0;
        }
        let kept = &inverses[b as usize % KEPT];
        let (number, mut inverse) = kept.get();
        if number != b {
            inverse = Self::inverse(b);
            kept.set((b, inverse));
        }
        Self::times(a, inverse)
    }
}

/// The integer and the binary exponent of a finite f64's magnitude.
fn decomposed(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let (fraction, exponent) = (bits & ((1 << 52) - 1), ((bits >> 52) & 0x7FF) as i32);
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

impl Residue {
    /// The residue of an unknown number.
    pub const UNDEFINED: Self = Self([NONE; 2]);

    /// The residue of the exact number zero.
    pub const ZERO: Self = Self([0; 2]);

    /// Whether the number is zero: proven if false, nearly certain if true; `None` after a division by zero.
    pub fn is_zero(self) -> Option<bool> {
        match self.0 {
            [0, 0] => Some(true),
            [0 | NONE, 0 | NONE] => None,
            _ => Some(false),
        }
    }
}

impl Real for Residue {
    fn from_f64(value: f64) -> Self {
        if value == 0.0 {
            return Self::ZERO;
        }
        if !value.is_finite() {
            return Self::UNDEFINED;
        }
        Self([FirstField::of(value, &FIRST_TABLES, 0), SecondField::of(value, &SECOND_TABLES, 0)])
    }
}

impl Trigonometry for Residue {
    /// The coordinates of an angle's point. The map to the circle is a homomorphism: it preserves relations of angles.
    fn cos_sin(angle: f64) -> [Self; 2] {
        if !angle.is_finite() {
            return [Self::UNDEFINED; 2];
        }
        if angle == 0.0 {
            return [Self::one(), Self::ZERO];
        }
        let first = FirstField::point(FirstOrder::of(angle, &FIRST_TABLES, 1), &FIRST_TABLES);
        let second = SecondField::point(SecondOrder::of(angle, &SECOND_TABLES, 1), &SECOND_TABLES);
        [0, 1].map(|at| Self([first[at], second[at]]))
    }
}

impl Residue {
    /// Applies an operation modulo each prime for which both numbers are known.
    #[inline]
    fn by_prime(self, other: Self, first: impl FnOnce(u64, u64) -> u64, second: impl FnOnce(u64, u64) -> u64) -> Self {
        let ([a, b], [c, d]) = (self.0, other.0);
        let first = if a == NONE || c == NONE { NONE } else { first(a, c) };
        Self([first, if b == NONE || d == NONE { NONE } else { second(b, d) }])
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        self.by_prime(other, FirstField::plus, SecondField::plus)
    }

    fn minus(self, other: Self) -> Self {
        self.by_prime(other, FirstField::minus, SecondField::minus)
    }

    #[inline]
    fn times(self, other: Self) -> Self {
        self.by_prime(other, FirstField::times, SecondField::times)
    }

    fn over(self, other: Self) -> Self {
        INVERSES.with(|[first, second]| {
            self.by_prime(other, |a, b| FirstField::over(a, b, first), |a, b| SecondField::over(a, b, second))
        })
    }

    fn negated(self) -> Self {
        Self::ZERO - self
    }
}

operators!([] Residue);

#[cfg(test)]
mod tests {
    use super::super::tests::exact;
    use super::*;
    use dashu_int::fast_div::ConstDivisor;
    use dashu_ratio::RBig;
    use proptest::prelude::*;

    /// The primality test of Miller and Rabin, which is exact below 2^64 with these bases.
    fn is_prime(n: u64) -> bool {
        let (ring, twos) = (ConstDivisor::new(n.into()), (n - 1).trailing_zeros());
        [2u8, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37].into_iter().all(|base| {
            let first = ring.reduce(base).pow(&((n - 1) >> twos).into());
            let mut powers = std::iter::successors(Some(first.clone()), |power| Some(power.sqr())).take(twos as usize);
            first == ring.reduce(1) || powers.any(|power| power == ring.reduce(-1))
        })
    }

    #[test]
    fn primes_and_orders_are_as_stated() {
        for (prime, order) in [(FirstField::PRIME, FirstOrder::PRIME), (SecondField::PRIME, SecondOrder::PRIME)] {
            assert!(is_prime(prime) && is_prime(order) && !is_prime(prime - 2));
            assert_eq!((prime % 8, prime + 1), (3, 4 * order));
        }
        assert!([&FIRST_TABLES, &SECOND_TABLES].iter().all(|tables| tables.turns[0][1] != [1, 0]));
        assert_eq!(FirstField::point(FirstOrder::PRIME, &FIRST_TABLES), [1, 0]);
        assert_eq!(SecondField::point(SecondOrder::PRIME, &SECOND_TABLES), [1, 0]);
    }

    fn residue(number: &RBig) -> Residue {
        Residue([FirstField::PRIME, SecondField::PRIME].map(|prime| {
            let ring = ConstDivisor::new(prime.into());
            let quotient = ring.reduce(number.numerator().clone()) / ring.reduce(number.denominator().clone());
            u64::try_from(quotient.residue()).expect("reduced")
        }))
    }

    proptest! {
        #[test]
        fn every_f64_is_its_rational(value in any::<u64>().prop_map(f64::from_bits)) {
            prop_assume!(value.is_finite());
            prop_assert_eq!(Residue::from_f64(value), residue(&exact(value)));
        }

        #[test]
        fn operations_are_those_of_the_rationals(a in -1e9..1e9f64, b in -1e-9..1e-9f64) {
            let (x, y) = (Residue::from_f64(a), Residue::from_f64(b));
            let (p, q) = (exact(a), exact(b));
            prop_assert_eq!(x + y, residue(&(&p + &q)));
            prop_assert_eq!(x - y, residue(&(&p - &q)));
            prop_assert_eq!(-x, residue(&-&p));
            prop_assert_eq!(x * y, residue(&(&p * &q)));
            if b != 0.0 {
                prop_assert_eq!(x / y, residue(&(&p / &q)));
            }
        }

        #[test]
        fn angles_add_on_the_circle(a in any::<i32>(), b in any::<i32>(), k in -900..900i32) {
            let scale = f64::from(k).exp2();
            let (a, b) = (f64::from(a), f64::from(b));
            let [[ca, sa], [cb, sb]] = [a, b].map(|angle| Residue::cos_sin(angle * scale));
            let [c, s] = Residue::cos_sin((a + b) * scale);
            prop_assert_eq!(c, ca * cb - sa * sb);
            prop_assert_eq!(s, sa * cb + ca * sb);
            prop_assert_eq!(c * c + s * s, Residue::one());
            prop_assert_eq!(Residue::cos_sin(-a * scale), [ca, -sa]);
        }
    }

    #[test]
    fn quotients_by_zero_are_unknown() {
        let [one, zero] = Residue::cos_sin(0.0);
        assert_eq!((one, zero), (Residue::one(), Residue::zero()));
        let third = Residue::one() / Residue::from_f64(3.0);
        assert_eq!((third * Residue::from_f64(3.0) - one).is_zero(), Some(true));
        assert_eq!(third.is_zero(), Some(false));
        assert_eq!((third / zero).is_zero(), None);
        assert_eq!((third / zero * zero - one).is_zero(), None);
        assert_eq!(Residue([NONE, 5]).is_zero(), Some(false));
        assert_eq!(Residue([NONE, 0]).is_zero(), None);
        assert_eq!(Residue::from_f64(f64::INFINITY), Residue::UNDEFINED);
    }
}
