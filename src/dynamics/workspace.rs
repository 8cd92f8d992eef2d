//! Memory of the dynamics, reused from state to state.

use super::articulated_inertia::{ArticulatedInertia, Wrench};
use super::ltl::LtlFactor;
use crate::planar::{Inertia, Pair, Rotation, Vector};

/// Everything that the dynamics of one state computes; nb bodies, nv columns of the plan, n contacts.
#[derive(Debug, Clone, Default)]
pub struct Workspace<T = f64> {
    // Computed by `kinematics`.
    /// Turn of each body from the world's axes. nb
    pub rotation: Vec<Rotation<T>>,
    /// Position of each body's origin from its parent's, in the world's axes \[m\]. nb
    pub arm: Vec<Vector<T>>,
    /// Motion of each prismatic joint for a unit rate of its column, in the world's axes; of no meaning for others. nb
    pub direction: Vec<Vector<T>>,

    // Computed by `mass_matrix` and `mass_diagonal`.
    /// Inertia of each body and all that it carries, about its origin in the world's axes. nb
    pub composite: Vec<Inertia<T>>,

    // Computed by `mass_diagonal`.
    /// M's diagonal. nv
    pub diagonal: Vec<T>,

    // Computed by `mass_matrix`.
    /// M by rows, its lower triangle along the tree's branches; the rest is zero. nv x nv
    pub mass_matrix: Vec<T>,

    // Computed by `factorize`.
    /// M = L^T D L. nv x nv
    pub factor: LtlFactor<T>,

    // Computed by `articulated_inertias`.
    /// Inertia that each body shows at its origin while the joints beyond it give way. nb
    pub articulated: Vec<ArticulatedInertia<T>>,
    /// D of M = L^T D L, without M. nv
    pub pivots: Vec<T>,

    // Computed by `contact_jacobian`.
    /// J by contacts and columns, [tangential, normal]. n x nv
    pub contact_jacobian: Vec<Pair<T>>,
    /// The greatest column that moves each contact; all others that do are its ancestors. n
    pub(crate) branch: Vec<Option<usize>>,
    /// Contact velocities c = J v, braked joints' rates included \[m/s\]. n
    pub contact_velocity: Vec<Pair<T>>,

    // Computed by `demands`.
    /// Rate of turn of each body \[rad/s\]. nb
    pub spin: Vec<T>,
    /// Its square, zero of a body that was said not to turn \[rad^2/s^2\]. nb
    pub(super) squared_spin: Vec<T>,
    /// Acceleration of each body's origin while no coordinate accelerates, in the world's axes \[m/s^2\]. nb
    pub drift: Vec<Vector<T>>,
    /// What each body demands for that, against gravity as well, about its origin; spent by what sums it up. nb
    pub(super) demand: Vec<Wrench<T>>,

    // Computed by `bias`.
    /// Forces that keep the coordinates from accelerating, against gravity as well \[N, N m\]. nv
    pub bias: Vec<T>,

    // Computed by `orthogonalize`.
    /// The rows of loops and of joints that keep their rates.
    pub loops: LoopRows<T>,

    // Computed by `delassus` or `articulated_delassus`.
    /// Y = L^-T J^T by contacts and columns, [tangential, normal], so that G = Y^T D^-1 Y. n x nv
    pub half: Vec<Pair<T>>,
    /// D^-1 Y in the same order. n x nv
    pub half_by_d: Vec<Pair<T>>,
    /// G by rows \[1/kg\], after `eliminate_loops` without what the loops do not let move. 2n x 2n
    pub delassus: Vec<T>,
}

impl<T: Copy> Workspace<T> {
    /// A row of J by columns: tangential (2i) or normal (2i + 1) of contact i, which there must be.
    #[cfg(any(test, feature = "accuracy"))]
    pub(crate) fn jacobian_row(&self, row: usize) -> impl Iterator<Item = T> + '_ {
        let nv = self.contact_jacobian.len() / self.contact_velocity.len();
        self.contact_jacobian[row / 2 * nv..][..nv].iter().map(move |own| own[row % 2])
    }
}

/// The constraints of joints that keep their rates, one row each, and of all loops, two rows (x and z in the world's
/// axes) per loop, as `orthogonalize` leaves them.
#[derive(Debug, Clone, Default)]
pub struct LoopRows<T = f64> {
    /// Coordinates that keep their rates; their rows come first.
    pub(super) kept: Vec<usize>,
    /// Rows of K in the order of their elimination: 2 loop + axis; without those that depend on others.
    pub(super) rows: Vec<usize>,
    /// Z by columns, those of a foot at rest behind those of the loops. nv each
    pub(super) basis: Vec<T>,
    /// D^-1 Z by columns.
    pub(super) basis_by_d: Vec<T>,
    /// Z^T D^-1 Z, which is diagonal.
    pub(super) squares: Vec<T>,
    /// C below its unit diagonal, by rows of the full square.
    pub(super) coupling: Vec<T>,
}
