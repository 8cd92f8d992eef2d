//! Bias forces, and accelerations of points: the effects of velocities and gravity while no coordinate accelerates.
//!
//! ```text
//!     M a = tau - b + J^T f          c' = J a + sigma          K a + kappa = 0
//!
//!     o_i = o_p - omega_p^2 r_i + 2 omega_p turned(d_i) q'_i     outward; r_i: arm from p, d_i: prismatic axis
//!     F_i = m (o_i - g) - omega_i^2 h_i,  N_i = turned(h_i) . (o_i - g)      inward as a wrench, b = S_i . wrench
//!     sigma = o_i - omega_i^2 r                                     of a point, or of a circle's center, at r
//! ```
//!
//! Here turned(r) is r rotated by +90 degrees. No body has an angular acceleration: the axes of all joints are
//! parallel, so the angular velocities simply add up. A circle rolls on straight ground: its lowest point stays at a
//! constant distance below its center, so both have the same acceleration. Source: Featherstone 2008, section 5.3
//! (recursive Newton-Euler), in world axes. Cost: O(nb).

use super::articulated_inertia::Wrench;
use super::jacobian::ContactPoint;
use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::Vector;
use crate::scalar::Real;

/// Computes the motion of every body while no coordinate accelerates, and the wrench that it requires, from the
/// kinematics. `velocity` is dq/dt including braked joints, and `gravity` acts along -z of the world \[m/s^2\]. Bodies
/// marked `steady` do not rotate: the sum of their joint rates is only rounding. An empty list marks none.
pub fn demands<T: Real>(plan: &Plan<T>, velocity: &[T], gravity: T, steady: &[bool], workspace: &mut Workspace<T>) {
    let Workspace { rotation, arm, direction, spin, squared_spin, drift, demand, .. } = workspace;
    spin.clear();
    squared_spin.clear();
    drift.clear();
    demand.clear();
    let weight = Vector { x: T::zero(), z: gravity };
    let turns = |index: usize| steady.get(index) != Some(&true);
    for (index, body) in plan.bodies.iter().enumerate() {
        let (turn, origin) = match body.parent {
            None => (if plan.floating { velocity[2] } else { T::zero() }, Vector::zero()),
            Some(parent) => {
                let carried = drift[parent] - arm[index] * squared_spin[parent];
                match body.motion {
                    JointMotion::Revolute { rate, .. } => (spin[parent] + rate * velocity[body.coordinate], carried),
                    JointMotion::Prismatic { .. } if turns(parent) => {
                        let twice = spin[parent] + spin[parent];
                        let slide = direction[index].perpendicular() * (twice * velocity[body.coordinate]);
                        (spin[parent], carried + slide)
                    }
                    _ => (spin[parent], carried),
                }
            }
        };
        let squared = if turns(index) { turn * turn } else { T::zero() };
        spin.push(turn);
        squared_spin.push(squared);
        drift.push(origin);
        let (first, lifted) = (rotation[index].apply(body.inertia.first), origin + weight);
        let linear = lifted * body.inertia.mass - first * squared;
        demand.push(Wrench { linear, moment: first.perpendicular().dot(lifted) });
    }
}

/// Computes b (nv, columns of the plan; N, N m). Calls [`demands`] with the same arguments.
pub fn bias<T: Real>(plan: &Plan<T>, velocity: &[T], gravity: T, steady: &[bool], workspace: &mut Workspace<T>) {
    demands(plan, velocity, gravity, steady, workspace);
    let Workspace { arm, direction, demand, bias, .. } = workspace;
    bias.clear();
    bias.resize(plan.columns(), T::zero());
    for (index, body) in plan.bodies.iter().enumerate().rev() {
        let wrench = demand[index];
        if let Some(parent) = body.parent {
            demand[parent] = demand[parent].with(wrench.seen_from(arm[index]));
        }
        let Some(column) = body.column else { continue };
        let part = match body.motion {
            JointMotion::Root => {
                (bias[0], bias[1]) = (wrench.linear.x, wrench.linear.z);
                wrench.moment
            }
            JointMotion::Revolute { rate, .. } => rate * wrench.moment,
            JointMotion::Prismatic { .. } => direction[index].dot(wrench.linear),
            JointMotion::Fixed => continue,
        };
        plan.bring(&mut bias[column], part);
    }
}

/// Returns the acceleration of the point at `arm` from the origin of `body` while no coordinate accelerates \[m/s^2\].
pub(super) fn point_drift<T: Real>(body: usize, arm: Vector<T>, workspace: &Workspace<T>) -> Vector<T> {
    workspace.drift[body] - arm * workspace.squared_spin[body]
}

impl<T: Real> ContactPoint<T> {
    /// Returns sigma in the world's axes \[m/s^2\]. Requires the results of [`bias`].
    pub fn drift(&self, workspace: &Workspace<T>) -> Vector<T> {
        point_drift(self.body, workspace.rotation[self.body].apply(self.center), workspace)
    }
}
