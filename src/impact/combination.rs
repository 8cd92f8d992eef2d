//! One combination of modes, solved in numbers that know their own signs.

use super::enumerate::Tableau;
use super::linear::Unsettled;
use super::outcome::{Motion, Rejection};
use super::problem::ContactProblem;
use super::reading::{CombinationReading, motion, read_signed};
use super::singular::{SingularCase, solve_singular};
use super::slack::Scale;
use crate::law::Mode;
use crate::scalar::{Ordered, Sign};

/// The solution of a combination.
#[derive(Debug)]
pub enum Solved {
    /// Its equations have one solution.
    Regular {
        reading: CombinationReading,
        /// Sign of det A.
        index: i8,
        motion: Motion,
        /// How far it may be off, in the scale of margins.
        error: f64,
    },
    Singular(SingularCase),
}

impl Solved {
    /// How far an outcome's numbers may be off, in the scale of margins; `None` of a rejected combination.
    pub fn error(&self) -> Option<f64> {
        match self {
            Self::Regular { reading, error, .. } => (reading.sign != Sign::Negative).then_some(*error),
            Self::Singular(SingularCase::Valid(own)) => Some(own.error),
            Self::Singular(SingularCase::Family([one, other])) => Some(one.error.max(other.error)),
            Self::Singular(SingularCase::Rejected(_)) => None,
        }
    }

    /// Whether some number of a rejected combination is not finite.
    pub fn is_vague(&self) -> bool {
        let (motion, margin) = match self {
            Self::Regular { reading, motion, .. } => (Some(motion), reading.margin),
            Self::Singular(SingularCase::Rejected(Rejection { margin, motion, .. })) => (motion.as_ref(), *margin),
            Self::Singular(_) => return false,
        };
        !(motion.is_none_or(Motion::is_finite) && margin.is_none_or(f64::is_finite))
    }
}

/// A problem in these numbers and its elimination.
pub struct CombinationSolver<'e, T> {
    exact: &'e ContactProblem<T>,
    tableau: Tableau<T>,
}

impl<'e, T: Ordered> CombinationSolver<'e, T> {
    pub fn new(exact: &'e ContactProblem<T>) -> Self {
        let mut tableau = Tableau::<T>::default();
        tableau.load(exact);
        Self { exact, tableau }
    }

    /// Solves a combination; `problem` is the same in f64.
    pub fn solve(&mut self, modes: &[Mode], problem: &ContactProblem, scale: &Scale) -> Result<Solved, Unsettled> {
        T::freeing(|| {
            let leaf = self.tableau.leaf(modes);
            let mut index = 1;
            for &pivot in leaf.pivots {
                match pivot.sign() {
                    Sign::Undecided => return Err(Unsettled),
                    Sign::Zero => return solve_singular(self.exact, problem, scale, modes).map(Solved::Singular),
                    Sign::Negative => index = -index,
                    Sign::Positive => {}
                }
            }
            let reading = read_signed(&leaf, modes, problem, scale);
            if reading.sign == Sign::Undecided {
                return Err(Unsettled);
            }
            let contacts = 0..modes.len();
            let velocity = contacts.clone().flat_map(|contact| leaf.velocity(contact));
            let error = scale.error(velocity, contacts.flat_map(|contact| leaf.impulse(contact)));
            Ok(Solved::Regular { reading, index, motion: motion(&leaf, modes, problem, T::to_f64), error })
        })
    }
}
