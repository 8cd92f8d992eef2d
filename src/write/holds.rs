//! Whether a verdict holds on the box of its state's uncertainty, and a state where it does not.

use super::state::StateRecord;
use crate::Robot;
use crate::impact::Verdict;
use crate::law::Mode;
use crate::pipeline::robust;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::RawValue;
use std::borrow::Cow;

/// `true`, `false` or `"unknown"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "Value", try_from = "Value")]
pub enum HoldsRecord {
    /// Every state of the box has the same outcomes, as lists of modes.
    Yes,
    /// Some state has others.
    No,
    /// Neither was shown.
    Unknown,
}

impl From<HoldsRecord> for Value {
    fn from(holds: HoldsRecord) -> Self {
        match holds {
            HoldsRecord::Yes => true.into(),
            HoldsRecord::No => false.into(),
            HoldsRecord::Unknown => "unknown".into(),
        }
    }
}

impl TryFrom<Value> for HoldsRecord {
    type Error = &'static str;

    fn try_from(value: Value) -> Result<Self, Self::Error> {
        let all = [Self::Yes, Self::No, Self::Unknown];
        all.into_iter().find(|&holds| Value::from(holds) == value).ok_or("expected true, false or \"unknown\"")
    }
}

impl From<&robust::Robustness> for HoldsRecord {
    fn from(holds: &robust::Robustness) -> Self {
        match holds {
            robust::Robustness::Everywhere => Self::Yes,
            robust::Robustness::Not(_) => Self::No,
            robust::Robustness::Unknown => Self::Unknown,
        }
    }
}

/// A state of the box with other outcomes.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Counterexample")]
pub struct CounterexampleRecord<'a> {
    /// The state as it is read, with the contacts by name.
    #[cfg_attr(feature = "schema", schemars(schema_with = "any_object"))]
    pub state: Box<RawValue>,
    /// Its verdict.
    pub verdict: Verdict,
    /// Its outcomes' lists of modes.
    pub outcomes: Cow<'a, [Vec<Mode>]>,
}

impl<'a> CounterexampleRecord<'a> {
    /// The counterexample of what was found about a state of `robot`; `None` if there is none.
    pub fn of(robot: &'a Robot, holds: &'a robust::Robustness) -> Option<Self> {
        let robust::Robustness::Not(found) = holds else { return None };
        let state = serde_json::value::to_raw_value(&StateRecord { robot, state: &found.state }).ok()?;
        Some(Self { state, verdict: found.verdict, outcomes: Cow::Borrowed(&found.outcomes) })
    }
}

/// Any object, of which there is a schema of its own.
#[cfg(feature = "schema")]
fn any_object(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({"type": "object"})
}
