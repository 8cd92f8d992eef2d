//! Feet against the ground line: which points touch, and where the base must be for a foot to stand.
//!
//! [`super::shape`] says which points of a foot are near; here they become contacts, each checked, named and in its order.

use super::Contact;
use super::feet::Feet;
use super::shape::{is_out_of_reach, points, touching};
use crate::dynamics::{ContactPoint, Workspace};
use crate::error::{Error, Reason, Result};
use crate::plan::Plan;
use crate::planar::{Rotation, Vector, difference, dot, scaled, sum};
use crate::robot::{Rim, Robot};
use crate::scalar::Real;
use crate::scene::NamedContact;
use parry2d::math::{Pose, Vector as ParryVector};

/// Where the bodies and the ground are.
#[derive(Debug, Clone)]
pub struct Placement {
    /// Origin of each body in the world \[m\].
    origins: Vec<Vector<f64>>,
    /// Pitch of each body as a turn.
    turns: Vec<Rotation<f64>>,
    /// Turn from the world's axes to the ground's.
    ground: Rotation<f64>,
}

impl Placement {
    /// The bodies after `kinematics`, with the root's origin at `base` \[m\], over the ground line through the world's
    /// origin.
    pub fn new(plan: &Plan<f64>, workspace: &Workspace<f64>, base: Vector<f64>, ground: Rotation<f64>) -> Self {
        let mut origins: Vec<Vector<f64>> = Vec::with_capacity(plan.bodies.len());
        for (body, &arm) in plan.bodies.iter().zip(&workspace.arm) {
            origins.push(body.parent.map_or(base, |parent| sum(origins[parent], arm)));
        }
        Self { origins, turns: workspace.rotation.clone(), ground }
    }

    fn tangent(&self) -> Vector<f64> {
        self.ground.apply([1.0, 0.0])
    }

    pub(super) fn normal(&self) -> Vector<f64> {
        self.ground.apply([0.0, 1.0])
    }

    /// Centre, in the body's frame, and radius of the circle that touches where `point` does: of an ellipse, with radius 0,
    /// the material point that is lowest along the normal now.
    pub(crate) fn circle(&self, point: Point) -> (Vector<f64>, f64) {
        match point.rim {
            Rim::Circle { radius } => (point.centre, radius),
            Rim::Ellipse { .. } => (sum(point.centre, point.rim.support(self.downward(point.body))), 0.0),
        }
    }

    /// The world's point of a rim about a corner that is lowest along the normal.
    pub(crate) fn lowest(&self, point: Point) -> Vector<f64> {
        let (centre, radius) = self.circle(point);
        difference(self.world(point.body, centre), scaled(radius, self.normal()))
    }

    pub(super) fn height(&self, point: Point) -> f64 {
        dot(self.normal(), self.lowest(point))
    }

    /// How far a rim of a body reaches toward the ground \[m\].
    pub(super) fn reach(&self, body: usize, rim: &Rim) -> f64 {
        rim.reach(self.downward(body))
    }

    /// The height of the lowest point of a circle of a body, given by centre and radius.
    pub(super) fn height_of_circle(&self, body: usize, (centre, radius): (Vector<f64>, f64)) -> f64 {
        dot(self.normal(), self.world(body, centre)) - radius
    }

    fn world(&self, body: usize, point: Vector<f64>) -> Vector<f64> {
        sum(self.origins[body], self.turns[body].apply(point))
    }

    /// The direction into the ground in the body's frame.
    fn downward(&self, body: usize) -> Vector<f64> {
        let Rotation { cos, sin } = self.turns[body];
        Rotation { cos, sin: -sin }.apply(scaled(-1.0, self.normal()))
    }

    /// The body's frame for parry.
    pub(super) fn pose(&self, body: usize) -> Pose {
        let Rotation { cos, sin } = self.turns[body];
        let [x, z] = self.origins[body];
        // parry turns counter-clockwise, a positive pitch clockwise.
        Pose::new(ParryVector::new(x, z), libm::atan2(-sin, cos))
    }

    /// How far heights are off by rounding alone: they are sums of a few terms of this size. On level ground it does not
    /// matter how far away the base is.
    fn rounding(&self, size: f64) -> f64 {
        let [x, z] = self.origins.first().copied().unwrap_or_default();
        let [along, up] = self.normal();
        16.0 * f64::EPSILON * (size + (along * x).abs() + (up * z).abs())
    }

    fn contact(&self, link: usize, point: Point) -> Contact {
        let (centre, radius) = self.circle(point);
        Contact {
            link,
            name: String::new(),
            body: point.body,
            centre,
            offset: point.offset,
            radius,
            point: self.lowest(point),
            normal: self.normal(),
            gap: self.height(point),
        }
    }
}

/// A corner and the rim about it, rigid on a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub body: usize,
    pub centre: Vector<f64>,
    /// In the link's own frame, where it was named so.
    pub offset: Option<[f64; 3]>,
    pub rim: Rim,
}

impl Point {
    fn named(robot: &Robot, contact: &NamedContact) -> Self {
        let link = &robot.links[contact.link];
        let (centre, offset) = (link.point(contact.offset), Some(contact.offset));
        Self { body: link.body, centre, offset, rim: Rim::Circle { radius: contact.radius } }
    }
}

impl Contact {
    /// The contact for the dynamics.
    pub fn point_of(&self, ground: Rotation<f64>) -> ContactPoint {
        ContactPoint { body: self.body, centre: self.centre, radius: self.radius, ground }
    }

