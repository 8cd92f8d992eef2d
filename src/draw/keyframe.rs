//! A state as a page shows it: the robot where it is, and what may happen to it.

use super::Drawing;
use crate::Error;
use crate::impact::{Outcome, Verdict};
use crate::pipeline::Impact;
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::NamedContact;
use crate::state::State;
use serde_json::Value;

/// A state that a page can show.
#[derive(Debug, Clone)]
pub struct Keyframe {
    /// Where the robot is; none where the state is refused.
    pub pose: Option<Pose>,
    /// What happens, or why that cannot be told.
    pub answer: Result<Answer, Error>,
    /// What a reader should know, in whole sentences.
    pub notes: Vec<String>,
}

/// Where a robot is.
#[derive(Debug, Clone)]
pub struct Pose {
    /// The robot, its contacts and the ground.
    pub drawing: Drawing,
    /// The x axis of each body's frame, in the world.
    pub turns: Vec<Vector<f64>>,
}

/// What happens to a robot.
#[derive(Debug, Clone)]
pub struct Answer {
    /// In one word.
    pub verdict: Verdict,
    /// Whether the list of outcomes is shown to be complete and right.
    pub proven: bool,
    /// Every outcome.
    pub outcomes: Vec<Outcome>,
}

/// A state of a batch that a page can show.
#[derive(Debug, Clone)]
pub struct ListedKeyframe {
    /// The line on which it begins, from 1.
    pub line: usize,
    /// What the user calls it.
    pub id: Option<Value>,
    /// When it is \[s\].
    pub time: Option<f64>,
    /// What is shown of it.
    pub keyframe: Keyframe,
}

impl Keyframe {
    /// A state and its impact; `feet` are those beside the robot's own shapes.
    pub fn of_impact(robot: &Robot, feet: &[NamedContact], state: &State, impact: &Impact) -> Self {
        let turn = |body| impact.placement.turned(body, Vector::new(1.0, 0.0));
        let answer = impact.analysis.as_ref().map(|analysis| Answer {
            verdict: analysis.verdict,
            proven: analysis.proven,
            outcomes: analysis.outcomes.clone(),
        });
        Self {
            pose: Some(Pose {
                drawing: Drawing::of_impact(robot, feet, state, impact),
                turns: (0..robot.bodies.len()).map(turn).collect(),
            }),
            answer: answer.map_err(Error::clone),
            notes: impact.notes.clone(),
        }
    }

    /// A state that is refused.
    pub fn refused(error: Error) -> Self {
        Self { pose: None, answer: Err(error), notes: Vec::new() }
    }
}
