//! What a user must know before trusting a reduced robot, each with its remedy.

use super::reading::{HeldJoint, Still};

/// An axis up to this far off the normal \[rad\] may have been meant to be parallel to it.
const NEARLY: f64 = 0.35;
/// The most joints that are named.
const NAMED: usize = 3;

/// The cautions about joints that are held, of which `kept` others stay.
pub(super) fn about_held(held: &[HeldJoint], kept: usize) -> Vec<String> {
    let mut cautions = Vec::new();
    let moving = held.iter().filter(|joint| !matches!(joint.still, Still::Fixed | Still::Asked { .. } | Still::Base));
    let moving: Vec<&HeldJoint> = moving.collect();
    let nearly: Vec<(&HeldJoint, f64)> = moving
        .iter()
        .filter_map(|joint| match joint.still {
            Still::OffPlane { angle, .. } if angle <= NEARLY => Some((*joint, angle)),
            _ => None,
        })
        .collect();
    if !nearly.is_empty() && nearly.len() >= kept {
        let degrees = |angle: f64| format!("{:.1}", angle.to_degrees());
        let least = nearly.iter().map(|(_, angle)| *angle).fold(f64::INFINITY, f64::min);
        let most = nearly.iter().map(|(_, angle)| *angle).fold(0.0, f64::max);
        let range = if degrees(least) == degrees(most) {
            degrees(most)
        } else {
            format!("{} to {}", degrees(least), degrees(most))
        };
        cautions.push(format!(
            "{} of {} joints that could move are held only because their axes are {range} degrees off the plane ({}): hold \
             the joint that tilts them where they are in line (--hold NAME=VALUE), or straighten their axes in the file",
            nearly.len(),
            moving.len() + kept,
            names(nearly.iter().map(|(joint, _)| *joint)),
        ));
    } else if kept == 0 && !moving.is_empty() {
        cautions.push(format!(
            "no joint moves in this plane, so the robot is one rigid body: all {} are held; choose another with --plane, or \
             hold joints where axes are in line (--hold NAME=VALUE)",
            moving.len()
        ));
    }
    let hidden: Vec<&HeldJoint> = moving
        .iter()
        .filter(|joint| matches!(joint.still, Still::Kind(kind) if kind.moves_in_every_plane()))
        .copied()
        .collect();
    if !hidden.is_empty() {
        cautions.push(format!(
            "{} could move in the plane and is held all the same, having no single axis: replace it by revolute and prismatic \
             joints",
            names(hidden.into_iter())
        ));
    }
    cautions
}

/// The first names.
fn names<'a>(joints: impl ExactSizeIterator<Item = &'a HeldJoint>) -> String {
    let more = joints.len().saturating_sub(NAMED);
    let mut named: Vec<String> = joints.take(NAMED).map(|joint| joint.name.clone()).collect();
    if more > 0 {
        named.push(format!("{more} more"));
    }
    named.join(", ")
}
