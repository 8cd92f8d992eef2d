//! Reads states, problems and studies from JSON, with expressions in studies, and states from tables.

pub mod expression;
pub(crate) mod json;
pub mod documents;
pub(crate) mod state;
pub mod lines;
mod problem;
mod variation;
mod study;
pub mod table;

pub use problem::Problem;
pub use state::loops_from_json;
pub use study::{Parameter, Study};
