//! The schemas of what is read: parts of `format.json`, in a study with expressions in place of numbers.
//!
//! ```text
//!     {"type": "number", ...} --> {"anyOf": [{"type": "number", ...}, {"$ref": "#/$defs/Expression"}]}
//! ```

use crate::read::json::FORMAT;
use serde_json::{Map, Value, json};

/// The schema of one document, with the definitions that it refers to.
pub(super) fn schema(document: &str) -> Value {
    let mut all: Value = serde_json::from_str(FORMAT).unwrap_or_default();
    let mut definitions = Map::new();
    let mut schema = all["$defs"][document].take();
    refer(&schema, &all["$defs"], &mut definitions);
    schema["$schema"] = all["$schema"].take();
    schema["title"] = document.into();
    schema["$defs"] = definitions.into();
    schema
}

/// Takes over every definition that a schema refers to.
fn refer(schema: &Value, all: &Value, definitions: &mut Map<String, Value>) {
    match schema {
        Value::Array(entries) => entries.iter().for_each(|entry| refer(entry, all, definitions)),
        Value::Object(object) => {
            let name = object.get("$ref").and_then(Value::as_str).and_then(|path| path.strip_prefix("#/$defs/"));
            if let Some(name) = name.filter(|name| !definitions.contains_key(*name)) {
                definitions.insert(name.to_owned(), all[name].clone());
                refer(&all[name], all, definitions);
            }
            object.values().for_each(|value| refer(value, all, definitions));
        }
        _ => {}
    }
}

/// Lets expressions stand for all numbers of a whole schema.
pub(super) fn allow_expressions(schema: &mut Value) {
    within(schema);
    let expression = json!({
        "type": "string",
        "description":
            "An expression of parameters, constants, pi, e and functions such as sin, as \"-(alpha + pi/2)^2\".",
    });
    schema["$defs"]["Expression"] = expression;
}

fn within(schema: &mut Value) {
    match schema {
        Value::Array(entries) => entries.iter_mut().for_each(within),
        Value::Object(object) if is_number(object) => {
            let mut number = std::mem::take(object);
            let kept: Vec<(String, Value)> =
                ["title", "description"].into_iter().filter_map(|key| number.remove_entry(key)).collect();
            object.extend(kept);
            object.insert("anyOf".into(), json!([number, {"$ref": "#/$defs/Expression"}]));
        }
        // An id is never an expression, and neither are values that stand for themselves.
        Value::Object(object) => {
            for (key, field) in object.iter_mut().filter(|(key, _)| !matches!(key.as_str(), "enum" | "const")) {
                match (key.as_str(), field) {
                    ("properties" | "$defs", Value::Object(named)) => {
                        named.iter_mut().filter(|(name, _)| *name != "id").for_each(|(_, schema)| within(schema));
                    }
                    (_, field) => within(field),
                }
            }
        }
        _ => {}
    }
}

fn is_number(schema: &Map<String, Value>) -> bool {
    matches!(schema.get("type").and_then(Value::as_str), Some("number" | "integer"))
}
