//! The crate against arithmetic that does not round, or that knows by how much: rationals (`exact`) and balls of 256 bits
//! (`balls`); and what holds of every problem (`laws`). Cases are random and seeded; a failing one prints its seed and
//! itself.

mod balls;
mod exact;
mod laws;
#[path = "../support/mod.rs"]
mod support;
