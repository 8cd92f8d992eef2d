//! A state's contact problem in any kind of number, step by step, so that every step can be timed.
//!
//! ```text
//!     state --trigonometry--> configuration --> Assembly: kinematics, M, L^T D L | articulated bodies, J, G
//!                                                                          └── Cholesky ──────────────> G
//! ```

use crate::dynamics::mass_matrix;
use crate::pipeline::assembly::{Assembly, Elimination};
use crate::pipeline::exact::{Contacts, ExactState};
use crate::scalar::Trigonometry;
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

/// A state compiled in numbers of kind `T`, with the memory that its computation uses.
pub(super) struct Computation<'a, T> {
    pub state: &'a ExactState<'a>,
    pub assembly: Assembly<T>,
    /// v by coordinate, adjusted so that the stance and the loops hold.
    pub velocity: Vec<T>,
}

impl<'a, T: Trigonometry> Computation<'a, T> {
    /// Compiles the robot; computes nothing that depends on the state.
    pub fn new(state: &'a ExactState<'a>) -> Self {
        Self { state, assembly: state.assembly(state.plan()), velocity: Vec::new() }
    }

    /// Computes the positions of all bodies from the f64 state.
    pub fn place(&mut self) {
        let Self { state, assembly, velocity } = self;
        assembly.configuration.set(&assembly.plan, state.position);
        state.place(assembly);
        velocity.clear();
        velocity.extend(state.velocity.iter().map(|&entry| T::from_f64(entry)));
    }

    /// Computes G by the sparse factorization of M, which never fails, and J and c, because loops are eliminated from
    /// them and from G.
    pub fn by_ltl(&mut self) -> bool {
        self.assembly.elimination = Elimination::Ltl;
        self.assembly.factorize();
        self.velocities();
        self.assembly.delassus();
        true
    }

    /// Computes G without M, which never fails.
    pub fn by_articulated_bodies(&mut self) -> bool {
        self.assembly.elimination = Elimination::ArticulatedBodies;
        self.assembly.factorize();
        self.assembly.delassus();
        true
    }

    /// Computes J and the contact velocities c = J v.
    pub fn velocities(&mut self) {
        self.state.contact_velocities(&mut self.assembly, &mut self.velocity);
    }

    /// Returns G, which is moved out of the workspace, and c with and without the applied impulses.
    pub fn collect(&mut self) -> Contacts<T> {
        if !self.state.scene.impulses.is_empty() {
            // The change by applied impulses needs a factor, which not every way to compute G leaves behind.
            self.assembly.factorize();
        }
        self.state.collect(&mut self.assembly)
    }
}

impl Computation<'_, f64> {
    /// Computes G by a dense Cholesky factorization of M; returns false if M is not numerically positive definite.
    pub fn by_dense_cholesky(&mut self) -> bool {
        mass_matrix(&self.assembly.plan, &mut self.assembly.workspace);
        self.velocities();
        let nv = self.assembly.plan.columns();
        let rows = 2 * self.assembly.points.len();
        let workspace = &mut self.assembly.workspace;
        // nalgebra reads only the lower triangle.
        let Some(factor) = DMatrix::from_row_slice(nv, nv, &workspace.mass_matrix).cholesky() else { return false };
        let mut half = DMatrix::from_iterator(nv, rows, (0..rows).flat_map(|row| workspace.jacobian_row(row)));
        if !factor.l_dirty().solve_lower_triangular_mut(&mut half) {
            return false;
        }
        let found = half.transpose() * &half;
        workspace.delassus.clear();
        workspace.delassus.extend((0..rows * rows).map(|entry| found[(entry / rows, entry % rows)]));
        true
    }
}
