//! Results in brief.

#[cfg(feature = "schema")]
use super::Id;
use super::refused::ErrorObject;
use super::{Report, Touchdown};
use crate::Mode;
use crate::impact::{Family, Next, OpenCombinations, Outcome, Verdict};
use crate::read::table::CarriedValue;
use crate::state::Named;
use crate::write::state::HoldsRecord;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::borrow::Cow;

/// An outcome in brief.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OutcomeInBrief<'a> {
    /// One mode per contact.
    pub modes: Cow<'a, [Mode]>,
    /// Sign of det A.
    pub index: Option<i8>,
    /// The smallest slack of the outcome's inequalities, free of units.
    pub margin: Option<f64>,
    /// The forces just after the impact, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<Cow<'a, Next>>,
    /// False if the combination is neither shown nor excluded; absent if true.
    #[serde(default = "yes", skip_serializing_if = "bool::clone")]
    pub decided: bool,
}

/// A closed contact in brief.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ContactInBrief<'a> {
    /// Its name.
    pub name: Cow<'a, str>,
}

/// The result in brief.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Brief<'a> {
    /// The user's name for the input.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Id>"))]
    pub id: Option<Cow<'a, Value>>,
    /// The line on which the input begins, from 1; present in a batch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    /// Where the state was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub touchdown: Option<Touchdown<'a>>,
    /// The answer in one word.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// Whether error bounds decide every combination.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proven: Option<bool>,
    /// Whether every state of the box has the same outcomes; absent without an uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holds: Option<HoldsRecord>,
    /// The closed contacts, in the order of the modes.
    pub contacts: Vec<ContactInBrief<'a>>,
    /// Every outcome.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<Vec<OutcomeInBrief<'a>>>,
    /// What an undecided state or problem leaves open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open: Option<OpenCombinations>,
    /// Lists of modes with many velocities, all of which are outcomes; absent if there are none.
    #[serde(default, skip_serializing_if = "<[Family]>::is_empty")]
    pub families: Cow<'a, [Family]>,
    /// Columns of the input table that are named as foreign.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<std::collections::BTreeMap<String, Value>>"))]
    pub carried: Option<Named<CarriedValue>>,
    /// The reason why there are no outcomes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorObject>,
}

impl Report<'_> {
    /// Returns the result in brief.
    pub fn brief(&self) -> Brief<'_> {
        let outcomes = self.outcomes.as_deref().unwrap_or_default().iter();
        let in_brief = outcomes.map(|&Outcome { ref modes, index, margin, decided, ref next, .. }| {
            let modes = Cow::Borrowed(&**modes);
            OutcomeInBrief { modes, index, margin, next: next.as_ref().map(Cow::Borrowed), decided }
        });
        let contacts = self.contacts.iter().map(|contact| ContactInBrief { name: Cow::Borrowed(&*contact.name) });
        Brief {
            id: self.id.clone(),
            line: self.line,
            touchdown: self.touchdown.clone(),
            verdict: self.verdict,
            proven: self.proven,
            holds: self.holds,
            contacts: contacts.collect(),
            outcomes: self.outcomes.is_some().then(|| in_brief.collect()),
            open: self.open,
            families: self.families.clone(),
            carried: self.carried.clone(),
            error: self.error.clone(),
        }
    }
}

fn yes() -> bool {
    true
}
