//! The joint-space inertia matrix M by composite rigid bodies, and its factor.
//!
//! ```text
//!     I^c_i = I_i + sum of children's I^c        M_ij = S_i^T I^c_j S_j  for i on the path from j to the root
//! ```
//!
//! Source: Featherstone 2008, section 6.2. Each inertia refers to the body's own origin in world axes, so that moving
//! it to the parent is a shift without a rotation. S is the motion for a unit rate of the column. If a column moves
//! several joints, their entries add up (see [`plan`](crate::dynamics::plan)). Cost: O(nb depth).

use super::articulated_inertia::Wrench;
use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::{Inertia, Vector};
use crate::scalar::Real;

/// Computes the composite inertia of every body, which includes all bodies that it carries, from the kinematics.
fn composite_inertias<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    let Workspace { rotation, arm, composite, .. } = workspace;
    composite.clear();
    composite.extend(plan.bodies.iter().zip(&*rotation).map(|(body, &turn)| body.inertia.turned(turn)));
    for (index, body) in plan.bodies.iter().enumerate().rev() {
        if let Some(parent) = body.parent {
            composite[parent] = composite[parent].with(composite[index].seen_from(arm[index]));
        }
    }
}

/// Computes the diagonal of M without the rest. The plan must have no mimic joints. Cost: O(nb).
pub fn mass_diagonal<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    composite_inertias(plan, workspace);
    let Workspace { direction, composite, diagonal, .. } = workspace;
    diagonal.clear();
    diagonal.resize(plan.columns(), T::zero());
    for (index, body) in plan.bodies.iter().enumerate() {
        let (Inertia { mass, second, .. }, Some(column)) = (composite[index], body.column) else { continue };
        diagonal[column] = match body.motion {
            JointMotion::Root => {
                diagonal[..2].fill(mass);
                second
            }
            JointMotion::Revolute { .. } => second + body.rotor,
            JointMotion::Prismatic { .. } => mass * direction[index].dot(direction[index]) + body.rotor,
            JointMotion::Fixed => continue,
        };
    }
}

/// Computes M (nv x nv, columns of the plan; kg, kg m, kg m^2) from the results of [`kinematics`](super::kinematics()).
pub fn mass_matrix<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    composite_inertias(plan, workspace);
    let nv = plan.columns();
    let Workspace { arm, direction, composite, mass_matrix, .. } = workspace;
    mass_matrix.clear();
    mass_matrix.resize(nv * nv, T::zero());
    for (index, body) in plan.bodies.iter().enumerate().rev() {
        let (Inertia { mass, first, second }, Some(column)) = (composite[index], body.column) else { continue };
        let momentum = match body.motion {
            JointMotion::Root => {
                let linear = first.perpendicular();
                mass_matrix[0] = mass;
                mass_matrix[nv + 1] = mass;
                for (row, axis) in Vector::axes().into_iter().enumerate() {
                    mass_matrix[column * nv + row] = axis.dot(linear);
                }
                mass_matrix[column * nv + column] = second;
                continue;
            }
            JointMotion::Revolute { rate, .. } => {
                Wrench { linear: first.perpendicular() * rate, moment: rate * second }
            }
            JointMotion::Prismatic { .. } => {
                Wrench { linear: direction[index] * mass, moment: first.perpendicular().dot(direction[index]) }
            }
            JointMotion::Fixed => continue,
        };
        // `momentum` belongs to a unit rate of this joint. The walk to the root projects it on every joint on the path.
        let along = |at: usize, momentum: Wrench<T>| match plan.bodies[at].motion {
            JointMotion::Root | JointMotion::Fixed => momentum.moment,
            JointMotion::Revolute { rate, .. } => rate * momentum.moment,
            JointMotion::Prismatic { .. } => direction[at].dot(momentum.linear),
        };
        plan.bring(&mut mass_matrix[column * nv + column], along(index, momentum) + body.rotor);
        let (mut at, mut momentum) = (index, momentum);
        while let Some(parent) = plan.bodies[at].parent {
            momentum = momentum.seen_from(arm[at]);
            at = parent;
            if let Some(other) = plan.bodies[at].column {
                let product = along(at, momentum);
                plan.bring(&mut mass_matrix[column.max(other) * nv + column.min(other)], product);
                if other == column {
                    // Both joints share this column, so the product appears twice in the diagonal entry.
                    plan.bring(&mut mass_matrix[column * nv + column], product);
                }
            }
        }
        if plan.floating {
            plan.bring(&mut mass_matrix[column * nv], momentum.linear.x);
            plan.bring(&mut mass_matrix[column * nv + 1], momentum.linear.z);
        }
    }
}

/// Factorizes the mass matrix. Callers check whether a pivot vanishes.
pub fn factorize<T: Real>(plan: &Plan<T>, workspace: &mut Workspace<T>) {
    workspace.factor.factorize(plan, &workspace.mass_matrix);
}
