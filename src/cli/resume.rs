//! The output of a batch, which can continue the output of an interrupted run.
//!
//! ```text
//!     answers to states   1 ... n-101 | n-100 ... n-1 | n, complete or cut off
//!                         kept        | compared      | written again
//! ```
//!
//! Robot, options and input must be those of the interrupted run, as its record shows ([`Origin`]); without a record,
//! all answers are compared. The last state is answered again, because its rows or its input may have been cut off. The
//! 100 states before it are answered again and compared byte by byte. Answers beyond their budget differ each time.

use super::origin::{Asked, Origin};
use super::output::{NewFile, Target, named};
use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// The number of answers that are compared.
const COMPARED: usize = 100;

/// The destination of the answers of a batch.
pub(super) struct BatchOutput {
    target: Target,
    origin: Origin,
    /// Of a file that an earlier run began.
    continued: Option<Continued>,
}

impl BatchOutput {
    /// Creates an output at `path`, or on standard output, for answers to `asked`; with `None`, no run can continue it.
    pub fn create(path: Option<&Path>, mut origin: Origin, asked: Option<Asked>) -> io::Result<Self> {
        let target = Target::open(path, asked.is_some())?;
        if let (Target::File(file), Some(asked)) = (&target, asked)
            && file.part().is_some()
        {
            origin.begin(asked, true)?;
        }
        Ok(Self { target, origin, continued: None })
    }

    /// Continues the output at `path`, or begins it if it does not exist. A table begins with `header`. With `all`,
    /// every state is answered again and compared.
    pub fn resume(path: &Path, header: &[u8], all: bool, origin: Origin, asked: Asked) -> io::Result<Self> {
        let Some(mut file) = NewFile::reopen(path)? else { return Self::create(Some(path), origin, Some(asked)) };
        let known = origin.answers(&asked, file.part().is_some()).map_err(|what| unlike(&file, what))?;
        let continued = Continued::open(&mut file, header, all || !known, asked).map_err(|error| named(path, error))?;
        Ok(Self { target: Target::File(file), origin, continued: Some(continued) })
    }

    /// Returns the number of states that are not answered again, and how many of them were refused.
    pub fn kept(&self) -> (usize, u64) {
        self.continued.as_ref().map_or((0, 0), |continued| continued.kept)
    }

    /// Returns the number of lines before the next answer. If it is 0, the header of a table is missing, too.
    pub fn lines(&mut self) -> io::Result<usize> {
        let (Target::File(NewFile { file, .. }), Some(_)) = (&mut self.target, &self.continued) else { return Ok(0) };
        let end = file.stream_position()?;
        file.rewind()?;
        Ok(BufReader::new(file.take(end)).split(b'\n').count())
    }

    /// Returns the file with the answers so far if another run can continue it.
    pub fn part(&self) -> Option<&Path> {
        let Target::File(file) = &self.target else { return None };
        file.part().filter(|_| file.keep)
    }

    /// Removes the written answers if no other run can continue them.
    pub fn discard(&self) {
        if let Target::File(file) = &self.target {
            file.discard();
        }
    }

    /// Finishes the output. An existing file is replaced only if something was `answered`.
    pub fn finish(mut self, answered: bool) -> io::Result<()> {
        if let (Target::File(file), Some(continued)) = (&mut self.target, &mut self.continued) {
            if self.origin.is_same_input() != Some(true) {
                return Err(unlike(file, OTHER_INPUT));
            }
            if continued.known > 0 {
                return Err(unlike(file, OTHER_ANSWERS));
            }
            continued.write(&[], file, &mut self.origin)?;
        }
        self.target.finish(answered || self.continued.is_some())?;
        self.origin.end();
        Ok(())
    }
}

impl Write for BatchOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match (&mut self.target, &mut self.continued) {
            (Target::File(file), Some(continued)) if continued.known > 0 => continued.compare(bytes, file),
            (Target::File(file), Some(continued)) => continued.write(bytes, file, &mut self.origin),
            (target, _) => target.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.target.flush()
    }
}

