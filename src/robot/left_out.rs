//! Descriptions of the parts of a file that do not enter the analysis.

use super::LeftOutPart;
use super::caution::closes_loops;
use super::composite::is_physical;
use crate::description::{Collision, Description, Geometry, Ignored, UrdfLink, joint_place, link_place};

impl LeftOutPart {
    pub(super) fn joint(name: &str, why: String) -> Self {
        Self { what: joint_place(name), why }
    }

    pub(super) fn link(name: &str, why: impl Into<String>) -> Self {
        Self { what: link_place(name), why: why.into() }
    }

    /// A link whose inertia is incomplete or impossible.
    pub(super) fn doubtful_inertia(link: &UrdfLink) -> Option<Self> {
        let why = match &link.inertial.as_ref()?.inertia {
            None => "its <inertial> has no <inertia>: taken as a point mass",
            Some(inertia) if !is_physical(inertia) => {
                "no body can have its inertia: the moment about the plane's normal is taken as it is, the rest left out"
            }
            Some(_) => return None,
        };
        Some(Self::link(&link.name, why))
    }

    /// The collision shapes of a link that is fixed to the world.
    pub(super) fn bolted_shapes(link: &UrdfLink) -> Self {
        let what = format!("collision shapes of {}", link_place(&link.name));
        Self { what, why: "bolted to the world: it cannot strike the ground".into() }
    }

    /// A collision shape that has no outline.
    pub(super) fn shape(link: &UrdfLink, collision: &Collision, why: String) -> Self {
        let shape = match &collision.geometry {
            Geometry::Box { .. } => "box".into(),
            Geometry::Cylinder { .. } => "cylinder".into(),
            Geometry::Capsule { .. } => "capsule".into(),
            Geometry::Sphere { .. } => "sphere".into(),
            Geometry::Mesh { file, .. } => format!("mesh \"{file}\""),
            Geometry::Unknown { tag } => format!("<{tag}>"),
        };
        Self { what: format!("collision {shape} of {}", link_place(&link.name)), why }
    }
}

/// Elements of the file that are not read.
pub(super) fn passed_over(description: &Description) -> impl Iterator<Item = LeftOutPart> {
    description.ignored.iter().map(|Ignored { parent, tag, count }| {
        let why = match (*parent, tag.as_str()) {
            ("joint", "limit") => "joint limits enter neither an impact nor forces",
            (parent, tag) if closes_loops(parent, tag) => "a tree of joints has no loops: states close them by `loops`",
            ("robot", "joint") => "a joint of another namespace, which is not read",
            ("joint", "dynamics") => "an impact has no damping or dry friction of joints; forces have it as `torque`",
            _ => "no part of the robot's mechanics",
        };
        let times = if *count == 1 { String::new() } else { format!("{count} ") };
        LeftOutPart { what: format!("{times}<{tag}> in <{parent}>"), why: why.into() }
    })
}
