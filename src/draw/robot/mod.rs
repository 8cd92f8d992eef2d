//! Drawings: a robot in its configuration, its contacts and the outcomes of its impact as points, shapes and vectors of
//! the plane.
//!
//! ```text
//!     Robot + Placement + feet             --> bodies: bones, shapes, CoG; joints
//!     Impact (contacts, outcomes) + ground --> contacts, arrows per outcome, ground
//!     Drawing --> a picture with a panel per outcome                                   picture.rs
//!     Drawing --> the data of an interactive page                                      ../page
//! ```
//!
//! Points are in the world frame, `[x, z]` in meters. Only shapes and CoGs are in the frames of their bodies.

#[cfg(feature = "plot")]
pub mod picture;

use crate::Friction;
use crate::contact::{Contact, Feet, Placement};
use crate::pipeline::{Aspect, Impact};
use crate::planar::{Pair, Vector};
use crate::robot::{Body, FootShape, Rim, Robot};
use crate::state::{AppliedImpulse, Ground, NamedContact, NamedLoop, State};
use serde::Serialize;

/// A robot in its configuration, its contacts and the outcomes of its impact.
#[derive(Debug, Clone, Default)]
pub struct Drawing {
    /// The question. For [`Aspect::Forces`], impulses stand for forces \[N\] and velocities after the impact for
    /// accelerations \[m/s^2\].
    pub aspect: Aspect,
    /// Rigid bodies, in the robot's order.
    pub bodies: Vec<DrawnBody>,
    /// The places of the joints \[m\].
    pub joints: Vec<Vector<f64>>,
    /// The points at which loops are closed \[m\].
    pub loops: Vec<Vector<f64>>,
    /// The surface of the ground from left to right, to some distance beyond the robot \[m\]; empty without a ground.
    pub ground: Vec<Vector<f64>>,
    /// Whether the ground is a profile, which has ends.
    pub is_profile: bool,
    /// The closed contacts.
    pub contacts: Vec<DrawnContact>,
    /// Impulses that the state applies \[N s\].
    pub applied: Vec<Arrow>,
    /// The outcomes, in the order of the analysis.
    pub outcomes: Vec<DrawnOutcome>,
}

/// A rigid body. The origin of its frame is its joint.
#[derive(Debug, Clone)]
pub struct DrawnBody {
    /// The origin of the body's frame, in the world frame \[m\].
    pub origin: Vector<f64>,
    /// The x axis of the body's frame: a unit vector in the world frame.
    pub x_axis: Vector<f64>,
    /// The collision shapes, in the body's frame.
    pub shapes: Vec<DrawnShape>,
    /// The CoG, in the body's frame \[m\]; `None` if the body has no mass.
    pub com: Option<Vector<f64>>,
    /// The ends of the bones, in the world frame \[m\]. Bones are lines from the body's origin to the joints of its
    /// children, to points of loops, to shapes, or to a CoG far from these.
    pub bones: Vec<Vector<f64>>,
    /// Whether the body has no children.
    pub is_last: bool,
    /// The mass \[kg\].
    pub mass: f64,
}

/// A closed contact of a picture.
#[derive(Debug, Clone)]
pub struct DrawnContact {
    /// The name of the contact.
    pub name: String,
    /// The name of its link.
    pub link: String,
    /// The contact point \[m\].
    pub point: Vector<f64>,
    /// The unit normal of the ground, which points toward the robot.
    pub normal: Vector<f64>,
    /// The velocity before the impact, in the world frame \[m/s\].
    pub velocity_before: Vector<f64>,
    /// The friction of the contact.
    pub friction: Friction,
}

/// The impulses and velocities of an outcome, in the world frame.
#[derive(Debug, Clone)]
pub struct DrawnOutcome {
    /// The impulse of the ground on each contact \[N s\].
    pub impulse: Vec<Vector<f64>>,
    /// For each loop, the impulse \[N s\] on the link that it pushes up, and the name of this link.
    pub loop_impulse: Vec<(String, Vector<f64>)>,
    /// The velocity of each contact after the impact \[m/s\].
    pub velocity_after: Vec<Vector<f64>>,
}

