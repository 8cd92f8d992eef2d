//! Cautions: facts that a user must know before trusting a reduced robot, each with a remedy.

use super::composite::is_physical;
use super::plane::{OBLIQUE, Plane};
use super::reading::{FreezeReason, FrozenJoint};
use super::reference_pose::ReferencePose;
use super::role::Role;
use super::{Axis, Base, Body, ParentJoint, Robot};
use crate::description::{
    Collision, Description, FOREIGN_JOINTS, Geometry, Inertial, JointKind, Matrix, Mesh, Mimic, Pose, UrdfJoint,
    UrdfLink, apply, turn,
};
use crate::error::{rounded, shortest_within};
use crate::planar::Vector;
use std::f64::consts::TAU;

/// An axis that is off the normal by at most this angle \[rad\] may have been meant to be parallel to it.
const NEARLY: f64 = 0.35;
/// An axis that is off by at most this angle was rounded in the file \[rad\].
const SLIGHTLY: f64 = 0.02;
/// Upper bound on the length of any part of a legged robot \[m\].
pub(crate) const LONGEST: f64 = 10.0;
/// Mass of a steel ball with a radius of 1 m \[kg\]: an upper bound.
const DENSEST: f64 = 33_000.0;
/// A radius of gyration is at most this many times the size of the robot.
const WIDEST: f64 = 2.0;
/// An inertia below this fraction of the robot's mass times its squared size does not matter, nor does a mass below
/// this fraction of the robot's mass: it belongs to a dummy link.
const SLIGHT: f64 = 1e-3;
/// A moment below this fraction of the link's largest moment is a rounding error of rotations.
const ROUNDED: f64 = 1e-9;
/// A link of a planar model with a smaller radius of gyration counts as a point \[m\].
const POINT: f64 = 1e-4;
/// Upper bound on the density of materials \[kg/m^3\].
const HEAVIEST: f64 = 23_000.0;
/// Lower bound on the size of a mesh \[m\].
const SMALLEST: f64 = 1e-3;
/// Limits count as containing zero if they miss it by at most this \[rad or m\].
const AT_ZERO: f64 = 0.02;
/// Largest number of hinges for which it is checked whether holding them aligns an axis.
const TRIED: usize = 3;
/// Largest number of joints or links that a caution names.
const NAMED: usize = 3;
/// Largest number of remedies for tilted axes that a caution names: one per leg.
const MOST_REMEDIES: usize = 8;

/// The description with its reference pose and plane.
pub(super) struct Seen<'a> {
    pub(super) description: &'a Description,
    pub(super) pose: &'a ReferencePose,
    pub(super) plane: Plane,
    /// For each joint, whether it leads to one of the lowest links.
    pub(super) legs: &'a [bool],
}

impl Seen<'_> {
    /// Returns the joints between a joint and the root, the nearest first.
    fn before(&self, joint: usize) -> impl Iterator<Item = usize> {
        let link = |joint: usize| self.description.links[self.description.joints[joint].parent].joint;
        std::iter::successors(link(joint), move |&joint| link(joint))
    }

    /// Returns the angle of a joint's `axis` to the plane's normal, or to the plane for a prismatic joint \[rad\].
    fn off(&self, joint: usize, axis: [f64; 3]) -> f64 {
        match self.description.joints[joint].kind {
            JointKind::Prismatic => self.plane.off_plane(axis),
            _ => self.plane.off_normal(axis),
        }
    }
}

