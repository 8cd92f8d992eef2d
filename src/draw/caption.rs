//! An outcome in words.

use crate::impact::Outcome;
use crate::write::words;

/// What each contact does.
pub(super) fn modes<'a>(contacts: impl Iterator<Item = &'a str>, outcome: &Outcome) -> String {
    match outcome.modes[..] {
        [] => "nothing changes".to_owned(),
        _ => words::modes(contacts, &outcome.modes),
    }
}

/// How sure and how special it is.
pub(super) fn remarks(outcome: &Outcome) -> Vec<String> {
    let border = outcome.border.as_ref().map(|border| {
        let zeros: Vec<String> = border.at_zero.iter().map(|zero| zero.inequality.to_string()).collect();
        format!("on a border: {}", zeros.join(", "))
    });
    let remarks = [
        (outcome.family, "the end of a family"),
        (!outcome.impulse_unique, "one of many impulses"),
        (!outcome.decided, "not excluded"),
        (outcome.decided && !outcome.proven, "not proven"),
    ];
    let remarks = remarks.into_iter().filter(|(applies, _)| *applies).map(|(_, remark)| remark.to_owned());
    border.into_iter().chain(remarks).collect()
}
