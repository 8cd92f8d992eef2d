//! The rank and the condition number of the Delassus matrix.

use super::linear::solve;
use super::problem::{ContactProblem, Precision, PrecisionTask, Remembered, escalate};
use super::slack::Scale;
use crate::reductions::Reductions;
use crate::scalar::Ordered;
use nalgebra::DMatrix;

/// The rank of G and, if G is regular, its condition number at a unit diagonal; `None` if no precision, within the
/// budget, shows the rank.
pub fn rank_and_condition(
    problem: &ContactProblem,
    remembered: &Remembered<'_>,
    scale: &Scale,
    regular: bool,
    reductions: Reductions,
) -> Option<(usize, Option<f64>)> {
    let rows = 2 * problem.contacts();
    if rows == 0 {
        return Some((0, None));
    }
    let (mobility, source) = (&scale.mobility, remembered.source);
    let scaled = |i: usize, j: usize| problem.delassus(i, j) / (mobility[i] * mobility[j]);
    let is_kept = |row: &usize| row % 2 == 1 || source.shared_tangent(row / 2).is_none();
    let kept: Vec<usize> = (0..rows).filter(is_kept).collect();
    let without_shared = || DMatrix::from_fn(kept.len(), kept.len(), |i, j| scaled(kept[i], kept[j]));
    if kept.len() < rows && scale.is_far_from_underflow() && is_definite(without_shared(), source.errors().delassus) {
        return Some((kept.len(), None));
    }
    let [least, greatest] = if problem.contacts() == 1 && reductions.lone {
        // G of a single contact scaled to a unit diagonal: [[1, r], [r, 1]].
        let coupling = scaled(0, 1).abs();
        [1.0 - coupling, 1.0 + coupling]
    } else {
        let values = DMatrix::from_fn(rows, rows, scaled).symmetric_eigenvalues();
        [values.min(), values.max()]
    };
    if regular && greatest < F64_CONDITION_LIMIT * least {
        return Some((rows, Some(greatest / least)));
    }
    let mut inverse = Inverse { mobility: mobility.clone(), ..Inverse::default() };
    escalate(remembered, Precision::Ball, &mut inverse);
    let rank = inverse.rank?;
    if rank < rows {
        return Some((rank, None));
    }
    let inverse = DMatrix::from_fn(rows, rows, |i, j| 0.5 * (inverse.rows[i][j] + inverse.rows[j][i]));
    let condition = greatest * inverse.symmetric_eigenvalues().max();
    Some((rank, condition.is_finite().then_some(condition)))
}

/// The least eigenvalue of a regular scaled G.
pub const REGULAR: f64 = 1e-6;

/// Whether f64 shows that a symmetric matrix with a unit diagonal, whose entries may be off by `errors`, has no
/// eigenvalue below half of [`REGULAR`]: a Cholesky factor exists only if rounding hides no negative eigenvalue (Rump
/// 2006).
pub fn is_definite(matrix: DMatrix<f64>, errors: f64) -> bool {
    let rows = matrix.nrows();
    rows as f64 * (errors + rows as f64 * f64::EPSILON) < 0.5 * REGULAR
        && (matrix - DMatrix::identity(rows, rows) * REGULAR).cholesky().is_some()
}

/// At a larger condition number the least eigenvalue of G has lost half of its digits.
const F64_CONDITION_LIMIT: f64 = 1e8;

/// The rank of G and, if G is regular, the inverse of the scaled G.
#[derive(Debug, Default)]
struct Inverse {
    /// The rank; `None` if no precision shows it.
    rank: Option<usize>,
    /// Rows of the inverse of G scaled to a unit diagonal.
    rows: Vec<Vec<f64>>,
    /// sqrt(G_ii).
    mobility: Vec<f64>,
}

impl PrecisionTask for Inverse {
    fn attempt<T: Ordered>(&mut self, problem: &ContactProblem<T>, _: Precision) -> bool {
        let count = 2 * problem.contacts();
        let equations = |right: Option<usize>| -> Vec<Vec<T>> {
            let one = |i: usize| if right == Some(i) { T::one() } else { T::zero() };
            let row = |i: usize| (0..count).map(|j| problem.delassus(i, j)).chain([one(i)]).collect();
            (0..count).map(row).collect()
        };
        let Ok(Some(kernel)) = solve(count, equations(None)) else { return false };
        let rank = count - kernel.directions.len();
        if rank == count {
            let columns = (0..count).map(|column| Some(solve(count, equations(Some(column))).ok()??.origin));
            let Some(columns) = columns.collect::<Option<Vec<Vec<T>>>>() else { return false };
            let entry = |i: usize, j: usize| columns[j][i].to_f64() * self.mobility[i] * self.mobility[j];
            self.rows = (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect();
        }
        self.rank = Some(rank);
        true
    }
}

#[cfg(test)]
mod tests {
    use crate::impact::{AnalysisOptions, ContactProblem, Errors, Scratch, Source};
    use crate::law::Friction;
    use crate::scalar::{Ordered, Trigonometry};

    /// A problem none of whose numbers is known.
    struct Unknown(ContactProblem);

    impl Source for Unknown {
        fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
            self.0.map(|_| T::one() / T::zero())
        }

        fn errors(&self) -> Errors<'_> {
            Errors::UNKNOWN
        }
    }

    #[test]
    fn a_rank_that_no_precision_shows_is_not_known() {
        let problem =
            ContactProblem::new(vec![1.0; 4], vec![[0.5, -1.0]], vec![Friction::Infinite], vec![0.0]).unwrap();
        let ranks = |source: &dyn crate::impact::Ladder| {
            let options = AnalysisOptions::default();
            Scratch::default().analyze(&problem, source, options).unwrap().rank
        };
        assert_eq!([ranks(&problem), ranks(&Unknown(problem.clone()))], [Some(1), None]);
    }
}
