//! From a schema of numbers to one where an expression may stand for each.
//!
//! ```text
//!     {"type": "number", ...} --> {"anyOf": [{"type": "number", ...}, {"$ref": "#/$defs/Expression"}]}
//! ```

use serde_json::{Map, Value, json};

/// Lets expressions stand for all numbers of a whole schema.
pub(super) fn allow(schema: &mut Value) {
    within(schema);
    let expression = json!({
        "type": "string",
        "description": "An expression of parameters, constants, pi, e and functions such as sin, as \"-(alpha + pi/2)^2\".",
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
