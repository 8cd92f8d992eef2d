//! Contacts of one rigid part that stand level on straight ground.
//!
//! ```text
//!     p_b = p_a + tangent (tangent . (p_b - p_a))      if normal . (p_b - p_a) is within rounding
//! ```
//!
//! The angles of a pose are rounded, so a flat sole is tilted by about 1e-16 rad, and so is the line between two feet
//! whose joints are braked. Contacts that bounce, or whose friction is infinite, may then balance on that tilt with
//! impulses of 1e16 N s. The pose does not have the digits that decide this tilt, so all number types beyond f64 take
//! these contacts as exactly level. Named points are taken exactly where they are: they count as level only if they are
//! on one body and level in all digits.

use super::Contact;
use crate::dynamics::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::Vector;

/// Largest height between level points, as a fraction of the lengths from which their positions are computed. The f64
/// bounds, [`RoundingBounds`](crate::dynamics::RoundingBounds), allow at least 48 epsilons for each point.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Largest number of bodies in a row that count as one: on longer paths the bounds count too few roundings.
const MOST_BODIES: usize = 8;

/// The position of a contact that is level with another contact of its rigid part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Index of the other contact, which is not itself level with a third one.
    pub with: usize,
    /// Distance from the other contact along the tangent, which replaces the position \[m\]; `None` if the position is
    /// exactly level as it is.
    pub along: Option<f64>,
    /// Sum of the lengths from which the arms between both bodies are computed \[m\]; 0 on one body.
    pub way: f64,
}

/// The rigid parts of a robot in a pose: bodies that move as one, because the joints between them are fixed or keep a
/// rate of zero.
#[derive(Clone, Copy)]
pub struct RigidParts<'a> {
    pub plan: &'a Plan,
    /// Holds the results of `kinematics`.
    pub workspace: &'a Workspace,
    /// Coordinates of joints that keep their rates although they have columns.
    pub kept: &'a [usize],
    /// dq/dt.
    pub velocity: &'a [f64],
}

/// Returns for each contact with which other contact it is level, up to rounding; contacts beyond the last entry are
/// level with none. The contact of a `stance` keeps its position. Contacts that are `named` are compared only within
/// their body.
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
    /// Returns the body nearest to the root among those that move as one with `body`.
    pub fn first(self, body: usize) -> usize {
        self.bodies(body).last().unwrap_or(body)
    }

    /// Returns whether two bodies move as one.
    pub fn are_one(self, a: usize, b: usize) -> bool {
        a == b || self.first(a) == self.first(b)
    }

    /// Returns how a contact is level with the contact `with`; `None` if it is not.
    fn level(self, contact: &Contact, contacts: &[Contact], with: usize) -> Option<Level> {
        let other = &contacts[with];
        if contact.ground != other.ground || !self.are_one(contact.body, other.body) {
            return None;
        }
        let (arm, way) = if contact.body == other.body {
            (self.workspace.rotation[contact.body].apply(contact.center - other.center), 0.0)
        } else {
            let [(place, length), (other_place, other_length)] = [contact, other].map(|contact| self.place(contact));
            (place - other_place, length + other_length)
        };
        let rise = contact.normal().dot(arm) - (contact.radius - other.radius);
        let length = |contact: &Contact| size(contact.center) + contact.radius;
        let is_level = rise.abs() <= ROUNDING * (length(contact) + length(other) + way);
        is_level.then(|| Level { with, along: Some(contact.tangent().dot(arm)), way })
    }

    /// Returns a body and its ancestors in its rigid part, at most [`MOST_BODIES`].
    fn bodies(&self, body: usize) -> impl Iterator<Item = usize> {
        let parts = std::iter::successors(Some(body), |&body| {
            let body = &self.plan.bodies[body];
            let keeps = || body.column.is_none() || self.kept.contains(&body.coordinate);
            let is_rigid = match body.motion {
                JointMotion::Root => false,
                JointMotion::Fixed => true,
                JointMotion::Revolute { .. } | JointMotion::Prismatic { .. } => {
                    self.velocity[body.coordinate] == 0.0 && keeps()
                }
            };
            body.parent.filter(|_| is_rigid)
        });
        parts.take(MOST_BODIES)
    }

    /// Returns a contact's center relative to the origin of its rigid part, and the sum of the lengths from which the
    /// arms to its body are computed; both in \[m\].
    fn place(&self, contact: &Contact) -> (Vector<f64>, f64) {
        let center = self.workspace.rotation[contact.body].apply(contact.center);
        let joints = self.bodies(contact.body).zip(self.bodies(contact.body).skip(1)).map(|(body, _)| body);
        joints.fold((center, 0.0), |(place, length), body| {
            let (arm, body) = (self.workspace.arm[body], &self.plan.bodies[body]);
            // The arm of a prismatic joint is its origin plus its displacement, which is no longer than both together.
            let slid = if let JointMotion::Prismatic { .. } = body.motion { 2.0 * size(body.origin) } else { 0.0 };
            (place + arm, length + size(arm) + slid)
        })
    }
}

fn size(vector: Vector<f64>) -> f64 {
    vector.x.abs() + vector.z.abs()
}
