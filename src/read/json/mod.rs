//! Strict reading of JSON: every field may occur once, and every refusal has its place, line and column.
//!
//! ```text
//! text --serde_json--> Value (borrows the text) --Node (a value and its path from the root)--> State, Problem, Study
//! ```
//!
//! A [`Value`] keeps objects as lists, so that a key that is given twice is noticed. It borrows keys and strings, so
//! that their place in the text is known without being stored. A [`Node`] lives on its reader's stack, and its path to
//! the root costs nothing until an [`Error`] needs it.

mod value;

pub(crate) use value::{TOO_LARGE, Value, id_in, id_of, raw_fields};

use crate::error::{Location, from_zero};
use crate::read::expression::{CONSTANTS, FUNCTIONS, Fault, Names};
use crate::{Error, Reason, Result};
use std::borrow::Cow;
use std::collections::HashSet;

/// The formats of states, problems and studies: a JSON Schema with a definition for each object. It is the only list of
/// their fields, from which hints and printed schemas come; `tests/command/schema` compares it with the readers.
pub(crate) const FORMAT: &str = include_str!("../format.json");

/// The last step of the path from the root to a node.
#[derive(Debug, Clone, Copy)]
enum PathStep<'n> {
    Root { text: &'n str, names: Option<&'n Names> },
    Field { parent: &'n Node<'n>, key: &'n str },
    Entry { parent: &'n Node<'n>, index: usize },
}

/// A value and its path from the root.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node<'n> {
    value: &'n Value<'n>,
    way: PathStep<'n>,
}

impl<'n> Node<'n> {
    /// Creates the root of the tree that was read from `text`; with `names`, any number may be an expression of them.
    pub(crate) fn root(value: &'n Value<'n>, text: &'n str, names: Option<&'n Names>) -> Self {
        Self { value, way: PathStep::Root { text, names } }
    }

