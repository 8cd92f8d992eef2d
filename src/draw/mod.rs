//! Pictures and pages of robots, impacts, sweeps and gaits.

#[cfg(feature = "plot")]
#[allow(missing_docs, reason = "names of colors, marks and strokes")]
pub mod plot;
#[cfg(feature = "plot")]
mod forward;
pub mod robot;
#[cfg(feature = "plot")]
pub mod sweep;
#[cfg(all(feature = "accuracy", feature = "plot"))]
mod accuracy;
#[cfg(feature = "plot")]
pub mod page;

#[cfg(feature = "plot")]
pub use forward::Forward;
#[cfg(feature = "plot")]
pub use plot::Picture;
pub use robot::Drawing;

use crate::impact::OpenCombinations;
use crate::pipeline::Aspect;
use crate::state::{NamedContact, State};
use crate::{Error, Impact, Outcome, Robot, Verdict};
use serde_json::Value;

/// A drawn state and its answer.
#[derive(Debug, Clone)]
pub struct Keyframe {
    /// The robot, its contacts and the ground; `None` if the state is refused.
    pub drawing: Option<Drawing>,
    /// The answer, or the reason why there is none.
    pub answer: Result<KeyframeAnswer, Error>,
    /// Notes about the input and the answer, as sentences.
    pub notes: Vec<String>,
}

/// The part of an answer that a keyframe shows.
#[derive(Debug, Clone)]
pub struct KeyframeAnswer {
    /// The question: the impact, or the forces in sustained contact.
    pub aspect: Aspect,
    /// The verdict.
    pub verdict: Verdict,
    /// Whether the list of outcomes is proven to be complete and correct.
    pub proven: bool,
    /// The outcomes.
    pub outcomes: Vec<Outcome>,
    /// The friction with which no contact would have to slide ([`Impact::friction_needed`]).
    pub friction_needed: Option<f64>,
    /// The number of undecided combinations, if the verdict is undecided.
    pub open: Option<OpenCombinations>,
}

/// A keyframe with the line, the id and the time of its state in the input.
#[derive(Debug, Clone)]
pub struct ListedKeyframe {
    /// The line on which the state begins, from 1.
    pub line: usize,
    /// The id of the state.
    pub id: Option<Value>,
    /// The time of the state \[s\].
    pub time: Option<f64>,
    /// The state and its answer.
    pub keyframe: Keyframe,
}

impl Keyframe {
    /// Creates the keyframe of a state and its answer. `feet` are added to the robot's own shapes.
    pub fn of_impact(robot: &Robot, feet: &[NamedContact], state: &State, impact: &Impact) -> Self {
        let answer = impact.analyzed().map(|analysis| KeyframeAnswer {
            aspect: impact.aspect(),
            verdict: analysis.verdict,
            proven: analysis.proven,
            outcomes: analysis.outcomes.clone(),
            friction_needed: impact.friction_needed,
            open: analysis.open,
        });
        let drawing = Some(Drawing::of_impact(robot, feet, state, impact));
        Self { drawing, answer, notes: impact.notes.clone() }
    }

    /// Mirrors the keyframe if forward is along -x.
    #[cfg(feature = "plot")]
    fn face(&mut self, forward: Forward) {
        self.drawing.iter_mut().for_each(|drawing| drawing.face(forward));
        self.answer.iter_mut().for_each(|answer| forward.outcomes(&mut answer.outcomes));
    }

    /// Creates the keyframe of a refused state.
    pub fn refused(error: Error) -> Self {
        Self { drawing: None, answer: Err(error), notes: Vec::new() }
    }
}
