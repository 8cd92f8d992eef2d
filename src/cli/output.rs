//! Standard output or a file, as text or JSON.

use super::{Answered, Completion, Failure};
use anstream::{AutoStream, ColorChoice};
use heelstrike::write::{self, Palette};
use heelstrike::{Error, Reason};
use serde::Serialize;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// The place and form of results.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputOptions {
    /// Text for people, or JSON, one line per result [default: by the output's ending, else text]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Write to this file, which is replaced; .json and .ndjson mean JSON
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// The form of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Format {
    /// For people
    Text,
    /// One line per result
    Json,
}

impl OutputOptions {
    /// The form chosen by option or by the output's ending; `None` if neither says.
    pub fn chosen(&self) -> Option<Format> {
        let by_ending = |path: &PathBuf| match path.extension()?.to_str()? {
            "json" | "ndjson" | "jsonl" => Some(Format::Json),
            "txt" => Some(Format::Text),
            _ => None,
        };
        self.format.or_else(|| self.output.as_ref().and_then(by_ending))
    }

    /// The file; `None` for standard output.
    pub fn path(&self) -> Option<&Path> {
        self.output.as_deref()
    }

    /// Writes the one result of a command, as text unless JSON is chosen.
    pub fn write(&self, result: &impl Serialize, text: impl FnOnce(&Palette) -> String) -> Completion {
        let output = Output::open(self.path())?;
        let mut bytes = Vec::new();
        match self.chosen() {
            Some(Format::Json) => write::append_line(&mut bytes, result),
            Some(Format::Text) | None => bytes.extend(text(&output.palette).bytes()),
        }
        output.finish(&bytes)
    }
}

/// Refuses an `output` that is one of the `inputs`, even under another name; `-` and `None` are standard input and
/// output.
pub(super) fn spare(output: Option<&Path>, inputs: &[Option<&PathBuf>]) -> heelstrike::Result<()> {
    let output = output.unwrap_or(Path::new("-"));
    let Some(written) = file_of(output, io::stdout()) else { return Ok(()) };
    if inputs.iter().flatten().all(|input| file_of(input, io::stdin()).as_ref() != Some(&written)) {
        return Ok(());
    }
    let reason = Reason::Io("is an input of this command, and the output would replace it".into());
    let name = if output == Path::new("-") { "<stdout>".to_owned() } else { output.display().to_string() };
    Err(Error::new(reason).in_file(name).hint("write to another file"))
}

/// Refuses two outputs that are one file, even under different names; `option` names the second, which may be absent.
pub(super) fn apart(
    [(what, one), (other_what, other)]: [(&str, Option<&Path>); 2],
    option: &'static str,
) -> Result<(), Failure> {
    let (one, Some(other)) = (one.unwrap_or(Path::new("-")), other) else { return Ok(()) };
    let same_name = one != Path::new("-") && std::path::absolute(one).ok() == std::path::absolute(other).ok();
    let same_file = file_of(one, io::stdout()).is_some_and(|file| file_of(other, io::stdout()) == Some(file));
    if !same_name && !same_file {
        return Ok(());
    }
    let reason = Reason::Inconsistent(format!("{what} and {other_what} would be written to the same file"));
    Err(Failure::Usage(Error::new(reason).at(option).hint("name two files")))
}

/// Checks before the work that a file can be written, and leaves it unchanged; pipes and devices are not tried.
pub(super) fn writable(path: Option<&Path>) -> io::Result<()> {
    let Some(path) = path.filter(|path| *path != Path::new("-")) else { return Ok(()) };
    let known = std::fs::metadata(path).ok();
    // A pipe's reader would take a trial for the end.
    if known.as_ref().is_some_and(|known| !known.is_file() && !known.is_dir()) {
        return Ok(());
    }
    OpenOptions::new().append(true).create(true).open(path).map_err(|error| named(path, error))?;
    known.map_or_else(|| std::fs::remove_file(path).map_err(|error| named(path, error)), |_| Ok(()))
}

/// Device and inode of the file, of `standard` for `-`; `None` for devices and pipes, which are never replaced.
#[cfg(unix)]
fn file_of(path: &Path, standard: impl std::os::fd::AsFd) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let file = match path == Path::new("-") {
        true => File::from(standard.as_fd().try_clone_to_owned().ok()?).metadata().ok()?,
        false => std::fs::metadata(path).ok()?,
    };
    file.is_file().then(|| (file.dev(), file.ino()))
}

/// The file of that name.
#[cfg(not(unix))]
fn file_of<S>(path: &Path, _standard: S) -> Option<PathBuf> {
    path.canonicalize().ok().filter(|path| path.is_file())
}

/// Creates the file of that path; `None` for standard output.
pub(super) fn create(path: Option<&Path>) -> io::Result<Option<File>> {
    let path = path.filter(|path| *path != Path::new("-"));
    path.map(|path| File::create(path).map_err(|error| named(path, error))).transpose()
}

/// A buffered output; standard output is colored if it is a terminal that wants colors.
pub(super) struct Output {
    pub writer: BufWriter<Box<dyn Write>>,
    /// How text is marked here.
    pub palette: Palette,
}

impl Output {
    /// Opens `path`, or standard output.
    pub fn open(path: Option<&Path>) -> io::Result<Self> {
        let (writer, palette): (Box<dyn Write>, _) = match (create(path)?, AutoStream::choice(&io::stdout())) {
            (Some(file), _) => (Box::new(file), Palette::default()),
            (None, ColorChoice::Never) => (Box::new(io::stdout().lock()), Palette::default()),
            (None, _) => (Box::new(io::stdout().lock()), COLORS),
        };
        Ok(Self { writer: BufWriter::with_capacity(1 << 16, writer), palette })
    }

    /// Writes `bytes` and closes the output.
    pub fn finish(mut self, bytes: &[u8]) -> Completion {
        self.writer.write_all(bytes)?;
        self.writer.flush()?;
        Ok(Answered::All)
    }
}

/// Bold and faint; a test keeps the sequences equal to anstyle's.
const COLORS: Palette = Palette { strong: "\x1b[1m", faint: "\x1b[2m", plain: "\x1b[0m" };

/// The error, with the file's name.
pub(super) fn named(path: &Path, error: io::Error) -> io::Error {
    io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anstyle::Style;

    #[test]
    fn colors_are_those_of_anstyle() {
        let strong = Style::new().bold();
        assert_eq!(COLORS.strong, strong.render().to_string());
        assert_eq!(COLORS.faint, Style::new().dimmed().render().to_string());
        assert_eq!(COLORS.plain, strong.render_reset().to_string());
    }
}
