//! Reads the fields of a state, with one function per shape of value.

use super::json::{Node, Value, id_in};
use crate::law::Friction;
use crate::planar::Vector;
use crate::robot::{Base, FreezeReason};
use crate::state::{
    AppliedImpulse, ByLink, Defaults, Ground, LOOP_LIMIT, LinkPoint, NamedContact, NamedLoop, PLACED_BY_JOINTS,
    Profile, SpringEnd, SpringLaw, State, Uncertainty, VirtualSpring, bolted, check_restitution, check_slope,
    placed_twice,
};
use crate::{Reason, Result, Robot};

/// The entries of a floating base in the order of q.
pub(super) const BASE: [&str; 3] = ["x", "z", "pitch"];

/// Reads loops of `robot` from a JSON list in the format of a state's field `loops`.
pub fn loops_from_json(text: &str, robot: &Robot) -> Result<Vec<NamedLoop>> {
    let tree = Value::parse(text)?;
    loops(Node::root(&tree, text, None), robot)
}

impl State {
    /// Reads a state of `robot` from one JSON object. Numbers that it omits are 0; friction, loops and placement that
    /// it omits are those of `defaults`.
    ///
    /// # Errors
    /// Returns an error for text that is not a state of this robot: broken JSON, unknown or repeated fields and names,
    /// values of the wrong kind or outside their range, a base that is both placed and given. It has place, line and
    /// column.
    pub fn from_json(text: &str, robot: &Robot, defaults: &Defaults) -> Result<Self> {
        let tree = Value::parse(text)?;
        read(Node::root(&tree, text, None), robot, defaults)
    }

    /// Returns the `id` in the text of a state that may be refused; `None` if there is none.
    pub fn id_in(text: &str) -> Option<serde_json::Value> {
        id_in(text)
    }
}

/// Reads a whole state.
pub(crate) fn read(root: Node, robot: &Robot, defaults: &Defaults) -> Result<State> {
    let mut state = State::zero(robot);
    let scene = &mut state.scene;
    let (mut own_loops, mut own_place) = (None, None);

    for field in root.fields("field")? {
        match field.key() {
            "id" => state.id = Some(field.id()?),
            "position" => coordinates(field, robot, &mut state.position, |entry| entry.number())?,
            "velocity" => coordinates(field, robot, &mut state.velocity, |entry| entry.number())?,
            "friction" => scene.friction = by_link(field, robot, friction)?,
            "restitution" => scene.restitution = by_link(field, robot, restitution)?,
            "ground" => scene.ground = ground(field)?,
            "stance" => {
                scene.stance = Some(link(field, robot)?);
                refuse_bolted(field, robot, "a stance cannot place it")?;
            }
            "place" => own_place = Some((field, lowest(field, robot)?)),
            "held" => scene.braked = braked(field, robot)?,
            "rotor_inertia" => scene.rotor_inertia = rotor_inertia(field, robot)?,
            "contacts" => scene.contacts = Some(contacts(field, robot)?),
            "impulse" => scene.impulses = impulses(field, robot)?,
            "gravity" => scene.gravity = Some(field.number()?),
            "torque" => {
                scene.torque = vec![0.0; robot.joints.len()];
                by_joint(field, robot, &mut scene.torque, |entry| entry.number())?;
            }
            "virtual" => scene.springs = springs(field, robot)?,
            "loops" => own_loops = Some(loops(field, robot)?),
            "uncertainty" => state.uncertainty = Some(uncertainty(field, robot)?),
            _ => return Err(field.unknown_field("State")),
        }
    }
    if scene.stance.is_some() {
        let hint = "leave out either the stance or the base's x and z, of position and velocity";
        refuse_base(root, |name| format!("the stance already gives the base's {name}"), hint)?;
        if let Some(field) = root.field("uncertainty")? {
            let hint = "leave out either the stance or this half-width";
            refuse_base(field, |name| format!("the stance gives the base's {name} from the rest"), hint)?;
        }
    }
    if let (Some(_), Some((field, true))) = (scene.stance, own_place) {
        return Err(field.refuse_inside(placed_twice()));
    }
    let by_default = || defaults.place_lowest && scene.stance.is_none();
    scene.place_lowest = own_place.map_or_else(by_default, |(_, lowest)| lowest);
    scene.friction.default = scene.friction.default.or(defaults.friction);
    scene.loops = own_loops.unwrap_or_else(|| defaults.loops.clone());
    Ok(state)
}

