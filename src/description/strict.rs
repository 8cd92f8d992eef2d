//! The strict copy of one link or joint, from which urdf-rs reads the values: numbers, joint types and shapes alone,
//! each checked and where urdf-rs wants it, and no names.

use super::{Geometry, JointKind, Mesh, Pose, xml};
use crate::error::{Error, Reason, Result};
use roxmltree::Node;

/// The least number that an attribute may hold: any, or none that is negative.
pub(super) const ANY: f64 = f64::NEG_INFINITY;
pub(super) const NOT_NEGATIVE: f64 = 0.0;

/// What `part` takes from the robot that urdf-rs reads in `strict`.
pub(super) fn values<T>(strict: &str, part: fn(urdf_rs::Robot) -> Option<T>) -> Result<T> {
    let unread = |why: &str| Error::new(Reason::Syntax(format!("urdf-rs could not read the checked values: {why}")));
    let robot = urdf_rs::read_from_string(&format!("<robot name=\"\">{strict}</robot>"));
    part(robot.map_err(|error| unread(&error.to_string()))?).ok_or_else(|| unread("links or joints were lost"))
}

pub(super) fn pose(values: &urdf_rs::Pose) -> Pose {
    Pose { xyz: values.xyz.0, rpy: values.rpy.0 }
}

/// The shape with these values; of what URDF does not have, and of a mesh's name, the strict copy says nothing.
pub(super) fn geometry(shape: Node<'_, '_>, values: &urdf_rs::Geometry) -> Geometry {
    use urdf_rs::Geometry as Values;
    match (values, shape.tag_name().name()) {
        (Values::Box { size }, _) => Geometry::Box { size: size.0 },
        (&Values::Cylinder { radius, length }, _) => Geometry::Cylinder { radius, length },
        (&Values::Capsule { radius, length }, _) => Geometry::Capsule { radius, length },
        (&Values::Sphere { radius }, _) => Geometry::Sphere { radius },
        (Values::Mesh { scale, .. }, "mesh") => Geometry::Mesh {
            file: shape.attribute("filename").unwrap_or_default().into(),
            scale: scale.map_or([1.0; 3], |scale| scale.0),
            mesh: Mesh::Unread,
        },
        (Values::Mesh { .. }, tag) => Geometry::Unknown { tag: tag.into() },
    }
}

/// Copies an `<inertial>`; returns whether it has an `<inertia>`.
pub(super) fn copy_inertial(element: Node<'_, '_>, strict: &mut String) -> Result<bool> {
    strict.push_str("<inertial>");
    copy_origin(element, strict)?;
    let mass = xml::required_child(element, "mass")?;
    strict.push_str("<mass");
    copy_required(mass, "value", 1, NOT_NEGATIVE, strict)?;
    strict.push_str("/><inertia");
    let inertia = xml::child(element, "inertia")?;
    for (entry, required) in
        [("ixx", true), ("iyy", true), ("izz", true), ("ixy", false), ("ixz", false), ("iyz", false)]
    {
        match inertia {
            Some(inertia) if required => copy_required(inertia, entry, 1, ANY, strict)?,
            // A file that leaves out the products of inertia means that there are none.
            Some(inertia) if copy(inertia, entry, 1, ANY, strict)? => {}
            _ => write_attribute(entry, "0", strict),
        }
    }
    strict.push_str("/></inertial>");
    Ok(inertia.is_some())
}

