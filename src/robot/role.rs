//! What each joint of the file is in the plane: a hinge, a slide, or a weld.
//!
//! ```text
//!     turns:   angle(a, n) <= 1e-3 rad  ->  it turns about ±n exactly        else held
//!     slides:  angle(a, plane) <= 1e-3 rad  ->  it slides along a in the plane  else held
//! ```

use super::plane::{PARALLEL, Plane};
use super::posture::Posture;
use super::{Axis, Still};
use crate::description::{Description, JointKind, Mimic, apply, unit};
use crate::planar::Vector;

/// An axis this near to the normal is off by rounding alone \[rad\].
const ROUNDING: f64 = 1e-9;

/// What a joint is in the plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Role {
    /// It moves: about or along this axis, by itself or after its leader.
    Moves {
        axis: Axis,
        leader: Option<Mimic>,
        /// By how much its axis had to be turned into line \[rad\]; 0 for less than rounding.
        tilt: f64,
    },
    /// Planar or floating: the base itself where it joins the robot to the world.
    Free,
    /// It keeps the value that the posture gives it.
    Held(Still),
}

/// The role of every joint.
pub(super) fn roles(description: &Description, posture: &Posture, plane: Plane) -> Vec<Role> {
    let joints = &description.joints;
    let alone: Vec<Role> = (0..joints.len()).map(|index| role(joints[index].kind, index, posture, plane)).collect();
    let mut roles = alone.clone();
    for (index, leader) in posture.leaders.iter().enumerate() {
        let Some(leader) = leader else { continue };
        let follows = || Role::Held(Still::Follows { leader: joints[leader.joint].name.clone() });
        match (&mut roles[index], &alone[leader.joint]) {
            (Role::Moves { leader: followed, .. }, Role::Moves { .. }) => *followed = Some(leader.clone()),
            (role @ Role::Moves { .. }, _) => *role = follows(),
            // Told as what it is: held at zero whatever its leader does.
            (Role::Free | Role::Held(_), _) => {}
        }
        if posture.held[index].is_some() && joints[index].kind != JointKind::Fixed {
            roles[index] = follows();
        }
    }
    roles
}

/// A joint's role by itself.
fn role(kind: JointKind, index: usize, posture: &Posture, plane: Plane) -> Role {
    if let (Some(value), true) = (posture.held[index], kind.has_axis()) {
        return Role::Held(Still::Asked { value });
    }
    let axis = posture.axes[index];
    match kind {
        JointKind::Fixed => Role::Held(Still::Fixed),
        JointKind::Spherical => Role::Held(Still::Kind(kind)),
        JointKind::Planar | JointKind::Floating => Role::Free,
        JointKind::Revolute | JointKind::Continuous => {
            let angle = plane.off_normal(axis);
            let [_, along_normal, _] = apply(&plane.axes(), axis);
            moves(angle, kind, || Axis::Turn { sign: if along_normal < 0.0 { -1.0 } else { 1.0 } })
        }
        JointKind::Prismatic => moves(plane.off_plane(axis), kind, || {
            let [x, _, z] = apply(&plane.axes(), axis);
            let [x, _, z] = unit([x, 0.0, z]);
            Axis::Slide { direction: Vector::new(x, z) }
        }),
    }
}

fn moves(angle: f64, kind: JointKind, axis: impl Fn() -> Axis) -> Role {
    if angle <= PARALLEL {
        Role::Moves { axis: axis(), leader: None, tilt: if angle > ROUNDING { angle } else { 0.0 } }
    } else {
        Role::Held(Still::OffPlane { angle, slides: kind == JointKind::Prismatic })
    }
}
