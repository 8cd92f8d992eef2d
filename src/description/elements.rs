//! Elements of a file by name, and counts of the elements that are not read.

use super::{Ignored, xml};
use crate::error::{Error, Location, Reason, Result};
use roxmltree::Node;
use std::collections::HashMap;

/// The link that joints may name as their parent although it is not defined.
pub(super) const WORLD: &str = "world";
/// The hint for a file with macros.
pub(super) const EXPAND: &str = "expand the file first: xacro FILE > robot.urdf";

/// Elements of one kind by name.
pub(super) struct ByName<'a, 'input> {
    what: &'static str,
    pub(super) elements: Vec<(&'a str, Node<'a, 'input>, Location)>,
    pub(super) by_name: HashMap<&'a str, usize>,
}

impl<'a, 'input> ByName<'a, 'input> {
    pub(super) fn new(what: &'static str, expected: usize) -> Self {
        Self { what, elements: Vec::with_capacity(expected), by_name: HashMap::with_capacity(expected) }
    }

    pub(super) fn push(&mut self, element: Node<'a, 'input>, location: Location) -> Result<()> {
        let name = xml::required_attribute(element, "name")?;
        if self.by_name.insert(name, self.elements.len()).is_some() {
            return Err(xml::refuse(element, Reason::Duplicate { what: self.what, name: name.into() }));
        }
        self.elements.push((name, element, location));
        Ok(())
    }

    /// Returns the index of the element that `attribute` of `element` names.
    pub(super) fn find(&self, element: Node<'_, '_>, attribute: &str) -> Result<usize> {
        let name = xml::required_attribute(element, attribute)?;
        self.by_name.get(name).copied().ok_or_else(|| {
            let error = self.unknown(element, name);
            let known = || self.elements.iter().map(|(name, ..)| *name).filter(|known| known.len() <= 100);
            // A part copied from another file may lack a prefix.
            let is_longer = |known: &&str| known.strip_suffix(name).is_some_and(|prefix| prefix.ends_with(['_', '/']));
            let longer: Vec<&str> = known().filter(is_longer).take(3).collect();
            match longer[..] {
                [] => error.did_you_mean(name, known()),
                _ => error.hint(format!("did you mean {}?", longer.join(" or "))),
            }
        })
    }

    /// Returns the error for a `name` in `element` that no element has, without a similar name.
    pub(super) fn unknown(&self, element: Node<'_, '_>, name: &str) -> Error {
        xml::refuse(element, Reason::UnknownName { what: self.what, name: name.into() })
    }
}

/// Returns the location of a joint with the parent link `world` if no element defines that link, as in many files.
pub(super) fn undefined_world(links: &ByName, joints: &ByName) -> Option<Location> {
    if links.by_name.contains_key(WORLD) {
        return None;
    }
    let is_world = |child: Node| child.tag_name().name() == "parent" && child.attribute("link") == Some(WORLD);
    let is_its_child = |element: Node| xml::children(element).any(is_world);
    joints.elements.iter().find(|(_, element, _)| is_its_child(*element)).map(|&(_, _, location)| location)
}

/// Largest number of kinds of ignored elements.
const MOST_IGNORED: usize = 1000;

/// Counts of ignored elements.
#[derive(Default)]
pub(super) struct IgnoredCount<'input> {
    pub(super) kinds: Vec<Ignored>,
    by_tag: HashMap<(&'static str, &'input str), usize>,
}

impl<'input> IgnoredCount<'input> {
    pub(super) fn count(&mut self, parent: &'static str, element: Node<'_, 'input>) -> Result<()> {
        let tag = element.tag_name().name();
        let kind = *self.by_tag.entry((parent, tag)).or_insert(self.kinds.len());
        if kind == MOST_IGNORED {
            let reason = Reason::TooMany { what: "kinds of unknown elements", limit: MOST_IGNORED };
            return Err(xml::refuse(element, reason));
        }
        match self.kinds.get_mut(kind) {
            Some(known) => known.count += 1,
            None => self.kinds.push(Ignored { parent, tag: tag.into(), count: 1 }),
        }
        Ok(())
    }
}

/// The tags of all elements that are read.
const READ: [&str; 19] = [
    "robot",
    "link",
    "joint",
    "inertial",
    "collision",
    "geometry",
    "origin",
    "parent",
    "child",
    "axis",
    "mimic",
    "limit",
    "mass",
    "inertia",
    "box",
    "cylinder",
    "capsule",
    "sphere",
    "mesh",
];

/// Frequent names of URDF that are not read, and not like any name that is.
const UNREAD: [&str; 3] = ["effort", "velocity", "dynamics"];

