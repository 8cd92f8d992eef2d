//! Description -> robot: places the tree at zero, projects it into its plane, and welds joints that leave the plane.

use super::composite::{LinkInertia, composites};
use super::left_out::passed_over;
use super::outline::outline;
use super::plane::{OBLIQUE, PARALLEL, PARALLEL_SHAPE, Plane};
use super::reading::{FreezeReason, FrozenJoint, PlaneReason, Reading};
use super::reference_pose::ReferencePose;
use super::role::{self, Role, roles};
use super::tree::{Place, Tree};
use super::{Base, LeftOutPart, Link, ParentJoint, Robot, base, caution};
use crate::description::{self, Description, Inertial, JointKind, UrdfLink, product};
use crate::error::{Error, Reason, Result, finite};
use crate::reductions::Reductions;

/// Options of the reduction. Plane and base are found automatically if they are not given.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reduction {
    /// The plane; by default it is found from the axes of the joints.
    pub plane: Option<Plane>,
    /// Joints (indices into [`Description::joints`]) that are welded at these values \[rad or m\]. Axes are tested in
    /// this pose.
    pub hold: Vec<(usize, f64)>,
    /// Whether the base floats; by default this is found from masses and joints.
    pub base: Option<Base>,
    /// The greatest angle between a revolute axis and the plane's normal, or between a prismatic axis and the plane, at
    /// which the joint is kept \[rad\]. Its axis then counts as exact. The default is 1e-3.
    pub axis_tolerance: Option<f64>,
    /// Which links are welded.
    pub reductions: Reductions,
}

impl Reduction {
    /// The greatest allowed [`axis_tolerance`](Self::axis_tolerance) \[rad\]. At greater angles, a hinge is closer to
    /// lying in the plane.
    pub const WIDEST_TOLERANCE: f64 = 0.5;
}

/// Lower bound on the size of a robot without shapes \[m\].
const USUAL: f64 = 1.0;

impl Robot {
    /// Reads a URDF text and reduces the robot to its plane.
    ///
    /// # Errors
    /// Returns an error in the cases of [`Description::from_urdf`] and [`Robot::reduce`].
    pub fn from_urdf(text: &str) -> Result<Self> {
        Self::reduce_tree(&Description::from_urdf(text)?, &Reduction::default())
    }

    /// Reduces `description` to a plane of its root link.
    ///
    /// The plane is the one whose normal is parallel to all revolute and continuous axes. If there is none, it is x-z
    /// or y-z, whichever is normal to more of these axes on the paths to the lowest links, or if it is normal to none
    /// of those, to more of all axes. Joints that rotate about the normal or slide in the plane, within the tolerance,
    /// are kept. All others are frozen at zero, with the inertia that their links have there. The base floats, is fixed
    /// to the world, or is a chain of the file's own joints. [`Robot::reading`] reports these choices with reasons, and
    /// [`Robot::left_out`] lists what does not enter the analysis.
    ///
    /// # Errors
    /// Returns [`Reason::Inconsistent`] if mimic joints form a cycle, if a joint cannot be frozen at a value or does
    /// not exist, or if nothing that moves has mass. Returns [`Reason::NotATree`] if links or joints of the description
    /// were changed such that they do not form one tree. Returns [`Reason::OutOfRange`] for a moving body with a
    /// negative moment of inertia about the normal, and for an axis tolerance beyond [`Reduction::WIDEST_TOLERANCE`].
    /// Returns [`Reason::NotFinite`] if sums of sizes or masses exceed the range of f64.
    pub fn reduce(description: &Description, reduction: &Reduction) -> Result<Self> {
        description.check()?;
        Self::reduce_tree(description, reduction)
    }

