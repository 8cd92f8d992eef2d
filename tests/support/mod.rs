//! Helpers that several test files use; `tests/README.md` says where a new test goes.

#![allow(dead_code, reason = "each binary uses its own part")]

pub mod answers;
pub mod command;
pub mod digits;
pub mod impact;
pub mod mechanism;
pub mod nearly;
pub mod paper;
pub mod parallel;
pub mod random;
pub mod robots;
pub mod rational;
pub mod scaled;
pub mod subject;
pub mod urdf;