/// Returns the cautions about frozen joints, each given with its index in the file. `kept` joints remain movable.
pub(super) fn about_frozen(seen: &Seen, frozen: &[(usize, FrozenJoint)], kept: usize) -> Vec<String> {
    use FreezeReason::{Asked, Base, Fixed, Kind, OffPlane};
    let with = |wanted: fn(&FreezeReason) -> bool| frozen.iter().filter(move |(_, joint)| wanted(&joint.reason));
    let movable: Vec<_> = with(|reason| !matches!(reason, Fixed | Asked { .. } | Base)).collect();
    let off = |joint: &FrozenJoint, most: f64| matches!(joint.reason, OffPlane { angle, .. } if angle <= most);
    let many = frozen.iter().filter(|(_, joint)| off(joint, NEARLY)).count() >= kept;
    let tilted = |&&(index, ref joint): &&(usize, FrozenJoint)| {
        many && off(joint, NEARLY) || seen.legs[index] && off(joint, OBLIQUE)
    };
    let nearly: Vec<_> = frozen.iter().filter(tilted).collect();
    let hidden: Vec<_> = with(|reason| matches!(reason, Kind(_))).collect();

    let mut cautions = Vec::new();
    if !nearly.is_empty() {
        let mut stays = vec![true; seen.description.joints.len()];
        frozen.iter().for_each(|&(joint, _)| stays[joint] = false);
        nearly.iter().for_each(|&&(joint, _)| stays[joint] = true);
        cautions.push(about_tilted(seen, &nearly, (movable.len() + kept, &stays)));
    } else if kept == 0 && movable.len() > hidden.len() {
        cautions.extend(naming(
            movable.iter().map(|(_, joint)| &joint.name),
            "no joint moves in this plane, so the robot is one rigid body ({} frozen): choose another plane (`plane`), or \
             hold joints where the axes of others are in line (`hold: NAME=VALUE`)",
        ));
    }
    cautions.extend(naming(
        hidden.iter().map(|(_, joint)| &joint.name),
        "able to move in the plane but frozen, having no single axis: {}; give revolute and prismatic joints instead",
    ));
    cautions
}

/// Returns the cautions about the file, whose joints have these `roles`. The links `outside` belong to the base.
pub(super) fn about_file(
    seen: &Seen,
    roles: &[Role],
    frozen: &[(usize, FrozenJoint)],
    outside: &[&UrdfLink],
) -> Vec<String> {
    let &Seen { description, pose, plane, .. } = seen;
    let Description { links, joints, ignored, misspelt, rotors, guessed, root, .. } = description;
    let moves = |joint: usize| matches!(roles[joint], Role::Moves { .. });
    let followers = pose.mimicked.iter().enumerate().filter_map(|(index, mimicked)| {
        let followed = mimicked.as_ref()?.joint;
        let is_off = matches!(roles[index], Role::Frozen(FreezeReason::OffPlane { .. }));
        (is_off && moves(followed)).then(|| format!("{} follows {}", joints[index].name, joints[followed].name))
    });
    // Shapes of the root itself belong to the ground or the rail.
    let touching = outside.iter().filter(|link| link.name != links[*root].name && !link.collisions.is_empty());
    let driven = joints.iter().enumerate().filter(|&(index, joint)| moves(index) && rotors.contains(&joint.name));
    let closing = ignored.iter().filter(|element| closes_loops(element.parent, &element.tag));
    let without_axis = joints.iter().filter(|joint| joint.kind.has_axis() && !joint.has_axis);
    let off = joints.iter().zip(&pose.axes).filter(|(joint, axis)| {
        let is_off = |angle| angle > pose.tolerance && angle <= OBLIQUE;
        joint.kind == JointKind::Planar && joint.has_axis && is_off(plane.off_normal(**axis))
    });
    // Multiples of 0.5 up to 360, at least one of 30 or more.
    let in_degrees = |limit: &f64| (2.0 * limit).fract() == 0.0 && limit.abs() <= 360.0;
    let limited = joints.iter().filter(|joint| {
        let limits = joint.limits.filter(|_| joint.kind == JointKind::Revolute);
        limits.is_some_and(|limits| limits.iter().all(in_degrees) && limits.iter().any(|limit| limit.abs() >= 30.0))
    });

    let mut cautions: Vec<String> = about_held(description, frozen).collect();
    cautions.extend(naming(
        followers,
        "frozen at zero although what they follow moves, their axes being off the plane: {}; to keep both where they \
         belong, hold what is followed (`hold: NAME=VALUE`)",
    ));
    cautions.extend(naming(
        touching.map(|link| &link.name),
        "part of the base, so that its collision shapes are left out: {}; if it is a foot, name one on another link \
         (`feet: LINK:X,Y,Z`)",
    ));
    cautions.extend(about_shapes(description));
    cautions.extend(naming(
        guessed,
        "packages of meshes whose folder is guessed by the path of a file: {}; if it is another, name the right one by \
         `package_path`",
    ));
    cautions.extend(naming(misspelt, "not read, and perhaps misspelt: {}"));
    cautions.extend(naming(
        driven.map(|(_, joint)| &joint.name),
        "rotor inertia of the file is not read ({}): give it times the gear ratio squared, by `rotor_inertia` in each \
         state",
    ));
    cautions.extend(naming(
        closing.map(|element| &element.tag),
        "what closes loops in the file is left out ({}): close them by `loops` in each state",
    ));
    // Without a joint from the world to the root the tree is still complete, so no error reports these.
    cautions.extend(description.has_foreign_joints().then(|| FOREIGN_JOINTS.to_owned()));
    cautions.extend(naming(
        without_axis.map(|joint| format!("{} on line {}", joint.name, joint.location.line)),
        "without an <axis>, and so about or along x: {}; name the axis, as in <axis xyz=\"0 1 0\"/>",
    ));
    cautions.extend(naming(
        off.map(|(joint, _)| &joint.name),
        "planar, with an axis off the plane's normal, and taken as in the plane: {}; straighten the axis",
    ));
    cautions.extend(about_lengths(description));
    cautions.extend(about_angles(description));
    let limited = limited.map(|joint| &joint.name);
    cautions.extend(naming(limited, "with limits as in degrees: {}; angles are in radians"));
    cautions
}

