//! Description -> robot: the tree placed at zero coordinates, projected into its plane, and welded at its fixed joints.
//!
//! The plane is x-z of the root link, with the normal n = +y. A link's frame stands in its body's frame at
//!
//! ```text
//!     p = p_parent + R_parent xyz,   R = R_parent Rz(yaw) Ry(pitch) Rx(roll)          p = 0 behind a moving joint
//! ```
//!
//! where `xyz` and roll, pitch, yaw are of the joint's origin and R leads to the root's axes. What lies beside the plane
//! counts as if it lay in it. Linear in links; nothing recurses.

use super::composite::{Part, composite};
use super::outline::outline;
use super::{Axis, Base, Body, Joint, LeftOut, Link, Robot};
use crate::description::{
    self, Collision, Description, Geometry, Ignored, Inertial, JointKind, Matrix, Pose, apply, product,
};
use crate::error::{Error, Reason, Result};
use crate::planar::Vector;

/// The greatest angle between two directions that still count as parallel \[rad\]: files round their axes.
const PARALLEL: f64 = 1e-3;
/// An axis this near to the normal is off by rounding alone \[rad\].
const ROUNDING: f64 = 1e-9;

impl Robot {
    /// Reads the text of a URDF file and reduces it to the x-z plane, with a floating base.
    ///
    /// # Errors
    /// Those of [`Description::from_urdf`] and [`Robot::reduce`].
    pub fn from_urdf(text: &str) -> Result<Self> {
        Self::reduce(&Description::from_urdf(text)?, None)
    }

    /// Reduces `description` to the x-z plane of its root link; without a `base` it floats.
    ///
    /// Revolute and continuous joints turn about ±y, prismatic ones slide in the plane, both within 1e-3 rad; fixed joints
    /// are welded. All that does not enter is told in [`Robot::left_out`].
    ///
    /// # Errors
    /// [`Reason::Unsupported`] for a joint off the plane, one that follows another (mimic), and planar, floating and
    /// spherical ones; [`Reason::OutOfRange`] for a negative moment of inertia about the normal; [`Reason::Inconsistent`]
    /// where nothing that moves has mass; [`Reason::NotFinite`] where sizes or masses add up to more than an f64 holds.
    pub fn reduce(description: &Description, base: Option<Base>) -> Result<Self> {
        let base = base.unwrap_or(Base::Floating);
        description.joints.iter().try_for_each(refuse_unhandled)?;
        let Tree { bodies, joints, places, mut left_out } = Tree::place(description)?;
        let mut robot =
            Self { name: description.name.clone(), base, bodies, joints, links: Vec::new(), left_out: Vec::new() };

        let mut parts = vec![Vec::new(); robot.bodies.len()];
        for (link, place) in description.links.iter().zip(&places) {
            if let Some(inertial) = &link.inertial {
                parts[place.body].push(reduce_inertial(link, inertial, place)?);
                if inertial.inertia.is_none() {
                    left_out.push(point_mass(link));
                }
            }
            robot.links.push(reduce_link(link, place, &mut left_out));
        }
        for (body, parts) in robot.bodies.iter_mut().zip(&parts) {
            (body.mass, body.com, body.moment) = composite(parts);
        }
        left_out.extend(description.ignored.iter().map(passed_over));
        robot.left_out = left_out;

        refuse_overflow(&robot)?;
        let moving = if base == Base::Fixed { 1 } else { 0 };
        if robot.bodies.iter().skip(moving).all(|body| body.mass == 0.0) {
            let error = Error::new(Reason::Inconsistent("nothing that moves has mass".into()));
            return Err(error.at("robot").hint("give the links <inertial> elements with a mass"));
        }
        Ok(robot)
    }
}

/// Refuses joints of a kind that is not handled yet.
fn refuse_unhandled(joint: &description::Joint) -> Result<()> {
    let kind = match joint.kind {
        JointKind::Fixed => return Ok(()),
        JointKind::Planar => "planar",
        JointKind::Floating => "floating",
        JointKind::Spherical => "spherical",
        _ if joint.mimic.is_some() => "mimic",
        _ => return Ok(()),
    };
    let error = joint.refuse(Reason::Unsupported(format!("{kind} joints are not handled yet")));
    Err(match joint.mimic {
        Some(_) => error.hint("remove <mimic> to let the joint move freely, or make it fixed"),
        None => error.hint("make it fixed, or replace it by revolute and prismatic joints"),
    })
}

/// A link's frame in its body's frame, in three dimensions and with the root's axes.
#[derive(Clone)]
struct Place {
    body: usize,
    rotation: Matrix,
    offset: [f64; 3],
}

