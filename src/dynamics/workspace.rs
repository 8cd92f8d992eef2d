//! Memory of the dynamics, reused for each state.

use super::articulated_inertia::{ArticulatedInertia, Wrench};
use super::ltl::LtlFactor;
use crate::planar::{Inertia, Pair, Rotation, Vector};

/// All results of the dynamics of one state. The last words of a field's comment are its size: nb bodies, nv columns of
/// the plan, n contacts.
#[derive(Debug, Clone, Default)]
pub struct Workspace<T = f64> {
    // Computed by `kinematics`.
    /// Rotation of each body relative to the world's axes. nb
    pub rotation: Vec<Rotation<T>>,
    /// Vector from the origin of each body's parent to the body's origin, in the world's axes \[m\]. nb
    pub arm: Vec<Vector<T>>,
    /// Motion of each prismatic joint for a unit rate of its column, in the world's axes; zero for other joints. nb
    pub direction: Vec<Vector<T>>,

    // Computed by `mass_matrix` and `mass_diagonal`.
    /// Inertia of each body with all bodies that it carries, about its origin in the world's axes. nb
    pub composite: Vec<Inertia<T>>,

    // Computed by `mass_diagonal`.
    /// Diagonal of M. nv
    pub diagonal: Vec<T>,

    // Computed by `mass_matrix`.
    /// M by rows: the lower triangle along the branches of the tree; other entries are zero. nv x nv
    pub mass_matrix: Vec<T>,

    // Computed by `factorize`.
    /// M = L^T D L. nv x nv
    pub factor: LtlFactor<T>,

    // Computed by `articulated_inertias`.
    /// Articulated-body inertia of each body at its origin. nb
    pub articulated: Vec<ArticulatedInertia<T>>,
    /// D of M = L^T D L, computed without M. nv
    pub pivots: Vec<T>,

    // Computed by `contact_jacobian`.
    /// J by contacts and columns, [tangential, normal]. n x nv
    pub contact_jacobian: Vec<Pair<T>>,
    /// The greatest column that moves each contact; the other columns that move it are ancestors of this one. n
    pub(crate) branch: Vec<Option<usize>>,
    /// Contact velocities c = J v, including the rates of braked joints \[m/s\]. n
    pub contact_velocity: Vec<Pair<T>>,

    // Computed by `demands`.
    /// Angular velocity of each body \[rad/s\]. nb
    pub spin: Vec<T>,
    /// Square of `spin`; zero for bodies marked as not rotating \[rad^2/s^2\]. nb
    pub(super) squared_spin: Vec<T>,
    /// Acceleration of each body's origin while no coordinate accelerates, in the world's axes \[m/s^2\]. nb
    pub drift: Vec<Vector<T>>,
    /// Wrench about its origin that each body requires for its drift and against gravity. Overwritten when it is summed
    /// up. nb
    pub(super) demand: Vec<Wrench<T>>,

    // Computed by `bias`.
    /// Forces that keep the coordinates from accelerating, including those against gravity \[N, N m\]. nv
    pub bias: Vec<T>,

    // Computed by `orthogonalize`.
    /// The rows of the loops, and of joints with a column that keep their rates.
    pub loops: LoopRows<T>,

    // Computed by `delassus` or `articulated_delassus`.
    /// Y = L^-T J^T by contacts and columns, [tangential, normal], so that G = Y^T D^-1 Y. n x nv
    pub half: Vec<Pair<T>>,
    /// D^-1 Y in the same order. n x nv
    pub half_by_d: Vec<Pair<T>>,
    /// G by rows \[1/kg\]; after `eliminate_loops`, G under the loop constraints. 2n x 2n
    pub delassus: Vec<T>,
}

impl<T: Copy> Workspace<T> {
    /// Returns a row of J by columns: tangential (2i) or normal (2i + 1) of contact i. There must be a contact.
    #[cfg(any(test, feature = "accuracy"))]
    pub(crate) fn jacobian_row(&self, row: usize) -> impl Iterator<Item = T> + '_ {
        let nv = self.contact_jacobian.len() / self.contact_velocity.len();
        self.contact_jacobian[row / 2 * nv..][..nv].iter().map(move |pair| pair[row % 2])
    }
}

/// The constraints, orthogonalized by `orthogonalize`: one row per joint that keeps its rate, and two rows per loop (x
/// and z in the world's axes).
#[derive(Debug, Clone, Default)]
pub struct LoopRows<T = f64> {
    /// Coordinates that keep their rates. Their rows come first.
    pub(super) kept: Vec<usize>,
    /// Rows of K (2 loop + axis) in the order of elimination, without rows that depend on others.
    pub(super) rows: Vec<usize>,
    /// Z, one row of nv entries per constraint. The rows of a foot at rest come last.
    pub(super) basis: Vec<T>,
    /// D^-1 Z in the same order.
    pub(super) basis_by_d: Vec<T>,
    /// The diagonal of Z^T D^-1 Z; its other entries are zero.
    pub(super) squares: Vec<T>,
    /// C below its unit diagonal, stored by rows as a full square.
    pub(super) coupling: Vec<T>,
}
