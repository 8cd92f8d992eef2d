//! Finds the families of a problem and their corners, which several families may share.

use super::collected::{Collected, Corner, FoundFamilies, Pending};
use super::linear::{Unsettled, are_zero};
use super::problem::{ContactProblem, Precision, PrecisionTask};
use super::singular::{Equations, modes_of};
use super::slack::Scale;
use crate::law::Mode;
use crate::scalar::Ordered;

/// Solves all families together, because two corners can be shown to be the same only in the same numbers.
pub struct FamiliesPass<'a, 'c> {
    pub pending: Vec<Pending>,
    pub collected: &'c Collected<'a>,
    /// What the last attempted kind of numbers found.
    pub found: FoundFamilies,
}

impl PrecisionTask for FamiliesPass<'_, '_> {
    fn attempt<T: Ordered>(&mut self, exact: &ContactProblem<T>, _: Precision) -> bool {
        let (found, settled) = T::freeing(|| self.find(exact));
        self.found = found;
        settled
    }
}

impl FamiliesPass<'_, '_> {
    /// Returns the families, and whether all signs and digits are settled.
    fn find<T: Ordered>(&self, exact: &ContactProblem<T>) -> (FoundFamilies, bool) {
        let mut found = FoundFamilies::default();
        let mut settled = true;
        // The modes and the velocity of each known corner.
        let mut known: Vec<(Vec<Mode>, Vec<T>)> = Vec::new();
        for pending in &self.pending {
            match self.family(pending, exact, &known) {
                Ok(Some(family)) => {
                    settled &= family.is_sharp;
                    let places = family.places;
                    for (modes, velocity, corner) in family.new {
                        known.push((modes, velocity));
                        found.corners.push(corner);
                    }
                    found.families.push((pending.clone(), family.dimension, places));
                }
                open => {
                    settled &= open.is_ok();
                    found.open.push(pending.clone());
                }
            }
        }
        (found, settled)
    }

    fn family<T: Ordered>(
        &self,
        pending: &Pending,
        exact: &ContactProblem<T>,
        known: &[(Vec<Mode>, Vec<T>)],
    ) -> Result<Option<FamilyCorners<T>>, Unsettled> {
        let scale = &Scale::of(exact);
        let Some((dimension, corners)) = Equations::of(exact, scale, &pending.modes).family()? else { return Ok(None) };
        let mut family = FamilyCorners { dimension, is_sharp: true, places: Vec::new(), new: Vec::new() };
        for velocity in corners {
            let modes = modes_of(&velocity, exact.laws())?;
            let mut place = None;
            for (at, (other, same)) in known.iter().enumerate() {
                if *other == modes && are_zero(velocity.iter().zip(same).map(|(&own, &same)| own - same))? {
                    place = Some(at);
                }
            }
            family.places.push(place.unwrap_or(known.len() + family.new.len()));
            if place.is_some() {
                continue;
            }
            let corner = if let Some(place) = self.collected.place_of(&modes) {
                Corner::Isolated(place)
            } else {
                let outcome = T::freeing(|| Equations::of(exact, scale, &modes).outcome_at(&velocity))?;
                family.is_sharp &= outcome.numbers.are_sharp;
                let own = self.pending.iter().find(|other| other.modes == modes).unwrap_or(pending);
                Corner::OfFamily(own.number, outcome)
            };
            family.new.push((modes, velocity, corner));
        }
        Ok(Some(family))
    }
}

/// The corners of one family: the places of all of them, and the new ones.
struct FamilyCorners<T> {
    dimension: usize,
    /// Whether the outcomes at the new corners have the promised digits.
    is_sharp: bool,
    places: Vec<usize>,
    new: Vec<(Vec<Mode>, Vec<T>, Corner)>,
}
