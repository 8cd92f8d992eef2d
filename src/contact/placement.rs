//! Where the bodies are in the world.

use super::point::{Circle, Point};
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{Workspace, kinematics};
use crate::planar::{Rotation, Vector};
use crate::robot::{Base, Rim, Robot};

/// Where each body of a robot is.
#[derive(Debug, Clone, Default)]
pub struct Placement {
    /// Origin of each body in the world \[m\].
    origins: Vec<Vector<f64>>,
    /// Pitch of each body as a turn.
    turns: Vec<Rotation<f64>>,
}

impl Placement {
    /// The bodies after `kinematics`, with the root's origin at `base` \[m\].
    pub fn new(plan: &Plan<f64>, workspace: &Workspace<f64>, base: Vector<f64>) -> Self {
        Self::default().moved(plan, workspace, base)
    }

    /// As [`Placement::new`], in the memory of another one.
    pub fn moved(mut self, plan: &Plan<f64>, workspace: &Workspace<f64>, base: Vector<f64>) -> Self {
        self.origins.clear();
        for (body, &arm) in plan.bodies.iter().zip(&workspace.arm) {
            self.origins.push(body.parent.map_or(base, |parent| self.origins[parent] + arm));
        }
        self.turns.clone_from(&workspace.rotation);
        self
    }

    /// The bodies of `robot` at `position` (q).
    pub fn of_robot(robot: &Robot, position: &[f64]) -> Self {
        let plan = Plan::new(robot, &[], &[]);
        let (mut configuration, mut workspace) = (Configuration::default(), Workspace::default());
        configuration.set(&plan, position);
        kinematics(&plan, &configuration, &mut workspace);
        let base = match (robot.base, position) {
            (Base::Floating, &[x, z, ..]) => Vector::new(x, z),
            _ => Vector::zero(),
        };
        Self::new(&plan, &workspace, base)
    }

    /// All bodies, higher by `rise` along z \[m\].
    pub(super) fn raised(&self, rise: f64) -> Self {
        let raised = |&Vector { x, z }: &Vector<f64>| Vector::new(x, z + rise);
        Self { origins: self.origins.iter().map(raised).collect(), turns: self.turns.clone() }
    }

    /// The root's origin in the world \[m\].
    pub(crate) fn base(&self) -> Vector<f64> {
        self.origins.first().copied().unwrap_or_default()
    }

    /// The world's point that is `local` in the frame of `body` \[m\].
    pub fn world(&self, body: usize, local: Vector<f64>) -> Vector<f64> {
        self.origins[body] + self.turned(body, local)
    }

    /// A vector of a body's frame in the world's axes.
    pub fn turned(&self, body: usize, vector: Vector<f64>) -> Vector<f64> {
        self.turns[body].apply(vector)
    }

    /// A vector of the world in a body's axes.
    pub(super) fn turned_back(&self, body: usize, vector: Vector<f64>) -> Vector<f64> {
        self.turns[body].back().apply(vector)
    }

    /// The circle that touches ground with this normal where `point` does: of an ellipse, with radius 0, the material
    /// point that is lowest along the normal now.
    pub(super) fn circle(&self, point: Point, normal: Vector<f64>) -> Circle {
        let Point { body, center, offset, rim } = point;
        match rim {
            Rim::Circle { radius } => Circle { body, center, offset, radius },
            Rim::Ellipse { .. } => {
                let down = self.turned_back(body, -normal);
                Circle { body, center: center + rim.support(down), offset, radius: 0.0 }
            }
        }
    }
}
