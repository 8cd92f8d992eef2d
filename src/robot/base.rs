//! Decides how the root is attached, after links on fixed and frozen joints are merged.
//!
//! ```text
//!     root massless, followed by a complete chain of x, z and pitch joints, or by a planar or floating joint
//!                                      -> this chain or joint is the floating base; the robot begins after it
//!     root massless, followed by a single joint or an incomplete chain (a rail), or else named `world`
//!                                      -> fixed to the world
//!     root with mass, or massless and followed by several joints
//!                                      -> floats
//! ```

use super::plane::PARALLEL;
use super::role::Role;
use super::{Axis, Base, FreezeReason};
use crate::description::{Description, UrdfJoint};

/// A link with at most this fraction of the robot's mass may be massless in reality: some programs require a mass.
const LIGHT: f64 = 1e-2;

/// The decision on how the root is attached.
pub(super) struct Judgment {
    pub(super) base: Base,
    /// The link of the file that is the root of the robot.
    pub(super) root: usize,
    /// The reason, worded to follow the root's name.
    pub(super) because: String,
    /// The joints that form the floating base, from the root on.
    pub(super) chain: Vec<usize>,
    /// Why the decision is doubtful, if it is.
    pub(super) caution: Option<String>,
}

/// Decides on the base, unless the user `asked` for one. Planar and floating joints that are not the base become
/// frozen.
pub(super) fn judge(description: &Description, outward: &[usize], roles: &mut [Role], asked: Option<Base>) -> Judgment {
    let root = description.root;
    let welded = Welded::new(description, outward, roles);
    let exit = welded.single_exit(root).filter(|&joint| roles[joint] == Role::Free && welded.is_massless(root, 0.0));
    let free = exit.filter(|_| asked != Some(Base::Fixed));
    let others = roles.iter_mut().enumerate().filter(|(index, role)| **role == Role::Free && Some(*index) != free);
    let mut frozen = 0;
    for (index, role) in others {
        *role = Role::Frozen(FreezeReason::Kind(description.joints[index].kind));
        frozen += 1;
    }
    if let Some(joint) = free {
        let UrdfJoint { kind, name, child, .. } = &description.joints[joint];
        let because = format!("{} joint \"{name}\" is the base itself", kind.name());
        return Judgment { base: Base::Floating, root: *child, because, chain: vec![joint], caution: None };
    }

    let welded = if frozen == 0 { welded } else { Welded::new(description, outward, roles) };
    let at_root = |base, because: String| Judgment { base, root, because, chain: Vec::new(), caution: None };
    if asked == Some(Base::Fixed) {
        return at_root(Base::Fixed, "as asked".into());
    }
    let names = |chain: [usize; 3]| chain.map(|joint| format!("\"{}\"", description.joints[joint].name)).join(", ");
    let light = || welded.is_massless(root, 0.0).then(|| welded.chain(description, roles, LIGHT * welded.total))?;
    if let Some(chain) = welded.chain(description, roles, 0.0).or_else(light) {
        let names = names(chain);
        let because = format!("the file's own chain of joints {names} is the base itself");
        let root = description.joints[chain[2]].child;
        let lost: f64 = chain[1..].iter().map(|&joint| welded.mass(description.joints[joint].parent)).sum();
        let caution = (lost > 0.0).then(|| {
            format!(
                "the links of the base's own chain ({names}) weigh {lost} kg, which is left out: give `base: fixed` to keep \
                 the chain and its mass"
            )
        });
        return Judgment { base: Base::Floating, root, because, chain: chain.into(), caution };
    }
    let massless = welded.mass(root) == 0.0;
    match welded.single_exit(root) {
        _ if asked == Some(Base::Floating) => at_root(Base::Floating, "as asked".into()),
        Some(joint) if massless => {
            let name = &description.joints[joint].name;
            at_root(Base::Fixed, format!("the root is massless and joint \"{name}\" alone carries the robot"))
        }
        _ if description.links[root].name == "world" => at_root(Base::Fixed, "the root is named world".into()),
        None if massless => at_root(Base::Floating, "the root is massless, but several joints carry the robot".into()),
        _ => {
            let caution = welded.chain(description, roles, LIGHT * welded.total).map(|chain| {
                format!(
                    "the root floats because it has mass, over a chain of its own ({}) whose links weigh next to nothing: \
                     set their mass to 0 to take the chain as the base, or give `base: fixed`",
                    names(chain)
                )
            });
            let has_mass = description.links[root].inertial.as_ref().is_some_and(|inertial| inertial.mass > 0.0);
            let because = if has_mass { "the root has mass" } else { "what is fixed to the root has mass" };
            Judgment { caution, ..at_root(Base::Floating, because.into()) }
        }
    }
}

