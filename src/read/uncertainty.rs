//! Half-widths of a state's numbers.

use super::format::fields_of;
use super::json::Node;
use super::state::{by_link, coordinates, joint};
use crate::state::{ByLink, Uncertainty};
use crate::{Reason, Result, Robot};

/// `{"position", "velocity", "friction", "rotor_inertia"}`, each one number or by name.
pub(super) fn uncertainty(field: Node, robot: &Robot) -> Result<Uncertainty> {
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
pub(super) fn refuse_a_placed_base(field: Node) -> Result<()> {
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
