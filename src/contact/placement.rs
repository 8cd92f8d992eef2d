//! Where the bodies are in the world.

use crate::dynamics::Workspace;
use crate::plan::Plan;
use crate::planar::{Rotation, Vector, sum};
use parry2d::math::{Pose, Vector as ParryVector};

/// Poses of all bodies.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Origin of each body in the world \[m\].
    origins: Vec<Vector<f64>>,
    /// Pitch of each body as a turn.
    turns: Vec<Rotation<f64>>,
}

impl Placement {
    /// The bodies after `kinematics`, with the root's origin at `base` \[m\].
    pub fn new(plan: &Plan<f64>, workspace: &Workspace<f64>, base: Vector<f64>) -> Self {
        let mut origins: Vec<Vector<f64>> = Vec::with_capacity(plan.bodies.len());
        for (body, &arm) in plan.bodies.iter().zip(&workspace.arm) {
            origins.push(body.parent.map_or(base, |parent| sum(origins[parent], arm)));
        }
        Self { origins, turns: workspace.rotation.clone() }
    }

    /// The root's origin in the world \[m\].
    pub(super) fn base(&self) -> Vector<f64> {
        self.origins.first().copied().unwrap_or_default()
    }

    /// The world's point that is `local` in the frame of `body` \[m\].
    pub(super) fn world(&self, body: usize, local: Vector<f64>) -> Vector<f64> {
        sum(self.origins[body], self.turns[body].apply(local))
    }

    /// The pose of a shape that is placed at `local` on `body`.
    pub(super) fn pose(&self, body: usize, local: Vector<f64>) -> Pose {
        let Rotation { cos, sin } = self.turns[body];
        let [x, z] = self.world(body, local);
        // parry turns counter-clockwise, a positive pitch clockwise.
        Pose::new(ParryVector::new(x, z), libm::atan2(-sin, cos))
    }
}
