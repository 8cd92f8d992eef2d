//! What holds coordinates together: loops, and joints that follow others. Every expectation comes from `mechanism`,
//! which knows nothing of the crate, or from paper.

mod command;
mod five_bar;
mod four_bar;
mod mechanism;
mod mimic_joints;
mod redundant;
mod refusals;
