//! Reading of files and standard input.

use super::Failure;
use crate::error::excerpt::Excerpt;
use crate::read::documents::utf8;
use crate::{Error, Reason, Result};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The largest number of files of a folder that are compared with the name of a missing file.
const MOST_NEIGHBORS: usize = 1000;

/// The contents of a file or of standard input.
pub(super) struct InputFile {
    /// The name of the file in messages.
    pub name: String,
    pub bytes: Vec<u8>,
}

impl InputFile {
    /// The size limit of a list of loops or a manifest, in bytes.
    pub const SMALL: u64 = 1 << 20;
    /// The size limit of a robot, a mesh, a study or a single state, in bytes.
    pub const LARGE: u64 = 64 << 20;
    /// The size limit of a sequence of states or problems, in bytes. `batch` reads line by line, without this limit.
    pub const MANY: u64 = 1 << 30;

    /// Reads `path`, or standard input for `-`. Refuses more than `limit` bytes, which an endless file would have.
    pub fn read(path: &Path, limit: u64) -> Result<Self> {
        let name = name(path);
        let mut bytes = Vec::new();
        stream(path)?.take(limit + 1).read_to_end(&mut bytes).map_err(|error| cannot_read(path, &error))?;
        if bytes.len() as u64 > limit {
            let reason = format!("more than {} MiB are not accepted here", limit >> 20);
            return Err(Error::new(Reason::Unsupported(reason)).in_file(name));
        }
        Ok(Self { name, bytes })
    }

    /// Returns the contents as text. An error does not yet name the file.
    pub fn text(&self) -> Result<&str> {
        utf8(&self.bytes)
    }

    /// Returns the failure for an `error` in this file, with an excerpt of the line in question.
    pub fn refuse(&self, error: Error) -> Failure {
        let excerpt = error.location().and_then(|place| Excerpt::around(&self.bytes, 1, place));
        Failure::Refused(error.in_file(&self.name), excerpt)
    }
}

/// Returns the name of a file in messages.
pub(super) fn name(path: &Path) -> String {
    if path == Path::new("-") { "<stdin>".to_owned() } else { path.display().to_string() }
}

/// Opens a file, or standard input for `-`.
pub(super) fn stream(path: &Path) -> Result<Box<dyn Read + Send>> {
    Ok(if path == Path::new("-") { Box::new(io::stdin()) } else { Box::new(file(path)?) })
}

pub(super) fn file(path: &Path) -> Result<File> {
    File::open(path).map_err(|error| cannot_read(path, &error))
}

fn cannot_read(path: &Path, error: &io::Error) -> Error {
    let refused = Error::new(Reason::Io(format!("cannot be read: {error}"))).in_file(name(path));
    match error.kind() {
        ErrorKind::NotFound => {
            let wanted = path.file_name().unwrap_or_default();
            let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
            let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().take(MOST_NEIGHBORS);
            // The file itself may be a broken link.
            let others = entries.map(|entry| entry.file_name()).filter(|name| name != wanted);
            let others: Vec<String> = others.map(|name| name.display().to_string()).collect();
            let refused = refused.hint("a name begins in the folder where the command runs");
            refused.did_you_mean(&wanted.to_string_lossy(), others.iter().map(String::as_str))
        }
        ErrorKind::IsADirectory => refused.hint("name a file in it"),
        ErrorKind::PermissionDenied => refused.hint("its permissions do not let you read it"),
        _ => refused,
    }
}

/// Returns whether the ending of a file means one JSON object per line.
pub(super) fn is_ndjson(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["ndjson", "jsonl"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}
