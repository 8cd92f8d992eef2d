//! The regions, borders and samples of a study, as JSON, tables and text.
//!
//! ```text
//!     Survey --> Sweep {parameter, regions, borders, notes} --> head of the JSON, text
//!     each sample --> Report --> "samples", rows of CSV
//! ```

mod samples;
mod text;

#[cfg(feature = "schema")]
pub(super) use samples::RefusedSample;
pub use samples::{SampleRecord, columns};

use super::{ErrorObject, append_line};
use crate::pipeline::Aspect;
use crate::sweep::{
    Area, BorderCurve, CELLS, Findings, Map, Parameter, Regime, Region, RegionBorder, Study, Survey, WATCHED_CONTACTS,
    letter,
};
use crate::{Error, Mode, Reason, Verdict};
use serde::Serialize;

/// The record of a study of one parameter, without its samples.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Sweep<'a> {
    /// What is asked; absent of impacts.
    #[serde(skip_serializing_if = "Aspect::is_impact")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Aspect>"))]
    pub question: Aspect,
    /// The parameter.
    pub parameter: &'a str,
    /// The regions, from the least to the greatest value.
    pub regions: Vec<RegionRecord<'a>>,
    /// The borders between neighboring regions.
    pub borders: &'a [RegionBorder],
    /// Limits of the search, and what is odd about the states, as sentences.
    pub notes: Vec<String>,
    /// How many samples there are.
    #[serde(skip)]
    steps: usize,
}

/// The record of a study, without its samples.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Regions<'a> {
    /// Of one parameter.
    Along(Sweep<'a>),
    /// Of two parameters.
    Map(MapSweep<'a>),
}

/// A stretch of the parameter with one set of outcomes.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RegionRecord<'a> {
    /// Regions of the same letter have the same contacts and outcomes.
    pub letter: String,
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Its outcomes.
    #[serde(flatten)]
    pub happening: Happening<'a>,
}

/// The outcomes of a region.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Happening<'a> {
    /// The question.
    #[serde(skip)]
    pub question: Aspect,
    /// Names of the closed contacts; absent if states are refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contacts: Option<&'a [String]>,
    /// The verdict at its middle; `no_impact` only if nothing strikes at its samples or, in a map, at the nodes. Absent
    /// if states are refused, or if a region of a map has no room for a point well inside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// The modes of every outcome; absent if states are refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcomes: Option<&'a [Vec<Mode>]>,
    /// Combinations that no precision excludes; absent if everything is decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undecided: Option<&'a [Vec<Mode>]>,
    /// The reason why the states in it are refused, from its middle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<ErrorObject>,
    /// Whether the error has a depth, which is that of one of its states.
    #[serde(skip)]
    pub has_depth: bool,
}

impl<'a> Regions<'a> {
    /// Creates the record of a `study`.
    pub fn new(study: &'a Study, findings: &'a Findings) -> Self {
        match findings {
            Findings::Along(survey) => Self::Along(Sweep::new(study, survey)),
            Findings::Map(map) => Self::Map(MapSweep::new(study, map)),
        }
    }

    /// Appends the JSON object up to its samples. The caller appends them with commas between them, and then `]}`.
    pub fn append_head(&self, out: &mut Vec<u8>) {
        append_line(out, self);
        out.truncate(out.len().saturating_sub(b"}\n".len()));
        out.extend(b",\"samples\":[");
    }
}

impl<'a> Sweep<'a> {
    /// Creates the record of a survey of the first parameter.
    pub fn new(study: &'a Study, survey: &'a Survey) -> Self {
        let parameter = &study.parameters()[0];
        let region = |region: &'a Region| RegionRecord {
            letter: letter(region.kind),
            from: region.from,
            to: region.to,
            happening: Happening::of(study.question(), &region.regime, region.verdict, region.refused.as_ref()),
        };
        let contacts = survey.regions.iter().map(|region| region.regime.contacts().len()).max().unwrap_or(0);
        Self {
            question: study.question(),
            parameter: &parameter.name,
            regions: survey.regions.iter().map(region).collect(),
            borders: &survey.borders,
            notes: [not_guaranteed(contacts, survey.dependent), survey.oddities.clone()].concat(),
            steps: parameter.steps,
        }
    }
}

