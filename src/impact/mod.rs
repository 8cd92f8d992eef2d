//! Finds every outcome of a contact problem. This module does not depend on robots.
//!
//! Read the files in this order: `problem`, `enumerate` (the numbers of each combination), `slack` (its inequalities),
//! and `analysis`, which uses them all.

mod linear;
mod simplex;
mod outcome;
mod problem;
#[doc(hidden)]
pub mod enumerate;
pub(crate) mod slack;
mod generators;
mod digits;
mod inequalities;
mod reading;
mod kernel;
mod index;
mod least_impulse;
mod corners;
mod needed;
mod singular;
mod combination;
mod explanation;
mod rank;
mod relaxation;
mod collected;
mod survivors;
mod passes;
mod families;
mod analysis;

pub use crate::law::{Friction, Inequality, Law, Mode};
pub use analysis::{CONTACT_LIMIT, Scratch, analyze, too_many_contacts};
pub(crate) use collected::RECYCLED;
pub use collected::{AnalysisOptions, EXPLAINED, ListedRejections};
pub(crate) use digits::{DIGITS, is_known};
#[cfg(feature = "plot")]
pub(crate) use explanation::mirrored;
pub use inequalities::{Inequalities, InequalityScratch};
pub use outcome::{
    Analysis, AtZero, Border, Effort, Explanation, Family, ImpulseRegion, Motion, Next, OpenCombinations, Outcome,
    Range, Rejection, RejectionReason, Verdict,
};
pub(crate) use problem::{Attempt, Precision, Rung, check_matrix_size, climb};
pub use problem::{ContactProblem, Errors, Ladder, MATRIX_LIMIT, Source};
