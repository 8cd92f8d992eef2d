//! Virtual model control: the torques with which the joints imitate a spring and damper between two points.
//!
//! ```text
//!     F = force + stiffness (target - (p_a - p_b)) - damping (v_a - v_b)        tau = J_ab^T F,  J_ab = J_a - J_b
//! ```
//!
//! The law applies along x and z of the world, and about the normal for the angles of both bodies. F acts on a, and -F
//! acts on b. No joint can supply the part of J_ab^T F that belongs to a floating base. Source: Pratt, Chew, Torres,
//! Dilworth, Pratt, "Virtual model control: an intuitive approach for bipedal locomotion", IJRR 20, 2001. Cost:
//! O(depth).

use super::articulated_inertia::Wrench;
use super::jacobian::{point_velocity, spin};
use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::Vector;
use crate::scalar::Real;
use crate::state::SpringLaw;

/// An end of a virtual spring.
#[derive(Debug, Clone, Copy)]
pub enum SpringPoint<T> {
    /// A body's index, and a point in its frame \[m\].
    Body(usize, Vector<T>),
    /// A fixed point in the world \[m\].
    World(Vector<T>),
}

/// Force and joint torques that a virtual spring requires.
#[derive(Debug, Clone, PartialEq)]
pub struct SpringLoad<T = f64> {
    /// The force on a along x and z of the world, and the moment \[N, N, N m\].
    pub force: [T; 3],
    /// J_ab^T F by coordinate \[N, N m\]: the torque or force of a joint. The entries of a floating base are
    /// unrealized.
    pub generalized: Vec<T>,
}

impl<T: Real> SpringLoad<T> {
    /// Computes the load of a spring with the ends a and b and the laws along x, along z, and about the normal, at
    /// `position` (q) and `velocity` (dq/dt). Requires the results of the kinematics.
    pub fn of(
        (ends, laws): ([SpringPoint<T>; 2], [SpringLaw; 3]),
        plan: &Plan<T>,
        position: &[f64],
        velocity: &[T],
        workspace: &Workspace<T>,
    ) -> Self {
        let [(place_a, rate_a), (place_b, rate_b)] = ends.map(|end| end.motion(plan, position, velocity, workspace));
        let force: [T; 3] =
            std::array::from_fn(|axis| laws[axis].force(place_a[axis] - place_b[axis], rate_a[axis] - rate_b[axis]));
        let mut generalized = vec![T::zero(); velocity.len()];
        for (end, [x, z, moment]) in ends.into_iter().zip([force, force.map(|entry| -entry)]) {
            let SpringPoint::Body(body, point) = end else { continue };
            let wrench = Wrench::at(workspace.rotation[body].apply(point), Vector { x, z });
            let wrench = wrench.with(Wrench { moment, linear: Vector::zero() });
            inward(plan, body, wrench, workspace, |coordinate, part| {
                generalized[coordinate] = generalized[coordinate] + part;
            });
        }
        Self { force, generalized }
    }
}

impl<T: Real> SpringPoint<T> {
    /// Returns the pose [x, z, pitch] of the end, and its rate.
    fn motion(self, plan: &Plan<T>, position: &[f64], velocity: &[T], workspace: &Workspace<T>) -> ([T; 3], [T; 3]) {
        let (body, point) = match self {
            Self::World(Vector { x, z }) => return ([x, z, T::zero()], [T::zero(); 3]),
            Self::Body(body, point) => (body, point),
        };
        let arm = workspace.rotation[body].apply(point);
        let at = |coordinate: usize| T::from_f64(position[coordinate]);
        let (mut place, mut pitch) = (arm, T::zero());
        for (index, body) in plan.way_to_root(body) {
            match body.motion {
                JointMotion::Root if plan.floating => {
                    (place, pitch) = (place + Vector { x: at(0), z: at(1) }, pitch + at(2));
                }
                JointMotion::Revolute { sign, .. } => {
                    let q = at(body.coordinate);
                    let turn =
                        body.mimic.map_or(q, |mimic| T::from_f64(mimic.multiplier) * q + T::from_f64(mimic.offset));
                    pitch = pitch + sign * turn;
                }
                _ => {}
            }
            // The root has no arm.
            if body.parent.is_some() {
                place += workspace.arm[index];
            }
        }
        let moving = point_velocity(plan, body, arm, velocity, workspace);
        ([place.x, place.z, pitch], [moving.x, moving.z, spin(plan, body, velocity)])
    }
}

/// Passes a `wrench` on `body` toward the root, and reports its component along every coordinate on the path, including
/// those of braked joints.
fn inward<T: Real>(
    plan: &Plan<T>,
    body: usize,
    mut wrench: Wrench<T>,
    workspace: &Workspace<T>,
    mut visit: impl FnMut(usize, T),
) {
    for (index, body) in plan.way_to_root(body) {
        match body.motion {
            JointMotion::Root if plan.floating => {
                let parts = [wrench.linear.x, wrench.linear.z, wrench.moment];
                parts.into_iter().enumerate().for_each(|(coordinate, part)| visit(coordinate, part));
            }
            JointMotion::Revolute { rate, .. } => visit(body.coordinate, rate * wrench.moment),
            JointMotion::Prismatic { .. } => visit(body.coordinate, workspace.direction[index].dot(wrench.linear)),
            JointMotion::Root | JointMotion::Fixed => {}
        }
        if body.parent.is_some() {
            wrench = wrench.seen_from(workspace.arm[index]);
        }
    }
}
