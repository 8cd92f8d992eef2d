//! The change at a border: which inequality of which contact is zero there.
//!
//! ```text
//!     an outcome that ends at a border is rejected beyond it, because of the slack that is zero on it
//! ```

use super::line::Bracket;
use super::model::Solver;
use super::regime::Regime;
use crate::Error;
use crate::impact::{Analysis, Outcome, Rejection, RejectionReason};
use crate::law::{Inequality, Mode};
use crate::pipeline::Aspect;
use serde::Serialize;

/// An inequality that is zero on a border.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EndedOutcome {
    /// The contact's name.
    pub contact: String,
    /// The inequality that is zero.
    pub inequality: Inequality,
    /// The outcome that begins or ends there.
    pub modes: Vec<Mode>,
    /// The side of the border on which it is an outcome.
    #[serde(rename = "valid")]
    pub side: Side,
}

/// A side of a border.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// At smaller parameters.
    Below,
    /// At greater parameters.
    Above,
}

/// What changes at a border.
#[derive(Debug, Clone, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Transition {
    /// The inequalities that are zero there.
    #[serde(rename = "turns")]
    pub ended: Vec<EndedOutcome>,
    /// Contacts that are closed below it and open above it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub opening: Vec<String>,
    /// Contacts that are open below it and closed above it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub closing: Vec<String>,
    /// Why states are refused below it and above it, if they are.
    #[serde(skip)]
    pub refused: [Option<Error>; 2],
}

impl Transition {
    /// Determines the transition between the sides of a `bracket`; `place` maps its line into the space of parameters.
    pub fn at(solver: &mut Solver, bracket: &Bracket, place: impl Fn(f64) -> Vec<f64>) -> Self {
        let outcomes = |regime: &Regime| regime.outcomes().unwrap_or_default().to_vec();
        let below = solver.explained(&place(bracket.below.at), &outcomes(&bracket.above.regime));
        let above = solver.explained(&place(bracket.above.at), &outcomes(&bracket.below.regime));
        let (below, above) = match (below, above) {
            (Ok(below), Ok(above)) => (below, above),
            (below, above) => return Self { refused: [below.err(), above.err()], ..Self::default() },
        };
        if below.0 != above.0 {
            let missing = |from: &[String], other: &[String]| -> Vec<String> {
                from.iter().filter(|name| !other.contains(name)).cloned().collect()
            };
            let (opening, closing) = (missing(&below.0, &above.0), missing(&above.0, &below.0));
            return Self { opening, closing, ..Self::default() };
        }
        let names = &below.0;
        let aspect = solver.model.study.question();
        let mut ended = ending(aspect, names, [&below.1, &above.1], Side::Below);
        ended.extend(ending(aspect, names, [&above.1, &below.1], Side::Above));
        Self { ended, ..Self::default() }
    }

    /// Returns the same transition, seen from the other side.
    pub fn reversed(&self) -> Self {
        let reversed = |cause: &EndedOutcome| {
            let side = if cause.side == Side::Below { Side::Above } else { Side::Below };
            EndedOutcome { side, ..cause.clone() }
        };
        let [below, above] = self.refused.clone();
        Self {
            ended: self.ended.iter().map(reversed).collect(),
            opening: self.closing.clone(),
            closing: self.opening.clone(),
            refused: [above, below],
        }
    }

    /// Returns whether the same things change, in any order.
    pub fn is_same_as(&self, other: &Self) -> bool {
        let all = |one: &Self, two: &Self| one.ended.iter().all(|cause| two.ended.contains(cause));
        all(self, other)
            && all(other, self)
            && (&self.opening, &self.closing) == (&other.opening, &other.closing)
            && self.refused.each_ref().map(Option::is_some) == other.refused.each_ref().map(Option::is_some)
    }
}

/// Next to a border the margin of an outcome is at most this, unless the state jumps there.
const ZERO: f64 = 1e-4;
/// If a force has no bound, the margin of the outcome beyond the border is less than this.
const UNBOUNDED: f64 = -1e4;

/// Returns the outcomes `here`, on this `side`, that the other side rejects, with the violated inequality and contact.
fn ending(aspect: Aspect, names: &[String], [here, there]: [&Analysis; 2], side: Side) -> Vec<EndedOutcome> {
    let cause = |outcome: &Outcome| {
        let modes = &outcome.modes;
        let rejection = there.rejected.iter().find(|rejection| rejection.modes == *modes)?;
        let RejectionReason::Violated { contact, inequality } = rejection.because else { return None };
        let (contact, inequality) = match inequality {
            _ if aspect == Aspect::Forces && rejection.margin.is_some_and(|margin| margin < UNBOUNDED) => {
                (most_pushed(rejection).unwrap_or(contact), Inequality::UnboundedForce)
            }
            // An outcome with a large margin ends because the state jumps; no inequality is zero.
            _ if outcome.margin.is_some_and(|margin| margin > ZERO) => return None,
            other => (contact, other),
        };
        Some(EndedOutcome { contact: names.get(contact)?.clone(), inequality, modes: modes.clone(), side })
    };
    here.outcomes.iter().filter_map(cause).collect()
}

/// Returns the contact with the greatest force.
fn most_pushed(rejection: &Rejection) -> Option<usize> {
    let forces = rejection.motion.as_ref()?.impulse.iter().map(|&[t, n]| libm::hypot(t, n));
    Some(forces.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))?.0)
}
