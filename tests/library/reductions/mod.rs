//! Reductions change nothing: outcomes, velocities and impulses are the same to 1e-12 of scale with every reduction
//! off, each alone off, and all on; and with any other link as the root.

mod command;
mod comparison;
mod merge;
mod robots;
mod trees;