/// The record of a study of two parameters, without its samples.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapSweep<'a> {
    /// What is asked; absent of impacts.
    #[serde(skip_serializing_if = "Aspect::is_impact")]
    #[cfg_attr(feature = "schema", schemars(with = "Option<Aspect>"))]
    pub question: Aspect,
    /// The parameters.
    pub parameters: Vec<&'a str>,
    /// The regions.
    pub regions: Vec<MapRegion<'a>>,
    /// The borders between them.
    pub borders: &'a [BorderCurve],
    /// Limits of the search, and what is odd about the states, as sentences.
    pub notes: Vec<String>,
    /// How many samples there are.
    #[serde(skip)]
    samples: usize,
}

/// Where one set of outcomes is valid.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MapRegion<'a> {
    /// Its letter.
    pub letter: String,
    /// Its outcomes.
    #[serde(flatten)]
    pub happening: Happening<'a>,
    /// The part of the ranges that it covers.
    pub share: f64,
    /// Closed loops of points, in the order of the parameters, with the region on their left (the second parameter up);
    /// holes run the other way.
    pub loops: &'a [Vec<[f64; 2]>],
}

impl<'a> MapSweep<'a> {
    /// Creates the record of the `map` of a study.
    pub fn new(study: &'a Study, map: &'a Map) -> Self {
        let parameters = study.parameters();
        let whole: f64 = parameters.iter().map(Parameter::range).product();
        let region = |(kind, area): (usize, &'a Area)| MapRegion {
            letter: letter(kind),
            happening: Happening::of(study.question(), &area.regime, area.verdict, area.refused.as_ref()),
            share: area.loops.iter().map(|points| surface(points)).sum::<f64>() / whole,
            loops: &area.loops,
        };
        let contacts = map.areas.iter().map(|area| area.regime.contacts().len()).max().unwrap_or(0);
        let mut notes = not_guaranteed(contacts, map.dependent);
        if contacts > 0 {
            notes.push(format!(
                "curves are traced along the lines of a grid of at least {CELLS} by {CELLS} cells: an area that lies within one of its \
             cells is not found"
            ));
        }
        notes.extend_from_slice(&map.oddities);
        Self {
            question: study.question(),
            parameters: parameters.iter().map(|parameter| parameter.name.as_str()).collect(),
            regions: map.areas.iter().enumerate().map(region).collect(),
            borders: &map.curves,
            notes,
            samples: parameters.iter().map(|parameter| parameter.steps).product(),
        }
    }
}

/// Returns the area of a loop, negative if it runs clockwise.
fn surface(points: &[[f64; 2]]) -> f64 {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

impl<'a> Happening<'a> {
    /// Describes a regime, with the verdict inside it, or with the reason why its states are refused.
    pub(crate) fn of(
        question: Aspect,
        regime: &'a Regime,
        verdict: Option<Verdict>,
        refused: Option<&'a Error>,
    ) -> Self {
        let undecided = match regime {
            Regime::Answered { undecided, .. } if !undecided.is_empty() => Some(&undecided[..]),
            _ => None,
        };
        let (contacts, outcomes) = (regime.outcomes().map(|_| regime.contacts()), regime.outcomes());
        let has_depth = refused.is_some_and(|error| matches!(error.reason(), Reason::Penetration { .. }));
        Self { question, contacts, verdict, outcomes, undecided, error: refused.map(ErrorObject::new), has_depth }
    }
}

/// Returns notes on what a search of regions with this many contacts may have missed: more if these are `dependent`.
fn not_guaranteed(contacts: usize, dependent: bool) -> Vec<String> {
    if contacts == 0 {
        return Vec::new();
    }
    let exact = "borders are right to 1e-12 of the range, but that no region is missing is not guaranteed";
    if contacts > WATCHED_CONTACTS {
        return vec![format!(
            "{exact}: with more than {WATCHED_CONTACTS} contacts, regions that lie between two samples of the same outcomes are \
             not searched for"
        )];
    }
    let mut notes = vec![format!(
        "{exact}: between two samples of the same outcomes a thinner region is found where an inequality of some combination \
         turns or comes near zero, and missed where that happens more often than the samples show; more steps leave less \
         room for it"
    )];
    if dependent {
        notes.push(
            "contacts depend on each other: combinations without a unique solution are not followed between samples"
                .into(),
        );
    }
    notes
}