impl Place {
    /// The vector of the body's frame to the origin of `pose`.
    fn point(&self, pose: &Pose) -> [f64; 3] {
        let [x, y, z] = apply(&self.rotation, pose.xyz);
        [self.offset[0] + x, self.offset[1] + y, self.offset[2] + z]
    }
}

/// Bodies and joints, still without inertia, and the places of all links.
struct Tree {
    bodies: Vec<Body>,
    joints: Vec<Joint>,
    places: Vec<Place>,
    left_out: Vec<LeftOut>,
}

impl Tree {
    /// Walks from the root down, so that parents come first, and along each branch before the next.
    fn place(description: &Description) -> Result<Self> {
        let Description { links, joints, root, .. } = description;
        let mut hanging = vec![Vec::new(); links.len()];
        // Backward, since a stack is emptied from its end.
        for (index, joint) in joints.iter().enumerate().rev() {
            hanging[joint.parent].push(index);
        }
        // The coordinate of each moving joint.
        let mut moving = 0;
        let coordinates = joints.iter().map(|joint| {
            (joint.kind != JointKind::Fixed).then(|| {
                moving += 1;
                moving - 1
            })
        });
        let coordinates: Vec<Option<usize>> = coordinates.collect();

        let at_root = Place { body: 0, rotation: Pose::default().rotation(), offset: [0.0; 3] };
        let mut places = vec![at_root; links.len()];
        let mut bodies = vec![Body::of(&links[*root].name, None)];
        let mut reduced: Vec<(usize, Joint)> = Vec::with_capacity(moving);
        let mut welds: Vec<(usize, LeftOut)> = Vec::new();
        let mut waiting = hanging[*root].clone();
        while let Some(index) = waiting.pop() {
            let joint = &joints[index];
            let parent = &places[joint.parent];
            let (body, origin) = (parent.body, parent.point(&joint.origin));
            let rotation = product(&parent.rotation, &joint.origin.rotation());
            places[joint.child] = match coordinates[index] {
                None => {
                    welds.push((index, weld(joint, &bodies[body].name)));
                    Place { body, rotation, offset: origin }
                }
                Some(coordinate) => {
                    let (axis, note) = planar_axis(joint, &rotation)?;
                    welds.extend(note.map(|note| (index, note)));
                    let (name, child) = (joint.name.clone(), bodies.len());
                    bodies.push(Body::of(&links[joint.child].name, Some(coordinate)));
                    reduced.push((coordinate, Joint { name, parent: body, child, origin: in_plane(origin), axis }));
                    Place { body: child, rotation, offset: [0.0; 3] }
                }
            };
            waiting.extend(&hanging[joint.child]);
        }

        reduced.sort_by_key(|(coordinate, _)| *coordinate);
        welds.sort_by_key(|(index, _)| *index);
        Ok(Self {
            bodies,
            joints: reduced.into_iter().map(|(_, joint)| joint).collect(),
            places,
            left_out: welds.into_iter().map(|(_, weld)| weld).collect(),
        })
    }
}

impl Body {
    /// A body that still weighs nothing.
    fn of(link: &str, joint: Option<usize>) -> Self {
        Self { name: link.into(), joint, mass: 0.0, com: [0.0; 2], moment: 0.0 }
    }
}

/// Forward and up of a vector in the root's axes.
fn in_plane([x, _, z]: [f64; 3]) -> Vector<f64> {
    [x, z]
}

fn weld(joint: &description::Joint, body: &str) -> LeftOut {
    LeftOut { what: description::joint_place(&joint.name), why: format!("fixed: welded into {body}") }
}

/// The joint's motion in the plane, and a word if its axis had to be brought into line.
fn planar_axis(joint: &description::Joint, rotation: &Matrix) -> Result<(Axis, Option<LeftOut>)> {
    let [x, y, z] = unit(apply(rotation, unit(joint.axis)));
    let (along_plane, along_normal) = (libm::hypot(x, z), y.abs());
    let slides = joint.kind == JointKind::Prismatic;
    let (angle, wanted) = match slides {
        false => (libm::atan2(along_plane, along_normal), "the plane's normal (y)"),
        true => (libm::atan2(along_normal, along_plane), "the plane (x-z)"),
    };
    if angle > PARALLEL {
        let reason = format!("its axis is {:.2} degrees off {wanted}: not handled yet", angle.to_degrees());
        // What a file without the element means is seldom meant.
        let hint = match joint.axis == [1.0, 0.0, 0.0] {
            true => "a joint without <axis> has URDF's default, 1 0 0: add <axis>, or make it fixed to hold it at zero",
            false => "make it fixed to hold it at zero",
        };
        return Err(joint.refuse(Reason::Unsupported(reason)).hint(hint));
    }
    let axis = if slides {
        Axis::Slide { direction: in_plane(unit([x, 0.0, z])) }
    } else {
        Axis::Turn { sign: if y < 0.0 { -1.0 } else { 1.0 } }
    };
    let note = (angle > ROUNDING).then(|| LeftOut {
        what: description::joint_place(&joint.name),
        why: format!("its axis is {:.1e} rad off {wanted}: taken as exactly on it", angle),
    });
    Ok((axis, note))
}

