//! The role of each joint of the file in the plane: revolute, prismatic, base or frozen.
//!
//! ```text
//!     revolute:   angle(a, n) <= tolerance      ->  rotates about ±n exactly          else frozen
//!     prismatic:  angle(a, plane) <= tolerance  ->  slides along a in the plane       else frozen
//!     planar:     angle(a, n) <= 0.9            ->  the base itself                   else slides along n x a
//! ```

use super::plane::{OBLIQUE, Plane};
use super::reference_pose::ReferencePose;
use super::{Axis, FreezeReason};
use crate::description::{Description, JointKind, Mimic, UrdfJoint, apply, unit};
use crate::planar::Vector;

/// An axis this close to the normal is off by rounding only \[rad\].
const ROUNDING: f64 = 1e-9;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Role {
    /// The joint moves about or along this axis, independently or as a mimic joint.
    Moves {
        axis: Axis,
        mimicked: Option<Mimic>,
        /// The angle by which the axis was corrected \[rad\]; 0 if it is only rounding.
        tilt: f64,
    },
    /// A planar or floating joint. It is the base if it connects the robot to the world.
    Free,
    /// The joint keeps its value in the reference pose.
    Frozen(FreezeReason),
}

pub(super) fn roles(description: &Description, pose: &ReferencePose, plane: Plane) -> Vec<Role> {
    let joints = &description.joints;
    let mut roles: Vec<Role> = (0..joints.len()).map(|index| role(&joints[index], index, pose, plane)).collect();
    for (index, mimicked) in pose.mimicked.iter().enumerate() {
        let Some(mimicked) = mimicked else { continue };
        let value = pose.frozen[index].unwrap_or(0.0);
        let follows = || Role::Frozen(FreezeReason::Follows { mimicked: joints[mimicked.joint].name.clone(), value });
        // A mimicked joint is not a mimic joint itself, so this loop does not change its role.
        let is_followed = matches!(roles[mimicked.joint], Role::Moves { .. });
        match &mut roles[index] {
            Role::Moves { mimicked: followed, .. } if is_followed => *followed = Some(mimicked.clone()),
            role @ Role::Moves { .. } => *role = follows(),
            // These joints are reported by their own reason: they are frozen at zero whatever the mimicked joint does.
            Role::Free | Role::Frozen(_) => {}
        }
        if pose.frozen[index].is_some() && joints[index].kind != JointKind::Fixed {
            roles[index] = follows();
        }
    }
    roles
}

/// Returns whether a mimic joint `follower` stays frozen at its offset together with its frozen mimicked joint
/// `followed`. If `turns`, the follower is on the path to the mimicked joint and rotates that joint as well.
///
/// A mimicked joint that is frozen because of its axis may become movable by this rotation. A rotation in the plane
/// cannot do that; an axis counts as in the plane if it is off by at most `tolerance`.
pub(super) fn stays(roles: &[Role], tolerance: f64, (follower, followed): (usize, usize), turns: bool) -> bool {
    let in_plane = matches!(roles[follower], Role::Frozen(FreezeReason::Follows { .. }));
    let keeps = match roles[followed] {
        Role::Frozen(FreezeReason::OffPlane { angle, .. }) => in_plane && angle > 3.0 * tolerance,
        Role::Frozen(_) => true,
        Role::Moves { .. } | Role::Free => return false,
    };
    matches!(roles[follower], Role::Frozen(_)) && (keeps || !turns)
}

/// Returns the role of a joint, disregarding mimicry.
fn role(joint: &UrdfJoint, index: usize, pose: &ReferencePose, plane: Plane) -> Role {
    let kind = joint.kind;
    if let (Some(value), true) = (pose.frozen[index], kind.has_axis()) {
        return Role::Frozen(FreezeReason::Asked { value });
    }
    let axis = pose.axes[index];
    let [x, along_normal, z] = apply(&plane.axes(), axis);
    let along = |x: f64, z: f64| {
        let [x, _, z] = unit([x, 0.0, z]);
        Axis::Prismatic { direction: Vector::new(x, z) }
    };
    match kind {
        JointKind::Fixed => Role::Frozen(FreezeReason::Fixed),
        JointKind::Spherical => Role::Frozen(FreezeReason::Kind(kind)),
        // Without an <axis>, or with one close to the normal, the joint is taken to move in this plane.
        JointKind::Planar if joint.has_axis && plane.off_normal(axis) > OBLIQUE => {
            // The joint's only motion in the plane, positive forward or up.
            let [x, z] = if f64::max(z, -x) > f64::max(-z, x) { [z, -x] } else { [-z, x] };
            Role::Moves { axis: along(x, z), mimicked: None, tilt: 0.0 }
        }
        JointKind::Planar | JointKind::Floating => Role::Free,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => {
            let slides = kind == JointKind::Prismatic;
            let angle = if slides { plane.off_plane(axis) } else { plane.off_normal(axis) };
            if angle > pose.tolerance {
                return Role::Frozen(FreezeReason::OffPlane { angle, slides });
            }
            let axis = match slides {
                true => along(x, z),
                false => Axis::Revolute { sign: if along_normal < 0.0 { -1.0 } else { 1.0 } },
            };
            Role::Moves { axis, mimicked: None, tilt: if angle > ROUNDING { angle } else { 0.0 } }
        }
    }
}
