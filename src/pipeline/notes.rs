//! What a reader should know of a state before its answer: what has no effect, and what is perhaps in other units or another
//! pose than it was meant.

use super::{NearestFoot, Pipeline};
use crate::contact::{Contact, Placement};
use crate::dynamics::plan::PlanBody;
use crate::error::{along_normal, rounded};
use crate::planar::Vector;
use crate::state::{Ground, Scene, State};

/// A foot that comes down from no more than this part of the robot's size has nearly touched.
const NEAR_MISS: f64 = 1e-2;

/// A slope beyond this is noted \[rad\].
const STEEP: f64 = 0.8;

/// No legged robot is faster \[m/s\].
const FASTEST: f64 = 100.0;

impl Pipeline<'_> {
    /// Notes a base that is faster than any robot, as in millimeters per second.
    pub(super) fn note_speed(&self, velocity: &[f64], notes: &mut Vec<String>) {
        let base = velocity.iter().zip(["x", "z"]).take(self.robot.base_dofs());
        base.filter(|(rate, _)| rate.abs() > FASTEST).for_each(|(rate, name)| {
            notes.push(format!("velocity.base.{name} is {rate} m/s: velocities are in m/s and rad/s"));
        });
    }

    /// Notes friction and restitution of links on which nothing can touch.
    pub(super) fn note_unused_laws(&self, State { scene, uncertainty, .. }: &State, notes: &mut Vec<String>) {
        let named = |link| scene.contacts.iter().flatten().any(|contact| contact.link == link);
        let has_foot = |link| self.feet.iter().any(|foot| foot.link == link) || named(link);
        let given = scene.friction.links.keys().map(|link| ("friction", *link));
        let given = given.chain(scene.restitution.links.keys().map(|link| ("restitution", *link)));
        let uncertain = uncertainty.iter().flat_map(|uncertainty| uncertainty.friction.links.keys());
        let given = given.chain(uncertain.map(|link| ("uncertainty of friction", *link)));
        given.filter(|(_, link)| !has_foot(*link)).for_each(|(what, link)| {
            let name = &self.robot.links[link].name;
            notes.push(format!("{what} is given to {name}, which has no foot: it has no effect"));
        });
    }

    /// Notes what is odd about the contacts, the `nearest` foot that does not touch, and the ground.
    pub(super) fn note_contacts(
        &self,
        scene: &Scene,
        (contacts, nearest): (&[Contact], Option<NearestFoot>),
        placement: &Placement,
        notes: &mut Vec<String>,
    ) {
        match scene.contacts {
            Some(_) => notes.extend(nearest.and_then(|foot| self.sunk_besides(foot))),
            None => {
                notes.extend(wide_tolerance(self.tolerance(), self.feet.size()));
                self.note_near_miss(contacts, nearest, notes);
            }
        }
        notes.extend(self.upside_down(contacts, placement));
        notes.extend(steep(&scene.ground));
    }

    /// That the robot's center of mass is below all contacts, as of a robot that is drawn head down.
    fn upside_down(&self, contacts: &[Contact], placement: &Placement) -> Option<String> {
        let bodies = self.assembly.plan.bodies.iter().enumerate();
        let sum = bodies.fold((0.0, Vector::zero()), |(mass, moment), (body, PlanBody { inertia, .. })| {
            let own = placement.world(body, Vector::zero()) * inertia.mass + placement.turned(body, inertia.first);
            (mass + inertia.mass, moment + own)
        });
        let (mass, moment) = sum;
        let center = moment * (1.0 / mass);
        let above = |contact: &Contact| contact.normal().dot(contact.point - center);
        let depth = contacts.iter().map(above).reduce(f64::min).filter(|&depth| depth > 0.0 && mass > 0.0)?;
        Some(format!("the center of mass is {depth:.3} m below all contacts: is the pose upside down?"))
    }

    /// The note of a foot that is deep in the ground where other contacts are named.
    fn sunk_besides(&self, NearestFoot { link, height, .. }: NearestFoot) -> Option<String> {
        let name = &self.robot.links[link].name;
        (height < -NEAR_MISS * self.feet.size()).then(|| {
            format!(
                "{name} is {} m deep in the ground, and is not among the contacts: it takes no part",
                rounded(-height)
            )
        })
    }

    /// Notes that nothing touches, and a foot that comes down just above the ground.
    fn note_near_miss(&self, contacts: &[Contact], nearest: Option<NearestFoot>, notes: &mut Vec<String>) {
        let Some(NearestFoot { link, height, velocity }) = nearest else {
            let why =
                if self.feet.iter().next().is_none() { "the robot has no feet" } else { "no foot is above the ground" };
            if contacts.is_empty() {
                notes.push(format!("{why}: name contact points by `contacts` in the state or by `feet`"));
            }
            return;
        };
        let is_near = height > 0.0 && height <= NEAR_MISS * self.feet.size() && velocity[1] < 0.0;
        if !is_near && !contacts.is_empty() {
            return;
        }
        let name = &self.robot.links[link].name;
        let moving = along_normal(velocity);
        // A little more than the height, in two digits, next to four of the height.
        let enough = 1.1 * height;
        let height = rounded(height);
        notes.push(match (contacts.is_empty(), is_near) {
            (true, true) => format!(
                "nothing touches the ground: the lowest foot, {name}, is {height} m above it and {moving}; to let \
                 it touch, put it there by `place: lowest`, or give `contact_tolerance: {enough:.1e}`"
            ),
            (true, false) => format!(
                "nothing touches the ground: the lowest foot, {name}, is {height} m above it and {moving}; \
                 `place: lowest` puts it there"
            ),
            (false, _) => {
                let touches = contacts.iter().any(|contact| contact.link == link);
                let which = if touches { "another point of " } else { "" };
                format!(
                    "{which}{name} nearly touches, {height} m above the ground: to let it touch, give \
                     `contact_tolerance: {enough:.1e}`, or correct the pose"
                )
            }
        });
    }
}

/// That a contact tolerance exceeds the size of the robot, as one in millimeters does; both in \[m\].
pub fn wide_tolerance(tolerance: f64, size: f64) -> Option<String> {
    (tolerance > size).then(|| {
        let [tolerance, size] = [tolerance, size].map(rounded);
        format!("a contact tolerance of {tolerance} m is more than the robot's size, {size} m: is it in meters?")
    })
}

/// That the ground is steeper than a legged robot stands on, as one of 1 degree taken for 1 rad.
fn steep(ground: &Ground) -> Option<String> {
    let &Ground::Slope(slope) = ground else { return None };
    (slope.abs() > STEEP).then(|| {
        let degrees = slope.to_degrees();
        format!("the ground's slope of {slope} rad is one of {degrees:.1} degrees: was it meant in degrees?")
    })
}
