//! Properties that hold for every problem and every robot: the index theorem, the contact law read off the outcomes,
//! and invariances. Cases are random and seeded; a failing one prints its seed and itself.

mod problems;
mod robots;
#[path = "../support/mod.rs"]
mod support;
