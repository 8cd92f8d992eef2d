//! JSON Schema (draft 2020-12) of the documents that are read and written.
//!
//! The schema of a result is derived from the structs that are serialized. The schemas of states, problems and studies
//! are parts of `format.json`, from which the readers take the known fields. In a study, an expression may replace any
//! number:
//!
//! ```text
//!     {"type": "number", ...} --> {"anyOf": [{"type": "number", ...}, {"$ref": "#/$defs/Expression"}]}
//! ```
//!
//! The schemas are closed: like the strict readers, they allow no fields except those they name.

#![expect(dead_code, reason = "of these types the schema is all that is wanted")]

use super::forces::ForcesRecord;
use super::result::{Brief, Refused, Report};
use super::sweep::{MapSweep, RefusedSample, Sweep};
use crate::read::json::FORMAT;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value, json};

/// Marks a property that may be absent and may also be null.
const MAY_BE_NULL: &str = "x-may-be-null";

/// The schema of a state.
pub fn state() -> Value {
    input("State")
}

/// The schema of a contact problem.
pub fn problem() -> Value {
    input("Problem")
}

/// The schema of a study, in which every number except an id may be an expression.
pub fn study() -> Value {
    let mut schema = input("Study");
    allow_expressions(&mut schema);
    schema
}

/// The schema of a line of forces: a result, one in brief, or a refusal.
pub fn forces() -> Value {
    schema_of::<ForcesLine>()
}

/// The schema of the result of a study.
pub fn sweep() -> Value {
    schema_of::<SweepWhole>()
}

/// The schema of a line of results: a result, one in brief, or a refusal.
pub fn result() -> Value {
    schema_of::<ResultLine>()
}

/// The schema of a comparison of methods.
#[cfg(feature = "accuracy")]
pub fn accuracy() -> Value {
    schema_of::<super::Accuracy>()
}

/// One line of results.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(title = "Result")]
enum ResultLine<'a> {
    Whole(Box<Report<'a>>),
    Brief(Box<Brief<'a>>),
    Refused(Refused),
}

/// One line of results in sustained contact.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(title = "Forces")]
enum ForcesLine<'a> {
    Whole(Box<ForcesRecord<'a>>),
    Brief(Box<Brief<'a>>),
    Refused(Refused),
}

/// What is found along one parameter, or over two.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(title = "Sweep")]
enum SweepWhole<'a> {
    Along(WithSamples<'a, Sweep<'a>>),
    Map(WithSamples<'a, MapSweep<'a>>),
}

/// Regions, and the samples behind them.
#[derive(JsonSchema)]
#[schemars(inline)]
struct WithSamples<'a, T> {
    #[serde(flatten)]
    regions: T,
    /// In the order of the parameters, the last of which changes fastest.
    samples: Vec<SampleWhole<'a>>,
}

/// The parameters' values under their names, and the result there.
#[derive(JsonSchema)]
#[schemars(rename = "Sample", extend("additionalProperties" = {"type": "number"}))]
struct SampleWhole<'a> {
    /// As of `impact` or `forces`, or why there is none.
    result: SampleResult<'a>,
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
enum SampleResult<'a> {
    Whole(Box<Report<'a>>),
    Forces(Box<ForcesRecord<'a>>),
    Brief(Box<Brief<'a>>),
    Refused(RefusedSample),
}

fn schema_of<T: JsonSchema>() -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize().with_transform(RecursiveTransform(strict));
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// Closes one schema: it allows no unnamed properties, and optional properties are absent instead of null.
fn strict(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = plain_text(description);
    }
    if schema.get("properties").is_none() {
        return;
    }
    let required = schema.get("required").and_then(Value::as_array).cloned().unwrap_or_default();
    if let Some(Value::Object(properties)) = schema.get_mut("properties") {
        for (name, property) in properties {
            // A default replaces an absent field when reading; what is written has no defaults.
            property.as_object_mut().map(|property| property.remove("default"));
            if !required.iter().any(|required| required == name) {
                without_null(property);
            }
        }
    }
    if schema.get("additionalProperties").is_none() {
        schema.insert("additionalProperties".into(), false.into());
    }
}

/// Turns rustdoc markup into plain text: drops the example, the marks of links and the escapes.
fn plain_text(description: &str) -> String {
    let text = description.split("```").next().unwrap_or_default().trim_end();
    text.replace("[`", "`").replace("`]", "`").replace("\\[", "[").replace("\\]", "]").replace('\n', " ")
}

/// Removes null from the types of an optional property, unless the property is marked with [`MAY_BE_NULL`].
fn without_null(property: &mut Value) {
    let Value::Object(property) = property else { return };
    if property.remove(MAY_BE_NULL).is_some() {
        return;
    }
    if let Some(Value::Array(types)) = property.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = types.as_mut_slice() {
            let only = only.take();
            property.insert("type".into(), only);
        }
    }
    if let Some(Value::Array(values)) = property.get_mut("enum") {
        values.retain(|value| !value.is_null());
    }
    if let Some(Value::Array(choices)) = property.get_mut("anyOf") {
        choices.retain(|choice| choice.get("type").is_none_or(|kind| kind != "null"));
        if let [Value::Object(only)] = choices.as_mut_slice() {
            let only = std::mem::take(only);
            property.remove("anyOf");
            for (key, value) in only {
                property.entry(key).or_insert(value);
            }
        }
    }
}

/// Returns the schema of one document, with the definitions that it refers to.
fn input(document: &str) -> Value {
    let all: Value = serde_json::from_str(FORMAT).unwrap_or_default();
    let (mut schema, mut definitions) = (all["$defs"][document].clone(), Map::new());
    write_out(&mut schema, &all, &mut definitions);
    schema["$schema"] = all["$schema"].clone();
    schema["title"] = document.into();
    schema["$defs"] = definitions.into();
    schema
}

/// Closes the objects of a schema, replaces references to shapes by these, and copies other references' definitions.
fn write_out(schema: &mut Value, all: &Value, definitions: &mut Map<String, Value>) {
    match schema {
        Value::Array(entries) => entries.iter_mut().for_each(|entry| write_out(entry, all, definitions)),
        Value::Object(object) => {
            let reference = object.get("$ref").and_then(Value::as_str).unwrap_or_default().to_owned();
            if let Some(Value::Object(shape)) = reference.strip_prefix("#/shapes/").map(|name| &all["shapes"][name]) {
                object.remove("$ref");
                object.extend(shape.clone());
            }
            if let Some(name) = reference.strip_prefix("#/$defs/").filter(|name| !definitions.contains_key(*name)) {
                let mut definition = all["$defs"][name].clone();
                // The entry exists before the recursion, because a definition may refer to itself.
                definitions.insert(name.to_owned(), Value::Null);
                write_out(&mut definition, all, definitions);
                definitions.insert(name.to_owned(), definition);
            }
            if object.contains_key("properties") {
                object.entry("type").or_insert("object".into());
                object.entry("additionalProperties").or_insert(false.into());
            }
            object.values_mut().for_each(|value| write_out(value, all, definitions));
        }
        _ => {}
    }
}

/// Allows an expression in place of every number of a schema.
fn allow_expressions(schema: &mut Value) {
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
        // An id is never an expression, and neither are the values of `enum` and `const`.
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
