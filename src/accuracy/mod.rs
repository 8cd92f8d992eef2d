//! Error against run time, stiff and extreme cases, and compliant contact beside the rigid impact.
//!
//! ```text
//!     state --[pose]--> M, G, c in f32, f64, double-double, by each factorization --┐
//!       └─────[reference]--> the same, enclosed by 320 bits and more ---------------┴──[study]--> errors, times, conditions
//!     [suite]: stiff and extreme cases by name            [compliant]: springs and dampers in place of rigid contact
//! ```
//!
//! Nothing of the product runs on what stands here; it is run beside it to be compared.

pub mod compliant;
mod condition;
mod number;
mod pose;
mod reference;
mod robots;
mod study;
mod suite;
mod timing;

pub use condition::mass_matrix_condition;
pub use number::Number;
pub use pose::{Computation, Factorization, Pose};
pub use reference::{PRECISION, Reference, with_precision};
pub use study::{Answer, Condition, Errors, Method, Study, Work, of_problem, of_state, study};
pub use suite::{Case, End, Subject, cases};
pub use timing::{Budget, Spread, time};
