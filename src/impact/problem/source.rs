//! The source of a contact problem's numbers, from which they can be computed again with more and more digits.
//!
//! ```text
//!     f64 with an error bound --> plain balls --> balls --> balls around pairs of f64 --> intervals (256 to 4096 bits)
//!       ├── f64 again with c computed in pairs of f64, if contacts are slow
//!       └── balls around the f64 numbers
//! ```
//!
//! "Balls" and all later numbers also carry a residue that shows whether a number is exactly zero (see
//! [`Residue`](crate::scalar::Residue)). Plain balls have none. They cost less than half, and are used if no zeros are
//! expected. Thus borders and dependent contacts are recognized, and enough digits show the sign of every other number.

use super::{ContactProblem, Origin};
use crate::budget::{ROUNDS, is_spent, is_spent_after};
use crate::impact::outcome::Effort;
use crate::planar::Pair;
use crate::scalar::{Ball, Certified, DoubleDouble, Interval, Ordered, Trigonometry};
use std::cell::OnceCell;

/// The exact data behind the rounded numbers of a [`ContactProblem`], and the computation of G and c from them.
pub trait Source {
    /// Computes the contact problem in numbers of any kind.
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T>
    where
        Self: Sized;

    /// Error bounds of the f64 problem.
    fn errors(&self) -> Errors<'_>;

    /// c- in pairs of f64 \[m/s\], with far smaller errors than [`Self::errors`]; `None` if it needs M^-1 or is not
    /// c_free.
    fn velocity(&self) -> Option<Vec<Pair<Ball<DoubleDouble>>>> {
        None
    }

    /// Whether the numbers are exactly the user's, so that their signs count as proven.
    fn is_exact(&self) -> bool {
        true
    }

    /// The name of a contact in an outcome.
    fn contact_name(&self, contact: usize) -> String {
        format!("contact/{contact}")
    }

    /// Another contact whose tangential row of G and whose c_t are exactly those of this contact, because both are
    /// level on one body. That other contact itself returns `None`.
    fn shared_tangent(&self, _contact: usize) -> Option<usize> {
        None
    }
}

/// A [`Source`] as a trait object: one method per kind of numbers replaces the generic method. Code that takes a `dyn
/// Ladder` is compiled once for all sources. The methods are in the order in which the numbers are tried.
pub trait Ladder: Source {
    /// The problem in plain balls, without residues.
    fn plain(&self) -> ContactProblem<Ball>;

    /// The problem in balls with residues.
    fn ball(&self) -> ContactProblem<Certified<Ball>>;

    /// The problem in balls around pairs of f64, with residues.
    fn double_double(&self) -> ContactProblem<Certified<Ball<DoubleDouble>>>;

    /// The problem in intervals with as many bits as the enclosing [`Interval::scope`].
    fn interval(&self) -> ContactProblem<Certified<Interval>>;
}

impl<S: Source> Ladder for S {
    fn plain(&self) -> ContactProblem<Ball> {
        self.problem()
    }

    fn ball(&self) -> ContactProblem<Certified<Ball>> {
        self.problem()
    }

    fn double_double(&self) -> ContactProblem<Certified<Ball<DoubleDouble>>> {
        self.problem()
    }

    fn interval(&self) -> ContactProblem<Certified<Interval>> {
        self.problem()
    }
}

/// A source that computes its problem once in each kind of numbers, except in intervals, which end with a scope.
pub struct Remembered<'a> {
    pub source: &'a dyn Ladder,
    plain: OnceCell<ContactProblem<Ball>>,
    ball: OnceCell<ContactProblem<Certified<Ball>>>,
    double_double: OnceCell<ContactProblem<Certified<Ball<DoubleDouble>>>>,
}

impl<'a> Remembered<'a> {
    pub fn of(source: &'a dyn Ladder) -> Self {
        Self { source, plain: OnceCell::new(), ball: OnceCell::new(), double_double: OnceCell::new() }
    }
}

/// A number type in the order of increasing precision.
pub trait Rung: Ordered + Trigonometry {
    /// The problem of a source in numbers of this kind.
    fn problem(of: &Remembered<'_>) -> ContactProblem<Self>;
}

impl Rung for Ball {
    fn problem(of: &Remembered<'_>) -> ContactProblem<Self> {
        of.plain.get_or_init(|| of.source.plain()).clone()
    }
}

impl Rung for Certified<Ball> {
    fn problem(of: &Remembered<'_>) -> ContactProblem<Self> {
        of.ball.get_or_init(|| of.source.ball()).clone()
    }
}

impl Rung for Certified<Ball<DoubleDouble>> {
    fn problem(of: &Remembered<'_>) -> ContactProblem<Self> {
        of.double_double.get_or_init(|| of.source.double_double()).clone()
    }
}

impl Rung for Certified<Interval> {
    fn problem(of: &Remembered<'_>) -> ContactProblem<Self> {
        of.source.interval()
    }
}

/// Error bounds of an f64 problem.
#[derive(Debug, Clone, Copy)]
pub struct Errors<'a> {
    /// Bound of the error of G_ij, relative to sqrt(G_ii G_jj) of the f64 matrix; infinite if nothing is known, even of
    /// c.
    pub delassus: f64,
    /// Bounds of the errors of c- and c_free, per contact \[m/s\]; `None` if they are exact.
    pub velocity: Option<&'a [Pair<f64>]>,
    /// Likely errors as fractions of the bounds `delassus` and `velocity`.
    pub likely: [f64; 2],
}

