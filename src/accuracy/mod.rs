//! Error against run time, stiff and extreme cases, and compliant contact beside the rigid impact.

mod number;
mod pose;
mod reference;
mod robots;
mod suite;


pub use number::Number;
pub use pose::{Computation, Factorization, Pose};
pub use reference::Reference;
pub use suite::{Case, End, Subject, cases};
pub use reference::PRECISION;