/// Reads `{"base": {"x", "z", "pitch"}, "joints": {name: number}}` in the order of q.
fn coordinates(field: Node, robot: &Robot, into: &mut [f64], number: impl Fn(Node) -> Result<f64>) -> Result<()> {
    let (base, joints) = into.split_at_mut(robot.base_dofs());
    for part in field.fields("field")? {
        match part.key() {
            "base" => {
                refuse_bolted(part, robot, "its base has no coordinates")?;
                for entry in part.fields("base entry")? {
                    match BASE.iter().position(|name| *name == entry.key()) {
                        Some(at) => base[at] = number(entry)?,
                        None => return Err(entry.unknown_field("Base")),
                    }
                }
            }
            "joints" => by_joint(part, robot, joints, &number)?,
            _ => return Err(part.unknown_field("Coordinates")),
        }
    }
    Ok(())
}

/// Reads an object of numbers by joint.
fn by_joint(field: Node, robot: &Robot, into: &mut [f64], number: impl Fn(Node) -> Result<f64>) -> Result<()> {
    let mut next = 0;
    for entry in field.fields("joint")? {
        // Most files have the joints in the robot's order, and searching for each takes the square of their number.
        let is_next = robot.joints.get(next).is_some_and(|joint| joint.name == entry.key());
        let at = if is_next { next } else { joint(entry, entry.key(), robot)? };
        into[at] = number(entry)?;
        next = at + 1;
    }
    Ok(())
}

/// Refuses x and z of the base in `position` and `velocity`, or their half-widths, because the stance gives them.
fn refuse_base(object: Node, reason: impl Fn(&str) -> String, hint: &str) -> Result<()> {
    let given = |field: &Node| matches!(field.key(), "position" | "velocity") && field.is_object();
    for field in object.fields("field")?.filter(given) {
        let Some(base) = field.field("base")? else { continue };
        if let Some(entry) = base.fields("base entry")?.find(|entry| matches!(entry.key(), "x" | "z")) {
            return Err(entry.refuse(Reason::Inconsistent(reason(entry.key()))).hint(hint));
        }
    }
    Ok(())
}

/// Reads whether the lowest foot is placed on the ground: "lowest" is true, "given" is false.
fn lowest(field: Node, robot: &Robot) -> Result<bool> {
    let lowest = field.choice("\"lowest\" or \"given\"", [("lowest", true), ("given", false)])?;
    if lowest {
        refuse_bolted(field, robot, "it cannot be placed").map_err(|error| error.hint(PLACED_BY_JOINTS))?;
    }
    Ok(lowest)
}

fn refuse_bolted(field: Node, robot: &Robot, what: &str) -> Result<()> {
    if robot.base == Base::Floating {
        return Ok(());
    }
    Err(field.refuse_inside(bolted(what)))
}

/// Reads a value for all links, or an object of values by link with an optional `default`.
fn by_link<T: Copy>(field: Node, robot: &Robot, read: impl Fn(Node) -> Result<T>) -> Result<ByLink<T>> {
    if !field.is_object() {
        return Ok(ByLink::everywhere(read(field)?));
    }
    let mut values = ByLink::default();
    for entry in field.fields("link")? {
        if entry.key() == "default" {
            values.default = Some(read(entry)?);
        } else {
            values.links.insert(named_link(entry, entry.key(), robot)?, read(entry)?);
        }
    }
    Ok(values)
}

/// Reads a number that is 0 or more, or "infinite".
pub(crate) fn friction(node: Node) -> Result<Friction> {
    match node.as_text() {
        Some("infinite") => Ok(Friction::Infinite),
        Some(text) if node.names().is_none() => {
            let error = node.expected_number("a number or \"infinite\"").did_you_mean(text, ["infinite"]);
            Err(if matches!(text, "inf" | "Inf" | "Infinity") { error.hint("did you mean infinite?") } else { error })
        }
        text => {
            let number = node.number_from_zero("friction");
            number.map(Friction::Finite).map_err(|error| error.did_you_mean(text.unwrap_or_default(), ["infinite"]))
        }
    }
}

