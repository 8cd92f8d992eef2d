//! Records of refused inputs.

#[cfg(feature = "schema")]
use super::Id;
use super::{NearestRecord, short_id};
use crate::{Error, Reason};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt::{self, Display};

/// The record that replaces the result of a refused input.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Refused {
    /// The user's name for the input, if it can be read; a long one is cut and ends with `... (cut)`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Id>"))]
    pub id: Option<Value>,
    /// The line on which the input begins, from 1.
    pub line: usize,
    /// The reason.
    pub error: ErrorObject,
}

/// A refusal; it names no file, so that a file, a pipe and standard input give the same bytes.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ErrorObject {
    /// Why.
    pub message: String,
    /// The place inside the input, as in `position.joints.left_hip`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// The remedy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hint: Option<String>,
    /// The foot that is too deep in the ground.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestRecord<'static>>,
}

impl Refused {
    /// Creates the refusal of the input that begins on `line`.
    pub fn new(id: Option<Value>, line: usize, error: &Error) -> Self {
        Self { id: id.map(short_id), line, error: ErrorObject::new(error) }
    }
}

impl ErrorObject {
    /// Creates the record of an error, without its file, line and column.
    pub fn new(error: &Error) -> Self {
        let [place, hint] = [error.place(), error.remedy()].map(|text| text.map(str::to_owned));
        let nearest = match error.reason() {
            Reason::Penetration { link, depth, velocity: Some(velocity), .. } => {
                Some(NearestRecord { name: link.clone().into(), height: -depth, velocity: *velocity })
            }
            _ => None,
        };
        Self { message: error.reason().to_string(), place, hint, nearest }
    }
}

/// Writes place, message and hint on one line.
impl Display for ErrorObject {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place.as_ref().map_or(String::new(), |place| format!("{place}: "));
        write!(out, "{place}{}{}", self.message, self.hint.as_ref().map_or(String::new(), |hint| format!("; {hint}")))
    }
}