    /// The key of the value; empty for the root and for entries of lists.
    pub(crate) fn key(&self) -> &'n str {
        match self.way {
            PathStep::Field { key, .. } => key,
            _ => "",
        }
    }

    /// Returns the fields of an object in order, or an error if a key is given twice; `what` says what the keys name.
    pub(crate) fn fields(&'n self, what: &'static str) -> Result<impl Iterator<Item = Node<'n>> + Clone> {
        let Value::Object(fields) = self.value else { return Err(self.expected("an object")) };
        let field = |key, value| Node { value, way: PathStep::Field { parent: self, key } };
        if let Some(second) = second_of_its_name(fields) {
            let name = second.to_owned();
            return Err(field(second, self.value).refuse_name(second, Reason::Duplicate { what, name }));
        }
        Ok(fields.iter().map(move |(key, value)| field(key, value)))
    }

    /// Returns the fields with these names; others are refused, because `object` of the format does not have them.
    pub(crate) fn object<const N: usize>(&'n self, object: &str, names: [&str; N]) -> Result<[Option<Node<'n>>; N]> {
        let mut found = [None; N];
        for field in self.fields("field")? {
            match names.iter().position(|name| *name == field.key()) {
                Some(at) => found[at] = Some(field),
                None => return Err(field.unknown_field(object)),
            }
        }
        Ok(found)
    }

    /// Returns the field of that name; other fields are not checked.
    pub(crate) fn field(&'n self, name: &str) -> Result<Option<Node<'n>>> {
        Ok(self.fields("field")?.find(|field| field.key() == name))
    }

    /// Returns the entries of a list.
    pub(crate) fn entries(&'n self) -> Result<impl ExactSizeIterator<Item = Node<'n>>> {
        let Value::List(entries) = self.value else { return Err(self.expected("a list")) };
        let entries = entries.iter().enumerate();
        Ok(entries.map(move |(index, value)| Node { value, way: PathStep::Entry { parent: self, index } }))
    }

    /// Returns the numbers of a list of exactly `N`, described by `expected`.
    pub(crate) fn numbers<const N: usize>(&'n self, expected: &'static str) -> Result<[f64; N]> {
        let entries = self.entries().map_err(|_| self.expected(expected))?;
        if entries.len() != N {
            let found = entries.len();
            return Err(self.refuse(Reason::Inconsistent(format!("expected {expected}, found {found} entries"))));
        }
        let mut numbers = [0.0; N];
        for (number, entry) in numbers.iter_mut().zip(entries) {
            *number = entry.number()?;
        }
        Ok(numbers)
    }

    /// Returns the numbers of a list of any length.
    pub(crate) fn vector(&'n self) -> Result<Vec<f64>> {
        self.entries()?.map(|entry| entry.number()).collect()
    }

    /// Returns the rows of a list of lists of numbers, all of the same length.
    pub(crate) fn matrix(&'n self) -> Result<Vec<Vec<f64>>> {
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for entry in self.entries()? {
            let row = entry.vector()?;
            if let Some(first) = rows.first().map(Vec::len).filter(|&first| first != row.len()) {
                let reason = format!("the row has {} entries, and the first row {first}", row.len());
                return Err(entry.refuse(Reason::Inconsistent(reason)));
            }
            rows.push(row);
        }
        Ok(rows)
    }

    /// Returns the number, or the value of an expression where these are allowed; JSON has finite numbers only.
    pub(crate) fn number(&self) -> Result<f64> {
        if let Value::Number(number) = self.value {
            return number.as_f64().ok_or_else(|| self.expected("a number"));
        }
        match (self.value, self.names()) {
            (Value::Text(text), Some(names)) => {
                names.evaluate(text).map_err(|fault| self.refuse_expression(names, fault))
            }
            (_, Some(_)) => Err(self.expected("a number or an expression")),
            (_, None) => Err(self.expected_number("a number")),
        }
    }

    /// Refuses a value that is no number; a number in quotes gets a remedy.
    pub(crate) fn expected_number(&self, expected: &'static str) -> Error {
        let error = self.expected(expected);
        match self.as_text().filter(|text| text.trim().parse::<f64>().is_ok_and(f64::is_finite)) {
            Some(text) => error.hint(format!("write {} without quotes", text.trim())),
            None => error,
        }
    }

    /// Returns a number that is 0 or more; `what` names it in errors.
    pub(crate) fn number_from_zero(&self, what: &str) -> Result<f64> {
        from_zero(self.number()?, what).map_err(|error| self.refuse_inside(error))
    }

    /// The names that expressions may use; `None` if strings are not expressions.
    pub(crate) fn names(&self) -> Option<&'n Names> {
        match self.way {
            PathStep::Root { names, .. } => names,
            PathStep::Field { parent, .. } | PathStep::Entry { parent, .. } => parent.names(),
        }
    }

    /// Refuses an expression, with the location of the character at fault.
    fn refuse_expression(&self, names: &Names, fault: Fault) -> Error {
        let error = self.refuse(Reason::Syntax(format!("the expression has no value: {}", fault.what)));
        // The text begins after the quotation mark.
        let error = error.relocated(|at| Location { column: at.column + 1 + fault.before, ..at });
        let Some(unknown) = fault.unknown else { return error };
        if FUNCTIONS.contains(&unknown.as_str()) {
            return error.hint(format!("{unknown} is a function, as in {unknown}(1)"));
        }
        if unknown == "log" {
            return error.hint("write ln or log10: log is the one to some and the other to others");
        }
        let known = match names.iter().filter(|name| !CONSTANTS.contains(name)).collect::<Vec<_>>().join(", ") {
            none if none.is_empty() => "only pi, e and functions such as sin and atan2 are known here".to_owned(),
            known => format!("known here are {known}, pi, e and functions such as sin and atan2"),
        };
        error.hint(known).did_you_mean(&unknown, names.iter().chain(FUNCTIONS))
    }

    /// Returns the string.
    pub(crate) fn text(&self) -> Result<&'n str> {
        self.as_text().ok_or_else(|| self.expected("a string"))
    }

    /// Returns the string; `None` if the value is none.
    pub(crate) fn as_text(&self) -> Option<&'n str> {
        let Value::Text(text) = self.value else { return None };
        Some(text)
    }

    pub(crate) fn is_object(&self) -> bool {
        matches!(self.value, Value::Object(_))
    }

    /// Returns an `id`: a string or a number; an integer of more than 64 bits is kept as the string of its digits.
    pub(crate) fn id(&self) -> Result<serde_json::Value> {
        match self.value {
            Value::Number(number) if number.is_f64() => Ok(self.raw().and_then(id_of).unwrap_or(number.clone().into())),
            Value::Text(text) => Ok(serde_json::Value::String(text.as_ref().to_owned())),
            Value::Number(number) => Ok(serde_json::Value::Number(number.clone())),
            _ => Err(self.expected("a string or a number")),
        }
    }

    /// Returns the text from this value on, if it is a field of the root.
    fn raw(&self) -> Option<&'n str> {
        let PathStep::Field { parent: Node { way: PathStep::Root { text, .. }, .. }, key } = self.way else {
            return None;
        };
        value_of(text, key)
    }

    /// Returns what the string stands for among `choices`, which `expected` lists.
    pub(crate) fn choice<T>(&self, expected: &'static str, choices: [(&'static str, T); 2]) -> Result<T> {
        let (text, names) = (self.text()?, choices.each_ref().map(|(name, _)| *name));
        let chosen = choices.into_iter().find(|(name, _)| *name == text);
        chosen.map(|(_, meant)| meant).ok_or_else(|| self.expected(expected).did_you_mean(text, names))
    }

    /// Refuses a value of the wrong kind.
    pub(crate) fn expected(&self, expected: &'static str) -> Error {
        let error = self.refuse(Reason::WrongKind { expected, found: self.value.kind() });
        let is_field = !self.key().is_empty();
        match self.value {
            Value::Null if is_field => error.hint("leave the field out"),
            Value::List(_) if is_field && expected == "an object" => {
                error.hint("name the entries, as in {\"x\": 0.5, \"z\": 1}")
            }
            _ => error,
        }
    }

    /// Refuses an object without the field `name`.
    pub(crate) fn missing(&self, name: &str) -> Error {
        self.refuse(Reason::Missing(format!("\"{name}\"")))
    }

    /// Refuses a field that `object` of the format does not have, and suggests the nearest of the fields that it has.
    pub(crate) fn unknown_field(&self, object: &str) -> Error {
        let known = fields_of(object);
        let error = self.refuse_name(self.key(), Reason::UnknownField(self.key().to_owned()));
        let fields = format!("the fields here are {}", known.join(", "));
        let is_document = DOCUMENTS.iter().any(|(document, _)| *document == object);
        let whose = |(other, _): &&(&str, &str)| fields_of(other).iter().any(|field| field == self.key());
        if let Some((_, whose)) = DOCUMENTS.iter().find(whose).filter(|_| is_document) {
            return error.hint(format!("this is a field of {whose}; {fields}"));
        }
        if is_document && SETTINGS.contains(&self.key()) {
            return error.hint(format!("`{}` is set for all states, not in one; {fields}", self.key()));
        }
        let error = error.hint(if object == "Base" { format!("{fields}; {SPATIAL}") } else { fields });
        // `mu` is the symbol in formulas.
        let key = if self.key() == "mu" { "friction" } else { self.key() };
        error.did_you_mean(key, known.iter().map(String::as_str))
    }

    /// Refuses the value for `reason`, with its place, line and column.
    pub(crate) fn refuse(&self, reason: Reason) -> Error {
        self.refuse_name(self.as_text().unwrap_or_default(), reason)
    }

    /// Gives an error about a part of this value the value's line and column; the part's place follows the value's.
    pub(crate) fn refuse_inside(&self, error: Error) -> Error {
        let part = error.place().unwrap_or_default();
        let place = self.place() + part;
        self.locate(error.at(place))
    }

    /// Gives an error that was found later this value's line and column.
    pub(crate) fn locate(&self, error: Error) -> Error {
        let (line, column) = self.location(self.as_text().unwrap_or_default());
        error.on(line, column)
    }

    /// Refuses `name`, which is the value or its key.
    pub(crate) fn refuse_name(&self, name: &str, reason: Reason) -> Error {
        let (line, column) = self.location(name);
        Error::new(reason).at(self.place()).on(line, column)
    }

    /// Returns the keys and indices from the root, as in `contacts[0].offset`.
    fn place(&self) -> String {
        match self.way {
            PathStep::Root { .. } => String::new(),
            PathStep::Entry { parent, index } => format!("{}[{index}]", parent.place()),
            PathStep::Field { parent, key } => match parent.place() {
                outer if outer.is_empty() => key.to_owned(),
                outer => format!("{outer}.{key}"),
            },
        }
    }

    /// Returns line and column of `name`, or else of the nearest key, if either is a slice of the text.
    fn location(&self, name: &str) -> (usize, usize) {
        let (text, key) = self.text_and_key();
        line_and_column(text.as_bytes(), offset_in(text, name).or_else(|| offset_in(text, key)).unwrap_or(0))
    }

    /// Returns the root's text, and the nearest key on the path to it.
    fn text_and_key(&self) -> (&'n str, &'n str) {
        match self.way {
            PathStep::Root { text, .. } => (text, ""),
            PathStep::Field { parent, key } => (parent.text_and_key().0, key),
            PathStep::Entry { parent, .. } => parent.text_and_key(),
        }
    }
}