/// Returns the attributes and the child elements that are read of elements with this tag; `None` if none are read.
fn read(tag: &str) -> Option<(&'static [&'static str], &'static [&'static str])> {
    Some(match tag {
        "robot" => (&["name"], &["link", "joint"]),
        "link" => (&["name"], &["inertial", "collision", "visual"]),
        "joint" => (&["name", "type"], &["origin", "parent", "child", "axis", "mimic", "limit"]),
        "inertial" => (&[], &["origin", "mass", "inertia"]),
        "collision" => (&[], &["origin", "geometry"]),
        "geometry" => (&[], &["box", "cylinder", "capsule", "sphere", "mesh"]),
        "origin" => (&["xyz", "rpy"], &[]),
        "parent" | "child" => (&["link"], &[]),
        "axis" => (&["xyz"], &[]),
        "mimic" => (&["joint", "multiplier", "offset"], &[]),
        "limit" => (&["lower", "upper"], &[]),
        "mass" => (&["value"], &[]),
        "inertia" => (&["ixx", "ixy", "ixz", "iyy", "iyz", "izz"], &[]),
        "box" => (&["size"], &[]),
        "cylinder" | "capsule" => (&["radius", "length"], &[]),
        "sphere" => (&["radius"], &[]),
        "mesh" => (&["filename", "scale"], &[]),
        _ => return None,
    })
}

/// Returns whether elements with this tag are read, but not inside elements with the tag `parent`.
pub(super) fn is_misplaced(parent: &str, tag: &str) -> bool {
    read(tag).is_some() && read(parent).is_some_and(|(_, children)| !children.contains(&tag))
}

/// Returns the lower and the upper end of a `<limit>`; a missing end is 0. Limits are not part of the mechanics, so
/// there is no error if an end is not a number: the result is then `None`.
pub(super) fn limits(limit: Node<'_, '_>) -> Option<[f64; 2]> {
    let end = |name| limit.attribute(name).map_or(Some(0.0), |text| text.trim().parse().ok());
    let limits: [f64; 2] = [end("lower")?, end("upper")?];
    (!limits.iter().any(|end| end.is_nan())).then_some(limits)
}

/// Returns the joints whose transmissions have a rotor inertia in Drake's format.
pub(super) fn rotors(robot: Node<'_, '_>) -> Vec<String> {
    let tagged = |tag: &'static str| move |node: &Node<'_, '_>| node.tag_name().name() == tag;
    let has_rotor = |transmission: &Node<'_, '_>| {
        let value = |rotor: Node<'_, '_>| rotor.attribute("value")?.trim().parse::<f64>().ok();
        transmission
            .descendants()
            .filter(tagged("rotor_inertia"))
            .filter_map(value)
            .any(|inertia| inertia.is_finite() && inertia > 0.0)
    };
    let transmissions = xml::children(robot).filter(tagged("transmission")).filter(has_rotor);
    let joints = transmissions.flat_map(|transmission| xml::children(transmission).filter(tagged("joint")));
    joints.filter_map(|joint| joint.attribute("name").map(str::to_owned)).collect()
}

/// Largest number of misspelt names that are kept.
pub(super) const MOST_MISSPELT: usize = 100;

