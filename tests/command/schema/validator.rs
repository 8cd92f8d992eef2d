//! A JSON Schema validator for the keywords that the schemas use; any other is a failure, so that none is passed over.

use serde_json::Value;

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
        "minimum" => value.as_f64().is_none_or(|number| number >= number_of(argument)),
        "maximum" => value.as_f64().is_none_or(|number| number <= number_of(argument)),
        "exclusiveMinimum" => value.as_f64().is_none_or(|number| number > number_of(argument)),
        "exclusiveMaximum" => value.as_f64().is_none_or(|number| number < number_of(argument)),
        "items" => value.as_array().is_none_or(|entries| entries.iter().all(|entry| holds(root, argument, entry))),
        "minItems" => value.as_array().is_none_or(|entries| entries.len() as f64 >= number_of(argument)),
        "maxItems" => value.as_array().is_none_or(|entries| entries.len() as f64 <= number_of(argument)),
        "uniqueItems" => value
            .as_array()
            .is_none_or(|entries| entries.iter().enumerate().all(|(at, entry)| !entries[..at].contains(entry))),
        "minProperties" => value.as_object().is_none_or(|object| object.len() as f64 >= number_of(argument)),
        "maxProperties" => value.as_object().is_none_or(|object| object.len() as f64 <= number_of(argument)),
        "propertyNames" => value
            .as_object()
            .is_none_or(|object| object.keys().all(|key| holds(root, argument, &Value::from(key.as_str())))),
        "pattern" => value.as_str().is_none_or(|text| matches(argument, text)),
        "required" => value
            .as_object()
            .is_none_or(|object| list(argument).iter().all(|name| object.contains_key(name.as_str().expect("a name")))),
        "properties" => value.as_object().is_none_or(|object| {
            let properties = argument.as_object().expect("schemas by name");
            object.iter().all(|(name, field)| properties.get(name).is_none_or(|schema| holds(root, schema, field)))
        }),
        "additionalProperties" => value.as_object().is_none_or(|object| {
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

/// Whether the text has the one pattern that the schemas use.
fn matches(pattern: &Value, text: &str) -> bool {
    assert_eq!(pattern, "^[A-Za-z_][A-Za-z0-9_]*$");
    let letter = |c: char| c == '_' || c.is_ascii_alphabetic();
    text.starts_with(letter) && text.chars().all(|c| letter(c) || c.is_ascii_digit())
}

fn list(argument: &Value) -> &[Value] {
    argument.as_array().expect("a list")
}

fn number_of(argument: &Value) -> f64 {
    argument.as_f64().expect("a number")
}
