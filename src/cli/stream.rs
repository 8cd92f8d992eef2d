//! One object after the other: answered or refused, as text or JSON, in order.

use super::diagnostic::{note, report, report_with, with_flags};
use super::input::InputFile;
use super::output::{Format, OutputOptions};
use super::{Answered, Completion, Failure};
use heelstrike::error::excerpt::Excerpt;
use heelstrike::read::documents::{Document, documents};
use heelstrike::state::State;
use heelstrike::write::{self, Palette, Refused};
use heelstrike::{Error, Reason, Result};
use std::io::Write;
use std::path::Path;

/// Up to so many contacts the text sums up the rejected combinations even without `--explain`: 4^6 take no time.
pub(super) const SUMMED_UP: usize = 6;

/// The largest file of states or problems that is read at once \[bytes\]; `batch` reads line by line.
const LARGEST: u64 = 1 << 30;
/// So many refusals are shown with their line.
const SHOWN: usize = 10;
/// Of more refusals than this the rest is counted at the end.
const REPORTED: usize = 100;

/// A command that answers one JSON object after the other.
pub(super) trait Answers {
    /// What an object is, for messages.
    const WHAT: &'static str;

    /// Refuses impossible requests before anything is answered; `_several` is true for more than one object.
    ///
    /// # Errors
    /// [`Failure::Usage`], naming the option.
    fn check(&self, _several: bool) -> std::result::Result<(), Failure> {
        Ok(())
    }

    /// Appends the answer as one line of JSON; returns the error that it contains next to the matrices, if any.
    fn json(&mut self, object: &str, out: &mut Vec<u8>) -> Result<Option<Error>>;

    /// The answer as text, and the error that it contains, if any.
    fn text(&mut self, object: &str, palette: &Palette) -> Result<(String, Option<Error>)>;
}

/// The one object of a file.
pub(super) fn only_document(input: &InputFile) -> Result<Document<'_>> {
    let name = &input.name;
    let text = input.text().map_err(|error| error.in_file(name))?;
    let mut found = documents(text);
    match (found.next(), found.next()) {
        (Some(document), None) if !document.text.trim_ascii().is_empty() => Ok(document),
        (Some(_), Some(second)) => {
            let reason = Reason::Inconsistent("one state is expected, and here a second one begins".into());
            Err(second.locate(Error::new(reason)).in_file(name).hint("give the states one by one"))
        }
        _ => Err(Error::new(Reason::Missing("a state".into())).in_file(name).hint("the input is empty")),
    }
}

/// Answers every object of a file.
pub(super) fn answer_all<A: Answers>(
    answers: &mut A,
    path: &Path,
    format: Format,
    options: &OutputOptions,
) -> Completion {
    let input = InputFile::read(path, LARGEST)?;
    let name = &input.name;
    let whole = input.text().map_err(|error| error.in_file(name))?;
    if whole.trim_ascii().is_empty() {
        let missing = Reason::Missing(format!("a {}", A::WHAT));
        return Err(Error::new(missing).in_file(name).hint("the input is empty").into());
    }

    answers.check(documents(whole).nth(1).is_some())?;
    let mut output = options.open()?;
    let mut refused = 0;
    for (at, document) in documents(whole).enumerate() {
        let mut out = Vec::new();
        let answer = match format {
            Format::Json => answers.json(document.text, &mut out),
            Format::Text => answers.text(document.text, output.palette()).map(|(text, error)| {
                if at > 0 {
                    out.push(b'\n');
                }
                out.extend_from_slice(with_flags(&text).as_bytes());
                error
            }),
        };
        if let (Err(error), Format::Json) = (&answer, format) {
            write::append_line(&mut out, &Refused::new(State::id_in(document.text), document.line, error));
        }
        output.write_all(&out)?;
        if let Err(error) | Ok(Some(error)) = answer {
            // On a terminal the answers so far come before the error.
            output.flush()?;
            let error = document.locate(error).in_file(name);
            if refused < SHOWN {
                let excerpt = error.location().and_then(|place| Excerpt::around(whole.as_bytes(), 1, place));
                report_with(&error, excerpt.as_ref());
            } else {
                report(&error);
            }
            refused += 1;
        }
    }
    output.flush()?;
    if refused > REPORTED {
        note(&format!("{} more were refused", refused - REPORTED));
    }
    Ok(if refused == 0 { Answered::All } else { Answered::NotAll })
}
