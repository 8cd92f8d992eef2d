//! M = L^T D L along the branches of the tree, without fill-in.
//!
//! Source: Featherstone 2008, section 6.5 (LTDL), with lambda the parent columns of the plan's elimination tree. It needs no root, so any
//! [`Real`] will do. Cost: O(nv depth^2).

use super::workspace::Workspace;
use crate::dynamics::plan::Plan;
use crate::scalar::Real;

/// Factorizes the mass matrix: L below the diagonal, D on it. A vanishing entry of D is the caller's to notice.
pub fn factorize<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let nv = plan.columns();
    let Workspace { mass_matrix, factor: h, .. } = workspace;
    h.clear();
    h.extend_from_slice(mass_matrix);
    for k in (0..nv).rev() {
        let mut ancestor = plan.parents[k];
        while let Some(i) = ancestor {
            // u (u / D), never u u (1 / D): the latter underflows for small masses.
            let a = h[k * nv + i] / h[k * nv + k];
            let mut below = Some(i);
            while let Some(j) = below {
                h[i * nv + j] = h[i * nv + j] - a * h[k * nv + j];
                below = plan.parents[j];
            }
            h[k * nv + i] = a;
            ancestor = plan.parents[i];
        }
    }
}
