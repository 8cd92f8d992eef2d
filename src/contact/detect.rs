//! Feet against the ground: which points touch, and where the base must be for a foot to stand.

use super::Contact;
use super::feet::Feet;
use super::placement::Placement;
use super::point::{Point, Touch, points};
use super::surface::{Sunk, Surface};
use crate::error::{Error, Reason, Result};
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::NamedContact;

impl Contact {
    fn of_touch(link: usize, placement: &Placement, Touch { circle, ground, gap }: Touch) -> Self {
        let mut contact = Self {
            link,
            name: String::new(),
            body: circle.body,
            centre: circle.centre,
            offset: circle.offset,
            radius: circle.radius,
            point: placement.world(circle.body, circle.centre),
            ground,
            gap,
        };
        contact.point = contact.point - contact.normal() * circle.radius;
        contact
    }
}

/// A foot that stands, and where.
#[derive(Debug, Clone)]
pub struct Stance {
    /// The standing point, with the root at zero.
    pub foot: Contact,
    /// The root's origin that puts it on the ground at x = 0 \[m\].
    pub base: Vector<f64>,
}

/// The point of the link that stands: its lowest along the ground's normal at x = 0, of several within `tolerance`
/// \[m\] the one with the smallest t; of the `named` contacts of the link if it has any, else of its feet. `placement`
/// has the root at zero.
///
/// # Errors
/// [`Reason::Missing`] where the link has no foot, [`Reason::Inconsistent`] where there is no ground at x = 0.
pub fn stance(
    robot: &Robot,
    feet: &Feet,
    named: Option<&[NamedContact]>,
    link: usize,
    (placement, surface): (&Placement, &Surface),
    tolerance: f64,
) -> Result<Stance> {
    let (plane, place) = surface.stance()?;
    let candidates: Vec<Point> = match named {
        Some(named) => {
            named.iter().filter(|contact| contact.link == link).map(|contact| Point::named(robot, contact)).collect()
        }
        None => feet.iter().filter(|foot| foot.link == link).flat_map(points).collect(),
    };
    let height = |point: Point| plane.height(placement, point);
    let lowest = candidates.iter().map(|&point| height(point)).fold(f64::INFINITY, f64::min);
    let along = |point: Point| plane.along(plane.lowest(placement, point));
    candidates
        .into_iter()
        .filter(|&point| height(point) <= lowest + tolerance)
        .min_by(|&a, &b| along(a).total_cmp(&along(b)))
        .map(|point| {
            let foot = Contact::of_touch(link, placement, plane.touch(placement, point));
            Stance { base: place - foot.point, foot }
        })
        .ok_or_else(|| {
            let name = &robot.links[link].name;
            Error::new(Reason::Missing(format!("a collision shape or named contact of link \"{name}\"")))
                .at("stance")
                .hint("name a link with a foot, or give its point in `contacts`")
        })
}

/// All closed contacts: the `named` ones whatever their height, else every point of a foot within `tolerance` \[m\] of
/// the ground, in the order of the links and within a link along t of a plane, along x of a profile.
///
/// # Errors
/// [`Reason::Penetration`] for the deepest of the feet that are deeper than the tolerance.
pub fn detect(
    robot: &Robot,
    feet: &Feet,
    named: Option<&[NamedContact]>,
    (placement, surface): (&Placement, &Surface),
    tolerance: f64,
) -> Result<Vec<Contact>> {
    let mut contacts = match named {
        Some(named) => {
            let touch = |contact| surface.touch(placement, Point::named(robot, contact), tolerance);
            named.iter().map(|contact| Contact::of_touch(contact.link, placement, touch(contact))).collect()
        }
        None => detected(robot, feet, placement, surface, tolerance)?,
    };
    name_contacts(robot, &mut contacts);
    Ok(contacts)
}

fn detected(
    robot: &Robot,
    feet: &Feet,
    placement: &Placement,
    surface: &Surface,
    tolerance: f64,
) -> Result<Vec<Contact>> {
    let rounding = surface.rounding(placement, feet.size());
    if rounding > feet.size() {
        let reason = format!("the base is so far from the world's origin that heights are rounded by {rounding:.1e} m");
        return Err(Error::new(Reason::Inconsistent(reason)).hint("move the scene to the world's origin"));
    }
    let tolerance = tolerance + rounding;
    let mut contacts: Vec<Contact> = Vec::new();
    let mut deepest: Option<(usize, Sunk)> = None;
    for foot in feet.iter() {
        let touches = match surface.touching(foot, placement, tolerance, rounding)? {
            Ok(touches) => touches,
            Err(sunk) => {
                if deepest.as_ref().is_none_or(|(_, other)| sunk.depth > other.depth) {
                    deepest = Some((foot.link, sunk));
                }
                continue;
            }
        };
        for touch in touches {
            let contact = Contact::of_touch(foot.link, placement, touch);
            // Shapes of a link may share a corner; it is one point all the same.
            if !contacts.iter().any(|other| surface.is_same(other, &contact, rounding)) {
                contacts.push(contact);
            }
        }
    }
    if let Some((link, Sunk { depth, remedy })) = deepest {
        let link = robot.links[link].name.clone();
        return Err(Error::new(Reason::Penetration { link, depth, tolerance }).hint(remedy));
    }
    contacts.sort_by(|a, b| a.link.cmp(&b.link).then(surface.along(a.point).total_cmp(&surface.along(b.point))));
    Ok(contacts)
}

/// How many feet are too far from the ground for [`detect`] to look at them with this `tolerance` \[m\].
pub fn out_of_reach(feet: &Feet, placement: &Placement, surface: &Surface, tolerance: f64) -> usize {
    let tolerance = tolerance + surface.rounding(placement, feet.size());
    feet.iter().filter(|foot| surface.is_out_of_reach(foot, placement, tolerance)).count()
}

/// The foot nearest to the ground, and its distance from it \[m\]; `None` if the robot has no feet.
pub fn nearest(robot: &Robot, feet: &Feet, placement: &Placement, surface: &Surface) -> Option<(String, f64)> {
    let distances = feet.iter().map(|foot| (foot.link, surface.clearance(foot, placement)));
    let (link, distance) = distances.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((robot.links[link].name.clone(), distance))
}

/// How far each foot is from the ground \[m\]; negative where it is in it.
pub fn clearances(feet: &Feet, placement: &Placement, surface: &Surface) -> Vec<f64> {
    feet.iter().map(|foot| surface.clearance(foot, placement)).collect()
}

/// The links of feet that reach beyond an end of the ground no higher than `tolerance` \[m\] above it, and the end's x
/// \[m\].
pub fn left_behind(
    robot: &Robot,
    feet: &Feet,
    placement: &Placement,
    surface: &Surface,
    tolerance: f64,
) -> Vec<(String, f64)> {
    let mut found: Vec<(usize, f64)> = Vec::new();
    for foot in feet.iter() {
        let end = surface.left_behind(foot, placement, tolerance).map(|end| (foot.link, end));
        found.extend(end.filter(|end| !found.contains(end)));
    }
    found.into_iter().map(|(link, end)| (robot.links[link].name.clone(), end)).collect()
}

/// A contact is named after its link, and numbered where the link has several.
fn name_contacts(robot: &Robot, contacts: &mut [Contact]) {
    let mut counts = vec![(0, 0); robot.links.len()];
    for contact in contacts.iter() {
        counts[contact.link].0 += 1;
    }
    for contact in contacts {
        let name = &robot.links[contact.link].name;
        let (all, next) = &mut counts[contact.link];
        contact.name = if *all == 1 { name.clone() } else { format!("{name}/{next}") };
        *next += 1;
    }
}
