//! Strict reading of JSON: every field once, every refusal with its place, line and column.
//!
//! ```text
//!     text --serde_json--> Value (a tree that borrows the text) --Node (a value that knows its way from the root)--> State, Problem
//! ```
//!
//! A [`Value`] keeps objects as lists, so that a key given twice is seen, and borrows keys and strings, so that their
//! place in the text is known without being stored. A [`Node`] lives on its reader's stack; its path to the root costs
//! nothing until an [`Error`] needs it.

mod read;
mod syntax;

pub(crate) use read::id_in;

use crate::read::expression::{FUNCTIONS, Fault, Names};
use crate::{Error, Reason, Result};
use serde_json::Number;
use std::borrow::Cow;

/// A JSON value that borrows its text.
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
    /// Reads the one value of `text`.
    ///
    /// # Errors
    /// [`Reason::Syntax`] with place, line and column, also for numbers beyond f64's range such as 1e999.
    pub(crate) fn parse(text: &'t str) -> Result<Self> {
        serde_json::from_str(text).map_err(|error| syntax::refusal(text, &error))
    }

    /// The kind of value, as in `found a string`.
    fn kind(&self) -> &'static str {
        match self {
            Value::Null => "null",
            Value::Bool => "true or false",
            Value::Number(_) => "a number",
            Value::Text(_) => "a string",
            Value::List(_) => "a list",
            Value::Object(_) => "an object",
        }
    }
}

/// The step from a parent to a node.
#[derive(Debug, Clone, Copy)]
enum Step<'n> {
    Root { text: &'n str, names: Option<&'n Names> },
    Field { parent: &'n Node<'n>, key: &'n str },
    Entry { parent: &'n Node<'n>, index: usize },
}

/// A value and its way from the root.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node<'n> {
    value: &'n Value<'n>,
    step: Step<'n>,
}

impl<'n> Node<'n> {
    /// The root of the tree that was read from `text`.
    pub(crate) fn root(value: &'n Value<'n>, text: &'n str) -> Self {
        Self { value, step: Step::Root { text, names: None } }
    }

    /// The same, where any number may be an expression of `names`.
    pub(crate) fn root_with(value: &'n Value<'n>, text: &'n str, names: &'n Names) -> Self {
        Self { value, step: Step::Root { text, names: Some(names) } }
    }

