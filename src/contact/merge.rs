//! Points of one rigid body on one straight line of ground act through the outer two of them.
//!
//! ```text
//!     p = (1 - s) a + s b:    a force at p = (1 - s) of it at a + s of it at b,     c_n(p) = (1 - s) c_n(a) + s c_n(b)
//! ```
//!
//! With the same friction the parts at a and b stay in their cones. c_t is the same all along a level line, and Newton's
//! bounce e min(c_n, 0) is concave, so that p is closed only where a and b are. Along a line that the contact tolerance
//! lets be tilted this needs e = 0, so that the body does not turn where p pushes, or no friction, so that c_t says
//! nothing. Then points off the line act through a and b, too, if both edges of p's friction cone meet the line between
//! them. Others stay.

use super::Contact;
use crate::planar::Vector;

/// Contacts of one body and those that act for them.
#[derive(Debug, Clone, PartialEq)]
pub struct Merged {
    /// How many are left out.
    pub inner: usize,
    /// Those that act for them, among the contacts that remain: the rearmost and the foremost, or one if all coincide.
    pub outer: Vec<usize>,
    /// How far the inner ones are off the straight line between the outer ones, at most \[m\]; 0 if by rounding alone.
    pub off: f64,
    /// Whether circles of other radii were left out at the same place, which roll otherwise.
    pub is_uneven: bool,
}

/// Leaves out of all contacts that are `together` those between the outer two, but none that `stays`; places are the
/// same up to `rounding` \[m\]. Points off a level line act through the outer two only with a `lean`, how far the edges of
/// their friction cones are inclined.
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
        // Of several at one end the lowest.
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
            // Where an edge of its friction cone meets the line; one along the ground never does.
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
    for own in merged.iter_mut().flat_map(|merged| &mut merged.outer) {
        *own = remains[..*own].iter().filter(|&&remains| remains).count();
    }
    let mut remains = remains.into_iter();
    contacts.retain(|_| remains.next().unwrap_or(true));
    merged
}
