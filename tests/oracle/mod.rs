//! An exact oracle: random planar trees, their impacts, and every outcome in rational arithmetic.
//!
//! It shares no code with the crate and is written another way on purpose: kinematics in absolute coordinates, the mass
//! matrix as a sum over bodies, G by Gauss on rationals, the outcomes by Cramer's rule on whole numbers for each of the
//! 4^n lists of modes, and exact signs. Physics: the conditions of the modes in the docs of `src/impact/mode.rs`.

pub mod case;
pub mod exact;
pub mod impact;
pub mod random;
mod self_test;
pub mod tree;
