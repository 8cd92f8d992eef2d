//! Studies of one parameter: where their regions lie, their transitions, and their output.
//!
//! Tests of known borders go to `paper`, `thin` and `transitions`; `completeness` compares with dense scans of random
//! studies.

pub mod command;
mod completeness;
mod invariances;
mod output;
mod paper;
pub mod studies;
mod thin;
mod transitions;
mod work;
