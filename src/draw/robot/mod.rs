//! A robot where it is, what it touches and what happens to it, as points, outlines and arrows of the plane.
//!
//! ```text
//!     Robot + body poses + feet            --> bodies: bones, outlines, CoG; joints      outline.rs
//!     Impact (contacts, outcomes) + ground --> contacts, arrows per outcome, ground      arrows.rs, mod.rs
//!     Drawing --> JSON (its own fields), a picture per outcome                           picture.rs
//! ```
//!
//! Everything is in the world's axes, `[x, z]` in metres, with six digits: it is there to be looked at.

mod arrows;
mod extent;
mod outline;
#[cfg(feature = "plot")]
pub mod picture;

pub use arrows::{Arrow, Effect};
pub use extent::Extent;
pub use outline::Outline;

use crate::contact::{Feet, Placement};
use crate::pipeline::Impact;
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::NamedContact;
use crate::state::State;
use serde::Serialize;

/// A robot where it is, and what happens to it.
#[derive(Debug, Clone, Serialize)]
pub struct Drawing {
    /// Rigid bodies, in the robot's order.
    pub bodies: Vec<Body>,
    /// Where joints are, and where loops are closed.
    pub joints: Vec<Vector<f64>>,
    /// The ground's surface from left to right, as far as the drawing reaches; empty where there is none.
    pub ground: Vec<Vector<f64>>,
    /// The closed contacts.
    pub contacts: Vec<Touch>,
    /// Impulses that the state applies \[N s\].
    pub applied: Vec<Arrow>,
    /// Every outcome.
    pub outcomes: Vec<Effect>,
    /// How long an impulse of 1 N s is drawn, the same for all outcomes \[m\].
    pub impulse_scale: f64,
    /// How long a velocity of 1 m/s is drawn, the same for all outcomes \[m\].
    pub velocity_scale: f64,
}

/// A rigid body.
#[derive(Debug, Clone, Serialize)]
pub struct Body {
    /// Its frame's origin, where its joint is.
    pub origin: Vector<f64>,
    /// The ends of its bones, which all begin at its origin: joints of its children, shapes, a CoG beside all of them.
    pub bones: Vec<Vector<f64>>,
    /// Its collision shapes.
    pub outlines: Vec<Outline>,
    /// Whether no joint hangs on it.
    pub last: bool,
    /// Its CoG; none of a massless one.
    pub com: Option<Vector<f64>>,
    /// Its mass \[kg\].
    pub mass: f64,
}

/// A closed contact.
#[derive(Debug, Clone, Serialize)]
pub struct Touch {
    /// Its name.
    pub name: String,
    /// Where.
    pub point: Vector<f64>,
    /// Unit normal of the ground, toward the robot.
    pub normal: Vector<f64>,
    /// Its velocity before the impact \[m/s\].
    pub velocity_before: Vector<f64>,
}

/// Of the robot's size: what a bone that is shorter has no direction of.
const SHORT: f64 = 0.02;

impl Drawing {
    /// A robot with its bodies at `placement` and, beside its own shapes, the feet that are `named`.
    pub fn of_robot(robot: &Robot, placement: &Placement, named: &[NamedContact]) -> Self {
        let mut bodies: Vec<Body> = robot
            .bodies
            .iter()
            .enumerate()
            .map(|(at, body)| Body {
                origin: placement.world(at, Vector::zero()),
                bones: Vec::new(),
                outlines: Vec::new(),
                last: true,
                com: (body.mass > 0.0).then(|| placement.world(at, body.com)),
                mass: body.mass,
            })
            .collect();
        for foot in Feet::new(robot, named).iter() {
            bodies[foot.body].outlines.push(Outline::of_shape(&foot.outline, placement, foot.body));
        }
        let mut joints = Vec::new();
        for (at, body) in robot.bodies.iter().enumerate() {
            let Some((parent, _, axis)) = body.joint.map(|mover| robot.hinge(mover)) else { continue };
            let origin = bodies[at].origin;
            bodies[parent].bones.push(origin);
            bodies[parent].last = false;
            if axis.is_some() {
                joints.push(origin);
            }
        }
        let mut drawing = Self {
            bodies,
            joints,
            ground: Vec::new(),
            contacts: Vec::new(),
            applied: Vec::new(),
            outcomes: Vec::new(),
            impulse_scale: 0.0,
            velocity_scale: 0.0,
        };
        let size = drawing.extent().size();
        drawing.bodies.iter_mut().for_each(|body| body.grow_bones(SHORT * size));
        drawing.round(size);
        drawing
    }

