//! The values that the variables of a relaxation may take.

use crate::law::{Impulse, Law, Mode};
use crate::planar::Pair;
use std::cmp::Ordering;

/// The signs that the value of a variable may have, besides zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Range {
    pub above_zero: bool,
    pub below_zero: bool,
}

impl Range {
    pub const FREE: Self = Self { above_zero: true, below_zero: true };
    pub const ABOVE: Self = Self { above_zero: true, below_zero: false };
    pub const BELOW: Self = Self { above_zero: false, below_zero: true };
    pub const ZERO: Self = Self { above_zero: false, below_zero: false };

    pub fn of(sign: Ordering) -> Self {
        match sign {
            Ordering::Greater => Self::ABOVE,
            Ordering::Equal => Self::ZERO,
            Ordering::Less => Self::BELOW,
        }
    }

    /// Whether the variable times a factor of this sign can never be negative.
    pub fn admits(self, factor: Ordering) -> bool {
        match factor {
            Ordering::Greater => !self.below_zero,
            Ordering::Equal => true,
            Ordering::Less => !self.above_zero,
        }
    }
}

/// The ranges of all variables as bits: up to 16 contacts with two velocities and at most two rays each.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Ranges {
    pub above_zero: u64,
    pub below_zero: u64,
    /// The velocities that must not be zero.
    pub moves: u64,
}

impl Ranges {
    pub fn get(self, variable: usize) -> Range {
        let is_in = |bits: u64| bits >> variable & 1 == 1;
        Range { above_zero: is_in(self.above_zero), below_zero: is_in(self.below_zero) }
    }

    pub fn set(&mut self, variable: usize, range: Range) {
        let put = |bits: u64, is_in: bool| bits & !(1 << variable) | u64::from(is_in) << variable;
        self.above_zero = put(self.above_zero, range.above_zero);
        self.below_zero = put(self.below_zero, range.below_zero);
    }

    /// These ranges with those of some `variables`, given as bits, replaced.
    pub fn replaced(self, variables: u64, by: Self) -> Self {
        Self {
            above_zero: self.above_zero & !variables | by.above_zero,
            below_zero: self.below_zero & !variables | by.below_zero,
            moves: self.moves & !variables | by.moves,
        }
    }

    /// Whether this nogood allows the ranges `other`. It does if some variable may take the sign that makes its term of
    /// the contradiction negative. It also does if the contradiction needs one of the velocities `moves` to be nonzero
    /// and `other` requires none of them to be.
    pub fn allows(self, other: Self) -> bool {
        let admitted = self.above_zero & other.above_zero | self.below_zero & other.below_zero;
        admitted != 0 || self.moves != 0 && self.moves & other.moves == 0
    }
}

/// One ray of a contact's cone; its multiplier is a variable.
#[derive(Debug, Clone, Copy)]
pub struct Ray {
    pub contact: usize,
    pub entries: Pair<f64>,
    /// Whether the opposite ray is in the cone, too.
    pub both: bool,
}

impl Ray {
    pub fn all(laws: &[Law]) -> impl Iterator<Item = Self> {
        laws.iter().enumerate().flat_map(|(contact, law)| {
            law.rays().into_iter().map(move |(entries, both)| Self { contact, entries, both })
        })
    }

    /// The range of the ray's multiplier in a mode of its contact, or in any mode.
    pub fn range(&self, law: &Law, mode: Option<Mode>) -> Range {
        let full = if self.both { Range::FREE } else { Range::ABOVE };
        match mode.map(|mode| law.impulse(mode)) {
            None | Some(Impulse::Free) => full,
            Some(Impulse::Along([t, n])) if t * self.entries[1] == n * self.entries[0] => {
                let is_forward = t * self.entries[0] + n * self.entries[1] > 0.0;
                Range { above_zero: is_forward, below_zero: !is_forward && self.both }
            }
            Some(Impulse::Zero | Impulse::Along(_)) => Range::ZERO,
        }
    }
}
