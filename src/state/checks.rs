//! Checks of states and options, whether they come from text or from code; `read` adds line and column.

use super::{
    AppliedImpulse, ByLink, Ground, LinkPoint, NamedContact, Scene, SpringEnd, State, Uncertainty, check_length,
};
use crate::error::{Error, Reason, Result, check_index, finite, from_zero};
use crate::law::Friction;
use crate::robot::{Base, Robot};
use std::f64::consts::FRAC_PI_2;

/// The remedy for a bolted robot that is to be placed.
pub(crate) const PLACED_BY_JOINTS: &str = "put its foot on the ground by its joints, or give `base: floating`";

/// The greatest number of loops of a state: each costs as much as a contact, and no robot has a tenth of this number.
pub(crate) const LOOP_LIMIT: usize = 256;

impl State {
    /// Refuses wrong lengths, unknown indices, numbers out of range, and a base that cannot be placed or is twice.
    pub(crate) fn check(&self, robot: &Robot) -> Result<()> {
        let Self { position, velocity, scene, uncertainty, .. } = self;
        check_length("position", position.len(), robot.dofs())?;
        check_length("velocity", velocity.len(), robot.dofs())?;
        scene.check(robot)?;
        // A stance gives x and z of the base, whose entries are placeholders.
        let placed = if scene.stance.is_some() { 2 } else { 0 };
        for (what, list) in [("position", position), ("velocity", velocity)] {
            if let Some(at) = (placed..list.len()).find(|&at| !list[at].is_finite()) {
                let reason = Reason::NotFinite { what: format!("a {what}"), value: list[at] };
                return Err(Error::new(reason).at(coordinate_place(robot, what, at)));
            }
        }
        uncertainty.as_ref().map_or(Ok(()), |uncertainty| uncertainty.check(robot))
    }
}

impl Scene {
    fn check(&self, robot: &Robot) -> Result<()> {
        let (links, joints) = (("links", robot.links.len()), ("joints", robot.joints.len()));
        let index = |place: &str, index: usize, of| check_index(index, of).map_err(|error| error.at(place));
        let point = |list: &str, at: usize, end: &str, point: LinkPoint| {
            index(list, point.link, links)?;
            check_finite(&point.offset, || format!("{list}[{at}]{end}.offset"))
        };
        self.stance.map_or(Ok(()), |link| index("stance", link, links))?;
        for (at, &joint) in self.braked.iter().enumerate() {
            index("held", joint, joints)?;
            if self.braked[..at].contains(&joint) {
                let twice = Reason::Duplicate { what: "joint", name: robot.joints[joint].name.clone() };
                return Err(Error::new(twice).at(format!("held[{at}]")));
            }
        }
        if robot.base != Base::Floating && self.stance.is_some() {
            return Err(bolted("a stance cannot place it").at("stance"));
        }
        if robot.base != Base::Floating && self.place_lowest {
            return Err(bolted("it cannot be placed").at("place").hint(PLACED_BY_JOINTS));
        }
        if self.stance.is_some() && self.place_lowest {
            return Err(placed_twice().at("place"));
        }
        let all = joints.1 + robot.mimic_joints.len();
        check_joints(robot, "rotor_inertia", (&self.rotor_inertia, &[all]), |value| from_zero(value, "rotor inertia"))?;
        check_joints(robot, "torque", (&self.torque, &[joints.1]), |torque| finite(torque, || "a torque".into()))?;
        let rough = |friction| match friction {
            Friction::Finite(mu) => from_zero(mu, "friction"),
            Friction::Infinite => Ok(0.0),
        };
        check_by_link(robot, "friction", &self.friction, rough)?;
        check_by_link(robot, "restitution", &self.restitution, check_restitution)?;
        if let Ground::Slope(slope) = self.ground {
            check_slope(slope).map_err(|error| error.at("ground.slope"))?;
        }
        check_contacts(robot, "contacts", self.contacts.as_deref().unwrap_or_default())?;
        if self.loops.len() > LOOP_LIMIT {
            return Err(Error::new(Reason::TooMany { what: "loops", limit: LOOP_LIMIT }).at("loops"));
        }
        for (at, pair) in self.loops.iter().enumerate() {
            point("loops", at, ".a", pair.a)?;
            point("loops", at, ".b", pair.b)?;
        }
        for (at, &AppliedImpulse { link, offset, vector }) in self.impulses.iter().enumerate() {
            point("impulse", at, "", LinkPoint { link, offset })?;
            check_finite(&vector.components(), || format!("impulse[{at}].vector"))?;
        }
        for (at, spring) in self.springs.iter().enumerate() {
            point("virtual", at, ".a", spring.a)?;
            match spring.b {
                SpringEnd::Link(b) => point("virtual", at, ".b", b)?,
                SpringEnd::World(place) => check_finite(&place.components(), || format!("virtual[{at}].b.world"))?,
            }
            for law in spring.laws {
                let numbers = [law.stiffness, law.damping, law.target, law.constant];
                check_finite(&numbers, || format!("virtual[{at}].laws"))?;
            }
        }
        finite(self.gravity(), || "gravity".into()).map(drop).map_err(|error| error.at("gravity"))
    }
}