/// The documents of [`FORMAT`], with descriptions.
const DOCUMENTS: [(&str, &str); 3] = [
    ("State", "a state, which `heelstrike impact` and `batch` read"),
    ("Problem", "a contact problem, which `heelstrike solve` reads"),
    ("Study", "a study, which `heelstrike sweep` reads"),
];

/// Settings for all states, which are no fields of one state.
const SETTINGS: [&str; 5] = ["contact_tolerance", "resting_speed", "strict_limits", "feet", "budget"];

const SPATIAL: &str = "a table may give a base in three dimensions (q_base_y, q_base_qw and so on)";

/// Returns the names of an object's fields in [`FORMAT`], in the order in which hints list them.
pub(crate) fn fields_of(object: &str) -> Vec<String> {
    let Ok(format) = Value::parse(FORMAT) else { return Vec::new() };
    match ["$defs", object, "properties"].into_iter().try_fold(&format, |value, name| value.get(name)) {
        Some(Value::Object(fields)) => fields.iter().map(|(name, _)| name.to_string()).collect(),
        _ => Vec::new(),
    }
}

/// Returns the text from the value of `key` on; `None` if the key is a copy, because it has escapes.
pub(super) fn value_of<'t>(text: &'t str, key: &str) -> Option<&'t str> {
    // The offset is that of the quotation mark before the key.
    let behind = text.get(offset_in(text, key)? + key.len() + 2..)?;
    Some(behind.trim_ascii_start().strip_prefix(':')?.trim_ascii_start())
}

