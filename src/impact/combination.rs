//! Solves one combination of modes in numbers with error bounds.

use super::digits::{Numbers, after};
use super::enumerate::Tableau;
use super::linear::Unsettled;
use super::outcome::{Motion, Rejection};
use super::problem::ContactProblem;
use super::reading::{motion, read};
use super::singular::{Equations, Solved};
use super::slack::{Scale, slacks};
use crate::law::Mode;
use crate::planar::Pair;
use crate::scalar::{Ordered, Sign};

impl Solved {
    /// Whether the numbers of the outcome have the promised digits; true if there is no outcome yet.
    pub fn is_precise(&self) -> bool {
        match self {
            Self::Outcome(outcome) => outcome.numbers.are_precise,
            Self::Rejected(_) | Self::Family(()) => true,
        }
    }

    /// Whether the combination is rejected, but its reason is provisional or a number is not finite.
    pub fn is_provisional(&self) -> bool {
        match self {
            Self::Rejected(Rejection { margin, motion, .. }) => {
                !(motion.as_ref().is_none_or(Motion::is_finite) && margin.is_none_or(f64::is_finite))
            }
            Self::Outcome(_) | Self::Family(()) => false,
        }
    }
}

/// A problem in numbers of type `T`, ready to solve its combinations.
pub struct CombinationSolver<'e, T> {
    exact: &'e ContactProblem<T>,
    /// The scale of these numbers; if they are balls around the f64 problem, the f64 scale with its errors.
    scale: Scale,
    tableau: Tableau<T>,
}

impl<'e, T: Ordered> CombinationSolver<'e, T> {
    pub fn new(exact: &'e ContactProblem<T>, scale: Scale) -> Self {
        let mut tableau = Tableau::<T>::default();
        tableau.load(exact);
        Self { exact, scale, tableau }
    }

    pub fn solve(&mut self, modes: &[Mode]) -> Result<Solved, Unsettled> {
        let Self { exact, scale, tableau } = self;
        T::freeing(|| {
            let equations = Equations::of(exact, scale, modes);
            let singular = || {
                Ok(match equations.solve()? {
                    Solved::Rejected(rejection) => Solved::Rejected(rejection),
                    Solved::Outcome(outcome) => Solved::Outcome(outcome),
                    Solved::Family(_) => Solved::Family(()),
                })
            };
            if equations.are_shared() {
                return singular();
            }
            let mut index = 1;
            let ends = |pivot: T| {
                let sign = pivot.sign();
                index *= if sign == Sign::Negative { -1 } else { 1 };
                matches!(sign, Sign::Undecided | Sign::Zero).then_some(sign)
            };
            let leaf = match tableau.leaf_unless(modes, ends) {
                Ok(leaf) => leaf,
                Err(Sign::Zero) => return singular(),
                Err(_) => return Err(Unsettled),
            };
            let reading = read(&leaf, modes, exact.laws(), scale, Vec::new());
            if reading.sign == Sign::Undecided {
                return Err(Unsettled);
            }
            if reading.sign == Sign::Negative {
                let after = |contact, xi| after(xi, contact, modes, exact).map(T::to_f64);
                let motion = || motion(&leaf, after, Motion::default());
                return Ok(Solved::Rejected(Rejection::read(modes, reading, motion)));
            }
            let [impulse, velocity]: [Vec<Pair<T>>; 2] = [
                (0..modes.len()).map(|contact| leaf.impulse(contact)).collect(),
                (0..modes.len()).map(|contact| leaf.velocity(contact)).collect(),
            ];
            let mut numbers = Numbers::of((exact, scale), modes, &impulse, &velocity);
            slacks(&leaf, modes, exact.laws(), |slack| {
                let error = scale.scaled(&slack, slack.number.error());
                numbers.are_precise &= error <= scale.digits() * reading.margin.unwrap_or(0.0).max(1.0);
            });
            Ok(Solved::Outcome(reading.solution(modes.to_vec(), index, numbers)))
        })
    }
}
