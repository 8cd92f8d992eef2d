//! Answers to a sequence of objects, as text or JSON, in order.

use super::diagnostic::{note, report, report_with, with_flags};
use super::input::InputFile;
use super::output::{Format, Output, OutputOptions};
use super::progress::Stopwatch;
use super::{Answered, Completion, Failure};
use crate::error::excerpt::Excerpt;
use crate::read::documents::{Document, documents};
use crate::state::State;
use crate::write::{self, Detail, Palette, Refused, Report, Subject, text};
use crate::{Error, Reason};
use std::io::Write;
use std::path::Path;

/// The most contacts for which text sums up rejections without `--explain`: 4^6 combinations take no noticeable time.
pub(super) const SUMMED_UP: usize = 6;

/// The number of refusals that are shown with an excerpt of their line.
const SHOWN: usize = 10;
/// The number of refusals that are reported; the others are only counted.
const REPORTED: usize = 100;

/// Appends a report: as text if there is a palette, else as a line of JSON.
pub(super) fn append(report: &Report, subject: &Subject, detail: Detail, palette: Option<&Palette>, out: &mut Vec<u8>) {
    match palette {
        Some(palette) => out.extend(with_flags(&text(report, subject, detail, palette)).bytes()),
        None => report.append_json(detail, out),
    }
}

pub(super) fn only_document(input: &InputFile) -> crate::Result<Document<'_>> {
    let name = &input.name;
    let text = input.text().map_err(|error| error.in_file(name))?;
    let mut found = documents(text);
    match (found.next(), found.next()) {
        (Some(document), None) if !document.text.trim_ascii().is_empty() => Ok(document),
        (Some(_), Some(second)) => {
            let reason = Reason::Inconsistent("one state is expected, and here a second one begins".into());
            Err(second.locate(Error::new(reason)).in_file(name).hint("give the states one by one"))
        }
        _ => Err(nothing("state", text).in_file(name)),
    }
}

/// Returns the error for a text without a `what`: it is empty, or an empty list.
pub(super) fn nothing(what: &str, text: &str) -> Error {
    let hint = if text.trim().is_empty() { "the input is empty" } else { "the list is empty" };
    Error::new(Reason::Missing(format!("a {what}"))).hint(hint)
}

/// Answers every object of the file at `path`, each a `what`. `several` says whether more than one is allowed.
///
/// `answer` appends the answer to an object, as text if there is a palette, else as a line of JSON, and returns the
/// error that the answer contains, if any.
pub(super) fn answer_all(
    what: &str,
    path: &Path,
    format: Format,
    output: &OutputOptions,
    several: Result<(), Failure>,
    mut answer: impl FnMut(&str, Option<&Palette>, &mut Vec<u8>) -> crate::Result<Option<Error>>,
) -> Completion {
    let input = InputFile::read(path, InputFile::MANY)?;
    let name = &input.name;
    let whole = input.text().map_err(|error| error.in_file(name))?;
    if documents(whole).next().is_none() {
        return Err(nothing(what, whole).in_file(name).into());
    }
    if documents(whole).nth(1).is_some() {
        several?;
    }
    let mut output = Output::open(output.path())?;
    let (mut refused, mut count) = (0, 0);
    for (at, document) in documents(whole).enumerate() {
        count += 1;
        let mut out = Vec::new();
        let clock = Stopwatch::start();
        let answer = answer(document.text, (format == Format::Text).then_some(&output.palette), &mut out);
        drop(clock);
        match (&answer, format) {
            (Ok(_), Format::Text) if at > 0 => out.insert(0, b'\n'),
            (Err(error), Format::Json) => {
                write::append_line(&mut out, &Refused::new(State::id_in(document.text), document.line, error));
            }
            _ => {}
        }
        output.writer.write_all(&out)?;
        if let Err(error) | Ok(Some(error)) = answer {
            // On a terminal, the answers so far must come before the error.
            output.writer.flush()?;
            let error = document.locate(error).in_file(name);
            if refused < SHOWN {
                let excerpt = error.location().and_then(|place| Excerpt::around(whole.as_bytes(), 1, place));
                report_with(&error, excerpt.as_ref());
            } else if refused < REPORTED {
                report(&error);
            }
            refused += 1;
        }
    }
    output.close(refused < count)?;
    if refused > REPORTED {
        note(&format!("{} more were refused", refused - REPORTED));
    }
    Ok(if refused == 0 { Answered::All } else { Answered::NotAll })
}
