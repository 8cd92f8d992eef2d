//! Roles of joints -> bodies, and poses of all links: the tree at zero coordinates, projected and welded.
//!
//! The pose of a link's frame in its body's frame is
//!
//! ```text
//!     p = p_parent + R_parent xyz,   R = R_parent Rz(yaw) Ry(pitch) Rx(roll)          p = 0 for a separate body
//! ```
//!
//! where `xyz` and roll, pitch, yaw are those of the joint's origin, and R transforms into the plane's axes. A joint
//! that is frozen at a value then displaces and rotates its child by that value. Cost: linear in the links, without
//! recursion.

use super::reference_pose::{ReferencePose, moved};
use super::role::Role;
use super::{Body, Joint, MimicJoint, ParentJoint};
use crate::description::{self, Description, Inertial, Matrix, Mimic, Pose, apply, product};
use crate::planar::Vector;
use crate::reductions::Reductions;

/// Pose of a link's frame in its body's frame, in three dimensions, along the plane's axes forward, normal, up.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) body: usize,
    pub(super) rotation: Matrix,
    pub(super) offset: [f64; 3],
}

impl Place {
    /// Returns the position in the body's frame of a point given in the link's frame.
    pub(super) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = apply(&self.rotation, point);
        [self.offset[0] + x, self.offset[1] + y, self.offset[2] + z]
    }

    /// Returns the pose in the body's frame of a frame given in the link's frame.
    pub(super) fn frame(&self, pose: &Pose) -> Self {
        let rotation = product(&self.rotation, &pose.rotation());
        Self { body: self.body, rotation, offset: self.point(pose.xyz) }
    }

    /// Returns the forward and up components of the origin.
    pub(super) fn in_plane(&self) -> Vector<f64> {
        let [x, _, z] = self.offset;
        Vector::new(x, z)
    }
}

/// Bodies and joints, not yet with inertia, and the poses of all links.
pub(super) struct Tree {
    pub(super) bodies: Vec<Body>,
    pub(super) joints: Vec<Joint>,
    pub(super) mimic_joints: Vec<MimicJoint>,
    /// The pose of each link; `None` for links outside of the robot.
    pub(super) places: Vec<Option<Place>>,
}

impl Tree {
    /// Builds the tree from `root`, whose axes are the columns of `rotation`, parents before their children.
    pub(super) fn grow(
        description: &Description,
        (pose, roles): (&ReferencePose, &[Role]),
        root: usize,
        rotation: Matrix,
        reductions: Reductions,
    ) -> Self {
        let links = &description.links;
        let beyond = (root != description.root).then(|| description.outward(root));
        let outward = beyond.as_ref().unwrap_or(&pose.outward);
        // The coordinate or mimic joint of each joint in the file. Both are numbered in the file's order.
        let mut movers = vec![None; roles.len()];
        let (mut coordinates, mut mimics) = (0.., 0..);
        let mut in_the_tree = outward.clone();
        in_the_tree.sort_unstable();
        for index in in_the_tree {
            movers[index] = match roles[index] {
                Role::Moves { mimicked: None, .. } => coordinates.next().map(ParentJoint::Joint),
                Role::Moves { mimicked: Some(_), .. } => mimics.next().map(ParentJoint::Mimic),
                Role::Frozen(_) | Role::Free => None,
            }
        }

        let mut places = vec![None; links.len()];
        places[root] = Some(Place { body: 0, rotation, offset: [0.0; 3] });
        let mut bodies = vec![Body::of(&links[root].name, None)];
        let (mut joints, mut mimic_joints) = (Vec::new(), Vec::new());
        for &index in outward {
            let joint = &description.joints[index];
            // The walk is outward, so the parent's pose is known.
            let Some(parent) = &places[joint.parent] else { continue };
            let at = parent.frame(&joint.origin);
            let child = match (&roles[index], movers[index]) {
                (&Role::Moves { axis, ref mimicked, .. }, Some(mover)) => {
                    let (name, parent, child, origin) = (joint.name.clone(), at.body, bodies.len(), at.in_plane());
                    bodies.push(Body::of(&links[joint.child].name, Some(mover)));
                    let joint = Joint { name, parent, child, origin, axis, limits: joint.limits };
                    let mimic = mimicked.as_ref().map(|mimicked| (movers[mimicked.joint], mimicked));
                    if let Some((Some(ParentJoint::Joint(mimicked)), &Mimic { multiplier, offset, .. })) = mimic {
                        mimic_joints.push((index, MimicJoint { joint, mimicked, multiplier, offset }));
                    } else {
                        joints.push((index, joint));
                    }
                    Place { body: child, offset: [0.0; 3], ..at }
                }
                _ => {
                    let at = match pose.frozen[index] {
                        Some(value) => {
                            let (turn, shift) = moved(joint, value);
                            Place { rotation: product(&at.rotation, &turn), offset: at.point(shift), ..at }
                        }
                        None => at,
                    };
                    let child = &links[joint.child];
                    let welded = if vanishes(child) { reductions.massless } else { reductions.weld };
                    if welded {
                        at
                    } else {
                        let fixed = ParentJoint::Fixed { parent: at.body, origin: at.in_plane() };
                        bodies.push(Body::of(&child.name, Some(fixed)));
                        Place { body: bodies.len() - 1, offset: [0.0; 3], ..at }
                    }
                }
            };
            places[joint.child] = Some(child);
        }
        Self { bodies, joints: in_order(joints), mimic_joints: in_order(mimic_joints), places }
    }
}

/// Sorts by index, which is the file's order.
fn in_order<T>(mut joints: Vec<(usize, T)>) -> Vec<T> {
    joints.sort_by_key(|(index, _)| *index);
    joints.into_iter().map(|(_, joint)| joint).collect()
}

/// Returns whether a link adds nothing to the body it is welded into: it has neither inertia nor shapes.
fn vanishes(link: &description::UrdfLink) -> bool {
    let inertia = |inertia: &Matrix| inertia.iter().flatten().all(|&entry| entry == 0.0);
    let massless = |inertial: &Inertial| inertial.mass == 0.0 && inertial.inertia.as_ref().is_none_or(inertia);
    link.collisions.is_empty() && link.inertial.as_ref().is_none_or(massless)
}

impl Body {
    fn of(link: &str, joint: Option<ParentJoint>) -> Self {
        Self { name: link.into(), joint, mass: 0.0, com: Vector::zero(), moment: 0.0 }
    }
}
