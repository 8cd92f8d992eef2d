//! Output of results, as text or JSON, to standard output or a file.

use super::diagnostic::note;
use super::{Answered, Completion, Failure};
use crate::write::{self, Palette};
use crate::{Error, Reason};
use anstream::{AutoStream, ColorChoice};
use serde::Serialize;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Write};
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
    /// Returns the format chosen by the option or by the output's ending; `None` if neither chooses one.
    pub fn chosen(&self) -> Option<Format> {
        let by_ending = |path: &PathBuf| match &*path.extension()?.to_str()?.to_ascii_lowercase() {
            "json" | "ndjson" | "jsonl" => Some(Format::Json),
            "txt" => Some(Format::Text),
            _ => None,
        };
        self.format.or_else(|| self.output.as_ref().and_then(by_ending))
    }

    /// Refuses an output whose ending means a format that is not written here, unless the option chooses a format.
    pub fn check_ending(&self) -> Result<(), Failure> {
        let written = "a result is written as .json, .ndjson or .txt, and tables by `batch`";
        if self.format.is_some() { Ok(()) } else { check_ending((self.path(), true), written, "--format") }
    }

    /// Returns the output file; `None` for standard output.
    pub fn path(&self) -> Option<&Path> {
        self.output.as_deref()
    }

    /// Writes the only result of a command, as text unless JSON is chosen.
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

/// Endings with a known meaning. A command reads or writes only some of these formats.
const FORMATS: [&str; 22] = [
    "arrow", "arrows", "csv", "feather", "h5", "hdf5", "html", "ipc", "mat", "npy", "npz", "parquet", "pdf", "pickle",
    "png", "svg", "toml", "tsv", "xlsx", "xml", "yaml", "yml",
];
/// Endings that are refused only for outputs: the first bytes of such an input lead to an error with a better remedy.
const PACKED: [&str; 8] = ["bz2", "gz", "ods", "pq", "xls", "xz", "zip", "zst"];

/// Refuses a file whose ending means another format than the command's; `is_written` is true for an output.
/// `reason` names the formats of the command, and `option` is the option that overrides the ending.
pub(super) fn check_ending(
    (path, is_written): (Option<&Path>, bool),
    reason: &'static str,
    option: &str,
) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !(FORMATS.contains(&&*ending) || is_written && PACKED.contains(&&*ending)) {
        return Ok(());
    }
    let error = Error::new(Reason::Unsupported(reason.to_owned())).in_file(path.display().to_string());
    Err(Failure::Usage(error.hint(format!("name a file with one of these endings, or say {option}"))))
}

/// Refuses an `output` that is one of the `inputs`, even under another name, and one whose temporary files next to it
/// ([`PART`], [`RUN`]) would replace an input. `-` is standard input or output, and so is `None` for the output.
pub(super) fn spare(output: Option<&Path>, inputs: &[Option<&PathBuf>]) -> crate::Result<()> {
    let output = output.unwrap_or(Path::new("-"));
    let places = match output == Path::new("-") {
        true => vec![output.to_owned()],
        false => ["", PART, RUN].map(|ending| with_ending(output, ending)).to_vec(),
    };
    let written: Vec<_> = places.iter().filter_map(|place| file_of(place, io::stdout())).collect();
    let is_written = |input: &&&PathBuf| file_of(input, io::stdin()).is_some_and(|file| written.contains(&file));
    let Some(input) = inputs.iter().flatten().find(is_written) else { return Ok(()) };
    let reason = Reason::Io("is an input of this command, and the output would replace it".into());
    let name = match (input.as_path() == Path::new("-"), output == Path::new("-")) {
        (_, true) => "<stdout>".to_owned(),
        (true, false) => output.display().to_string(),
        (false, false) => input.display().to_string(),
    };
    Err(Error::new(reason).in_file(name).hint("write to another file"))
}

/// Refuses two outputs that are the same file, even under different names. The second may be absent; `option` names it.
pub(super) fn apart(
    [(what, one), (other_what, other)]: [(&str, Option<&Path>); 2],
    option: &'static str,
) -> Result<(), Failure> {
    let (one, Some(other)) = (one.unwrap_or(Path::new("-")), other) else { return Ok(()) };
    let place = |path: &Path| {
        let last = with_ending(path, "");
        Some(last.parent()?.join(".").canonicalize().ok()?.join(last.file_name()?))
    };
    let same_name = one != Path::new("-") && place(one).is_some_and(|one| place(other) == Some(one));
    let same_file = file_of(one, io::stdout()).is_some_and(|file| file_of(other, io::stdout()) == Some(file));
    if !same_name && !same_file {
        return Ok(());
    }
    let reason = format!("{what} and {other_what} would be written to the same file");
    Err(Failure::usage(option, reason, "name two files"))
}

