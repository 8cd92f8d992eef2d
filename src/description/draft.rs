//! XML elements -> names, places, references, and a strict copy of all values for urdf-rs.
//!
//! The strict copy is URDF text that holds numbers, joint types and shapes alone: each checked, each element where
//! urdf-rs wants it, and no names, which need no reading. What urdf-rs would misread cannot reach it: it drops words
//! from a vector that are no numbers, and wants a `velocity` in every `<limit>`.

use super::elements::{ByName, EXPAND, IgnoredCount, WORLD, undefined_world};
use super::repair::Repaired;
use super::strict::{Range, copy, copy_axis, copy_origin, copy_required, write_attribute};
use super::xml::{self, Cursor, MOST_LINKS, Unparsed};
use super::{Ignored, JointKind, joint_place, link_place};
use crate::error::{Location, Reason, Result};
use roxmltree::{Document, Node};

/// The most joints that move: a chain of n of them takes n^3 / 3 steps to factorize.
const MOST_MOVING: usize = 2000;
/// The links or joints in one part of the strict copy; parts bound the memory that urdf-rs needs.
const PART: usize = 1000;
/// How a part of the strict copy begins.
const OPENING: &str = "<robot name=\"\">";
/// How a part of the strict copy ends.
const CLOSING: &str = "</robot>";

/// All that is known of a file before its values are read.
pub(super) struct Draft {
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    pub(super) ignored: Vec<Ignored>,
    /// The strict copy, in parts that are URDF texts of their own: first all of `links`, then all of `joints`, in
    /// order.
    pub(super) strict: Vec<String>,
}

/// A link without its values.
pub(super) struct Link {
    pub(super) name: String,
    pub(super) location: Location,
    pub(super) inertial: Stated,
    pub(super) shapes: Vec<Shape>,
}

/// How much of an inertia the file states.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stated {
    /// No `<inertial>`.
    Nothing,
    /// `<inertial>` without `<inertia>`.
    Mass,
    /// Both.
    Everything,
}

/// What urdf-rs is not asked about a shape.
pub(super) enum Shape {
    /// A shape whose sizes are all there is to know.
    Simple,
    /// A mesh and its file.
    Mesh(String),
    /// A shape of this tag, which URDF does not have; a mesh stands in its place in the strict copy.
    Unknown(String),
}

/// A joint without its values.
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) location: Location,
    pub(super) kind: JointKind,
    pub(super) parent: usize,
    pub(super) child: usize,
    pub(super) mimic: Option<usize>,
}

/// Reads and checks `text`; see [`super::Description::from_urdf`] for what is refused.
pub(super) fn read(text: &str) -> Result<Draft> {
    let mut repaired = Repaired::new(text);
    loop {
        match xml::parse(&repaired.text) {
            Ok(document) => {
                let draft = read_document(&document).map_err(|error| repaired.refusal(error));
                return draft.map(|draft| draft.moved(|place| repaired.in_file(place)));
            }
            Err(Unparsed::Prefix(prefix, refused)) => {
                let refused = repaired.refusal(refused);
                repaired = repaired.declaring(&prefix).ok_or(refused)?;
            }
            Err(Unparsed::Refused(refused)) => return Err(repaired.refusal(refused)),
        }
    }
}

fn read_document(document: &Document<'_>) -> Result<Draft> {
    let text = document.input_text();
    let robot = document.root_element();
    require_urdf(robot)?;
    refuse_xacro(robot)?;

    let mut cursor = Cursor::new(text);
    let (mut links, mut joints) = (ByName::new("link"), ByName::new("joint"));
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

    let mut strict = Vec::new();
    let mut shapes = 0;
    let mut draft_links = Vec::with_capacity(links.elements.len());
    for part in links.elements.chunks(PART) {
        let mut copy = String::from(OPENING);
        for &(name, element, location) in part {
            let link = read_link(name, element, location, &mut ignored, &mut copy);
            let link = link.map_err(|error| error.at(link_place(name)))?;
            shapes += link.shapes.len();
            if shapes > MOST_LINKS {
                let refused = xml::refuse(element, Reason::TooMany { what: "collision shapes", limit: MOST_LINKS });
                return Err(refused.at(link_place(name)));
            }
            draft_links.push(link);
        }
        copy.push_str(CLOSING);
        strict.push(copy);
    }
    if let Some(location) = world {
        draft_links.push(Link { name: WORLD.into(), location, inertial: Stated::Nothing, shapes: Vec::new() });
        strict.push(format!("{OPENING}<link name=\"\"/>{CLOSING}"));
    }
    let mut draft_joints = Vec::with_capacity(joints.elements.len());
    for part in joints.elements.chunks(PART) {
        let mut copy = String::from(OPENING);
        for &(name, element, location) in part {
            let joint = JointElement { name, element, location };
            let joint = joint.read(&links, &joints, &mut ignored, &mut copy);
            draft_joints.push(joint.map_err(|error| error.at(joint_place(name)))?);
        }
        copy.push_str(CLOSING);
        strict.push(copy);
    }

    let name = robot.attribute("name").unwrap_or_default().to_owned();
    Ok(Draft { name, links: draft_links, joints: draft_joints, ignored: ignored.kinds, strict })
}

