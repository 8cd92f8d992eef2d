//! Relations between the velocities of dependent contacts that hold whatever the impulses are.
//!
//! ```text
//!     z with G z = 0:    z . xi = z . xi_free   for all impulses
//! ```
//!
//! For example, toe and heel of a flat foot have the same tangential velocity. Combinations that contradict this are
//! excluded by the signs of z alone, before anything is solved.

use super::linear::{Unsettled, settled, solve};
use super::outcome::RejectionReason;
use super::problem::ContactProblem;
use crate::law::{Law, Mode};
use crate::scalar::Ordered;
use std::cmp::Ordering;

/// The relations of a basis of the kernel of G.
#[derive(Debug, Clone, Default)]
pub struct Kernel {
    pub relations: Vec<Relation>,
}

/// A relation between velocities: the sum of z_i xi_i is constant.
#[derive(Debug, Clone)]
pub struct Relation {
    /// The rows with nonzero z_i, and the sign of each z_i.
    pub terms: Vec<(usize, Ordering)>,
    pub constant: Ordering,
}

impl Kernel {
    /// The relations of contacts that share a tangential row; there may be others.
    pub fn of_shared(shared: &[Option<usize>]) -> Self {
        let relation = |(contact, &with): (usize, &Option<usize>)| {
            let terms = vec![(2 * with?, Ordering::Greater), (2 * contact, Ordering::Less)];
            Some(Relation { terms, constant: Ordering::Equal })
        };
        Self { relations: shared.iter().enumerate().filter_map(relation).collect() }
    }

    pub fn of<T: Ordered>(problem: &ContactProblem<T>) -> Result<Self, Unsettled> {
        let count = 2 * problem.contacts();
        let rows =
            (0..count).map(|i| (0..count).map(|j| problem.delassus(i, j)).chain([T::zero()]).collect()).collect();
        let Some(solutions) = solve(count, rows)? else { return Ok(Self::default()) };
        let relation = |z: &Vec<T>| {
            let mut terms = Vec::new();
            let mut constant = T::zero();
            for (row, &entry) in z.iter().enumerate() {
                let sign = settled(entry)?;
                if sign.is_ne() {
                    terms.push((row, sign));
                    constant = constant + entry * problem.free_row(row);
                }
            }
            Ok(Relation { terms, constant: settled(constant)? })
        };
        Ok(Self { relations: solutions.directions.iter().map(relation).collect::<Result<_, _>>()? })
    }

    /// The reason why no outcome can have these modes; `None` if the kernel does not exclude them.
    pub fn excludes(&self, modes: &[Mode], laws: &[Law]) -> Option<RejectionReason> {
        let broken = self.relations.iter().find(|relation| relation.excludes(modes, laws))?;
        // If the constant is zero, the velocity belongs to other modes. Otherwise the equations contradict each other.
        Some(if broken.constant.is_eq() { RejectionReason::RedundantTwin } else { RejectionReason::NoSolution })
    }
}

impl Relation {
    fn excludes(&self, modes: &[Mode], laws: &[Law]) -> bool {
        let mut sum = Ordering::Equal;
        for &(row, sign) in &self.terms {
            let moves = match laws[row / 2].velocity(modes[row / 2])[row % 2] {
                None => return false,
                Some(Ordering::Equal) => continue,
                Some(moves) => moves,
            };
            let term = if moves == sign { Ordering::Greater } else { Ordering::Less };
            if sum.is_ne() && sum != term {
                return false;
            }
            sum = term;
        }
        sum != self.constant
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;
    use crate::scalar::{Ball, Certified, Real};

    #[test]
    fn toe_and_heel_slide_together() {
        // Mass 1, moment 1, contacts at (-1, -1) and (1, -1) from the CoG: c_t is the same for both.
        let rows = [[1.0, 0.0, -1.0], [0.0, 1.0, 1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0]];
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let delassus = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b)).collect::<Vec<_>>()).collect();
        let before = vec![[0.5, -1.0], [0.5, -2.0]];
        let problem = ContactProblem::new(delassus, before, vec![Friction::Infinite; 2], vec![0.0; 2]).unwrap();
        let kernel = Kernel::of(&problem.map(Certified::<Ball>::from_f64)).unwrap();
        let laws = problem.laws();
        use Mode::{Separate, SlideMinus, SlidePlus, Stick};
        for (modes, excluded) in [
            ([SlidePlus, SlidePlus], false),
            ([Stick, Stick], false),
            ([SlidePlus, SlideMinus], true),
            ([SlidePlus, Stick], true),
            ([Stick, SlideMinus], true),
            ([Separate, SlideMinus], false),
        ] {
            assert_eq!(kernel.excludes(&modes, laws).is_some(), excluded, "{modes:?}");
        }
        assert_eq!(kernel.excludes(&[SlidePlus, Stick], laws), Some(RejectionReason::RedundantTwin));
    }
}
