//! A state with its contacts, ready to be computed in any number.
//!
//! ```text
//!     state --trigonometry--> posture --kinematics--> M, L^T D L or Cholesky, J --> G
//!                                          └── articulated bodies ──────────────> G
//! ```

use super::number::Number;
use crate::contact::Contact;
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{
    ContactPoint, Workspace, articulated_delassus, articulated_inertias, contact_jacobian, delassus, factorize,
    kinematics, mass_matrix, point_velocity,
};
use crate::impact::ContactProblem;
use crate::pipeline::Impact;
use crate::planar::Rotation;
use crate::robot::Robot;
use crate::state::Ground;
use crate::state::State;
use nalgebra::DMatrix;
use serde::Serialize;

/// How G = J M^-1 J^T is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Factorization {
    /// M = L^T D L along the tree's branches.
    SparseLtl,
    /// M = L L^T without regard to zeros, by nalgebra.
    DenseCholesky,
    /// No M at all: articulated bodies.
    ArticulatedBodies,
}

/// A state whose contacts are known.
#[derive(Debug, Clone)]
pub struct Pose<'a> {
    pub(super) robot: &'a Robot,
    pub(super) state: &'a State,
    /// The closed contacts.
    contacts: &'a [Contact],
    /// The same in f64.
    pub(super) points: Vec<ContactPoint>,
    /// The contact (an index) that is at rest whatever the base velocity says.
    pub(super) stance: Option<usize>,
}

impl<'a> Pose<'a> {
    /// `state` with the contacts that `impact`, its answer, found.
    pub fn new(robot: &'a Robot, state: &'a State, impact: &'a Impact) -> Self {
        let stands = |link: usize| {
            let mut speeds = impact.contacts.iter().zip(&impact.velocity_before);
            speeds.position(|(contact, speed)| contact.link == link && *speed == [0.0; 2])
        };
        Self {
            robot,
            state,
            points: impact.contacts.iter().map(Contact::point_of).collect(),
            contacts: &impact.contacts,
            stance: state.scene.stance.and_then(stands),
        }
    }

    /// Everything in f64, by the sparse factorization of M.
    pub(super) fn computed(&self) -> Computation<f64> {
        let mut computation = Computation::new(self);
        computation.place(self);
        computation.by_ltl(self);
        computation
    }

    /// The contact problem in f64, without applied impulses; none without friction.
    pub fn problem(&self) -> Option<ContactProblem> {
        let (shape, computation) = (self.shape()?, self.computed());
        let Workspace { delassus, contact_velocity, .. } = computation.workspace();
        let (friction, restitution) = (shape.laws().to_vec(), shape.restitution().to_vec());
        ContactProblem::new(delassus.clone(), contact_velocity.clone(), friction, restitution).ok()
    }

    /// Friction and restitution of the contacts as a problem whose matrices are still to be filled in; none without
    /// friction.
    pub(super) fn shape(&self) -> Option<ContactProblem> {
        let scene = &self.state.scene;
        let links = self.contacts.iter().map(|contact| contact.link);
        let friction = links.clone().map(|link| scene.friction.of(link)).collect::<Option<Vec<_>>>()?;
        let restitution = links.map(|link| scene.restitution.of(link).unwrap_or(0.0)).collect();
        let contacts = self.contacts.len();
        let unit = (0..4 * contacts * contacts).map(|at| f64::from(u8::from(at % (2 * contacts + 1) == 0))).collect();
        ContactProblem::new(unit, vec![[0.0; 2]; contacts], friction, restitution).ok()
    }
}

/// A pose compiled in numbers of kind `T`, and the memory of its computation.
#[derive(Debug, Clone)]
pub struct Computation<T> {
    plan: Plan<T>,
    posture: Configuration<T>,
    points: Vec<ContactPoint<T>>,
    velocity: Vec<T>,
    workspace: Workspace<T>,
}

