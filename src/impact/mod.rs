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
pub mod outcome;
pub mod problem;
mod program;
mod reading;
mod redundant;
mod region;
pub mod sign;

pub use crate::law::{Friction, Inequality, Law, Mode};
pub use analysis::{Asked, CONTACT_LIMIT, Explain, Scratch, analyse};
pub use inequalities::Inequalities;
pub use outcome::{
    Analysis, Border, Effort, Explanation, ImpulseRegion, Motion, Outcome, Rejection, RejectionReason, Verdict,
};
pub use problem::{ContactProblem, Errors, MATRIX_LIMIT, Source};
