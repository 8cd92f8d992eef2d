//! Error against run time, stiff and extreme cases, and compliant contact next to the rigid impact.
//!
//! ```text
//!     state --[computation]--> M, G, c in f32, f64, double-double, by each factorization --[study]--> errors, times
//! state --[reference]--> the same, enclosed with 320 bits or more --[study]
//! [suite]: named stiff and extreme cases              [compliant]: springs and dampers in place of rigid contact
//! ```
//!
//! The rest of the crate does not use this module.

mod number;
mod computation;
mod reference;
mod condition;
mod timing;
mod robots;
mod suite;
mod study;
pub mod compliant;

pub use computation::Factorization;
pub use study::{AnswerSummary, CaseStudy, ConditionNumbers, Method, MethodErrors, Work, of_problem, of_state, study};
pub use suite::{Case, CaseSubject, Expected, cases};
pub(crate) use timing::quantile;
pub use timing::{Sampling, Spread};
