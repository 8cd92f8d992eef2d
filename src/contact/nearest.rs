//! Finds the open foot nearest to the ground, and the rise along z that puts a robot's lowest foot on the ground.

use super::detect::Footing;
use super::face::Face;
use super::feet::Foot;
use super::outline::Outline;
use super::placement::Placement;
use super::point::{Point, Touch, points};
use super::surface::Surface;
use super::terrain::Terrain;
use super::{Contact, profile};
use crate::error::{Error, Reason, Result};
use crate::planar::Vector;

/// A sole that touches at one end counts as nearly flat if its other end is lower than this fraction of its length.
const FLAT: f64 = 0.1;

impl Footing<'_> {
    /// Returns the lowest foot that does not touch, as the contact that it would make; `None` if every foot touches. On
    /// a body that makes only one of the `contacts`, the raised end of a nearly flat sole counts as a foot, too.
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

    /// Returns, for each body that makes none of the `contacts`, its lowest foot as the contact that it would make, if
    /// that foot is at most `height` \[m\] above the ground.
    pub fn near(&self, contacts: &[Contact], height: f64) -> Vec<Contact> {
        let Self { placement, surface, .. } = self;
        let body = |body: usize| self.robot.rigid_body(body);
        let is_open = |foot: &&Foot| contacts.iter().all(|contact| body(contact.body) != body(foot.body));
        let is_near = |foot: &&Foot| !surface.is_out_of_reach(foot, placement, height);
        let mut near: Vec<Contact> = Vec::new();
        for foot in self.feet.iter().filter(|foot| is_open(foot) && is_near(foot)) {
            let touch = surface.first_touch(foot, placement);
            let Some(contact) = touch.filter(|touch| touch.gap <= height).map(|touch| self.contact(foot.link, touch))
            else {
                continue;
            };
            match near.iter_mut().find(|other| body(other.body) == body(contact.body)) {
                Some(other) if contact.gap < other.gap => *other = contact,
                Some(_) => {}
                None => near.push(contact),
            }
        }
        near
    }

    /// Returns the link of the shape that reaches farthest below all `contacts` of its body, and how far \[m\]; `None`
    /// if no shape does.
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
            farthest = below.filter(|(_, below)| *below > depth).or(farthest);
        }
        farthest
    }

    /// Returns rises along z \[m\] at which a corner of the profile is inside of a foot. They reveal feet that reach
    /// beyond both ends of the profile, which have no corner in the ground, however low they are.
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
                // A ground corner past all sides may still be within the rim of a foot's corner.
                let beside = || outline.corners.iter().min_by(near).map_or(0.0, |nearest| nearest.z);
                corner.z - if least <= most { 0.5 * (least + most) } else { beside() }
            })
        })
    }

    /// Returns the rise along z \[m\] that puts the lowest foot or named contact of the robot on the ground.
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

/// Returns, by bisection, the rise \[m\] from which on `is_above` holds; `None` if it holds always or never. The lower
/// end of the search is the highest rise that is not above the ground: of the `others`, and of steps down that begin
/// with `size` \[m\] and double. Steps of the same lengths lead to the upper end.
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
    /// Returns a lower bound on the height of all points of a foot \[m\]. It costs less than the points themselves.
    fn least_gap(&self, foot: &Foot, placement: &Placement) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.least_gap(foot, placement),
            Self::Profile(_) => f64::NEG_INFINITY,
        }
    }

    /// Returns where a foot that does not touch is nearest to the ground.
    fn first_touch(&self, foot: &Foot, placement: &Placement) -> Option<Touch> {
        match self {
            Self::HalfPlane(plane) => points(foot).map(|point| plane.touch(placement, point)).min_by(Touch::by_gap),
            Self::Profile(terrain) => profile::nearest(terrain, &Outline::new(foot, placement)),
        }
    }

    /// Returns the lowest open point of a foot whose body makes only this contact, if its sole is nearly flat on a
    /// plane; `None` on a profile.
    fn raised_end(&self, foot: &Foot, placement: &Placement, contact: &Contact) -> Option<Touch> {
        let Self::HalfPlane(plane) = self else { return None };
        let flat = |touch: &Touch| {
            let way = plane.along(placement.world(touch.circle.body, touch.circle.center) - contact.point);
            // The contact's own circle is only rounding away from it.
            let is_own = (touch.circle.body, touch.circle.center) == (contact.body, contact.center);
            !is_own && touch.gap > 0.0 && touch.gap < FLAT * way.abs()
        };
        let touches = points(foot).map(|point| plane.touch(placement, point)).filter(flat);
        touches.min_by(Touch::by_gap)
    }
}
