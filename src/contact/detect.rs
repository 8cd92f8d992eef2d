//! Feet against the ground: finds the points that touch, and where the base must be for a foot to stand.

use super::Contact;
use super::feet::Feet;
use super::merge::{Merged, merge};
use super::outline::Outline;
use super::placement::Placement;
use super::point::{Circle, Point, Touch};
use super::profile::{Closeness, left_behind};
use super::surface::{Sunk, Surface};
use crate::error::{Error, Reason, Result};
use crate::law::Friction;
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::{NamedContact, Scene};

/// The foot of a stance and its placement.
pub(crate) struct Stance {
    /// The standing point, with the root at zero.
    pub foot: Contact,
    /// The position of the root's origin \[m\] that puts the standing point at x = 0 and the lowest point of its link
    /// on the ground.
    pub base: Vector<f64>,
}

/// A placed robot with its feet, and the ground.
pub(crate) struct Footing<'a> {
    pub robot: &'a Robot,
    pub feet: &'a Feet,
    pub scene: &'a Scene,
    pub placement: &'a Placement,
    pub surface: &'a Surface,
}

impl Footing<'_> {
    fn name(&self, link: usize) -> &str {
        &self.robot.links[link].name
    }

    /// Returns the contact that a link makes, with the link's name.
    pub(super) fn contact(&self, link: usize, touch: Touch) -> Contact {
        let Touch { circle: Circle { body, center, offset, radius }, ground, gap } = touch;
        let (name, point) = (self.feet.name(link), self.placement.touched(&touch));
        Contact { link, name, body, center, offset, radius, point, ground, gap }
    }

    /// Returns the contacts that the scene names, which replace those of the feet; `None` if it names none.
    pub(super) fn named(&self) -> Option<&[NamedContact]> {
        self.scene.contacts.as_deref()
    }

    /// Returns the standing point of a link and the base that puts it on the ground. Requires a placement with the root
    /// at zero. Candidates are the named contacts of the link, if there are any; else the points that touch with this
    /// `tolerance` \[m\] once the lowest is on the ground. The lowest one stands; of several within `flat` \[m\], the
    /// rearmost.
    ///
    /// # Errors
    /// [`Reason::Missing`] if the link has no foot, [`Reason::Inconsistent`] if there is no ground at x = 0.
    pub fn stance(&self, link: usize, tolerance: f64, flat: f64) -> Result<Stance> {
        let Self { placement, surface, .. } = self;
        let (plane, place) = surface.stance()?;
        let rounding = surface.rounding(placement, self.feet.size());
        let feet = || self.feet.iter().filter(|foot| foot.link == link);
        let lowest = feet().map(|foot| plane.clearance(foot, placement)).fold(f64::INFINITY, f64::min);
        let candidates: Vec<Point> = match self.named() {
            Some(named) => {
                let contacts = named.iter().filter(|contact| contact.link == link);
                contacts.map(|contact| Point::named(self.robot, contact)).collect()
            }
            None => feet().flat_map(|foot| plane.sole(foot, placement, lowest + tolerance + rounding)).collect(),
        };
        let height = |point: Point| plane.height(placement, point);
        let least = candidates.iter().map(|&point| height(point)).fold(f64::INFINITY, f64::min);
        let along = |point: Point| plane.along(plane.lowest(placement, point));
        let standing = candidates.into_iter().filter(|&point| height(point) <= least + flat);
        let standing = standing.min_by(|&a, &b| along(a).total_cmp(&along(b))).ok_or_else(|| {
            let (what, hint) = match self.named() {
                Some(_) => ("one of the named contacts, on", "they replace all feet: name one, or add this one"),
                None => ("a collision shape of", "name a link with a foot, or give its point in `contacts`"),
            };
            let what = format!("{what} link \"{}\"", self.name(link));
            Error::new(Reason::Missing(what)).at("stance").hint(hint)
        })?;
        let foot = self.contact(link, plane.touch(placement, standing));
        let above = height(standing) - lowest;
        let lift = if self.named().is_none() && above > rounding { foot.normal() * above } else { Vector::zero() };
        Ok(Stance { base: place - foot.point + lift, foot })
    }

    /// Returns all closed contacts, and those that were merged. Named contacts count at any height. Without them, these
    /// are the outer two of every foot within `tolerance` \[m\] of the ground, sorted by link and then along the
    /// tangent of a plane or x of a profile. A contact has the name of its link, and a number if the link has several
    /// contacts. With `merges`, contacts between the outer two of a body are left out, except the `standing` one. The
    /// memory of `contacts` is reused.
    ///
    /// # Errors
    /// [`Reason::Penetration`] for the deepest foot, if one is deeper than the tolerance.
    pub fn contacts(
        &self,
        tolerance: f64,
        merges: bool,
        standing: Option<&Contact>,
        mut contacts: Vec<Contact>,
    ) -> Result<(Vec<Contact>, Vec<Merged>)> {
        let mut merged = Vec::new();
        contacts.clear();
        match self.named() {
            Some(named) => {
                let touch = |contact| self.surface.touch(self.placement, Point::named(self.robot, contact), tolerance);
                contacts.extend(named.iter().map(|contact| self.contact(contact.link, touch(contact))));
            }
            None => self.detect(tolerance, &mut contacts)?,
        }
        if merges && self.named().is_none() {
            let stays = |contact: &Contact| standing.is_some_and(|foot| foot.has_circle_of(contact));
            let rounding = self.surface.rounding(self.placement, self.feet.size());
            let together = |a: &Contact, b: &Contact| self.acts_as(a, b, rounding);
            merged = merge(&mut contacts, together, stays, |contact| self.lean(contact), rounding);
        }
        let has_twin = |at: usize| contacts[..at].iter().any(|other: &Contact| other.link == contacts[at].link);
        if (0..contacts.len()).any(has_twin) {
            let mut counts = vec![(0, 0); self.robot.links.len()];
            contacts.iter().for_each(|contact| counts[contact.link].0 += 1);
            for contact in &mut contacts {
                let (all, next) = &mut counts[contact.link];
                if *all > 1 {
                    contact.name = self.feet.numbered(&contact.name, *next).into();
                }
                *next += 1;
            }
        }
        Ok((contacts, merged))
    }

    /// Returns whether two contacts are on one rigid body, at one line of ground up to `rounding` \[m\], and have the
    /// same friction and restitution.
    fn acts_as(&self, a: &Contact, b: &Contact, rounding: f64) -> bool {
        let Scene { friction, restitution, .. } = self.scene;
        let body = |contact: &Contact| self.robot.rigid_body(contact.body);
        let bounce = |contact: &Contact| restitution.of(contact.link).unwrap_or(0.0);
        body(a) == body(b)
            && a.ground == b.ground
            && (a.normal().dot(a.point - b.point) - (a.gap - b.gap)).abs() <= 4.0 * rounding
            && friction.of(a.link) == friction.of(b.link)
            && bounce(a) == bounce(b)
    }

    /// Returns the slope of the edges of a contact's friction cone against the normal. `None` if the contact has both
    /// friction and restitution, because its height then matters, or if its friction is unknown.
    fn lean(&self, contact: &Contact) -> Option<f64> {
        let Scene { friction, restitution, .. } = self.scene;
        let lean = match friction.of(contact.link)? {
            Friction::Finite(mu) => mu,
            Friction::Infinite => f64::INFINITY,
        };
        let bounces = restitution.of(contact.link).is_some_and(|bounce| bounce > 0.0);
        (lean == 0.0 || !bounces).then_some(lean)
    }

    fn detect(&self, tolerance: f64, contacts: &mut Vec<Contact>) -> Result<()> {
        let Self { feet, placement, surface, .. } = self;
        let rounding = surface.rounding(placement, feet.size());
        if rounding > feet.size() {
            let reason =
                format!("the base is so far from the world's origin that heights are rounded by {rounding:.1e} m");
            return Err(Error::new(Reason::Inconsistent(reason)).hint("move the scene to the world's origin"));
        }
        let tolerance = tolerance + rounding;
        let mut deepest: Option<(usize, f64, String)> = None;
        for foot in feet.iter() {
            let found = |touch| {
                let contact = self.contact(foot.link, touch);
                // Shapes of a link may share a corner, which is one contact.
                if !contacts.iter().any(|other| surface.is_same(other, &contact, rounding)) {
                    contacts.push(contact);
                }
            };
            match surface.touching(foot, placement, Closeness { tolerance, rounding }, found) {
                Err(Sunk { depth, remedy }) if deepest.as_ref().is_none_or(|(_, other, _)| depth > *other) => {
                    deepest = Some((foot.link, depth, remedy));
                }
                _ => {}
            }
        }
        if let Some((link, depth, remedy)) = deepest {
            let link = self.name(link).to_owned();
            return Err(Error::new(Reason::Penetration { link, depth, tolerance, velocity: None }).hint(remedy));
        }
        contacts.sort_by(|a, b| a.link.cmp(&b.link).then(surface.along(a.point).total_cmp(&surface.along(b.point))));
        Ok(())
    }

    /// Returns the number of feet that are too far from the ground to touch with this `tolerance` \[m\].
    pub fn out_of_reach(&self, tolerance: f64) -> usize {
        let tolerance = tolerance + self.surface.rounding(self.placement, self.feet.size());
        self.feet.iter().filter(|foot| self.surface.is_out_of_reach(foot, self.placement, tolerance)).count()
    }

    /// Returns the links of feet that reach beyond an end of the profile, at most `tolerance` \[m\] above it, and x of
    /// that end \[m\].
    pub fn left_behind(&self, tolerance: f64) -> Vec<(&str, f64)> {
        let Surface::Profile(terrain) = self.surface else { return Vec::new() };
        let mut found: Vec<(usize, f64)> = Vec::new();
        for foot in self.feet.iter() {
            let end = left_behind(terrain, &Outline::new(foot, self.placement), tolerance).map(|end| (foot.link, end));
            found.extend(end.filter(|end| !found.contains(end)));
        }
        found.into_iter().map(|(link, end)| (self.name(link), end)).collect()
    }
}
