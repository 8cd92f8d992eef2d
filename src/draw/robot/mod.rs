//! A robot in its configuration, its contacts and the outcomes of its impact, as points, shapes and arrows of the
//! plane.
//!
//! ```text
//!     Robot + Placement + feet             --> bodies: bones, shapes, CoG; joints      shape.rs
//!     Impact (contacts, outcomes) + ground --> contacts, arrows per outcome, ground    extent.rs
//!     Drawing --> a picture with a panel per outcome                                   picture.rs
//!     Drawing --> the data of an interactive page                                      ../page
//! ```
//!
//! Points are in the world's axes, `[x, z]` in meters; only shapes and CoGs are in the frames of their bodies.

mod extent;
mod shape;
#[cfg(feature = "plot")]
pub mod picture;

pub use extent::Extent;
pub use shape::DrawnShape;

use crate::contact::{Feet, Placement};
use crate::pipeline::Impact;
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::state::{NamedContact, State};
use serde::Serialize;

/// A robot in its configuration, its contacts and the outcomes of its impact.
#[derive(Debug, Clone)]
pub struct Drawing {
    /// Rigid bodies, in the robot's order.
    pub bodies: Vec<DrawnBody>,
    /// Where joints are, and where loops are closed.
    pub joints: Vec<Vector<f64>>,
    /// The ground's surface from left to right, as far as the drawing reaches; empty without a ground.
    pub ground: Vec<Vector<f64>>,
    /// The closed contacts.
    pub contacts: Vec<DrawnContact>,
    /// Impulses that the state applies \[N s\].
    pub applied: Vec<Arrow>,
    /// Every outcome.
    pub outcomes: Vec<DrawnOutcome>,
}

/// A rigid body.
#[derive(Debug, Clone)]
pub struct DrawnBody {
    /// Its frame's origin, where its joint is.
    pub origin: Vector<f64>,
    /// The x axis of its frame.
    pub x_axis: Vector<f64>,
    /// Its collision shapes, in its frame.
    pub shapes: Vec<DrawnShape>,
    /// Its CoG, in its frame; `None` if it has no mass.
    pub com: Option<Vector<f64>>,
    /// The ends of its bones, which all begin at its origin: joints of its children, shapes, a CoG apart from all of
    /// them.
    pub bones: Vec<Vector<f64>>,
    /// Whether it has no children.
    pub is_last: bool,
    /// Its mass \[kg\].
    pub mass: f64,
}

/// A closed contact.
#[derive(Debug, Clone)]
pub struct DrawnContact {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub point: Vector<f64>,
    /// Unit normal of the ground, toward the robot.
    pub normal: Vector<f64>,
    /// Its velocity before the impact \[m/s\].
    pub velocity_before: Vector<f64>,
}

/// The effect of an outcome on each contact.
#[derive(Debug, Clone)]
pub struct DrawnOutcome {
    /// The impulse of the ground \[N s\].
    pub impulse: Vec<Vector<f64>>,
    /// The velocity after the impact \[m/s\].
    pub velocity_after: Vec<Vector<f64>>,
}

/// A vector at a point.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Arrow {
    /// Where it acts \[m\].
    pub point: Vector<f64>,
    /// The vector, in its own unit.
    pub vector: Vector<f64>,
}

/// A bone that is shorter than this share of the robot's size has no visible direction.
const SHORT: f64 = 0.02;

