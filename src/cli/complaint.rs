//! Errors on standard error, coloured where a person looks.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet, normalize_untrusted_str};
use heelstrike::Error;
use heelstrike::error::Location;
use heelstrike::error::excerpt::Excerpt;
use std::io::Write;

/// Writes `error: file:line:column: place: reason` and, where there is a remedy, `hint: remedy`.
pub(super) fn complain(error: &Error) {
    write(&[Group::with_title(Level::ERROR.primary_title(error.to_string()))]);
    if let Some(remedy) = error.remedy() {
        write(&[hint(remedy)]);
    }
}

/// Writes the reason, the line of `text` that it is about with the place marked, and the remedy.
///
/// `text` is the whole text of the error's file. Without a line and column in it this is [`complain`].
pub(super) fn complain_within(error: &Error, text: &str) {
    let excerpt = error.location().and_then(|place| Excerpt::around(text.as_bytes(), 1, place));
    complain_at(error, excerpt.as_ref());
}

/// Writes the reason, the line that it is about with the place marked, and the remedy; without a line this is [`complain`].
pub(super) fn complain_at(error: &Error, excerpt: Option<&Excerpt>) {
    let (Some(Location { line, .. }), Some(excerpt)) = (error.location(), excerpt) else {
        return complain(error);
    };
    let mut mark = AnnotationKind::Primary.span(excerpt.mark());
    if let Some(place) = error.place() {
        mark = mark.label(normalize_untrusted_str(place));
    }
    let snippet = Snippet::source(excerpt.text()).line_start(line).annotation(mark);
    let title = |text: String| Level::ERROR.primary_title(text);
    let mut report = vec![if excerpt.starts_later() {
        // The renderer would count the columns from the cut.
        title(error.to_string()).element(snippet)
    } else {
        let file = error.file().map(normalize_untrusted_str);
        title(error.reason().to_string()).element(snippet.path(file))
    }];
    report.extend(error.remedy().map(hint));
    write(&report);
}

/// Writes `note: ` and the text.
pub(super) fn note(text: &str) {
    write(&[Group::with_title(Level::NOTE.primary_title(text))]);
}

fn hint(remedy: &str) -> Group<'_> {
    Group::with_title(Level::HELP.with_name("hint").secondary_title(normalize_untrusted_str(remedy)))
}

fn write(report: &[Group<'_>]) {
    let told = Renderer::styled().render(report);
    // anstream takes the colours out where nobody wants them; where nobody reads standard error there is nobody to tell
    // that it cannot be written.
    let _ = writeln!(anstream::stderr().lock(), "{told}");
}
