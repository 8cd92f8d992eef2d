//! Errors and notes on standard error, colored on a terminal. Hints name the options of the command line.

use crate::Error;
use crate::error::excerpt::Excerpt;
use crate::error::{Location, visible};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet, normalize_untrusted_str};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};

/// The settings that hints of the library name. Each has an option of the same name, except `feet`: `--contact`.
const SETTINGS: &str = "base plane all hold axis_tolerance feet contact_tolerance package_path place strict_limits \
    resting_speed friction velocity drop ground_height foreign touchdowns at touching input_format format budget \
    budget_total brief simulated";

/// Replaces settings in backticks, such as `base: floating`, by options: --base floating. The value may be on the next
/// line.
pub(super) fn with_flags(text: &str) -> String {
    let pieces: Vec<&str> = text.split('`').collect();
    let mut out = String::new();
    for (at, piece) in pieces.iter().enumerate() {
        // Every second piece is between two backticks, except a last one that lacks the closing backtick.
        let quoted = at % 2 == 1 && at + 1 < pieces.len();
        let parts = piece.split_once(':').filter(|(_, value)| value.starts_with(char::is_whitespace));
        let (name, value) = parts.unwrap_or((piece, ""));
        let flag = || format!("--{}", if name == "feet" { "contact".into() } else { name.replace('_', "-") });
        match (quoted && SETTINGS.split(' ').any(|setting| setting == name)).then(flag) {
            Some(flag) => out.extend([&flag, value]),
            None if at % 2 == 1 => out.extend(["`", piece, if quoted { "`" } else { "" }]),
            None => out.push_str(piece),
        }
    }
    out
}

/// Writes `error: file:line:column: place: reason` and, if there is a remedy, `hint: remedy`.
pub(super) fn report(error: &Error) {
    write(&[Group::with_title(Level::ERROR.primary_title(error.to_string()))]);
    if let Some(hint) = hint(error) {
        write(&[hint]);
    }
}

/// Writes the reason, the line with a mark at the place, and the remedy. Without an excerpt, this is [`report`].
pub(super) fn report_with(error: &Error, excerpt: Option<&Excerpt>) {
    let (Some(Location { line, .. }), Some(excerpt)) = (error.location(), excerpt) else {
        return report(error);
    };
    let mut mark = AnnotationKind::Primary.span(excerpt.mark.clone());
    if let Some(place) = error.place() {
        mark = mark.label(normalize_untrusted_str(place));
    }
    let snippet = Snippet::source(&excerpt.text).line_start(line).annotation(mark);
    let title = |text: String| Level::ERROR.primary_title(text);
    let mut groups = vec![if excerpt.starts_later {
        // The renderer would count columns from the start of the excerpt, so the title names the place instead.
        title(error.to_string()).element(snippet)
    } else {
        let file = error.file().map(normalize_untrusted_str);
        title(error.reason().to_string()).element(snippet.path(file))
    }];
    groups.extend(hint(error));
    write(&groups);
}

/// Whether only errors are written.
static QUIET: AtomicBool = AtomicBool::new(false);

pub(super) fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

pub(super) fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Writes `note: ` and the text, unless `--quiet` is given.
pub(super) fn note(text: &str) {
    if !is_quiet() {
        write(&[Group::with_title(Level::NOTE.primary_title(visible(&with_flags(text))))]);
    }
}

pub(super) fn note_all(notes: impl IntoIterator<Item = String>) {
    notes.into_iter().for_each(|text| note(&text));
}

fn hint(error: &Error) -> Option<Group<'_>> {
    let hint = normalize_untrusted_str(&with_flags(error.remedy()?));
    Some(Group::with_title(Level::HELP.with_name("hint").secondary_title(hint)))
}

fn write(groups: &[Group<'_>]) {
    let text = Renderer::styled().render(groups);
    // A failure to write to standard error cannot be reported anywhere.
    let _ = writeln!(anstream::stderr().lock(), "{text}");
}

#[cfg(test)]
mod tests {
    use super::with_flags;

    #[test]
    fn settings_become_options() {
        assert_eq!(with_flags("give `base: floating`, or `hold`"), "give --base floating, or --hold");
        assert_eq!(with_flags("keep it: `hold:\n    knee=0.5`"), "keep it: --hold\n    knee=0.5");
        for other in ["as in `impact`, or `stance`", "link a`base", "`", "plain"] {
            assert_eq!(with_flags(other), other);
        }
    }
}