/// Returns whether an element with this tag closes a loop in an extension of URDF.
pub(super) fn closes_loops(parent: &str, tag: &str) -> bool {
    parent == "robot" && matches!(tag, "loop" | "loop_joint" | "linear_bushing_rpy")
}

/// Returns the cautions about lengths that no legged robot has, for example millimeters taken for meters or vice versa.
fn about_lengths(description: &Description) -> Vec<String> {
    const SHAPE: &str = "a shape of";
    let span = |points: &[[f64; 3]], at: usize| {
        let along = points.iter().map(|point| point[at]);
        along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
    };
    let extent = |geometry: &Geometry| match geometry {
        Geometry::Box { size } => size.iter().copied().fold(0.0, f64::max),
        Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => length.max(2.0 * radius),
        Geometry::Sphere { radius } => 2.0 * radius,
        Geometry::Mesh { scale, mesh: Mesh::Vertices(points), .. } => {
            [0, 1, 2].map(|at| span(points, at) * scale[at].abs()).into_iter().fold(0.0, f64::max)
        }
        Geometry::Mesh { .. } | Geometry::Unknown { .. } => 0.0,
    };
    let reach = |origin: &Pose| origin.xyz.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let of_links = description.links.iter().flat_map(|link| {
        let inertial =
            link.inertial.iter().map(|inertial| ("the origin of the inertial of", &link.name, reach(&inertial.origin)));
        let shapes = link.collisions.iter().flat_map(|Collision { origin, geometry }| {
            [("the origin of a shape of", &link.name, reach(origin)), (SHAPE, &link.name, extent(geometry))]
        });
        inertial.chain(shapes)
    });
    let joints = description.joints.iter().map(|joint| ("the origin of", &joint.name, reach(&joint.origin)));
    let longest = joints.chain(of_links).max_by(|a, b| a.2.total_cmp(&b.2)).filter(|(.., length)| *length > LONGEST);
    let large = longest.map(|(what, name, length)| {
        let length = rounded(length);
        let length = if what == SHAPE { format!("spans {length} m") } else { format!("is {length} m away") };
        format!(
            "{what} {name} {length}: lengths are in meters; scale=\"0.001 0.001 0.001\" is for meshes in \
             millimeters"
        )
    });
    let meshes = description.links.iter().flat_map(|link| {
        let is_scaled = |collision: &&Collision| match collision.geometry {
            Geometry::Mesh { scale, .. } => scale.iter().all(|scale| scale.abs() < 0.1),
            _ => false,
        };
        let meshes = link.collisions.iter().filter(is_scaled);
        meshes.map(|collision| (&link.name, extent(&collision.geometry))).filter(|&(_, extent)| extent > 0.0)
    });
    let smallest = meshes.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|&(_, extent)| extent < SMALLEST);
    let small = smallest.map(|(name, extent)| {
        let extent = rounded(extent);
        format!("a mesh of {name} spans {extent} m: lengths are in meters; a mesh in meters needs no scale")
    });
    large.into_iter().chain(small).collect()
}

