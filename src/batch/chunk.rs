//! Cuts a stream into chunks of whole records.

use crate::read::documents::refuse_foreign;
use crate::read::table::{Form, Quotes, Quoting};
use crate::{Error, Reason, Result};
use memchr::{memchr, memchr_iter};
use std::io::{BufRead, BufReader, ErrorKind, Read};

/// Bytes per read from the input.
const READ: usize = 1 << 16;

/// Records per task, at most: few, so that the threads share short inputs.
const RECORDS: usize = 16;

/// Longer records are skipped and refused \[bytes\].
pub const RECORD_LIMIT: usize = 1 << 24;

/// Consecutive whole records.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Chunk {
    bytes: Vec<u8>,
    /// For each record, its first line and the end of its bytes.
    ends: Vec<(usize, usize)>,
    /// The line of a record behind these that was skipped because it is longer than [`RECORD_LIMIT`].
    pub too_long: Option<usize>,
}

/// Cuts an input into chunks. It never waits for more input while a whole record is buffered.
///
/// A line of a table is a record of its own if its quote is not closed, is closed only before text, or would enclose
/// whole rows. The lines behind it are then read again.
#[derive(Debug)]
pub struct Chunks<R> {
    input: BufReader<R>,
    /// Bytes that are read a second time, and the number of these that were consumed already.
    again: (Vec<u8>, usize),
    /// The state of the quotes, which may enclose line breaks; `None` for lines of JSON.
    quotes: Option<Quotes>,
    /// The number of columns, if it is known.
    columns: Option<usize>,
    /// Quotes that are open at the end of a line before this line are never closed correctly.
    unclosed_before: usize,
    line: usize,
    /// Whether nothing was read yet.
    fresh: bool,
}

impl<R: Read + Send> Chunks<R> {
    /// Reads an input with one record per line.
    pub fn of_lines(input: R) -> Self {
        let input = BufReader::with_capacity(READ, input);
        Self { input, again: (Vec::new(), 0), quotes: None, columns: None, unclosed_before: 0, line: 1, fresh: true }
    }

    /// Reads an input as a table of this form.
    pub fn of_table(input: R, form: Form) -> Self {
        Self { quotes: (form != Form::Ndjson).then(|| form.quotes()), ..Self::of_lines(input) }
    }

    /// Sets the number of columns, so that a quote around several rows is detected.
    pub fn expect_columns(&mut self, columns: usize) {
        self.columns = Some(columns);
    }

    /// Refuses an input whose first bytes show that it is compressed, a spreadsheet or the like.
    pub fn check_format(&mut self) -> Result<()> {
        refuse_foreign(self.fill()?)
    }

    /// Returns the first record that is not blank and the line on which it begins, from 1; `None` if there is none.
    ///
    /// # Errors
    /// Returns an error if a record is longer than [`RECORD_LIMIT`] or reading fails.
    pub fn first(&mut self) -> Result<Option<(usize, Vec<u8>)>> {
        while let Some(chunk) = self.record()? {
            if let Some(line) = chunk.too_long {
                return Err(too_long().on(line, 1));
            }
            if let Some((line, record)) = chunk.records().find(|(_, record)| !self.is_blank(record)) {
                return Ok(Some((line, record.to_vec())));
            }
        }
        Ok(None)
    }

    /// Returns the number and result of the first line for which `decide` returns `Some`. All lines are read again.
    pub fn peek<T>(&mut self, decide: impl Fn(&[u8]) -> Option<T>) -> Result<Option<(usize, T)>> {
        let (mut seen, mut start, mut line) = (Vec::new(), 0, self.line);
        let decided = loop {
            let ready = self.fill()?;
            let (count, at_end) = (ready.len(), ready.is_empty());
            seen.extend_from_slice(ready);
            self.consume(count);
            let ends = memchr_iter(b'\n', &seen[start..]).map(|newline| newline + 1);
            let lines = ends
                .chain(at_end.then_some(seen.len() - start))
                .scan(start, |from, end| Some(&seen[std::mem::replace(from, start + end)..start + end]));
            let lines: Vec<&[u8]> = lines.collect();
            if let Some((at, decided)) = lines.iter().enumerate().find_map(|(at, line)| Some((at, decide(line)?))) {
                break Some((line + at, decided));
            }
            (start, line) = (start + lines.iter().map(|line| line.len()).sum::<usize>(), line + lines.len());
            if at_end || seen.len() > RECORD_LIMIT {
                break None;
            }
        };
        self.again = (seen, 0);
        Ok(decided)
    }

