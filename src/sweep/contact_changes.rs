//! Finds where the contacts change between two places: which contacts are closed, and what touches at each.
//!
//! ```text
//!     corner 0 ... corner 3 --bisected--> 0 | 0 and 1 | 1 | 1 and 2 | 2 ...: each | to the accuracy of borders
//! ```
//!
//! A foot that rolls over several corners, or over several segments of a ground profile, stands on two of them at once
//! wherever it changes from one to the next. The search is divided at every place that has other contacts than both
//! ends. Contacts that change and change back between two places with the same contacts are not found.

use super::model::Watched;
use crate::budget::is_spent;
use std::sync::Arc;

/// What is followed at a place; `None` if it is refused.
pub type Seen = Option<Arc<Watched>>;

/// The greatest number of changes that are found between two places: where rounding decides what touches, there may be
/// any number of them.
const MOST: usize = 1_000;

/// Returns whether two places have the same contacts, at the same corners of feet and parts of the ground, and the
/// same inequalities. Refused places are alike.
pub fn are_alike(one: &Seen, other: &Seen) -> bool {
    match (one, other) {
        (Some(one), Some(other)) => {
            one.contacts == other.contacts
                && one.touching == other.touching
                && one.inequalities.ends == other.inequalities.ends
                && one.clearance.len() == other.clearance.len()
        }
        (one, other) => one.is_none() && other.is_none(),
    }
}

/// Adds to `found`, in ascending order, the last place before and the first place beyond each change between two
/// places with what is seen there. They are at most `resolution` apart.
pub fn contact_changes(
    watch: &mut impl FnMut(f64) -> Seen,
    [(mut a, first), (mut b, last)]: [(f64, &Seen); 2],
    resolution: f64,
    found: &mut Vec<[f64; 2]>,
) {
    if are_alike(first, last) || found.len() >= MOST {
        return;
    }
    while b - a > resolution && !is_spent() {
        let middle = 0.5 * (a + b);
        // Numbers far from zero may be farther apart than the resolution.
        if middle <= a || middle >= b {
            break;
        }
        let seen = watch(middle);
        if are_alike(&seen, first) {
            a = middle;
        } else if are_alike(&seen, last) {
            b = middle;
        } else {
            contact_changes(watch, [(a, first), (middle, &seen)], resolution, found);
            return contact_changes(watch, [(middle, &seen), (b, last)], resolution, found);
        }
    }
    found.push([a, b]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::Inequalities;
    use crate::pipeline::Touching;

    /// What is seen where these corners touch.
    fn standing(corners: &[usize]) -> Seen {
        let touching = corners.iter().map(|&corner| Touching { corner: Some(corner), ground: 0 }).collect();
        let contacts = corners.iter().map(|corner| format!("foot/{corner}")).collect();
        Some(Arc::new(Watched { contacts, inequalities: Inequalities::default(), clearance: Vec::new(), touching }))
    }

    /// Asserts the places of all changes from 0 to 1, to 1e-12.
    fn assert_changes(mut watch: impl FnMut(f64) -> Seen, expected: &[f64]) {
        let ends = [watch(0.0), watch(1.0)];
        let mut found = Vec::new();
        contact_changes(&mut watch, [(0.0, &ends[0]), (1.0, &ends[1])], 1e-12, &mut found);
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for ([a, b], at) in found.iter().zip(expected) {
            assert!(a < b && b - a <= 1e-12 && *a <= at + 1e-15 && *b >= at - 1e-15, "{found:?} {expected:?}");
        }
    }

    #[test]
    fn every_roll_of_a_foot_is_found() {
        // The foot stands on two corners up to a distance of `BAND` from each tenth.
        const BAND: f64 = 1e-5;
        let watch = |x: f64| {
            let nearest = (10.0 * x).round();
            let next = nearest as usize;
            match (x - 0.1 * nearest).abs() <= BAND && (1..10).contains(&next) {
                true => standing(&[next - 1, next]),
                false => standing(&[(10.0 * x).floor().min(9.0) as usize]),
            }
        };
        let expected: Vec<f64> = (1..10).flat_map(|k| [0.1 * f64::from(k) - BAND, 0.1 * f64::from(k) + BAND]).collect();
        assert_changes(watch, &expected);
    }

    #[test]
    fn refused_places_are_changes_too() {
        let watch = |x: f64| if (0.3..0.6).contains(&x) { None } else { standing(&[usize::from(x > 0.5)]) };
        assert_changes(watch, &[0.3, 0.6]);
    }

    #[test]
    fn contacts_that_rounding_decides_are_left() {
        let mut asked = 0_u64;
        let mut watch = |_: f64| {
            asked += 1;
            standing(&[asked as usize])
        };
        let ends = [watch(0.0), watch(1.0)];
        let mut found = Vec::new();
        contact_changes(&mut watch, [(0.0, &ends[0]), (1.0, &ends[1])], 1e-12, &mut found);
        assert_eq!(found.len(), MOST);
        assert!(asked < 50_000, "{asked}");
    }
}
