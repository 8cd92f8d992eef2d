//! The factorization M = L^T D L along the branches of the tree, without fill-in.
//!
//! Source: Featherstone 2008, section 6.5 (LTDL), with lambda taken from the plan's elimination tree. It needs no
//! square root, so any [`Real`] works. Cost: O(nv depth^2), and O(nv depth) per solve.

use super::plan::Plan;
use crate::scalar::{Real, subtract};

/// L below the diagonal, with an implicit unit diagonal, and D on the diagonal, by rows. nv x nv
#[derive(Debug, Clone, Default)]
pub struct LtlFactor<T = f64> {
    entries: Vec<T>,
    columns: usize,
}

impl<T: Real> LtlFactor<T> {
    /// Factorizes M (nv x nv by rows, lower triangle). Callers check whether a [`pivot`](Self::pivot) vanishes.
    pub fn factorize(&mut self, plan: &Plan<T>, mass_matrix: &[T]) {
        let nv = plan.columns();
        self.columns = nv;
        mass_matrix.clone_into(&mut self.entries);
        for k in (0..nv).rev() {
            let (above, pivot_row) = self.entries.split_at_mut(k * nv);
            let pivot_row = &mut pivot_row[..=k];
            plan.for_ancestors(k, |i| {
                // Computed as u (u / D), because u u (1 / D) underflows for small masses.
                let a = pivot_row[i] / pivot_row[k];
                let row = &mut above[i * nv..][..=i];
                row[i] = row[i] - a * pivot_row[i];
                let (row, others) = (&mut row[..i], &pivot_row[..i]);
                plan.for_ancestors(i, |j| row[j] = row[j] - a * others[j]);
                pivot_row[i] = a;
            });
        }
    }

    /// Returns the entries of a row of L below its diagonal.
    pub fn row(&self, row: usize) -> &[T] {
        &self.entries[row * self.columns..][..row]
    }

    /// Returns the entry of D in a column.
    pub fn pivot(&self, column: usize) -> T {
        self.entries[column * self.columns + column]
    }

    /// Returns D^-1 y.
    pub fn divided<'a>(&'a self, y: &'a [T]) -> impl Iterator<Item = T> + use<'a, T> {
        y.iter().enumerate().map(|(i, &entry)| entry / self.pivot(i))
    }

    /// Replaces N vectors y by L^-T y. They are zero outside of `columns`, each of which comes before its ancestors.
    pub fn half_solve<const N: usize>(&self, plan: &Plan<T>, columns: impl Iterator<Item = usize>, y: &mut [[T; N]]) {
        for i in columns {
            let (above, rest) = y.split_at_mut(i);
            let (entries, row) = (rest[0], self.row(i));
            plan.for_ancestors(i, |j| subtract(&mut above[j], &entries, row[j]));
        }
    }

    /// Replaces x by L^-1 x.
    pub fn other_half_solve(&self, plan: &Plan<T>, x: &mut [T]) {
        for i in 0..self.columns {
            let ((above, rest), row) = (x.split_at_mut(i), self.row(i));
            plan.for_ancestors(i, |j| rest[0] = rest[0] - row[j] * above[j]);
        }
    }

    /// Replaces x by M^-1 x.
    pub fn solve(&self, plan: &Plan<T>, x: &mut [T]) {
        self.half_solve(plan, (0..self.columns).rev(), x.as_chunks_mut::<1>().0);
        for (i, entry) in x.iter_mut().enumerate() {
            *entry = *entry / self.pivot(i);
        }
        self.other_half_solve(plan, x);
    }
}
