//! Error against run time, stiff and extreme cases, and compliant contact beside the rigid impact.

mod number;
mod wide;

pub use number::Number;
pub use wide::{PRECISION, Wide};
