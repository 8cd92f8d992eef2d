//! Connects links and joints to one tree.

use super::{Description, UrdfJoint, UrdfLink};
use crate::error::{Reason, Result};

/// Sets the joint of each link and returns the root, in linear time. Refuses two parents, several roots and cycles.
pub(super) fn connect(links: &mut [UrdfLink], joints: &[UrdfJoint]) -> Result<usize> {
    for (index, joint) in joints.iter().enumerate() {
        if let Some(first) = links[joint.child].joint {
            let reason = format!(
                "link \"{}\" would have two parents: it is the child of joint \"{}\" too",
                links[joint.child].name, joints[first].name
            );
            return Err(joint
                .refuse(Reason::NotATree(reason))
                .hint("cut the loop open, since a link has one parent joint; \"loops\" of a state close it again"));
        }
        links[joint.child].joint = Some(index);
    }

    let mut roots = (0..links.len()).filter(|&link| links[link].joint.is_none());
    let root = roots.next();
    if let (Some(root), Some(other)) = (root, roots.next()) {
        let reason = format!("links \"{}\" and \"{}\" are both roots", links[root].name, links[other].name);
        return Err(links[other].refuse(Reason::NotATree(reason)).hint("make one of them the child of a joint"));
    }

    if let Some((link, joint)) = first_in_cycle(links, joints) {
        let name = &links[link].name;
        let reason = Reason::NotATree(format!("link \"{name}\" is its own ancestor: the joints form a cycle"));
        return Err(joints[joint].refuse(reason).hint("cut the cycle open: one link must be no joint's child"));
    }
    // Without a root every link is a child, which was refused above as a cycle. So there are no links.
    root.ok_or_else(|| Reason::Missing("a <link>".into()).into())
}

impl Description {
    /// Returns all joints beyond `link` in depth-first order. Joints of the same link are in the file's order.
    pub fn outward(&self, link: usize) -> Vec<usize> {
        // The first joint of each link, and for each joint the next joint of the same parent link.
        let (mut first, mut next) = (vec![None; self.links.len()], vec![None; self.joints.len()]);
        for (index, joint) in self.joints.iter().enumerate().rev() {
            next[index] = first[joint.parent].replace(index);
        }
        let (mut order, mut waiting) = (Vec::with_capacity(self.joints.len()), Vec::from_iter(first[link]));
        while let Some(index) = waiting.pop() {
            order.push(index);
            // `waiting` is a stack: the child's joints come before the next joint.
            waiting.extend(next[index]);
            waiting.extend(first[self.joints[index].child]);
        }
        order
    }
}

/// Returns a link that is its own ancestor, and its joint; `None` if there is no cycle.
fn first_in_cycle(links: &[UrdfLink], joints: &[UrdfJoint]) -> Option<(usize, usize)> {
    // For each link, the first walk toward the root that reached it, counted from 1.
    let mut met = vec![0; links.len()];
    for start in 0..links.len() {
        let (walk, mut at) = (start + 1, start);
        while met[at] == 0 {
            met[at] = walk;
            match links[at].joint {
                Some(joint) => at = joints[joint].parent,
                None => break,
            }
        }
        if let (true, Some(joint)) = (met[at] == walk, links[at].joint) {
            return Some((at, joint));
        }
    }
    None
}
