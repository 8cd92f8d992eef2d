//! What a result repeats of the table or recording that its state comes from.

use crate::Robot;
use crate::gait::Landing;
use crate::state::State;
#[cfg(feature = "schema")]
use crate::write::state::any_object;
use crate::write::state::raw_state;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::borrow::Cow;

/// Where in a recording a foot reached the ground, and how the state was taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Touchdown<'a> {
    /// The line of the state's row in the table, or of the last row before it, from 1.
    pub row: usize,
    /// The time of the state \[s\].
    pub time: f64,
    /// The contact that reached the ground; of several at once the first.
    pub striking: Cow<'a, str>,
    /// What was added to the base's z so that this contact is at height 0 \[m\].
    pub shift_z: f64,
    /// `crossing` if the state lies between two rows, `row` if it is one.
    pub at: Cow<'a, str>,
    /// Which other feet take part: `strike`, `slow:SPEED,HEIGHT` or `near:HEIGHT`.
    pub touching: String,
    /// The state before the impact, to be fed back.
    #[cfg_attr(feature = "schema", schemars(schema_with = "any_object"))]
    pub state: Box<RawValue>,
    /// Its q and v, for tables.
    #[serde(skip)]
    pub coordinates: Vec<f64>,
}

impl<'a> Touchdown<'a> {
    /// The touchdown of a `state` that was found behind a `row` of a recording at `time` \[s\].
    pub fn of(robot: &Robot, state: &State, landing: &'a Landing, row: usize, time: f64) -> Option<Self> {
        Some(Self {
            row,
            time,
            striking: (&landing.striking).into(),
            shift_z: landing.shift_z,
            at: landing.at.name().into(),
            touching: landing.touching.to_string(),
            state: raw_state(robot, state)?,
            coordinates: [&state.position[..], &state.velocity].concat(),
        })
    }
}
