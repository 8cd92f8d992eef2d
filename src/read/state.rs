//! The fields of a state, one function for each shape of value.

use super::format::fields_of;
use super::json::{Node, Value, id_in};
use crate::law::Friction;
use crate::planar::Vector;
use crate::robot::Base;
use crate::state::{
    AppliedImpulse, ByLink, Defaults, Ground, LinkPoint, NamedContact, NamedLoop, Profile, State, Uncertainty,
};
use crate::{Error, Reason, Result, Robot};
use std::f64::consts::FRAC_PI_2;

/// The entries of a floating base in the order of q.
const BASE: [&str; 3] = ["x", "z", "pitch"];

/// The most loops of a state: each costs as much as a contact, and no robot has a tenth of these.
const LOOP_LIMIT: usize = 256;

/// Reads loops of `robot` from a JSON list, as a state's field `loops` has it.
///
/// # Errors
/// Anything else than such a list; the error has place, line and column in `text`.
pub fn loops_from_json(text: &str, robot: &Robot) -> Result<Vec<NamedLoop>> {
    let tree = Value::parse(text)?;
    loops(Node::root(&tree, text), robot)
}

impl State {
    /// Reads a state of `robot` from one JSON object; what it omits is 0, and its friction that of `defaults`.
    ///
    /// Whether every contact ends up with a friction is not known before the contacts are.
    ///
    /// # Errors
    /// Whatever is not a state of this robot: broken JSON, unknown or doubled fields and names, values of the wrong
    /// kind or outside their range, a base that is both placed and given. The error has place, line and column in
    /// `text`.
    pub fn from_json(text: &str, robot: &Robot, defaults: &Defaults) -> Result<Self> {
        let tree = Value::parse(text)?;
        read(Node::root(&tree, text), robot, defaults)
    }

    /// The `id` in the text of a state that may be refused; `None` if there is none.
    pub fn id_in(text: &str) -> Option<serde_json::Value> {
        id_in(text)
    }
}

/// Reads a whole state.
pub(crate) fn read(root: Node, robot: &Robot, defaults: &Defaults) -> Result<State> {
    let mut state = State::zero(robot);
    let scene = &mut state.scene;
    let mut own_loops = None;

    for field in root.fields("field")? {
        match field.key() {
            "id" => state.id = Some(field.id()?),
            "position" => coordinates(field, robot, &mut state.position, number)?,
            "velocity" => coordinates(field, robot, &mut state.velocity, number)?,
            "friction" => scene.friction = by_link(field, robot, friction)?,
            "restitution" => scene.restitution = by_link(field, robot, restitution)?,
            "ground" => scene.ground = ground(field)?,
            "stance" => scene.stance = Some(stance(field, robot)?),
            "held" => scene.held = held(field, robot)?,
            "rotor_inertia" => scene.rotor_inertia = rotor_inertia(field, robot)?,
            "contacts" => scene.contacts = Some(contacts(field, robot)?),
            "impulse" => scene.impulses = impulses(field, robot)?,
            "loops" => own_loops = Some(loops(field, robot)?),
            "uncertainty" => state.uncertainty = Some(uncertainty(field, robot)?),
            _ => return Err(field.unknown_field(&fields_of("State"))),
        }
    }
    if scene.stance.is_some() {
        refuse_a_placed_base(root)?;
    }
    scene.friction.default = scene.friction.default.or(defaults.friction);
    scene.loops = own_loops.unwrap_or_else(|| defaults.loops.clone());
    Ok(state)
}

/// Any number.
fn number(node: Node) -> Result<f64> {
    node.number()
}

/// `{"base": {"x", "z", "pitch"}, "joints": {name: number}}` into the order of q.
fn coordinates(field: Node, robot: &Robot, into: &mut [f64], number: impl Fn(Node) -> Result<f64>) -> Result<()> {
    let (base, joints) = into.split_at_mut(robot.base_dofs());
    for part in field.fields("field")? {
        match part.key() {
            "base" if robot.base == Base::Fixed => {
                let reason =
                    Reason::Inconsistent("the robot is bolted to the world, its base has no coordinates".into());
                return Err(part.refuse(reason).hint("leave it out, or give `base: floating`"));
            }
            "base" => {
                for entry in part.fields("base entry")? {
                    match BASE.iter().position(|name| *name == entry.key()) {
                        Some(at) => base[at] = number(entry)?,
                        None => return Err(entry.unknown_field(&fields_of("Base"))),
                    }
                }
            }
            "joints" => {
                for entry in part.fields("joint")? {
                    joints[joint(entry, entry.key(), robot)?] = number(entry)?;
                }
            }
            _ => return Err(part.unknown_field(&fields_of("Coordinates"))),
        }
    }
    Ok(())
}