/// A vector at the point where it acts.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Arrow {
    /// The point where the vector acts, in the world frame \[m\].
    pub point: Vector<f64>,
    /// The vector in its own unit, in the world frame.
    pub vector: Vector<f64>,
}

/// Bones shorter than this share of the robot's size are omitted: their direction is not visible.
const SHORT: f64 = 0.02;

impl Drawing {
    /// Draws a robot with its bodies at `placement`. The feet in `named` are added to its own shapes.
    pub fn of_robot(robot: &Robot, placement: &Placement, named: &[NamedContact]) -> Self {
        let body = |(at, body): (usize, &Body)| DrawnBody {
            origin: placement.world(at, Vector::zero()),
            x_axis: placement.turned(at, Vector::new(1.0, 0.0)),
            shapes: Vec::new(),
            com: (body.mass > 0.0).then_some(body.com),
            bones: Vec::new(),
            is_last: true,
            mass: body.mass,
        };
        let mut drawing = Self { bodies: robot.bodies.iter().enumerate().map(body).collect(), ..Self::default() };
        for foot in Feet::new(robot, named).iter() {
            drawing.bodies[foot.body].shapes.push(DrawnShape::new(&foot.outline));
        }
        for (at, body) in robot.bodies.iter().enumerate() {
            let Some((parent, _, axis)) = body.joint.map(|mover| robot.hinge(mover)) else { continue };
            let origin = drawing.bodies[at].origin;
            drawing.bodies[parent].bones.push(origin);
            drawing.bodies[parent].is_last = false;
            drawing.joints.extend(axis.map(|_| origin));
        }
        let size = drawing.extent().size();
        drawing.bodies.iter_mut().for_each(|body| body.grow_bones(SHORT * size));
        drawing
    }

    /// Draws a state of the robot and every outcome of its impact. `feet` are added to its own shapes.
    pub fn of_impact(robot: &Robot, feet: &[NamedContact], state: &State, impact: &Impact) -> Self {
        let State { scene, .. } = state;
        let named: Vec<NamedContact> = feet.iter().chain(scene.contacts.iter().flatten()).copied().collect();
        let mut drawing = Self::of_robot(robot, &impact.placement, &named);
        let in_world = |link: usize, offset| {
            let link = &robot.links[link];
            impact.placement.world(link.body, link.point(offset))
        };
        for pin in &scene.loops {
            let ends = [pin.a, pin.b].map(|end| (robot.links[end.link].body, in_world(end.link, end.offset)));
            ends.into_iter().for_each(|(body, point)| drawing.bodies[body].bones.push(point));
            drawing.loops.push(ends[0].1);
        }
        let turned = |pairs: &[Pair<f64>]| -> Vec<Vector<f64>> {
            impact.contacts.iter().zip(pairs).map(|(contact, &pair)| contact.ground.apply(pair.into())).collect()
        };
        let contact = |((contact, velocity_before), friction): ((&Contact, _), _)| {
            let (name, link) = (contact.name.to_string(), robot.links[contact.link].name.clone());
            DrawnContact { name, link, point: contact.point, normal: contact.normal(), velocity_before, friction }
        };
        let contacts = impact.contacts.iter().zip(turned(&impact.velocity_before)).zip(impact.problem.friction());
        drawing.contacts = contacts.map(contact).collect();
        let outcomes = impact.analysis.iter().flat_map(|analysis| &analysis.outcomes);
        let on_link = |(pin, &impulse): (&NamedLoop, &Vector<f64>)| {
            let (end, impulse) = if impulse.z < 0.0 { (pin.b, -impulse) } else { (pin.a, impulse) };
            (robot.links[end.link].name.clone(), impulse)
        };
        let drawn = outcomes.map(|outcome| DrawnOutcome {
            impulse: turned(&outcome.impulse),
            loop_impulse: scene.loops.iter().zip(outcome.loop_impulse.iter().flatten()).map(on_link).collect(),
            velocity_after: turned(&outcome.velocity_after),
        });
        drawing.outcomes = drawn.collect();
        let arrow = |by: &AppliedImpulse| Arrow { point: in_world(by.link, by.offset), vector: by.vector };
        drawing.aspect = impact.aspect();
        drawing.applied = scene.impulses.iter().map(arrow).collect();
        drawing.is_profile = matches!(scene.ground, Ground::Profile(_));
        drawing.ground = drawing.extent().surface(&scene.ground, drawing.extent().scale());
        drawing
    }