/// Links of the file in groups that no moving joint separates.
struct Welded {
    group: Vec<usize>,
    masses: Vec<f64>,
    /// For each group, the number of moving joints that have their parent in it, and the last of these joints.
    exits: Vec<(usize, usize)>,
    world: Option<usize>,
    total: f64,
}

impl Welded {
    fn new(description: &Description, outward: &[usize], roles: &[Role]) -> Self {
        let Description { links, root, .. } = description;
        let mass = |link: usize| links[link].inertial.as_ref().map_or(0.0, |inertial| inertial.mass);
        let mut group = vec![0; links.len()];
        let (mut masses, mut exits) = (vec![mass(*root)], vec![(0, 0)]);
        for &index in outward {
            let joint = &description.joints[index];
            let parent = group[joint.parent];
            if let Role::Frozen(_) = roles[index] {
                group[joint.child] = parent;
                masses[parent] += mass(joint.child);
            } else {
                exits[parent] = (exits[parent].0 + 1, index);
                group[joint.child] = masses.len();
                masses.push(mass(joint.child));
                exits.push((0, 0));
            }
        }
        let total = masses.iter().sum();
        let world = (links[*root].name == "world").then_some(*root);
        Self { group, masses, exits, world, total }
    }

    fn mass(&self, link: usize) -> f64 {
        self.masses[self.group[link]]
    }

    /// Returns whether the group of `link` has at most the mass `light`. The group of the world counts as massless.
    fn is_massless(&self, link: usize, light: f64) -> bool {
        self.mass(link) <= light || self.world.is_some_and(|world| self.group[world] == self.group[link])
    }

    fn single_exit(&self, link: usize) -> Option<usize> {
        let (count, joint) = self.exits[self.group[link]];
        (count == 1).then_some(joint)
    }

    /// Returns three consecutive joints, from the root on, that let their descendants move freely in the plane; `None`
    /// if there are none, or if the links that carry them weigh more than `light`.
    fn chain(&self, description: &Description, roles: &[Role], light: f64) -> Option<[usize; 3]> {
        let mut link = description.root;
        let mut chain = [0; 3];
        let mut slides = Vec::new();
        for joint in &mut chain {
            *joint = self.single_exit(link).filter(|_| self.is_massless(link, light))?;
            let mimics =
                |role: &Role| matches!(role, Role::Moves { mimicked: Some(mimicked), .. } if mimicked.joint == *joint);
            match roles[*joint] {
                Role::Moves { mimicked: None, .. } if roles.iter().any(mimics) => return None,
                Role::Moves { axis: Axis::Revolute { .. }, mimicked: None, .. } => {}
                Role::Moves { axis: Axis::Prismatic { direction }, mimicked: None, .. } => slides.push(direction),
                _ => return None,
            }
            link = description.joints[*joint].child;
        }
        // Two of the three joints are prismatic, so one is revolute.
        let [a, b] = slides[..] else { return None };
        ((a.x * b.z - a.z * b.x).abs() > PARALLEL).then_some(chain)
    }
}
