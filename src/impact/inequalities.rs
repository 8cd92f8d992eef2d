//! The inequalities of all combinations as numbers without poles, to be followed along a parameter.
//!
//! ```text
//!     slack s = N / det A      N and det A are as smooth as the problem; s changes its sign at N = 0 and det A = 0
//! ```
//!
//! A set of outcomes changes only where some N passes zero. The numbers only guide a search. Their error bounds show
//! which of them are only rounding, whose sign has no meaning; contacts that are close together make it large.
//!
//! Cost: that of the enumeration, 4^n combinations of n contacts.

use super::enumerate::{Labels, Leaf, Tableau};
use super::problem::{ContactProblem, Errors};
use super::slack::{Scale, slacks};
use crate::law::Impulse;
use crate::planar::Pair;
use crate::scalar::{Ordered, Rounded, Sign};

/// The inequalities of all combinations of one problem.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Inequalities {
    /// det A of each combination.
    pub determinants: Vec<f64>,
    /// N of every inequality, grouped by combination.
    pub numerators: Vec<f64>,
    /// Whether each inequality is within its error, so that its sign means nothing.
    pub rounding: Vec<bool>,
    /// Whether the slack of each inequality may be zero up to rounding and bad conditioning.
    pub negligible: Vec<bool>,
    /// The end of each combination's range in `numerators`.
    pub ends: Vec<usize>,
}

/// Memory that is reused from problem to problem.
#[derive(Debug, Clone, Default)]
pub struct InequalityScratch {
    tableau: Tableau<Rounded>,
    labels: Labels,
    scale: Scale,
    /// Estimated errors of c_free, if no bounds are known.
    estimated: Vec<Pair<f64>>,
}

impl Inequalities {
    /// Computes the inequalities of `problem`, whose numbers have these `errors`. Their order is always the same as
    /// long as each friction stays zero, finite or infinite. All numbers of a combination that is singular up to
    /// rounding are zero.
    pub fn of(problem: &ContactProblem, errors: Errors<'_>, scratch: &mut InequalityScratch) -> Self {
        let InequalityScratch { tableau, labels, scale, estimated } = scratch;
        let (contacts, combinations) = (problem.contacts(), 1 << (2 * problem.contacts()));
        let mut all = Self::default();
        // With Coulomb friction a contact has eight inequalities over its four modes.
        all.numerators.reserve(2 * contacts * combinations);
        all.rounding.reserve(2 * contacts * combinations);
        all.negligible.reserve(2 * contacts * combinations);
        all.determinants.reserve(combinations);
        all.ends.reserve(combinations);
        scale.measure(problem, Errors::NONE);
        let errors = if errors.delassus.is_finite() { errors } else { scale.estimate(estimated) };
        tableau.load_entries(problem.laws(), scale.delassus(problem, errors), scale.free(problem, errors));
        tableau.visit(&mut |leaf: &Leaf<'_, Rounded>| {
            let determinant = match is_singular(leaf, problem) {
                true => 0.0,
                false => leaf.pivots.iter().map(|pivot| pivot.value).product::<f64>(),
            };
            labels.visit(leaf.modes, problem.laws(), true, |modes| {
                slacks(leaf, modes, problem.laws(), |slack| {
                    let Rounded { value, .. } = slack.number;
                    let is_rounding = determinant == 0.0 || slack.number.sign() == Sign::Undecided;
                    all.numerators.push(if determinant == 0.0 { 0.0 } else { value * determinant });
                    all.rounding.push(is_rounding);
                    all.negligible.push(is_rounding || scale.scaled(&slack, value).abs() < NEGLIGIBLE);
                });
                all.determinants.push(determinant);
                all.ends.push(all.numerators.len());
            });
        });
        all
    }

    /// The range of the inequalities that belong to a combination, given by its number.
    pub fn of_combination(&self, combination: usize) -> std::ops::Range<usize> {
        combination.checked_sub(1).map_or(0, |before| self.ends[before])..self.ends[combination]
    }
}

/// A slack below this, free of units, may be a zero changed by rounding and bad conditioning.
const NEGLIGIBLE: f64 = 1e-10;

/// A pivot this small, relative to the terms of its difference, is zero up to rounding.
const SINGULAR: f64 = 1e-10;

/// Whether a pivot is zero up to rounding, because contacts depend on each other or an inequality is at a pole.
fn is_singular(leaf: &Leaf<'_, Rounded>, problem: &ContactProblem) -> bool {
    (0..problem.contacts()).any(|contact| {
        let entry = |row: usize, column: usize| problem.delassus(2 * contact + row, 2 * contact + column);
        let size = match problem.laws()[contact].impulse(leaf.modes[contact]) {
            Impulse::Zero => return false,
            Impulse::Along([t, n]) => t.abs() * entry(0, 1).abs() + n * entry(1, 1),
            Impulse::Free => entry(0, 0) * entry(1, 1),
        };
        let pivot = leaf.pivots[contact];
        pivot.sign() == Sign::Undecided || pivot.value.abs() <= SINGULAR * size
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::{ListedRejections, analyze};
    use crate::law::{Friction, Mode};

    #[test]
    fn valid_inequalities_have_the_determinants_sign() {
        // The paper's section 4: G = [[2, 1], [1, 2]].
        for mu in [Friction::Finite(0.4), Friction::Finite(6.0), Friction::Infinite] {
            for before in [[1.0, -1.0], [-3.0, -1.0], [0.5, 0.2], [2.5, -0.5]] {
                let problem = ContactProblem::new(vec![2.0, 1.0, 1.0, 2.0], vec![before], vec![mu], vec![0.0]).unwrap();
                let all = Inequalities::of(&problem, Errors::NONE, &mut InequalityScratch::default());
                let valid = |combination: &usize| {
                    let determinant = all.determinants[*combination];
                    all.numerators[all.of_combination(*combination)].iter().all(|number| number * determinant > 0.0)
                };
                let found: Vec<_> = (0..4).filter(valid).map(|combination| [Mode::ALL[combination]]).collect();
                let analysis = analyze(&problem, ListedRejections::Nothing).unwrap();
                let outcomes: Vec<_> = analysis.outcomes.into_iter().map(|outcome| outcome.modes).collect();
                assert_eq!(outcomes, found, "{mu} {before:?}");
            }
        }
    }
}
