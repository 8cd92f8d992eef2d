//! Files and standard input.

use super::Failure;
use crate::error::excerpt::Excerpt;
use crate::read::documents::utf8;
use crate::{Error, Reason, Result};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

/// The most files of a folder that are compared with a name that is not there.
const MOST_NEIGHBORS: usize = 1000;

/// A file or standard input that was read whole.
pub(super) struct InputFile {
    /// Its name in messages.
    pub name: String,
    /// Its contents.
    pub bytes: Vec<u8>,
}

impl InputFile {
    /// The most bytes of a list of loops or a manifest.
    pub const SMALL: u64 = 1 << 20;
    /// Of a robot, a mesh, a study or a single state.
    pub const LARGE: u64 = 64 << 20;
    /// Of states or problems after each other; `batch` reads line by line.
    pub const MANY: u64 = 1 << 30;

    /// Reads `path`, of at most `limit` bytes: an endless file is refused.
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

    /// The contents as text; an error does not name the file yet.
    pub fn text(&self) -> Result<&str> {
        utf8(&self.bytes)
    }

    /// `error` in this file, with the line in question.
    pub fn refuse(&self, error: Error) -> Failure {
        let excerpt = error.location().and_then(|place| Excerpt::around(&self.bytes, 1, place));
        Failure::Refused(error.in_file(&self.name), excerpt)
    }
}

/// The name of a file in messages.
pub(super) fn name(path: &Path) -> String {
    if path == Path::new("-") { "<stdin>".to_owned() } else { path.display().to_string() }
}

/// Opens a file, or standard input for `-`.
pub(super) fn stream(path: &Path) -> Result<Box<dyn Read + Send>> {
    if path == Path::new("-") {
        return Ok(Box::new(io::stdin()));
    }
    Ok(Box::new(file(path)?))
}

/// Opens a file.
pub(super) fn file(path: &Path) -> Result<File> {
    File::open(path).map_err(|error| cannot_read(path, &error))
}

fn cannot_read(path: &Path, error: &io::Error) -> Error {
    let refused = Error::new(Reason::Io(format!("cannot be read: {error}"))).in_file(name(path));
    match error.kind() {
        ErrorKind::NotFound => {
            let wanted = path.file_name().unwrap_or_default().to_string_lossy();
            let refused = refused.hint("a name begins in the folder where the command runs");
            refused.did_you_mean(&wanted, neighbors(path).iter().map(String::as_str))
        }
        ErrorKind::IsADirectory => refused.hint("name a file in it"),
        ErrorKind::PermissionDenied => refused.hint("its permissions do not let you read it"),
        _ => refused,
    }
}

/// The names of the files next to `path`.
fn neighbors(path: &Path) -> Vec<String> {
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    let listed = std::fs::read_dir(folder);
    let entries = listed.into_iter().flatten().flatten().take(MOST_NEIGHBORS);
    // The file itself may be a link that leads nowhere.
    let others = entries.filter(|entry| Some(&*entry.file_name()) != path.file_name());
    others.map(|entry| entry.file_name().display().to_string()).collect()
}

/// Whether the file's name says that it holds one JSON object per line.
pub(super) fn is_ndjson(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ["ndjson", "jsonl"].iter().any(|own| ending.eq_ignore_ascii_case(own)))
}
