//! The formats of states, problems and studies: `format.json`, a JSON Schema with a definition for each object.
//!
//! It is the one list of their fields: readers take those that they name in hints from it, and the schemas that are
//! printed are parts of it. `tests/command/schema` compares schemas and readers value by value.

use super::json::Value;

/// The formats as JSON.
pub(crate) const FORMAT: &str = include_str!("format.json");

/// The names of an object's fields, in the order in which hints list them.
pub(super) fn fields_of(object: &str) -> Vec<String> {
    let fields = |value: Value<'static>, name: &str| match value {
        Value::Object(fields) => fields.into_iter().find(|(key, _)| key == name).map(|(_, value)| value),
        _ => None,
    };
    let properties = Value::parse(FORMAT)
        .ok()
        .and_then(|format| ["$defs", object, "properties"].into_iter().try_fold(format, fields));
    match properties {
        Some(Value::Object(fields)) => fields.into_iter().map(|(name, _)| name.into_owned()).collect(),
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_listed_in_their_order() {
        assert_eq!(fields_of("Contact"), ["link", "offset", "radius"]);
        assert!(fields_of("Friction").is_empty(), "no object");
    }
}
