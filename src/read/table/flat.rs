//! States as flat lines of JSON, in the form in which data frames are written: the keys are the names of the columns.
//!
//! ```text
//!     {"id":"k17","q_base_z":0.41,"v_base_z":-1.0,"phase":null}
//! ```
//!
//! The first line that can be read names the columns. Null, and a key that a later line lacks, are empty cells.

use crate::read::documents::utf8;
use crate::read::json::{line_and_column, raw_fields};
use crate::{Error, Reason, Result};
use csv::ByteRecord;
use serde_json::value::RawValue;
use std::borrow::Cow;

/// Returns whether a line of JSON is a flat state; `None` if it is blank or broken. A line that begins a list is none.
pub fn is_flat(line: &[u8]) -> Option<bool> {
    let is_coordinate = |name: &str| name.starts_with("q_") || name.starts_with("v_");
    if line.trim_ascii_start().starts_with(b"[") {
        return Some(false);
    }
    let fields = fields(line).ok()?;
    let any = |wanted: &dyn Fn(&str) -> bool| fields.iter().any(|(key, _)| wanted(key));
    Some(any(&is_coordinate) && !any(&|key| matches!(key, "position" | "velocity")))
}

/// Returns the keys of a line.
pub(super) fn keys(line: &[u8]) -> Result<Vec<String>> {
    Ok(fields(line)?.into_iter().map(|(key, _)| key.into_owned()).collect())
}

/// Reads the values of a line into the cells of the columns, as they are written; a null gives an empty cell.
pub(super) fn read(line: &[u8], columns: &[String], cells: &mut ByteRecord) -> Result<()> {
    let fields = fields(line)?;
    let refuse = |key: &str, reason: Reason| Error::new(reason).at(key).on(1, column_of(line, key, true));
    let mut values = vec![None; columns.len()];
    // Most lines have the keys in the order of the first line.
    let mut next = 0;
    for (key, value) in &fields {
        let is_next = columns.get(next).is_some_and(|column| column == key);
        let at = if is_next { Some(next) } else { columns.iter().position(|column| column == key) };
        let at = at.ok_or_else(|| match fields.iter().find(|(key, _)| matches!(&**key, "position" | "velocity")) {
            Some((nested, _)) if !columns.iter().any(|column| column == nested) => {
                let reason = "this line is a nested state, and the first line is flat".to_owned();
                refuse(nested, Reason::Inconsistent(reason)).hint("write all states in one form")
            }
            _ => refuse(key, Reason::Inconsistent("the first line has no such key".into()))
                .hint("it names the columns: give the key there, too, with null"),
        })?;
        if values[at].replace(value.get()).is_some() {
            return Err(refuse(key, Reason::Duplicate { what: "key", name: key.to_string() }));
        }
        next = at + 1;
    }
    cells.clear();
    cells.extend(values.into_iter().map(|value| value.filter(|text| *text != "null").unwrap_or_default()));
    Ok(())
}

/// Returns the column at which a key begins, or its value, in characters from 1; 1 if there is none.
pub(super) fn column_of(line: &[u8], name: &str, of_key: bool) -> usize {
    let place = |(key, value): &(Cow<str>, &RawValue)| {
        let start = match key {
            // A quotation mark is before it.
            Cow::Borrowed(key) if of_key => key.as_ptr() as usize - 1,
            _ => value.get().as_ptr() as usize,
        };
        let offset = start.checked_sub(line.as_ptr() as usize)?;
        Some(line_and_column(line, offset).1)
    };
    fields(line).ok().and_then(|fields| fields.iter().rev().find(|(key, _)| key == name).and_then(place)).unwrap_or(1)
}

fn fields(line: &[u8]) -> Result<Vec<(Cow<'_, str>, &RawValue)>> {
    raw_fields(utf8(line)?)
}
