//! The unit of a parameter, if the study implies one.
//!
//! ```text
//!     a number of the state or the robot = +- parameter + a constant   ->   the parameter has its unit
//! ```

use super::model::{RobotStudy, Solver};
use crate::Robot;
use crate::description::{Description, Inertial};
use crate::state::{Ground, State};

/// A unit, and a number in this unit.
type Measured = (&'static str, f64);

/// The number of intervals of the range at whose ends numbers are compared, as far as the study can be read there.
const PARTS: usize = 8;

/// Numbers grow like the parameter if their differences agree with it to this fraction of its range.
const SAME: f64 = 1e-9;

impl RobotStudy<'_> {
    /// Returns the unit of a parameter; `None` if no number equals the parameter up to its sign and a constant, or if
    /// these numbers have several units.
    pub fn unit(&self, parameter: usize) -> Option<&'static str> {
        let range = self.study.parameters().get(parameter)?.range();
        let part = |k: usize| k as f64 / PARTS as f64;
        let found = (0..=PARTS).filter_map(|k| Some((part(k), self.measured(parameter, part(k))?)));
        let (parts, measured): (Vec<f64>, Vec<Vec<Measured>>) = found.unzip();
        let (first, others) = measured.split_first()?;
        // Two places do not distinguish a line from a curve, and robots of another structure have other numbers.
        if others.len() < 2 || others.iter().any(|other| other.len() != first.len()) {
            return None;
        }
        let grows = |index: &usize| {
            let is_line = |sign: f64| {
                others.iter().zip(&parts[1..]).all(|(other, part)| {
                    let expected = sign * (part - parts[0]) * range;
                    (other[*index].1 - first[*index].1 - expected).abs() <= SAME * range
                })
            };
            is_line(1.0) || is_line(-1.0)
        };
        let mut units = (0..first.len()).filter(grows).map(|index| first[index].0);
        let unit = units.next()?;
        units.all(|other| other == unit).then_some(unit)
    }

    /// Returns all numbers of robot and state for the parameter at this part of its range; other parameters are in the
    /// middle.
    fn measured(&self, parameter: usize, part: f64) -> Option<Vec<Measured>> {
        let point = self.point(|index| if index == parameter { part } else { 0.5 });
        let description = self.study.describe(&self.study.names(&point), self.description).ok()?;
        let mut all = of_robot(&description);
        all.extend(Solver::new(self).at(&point, |robot, state, _| Ok(of_state(robot, &state))).ok()?);
        Some(all)
    }
}

fn of_robot(description: &Description) -> Vec<Measured> {
    let inertial = |Inertial { origin, mass, inertia }: &Inertial| {
        let moments = inertia.iter().flatten().flatten().map(|&moment| ("kg m²", moment));
        let lengths = origin.xyz.map(|length| ("m", length));
        moments.chain(lengths).chain([("kg", *mass)]).collect::<Vec<_>>()
    };
    let links = description.links.iter().flat_map(|link| link.inertial.iter().flat_map(inertial));
    let joints = description.joints.iter().flat_map(|joint| joint.origin.xyz.map(|length| ("m", length)));
    links.chain(joints).collect()
}

fn of_state(robot: &Robot, State { position, velocity, scene, .. }: &State) -> Vec<Measured> {
    let positions = robot.units().map(|(unit, _)| unit).zip(position.iter().copied());
    let velocities = robot.units().map(|(_, unit)| unit).zip(velocity.iter().copied());
    let slope = match scene.ground {
        Ground::Slope(slope) => Some(("rad", slope)),
        Ground::Profile(_) => None,
    };
    let impulses = scene.impulses.iter().flat_map(|impulse| impulse.vector.components().map(|part| ("N s", part)));
    let gravity = scene.gravity.map(|gravity| ("m/s²", gravity));
    let loads = robot.units().skip(robot.base_dofs()).map(|(unit, _)| if unit == "m" { "N" } else { "N m" });
    let torques = loads.zip(scene.torque.iter().copied());
    positions.chain(velocities).chain(slope).chain(impulses).chain(gravity).chain(torques).collect()
}
