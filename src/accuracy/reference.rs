//! M, G and c to 320 bits and more, and how far others are from them.
//!
//! Errors are free of units: of M and G relative to the geometric mean of both diagonal entries, of contact velocities
//! and impulses by the scale of margins, S = max |c_i| / sqrt(G_ii).

use super::computation::{Computation, Factorization};
use super::number::Number;
use crate::dynamics::plan::JointMotion;
use crate::pipeline::assembly::Elimination;
use crate::pipeline::exact::{Contacts, ExactState};
use crate::planar::{Inertia, Vector};
use crate::robot::Robot;
use crate::scalar::{Ball, DoubleDouble, Enclosure, Interval, Ordered, Real};

/// Bits of the reference, and for each body: an articulated inertia is that much less sharp than its children's. The
/// numbers are enclosures, so that their own uncertainty shows as an error.
pub const PRECISION: usize = 320;
const PRECISION_PER_BODY: usize = 4;

/// Errors of M from here on are seen by pairs of f64, whose own are some 1e-31.
const SHOWN_BY_PAIRS: f64 = 1e-24;

/// Runs `work` on numbers with bits enough for `robot`.
pub fn with_precision<R>(robot: &Robot, work: impl FnOnce() -> R) -> R {
    Interval::scope(PRECISION + PRECISION_PER_BODY * robot.bodies.len(), work)
}

/// M, G and c of a state in the reference's numbers; it must stay within one [`with_precision`].
pub(super) struct Reference<'a> {
    computation: Computation<'a, Interval>,
    pub contacts: Contacts<Interval>,
    /// The joints and the base's motions of each column.
    columns: Vec<Vec<UnitMotion<Interval>>>,
}

/// A joint's motion for a unit rate of its column, and the momentum of all that it moves; both at the root's origin.
struct UnitMotion<T> {
    body: usize,
    angular_velocity: T,
    /// Of the point at the root's origin.
    velocity: Vector<T>,
    angular_momentum: T,
    momentum: Vector<T>,
    rotor: T,
}

impl<'a> Reference<'a> {
    /// Computes G and c, and what M follows from.
    pub fn new(state: &'a ExactState<'a>) -> Self {
        let mut computation = Computation::new(state);
        computation.place();
        if computation.assembly.has_articulated_bodies() {
            computation.delassus(Elimination::ArticulatedBodies);
            computation.velocities();
        } else {
            computation.delassus(Elimination::Ltl);
        }
        Self { contacts: computation.collect(), columns: columns(&computation), computation }
    }

    /// How G was found.
    pub fn factorization(&self) -> Factorization {
        match self.computation.assembly.elimination {
            Elimination::Ltl => Factorization::SparseLtl,
            Elimination::ArticulatedBodies => Factorization::ArticulatedBodies,
        }
    }

    /// How well G itself is known.
    pub fn own_error(&self) -> f64 {
        self.worst_of_delassus(|_, exact| exact.error())
    }

    /// The largest error of a G; NaN where it holds no number.
    pub fn delassus_error<T: Number>(&self, delassus: &[T]) -> f64 {
        self.worst_of_delassus(|at, exact| distance(delassus[at], exact))
    }

    fn worst_of_delassus(&self, error: impl Fn(usize, Interval) -> f64) -> f64 {
        let exact = &self.contacts.delassus;
        let rows = exact.len().isqrt();
        let size = |row: usize| exact[row * rows + row].to_f64().sqrt();
        worst((0..exact.len()).map(|at| relative(error(at, exact[at]), size(at / rows) * size(at % rows))))
    }

    /// The largest error of an M (nv x nv, columns of the plan, of which the lower triangle is read); NaN where it
    /// holds no number.
    pub fn mass_matrix_error<T: Number>(&self, mass: &[T]) -> f64 {
        // Pairs of f64 are faster, and show all but the least errors.
        let error = self.mass_matrix_error_by(mass, enclosed);
        let is_shown = (SHOWN_BY_PAIRS..f64::INFINITY).contains(&error);
        // The bits of a whole chain are not needed for one entry.
        let exactly = || self.mass_matrix_error_by(mass, |exact| exact * Interval::one());
        if is_shown { error } else { Interval::scope(PRECISION, exactly) }
    }

