//! What a figure looks like.

use crate::exhibit::{Exhibit, Found};
use heelstrike::Result;
use heelstrike::report::sweep::picture;

/// As SVG; none where there is nothing to draw.
///
/// # Errors
/// A study that is refused.
pub fn svg(exhibit: &Exhibit, found: &Found) -> Result<Option<String>> {
    match found {
        Found::Regions(findings) => exhibit.study(|model, workers| picture::of(model, findings, workers).svg()),
        Found::Outcomes(_) => Ok(None),
    }
}
