//! What a result says of the recording that its state comes from.

use crate::state::Named;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::borrow::Cow;

/// Where in a recording a foot reached the ground, and how the state was taken.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Touchdown<'a> {
    /// The row of the state, or the last one before it, counted from 0 without the header.
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
}

/// Fields of a table that are carried through, written as an object.
#[derive(Debug, Clone)]
pub struct CarriedFields<'a>(pub Vec<(Cow<'a, str>, Cow<'a, str>)>);

impl Serialize for CarriedFields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, text)| (name, text)))
    }
}

impl<'de> Deserialize<'de> for CarriedFields<'_> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let fields = Named::<String>::deserialize(deserializer)?;
        Ok(Self(fields.iter().map(|(name, text)| (name.to_owned().into(), text.clone().into())).collect()))
    }
}
