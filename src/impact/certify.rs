//! What f64 leaves open, settled in numbers with more and more digits.
//!
//! ```text
//!     f64 with an error bound --> balls --> balls around pairs of f64 --> intervals of 256, 1024, 4096 bits
//! ```
//!
//! Every layer runs the same elimination on the same data. From the balls on, each number also has a residue that tells
//! whether it is exactly zero (see [`Residue`](crate::scalar::Residue)), so that borders and dependent contacts are seen as
//! what they are, and a number that is not zero shows its sign once it has enough digits. What still hangs on a sign after
//! the last layer is undecided.

use super::analysis::{index_of, motion};
use super::enumerate::Tableau;
use super::linear::{Unsettled, solve};
use super::outcome::{Effort, Motion};
use super::problem::{ContactProblem, Source};
use super::reading::{Reading, read_signed};
use super::redundant::{Judged, judge};
use super::sign::Scale;
use crate::law::Mode;
use crate::scalar::{Ball, Certified, DoubleDouble, Interval, Ordered, Sign};

/// Digits of the last layers \[bit\].
const PRECISIONS: [usize; 3] = [256, 1024, 4096];

/// Combinations that are tried in each of them.
const PRECISE_COMBINATIONS: usize = 2_000;

/// Something to settle about a problem, tried in every layer until it is.
pub trait Question {
    /// Tries to settle it, and tells whether nothing is left open.
    fn ask<T: Ordered>(&mut self, problem: &ContactProblem<T>, layer: Layer) -> bool;
}

/// A kind of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Balls around f64.
    Ball,
    /// Balls around pairs of f64.
    DoubleDouble,
    /// Intervals of many digits.
    Precise,
}

impl Layer {
    /// How many combinations it is worth to try in it: many digits of many contacts take longer than anyone waits, and
    /// what is left is told as undecided.
    pub fn combinations(self) -> usize {
        match self {
            Self::Ball | Self::DoubleDouble => usize::MAX,
            Self::Precise => PRECISE_COMBINATIONS,
        }
    }

    /// Counts what this layer settled.
    pub fn count(self, effort: &mut Effort, combinations: usize) {
        match self {
            Self::Ball => effort.ball += combinations,
            Self::DoubleDouble => effort.double_double += combinations,
            Self::Precise => effort.precise += combinations,
        }
    }
}

/// Asks in one layer after the other, beginning with `first`, until nothing is left open.
pub fn settle<S: Source>(source: &S, first: Layer, question: &mut impl Question) {
    if first <= Layer::Ball && question.ask(&source.problem::<Certified<Ball>>(), Layer::Ball) {
        return;
    }
    if question.ask(&source.problem::<Certified<Ball<DoubleDouble>>>(), Layer::DoubleDouble) {
        return;
    }
    for bits in PRECISIONS {
        let done = Interval::scope(bits, || question.ask(&source.problem::<Certified<Interval>>(), Layer::Precise));
        if done {
            return;
        }
    }
}

/// What became of a combination.
#[derive(Debug)]
pub enum Settled {
    /// Its equations have one solution.
    Regular {
        /// Its signs.
        reading: Reading,
        /// Sign of det A.
        index: i8,
        /// The solution.
        motion: Motion,
        /// How far it may be off, in the scale of margins.
        error: f64,
    },
    /// Its equations are singular.
    Singular(Judged),
}

impl Settled {
    /// How far an outcome's numbers may be off, in the scale of margins; none of a combination that is rejected.
    pub fn error(&self) -> Option<f64> {
        match self {
            Self::Regular { reading, error, .. } => (reading.sign != Sign::Negative).then_some(*error),
            Self::Singular(Judged::Valid(member)) => Some(member.error),
            Self::Singular(Judged::Family([one, other])) => Some(one.error.max(other.error)),
            Self::Singular(Judged::Rejected { .. }) => None,
        }
    }

    /// Whether a rejected combination tells numbers that are none.
    pub fn is_vague(&self) -> bool {
        match self {
            Self::Regular { reading, motion, .. } => !(motion.is_finite() && reading.margin.is_none_or(f64::is_finite)),
            Self::Singular(Judged::Rejected { margin, motion, .. }) => {
                !(motion.as_ref().is_none_or(Motion::is_finite) && margin.is_none_or(f64::is_finite))
            }
            Self::Singular(_) => false,
        }
    }
}

/// Settles one combination in one layer's numbers.
pub fn combination<T: Ordered>(
    tableau: &mut Tableau<T>,
    exact: &ContactProblem<T>,
    problem: &ContactProblem,
    scale: &Scale,
    modes: &[Mode],
) -> Result<Settled, Unsettled> {
    let leaf = tableau.leaf(modes);
    let mut pivots = Vec::with_capacity(modes.len());
    for &pivot in leaf.pivots {
        match pivot.sign() {
            Sign::Undecided => return Err(Unsettled),
            Sign::Zero => return judge(exact, problem, scale, modes).map(Settled::Singular),
            Sign::Negative | Sign::Positive => pivots.push(pivot.to_f64()),
        }
    }
    let reading = read_signed(&leaf, modes, problem, scale);
    if reading.sign == Sign::Undecided {
        return Err(Unsettled);
    }
    let motion = motion(&leaf, modes, problem, T::to_f64);
    let contacts = 0..modes.len();
    let velocity = contacts.clone().flat_map(|contact| leaf.velocity(contact));
    let error = scale.error(velocity, contacts.flat_map(|contact| leaf.impulse(contact)));
    Ok(Settled::Regular { reading, index: index_of(&pivots), motion, error })
}

/// The rank of G, and its inverse in the scale where it is regular.
#[derive(Debug, Default)]
pub struct Inverse {
    /// The rank; none where no layer tells it.
    pub rank: Option<usize>,
    /// Rows of the inverse of G scaled to a unit diagonal.
    pub rows: Vec<Vec<f64>>,
    /// sqrt(G_ii).
    pub mobility: Vec<f64>,
}

impl Question for Inverse {
    fn ask<T: Ordered>(&mut self, problem: &ContactProblem<T>, _: Layer) -> bool {
        let count = 2 * problem.contacts();
        let equations = |right: Option<usize>| -> Vec<Vec<T>> {
            let row = |i: usize| {
                let entries = (0..count).map(|j| problem.delassus(i, j));
                entries.chain([if right == Some(i) { T::one() } else { T::zero() }]).collect()
            };
            (0..count).map(row).collect()
        };
        let Ok(Some(kernel)) = solve(count, equations(None)) else { return false };
        self.rank = Some(count - kernel.directions.len());
        if self.rank == Some(count) {
            let columns = (0..count).map(|column| match solve(count, equations(Some(column))) {
                Ok(Some(found)) => Some(found.origin),
                _ => None,
            });
            let Some(columns) = columns.collect::<Option<Vec<Vec<T>>>>() else { return false };
            let entry = |i: usize, j: usize| columns[j][i].to_f64() * self.mobility[i] * self.mobility[j];
            self.rows = (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect();
        }
        true
    }
}