/// Reads a number from 0 to 1.
pub(crate) fn restitution(node: Node) -> Result<f64> {
    check_restitution(node.number()?).map_err(|error| node.refuse_inside(error))
}

/// Reads `{"slope": radians}` or `{"profile": [[x, z], ...]}`.
fn ground(field: Node) -> Result<Ground> {
    match field.object("Ground", ["slope", "profile"])? {
        [None, None] => Ok(Ground::default()),
        [Some(entry), None] => {
            check_slope(entry.number()?).map(Ground::Slope).map_err(|error| entry.refuse_inside(error))
        }
        [None, Some(entry)] => profile(entry).map(Ground::Profile),
        [Some(_), Some(entry)] => {
            let reason = Reason::Inconsistent("the ground has either a slope or a profile".into());
            Err(entry.refuse(reason).hint("leave one of them out: a profile of two points is a slope, too"))
        }
    }
}

/// Reads a list of `[x, z]`.
fn profile(entry: Node) -> Result<Profile> {
    let points = entry.entries()?.map(|point| point.numbers("a list of 2 numbers, [x, z]").map(Vector::from));
    Profile::new(points.collect::<Result<_>>()?).map_err(|error| entry.refuse_inside(error))
}

/// Reads a list of joints without repetition.
fn braked(field: Node, robot: &Robot) -> Result<Vec<usize>> {
    let mut braked = Vec::new();
    for entry in field.entries()? {
        let name = entry.text()?;
        let joint = joint(entry, name, robot)?;
        if braked.contains(&joint) {
            return Err(entry.refuse(Reason::Duplicate { what: "joint", name: name.to_owned() }));
        }
        braked.push(joint);
    }
    Ok(braked)
}

/// Reads an object of inertias by joint; the result has every joint, then every mimic joint of the robot.
fn rotor_inertia(field: Node, robot: &Robot) -> Result<Vec<f64>> {
    let mut inertia = vec![0.0; robot.joints.len() + robot.mimic_joints.len()];
    for entry in field.fields("joint")? {
        let name = entry.key();
        let place = match robot.mimic_joints.iter().position(|mimic| mimic.joint.name == name) {
            Some(mimic) => robot.joints.len() + mimic,
            None => joint(entry, name, robot)?,
        };
        inertia[place] = entry.number_from_zero("rotor inertia")?;
    }
    Ok(inertia)
}

/// Reads a list of `{"link", "offset", "radius"}`.
fn contacts(field: Node, robot: &Robot) -> Result<Vec<NamedContact>> {
    let contact = |entry: Node| {
        let [link, offset, radius] = entry.object("Contact", ["link", "offset", "radius"])?;
        let LinkPoint { link, offset } = link_point(entry, link, offset, robot)?;
        let radius = radius.map_or(Ok(0.0), |radius| radius.number_from_zero("radius"))?;
        Ok(NamedContact { link, offset, radius })
    };
    field.entries()?.map(contact).collect()
}

/// Reads a list of `{"a": {"link", "offset"}, "b": {"link", "offset"}}`.
fn loops(field: Node, robot: &Robot) -> Result<Vec<NamedLoop>> {
    let entries = field.entries()?;
    if entries.len() > LOOP_LIMIT {
        return Err(field.refuse(Reason::TooMany { what: "loops", limit: LOOP_LIMIT }));
    }
    let end = |entry: Node, name: &str, end: Option<Node>| {
        let end = end.ok_or_else(|| entry.missing(name))?;
        let [link, offset] = end.object("LinkPoint", ["link", "offset"])?;
        link_point(end, link, offset, robot)
    };
    let pair = |entry: Node| {
        let [a, b] = entry.object("Loop", ["a", "b"])?;
        Ok(NamedLoop { a: end(entry, "a", a)?, b: end(entry, "b", b)? })
    };
    entries.map(pair).collect()
}

