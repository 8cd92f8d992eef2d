//! The crate against arithmetic that does not round, or that knows by how much: rationals (`exact`), balls of 256 bits
//! (`balls`), and the core itself on other numbers (`scalars`); and what holds of every problem (`laws`). Cases are random
//! and seeded; a failing one prints its seed and itself.

mod balls;
mod exact;
mod laws;
mod scalars;
#[path = "../support/mod.rs"]
mod support;
