//! The Delassus matrix G = J M^-1 J^T, and the velocity change caused by impulses.
//!
//! ```text
//!     M = L^T D L,   Y = L^-T J^T,   G = Y^T D^-1 Y,   dv = M^-1 J^T p = L^-1 (D^-1 Y p)
//! ```
//!
//! A column of Y is nonzero only on the branch of its contact's body. Source: Featherstone 2008, section 6.5; the split
//! into Y and D^-1 Y follows Pinocchio's `delassus`. Cost: O(n depth^2 + n^2 nv).

use super::jacobian::walk;
use super::workspace::Workspace;
use crate::dynamics::plan::Plan;
use crate::planar::Vector;
use crate::scalar::Real;

/// Computes G (2n x 2n) from the factorized mass matrix and the contact Jacobian.
pub fn delassus<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let Workspace { factor, contact_jacobian, branch, half, half_by_d, .. } = workspace;
    half.clone_from(contact_jacobian);
    half_by_d.clear();
    half_by_d.resize(half.len(), [T::zero(); 2]);
    let nv = plan.columns().max(1);
    for ((y, by_d), &branch) in half.chunks_exact_mut(nv).zip(half_by_d.chunks_exact_mut(nv)).zip(&*branch) {
        factor.half_solve(plan, plan.branch(branch), y);
        for column in plan.branch(branch) {
            let pivot = factor.pivot(column);
            by_d[column] = y[column].map(|entry| entry / pivot);
        }
    }
    let branch = std::mem::take(branch);
    from_half(branch.len(), workspace, |a, b| plan.branch(plan.shared(branch[a], branch[b])));
    workspace.branch = branch;
}

/// Computes G = Y^T D^-1 Y of n contacts from Y and D^-1 Y. `shared` returns the columns in which both have entries.
pub(super) fn from_half<T: Real, I: Iterator<Item = usize>>(
    contacts: usize,
    workspace: &mut Workspace<T>,
    shared: impl Fn(usize, usize) -> I,
) {
    let Workspace { half, half_by_d, delassus, .. } = workspace;
    let rows = 2 * contacts;
    delassus.clear();
    delassus.resize(rows * rows, T::zero());
    // There are no columns if every joint is braked.
    let nv = half.len() / contacts.max(1);
    for a in 0..contacts {
        let y = &half[a * nv..][..nv];
        for b in 0..=a {
            let by_d = &half_by_d[b * nv..][..nv];
            let [mut tt, mut tn, mut nt, mut nn] = [T::zero(); 4];
            for column in shared(a, b) {
                let ([t, n], [by_t, by_n]) = (y[column], by_d[column]);
                (tt, tn) = (tt + t * by_t, tn + t * by_n);
                (nt, nn) = (nt + n * by_t, nn + n * by_n);
            }
            for (row, column, entry) in [(0, 0, tt), (0, 1, tn), (1, 0, nt), (1, 1, nn)] {
                let (row, column) = (2 * a + row, 2 * b + column);
                delassus[row * rows + column] = entry;
                delassus[column * rows + row] = entry;
            }
        }
    }
}

/// An impulse at a point of a body.
#[derive(Debug, Clone, Copy)]
pub struct PointImpulse<T = f64> {
    /// The body, an index into the plan's bodies.
    pub body: usize,
    /// Vector from the body's origin to the point, in the world's axes \[m\].
    pub arm: Vector<T>,
    /// The impulse in the world's axes \[N s\].
    pub vector: Vector<T>,
}

/// Adds the velocity change M^-1 J^T p of an impulse p to `velocity` (dq/dt by coordinate). `column` is scratch.
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
