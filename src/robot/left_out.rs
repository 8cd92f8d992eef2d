//! Descriptions of the parts of a file that do not enter the analysis.

use super::LeftOutPart;
use super::caution::closes_loops;
use super::reading::{FrozenJoint, Reading};
use crate::description::{self, Collision, Description, Geometry, Ignored, JointKind, joint_place, link_place};

/// A joint without a coordinate.
pub(super) fn frozen(joint: &FrozenJoint) -> LeftOutPart {
    LeftOutPart { what: joint_place(&joint.name), why: joint.why() }
}

/// A joint whose axis is off by `tilt` \[rad\] and is taken as exact.
pub(super) fn tilted(joint: &description::UrdfJoint, tilt: f64) -> LeftOutPart {
    let wanted = if joint.kind == JointKind::Prismatic { "the plane" } else { "the plane's normal" };
    let why = format!("its axis is {tilt:.1e} rad off {wanted}: taken as exactly on it");
    LeftOutPart { what: joint_place(&joint.name), why }
}

/// Links that belong to the base.
pub(super) fn outside(reading: &Reading) -> impl Iterator<Item = LeftOutPart> {
    let why = "not part of the robot: it belongs to the world or to the base";
    reading.outside.iter().map(move |name| LeftOutPart { what: link_place(name), why: why.into() })
}

/// A link whose inertia is incomplete or impossible.
pub(super) fn doubtful_inertia(link: &description::UrdfLink) -> Option<LeftOutPart> {
    let inertial = link.inertial.as_ref()?;
    let why = match &inertial.inertia {
        None => "its <inertial> has no <inertia>: taken as a point mass",
        Some(inertia) if !super::composite::is_physical(inertia) => {
            "no body can have its inertia: the moment about the plane's normal is taken as it is, the rest left out"
        }
        Some(_) => return None,
    };
    Some(LeftOutPart { what: link_place(&link.name), why: why.into() })
}

/// A moment of inertia that is negative by rounding and is taken as zero.
pub(super) fn rounded(link: &description::UrdfLink, moment: f64) -> LeftOutPart {
    let why = format!("its moment about the plane's normal is {moment:e} kg m^2, which is rounding: taken as 0");
    LeftOutPart { what: link_place(&link.name), why }
}

/// The collision shapes of a link that is fixed to the world.
pub(super) fn bolted_shapes(link: &description::UrdfLink) -> LeftOutPart {
    let why = "bolted to the world: it cannot strike the ground";
    LeftOutPart { what: format!("collision shapes of {}", link_place(&link.name)), why: why.into() }
}

/// A collision shape that has no outline.
pub(super) fn skipped(link: &description::UrdfLink, collision: &Collision, why: String) -> LeftOutPart {
    let shape = match &collision.geometry {
        Geometry::Box { .. } => "box".into(),
        Geometry::Cylinder { .. } => "cylinder".into(),
        Geometry::Capsule { .. } => "capsule".into(),
        Geometry::Sphere { .. } => "sphere".into(),
        Geometry::Mesh { file, .. } => format!("mesh \"{file}\""),
        Geometry::Unknown { tag } => format!("<{tag}>"),
    };
    LeftOutPart { what: format!("collision {shape} of {}", link_place(&link.name)), why }
}

/// Elements of the file that are not read.
pub(super) fn passed_over(description: &Description) -> impl Iterator<Item = LeftOutPart> {
    description.ignored.iter().map(|Ignored { parent, tag, count }| {
        let why = match (*parent, tag.as_str()) {
            ("joint", "limit") => "joint limits do not enter an impact",
            (parent, tag) if closes_loops(parent, tag) => "a tree of joints has no loops: states close them by `loops`",
            ("robot", "joint") => "a joint of another namespace, which is not read",
            ("joint", "dynamics") => "an impact has no damping or dry friction of joints; forces have it as `torque`",
            _ => "no part of the robot's mechanics",
        };
        let times = if *count == 1 { String::new() } else { format!("{count} ") };
        LeftOutPart { what: format!("{times}<{tag}> in <{parent}>"), why: why.into() }
    })
}
