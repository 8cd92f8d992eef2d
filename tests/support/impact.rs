//! Impacts of robots, and their results as lists with one entry per outcome.

use heelstrike::description::Description;
use heelstrike::impact::Mode;
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::robot::Reduction;
use heelstrike::{Defaults, Friction, Outcome, Result, Robot, State};
use std::fmt::Display;

pub fn robot(urdf: &str) -> Robot {
    Robot::from_urdf(urdf).unwrap_or_else(|error| panic!("{error}\n{urdf}"))
}

pub fn ramone() -> Robot {
    robot(include_str!("../../urdf/ramone.urdf"))
}

pub fn reduced(urdf: &str, reduction: &Reduction) -> Robot {
    Robot::reduce(&Description::from_urdf(urdf).expect("a description"), reduction).expect("a robot")
}

/// Computes the impact of a state in JSON, with friction 0.5 unless the state gives another.
pub fn try_impact(robot: &Robot, options: Options, state: impl Display) -> Result<Box<Impact>> {
    let defaults = Defaults { friction: Some(Friction::Finite(0.5)), ..Defaults::default() };
    Pipeline::new(robot, options).impact(&State::from_json(&state.to_string(), robot, &defaults)?)
}

pub fn impact(robot: &Robot, state: impl Display) -> Box<Impact> {
    try_impact(robot, Options::default(), &state).unwrap_or_else(|error| panic!("{error}\n{state}"))
}

pub fn outcomes(impact: &Impact) -> &[Outcome] {
    impact.analysis.as_ref().map_or(&[], |analysis| &analysis.outcomes)
}

pub fn is_proven(impact: &Impact) -> bool {
    impact.analysis.as_ref().is_some_and(|analysis| analysis.proven)
}

pub fn modes(impact: &Impact) -> Vec<Vec<Mode>> {
    outcomes(impact).iter().map(|outcome| outcome.modes.clone()).collect()
}

/// The velocity v after each outcome, in the order of q.
pub fn velocities_after(impact: &Impact) -> Vec<Vec<f64>> {
    outcomes(impact).iter().map(|outcome| outcome.velocity().collect()).collect()
}

/// The impulse on point a of each loop, for each outcome.
pub fn loop_impulses(impact: &Impact) -> Vec<Vec<[f64; 2]>> {
    let components = |outcome: &Outcome| outcome.loop_impulse.iter().flatten().map(|own| own.components()).collect();
    outcomes(impact).iter().map(components).collect()
}
