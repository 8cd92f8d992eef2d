//! Numbers with more and more digits, tried one after the other.
//!
//! ```text
//!     f64 with an error bound --> balls --> balls around pairs of f64 --> intervals of 256, 1024, 4096 bits
//! ```
//!
//! From the balls on, each number also has a residue that shows whether it is exactly zero (see
//! [`Residue`](crate::scalar::Residue)). So borders and dependent contacts are recognized, and a number that is not
//! zero shows its sign once it has enough digits.

use super::{ContactProblem, Source};
use crate::scalar::{Ball, Certified, DoubleDouble, Interval, Ordered};

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
    Ball,
    DoubleDouble,
    Interval,
}

/// Attempts a task in one kind of numbers after the other, beginning with `first`, until nothing is left open.
pub fn escalate<S: Source>(source: &S, first: Precision, task: &mut impl PrecisionTask) {
    if first <= Precision::Ball && task.attempt(&source.problem::<Certified<Ball>>(), Precision::Ball) {
        return;
    }
    if task.attempt(&source.problem::<Certified<Ball<DoubleDouble>>>(), Precision::DoubleDouble) {
        return;
    }
    for bits in BITS {
        let problem = || source.problem::<Certified<Interval>>();
        if Interval::scope(bits, || task.attempt(&problem(), Precision::Interval)) {
            return;
        }
    }
}
