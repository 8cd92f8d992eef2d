//! The legs: the joints on the way from the root to the lowest links.

use super::reference_pose::{ReferencePose, frozen_shift};
use crate::description::{Description, apply};

/// Links no higher above the lowest one than this part of the robot's height are feet.
const FOOT: f64 = 0.1;

/// An axis of a leg up to this far off the normal turns more in the plane than out of it \[rad\].
pub(super) const OBLIQUE: f64 = 0.9;

/// Whether each joint leads to a link that is among the lowest, in the root link's axes with z up.
pub(super) fn legs(description: &Description, pose: &ReferencePose) -> Vec<bool> {
    let Description { links, joints, root, .. } = description;
    let mut places = vec![[0.0; 3]; links.len()];
    let outward = description.outward(*root);
    for &index in &outward {
        let joint = &joints[index];
        let moved = |from: [f64; 3], axes, by: [f64; 3]| {
            let by = apply(axes, by);
            [0, 1, 2].map(|axis| from[axis] + by[axis])
        };
        let origin = moved(places[joint.parent], &pose.rotations[joint.parent], joint.origin.xyz);
        let shift = pose.frozen[index].map_or([0.0; 3], |value| frozen_shift(joint, value));
        places[joint.child] = moved(origin, &pose.rotations[joint.child], shift);
    }
    let heights = || places.iter().map(|place| place[2]);
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    let mut leads: Vec<bool> = heights().map(|height| height <= low + FOOT * (high - low)).collect();
    let mut legs = vec![false; joints.len()];
    for &index in outward.iter().rev() {
        legs[index] = leads[joints[index].child];
        leads[joints[index].parent] |= legs[index];
    }
    legs
}
