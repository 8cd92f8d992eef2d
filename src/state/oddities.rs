//! Joints of a state that are outside the limits of the robot's file, and angles that look like degrees.

use super::State;
use crate::robot::{Joint, Robot};
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
            let beyond = |slack: f64| position < limits[0] - slack || position > limits[1] + slack;
            if !beyond(0.0) {
                return None;
            }
            // An infinite end is none.
            let slack =
                limits.iter().filter(|end| end.is_finite()).fold(0.0, |most: f64, end| most.max(ROUNDING * end.abs()));
            beyond(slack).then_some(OutsideLimits { joint, position, limits })
        })
    }

    /// What is odd about the joints, in sentences: those outside their limits, and angles that look like degrees.
    pub fn odd_joints(&self, robot: &Robot) -> impl Iterator<Item = String> {
        let like_degrees = self.like_degrees(robot);
        let like_degrees =
            like_degrees.map(|(name, angle)| format!("{name} = {angle} rad is more than a turn; degrees?"));
        self.outside_limits(robot).map(|outside| outside.to_string()).chain(like_degrees)
    }

    /// The pitch and the joints without limits that are more than a turn, as degrees are: name and angle \[rad\]. Wheels,
    /// which carry no other joint, do turn so far: of these the whole numbers, as degrees written by hand are.
    fn like_degrees<'r>(&self, robot: &'r Robot) -> impl Iterator<Item = (&'r str, f64)> {
        let base = robot.base_dofs();
        let is_free_angle = move |at: usize| match at.checked_sub(base) {
            Some(joint) => robot.joints[joint].limits.is_none() && robot.joints[joint].axis.is_revolute(),
            None => at == 2,
        };
        let joints = || robot.joints.iter().chain(robot.mimic_joints.iter().map(|mimic| &mimic.joint));
        let is_wheel = move |at: usize| match at.checked_sub(base) {
            Some(joint) => joints().all(|other| other.parent != robot.joints[joint].child),
            None => robot.joints.is_empty(),
        };
        let like = move |&(at, angle): &(usize, f64)| {
            angle.abs() > TAU && is_free_angle(at) && (angle.fract() == 0.0 || !is_wheel(at))
        };
        let angles = self.position.iter().copied().take(robot.dofs()).enumerate().filter(like);
        angles.filter_map(|(at, angle)| Some((robot.coordinates().nth(at)?, angle)))
    }
}

impl fmt::Display for OutsideLimits<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { joint: Joint { name, axis, .. }, position, limits: [lower, upper] } = self;
        let is_angle = axis.is_revolute();
        let unit = if is_angle { "rad" } else { "m" };
        write!(f, "{name} = {position} {unit} is outside [{lower}, {upper}]")?;
        let as_degrees = position.to_radians();
        let meant = is_angle && position.abs() > TAU && as_degrees >= *lower && as_degrees <= *upper;
        f.write_str(if meant { "; degrees?" } else { "" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_another_length_are_read_to_their_end() {
        let robot = Robot::from_urdf(include_str!("../../urdf/minimalistic.urdf")).unwrap();
        let names = |position: Vec<f64>| {
            let state = State { position, ..State::zero(&robot) };
            state.like_degrees(&robot).map(|(name, _)| name).collect::<Vec<_>>()
        };
        assert_eq!(names(vec![90.0, 90.0, 45.0]), ["pitch"]);
        assert_eq!(names(vec![0.0, 0.0, 0.0, 30.5, 90.0]), Vec::<&str>::new());
        assert_eq!(names(vec![0.0, 0.0, 0.0, 30.0, 90.0]), ["hip"]);
    }
}
