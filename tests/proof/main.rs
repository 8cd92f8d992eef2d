//! The crate against arithmetic that does not round, or that knows by how much: rationals (`exact`), balls of 256 bits
//! (`balls`), and the core itself on other numbers (`scalars`).

mod balls;
mod exact;
mod scalars;
#[path = "../support/mod.rs"]
mod support;