/// Before the costly part: a tree has fewer joints than links, but this is no tree yet.
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
    if tag == "robot" {
        return Ok(());
    }
    let error = xml::refuse(root, Reason::Missing("<robot>".into())).at(format!("<{tag}>"));
    Err(match tag {
        "sdf" => error.hint("this is an SDF file; convert it to URDF"),
        "mujoco" => error.hint("this is a MuJoCo model; convert it to URDF"),
        _ => error.hint("the outermost element of a URDF file is <robot>"),
    })
}

/// Refuses macros that are still to be expanded, by their namespace or as they were written before there was one; a
/// file that only declares the namespace is plain URDF.
fn refuse_xacro(robot: Node<'_, '_>) -> Result<()> {
    let is_macro = |element: &Node| element.tag_name().namespace().is_some_and(|namespace| namespace.contains("xacro"));
    let refused = |element: Node, what: String| {
        xml::refuse(element, Reason::Unsupported(format!("{what} is not URDF"))).hint(EXPAND)
    };
    if let Some(element) = robot.descendants().find(|node| node.is_element() && is_macro(node)) {
        return Err(refused(element, format!("<xacro:{}>", element.tag_name().name())));
    }
    for element in robot.children().filter(Node::is_element) {
        let place: fn(&str) -> String = match tag(robot, element) {
            Some(old @ ("include" | "property" | "macro")) => {
                return Err(refused(element, format!("<{old}> of xacro")));
            }
            Some("link") => link_place,
            Some("joint") => joint_place,
            // What other programs read may hold anything.
            _ => continue,
        };
        for inside in element.descendants().filter(|node| node.is_element() && node.tag_name().name() != "gazebo") {
            let mut values = inside.attributes().map(|attribute| attribute.value());
            if let Some(value) = values.find(|value| value.contains("${") || value.contains("$(")) {
                let name = element.attribute("name").unwrap_or_default();
                return Err(refused(inside, format!("\"{value}\"")).at(place(name)));
            }
        }
    }
    Ok(())
}

/// The tag of a child of `robot`, if it is of the same namespace.
fn tag<'a>(robot: Node<'_, '_>, element: Node<'a, '_>) -> Option<&'a str> {
    (element.tag_name().namespace() == robot.tag_name().namespace()).then(|| element.tag_name().name())
}

impl Draft {
    /// The draft with all places changed.
    fn moved(mut self, place: impl Fn(Location) -> Location) -> Self {
        for link in &mut self.links {
            link.location = place(link.location);
        }
        for joint in &mut self.joints {
            joint.location = place(joint.location);
        }
        self
    }
}

fn read_link(
    name: &str,
    element: Node<'_, '_>,
    location: Location,
    ignored: &mut IgnoredCount,
    strict: &mut String,
) -> Result<Link> {
    strict.push_str("<link name=\"\">");
    let inertial = match xml::child(element, "inertial")? {
        // An empty one says no more than none.
        Some(inertial) if inertial.children().any(|child| child.is_element()) => read_inertial(inertial, strict)?,
        _ => Stated::Nothing,
    };
    let mut shapes = Vec::new();
    for child in element.children().filter(Node::is_element) {
        match tag(element, child) {
            Some("collision") => shapes.push(read_collision(child, strict)?),
            Some("inertial" | "visual") => {}
            _ => ignored.count("link", child)?,
        }
    }
    strict.push_str("</link>");
    Ok(Link { name: name.into(), location, inertial, shapes })
}

fn read_inertial(element: Node<'_, '_>, strict: &mut String) -> Result<Stated> {
    strict.push_str("<inertial>");
    copy_origin(element, strict)?;
    let mass = xml::required_child(element, "mass")?;
    strict.push_str("<mass");
    copy_required(mass, "value", 1, Range::NotNegative, strict)?;
    strict.push_str("/><inertia");
    let inertia = xml::child(element, "inertia")?;
    for moment in ["ixx", "iyy", "izz"] {
        match inertia {
            Some(inertia) => copy_required(inertia, moment, 1, Range::Any, strict)?,
            None => write_attribute(moment, "0", strict),
        }
    }
    for product in ["ixy", "ixz", "iyz"] {
        // A file that leaves out the products of inertia means that there are none.
        let given = inertia.map_or(Ok(false), |inertia| copy(inertia, product, 1, Range::Any, strict))?;
        if !given {
            write_attribute(product, "0", strict);
        }
    }
    strict.push_str("/></inertial>");
    Ok(if inertia.is_some() { Stated::Everything } else { Stated::Mass })
}

