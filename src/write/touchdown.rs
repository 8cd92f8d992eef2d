//! What a result tells of the recording that its state comes from.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use std::borrow::Cow;

/// Where in a recording a foot reached the ground, and how the state was taken.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Touchdown<'a> {
    /// The row of the state, or the last one before it, counted from 0 without the header.
    pub row: usize,
    /// The time of the state \[s\].
    pub time: f64,
    /// The contact that reached the ground; of several at once the first.
    pub striking: &'a str,
    /// What was added to the base's z so that this contact is at height 0 \[m\].
    pub shift_z: f64,
    /// `crossing` where the state lies between two rows, `row` where it is one.
    pub at: &'static str,
    /// Which other feet take part: `strike`, `slow:SPEED,HEIGHT` or `near:HEIGHT`.
    pub touching: String,
}

/// Fields of a table that are carried through, written as an object.
#[derive(Debug, Clone)]
pub struct CarriedFields<'a>(pub Vec<(&'a str, Cow<'a, str>)>);

impl Serialize for CarriedFields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, text) in &self.0 {
            map.serialize_entry(name, text)?;
        }
        map.end()
    }
}