/// Returns the offset of the quotation mark before `part`; `None` if `part` is a copy and not a slice of `text`.
fn offset_in(text: &str, part: &str) -> Option<usize> {
    let offset = (part.as_ptr() as usize).checked_sub(text.as_ptr() as usize)?;
    // The address of an empty slice has no meaning.
    (!part.is_empty() && offset + part.len() <= text.len()).then(|| offset.saturating_sub(1))
}

/// Returns line and column (in characters, both from 1) of the byte at `offset`.
pub(crate) fn line_and_column(text: &[u8], offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let line = before.iter().filter(|&&byte| byte == b'\n').count();
    let start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |newline| newline + 1);
    // Bytes that continue a character do not count.
    let column = before[start..].iter().filter(|&&byte| byte & 0xC0 != 0x80).count();
    (line + 1, column + 1)
}

/// Returns the second of two equal keys; `None` if all differ.
fn second_of_its_name<'v>(fields: &'v [(Cow<'_, str>, Value<'_>)]) -> Option<&'v str> {
    /// Up to this number of fields every pair is compared, which needs no memory; beyond it, the keys are hashed.
    const FEW: usize = 16;
    let mut keys = fields.iter().map(|(key, _)| key.as_ref()).enumerate();
    let mut seen = HashSet::new();
    let second = match fields.len() <= FEW {
        true => keys.find(|&(at, key)| fields[..at].iter().any(|(earlier, _)| earlier == key)),
        false => keys.find(|&(_, key)| !seen.insert(key)),
    };
    second.map(|(_, key)| key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_equal_keys_the_second_is_refused() {
        for others in ["", &(0..30).map(|k| format!("\"k{k}\": 0, ")).collect::<String>()] {
            let text = format!("{{{others}\"a\": 1,\n\"a\": 2}}");
            let tree = Value::parse(&text).expect("well-formed");
            let error = Node::root(&tree, &text, None).field("a").map(|_| ()).expect_err("a key stands twice");
            assert_eq!(error.to_string(), "2:1: a: field \"a\" is given twice");
        }
    }
}
