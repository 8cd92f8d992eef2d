//! Where a contact problem's numbers come from, so that they can be computed again with more and more digits.
//!
//! ```text
//!     f64 with an error bound --> plain balls --> balls --> balls around pairs of f64 --> intervals of 256, 1024, 4096 bits
//!       ├── again with c from pairs of f64, if contacts are slow
//!       └── balls around it
//! ```
//!
//! From the balls on, each number also has a residue that shows whether it is exactly zero (see
//! [`Residue`](crate::scalar::Residue)); plain ones cost less than half, where no zeros are expected. So borders and
//! dependent contacts are recognized, and a number that is not zero shows its sign once it has enough digits.

use super::{ContactProblem, Origin};
use crate::budget::{ROUNDS, is_spent, is_spent_after};
use crate::impact::outcome::Effort;
use crate::planar::Pair;
use crate::scalar::{Ball, Certified, DoubleDouble, Interval, Ordered, Trigonometry};
use std::cell::OnceCell;

/// What stands behind the rounded numbers of a [`ContactProblem`]: exact data, and the way from them to G and c.
pub trait Source {
    /// The contact problem itself, in numbers of any kind.
    fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T>
    where
        Self: Sized;

    /// What the f64 problem may be off by.
    fn errors(&self) -> Errors<'_>;

    /// c- alone, far more closely than `errors` says; `None` if it needs M^-1 or is not c_free.
    fn velocity(&self) -> Option<Vec<Pair<Ball<DoubleDouble>>>> {
        None
    }

    /// Whether the numbers are what was asked about, so that what is shown of them is proven.
    fn is_exact(&self) -> bool {
        true
    }

    /// What an outcome calls a contact.
    fn contact_name(&self, contact: usize) -> String {
        format!("contact/{contact}")
    }

    /// Another contact whose tangential row of G and c_t are exactly those of this one, as both stand level on one body;
    /// that one has none itself.
    fn shared_tangent(&self, _contact: usize) -> Option<usize> {
        None
    }
}

/// Any [`Source`] with its problem in the numbers that are tried one after the other: what asks it is compiled once for
/// all sources.
pub trait Ladder: Source {
    /// In plain balls.
    fn plain(&self) -> ContactProblem<Ball>;

    /// In balls.
    fn ball(&self) -> ContactProblem<Certified<Ball>>;

    /// In balls around pairs of f64.
    fn double_double(&self) -> ContactProblem<Certified<Ball<DoubleDouble>>>;

    /// In intervals of as many digits as their scope has.
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

/// A source whose problem is computed once in each kind of numbers, but for intervals, which live in their scope alone.
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

/// A kind of numbers of the ladder.
pub trait Rung: Ordered + Trigonometry {
    /// The problem of a source in them.
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

/// Error bounds of a problem in f64.
#[derive(Debug, Clone, Copy)]
pub struct Errors<'a> {
    /// Of an entry G_ij, relative to sqrt(G_ii G_jj) of the f64 matrix; infinite if nothing is known, not even of c.
    pub delassus: f64,
    /// Of c- and c_free, per contact \[m/s\]; `None` if they are exact.
    pub velocity: Option<&'a [Pair<f64>]>,
    /// What part of `delassus` and of `velocity` the errors are likely to reach.
    pub likely: [f64; 2],
}

impl Errors<'_> {
    /// Of a problem that is given exactly.
    pub const NONE: Self = Self { delassus: 0.0, velocity: None, likely: [1.0; 2] };
    /// Of a problem whose errors nobody knows.
    pub const UNKNOWN: Self = Self { delassus: f64::INFINITY, velocity: None, likely: [1.0; 2] };
}

/// A problem that is given as matrices is its own source: every f64 is meant as the number that it is.
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

/// Digits of the last numbers \[bit\].
const BITS: [usize; 3] = [256, 1024, 4096];

/// A question about a problem that more digits may answer.
pub trait PrecisionTask {
    /// Tries to answer it in these numbers; true if nothing is left open.
    fn attempt<T: Ordered>(&mut self, problem: &ContactProblem<T>, precision: Precision) -> bool;
}

/// A kind of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precision {
    /// Balls around the numbers of f64 with their bounds, where contacts that share a row are known.
    Enclosed,
    /// Balls that do not recognize an exact zero.
    Plain,
    Ball,
    DoubleDouble,
    Interval,
}

impl Precision {
    /// What to begin with: numbers that recognize zeros where contacts may depend on each other, or where some rest or
    /// have no friction.
    pub fn first(is_regular: bool, problem: &ContactProblem) -> Self {
        let rests = |velocity: &Pair<f64>| velocity.contains(&0.0);
        let is_generic = is_regular && !problem.velocity_free().iter().any(rests);
        if is_generic && problem.friction().all(|friction| !friction.is_zero()) { Self::Plain } else { Self::Ball }
    }

    /// How many combinations were decided in these numbers.
    pub fn share(self, effort: &mut Effort) -> &mut u64 {
        match self {
            Self::Enclosed => &mut effort.bound,
            Self::Plain | Self::Ball => &mut effort.ball,
            Self::DoubleDouble => &mut effort.double_double,
            Self::Interval => &mut effort.precise,
        }
    }
}

/// A question that numbers with more digits may answer, whatever they are computed from.
pub trait Attempt {
    /// Tries to answer it in these numbers; true if nothing is left open.
    fn attempt<T: Rung>(&mut self, precision: Precision) -> bool;
}

/// A question about the problem of a source.
struct Posed<'a, Q> {
    source: &'a Remembered<'a>,
    task: &'a mut Q,
}

impl<Q: PrecisionTask> Attempt for Posed<'_, Q> {
    fn attempt<T: Rung>(&mut self, precision: Precision) -> bool {
        self.task.attempt(&T::problem(self.source), precision)
    }
}

/// Attempts a task in one kind of numbers after the other, beginning with `first`, until nothing is left open or the
/// budget is spent.
pub fn escalate(source: &Remembered<'_>, first: Precision, task: &mut impl PrecisionTask) {
    climb(first, &mut Posed { source, task });
}

/// As [`escalate`], of any question.
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
