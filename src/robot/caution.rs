//! What a user must know before trusting a reduced robot, each with its remedy.

use super::plane::{PARALLEL, Plane};
use super::reading::{FreezeReason, FrozenJoint};
use super::reference_pose::ReferencePose;
use crate::description::{Description, JointKind, Matrix, apply, turn};

/// An axis up to this far off the normal \[rad\] may have been meant to be parallel to it.
const NEARLY: f64 = 0.35;
/// The most joints that are named.
const NAMED: usize = 3;

/// The description in its pose and plane.
pub(super) struct Seen<'a> {
    pub(super) description: &'a Description,
    pub(super) pose: &'a ReferencePose,
    pub(super) plane: Plane,
}

/// The cautions about joints that are held, of which `kept` others stay.
pub(super) fn about_held(seen: &Seen, held: &[FrozenJoint], kept: usize) -> Vec<String> {
    use FreezeReason::{Asked, Base, Fixed, Kind, OffPlane};
    let with = |wanted: fn(&FreezeReason) -> bool| held.iter().filter(move |joint| wanted(&joint.reason));
    let movable: Vec<_> = with(|reason| !matches!(reason, Fixed | Asked { .. } | Base)).collect();
    let nearly: Vec<_> = with(|reason| matches!(reason, OffPlane { angle, .. } if *angle <= NEARLY)).collect();
    let hidden: Vec<_> = with(|reason| matches!(reason, Kind(_))).collect();
    let names = |joints: &[&FrozenJoint]| names(joints.iter().map(|joint| joint.name.as_str()));
    let mut cautions = Vec::new();
    if !nearly.is_empty() && nearly.len() >= kept {
        cautions.push(about_tilted(seen, &nearly, movable.len() + kept));
    } else if kept == 0 && movable.len() > hidden.len() {
        cautions.push(format!(
            "no joint moves in this plane, so the robot is one rigid body ({} held): choose another plane (`plane`), or hold \
             joints where the axes of others are in line (`hold: NAME=VALUE`)",
            names(&movable)
        ));
    }
    if !hidden.is_empty() {
        cautions.push(format!(
            "{} could move in the plane and is held all the same, having no single axis: replace it by revolute and prismatic \
             joints",
            names(&hidden)
        ));
    }
    cautions
}

/// The caution about links of the base that could touch the ground; the root's shapes are the ground's or the rail's.
pub(super) fn about_outside(description: &Description, outside: &[String]) -> Option<String> {
    let root = &description.links[description.root].name;
    let touching = |name: &String| {
        let link = description.links.iter().find(|link| link.name == *name);
        name != root && link.is_some_and(|link| !link.collisions.is_empty())
    };
    let touching = names(outside.iter().filter(|name| touching(name)).map(String::as_str));
    (!touching.is_empty()).then(|| {
        format!(
            "{touching} has collision shapes but belongs to the base, so they are left out: if it is a foot, name one on \
             another link (`feet: LINK:X,Y,Z`)"
        )
    })
}

/// The caution about joints whose axes are nearly parallel to the normal, out of `all` that could move.
fn about_tilted(seen: &Seen, nearly: &[&FrozenJoint], all: usize) -> String {
    let angles = nearly.iter().filter_map(|joint| match joint.reason {
        FreezeReason::OffPlane { angle, .. } => Some(angle),
        _ => None,
    });
    let degrees = |angle: f64| format!("{:.1}", angle.to_degrees());
    let (least, most) = (degrees(angles.clone().fold(f64::INFINITY, f64::min)), degrees(angles.fold(0.0, f64::max)));
    let range = if least == most { most } else { format!("{least} to {most}") };
    let mut remedies: Vec<String> = Vec::new();
    for remedy in nearly.iter().filter_map(|joint| remedy(seen, seen.description.joint(&joint.name)?)) {
        if !remedies.contains(&remedy) {
            remedies.push(remedy);
        }
    }
    format!(
        "{} of {all} joints that could move are held only because their axes are {range} degrees off the plane ({}); to keep \
         them: {}",
        nearly.len(),
        names(nearly.iter().map(|joint| joint.name.as_str())),
        remedies.join(", "),
    )
}

/// What brings the axis of a joint into line: a held hinge before it that can turn it there, or else the joint whose
/// origin tilts it.
fn remedy(seen: &Seen, joint: usize) -> Option<String> {
    let Seen { description, pose, plane } = seen;
    let axis = pose.axes[joint];
    let before = || {
        let link = |joint: usize| description.links[description.joints[joint].parent].joint;
        std::iter::successors(link(joint), move |&joint| link(joint))
    };
    let turned = before().filter(|&before| {
        let kind = description.joints[before].kind;
        // One that is nearly in line is to be kept itself.
        matches!(kind, JointKind::Revolute | JointKind::Continuous)
            && pose.held[before].is_none()
            && plane.off_normal(pose.axes[before]) > NEARLY
    });
    let mut turned = turned.filter_map(|before| Some((before, angle_into_line(axis, pose.axes[before], *plane)?)));
    if let Some((hinge, angle)) = turned.next() {
        return Some(format!("`hold: {}={angle:.6}`", description.joints[hinge].name));
    }
    let in_line = |axes: &Matrix| {
        let columns = [0, 1, 2].map(|column| axes.map(|row| row[column]));
        columns.into_iter().any(|column| plane.off_normal(column) <= PARALLEL)
    };
    let tilts = |at: &usize| {
        let joint = &description.joints[*at];
        in_line(&pose.rotations[joint.parent]) && !in_line(&pose.rotations[joint.child])
    };
    match std::iter::once(joint).chain(before()).find(tilts) {
        Some(tilting) => Some(format!("straighten the rpy of {}", description.joints[tilting].name)),
        None => Some(format!("straighten the axis of {}", description.joints[joint].name)),
    }
}

/// The angle \[rad\] by which a turn about `hinge` brings `axis` to the plane's normal, if one does; both of length
/// one.
fn angle_into_line(axis: [f64; 3], hinge: [f64; 3], plane: Plane) -> Option<f64> {
    let [_, normal, _] = plane.axes();
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    let aim = if dot(axis, normal) < 0.0 { normal.map(|entry| -entry) } else { normal };
    // What of both lies across the hinge.
    let across = |vector: [f64; 3]| [0, 1, 2].map(|k| vector[k] - dot(vector, hinge) * hinge[k]);
    let (from, to) = (across(axis), across(aim));
    let angle = libm::atan2(dot(cross(from, to), hinge), dot(from, to));
    (plane.off_normal(apply(&turn(hinge, angle), axis)) <= PARALLEL).then_some(angle)
}

/// The first names.
fn names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.len().checked_sub(NAMED) {
        Some(more) if more > 0 => format!("{}, {more} more", names[..NAMED].join(", ")),
        _ => names.join(", "),
    }
}
