//! The Delassus matrix G = J M^-1 J^T, and what impulses do to the velocity.
//!
//! ```text
//!     M = L^T D L,   Y = L^-T J^T,   G = Y^T D^-1 Y,   dv = M^-1 J^T p = L^-1 (D^-1 Y p)
//! ```
//!
//! A column of Y is zero off the branch of its contact's body. Source: Featherstone 2008, section 6.5; Pinocchio's
//! `delassus` for the split. Cost: O(n depth^2 + n^2 nv).

use super::jacobian::walk;
use super::ltl::LtlFactor;
use super::workspace::Workspace;
use crate::dynamics::plan::Plan;
use crate::planar::Vector;
use crate::scalar::{Real, dot};

/// Computes G (2n x 2n) from the factorized mass matrix and the contact Jacobian.
pub fn delassus<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let nv = plan.columns();
    let Workspace { factor, contact_jacobian, contact_velocity, half, half_by_d, delassus, .. } = workspace;
    half.clone_from(contact_jacobian);
    for y in half.chunks_exact_mut(nv.max(1)) {
        factor.half_solve(plan, y);
    }
    // Not from the Jacobian's length: if every joint is braked it has no columns.
    from_half(nv, 2 * contact_velocity.len(), factor, (half, half_by_d), delassus);
}

/// G = Y^T D^-1 Y, and D^-1 Y on the way.
pub(super) fn from_half<T: Real>(
    nv: usize,
    rows: usize,
    factor: &LtlFactor<T>,
    (half, half_by_d): (&[T], &mut Vec<T>),
    delassus: &mut Vec<T>,
) {
    half_by_d.clear();
    for y in half.chunks_exact(nv.max(1)) {
        half_by_d.extend(factor.divided(y));
    }
    delassus.clear();
    delassus.resize(rows * rows, T::zero());
    for row in 0..rows {
        for column in 0..=row {
            let entry = dot(&half[row * nv..(row + 1) * nv], &half_by_d[column * nv..(column + 1) * nv]);
            delassus[row * rows + column] = entry;
            delassus[column * rows + row] = entry;
        }
    }
}

/// Adds to `velocity` (dq/dt by coordinate) what `impulse` \[N s\] at a point does to it: M^-1 J^T p. The point lies at
/// `arm` from the origin of `body`, both vectors in the world's axes; `column` is scratch.
pub fn add_impulse<T: Real>(
    plan: &Plan<T>,
    workspace: &Workspace<T>,
    (body, arm): (usize, Vector<T>),
    impulse: Vector<T>,
    column: &mut Vec<T>,
    velocity: &mut [T],
) {
    column.clear();
    column.resize(plan.columns(), T::zero());
    walk(plan, body, arm, velocity, workspace, |index, unit| plan.bring(&mut column[index], unit.dot(impulse)));
    workspace.factor.solve(plan, column);
    for (&coordinate, &change) in plan.coordinates.iter().zip(column.iter()) {
        velocity[coordinate] = velocity[coordinate] + change;
    }
}
