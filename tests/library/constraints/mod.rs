//! Loops and mimic joints. Every expectation comes from `support::mechanism`, which does not use the crate, or is
//! worked out by hand.

mod command;
mod five_bar;
mod four_bar;
mod mimic_joints;
mod redundant;
mod refusals;
mod singular;

use crate::support::impact::{self, outcomes, velocities_after};
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

/// Asserts that both agree to `parts` eps of the largest expected entry.
#[track_caller]
fn assert_near(found: &[Vec<f64>], expected: &DMatrix<f64>, parts: f64) {
    let found = crate::support::scaled::matrix(found);
    assert_eq!(found.shape(), expected.shape());
    let error = (&found - expected).amax() / expected.amax();
    assert!(error <= parts * f64::EPSILON, "{error:e}\n{found}\n{expected}");
}

/// Asserts that M, J, G and the kinetic energy are those of `mass` and `jacobian`, and that impulses change `v`
/// accordingly. `roundings` is the tolerance of M and J in eps.
#[track_caller]
pub fn assert_struck(found: &Impact, mass: &DMatrix<f64>, jacobian: &DMatrix<f64>, v: &DVector<f64>, roundings: f64) {
    let matrices = matrices(found);
    assert_near(&matrices.mass_matrix, mass, roundings);
    assert_near(&matrices.contact_jacobian, jacobian, roundings);
    let inverse = mass.clone().try_inverse().expect("positive definite");
    assert_near(&matrices.delassus, &(jacobian * &inverse * jacobian.transpose()), 10.0 * roundings);
    let energy = 0.5 * v.dot(&(mass * v));
    assert!((found.kinetic_energy - energy).abs() <= roundings * f64::EPSILON * energy);
    assert!(!outcomes(found).is_empty());
    for (outcome, after) in outcomes(found).iter().zip(velocities_after(found)) {
        let expected = v + &inverse * jacobian.transpose() * flat(&outcome.impulse);
        let (error, size) = ((DVector::from_vec(after) - &expected).amax(), expected.amax().max(v.amax()));
        assert!(error <= 100.0 * roundings * f64::EPSILON * size, "{error:e} of {size:e}");
    }
}