/// Returns attributes and elements of a robot that are not read and may be misspelt: they differ by one letter from a
/// name that is read and missing, or stand in the wrong element. Impossible limits are included.
pub(super) fn misspelt(robot: Node<'_, '_>) -> Vec<String> {
    let (mut found, mut unread_to) = (Vec::new(), 0);
    for element in robot.descendants().filter(Node::is_element) {
        let (tag, range) = (element.tag_name().name(), element.range());
        if range.start < unread_to || found.len() == MOST_MISSPELT {
            continue;
        }
        let line = |node: Node| node.document().text_pos_at(node.range().start).row;
        if tag == "visual" {
            // Nothing in <visual> is read, but these elements would be read in <link>.
            let named = xml::children(element).map(|child| (child, child.tag_name().name()));
            let of_link = named.filter(|(_, name)| matches!(*name, "inertial" | "collision"));
            let odd = of_link.map(|(child, name)| format!("<{name}> in <visual> on line {} (in <link>?)", line(child)));
            found.extend(odd.take(MOST_MISSPELT - found.len()));
        }
        let Some((attributes, children)) = read(tag) else {
            unread_to = range.end;
            continue;
        };
        let elements = || element.children().filter(Node::is_element).map(|child| (child, child.tag_name().name()));
        let tags = || elements().map(|(_, name)| name);
        let given = || element.attributes().filter(|given| given.namespace().is_none()).map(|given| given.name());
        // The element has numbers between its tags, but they belong in an attribute.
        let text = element.text().filter(|text| children.is_empty() && !text.trim().is_empty());
        let text = text.map(|_| format!("text in <{tag}> on line {} ({}?)", line(element), attributes.join(" or ")));
        let is_no_limit = tag == "limit" && limits(element).is_none_or(|[lower, upper]| lower > upper);
        let limit = is_no_limit.then(|| {
            let [lower, upper] = ["lower", "upper"].map(|end| element.attribute(end).unwrap_or("0"));
            format!("<limit> on line {} (no limit from {lower} to {upper})", line(element))
        });
        // In most elements nothing is misspelt, and no names need to be compared.
        let is_known = |name: &str, read: &[&str]| read.contains(&name) || UNREAD.contains(&name);
        if given().all(|name| is_known(name, attributes)) && tags().all(|tag| is_known(tag, children)) {
            found.extend(text.into_iter().chain(limit).take(MOST_MISSPELT - found.len()));
            continue;
        }
        let meant = meant(given(), attributes);
        let misread = given().filter_map(|name| {
            meant(name).map(|meant| format!("{name} of <{tag}> on line {} ({meant}?)", line(element)))
        });
        // Exporters write <axis> like <origin>, with an rpy.
        let misplaced = given().filter(|&name| !attributes.contains(&name) && (tag, name) != ("axis", "rpy"));
        let misplaced = misplaced.filter_map(|name| {
            owner(name, children).map(|owner| format!("{name} of <{tag}> on line {} (<{owner}>?)", line(element)))
        });
        let meant = self::meant(tags(), children);
        let misnamed = elements().filter_map(|(child, name)| {
            meant(name).map(|meant| format!("<{name}> in <{tag}> on line {} (<{meant}>?)", line(child)))
        });
        let around = element.parent().map_or("", |parent| parent.tag_name().name());
        let takes = |name: &str, of: &str| read(of).is_some_and(|(_, children)| children.contains(&name));
        let unread = elements().filter(|(_, name)| !children.contains(name) && meant(name).is_none());
        let of_others =
            unread.filter(|(_, name)| *name == "visual" || read(name).is_some()).filter_map(|(child, name)| {
                let mut others = children.iter().copied().chain([around]).chain(READ);
                let owner = others.find(|other| takes(name, other))?;
                Some(format!("<{name}> in <{tag}> on line {} (in <{owner}>?)", line(child)))
            });
        let odd = text.into_iter().chain(misread).chain(misplaced).chain(misnamed).chain(of_others).chain(limit);
        found.extend(odd.take(MOST_MISSPELT - found.len()));
    }
    found
}

/// Returns the element that an attribute with this name belongs to, or the child element with this name.
fn owner(name: &str, children: &[&'static str]) -> Option<&'static str> {
    if matches!(name, "name" | "type" | "joint") {
        return None;
    }
    let gives = |tag: &&str| read(tag).is_some_and(|(attributes, _)| attributes.contains(&name));
    let is_own = |tag: &&str| *tag == name;
    let child = children.iter().copied().find(is_own);
    child.or_else(|| READ.into_iter().find(gives)).or_else(|| READ.into_iter().find(is_own))
}

/// Returns a function that finds the name in `known`, but not `given`, which another name may stand for.
fn meant<'a>(
    given: impl Iterator<Item = &'a str>,
    known: &'static [&'static str],
) -> impl Fn(&str) -> Option<&'static str> {
    let is_near = |name: &str, known: &str| {
        let [own, other] = [name, known].map(str::as_bytes);
        // Names in MJCF, SDF and other formats.
        let others = match known {
            "xyz" => "pos position translation",
            "rpy" => "euler rotation quat quaternion rpydeg rpy_deg ypr orientation rot angle",
            "origin" => "pose com frame",
            "multiplier" => "ratio gearing scale gain",
            "lower" => "min low",
            "upper" => "max high",
            _ => "",
        };
        others.split_whitespace().any(|other| other == name)
            || name.eq_ignore_ascii_case(known)
            // Known names have at least three letters, so one slip keeps the first or the last letter.
            || name.len().abs_diff(known.len()) <= 1
                && (own.first() == other.first() || own.last() == other.last())
                && strsim::osa_distance(name, known) == 1
    };
    let mut absent = known.to_vec();
    for name in given {
        absent.retain(|other| *other != name);
    }
    move |name| absent.iter().copied().find(|meant| !known.contains(&name) && is_near(name, meant))
}