    /// The key under which the value stands; empty for the root and for entries of lists.
    pub(crate) fn key(&self) -> &'n str {
        match self.step {
            Step::Field { key, .. } => key,
            _ => "",
        }
    }

    /// The fields of an object in their order; `what` names what its keys stand for.
    ///
    /// # Errors
    /// [`Reason::WrongKind`] if it is none, [`Reason::Duplicate`] if a key stands twice.
    pub(crate) fn fields(&'n self, what: &'static str) -> Result<impl Iterator<Item = Node<'n>> + Clone> {
        let Value::Object(fields) = self.value else {
            return Err(self.expected("an object"));
        };
        if let Some(second) = second_of_its_name(fields) {
            let name = second.to_owned();
            return Err(self.field(second, self.value).refuse_name(second, Reason::Duplicate { what, name }));
        }
        Ok(fields.iter().map(move |(key, value)| self.field(key, value)))
    }

    fn field(&'n self, key: &'n str, value: &'n Value<'n>) -> Node<'n> {
        Node { value, step: Step::Field { parent: self, key } }
    }

    /// The entries of a list.
    ///
    /// # Errors
    /// [`Reason::WrongKind`] if it is none.
    pub(crate) fn entries(&'n self) -> Result<impl ExactSizeIterator<Item = Node<'n>>> {
        let Value::List(entries) = self.value else {
            return Err(self.expected("a list"));
        };
        let entries = entries.iter().enumerate();
        Ok(entries.map(move |(index, value)| Node { value, step: Step::Entry { parent: self, index } }))
    }

    /// The list of exactly `N` numbers.
    ///
    /// # Errors
    /// [`Reason::WrongKind`], naming `expected`.
    pub(crate) fn numbers<const N: usize>(&'n self, expected: &'static str) -> Result<[f64; N]> {
        let Value::List(entries) = self.value else {
            return Err(self.expected(expected));
        };
        if entries.len() != N {
            let found = entries.len();
            return Err(self.refuse(Reason::Inconsistent(format!("expected {expected}, found {found} entries"))));
        }
        let mut numbers = [0.0; N];
        for (number, entry) in numbers.iter_mut().zip(self.entries()?) {
            *number = entry.number()?;
        }
        Ok(numbers)
    }

    /// The list of numbers, of any length.
    ///
    /// # Errors
    /// [`Reason::WrongKind`].
    pub(crate) fn vector(&'n self) -> Result<Vec<f64>> {
        self.entries()?.map(|entry| entry.number()).collect()
    }

    /// The list of lists of numbers, each as long as the first.
    ///
    /// # Errors
    /// [`Reason::WrongKind`], or [`Reason::Inconsistent`] for a row of another length.
    pub(crate) fn matrix(&'n self) -> Result<Vec<Vec<f64>>> {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for entry in self.entries()? {
            let row = entry.vector()?;
            if let Some(first) = rows.first().map(Vec::len).filter(|&first| first != row.len()) {
                let found = row.len();
                let reason = format!("the row has {found} entries, and the first row {first}");
                return Err(entry.refuse(Reason::Inconsistent(reason)));
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// The number, or the value of an expression where they are allowed; it is finite, because JSON has no others.
    ///
    /// # Errors
    /// [`Reason::WrongKind`], or [`Reason::Syntax`] for an expression without a value.
    pub(crate) fn number(&self) -> Result<f64> {
        match (self.value, self.names()) {
            (Value::Number(number), _) => number.as_f64().ok_or_else(|| self.expected("a number")),
            (Value::Text(text), Some(names)) => {
                names.evaluate(text).map_err(|fault| self.refuse_expression(names, fault))
            }
            (_, Some(_)) => Err(self.expected("a number or an expression")),
            (_, None) => Err(self.expected("a number")),
        }
    }

    /// Whether a string here may be an expression.
    pub(crate) fn takes_expressions(&self) -> bool {
        self.names().is_some()
    }

    /// A number from 0 on; `what` it is.
    ///
    /// # Errors
    /// As [`Node::number`], and [`Reason::OutOfRange`].
    pub(crate) fn number_from_zero(&self, what: &str) -> Result<f64> {
        let value = self.number()?;
        if value >= 0.0 {
            return Ok(value);
        }
        Err(self.refuse(Reason::OutOfRange { what: what.to_owned(), allowed: "0 or more", value }))
    }

    /// What expressions are made of, where they are allowed.
    fn names(&self) -> Option<&'n Names> {
        let mut step = self.step;
        loop {
            step = match step {
                Step::Root { names, .. } => return names,
                Step::Field { parent, .. } | Step::Entry { parent, .. } => parent.step,
            };
        }
    }

    /// Refuses an expression at the character that is wrong with it.
    fn refuse_expression(&self, names: &Names, fault: Fault) -> Error {
        let error = self.refuse(Reason::Syntax(format!("the expression has no value: {}", fault.what)));
        let error = match error.location() {
            // Behind the quotation mark.
            Some(at) => error.on(at.line, at.column + 1 + fault.before),
            None => error,
        };
        let Some(unknown) = fault.unknown else { return error };
        if FUNCTIONS.contains(&unknown.as_str()) {
            return error.hint(format!("{unknown} is a function, as in {unknown}(1)"));
        }
        if unknown == "log" {
            return error.hint("write ln or log10: log is the one to some and the other to others");
        }
        let nearest = error.did_you_mean(&unknown, names.iter().chain(FUNCTIONS));
        match (nearest.remedy(), names.iter().collect::<Vec<_>>()) {
            (Some(_), _) => nearest,
            (None, known) if known.is_empty() => {
                nearest.hint("only pi, e and functions such as sin and atan2 are known here")
            }
            (None, known) => {
                nearest.hint(format!("known here are {}, pi, e and functions such as sin and atan2", known.join(", ")))
            }
        }
    }

    /// The string.
    ///
    /// # Errors
    /// [`Reason::WrongKind`].
    pub(crate) fn text(&self) -> Result<&'n str> {
        self.as_text().ok_or_else(|| self.expected("a string"))
    }

    /// The string, if it is one.
    pub(crate) fn as_text(&self) -> Option<&'n str> {
        match self.value {
            Value::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Whether it is an object.
    pub(crate) fn is_object(&self) -> bool {
        matches!(self.value, Value::Object(_))
    }

    /// Whether it is a list.
    pub(crate) fn is_list(&self) -> bool {
        matches!(self.value, Value::List(_))
    }

    /// An `id`: a string or a number.
    ///
    /// # Errors
    /// [`Reason::WrongKind`].
    pub(crate) fn id(&self) -> Result<serde_json::Value> {
        match self.value {
            Value::Text(text) => Ok(serde_json::Value::String(text.as_ref().to_owned())),
            Value::Number(number) => Ok(serde_json::Value::Number(number.clone())),
            _ => Err(self.expected("a string or a number")),
        }
    }

    /// Refuses a value of the wrong kind.
    pub(crate) fn expected(&self, expected: &'static str) -> Error {
        self.refuse(Reason::WrongKind { expected, found: self.value.kind() })
    }

    /// Refuses a field that the format does not have, and offers the nearest of those it has.
    pub(crate) fn unknown_field(&self, known: &[String]) -> Error {
        let error = self.refuse_name(self.key(), Reason::UnknownField(self.key().to_owned()));
        let nearest = error.did_you_mean(self.key(), known.iter().map(String::as_str));
        match nearest.remedy() {
            Some(_) => nearest,
            None => nearest.hint(format!("the fields here are {}", known.join(", "))),
        }
    }

    /// Refuses the value for `reason`, with its place, line and column.
    pub(crate) fn refuse(&self, reason: Reason) -> Error {
        self.refuse_name(self.as_text().unwrap_or_default(), reason)
    }

    /// Puts an error about a part of this value at its line and column, the part's place behind the value's.
    pub(crate) fn refuse_inside(&self, error: Error) -> Error {
        let mut place = String::new();
        self.write_place(&mut place);
        place.push_str(error.place().unwrap_or_default());
        self.locate(error.at(place))
    }

    /// Puts an error that was found later at this value's line and column.
    pub(crate) fn locate(&self, error: Error) -> Error {
        let (line, column) = self.location("");
        error.on(line, column)
    }

    /// Refuses `name`, which is the value or its key.
    pub(crate) fn refuse_name(&self, name: &str, reason: Reason) -> Error {
        let mut place = String::new();
        self.write_place(&mut place);
        let mut error = Error::new(reason);
        if !place.is_empty() {
            error = error.at(place);
        }
        let (line, column) = self.location(name);
        error.on(line, column)
    }

    fn write_place(&self, place: &mut String) {
        match self.step {
            Step::Root { .. } => {}
            Step::Field { parent, key } => {
                parent.write_place(place);
                if !place.is_empty() {
                    place.push('.');
                }
                place.push_str(key);
            }
            Step::Entry { parent, index } => {
                parent.write_place(place);
                place.push_str(&format!("[{index}]"));
            }
        }
    }

    /// Line and column of `name`, else of the nearest key on the way to the root, if it stands in the text as it is.
    fn location(&self, name: &str) -> (usize, usize) {
        let (mut key, mut step) = (None, self.step);
        let text = loop {
            step = match step {
                Step::Root { text, .. } => break text,
                Step::Field { parent, key: nearer } => {
                    key = key.or(Some(nearer));
                    parent.step
                }
                Step::Entry { parent, .. } => parent.step,
            };
        };
        let offset = [Some(name), key].into_iter().flatten().find_map(|anchor| offset_in(text, anchor));
        line_and_column(text, offset.unwrap_or(0))
    }
}

/// Where `part` begins in `text`, if it is a piece of it and not a copy; the quotation mark before it belongs to it.
fn offset_in(text: &str, part: &str) -> Option<usize> {
    let offset = (part.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    // An empty piece has an address of no meaning.
    (!part.is_empty() && offset + part.len() <= text.len()).then(|| offset.saturating_sub(1))
}

/// Line and column, counted from 1, of the byte `offset`.
pub(crate) fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text.as_bytes()[..offset.min(text.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count();
    let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    // Bytes that continue a character do not count.
    let column = before[start..].iter().filter(|&&byte| byte & 0xC0 != 0x80).count();
    (line + 1, column + 1)
}

/// The second of two equal keys.
fn second_of_its_name<'v>(fields: &'v [(Cow<'_, str>, Value<'_>)]) -> Option<&'v str> {
    /// Up to here every pair is compared; beyond, the keys are sorted.
    const FEW: usize = 16;
    if fields.len() <= FEW {
        let twice = |&(at, (key, _)): &(usize, &'v (Cow<str>, Value))| fields[..at].iter().any(|(k, _)| k == key);
        return fields.iter().enumerate().find(twice).map(|(_, (key, _))| key.as_ref());
    }
    let mut keys: Vec<&str> = fields.iter().map(|(key, _)| key.as_ref()).collect();
    // The sort is stable: of equal keys the later one stays behind.
    keys.sort();
    keys.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_knows_its_place_line_and_column() {
        let text = "{\"contacts\": [\n  {\"offset\": [0, \"é\"]}]}";
        let tree = Value::parse(text).expect("well-formed");
        let root = Node::root(&tree, text);
        let contacts = root.fields("field").expect("an object").next().expect("one field");
        let contact = contacts.entries().expect("a list").next().expect("one entry");
        let offset = contact.fields("field").expect("an object").next().expect("one field");
        let error = offset.vector().expect_err("a string is no number");
        assert_eq!(error.to_string(), "2:18: contacts[0].offset[1]: expected a number, found a string");
    }

    #[test]
    fn of_two_equal_keys_the_second_is_refused() {
        for others in ["", &(0..30).map(|k| format!("\"k{k}\": 0, ")).collect::<String>()] {
            let text = format!("{{{others}\"a\": 1,\n\"a\": 2}}");
            let tree = Value::parse(&text).expect("well-formed");
            let root = Node::root(&tree, &text);
            let error = root.fields("field").map(|_| ()).expect_err("a key stands twice");
            assert_eq!(error.to_string(), "2:1: a: field \"a\" is given twice");
        }
    }

    #[test]
    fn numbers_beyond_the_range_are_refused_with_their_place() {
        let error = Value::parse("{\"position\": {\"base\": {\"x\": 1e999}}}").expect_err("no f64 is that large");
        assert_eq!(error.place(), Some("position.base.x"));
        assert_eq!(error.location().map(|location| location.line), Some(1));
    }

    #[test]
    fn an_id_is_read_before_the_text_breaks() {
        assert_eq!(id_in("{\"id\": \"k18\", \"position\": {"), Some("k18".into()));
        assert_eq!(id_in("{\"position\": {}, \"id\": 7, oops"), Some(7.into()));
        assert_eq!(id_in("{\"id\": null}"), None);
        assert_eq!(id_in("nonsense"), None);
    }

    #[test]
    fn deep_nesting_is_refused_and_not_followed() {
        let error = Value::parse(&"[".repeat(200_000)).expect_err("too deep");
        assert!(matches!(error.reason(), Reason::Syntax(_)));
    }
}