/// Returns the caution about a mass \[kg\] too large for the robot's size \[m\], as grams taken for kilograms are.
pub(super) fn about_mass(mass: f64, size: f64) -> Option<String> {
    (mass > DENSEST * size * size * size).then(|| {
        let [mass, size] = [mass, size].map(rounded);
        format!(
            "the robot weighs {mass} kg, more than a ball of steel around all of it (radius {size} m): masses are in kg"
        )
    })
}

/// Returns the cautions about joints held or frozen at zero beyond their limits, for example in degrees.
fn about_held(description: &Description, frozen: &[(usize, FrozenJoint)]) -> impl Iterator<Item = String> {
    let (mut held, mut at_zero) = (Vec::new(), Vec::new());
    for (index, joint) in frozen {
        let UrdfJoint { kind, limits, .. } = &description.joints[*index];
        let name = &joint.name;
        match (&joint.reason, limits) {
            (&FreezeReason::Asked { value }, &Some([lower, upper])) if value < lower || value > upper => {
                held.push(format!("{name} = {value} is outside [{lower}, {upper}]"));
            }
            (&FreezeReason::Asked { value }, None) if *kind != JointKind::Prismatic && value.abs() > TAU => {
                held.push(format!("{name} = {value} rad is more than a turn"));
            }
            (FreezeReason::OffPlane { .. }, &Some([lower, upper])) if lower > AT_ZERO || upper < -AT_ZERO => {
                at_zero.push(format!("{name} in [{lower}, {upper}]"));
            }
            _ => {}
        }
    }
    let held = naming(held, "held beyond limits, or in degrees: {}");
    held.into_iter().chain(naming(
        at_zero,
        "frozen at zero, which is beyond their limits: {}; give values (`hold: NAME=VALUE`), which may turn joints \
         beyond them out of the plane",
    ))
}

/// Returns the caution about rotations by more than a full turn, for example degrees taken for radians.
fn about_angles(description: &Description) -> Option<String> {
    let of_links = description.links.iter().flat_map(|link| {
        let inertial = link.inertial.iter().map(|inertial| &inertial.origin);
        let collisions = link.collisions.iter().map(|collision| &collision.origin);
        inertial.chain(collisions).map(|origin| (&link.name, origin.rpy))
    });
    let of_joints = description.joints.iter().map(|joint| (&joint.name, joint.origin.rpy));
    // A full turn may be rounded.
    let is_wide = |angle: &f64| angle.abs() > 1.001 * TAU;
    let (name, [roll, pitch, yaw]) = of_joints.chain(of_links).find(|(_, rpy)| rpy.iter().any(is_wide))?;
    Some(format!(
        "the rpy of {name}, \"{roll} {pitch} {yaw}\", is more than a turn: angles are in radians, and 90 degrees are \
         1.5708"
    ))
}