impl Uncertainty {
    fn check(&self, robot: &Robot) -> Result<()> {
        let half_width = |width| from_zero(width, "a half-width");
        for (what, list) in [("uncertainty.position", &self.position), ("uncertainty.velocity", &self.velocity)] {
            check_length(what, list.len(), robot.dofs())?;
            check_each(list, half_width, |at| coordinate_place(robot, what, at))?;
        }
        check_by_link(robot, "uncertainty.friction", &self.friction, half_width)?;
        let joints = robot.joints.len();
        let lengths = [joints, joints + robot.mimic_joints.len()];
        check_joints(robot, "uncertainty.rotor_inertia", (&self.rotor_inertia, &lengths), half_width)
    }
}

/// The place of a coordinate in a list such as `position`.
pub(crate) fn coordinate_place(robot: &Robot, list: &str, coordinate: usize) -> String {
    let part = if coordinate < robot.base_dofs() { "base" } else { "joints" };
    format!("{list}.{part}.{}", robot.coordinates().nth(coordinate).unwrap_or_default())
}

/// Refuses contacts of unknown links, with offsets that are not finite or with negative radii.
pub(crate) fn check_contacts(robot: &Robot, place: &'static str, contacts: &[NamedContact]) -> Result<()> {
    for (at, contact) in contacts.iter().enumerate() {
        check_index(contact.link, ("links", robot.links.len())).map_err(|error| error.at(place))?;
        check_finite(&contact.offset, || format!("{place}[{at}].offset"))?;
        from_zero(contact.radius, "radius").map_err(|error| error.at(format!("{place}[{at}].radius")))?;
    }
    Ok(())
}

pub(crate) fn check_restitution(value: f64) -> Result<f64> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(Reason::OutOfRange { what: "restitution".into(), allowed: "between 0 and 1", value }.into())
}

pub(crate) fn check_slope(value: f64) -> Result<f64> {
    if value.abs() < FRAC_PI_2 {
        return Ok(value);
    }
    let reason = Reason::OutOfRange { what: "slope".into(), allowed: "between -pi/2 and pi/2", value };
    Err(Error::new(reason).hint("it is in radians: 10 degrees are 0.1745"))
}

/// The error for a stance with `place: lowest`.
pub(crate) fn placed_twice() -> Error {
    let reason = Reason::Inconsistent("the stance already places the base".into());
    Error::new(reason).hint("leave out either the stance or \"place\"")
}

/// The error for a request that a robot without a floating base cannot fulfill; `what` names it.
pub(crate) fn bolted(what: &str) -> Error {
    let reason = Reason::Inconsistent(format!("the robot is bolted to the world, {what}"));
    Error::new(reason).hint("leave it out, or give `base: floating`")
}

#[inline]
fn check_each(list: &[f64], check: impl Fn(f64) -> Result<f64>, place: impl Fn(usize) -> String) -> Result<()> {
    list.iter().enumerate().try_for_each(|(at, &entry)| check(entry).map(drop).map_err(|error| error.at(place(at))))
}

fn check_finite(list: &[f64], place: impl Fn() -> String) -> Result<()> {
    check_each(list, |entry| finite(entry, || "a number".into()), |at| format!("{}[{at}]", place()))
}

fn check_by_link<T: Copy>(
    robot: &Robot,
    place: &'static str,
    values: &ByLink<T>,
    check: impl Fn(T) -> Result<f64>,
) -> Result<()> {
    if let Some(value) = values.default {
        check(value).map_err(|error| error.at(place))?;
    }
    for (&link, &value) in &values.links {
        check_index(link, ("links", robot.links.len())).map_err(|error| error.at(place))?;
        check(value).map_err(|error| error.at(format!("{place}.{}", robot.links[link].name)))?;
    }
    Ok(())
}

/// Checks a list by joint, then by mimic joint, that is empty or has one of the `lengths`.
fn check_joints(
    robot: &Robot,
    place: &'static str,
    (list, lengths): (&[f64], &[usize]),
    check: impl Fn(f64) -> Result<f64>,
) -> Result<()> {
    if !list.is_empty() && !lengths.contains(&list.len()) {
        let error = check_length(place, list.len(), lengths[0]);
        return error.map_err(|error| error.hint("give an entry per joint; an empty list stands for zeros"));
    }
    let name = |at| robot.moving_joints().nth(at).map_or("", |joint| &joint.name);
    check_each(list, check, |at| format!("{place}.{}", name(at)))
}
