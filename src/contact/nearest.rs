//! The open foot that is nearest to the ground, and how far a robot must rise to put its lowest foot on it.

use super::Contact;
use super::detect::Footing;
use super::face::Face;
use super::feet::Foot;
use super::outline::Outline;
use super::placement::Placement;
use super::point::{Point, Touch, points};
use super::profile;
use super::surface::Surface;
use super::terrain::Terrain;
use crate::error::{Error, Reason, Result};
use crate::planar::Vector;

/// A sole whose other end is lower than this part of the way to it is meant to be flat on the ground.
const FLAT: f64 = 0.1;

impl Footing<'_> {
    /// The lowest foot that does not touch, as the contact that it would make; `None` if every foot touches. A body
    /// that makes one of the `contacts` alone also has an open foot if its sole is nearly flat on the ground.
    pub fn nearest(&self, contacts: &[Contact]) -> Option<Contact> {
        let Self { placement, surface, .. } = self;
        let mut nearest: Option<Contact> = None;
        for foot in self.feet.iter() {
            let gap = nearest.as_ref().map_or(f64::INFINITY, |nearest| nearest.gap);
            if surface.least_gap(foot, placement) >= gap {
                continue;
            }
            let body = |body: usize| self.robot.rigid_body(body);
            let mut of_body = contacts.iter().filter(|contact| body(contact.body) == body(foot.body));
            let touch = match (of_body.next(), of_body.next()) {
                (None, _) => surface.first_touch(foot, placement),
                (Some(contact), None) => surface.raised_end(foot, placement, contact),
                _ => None,
            };
            if let Some(touch) = touch.filter(|touch| touch.gap < gap) {
                nearest = Some(self.contact(foot.link, touch));
            }
        }
        nearest
    }

    /// The feet of bodies that make none of the `contacts` and are no more than so high above the ground, each as the
    /// contact that it would make.
    pub fn near(&self, contacts: &[Contact], height: f64) -> Vec<Contact> {
        let Self { placement, surface, .. } = self;
        let body = |body: usize| self.robot.rigid_body(body);
        let is_open = |foot: &&Foot| contacts.iter().all(|contact| body(contact.body) != body(foot.body));
        let is_near = |foot: &&Foot| !surface.is_out_of_reach(foot, placement, height);
        let mut near: Vec<Contact> = Vec::new();
        for foot in self.feet.iter().filter(|foot| is_open(foot) && is_near(foot)) {
            let touch = surface.first_touch(foot, placement);
            let Some(own) = touch.filter(|touch| touch.gap <= height).map(|touch| self.contact(foot.link, touch))
            else {
                continue;
            };
            match near.iter_mut().find(|other| body(other.body) == body(own.body)) {
                Some(other) if own.gap < other.gap => *other = own,
                Some(_) => {}
                None => near.push(own),
            }
        }
        near
    }

    /// The link of the shape that reaches farthest below all of the `contacts` of its body, and how far \[m\].
    pub fn below_contacts(&self, contacts: &[Contact]) -> Option<(usize, f64)> {
        let Self { placement, surface, .. } = self;
        let mut farthest: Option<(usize, f64)> = None;
        for foot in self.feet.iter() {
            let body = |body: usize| self.robot.rigid_body(body);
            let of_body = contacts.iter().filter(|contact| body(contact.body) == body(foot.body));
            let Some(lowest) = of_body.map(|contact| contact.gap).reduce(f64::min) else { continue };
            let depth = farthest.map_or(0.0, |(_, depth)| depth);
            if lowest - surface.least_gap(foot, placement) <= depth {
                continue;
            }
            let touch = surface.first_touch(foot, placement);
            let below = touch.map(|touch| (foot.link, lowest - touch.gap));
            farthest = below.filter(|(_, own)| *own > depth).or(farthest);
        }
        farthest
    }

    /// Rises at which a corner of the profile is inside of a foot: one that reaches beyond both ends of the profile has no
    /// corner above it, and from below does not seem to be in it.
    fn around(&self, terrain: &Terrain) -> impl Iterator<Item = f64> {
        let corners = move || (0..=terrain.segments().len()).map(|corner| terrain.at_corner(corner)[0].to);
        self.feet.iter().flat_map(move |foot| {
            let outline = Outline::new(foot, self.placement);
            let [low, high] = outline.region(0.0);
            corners().filter(move |corner| (low.x..=high.x).contains(&corner.x)).map(move |corner| {
                let of_sides = outline.bones.iter().filter_map(|Face { from, to, .. }| {
                    let share = (corner.x - from.x) / (to.x - from.x);
                    (0.0..=1.0).contains(&share).then_some(from.z + share * (to.z - from.z))
                });
                let (least, most) =
                    of_sides.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), z| (least.min(z), most.max(z)));
                let near =
                    |a: &&Vector<f64>, b: &&Vector<f64>| (a.x - corner.x).abs().total_cmp(&(b.x - corner.x).abs());
                // Beside all sides it may still be within a corner's rim.
                let beside = || outline.corners.iter().min_by(near).map_or(0.0, |nearest| nearest.z);
                corner.z - if least <= most { 0.5 * (least + most) } else { beside() }
            })
        })
    }

    /// How far the robot must rise along z so that the lowest of its feet, or of the named contacts, is on the ground
    /// \[m\].
    ///
    /// # Errors
    /// [`Reason::Inconsistent`] if no foot is above the ground.
    pub fn rise(&self) -> Result<f64> {
        let of_named = |placement: &Placement| {
            let gap = |contact| self.surface.touch(placement, Point::named(self.robot, contact), 0.0).gap;
            self.named().map(|named| named.iter().map(gap).fold(f64::INFINITY, f64::min))
        };
        let rise = match self.surface {
            Surface::HalfPlane(plane) => {
                let of_feet = || self.feet.iter().map(|foot| plane.clearance(foot, self.placement));
                let gap = of_named(self.placement).unwrap_or_else(|| of_feet().fold(f64::INFINITY, f64::min));
                Some(-gap / plane.normal.z)
            }
            Surface::Profile(terrain) => {
                let size = self.feet.size();
                let is_above = |rise: f64| {
                    let placement = self.placement.raised(rise);
                    let rounding = profile::rounding(&placement, size);
                    let is_clear = |foot| profile::is_clear(terrain, foot, &placement, rounding);
                    of_named(&placement).map_or_else(|| self.feet.iter().all(is_clear), |gap| gap > 0.0)
                };
                first_above(is_above, size, self.around(terrain))
            }
        };
        rise.filter(|rise| rise.is_finite()).ok_or_else(|| {
            let (reason, remedy) = match self.named().is_none() && self.feet.iter().next().is_none() {
                true => ("the robot has no feet", ""),
                false => ("no foot is above the ground", ", or move the base above the ground"),
            };
            let hint = format!("name a contact point by `contacts` in the state or by `feet`{remedy}");
            Error::new(Reason::Inconsistent(reason.into())).at("place").hint(hint)
        })
    }
}

