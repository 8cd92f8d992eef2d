//! One pre-impact state: coordinates, velocities and scene, resolved against a robot.

pub(crate) mod read;
mod uncertainty;

pub use uncertainty::Uncertainty;

use crate::impact::Friction;
use crate::scene::{NamedLoop, Scene};
use crate::{Result, Robot, json};

/// A state just before the impact; every name in it is resolved to an index of its robot.
#[derive(Debug, Clone, Default)]
pub struct State {
    /// What the user calls it: a JSON string or number.
    pub id: Option<serde_json::Value>,
    /// q = [x, z, pitch, joints...] \[m, rad\]; with a stance x and z are placeholders until the base is placed.
    pub position: Vec<f64>,
    /// v = dq/dt \[m/s, rad/s\]; with a stance its x and z likewise.
    pub velocity: Vec<f64>,
    /// Everything else.
    pub scene: Scene,
    /// How far the numbers may be off; none where they are meant as they are.
    pub uncertainty: Option<Uncertainty>,
}

/// What a state takes from elsewhere where it is silent.
#[derive(Debug, Clone, Default)]
pub struct Defaults {
    /// Friction of every link to which the state gives none.
    pub friction: Option<Friction>,
    /// Loops of every state that gives none of its own.
    pub loops: Vec<NamedLoop>,
}

/// Reads loops of `robot` from a JSON list, as a state's field `loops` has it.
///
/// # Errors
/// Whatever is no such list; the error tells place, line and column in `text`.
pub fn loops_from_json(text: &str, robot: &Robot) -> Result<Vec<NamedLoop>> {
    let tree = json::Value::parse(text)?;
    read::loops(json::Node::root(&tree, text), robot)
}

impl State {
    /// Reads a state of `robot` from one JSON object; what it omits is 0, and its friction that of `defaults`.
    ///
    /// Whether every contact ends up with a friction is not known before the contacts are.
    ///
    /// # Errors
    /// Whatever is not a state of this robot: broken JSON, unknown or doubled fields and names, values of the wrong kind or
    /// outside their range, a base that is both placed and given. The error tells place, line and column in `text`.
    pub fn from_json(text: &str, robot: &Robot, defaults: &Defaults) -> Result<Self> {
        let tree = json::Value::parse(text)?;
        read::state(json::Node::root(&tree, text), robot, defaults)
    }

    /// The `id` in the text of a state that may be refused; none where none can be read.
    pub fn id_in(text: &str) -> Option<serde_json::Value> {
        json::id_in(text)
    }
}
