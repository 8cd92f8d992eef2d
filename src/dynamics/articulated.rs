//! G = J M^-1 J^T and M^-1 J^T p by the articulated-body algorithm, without M.
//!
//! ```text
//!     A_i = I_i + sum over children of (A_c - U_c D_c^-1 U_c^T) seen from i         U = A S,  D = S^T A S + rotor
//!     y_i = S_i^T f_i,   f_parent = f_i - U_i D_i^-1 y_i                            G = Y^T D^-1 Y
//! ```
//!
//! A and f are 3 x 3 matrices and 3-vectors in the plane, stored as moment, coupling and linear block about each body's
//! origin in world axes. A revolute joint without a rotor transmits no moment, so the parent sees only a 2 x 2 block of
//! the child. D and Y equal those of M = L^T D L. This is a second, independent way to the same numbers, and the only
//! fast one for long chains. It does not support mimic joints: each column must move exactly one joint. Source:
//! Featherstone 2008, sections 7.2 and 7.3. Cost: O(nb + n depth), and O(n^2) per shared joint for G.

use super::articulated_inertia::{ArticulatedInertia, Wrench};
use super::delassus::{PointImpulse, from_half};
use super::jacobian::{ContactPoint, Motion};
use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan, PlanBody};
use crate::planar::Vector;
use crate::scalar::Real;

/// Computes every body's articulated inertia and the pivots D (nv, columns of the plan) from the kinematics.
///
/// Callers check whether a pivot vanishes, as with [`factorize`](super::factorize).
pub fn articulated_inertias<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let Workspace { rotation, arm, direction, articulated, pivots, .. } = workspace;
    articulated.clear();
    let rigid = |(body, &turn): (&PlanBody<T>, _)| ArticulatedInertia::rigid(body.inertia.turned(turn));
    articulated.extend(plan.bodies.iter().zip(&*rotation).map(rigid));
    pivots.clear();
    pivots.resize(plan.columns(), T::zero());
    for (index, body) in plan.bodies.iter().enumerate().rev() {
        let inertia = articulated[index];
        let passed = match (body.motion, body.column) {
            (JointMotion::Root, Some(column)) => {
                pivots[column] = inertia.moment;
                let [xx, xz, zz] = inertia.without_turn(T::zero(), inertia.moment).linear;
                pivots[1] = zz;
                pivots[0] = xx - xz * (xz / zz);
                continue;
            }
            (JointMotion::Fixed, _) | (_, None) => inertia,
            (JointMotion::Revolute { .. }, Some(column)) => {
                pivots[column] = inertia.moment + body.rotor;
                inertia.without_turn(body.rotor, pivots[column])
            }
            (JointMotion::Prismatic { .. }, Some(column)) => {
                let along = direction[index];
                pivots[column] = along.dot(inertia.stretch(along)) + body.rotor;
                inertia.without_slide(along, body.rotor, pivots[column])
            }
        };
        if let Some(parent) = body.parent {
            articulated[parent] = articulated[parent].with(passed.seen_from(arm[index]));
        }
    }
}

/// Computes G (2n x 2n), Y and D^-1 Y for `contacts` from the articulated inertias.
pub fn articulated_delassus<T: Real>(plan: &Plan<T>, contacts: &[ContactPoint<T>], workspace: &mut Workspace<T>) {
    let nv = plan.columns();
    let mut half = std::mem::take(&mut workspace.half);
    let mut half_by_d = std::mem::take(&mut workspace.half_by_d);
    for list in [&mut half, &mut half_by_d] {
        list.clear();
        list.resize(contacts.len() * nv, [T::zero(); 2]);
    }
    for (index, contact) in contacts.iter().enumerate() {
        let arm = contact.arm(workspace);
        for (row, axis) in contact.axes().into_iter().enumerate() {
            to_root(plan, workspace, contact.body, Wrench::at(arm, axis), |column, y, by_d| {
                half[index * nv + column][row] = y;
                half_by_d[index * nv + column][row] = by_d;
            });
        }
    }
    workspace.half = half;
    workspace.half_by_d = half_by_d;
    let outermost = |contact: usize| plan.way_to_root(contacts[contact].body).find_map(|(_, body)| body.column);
    from_half(contacts.len(), workspace, |a, b| plan.branch(plan.shared(outermost(a), outermost(b))));
}

/// Adds the velocity change M^-1 J^T p of an impulse p to `velocity` (dq/dt by coordinate). `rates` and `motions` are
/// scratch.
pub fn add_articulated_impulse<T: Real>(
    plan: &Plan<T>,
    workspace: &Workspace<T>,
    impulse: PointImpulse<T>,
    rates: &mut Vec<T>,
    motions: &mut Vec<Motion<T>>,
    velocity: &mut [T],
) {
    rates.clear();
    rates.resize(plan.columns(), T::zero());
    let PointImpulse { body, arm, vector } = impulse;
    to_root(plan, workspace, body, Wrench::at(arm, vector), |column, _, by_d| rates[column] = by_d);
    set_in_motion(plan, workspace, rates, motions);
    for (&coordinate, &change) in plan.coordinates.iter().zip(rates.iter()) {
        velocity[coordinate] = velocity[coordinate] + change;
    }
}

