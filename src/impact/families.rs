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
    /// The result of the last number type that was tried.
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
            match self.family(pending, exact, &mut known, &mut found) {
                Ok(Some(is_precise)) => settled &= is_precise,
                open => {
                    settled &= open.is_ok();
                    found.open.push(pending.clone());
                }
            }
        }
        (found, settled)
    }

    /// Adds a family and its corners that are not `known` yet. Returns whether the outcomes at these have the promised
    /// digits; `None` if there are too many corners.
    fn family<T: Ordered>(
        &self,
        pending: &Pending,
        exact: &ContactProblem<T>,
        known: &mut Vec<(Vec<Mode>, Vec<T>)>,
        found: &mut FoundFamilies,
    ) -> Result<Option<bool>, Unsettled> {
        let scale = &Scale::of(exact);
        let Some((dimension, corners)) = Equations::of(exact, scale, &pending.modes).family()? else { return Ok(None) };
        let (mut is_precise, mut places, mut new) = (true, Vec::new(), Vec::new());
        for velocity in corners {
            let modes = modes_of(&velocity, exact.laws())?;
            let mut place = None;
            for (at, (other, same)) in known.iter().enumerate() {
                if *other == modes && are_zero(velocity.iter().zip(same).map(|(&entry, &same)| entry - same))? {
                    place = Some(at);
                }
            }
            places.push(place.unwrap_or(known.len() + new.len()));
            if place.is_some() {
                continue;
            }
            let corner = if let Some(place) = self.collected.place_of(&modes) {
                Corner::Isolated(place)
            } else {
                let outcome = T::freeing(|| Equations::of(exact, scale, &modes).outcome_at(&velocity))?;
                is_precise &= outcome.numbers.are_precise;
                let combination = self.pending.iter().find(|other| other.modes == modes).unwrap_or(pending);
                Corner::OfFamily(combination.number, outcome)
            };
            new.push(((modes, velocity), corner));
        }
        for (velocity, corner) in new {
            known.push(velocity);
            found.corners.push(corner);
        }
        found.families.push((pending.clone(), dimension, places));
        Ok(Some(is_precise))
    }
}
