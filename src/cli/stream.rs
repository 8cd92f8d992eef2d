//! One object after the other: answered or refused, as text or JSON, in order.

use super::complaint::{complain, complain_within, note};
use super::output::{Format, OutputOptions};
use super::{Answered, Failure, Outcome, input};
use heelstrike::read::documents::{Document, documents, utf8};
use heelstrike::state::State;
use heelstrike::write::{self, Palette, Refused};
use heelstrike::{Error, Reason, Result};
use std::io::Write;
use std::path::Path;

/// Up to so many contacts the rejected combinations are summed up for people, asked for or not: 4^6 are told at once.
pub(super) const SUMMED_UP: usize = 6;

/// The largest file of states or problems that is read at once \[bytes\]; `batch` reads line by line.
const LARGEST: u64 = 1 << 30;
/// So many refusals are shown with their line.
const SHOWN: usize = 10;
/// So many refusals are told, those beyond the shown ones in short; the rest are counted.
const TOLD: usize = 100;

/// What turns the text of an object into an answer.
pub(super) trait Answers {
    /// What an object is, for messages.
    const WHAT: &'static str;

    /// Refuses what cannot be done, before anything is answered; `_several` tells of more than one object.
    ///
    /// # Errors
    /// [`Failure::Usage`], naming the option.
    fn check(&self, _several: bool) -> std::result::Result<(), Failure> {
        Ok(())
    }

    /// Appends the answer as one line of JSON; gives the error that stands in it beside the matrices, if any.
    fn json(&mut self, object: &str, out: &mut Vec<u8>) -> Result<Option<Error>>;

    /// The answer as text, and the error that stands in it, if any.
    fn text(&mut self, object: &str, palette: &Palette) -> Result<(String, Option<Error>)>;
}

/// The one object of a file.
pub(super) fn only_document<'t>(bytes: &'t [u8], name: &str) -> Result<Document<'t>> {
    let text = utf8(bytes).map_err(|error| error.in_file(name))?;
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
pub(super) fn answer_all<A: Answers>(answers: &mut A, path: &Path, format: Format, options: &OutputOptions) -> Outcome {
    let name = input::name(path);
    let bytes = input::bytes_up_to(path, LARGEST)?;
    let whole = utf8(&bytes).map_err(|error| error.in_file(&name))?;
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
            Format::Text => answers.text(document.text, output.palette()).map(|(text, beside)| {
                if at > 0 {
                    out.push(b'\n');
                }
                out.extend_from_slice(text.as_bytes());
                beside
            }),
        };
        if let (Err(error), Format::Json) = (&answer, format) {
            write::append_line(&mut out, &Refused::new(State::id_in(document.text), document.line, error));
        }
        output.write_all(&out)?;
        if let Err(error) | Ok(Some(error)) = answer {
            // What is already answered stands before the complaint also where both go to one terminal.
            output.flush()?;
            let error = document.locate(error).in_file(&name);
            if refused < SHOWN {
                complain_within(&error, whole)
            } else {
                complain(&error)
            }
            refused += 1;
        }
    }
    output.flush()?;
    if refused > TOLD {
        note(&format!("{} more were refused", refused - TOLD));
    }
    Ok(if refused == 0 { Answered::All } else { Answered::NotAll })
}
