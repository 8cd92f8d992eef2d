//! Names, modes, verdicts and grades in words.

use super::table::number;
use crate::impact::Verdict;
use crate::law::Mode;
use serde_json::Value;

/// `ramone (k17)`.
pub(crate) fn titled(name: &str, id: &Option<Value>) -> String {
    id.as_ref().map_or(name.to_owned(), |own| format!("{name} ({})", self::id(own)))
}

/// An id without quotes.
pub(crate) fn id(id: &Value) -> String {
    id.as_str().map_or_else(|| id.to_string(), str::to_owned)
}

/// `margin 0.0130, index +1`, as far as there are any.
pub(crate) fn grades(margin: Option<f64>, index: Option<i8>) -> String {
    let margin = margin.map(|margin| format!("margin {}", number(margin)));
    let index = index.map(|index| format!("index {index:+}"));
    margin.into_iter().chain(index).collect::<Vec<_>>().join(", ")
}

/// `left_foot lifts off, right_foot sticks`.
pub(crate) fn modes<'a>(names: impl Iterator<Item = &'a str>, modes: &[Mode]) -> String {
    let clauses = names.zip(modes).map(|(name, mode)| format!("{name} {}", verb(*mode)));
    clauses.collect::<Vec<_>>().join(", ")
}

/// The verdict as a sentence.
pub(crate) fn verdict(verdict: Verdict, outcomes: usize) -> String {
    match verdict {
        Verdict::Unique => "Exactly one outcome.".to_owned(),
        Verdict::Ambiguous => format!("{} outcomes are equally valid.", counted(outcomes)),
        // Regular contacts always have an outcome.
        Verdict::None => {
            "No outcome is consistent: no impulse brings every contact to what is asked of it, since they depend on each \
             other, or nothing that may move moves them."
                .to_owned()
        }
        Verdict::Undecided => {
            "Undecided: some sign was settled by no precision; what it leaves open is listed.".to_owned()
        }
        Verdict::NoImpact => "No impact: the only outcome needs no impulse from the ground.".to_owned(),
        Verdict::NoContact => "No contact: the ground gives no impulse.".to_owned(),
    }
}

fn counted(number: usize) -> String {
    const WORDS: [&str; 10] = ["No", "One", "Two", "Three", "Four", "Five", "Six", "Seven", "Eight", "Nine"];
    WORDS.get(number).map_or_else(|| number.to_string(), |word| (*word).to_owned())
}

fn verb(mode: Mode) -> &'static str {
    match mode {
        Mode::Separate => "lifts off",
        Mode::Stick => "sticks",
        Mode::SlidePlus => "slides forward",
        Mode::SlideMinus => "slides backward",
    }
}