/// Returns the cautions about incomplete or wrong inertias. Each link has its moment about the plane's normal \[kg
/// m^2\]; the robot has the mass `whole` \[kg\] and the `size` \[m\].
pub(super) fn about_inertias<'l>(
    links: impl Iterator<Item = (&'l UrdfLink, f64)>,
    (whole, size): (f64, f64),
) -> Vec<String> {
    let kinds = [
        ("with a mass but no <inertia>, and so a point mass", "give its moments, as in <inertia ixx=\"0.1\" .../>"),
        ("with an inertia but no mass", "give the mass in kg, or leave out the <inertia>"),
        ("with an inertia that needs a part far beyond the robot's size", "inertia is in kg m^2, mass in kg"),
        ("with an inertia that no body has, one moment being more than the other two together", "correct it"),
        ("with a single moment of inertia, which is not about the plane's normal", "only that about the normal counts"),
        ("with more mass than the densest metal has in a ball of this inertia", "inertia is in kg m^2, mass in kg"),
    ];
    // A single moment may be that of a long body about its length, and is then smaller than that of a ball.
    let least = |mass: f64, is_planar: bool| if is_planar { POINT * POINT * mass } else { of_ball(mass) };
    let mut found = kinds.map(|_| Vec::new());
    for (link, moment) in links {
        let Some(Inertial { mass, inertia, .. }) = &link.inertial else { continue };
        let moments = inertia.map(|inertia| [inertia[0][0], inertia[1][1], inertia[2][2]]).unwrap_or_default();
        let largest = moments.into_iter().fold(0.0, f64::max);
        // Planar models give only one moment.
        let is_planar = largest > 0.0 && moments.iter().filter(|&&moment| moment == 0.0).count() == 2;
        let kind = match inertia {
            None if *mass > 0.0 => 0,
            Some(_) if *mass == 0.0 && largest > 0.0 => 1,
            Some(_) if largest > size * size * (WIDEST * WIDEST * mass).max(SLIGHT * whole) => 2,
            Some(inertia) if !is_planar && !is_physical(inertia) => 3,
            Some(_) if is_planar && moment < ROUNDED * largest => 4,
            Some(_) if *mass > SLIGHT * whole && largest > 0.0 && largest < least(*mass, is_planar) => 5,
            _ => continue,
        };
        found[kind].push(link.name.as_str());
    }
    let found = found.into_iter().zip(kinds);
    found.filter_map(|(links, (what, remedy))| Some(format!("{what}: {}; {remedy}", names(links)?))).collect()
}

/// Returns the moment of the densest ball of this mass \[kg, kg m^2\]: a bound on any body's largest moment.
fn of_ball(mass: f64) -> f64 {
    let radius = libm::cbrt(mass / (2.0 / 3.0 * TAU * HEAVIEST));
    0.4 * mass * radius * radius
}

/// Returns the cautions about bodies without mass that a joint moves, if they extend from joint to joint, touch the
/// ground or carry no mass; and about joints whose motion nothing resists in any state: M is singular.
pub(super) fn about_massless(robot: &Robot) -> Vec<String> {
    let weighs_nothing = |body: &Body| body.mass == 0.0 && body.moment == 0.0;
    // For each rigid body: whether it extends from joint to joint or touches the ground, and whether any part has mass.
    let rigid: Vec<usize> = (0..robot.bodies.len()).map(|body| robot.rigid_body(body)).collect();
    let [mut has_length, mut weighs] = [vec![false; rigid.len()], vec![false; rigid.len()]];
    // `carries` is like `weighs`, but includes all bodies that the body carries. `resists` states whether any of them
    // resists the body's own motion. Bodies behind a joint with the same axis do not, because that joint can turn back.
    let [mut carries, mut resists] = [vec![false; rigid.len()], vec![false; rigid.len()]];
    // A mimic joint that follows this joint may move a mass.
    let is_alone = |joint: usize| !robot.mimic_joints.iter().any(|mimic| mimic.mimicked == joint);
    let hinge = |body: &Body| body.joint.map(|mover| robot.hinge(mover));
    // The root can rotate about any point. This is its center of gravity or, if it has no mass, its first joint.
    let first = robot.bodies.iter().filter_map(hinge).find(|(parent, ..)| *parent == 0 && robot.bodies[0].mass == 0.0);
    let pivot = first.map_or(robot.bodies[0].com, |(_, origin, _)| origin);
    let motion = |body: usize| match hinge(&robot.bodies[body]) {
        Some((.., motion)) => (motion, Vector::zero()),
        None => (Some(Axis::Revolute { sign: 1.0 }), pivot),
    };
    for (index, body) in robot.bodies.iter().enumerate().rev() {
        weighs[rigid[index]] |= !weighs_nothing(body);
        carries[index] |= !weighs_nothing(body);
        resists[index] |= match motion(index) {
            (Some(Axis::Prismatic { .. }), _) => body.mass > 0.0,
            (_, center) => body.moment > 0.0 || body.mass > 0.0 && body.com != center,
        };
        if let Some((parent, origin, axis)) = hinge(body) {
            let yields = match (axis, motion(parent)) {
                (Some(Axis::Revolute { .. }), (Some(Axis::Revolute { .. }), center)) => origin == center,
                (Some(Axis::Prismatic { direction }), (Some(Axis::Prismatic { direction: other }), _)) => {
                    direction.x * other.z == direction.z * other.x
                }
                _ => false,
            };
            let yields = yields && matches!(body.joint, Some(ParentJoint::Joint(joint)) if is_alone(joint));
            resists[parent] |= carries[index] && !yields;
            carries[parent] |= carries[index];
            has_length[rigid[parent]] |= axis.is_some() && origin.length() > 0.0;
        }
    }
    robot.links.iter().for_each(|link| has_length[rigid[link.body]] |= !link.shapes.is_empty());
    let is_massless = |&(index, body): &(usize, &Body)| match body.joint {
        _ if weighs[index] => false,
        Some(ParentJoint::Joint(joint)) => has_length[index] || !carries[index] && is_alone(joint),
        Some(ParentJoint::Mimic(_)) => has_length[index],
        Some(ParentJoint::Fixed { .. }) | None => false,
    };
    let (massless, others): (Vec<_>, Vec<_>) = robot.bodies.iter().enumerate().partition(is_massless);
    let unresisted =
        others.into_iter().filter(|(index, _)| !resists[*index]).filter_map(|(_, body)| match body.joint {
            Some(ParentJoint::Joint(joint)) if is_alone(joint) => Some(robot.joints[joint].name.as_str()),
            None if robot.base == Base::Floating => Some("the base's pitch"),
            _ => None,
        });
    let massless = naming(
        massless.iter().map(|(_, body)| &body.name),
        "without mass, although a joint of its own moves it: {}; give it an <inertial>, or name the joint in `held`",
    );
    let unresisted = naming(
        unresisted,
        "nothing resists a motion of {} in any state: give what it moves a mass off its axis or a moment of inertia, or \
         name the joint in `held`",
    );
    massless.into_iter().chain(unresisted).collect()
}