/// Copies a `<collision>`, with a mesh in the place of a shape that URDF does not have; returns its shape.
pub(super) fn copy_collision<'a, 'input: 'a>(
    element: Node<'a, 'input>,
    strict: &mut String,
) -> Result<Node<'a, 'input>> {
    strict.push_str("<collision>");
    copy_origin(element, strict)?;
    let geometry = xml::required_child(element, "geometry")?;
    // Beside a shape of URDF elements of other programs may stand, such as <drake:declare_convex>.
    let (mut shapes, foreign) = (xml::children(geometry), || geometry.children().find(Node::is_element));
    let missing = || xml::refuse(geometry, Reason::Missing("a shape in <geometry>".into()));
    let shape = shapes.next().or_else(foreign).ok_or_else(missing)?;
    if let Some(second) = shapes.next() {
        let reason = format!("<{}> is a second shape in one <geometry>", second.tag_name().name());
        return Err(xml::refuse(second, Reason::Inconsistent(reason)).hint("give each shape a <collision> of its own"));
    }
    let tag = shape.tag_name().name();
    let sizes: &[(&str, usize)] = match tag {
        "box" => &[("size", 3)],
        "sphere" => &[("radius", 1)],
        "cylinder" | "capsule" => &[("radius", 1), ("length", 1)],
        _ => &[],
    };
    strict.push_str(&format!("<geometry><{}", if sizes.is_empty() { "mesh" } else { tag }));
    for &(size, count) in sizes {
        copy_required(shape, size, count, NOT_NEGATIVE, strict)?;
    }
    if sizes.is_empty() {
        write_attribute("filename", "-", strict);
    }
    if tag == "mesh" {
        copy(shape, "scale", 3, ANY, strict)?;
        xml::required_attribute(shape, "filename")?;
    }
    strict.push_str("/></geometry></collision>");
    Ok(shape)
}

/// Copies an `<axis>`, which must not be zero where the joint has an axis.
pub(super) fn copy_axis(axis: Node<'_, '_>, kind: JointKind, strict: &mut String) -> Result<()> {
    let Some(xyz) = axis.attribute("xyz") else {
        // <axis/> means what no <axis> means.
        return Ok(());
    };
    strict.push_str("<axis");
    copy(axis, "xyz", 3, ANY, strict)?;
    strict.push_str("/>");
    if kind.has_axis() && xyz.split_whitespace().flat_map(str::parse::<f64>).all(|component| component == 0.0) {
        let reason = "xyz of <axis> is zero, so the joint has no direction".into();
        return Err(xml::refuse(axis, Reason::Inconsistent(reason)));
    }
    Ok(())
}

/// Copies the `<origin>` of `parent`, if it has one.
pub(super) fn copy_origin(parent: Node<'_, '_>, strict: &mut String) -> Result<()> {
    let Some(origin) = xml::child(parent, "origin")? else { return Ok(()) };
    if origin.has_attribute("quat_xyzw") {
        let reason = "quat_xyzw of <origin> is not handled".into();
        return Err(xml::refuse(origin, Reason::Unsupported(reason)).hint("give the rotation as rpy"));
    }
    strict.push_str("<origin");
    copy(origin, "xyz", 3, ANY, strict)?;
    copy(origin, "rpy", 3, ANY, strict)?;
    strict.push_str("/>");
    Ok(())
}

/// As [`copy`], for an attribute that must be there.
fn copy_required(element: Node<'_, '_>, name: &str, count: usize, least: f64, strict: &mut String) -> Result<()> {
    xml::required_attribute(element, name)?;
    copy(element, name, count, least, strict).map(|_| ())
}

/// Copies an attribute that must hold `count` finite numbers from `least` on; returns whether it is present.
pub(super) fn copy(element: Node<'_, '_>, name: &str, count: usize, least: f64, strict: &mut String) -> Result<bool> {
    let Some(value) = element.attribute(name) else { return Ok(false) };
    let what = format!("{name} of <{}>", element.tag_name().name());
    let words: Vec<&str> = value.split_whitespace().collect();
    let numbers: Vec<f64> = words.iter().flat_map(|word| word.parse()).collect();
    if words.len() != count || numbers.len() != count {
        let expected = if count == 1 { "a number".into() } else { format!("{count} numbers") };
        return Err(xml::refuse(element, Reason::Syntax(format!("{what} must be {expected}, not \"{value}\""))));
    }
    if let Some(&value) = numbers.iter().find(|number| !number.is_finite() || **number < least) {
        return Err(xml::refuse(
            element,
            match value.is_finite() {
                true => Reason::OutOfRange { what, allowed: "at least 0", value },
                false => Reason::NotFinite { what, value },
            },
        ));
    }
    write_attribute(name, &words.join(" "), strict);
    Ok(true)
}

/// Writes an attribute into the strict copy.
fn write_attribute(name: &str, value: &str, strict: &mut String) {
    strict.push_str(&format!(" {name}=\"{value}\""));
}
