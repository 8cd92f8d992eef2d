//! Connects links and joints to one tree.

use super::{Description, UrdfJoint, UrdfLink};
use crate::error::{Reason, Result};

/// Sets the joint of each link and returns the root, in time linear in links and joints. A link with two parents, more
/// than one root, or a cycle are refused.
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
    // Without a root every link is a child, so there is a cycle; without links there is nothing to connect.
    root.ok_or_else(|| Reason::Missing("a <link>".into()).into())
}

impl Description {
    /// All joints outward from `link`, those of one link in the file's order and each branch before the next.
    pub fn outward(&self, link: usize) -> Vec<usize> {
        // The first joint of each link, and of each joint the next of the same link.
        let (mut first, mut next) = (vec![None; self.links.len()], vec![None; self.joints.len()]);
        for (index, joint) in self.joints.iter().enumerate().rev() {
            next[index] = first[joint.parent].replace(index);
        }
        let (mut order, mut waiting) = (Vec::with_capacity(self.joints.len()), Vec::from_iter(first[link]));
        while let Some(index) = waiting.pop() {
            order.push(index);
            // A stack is emptied from its end.
            waiting.extend(next[index]);
            waiting.extend(first[self.joints[index].child]);
        }
        order
    }
}

/// A link that is its own ancestor, if any, and its joint.
fn first_in_cycle(links: &[UrdfLink], joints: &[UrdfJoint]) -> Option<(usize, usize)> {
    // The walk toward the root in which a link was first met, counted from 1.
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
