//! `--plot`: pictures as SVG or PNG.

use super::Failure;
use super::output::{apart, named, spare, writable};
use super::page::is_page;
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
    /// To this file, if there is one.
    pub fn to(plot: Option<PathBuf>) -> Self {
        Self { plot }
    }

    /// Refuses an ending that is neither svg nor png, before any work is done.
    ///
    /// # Errors
    /// [`Failure::Usage`], naming the file.
    pub fn check(&self) -> Result<(), Failure> {
        match self.plot.as_deref().map(ending) {
            None | Some(Some(_)) => Ok(()),
            Some(None) => {
                let reason = Reason::Unsupported("a picture is written as .svg or .png".into());
                let hint = match self.plot.as_deref().is_some_and(is_page) {
                    true => {
                        "name a file that ends in .svg or .png; interactive pages are written by `sweep` and `batch`"
                    }
                    false => "name a file that ends in .svg or .png",
                };
                Err(Failure::Usage(Error::new(reason).at("--plot").hint(hint)))
            }
        }
    }

    /// Refuses, before any work is done, a file that is being read, one that the `results` go to, and one that cannot be
    /// written.
    ///
    /// # Errors
    /// [`Failure::Refused`], [`Failure::Usage`] and [`Failure::Output`].
    pub fn claim(&self, inputs: &[&Path], results: Option<&Path>) -> Result<(), Failure> {
        let plot = self.plot.as_deref();
        spare(plot, inputs)?;
        apart([("results", results), ("picture", plot)], "--plot")?;
        Ok(writable(plot)?)
    }

    /// Whether a picture is asked for.
    pub fn is_asked(&self) -> bool {
        self.plot.is_some()
    }

    /// Draws the picture, if one is asked for.
    ///
    /// # Errors
    /// Whatever keeps the file from being written, and a picture that nothing can be drawn in, with why that may be.
    pub fn draw(&self, picture: &Picture, why_empty: &'static str) -> Result<(), Failure> {
        let Some((path, ending)) = self.plot.as_deref().and_then(|path| Some((path, ending(path)?))) else {
            return Ok(());
        };
        let bytes = match ending {
            Ending::Svg => picture.svg().map(String::into_bytes),
            Ending::Png => picture.png()?,
        };
        let bytes = bytes.ok_or_else(|| nothing_to_draw(why_empty))?;
        std::fs::write(path, bytes).map_err(|error| Failure::Output(named(path, error)))
    }
}

/// The refusal of a picture that nothing can be drawn in.
pub(super) fn nothing_to_draw(why: &'static str) -> Failure {
    let reason = Reason::Unsupported("there is nothing to draw".into());
    Error::new(reason).at("--plot").hint(why).into()
}

#[derive(Debug, Clone, Copy)]
enum Ending {
    Svg,
    Png,
}

fn ending(path: &Path) -> Option<Ending> {
    match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
        "svg" => Some(Ending::Svg),
        "png" => Some(Ending::Png),
        _ => None,
    }
}
