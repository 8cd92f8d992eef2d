//! Where the bodies are: R_i = R_p R(q_i), and the arms from origin to origin.
//!
//! Source: Featherstone 2008, section 4.1, in world axes. Cost: O(nb).

use super::workspace::Workspace;
use crate::dynamics::plan::{Configuration, Motion, Plan};
use crate::planar::{Rotation, Vector};
use crate::scalar::Real;

/// Computes every body's rotation and arm for a configuration (cos, sin and displacement per coordinate and mimic
/// joint).
///
/// Only differences of position enter the dynamics, so the base's x and z are not read.
pub fn kinematics<T: Real>(plan: &Plan<T>, posture: &Configuration<T>, workspace: &mut Workspace<T>) {
    let Workspace { rotation, arm, direction, .. } = workspace;
    rotation.clear();
    arm.clear();
    direction.clear();
    for body in &plan.bodies {
        let Some(parent) = body.parent else {
            rotation.push(if plan.floating { posture.turn(2) } else { Rotation::identity() });
            arm.push(Vector::zero());
            direction.push(Vector::zero());
            continue;
        };
        let base = rotation[parent];
        match body.motion {
            Motion::Root => {}
            Motion::Revolute { sign, .. } => {
                let Rotation { cos, sin } = posture.turn(body.place);
                rotation.push(base.then(Rotation { cos, sin: sign * sin }));
                arm.push(base.apply(body.origin));
                direction.push(Vector::zero());
            }
            Motion::Prismatic { direction: along, rate } => {
                let displaced = body.origin + along * posture.displacement[body.place];
                rotation.push(base);
                arm.push(base.apply(displaced));
                direction.push(base.apply(rate));
            }
            Motion::Fixed => {
                rotation.push(base);
                arm.push(base.apply(body.origin));
                direction.push(Vector::zero());
            }
        }
    }
}
