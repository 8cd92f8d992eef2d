//! The picture of a figure.

use super::exhibit::{Exhibit, Found};
use heelstrike::Result;
use heelstrike::draw::{Forward, Picture, robot as drawing, sweep};

/// Curves and regions of a study, or the robot in its pose with every outcome; `None` if there is nothing to draw.
///
/// # Errors
/// Returns an error if the study is refused.
pub fn of(exhibit: &Exhibit, found: &Found) -> Result<Option<Picture>> {
    match found {
        Found::Regions(findings) => {
            exhibit.study(|model, workers| sweep::of(model, findings, Forward::Along, workers)).map(Some)
        }
        Found::Outcomes(of) => Ok(drawing::picture::impact(&exhibit.robot, &[], &of.0, &of.1, Forward::Along)),
    }
}
