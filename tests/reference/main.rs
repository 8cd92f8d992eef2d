//! Numbers that others computed (`../data`), through the command: the paper, problems, robots and gaits.

mod gaits;
mod paper;
mod paper_figures;
mod problems;
mod robots;
#[path = "../support/mod.rs"]
mod support;