/// Checks that a file can be written, and leaves it unchanged. Pipes and devices are not checked.
pub(super) fn writable(path: Option<&Path>) -> io::Result<()> {
    let Some(path) = path.filter(|path| *path != Path::new("-")) else { return Ok(()) };
    let known = std::fs::metadata(path).ok();
    // Opening and closing a pipe would look like the end of the output to its reader.
    if known.as_ref().is_some_and(|known| !known.is_file() && !known.is_dir()) {
        return Ok(());
    }
    OpenOptions::new().append(true).create(true).open(path).map_err(|error| named(path, error))?;
    known.map_or_else(|| std::fs::remove_file(with_ending(path, "")).map_err(|error| named(path, error)), |_| Ok(()))
}

/// The endings that are added to the name of an unfinished output, and to the name of its record ([`super::origin`]).
const PART: &str = ".part";
pub(super) const RUN: &str = ".run";

/// Returns device and inode of the file, or of `standard` for `-`; `None` for devices and pipes, never replaced.
#[cfg(unix)]
fn file_of(path: &Path, standard: impl std::os::fd::AsFd) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    let file = match path == Path::new("-") {
        true => File::from(standard.as_fd().try_clone_to_owned().ok()?).metadata().ok()?,
        false => std::fs::metadata(path).ok()?,
    };
    file.is_file().then(|| (file.dev(), file.ino()))
}

/// Returns the absolute path of the file; `None` if it is not a regular file.
#[cfg(not(unix))]
fn file_of<S>(path: &Path, _standard: S) -> Option<PathBuf> {
    path.canonicalize().ok().filter(|path| path.is_file())
}

/// A file that gets its name when it is finished. Until then it is written next to its place, with the ending `.part`.
/// Devices and pipes are written in place.
#[derive(Debug)]
pub(super) struct NewFile {
    pub file: File,
    /// The path as the user gave it.
    pub path: PathBuf,
    /// The temporary and the final path; `None` if the file is written in place or is finished.
    places: Option<[PathBuf; 2]>,
    /// Whether an unfinished file is kept.
    pub keep: bool,
}

impl NewFile {
    /// Creates the file. An existing file of the same name stays until [`Self::finish`].
    pub fn create(path: &Path) -> io::Result<Self> {
        Self::open(path).map_err(|error| named(path, error))
    }

    fn open(path: &Path) -> io::Result<Self> {
        let known = std::fs::metadata(path).ok();
        let new = |file, places| Self { file, path: path.to_owned(), places, keep: false };
        if known.as_ref().is_some_and(|known| !known.is_file()) {
            return Ok(new(File::create(path)?, None));
        }
        if known.is_some() {
            // Fails if the existing file may not be written.
            OpenOptions::new().append(true).open(path)?;
        }
        let [part, last] = Self::places(path);
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&part)?;
        lock(&file)?;
        file.set_len(0)?;
        Ok(new(file, Some([part, last])))
    }

    pub fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut new = Self::create(path)?;
        new.file.write_all(bytes).map_err(|error| named(path, error))?;
        new.finish()
    }

    /// Opens the file of an earlier run: the unfinished file, or else the file itself, which is then continued in
    /// place. Returns `None` if there is neither.
    pub fn reopen(path: &Path) -> io::Result<Option<Self>> {
        let [part, last] = Self::places(path);
        let places = part.is_file().then(|| [part, last.clone()]);
        let present = places.as_ref().map_or(&last, |[part, _]| part);
        if !present.is_file() {
            return Ok(None);
        }
        let file = OpenOptions::new().read(true).write(true).open(present).map_err(|error| named(present, error))?;
        lock(&file).map_err(|error| named(present, error))?;
        Ok(Some(Self { file, path: path.to_owned(), places, keep: true }))
    }

    fn places(path: &Path) -> [PathBuf; 2] {
        [with_ending(path, PART), with_ending(path, "")]
    }

    /// Returns the temporary path; `None` if the file is written in place or is finished.
    pub fn part(&self) -> Option<&Path> {
        self.places.as_ref().map(|[part, _]| part.as_path())
    }

    /// Returns whether finishing will replace an existing file.
    pub fn replaces(&self) -> bool {
        self.places.as_ref().is_some_and(|[_, last]| last.is_file())
    }

    /// Removes an unfinished file that is not kept.
    pub fn discard(&self) {
        if let (Some([part, _]), false) = (&self.places, self.keep) {
            // If this fails, a useless file stays; that is not worth an error.
            let _ = std::fs::remove_file(part);
        }
    }

    /// Gives the file its final name, with the permissions of the file that it replaces.
    pub fn finish(mut self) -> io::Result<()> {
        let Some([part, last]) = self.places.take() else { return Ok(()) };
        let renamed = || {
            self.file.sync_all()?;
            if let Ok(known) = std::fs::metadata(&last) {
                std::fs::set_permissions(&part, known.permissions())?;
            }
            std::fs::rename(&part, &last)
        };
        renamed().map_err(|error| named(&self.path, error))
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        self.discard();
    }
}