/// A stance places the base and gives its velocity: both given is one too many.
fn refuse_a_placed_base(root: Node) -> Result<()> {
    for field in root.fields("field")?.filter(|field| matches!(field.key(), "position" | "velocity")) {
        for base in field.fields("field")?.filter(|part| part.key() == "base") {
            if let Some(entry) = base.fields("base entry")?.find(|entry| matches!(entry.key(), "x" | "z")) {
                let reason = Reason::Inconsistent(format!("the stance already gives the base's {}", entry.key()));
                return Err(entry.refuse(reason).hint("leave out either the stance or the base's x and z"));
            }
        }
    }
    for field in root.fields("field")?.filter(|field| field.key() == "uncertainty") {
        refuse_half_widths_of_a_placed_base(field)?;
    }
    Ok(())
}

fn stance(field: Node, robot: &Robot) -> Result<usize> {
    let link = link(field, field.text()?, robot)?;
    match robot.base {
        Base::Floating => Ok(link),
        Base::Fixed => {
            let reason = Reason::Inconsistent("the robot is bolted to the world, a stance cannot place it".into());
            Err(field.refuse(reason).hint("leave it out, or give `base: floating`"))
        }
    }
}

/// A value for all links, or an object of values by link with an optional `default`.
fn by_link<T: Copy>(field: Node, robot: &Robot, read: impl Fn(Node) -> Result<T>) -> Result<ByLink<T>> {
    if !field.is_object() {
        return Ok(ByLink::everywhere(read(field)?));
    }
    let mut values = ByLink::default();
    for entry in field.fields("link")? {
        match entry.key() {
            "default" => values.default = Some(read(entry)?),
            name => {
                values.links.insert(link(entry, name, robot)?, read(entry)?);
            }
        }
    }
    Ok(values)
}

/// A number from 0 on, or "infinite".
pub(crate) fn friction(node: Node) -> Result<Friction> {
    match node.as_text() {
        Some("infinite") => Ok(Friction::Infinite),
        Some(_) if !node.takes_expressions() => {
            Err(node.expected("a number or \"infinite\"").did_you_mean(node.text()?, ["infinite"]))
        }
        Some(text) => {
            let number = node.number_from_zero("friction").map_err(|error| error.did_you_mean(text, ["infinite"]));
            number.map(Friction::Finite)
        }
        None => node.number_from_zero("friction").map(Friction::Finite),
    }
}

/// A number from 0 to 1.
pub(crate) fn restitution(node: Node) -> Result<f64> {
    let value = node.number()?;
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    Err(node.refuse(Reason::OutOfRange { what: "restitution".into(), allowed: "between 0 and 1", value }))
}

/// `{"slope": radians}` or `{"profile": [[x, z], ...]}`.
fn ground(field: Node) -> Result<Ground> {
    let mut ground = None;
    for entry in field.fields("field")? {
        let read = match entry.key() {
            "slope" => Ground::Slope(slope(entry)?),
            "profile" => Ground::Profile(profile(entry)?),
            _ => return Err(entry.unknown_field(&fields_of("Ground"))),
        };
        if ground.replace(read).is_some() {
            let reason = Reason::Inconsistent("the ground has either a slope or a profile".into());
            return Err(entry.refuse(reason).hint("leave one of them out: a profile of two points is a slope, too"));
        }
    }
    Ok(ground.unwrap_or_default())
}

fn slope(entry: Node) -> Result<f64> {
    let value = entry.number()?;
    if value.abs() >= FRAC_PI_2 {
        let what = "slope".into();
        return Err(entry.refuse(Reason::OutOfRange { what, allowed: "between -pi/2 and pi/2", value }));
    }
    Ok(value)
}