/// Replaces the joint forces tau in `column` (nv, columns of the plan; N, N m) by the accelerations M^-1 (tau - b).
/// Requires the results of [`demands`](super::demands), which it overwrites: b is never formed.
pub fn articulated_acceleration<T: Real>(
    plan: &Plan<T>,
    workspace: &mut Workspace<T>,
    column: &mut [T],
    motions: &mut Vec<Motion<T>>,
) {
    let mut demand = std::mem::take(&mut workspace.demand);
    for (index, body) in plan.bodies.iter().enumerate().rev() {
        let Wrench { moment, linear } = demand[index];
        let force = Wrench { moment: -moment, linear: -linear };
        let tau = body.column.map(|at| column[at]);
        let Wrench { moment, linear } =
            through_joint(plan, workspace, index, force, tau, |at, _, by_d| column[at] = by_d);
        if let Some(parent) = body.parent {
            let passed = Wrench { moment: -moment, linear: -linear };
            demand[parent] = demand[parent].with(passed.seen_from(workspace.arm[index]));
        }
    }
    workspace.demand = demand;
    set_in_motion(plan, workspace, column, motions);
}

/// Replaces D^-1 y in `rates` by the rates that the impulse causes, and computes each body's motion.
pub(super) fn set_in_motion<T: Real>(
    plan: &Plan<T>,
    workspace: &Workspace<T>,
    rates: &mut [T],
    motions: &mut Vec<Motion<T>>,
) {
    motions.clear();
    for (index, body) in plan.bodies.iter().enumerate() {
        let inertia = &workspace.articulated[index];
        let Some(parent) = body.parent else {
            motions.push(if plan.floating { root_motion(workspace, rates) } else { (T::zero(), Vector::zero()) });
            continue;
        };
        let (spin, origin) = motions[parent];
        let carried = origin + workspace.arm[index].perpendicular() * spin;
        let Some(column) = body.column else {
            motions.push((spin, carried));
            continue;
        };
        let pivot = workspace.pivots[column];
        motions.push(match body.motion {
            JointMotion::Root | JointMotion::Fixed => (spin, carried),
            JointMotion::Revolute { sign, .. } => {
                let moment = inertia.moment * spin + inertia.coupling.dot(carried);
                rates[column] = rates[column] - sign * (moment / pivot);
                (spin + sign * rates[column], carried)
            }
            JointMotion::Prismatic { .. } => {
                let along = workspace.direction[index];
                let force = along.dot(inertia.coupling) * spin + inertia.stretch(along).dot(carried);
                rates[column] = rates[column] - force / pivot;
                (spin, carried + along * rates[column])
            }
        });
    }
}

/// Replaces D^-1 y of a floating base in `rates` by its rates. Returns the root's spin and the velocity of its origin.
fn root_motion<T: Real>(workspace: &Workspace<T>, rates: &mut [T]) -> Motion<T> {
    let root = &workspace.articulated[0];
    let [_, xz, zz] = root.without_turn(T::zero(), root.moment).linear;
    rates[1] = rates[1] - (xz / zz) * rates[0];
    let origin = Vector::new(rates[0], rates[1]);
    rates[2] = rates[2] - root.coupling.dot(origin) / root.moment;
    (rates[2], origin)
}

/// Passes a force on `body` toward the root, joint by joint, and reports y and y/D of every column on the path.
fn to_root<T: Real>(
    plan: &Plan<T>,
    workspace: &Workspace<T>,
    body: usize,
    mut force: Wrench<T>,
    mut visit: impl FnMut(usize, T, T),
) {
    for (at, body) in plan.way_to_root(body) {
        force = through_joint(plan, workspace, at, force, None, &mut visit);
        if body.parent.is_some() {
            force = force.seen_from(workspace.arm[at]);
        }
    }
}

/// Passes a force on body `at` through its joint, on which `tau` acts, and reports y and y/D of the joint's column.
#[inline]
fn through_joint<T: Real>(
    plan: &Plan<T>,
    workspace: &Workspace<T>,
    at: usize,
    mut force: Wrench<T>,
    tau: Option<T>,
    mut visit: impl FnMut(usize, T, T),
) -> Wrench<T> {
    let PlanBody { motion, column, rotor, .. } = plan.bodies[at];
    let inertia = &workspace.articulated[at];
    let driven = |y: T| tau.map_or(y, |tau| tau + y);
    match (motion, column) {
        // No joint force acts on the base.
        (JointMotion::Root, Some(column)) => {
            let pitch = force.moment / workspace.pivots[column];
            visit(column, force.moment, pitch);
            let Vector { x, z } = force.linear - inertia.coupling * pitch;
            let [_, xz, _] = inertia.without_turn(T::zero(), inertia.moment).linear;
            let up = z / workspace.pivots[1];
            visit(1, z, up);
            let rest = x - xz * up;
            visit(0, rest, rest / workspace.pivots[0]);
        }
        (JointMotion::Fixed, _) | (_, None) => {}
        (JointMotion::Revolute { sign, .. }, Some(column)) => {
            let y = driven(sign * force.moment);
            let rate = y / workspace.pivots[column];
            visit(column, y, rate);
            // Equals n - A_nn y / D without its cancellation: without a rotor, only the joint's torque is transmitted.
            let passed = rotor * rate;
            force.moment = sign * tau.map_or(passed, |tau| passed - tau);
            force.linear = force.linear - inertia.coupling * (sign * rate);
        }
        (JointMotion::Prismatic { .. }, Some(column)) => {
            let along = workspace.direction[at];
            let push = driven(along.dot(force.linear));
            let rate = push / workspace.pivots[column];
            visit(column, push, rate);
            force.moment = force.moment - along.dot(inertia.coupling) * rate;
            force.linear = force.linear - inertia.stretch(along) * rate;
        }
    }
    force
}
