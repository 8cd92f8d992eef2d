//! Runs `heelstrike sweep` on a study and reads what it writes.

use crate::support::command::{Run, heelstrike_reads};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeSet;

/// What is written as JSON, as far as the tests read it.
#[derive(Debug, Clone, Deserialize)]
pub struct Sweep {
    pub regions: Vec<Region>,
    pub borders: Vec<Border>,
    pub samples: Vec<Value>,
}

#[derive(Debug, Clone, Deserialize)]
pub struct Region {
    pub letter: String,
    pub from: f64,
    pub to: f64,
    pub contacts: Option<Vec<String>>,
    pub outcomes: Option<Vec<Vec<String>>>,
}

#[derive(Debug, Clone, Deserialize)]
pub struct Border {
    pub at: f64,
    pub turns: Vec<Turn>,
    #[serde(default)]
    pub opening: Vec<String>,
    #[serde(default)]
    pub closing: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
pub struct Turn {
    pub contact: String,
    pub inequality: String,
    pub modes: Vec<String>,
    pub valid: String,
}

/// Runs `heelstrike sweep ROBOT -` with more arguments; the study goes to standard input.
pub fn run(robot: &str, study: &Value, arguments: &[&str]) -> Run {
    heelstrike_reads(&[&["sweep", robot, "-"], arguments].concat(), study.to_string())
}

/// What is written of a study that is answered everywhere.
pub fn written<T: DeserializeOwned>(robot: &str, study: &Value, arguments: &[&str]) -> T {
    let Run { status, stdout, stderr, .. } = run(robot, study, &[&["--format", "json"], arguments].concat());
    assert_eq!(status, 0, "{study}\n{stderr}");
    serde_json::from_str(&stdout).unwrap_or_else(|error| panic!("{error}: {stdout}"))
}

/// The regions, borders and samples of a study that is answered everywhere.
pub fn sweep(robot: &str, study: &Value) -> Sweep {
    written(robot, study, &[])
}

impl Region {
    /// The outcomes as a set, each with its modes joined by slashes.
    pub fn set(&self) -> BTreeSet<String> {
        self.outcomes.iter().flatten().map(|modes| modes.join("/")).collect()
    }
}

/// Checks where the regions begin, the first one aside, to `within`, and the set of outcomes of each, in which a bar
/// parts the outcomes.
pub fn assert_begins(place: &str, sweep: &Sweep, expected: &[(f64, &str)], within: f64) {
    let found: Vec<_> = sweep.regions.iter().map(|region| (region.from, region.set())).collect();
    assert_eq!(found.len(), expected.len(), "{place}: {found:#?}");
    for (at, ((from, set), (begin, outcomes))) in found.iter().zip(expected).enumerate() {
        let should: BTreeSet<String> = outcomes.split('|').map(str::to_owned).collect();
        assert_eq!(*set, should, "{place}, region {at} from {from}");
        let off = (from - begin).abs();
        assert!(at == 0 || off <= within, "{place}, region {at}: {from} instead of {begin}, off by {off:.1e}");
    }
}
