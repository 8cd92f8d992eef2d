//! What holds coordinates together: loops, and mimic joints. Every expectation comes from `support::mechanism`, which
//! knows nothing of the crate, or from paper.

mod command;
mod five_bar;
mod four_bar;
mod mimic_joints;
mod redundant;
mod refusals;
mod singular;

use crate::support::impact;
use heelstrike::pipeline::{Impact, Matrices, Options};
use heelstrike::{Result, Robot};
use nalgebra::{DMatrix, DVector};
use serde_json::Value;

fn try_impact(robot: &Robot, state: &Value) -> Result<Box<Impact>> {
    impact::try_impact(robot, Options { matrices: true, ..Options::default() }, state)
}

fn impact(robot: &Robot, state: &Value) -> Box<Impact> {
    try_impact(robot, state).unwrap_or_else(|error| panic!("{error} {:?}\n{state}", error.remedy()))
}

fn matrices(impact: &Impact) -> &Matrices {
    impact.matrices.as_ref().expect("asked for")
}

fn flat(vectors: &[[f64; 2]]) -> DVector<f64> {
    DVector::from_vec(vectors.concat())
}

/// Asserts that both agree to `parts` eps of the expected one's largest entry.
#[track_caller]
fn assert_near(found: &[Vec<f64>], expected: &DMatrix<f64>, parts: f64) {
    let found = crate::support::scaled::matrix(found);
    assert_eq!(found.shape(), expected.shape());
    let error = (&found - expected).amax() / expected.amax();
    assert!(error <= parts * f64::EPSILON, "{error:e}\n{found}\n{expected}");
}
