//! Kinetic energy, body by body; independent of the mass matrix, which tests check against it.
//!
//! ```text
//!     T = sum of 1/2 (m u.u + 2 omega u.turned(h) + I omega^2) + 1/2 rotor rate^2
//! ```
//!
//! with u the velocity of a body's origin, h and I its first and second moments about it.

use super::jacobian::{point_velocity, spin};
use super::workspace::Workspace;
use crate::dynamics::plan::{Motion, Plan};
use crate::planar::Vector;

use crate::scalar::Real;

/// Kinetic energy \[J\] for `velocity` (dq/dt by coordinate, braked joints included), after `kinematics`.
pub fn kinetic_energy<T: Real>(plan: &Plan<T>, velocity: &[T], workspace: &Workspace<T>) -> T {
    let mut twice = T::zero();
    for (index, body) in plan.bodies.iter().enumerate() {
        let rate = spin(plan, index, velocity);
        let origin = point_velocity(plan, index, Vector::zero(), velocity, workspace);
        let first = workspace.rotation[index].apply(body.inertia.first);
        let cross = rate * origin.dot(first.perpendicular());
        twice = twice + body.inertia.mass * origin.dot(origin) + cross + cross + body.inertia.second * rate * rate;
        if !matches!(body.motion, Motion::Root | Motion::Fixed) {
            let own = velocity[body.coordinate];
            twice = twice + body.rotor * own * own;
        }
    }
    T::from_f64(0.5) * twice
}
