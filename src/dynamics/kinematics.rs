//! Poses of the bodies: rotations R_i = R_p R(q_i), and the arm from the parent's origin to each body's origin.
//!
//! Source: Featherstone 2008, section 4.1, in world axes. Cost: O(nb).

use super::workspace::Workspace;
use crate::dynamics::plan::{Configuration, JointMotion, Plan};
use crate::planar::{Rotation, Vector};
use crate::scalar::Real;

/// Computes the rotation and arm of every body. The base's x and z are not read: only differences of position matter.
pub fn kinematics<T: Real>(plan: &Plan<T>, configuration: &Configuration<T>, workspace: &mut Workspace<T>) {
    let Workspace { rotation, arm, direction, .. } = workspace;
    rotation.clear();
    arm.clear();
    direction.clear();
    for body in &plan.bodies {
        let Some(parent) = body.parent else {
            rotation.push(if plan.floating { configuration.turns[2] } else { Rotation::identity() });
            arm.push(Vector::zero());
            direction.push(Vector::zero());
            continue;
        };
        let base = rotation[parent];
        arm.push(base.apply(match body.motion {
            JointMotion::Prismatic { direction, .. } => {
                body.origin + direction * configuration.displacement[body.place]
            }
            _ => body.origin,
        }));
        rotation.push(match body.motion {
            JointMotion::Revolute { sign, .. } => {
                let Rotation { cos, sin } = configuration.turns[body.place];
                base.then(Rotation { cos, sin: sign * sin })
            }
            _ => base,
        });
        direction.push(match body.motion {
            JointMotion::Prismatic { rate, .. } => base.apply(rate),
            _ => Vector::zero(),
        });
    }
}