/// Returns the cautions about collision meshes that could not be read, and about shapes that URDF does not have.
fn about_shapes(description: &Description) -> impl Iterator<Item = String> {
    let (mut meshes, mut unknown) = (Vec::new(), Vec::new());
    for link in &description.links {
        for collision in &link.collisions {
            match &collision.geometry {
                Geometry::Mesh { file, mesh: Mesh::LeftOut { why }, .. } => {
                    meshes.push(format!("{file} of {}: {why}", link.name));
                }
                Geometry::Unknown { tag } => unknown.push(format!("<{tag}> of {}", link.name)),
                _ => {}
            }
        }
    }
    let kinds = [("mesh", "meshes", meshes, "give the file"), ("shape", "shapes", unknown, "give a shape of URDF")];
    kinds.into_iter().filter_map(|(one, many, left_out, remedy)| {
        let first = left_out.first()?;
        let count = left_out.len();
        let (what, more) = if count == 1 { (format!("{one} is"), "") } else { (format!("{many} are"), ", and others") };
        Some(format!(
            "{count} collision {what} left out, so that nothing touches there ({first}{more}): {remedy}, or name a foot by \
             `feet: LINK:X,Y,Z`"
        ))
    })
}

/// Returns the caution about nearly aligned frozen joints, of `all` that could move; `stays` marks those kept then.
fn about_tilted(seen: &Seen, nearly: &[&(usize, FrozenJoint)], (all, stays): (usize, &[bool])) -> String {
    let angles = nearly.iter().filter_map(|(_, joint)| match joint.reason {
        FreezeReason::OffPlane { angle, .. } => Some(angle),
        _ => None,
    });
    let degrees = |angle: f64| format!("{:.*}", if angle <= SLIGHTLY { 3 } else { 1 }, angle.to_degrees());
    let greatest = angles.clone().fold(0.0, f64::max);
    let (least, most) = (degrees(angles.clone().fold(f64::INFINITY, f64::min)), degrees(greatest));
    let range = if least == most { most } else { format!("{least} to {most}") };
    let slightly = angles.filter(|&angle| angle <= SLIGHTLY).fold(0.0, f64::max);
    let mut remedies: Vec<Remedy> = Vec::new();
    // A prismatic joint has no remedy of its own, but one for a hinge before it may serve it too. So hinges come first.
    let slides = |joint: usize| seen.description.joints[joint].kind == JointKind::Prismatic;
    let joints = nearly.iter().map(|(joint, _)| *joint);
    for joint in joints.clone().filter(|&joint| !slides(joint)).chain(joints.filter(|&joint| slides(joint))) {
        let is_held = |hinge| remedies.iter().any(|(kind, of, _)| (*kind, *of) == ("hold", hinge));
        let remedy = if seen.off(joint, seen.pose.axes[joint]) <= SLIGHTLY {
            ("axis_tolerance", 0, format!("`axis_tolerance: {:.1e}`", 1.1 * slightly))
        } else if seen.before(joint).any(is_held) {
            // That remedy serves this joint too.
            continue;
        } else {
            remedy(seen, joint, (stays, greatest))
        };
        // One remedy per joint, because a hinge has one value.
        if !remedies.iter().any(|(kind, of, _)| (*kind, *of) == (remedy.0, remedy.1)) {
            remedies.push(remedy);
        }
    }
    let [are, their_axes_are, them] = match nearly.len() {
        1 => ["is", "its axis is", "it"],
        _ => ["are", "their axes are", "them"],
    };
    format!(
        "{} of {all} joints that could move {are} frozen only because {their_axes_are} {range} degrees off the plane ({}); to \
         keep {them}: {}",
        nearly.len(),
        names(nearly.iter().map(|(_, joint)| &joint.name)).unwrap_or_default(),
        first(remedies.into_iter().map(|(.., words)| words), MOST_REMEDIES).unwrap_or_default(),
    )
}

