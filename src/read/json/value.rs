//! Reads a [`Value`] from text through serde_json, and converts its errors to ours, with place and hint.

use super::line_and_column;
use crate::state::Entries;
use crate::{Error, Reason};
use serde::Deserialize;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Deserializer, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::Number;
use serde_json::value::RawValue;
use serde_path_to_error::Segment;
use std::borrow::Cow;
use std::fmt;

/// The remedy for digits beyond the range of f64.
pub(crate) const TOO_LARGE: &str = "numbers go up to 1.8e308; friction without a bound is \"infinite\"";

/// A JSON value that borrows from its text.
#[derive(Debug, Clone)]
pub(crate) enum Value<'t> {
    Null,
    Bool,
    Number(Number),
    Text(Cow<'t, str>),
    List(Vec<Value<'t>>),
    Object(Vec<(Cow<'t, str>, Value<'t>)>),
}

impl<'t> Value<'t> {
    /// Reads the only value of `text`; numbers beyond f64's range, such as 1e999, are refused.
    pub(crate) fn parse(text: &'t str) -> crate::Result<Self> {
        serde_json::from_str(text).map_err(|error| refusal(text, &error))
    }

    /// Returns the kind of value, as in `found a string`.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Value::Null => "null",
            Value::Bool => "true or false",
            Value::Number(_) => "a number",
            Value::Text(_) => "a string",
            Value::List(_) => "a list",
            Value::Object(_) => "an object",
        }
    }

    /// Returns the keys and values of an object; empty for other values.
    pub(crate) fn fields(&self) -> &[(Cow<'t, str>, Self)] {
        match self {
            Value::Object(fields) => fields,
            _ => &[],
        }
    }

    /// Returns the field of that name; `None` if the value is no object or has no such field.
    pub(crate) fn get(&self, name: &str) -> Option<&Self> {
        self.fields().iter().find(|(key, _)| key == name).map(|(_, value)| value)
    }
}

/// A key, borrowed unless it has escapes.
#[derive(Deserialize)]
#[serde(transparent)]
struct Key<'t>(#[serde(borrow)] Cow<'t, str>);

impl<'de> Deserialize<'de> for Value<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(AnyValue)
    }
}

struct AnyValue;

impl<'de> Visitor<'de> for AnyValue {
    type Value = Value<'de>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a JSON value")
    }
    fn visit_unit<E>(self) -> Result<Self::Value, E> {
        Ok(Value::Null)
    }
    fn visit_bool<E>(self, _: bool) -> Result<Self::Value, E> {
        Ok(Value::Bool)
    }
    fn visit_u64<E>(self, number: u64) -> Result<Self::Value, E> {
        Ok(Value::Number(number.into()))
    }
    fn visit_i64<E>(self, number: i64) -> Result<Self::Value, E> {
        Ok(Value::Number(number.into()))
    }
    fn visit_f64<E: serde::de::Error>(self, number: f64) -> Result<Self::Value, E> {
        Number::from_f64(number).map(Value::Number).ok_or_else(|| E::custom("number out of range"))
    }
    fn visit_borrowed_str<E>(self, text: &'de str) -> Result<Self::Value, E> {
        Ok(Value::Text(Cow::Borrowed(text)))
    }
    fn visit_str<E>(self, text: &str) -> Result<Self::Value, E> {
        Ok(Value::Text(Cow::Owned(text.to_owned())))
    }
    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Self::Value, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(list)).map(Value::List)
    }
    fn visit_map<A: MapAccess<'de>>(self, object: A) -> Result<Self::Value, A::Error> {
        Entries::deserialize(MapAccessDeserializer::new(object)).map(|entries| Value::Object(fields(entries)))
    }
}

/// Returns the fields of the only object of `text`, with their values as they are written.
pub(crate) fn raw_fields(text: &str) -> crate::Result<Vec<(Cow<'_, str>, &RawValue)>> {
    serde_json::from_str(text).map(fields).map_err(|error| refusal(text, &error))
}

fn fields<'t, V>(Entries(entries): Entries<Key<'t>, V>) -> Vec<(Cow<'t, str>, V)> {
    entries.into_iter().map(|(Key(key), value)| (key, value)).collect()
}

/// Returns the `id` of an object that may be malformed after it; `None` if none can be read.
pub(crate) fn id_in(text: &str) -> Option<serde_json::Value> {
    struct IdVisitor<'a>(&'a mut Option<serde_json::Value>);

    impl<'de> Visitor<'de> for IdVisitor<'_> {
        type Value = ();

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("an object")
        }
        fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
            while let Some(Key(key)) = map.next_key()? {
                if key == "id" {
                    *self.0 = id_of(map.next_value::<&RawValue>()?.get());
                    return Err(A::Error::custom("the rest is not needed"));
                }
                map.next_value::<IgnoredAny>()?;
            }
            Ok(())
        }
    }

    let mut id = None;
    // It does not matter here whether the rest can be read.
    let _ = serde_json::Deserializer::from_str(text).deserialize_map(IdVisitor(&mut id));
    id
}

