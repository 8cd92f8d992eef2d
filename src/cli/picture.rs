//! `--plot`: pictures as SVG or PNG, and interactive pages.

use super::Failure;
use super::output::{NewFile, apart, spare, writable};
use crate::draw::page::Page;
use crate::draw::plot::Rendered;
use crate::draw::{Forward, Picture};
use crate::{Error, Reason};
use std::path::{Path, PathBuf};

/// Where a picture goes, or with `PAGES` also an interactive page.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct PlotOptions<const PAGES: bool> {
    #[arg(long, value_name = if PAGES { "FILE.svg|.png|.html" } else { "FILE.svg|.png" })]
    #[arg(help = if PAGES {
        "Draw a picture (.svg or .png) or write an interactive page (.html) to this file, which is replaced"
    } else {
        "Draw a picture to this file, which is replaced; .svg or .png"
    })]
    plot: Option<PathBuf>,
}

/// Which way is forward in a picture of a robot.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Output")]
pub(super) struct MirrorOptions {
    /// Mirror the picture: forward is along -x, and drawn to the right
    #[arg(long, requires = "plot")]
    mirror: bool,
}

impl MirrorOptions {
    pub fn forward(&self) -> Forward {
        if self.mirror { Forward::Against } else { Forward::Along }
    }
}

impl<const PAGES: bool> PlotOptions<PAGES> {
    /// Checks the outputs before any work is done. Refuses `results` or a picture that would replace an input, and a
    /// picture whose file has an unknown ending, is that of the results, or cannot be written.
    pub fn claim(&self, inputs: &[Option<&PathBuf>], results: Option<&Path>) -> Result<(), Failure> {
        spare(results, inputs)?;
        let refuse = |reason, hint| Err(Failure::usage("--plot", reason, hint));
        let picture = "a picture is written as .svg or .png";
        match (self.ending().as_deref(), PAGES) {
            (Some("svg" | "png"), _) | (Some("html"), true) => Ok(()),
            _ if self.plot.is_none() => Ok(()),
            (Some("html"), false) => refuse(
                picture,
                "name a file that ends in .svg or .png; interactive pages are written by `sweep` and `batch`",
            ),
            (_, false) => refuse(picture, "name a file that ends in .svg or .png"),
            (_, true) => refuse(
                "a picture is written as .svg or .png, an interactive page as .html",
                "name a file that ends in .svg, .png or .html",
            ),
        }?;
        spare(self.path(), inputs)?;
        apart([("results", results), ("picture", self.path())], "--plot")?;
        Ok(writable(self.path())?)
    }

    /// Returns the file of the picture or page, if one is requested.
    pub fn path(&self) -> Option<&Path> {
        self.plot.as_deref()
    }

    fn ending(&self) -> Option<String> {
        Some(self.path()?.extension()?.to_str()?.to_ascii_lowercase())
    }

    pub fn is_page(&self) -> bool {
        self.ending().as_deref() == Some("html")
    }

    /// Writes the picture if one is requested. Refuses a picture without anything to draw, or without a finite scale;
    /// `why_empty` explains it.
    pub fn draw(&self, picture: &Picture, why_empty: &'static str) -> Result<(), Failure> {
        match self.ending().as_deref() {
            None => Ok(()),
            Some("png") => self.write(picture.png()?, why_empty),
            Some(_) => self.write(picture.svg().map(Into::into), why_empty),
        }
    }

    /// Writes the picture, or the page that `page` creates with it, if either is requested.
    pub fn draw_or_page(
        &self,
        picture: &Picture,
        why_empty: &'static str,
        page: impl FnOnce(Rendered) -> Result<Page, Failure>,
    ) -> Result<(), Failure> {
        if !self.is_page() {
            return self.draw(picture, why_empty);
        }
        let page = picture.render().map(page).transpose()?;
        self.write(page.map(|page| page.html().into_bytes()), why_empty)
    }

    fn write(&self, bytes: Option<Vec<u8>>, why_empty: &'static str) -> Result<(), Failure> {
        let Some(path) = self.path() else { return Ok(()) };
        let nothing = || Reason::Unsupported("there is nothing to draw, or not to scale".into());
        let bytes = bytes.ok_or_else(|| Error::new(nothing()).at("--plot").hint(why_empty))?;
        Ok(NewFile::write(path, &bytes)?)
    }
}