    /// Reduces a description whose links and joints form one tree.
    fn reduce_tree(description: &Description, reduction: &Reduction) -> Result<Self> {
        let tolerance = reduction.axis_tolerance.unwrap_or(PARALLEL);
        if !(0.0..=Reduction::WIDEST_TOLERANCE).contains(&tolerance) {
            let (what, allowed) = ("`axis_tolerance`".to_owned(), "between 0 and 0.5 rad");
            return Err(Reason::OutOfRange { what, allowed, value: tolerance }.into());
        }
        let mut pose = ReferencePose::new(description, &reduction.hold, tolerance)?;
        let legs = pose.legs(description);
        let (plane, plane_because) = find_plane(description, &pose, &legs, reduction.plane);
        let roles_in = |pose: &ReferencePose| roles(description, pose, plane);
        let mut roles = roles_in(&pose);
        while pose.follow(description, |own, other, turns| role::stays(&roles, tolerance, (own, other), turns)) {
            roles = roles_in(&pose);
        }
        let found = base::judge(description, &pose.outward, &mut roles, reduction.base);
        let rotation = product(&plane.axes(), &pose.rotations[found.root]);
        let tree = Tree::grow(description, (&pose, &roles), found.root, rotation, reduction.reductions);

        let frozen = frozen(description, &roles, &tree, &found);
        let places = description.links.iter().zip(&tree.places);
        let outside: Vec<&UrdfLink> = places.filter(|(_, place)| place.is_none()).map(|(link, _)| link).collect();
        let seen = caution::Seen { description, pose: &pose, plane, legs: &legs };
        let mut cautions = caution::about_frozen(&seen, &frozen, tree.joints.len() + tree.mimic_joints.len());
        cautions.extend(found.caution);
        cautions.extend(caution::about_file(&seen, &roles, &frozen, &outside));
        let reading = Reading {
            plane,
            plane_because,
            better_plane: better_plane(description, &pose, (plane, &roles))
                .filter(|_| plane_because != PlaneReason::Legs),
            base_because: found.because,
            frozen: frozen.into_iter().map(|(_, joint)| joint).collect(),
            outside: outside.into_iter().map(|link| link.name.clone()).collect(),
            cautions,
        };
        let mut robot = Self {
            name: if description.name.is_empty() { "robot".into() } else { description.name.clone() },
            base: found.base,
            left_out: joints_left_out(description, &roles, &tree, &reading),
            reading,
            bodies: tree.bodies,
            joints: tree.joints,
            mimic_joints: tree.mimic_joints,
            links: Vec::new(),
        };

        let mut parts = Vec::with_capacity(description.links.len());
        let mut moments = vec![0.0; description.links.len()];
        for ((link, place), moment) in description.links.iter().zip(&tree.places).zip(&mut moments) {
            let Some(place) = place else { continue };
            if let Some(inertial) = &link.inertial {
                let Inertial { origin, mass, inertia } = inertial;
                let frame = place.frame(origin);
                let (mut part, rounding) =
                    LinkInertia::projected(*mass, frame.in_plane(), inertia.as_ref(), &frame.rotation);
                if part.moment < 0.0 && part.moment >= -rounding {
                    let found = format!("its moment about the plane's normal is {:e} kg m^2", part.moment);
                    let why = format!("{found}, which is rounding: taken as 0");
                    robot.left_out.push(LeftOutPart::link(&link.name, why));
                    part.moment = 0.0;
                }
                *moment = part.moment;
                parts.push((place.body, part));
            }
            robot.left_out.extend(LeftOutPart::doubtful_inertia(link));
            let mut reduced = reduce_link(link, place, &mut robot.left_out);
            if !robot.moves(place.body) && !reduced.shapes.is_empty() {
                reduced.shapes.clear();
                robot.left_out.push(LeftOutPart::bolted_shapes(link));
            }
            robot.links.push(reduced);
        }
        let wholes = composites(robot.bodies.len(), parts);
        for (body, whole) in robot.bodies.iter_mut().zip(wholes) {
            (body.mass, body.com, body.moment) = whole;
        }
        let placed = description.links.iter().zip(moments).zip(&tree.places);
        let placed = placed.filter_map(|((link, moment), place)| Some((link, moment, place.as_ref()?.body)));
        refuse_negative(&robot, placed.clone())?;
        robot.left_out.extend(passed_over(description));
        let mut shapes =
            robot.links.iter().flat_map(|link| link.shapes.iter().map(|shape| (link.body, shape))).peekable();
        // Without shapes, only the centers of mass are known.
        let least = if shapes.peek().is_some() { 0.0 } else { USUAL };
        let size = robot.size(shapes).max(least);
        let moving = placed.filter(|&(.., body)| robot.moves(body)).map(|(link, moment, _)| (link, moment));
        let cautions = caution::about_inertias(moving, (robot.mass(), size));
        robot.reading.cautions.extend(cautions);
        // With prismatic joints, the robot may reach farther than at zero.
        let slides = robot.joints.iter().any(|joint| !joint.axis.is_revolute());
        robot.reading.cautions.extend(caution::about_mass(robot.mass(), size).filter(|_| !slides));
        robot.reading.cautions.extend(caution::about_massless(&robot));

        refuse_overflow(&robot)?;
        if robot.mass() == 0.0 {
            let error = Error::new(Reason::Inconsistent("nothing that moves has mass".into())).at("robot");
            return Err(match robot.bodies.iter().any(|body| body.mass > 0.0) {
                true => error.hint("its root is bolted to the world; give `base: floating` to set it free"),
                false => error.hint("give the links <inertial> elements with a mass"),
            });
        }
        Ok(robot)
    }
}

