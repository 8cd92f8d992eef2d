//! `--plot` of commands that also write an interactive page.

use super::Failure;
use super::picture::{PlotFormat, claim, draw, unknown_ending, write};
use heelstrike::draw::Picture;
use heelstrike::draw::page::Page;
use heelstrike::draw::plot::Rendered;
use std::path::{Path, PathBuf};

/// Where a picture or a page goes.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct PageOptions {
    /// Draw a picture (.svg or .png) or write an interactive page (.html) to this file, which is replaced
    #[arg(long, value_name = "FILE.svg|.png|.html")]
    plot: Option<PathBuf>,
}

impl PageOptions {
    /// Refuses an unknown ending, before any work is done.
    ///
    /// # Errors
    /// [`Failure::Usage`], naming the option.
    pub fn check(&self) -> Result<(), Failure> {
        match self.plot.as_deref().map(PlotFormat::of) {
            Some(None) => Err(unknown_ending(
                "a picture is written as .svg or .png, an interactive page as .html",
                "name a file that ends in .svg, .png or .html",
            )),
            _ => Ok(()),
        }
    }

    /// As [`PlotOptions::claim`](super::picture::PlotOptions::claim).
    ///
    /// # Errors
    /// As there.
    pub fn claim(&self, inputs: &[&Path], results: Option<&Path>) -> Result<(), Failure> {
        claim(self.plot.as_deref(), inputs, results)
    }

    /// The file.
    pub fn path(&self) -> Option<&Path> {
        self.plot.as_deref()
    }

    /// Whether a picture or a page is asked for.
    pub fn is_asked(&self) -> bool {
        self.plot.is_some()
    }

    /// Whether a page is asked for.
    pub fn is_page(&self) -> bool {
        self.plot.as_deref().and_then(PlotFormat::of) == Some(PlotFormat::Html)
    }

    /// Draws the picture, or writes the page that `page` makes around it, if one of both is asked for.
    ///
    /// # Errors
    /// As [`PlotOptions::draw`](super::picture::PlotOptions::draw).
    pub fn draw(
        &self,
        picture: &Picture,
        why_empty: &'static str,
        page: impl FnOnce(Rendered) -> Page,
    ) -> Result<(), Failure> {
        match self.plot.as_deref() {
            None => Ok(()),
            Some(path) if self.is_page() => {
                write(path, picture.render().map(|rendered| page(rendered).html().into_bytes()), why_empty)
            }
            Some(path) => draw(path, picture, why_empty),
        }
    }
}
