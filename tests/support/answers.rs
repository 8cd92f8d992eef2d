//! Runs the real binary on a stream of states or problems and reads its result lines strictly: a NaN (null) among the
//! numbers, a missing field or a line too few is a failure.

use std::collections::BTreeMap;

use super::command::heelstrike_reads;
use serde::Deserialize;
use serde_json::Value;

/// A result line, as far as the tests read it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default)]
pub struct Answer {
    pub id: Option<Value>,
    pub verdict: Option<String>,
    pub proven: bool,
    pub contacts: Vec<Contact>,
    pub outcomes: Vec<Outcome>,
    pub rejected: Vec<Rejected>,
    pub kinetic_energy: Option<f64>,
    pub index_sum: Option<i64>,
    pub rank: Option<usize>,
    pub coordinates: Vec<String>,
    pub mass_matrix: Vec<Vec<f64>>,
    pub contact_jacobian: Vec<Vec<f64>>,
    pub delassus: Vec<Vec<f64>>,
    pub error: Option<Value>,
}

/// A contact of a result.
#[derive(Debug, Clone, Deserialize)]
pub struct Contact {
    pub link: Option<String>,
    pub name: Option<String>,
    pub point: Option<[f64; 2]>,
    pub velocity_before: [f64; 2],
}

/// An outcome of a result.
#[derive(Debug, Clone, Deserialize)]
pub struct Outcome {
    pub modes: Vec<String>,
    pub impulse: Vec<[f64; 2]>,
    pub velocity_after: Vec<[f64; 2]>,
    pub impulse_unique: bool,
    pub impulse_range: Option<Vec<[[Option<f64>; 2]; 2]>>,
    pub index: Option<i64>,
    pub margin: Option<f64>,
    pub border: Option<Value>,
    #[serde(default)]
    pub family: bool,
    pub proven: bool,
    pub energy_loss: f64,
    pub base_velocity_after: Option<BTreeMap<String, f64>>,
    pub joint_velocity_after: Option<BTreeMap<String, f64>>,
}

/// A rejected combination of modes; without numbers where it has no solution.
#[derive(Debug, Clone, Deserialize)]
pub struct Rejected {
    pub modes: Vec<String>,
    pub because: String,
    pub impulse: Option<Vec<[f64; 2]>>,
    pub velocity_after: Option<Vec<[f64; 2]>>,
}

/// Runs `heelstrike` with the arguments and gives it the inputs on standard input, one line each: the results in their
/// order, what cannot be read as a result as the error.
pub fn answers(arguments: &[&str], inputs: &[Value]) -> Vec<Result<Answer, String>> {
    let stream: String = inputs.iter().map(|input| format!("{input}\n")).collect();
    let run = heelstrike_reads(arguments, stream);
    assert!(matches!(run.status, 0 | 1), "{arguments:?} ended with {}:\n{}", run.status, run.stderr);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert_eq!(lines.len(), inputs.len(), "{arguments:?}: a line for each input\n{}", run.stderr);
    let answers = lines.iter().zip(inputs).map(|(line, input)| {
        let answer: Answer = serde_json::from_str(line).map_err(|error| format!("{error} in {line}"))?;
        match &answer.error {
            Some(error) => Err(format!("refused: {error}")),
            None if answer.id.as_ref() != input.get("id") => Err(format!("answers another id: {:?}", answer.id)),
            None => Ok(answer),
        }
    });
    answers.collect()
}
