//! The sink of a batch. It writes results to the output and refusals to standard error, and adds counts to the summary.

use super::diagnostic::{note, report_with};
use super::resume::BatchOutput;
use super::{Failure, status};
use crate::batch::{Block, RefusedRecord, Summary};
use crate::draw::page::Gait;
#[cfg(feature = "columnar")]
use crate::write::ColumnWriter;
use crate::write::words::counted;
use indicatif::ProgressBar;
use memchr::memchr_iter;
use std::collections::HashMap;
use std::io::{self, ErrorKind, Write};

/// The number of refusals that are reported on standard error; the output contains all of them.
const REPORTED: u64 = 20;
/// The number of reported refusals with the same place and the same reason, apart from its digits.
const ALIKE: u64 = 3;

pub(super) struct OutputSink<'a> {
    pub output: BatchOutput,
    /// The name of the input in messages.
    input: &'a str,
    progress: &'a ProgressBar,
    /// The summary of all states so far.
    pub summary: Summary,
    /// The states for a page, if one is requested.
    pub gait: Gait,
    /// The number of reported refusals, and the number of all refusals for each place and reason without digits.
    reported: u64,
    alike: HashMap<(Option<String>, String), u64>,
    /// The number of lines in the output so far; `None` for Parquet and Arrow.
    lines: Option<usize>,
    /// The writer of Parquet or Arrow.
    #[cfg(feature = "columnar")]
    pub columns: Option<ColumnWriter>,
}

impl<'a> OutputSink<'a> {
    /// Creates a sink for the answers to `input`. `output` contains `lines` lines already; `None` if it is not text. It
    /// must not buffer, so that the number of written lines is known.
    pub fn new(output: BatchOutput, lines: Option<usize>, input: &'a str, progress: &'a ProgressBar) -> Self {
        Self {
            output,
            input,
            progress,
            summary: Summary::default(),
            gait: Gait::default(),
            reported: 0,
            alike: HashMap::new(),
            lines,
            #[cfg(feature = "columnar")]
            columns: None,
        }
    }

    /// Writes all bytes. An error states how many lines were written.
    pub fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match self.output.write(bytes) {
                Ok(0) => return Err(self.ended(ErrorKind::WriteZero.into())),
                Ok(written) => {
                    self.lines = self.lines.map(|lines| lines + memchr_iter(b'\n', &bytes[..written]).count());
                    bytes = &bytes[written..];
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.ended(error)),
            }
        }
        Ok(())
    }

    fn ended(&self, error: io::Error) -> io::Error {
        let Some(lines) = self.lines.filter(|_| error.kind() != ErrorKind::InvalidData) else { return error };
        io::Error::new(error.kind(), format!("{error}; it ends after {}", counted(lines, "whole line")))
    }

    fn report(&mut self, RefusedRecord { error, excerpt }: RefusedRecord) {
        if self.reported > REPORTED {
            return;
        }
        let reason = error.reason().to_string();
        let kind = (error.place().map(str::to_owned), reason.replace(|c: char| c.is_ascii_digit(), ""));
        let alike = self.alike.entry(kind).or_default();
        *alike += 1;
        if *alike <= ALIKE {
            self.reported += 1;
            self.progress.suspend(|| match self.reported {
                0..=REPORTED => report_with(&error.in_file(self.input), excerpt.as_ref()),
                _ => note("further refusals stand in the output alone"),
            });
        } else if *alike == ALIKE + 1 {
            self.progress.suspend(|| note(&format!("further refusals like this stand in the output alone: {reason}")));
        }
    }

    /// Writes the next answers. Ends the process if the output cannot be written.
    ///
    /// # Errors
    /// Returns an error if the format cannot represent the columns.
    pub fn block(&mut self, block: Block) -> crate::Result<()> {
        #[cfg(feature = "columnar")]
        if let (Some(writer), Some(columns)) = (&mut self.columns, block.columns) {
            let bytes = writer.write(columns)?;
            self.write(&bytes).unwrap_or_else(|error| self.end(error));
        }
        self.write(&block.out).and_then(|()| self.output.flush()).unwrap_or_else(|error| self.end(error));
        // On a terminal the answers come before the errors.
        block.refused.into_iter().for_each(|refused| self.report(refused));
        self.summary.merge(block.summary);
        block.keyframes.into_iter().for_each(|keyframe| self.gait.push(keyframe));
        Ok(())
    }

    /// Ends the process instead of waiting for more input, which may never come.
    fn end(&self, error: io::Error) -> ! {
        self.progress.finish_and_clear();
        let status = status(Failure::Output(error));
        note_part(&self.output);
        self.output.discard();
        std::process::exit(status.into())
    }
}

/// Writes a note with the place of the answers so far if another run can continue them.
pub(super) fn note_part(output: &BatchOutput) {
    if let Some(part) = output.part() {
        note(&format!("{} holds the answers so far; --resume continues them", part.display()));
    }
}
