//! Converts XML elements to links and joints, checked and with their locations.

use super::elements::{ByName, EXPAND, IgnoredCount, MOST_MISSPELT, WORLD, limits, misspelt, rotors, undefined_world};
use super::repair::Repaired;
use super::xml::{self, Cursor, MOST_LINKS};
use super::{Description, JointKind, UrdfJoint, UrdfLink, joint_place, link_place, values};
use crate::error::{Location, Reason, Result};
use memchr::{memchr2, memmem};
use roxmltree::{Document, Node};

/// Largest number of moving joints: the factorization of M takes n^3 / 3 steps for a chain of n joints.
const MOST_MOVING: usize = 2000;
/// Largest number of mimics of unknown joints for which a similar name is searched.
const MOST_LIKENED: usize = 3;
/// Drake's name for a spherical joint.
const DRAKES_SPHERICAL: &str = "ball";

/// Reads the description of `text` without connecting links and joints; see [`Description::from_urdf`] for the errors.
pub(super) fn read(text: &str) -> Result<Description> {
    let mut repaired = Repaired::new(text);
    loop {
        match xml::parse(&repaired.text) {
            Ok(document) => {
                let mut description = read_document(&document).map_err(|error| repaired.refusal(error))?;
                let links = description.links.iter_mut().map(|link| &mut link.location);
                let places = links.chain(description.joints.iter_mut().map(|joint| &mut joint.location));
                places.for_each(|place| *place = repaired.in_file(*place));
                return Ok(description);
            }
            Err((refused, prefix)) => {
                let refused = repaired.refusal(refused);
                repaired = prefix.and_then(|prefix| repaired.declaring(&prefix)).ok_or(refused)?;
            }
        }
    }
}

fn read_document(document: &Document<'_>) -> Result<Description> {
    let robot = document.root_element();
    require_urdf(robot)?;
    refuse_xacro(robot)?;

    let mut cursor = Cursor::new(document.input_text());
    // Most children are links and joints, each with a text of white space.
    let expected = robot.children().count() / 4;
    let (mut links, mut joints) = (ByName::new("link", expected), ByName::new("joint", expected));
    let mut ignored = IgnoredCount::default();
    for element in robot.children().filter(Node::is_element) {
        let location = cursor.locate(element.range().start);
        match tag(robot, element) {
            Some("link") => links.push(element, location)?,
            Some("joint") => joints.push(element, location)?,
            Some("material") => {}
            _ => ignored.count("robot", element)?,
        }
    }
    if links.elements.is_empty() {
        return Err(xml::refuse(robot, Reason::Missing("a <link>".into())));
    }
    let world = undefined_world(&links, &joints);
    links.by_name.extend(world.map(|_| (WORLD, links.elements.len())));
    refuse_many_joints(&joints)?;

    let mut description = Description {
        name: robot.attribute("name").unwrap_or_default().to_owned(),
        links: Vec::with_capacity(links.elements.len() + 1),
        joints: Vec::with_capacity(joints.elements.len()),
        root: 0,
        ignored: Vec::new(),
        misspelt: Vec::new(),
        rotors: rotors(robot),
        guessed: Vec::new(),
    };
    let mut shapes = 0;
    for &(name, element, location) in &links.elements {
        let link = read_link(name, element, location, &mut ignored).and_then(|link| {
            shapes += link.collisions.len();
            let many = Reason::TooMany { what: "collision shapes", limit: MOST_LINKS };
            if shapes > MOST_LINKS { Err(xml::refuse(element, many)) } else { Ok(link) }
        });
        description.links.push(link.map_err(|error| error.at(link_place(name)))?);
    }
    description.links.extend(world.map(|location| UrdfLink {
        name: WORLD.into(),
        inertial: None,
        collisions: Vec::new(),
        joint: None,
        location,
    }));
    for &(name, element, location) in &joints.elements {
        let joint = read_joint(name, element, location, &links, &joints, &mut ignored);
        let (joint, unread) = joint.map_err(|error| error.at(joint_place(name)))?;
        description.joints.push(joint);
        let known = description.misspelt.len();
        description.misspelt.extend(unread.filter(|_| known < MOST_MISSPELT).and_then(|mimic| {
            let error = match mimic.attribute("joint") {
                // The search for a similar name takes time.
                Some(other) if known >= MOST_LIKENED => joints.unknown(mimic, other),
                _ => joints.find(mimic, "joint").err()?,
            };
            let remedy = error.remedy().map_or(String::new(), |remedy| format!("; {remedy}"));
            let (line, reason) = (error.location()?.line, format!("{}{remedy}", error.reason()));
            Some(format!("<mimic> of {name} on line {line} ({reason}), so that this joint follows no other one"))
        }));
    }
    let most = MOST_MISSPELT - description.misspelt.len();
    description.misspelt.extend(misspelt(robot).into_iter().take(most));
    Ok(Description { ignored: ignored.kinds, ..description })
}

