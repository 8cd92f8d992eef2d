//! Runs `heelstrike sweep` on a study and reads its output; the studies of the paper's models over the leg angle
//! `alpha`, each pivoting about its trailing foot at 1 rad/s.

use crate::support::command::{Run, heelstrike_reads};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// The part of the JSON output that the tests read.
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
    pub verdict: Option<String>,
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

/// The JSON output for a study that is answered everywhere.
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

/// Asserts where the regions begin, except for the first one, to `within`, and the set of outcomes of each; a bar
/// separates outcomes.
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

/// The range of the leg angle; at 0 both feet coincide.
pub const RANGE: [f64; 2] = [0.001, 1.57];

/// The study of a walker with two straight legs; `inertia` replaces the moment of inertia of both.
pub fn straight(inertia: Option<f64>) -> Value {
    let mut study = json!({
        "parameters": {"alpha": {"from": RANGE[0], "to": RANGE[1], "steps": 50}},
        "state": {
            "position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}},
            "velocity": {"base": {"pitch": -1}},
            "stance": "left_leg",
            "friction": "infinite",
        },
    });
    if let Some(inertia) = inertia {
        study["constants"] = json!({"j": inertia});
        study["robot"] = json!({"links": {"left_leg": {"inertia": "j"}, "right_leg": {"inertia": "j"}}});
    }
    study
}

/// The study of RAMone with its knees at a right angle and its main body upright.
pub fn kneed() -> Value {
    let mut study = straight(None);
    study["constants"] = json!({"upper": 0.2, "lower": 0.2385, "knee": "-pi/2", "bend": "atan2(lower, upper)"});
    study["state"]["position"] = json!({"joints": {
        "left_hip": "bend + alpha", "left_knee": "knee", "right_hip": "bend - alpha", "right_knee": "knee",
    }});
    study["state"]["stance"] = json!("left_foot");
    study
}
