//! From a contact problem to every outcome; knows no robot.
//!
//! Read [`problem`], then [`enumerate`] (numbers), [`sign`] (signs), and [`analysis`], where they meet.

pub mod analysis;
mod border;
mod bound;
pub mod certify;
pub mod enumerate;
mod generators;
mod index;
pub mod inequalities;
mod kernel;
mod labels;
mod linear;
mod lone;
pub mod mode;
pub mod outcome;
pub mod problem;
mod program;
mod reading;
mod redundant;
mod region;
pub mod sign;

pub use analysis::{Asked, CONTACT_LIMIT, Explain, Scratch, analyse};
pub use inequalities::Inequalities;
pub use mode::{Friction, Mode};
pub use outcome::{Analysis, Because, Border, Effort, Explanation, Motion, Outcome, Region, Rejection, Verdict, Zero};
pub use problem::{ContactProblem, Errors, MATRIX_LIMIT, Source};
