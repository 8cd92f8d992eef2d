//! Contacts of one body that stand level on straight ground.
//!
//! ```text
//!     p_b = p_a + tangent (tangent . (p_b - p_a))      if normal . (p_b - p_a) is within rounding
//! ```
//!
//! The angles of a pose are rounded, so a flat sole is tilted by some 1e-16 rad. Contacts that bounce, or whose friction
//! is infinite, may then balance on that tilt with impulses of 1e16 N s. What only digits below those of the pose say
//! is not read from it: all numbers beyond f64 take such contacts as exactly level. Points that are given by name are
//! meant where they are; of these only those count that are level in all digits.

use super::Contact;
use super::placement::Placement;

/// How far one point may be above another, as part of what their places in the body were added up from: the bounds of
/// f64, [`RoundingBounds`](crate::dynamics::RoundingBounds), count 48 units and more of it for each point.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Where a contact is on the line of another of its body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// The other one, which is level with none.
    pub with: usize,
    /// How far along the tangent it is taken to be from there \[m\]; `None` if its place is exactly level by itself.
    pub along: Option<f64>,
}

/// Which contacts are level with which, up to rounding; none of those behind the last entry. The foot of a `stance` keeps
/// its place.
pub fn level(contacts: &[Contact], placement: &Placement, stance: Option<usize>) -> Vec<Option<Level>> {
    let mut levels: Vec<Option<Level>> = Vec::new();
    for (index, contact) in contacts.iter().enumerate() {
        let is_own = |&other: &usize| levels.get(other).is_none_or(Option::is_none);
        let others = stance.into_iter().chain((0..index).filter(is_own));
        let found = others.filter(|_| stance != Some(index)).find_map(|with| {
            let along = along(contact, &contacts[with], placement)?;
            Some(Level { with, along: Some(along) })
        });
        if found.is_some() {
            levels.resize(index, None);
            levels.push(found);
        }
    }
    levels
}

/// How far a contact is from another along the tangent \[m\], if they are level.
fn along(contact: &Contact, other: &Contact, placement: &Placement) -> Option<f64> {
    if (contact.body, contact.ground) != (other.body, other.ground) {
        return None;
    }
    let arm = placement.turned(contact.body, contact.center - other.center);
    let rise = contact.normal().dot(arm) - (contact.radius - other.radius);
    let length = |own: &Contact| own.center.x.abs() + own.center.z.abs() + own.radius;
    (rise.abs() <= ROUNDING * (length(contact) + length(other))).then(|| contact.tangent().dot(arm))
}