impl Drawing {
    /// A robot with its bodies at `placement` and the feet that are `named` in addition to its own shapes.
    pub fn of_robot(robot: &Robot, placement: &Placement, named: &[NamedContact]) -> Self {
        let mut bodies: Vec<DrawnBody> = robot
            .bodies
            .iter()
            .enumerate()
            .map(|(at, body)| DrawnBody {
                origin: placement.world(at, Vector::zero()),
                x_axis: placement.turned(at, Vector::new(1.0, 0.0)),
                shapes: Vec::new(),
                com: (body.mass > 0.0).then_some(body.com),
                bones: Vec::new(),
                is_last: true,
                mass: body.mass,
            })
            .collect();
        for foot in Feet::new(robot, named).iter() {
            bodies[foot.body].shapes.push(DrawnShape::new(&foot.outline));
        }
        let mut joints = Vec::new();
        for (at, body) in robot.bodies.iter().enumerate() {
            let Some((parent, _, axis)) = body.joint.map(|mover| robot.hinge(mover)) else { continue };
            let origin = bodies[at].origin;
            bodies[parent].bones.push(origin);
            bodies[parent].is_last = false;
            if axis.is_some() {
                joints.push(origin);
            }
        }
        let (ground, contacts, applied, outcomes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut drawing = Self { bodies, joints, ground, contacts, applied, outcomes };
        let size = drawing.extent().size();
        drawing.bodies.iter_mut().for_each(|body| body.grow_bones(SHORT * size));
        drawing
    }

    /// A state of the robot and every outcome of its impact; `feet` are those in addition to its own shapes.
    pub fn of_impact(robot: &Robot, feet: &[NamedContact], state: &State, impact: &Impact) -> Self {
        let State { scene, .. } = state;
        let placement = &impact.placement;
        let named: Vec<NamedContact> = feet.iter().chain(scene.contacts.iter().flatten()).copied().collect();
        let mut drawing = Self::of_robot(robot, placement, &named);
        for pin in &scene.loops {
            let ends = [pin.a, pin.b].map(|end| {
                let link = &robot.links[end.link];
                let point = placement.world(link.body, link.point(end.offset));
                drawing.bodies[link.body].bones.push(point);
                point
            });
            drawing.joints.push(ends[0]);
        }
        let in_world = |pairs: &[Pair<f64>]| -> Vec<Vector<f64>> {
            impact.contacts.iter().zip(pairs).map(|(contact, &pair)| contact.ground.apply(pair.into())).collect()
        };
        let contacts = impact.contacts.iter().zip(in_world(&impact.velocity_before));
        let contacts = contacts.map(|(contact, velocity_before)| DrawnContact {
            name: contact.name.clone(),
            point: contact.point,
            normal: contact.normal(),
            velocity_before,
        });
        drawing.contacts = contacts.collect();
        let outcomes = impact.analysis.as_ref().map_or(&[][..], |analysis| &analysis.outcomes).iter();
        let outcomes = outcomes.map(|outcome| DrawnOutcome {
            impulse: in_world(&outcome.impulse),
            velocity_after: in_world(&outcome.velocity_after),
        });
        drawing.outcomes = outcomes.collect();
        let applied = scene.impulses.iter().map(|applied| {
            let link = &robot.links[applied.link];
            let point = placement.world(link.body, link.point(applied.offset));
            Arrow { point, vector: applied.vector }
        });
        drawing.applied = applied.collect();
        drawing.ground = drawing.extent().surface(&scene.ground, drawing.size());
        drawing
    }

    /// Everything except the ground and the arrows.
    pub fn extent(&self) -> Extent {
        let bodies = self.bodies.iter().flat_map(|body| {
            let com = body.com.map(|com| body.world(com));
            body.bones.iter().copied().chain([body.origin]).chain(com).chain(body.corners())
        });
        let contacts = self.contacts.iter().map(|contact| contact.point);
        Extent::of(bodies.chain(contacts))
    }

    /// The diagonal of its extent \[m\]; a single point is drawn as if it were a meter long.
    pub fn size(&self) -> f64 {
        Some(self.extent().size()).filter(|&size| size > 0.0).unwrap_or(1.0)
    }

    /// The greatest impulse of all outcomes, and of those that the state applies \[N s\].
    pub fn greatest_impulse(&self) -> f64 {
        let applied = self.applied.iter().map(|applied| &applied.vector);
        greatest(self.outcomes.iter().flat_map(|outcome| &outcome.impulse).chain(applied))
    }

    /// The greatest velocity of a contact, before the impact or after it \[m/s\].
    pub fn greatest_velocity(&self) -> f64 {
        let before = self.contacts.iter().map(|contact| &contact.velocity_before);
        greatest(self.outcomes.iter().flat_map(|outcome| &outcome.velocity_after).chain(before))
    }
}

fn greatest<'a>(vectors: impl Iterator<Item = &'a Vector<f64>>) -> f64 {
    vectors.map(|vector| vector.length()).fold(0.0, f64::max)
}

impl DrawnBody {
    /// The world's point that is `local` in its frame.
    pub fn world(&self, local: Vector<f64>) -> Vector<f64> {
        self.origin + self.x_axis * local.x - self.x_axis.perpendicular() * local.z
    }

    /// Points in the world that its shapes lie between.
    fn corners(&self) -> impl Iterator<Item = Vector<f64>> {
        self.shapes.iter().flat_map(|shape| match shape {
            &DrawnShape::Disc { center, radius } => {
                let [right, up] = Vector::axes().map(|axis| axis * radius);
                [-right, right, -up, up].map(|side| self.world(center) + side).to_vec()
            }
            DrawnShape::Polygon(corners) => corners.iter().map(|&corner| self.world(corner)).collect(),
        })
    }

    /// Adds bones to the shapes of a body without children, and to a CoG that lies on nothing that is drawn. A bone
    /// that is not longer than `short` \[m\] is left out.
    fn grow_bones(&mut self, short: f64) {
        let origin = self.origin;
        let is_long = |end: &Vector<f64>| (*end - origin).length() > short;
        self.bones.retain(is_long);
        if self.is_last || self.bones.is_empty() {
            let ends: Vec<Vector<f64>> = self.shapes.iter().map(|shape| self.world(shape.center())).collect();
            self.bones.extend(ends.into_iter().filter(is_long));
        }
        let drawn = Extent::of(self.bones.iter().copied().chain([origin]).chain(self.corners())).widened(short);
        let com = self.com.map(|com| self.world(com));
        self.bones.extend(com.filter(|&com| !drawn.holds(com)));
    }
}

#[cfg(test)]
mod tests;
