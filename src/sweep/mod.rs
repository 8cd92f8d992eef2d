//! Outcomes as functions of one or two parameters: regions of equal outcomes, and the transitions at the borders
//! between them.
//!
//! ```text
//!     point of the parameters --[model]--> Robot, State --[pipeline]--> Impact --[regime]--> which outcomes are valid
//!     inequalities of all combinations --[border_search]--> where they may change
//!     samples --[line]--> borders, found to 1e-12 of the range --[transition]--> which inequality is zero there
//!     one parameter --[survey]--> Survey --[curves]--> RegionCurves
//!     two parameters --[edge, cell]--> pieces of borders --[polyline, interior, map]--> Map
//! ```

mod parallel;
mod regime;
mod model;
mod unit;
mod contact_changes;
mod border_search;
mod line;
mod transition;
mod survey;
mod curves;
mod edge;
mod cell;
mod polyline;
mod interior;
mod map;

pub use crate::read::{Parameter, Study};
pub use curves::{CurvePoint, RegionCurves};
pub use line::{Bracket, Landscape, Probe, RESOLUTION, brackets};
pub use map::{Area, BorderCurve, CELLS, Map};
pub use model::{RobotStudy, Solver, WATCHED_CONTACTS, Watched};
pub use parallel::Workers;
pub use regime::Regime;
pub use survey::{Region, RegionBorder, Survey};
pub use transition::{EndedOutcome, Side, Transition};

use crate::Error;
use std::sync::Arc;

/// The regions and borders of a study.
#[derive(Debug, Clone)]
pub enum Findings {
    /// The regions along one parameter.
    Along(Survey),
    /// The areas in the plane of two parameters.
    Map(Map),
}

impl Findings {
    /// Computes the findings of `model`. Reports [`Findings::work`] pieces of work to `workers`.
    pub fn of(model: &RobotStudy, workers: Workers) -> Self {
        match model.study.parameters().len() {
            2 => Self::Map(Map::of(model, workers)),
            _ => Self::Along(Survey::of(model, workers)),
        }
    }

    /// Returns the number of pieces of work for the findings of `model`.
    pub fn work(model: &RobotStudy) -> usize {
        match model.study.parameters().len() {
            2 => Map::work(model),
            _ => Survey::work(model),
        }
    }

    /// Returns the regime of every region, the number of its letter, and the error if it is refused.
    pub fn regimes(&self) -> Vec<(&Arc<Regime>, usize, Option<&Error>)> {
        match self {
            Self::Along(survey) => {
                survey.regions.iter().map(|region| (&region.regime, region.kind, region.refused.as_ref())).collect()
            }
            Self::Map(map) => {
                map.areas.iter().enumerate().map(|(kind, area)| (&area.regime, kind, area.refused.as_ref())).collect()
            }
        }
    }
}

/// Returns the letters of a number: A, B, ..., Z, AA, AB, ...
pub fn letter(kind: usize) -> String {
    let last = char::from(b'A' + (kind % 26) as u8);
    match kind / 26 {
        0 => last.to_string(),
        more => letter(more - 1) + &last.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_behind_z() {
        let letters: Vec<String> = [0, 25, 26, 51, 52, 701, 702].map(letter).into();
        assert_eq!(letters, ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }
}
