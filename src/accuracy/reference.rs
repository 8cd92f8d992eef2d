//! M, G and c to 320 bits and more, and how far others are from them.
//!
//! Errors are free of units: of M and G relative to the geometric mean of both diagonal entries, of contact velocities
//! and impulses by the scale of margins, S = max |c_i| / sqrt(G_ii).

use super::number::Number;
use super::pose::{Computation, Pose};
use crate::dynamics::plan::Motion;
use crate::planar::{Inertia, Pair, Vector};
use crate::robot::Robot;
use crate::scalar::{Interval, Ordered, Real};

/// Bits of the reference, and for each body: an articulated inertia is that much less sharp than its children's. The
/// numbers are enclosures, so that their own uncertainty shows as an error.
pub const PRECISION: usize = 320;
const PRECISION_PER_BODY: usize = 4;

/// Runs `work` on numbers with bits enough for `robot`.
pub fn with_precision<R>(robot: &Robot, work: impl FnOnce() -> R) -> R {
    Interval::scope(PRECISION + PRECISION_PER_BODY * robot.bodies.len(), work)
}

/// M, G and c of a pose in the reference's numbers; it must stay within one [`with_precision`].
#[derive(Debug)]
pub struct Reference {
    computation: Computation<Interval>,
    /// Each column's motion.
    columns: Vec<Column>,
}

/// A coordinate's unit motion and all that it moves.
#[derive(Debug, Clone, Copy)]
struct Column {
    axis: Axis,
    /// The joint's origin from the root's \[m\].
    origin: Vector<Interval>,
    /// All bodies beyond the joint, about its origin.
    moved: Inertia<Interval>,
    rotor: Interval,
}

#[derive(Debug, Clone, Copy)]
enum Axis {
    Revolute(Interval),
    Prismatic(Vector<Interval>),
}

impl Reference {
    /// Computes G and c, and what M follows from.
    pub fn new(pose: &Pose) -> Self {
        let mut computation = Computation::new(pose);
        computation.place(pose);
        computation.velocities(pose);
        computation.by_articulated_bodies();
        let columns = columns(&computation);
        Self { computation, columns }
    }

    /// G, 2n x 2n by rows.
    pub fn delassus(&self) -> &[Interval] {
        &self.computation.workspace().delassus
    }

    /// c, one entry per contact.
    pub fn velocity(&self) -> &[Pair<Interval>] {
        &self.computation.workspace().contact_velocity
    }

    /// How well G itself is known.
    pub fn own_error(&self) -> f64 {
        self.worst_of_delassus(|_, exact| exact.radius())
    }

    /// The largest error of a G; NaN where it holds no number.
    pub fn delassus_error<T: Number>(&self, delassus: &[T]) -> f64 {
        self.worst_of_delassus(|at, exact| distance(delassus[at], exact))
    }

    fn worst_of_delassus(&self, error: impl Fn(usize, Interval) -> f64) -> f64 {
        let exact = self.delassus();
        let rows = exact.len().isqrt();
        let size = |row: usize| exact[row * rows + row].to_f64().sqrt();
        worst((0..exact.len()).map(|at| relative(error(at, exact[at]), size(at / rows) * size(at % rows))))
    }

    /// The largest error of an M (nv x nv, columns of the plan, of which the lower triangle is read); NaN where it
    /// holds no number.
    pub fn mass_matrix_error<T: Number>(&self, mass: &[T]) -> f64 {
        let nv = self.columns.len();
        let parents = &self.computation.plan().parents;
        let size: Vec<f64> =
            (0..nv).map(|i| Interval::scope(PRECISION, || self.inertia(i, i).to_f64().sqrt())).collect();
        worst((0..nv).flat_map(|i| {
            let below = std::iter::successors(Some(i), |&column| parents[column]);
            let size = &size;
            below.map(move |j| {
                let error = Interval::scope(PRECISION, || distance(mass[i * nv + j], self.inertia(i, j)));
                relative(error, size[i] * size[j])
            })
        }))
    }

    /// Entry of M for two columns, the second one below the first or the same.
    ///
    /// Not by a walk to the root as [`mass_matrix`](crate::dynamics::mass_matrix) does it, but by the places of both.
    fn inertia(&self, upper: usize, lower: usize) -> Interval {
        let (beyond, below) = (&self.columns[upper], &self.columns[lower]);
        let Inertia { mass, first, second } = beyond.moved;
        let (linear, angular) = match beyond.axis {
            Axis::Revolute(sign) => (first.perpendicular() * sign, sign * second),
            Axis::Prismatic(along) => (along * mass, first.perpendicular().dot(along)),
        };
        let entry = match below.axis {
            Axis::Revolute(sign) => sign * (angular + (beyond.origin - below.origin).perpendicular().dot(linear)),
            Axis::Prismatic(along) => along.dot(linear),
        };
        if upper == lower { entry + beyond.rotor } else { entry }
    }
}

fn columns(computation: &Computation<Interval>) -> Vec<Column> {
    let (plan, workspace) = (computation.plan(), computation.workspace());
    let mut composite: Vec<Inertia<Interval>> = Vec::new();
    let mut origins: Vec<Vector<Interval>> = Vec::new();
    for (index, body) in plan.bodies.iter().enumerate() {
        composite.push(Inertia { first: workspace.rotation[index].apply(body.inertia.first), ..body.inertia });
        origins.push(body.parent.map_or(Vector::zero(), |parent| origins[parent] + workspace.arm[index]));
    }
    for (index, body) in plan.bodies.iter().enumerate().rev() {
        if let Some(parent) = body.parent {
            composite[parent] = composite[parent].with(composite[index].seen_from(workspace.arm[index]));
        }
    }
    let column = |axis, index: usize| Column {
        axis,
        origin: origins[index],
        moved: composite[index],
        rotor: plan.bodies[index].rotor,
    };
    let mut columns = Vec::new();
    for (index, body) in plan.bodies.iter().enumerate().filter(|(_, body)| body.column.is_some()) {
        match body.motion {
            Motion::Root => {
                columns.extend(Vector::axes().map(|axis| column(Axis::Prismatic(axis), index)));
                columns.push(column(Axis::Revolute(Interval::one()), index));
            }
            Motion::Revolute { sign, .. } => columns.push(column(Axis::Revolute(sign), index)),
            Motion::Prismatic { .. } => columns.push(column(Axis::Prismatic(workspace.direction[index]), index)),
            Motion::Fixed => {}
        }
    }
    columns
}

/// At most how far `found` is from `exact`.
pub fn distance<T: Number>(found: T, exact: Interval) -> f64 {
    let [head, tail] = found.parts().map(Interval::from_f64);
    let difference = head + tail - exact;
    difference.to_f64().abs() + difference.radius()
}

/// `error` in parts of `size`; zero if there is no error.
pub fn relative(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / size }
}

/// The largest of the errors, or NaN if one is NaN.
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors
        .into_iter()
        .fold(0.0, |worst: f64, error| if worst.is_nan() || error.is_nan() { f64::NAN } else { worst.max(error) })
}