impl<T: Number> Computation<T> {
    /// Compiles the robot; nothing that hangs on the state is computed yet.
    pub fn new(pose: &Pose) -> Self {
        let scene = &pose.state.scene;
        Self {
            plan: Plan::new(pose.robot, &scene.held, &scene.rotor_inertia),
            posture: Configuration::default(),
            points: Vec::new(),
            velocity: Vec::new(),
            workspace: Workspace::default(),
        }
    }

    /// Positions of all bodies, from the f64 state on; of a base that a foot places, its velocity too.
    pub fn place(&mut self, pose: &Pose) {
        let Self { plan, posture, points, velocity, workspace } = self;
        let number = |entry: &f64| T::from_f64(*entry);
        posture.displacement.clear();
        posture.displacement.extend(pose.state.position.iter().map(number));
        posture.cos.clear();
        posture.sin.clear();
        for &angle in &pose.state.position {
            let Rotation { cos, sin } = T::rotation(angle);
            posture.cos.push(cos);
            posture.sin.push(sin);
        }
        kinematics(plan, posture, workspace);
        let axes = |contact: &Contact| match pose.state.scene.ground {
            // Level ground is level in every number.
            Ground::Slope(0.0) => Rotation::identity(),
            Ground::Slope(slope) => T::rotation(-slope),
            Ground::Profile(_) => {
                Rotation { cos: T::from_f64(contact.ground.cos), sin: T::from_f64(contact.ground.sin) }
            }
        };
        points.clear();
        points.extend(pose.contacts.iter().map(|contact| contact.exact_point(pose.robot, axes(contact))));
        velocity.clear();
        velocity.extend(pose.state.velocity.iter().map(number));
        if let (Some(stance), true) = (pose.stance, plan.floating) {
            velocity[..2].fill(T::zero());
            let arm = points[stance].arm(workspace);
            let moving = point_velocity(plan, points[stance].body, arm, velocity, workspace);
            velocity[..2].copy_from_slice(&(-moving).components());
        }
    }

    /// M, by composite rigid bodies.
    pub fn mass_matrix(&mut self) {
        mass_matrix(&self.plan, &mut self.workspace);
    }

    /// G without M.
    pub fn by_articulated_bodies(&mut self) {
        articulated_inertias(&self.plan, &mut self.workspace);
        articulated_delassus(&self.plan, &self.points, &mut self.workspace);
    }

    /// G by the sparse factorization of M; and J and c.
    pub fn by_ltl(&mut self, pose: &Pose) {
        self.mass_matrix();
        factorize(&self.plan, &mut self.workspace);
        self.velocities(pose);
        delassus(&self.plan, &mut self.workspace);
    }

    /// J and the contact velocities c = J v.
    pub fn velocities(&mut self, pose: &Pose) {
        contact_jacobian(&self.plan, &self.points, &self.velocity, pose.stance, &mut self.workspace);
    }

    /// v, by coordinate; that of a base which a foot places included.
    pub fn velocity(&self) -> &[T] {
        &self.velocity
    }

    /// What was computed.
    pub fn workspace(&self) -> &Workspace<T> {
        &self.workspace
    }

    /// The robot in these numbers.
    pub fn plan(&self) -> &Plan<T> {
        &self.plan
    }
}

impl Computation<f64> {
    /// G by a dense Cholesky factorization of M; false where M is not positive definite to it.
    pub fn by_cholesky(&mut self, pose: &Pose) -> bool {
        self.mass_matrix();
        self.velocities(pose);
        let nv = self.plan.columns();
        let rows = 2 * self.points.len();
        let workspace = &mut self.workspace;
        // Only the lower triangle is read.
        let Some(factor) = DMatrix::from_row_slice(nv, nv, &workspace.mass_matrix).cholesky() else { return false };
        let mut half = DMatrix::from_row_slice(rows, nv, &workspace.contact_jacobian).transpose();
        if !factor.l_dirty().solve_lower_triangular_mut(&mut half) {
            return false;
        }
        let found = half.transpose() * &half;
        workspace.delassus.clear();
        workspace.delassus.extend((0..rows * rows).map(|entry| found[(entry / rows, entry % rows)]));
        true
    }
}