/// Returns the plane that is `asked` for, else the plane of all hinges, else the plane of most hinges of the `legs`, or
/// of the robot if its legs have none.
fn find_plane(
    description: &Description,
    pose: &ReferencePose,
    legs: &[bool],
    asked: Option<Plane>,
) -> (Plane, PlaneReason) {
    let hinges = (0..description.joints.len()).filter(|&joint| {
        let kind = description.joints[joint].kind;
        matches!(kind, JointKind::Revolute | JointKind::Continuous) && pose.frozen[joint].is_none()
    });
    if let Some(plane) = asked {
        return (plane, PlaneReason::Asked);
    }
    if let Some(plane) = Plane::normal_to(hinges.clone().map(|joint| pose.axes[joint]), pose.tolerance) {
        return (plane, PlaneReason::CommonAxis);
    }
    let counts = |all: bool| {
        [Plane::XZ, Plane::YZ].map(|plane| {
            let most = if all { pose.tolerance } else { OBLIQUE };
            let turns = |&joint: &usize| (all || legs[joint]) && plane.off_normal(pose.axes[joint]) <= most;
            hinges.clone().filter(turns).count()
        })
    };
    match (counts(false), counts(true)) {
        // No hinge leads to the lowest links if the root is the lowest.
        ([0, 0], [x, y]) if y > x => (Plane::YZ, PlaneReason::Most),
        ([0, 0], _) => (Plane::XZ, PlaneReason::Usual),
        ([x, y], _) => (if y > x { Plane::YZ } else { Plane::XZ }, PlaneReason::Legs),
    }
}

/// Returns the plane that keeps the most joints, with their number, if more than in the plane with roles `here`.
fn better_plane(description: &Description, pose: &ReferencePose, here: (Plane, &[Role])) -> Option<(Plane, usize)> {
    let can_move = |kind| matches!(kind, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic);
    let moving = |roles: &[Role]| {
        let kinds = description.joints.iter().map(|joint| joint.kind);
        let moving = |(role, kind): &(&Role, JointKind)| can_move(*kind) && matches!(role, Role::Moves { .. });
        roles.iter().zip(kinds).filter(moving).count()
    };
    let (plane, here) = (here.0, moving(here.1));
    if here == description.joints.iter().filter(|joint| can_move(joint.kind)).count() {
        return None;
    }
    let others = Plane::ALL.into_iter().filter(|&other| other != plane);
    let others = others.map(|other| (other, moving(&roles(description, pose, other))));
    // Of equally good planes the first is taken.
    others.rev().max_by_key(|&(_, moving)| moving).filter(|&(_, most)| most > here)
}

/// Returns the joints without a coordinate, in the file's order, each with its index in the file.
fn frozen(description: &Description, roles: &[Role], tree: &Tree, found: &base::Judgment) -> Vec<(usize, FrozenJoint)> {
    let joints = description.joints.iter().zip(roles).enumerate();
    let frozen = joints.filter_map(|(index, (joint, role))| {
        let name = joint.name.clone();
        match (role, tree.places[joint.child].as_ref().map(|place| &tree.bodies[place.body])) {
            (Role::Frozen(reason), Some(body)) => {
                let welded = !matches!(body.joint, Some(ParentJoint::Fixed { .. }));
                Some((index, FrozenJoint { name, reason: reason.clone(), body: body.name.clone(), welded }))
            }
            // Frozen joints between links of the base are not part of the robot.
            (role, outside) if found.chain.contains(&index) || outside.is_none() && matches!(role, Role::Frozen(_)) => {
                let root = description.links[found.root].name.clone();
                Some((index, FrozenJoint { name, reason: FreezeReason::Base, body: root, welded: true }))
            }
            _ => None,
        }
    });
    frozen.collect()
}

