//! Properties that hold for every contact problem: the index theorem, what a search of combinations leaves out, and the
//! friction that is needed. Cases are random and seeded; a failing one prints its seed and itself.

mod problems;
#[path = "../support/mod.rs"]
mod support;