/// A list of `[x, z]`.
fn profile(entry: Node) -> Result<Profile> {
    let points = entry.entries()?.map(|point| point.numbers("a list of 2 numbers, [x, z]").map(Vector::from));
    Profile::new(points.collect::<Result<_>>()?).map_err(|error| entry.refuse_inside(error))
}

/// A list of different joints.
fn held(field: Node, robot: &Robot) -> Result<Vec<usize>> {
    let mut held = Vec::new();
    for entry in field.entries()? {
        let name = entry.text()?;
        let joint = joint(entry, name, robot)?;
        if held.contains(&joint) {
            return Err(entry.refuse(Reason::Duplicate { what: "joint", name: name.to_owned() }));
        }
        held.push(joint);
    }
    Ok(held)
}

/// An object of inertias by joint, for every joint and then every follower of the robot.
fn rotor_inertia(field: Node, robot: &Robot) -> Result<Vec<f64>> {
    let mut inertia = vec![0.0; robot.joints.len() + robot.mimic_joints.len()];
    for entry in field.fields("joint")? {
        let name = entry.key();
        let place = match robot.mimic_joints.iter().position(|follower| follower.name == name) {
            Some(follower) => robot.joints.len() + follower,
            None => joint(entry, name, robot)?,
        };
        inertia[place] = entry.number_from_zero("rotor inertia")?;
    }
    Ok(inertia)
}

/// A list of `{"link", "offset", "radius"}`.
fn contacts(field: Node, robot: &Robot) -> Result<Vec<NamedContact>> {
    let mut contacts = Vec::new();
    for entry in field.entries()? {
        let (mut named, mut offset, mut radius) = (None, [0.0; 3], 0.0);
        for part in entry.fields("field")? {
            match part.key() {
                "link" => named = Some(link(part, part.text()?, robot)?),
                "offset" => offset = part.numbers("a list of 3 numbers")?,
                "radius" => radius = part.number_from_zero("radius")?,
                _ => return Err(part.unknown_field(&fields_of("Contact"))),
            }
        }
        let link = named.ok_or_else(|| missing(entry, "link"))?;
        contacts.push(NamedContact { link, offset, radius });
    }
    Ok(contacts)
}

/// A list of `{"a": {"link", "offset"}, "b": {"link", "offset"}}`.
pub(super) fn loops(field: Node, robot: &Robot) -> Result<Vec<NamedLoop>> {
    let mut loops = Vec::new();
    let entries = field.entries()?;
    if entries.len() > LOOP_LIMIT {
        return Err(field.refuse(Reason::TooMany { what: "loops", limit: LOOP_LIMIT }));
    }
    for entry in entries {
        let (mut a, mut b) = (None, None);
        for part in entry.fields("field")? {
            match part.key() {
                "a" => a = Some(link_point(part, robot)?),
                "b" => b = Some(link_point(part, robot)?),
                _ => return Err(part.unknown_field(&fields_of("Loop"))),
            }
        }
        let a = a.ok_or_else(|| missing(entry, "a"))?;
        let b = b.ok_or_else(|| missing(entry, "b"))?;
        loops.push(NamedLoop { a, b });
    }
    Ok(loops)
}

/// `{"link", "offset"}`.
fn link_point(field: Node, robot: &Robot) -> Result<LinkPoint> {
    let (mut named, mut offset) = (None, [0.0; 3]);
    for part in field.fields("field")? {
        match part.key() {
            "link" => named = Some(link(part, part.text()?, robot)?),
            "offset" => offset = part.numbers("a list of 3 numbers")?,
            _ => return Err(part.unknown_field(&fields_of("LinkPoint"))),
        }
    }
    let link = named.ok_or_else(|| missing(field, "link"))?;
    Ok(LinkPoint { link, offset })
}

