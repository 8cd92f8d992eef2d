//! Replaces a Delassus matrix that rounding made indefinite by a semidefinite matrix close to it.

use super::ContactProblem;
use super::source::{Precision, PrecisionTask, Remembered, escalate};
use crate::impact::linear::{Unsettled, are_zero, settled};
use crate::scalar::{Ordered, Real, dot, subtract};

/// The rows of a factor Z, taken exactly, with G = Z Z^T.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FactorRows(Vec<Vec<f64>>);

impl FactorRows {
    /// Factors the matrix of `problem` by elimination with diagonal pivoting, down to the rounding of its entries.
    pub fn of(problem: &ContactProblem) -> Self {
        let count = 2 * problem.contacts();
        let mut rest: Vec<Vec<f64>> = (0..count)
            .map(|i| (0..count).map(|j| 0.5 * (problem.delassus(i, j) + problem.delassus(j, i))).collect())
            .collect();
        let original: Vec<f64> = (0..count).map(|i| rest[i][i]).collect();
        let mut rows = vec![Vec::new(); count];
        // A remaining diagonal entry is compared with its original value, so that units do not matter.
        let share = |rest: &[Vec<f64>], i: usize| if original[i] > 0.0 { rest[i][i] / original[i] } else { 0.0 };
        for _ in 0..count {
            let Some(pivot) = (0..count).max_by(|&i, &j| share(&rest, i).total_cmp(&share(&rest, j))) else { break };
            if share(&rest, pivot) <= 8.0 * count as f64 * f64::EPSILON {
                break;
            }
            let diagonal = rest[pivot][pivot];
            let column: Vec<f64> = rest.iter().map(|row| row[pivot] / diagonal.sqrt()).collect();
            for (i, line) in rest.iter_mut().enumerate() {
                rows[i].push(column[i]);
                subtract(line, &column, column[i]);
                // The rest of the pivot's column is zero by construction; its rounding must not count as more rank.
                line[pivot] = 0.0;
            }
            rest[pivot].fill(0.0);
        }
        Self(rows)
    }

    pub fn delassus<T: Real>(&self) -> Vec<T> {
        let rows: Vec<Vec<T>> =
            self.0.iter().map(|row| row.iter().map(|&entry| T::from_f64(entry)).collect()).collect();
        rows.iter().flat_map(|row| rows.iter().map(|other| dot(row, other))).collect()
    }
}

/// Whether the symmetric matrix of `problem`, taken exactly, has no negative eigenvalue.
pub(super) fn is_semidefinite(problem: &ContactProblem) -> bool {
    let mut definiteness = Definiteness(false);
    escalate(&Remembered::of(problem), Precision::Ball, &mut definiteness);
    definiteness.0
}

struct Definiteness(bool);

impl PrecisionTask for Definiteness {
    fn attempt<T: Ordered>(&mut self, problem: &ContactProblem<T>, _: Precision) -> bool {
        let found = semidefinite(problem);
        self.0 = found == Ok(true);
        found.is_ok()
    }
}

/// Decides semidefiniteness by symmetric elimination: where a pivot is zero, its row must be zero.
fn semidefinite<T: Ordered>(problem: &ContactProblem<T>) -> Result<bool, Unsettled> {
    let count = 2 * problem.contacts();
    let mut rest: Vec<Vec<T>> = (0..count).map(|i| (0..count).map(|j| problem.delassus(i, j)).collect()).collect();
    for pivot in 0..count {
        let standing = settled(rest[pivot][pivot])?;
        if standing.is_lt() {
            return Ok(false);
        }
        let (above, below) = rest.split_at_mut(pivot + 1);
        let row = &above[pivot];
        if standing.is_eq() {
            if !are_zero(row[pivot + 1..].iter().copied())? {
                return Ok(false);
            }
            continue;
        }
        let inverse = T::one() / row[pivot];
        for line in below {
            let factor = line[pivot] * inverse;
            subtract(&mut line[pivot..], &row[pivot..], factor);
        }
    }
    Ok(true)
}