    /// A state of the robot and every outcome of its impact; `feet` are those beside its own shapes.
    pub fn of_impact(robot: &Robot, feet: &[NamedContact], state: &State, impact: &Impact) -> Self {
        let State { scene, .. } = state;
        let placement = &impact.placement;
        let named: Vec<NamedContact> = feet.iter().chain(scene.contacts.iter().flatten()).copied().collect();
        let mut drawing = Self::of_robot(robot, placement, &named);
        // A single point is drawn as if it were a metre long.
        let size = Some(drawing.extent().size()).filter(|&size| size > 0.0).unwrap_or(1.0);
        for pin in &scene.loops {
            let ends = [pin.a, pin.b].map(|end| {
                let link = &robot.links[end.link];
                let point = placement.world(link.body, link.point(end.offset));
                drawing.bodies[link.body].bones.push(point);
                point
            });
            drawing.joints.push(ends[0]);
        }
        drawing.act(robot, state, impact, size);
        drawing.ground = drawing.extent().surface(&scene.ground, size);
        drawing.round(size);
        drawing
    }

    /// All that is drawn but the ground and the arrows.
    pub fn extent(&self) -> Extent {
        let bodies = self.bodies.iter().flat_map(|body| {
            let outlines = body.outlines.iter().flat_map(Outline::corners);
            body.bones.iter().copied().chain([body.origin]).chain(body.com).chain(outlines)
        });
        let contacts = self.contacts.iter().map(|contact| contact.point);
        Extent::of(bodies.chain(contacts))
    }

    /// Keeps six digits of every place, of a robot of this size \[m\].
    fn round(&mut self, size: f64) {
        let unit = libm::pow(10.0, libm::floor(libm::log10(size)) - 5.0);
        let round = |point: &mut Vector<f64>| {
            if unit > 0.0 && unit.is_finite() {
                *point = point.map(|entry| {
                    let whole = (entry / unit).round();
                    // A quotient by a power of ten has fewer digits than a product has.
                    if unit < 1.0 { whole / (1.0 / unit).round() } else { whole * unit }
                });
            }
        };
        for body in &mut self.bodies {
            round(&mut body.origin);
            body.bones.iter_mut().for_each(round);
            body.com.iter_mut().for_each(round);
            body.outlines.iter_mut().for_each(|outline| outline.places(round));
        }
        self.joints.iter_mut().for_each(round);
        self.ground.iter_mut().for_each(round);
        self.contacts.iter_mut().for_each(|contact| round(&mut contact.point));
        self.applied.iter_mut().for_each(|arrow| round(&mut arrow.point));
    }
}

impl Body {
    /// Adds bones to the shapes of a body that ends there, and to a CoG that lies on nothing that is drawn; `short` is the
    /// length below which a bone shows nothing \[m\].
    fn grow_bones(&mut self, short: f64) {
        let origin = self.origin;
        let is_long = |end: &Vector<f64>| {
            let Vector { x, z } = *end - origin;
            libm::hypot(x, z) > short
        };
        self.bones.retain(is_long);
        if self.last || self.bones.is_empty() {
            self.bones.extend(self.outlines.iter().map(Outline::center).filter(is_long));
        }
        let drawn = self.bones.iter().copied().chain([origin]).chain(self.outlines.iter().flat_map(Outline::corners));
        let drawn = Extent::of(drawn).widened(short);
        self.bones.extend(self.com.filter(|&com| !drawn.holds(com)));
    }
}

#[cfg(test)]
mod tests;
