//! Files and standard input.

use heelstrike::{Error, Reason, Result};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// What standard input is called where a file is expected.
const STANDARD_INPUT: &str = "-";

/// What a file is called in messages.
pub(super) fn name(path: &Path) -> String {
    if is_standard_input(path) { "<stdin>".to_owned() } else { path.display().to_string() }
}

/// The bytes of a file, or of standard input for `-`; at most `most`.
///
/// # Errors
/// [`Reason::Io`], naming the file; [`Reason::Unsupported`] for a larger one, as an endless one is.
pub(super) fn bytes_up_to(path: &Path, most: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let reader = open(path)?;
    reader.take(most + 1).read_to_end(&mut bytes).map_err(|error| cannot_read(path, &error))?;
    if bytes.len() as u64 > most {
        let reason = format!("more than {} MiB are not accepted here", most >> 20);
        return Err(Error::new(Reason::Unsupported(reason)).in_file(name(path)));
    }
    Ok(bytes)
}

/// A file line by line, or standard input for `-`.
///
/// # Errors
/// [`Reason::Io`], naming the file.
pub(super) fn open(path: &Path) -> Result<Box<dyn BufRead>> {
    if is_standard_input(path) {
        return Ok(Box::new(io::stdin().lock()));
    }
    let file = File::open(path).map_err(|error| cannot_read(path, &error))?;
    Ok(Box::new(BufReader::with_capacity(1 << 16, file)))
}

/// The bytes of a file as they come, or of standard input for `-`.
///
/// # Errors
/// [`Reason::Io`], naming the file.
pub(super) fn stream(path: &Path) -> Result<Box<dyn Read + Send>> {
    if is_standard_input(path) {
        return Ok(Box::new(io::stdin()));
    }
    Ok(Box::new(File::open(path).map_err(|error| cannot_read(path, &error))?))
}

/// The refusal of a file that cannot be read.
pub(super) fn cannot_read(path: &Path, error: &io::Error) -> Error {
    Error::new(Reason::Io(format!("cannot be read: {error}"))).in_file(name(path))
}

fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == STANDARD_INPUT
}

/// Whether a file's ending says that it holds one JSON object per line.
pub(super) fn is_ndjson(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending == "ndjson" || ending == "jsonl")
}
