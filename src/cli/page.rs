//! `--plot` of commands that write an interactive page, too.

use super::Failure;
use super::output::named;
use super::picture::{PlotOptions, nothing_to_draw};
use heelstrike::draw::Picture;
use heelstrike::draw::page::Page;
use heelstrike::draw::plot::Rendered;
use heelstrike::{Error, Reason};
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
        if self.is_page() || self.picture().check().is_ok() {
            return Ok(());
        }
        let reason = Reason::Unsupported("a picture is written as .svg or .png, an interactive page as .html".into());
        Err(Failure::Usage(Error::new(reason).at("--plot").hint("name a file that ends in .svg, .png or .html")))
    }

    /// As [`PlotOptions::claim`].
    ///
    /// # Errors
    /// As there.
    pub fn claim(&self, inputs: &[&Path], results: Option<&Path>) -> Result<(), Failure> {
        PlotOptions::to(self.plot.clone()).claim(inputs, results)
    }

    /// The file.
    pub fn path(&self) -> Option<&Path> {
        self.plot.as_deref()
    }

    /// Whether a picture or a page is asked for.
    pub fn is_asked(&self) -> bool {
        self.plot.is_some()
    }

    /// Draws the picture, or writes the page that `page` makes around it, if one of both is asked for.
    ///
    /// # Errors
    /// Whatever keeps the file from being written, and a picture that nothing can be drawn in, with why that may be.
    pub fn draw(
        &self,
        picture: &Picture,
        why_empty: &'static str,
        page: impl FnOnce(Rendered) -> Page,
    ) -> Result<(), Failure> {
        match (self.plot.as_deref().filter(|plot| is_page(plot)), picture.render()) {
            (Some(path), Some(rendered)) => {
                std::fs::write(path, page(rendered).html()).map_err(|error| Failure::Output(named(path, error)))
            }
            (Some(_), None) => Err(nothing_to_draw(why_empty)),
            (None, _) => self.picture().draw(picture, why_empty),
        }
    }

    /// Whether a page is asked for.
    pub fn is_page(&self) -> bool {
        self.plot.as_deref().is_some_and(is_page)
    }

    /// Where a picture goes; nowhere where a page is asked for.
    fn picture(&self) -> PlotOptions {
        PlotOptions::to(self.plot.clone().filter(|plot| !is_page(plot)))
    }
}

/// Whether a file's ending says that it is a page.
pub(super) fn is_page(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html"))
}
