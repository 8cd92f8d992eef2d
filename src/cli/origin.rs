//! The record of what the answers in an unfinished output depend on: `FILE.run`, until the output is complete.
//!
//! ```text
//!     version, robot, options     compared before a run is continued
//!     input: bytes, digest        compared once this number of bytes of the input is read again
//! ```
//!
//! The record is rewritten whenever more of the input was read, before any of that is answered.

use super::VERSION;
use super::output::{RUN, named, with_ending};
use crc32fast::Hasher;
use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::fs::File;
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Returns the CRC-32 of a value's debug output, which contains numbers with all digits.
fn digest(value: &impl Debug) -> u32 {
    crc32fast::hash(format!("{value:?}").as_bytes())
}

/// Digests of the robot and the options of a run, as far as answers depend on them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Asked {
    version: String,
    robot: u32,
    options: u32,
}

impl Asked {
    pub fn new(robot: &impl Debug, options: &impl Debug) -> Self {
        Self { version: VERSION.to_owned(), robot: digest(robot), options: digest(options) }
    }

    /// Returns what was different in an earlier run; `None` if nothing was.
    fn unlike(&self, earlier: &Self) -> Option<&'static str> {
        let differences = [
            (self.version == earlier.version, "by another version of this tool"),
            (self.robot == earlier.robot, "with another robot"),
            (self.options == earlier.options, "with other options"),
        ];
        differences.into_iter().find(|(same, _)| !same).map(|(_, what)| what)
    }
}

/// The number of bytes at the beginning of an input, and their CRC-32.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
struct Beginning {
    bytes: u64,
    digest: u32,
}

#[derive(Debug, Serialize, Deserialize)]
struct Record {
    #[serde(flatten)]
    asked: Asked,
    /// Whether the answers are in `FILE.part` rather than in the file itself.
    part: bool,
    input: Beginning,
}

struct Reading {
    bytes: u64,
    hasher: Hasher,
    /// The part of the input that an earlier run had read; `None` once as many bytes are read again.
    earlier: Option<Beginning>,
    /// Whether these bytes were the same; valid once `earlier` is `None`.
    is_same: bool,
    kept: Option<(File, Record)>,
}

impl Reading {
    fn add(&mut self, mut bytes: &[u8]) {
        if let Some(earlier) = self.earlier
            && let Ok(left) = usize::try_from(earlier.bytes - self.bytes)
            && left <= bytes.len()
        {
            self.hash(&bytes[..left]);
            bytes = &bytes[left..];
            self.earlier = None;
            self.is_same = self.beginning() == earlier;
        }
        self.hash(bytes);
        let read = self.beginning();
        if let Some((_, record)) = &mut self.kept {
            record.input = read;
        }
    }

    fn hash(&mut self, bytes: &[u8]) {
        self.bytes += bytes.len() as u64;
        self.hasher.update(bytes);
    }

    /// Returns the size and digest of the input so far.
    fn beginning(&self) -> Beginning {
        Beginning { bytes: self.bytes, digest: self.hasher.clone().finalize() }
    }

    /// Writes the record. If that fails, as on a full disk, the file is left empty, without a record.
    fn keep(&mut self) {
        let Some((file, record)) = &mut self.kept else { return };
        let bytes = serde_json::to_vec(record).unwrap_or_default();
        // One write over the old record. A rest of a longer old record may follow; `Origin::of` ignores it.
        let written = file.rewind().and_then(|()| file.write_all(&bytes));
        if written.is_err() {
            let _ = file.set_len(0);
        }
    }
}

fn locked(reading: &Mutex<Reading>) -> MutexGuard<'_, Reading> {
    reading.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The record of one output.
pub(super) struct Origin {
    path: Option<PathBuf>,
    earlier: Option<Record>,
    reading: Arc<Mutex<Reading>>,
}

impl Origin {
    /// Creates the record for the output at `path`; with `resume`, reads the record that an earlier run left.
    pub fn of(path: Option<&Path>, resume: bool) -> Self {
        let path = path.filter(|path| *path != Path::new("-")).map(|path| with_ending(path, RUN));
        let bytes = path.as_ref().filter(|_| resume).and_then(|path| std::fs::read(path).ok()).unwrap_or_default();
        let earlier = serde_json::Deserializer::from_slice(&bytes).into_iter::<Record>().next().and_then(Result::ok);
        let known = earlier.as_ref().map(|record| record.input);
        let reading = Reading { bytes: 0, hasher: Hasher::new(), earlier: known, is_same: true, kept: None };
        Self { path, earlier, reading: Arc::new(Mutex::new(reading)) }
    }

    /// Returns the input as a reader that records its bytes if the output has a record.
    pub fn watch<R: Read>(&self, input: R) -> Watched<R> {
        Watched { input, reading: self.path.is_some().then(|| Arc::clone(&self.reading)) }
    }

    /// Returns whether the present answers, in the `part` file or not, are known to belong to what is `asked` now;
    /// without a record, it is not known.
    ///
    /// # Errors
    /// Returns what was different in the earlier run if they do not belong to it.
    pub fn answers(&self, asked: &Asked, part: bool) -> Result<bool, &'static str> {
        let Some(earlier) = self.earlier.as_ref().filter(|record| record.part == part) else {
            let mut reading = locked(&self.reading);
            (reading.earlier, reading.is_same) = (None, true);
            return Ok(false);
        };
        asked.unlike(&earlier.asked).map_or(Ok(true), Err)
    }

    /// Returns whether the input begins like that of the earlier run; `None` until as many bytes are read.
    pub fn is_same_input(&self) -> Option<bool> {
        let reading = locked(&self.reading);
        reading.earlier.is_none().then_some(reading.is_same)
    }

    /// Keeps the record from now on, for answers in the `part` file or not.
    pub fn begin(&mut self, asked: Asked, part: bool) -> io::Result<()> {
        let Some(path) = &self.path else { return Ok(()) };
        let file = File::create(path).map_err(|error| named(path, error))?;
        let mut reading = locked(&self.reading);
        let input = reading.beginning();
        reading.kept = Some((file, Record { asked, part, input }));
        reading.keep();
        Ok(())
    }

    /// Removes the record, because the output is whole.
    pub fn end(self) {
        let is_kept = locked(&self.reading).kept.take().is_some();
        if let Some(path) = self.path.filter(|_| is_kept || self.earlier.is_some()) {
            // If this fails, a useless file stays; that is not worth an error.
            let _ = std::fs::remove_file(path);
        }
    }
}

/// An input whose bytes are recorded.
pub(super) struct Watched<R> {
    input: R,
    reading: Option<Arc<Mutex<Reading>>>,
}

impl<R: Read> Read for Watched<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(into)?;
        if let Some(reading) = &self.reading {
            let mut reading = locked(reading);
            reading.add(&into[..count]);
            reading.keep();
        }
        Ok(count)
    }
}