/// Returns the id at the beginning of `text`, a string or a number; an integer of more than 64 bits becomes a string.
pub(crate) fn id_of(text: &str) -> Option<serde_json::Value> {
    let end = text.find(|c: char| !matches!(c, '-' | '+' | '.' | 'e' | 'E' | '0'..='9')).unwrap_or(text.len());
    let digits = &text[..end];
    let is_integer = !digits.is_empty() && digits.bytes().all(|byte| matches!(byte, b'-' | b'0'..=b'9'));
    match serde_json::from_str(if end == 0 { text } else { digits }).ok()? {
        serde_json::Value::Number(number) if number.is_f64() && is_integer => Some(digits.into()),
        id @ (serde_json::Value::String(_) | serde_json::Value::Number(_)) => Some(id),
        _ => None,
    }
}

/// Converts an error of serde_json; its place is found only now, by a second reading.
fn refusal(text: &str, error: &serde_json::Error) -> Error {
    let start: usize = text.split_inclusive('\n').take(error.line().max(1) - 1).map(str::len).sum();
    let found = start + error.column().saturating_sub(1);
    let whole = error.to_string();
    // Text that begins with t, f or n is taken for true, false or null, and refused inside the word; a number out of
    // range at its end.
    let is_of_word = |byte: &&u8| {
        whole.starts_with("expected ident") && byte.is_ascii_alphabetic()
            || whole.starts_with("number out of range") && (byte.is_ascii_digit() || b"+-.eE".contains(byte))
    };
    let offset = found - text.as_bytes()[..found.min(text.len())].iter().rev().take_while(is_of_word).count();
    let location = line_and_column(text.as_bytes(), offset);
    let syntax = |message: &str| Error::new(Reason::Syntax(message.to_owned())).on(location.0, location.1);
    let refused = match whole.split(" at line ").next().unwrap_or_default() {
        "recursion limit exceeded" => return syntax("brackets are nested too deep"),
        "expected ident" => syntax("expected value"),
        message => syntax(message),
    };
    let rest = text.as_bytes().get(offset..).unwrap_or_default();
    let begins = |words: &[&str]| words.iter().any(|word| rest.starts_with(word.as_bytes()));
    let is_infinite = begins(&["NaN", "nan", "Infinity", "-Infinity", "inf", "-inf", "Inf", "-Inf"]);
    let is_key = |kind: fn(&u8) -> bool| whole.starts_with("key must be") && rest.first().is_some_and(kind);
    let lacks_comma = whole.starts_with("expected `,`") && begins(&["\"", "{", "["]);
    let hints = [
        (error.is_eof(), "the text ends too early: is it whole?"),
        (whole.starts_with("number out of range"), TOO_LARGE),
        (is_infinite, "JSON has no NaN and no infinity: numbers are finite, and friction alone may be \"infinite\""),
        (begins(&["'"]), "JSON has double quotes, as in {\"friction\": 0.8}"),
        (whole.starts_with("trailing comma"), "leave out the comma before the closing bracket"),
        (lacks_comma, "put a comma before it"),
        (is_key(u8::is_ascii_digit), "numbers have a decimal point, as in 0.8"),
        (is_key(u8::is_ascii_alphabetic), "names are in double quotes, as in {\"friction\": 0.8}"),
        (begins(&[","]), "leave out this comma"),
        (
            text.trim_start().starts_with('<'),
            "is this a robot description? commands that take one have it as their first argument",
        ),
        (
            is_table(text),
            "is this a table? `heelstrike batch` reads CSV, with commas between columns and points in numbers",
        ),
        (is_yaml(text), "is this YAML? JSON has braces and double quotes, as in {\"friction\": 0.8}"),
        (begins(&["//", "/*", "#"]), "JSON has no comments: leave it out"),
    ];
    let refused = match hints.into_iter().find(|(applies, _)| *applies) {
        Some((_, hint)) => refused.hint(hint),
        None => refused,
    };
    match serde_path_to_error::deserialize::<_, Value>(&mut serde_json::Deserializer::from_str(text)) {
        Err(error) => refused.at(known_part(error.path())),
        Ok(_) => refused,
    }
}

/// Returns whether a text that is not JSON begins as YAML does: with `---`, or with a plain word and a colon.
fn is_yaml(text: &str) -> bool {
    let word = text.trim_start().split_once(':').map_or("", |(word, _)| word);
    text.starts_with("---") || !word.is_empty() && word.chars().all(|c| c.is_alphanumeric() || c == '_')
}

/// Returns whether a text that is not JSON begins as a table of states does: with names of coordinates among others.
fn is_table(text: &str) -> bool {
    let mut names = text.lines().next().unwrap_or_default().split([',', ';', '\t']).map(str::trim);
    names.clone().nth(1).is_some() && names.any(|name| name.starts_with("q_") || name.starts_with("v_"))
}

/// Returns the path up to the last key that was read.
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
