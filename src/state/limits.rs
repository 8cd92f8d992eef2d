//! Joints of a state that are outside the limits of the robot's file.

use super::State;
use crate::robot::{Axis, Joint, Robot};
use std::f64::consts::TAU;
use std::fmt;

/// Files and recordings round limits and positions by this part of the limits.
const ROUNDING: f64 = 1e-6;

/// A joint that is outside its limits by more than rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsideLimits<'r> {
    pub joint: &'r Joint,
    /// Where it is \[rad or m\].
    pub position: f64,
    /// Between which values the file has it \[rad or m\].
    pub limits: [f64; 2],
}

impl State {
    /// The joints and mimic joints that are outside the limits of the file of `robot`.
    pub fn outside_limits<'r>(&self, robot: &'r Robot) -> impl Iterator<Item = OutsideLimits<'r>> {
        let joints = self.position.get(robot.base_dofs()..).unwrap_or_default();
        let own = robot.joints.iter().zip(joints.iter().copied());
        let mimics = robot.mimic_joints.iter().filter_map(|mimic| {
            let mimicked = joints.get(mimic.mimicked)?;
            Some((&mimic.joint, mimic.multiplier * mimicked + mimic.offset))
        });
        own.chain(mimics).filter_map(|(joint, position)| {
            let limits = joint.limits?;
            let slack = ROUNDING * limits[0].abs().max(limits[1].abs());
            let outside = position < limits[0] - slack || position > limits[1] + slack;
            outside.then_some(OutsideLimits { joint, position, limits })
        })
    }
}

impl fmt::Display for OutsideLimits<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { joint: Joint { name, axis, .. }, position, limits: [lower, upper] } = self;
        let is_angle = matches!(axis, Axis::Revolute { .. });
        let unit = if is_angle { "rad" } else { "m" };
        write!(f, "{name} = {position} {unit} is outside [{lower}, {upper}]")?;
        let as_degrees = position.to_radians();
        let meant = is_angle && position.abs() > TAU && as_degrees >= *lower && as_degrees <= *upper;
        f.write_str(if meant { "; degrees?" } else { "" })
    }
}