    /// The same by a reference that is `rounded`.
    fn mass_matrix_error_by<T: Number, R: Ordered>(&self, mass: &[T], rounded: fn(Interval) -> R) -> f64 {
        let nv = self.columns.len();
        let plan = &self.computation.assembly.plan;
        let round = |motions: &Vec<UnitMotion<Interval>>| motions.iter().map(|own| own.rounded(rounded)).collect();
        let columns: Vec<Vec<UnitMotion<R>>> = self.columns.iter().map(round).collect();
        let inertia = |i: usize, j: usize| self.inertia(&columns[i], &columns[j]);
        let size: Vec<f64> = (0..nv).map(|i| R::freeing(|| inertia(i, i).to_f64().sqrt())).collect();
        worst((0..nv).flat_map(|i| {
            let (size, inertia) = (&size, &inertia);
            plan.branch(Some(i)).map(move |j| {
                let error = R::freeing(|| distance(mass[i * nv + j], inertia(i, j)));
                relative(error, size[i] * size[j])
            })
        }))
    }

    /// Entry of M for two columns, the second one below the first or the same.
    fn inertia<T: Real>(&self, upper: &[UnitMotion<T>], lower: &[UnitMotion<T>]) -> T {
        let plan = &self.computation.assembly.plan;
        let carries = |body: usize, outer: usize| plan.way_to_root(outer).any(|(at, _)| at == body);
        let pairs = upper.iter().flat_map(|one| lower.iter().map(move |other| (one, other)));
        let parts = pairs.filter_map(|(one, other)| {
            if !plan.has_mimics || carries(other.body, one.body) {
                Some(one.inertia(other))
            } else {
                carries(one.body, other.body).then(|| other.inertia(one))
            }
        });
        parts.reduce(|sum, part| sum + part).unwrap_or(T::zero())
    }
}

impl UnitMotion<Interval> {
    fn rounded<R: Real>(&self, round: fn(Interval) -> R) -> UnitMotion<R> {
        UnitMotion {
            body: self.body,
            angular_velocity: round(self.angular_velocity),
            velocity: self.velocity.map(round),
            angular_momentum: round(self.angular_momentum),
            momentum: self.momentum.map(round),
            rotor: round(self.rotor),
        }
    }
}

impl<T: Real> UnitMotion<T> {
    /// What this motion and one `below` it, or itself, bring to M.
    ///
    /// Not by a walk to the root as [`mass_matrix`](crate::dynamics::mass_matrix) does it, but by the places of both.
    fn inertia(&self, below: &Self) -> T {
        let entry = self.angular_momentum * below.angular_velocity + self.momentum.dot(below.velocity);
        if std::ptr::eq(self, below) { entry + self.rotor } else { entry }
    }
}

fn columns(computation: &Computation<Interval>) -> Vec<Vec<UnitMotion<Interval>>> {
    let (plan, workspace) = (&computation.assembly.plan, &computation.assembly.workspace);
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
    let mut columns: Vec<Vec<UnitMotion<Interval>>> = (0..plan.columns()).map(|_| Vec::new()).collect();
    for (index, body) in plan.bodies.iter().enumerate() {
        let Some(column) = body.column else { continue };
        let (origin, Inertia { mass, first, second }) = (origins[index], composite[index]);
        let mut add = |column: usize, angular_velocity, velocity, angular_momentum, momentum: Vector<Interval>| {
            columns[column].push(UnitMotion {
                body: index,
                angular_velocity,
                velocity,
                angular_momentum: angular_momentum + origin.perpendicular().dot(momentum),
                momentum,
                rotor: body.rotor,
            });
        };
        let mut slide = |column, rate: Vector<Interval>| {
            add(column, Interval::zero(), rate, first.perpendicular().dot(rate), rate * mass);
        };
        match body.motion {
            JointMotion::Root => Vector::axes().into_iter().enumerate().for_each(|(axis, rate)| slide(axis, rate)),
            JointMotion::Prismatic { .. } => slide(column, workspace.direction[index]),
            JointMotion::Revolute { .. } | JointMotion::Fixed => {}
        }
        let rate = match body.motion {
            JointMotion::Root => Interval::one(),
            JointMotion::Revolute { rate, .. } => rate,
            JointMotion::Prismatic { .. } | JointMotion::Fixed => continue,
        };
        add(column, rate, -(origin.perpendicular() * rate), rate * second, first.perpendicular() * rate);
    }
    columns
}

/// A ball around the pair of f64s next to a number.
fn enclosed(exact: Interval) -> Ball<DoubleDouble> {
    let [head, tail] = exact.parts();
    let rest = exact - Interval::from_f64(head) - Interval::from_f64(tail);
    let rest = Ball::from_f64(2.0 * rest.to_f64().abs() + rest.error());
    (Ball::from_f64(head) + Ball::from_f64(tail)).widened(rest)
}

/// At most how far `found` is from `exact`.
pub fn distance<T: Number, R: Ordered>(found: T, exact: R) -> f64 {
    let [head, tail] = found.parts().map(R::from_f64);
    let difference = head + tail - exact;
    difference.to_f64().abs() + difference.error()
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