/// Refuses too many joints before the expensive steps. A tree has fewer joints than links, but this may not be a tree.
fn refuse_many_joints(joints: &ByName) -> Result<()> {
    let mut all = joints.elements.iter().map(|&(_, element, _)| element);
    let mut moving = all.clone().filter(|element| element.attribute("type") != Some("fixed"));
    for (what, limit, too_many) in
        [("joints", MOST_LINKS, all.nth(MOST_LINKS)), ("joints that move", MOST_MOVING, moving.nth(MOST_MOVING))]
    {
        if let Some(element) = too_many {
            return Err(xml::refuse(element, Reason::TooMany { what, limit }));
        }
    }
    Ok(())
}

fn require_urdf(root: Node<'_, '_>) -> Result<()> {
    let tag = root.tag_name().name();
    let hint = match tag {
        "robot" => return Ok(()),
        "sdf" => {
            "this is an SDF file; convert it by the Python package and `pip install drake`: \
             `python -m heelstrike.to_urdf MODEL.sdf ROBOT.urdf`"
        }
        "mujoco" => {
            "this is a MuJoCo model; convert it by the Python package and `pip install drake`: \
             `python -m heelstrike.to_urdf MODEL.xml ROBOT.urdf`"
        }
        _ => "the outermost element of a URDF file is <robot>",
    };
    Err(xml::refuse(root, Reason::Missing("<robot>".into())).at(format!("<{tag}>")).hint(hint))
}

/// Refuses unexpanded macros, with a namespace or the old syntax without; a declared namespace alone is no macro.
fn refuse_xacro(robot: Node<'_, '_>) -> Result<()> {
    let is_macro = |element: &Node| {
        let of_xacro = |uri: &str| uri.contains("xacro") || element.lookup_prefix(uri) == Some("xacro");
        element.tag_name().namespace().is_some_and(of_xacro)
    };
    let refused = |element: Node, what: String| {
        xml::refuse(element, Reason::Unsupported(format!("{what} is not URDF"))).hint(EXPAND)
    };
    let text = robot.document().input_text().as_bytes();
    // Without a namespace declaration, elements can only have XML's own namespace.
    if memmem::find(text, b"xmlns").is_some()
        && let Some(element) = robot.descendants().find(|node| node.is_element() && is_macro(node))
    {
        return Err(refused(element, format!("<xacro:{}>", element.tag_name().name())));
    }
    // A dollar sign may also be written as a character reference.
    let may_have_dollar = memchr2(b'$', b'&', text).is_some();
    for element in robot.children().filter(Node::is_element) {
        let place: fn(&str) -> String = match tag(robot, element) {
            Some(old @ ("include" | "property" | "macro")) => {
                return Err(refused(element, format!("<{old}> of xacro")));
            }
            Some("link") => link_place,
            Some("joint") => joint_place,
            // Elements for other programs may contain anything.
            _ => continue,
        };
        if !may_have_dollar {
            continue;
        }
        // These are not read.
        let is_skipped = |node: Node| matches!(node.tag_name().name(), "gazebo" | "visual");
        for inside in element.descendants().filter(|node| node.is_element() && !node.ancestors().any(is_skipped)) {
            let mut values = inside.attributes().map(|attribute| attribute.value());
            if let Some(value) = values.find(|value| value.split('$').skip(1).any(|rest| rest.starts_with(['{', '('])))
            {
                let name = element.attribute("name").unwrap_or_default();
                return Err(refused(inside, format!("\"{value}\"")).at(place(name)));
            }
        }
    }
    Ok(())
}