    /// Returns whether only blank lines are left.
    pub fn is_empty(&mut self) -> Result<bool> {
        let quotes = self.quotes.unwrap_or(Form::Ndjson.quotes());
        loop {
            let ready = self.fill()?;
            let blank = ready.iter().take_while(|&&byte| quotes.is_blank(byte)).count();
            if blank < ready.len() || ready.is_empty() {
                return Ok(ready.is_empty());
            }
            self.line += memchr_iter(b'\n', ready).count();
            self.consume(blank);
        }
    }

    /// Returns the next record alone; `None` at the end of the input.
    pub fn record(&mut self) -> Result<Option<Chunk>> {
        self.records(1)
    }

    /// Returns the next records, as many as one task holds; `None` at the end of the input.
    ///
    /// # Errors
    /// Returns an error if reading fails.
    pub fn task(&mut self) -> Result<Option<Chunk>> {
        self.records(RECORDS)
    }

    /// Skips the next `count` records that are not blank.
    pub fn skip(&mut self, mut count: usize) -> Result<()> {
        while count > 0 {
            let Some(chunk) = self.record()? else { break };
            let blank = |(_, record): (usize, &[u8])| self.is_blank(record);
            count -= usize::from(chunk.too_long.is_some() || !chunk.records().all(blank));
        }
        Ok(())
    }

    /// Returns whether a record is blank, so that it has no answer.
    fn is_blank(&self, record: &[u8]) -> bool {
        let quotes = self.quotes.unwrap_or(Form::Ndjson.quotes());
        record.iter().all(|&byte| quotes.is_blank(byte))
    }

    /// Takes up to `most` of the whole lines in the buffer, with one copy.
    fn take_lines(&mut self, most: usize, chunk: &mut Chunk) -> Result<()> {
        let line = self.line;
        let ready = self.fill()?;
        let ends = memchr_iter(b'\n', ready).take(most).map(|newline| newline + 1);
        chunk.ends.extend((line..).zip(ends));
        let taken = chunk.ends.last().map_or(0, |&(_, end)| end);
        chunk.bytes.extend_from_slice(&ready[..taken]);
        self.consume(taken);
        self.line += chunk.ends.len();
        Ok(())
    }

    /// Returns whether no whole line is buffered.
    pub fn keeps_waiting(&self) -> bool {
        let again = &self.again.0[self.again.1..];
        memchr(b'\n', again).is_none() && memchr(b'\n', self.input.buffer()).is_none()
    }

    /// Returns up to `most` records, or fewer if the next one would have to be waited for.
    fn records(&mut self, most: usize) -> Result<Option<Chunk>> {
        let mut chunk = Chunk::default();
        if self.quotes.is_none() {
            self.take_lines(most, &mut chunk)?;
            if !chunk.ends.is_empty() {
                return Ok(Some(chunk));
            }
        }
        // The starts of the current record and of its last line, the record's first line, and its length so far.
        let (mut start, mut line_start, mut first, mut length) = (0, 0, self.line, 0);
        loop {
            let ready = self.fill()?;
            let newline = memchr(b'\n', ready);
            let taken = newline.map_or(ready.len(), |newline| newline + 1);
            length += taken;
            let too_long = length > RECORD_LIMIT;
            if !too_long {
                chunk.bytes.extend_from_slice(&ready[..taken]);
            }
            let at_end = taken == 0;
            if too_long && line_start > start {
                self.end_with_line(&mut chunk, (start, first), self.line);
                return Ok(Some(chunk));
            }
            self.consume(taken);
            self.line += usize::from(newline.is_some());
            if !at_end && newline.is_none() {
                continue;
            }
            if too_long {
                chunk.bytes.truncate(start);
                chunk.too_long = Some(first);
                return Ok(Some(chunk));
            }
            let line = &chunk.bytes[line_start..];
            match self.quotes.as_mut().map_or(Quoting::Closed, |quotes| quotes.after(line)) {
                Quoting::Open if !at_end && self.line > self.unclosed_before => {
                    line_start = chunk.bytes.len();
                    continue;
                }
                Quoting::Open => self.end_with_line(&mut chunk, (start, first), self.line),
                Quoting::Misplaced => self.end_with_line(&mut chunk, (start, first), self.line - 1),
                Quoting::Closed if line_start > start && self.encloses_rows(&chunk.bytes[start..]) => {
                    self.end_with_line(&mut chunk, (start, first), self.line - 1);
                }
                Quoting::Closed if chunk.bytes.len() > start => chunk.ends.push((first, chunk.bytes.len())),
                Quoting::Closed => {}
            }
            (start, line_start, first, length) = (chunk.bytes.len(), chunk.bytes.len(), self.line, 0);
            if at_end || chunk.ends.len() == most || self.keeps_waiting() {
                return Ok((!chunk.ends.is_empty()).then_some(chunk));
            }
        }
    }

