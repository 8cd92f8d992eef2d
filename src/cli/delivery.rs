//! Where the answers of a batch go: results to the output, refusals to standard error, counts to the summary.

use super::complaint::complain_at;
use super::progress::Progress;
use super::{Failure, status};
use heelstrike::batch::{Block, Refusal, Sink, Summary};
use heelstrike::draw::page::Gait;
use std::io::{self, ErrorKind, Write};

/// So many refusals are told on standard error; all stand in the output.
const TOLD: u64 = 20;

/// Takes the answers in their order.
pub(super) struct Delivery<'a, W> {
    output: W,
    /// What the input is called.
    input: &'a str,
    progress: &'a Progress,
    /// What is known of all states so far.
    pub summary: Summary,
    /// The states that a page shows, if that is asked for.
    pub gait: Gait,
    refused: u64,
    /// Lines that the output has taken.
    lines: usize,
}

impl<'a, W: Write> Delivery<'a, W> {
    /// Answers to `input` go to `output`, which does not buffer: so it is known what was written.
    pub fn new(output: W, input: &'a str, progress: &'a Progress) -> Self {
        Self { output, input, progress, summary: Summary::default(), gait: Gait::default(), refused: 0, lines: 0 }
    }

    /// Writes the line that names the columns.
    ///
    /// # Errors
    /// Whatever keeps it from being written, with the number of lines that were.
    pub fn write(&mut self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            match self.output.write(bytes) {
                Ok(0) => return Err(self.ended(ErrorKind::WriteZero.into())),
                Ok(written) => {
                    self.lines += bytes[..written].iter().filter(|&&byte| byte == b'\n').count();
                    bytes = &bytes[written..];
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(self.ended(error)),
            }
        }
        Ok(())
    }

    fn ended(&self, error: io::Error) -> io::Error {
        let lines = self.lines;
        io::Error::new(
            error.kind(),
            format!("{error}; it ends after {lines} whole line{}", if lines == 1 { "" } else { "s" }),
        )
    }

    fn complain(&mut self, Refusal { error, excerpt }: Refusal) {
        self.refused += 1;
        if self.refused <= TOLD {
            self.progress.beside(|| complain_at(&error.in_file(self.input), excerpt.as_ref()));
        } else if self.refused == TOLD + 1 {
            self.progress.beside(|| {
                // Where nobody reads standard error there is nobody to tell that it cannot be written.
                let _ = writeln!(io::stderr(), "note: further refusals stand in the output alone");
            });
        }
    }
}

impl<W: Write> Delivery<'_, W> {
    /// Ends the process: whoever gives the input may stay silent for ever, and waiting for more of it is of no use.
    fn end(&self, error: io::Error) -> ! {
        self.progress.clear();
        std::process::exit(status(Failure::Output(error)).into())
    }
}

impl<W: Write> Sink for Delivery<'_, W> {
    fn block(&mut self, block: Block) -> io::Result<()> {
        self.write(&block.out).unwrap_or_else(|error| self.end(error));
        // What is answered stands before the complaint also where both go to one terminal.
        block.refused.into_iter().for_each(|refusal| self.complain(refusal));
        self.summary.merge(block.summary);
        block.keyframes.into_iter().for_each(|keyframe| self.gait.push(keyframe));
        Ok(())
    }

    fn idle(&mut self) -> io::Result<()> {
        self.output.flush().unwrap_or_else(|error| self.end(error));
        Ok(())
    }
}