/// How this run continues an output that an earlier run began.
struct Continued {
    /// The number of bytes that are still to be compared.
    known: u64,
    /// The number of states that are not answered again, and how many of them were refused.
    kept: (usize, u64),
    /// The robot and options of this run, until the first answer is written.
    asked: Option<Asked>,
    /// Answers that are held back until the input is known to be the same.
    waiting: Vec<u8>,
}

const OTHER_INPUT: &str = "over another input";
const OTHER_ANSWERS: &str = "with other answers";

impl Continued {
    /// Opens an output; a table begins with `header`. With `all`, every state is answered again and compared.
    fn open(file: &mut NewFile, header: &[u8], all: bool, asked: Asked) -> io::Result<Self> {
        let Answers { before, last } = match header.get("id".len()) {
            None => lines(&file.file),
            Some(&delimiter) => rows(&file.file, delimiter),
        }?;
        let end = last.back().map_or(0, |&(start, _)| start);
        let mut continued = Self { known: end, kept: (0, 0), asked: Some(asked), waiting: Vec::new() };
        file.file.rewind()?;
        if end > 0 {
            continued.compare(header, file)?;
        }
        if let (Some(&(start, _)), false) = (last.front(), all) {
            (continued.kept, continued.known) = (before, end - start);
            file.file.seek(SeekFrom::Start(start))?;
        }
        Ok(continued)
    }

    /// Compares the beginning of `bytes` with the file, and returns how many bytes were compared.
    fn compare(&mut self, bytes: &[u8], file: &mut NewFile) -> io::Result<usize> {
        let count = usize::try_from(self.known).unwrap_or(usize::MAX).min(bytes.len());
        let mut there = vec![0; count];
        file.file.read_exact(&mut there)?;
        if there != bytes[..count] {
            return Err(unlike(file, OTHER_ANSWERS));
        }
        self.known -= count as u64;
        Ok(count)
    }

    /// Writes after the compared answers, once the input is known to be the same.
    fn write(&mut self, bytes: &[u8], file: &mut NewFile, origin: &mut Origin) -> io::Result<usize> {
        match origin.is_same_input() {
            Some(true) => {}
            Some(false) => return Err(unlike(file, OTHER_INPUT)),
            None => {
                self.waiting.extend_from_slice(bytes);
                return Ok(bytes.len());
            }
        }
        if let Some(asked) = self.asked.take() {
            let end = file.file.stream_position()?;
            file.file.set_len(end)?;
            origin.begin(asked, file.part().is_some())?;
            file.file.write_all(&std::mem::take(&mut self.waiting))?;
        }
        file.file.write(bytes)
    }
}

/// Returns the error for an output that was begun differently.
fn unlike(file: &NewFile, what: &str) -> io::Error {
    let reason = format!("it was begun {what}: give what it was begun with, or remove it");
    named(file.part().unwrap_or(&file.path), io::Error::new(ErrorKind::InvalidData, reason))
}

/// The answers found in a file.
#[derive(Default)]
struct Answers {
    /// The number of states before those in `last`, and how many of them are refused.
    before: (usize, u64),
    /// The last states, those to be compared and one more: where their answers begin, and whether they are refused.
    last: VecDeque<(u64, bool)>,
}

impl Answers {
    fn push(&mut self, start: u64, refused: bool) {
        self.last.push_back((start, refused));
        if self.last.len() > COMPARED + 1
            && let Some((_, refused)) = self.last.pop_front()
        {
            self.before.0 += 1;
            self.before.1 += u64::from(refused);
        }
    }
}

/// Finds the answers in lines of JSON.
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

/// Finds the answers in a table, in which each outcome of a state has a row.
fn rows(file: &File, delimiter: u8) -> io::Result<Answers> {
    let mut reader = csv::ReaderBuilder::new().flexible(true).delimiter(delimiter).from_reader(file);
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
