//! What the user calls a state, where it only has to be recognized.

use serde_json::Value;

/// The most characters of an id that are repeated.
const MOST: usize = 200;

/// The id; of a long text the beginning and `... (cut)`.
pub(crate) fn short_id(id: Value) -> Value {
    match id {
        Value::String(text) => Value::String(match text.char_indices().nth(MOST) {
            Some((end, _)) => format!("{}... (cut)", &text[..end]),
            None => text,
        }),
        id => id,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_id_is_cut_and_a_short_one_is_not() {
        for kept in [Value::from(17), "k17".into(), "é".repeat(MOST).into()] {
            assert_eq!(short_id(kept.clone()), kept);
        }
        assert_eq!(short_id("é".repeat(1 << 20).into()), format!("{}... (cut)", "é".repeat(MOST)));
    }
}
