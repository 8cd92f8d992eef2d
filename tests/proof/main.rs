//! The crate against exact rationals (`exact`) and against balls of 256 bits, which bound their rounding (`balls`); and
//! properties of every contact problem (`laws`). Cases are random and seeded; a failing case prints its seed and input.

mod balls;
mod exact;
mod laws;
#[path = "../support/mod.rs"]
mod support;
