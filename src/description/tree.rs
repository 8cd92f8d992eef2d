//! Connects links and joints to one tree.

use super::{Description, UrdfJoint, UrdfLink};
use crate::error::{Error, Reason, Result, check_index};

/// Returns the joint whose child each link is, and the root, in linear time. Refuses two parents, several roots and
/// cycles.
pub(super) fn connect(links: &[UrdfLink], joints: &[UrdfJoint]) -> Result<(Vec<Option<usize>>, usize)> {
    let mut inward = vec![None; links.len()];
    for (index, joint) in joints.iter().enumerate() {
        if let Some(first) = inward[joint.child].replace(index) {
            let reason = format!(
                "link \"{}\" would have two parents: it is the child of joint \"{}\" too",
                links[joint.child].name, joints[first].name
            );
            return Err(joint
                .refuse(Reason::NotATree(reason))
                .hint("cut the loop open, since a link has one parent joint; \"loops\" of a state close it again"));
        }
    }

    let mut roots = (0..links.len()).filter(|&link| inward[link].is_none());
    let root = roots.next();
    if let (Some(root), Some(other)) = (root, roots.next()) {
        let reason = format!("links \"{}\" and \"{}\" are both roots", links[root].name, links[other].name);
        return Err(links[other].refuse(Reason::NotATree(reason)).hint("make one of them the child of a joint"));
    }

    if let Some((link, joint)) = first_in_cycle(&inward, joints) {
        let name = &links[link].name;
        let reason = Reason::NotATree(format!("link \"{name}\" is its own ancestor: the joints form a cycle"));
        return Err(joints[joint].refuse(reason).hint("cut the cycle open: one link must be no joint's child"));
    }
    // Without a root every link is a child, which was refused above as a cycle. So there are no links.
    let root = root.ok_or_else(|| Error::from(Reason::Missing("a <link>".into())))?;
    Ok((inward, root))
}

impl Description {
    /// Refuses links and joints that a program changed such that they are not one tree.
    pub(crate) fn check(&self) -> Result<()> {
        for joint in &self.joints {
            let links = [joint.parent, joint.child].map(|link| (link, ("links", self.links.len())));
            let mimicked = joint.mimic.as_ref().map(|mimic| (mimic.joint, ("joints", self.joints.len())));
            let mut all = links.into_iter().chain(mimicked);
            all.try_for_each(|(index, of)| check_index(index, of)).map_err(|error| joint.refuse(error))?;
        }
        let (inward, root) = connect(&self.links, &self.joints)?;
        if root == self.root && self.links.iter().map(|link| link.joint).eq(inward) {
            return Ok(());
        }
        let reason = Reason::NotATree("`root` and each link's `joint` are not those of the joints' children".into());
        Err(Error::new(reason).hint("give each link the index of the joint whose child it is"))
    }

    /// Returns all joints beyond `link` in depth-first order. Joints of the same link are in the file's order.
    pub(crate) fn outward(&self, link: usize) -> Vec<usize> {
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
fn first_in_cycle(inward: &[Option<usize>], joints: &[UrdfJoint]) -> Option<(usize, usize)> {
    // For each link, the first walk toward the root that reached it, counted from 1.
    let mut met = vec![0; inward.len()];
    for start in 0..inward.len() {
        let (walk, mut at) = (start + 1, start);
        while met[at] == 0 {
            met[at] = walk;
            match inward[at] {
                Some(joint) => at = joints[joint].parent,
                None => break,
            }
        }
        if let (true, Some(joint)) = (met[at] == walk, inward[at]) {
            return Some((at, joint));
        }
    }
    None
}