/// `vector` at length one; one that has it keeps its digits, and zero stays zero.
fn unit(vector: [f64; 3]) -> [f64; 3] {
    // A power of two first, so that no square overflows or vanishes; it costs no digit.
    let largest = vector.into_iter().map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 {
        return vector;
    }
    let [x, y, z] = vector.map(|component| libm::scalbn(component, -libm::ilogb(largest)));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// The inertia of `link` in its body's frame.
fn reduce_inertial(link: &description::Link, inertial: &Inertial, place: &Place) -> Result<Part> {
    let rotation = product(&place.rotation, &inertial.origin.rotation());
    let com = in_plane(place.point(&inertial.origin));
    let part = Part::projected(inertial.mass, com, inertial.inertia.as_ref(), &rotation);
    part.map_err(|reason| link.refuse(reason))
}

fn point_mass(link: &description::Link) -> LeftOut {
    LeftOut {
        what: description::link_place(&link.name),
        why: "its <inertial> has no <inertia>: taken as a point mass".into(),
    }
}

/// `link` with its collision shapes, in its body's frame.
fn reduce_link(link: &description::Link, place: &Place, left_out: &mut Vec<LeftOut>) -> Link {
    let pose = [0, 2].map(|row| {
        let [a, b, c] = place.rotation[row];
        [a, b, c, place.offset[row]]
    });
    let mut shapes = Vec::with_capacity(link.collisions.len());
    for collision in &link.collisions {
        let rotation = product(&place.rotation, &collision.origin.rotation());
        match outline(&collision.geometry, &rotation, in_plane(place.point(&collision.origin)), PARALLEL) {
            Ok(shape) => shapes.push(shape),
            Err(why) => left_out.push(LeftOut { what: skipped(link, collision), why }),
        }
    }
    Link { name: link.name.clone(), body: place.body, pose, shapes, has_inertial: link.inertial.is_some() }
}

/// A collision shape as [`LeftOut`] names it.
fn skipped(link: &description::Link, collision: &Collision) -> String {
    let shape = match &collision.geometry {
        Geometry::Box { .. } => "box".into(),
        Geometry::Cylinder { .. } => "cylinder".into(),
        Geometry::Capsule { .. } => "capsule".into(),
        Geometry::Sphere { .. } => "sphere".into(),
        Geometry::Mesh { file, .. } => format!("mesh \"{file}\""),
        Geometry::Unknown { tag } => format!("<{tag}>"),
    };
    format!("collision {shape} of {}", description::link_place(&link.name))
}

/// Elements that the description passed over, as [`LeftOut`] names them.
fn passed_over(ignored: &Ignored) -> LeftOut {
    let Ignored { parent, tag, count } = ignored;
    let why = match (*parent, tag.as_str()) {
        ("joint", "limit") => "joint limits do not enter an impact",
        ("joint", "dynamics") => "damping and dry friction of a joint do not enter an impact",
        _ => "no part of the robot's mechanics",
    };
    let times = if *count == 1 { String::new() } else { format!("{count} ") };
    LeftOut { what: format!("{times}<{tag}> in <{parent}>"), why: why.into() }
}

/// Refuses a robot whose sums have left the range of f64.
fn refuse_overflow(robot: &Robot) -> Result<()> {
    let refuse = |what: &str, numbers: &[f64], place: String| match numbers.iter().find(|number| !number.is_finite()) {
        Some(&value) => Err(Error::from(Reason::NotFinite { what: what.into(), value }).at(place)),
        None => Ok(()),
    };
    for body in &robot.bodies {
        let inertia = [body.mass, body.com[0], body.com[1], body.moment];
        refuse("the inertia of the welded body", &inertia, description::link_place(&body.name))?;
    }
    for joint in &robot.joints {
        refuse("the place at zero", &joint.origin, description::joint_place(&joint.name))?;
    }
    for link in &robot.links {
        refuse("the place at zero", link.pose.as_flattened(), description::link_place(&link.name))?;
        for shape in &link.shapes {
            let corners = shape.corners().as_flattened();
            refuse("the place of a collision shape", corners, description::link_place(&link.name))?;
        }
    }
    refuse("the mass", &[robot.mass()], "robot".into())
}
