//! Formats of states and of their answers.

use super::Failure;
use super::output::check_ending;
use crate::read::table::Form;
#[cfg(not(feature = "columnar"))]
use crate::{Error, Reason};
use clap::ValueEnum;
use std::path::Path;

/// How the records of a file are written, by its ending; endings are the names of formats.
pub fn records(path: &Path) -> Option<Form> {
    Form::from_str(path.extension()?.to_str()?, true).ok()
}

/// What is `chosen` by the option of this name, or by the ending of a file, which may be written; else lines of JSON.
pub(super) fn form(file: (Option<&Path>, bool), chosen: Option<Form>, option: &str) -> Result<Form, Failure> {
    let (path, _) = file;
    let form = chosen.or_else(|| path.and_then(records)).unwrap_or(Form::Ndjson);
    if chosen.is_none() && form == Form::Ndjson {
        check_ending(file, "states and answers are .ndjson, .csv, .tsv, .parquet or .arrow", option)?;
    }
    #[cfg(not(feature = "columnar"))]
    if !form.is_text() {
        let error = absent();
        return Err(Failure::Usage(path.map_or(error.clone(), |path| error.in_file(path.display().to_string()))));
    }
    Ok(form)
}

/// The refusal of a format that this build does not have.
#[cfg(not(feature = "columnar"))]
pub(super) fn absent() -> Error {
    let reason = Reason::Unsupported("this build has no Parquet and no Arrow".into());
    let hint = "build it with `cargo install --path . --features columnar`, or take the command of the Python package";
    Error::new(reason).hint(hint)
}