/// Reads a list of `{"link", "offset", "vector"}`.
fn impulses(field: Node, robot: &Robot) -> Result<Vec<AppliedImpulse>> {
    let impulse = |entry: Node| {
        let [link, offset, vector] = entry.object("AppliedImpulse", ["link", "offset", "vector"])?;
        let LinkPoint { link, offset } = link_point(entry, link, offset, robot)?;
        let vector = axes(vector.ok_or_else(|| entry.missing("vector"))?)?;
        Ok(AppliedImpulse { link, offset, vector: vector.into() })
    };
    field.entries()?.map(impulse).collect()
}

/// Reads a list of `{"a", "b", "stiffness", "damping", "target", "force", "pitch", "moment"}`.
fn springs(field: Node, robot: &Robot) -> Result<Vec<VirtualSpring>> {
    let of_axes = |entry: Option<Node>| entry.map_or(Ok([0.0; 2]), axes);
    let number = |entry: Option<Node>| entry.map_or(Ok(0.0), |entry| entry.number());
    let pulled = |stiffness: &Option<Node>, target: &Option<Node>| match (stiffness, target) {
        (None, Some(target)) => {
            let reason = Reason::Inconsistent("nothing pulls to the target: the spring has no stiffness".into());
            Err(target.refuse(reason).hint("give `stiffness`, which may be 0, or leave the target out"))
        }
        _ => Ok(()),
    };
    let spring = |entry: Node| {
        let names = ["a", "b", "stiffness", "damping", "target", "force", "pitch", "moment"];
        let [a, b, along @ .., pitch, moment] = entry.object("Spring", names)?;
        let lacks = |name| entry.missing(name).hint("a spring has two ends, a and b, and b may be a place");
        let (a, b) = (a.ok_or_else(|| lacks("a"))?, b.ok_or_else(|| lacks("b"))?);
        let [link, offset] = a.object("LinkPoint", ["link", "offset"])?;
        pulled(&along[0], &along[2])?;
        let [stiffness, damping, target, constant] = along.map(of_axes);
        let [stiffness, damping, target, constant] = [stiffness?, damping?, target?, constant?];
        let along = |axis: usize| {
            let numbers = [stiffness, damping, target, constant].map(|of_axes| of_axes[axis]);
            let [stiffness, damping, target, constant] = numbers;
            SpringLaw { stiffness, damping, target, constant }
        };
        let [stiffness, damping, target] = match pitch {
            Some(pitch) => {
                let parts = pitch.object("PitchSpring", ["stiffness", "damping", "target"])?;
                pulled(&parts[0], &parts[2])?;
                parts.map(number)
            }
            None => [Ok(0.0), Ok(0.0), Ok(0.0)],
        };
        let pitch = SpringLaw { stiffness: stiffness?, damping: damping?, target: target?, constant: number(moment)? };
        let (a, b) = (link_point(a, link, offset, robot)?, spring_end(b, robot)?);
        Ok(VirtualSpring { a, b, laws: [along(0), along(1), pitch] })
    };
    field.entries()?.map(spring).collect()
}

/// Reads one number along x and one along z of the world.
fn axes(node: Node) -> Result<[f64; 2]> {
    let read = node.numbers("a list of 2 numbers, [x, z]");
    read.map_err(|error| match error.remedy() {
        None => error.hint("give one number along x and one along z of the world, as in [0, 800]"),
        Some(_) => error,
    })
}

/// Reads `{"link", "offset"}` or `{"world": [x, z]}`.
fn spring_end(end: Node, robot: &Robot) -> Result<SpringEnd> {
    const ENDS: &str = "name a link as {\"link\": NAME}, or give a place as {\"world\": [0, 0.5]}";
    if end.as_text().is_some() {
        return Err(end.expected("an object").hint(ENDS));
    }
    match end.object("SpringEnd", ["link", "offset", "world"])? {
        [None, None, Some(world)] => axes(world).map(|place| SpringEnd::World(place.into())),
        [None, _, None] => Err(end.missing("link").hint(ENDS)),
        [Some(link), ..] if link.as_text() == Some("world") && robot.link("world").is_none() => {
            Err(link.refuse(robot.no_link("world")).hint(ENDS))
        }
        [link, offset, None] => link_point(end, link, offset, robot).map(SpringEnd::Link),
        [_, _, Some(world)] => {
            let reason = Reason::Inconsistent("the end of a spring is either on a link or in the world".into());
            Err(world.refuse(reason).hint("leave out either the link with its offset or \"world\""))
        }
    }
}

