//! The command against numbers that others computed (`../data`): the paper, problems, robots and gaits.

mod gaits;
mod paper;
mod paper_figures;
mod problems;
mod robots;
#[path = "../support/mod.rs"]
mod support;