/// Returns the tag of a child of `robot` if both have the same namespace.
fn tag<'a>(robot: Node<'_, '_>, element: Node<'a, '_>) -> Option<&'a str> {
    (element.tag_name().namespace() == robot.tag_name().namespace()).then(|| element.tag_name().name())
}

fn read_link<'input>(
    name: &str,
    element: Node<'_, 'input>,
    location: Location,
    ignored: &mut IgnoredCount<'input>,
) -> Result<UrdfLink> {
    // An <inertial> without child elements counts as missing.
    let [inertial] = xml::named(element, ["inertial"]);
    let inertial = inertial?.filter(|inertial| inertial.children().any(|child| child.is_element()));
    let inertial = inertial.map(values::inertial).transpose()?;
    let mut collisions = Vec::new();
    for child in element.children().filter(Node::is_element) {
        match tag(element, child) {
            Some("collision") => collisions.push(values::collision(child)?),
            Some("inertial" | "visual") => {}
            _ => ignored.count("link", child)?,
        }
    }
    Ok(UrdfLink { name: name.into(), inertial, collisions, joint: None, location })
}

/// Reads a joint. A `<mimic>` of a joint that the file does not have is left out and returned: most programs read such a
/// file.
fn read_joint<'a, 'input>(
    name: &str,
    element: Node<'a, 'input>,
    location: Location,
    links: &ByName,
    joints: &ByName,
    ignored: &mut IgnoredCount<'input>,
) -> Result<(UrdfJoint, xml::Child<'a, 'input>)> {
    let [parent, child, origin, axis, mimic] = xml::named(element, ["parent", "child", "origin", "axis", "mimic"]);
    let kind = joint_kind(element)?;
    let parent = links.find(xml::required_child(element, parent, "parent")?, "link")?;
    let child = links.find(xml::required_child(element, child, "child")?, "link")?;
    let origin = values::origin(origin?)?;
    let axis = values::axis(axis?, kind)?;
    let mimic = mimic?;
    let is_unknown = |name: &str| !name.is_empty() && !joints.by_name.contains_key(name);
    let is_unread = |mimic: &Node| mimic.attribute("joint").is_some_and(is_unknown);
    let unread = mimic.filter(is_unread);
    let of_joint = |mimic: Node| values::mimic(mimic, if is_unread(&mimic) { 0 } else { joints.find(mimic, "joint")? });
    let mimic = mimic.map(of_joint).transpose()?.filter(|_| unread.is_none());
    let mut limit = None;
    for child in element.children().filter(Node::is_element) {
        match tag(element, child) {
            Some("origin" | "parent" | "child" | "axis" | "mimic") => continue,
            Some("limit") => limit = limit.or(Some(child)),
            _ => {}
        }
        ignored.count("joint", child)?;
    }
    let (has_axis, axis) = (axis.is_some(), axis.unwrap_or_default().xyz.0);
    let limits = limit.and_then(limits);
    let limits =
        limits.filter(|[lower, upper]| lower < upper && matches!(kind, JointKind::Revolute | JointKind::Prismatic));
    let name = name.into();
    Ok((UrdfJoint { name, kind, parent, child, origin, axis, has_axis, mimic, limits, location }, unread))
}

fn joint_kind(element: Node<'_, '_>) -> Result<JointKind> {
    let word = xml::required_attribute(element, "type")?;
    let known = |kind: &JointKind| kind.name() == word || (*kind, word) == (JointKind::Spherical, DRAKES_SPHERICAL);
    JointKind::ALL.into_iter().find(known).ok_or_else(|| {
        let words = JointKind::ALL.map(JointKind::name).into_iter().chain([DRAKES_SPHERICAL]);
        xml::refuse(element, Reason::Unsupported(format!("unknown joint type \"{word}\""))).did_you_mean(word, words)
    })
}