impl Errors<'_> {
    /// The errors of a problem that is given exactly.
    pub const NONE: Self = Self { delassus: 0.0, velocity: None, likely: [1.0; 2] };
    /// The errors of a problem about whose rounding nothing is known.
    pub const UNKNOWN: Self = Self { delassus: f64::INFINITY, velocity: None, likely: [1.0; 2] };
}

/// A problem that is given as matrices is its own source: each f64 stands for exactly its own value.
impl Source for ContactProblem {
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
        match &self.origin {
            Origin::Given | Origin::Symmetrized => self.map(T::from_f64),
            Origin::Dynamics(dynamics) => {
                let (delassus, before, _) = dynamics.numbers();
                let (laws, restitution) = (self.laws.clone(), self.restitution.clone());
                ContactProblem::of_parts(delassus, before.clone(), before, laws, restitution)
            }
            Origin::Repaired(rows) => ContactProblem { delassus: rows.delassus(), ..self.map(T::from_f64) },
        }
    }

    fn errors(&self) -> Errors<'_> {
        if matches!(self.origin, Origin::Given | Origin::Symmetrized) { Errors::NONE } else { Errors::UNKNOWN }
    }

    fn is_exact(&self) -> bool {
        !self.is_repaired()
    }
}

/// Bits of the intervals, which are tried last.
const BITS: [usize; 3] = [256, 1024, 4096];

/// A question about a problem that numbers with more digits may answer.
pub trait PrecisionTask {
    /// Tries to answer the question from this problem; returns true if nothing is left open.
    fn attempt<T: Ordered>(&mut self, problem: &ContactProblem<T>, precision: Precision) -> bool;
}

/// The kinds of numbers in which a task is attempted, in increasing precision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precision {
    /// Balls around the f64 numbers with their error bounds; tangential rows that contacts share are known to be equal.
    Enclosed,
    /// Balls without residues, which do not recognize an exact zero.
    Plain,
    Ball,
    DoubleDouble,
    Interval,
}

impl Precision {
    /// The kind of numbers to begin with. Numbers that recognize exact zeros come first if contacts may depend on each
    /// other, or if some contact is at rest or has no friction.
    pub fn first(is_regular: bool, problem: &ContactProblem) -> Self {
        let rests = |velocity: &Pair<f64>| velocity.contains(&0.0);
        let is_generic = is_regular && !problem.velocity_free().iter().any(rests);
        if is_generic && problem.friction().all(|friction| !friction.is_zero()) { Self::Plain } else { Self::Ball }
    }

    /// The counter in `effort` of combinations that were decided in these numbers.
    pub fn share(self, effort: &mut Effort) -> &mut u64 {
        match self {
            Self::Enclosed => &mut effort.bound,
            Self::Plain | Self::Ball => &mut effort.ball,
            Self::DoubleDouble => &mut effort.double_double,
            Self::Interval => &mut effort.precise,
        }
    }
}

/// A question that numbers with more digits may answer, whether or not it is about a contact problem.
pub trait Attempt {
    /// Tries to answer the question in numbers of type `T`; returns true if nothing is left open.
    fn attempt<T: Rung>(&mut self, precision: Precision) -> bool;
}

/// A task together with the source of its problem.
impl<Q: PrecisionTask> Attempt for (&Remembered<'_>, &mut Q) {
    fn attempt<T: Rung>(&mut self, precision: Precision) -> bool {
        self.1.attempt(&T::problem(self.0), precision)
    }
}

/// Attempts a task in ever more precise numbers, from `first` on, until nothing is open or the budget is spent.
pub fn escalate(source: &Remembered<'_>, first: Precision, task: &mut impl PrecisionTask) {
    climb(first, &mut (source, task));
}

/// Does the same as [`escalate`] for any question.
pub fn climb(first: Precision, task: &mut impl Attempt) {
    if first <= Precision::Plain && task.attempt::<Ball>(Precision::Plain) {
        return;
    }
    if first <= Precision::Ball && task.attempt::<Certified<Ball>>(Precision::Ball) {
        return;
    }
    if is_spent() || task.attempt::<Certified<Ball<DoubleDouble>>>(Precision::DoubleDouble) {
        return;
    }
    for bits in BITS {
        if is_spent_after(ROUNDS) {
            return;
        }
        if Interval::scope(bits, || task.attempt::<Certified<Interval>>(Precision::Interval)) {
            return;
        }
    }
}
