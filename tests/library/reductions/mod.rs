//! What is left out changes nothing: the same outcomes, velocities and impulses to 1e-12 of scale with every reduction
//! off, each alone off, and all on; and with any other link as the root.

mod command;
mod comparison;
mod merge;
mod robots;
mod trees;
