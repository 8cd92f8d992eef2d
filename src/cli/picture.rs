//! `--plot`: pictures as SVG or PNG.

use super::Failure;
use super::output::{apart, named, spare, writable};
use heelstrike::draw::Picture;
use heelstrike::{Error, Reason};
use std::path::{Path, PathBuf};

/// Where a picture goes.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct PlotOptions {
    /// Draw a picture to this file, which is replaced; .svg or .png
    #[arg(long, value_name = "FILE.svg|.png")]
    plot: Option<PathBuf>,
}

impl PlotOptions {
    /// Refuses an ending that is neither svg nor png, before any work is done.
    ///
    /// # Errors
    /// [`Failure::Usage`], naming the file.
    pub fn check(&self) -> Result<(), Failure> {
        let hint = match self.plot.as_deref().map(PlotFormat::of) {
            None | Some(Some(PlotFormat::Svg | PlotFormat::Png)) => return Ok(()),
            Some(Some(PlotFormat::Html)) => {
                "name a file that ends in .svg or .png; interactive pages are written by `sweep` and `batch`"
            }
            Some(None) => "name a file that ends in .svg or .png",
        };
        Err(unknown_ending("a picture is written as .svg or .png", hint))
    }

    /// Refuses, before any work is done, a file that is being read, one that the `results` go to, and one that cannot
    /// be written.
    ///
    /// # Errors
    /// [`Failure::Refused`], [`Failure::Usage`] and [`Failure::Output`].
    pub fn claim(&self, inputs: &[&Path], results: Option<&Path>) -> Result<(), Failure> {
        claim(self.plot.as_deref(), inputs, results)
    }

    /// Whether a picture is asked for.
    pub fn is_asked(&self) -> bool {
        self.plot.is_some()
    }

    /// Draws the picture, if one is asked for.
    ///
    /// # Errors
    /// An error of the file system, and a picture without anything to draw, for the reason `why_empty`.
    pub fn draw(&self, picture: &Picture, why_empty: &'static str) -> Result<(), Failure> {
        self.plot.as_deref().map_or(Ok(()), |path| draw(path, picture, why_empty))
    }
}

/// The form of what is drawn, by the ending of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PlotFormat {
    Svg,
    Png,
    /// An interactive page.
    Html,
}

impl PlotFormat {
    /// The form that a file's ending names; `None` for any other ending.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "svg" => Some(Self::Svg),
            "png" => Some(Self::Png),
            "html" => Some(Self::Html),
            _ => None,
        }
    }
}

/// As [`PlotOptions::claim`], for this file.
///
/// # Errors
/// As there.
pub(super) fn claim(plot: Option<&Path>, inputs: &[&Path], results: Option<&Path>) -> Result<(), Failure> {
    spare(plot, inputs)?;
    apart([("results", results), ("picture", plot)], "--plot")?;
    Ok(writable(plot)?)
}

/// Draws the picture to this file.
///
/// # Errors
/// As [`PlotOptions::draw`].
pub(super) fn draw(path: &Path, picture: &Picture, why_empty: &'static str) -> Result<(), Failure> {
    let bytes =
        if PlotFormat::of(path) == Some(PlotFormat::Png) { picture.png()? } else { picture.svg().map(Into::into) };
    write(path, bytes, why_empty)
}

/// Writes a picture or a page; without `bytes` there is nothing to draw.
///
/// # Errors
/// As [`PlotOptions::draw`].
pub(super) fn write(path: &Path, bytes: Option<Vec<u8>>, why_empty: &'static str) -> Result<(), Failure> {
    let nothing = || Error::new(Reason::Unsupported("there is nothing to draw".into())).at("--plot").hint(why_empty);
    let bytes = bytes.ok_or_else(nothing)?;
    std::fs::write(path, bytes).map_err(|error| Failure::Output(named(path, error)))
}

/// The refusal of an ending.
pub(super) fn unknown_ending(reason: &'static str, hint: &'static str) -> Failure {
    Failure::Usage(Error::new(Reason::Unsupported(reason.into())).at("--plot").hint(hint))
}
