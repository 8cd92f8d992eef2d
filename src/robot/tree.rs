//! Roles of joints -> bodies and the places of all links: the tree placed at zero, projected, and welded.
//!
//! A link's frame stands in its body's frame at
//!
//! ```text
//!     p = p_parent + R_parent xyz,   R = R_parent Rz(yaw) Ry(pitch) Rx(roll)          p = 0 behind a moving joint
//! ```
//!
//! where `xyz` and roll, pitch, yaw are of the joint's origin and R leads to the plane's axes; a joint that is held at a value
//! shifts and turns its child by that once more. What lies beside the plane counts as if it lay in it. Linear in links;
//! nothing recurses.

use super::posture::{Posture, held_shift, held_turn};
use super::role::Role;
use super::{Body, Joint};
use crate::description::{Description, Matrix, Pose, apply, product};
use crate::error::{Reason, Result};
use crate::planar::Vector;

/// A link's frame in its body's frame, in three dimensions and with the plane's axes: forward, normal, up.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) body: usize,
    pub(super) rotation: Matrix,
    pub(super) offset: [f64; 3],
}

impl Place {
    /// A point of the link's frame in the body's frame.
    pub(super) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = apply(&self.rotation, point);
        [self.offset[0] + x, self.offset[1] + y, self.offset[2] + z]
    }

    /// A frame in the link's frame, in the body's frame.
    pub(super) fn frame(&self, pose: &Pose) -> Self {
        let rotation = product(&self.rotation, &pose.rotation());
        Self { body: self.body, rotation, offset: self.point(pose.xyz) }
    }

    /// Forward and up of the origin.
    pub(super) fn in_plane(&self) -> Vector<f64> {
        let [x, _, z] = self.offset;
        [x, z]
    }
}

/// Bodies and joints, still without inertia, and the places of all links.
pub(super) struct Tree {
    pub(super) bodies: Vec<Body>,
    /// The moving joints, in the file's order.
    pub(super) joints: Vec<Joint>,
    /// The joint of the file that each of `joints` is.
    pub(super) sources: Vec<usize>,
    /// The place of each link; none for those that do not hang on the root.
    pub(super) places: Vec<Option<Place>>,
}

impl Tree {
    /// Walks from `root`, whose axes are the columns of `rotation`, so that parents come first, and along each branch
    /// before the next.
    pub(super) fn grow(
        description: &Description,
        posture: &Posture,
        roles: &[Role],
        root: usize,
        rotation: Matrix,
    ) -> Result<Self> {
        let links = &description.links;
        // The coordinate of each moving joint.
        let outward = description.outward_from(root);
        let mut sources: Vec<usize> =
            outward.iter().copied().filter(|&index| !matches!(roles[index], Role::Held(_))).collect();
        sources.sort_unstable();
        let mut coordinates = vec![None; roles.len()];
        for (coordinate, &index) in sources.iter().enumerate() {
            coordinates[index] = Some(coordinate);
        }

        let mut places = vec![None; links.len()];
        places[root] = Some(Place { body: 0, rotation, offset: [0.0; 3] });
        let mut bodies = vec![Body::of(&links[root].name, None)];
        let mut joints: Vec<(usize, Joint)> = Vec::with_capacity(sources.len());
        for index in outward {
            let joint = &description.joints[index];
            // Outward: the parent's place is known.
            let Some(parent) = &places[joint.parent] else { continue };
            let at = parent.frame(&joint.origin);
            let child = match (&roles[index], coordinates[index]) {
                (Role::Moves { axis, leader, .. }, Some(coordinate)) => {
                    if leader.is_some() {
                        let refused = joint.refuse(Reason::Unsupported("mimic joints are not handled yet".into()));
                        return Err(refused.hint("remove <mimic> to let the joint move freely, or make it fixed"));
                    }
                    let (name, child) = (joint.name.clone(), bodies.len());
                    bodies.push(Body::of(&links[joint.child].name, Some(coordinate)));
                    joints
                        .push((coordinate, Joint { name, parent: at.body, child, origin: at.in_plane(), axis: *axis }));
                    Place { body: child, offset: [0.0; 3], ..at }
                }
                _ => match posture.held[index] {
                    Some(value) => {
                        let offset = at.point(held_shift(joint, value));
                        Place { rotation: product(&at.rotation, &held_turn(joint, value)), offset, ..at }
                    }
                    None => at,
                },
            };
            places[joint.child] = Some(child);
        }
        joints.sort_by_key(|(coordinate, _)| *coordinate);
        Ok(Self { bodies, joints: joints.into_iter().map(|(_, joint)| joint).collect(), sources, places })
    }
}

impl Body {
    /// A body that still weighs nothing.
    fn of(link: &str, joint: Option<usize>) -> Self {
        Self { name: link.into(), joint, mass: 0.0, com: [0.0; 2], moment: 0.0 }
    }
}
