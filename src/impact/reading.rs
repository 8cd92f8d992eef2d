//! Combines the signs of all inequalities of a combination into one.

use super::digits::{Numbers, Solution};
use super::enumerate::Leaf;
use super::outcome::{Motion, Rejection, RejectionReason};
use super::slack::{Scale, slacks};
use crate::law::{Inequality, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, Sign};

/// The result of reading all slacks of a combination.
#[derive(Debug)]
pub struct CombinationReading {
    /// Positive if the combination is valid, negative if it is rejected, or undecided; never zero.
    pub sign: Sign,
    pub because: RejectionReason,
    /// The smallest slack, free of units.
    pub margin: Option<f64>,
    /// The impulse inequalities that are exactly zero, by contact.
    pub at_zero: Vec<(usize, Inequality)>,
    /// Whether some sign is undecided.
    is_open: bool,
}

impl CombinationReading {
    /// The outcome of a valid combination; `index` is the sign of det A.
    pub fn solution(self, modes: Vec<Mode>, index: i8, numbers: Numbers) -> Solution {
        let (index, margin) = (self.at_zero.is_empty().then_some(index), self.margin.map(|margin| margin + 0.0));
        Solution { modes, numbers, index, margin, range: None, at_zero: self.at_zero }
    }

    /// Whether the combination is rejected because it lies on a border, although it may also violate an inequality.
    pub fn is_provisional(&self) -> bool {
        self.is_open && self.because == RejectionReason::OnBorder
    }
}

impl Rejection {
    /// The rejection of a combination whose reading is negative; no `motion` solves contradictory equations.
    pub(super) fn read(modes: &[Mode], reading: CombinationReading, motion: impl FnOnce() -> Motion) -> Self {
        let solved = !matches!(reading.because, RejectionReason::NothingHolds { .. });
        let is_provisional = reading.is_provisional();
        let rejection =
            Self { margin: reading.margin, motion: solved.then(motion), ..Self::of(modes, reading.because) };
        if is_provisional { rejection.provisional() } else { rejection }
    }
}

/// Whether the two numbers of a contact have a wrong sign for its mode. This quick test rejects most combinations.
#[inline]
pub fn rejects<T: Ordered>(numbers: &Pair<T>, mode: Mode, law: &Law) -> bool {
    let mut wrong = law.is_unheld(mode) && matches!(numbers[0].sign(), Sign::Positive | Sign::Negative);
    law.conditions(mode, |inequality, function| {
        let sign = function.at(|which| numbers[which], |mu, impulse| impulse.scaled(mu)).sign();
        wrong |= sign == Sign::Negative || sign == Sign::Zero && inequality.is_strict();
    });
    wrong
}

/// Reads the signs of all slacks, and of c_t = 0 at frictionless contacts that stick; `at_zero` is empty memory.
pub fn read<T: Ordered>(
    leaf: &Leaf<'_, T>,
    modes: &[Mode],
    laws: &[Law],
    scale: &Scale,
    at_zero: Vec<(usize, Inequality)>,
) -> CombinationReading {
    let because = RejectionReason::NoSolution;
    let mut reading = CombinationReading { sign: Sign::Positive, because, margin: None, at_zero, is_open: false };
    for (contact, (&mode, law)) in modes.iter().zip(laws).enumerate() {
        if law.is_unheld(mode) {
            match leaf.numbers(contact)[0].sign() {
                Sign::Zero => {}
                Sign::Undecided => (reading.sign, reading.is_open) = (Sign::Undecided, true),
                Sign::Positive | Sign::Negative => {
                    // Two equations for one impulse: no slack measures how far they are from being compatible.
                    let because = RejectionReason::NothingHolds { contact };
                    return CombinationReading { sign: Sign::Negative, because, ..reading };
                }
            }
        }
    }
    slacks(leaf, modes, laws, |entry| {
        let (sign, scaled) = (entry.number.sign(), scale.scaled(&entry, entry.number.to_f64()));
        let (contact, inequality) = (entry.contact, entry.inequality);
        let violated = match sign {
            Sign::Negative => Some(RejectionReason::Violated { contact, inequality }),
            Sign::Zero if inequality.is_strict() => Some(RejectionReason::OnBorder),
            _ => None,
        };
        reading.is_open |= sign == Sign::Undecided;
        let least = reading.margin.is_none_or(|margin| scaled < margin);
        if let Some(because) = violated {
            if reading.sign != Sign::Negative || least {
                reading.because = because;
            }
            reading.sign = Sign::Negative;
        } else if sign == Sign::Undecided && reading.sign == Sign::Positive {
            reading.sign = Sign::Undecided;
        }
        if sign == Sign::Zero && !reading.at_zero.contains(&(contact, inequality)) {
            reading.at_zero.push((contact, inequality));
        }
        if least {
            reading.margin = Some(scaled);
        }
    });
    reading
}

/// Impulses and velocities of a leaf as the nearest f64, in reused memory. `after` computes c+ of a contact from xi.
pub fn motion<T: Ordered>(
    leaf: &Leaf<'_, T>,
    after: impl Fn(usize, Pair<T>) -> Pair<f64>,
    Motion { mut impulse, mut velocity_after }: Motion,
) -> Motion {
    let contacts = 0..leaf.modes.len();
    impulse.clear();
    impulse.extend(contacts.clone().map(|contact| leaf.impulse(contact).map(T::to_f64)));
    velocity_after.clear();
    velocity_after.extend(contacts.map(|contact| after(contact, leaf.velocity(contact))));
    Motion { impulse, velocity_after }
}
