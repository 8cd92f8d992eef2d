//! What each joint of the file is in the plane: revolute, prismatic, or fixed.
//!
//! ```text
//!     revolute:   angle(a, n) <= tolerance      ->  it turns about ±n exactly         else frozen
//!     prismatic:  angle(a, plane) <= tolerance  ->  it slides along a in the plane    else frozen
//! ```

use super::plane::Plane;
use super::reference_pose::ReferencePose;
use super::{Axis, FreezeReason};
use crate::description::{Description, JointKind, Mimic, apply, unit};
use crate::planar::Vector;

/// An axis this near to the normal is off by rounding alone \[rad\].
const ROUNDING: f64 = 1e-9;

/// What a joint is in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Role {
    /// It moves: about or along this axis, by itself or as a mimic joint.
    Moves {
        axis: Axis,
        mimicked: Option<Mimic>,
        /// By how much its axis had to be turned into line \[rad\]; 0 for less than rounding.
        tilt: f64,
    },
    /// Planar or floating: the base itself where it joins the robot to the world.
    Free,
    /// It keeps its value in the pose.
    Frozen(FreezeReason),
}

/// The role of every joint.
pub(super) fn roles(description: &Description, pose: &ReferencePose, plane: Plane) -> Vec<Role> {
    let joints = &description.joints;
    let mut roles: Vec<Role> = (0..joints.len()).map(|index| role(joints[index].kind, index, pose, plane)).collect();
    for (index, mimicked) in pose.mimicked.iter().enumerate() {
        let Some(mimicked) = mimicked else { continue };
        let value = pose.frozen[index].unwrap_or(0.0);
        let follows = || Role::Frozen(FreezeReason::Follows { mimicked: joints[mimicked.joint].name.clone(), value });
        // The mimicked joint mimics none, so that its own role stays.
        let is_followed = matches!(roles[mimicked.joint], Role::Moves { .. });
        match &mut roles[index] {
            Role::Moves { mimicked: followed, .. } if is_followed => *followed = Some(mimicked.clone()),
            role @ Role::Moves { .. } => *role = follows(),
            // Reported as what it is: frozen at zero whatever the mimicked joint does.
            Role::Free | Role::Frozen(_) => {}
        }
        if pose.frozen[index].is_some() && joints[index].kind != JointKind::Fixed {
            roles[index] = follows();
        }
    }
    roles
}

/// A joint's role by itself.
fn role(kind: JointKind, index: usize, pose: &ReferencePose, plane: Plane) -> Role {
    if let (Some(value), true) = (pose.frozen[index], kind.has_axis()) {
        return Role::Frozen(FreezeReason::Asked { value });
    }
    let axis = pose.axes[index];
    match kind {
        JointKind::Fixed => Role::Frozen(FreezeReason::Fixed),
        JointKind::Spherical => Role::Frozen(FreezeReason::Kind(kind)),
        JointKind::Planar | JointKind::Floating => Role::Free,
        JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic => {
            let slides = kind == JointKind::Prismatic;
            let angle = if slides { plane.off_plane(axis) } else { plane.off_normal(axis) };
            if angle > pose.tolerance {
                return Role::Frozen(FreezeReason::OffPlane { angle, slides });
            }
            let [x, along_normal, z] = apply(&plane.axes(), axis);
            let [x, _, z] = unit([x, 0.0, z]);
            let axis = match slides {
                true => Axis::Prismatic { direction: Vector::new(x, z) },
                false => Axis::Revolute { sign: if along_normal < 0.0 { -1.0 } else { 1.0 } },
            };
            Role::Moves { axis, mimicked: None, tilt: if angle > ROUNDING { angle } else { 0.0 } }
        }
    }
}
