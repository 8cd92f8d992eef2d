//! Formats of states and answers.

use super::Failure;
use super::output::check_ending;
use crate::read::table::Form;
#[cfg(not(feature = "columnar"))]
use crate::{Error, Reason};
use clap::ValueEnum;
use std::path::Path;

/// Returns the format of a file by its ending, which is the name of the format; `None` for other endings.
pub fn records(path: &Path) -> Option<Form> {
    Form::from_str(path.extension()?.to_str()?, true).ok()
}

/// Returns the `chosen` format, or else that of the ending of `file`, or else lines of JSON; refuses other endings and
/// formats that this build does not have. The flag in `file` is true for an output; `option` chooses a format.
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

/// Returns the error for a format that this build does not have.
#[cfg(not(feature = "columnar"))]
pub(super) fn absent() -> Error {
    let reason = Reason::Unsupported("this build has no Parquet and no Arrow".into());
    let hint = "build it with `cargo install --path . --features columnar`, or take the command of the Python package";
    Error::new(reason).hint(hint)
}
