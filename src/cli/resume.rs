//! The output of a batch, which may continue what an interrupted run has written.
//!
//! ```text
//!     answers to states   1 ... n-101 | n-100 ... n-1 | n, whole or cut off
//!                         kept        | compared      | written again
//! ```
//!
//! The last state is answered again, because its rows or its input may have been cut off. Those before it are answered
//! again and compared, byte by byte: with another input or other options some would differ, if not each (a foot at rest
//! needs no friction).

use super::output::{NewFile, Target, named};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// How many answers are compared.
const COMPARED: usize = 100;

/// Where the answers of a batch go.
pub(super) enum BatchOutput {
    New(Target),
    Continued(Continued),
}

impl BatchOutput {
    /// What holds the answers so far, if another run can continue it.
    pub fn part(&self) -> Option<&Path> {
        match self {
            Self::New(Target::File(file)) | Self::Continued(Continued { file, .. }) => file.part(),
            Self::New(Target::Standard(_)) => None,
        }
    }

    /// Ends the output; a file that is there already is replaced only if something was `answered`.
    pub fn finish(self, answered: bool) -> io::Result<()> {
        match self {
            Self::New(target) => target.finish(answered),
            Self::Continued(Continued { known: 1.., .. }) => Err(unlike()),
            Self::Continued(Continued { file, .. }) => file.finish(),
        }
    }
}

impl Write for BatchOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::New(target) => target.write(bytes),
            Self::Continued(continued) if continued.known > 0 => continued.compare(bytes),
            Self::Continued(continued) => continued.file.file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::New(target) => target.flush(),
            Self::Continued(continued) => continued.file.file.flush(),
        }
    }
}

/// An output that an earlier run began.
pub(super) struct Continued {
    file: NewFile,
    /// How many bytes are still to be compared.
    known: u64,
    /// How many states are not answered again, and how many of them were refused.
    pub answered: usize,
    pub refused: u64,
}

impl Continued {
    /// Opens what there is of the output at `path`; `None` if there is nothing. A table begins with `header`. With
    /// `all`, every state is answered again and compared.
    pub fn open(path: &Path, header: &[u8], all: bool) -> io::Result<Option<Self>> {
        let Some(file) = NewFile::reopen(path)? else { return Ok(None) };
        let answers = if header.is_empty() { lines(&file.file) } else { rows(&file.file) };
        let Answers { before, refused, last } = answers.map_err(|error| named(path, error))?;
        let end = last.back().map_or(0, |&(start, _)| start);
        let mut continued = Self { file, known: end, answered: 0, refused: 0 };
        continued.begin(header).map_err(|error| named(path, error))?;
        if let (Some(&(start, _)), false) = (last.front(), all) {
            (continued.answered, continued.refused, continued.known) = (before, refused, end - start);
            continued.file.file.seek(SeekFrom::Start(start))?;
        }
        continued.truncate()?;
        Ok(Some(continued))
    }

    /// Compares the header, if there is one.
    fn begin(&mut self, header: &[u8]) -> io::Result<()> {
        self.file.file.seek(SeekFrom::Start(0))?;
        if self.known > 0 { self.compare(header).map(drop) } else { Ok(()) }
    }

    /// Whether nothing is there, so that a header is missing, too.
    pub fn is_empty(&mut self) -> io::Result<bool> {
        Ok(self.file.file.stream_position()? == 0)
    }

    /// Compares the beginning of `bytes` with what is there, and drops the rest of the file behind the last comparison;
    /// returns how many bytes were compared.
    fn compare(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = usize::try_from(self.known).unwrap_or(usize::MAX).min(bytes.len());
        let mut there = vec![0; count];
        self.file.file.read_exact(&mut there)?;
        if there != bytes[..count] {
            return Err(unlike());
        }
        self.known -= count as u64;
        self.truncate()?;
        Ok(count)
    }

    /// Ends the file here if nothing is left to compare.
    fn truncate(&mut self) -> io::Result<()> {
        if self.known > 0 {
            return Ok(());
        }
        let end = self.file.file.stream_position()?;
        self.file.file.set_len(end)
    }
}

fn unlike() -> io::Error {
    let reason = "it does not hold these answers: give the input and the options with which it was begun, or remove it";
    io::Error::new(ErrorKind::InvalidData, reason)
}

/// The places of answers in a file.
#[derive(Default)]
struct Answers {
    /// How many states are answered before the last ones, and how many of them are refused.
    before: usize,
    refused: u64,
    /// Where the answers to the last ones begin, those to be compared and one more, and whether they are refusals.
    last: VecDeque<(u64, bool)>,
}

impl Answers {
    /// Adds the answer to the next state.
    fn push(&mut self, start: u64, refused: bool) {
        self.last.push_back((start, refused));
        if self.last.len() > COMPARED + 1
            && let Some((_, refused)) = self.last.pop_front()
        {
            self.before += 1;
            self.refused += u64::from(refused);
        }
    }
}

/// The answers in lines of JSON.
fn lines(file: &File) -> io::Result<Answers> {
    #[derive(Deserialize)]
    struct Line {
        error: Option<IgnoredAny>,
    }

    let mut reader = BufReader::with_capacity(1 << 16, file);
    let (mut answers, mut start, mut line) = (Answers::default(), 0, Vec::new());
    while reader.read_until(b'\n', &mut line)? > 0 {
        answers.push(start, serde_json::from_slice(&line).is_ok_and(|line: Line| line.error.is_some()));
        start += line.len() as u64;
        line.clear();
    }
    Ok(answers)
}

/// The answers in a table, whose states have a row for each outcome.
fn rows(file: &File) -> io::Result<Answers> {
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(file);
    let header = reader.byte_headers()?.clone();
    let place = |name: &[u8]| header.iter().position(|column| column == name);
    let (outcome, error) = (place(b"outcome"), place(b"error"));
    let (mut answers, mut row) = (Answers::default(), csv::ByteRecord::new());
    loop {
        let start = reader.position().byte();
        if !reader.read_byte_record(&mut row)? {
            return Ok(answers);
        }
        let cell = |place: Option<usize>| place.and_then(|at| row.get(at)).unwrap_or_default();
        if matches!(cell(outcome), b"" | b"1") {
            answers.push(start, !cell(error).is_empty());
        }
    }
}
