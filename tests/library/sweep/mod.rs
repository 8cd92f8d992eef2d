//! Studies of one parameter: where their regions lie, what turns between them, and what is written of them.
//!
//! Borders that are known go to `paper`, `thin` and `turns`; `completeness` compares with dense scans of random
//! studies.

pub mod command;
mod completeness;
mod invariances;
mod output;
mod paper;
pub mod studies;
mod thin;
mod transitions;
