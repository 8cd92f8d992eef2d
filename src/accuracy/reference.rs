//! M, G and c with 320 bits or more, and the errors of other computations against them. The algorithms are those of
//! f64, so that differences are due to rounding alone; tests compare the algorithms with sums over bodies and with
//! kinetic energy.
//!
//! Errors are free of units. Those of M and G are relative to the geometric mean of the two diagonal entries; those of
//! contact velocities and impulses are relative to the scale of margins, S = max |c_i| / sqrt(G_ii).

use super::computation::{Computation, Factorization};
use super::number::Number;
use crate::dynamics::{Workspace, mass_matrix};
use crate::pipeline::exact::{Contacts, ExactState};
use crate::planar::Rotation;
use crate::robot::Robot;
use crate::scalar::{Ball, DoubleDouble, Enclosure, Interval, Ordered, Real};

/// Bits of the reference, and further bits per body, because an articulated inertia loses about that many against those
/// of its children. The numbers are enclosures, so that their own uncertainty counts as an error.
pub const PRECISION: usize = 320;
const PRECISION_PER_BODY: usize = 4;

/// Errors of M from here on are resolved by pairs of f64, whose own errors are about 1e-31.
const SHOWN_BY_PAIRS: f64 = 1e-24;

/// Runs `work` on numbers that have enough bits for `robot`.
pub fn with_precision<R>(robot: &Robot, work: impl FnOnce() -> R) -> R {
    Interval::scope(PRECISION + PRECISION_PER_BODY * robot.bodies.len(), work)
}

/// G, c and the poses of a state in the reference's numbers; valid only within one [`with_precision`].
pub(super) struct Reference<'a> {
    computation: Computation<'a, Interval>,
    /// The factorization by which G was computed.
    pub factorization: Factorization,
    pub contacts: Contacts<Interval>,
}

impl<'a> Reference<'a> {
    /// Computes poses, G and c.
    pub fn new(state: &'a ExactState<'a>) -> Self {
        let mut computation = Computation::new(state);
        computation.place();
        let factorization = if computation.assembly.has_articulated_bodies() {
            computation.by_articulated_bodies();
            computation.velocities();
            Factorization::ArticulatedBodies
        } else {
            computation.by_ltl();
            Factorization::SparseLtl
        };
        Self { factorization, contacts: computation.collect(), computation }
    }

    /// Returns the uncertainty of the reference's own G.
    pub fn own_error(&self) -> f64 {
        self.worst_of_delassus(|_, exact| exact.error())
    }

    /// Returns the largest error of G; NaN if an entry of `delassus` is not a number.
    pub fn delassus_error<T: Number>(&self, delassus: &[T]) -> f64 {
        self.worst_of_delassus(|at, exact| distance(delassus[at], exact))
    }

    fn worst_of_delassus(&self, error: impl Fn(usize, Interval) -> f64) -> f64 {
        let exact = &self.contacts.delassus;
        let rows = exact.len().isqrt();
        let size = |row: usize| exact[row * rows + row].to_f64().sqrt();
        worst((0..exact.len()).map(|at| relative(error(at, exact[at]), size(at / rows) * size(at % rows))))
    }

    /// Returns the largest error of M (nv x nv, columns of the plan; only the lower triangle is read); NaN if an entry
    /// is not a number.
    pub fn mass_matrix_error<T: Number>(&self, mass: &[T]) -> f64 {
        // Pairs of f64 are faster, and resolve all but the smallest errors.
        let error = self.mass_matrix_error_by(mass, enclosed);
        let is_shown = (SHOWN_BY_PAIRS..f64::INFINITY).contains(&error);
        // Poses need bits for each body, because errors grow with every rotation; M is then a sum without rotations.
        let exactly = || self.mass_matrix_error_by(mass, |exact| exact * Interval::one());
        if is_shown { error } else { Interval::scope(PRECISION, exactly) }
    }

    /// Returns the error of M against an M that is computed from the poses, converted to other numbers by `rounded`.
    fn mass_matrix_error_by<T: Number, R: Ordered>(&self, mass: &[T], rounded: fn(Interval) -> R) -> f64 {
        let (plan, poses) = (self.computation.state.plan::<R>(), &self.computation.assembly.workspace);
        let mut workspace = Workspace::default();
        let turns = poses.rotation.iter().map(|turn| Rotation { cos: rounded(turn.cos), sin: rounded(turn.sin) });
        workspace.rotation.extend(turns);
        workspace.arm.extend(poses.arm.iter().map(|arm| arm.map(rounded)));
        workspace.direction.extend(poses.direction.iter().map(|direction| direction.map(rounded)));
        mass_matrix(&plan, &mut workspace);
        let (nv, exact) = (plan.columns(), &workspace.mass_matrix);
        let size: Vec<f64> = (0..nv).map(|i| exact[i * nv + i].to_f64().sqrt()).collect();
        let branches = (0..nv).flat_map(|i| plan.branch(Some(i)).map(move |j| (i, j)));
        worst(branches.map(|(i, j)| {
            let error = R::freeing(|| distance(mass[i * nv + j], exact[i * nv + j]));
            relative(error, size[i] * size[j])
        }))
    }
}

/// Returns a ball around the pair of f64s that is closest to `exact`; the ball contains `exact`.
fn enclosed(exact: Interval) -> Ball<DoubleDouble> {
    let head = exact.to_f64();
    let rest = exact - Interval::from_f64(head);
    let tail = rest.to_f64();
    let rest = rest - Interval::from_f64(tail);
    let rest = Ball::from_f64(2.0 * rest.to_f64().abs() + rest.error());
    (Ball::from_f64(head) + Ball::from_f64(tail)).widened(rest)
}

/// Returns an upper bound of the distance between `found` and `exact`.
pub fn distance<T: Number, R: Ordered>(found: T, exact: R) -> f64 {
    let [head, tail] = found.parts().map(R::from_f64);
    let difference = head + tail - exact;
    difference.to_f64().abs() + difference.error()
}

/// Returns `error` as a part of `size`; zero if there is no error.
pub fn relative(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / size }
}

/// The largest of the errors, or NaN if one is NaN.
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors
        .into_iter()
        .fold(0.0, |worst: f64, error| if worst.is_nan() || error.is_nan() { f64::NAN } else { worst.max(error) })
}
