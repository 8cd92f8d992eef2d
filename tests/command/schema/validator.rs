//! A JSON Schema validator for the keywords that the schemas use. Any other keyword panics, so that none is ignored.

use crate::list;
use serde_json::{Value, json};

/// Whether `value` is valid by `schema`.
pub fn is_valid(schema: &Value, value: &Value) -> bool {
    holds(schema, schema, value)
}

fn holds(root: &Value, schema: &Value, value: &Value) -> bool {
    let keywords = match schema {
        Value::Bool(holds) => return *holds,
        Value::Object(keywords) => keywords,
        _ => panic!("no schema: {schema}"),
    };
    let (number, array, object) = (value.as_f64(), value.as_array(), value.as_object());
    keywords.iter().all(|(keyword, argument)| match keyword.as_str() {
        "$schema" | "$defs" | "title" | "description" | "format" => true,
        "$ref" => holds(root, target(root, argument), value),
        "type" => match argument {
            Value::Array(kinds) => kinds.iter().any(|kind| is_of_kind(value, kind)),
            kind => is_of_kind(value, kind),
        },
        "const" => value == argument,
        "enum" => list(argument).contains(value),
        "anyOf" => list(argument).iter().any(|choice| holds(root, choice, value)),
        "oneOf" => list(argument).iter().filter(|choice| holds(root, choice, value)).count() == 1,
        "not" => !holds(root, argument, value),
        "minimum" => number.is_none_or(|number| number >= number_of(argument)),
        "maximum" => number.is_none_or(|number| number <= number_of(argument)),
        "exclusiveMinimum" => number.is_none_or(|number| number > number_of(argument)),
        "exclusiveMaximum" => number.is_none_or(|number| number < number_of(argument)),
        "items" => array.is_none_or(|entries| entries.iter().all(|entry| holds(root, argument, entry))),
        "minItems" => array.is_none_or(|entries| entries.len() as f64 >= number_of(argument)),
        "maxItems" => array.is_none_or(|entries| entries.len() as f64 <= number_of(argument)),
        "uniqueItems" => array.is_none_or(|entries| (1..entries.len()).all(|at| !entries[..at].contains(&entries[at]))),
        "minProperties" => object.is_none_or(|object| object.len() as f64 >= number_of(argument)),
        "maxProperties" => object.is_none_or(|object| object.len() as f64 <= number_of(argument)),
        "propertyNames" => object.is_none_or(|object| object.keys().all(|key| holds(root, argument, &json!(key)))),
        "pattern" => value.as_str().is_none_or(|text| matches(argument, text)),
        "required" => object
            .is_none_or(|object| list(argument).iter().all(|name| object.contains_key(name.as_str().expect("a name")))),
        "properties" => object.is_none_or(|object| {
            let properties = argument.as_object().expect("schemas by name");
            object.iter().all(|(name, field)| properties.get(name).is_none_or(|schema| holds(root, schema, field)))
        }),
        "additionalProperties" => object.is_none_or(|object| {
            let named = |name: &str| keywords.get("properties").is_some_and(|named| named.get(name).is_some());
            object.iter().all(|(name, field)| named(name) || holds(root, argument, field))
        }),
        unknown => panic!("the validator does not know the keyword {unknown}"),
    })
}

fn target<'s>(root: &'s Value, reference: &Value) -> &'s Value {
    let pointer = reference.as_str().and_then(|reference| reference.strip_prefix('#'));
    pointer.and_then(|pointer| root.pointer(pointer)).expect("a reference within the schema")
}

fn is_of_kind(value: &Value, kind: &Value) -> bool {
    match kind.as_str().expect("a kind") {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        unknown => panic!("no kind of value: {unknown}"),
    }
}

/// Whether the text matches the only pattern that the schemas use.
fn matches(pattern: &Value, text: &str) -> bool {
    assert_eq!(pattern, "^[A-Za-z_][A-Za-z0-9_]*$");
    let letter = |c: char| c == '_' || c.is_ascii_alphabetic();
    text.starts_with(letter) && text.chars().all(|c| letter(c) || c.is_ascii_digit())
}

fn number_of(argument: &Value) -> f64 {
    argument.as_f64().expect("a number")
}