    /// Returns the extent of everything except the ground and the arrows.
    pub fn extent(&self) -> Extent {
        let bodies = self.bodies.iter().flat_map(|body| body.drawn().chain(body.com.map(|com| body.world(com))));
        let contacts = self.contacts.iter().map(|contact| contact.point);
        Extent::of(bodies.chain(contacts))
    }

    /// Returns the magnitude of the greatest impulse: of the ground, in a loop, or applied by the state \[N s\].
    pub fn greatest_impulse(&self) -> f64 {
        let impulses = self.outcomes.iter().flat_map(|outcome| &outcome.impulse);
        let in_loops = self.outcomes.iter().flat_map(|outcome| &outcome.loop_impulse).map(|(_, impulse)| impulse);
        greatest(impulses.chain(in_loops).chain(self.applied.iter().map(|applied| &applied.vector)))
    }

    /// Returns the greatest velocities of contacts before and after the impact. For an impact, both are the greatest
    /// before or after it \[m/s\]; for forces, they are the greatest velocity \[m/s\] and acceleration \[m/s^2\].
    pub fn greatest_velocities(&self) -> [f64; 2] {
        let before = greatest(self.contacts.iter().map(|contact| &contact.velocity_before));
        let after = greatest(self.outcomes.iter().flat_map(|outcome| &outcome.velocity_after));
        if self.aspect.is_impact() { [before.max(after); 2] } else { [before, after] }
    }
}

fn greatest<'a>(vectors: impl Iterator<Item = &'a Vector<f64>>) -> f64 {
    vectors.map(|vector| vector.length()).fold(0.0, f64::max)
}

impl DrawnBody {
    /// Returns the point in the world frame \[m\] that is `local` in the body's frame \[m\].
    pub fn world(&self, local: Vector<f64>) -> Vector<f64> {
        self.origin + self.x_axis * local.x - self.x_axis.perpendicular() * local.z
    }

    /// Returns points in the world frame whose extent contains the body's origin, bones and shapes.
    fn drawn(&self) -> impl Iterator<Item = Vector<f64>> {
        let corners = self.shapes.iter().flat_map(|shape| match shape {
            &DrawnShape::Disc { center, radius } => {
                let [right, up] = Vector::axes().map(|axis| axis * radius);
                [-right, right, -up, up].map(|side| self.world(center) + side).to_vec()
            }
            DrawnShape::Polygon(corners) => corners.iter().map(|&corner| self.world(corner)).collect(),
        });
        self.bones.iter().copied().chain([self.origin]).chain(corners)
    }

    /// Adds bones to the shapes of a body without children or bones, and to a CoG outside everything that is drawn.
    /// Bones that are not longer than `short` \[m\] are omitted.
    fn grow_bones(&mut self, short: f64) {
        let origin = self.origin;
        let is_long = |end: &Vector<f64>| (*end - origin).length() > short;
        self.bones.retain(is_long);
        if self.is_last || self.bones.is_empty() {
            let ends: Vec<Vector<f64>> = self.shapes.iter().map(|shape| self.world(shape.center())).collect();
            self.bones.extend(ends.into_iter().filter(is_long));
        }
        let Extent { low, high } = Extent::of(self.drawn()).widened(short);
        let holds = |at: Vector<f64>| (low.x..=high.x).contains(&at.x) && (low.z..=high.z).contains(&at.z);
        let com = self.com.map(|com| self.world(com));
        self.bones.extend(com.filter(|&com| !holds(com)));
    }
}

/// A collision shape in the frame of its body \[m\].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DrawnShape {
    /// A disc; with radius 0, a point.
    #[allow(missing_docs, reason = "a circle about a point")]
    Disc { center: Vector<f64>, radius: f64 },
    /// A polygon with these corners.
    Polygon(Vec<Vector<f64>>),
}