fn read_collision(element: Node<'_, '_>, strict: &mut String) -> Result<Shape> {
    strict.push_str("<collision>");
    copy_origin(element, strict)?;
    let geometry = xml::required_child(element, "geometry")?;
    let mut shapes = geometry.children().filter(Node::is_element);
    let shape = shapes.next().ok_or_else(|| xml::refuse(geometry, Reason::Missing("a shape in <geometry>".into())))?;
    if let Some(second) = shapes.next() {
        let reason = format!("<{}> is a second shape in one <geometry>", second.tag_name().name());
        return Err(xml::refuse(second, Reason::Inconsistent(reason)).hint("give each shape a <collision> of its own"));
    }

    strict.push_str("<geometry><");
    let (tag, sizes): (&str, &[(&str, usize)]) = match shape.tag_name().name() {
        "box" => ("box", &[("size", 3)]),
        "sphere" => ("sphere", &[("radius", 1)]),
        "cylinder" => ("cylinder", &[("radius", 1), ("length", 1)]),
        "capsule" => ("capsule", &[("radius", 1), ("length", 1)]),
        _ => ("mesh", &[]),
    };
    strict.push_str(tag);
    for &(size, count) in sizes {
        copy_required(shape, size, count, Range::NotNegative, strict)?;
    }
    let shape = match shape.tag_name().name() {
        "mesh" => {
            copy(shape, "scale", 3, Range::Any, strict)?;
            Shape::Mesh(xml::required_attribute(shape, "filename")?.into())
        }
        unknown if tag == "mesh" => Shape::Unknown(unknown.into()),
        _ => Shape::Simple,
    };
    if tag == "mesh" {
        write_attribute("filename", "-", strict);
    }
    strict.push_str("/></geometry></collision>");
    Ok(shape)
}

/// A joint's element, about to be read.
struct JointElement<'a, 'input> {
    name: &'a str,
    element: Node<'a, 'input>,
    location: Location,
}

impl JointElement<'_, '_> {
    fn read(self, links: &ByName, joints: &ByName, ignored: &mut IgnoredCount, strict: &mut String) -> Result<Joint> {
        let Self { name, element, location } = self;
        let kind = joint_kind(element)?;
        let parent = links.find(xml::required_child(element, "parent")?, "link")?;
        let child = links.find(xml::required_child(element, "child")?, "link")?;

        strict.push_str(&format!("<joint name=\"\" type=\"{}\">", kind.name()));
        copy_origin(element, strict)?;
        strict.push_str("<parent link=\"\"/><child link=\"\"/>");
        if let Some(axis) = xml::child(element, "axis")? {
            copy_axis(axis, kind, strict)?;
        }
        let mut mimic = None;
        if let Some(own) = xml::child(element, "mimic")? {
            let mimicked = joints.find(own, "joint")?;
            strict.push_str("<mimic joint=\"\"");
            copy(own, "multiplier", 1, Range::Any, strict)?;
            copy(own, "offset", 1, Range::Any, strict)?;
            strict.push_str("/>");
            mimic = Some(mimicked);
        }
        strict.push_str("</joint>");

        for child in element.children().filter(Node::is_element) {
            match tag(element, child) {
                Some("origin" | "parent" | "child" | "axis" | "mimic") => {}
                _ => ignored.count("joint", child)?,
            }
        }
        Ok(Joint { name: name.into(), location, kind, parent, child, mimic })
    }
}

/// The joint's type.
fn joint_kind(element: Node<'_, '_>) -> Result<JointKind> {
    // Drake calls a spherical joint a ball.
    const KINDS: [(&str, JointKind); 8] = [
        ("fixed", JointKind::Fixed),
        ("revolute", JointKind::Revolute),
        ("continuous", JointKind::Continuous),
        ("prismatic", JointKind::Prismatic),
        ("planar", JointKind::Planar),
        ("floating", JointKind::Floating),
        ("spherical", JointKind::Spherical),
        ("ball", JointKind::Spherical),
    ];
    let word = xml::required_attribute(element, "type")?;
    match KINDS.iter().find(|(known, _)| *known == word) {
        Some(&(_, kind)) => Ok(kind),
        None => Err(xml::refuse(element, Reason::Unsupported(format!("unknown joint type \"{word}\"")))
            .did_you_mean(word, KINDS.map(|(known, _)| known))),
    }
}
