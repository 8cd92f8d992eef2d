//! What every method makes of a case: error against the reference, and run time.

use super::number::Number;
use super::pose::{Computation, Factorization, Pose};
use super::reference::{Reference, distance, relative, worst};
use super::suite::Subject;
use super::timing::{Budget, Spread};
use crate::scalar::Interval;
use crate::impact::enumerate::Tableau;
use crate::impact::problem::Entry;
use crate::impact::{Analysis, ContactProblem, Scratch, Verdict};
use crate::pipeline::{Impact, Options, Pipeline};
use crate::planar::Vector;
use crate::robot::Robot;
use crate::scalar::Real;
use crate::state::State;
use crate::{Error, Result};
use serde::Serialize;

/// One case, looked at by every method.
#[derive(Debug, Clone, Serialize)]
pub struct Study {
    /// What the case is called.
    pub name: String,
    /// Coordinates of the robot; none of a problem given as matrices.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coordinates: Option<usize>,
    /// Closed contacts.
    pub contacts: usize,
    /// The answer; none where the case was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answer: Option<Answer>,
    /// Why the case was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// How large rounding grows.
    pub condition: Condition,
    /// What each method makes of it; nothing of a refused case.
    pub methods: Vec<Method>,
}

/// The answer in short.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// The verdict.
    pub verdict: Verdict,
    /// Number of outcomes.
    pub outcomes: usize,
    /// Whether every sign is shown.
    pub proven: bool,
    /// The smallest margin of an outcome.
    pub margin: Option<f64>,
    /// Sum of indices.
    pub index_sum: Option<i32>,
    /// Rank of G.
    pub rank: usize,
}

/// Condition numbers of matrices scaled to a unit diagonal.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Condition {
    /// Of M; none without a robot.
    pub mass_matrix: Option<f64>,
    /// Of G; none where it is singular or not known.
    pub delassus: Option<f64>,
}

/// One way to G, or to the whole answer.
#[derive(Debug, Clone, Serialize)]
pub struct Method {
    /// The kind of number.
    pub number: &'static str,
    /// How G is found; none for the whole answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factorization: Option<Factorization>,
    /// What is timed.
    pub work: Work,
    /// Run time; none where it was not measured.
    pub time: Option<Spread>,
    /// How far from the reference; none where the method failed.
    pub error: Option<Errors>,
}

/// What is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Work {
    /// From the f64 state to G.
    Delassus,
    /// From the f64 state, or from given matrices, to the verdict.
    Answer,
}

/// Largest errors, free of units (see [`Reference`]).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Of M; none where the method has none.
    pub mass_matrix: Option<f64>,
    /// Of G; none where it was given.
    pub delassus: Option<f64>,
    /// Of the outcomes' impulses and velocities; none where there is none, or where they are not unique.
    pub outcome: Option<f64>,
}
