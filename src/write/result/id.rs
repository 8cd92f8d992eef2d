//! Names that users give to states and problems.

use serde_json::Value;

/// The most characters of an id that are repeated.
const ID_LIMIT: usize = 200;

/// An id as it is repeated where it only has to be recognized; of a long text the beginning and `... (cut)`.
pub(crate) fn short_id(id: Value) -> Value {
    let end = id.as_str().and_then(|text| text.char_indices().nth(ID_LIMIT));
    match (&id, end) {
        (Value::String(text), Some((end, _))) => format!("{}... (cut)", &text[..end]).into(),
        _ => id,
    }
}

/// What the user calls a state or a problem.
#[cfg(feature = "schema")]
#[derive(schemars::JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
#[expect(dead_code, reason = "the schema is all that is wanted of it")]
pub(in crate::write) enum Id {
    /// A name.
    Text(String),
    /// A number.
    Number(f64),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_id_is_cut_and_a_short_one_is_not() {
        for kept in [Value::from(17), "k17".into(), "é".repeat(ID_LIMIT).into()] {
            assert_eq!(short_id(kept.clone()), kept);
        }
        assert_eq!(short_id("é".repeat(1 << 20).into()), format!("{}... (cut)", "é".repeat(ID_LIMIT)));
    }
}
