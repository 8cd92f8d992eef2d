//! Oddities among the numbers of a state: joints outside the limits of the robot's file, angles and rates that look
//! like degrees, and speeds, slopes and places that no legged robot has.

use super::{Ground, State};
use crate::law::Friction;
use crate::robot::{Joint, Robot};
use std::f64::consts::{PI, TAU};
use std::fmt;

/// Rounding of limits and positions in files and recordings, as a fraction of the limits.
const ROUNDING: f64 = 1e-6;

/// Greater speeds get a note: no legged robot moves faster \[m/s\], and few parts rotate faster \[rad/s\].
const FASTEST: f64 = 100.0;

/// A coefficient of friction between these is probably in percent or degrees. Greater ones mean infinite.
const ROUGH: [f64; 2] = [10.0, 100.0];

/// A slope beyond this was probably meant in degrees \[rad\].
const STEEP: f64 = 0.8;

/// A joint that is outside its limits by more than rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutsideLimits<'r> {
    /// The joint.
    pub joint: &'r Joint,
    /// Its coordinate \[rad or m\].
    pub position: f64,
    /// The limits in the file \[rad or m\].
    pub limits: [f64; 2],
}

impl State {
    /// Finds the joints and mimic joints that are outside the limits of the robot's file.
    pub fn outside_limits<'r>(&self, robot: &'r Robot) -> impl Iterator<Item = OutsideLimits<'r>> {
        let positions = self.position.get(robot.base_dofs()..).unwrap_or_default();
        let joints = robot.joints.iter().zip(positions.iter().copied());
        let mimics = robot.mimic_joints.iter().filter_map(|mimic| {
            let mimicked = positions.get(mimic.mimicked)?;
            Some((&mimic.joint, mimic.multiplier * mimicked + mimic.offset))
        });
        joints.chain(mimics).filter_map(|(joint, position)| {
            let limits = joint.limits?;
            let beyond = |slack: f64| position < limits[0] - slack || position > limits[1] + slack;
            if !beyond(0.0) {
                return None;
            }
            // An infinite limit has no rounding.
            let slack =
                limits.iter().filter(|end| end.is_finite()).fold(0.0, |most: f64, end| most.max(ROUNDING * end.abs()));
            beyond(slack).then_some(OutsideLimits { joint, position, limits })
        })
    }

    /// Describes oddities in sentences: joints outside their limits, and numbers as in degrees or millimeters.
    pub fn oddities(&self, robot: &Robot) -> Vec<String> {
        let mut odd = self.oddities_of_motion(robot);
        let friction = &self.scene.friction;
        odd.extend(rough_friction(friction.default.iter().chain(friction.links.values()).copied()));
        odd
    }

    /// Describes the oddities that may explain why a foot is too deep or never lands: all except those of friction.
    pub(crate) fn oddities_of_motion(&self, robot: &Robot) -> Vec<String> {
        let mut odd = Vec::new();
        self.outside_limits(robot).for_each(|outside| odd.push(outside.to_string()));
        self.like_degrees(robot).for_each(|(name, angle)| {
            let half = if angle.abs() > TAU { "" } else { "half " };
            odd.push(format!("{name} = {angle} rad is more than {half}a turn; degrees?"));
        });
        if self.velocity.iter().any(|rate| rate.abs() > FASTEST) {
            odd.extend(self.fast(robot));
        }
        odd.extend(self.scene.contacts.iter().flatten().filter_map(|contact| contact.out_of_scale(robot)));
        odd.extend(self.steep());
        odd
    }

    /// Describes rates that no robot has, except those of wheels, whose joints have no limits.
    fn fast(&self, robot: &Robot) -> impl Iterator<Item = String> {
        let base = robot.base_dofs();
        let rates = self.velocity.iter().copied().take(robot.dofs()).enumerate();
        rates.filter(|(_, rate)| rate.abs() > FASTEST).filter_map(move |(at, rate)| {
            let name = robot.coordinates().nth(at)?;
            let joint = at.checked_sub(base).map(|joint| &robot.joints[joint]);
            match joint.map_or(at == 2, |joint| joint.axis.is_revolute()) {
                true if joint.is_none_or(|joint| joint.limits.is_none()) && is_wheel(robot, at) => None,
                true => Some(format!("the rate of {name} is {rate} rad/s; degrees per second?")),
                false => Some(format!("the rate of {name} is {rate} m/s: velocities are in m/s and rad/s")),
            }
        })
    }

    /// Notes that the ground is steeper than a legged robot can stand on.
    fn steep(&self) -> Option<String> {
        let Ground::Slope(slope) = self.scene.ground else { return None };
        (slope.abs() > STEEP).then(|| {
            let degrees = slope.to_degrees();
            format!("the ground's slope of {slope} rad is one of {degrees:.1} degrees: was it meant in degrees?")
        })
    }

    /// Finds the pitch and the joints without limits whose angle exceeds a turn, or as a whole number half a turn, as
    /// degrees do: name and angle \[rad\]. Wheels, which carry no other joint, may turn that far: for them only whole
    /// numbers count.
    fn like_degrees<'r>(&self, robot: &'r Robot) -> impl Iterator<Item = (&'r str, f64)> {
        let base = robot.base_dofs();
        let is_free_angle = move |at: usize| match at.checked_sub(base) {
            Some(joint) => robot.joints[joint].limits.is_none() && robot.joints[joint].axis.is_revolute(),
            None => at == 2,
        };
        let like = move |&(at, angle): &(usize, f64)| {
            let least = || match (angle.fract() == 0.0, is_wheel(robot, at)) {
                (true, false) => PI,
                (false, true) => f64::INFINITY,
                _ => TAU,
            };
            angle.abs() > PI && is_free_angle(at) && angle.abs() > least()
        };
        let angles = self.position.iter().copied().take(robot.dofs()).enumerate().filter(like);
        angles.filter_map(|(at, angle)| Some((robot.coordinates().nth(at)?, angle)))
    }
}

