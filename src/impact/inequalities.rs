//! The inequalities of all combinations as numbers without poles, to be followed along a parameter.
//!
//! ```text
//!     slack s = N / det A      N and det A are as smooth as the problem; s changes its sign at N = 0 and det A = 0
//! ```
//!
//! A set of outcomes changes only where some N passes zero. The numbers are f64 without error bounds: hints to search
//! by.
//!
//! Cost: that of the enumeration, 4^n combinations of n contacts.

use super::enumerate::{Labels, Leaf, Tableau};
use super::problem::{ContactProblem, Errors};
use super::slack::{Scale, slacks};
use crate::law::Impulse;

/// The inequalities of all combinations of one problem.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Inequalities {
    /// det A of each combination.
    pub determinants: Vec<f64>,
    /// N of every inequality, grouped by combination.
    pub numerators: Vec<f64>,
    /// Whether the slack of each inequality is zero up to rounding.
    pub negligible: Vec<bool>,
    /// The end of each combination's range in `numerators`.
    pub ends: Vec<usize>,
}

/// Memory that is reused from problem to problem.
#[derive(Debug, Clone, Default)]
pub struct InequalityScratch {
    tableau: Tableau<f64>,
    labels: Labels,
    scale: Scale,
}

impl Inequalities {
    /// Computes the inequalities of `problem`. Their order is always the same as long as each friction stays zero,
    /// finite or infinite. All numbers of a combination that is singular up to rounding are zero.
    pub fn of(problem: &ContactProblem, scratch: &mut InequalityScratch) -> Self {
        let InequalityScratch { tableau, labels, scale } = scratch;
        let (contacts, combinations) = (problem.contacts(), 1 << (2 * problem.contacts()));
        let mut all = Self::default();
        // With Coulomb friction a contact has eight inequalities over its four modes.
        all.numerators.reserve(2 * contacts * combinations);
        all.negligible.reserve(2 * contacts * combinations);
        all.determinants.reserve(combinations);
        all.ends.reserve(combinations);
        tableau.load(problem);
        scale.measure(problem, Errors::NONE);
        tableau.visit(&mut |leaf: &Leaf<'_, f64>| {
            let determinant = if is_singular(leaf, problem) { 0.0 } else { leaf.pivots.iter().product::<f64>() };
            labels.visit(leaf.modes, problem.laws(), true, |modes| {
                slacks(leaf, modes, problem.laws(), |slack| {
                    let scaled = scale.scaled(&slack, slack.number);
                    all.numerators.push(if determinant == 0.0 { 0.0 } else { slack.number * determinant });
                    all.negligible.push(determinant == 0.0 || scaled.abs() < NEGLIGIBLE);
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
fn is_singular(leaf: &Leaf<'_, f64>, problem: &ContactProblem) -> bool {
    (0..problem.contacts()).any(|contact| {
        let entry = |row: usize, column: usize| problem.delassus(2 * contact + row, 2 * contact + column);
        let size = match problem.laws()[contact].impulse(leaf.modes[contact]) {
            Impulse::Zero => return false,
            Impulse::Along([t, n]) => t.abs() * entry(0, 1).abs() + n * entry(1, 1),
            Impulse::Free => entry(0, 0) * entry(1, 1),
        };
        leaf.pivots[contact].abs() <= SINGULAR * size
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
                let all = Inequalities::of(&problem, &mut InequalityScratch::default());
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
