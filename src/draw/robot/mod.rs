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

use crate::contact::{Contact, Feet, Placement};
use crate::impact::Outcome;
use crate::pipeline::Impact;
use crate::planar::{Pair, Vector};
use crate::robot::{Body, Robot};
use crate::state::{NamedContact, State};
use serde::Serialize;

/// A robot in its configuration, its contacts and the outcomes of its impact.
#[derive(Debug, Clone, Default)]
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
    pub outcomes: Vec<DrawnOutcome>,
}

/// A rigid body; its frame's origin is where its joint is.
#[derive(Debug, Clone)]
pub struct DrawnBody {
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
    /// In kg.
    pub mass: f64,
}

/// A closed contact.
#[derive(Debug, Clone)]
pub struct DrawnContact {
    pub name: String,
    pub point: Vector<f64>,
    /// Unit normal of the ground, toward the robot.
    pub normal: Vector<f64>,
    /// In m/s.
    pub velocity_before: Vector<f64>,
}

/// The impulse of the ground on each contact \[N s\], and its velocity after the impact \[m/s\].
#[derive(Debug, Clone)]
pub struct DrawnOutcome {
    pub impulse: Vec<Vector<f64>>,
    pub velocity_after: Vec<Vector<f64>>,
}

/// A vector, in its own unit, at the point where it acts \[m\].
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Arrow {
    pub point: Vector<f64>,
    pub vector: Vector<f64>,
}

/// A bone that is shorter than this share of the robot's size has no visible direction.
const SHORT: f64 = 0.02;

impl Drawing {
    /// A robot with its bodies at `placement` and the feet that are `named` in addition to its own shapes.
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

    /// A state of the robot and every outcome of its impact; `feet` are those in addition to its own shapes.
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
            drawing.joints.push(ends[0].1);
        }
        let turned = |pairs: &[Pair<f64>]| -> Vec<Vector<f64>> {
            impact.contacts.iter().zip(pairs).map(|(contact, &pair)| contact.ground.apply(pair.into())).collect()
        };
        let contacts = impact.contacts.iter().zip(turned(&impact.velocity_before));
        let contact = |(contact, velocity_before): (&Contact, _)| DrawnContact {
            name: contact.name.clone(),
            point: contact.point,
            normal: contact.normal(),
            velocity_before,
        };
        drawing.contacts = contacts.map(contact).collect();
        let outcome = |outcome: &Outcome| DrawnOutcome {
            impulse: turned(&outcome.impulse),
            velocity_after: turned(&outcome.velocity_after),
        };
        let outcomes = impact.analysis.iter().flat_map(|analysis| &analysis.outcomes);
        drawing.outcomes = outcomes.map(outcome).collect();
        let applied = scene.impulses.iter();
        drawing.applied = applied
            .map(|applied| Arrow { point: in_world(applied.link, applied.offset), vector: applied.vector })
            .collect();
        drawing.ground = drawing.extent().surface(&scene.ground, drawing.size());
        drawing
    }

    /// Everything except the ground and the arrows.
    pub fn extent(&self) -> Extent {
        let bodies = self.bodies.iter().flat_map(|body| body.drawn().chain(body.com.map(|com| body.world(com))));
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

    /// Points in the world that its bones and shapes lie between.
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
        let drawn = Extent::of(self.drawn()).widened(short);
        let com = self.com.map(|com| self.world(com));
        self.bones.extend(com.filter(|&com| !drawn.holds(com)));
    }
}

#[cfg(test)]
mod tests;
