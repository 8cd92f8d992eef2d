//! Contacts of one rigid body on a straight line of ground act through the outermost two of them.
//!
//! ```text
//!     p = (1 - s) a + s b:    f at p = (1 - s) f at a + s f at b (forces),    c_n(p) = (1 - s) c_n(a) + s c_n(b)
//! ```
//!
//! If the friction is the same, the forces at a and b stay in their friction cones. On a level line c_t is the same at
//! all points, and Newton's restitution e min(c_n, 0) is concave in c_n, so p is closed only if a and b are. The
//! contact tolerance also admits tilted lines. These need e = 0, so that the body does not turn while p pushes, or no
//! friction, so that c_t has no effect. Then points off the line also act through a and b, if both edges of their
//! friction cone meet the line between a and b. All other points stay.

use super::Contact;
use crate::planar::Vector;

/// Contacts of one body that were left out, and the contacts into which they were merged.
#[derive(Debug, Clone, PartialEq)]
pub struct Merged {
    /// Number of contacts that are left out.
    pub inner: usize,
    /// Indices after merging of the remaining contacts: the rearmost and the foremost, or one if all coincide.
    pub outer: Vec<usize>,
    /// Largest distance, along the normal, of the inner contacts from the line between the outer ones \[m\]; 0 if it is
    /// only rounding.
    pub off: f64,
    /// Whether circles of other radii, which roll differently, were left out at the same place.
    pub is_uneven: bool,
}

/// Among contacts that are `together`, leaves out those between the outermost two, except those for which `stays` is
/// true. Positions are equal up to `rounding` \[m\]. Points off a level line are left out only if `lean` returns the
/// slope of the edges of their friction cone.
pub(super) fn merge(
    contacts: &mut Vec<Contact>,
    together: impl Fn(&Contact, &Contact) -> bool,
    stays: impl Fn(&Contact) -> bool,
    lean: impl Fn(&Contact) -> Option<f64>,
    rounding: f64,
) -> Vec<Merged> {
    let mut merged = Vec::new();
    let mut remains = Vec::new();
    for first in 0..contacts.len() {
        let is_together = |&at: &usize| together(&contacts[first], &contacts[at]);
        if !(first + 1..contacts.len()).any(|at| is_together(&at)) || (0..first).any(|at| is_together(&at)) {
            continue;
        }
        let members = || (first..contacts.len()).filter(is_together);
        // [tangential, normal]
        let place = |at: usize| Vector::axes().map(|axis| contacts[first].ground.apply(axis).dot(contacts[at].point));
        // If several contacts are at one end, the lowest counts.
        let end = |way: f64| {
            let most = members().map(|at| way * place(at)[0]).fold(f64::NEG_INFINITY, f64::max);
            let last = members().filter(|&at| way * place(at)[0] >= most - rounding);
            last.min_by(|&a, &b| place(a)[1].total_cmp(&place(b)[1])).unwrap_or(first)
        };
        let (rear, front) = (end(-1.0), end(1.0));
        let [[from, low], [to, high]] = [place(rear), place(front)];
        let coincide = to - from <= rounding;
        let outer = if coincide { vec![rear] } else { vec![rear, front] };
        let slope = if coincide { 0.0 } else { (high - low) / (to - from) };
        let off = |at: usize| {
            let [along, height] = place(at);
            height - low - slope * (along - from)
        };
        let acts_through_outer = |at: usize| {
            // Whether an edge of the friction cone meets the line between the outer two; an edge along it never does.
            let meets = |lean: f64| {
                let steeper = 1.0 - slope * lean;
                let along = place(at)[0] - off(at) * lean / steeper;
                steeper > 0.0 && (from - rounding..=to + rounding).contains(&along)
            };
            let is_level = (high - low).abs() <= rounding && off(at).abs() <= rounding;
            is_level || lean(&contacts[at]).is_some_and(|lean| off(at).abs() <= rounding || meets(lean) && meets(-lean))
        };
        let is_inner = |&at: &usize| !outer.contains(&at) && !stays(&contacts[at]) && acts_through_outer(at);
        let inner: Vec<usize> = members().filter(is_inner).collect();
        if inner.is_empty() {
            continue;
        }
        let off = inner.iter().map(|&at| off(at).abs()).filter(|&off| off > rounding).fold(0.0, f64::max);
        let is_uneven = coincide && inner.iter().any(|&at| contacts[at].radius != contacts[rear].radius);
        merged.push(Merged { inner: inner.len(), outer, off, is_uneven });
        remains.resize(contacts.len(), true);
        inner.into_iter().for_each(|at| remains[at] = false);
    }
    if merged.is_empty() {
        return merged;
    }
    for index in merged.iter_mut().flat_map(|merged| &mut merged.outer) {
        *index = remains[..*index].iter().filter(|&&remains| remains).count();
    }
    let mut remains = remains.into_iter();
    contacts.retain(|_| remains.next().unwrap_or(true));
    merged
}
