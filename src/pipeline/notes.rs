//! Notes on a state before its answer: inputs without effect, and inputs that may have other units or another pose than
//! was meant.

use super::{NearestFoot, Pipeline};
use crate::contact::{Contact, Footing, Placement};
use crate::dynamics::plan::PlanBody;
use crate::error::{along_normal, rounded};
use crate::impact::Outcome;
use crate::planar::Vector;
use crate::state::{Scene, State};

/// Greatest height of a falling foot that nearly touches, and least noted depth, as a fraction of the robot's size.
const NEAR_MISS: f64 = 1e-2;

/// Greatest height of a resting foot that nearly stands, as a fraction of the robot's size.
const STANDS: f64 = 1e-4;

/// A foot that leaves the ground more slowly than this counts as resting \[m/s\].
const SLOW: f64 = 1e-2;

/// Contacts of two bodies whose distance is at most this fraction of the robot's size may be meant to be at the same
/// place: exporters round angles and lengths to 4 to 6 digits. An outcome may depend on that if its margin is smaller
/// than this.
const THIN: f64 = 1e-5;

/// Named contacts whose heights differ by more than this fraction of the robot's size cannot both touch the ground.
const UNEVEN: f64 = 0.1;

impl Pipeline<'_> {
    /// Notes friction and restitution of links that have no foot.
    pub(super) fn note_unused_laws(&self, State { scene, uncertainty, .. }: &State, notes: &mut Vec<String>) {
        let named = |link| scene.contacts.iter().flatten().any(|contact| contact.link == link);
        let has_foot = |link| self.feet.iter().any(|foot| foot.link == link) || named(link);
        let given = scene.friction.links.keys().map(|link| ("friction", *link));
        let given = given.chain(scene.restitution.links.keys().map(|link| ("restitution", *link)));
        let uncertain = uncertainty.iter().flat_map(|uncertainty| uncertainty.friction.links.keys());
        let given = given.chain(uncertain.map(|link| ("uncertainty of friction", *link)));
        notes.extend(given.filter(|(_, link)| !has_foot(*link)).map(|(what, link)| {
            format!("{what} is given to {}, which has no foot: it has no effect", self.robot.links[link].name)
        }));
    }

    /// Notes what is unusual about the contacts, the feet that nearly touch (`nearest` and `near`), and the ground.
    pub(super) fn note_contacts(
        &self,
        scene: &Scene,
        (contacts, nearest, near): (&[Contact], Option<NearestFoot>, &[NearestFoot]),
        (placement, footing): (&Placement, &Footing),
        notes: &mut Vec<String>,
    ) {
        match scene.contacts {
            Some(_) => {
                notes.extend(nearest.and_then(|foot| self.sunk_besides(foot)));
                if self.options.aspect.is_impact() {
                    notes.extend(self.uneven(contacts));
                    notes.extend(self.doubled(contacts));
                }
                notes.extend(footing.below_contacts(contacts).and_then(|below| self.inside(below)));
            }
            None => {
                notes.extend(beyond_size("a contact tolerance", self.tolerance(), self.feet.size()));
                self.note_near_misses(contacts, nearest, near, notes);
            }
        }
        notes.extend(self.upside_down(contacts, placement));
    }

    /// Notes an outcome that depends on the distance of two contacts that are nearly at the same place.
    pub(super) fn nearly_one(&self, contacts: &[Contact], outcomes: &[Outcome]) -> Option<String> {
        let is_thin = |outcome: &Outcome| outcome.margin.is_some_and(|margin| margin > 0.0 && margin < THIN);
        if !outcomes.iter().any(is_thin) {
            return None;
        }
        let others = |at: usize| contacts[..at].iter().filter(move |other| other.body != contacts[at].body);
        let pairs = (0..contacts.len()).flat_map(|at| others(at).map(move |other| (other, &contacts[at])));
        let mut pairs = pairs.map(|(a, b)| (a, b, (a.point - b.point).length()));
        let (a, b, distance) = pairs.find(|(.., distance)| *distance <= THIN * self.feet.size())?;
        let apart = if distance > THIN * THIN * self.feet.size() {
            format!("{distance:.1e} m apart; the outcome may depend on this distance, which may be rounding")
        } else {
            "at the same place except for last digits; the outcome may depend on those digits".to_owned()
        };
        Some(format!("{} and {} are {apart} of the robot or its pose", a.name, b.name))
    }

    /// Notes that the robot's center of mass is below all contacts, as it is if the robot is upside down.
    fn upside_down(&self, contacts: &[Contact], placement: &Placement) -> Option<String> {
        let bodies = self.assembly.plan.bodies.iter().enumerate();
        let start = (0.0, Vector::zero());
        let (mass, moment) = bodies.fold(start, |(mass, moment), (body, PlanBody { inertia, .. })| {
            let first = placement.world(body, Vector::zero()) * inertia.mass + placement.turned(body, inertia.first);
            (mass + inertia.mass, moment + first)
        });
        let center = moment * (1.0 / mass);
        let above = |contact: &Contact| contact.normal().dot(contact.point - center);
        let depth = contacts.iter().map(above).reduce(f64::min).filter(|&depth| depth > 0.0 && mass > 0.0)?;
        Some(format!("the center of mass is {depth:.3} m below all contacts: is the pose upside down?"))
    }

    /// Notes that a link reaches this depth \[m\] below the named contacts of its body.
    fn inside(&self, (link, depth): (usize, f64)) -> Option<String> {
        let name = &self.robot.links[link].name;
        (depth > self.near_miss()).then(|| {
            format!(
                "{name} reaches {} m below the contact that is named on its body: is a radius or another contact missing?",
                rounded(depth)
            )
        })
    }

    /// Notes that a contact is named twice.
    fn doubled(&self, contacts: &[Contact]) -> Option<String> {
        let place = |contact: &Contact| (contact.link, contact.offset, contact.radius);
        let is_known = |at: &usize| contacts[..*at].iter().any(|other| place(other) == place(&contacts[*at]));
        let name = &self.robot.links[contacts[(1..contacts.len()).find(is_known)?].link].name;
        Some(format!("a contact of {name} is named twice: its impulse is shared by both"))
    }

    /// Notes that one of the named contacts is high above another one.
    fn uneven(&self, contacts: &[Contact]) -> Option<String> {
        let by_height = |a: &&Contact, b: &&Contact| a.gap.total_cmp(&b.gap);
        let (lowest, highest) = (contacts.iter().min_by(by_height)?, contacts.iter().max_by(by_height)?);
        let height = highest.gap - lowest.gap;
        (height > UNEVEN * self.feet.size()).then(|| {
            let [high, low] = [highest, lowest].map(|contact| &contact.name);
            format!("{high} is {} m higher above the ground than {low}: both are taken to touch it", rounded(height))
        })
    }

    /// Notes that a foot is deep in the ground while other contacts are named.
    fn sunk_besides(&self, NearestFoot { link, height, .. }: NearestFoot) -> Option<String> {
        let name = &self.robot.links[link].name;
        (height < -self.near_miss()).then(|| {
            format!(
                "{name} is {} m deep in the ground, and is not among the contacts: it takes no part",
                rounded(-height)
            )
        })
    }

    /// Greatest height above the ground at which a falling foot has nearly touched \[m\].
    pub(super) fn near_miss(&self) -> f64 {
        NEAR_MISS * self.feet.size()
    }

    /// Notes that nothing touches, and feet that come down or stand just above the ground: the `nearest` one, and those
    /// of other bodies without contacts (`near`).
    fn note_near_misses(
        &self,
        contacts: &[Contact],
        nearest: Option<NearestFoot>,
        near: &[NearestFoot],
        notes: &mut Vec<String>,
    ) {
        let is_near = |NearestFoot { height, velocity, .. }: &NearestFoot| {
            let comes = *height <= self.near_miss() && velocity[1] < 0.0;
            let stands = *height <= STANDS * self.feet.size() && velocity[1] < SLOW;
            *height > 0.0 && (comes || stands)
        };
        // A little more than the height, because it is printed with two digits and the height with four. The bumps are
        // added so that an uneven sole stands on as many corners as with the default tolerance.
        let bumps = self.feet.iter().map(|foot| foot.bumps).fold(0.0, f64::max);
        let enough = |height: f64| 1.1 * height + bumps;
        if !contacts.is_empty() {
            let another = nearest.filter(|foot| near.iter().all(|other| other.link != foot.link));
            for &NearestFoot { link, height, .. } in another.iter().chain(near).filter(|foot| is_near(foot)) {
                let touches = contacts.iter().any(|contact| contact.link == link);
                let which = if touches { "another point of " } else { "" };
                notes.push(format!(
                    "{which}{} nearly touches, {} m above the ground: to let it touch, give the option \
                     `contact_tolerance: {:.1e}`, or correct the pose",
                    self.robot.links[link].name,
                    rounded(height),
                    enough(height)
                ));
            }
            return;
        }
        let Some(foot) = nearest else {
            let why =
                if self.feet.iter().next().is_none() { "the robot has no feet" } else { "no foot is above the ground" };
            notes.push(format!("{why}: name contact points by `contacts` in the state or by `feet`"));
            return;
        };
        let by_base = if self.assembly.plan.floating { "`place: lowest`" } else { "its joints" };
        let remedy = match is_near(&foot) {
            true => format!(
                "to let it touch, put it there by {by_base}, or by the option `contact_tolerance: {:.1e}`",
                enough(foot.height)
            ),
            false => format!("put it there by {by_base}"),
        };
        notes.push(format!(
            "nothing touches the ground: the lowest foot, {}, is {} m above it and {}; {remedy}",
            self.robot.links[foot.link].name,
            rounded(foot.height),
            along_normal(foot.velocity)
        ));
    }
}

/// Notes that a length, such as a contact tolerance, exceeds the robot's size, as one in millimeters does; both in
/// \[m\].
pub fn beyond_size(what: &str, length: f64, size: f64) -> Option<String> {
    (length > size).then(|| {
        let [length, size] = [length, size].map(rounded);
        format!("{what} of {length} m is more than the robot's size, {size} m: is it in meters?")
    })
}
