//! The pose in which axes are tested: frozen joints and their mimic joints at their values, all others at zero.
//!
//! ```text
//!     R_child = R_parent R_origin turn(a, q)          axis in the root's axes = R_parent R_origin a
//!     p_child = p_parent + R_parent xyz + R_parent R_origin a q, for a prismatic joint
//! ```

use crate::description::{Description, JointKind, Matrix, Mimic, Pose, UrdfJoint, apply, product, turn, unit};
use crate::error::{Reason, Result, check_index};

/// A link is a foot if its height above the lowest link is at most this fraction of the robot's height.
const FOOT: f64 = 0.1;

/// Axes of all joints and poses of all links, with the values of frozen joints.
pub(super) struct ReferencePose {
    /// All joints in depth-first order.
    pub(super) outward: Vec<usize>,
    /// For each joint, the value at which it is to be frozen, if any; also for what mimics it \[rad or m\].
    pub(super) frozen: Vec<Option<f64>>,
    /// For each joint, the joint that it finally mimics, after chains of mimic joints are resolved.
    pub(super) mimicked: Vec<Option<Mimic>>,
    /// For each joint, its axis as a unit vector in the root link's axes.
    pub(super) axes: Vec<[f64; 3]>,
    /// For each link, its axes as columns, in the root link's axes.
    pub(super) rotations: Vec<Matrix>,
    /// For each link, its origin in the root link's frame \[m\].
    pub(super) places: Vec<[f64; 3]>,
    /// The greatest angle between an axis and the plane's normal at which they count as parallel \[rad\].
    pub(super) tolerance: f64,
}

impl ReferencePose {
    /// Creates the pose with the joints in `hold` frozen at these values. Returns an error if a joint appears twice or
    /// has no coordinate of its own, or if a value is not finite.
    pub(super) fn new(description: &Description, hold: &[(usize, f64)], tolerance: f64) -> Result<Self> {
        let joints = &description.joints;
        let mut frozen = vec![None; joints.len()];
        for &(index, value) in hold {
            check_index(index, ("joints", joints.len())).map_err(|error| error.at("hold"))?;
            let joint = &joints[index];
            refuse_no_coordinate(joint, joints)?;
            if frozen[index].replace(value).is_some() {
                return Err(joint.refuse(Reason::Duplicate { what: "frozen joint", name: joint.name.clone() }));
            }
            if !value.is_finite() {
                return Err(joint.refuse(Reason::NotFinite { what: "the value at which it is frozen".into(), value }));
            }
        }
        let mimicked = description.mimicked()?;
        for (index, mimicked) in mimicked.iter().enumerate() {
            if let &Some(Mimic { joint, multiplier, offset }) = mimicked {
                frozen[index] = frozen[joint].map(|value| multiplier * value + offset);
            }
        }
        let (axes, links) = (vec![[0.0; 3]; joints.len()], description.links.len());
        let (rotations, places) = (vec![Pose::default().rotation(); links], vec![[0.0; 3]; links]);
        let outward = description.outward(description.root);
        let mut pose = Self { outward, frozen, mimicked, axes, rotations, places, tolerance };
        pose.turn(description);
        Ok(pose)
    }

    /// Computes axes, rotations and places.
    fn turn(&mut self, description: &Description) {
        let Self { outward, frozen, axes, rotations, places, .. } = self;
        for &index in &*outward {
            let joint = &description.joints[index];
            let (parent, child) = (joint.parent, joint.child);
            let origin = product(&rotations[parent], &joint.origin.rotation());
            axes[index] = unit(apply(&origin, unit(joint.axis)));
            let moved = frozen[index].map(|value| moved(joint, value));
            rotations[child] = moved.map_or(origin, |(turn, _)| product(&origin, &turn));
            let shift = moved.map_or([0.0; 3], |(_, shift)| shift);
            let (to_joint, to_child) = (apply(&rotations[parent], joint.origin.xyz), apply(&origin, shift));
            places[child] = [0, 1, 2].map(|axis| places[parent][axis] + to_joint[axis] + to_child[axis]);
        }
    }

    /// Freezes mimic joints at their offset if their mimicked joint is frozen at zero. Returns whether there were any.
    ///
    /// This applies only if `stay(mimic joint, mimicked joint, turns)` is true. `turns` states whether the mimic joint
    /// is on the path from the root to the mimicked joint, and so rotates it.
    pub(super) fn follow(&mut self, description: &Description, stay: impl Fn(usize, usize, bool) -> bool) -> bool {
        let mut moved = false;
        for (index, mimicked) in self.mimicked.iter().enumerate() {
            let &Some(Mimic { joint, offset, .. }) = mimicked else { continue };
            let has_place = self.frozen[index].is_some() || offset == 0.0 || !description.joints[index].kind.has_axis();
            let inward = |&joint: &usize| description.links[description.joints[joint].parent].joint;
            let on_the_way = || std::iter::successors(Some(joint), inward).any(|before| before == index);
            if !has_place && stay(index, joint, on_the_way()) {
                self.frozen[index] = Some(offset);
                moved = true;
            }
        }
        if moved {
            self.turn(description);
        }
        moved
    }

    /// Returns for each joint whether it leads to one of the lowest links, in the root link's axes with z up.
    pub(super) fn legs(&self, description: &Description) -> Vec<bool> {
        let joints = &description.joints;
        let heights = || self.places.iter().map(|place| place[2]);
        let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let mut leads: Vec<bool> = heights().map(|height| height <= low + FOOT * (high - low)).collect();
        let mut legs = vec![false; joints.len()];
        for &index in self.outward.iter().rev() {
            legs[index] = leads[joints[index].child];
            leads[joints[index].parent] |= legs[index];
        }
        legs
    }
}

/// Returns rotation and displacement \[m\] of the child in the frame of its joint, which is frozen at `value`.
pub(super) fn moved(joint: &UrdfJoint, value: f64) -> (Matrix, [f64; 3]) {
    let (unmoved, axis) = (Pose::default().rotation(), unit(joint.axis));
    match joint.kind {
        JointKind::Revolute | JointKind::Continuous => (turn(axis, value), [0.0; 3]),
        JointKind::Prismatic => (unmoved, axis.map(|component| component * value)),
        _ => (unmoved, [0.0; 3]),
    }
}

fn refuse_no_coordinate(joint: &UrdfJoint, joints: &[UrdfJoint]) -> Result<()> {
    let (reason, hint) = match (joint.kind, &joint.mimic) {
        (_, Some(mimic)) => {
            let mimicked = &joints[mimic.joint].name;
            (format!("it cannot be frozen by itself: it follows joint \"{mimicked}\""), format!("hold {mimicked}"))
        }
        (JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic, None) => return Ok(()),
        (kind, None) => {
            (format!("it cannot be frozen at a value: it is {}", kind.name()), "leave it out of `hold`".into())
        }
    };
    Err(joint.refuse(Reason::Inconsistent(reason)).hint(hint))
}
