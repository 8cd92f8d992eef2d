//! A state with its contacts, ready to be computed in any number.
//!
//! ```text
//!     state --trigonometry--> configuration --> Assembly: kinematics, M, L^T D L | articulated bodies, J, G
//!                                                                          └── Cholesky ──────────────> G
//! ```

use super::number::Number;
use crate::contact::Contact;
use crate::dynamics::plan::Plan;
use crate::dynamics::{ContactPoint, Workspace, mass_matrix};
use crate::impact::ContactProblem;
use crate::pipeline::Impact;
use crate::pipeline::assembly::{Assembly, Elimination};
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
    /// The contact (an index) that is at rest whatever the base velocity is.
    stance: Option<usize>,
    /// The contact problem in f64.
    pub(super) problem: &'a ContactProblem,
}

impl<'a> Pose<'a> {
    /// `state` with the contacts that `impact`, its answer, found.
    pub fn new(robot: &'a Robot, state: &'a State, impact: &'a Impact) -> Self {
        Self {
            robot,
            state,
            points: impact.contacts.iter().map(Contact::point_of).collect(),
            contacts: &impact.contacts,
            stance: impact.stance,
            problem: &impact.problem,
        }
    }

    /// Everything in f64, by the sparse factorization of M.
    pub(super) fn computed(&self) -> Computation<f64> {
        let mut computation = Computation::new(self);
        computation.place(self);
        computation.by_ltl(self);
        computation
    }
}

/// A pose compiled in numbers of kind `T`, and the memory of its computation.
#[derive(Debug, Clone)]
pub struct Computation<T> {
    assembly: Assembly<T>,
    velocity: Vec<T>,
}

impl<T: Number> Computation<T> {
    /// Compiles the robot; nothing that depends on the state is computed yet.
    pub fn new(pose: &Pose) -> Self {
        let scene = &pose.state.scene;
        let assembly = Assembly::new(Plan::new(pose.robot, &scene.held, &scene.rotor_inertia));
        Self { assembly, velocity: Vec::new() }
    }

    /// Positions of all bodies, from the f64 state on; of a base that a foot places, its velocity too.
    pub fn place(&mut self, pose: &Pose) {
        let Self { assembly, velocity } = self;
        let number = |entry: &f64| T::from_f64(*entry);
        let configuration = &mut assembly.configuration;
        configuration.displacement.clear();
        configuration.displacement.extend(pose.state.position.iter().map(number));
        configuration.cos.clear();
        configuration.sin.clear();
        for &angle in &pose.state.position {
            let Rotation { cos, sin } = T::rotation(angle);
            configuration.cos.push(cos);
            configuration.sin.push(sin);
        }
        assembly.place();
        let axes = |contact: &Contact| match pose.state.scene.ground {
            // Level ground is level in every number.
            Ground::Slope(0.0) => Rotation::identity(),
            Ground::Slope(slope) => T::rotation(-slope),
            Ground::Profile(_) => {
                Rotation { cos: T::from_f64(contact.ground.cos), sin: T::from_f64(contact.ground.sin) }
            }
        };
        assembly.points.clear();
        assembly.points.extend(pose.contacts.iter().map(|contact| contact.exact_point(pose.robot, axes(contact))));
        velocity.clear();
        velocity.extend(pose.state.velocity.iter().map(number));
        if let (Some(stance), true) = (pose.stance, assembly.plan.floating) {
            assembly.rest(&assembly.points[stance], velocity);
        }
    }

    /// G without M.
    pub fn by_articulated_bodies(&mut self) {
        self.assembly.elimination = Elimination::ArticulatedBodies;
        self.assembly.factorize();
        self.assembly.delassus();
    }

    /// G by the sparse factorization of M; and J and c.
    pub fn by_ltl(&mut self, pose: &Pose) {
        self.assembly.elimination = Elimination::Ltl;
        self.assembly.factorize();
        self.velocities(pose);
        self.assembly.delassus();
    }

    /// J and the contact velocities c = J v.
    pub fn velocities(&mut self, pose: &Pose) {
        self.assembly.contact_jacobian(&self.velocity, pose.stance);
    }

    /// v, by coordinate; that of a base which a foot places included.
    pub fn velocity(&self) -> &[T] {
        &self.velocity
    }

    /// What was computed.
    pub fn workspace(&self) -> &Workspace<T> {
        &self.assembly.workspace
    }

    /// The robot in these numbers.
    pub fn plan(&self) -> &Plan<T> {
        &self.assembly.plan
    }
}

impl Computation<f64> {
    /// G by a dense Cholesky factorization of M; false if M is not positive definite to it.
    pub fn by_cholesky(&mut self, pose: &Pose) -> bool {
        mass_matrix(&self.assembly.plan, &mut self.assembly.workspace);
        self.velocities(pose);
        let nv = self.assembly.plan.columns();
        let rows = 2 * self.assembly.points.len();
        let workspace = &mut self.assembly.workspace;
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
