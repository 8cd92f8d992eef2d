//! From a contact problem to every outcome; knows no robot.
//!
//! Read [`problem`], then [`enumerate`] (numbers), [`sign`] (signs), and [`analysis`], where they meet.

pub mod analysis;
mod basis;
pub mod enumerate;
mod generators;
mod labels;
pub mod mode;
pub mod outcome;
pub mod problem;
mod program;
mod reading;
mod redundant;
mod region;
pub mod sign;

pub use analysis::{CONTACT_LIMIT, Scratch, analyse};
pub use mode::{Friction, Mode};
pub use outcome::{Analysis, Because, Explanation, Motion, Outcome, Region, Rejection, Verdict};
pub use problem::{ContactProblem, MATRIX_LIMIT};
