//! Errors of serde_json, with place and hint.

use super::{Value, line_and_column};
use crate::{Error, Reason};
use serde_path_to_error::Segment;

/// serde_json's error in our words; the place is looked for only now, by reading once more.
pub(super) fn refusal(text: &str, error: &serde_json::Error) -> Error {
    let (line, byte) = (error.line().max(1), error.column());
    let start: usize = text.split_inclusive('\n').take(line - 1).map(str::len).sum();
    let offset = start + byte.saturating_sub(1);
    let (_, column) = line_and_column(text, offset);

    let whole = error.to_string();
    let message = match whole.split(" at line ").next().unwrap_or_default() {
        "recursion limit exceeded" => {
            return Error::new(Reason::Syntax("brackets are nested too deep".to_owned())).on(line, column);
        }
        // What begins with t, f or n is taken for true, false or null.
        "expected ident" => "expected value",
        message => message,
    };
    let mut refused = Error::new(Reason::Syntax(message.to_owned())).on(line, column);
    let rest = text.as_bytes().get(offset..).unwrap_or_default();
    if error.is_eof() {
        refused = refused.hint("the text ends too early: is it whole?");
    } else if ["NaN", "Infinity", "-Infinity"].iter().any(|word| rest.starts_with(word.as_bytes())) {
        refused = refused.hint("JSON has no NaN and no infinity; numbers are finite");
    } else if rest.starts_with(b"//") || rest.starts_with(b"/*") || rest.starts_with(b"#") {
        refused = refused.hint("JSON has no comments: leave it out");
    }

    let mut reader = serde_json::Deserializer::from_str(text);
    let place =
        serde_path_to_error::deserialize::<_, Value>(&mut reader).err().map(|tracked| known_part(tracked.path()));
    match place {
        Some(place) if !place.is_empty() => refused.at(place),
        _ => refused,
    }
}

/// The path as far as its keys were read.
fn known_part(path: &serde_path_to_error::Path) -> String {
    let mut place = String::new();
    for segment in path {
        match segment {
            Segment::Seq { index } => place.push_str(&format!("[{index}]")),
            Segment::Map { key } if place.is_empty() => place.push_str(key),
            Segment::Map { key } => place.extend([".", key]),
            Segment::Enum { .. } | Segment::Unknown => break,
        }
    }
    place
}
