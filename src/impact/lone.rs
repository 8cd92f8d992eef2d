//! One contact alone: the eigenvalues of its G, scaled to a unit diagonal, in closed form.
//!
//! ```text
//!     [[1, r], [r, 1]],  r = G_tn / sqrt(G_tt G_nn)          eigenvalues 1 - |r|, 1 + |r|
//! ```
//!
//! Its four combinations have their closed form in [`enumerate`](super::enumerate) already: the tree of one contact is three
//! leaves beside the root, and each step divides by the one pivot or by the determinant.

use super::problem::ContactProblem;

/// The least and the greatest eigenvalue; `mobility` are the roots of the diagonal.
pub fn eigenvalues(problem: &ContactProblem, mobility: &[f64]) -> [f64; 2] {
    // Twice the same off-diagonal entry, as it was given.
    let coupling = problem.delassus(0, 1) / (mobility[0] * mobility[1]);
    [1.0 - coupling.abs(), 1.0 + coupling.abs()]
}
