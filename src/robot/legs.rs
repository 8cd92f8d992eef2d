//! Legs: the joints on the paths from the root to the lowest links.

use super::reference_pose::ReferencePose;
use crate::description::Description;

/// A link is a foot if its height above the lowest link is at most this fraction of the robot's height.
const FOOT: f64 = 0.1;

/// A leg's axis that is off the normal by at most this angle rotates more in the plane than out of it \[rad\].
pub(super) const OBLIQUE: f64 = 0.9;

/// Returns for each joint whether it leads to one of the lowest links, in the root link's axes with z up.
pub(super) fn legs(description: &Description, pose: &ReferencePose) -> Vec<bool> {
    let joints = &description.joints;
    let heights = || pose.places.iter().map(|place| place[2]);
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    let mut leads: Vec<bool> = heights().map(|height| height <= low + FOOT * (high - low)).collect();
    let mut legs = vec![false; joints.len()];
    for index in description.outward(description.root).into_iter().rev() {
        legs[index] = leads[joints[index].child];
        leads[joints[index].parent] |= legs[index];
    }
    legs
}