/// Reads a point from these fields of `object`.
fn link_point(object: Node, named: Option<Node>, offset: Option<Node>, robot: &Robot) -> Result<LinkPoint> {
    let link = link(named.ok_or_else(|| object.missing("link"))?, robot)?;
    let offset = offset.map_or(Ok([0.0; 3]), |offset| offset.numbers("a list of 3 numbers"))?;
    Ok(LinkPoint { link, offset })
}

/// Finds the link that a string names.
fn link(node: Node, robot: &Robot) -> Result<usize> {
    named_link(node, node.text()?, robot)
}

/// Finds the link of that name, which is the node's value or key.
fn named_link(node: Node, name: &str, robot: &Robot) -> Result<usize> {
    let known = || robot.links.iter().map(|link| link.name.as_str());
    robot.link(name).ok_or_else(|| node.refuse_name(name, robot.no_link(name)).did_you_mean(name, known()))
}

/// Finds the joint of that name, which is the node's value or key.
fn joint(node: Node, name: &str, robot: &Robot) -> Result<usize> {
    robot.joint(name).ok_or_else(|| {
        let no_coordinate = |why: String| {
            node.refuse_name(name, Reason::Inconsistent(format!("joint \"{name}\" has no coordinate: {why}")))
        };
        if let Some(mimic) = robot.mimic_joints.iter().find(|mimic| mimic.joint.name == name) {
            let mimicked = &robot.joints[mimic.mimicked].name;
            return no_coordinate(format!("it follows joint \"{mimicked}\"")).hint(format!("name {mimicked} instead"));
        }
        if let Some(frozen) = robot.frozen(name) {
            let refused = no_coordinate(frozen.why());
            return match frozen.reason {
                FreezeReason::OffPlane { .. } => refused.hint(format!("pose it by `hold: {name}=VALUE`")),
                FreezeReason::Asked { .. } => refused.hint("leave it out of the state: `hold` has posed it"),
                _ => refused,
            };
        }
        let unknown = Reason::UnknownName { what: "joint", name: name.to_owned() };
        let others = robot.mimic_joints.iter().map(|mimic| &mimic.joint.name);
        let others = others.chain(robot.reading.frozen.iter().map(|frozen| &frozen.name));
        let known = robot.joints.iter().map(|joint| joint.name.as_str());
        // If no name is similar, only those with a coordinate are listed.
        let error = node.refuse_name(name, unknown).did_you_mean(name, known.clone());
        error.did_you_mean(name, known.chain(others.map(String::as_str)))
    })
}

/// Reads `{"position", "velocity", "friction", "rotor_inertia"}`, each one number or numbers by name.
fn uncertainty(field: Node, robot: &Robot) -> Result<Uncertainty> {
    let (zero, rotor_inertia) = (vec![0.0; robot.dofs()], vec![0.0; robot.joints.len()]);
    let mut read = Uncertainty { position: zero.clone(), velocity: zero, friction: ByLink::default(), rotor_inertia };
    for part in field.fields("field")? {
        match part.key() {
            "position" if part.is_object() => coordinates(part, robot, &mut read.position, half_width)?,
            "velocity" if part.is_object() => coordinates(part, robot, &mut read.velocity, half_width)?,
            "position" => read.position.fill(half_width(part)?),
            "velocity" => read.velocity.fill(half_width(part)?),
            "friction" => read.friction = by_link(part, robot, half_width)?,
            "rotor_inertia" if part.is_object() => by_joint(part, robot, &mut read.rotor_inertia, half_width)?,
            "rotor_inertia" => read.rotor_inertia.fill(half_width(part)?),
            _ => return Err(part.unknown_field("Uncertainty")),
        }
    }
    Ok(read)
}

fn half_width(node: Node) -> Result<f64> {
    node.number_from_zero("a half-width")
}
