//! The factor of M = L^T D L along the branches of the tree, without fill-in.
//!
//! Source: Featherstone 2008, section 6.5 (LTDL), with lambda the parent columns of the plan's elimination tree. It
//! needs no root, so any [`Real`] works. Cost: O(nv depth^2), and O(nv depth) per solve.

use super::plan::Plan;
use crate::scalar::Real;

/// L below the diagonal (its own diagonal is one) and D on it, by rows. nv x nv
#[derive(Debug, Clone, Default)]
pub struct LtlFactor<T = f64> {
    entries: Vec<T>,
    columns: usize,
    /// The ancestors of one column.
    branch: Vec<usize>,
}

impl<T: Real> LtlFactor<T> {
    /// Factorizes M (nv x nv by rows, its lower triangle). Callers check for a vanishing [`pivot`](Self::pivot).
    pub fn factorize(&mut self, plan: &Plan<T>, mass_matrix: &[T]) {
        let nv = plan.columns();
        self.columns = nv;
        mass_matrix.clone_into(&mut self.entries);
        for k in (0..nv).rev() {
            let (above, own) = self.entries.split_at_mut(k * nv);
            let own = &mut own[..nv];
            self.branch.clear();
            self.branch.extend(plan.ancestors(k));
            for (at, &i) in self.branch.iter().enumerate() {
                let row = &mut above[i * nv..][..nv];
                // u (u / D), never u u (1 / D): the latter underflows for small masses.
                let a = own[i] / own[k];
                for &j in &self.branch[at..] {
                    row[j] = row[j] - a * own[j];
                }
                own[i] = a;
            }
        }
    }

    /// The entries of a row of L below its diagonal.
    pub fn row(&self, row: usize) -> &[T] {
        &self.entries[row * self.columns..][..row]
    }

    pub fn pivot(&self, column: usize) -> T {
        self.entries[column * self.columns + column]
    }

    /// D^-1 y.
    pub fn divided<'a>(&'a self, y: &'a [T]) -> impl Iterator<Item = T> + use<'a, T> {
        y.iter().enumerate().map(|(i, &entry)| entry / self.pivot(i))
    }

    /// y := L^-T y.
    pub fn half_solve(&self, plan: &Plan<T>, y: &mut [T]) {
        for i in (0..self.columns).rev() {
            let (above, rest) = y.split_at_mut(i);
            for j in plan.ancestors(i) {
                above[j] = above[j] - self.row(i)[j] * rest[0];
            }
        }
    }

    /// x := L^-1 x.
    pub fn other_half_solve(&self, plan: &Plan<T>, x: &mut [T]) {
        for i in 0..self.columns {
            for j in plan.ancestors(i) {
                x[i] = x[i] - self.row(i)[j] * x[j];
            }
        }
    }

    /// x := M^-1 x.
    pub fn solve(&self, plan: &Plan<T>, x: &mut [T]) {
        self.half_solve(plan, x);
        for (i, entry) in x.iter_mut().enumerate() {
            *entry = *entry / self.pivot(i);
        }
        self.other_half_solve(plan, x);
    }
}