/// A list of `{"link", "offset", "vector"}`.
fn impulses(field: Node, robot: &Robot) -> Result<Vec<AppliedImpulse>> {
    let mut impulses = Vec::new();
    for entry in field.entries()? {
        let (mut named, mut offset, mut applied) = (None, [0.0; 3], None);
        for part in entry.fields("field")? {
            match part.key() {
                "link" => named = Some(link(part, part.text()?, robot)?),
                "offset" => offset = part.numbers("a list of 3 numbers")?,
                "vector" => applied = Some(Vector::from(part.numbers("a list of 2 numbers, [x, z]")?)),
                _ => return Err(part.unknown_field(&fields_of("AppliedImpulse"))),
            }
        }
        let link = named.ok_or_else(|| missing(entry, "link"))?;
        let vector = applied.ok_or_else(|| missing(entry, "vector"))?;
        impulses.push(AppliedImpulse { link, offset, vector });
    }
    Ok(impulses)
}

fn link(node: Node, name: &str, robot: &Robot) -> Result<usize> {
    let known = || robot.links.iter().map(|link| link.name.as_str());
    robot.link(name).ok_or_else(|| node.refuse_name(name, robot.no_link(name)).did_you_mean(name, known()))
}

fn joint(node: Node, name: &str, robot: &Robot) -> Result<usize> {
    let known = || robot.joints.iter().map(|joint| joint.name.as_str());
    robot.joint(name).ok_or_else(|| {
        let what = format!("joint \"{name}\"");
        if let Some(follower) = robot.mimic_joints.iter().find(|follower| follower.name == name) {
            let leader = &robot.joints[follower.mimicked].name;
            let reason = format!("{what} has no coordinate: it follows joint \"{leader}\"");
            return node.refuse_name(name, Reason::Inconsistent(reason)).hint(format!("name {leader} instead"));
        }
        match robot.frozen(name) {
            Some(held) => {
                node.refuse_name(name, Reason::Inconsistent(format!("{what} has no coordinate: {}", held.why())))
            }
            None => {
                let unknown = Reason::UnknownName { what: "joint", name: name.to_owned() };
                node.refuse_name(name, unknown).did_you_mean(name, known())
            }
        }
    })
}

fn missing(node: Node, what: &str) -> Error {
    node.refuse(Reason::Missing(format!("\"{what}\"")))
}

/// `{"position", "velocity", "friction", "rotor_inertia"}`, each one number or by name.
fn uncertainty(field: Node, robot: &Robot) -> Result<Uncertainty> {
    let (dofs, joints) = (robot.dofs(), robot.joints.len());
    let mut read = Uncertainty {
        position: vec![0.0; dofs],
        velocity: vec![0.0; dofs],
        friction: ByLink::default(),
        rotor_inertia: vec![0.0; joints],
    };
    for part in field.fields("field")? {
        match part.key() {
            "position" if part.is_object() => coordinates(part, robot, &mut read.position, half_width)?,
            "velocity" if part.is_object() => coordinates(part, robot, &mut read.velocity, half_width)?,
            "position" => read.position.fill(half_width(part)?),
            "velocity" => read.velocity.fill(half_width(part)?),
            "friction" => read.friction = by_link(part, robot, half_width)?,
            "rotor_inertia" if part.is_object() => {
                for entry in part.fields("joint")? {
                    read.rotor_inertia[joint(entry, entry.key(), robot)?] = half_width(entry)?;
                }
            }
            "rotor_inertia" => read.rotor_inertia.fill(half_width(part)?),
            _ => return Err(part.unknown_field(&fields_of("Uncertainty"))),
        }
    }
    Ok(read)
}

/// The base's x and z follow the stance's foot: a half-width of their own would be read in vain.
fn refuse_half_widths_of_a_placed_base(field: Node) -> Result<()> {
    for part in field.fields("field")?.filter(|part| matches!(part.key(), "position" | "velocity") && part.is_object())
    {
        for base in part.fields("field")?.filter(|entry| entry.key() == "base") {
            if let Some(entry) = base.fields("base entry")?.find(|entry| matches!(entry.key(), "x" | "z")) {
                let reason = Reason::Inconsistent(format!("the stance gives the base's {} from the rest", entry.key()));
                return Err(entry.refuse(reason).hint("leave out either the stance or this half-width"));
            }
        }
    }
    Ok(())
}

fn half_width(node: Node) -> Result<f64> {
    node.number_from_zero("a half-width")
}