    /// Returns whether the quotes of a record of several lines enclose other rows.
    fn encloses_rows(&self, record: &[u8]) -> bool {
        self.quotes.zip(self.columns).is_some_and(|(quotes, columns)| quotes.enclose_rows(record, columns))
    }

    /// Ends the record that begins at `start` on line `first` after that line; the lines behind it are read again. No
    /// quote that is open before the line `unclosed_before` is closed correctly, so no line is read a third time.
    fn end_with_line(&mut self, chunk: &mut Chunk, (start, first): (usize, usize), unclosed_before: usize) {
        self.unclosed_before = self.unclosed_before.max(unclosed_before);
        self.quotes = self.quotes.map(Quotes::fresh);
        let lines = &chunk.bytes[start..];
        let end = start + memchr(b'\n', lines).map_or(lines.len(), |newline| newline + 1);
        let mut rest = chunk.bytes.split_off(end);
        chunk.ends.push((first, end));
        if !rest.is_empty() {
            rest.extend_from_slice(&self.again.0[self.again.1..]);
            (self.again, self.line) = ((rest, 0), first + 1);
        }
    }

    /// Removes the first bytes of [`Self::fill`].
    fn consume(&mut self, count: usize) {
        match self.again.1 < self.again.0.len() {
            true => self.again.1 += count,
            false => self.input.consume(count),
        }
    }

    /// Returns the buffered bytes without a byte order mark: at least one, unless the input has ended.
    fn fill(&mut self) -> Result<&[u8]> {
        if self.again.1 < self.again.0.len() {
            return Ok(&self.again.0[self.again.1..]);
        }
        self.again = (Vec::new(), 0);
        loop {
            match self.input.fill_buf() {
                Ok(ready) if std::mem::take(&mut self.fresh) && ready.starts_with(b"\xEF\xBB\xBF") => {
                    self.input.consume(3);
                }
                Ok(_) => break,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => {
                    let refused = Error::new(Reason::Io(format!("cannot be read: {error}")));
                    let is_folder = error.kind() == ErrorKind::IsADirectory;
                    return Err(if is_folder { refused.hint("name a file in it") } else { refused });
                }
            }
        }
        Ok(self.input.buffer())
    }
}

/// The error for a record longer than [`RECORD_LIMIT`].
pub(super) fn too_long() -> Error {
    let reason = Reason::Unsupported(format!("the record is longer than {} MiB", RECORD_LIMIT >> 20));
    Error::new(reason).hint("is a line break or a closing quote missing?")
}

impl Chunk {
    /// Iterates over the records, with their line breaks and the lines on which they begin, from 1.
    pub fn records(&self) -> impl Iterator<Item = (usize, &[u8])> {
        let starts = std::iter::once(0).chain(self.ends.iter().map(|&(_, end)| end));
        starts.zip(&self.ends).map(|(start, &(line, end))| (line, &self.bytes[start..end]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reader that returns one part per call.
    struct Parts<'p>(Vec<&'p [u8]>);

    impl Read for Parts<'_> {
        fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
            if self.0.is_empty() { Ok(0) } else { self.0.remove(0).read(into) }
        }
    }

