//! The Delassus matrix G = J M^-1 J^T, and what impulses do to the velocity.
//!
//! ```text
//!     M = L^T D L,   Y = L^-T J^T,   G = Y^T D^-1 Y,   dv = M^-1 J^T p = L^-1 (D^-1 Y p)
//! ```
//!
//! A column of Y is zero off the branch of its contact's body. Source: Featherstone 2008, section 6.5; Pinocchio's
//! `delassus` for the split. Cost: O(n depth^2 + n^2 nv).

use super::jacobian::walk;
use super::workspace::Workspace;
use crate::dynamics::plan::Plan;
use crate::planar::Vector;
use crate::scalar::{Real, dot};

/// Computes G (2n x 2n) from the factorized mass matrix and the contact Jacobian.
pub fn delassus<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let nv = plan.columns();
    let Workspace { factor, contact_jacobian, half, .. } = workspace;
    half.clone_from(contact_jacobian);
    for y in half.chunks_exact_mut(nv.max(1)) {
        factor.half_solve(plan, y);
    }
    from_half(plan, workspace);
}

/// G = Y^T D^-1 Y, and D^-1 Y on the way.
pub(super) fn from_half<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let Workspace { factor, contact_velocity, half, half_by_d, delassus, .. } = workspace;
    // Not from the Jacobian's length: if every joint is braked it has no columns.
    let (nv, rows) = (plan.columns(), 2 * contact_velocity.len());
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

/// An impulse at a point of a body.
#[derive(Debug, Clone, Copy)]
pub struct PointImpulse<T = f64> {
    /// An index into the plan's bodies.
    pub body: usize,
    /// The point from the body's origin, in the world's axes \[m\].
    pub arm: Vector<T>,
    /// In the world's axes \[N s\].
    pub vector: Vector<T>,
}

/// Adds to `velocity` (dq/dt by coordinate) what an impulse p does to it: M^-1 J^T p; `column` is scratch.
pub fn add_impulse<T: Real>(
    plan: &Plan<T>,
    workspace: &Workspace<T>,
    impulse: PointImpulse<T>,
    column: &mut Vec<T>,
    velocity: &mut [T],
) {
    column.clear();
    column.resize(plan.columns(), T::zero());
    let PointImpulse { body, arm, vector } = impulse;
    walk(plan, body, arm, velocity, workspace, |index, unit| plan.bring(&mut column[index], unit.dot(vector)));
    workspace.factor.solve(plan, column);
    for (&coordinate, &change) in plan.coordinates.iter().zip(column.iter()) {
        velocity[coordinate] = velocity[coordinate] + change;
    }
}
