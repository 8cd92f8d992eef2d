//! Values of an element, with every number checked, in the types and with the defaults of urdf-rs.

use super::elements::is_misplaced;
use super::{Collision, Geometry, Inertial, JointKind, Mesh, Mimic, Pose, xml};
use crate::error::{Reason, Result};
use roxmltree::Node;
use urdf_rs::Vec3;

/// Smallest allowed value of an attribute: any number, or zero.
const ANY: f64 = f64::NEG_INFINITY;
const NOT_NEGATIVE: f64 = 0.0;

impl From<urdf_rs::Pose> for Pose {
    fn from(urdf_rs::Pose { xyz, rpy }: urdf_rs::Pose) -> Self {
        Self { xyz: xyz.0, rpy: rpy.0 }
    }
}

/// Reads an `<origin>`; a missing one is the identity.
pub(super) fn origin(origin: Option<Node<'_, '_>>) -> Result<Pose> {
    let Some(origin) = origin else { return Ok(urdf_rs::Pose::default().into()) };
    if origin.has_attribute("quat_xyzw") {
        let reason = "quat_xyzw of <origin> is not handled".into();
        return Err(xml::refuse(origin, Reason::Unsupported(reason)).hint("give the rotation as rpy"));
    }
    let vector = |name| optional(origin, name, ANY).map(|xyz| xyz.map(Vec3).unwrap_or_default());
    Ok(urdf_rs::Pose { xyz: vector("xyz")?, rpy: vector("rpy")? }.into())
}

/// Reads an `<inertial>`.
pub(super) fn inertial(element: Node<'_, '_>) -> Result<Inertial> {
    let [frame, mass, moments] = xml::named(element, ["origin", "mass", "inertia"]);
    let origin = origin(frame?)?;
    let [mass] = required(xml::required_child(element, mass, "mass")?, "value", NOT_NEGATIVE)?;
    let inertia = moments?.map(inertia).transpose()?;
    let matrix =
        |urdf_rs::Inertia { ixx, ixy, ixz, iyy, iyz, izz }| [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]];
    Ok(Inertial { origin, mass, inertia: inertia.map(matrix) })
}

/// Reads an `<inertia>`. Missing products of inertia are zero.
fn inertia(element: Node<'_, '_>) -> Result<urdf_rs::Inertia> {
    let moment = |name| required(element, name, ANY).map(|[moment]| moment);
    let product = |name| optional(element, name, ANY).map(|product| product.map_or(0.0, |[product]| product));
    let (ixx, iyy, izz) = (moment("ixx")?, moment("iyy")?, moment("izz")?);
    Ok(urdf_rs::Inertia { ixx, iyy, izz, ixy: product("ixy")?, ixz: product("ixz")?, iyz: product("iyz")? })
}

pub(super) fn collision(element: Node<'_, '_>) -> Result<Collision> {
    let [frame, shape] = xml::named(element, ["origin", "geometry"]);
    Ok(Collision { origin: origin(frame?)?, geometry: geometry(xml::required_child(element, shape, "geometry")?)? })
}

fn geometry(geometry: Node<'_, '_>) -> Result<Geometry> {
    // Elements of other programs, such as <drake:declare_convex>, or misplaced ones may accompany a shape of URDF.
    let mut shapes = xml::children(geometry).filter(|shape| !is_misplaced("geometry", shape.tag_name().name()));
    let foreign = || geometry.children().find(Node::is_element);
    let missing = || xml::refuse(geometry, Reason::Missing("a shape in <geometry>".into()));
    let shape = shapes.next().or_else(foreign).ok_or_else(missing)?;
    if let Some(second) = shapes.next() {
        let reason = format!("<{}> is a second shape in one <geometry>", second.tag_name().name());
        return Err(xml::refuse(second, Reason::Inconsistent(reason)).hint("give each shape a <collision> of its own"));
    }
    let size = |name| required(shape, name, NOT_NEGATIVE).map(|[size]| size);
    Ok(match shape.tag_name().name() {
        "box" => Geometry::Box { size: required(shape, "size", NOT_NEGATIVE)? },
        "cylinder" => Geometry::Cylinder { radius: size("radius")?, length: size("length")? },
        "capsule" => Geometry::Capsule { radius: size("radius")?, length: size("length")? },
        "sphere" => Geometry::Sphere { radius: size("radius")? },
        "mesh" => {
            let scale = optional(shape, "scale", ANY)?.unwrap_or([1.0; 3]);
            if scale == [0.0; 3] {
                let reason = "scale of <mesh> is zero, so the mesh is a point".into();
                return Err(xml::refuse(shape, Reason::Inconsistent(reason)).hint("without a scale it is 1 1 1"));
            }
            let file = xml::required_attribute(shape, "filename")?.into();
            Geometry::Mesh { file, scale, mesh: Mesh::Unread }
        }
        tag => Geometry::Unknown { tag: tag.into() },
    })
}

