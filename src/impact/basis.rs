//! Rank-revealing orthogonalization of a few short rows, and least-norm solutions of the equations they form.
//!
//! ```text
//!     rows . w = right      rows = C Q,  Q orthonormal,  w = Q^T y
//! ```
//!
//! Modified Gram-Schmidt with row pivoting, each row projected twice (Bjorck, *Numerical Methods for Least Squares
//! Problems*, 1996, section 2.4), which keeps Q orthogonal to rounding. Rows are expected to be of length about one; a row
//! whose rest is shorter than [`RANK_TOLERANCE`] depends on the others. Own loops on purpose: a library's matrix products
//! choose their kernels by the machine, and a rank must not depend on that.

/// What the rest of a unit row must exceed to count as independent.
pub const RANK_TOLERANCE: f64 = 1e3 * f64::EPSILON;
/// How well a dependent equation must be met by the others to agree with them, relative to its terms.
const AGREEMENT: f64 = 1e-10;
/// Where a dependent equation certainly contradicts the others.
const CONTRADICTION: f64 = 1e-7;

/// An orthonormal basis of the rows added so far.
#[derive(Debug, Clone, Default)]
pub struct Basis {
    columns: usize,
    /// Orthonormal rows, one after the other.
    rows: Vec<f64>,
}

/// Whether dependent equations agree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Agreement {
    /// They agree to rounding.
    Holds,
    /// They contradict each other.
    Fails,
    /// The disagreement is neither rounding nor clear.
    Doubtful,
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Basis {
    /// The basis of nothing, for rows of `columns` entries.
    pub fn new(columns: usize) -> Self {
        Self { columns, rows: Vec::new() }
    }

    /// Its number of rows.
    pub fn rank(&self) -> usize {
        self.rows.len().checked_div(self.columns).unwrap_or(0)
    }

    /// Its rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.rows.chunks_exact(self.columns.max(1))
    }

    /// What of `row` is orthogonal to the basis.
    pub fn rest(&self, row: &[f64]) -> Vec<f64> {
        let mut rest = row.to_vec();
        for _ in 0..2 {
            for unit in self.rows() {
                let part = dot(unit, &rest);
                for (entry, direction) in rest.iter_mut().zip(unit) {
                    *entry -= part * direction;
                }
            }
        }
        rest
    }

    /// Adds the rows that are independent, the one with the longest rest first, and returns their order.
    pub fn extend(&mut self, rows: &[&[f64]]) -> Vec<usize> {
        let mut left: Vec<usize> = (0..rows.len()).collect();
        let mut order = Vec::new();
        while !left.is_empty() && self.rank() < self.columns {
            let rests: Vec<Vec<f64>> = left.iter().map(|&index| self.rest(rows[index])).collect();
            let lengths: Vec<f64> = rests.iter().map(|rest| dot(rest, rest).sqrt()).collect();
            let Some(longest) = (0..left.len()).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j])) else { break };
            if lengths[longest] <= RANK_TOLERANCE {
                break;
            }
            self.rows.extend(rests[longest].iter().map(|entry| entry / lengths[longest]));
            order.push(left.swap_remove(longest));
        }
        order
    }

    /// Completes nothing, but tells what is missing: an orthonormal basis of all vectors that are orthogonal to this one.
    pub fn complement(&self) -> Basis {
        let mut whole = self.clone();
        let units: Vec<Vec<f64>> =
            (0..self.columns).map(|i| (0..self.columns).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        whole.extend(&units.iter().map(Vec::as_slice).collect::<Vec<_>>());
        Basis { columns: self.columns, rows: whole.rows.split_off(self.rows.len()) }
    }
}

/// Orthonormal vectors that span the same as `vectors`, which are independent.
pub fn orthonormal(vectors: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let unit = |vector: &Vec<f64>| {
        let length = dot(vector, vector).sqrt();
        vector.iter().map(|entry| entry / length).collect::<Vec<f64>>()
    };
    let vectors: Vec<Vec<f64>> = vectors.iter().map(unit).collect();
    let mut basis = Basis::new(vectors.first().map_or(0, Vec::len));
    basis.extend(&vectors.iter().map(Vec::as_slice).collect::<Vec<_>>());
    basis.rows().map(<[f64]>::to_vec).collect()
}

/// The shortest w with rows . w = right, the basis of the rows, and whether the dependent equations agree. Rows should be
/// of length about one, as the tolerances are relative to that.
pub fn solve(columns: usize, rows: &[&[f64]], right: &[f64]) -> (Vec<f64>, Basis, Agreement) {
    let mut basis = Basis::new(columns);
    let order = basis.extend(rows);
    let mut w = vec![0.0; columns];
    for (unit, &index) in basis.rows().zip(&order) {
        // The equation's row has no part along later units, so that the earlier part of w is final.
        let step = (right[index] - dot(rows[index], &w)) / dot(rows[index], unit);
        for (entry, direction) in w.iter_mut().zip(unit) {
            *entry += step * direction;
        }
    }
    let size = 1.0 + dot(&w, &w).sqrt();
    let worst = rows.iter().zip(right).map(|(row, right)| (dot(row, &w) - right).abs()).fold(0.0, f64::max) / size;
    let agreement = if worst <= AGREEMENT {
        Agreement::Holds
    } else if worst >= CONTRADICTION {
        Agreement::Fails
    } else {
        Agreement::Doubtful
    };
    (w, basis, agreement)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependent_rows_are_found_and_their_equations_checked() {
        let rows: [&[f64]; 3] = [&[1.0, 0.0, 0.0], &[0.6, 0.8, 0.0], &[0.0, 1.0, 0.0]];
        let (w, basis, agreement) = solve(3, &rows, &[1.0, 2.2, 2.0]);
        assert_eq!(basis.rank(), 2);
        assert_eq!(agreement, Agreement::Holds);
        for (entry, expected) in w.iter().zip([1.0, 2.0, 0.0]) {
            // A few roundings on numbers of order one.
            assert!((entry - expected).abs() < 8.0 * f64::EPSILON);
        }
        assert_eq!(solve(3, &rows, &[1.0, 2.2, 2.5]).2, Agreement::Fails);
        assert_eq!(basis.complement().rank(), 1);
    }
}