/// Returns what is left out about joints, in the file's order, and the links that are not part of the robot.
fn joints_left_out(description: &Description, roles: &[Role], tree: &Tree, reading: &Reading) -> Vec<LeftOutPart> {
    let mut frozen = reading.frozen.iter().peekable();
    let mut all = Vec::new();
    for (index, joint) in description.joints.iter().enumerate() {
        if let Some(frozen) = frozen.next_if(|frozen| frozen.name == joint.name) {
            all.push(LeftOutPart::joint(&joint.name, frozen.why()));
        } else if let Role::Moves { tilt, .. } = roles[index]
            && tilt > 0.0
            && tree.places[joint.parent].is_some()
        {
            let wanted = if joint.kind == JointKind::Prismatic { "the plane" } else { "the plane's normal" };
            let why = format!("its axis is {tilt:.1e} rad off {wanted}: taken as exactly on it");
            all.push(LeftOutPart::joint(&joint.name, why));
        }
    }
    let why = "not part of the robot: it belongs to the world or to the base";
    all.extend(reading.outside.iter().map(|name| LeftOutPart::link(name, why)));
    all
}

/// Returns `link` with its collision shapes in its body's frame.
fn reduce_link(link: &UrdfLink, place: &Place, left_out: &mut Vec<LeftOutPart>) -> Link {
    let pose = [0, 2].map(|row| {
        let [a, b, c] = place.rotation[row];
        [a, b, c, place.offset[row]]
    });
    let mut shapes = Vec::with_capacity(link.collisions.len());
    for collision in &link.collisions {
        let frame = place.frame(&collision.origin);
        match outline(&collision.geometry, &frame.rotation, frame.in_plane(), PARALLEL_SHAPE) {
            Ok(shape) => shapes.push(shape),
            Err(why) => left_out.push(LeftOutPart::shape(link, collision, why)),
        }
    }
    Link {
        name: link.name.clone(),
        body: place.body,
        pose,
        shapes,
        has_inertial: link.inertial.is_some(),
        line: Some(link.location.line),
    }
}

/// Returns an error if a moving body has a negative moment of inertia. Its place is that of the link that contributes
/// most. Each of the `links` has its moment and its body.
fn refuse_negative<'l>(robot: &Robot, links: impl Iterator<Item = (&'l UrdfLink, f64, usize)>) -> Result<()> {
    let wholes = robot.wholes().into_iter().enumerate();
    let mut negative = wholes.filter_map(|(body, whole)| Some((body, whole.filter(|whole| whole.1 < 0.0)?.1)));
    let Some((whole, value)) = negative.find(|&(body, _)| robot.moves(body)) else { return Ok(()) };
    let what = "the moment of inertia about the plane's normal".into();
    let error = Error::from(Reason::OutOfRange { what, allowed: "at least 0", value });
    let parts = links.filter(|&(.., body)| robot.rigid_body(body) == whole);
    let worst = parts.min_by(|(_, one, _), (_, other, _)| one.total_cmp(other));
    let error = worst.into_iter().fold(error, |error, (link, ..)| link.refuse(error));
    Err(error.hint("correct the moments and products of its <inertia>"))
}

/// Returns an error if a sum exceeds the range of f64.
fn refuse_overflow(robot: &Robot) -> Result<()> {
    for body in &robot.bodies {
        let inertia = [body.mass, body.com.x, body.com.z, body.moment];
        refuse_infinite("the inertia of the welded body", inertia, || description::link_place(&body.name))?;
    }
    for joint in robot.moving_joints() {
        refuse_infinite("the place at zero", joint.origin.components(), || description::joint_place(&joint.name))?;
    }
    for link in &robot.links {
        let place = || description::link_place(&link.name);
        refuse_infinite("the place at zero", link.pose.into_iter().flatten(), place)?;
        for shape in &link.shapes {
            let corners = shape.corners().iter().flat_map(|corner| corner.components());
            refuse_infinite("the place of a collision shape", corners, place)?;
        }
    }
    refuse_infinite("the mass", [robot.mass()], || "robot".into())
}

fn refuse_infinite(what: &str, numbers: impl IntoIterator<Item = f64>, place: impl Fn() -> String) -> Result<()> {
    let all = numbers.into_iter().try_for_each(|number| finite(number, || what.into()).map(drop));
    all.map_err(|error| error.at(place()))
}