/// Notes the first coefficient of friction that is probably in percent or degrees.
pub(crate) fn rough_friction(mut friction: impl Iterator<Item = Friction>) -> Option<String> {
    let rough = friction.find(|friction| matches!(friction, Friction::Finite(mu) if *mu > ROUGH[0] && *mu < ROUGH[1]));
    rough.map(|mu| format!("the coefficient of friction is {mu}: was it meant in percent or degrees?"))
}

/// Returns whether the body that a coordinate rotates carries no other joint.
fn is_wheel(robot: &Robot, at: usize) -> bool {
    match at.checked_sub(robot.base_dofs()) {
        Some(joint) => robot.moving_joints().all(|other| robot.rigid_body(other.parent) != robot.joints[joint].child),
        None => robot.joints.is_empty(),
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
    use crate::description::Description;
    use crate::reductions::Reductions;
    use crate::robot::Reduction;

    #[test]
    fn only_what_may_turn_on_turns_fast() {
        let urdf = include_str!("../../urdf/ramone.urdf");
        let limited = urdf.replace("continuous", "revolute").replace("<axis", "<limit lower=\"-3\" upper=\"3\"/><axis");
        // The thigh carries the knee by another link, whose fixed joint may be kept.
        let mount = r#"<link name="mount"/><joint name="mount" type="fixed"><parent link="left_thigh"/>
            <child link="mount"/></joint></robot>"#;
        let mounted =
            urdf.replace(r#"<parent link="left_thigh"/>"#, r#"<parent link="mount"/>"#).replace("</robot>", mount);
        for (urdf, reductions, expected) in [
            (urdf, Reductions::ALL, ["left_hip"].as_slice()),
            (&limited, Reductions::ALL, &["left_hip", "left_knee"]),
            (&mounted, Reductions::ALL, &["left_hip"]),
            (&mounted, Reductions::NONE, &["left_hip"]),
        ] {
            let description = Description::from_urdf(urdf).unwrap();
            let robot = Robot::reduce(&description, &Reduction { reductions, ..Reduction::default() }).unwrap();
            let mut state = State::zero(&robot);
            for (name, rate) in [("left_hip", -101.0), ("left_knee", 101.0), ("right_hip", 99.0)] {
                state.set_velocity(&robot, name, rate).unwrap();
            }
            let odd = state.oddities(&robot);
            let named = |(odd, name): (&String, &&str)| odd.starts_with(&format!("the rate of {name} is "));
            assert!(odd.len() == expected.len() && odd.iter().zip(expected).all(named), "{odd:?}");
        }
    }

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
