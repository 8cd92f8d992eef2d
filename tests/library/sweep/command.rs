//! Runs `heelstrike sweep` on a study and reads what it writes; the studies of the paper's models, each pivoting about
//! its trailing foot at 1 rad/s, against the leg angle `alpha`.

use crate::support::command::{Run, heelstrike_reads};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
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

/// From where to where the leg angle goes; at 0 both feet are one point.
pub const RANGE: [f64; 2] = [0.001, 1.57];

/// Two straight legs; with `inertia`, that of both legs.
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

/// RAMone: knees at a right angle, the main body upright.
pub fn kneed() -> Value {
    let mut study = straight(None);
    study["constants"] = json!({"upper": 0.2, "lower": 0.2385, "knee": "-pi/2", "bend": "atan2(lower, upper)"});
    study["state"]["position"] = json!({"joints": {
        "left_hip": "bend + alpha", "left_knee": "knee", "right_hip": "bend - alpha", "right_knee": "knee",
    }});
    study["state"]["stance"] = json!("left_foot");
    study
}
