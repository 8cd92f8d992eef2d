//! JSON Schema (draft 2020-12) of what is read and written.
//!
//! A result's schema is derived from the very structs that are written; those of states, problems and studies are parts
//! of `format.json`, from which their readers know their fields.
//!
//! The schemas are closed: as for the strict readers, a field that they do not name does not exist.

mod inputs;

use super::holds::HoldsRecord;
use super::result::{Brief, Refused, Report};
use super::sweep::{MapSweep, RefusedSample, Sweep};
use super::touchdown::CarriedFields;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Marks a property that may be null although it may also be absent.
const MAY_BE_NULL: &str = "x-may-be-null";

/// The schema of a state.
pub fn state() -> Value {
    inputs::schema("State")
}

/// The schema of a contact problem that is given as matrices.
pub fn problem() -> Value {
    inputs::schema("Problem")
}

/// The schema of a study; every number of it but an id may be an expression.
pub fn study() -> Value {
    let mut schema = inputs::schema("Study");
    inputs::allow_expressions(&mut schema);
    schema
}

/// The schema of what `sweep` writes.
pub fn sweep() -> Value {
    schema_of::<SweepWhole>(SchemaSettings::draft2020_12().for_serialize())
}

/// The schema of a line of results: a result, one in brief, or a refusal.
pub fn result() -> Value {
    schema_of::<ResultLine>(SchemaSettings::draft2020_12().for_serialize())
}

/// The schema of what `accuracy` writes.
#[cfg(feature = "accuracy")]
pub fn accuracy() -> Value {
    schema_of::<super::Accuracy>(SchemaSettings::draft2020_12().for_serialize())
}

/// One line of results.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(title = "Result")]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
enum ResultLine<'a> {
    Whole(Box<Report<'a>>),
    Brief(Brief<'a>),
    Refused(Refused),
}

/// What is found along one parameter, or over two.
#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(title = "Sweep")]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
enum SweepWhole<'a> {
    Along(WithSamples<'a, Sweep<'a>>),
    Map(WithSamples<'a, MapSweep<'a>>),
}

/// Regions, and the samples behind them.
#[derive(JsonSchema)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
struct WithSamples<'a, T> {
    #[serde(flatten)]
    regions: T,
    /// In the order of the parameters, the last of which changes fastest.
    samples: Vec<SampleWhole<'a>>,
}

/// The parameters' values under their names, and the result there.
#[derive(JsonSchema)]
#[schemars(rename = "Sample", extend("additionalProperties" = {"type": "number"}))]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
struct SampleWhole<'a> {
    /// As of `impact`, or why there is none.
    result: SampleResult<'a>,
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
enum SampleResult<'a> {
    Whole(Box<Report<'a>>),
    Brief(Brief<'a>),
    Refused(RefusedSample),
}

impl JsonSchema for CarriedFields<'_> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "CarriedFields".into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        BTreeMap::<String, String>::json_schema(generator)
    }
}

impl JsonSchema for HoldsRecord {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        "Holds".into()
    }
    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({"enum": [true, false, "unknown"]})
    }
}

fn schema_of<T: JsonSchema>(settings: SchemaSettings) -> Value {
    let settings = settings.with_transform(RecursiveTransform(strict));
    settings.into_generator().into_root_schema_for::<T>().to_value()
}

/// Says of one schema what the contract says of all: what is not named does not exist, what is optional is absent and
/// not null.
fn strict(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = plain_text(description);
    }
    if schema.get("properties").is_none() {
        return;
    }
    let required: Vec<Value> = schema.get("required").and_then(Value::as_array).cloned().unwrap_or_default();
    if let Some(Value::Object(properties)) = schema.get_mut("properties") {
        for (name, property) in properties {
            // What is read in place of an absent field is no part of what is written.
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

/// A description as rustdoc's markup has it, without the marks that only rustdoc needs.
fn plain_text(description: &str) -> String {
    description.replace("[`", "`").replace("`]", "`").replace("\\[", "[").replace("\\]", "]").replace('\n', " ")
}

/// Takes null out of what an optional property may be, unless it is marked.
fn without_null(property: &mut Value) {
    let Value::Object(property) = property else { return };
    if property.remove(MAY_BE_NULL).is_some() {
        return;
    }
    if let Some(Value::Array(types)) = property.get_mut("type") {
        types.retain(|kind| kind != "null");
        if let [only] = types.as_slice() {
            let only = only.clone();
            property.insert("type".into(), only);
        }
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