/// Returns the path of the file at `path`, with links followed and `ending` added to its name.
pub(super) fn with_ending(path: &Path, ending: &str) -> PathBuf {
    // The target of a link is replaced, not the link; this includes a target that does not exist yet.
    let linked = || Some(path.parent()?.join(path.read_link().ok()?));
    let mut name = path.canonicalize().ok().or_else(linked).unwrap_or_else(|| path.to_owned()).into_os_string();
    name.push(ending);
    name.into()
}

/// Locks a file, and refuses one that another run is writing. File systems without locks accept every file.
fn lock(file: &File) -> io::Result<()> {
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(io::Error::other("another run is writing it")),
        Ok(()) | Err(TryLockError::Error(_)) => Ok(()),
    }
}

/// The destination of results.
pub(super) enum Target {
    Standard(Box<dyn Write + Send>),
    File(NewFile),
}

impl Target {
    /// Opens the file at `path`, or standard output. With `keep`, an unfinished file is kept.
    pub fn open(path: Option<&Path>, keep: bool) -> io::Result<Self> {
        match path.filter(|path| *path != Path::new("-")) {
            Some(path) => {
                let mut file = NewFile::create(path)?;
                file.keep = keep;
                Ok(Self::File(file))
            }
            None => standard_output().map(Self::Standard),
        }
    }

    /// Finishes the output. An existing file is replaced only if something was `answered`.
    pub fn finish(self, answered: bool) -> io::Result<()> {
        match self {
            Self::Standard(mut output) => output.flush(),
            Self::File(mut file) if !answered && file.replaces() => {
                note(&format!("nothing was answered, and {} stays as it was", file.path.display()));
                file.keep = false;
                Ok(())
            }
            Self::File(file) => file.finish(),
        }
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Standard(output) => output.write(bytes),
            Self::File(file) => file.file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Standard(output) => output.flush(),
            Self::File(file) => file.file.flush(),
        }
    }
}

/// Opens standard output without a buffer. Results come in large blocks, and std's line buffer would hide how much
/// reached a full disk. Also, std ignores the error of writing to a descriptor that is not open for writing.
fn standard_output() -> io::Result<Box<dyn Write + Send>> {
    #[cfg(unix)]
    {
        let standard_output = std::os::fd::AsFd::as_fd(&io::stdout()).try_clone_to_owned()?;
        Ok(Box::new(File::from(standard_output)))
    }
    #[cfg(not(unix))]
    Ok(Box::new(io::stdout()))
}

/// A buffered output. Text on standard output is colored if colors are on.
pub(super) struct Output {
    pub writer: BufWriter<Target>,
    /// The codes that emphasize text on this output.
    pub palette: Palette,
}

impl Output {
    pub fn open(path: Option<&Path>) -> io::Result<Self> {
        let target = Target::open(path, false)?;
        let palette = match (&target, AutoStream::choice(&io::stdout())) {
            (Target::File(_), _) | (_, ColorChoice::Never) => Palette::default(),
            (Target::Standard(_), _) => COLORS,
        };
        Ok(Self { writer: BufWriter::with_capacity(1 << 16, target), palette })
    }

    /// Writes `bytes` and closes the output.
    pub fn finish(mut self, bytes: &[u8]) -> Completion {
        self.writer.write_all(bytes)?;
        self.close(true)?;
        Ok(Answered::All)
    }

    /// Closes the output. An existing file is replaced only if something was `answered`.
    pub fn close(self, answered: bool) -> io::Result<()> {
        self.writer.into_inner().map_err(|error| error.into_error())?.finish(answered)
    }
}

/// Terminal codes for bold, faint and plain text.
const COLORS: Palette = Palette { strong: "\x1b[1m", faint: "\x1b[2m", plain: "\x1b[0m" };

/// Adds the file's name to an error.
pub(super) fn named(path: &Path, error: io::Error) -> io::Error {
    let path = path.display();
    let reason = match error.kind() {
        ErrorKind::NotFound => format!("{path}: its folder is not there"),
        _ => format!("{path}: {error}"),
    };
    io::Error::new(error.kind(), reason)
}
