//! Forces and accelerations in sustained contact: laws of mechanics that hold for every robot, and cases by hand.

mod next;
mod painleve;
mod refusals;
mod standing;
mod springs;
mod studies;

use crate::support::impact::{modes, outcomes, robot};
use crate::support::urdf;
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::{Defaults, Friction, Impact, Result, Robot, State};
use std::fmt::Display;

/// Computes the forces of a state in JSON, with friction 0.5 unless the state gives another.
fn try_forces(robot: &Robot, state: impl Display) -> Result<Box<Impact>> {
    let defaults = Defaults { friction: Some(Friction::Finite(0.5)), ..Defaults::default() };
    let state = State::from_json(&state.to_string(), robot, &defaults)?;
    Pipeline::new(robot, Options { matrices: true, ..Options::default() }).forces(&state)
}

fn forces(robot: &Robot, state: impl Display) -> Box<Impact> {
    try_forces(robot, &state).unwrap_or_else(|error| panic!("{error}\n{state}"))
}

/// A rigid body without shapes, of mass m and moment of inertia m k^2 (`square` is k^2), with its frame at its center.
fn rod(mass: f64, square: f64) -> Robot {
    robot(&urdf::robot(&[urdf::link("rod", mass, [0.0; 2], mass * square, "")]))
}
