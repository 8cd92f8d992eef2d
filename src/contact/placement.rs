//! Where the bodies are in the world.

use super::point::{Circle, Point, Touch};
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{Workspace, kinematics};
use crate::planar::{Rotation, Vector};
use crate::robot::{Base, Rim, Robot};

/// The pose of each body of a robot.
#[derive(Debug, Clone, Default)]
pub struct Placement {
    /// Origin of each body in the world \[m\].
    origins: Vec<Vector<f64>>,
    /// Pitch of each body as a rotation.
    turns: Vec<Rotation<f64>>,
}

impl Placement {
    /// Creates the placement with the root's origin at `base` \[m\]. Requires the results of `kinematics`.
    pub fn new(plan: &Plan<f64>, workspace: &Workspace<f64>, base: Vector<f64>) -> Self {
        Self::default().moved(plan, workspace, base)
    }

    /// Does the same as [`Placement::new`] in the memory of `self`.
    pub fn moved(mut self, plan: &Plan<f64>, workspace: &Workspace<f64>, base: Vector<f64>) -> Self {
        self.origins.clear();
        for (body, &arm) in plan.bodies.iter().zip(&workspace.arm) {
            self.origins.push(body.parent.map_or(base, |parent| self.origins[parent] + arm));
        }
        self.turns.clone_from(&workspace.rotation);
        self
    }

    /// Creates the placement of `robot` at `position` (q).
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

    /// Returns the placement moved up by `rise` along z \[m\].
    pub(super) fn raised(&self, rise: f64) -> Self {
        let raised = |&Vector { x, z }: &Vector<f64>| Vector::new(x, z + rise);
        Self { origins: self.origins.iter().map(raised).collect(), turns: self.turns.clone() }
    }

    /// Returns the root's origin in the world \[m\].
    pub(crate) fn base(&self) -> Vector<f64> {
        self.origins.first().copied().unwrap_or_default()
    }

    /// Returns the world coordinates of the point `local` in the frame of `body`; both in \[m\].
    pub fn world(&self, body: usize, local: Vector<f64>) -> Vector<f64> {
        self.origins[body] + self.turned(body, local)
    }

    /// Returns the material point of a contact in the world \[m\].
    pub(super) fn touched(&self, Touch { circle, ground, .. }: &Touch) -> Vector<f64> {
        self.world(circle.body, circle.center) - ground.apply(Vector::new(0.0, 1.0)) * circle.radius
    }

    /// Returns a vector of a body's frame in the world's axes.
    pub fn turned(&self, body: usize, vector: Vector<f64>) -> Vector<f64> {
        self.turns[body].apply(vector)
    }

    /// Returns a vector of the world in a body's axes.
    pub(super) fn turned_back(&self, body: usize, vector: Vector<f64>) -> Vector<f64> {
        self.turns[body].back().apply(vector)
    }

    /// Returns the circle with which `point` touches ground of this normal. For an ellipse it has the radius 0 and the
    /// material point that is lowest along the normal in this placement.
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