/// The least rise from which on all `is_above`; the search begins with steps of `size` \[m\] or, if it is below there and
/// higher, at the highest of some `others`.
fn first_above(is_above: impl Fn(f64) -> bool, size: f64, others: impl Iterator<Item = f64>) -> Option<f64> {
    let steps = || std::iter::successors(Some(size), |step| Some(2.0 * step)).take_while(|step| step.is_finite());
    let is_below = |rise: &f64| !is_above(*rise);
    let mut others: Vec<f64> = others.collect();
    others.sort_unstable_by(|a, b| b.total_cmp(a));
    let highest = others.into_iter().find(is_below);
    let stepped = steps().map(|step| -step).find(is_below);
    let mut below = stepped.into_iter().chain(highest).reduce(f64::max)?;
    let mut above = steps().map(|step| below.max(0.0) + step).find(|&rise| is_above(rise))?;
    loop {
        let middle = below + (above - below) / 2.0;
        match middle {
            _ if middle <= below || middle >= above => return Some(above),
            _ if is_above(middle) => above = middle,
            _ => below = middle,
        }
    }
}

impl Surface {
    /// A height \[m\] that no point of a foot is below; it costs less than the foot's points.
    fn least_gap(&self, foot: &Foot, placement: &Placement) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.least_gap(foot, placement),
            Self::Profile(_) => f64::NEG_INFINITY,
        }
    }

    /// Where a foot that does not touch is nearest to the ground.
    fn first_touch(&self, foot: &Foot, placement: &Placement) -> Option<Touch> {
        match self {
            Self::HalfPlane(plane) => points(foot).map(|point| plane.touch(placement, point)).min_by(Touch::by_gap),
            Self::Profile(terrain) => profile::nearest(terrain, &Outline::new(foot, placement)),
        }
    }

    /// The lowest open point of a foot whose link makes this one contact, if its sole is nearly flat on a plane.
    fn raised_end(&self, foot: &Foot, placement: &Placement, contact: &Contact) -> Option<Touch> {
        let Self::HalfPlane(plane) = self else { return None };
        let flat = |touch: &Touch| {
            let way = plane.along(placement.world(touch.circle.body, touch.circle.center) - contact.point);
            // The way to the contact's own circle is rounding.
            let is_own = (touch.circle.body, touch.circle.center) == (contact.body, contact.center);
            !is_own && touch.gap > 0.0 && touch.gap < FLAT * way.abs()
        };
        let touches = points(foot).map(|point| plane.touch(placement, point)).filter(flat);
        touches.min_by(Touch::by_gap)
    }
}
