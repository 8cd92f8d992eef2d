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

/// Reads a leaf's f64 numbers, known to `bound`; unless `complete`, up to the first violation.
pub fn read_f64(
    leaf: &Leaf<'_, f64>,
    modes: &[Mode],
    problem: &ContactProblem,
    scale: &Scale,
    bound: &Bound,
    complete: bool,
) -> CombinationReading {
    let (velocity, impulse) = (bound.velocity_error(), bound.impulse_error());
    let speed = |contact: usize, c_t: f64| Sign::within(c_t / scale.speed / scale.mobility[2 * contact], velocity);
    read(leaf, modes, problem.laws(), complete, speed, |slack| {
        let scaled = scale.scaled(slack, slack.number);
        (Sign::within(scaled, if slack.condition.inequality.is_strict() { velocity } else { impulse }), scaled)
    })
}

/// Reads a leaf whose numbers know their own sign.
pub fn read_signed<T: Ordered>(leaf: &Leaf<'_, T>, modes: &[Mode], laws: &[Law], scale: &Scale) -> CombinationReading {
    let scaled = |slack: &Slack<T>| scale.scaled(slack, slack.number.to_f64());
    read(leaf, modes, laws, true, |_, c_t| c_t.sign(), |slack| (slack.number.sign(), scaled(slack)))
}

/// The signs of all slacks, and of the frictionless contacts' equality c_t = 0, as one.
fn read<T: Real>(
    leaf: &Leaf<'_, T>,
    modes: &[Mode],
    laws: &[Law],
    complete: bool,
    speed: impl Fn(usize, T) -> Sign,
    slack: impl Fn(&Slack<T>) -> (Sign, f64),
) -> CombinationReading {
    let mut reading = CombinationReading {
        sign: Sign::Positive,
        because: RejectionReason::NoSolution,
        margin: None,
        at_zero: Vec::new(),
    };
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
    let mut done = false;
    slacks(leaf, modes, laws, |entry| {
        if done {
            return;
        }
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
            done = !complete;
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

/// Impulses and velocities of a leaf.
pub fn motion<T: Real>(
    leaf: &Leaf<'_, T>,
    modes: &[Mode],
    problem: &ContactProblem<T>,
    nearest: impl Fn(T) -> f64,
) -> Motion {
    let contacts = 0..problem.contacts();
    let velocity = |contact: usize| after(leaf.velocity(contact), contact, modes, problem).map(&nearest);
    Motion {
        impulse: contacts.clone().map(|contact| leaf.impulse(contact).map(&nearest)).collect(),
        velocity_after: contacts.map(velocity).collect(),
    }
}