    /// The records of each chunk, with their lines.
    fn chunks(mut chunks: Chunks<impl Read + Send>) -> Vec<String> {
        let chunks = std::iter::from_fn(|| chunks.task().unwrap());
        let shown = |(line, record): (usize, &[u8])| format!("{line}:{}", record.escape_ascii());
        chunks.map(|chunk| chunk.records().map(shown).collect::<Vec<_>>().join(" ")).collect()
    }

    #[test]
    fn lines_keep_their_numbers_however_the_input_comes() {
        let lines = |parts: &[&'static [u8]]| chunks(Chunks::of_lines(Parts(parts.to_vec())));
        assert_eq!(lines(&[b"a\n\nb"]), [r"1:a\n 2:\n", "3:b"]);
        assert_eq!(lines(&[b"a", b"\n\n", b"b\n"]), [r"1:a\n 2:\n", r"3:b\n"]);
        assert_eq!(lines(&[b"a\nb", b"c\nd\n"]), [r"1:a\n", r"2:bc\n 3:d\n"]);
        assert!(lines(&[]).is_empty());
        let many: String = (0..40).map(|number| format!("{number}\n")).collect();
        let many = chunks(Chunks::of_lines(many.as_bytes()));
        assert_eq!(many.iter().map(|chunk| &chunk[..3]).collect::<Vec<_>>(), ["1:0", "17:", "33:"], "chunks are short");
    }

    #[test]
    fn a_line_whose_quote_stays_open_swallows_no_other() {
        for (text, expected) in [
            // A quote that is never closed, and one that is closed before text.
            ("a\n\"b\nc\nd", "1:a 2:\"b 3:c 4:d"),
            ("\"a\nb\nc\"d\ne\n", "1:\"a 2:b 3:c\"d 4:e"),
            ("x,\"a\nb\nx,\"c\nd\n", "1:x,\"a 2:b 3:x,\"c 4:d"),
            // The line at which the first quote fails begins a record of two lines.
            ("\"a\nb\n\"c\nd\"\ne\n", "1:\"a 2:b 3:\"c;d\" 5:e"),
            ("\"a\n\n\"b\"c\n\"d\"\n", "1:\"a 2: 3:\"b\"c 4:\"d\""),
        ] {
            for size in [1, 3, 100] {
                let parts = text.as_bytes().chunks(size).collect();
                let found = chunks(Chunks::of_table(Parts(parts), Form::Csv)).join(" ");
                assert_eq!(
                    found.replace(r"\n ", " ").trim_end_matches(r"\n").replace(r"\n", ";").replace('\\', ""),
                    expected
                );
            }
        }
    }

    #[test]
    fn each_line_is_read_twice_at_most() {
        // On its own, each line opens a quote; inside quotes, none of these quotes is closed before text.
        let line = "a\",\"b\n";
        let count = RECORD_LIMIT / line.len() + 100_000;
        let text = line.repeat(count);
        let mut chunks = Chunks::of_table(text.as_bytes(), Form::Csv);
        let records = std::iter::from_fn(|| chunks.task().unwrap());
        assert_eq!(records.map(|chunk| chunk.ends.len()).sum::<usize>(), count);
    }

    #[test]
    fn an_endless_record_does_not_fill_the_memory() {
        let parts = |first: &'static [u8]| {
            let part: &[u8] = &[b'x'; 1 << 12];
            let long = std::iter::repeat_n(part, RECORD_LIMIT / part.len() + 1);
            Parts(std::iter::once(first).chain(long).chain([&b"\nend"[..]]).collect())
        };
        for mut chunks in [Chunks::of_lines(parts(b"a\n")), Chunks::of_table(parts(b"a\n\""), Form::Csv)] {
            let chunks = std::iter::from_fn(move || chunks.task().unwrap());
            let found: Vec<_> = chunks.map(|chunk| (chunk.bytes.len(), chunk.too_long)).collect();
            assert_eq!(found, [(2, None), (0, Some(2)), (3, None)]);
        }
    }
}
