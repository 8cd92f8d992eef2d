//! One pre-impact state: coordinates, velocities and scene, resolved against a robot.

mod ground;
mod scene;
mod uncertainty;

pub use ground::{Ground, Profile};
pub use scene::{AppliedImpulse, ByLink, LinkPoint, NamedContact, NamedLoop, Scene};
pub use uncertainty::Uncertainty;

use crate::law::Friction;

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