/// The number of directions in which the farthest points of a round shape are computed.
const DIRECTIONS: u32 = 48;

impl DrawnShape {
    fn new(shape: &FootShape) -> Self {
        match (shape.corners(), shape.rim) {
            (&[center], Rim::Circle { radius }) => Self::Disc { center, radius },
            (corners, rim) if rim.bound() == 0.0 => Self::Polygon(corners.to_vec()),
            (corners, rim) => Self::Polygon(swept(corners, rim)),
        }
    }

    /// Returns the center of a disc, or the mean of a polygon's corners.
    fn center(&self) -> Vector<f64> {
        match self {
            Self::Disc { center, .. } => *center,
            Self::Polygon(corners) => {
                let share = 1.0 / corners.len().max(1) as f64;
                corners.iter().fold(Vector::zero(), |middle, corner| middle + *corner * share)
            }
        }
    }
}

/// Approximates corners with rims by a polygon of the farthest points in [`DIRECTIONS`] directions.
fn swept(corners: &[Vector<f64>], rim: Rim) -> Vec<Vector<f64>> {
    let farthest = |at: u32| {
        let (sin, cos) = libm::sincos(f64::from(at) * std::f64::consts::TAU / f64::from(DIRECTIONS));
        let direction = Vector::new(cos, sin);
        let corner = corners.iter().max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)))?;
        Some(*corner + rim.support(direction))
    };
    let mut polygon: Vec<Vector<f64>> = (0..DIRECTIONS).filter_map(farthest).collect();
    polygon.dedup();
    polygon
}

/// The smallest upright rectangle around some points \[m\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Extent {
    /// The least x and z \[m\].
    pub low: Vector<f64>,
    /// The greatest x and z \[m\].
    pub high: Vector<f64>,
}

/// How far the ground reaches beyond the robot on each side, as a multiple of its size.
const BEYOND: f64 = 2.0;

impl Extent {
    /// Returns the extent of these points; that of the origin if there are none.
    pub fn of(points: impl Iterator<Item = Vector<f64>>) -> Self {
        let infinite = Vector::new(f64::INFINITY, f64::INFINITY);
        let around = |(low, high): (Vector<f64>, Vector<f64>), point| (low.least(point), high.greatest(point));
        let (low, high) = points.fold((infinite, -infinite), around);
        if low.x <= high.x { Self { low, high } } else { Self::default() }
    }

    /// Returns the diagonal \[m\].
    pub fn size(self) -> f64 {
        (self.high - self.low).length()
    }

    /// Returns the diagonal \[m\]; 1 m for a single point.
    fn scale(self) -> f64 {
        Some(self.size()).filter(|&size| size > 0.0).unwrap_or(1.0)
    }

    /// Returns the extent with additional `room` \[m\] on every side.
    fn widened(self, room: f64) -> Self {
        Self { low: self.low.map(|entry| entry - room), high: self.high.map(|entry| entry + room) }
    }

    /// Returns the surface of the ground below a robot of this size \[m\] and well to both sides.
    fn surface(self, ground: &Ground, size: f64) -> Vec<Vector<f64>> {
        let (left, right) = (self.low.x - BEYOND * size, self.high.x + BEYOND * size);
        match ground {
            Ground::Slope(slope) => [left, right].map(|x| Vector::new(x, libm::tan(*slope) * x)).to_vec(),
            Ground::Profile(profile) => {
                let mut surface: Vec<Vector<f64>> = Vec::new();
                let pairs = profile.points().windows(2).map(|pair| [pair[0], pair[1]]);
                for pair @ [from, to] in pairs.filter(|[from, to]| to.x >= left && from.x <= right) {
                    if surface.is_empty() {
                        surface.push(if from.x < left { between(pair, left) } else { from });
                    }
                    surface.push(if to.x > right { between(pair, right) } else { to });
                }
                surface
            }
        }
    }
}

/// Returns the point of a segment at this x.
fn between([from, to]: [Vector<f64>; 2], x: f64) -> Vector<f64> {
    Vector::new(x, from.z + (x - from.x) / (to.x - from.x) * (to.z - from.z))
}

#[cfg(test)]
mod tests;