/// A remedy that keeps a joint with a tilted axis: the setting, the joint that it applies to, and the text.
type Remedy = (&'static str, usize, String);

/// Returns the remedy that aligns the axis of a joint: holding a frozen hinge before it, if this aligns all joints
/// beyond that `stays` marks, or else correcting the joint whose origin or pose tilts it. `greatest` is the greatest
/// angle off the plane \[rad\].
fn remedy(seen: &Seen, joint: usize, (stays, greatest): (&[bool], f64)) -> Remedy {
    let Seen { description, pose, plane, .. } = seen;
    let axis = pose.axes[joint];
    let turned = seen.before(joint).filter(|&before| {
        let kind = description.joints[before].kind;
        let mimics = |(index, mimicked): (usize, &Option<Mimic>)| {
            mimicked.as_ref().is_some_and(|mimicked| index == before || mimicked.joint == before)
        };
        // A hinge that is nearly in line should itself be kept.
        matches!(kind, JointKind::Revolute | JointKind::Continuous)
            && description.joints[joint].kind != JointKind::Prismatic
            && pose.frozen[before].is_none()
            && plane.off_normal(pose.axes[before]) > OBLIQUE
            && !pose.mimicked.iter().enumerate().any(mimics)
    });
    let into_line = |hinge: usize| angle_into_line(axis, pose.axes[hinge], *plane, pose.tolerance);
    let turned = turned.filter_map(|hinge| Some((hinge, into_line(hinge)?))).filter(|&(hinge, angle)| {
        let limits = description.joints[hinge].limits;
        limits.is_none_or(|[lower, upper]| (lower..=upper).contains(&angle))
    });
    if let Some((hinge, angle)) = turned.take(TRIED).find(|&turn| aligns_all(seen, turn, stays)) {
        return ("hold", hinge, format!("`hold: {}={angle:.6}`", description.joints[hinge].name));
    }
    let in_line = |axes: &Matrix| {
        let columns = [0, 1, 2].map(|column| axes.map(|row| row[column]));
        columns.into_iter().any(|column| plane.off_normal(column) <= pose.tolerance)
    };
    let tilts = |at: &usize| {
        let joint = &description.joints[*at];
        in_line(&pose.rotations[joint.parent]) && !in_line(&pose.rotations[joint.child])
    };
    // If joints beyond are aligned again, only this axis is off.
    let is_undone = |tilted: &usize| {
        let beyond = description.outward(description.joints[*tilted].child);
        beyond.into_iter().any(|other| stays[other] && pose.frozen[other].is_none() && is_in_line(seen, other))
    };
    let tilted = std::iter::once(joint).chain(seen.before(joint)).find(tilts);
    let described = &description.joints[joint];
    match tilted {
        Some(posed) if pose.frozen[posed].is_some_and(|value| value != 0.0) => {
            let name = &description.joints[posed].name;
            let tolerance = format!("`axis_tolerance: {:.1e}`", 1.1 * greatest);
            (
                "pose",
                0,
                format!("leave {name} and the like at zero, or take what they tilt as in the plane by {tolerance}"),
            )
        }
        Some(tilted) if is_undone(&tilted) && described.kind != JointKind::Prismatic => {
            let [_, normal, _] = plane.axes();
            let sign = f64::copysign(1.0, dot(axis, normal));
            let rotation = pose.rotations[described.child];
            let along =
                [0, 1, 2].map(|at| shortest_within(sign * dot(rotation.map(|row| row[at]), normal), 5e-7) + 0.0);
            (
                "axis",
                joint,
                format!("give {} the axis \"{}\"", described.name, along.map(|entry| entry.to_string()).join(" ")),
            )
        }
        Some(tilted) => ("rpy", tilted, format!("straighten the rpy of {}", description.joints[tilted].name)),
        None => ("axis", joint, format!("straighten the axis of {}", described.name)),
    }
}

/// Returns whether a kept joint needs no remedy.
fn is_in_line(seen: &Seen, joint: usize) -> bool {
    seen.description.joints[joint].kind.has_axis() && seen.off(joint, seen.pose.axes[joint]) <= seen.pose.tolerance
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns whether this rotation of a hinge aligns all joints beyond it that `stays` marks, up to the file's digits.
fn aligns_all(seen: &Seen, (hinge, angle): (usize, f64), stays: &[bool]) -> bool {
    let Seen { description, pose, .. } = seen;
    let turned = turn(pose.axes[hinge], angle);
    description.outward(description.joints[hinge].child).into_iter().filter(|&joint| stays[joint]).all(|joint| {
        let before = seen.off(joint, pose.axes[joint]);
        let most = if before <= SLIGHTLY { before.max(pose.tolerance) } else { pose.tolerance };
        !description.joints[joint].kind.has_axis() || seen.off(joint, apply(&turned, pose.axes[joint])) <= most
    })
}

/// Returns the angle \[rad\] by which a rotation about `hinge` aligns `axis`, both of length 1, with the plane's
/// normal; `None` if none does.
fn angle_into_line(axis: [f64; 3], hinge: [f64; 3], plane: Plane, tolerance: f64) -> Option<f64> {
    let [_, normal, _] = plane.axes();
    let cross =
        |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    let aim = if dot(axis, normal) < 0.0 { normal.map(|entry| -entry) } else { normal };
    // The components of both vectors across the hinge.
    let across = |vector: [f64; 3]| [0, 1, 2].map(|k| vector[k] - dot(vector, hinge) * hinge[k]);
    let (from, to) = (across(axis), across(aim));
    let angle = libm::atan2(dot(cross(from, to), hinge), dot(from, to));
    (plane.off_normal(apply(&turn(hinge, angle), axis)) <= tolerance).then_some(angle)
}

/// Returns `text` with the [`names`] in place of `{}`; `None` if there are none.
fn naming<S: AsRef<str>>(listed: impl IntoIterator<Item = S>, text: &str) -> Option<String> {
    names(listed).map(|names| text.replace("{}", &names))
}

/// Returns the first [`NAMED`] names and the number of others; `None` if there are none.
fn names<S: AsRef<str>>(names: impl IntoIterator<Item = S>) -> Option<String> {
    first(names, NAMED)
}

/// Returns the first `most` names and the number of others; `None` if there are none.
fn first<S: AsRef<str>>(names: impl IntoIterator<Item = S>, most: usize) -> Option<String> {
    let mut names = names.into_iter();
    let mut first: Vec<String> = names.by_ref().take(most).map(|name| name.as_ref().to_owned()).collect();
    first.extend(Some(names.count()).filter(|&more| more > 0).map(|more| format!("{more} more")));
    (!first.is_empty()).then(|| first.join(", "))
}