    /// The same in numbers of any kind, a named point from the digits that it was named with.
    pub fn exact_point<T: Real>(&self, robot: &Robot, ground: Rotation<T>) -> ContactPoint<T> {
        let centre = match self.offset {
            Some(offset) => robot.links[self.link].point(offset),
            None => self.centre.map(T::from_f64),
        };
        ContactPoint { body: self.body, centre, radius: T::from_f64(self.radius), ground }
    }

    /// What the centre's coordinates were added up from, by magnitude \[m\].
    pub fn stretch(&self, robot: &Robot) -> f64 {
        match self.offset {
            Some(offset) => {
                let pose = robot.links[self.link].pose.iter();
                pose.flat_map(|row| row.iter().zip([offset[0], offset[1], offset[2], 1.0]))
                    .map(|(a, b)| (a * b).abs())
                    .sum()
            }
            None => self.centre[0].abs() + self.centre[1].abs(),
        }
    }
}

/// The point of the link that stands: its lowest along the normal, of several within `tolerance` \[m\] the one with the
/// smallest t; of the `named` contacts of the link if it has any, else of its feet.
///
/// # Errors
/// [`Reason::Missing`] where the link has no foot.
pub fn stance_foot(
    robot: &Robot,
    feet: &Feet,
    named: Option<&[NamedContact]>,
    link: usize,
    placement: &Placement,
    tolerance: f64,
) -> Result<Contact> {
    let candidates: Vec<Point> = match named {
        Some(named) => {
            named.iter().filter(|contact| contact.link == link).map(|contact| Point::named(robot, contact)).collect()
        }
        None => feet.iter().filter(|foot| foot.link == link).flat_map(points).collect(),
    };
    let lowest = candidates.iter().map(|&point| placement.height(point)).fold(f64::INFINITY, f64::min);
    let along = |point: Point| dot(placement.tangent(), placement.lowest(point));
    candidates
        .into_iter()
        .filter(|&point| placement.height(point) <= lowest + tolerance)
        .min_by(|&a, &b| along(a).total_cmp(&along(b)))
        .map(|point| placement.contact(link, point))
        .ok_or_else(|| {
            let name = &robot.links[link].name;
            Error::new(Reason::Missing(format!("a collision shape or named contact of link \"{name}\"")))
                .at("stance")
                .hint("name a link with a foot, or give its point in `contacts`")
        })
}

/// The root's origin that puts the standing point at the world's origin \[m\], `foot` found with the root at zero.
pub fn place(foot: &Contact) -> Vector<f64> {
    foot.point.map(|entry| -entry)
}

/// All closed contacts: the `named` ones whatever their height, else every point of a foot within `tolerance` \[m\] of the
/// ground, in the order of the links and along t within a link.
///
/// # Errors
/// [`Reason::Penetration`] for a detected one that is deeper than the tolerance.
pub fn detect(
    robot: &Robot,
    feet: &Feet,
    named: Option<&[NamedContact]>,
    placement: &Placement,
    tolerance: f64,
) -> Result<Vec<Contact>> {
    let mut contacts = match named {
        Some(named) => {
            named.iter().map(|contact| placement.contact(contact.link, Point::named(robot, contact))).collect()
        }
        None => detected(robot, feet, placement, tolerance)?,
    };
    name_contacts(robot, &mut contacts);
    Ok(contacts)
}

fn detected(robot: &Robot, feet: &Feet, placement: &Placement, tolerance: f64) -> Result<Vec<Contact>> {
    let rounding = placement.rounding(feet.size());
    if rounding > feet.size() {
        let reason = format!("the base is so far from the world's origin that heights are rounded by {rounding:.1e} m");
        return Err(Error::new(Reason::Inconsistent(reason)).hint("move the scene to the world's origin"));
    }
    let tolerance = tolerance + rounding;
    let mut contacts: Vec<Contact> = Vec::new();
    for foot in feet.iter() {
        for point in touching(foot, placement, tolerance)? {
            let contact = placement.contact(foot.link, point);
            if contact.gap < -tolerance {
                return Err(Error::new(Reason::Penetration {
                    link: robot.links[foot.link].name.clone(),
                    depth: -contact.gap,
                    tolerance,
                })
                .hint(format!(
                    "raise the base by {:?} m, correct the pose, or accept it by a greater --contact-tolerance",
                    -contact.gap
                )));
            }
            // Shapes of a link may share a corner; it is one point all the same.
            let known = |other: &Contact| {
                other.link == contact.link && (other.centre, other.radius) == (contact.centre, contact.radius)
            };
            if !contacts.iter().any(known) {
                contacts.push(contact);
            }
        }
    }
    let along = |contact: &Contact| dot(placement.tangent(), contact.point);
    contacts.sort_by(|a, b| a.link.cmp(&b.link).then(along(a).total_cmp(&along(b))));
    Ok(contacts)
}

/// How many feet are too high for [`detect`] to look at them with this `tolerance` \[m\].
pub fn out_of_reach(feet: &Feet, placement: &Placement, tolerance: f64) -> usize {
    let tolerance = tolerance + placement.rounding(feet.size());
    feet.iter().filter(|foot| is_out_of_reach(foot, placement, tolerance)).count()
}

/// The foot nearest to the ground, and its height above it \[m\]; none where the robot has no feet.
pub fn nearest(robot: &Robot, feet: &Feet, placement: &Placement) -> Option<(String, f64)> {
    let heights = feet.iter().flat_map(|foot| points(foot).map(|point| (foot.link, placement.height(point))));
    let (link, height) = heights.min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((robot.links[link].name.clone(), height))
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
