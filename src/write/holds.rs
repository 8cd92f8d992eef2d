//! Whether a verdict holds on the box of its state's uncertainty, and a state where it does not.

use super::NamedVelocities;
use crate::Robot;
use crate::impact::Verdict;
use crate::law::{Friction, Mode};
use crate::pipeline::robust;
use crate::state::State;
use crate::state::{ByLink, Ground};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// `true`, `false` or `"unknown"`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Holds {
    /// Every state of the box has the same outcomes, as lists of modes.
    Yes,
    /// Some state has others.
    No,
    /// Neither was shown.
    Unknown,
}

impl Serialize for Holds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Yes => serializer.serialize_bool(true),
            Self::No => serializer.serialize_bool(false),
            Self::Unknown => serializer.serialize_str("unknown"),
        }
    }
}

impl From<&robust::Robustness> for Holds {
    fn from(holds: &robust::Robustness) -> Self {
        match holds {
            robust::Robustness::Everywhere => Self::Yes,
            robust::Robustness::Not(_) => Self::No,
            robust::Robustness::Unknown => Self::Unknown,
        }
    }
}

/// A state of the box with other outcomes.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Counterexample<'a> {
    /// The state as it is read, with the contacts by name.
    pub state: StateFields<'a>,
    /// Its verdict.
    pub verdict: Verdict,
    /// Its outcomes' lists of modes.
    pub outcomes: &'a [Vec<Mode>],
}

impl<'a> Counterexample<'a> {
    /// The counterexample of what was found about a state of `robot`; none where there is none.
    pub fn of(robot: &'a Robot, holds: &'a robust::Robustness) -> Option<Self> {
        let robust::Robustness::Not(found) = holds else { return None };
        let state = StateFields { robot, state: &found.state };
        Some(Self { state, verdict: found.verdict, outcomes: &found.outcomes })
    }
}

/// A state in the format in which it is read.
#[derive(Debug, Clone, Copy)]
pub struct StateFields<'a> {
    robot: &'a Robot,
    state: &'a State,
}

impl StateFields<'_> {
    fn coordinates(&self, values: &[f64]) -> BTreeMap<&'static str, NamedVelocities<'_>> {
        let mut named = self.robot.coordinates().zip(values.iter().copied());
        // With a stance the base's x and z follow from the rest.
        let follow = if self.state.scene.stance.is_some() { 2 } else { 0 };
        let base: Vec<_> = named.by_ref().take(self.robot.base_dofs()).skip(follow).collect();
        let joints = ("joints", NamedVelocities(named.collect()));
        let base = (!base.is_empty()).then_some(("base", NamedVelocities(base)));
        base.into_iter().chain([joints]).collect()
    }

    fn by_link<T: Copy>(&self, values: &ByLink<T>, write: impl Fn(T) -> Value) -> Value {
        match values.default {
            Some(everywhere) if values.links.is_empty() => write(everywhere),
            default => {
                let links = values.links.iter().map(|&(link, value)| (self.link(link).to_owned(), write(value)));
                default.map(|value| ("default".to_owned(), write(value))).into_iter().chain(links).collect()
            }
        }
    }

    fn link(&self, link: usize) -> &str {
        &self.robot.links[link].name
    }
}

impl Serialize for StateFields<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let State { position, velocity, scene, .. } = self.state;
        let joint = |joint: usize| self.robot.joints[joint].name.as_str();
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("position", &self.coordinates(position))?;
        map.serialize_entry("velocity", &self.coordinates(velocity))?;
        map.serialize_entry("friction", &self.by_link(&scene.friction, friction))?;
        if scene.restitution != ByLink::default() {
            map.serialize_entry("restitution", &self.by_link(&scene.restitution, |value| json!(value)))?;
        }
        match &scene.ground {
            Ground::Slope(0.0) => {}
            Ground::Slope(slope) => map.serialize_entry("ground", &json!({"slope": slope}))?,
            Ground::Profile(profile) => map.serialize_entry("ground", &json!({"profile": profile.points()}))?,
        }
        if let Some(stance) = scene.stance {
            map.serialize_entry("stance", self.link(stance))?;
        }
        if !scene.held.is_empty() {
            map.serialize_entry("held", &scene.held.iter().map(|&held| joint(held)).collect::<Vec<_>>())?;
        }
        if !scene.rotor_inertia.is_empty() {
            let inertia = scene.rotor_inertia.iter().enumerate().map(|(at, &inertia)| (joint(at), inertia));
            map.serialize_entry("rotor_inertia", &NamedVelocities(inertia.collect()))?;
        }
        let contacts = scene.contacts.iter().flatten().map(
            |contact| json!({"link": self.link(contact.link), "offset": contact.offset, "radius": contact.radius}),
        );
        map.serialize_entry("contacts", &contacts.collect::<Vec<_>>())?;
        if !scene.impulses.is_empty() {
            let impulses = scene.impulses.iter().map(
                |applied| json!({"link": self.link(applied.link), "offset": applied.offset, "vector": applied.vector}),
            );
            map.serialize_entry("impulse", &impulses.collect::<Vec<_>>())?;
        }
        map.end()
    }
}

fn friction(friction: Friction) -> Value {
    match friction {
        Friction::Finite(mu) => json!(mu),
        Friction::Infinite => json!("infinite"),
    }
}
