//! The signs of all inequalities of a combination as one.

use super::bound::Bound;
use super::digits::after;
use super::enumerate::Leaf;
use super::outcome::{Motion, Rejection, RejectionReason};
use super::problem::ContactProblem;
use super::slack::{Scale, Slack, slacks};
use crate::law::{Inequality, Law, Mode};
use crate::scalar::{Ordered, Real, Sign};

/// What the slacks of a combination say.
#[derive(Debug)]
pub struct CombinationReading {
    /// Valid, rejected or undecided; never zero.
    pub sign: Sign,
    pub because: RejectionReason,
    /// The smallest slack, free of units.
    pub margin: Option<f64>,
    /// The impulse inequalities that are exactly zero, by contact.
    pub at_zero: Vec<(usize, Inequality)>,
}

impl Rejection {
    /// Of a combination whose reading is negative; `motion` is not asked for if two equations contradict each other.
    pub fn read(modes: &[Mode], reading: CombinationReading, motion: impl FnOnce() -> Motion) -> Self {
        let solved = !matches!(reading.because, RejectionReason::NothingHolds { .. });
        let motion = solved.then(motion);
        Self { margin: reading.margin, motion, ..Self::of(modes, reading.because) }
    }
}

/// Reads signs from a leaf's f64 numbers, known to a bound.
pub struct F64Reader<'a> {
    problem: &'a ContactProblem,
    scale: &'a Scale,
    /// What scaled velocities and impulses may be off by.
    velocity: f64,
    impulse: f64,
    /// Bits of the numbers that are exactly zero, two of each contact.
    still: u32,
}

impl<'a> F64Reader<'a> {
    pub fn new(problem: &'a ContactProblem, scale: &'a Scale, bound: &Bound) -> Self {
        let [velocity, impulse] = [bound.velocity_error(), bound.impulse_error()];
        Self { problem, scale, velocity, impulse, still: bound.still }
    }

    /// Whether the first wrong sign is found, with which most combinations are done.
    pub fn rejects(&self, leaf: &Leaf<'_, f64>, modes: &[Mode]) -> bool {
        modes.iter().zip(self.problem.laws()).enumerate().any(|(contact, (&mode, law))| {
            let numbers = leaf.numbers(contact);
            let mut wrong =
                law.is_unheld(mode) && matches!(self.speed(contact, numbers[0]), Sign::Positive | Sign::Negative);
            law.conditions(mode, |condition| {
                wrong = wrong || {
                    let number = condition.function.at(|which| numbers[which], std::convert::identity);
                    match self.sign(&Slack { contact, condition, number }).0 {
                        Sign::Zero => condition.inequality.is_strict(),
                        sign => sign == Sign::Negative,
                    }
                };
            });
            wrong
        })
    }

    /// The reading of a leaf as `modes`; `at_zero` is empty memory.
    pub fn read(&self, leaf: &Leaf<'_, f64>, modes: &[Mode], at_zero: Vec<(usize, Inequality)>) -> CombinationReading {
        let speed = |contact: usize, c_t: f64| self.speed(contact, c_t);
        read(leaf, modes, self.problem.laws(), at_zero, speed, |slack| self.sign(slack))
    }

    #[inline]
    fn speed(&self, contact: usize, c_t: f64) -> Sign {
        if self.is_still(contact, 0b01) {
            return Sign::Zero;
        }
        Sign::within(c_t / self.scale.speed / self.scale.mobility[2 * contact], self.velocity)
    }

    fn is_still(&self, contact: usize, numbers: u32) -> bool {
        let numbers = numbers << (2 * contact);
        self.still & numbers == numbers
    }

    /// The sign and the value of a slack, free of units.
    #[inline]
    fn sign(&self, slack: &Slack<f64>) -> (Sign, f64) {
        if self.is_still(slack.contact, slack.condition.function.numbers()) {
            return (Sign::Zero, 0.0);
        }
        let scaled = self.scale.scaled(slack, slack.number);
        (
            Sign::within(scaled, if slack.condition.inequality.is_strict() { self.velocity } else { self.impulse }),
            scaled,
        )
    }
}

/// Reads a leaf whose numbers know their own sign.
pub fn read_signed<T: Ordered>(leaf: &Leaf<'_, T>, modes: &[Mode], laws: &[Law], scale: &Scale) -> CombinationReading {
    let scaled = |slack: &Slack<T>| scale.scaled(slack, slack.number.to_f64());
    read(leaf, modes, laws, Vec::new(), |_, c_t| c_t.sign(), |slack| (slack.number.sign(), scaled(slack)))
}

/// The signs of all slacks, and of the frictionless contacts' equality c_t = 0, as one.
fn read<T: Real>(
    leaf: &Leaf<'_, T>,
    modes: &[Mode],
    laws: &[Law],
    at_zero: Vec<(usize, Inequality)>,
    speed: impl Fn(usize, T) -> Sign,
    slack: impl Fn(&Slack<T>) -> (Sign, f64),
) -> CombinationReading {
    let mut reading =
        CombinationReading { sign: Sign::Positive, because: RejectionReason::NoSolution, margin: None, at_zero };
    for (contact, (&mode, law)) in modes.iter().zip(laws).enumerate() {
        if law.is_unheld(mode) {
            match speed(contact, leaf.numbers(contact)[0]) {
                Sign::Zero => {}
                Sign::Undecided => reading.sign = Sign::Undecided,
                Sign::Positive | Sign::Negative => {
                    // Two equations for one impulse: no slack measures how far they are from agreeing.
                    let because = RejectionReason::NothingHolds { contact };
                    return CombinationReading { sign: Sign::Negative, because, ..reading };
                }
            }
        }
    }
    slacks(leaf, modes, laws, |entry| {
        let (sign, scaled) = slack(&entry);
        let (contact, inequality) = (entry.contact, entry.condition.inequality);
        let violated = match sign {
            Sign::Negative => Some(RejectionReason::Violated { contact, inequality }),
            Sign::Zero if inequality.is_strict() => Some(RejectionReason::OnBorder),
            _ => None,
        };
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

/// Impulses and velocities of a leaf, in the memory of others.
pub fn motion<T: Real>(
    leaf: &Leaf<'_, T>,
    modes: &[Mode],
    problem: &ContactProblem<T>,
    nearest: impl Fn(T) -> f64,
    Motion { mut impulse, mut velocity_after }: Motion,
) -> Motion {
    let contacts = 0..problem.contacts();
    impulse.clear();
    impulse.extend(contacts.clone().map(|contact| leaf.impulse(contact).map(&nearest)));
    let velocity = |contact: usize| after(leaf.velocity(contact), contact, modes, problem).map(&nearest);
    velocity_after.clear();
    velocity_after.extend(contacts.map(velocity));
    Motion { impulse, velocity_after }
}
