//! The passes over all combinations: first in f64, then with more digits those that need them.

use super::bound::LeafBounds;
use super::collected::{Collected, Pending};
use super::combination::CombinationSolver;
use super::enumerate::{Labels, Leaf, Tableau, Visitor};
use super::kernel::Kernel;
use super::outcome::Rejection;
use super::problem::{ContactProblem, Precision, PrecisionTask};
use super::reading::{motion, read_f64};
use crate::law::Impulse;
use crate::scalar::{Ordered, Sign};

/// Beyond this growth of rounding, f64 has lost the digits that an answer is expected to have.
const F64_SERVES: f64 = 1e4;

/// Combinations that are tried with many digits: more of many contacts take too long, and what is left is undecided.
const PRECISE_COMBINATIONS: usize = 2_000;

/// What an answer's numbers may be off by, in the scale of margins.
const DIGITS: f64 = 1e-12;

/// All combinations in f64.
pub struct F64Pass<'a, 'm> {
    pub bounds: &'m mut LeafBounds,
    pub labels: &'m mut Labels,
    /// Whether some modes with the same impulses are visited as one.
    pub shares: bool,
    /// Whether G was shown to be regular.
    pub regular: bool,
    /// What f64 does not decide.
    pub undecided: Vec<Pending>,
    /// Outcomes that f64 decides, but with few digits.
    pub coarse: Vec<Pending>,
    pub collected: Collected<'a>,
}

impl Visitor<f64> for F64Pass<'_, '_> {
    fn eliminated(&mut self, tableau: &Tableau<f64>, contact: usize, source: usize) {
        self.bounds.follow(tableau, contact, source);
    }

    fn leaf(&mut self, leaf: &Leaf<'_, f64>) {
        let Self { bounds, labels, shares, regular, undecided, coarse, collected } = self;
        let Collected { problem, scale, options, .. } = *collected;
        let bound = bounds.at(leaf.depth);
        // If every impulse is free, the pivots are those of the whole matrix.
        *regular |= bound.impulse_error().is_finite()
            && leaf.modes.iter().zip(problem.laws()).all(|(&mode, law)| law.impulse(mode) == Impulse::Free);
        labels.visit(leaf.modes, problem.laws(), *shares, |modes| {
            let number = collected.total;
            let pending = || Pending { number, modes: modes.to_vec() };
            let reading = read_f64(leaf, modes, problem, scale, bound, options.rejections.contain(modes));
            if reading.sign == Sign::Undecided {
                undecided.push(pending());
            } else {
                if reading.sign != Sign::Negative && bound.growth() > F64_SERVES {
                    coarse.push(pending());
                }
                let index = leaf.pivots.iter().fold(1, |sign, &pivot| if pivot < 0.0 { -sign } else { sign });
                let motion = || motion(leaf, modes, problem, |number| number);
                collected.add_regular(number, modes, reading, index, motion);
            }
            collected.total += 1;
        });
    }
}

/// Combinations whose signs need more digits than f64 has.
pub struct UndecidedPass<'a, 'c> {
    pub undecided: Vec<Pending>,
    /// Outcomes that were decided with fewer digits than an answer is expected to have.
    pub coarse: Vec<Pending>,
    pub collected: &'c mut Collected<'a>,
}

impl PrecisionTask for UndecidedPass<'_, '_> {
    fn attempt<T: Ordered>(&mut self, exact: &ContactProblem<T>, precision: Precision) -> bool {
        let mut solver = CombinationSolver::new(exact);
        let before = self.undecided.len();
        let Self { undecided, coarse, collected } = self;
        // What the contacts' dependence excludes is not solved for; if it cannot be shown, everything is.
        let kernel = T::freeing(|| Kernel::of(exact)).unwrap_or_default();
        let mut left = if precision == Precision::Interval { PRECISE_COMBINATIONS } else { usize::MAX };
        undecided.retain(|pending| {
            if let Some(because) = kernel.excludes(&pending.modes) {
                collected.reject(pending.number, &pending.modes, || Rejection::of(&pending.modes, because));
                return false;
            }
            if left == 0 {
                return true;
            }
            left -= 1;
            let Ok(solved) = solver.solve(&pending.modes, collected.problem, collected.scale) else { return true };
            let listed = collected.options.rejections.contain(&pending.modes);
            if listed && precision != Precision::Interval && solved.is_vague() {
                return true;
            }
            if solved.error().is_some_and(|error| error > DIGITS) {
                coarse.push(pending.clone());
            }
            collected.add(pending, solved);
            false
        });
        let effort = match precision {
            Precision::Ball => &mut collected.effort.ball,
            Precision::DoubleDouble => &mut collected.effort.double_double,
            Precision::Interval => &mut collected.effort.precise,
        };
        *effort += before - undecided.len();
        undecided.is_empty()
    }
}

/// Outcomes whose numbers need more digits.
pub struct CoarsePass<'a, 'c> {
    pub coarse: Vec<Pending>,
    pub collected: &'c mut Collected<'a>,
}

impl PrecisionTask for CoarsePass<'_, '_> {
    fn attempt<T: Ordered>(&mut self, exact: &ContactProblem<T>, _: Precision) -> bool {
        let mut solver = CombinationSolver::new(exact);
        let Self { coarse, collected } = self;
        coarse.retain(|pending| match solver.solve(&pending.modes, collected.problem, collected.scale) {
            Ok(solved) if solved.error().is_some_and(|error| error <= DIGITS) => {
                collected.remove(pending.number);
                collected.add(pending, solved);
                false
            }
            _ => true,
        });
        coarse.is_empty()
    }
}