/// Reads the `<axis>` of a joint, if it gives a direction. Zero is an error if joints of this `kind` have an axis.
pub(super) fn axis(axis: Option<Node<'_, '_>>, kind: JointKind) -> Result<Option<urdf_rs::Axis>> {
    let Some(axis) = axis else { return Ok(None) };
    let Some(xyz) = optional(axis, "xyz", ANY)? else { return Ok(None) };
    if kind.has_axis() && xyz == [0.0; 3] {
        let reason = "xyz of <axis> is zero, so the joint has no direction".into();
        let hint = "give a direction, as in xyz=\"0 1 0\"; a joint that does not move is of type fixed";
        return Err(xml::refuse(axis, Reason::Inconsistent(reason)).hint(hint));
    }
    Ok(Some(urdf_rs::Axis { xyz: Vec3(xyz) }))
}

/// Reads a `<mimic>` of the joint with the index `joint`.
pub(super) fn mimic(element: Node<'_, '_>, joint: usize) -> Result<Mimic> {
    let value = |name, default| optional(element, name, ANY).map(|value| value.map_or(default, |[value]| value));
    Ok(Mimic { joint, multiplier: value("multiplier", 1.0)?, offset: value("offset", 0.0)? })
}

/// Reads the numbers of a required attribute; see [`numbers`].
#[inline(always)]
fn required<const N: usize>(element: Node<'_, '_>, name: &str, least: f64) -> Result<[f64; N]> {
    numbers(element, name, xml::required_attribute(element, name)?, least)
}

/// Reads the numbers of an optional attribute; see [`numbers`].
#[inline(always)]
fn optional<const N: usize>(element: Node<'_, '_>, name: &str, least: f64) -> Result<Option<[f64; N]>> {
    element.attribute(name).map(|text| numbers(element, name, text, least)).transpose()
}

/// Parses the `text` of an attribute as exactly `N` finite numbers of at least `least`.
fn numbers<const N: usize>(element: Node<'_, '_>, name: &str, text: &str, least: f64) -> Result<[f64; N]> {
    let what = || format!("{name} of <{}>", element.tag_name().name());
    // White space beyond ASCII is rare and slower to find.
    let numbers = parsed(text.split_ascii_whitespace()).or_else(|| parsed(text.split_whitespace()));
    let numbers: [f64; N] = numbers.ok_or_else(|| {
        let expected = if N == 1 { "a number".into() } else { format!("{N} numbers") };
        let reason = format!("{} must be {expected}, not \"{text}\"", what());
        let error = xml::refuse(element, Reason::Syntax(reason));
        let first = text.split_whitespace().take(N).collect::<Vec<_>>().join(" ");
        let remedies = [
            ("separate numbers by spaces", text.replace(", ", " ").replace(',', " ")),
            ("write decimal points", text.replace(',', ".")),
            ("leave out the rest", first),
        ];
        let is_one = |meant: &str| meant.len() < 100 && parsed::<N>(meant.split_whitespace()).is_some();
        let remedy = remedies.into_iter().find(|(_, meant)| is_one(meant));
        remedy.into_iter().fold(error, |error, (what, meant)| error.hint(format!("{what}: \"{}\"", meant.trim())))
    })?;
    match numbers.iter().find(|number| !number.is_finite() || **number < least) {
        None => Ok(numbers),
        Some(&value) if value.is_finite() => {
            Err(xml::refuse(element, Reason::OutOfRange { what: what(), allowed: "at least 0", value }))
        }
        Some(&value) => Err(xml::refuse(element, Reason::NotFinite { what: what(), value })),
    }
}

/// Parses exactly `N` words as numbers; `None` if there are fewer, more, or non-numbers.
fn parsed<'t, const N: usize>(mut words: impl Iterator<Item = &'t str>) -> Option<[f64; N]> {
    let mut numbers = [0.0; N];
    for number in &mut numbers {
        *number = match words.next()? {
            // Most numbers.
            "0" => 0.0,
            "1" => 1.0,
            word => word.parse().ok()?,
        };
    }
    words.next().is_none().then_some(numbers)
}
