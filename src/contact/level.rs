//! Contacts of one rigid part that stand level on straight ground.
//!
//! ```text
//!     p_b = p_a + tangent (tangent . (p_b - p_a))      if normal . (p_b - p_a) is within rounding
//! ```
//!
//! The angles of a pose are rounded, so a flat sole is tilted by some 1e-16 rad, and so is the line between two feet
//! whose joints are braked. Contacts that bounce, or whose friction is infinite, may then balance on that tilt with
//! impulses of 1e16 N s. What only digits below those of the pose say is not read from it: all numbers beyond f64 take
//! such contacts as exactly level. Points that are given by name are meant where they are; of these only those of one
//! body count that are level in all digits.

use super::Contact;
use crate::dynamics::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::Vector;

/// How far one point may be above another, as part of what their places in the body were added up from: the bounds of
/// f64, [`RoundingBounds`](crate::dynamics::RoundingBounds), count 48 units and more of it for each point.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// So many bodies at most are taken for one: of longer ways the bounds count too few roundings.
const MOST_BODIES: usize = 8;

/// Where a contact is on the line of another of its rigid part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The other one, which is level with none.
    pub with: usize,
    /// How far along the tangent it is taken to be from there \[m\]; `None` if its place is exactly level by itself.
    pub along: Option<f64>,
    /// What the arms between both bodies were added up from \[m\].
    pub way: f64,
}

/// A robot in a pose, whose bodies move as one between joints that keep a rate of zero: each such part is rigid.
#[derive(Clone, Copy)]
pub struct RigidParts<'a> {
    pub plan: &'a Plan,
    /// After `kinematics`.
    pub workspace: &'a Workspace,
    /// Coordinates that keep their rates although they have columns.
    pub kept: &'a [usize],
    /// dq/dt.
    pub velocity: &'a [f64],
}

/// Which contacts are level with which, up to rounding; none of those behind the last entry. The foot of a `stance`
/// keeps its place, and contacts that are `named` are level with those of their own body alone.
pub fn level(contacts: &[Contact], parts: RigidParts<'_>, stance: Option<usize>, named: bool) -> Vec<Option<Level>> {
    let mut levels: Vec<Option<Level>> = Vec::new();
    for (index, contact) in contacts.iter().enumerate() {
        let is_own = |&other: &usize| levels.get(other).is_none_or(Option::is_none);
        let others = stance.into_iter().chain((0..index).filter(is_own));
        let mut others = others.filter(|&with| !named || contact.body == contacts[with].body);
        let found =
            if stance == Some(index) { None } else { others.find_map(|with| parts.level(contact, contacts, with)) };
        if found.is_some() {
            levels.resize(index, None);
            levels.push(found);
        }
    }
    levels
}

impl RigidParts<'_> {
    /// The first of the bodies that move as one with this one.
    pub fn first(self, body: usize) -> usize {
        self.bodies(body).last().unwrap_or(body)
    }

    /// Whether two bodies move as one.
    pub fn are_one(self, a: usize, b: usize) -> bool {
        a == b || self.first(a) == self.first(b)
    }

    /// How a contact is level `with` another, if it is.
    fn level(self, contact: &Contact, contacts: &[Contact], with: usize) -> Option<Level> {
        let other = &contacts[with];
        if contact.ground != other.ground || !self.are_one(contact.body, other.body) {
            return None;
        }
        let (arm, way) = if contact.body == other.body {
            (self.workspace.rotation[contact.body].apply(contact.center - other.center), 0.0)
        } else {
            let [own, others] = [contact, other].map(|own| self.place(own));
            (own.0 - others.0, own.1 + others.1)
        };
        let rise = contact.normal().dot(arm) - (contact.radius - other.radius);
        let length = |own: &Contact| size(own.center) + own.radius;
        let is_level = rise.abs() <= ROUNDING * (length(contact) + length(other) + way);
        is_level.then(|| Level { with, along: Some(contact.tangent().dot(arm)), way })
    }

    /// A body and those below it in its rigid part.
    fn bodies(&self, body: usize) -> impl Iterator<Item = usize> {
        let parts = std::iter::successors(Some(body), |&body| {
            let own = &self.plan.bodies[body];
            let keeps = || own.column.is_none() || self.kept.contains(&own.coordinate);
            let is_rigid = match own.motion {
                JointMotion::Root => false,
                JointMotion::Fixed => true,
                JointMotion::Revolute { .. } | JointMotion::Prismatic { .. } => {
                    self.velocity[own.coordinate] == 0.0 && keeps()
                }
            };
            own.parent.filter(|_| is_rigid)
        });
        parts.take(MOST_BODIES)
    }

    /// Where a contact's center is from the origin of its rigid part \[m\], and what the arms to its body were added up
    /// from \[m\].
    fn place(&self, contact: &Contact) -> (Vector<f64>, f64) {
        let center = self.workspace.rotation[contact.body].apply(contact.center);
        let joints = self.bodies(contact.body).zip(self.bodies(contact.body).skip(1)).map(|(body, _)| body);
        joints.fold((center, 0.0), |(place, length), body| {
            let (arm, own) = (self.workspace.arm[body], &self.plan.bodies[body]);
            // A displacement is no longer than the arm and the origin together.
            let slid = if let JointMotion::Prismatic { .. } = own.motion { 2.0 * size(own.origin) } else { 0.0 };
            (place + arm, length + size(arm) + slid)
        })
    }
}

fn size(vector: Vector<f64>) -> f64 {
    vector.x.abs() + vector.z.abs()
}
