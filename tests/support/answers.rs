//! Runs the real binary on a stream of states or problems and parses its result lines strictly: a NaN (`null`) among
//! the numbers, a missing field or a missing line fails the test.

use super::command::heelstrike_reads;
use heelstrike::state::Named;
use heelstrike::{Outcome, Report};
use serde_json::Value;

/// A result line with its outcomes.
pub struct Answer {
    pub outcomes: Vec<Outcome>,
    /// All other fields; its own `outcomes` is `None`.
    pub report: Report<'static>,
}

impl Answer {
    /// Velocities of all contacts before the impact, tangential and normal in turn.
    pub fn velocity_before(&self) -> Vec<f64> {
        self.report.contacts.iter().flat_map(|contact| contact.velocity_before).collect()
    }
}

/// Names and values of a robot's velocity after the impact, those of the base first.
pub fn named_velocity(outcome: &Outcome) -> (Vec<&str>, Vec<f64>) {
    let parts = [&outcome.base_velocity_after, &outcome.joint_velocity_after];
    parts.into_iter().flatten().flat_map(Named::iter).map(|(name, &value)| (name, value)).unzip()
}

/// Runs `heelstrike` with one input per line on standard input and returns the results in the order of the inputs.
/// Panics if an input was refused.
pub fn answers(arguments: &[&str], inputs: &[Value]) -> Vec<Answer> {
    let stream: String = inputs.iter().map(|input| format!("{input}\n")).collect();
    let run = heelstrike_reads(arguments, stream).well();
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert_eq!(lines.len(), inputs.len(), "{arguments:?}: a line for each input\n{}", run.stderr);
    let answers = lines.iter().zip(inputs).map(|(line, input)| {
        let fail = |why: &str| -> ! { panic!("{arguments:?}: {why} in {line}\n{input}") };
        let mut report: Report = serde_json::from_str(line).unwrap_or_else(|error| fail(&error.to_string()));
        let Some(outcomes) = report.outcomes.take() else { fail("no outcomes") };
        if report.id.as_deref() != input.get("id") || report.error.is_some() {
            fail("another id, or an error");
        }
        Answer { outcomes: outcomes.into_owned(), report }
    });
    answers.collect()
}
