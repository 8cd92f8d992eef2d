//! A state as JSON in the format from which it is read, and whether its outcomes hold on the box of its uncertainty.

use crate::pipeline::robust::Robustness;
use crate::robot::Base;
use crate::state::{ByLink, Ground, LinkPoint, Named, SpringEnd, State, Uncertainty, VirtualSpring};
use crate::{Friction, Mode, Result, Robot, Verdict};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use serde_json::value::{RawValue, to_raw_value};
use serde_json::{Value, json};
use std::borrow::Cow;

impl State {
    /// Returns the state as the JSON object that [`State::from_json`] reads, without the fields that follow from
    /// others.
    ///
    /// # Errors
    /// Returns an error for what [`Pipeline::impact`](crate::Pipeline::impact) refuses of a state of `robot` before any
    /// work: indices that the robot does not have, wrong lengths and numbers out of range.
    pub fn to_json(&self, robot: &Robot) -> Result<String> {
        self.check(robot)?;
        // This cannot fail, because all keys of a state are strings.
        Ok(serde_json::to_string(&StateRecord { robot, state: self }).unwrap_or_default())
    }
}

/// Returns the state as JSON, for a field of a result; `None` if it is no state of `robot`.
pub(super) fn raw_state(robot: &Robot, state: &State) -> Option<Box<RawValue>> {
    state.check(robot).ok().and_then(|()| to_raw_value(&StateRecord { robot, state }).ok())
}

/// A state that is written with the names of its robot's links and joints.
struct StateRecord<'a> {
    robot: &'a Robot,
    state: &'a State,
}

impl StateRecord<'_> {
    fn coordinates(&self, values: &[f64]) -> Named<Named> {
        let mut named = self.robot.coordinates().map(str::to_owned).zip(values.iter().copied());
        // With a stance, x and z of the base follow from the rest.
        let follow = if self.state.scene.stance.is_some() { 2 } else { 0 };
        let base: Vec<_> = named.by_ref().take(self.robot.base_dofs()).skip(follow).collect();
        let base = (!base.is_empty()).then(|| ("base".to_owned(), base.into_iter().collect()));
        base.into_iter().chain([("joints".to_owned(), named.collect())]).collect()
    }

    fn by_link<T: Copy>(&self, values: &ByLink<T>, write: impl Fn(T) -> Value) -> Value {
        match values.default {
            Some(everywhere) if values.links.is_empty() => write(everywhere),
            default => {
                let links = values.links.iter().map(|(&link, &value)| (self.link(link).to_owned(), write(value)));
                default.map(|value| ("default".to_owned(), write(value))).into_iter().chain(links).collect()
            }
        }
    }

    fn link(&self, link: usize) -> &str {
        &self.robot.links[link].name
    }

    /// Names the values of all joints, followed by those of the mimic joints.
    fn by_joint(&self, values: &[f64]) -> Named {
        let mimic = self.robot.mimic_joints.iter().map(|mimic| &mimic.joint.name);
        let names = self.robot.joints.iter().map(|joint| &joint.name).chain(mimic);
        names.cloned().zip(values.iter().copied()).collect()
    }

    fn point(&self, point: LinkPoint) -> Value {
        json!({"link": self.link(point.link), "offset": point.offset})
    }

    fn spring(&self, VirtualSpring { a, b, laws: [x, z, pitch] }: &VirtualSpring) -> Value {
        let b = match *b {
            SpringEnd::Link(point) => self.point(point),
            SpringEnd::World(place) => json!({"world": place}),
        };
        json!({
            "a": self.point(*a),
            "b": b,
            "stiffness": [x.stiffness, z.stiffness],
            "damping": [x.damping, z.damping],
            "target": [x.target, z.target],
            "force": [x.constant, z.constant],
            "pitch": {"stiffness": pitch.stiffness, "damping": pitch.damping, "target": pitch.target},
            "moment": pitch.constant,
        })
    }

    fn uncertainty(&self, uncertainty: &Uncertainty) -> Value {
        let Uncertainty { position, velocity, friction, rotor_inertia } = uncertainty;
        let half_widths = |values: &[f64], named: &dyn Fn(&[f64]) -> Value| match values {
            [width, rest @ ..] if rest.iter().any(|other| other != width) => named(values),
            _ => json!(values.first().unwrap_or(&0.0)),
        };
        json!({
            "position": half_widths(position, &|values| json!(self.coordinates(values))),
            "velocity": half_widths(velocity, &|values| json!(self.coordinates(values))),
            "friction": self.by_link(friction, |width| json!(width)),
            "rotor_inertia": half_widths(rotor_inertia, &|values| json!(self.by_joint(values))),
        })
    }
}

impl Serialize for StateRecord<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let State { id, position, velocity, scene, uncertainty } = self.state;
        let mut map = serializer.serialize_map(None)?;
        entry(&mut map, "id", id.is_some(), id)?;
        map.serialize_entry("position", &self.coordinates(position))?;
        map.serialize_entry("velocity", &self.coordinates(velocity))?;
        let friction = self.by_link(&scene.friction, |friction| match friction {
            Friction::Finite(mu) => json!(mu),
            Friction::Infinite => json!("infinite"),
        });
        entry(&mut map, "friction", scene.friction != ByLink::default(), &friction)?;
        let restitution = self.by_link(&scene.restitution, |value| json!(value));
        entry(&mut map, "restitution", scene.restitution != ByLink::default(), &restitution)?;
        let ground = match &scene.ground {
            Ground::Slope(slope) => json!({"slope": slope}),
            Ground::Profile(profile) => json!({"profile": profile.points()}),
        };
        entry(&mut map, "ground", !matches!(scene.ground, Ground::Slope(0.0)), &ground)?;
        let stance = scene.stance.map(|stance| self.link(stance));
        entry(&mut map, "stance", stance.is_some(), &stance)?;
        // Without the field, a reader that places states by default would move the base.
        let is_placed = self.robot.base == Base::Floating && scene.stance.is_none();
        entry(&mut map, "place", is_placed, if scene.place_lowest { &"lowest" } else { &"given" })?;
        let braked: Vec<_> = scene.braked.iter().map(|&joint| &self.robot.joints[joint].name).collect();
        entry(&mut map, "held", !braked.is_empty(), &braked)?;
        let rotors = self.by_joint(&scene.rotor_inertia);
        entry(&mut map, "rotor_inertia", !scene.rotor_inertia.is_empty(), &rotors)?;
        let contacts = scene.contacts.iter().flatten().map(
            |contact| json!({"link": self.link(contact.link), "offset": contact.offset, "radius": contact.radius}),
        );
        entry(&mut map, "contacts", scene.contacts.is_some(), &contacts.collect::<Vec<_>>())?;
        let loops = scene.loops.iter().map(|pair| json!({"a": self.point(pair.a), "b": self.point(pair.b)}));
        // Without the field, a reader would close its default loops.
        map.serialize_entry("loops", &loops.collect::<Vec<_>>())?;
        let uncertainty = uncertainty.as_ref().map(|uncertainty| self.uncertainty(uncertainty));
        entry(&mut map, "uncertainty", uncertainty.is_some(), &uncertainty)?;
        let impulses = scene.impulses.iter().map(
            |applied| json!({"link": self.link(applied.link), "offset": applied.offset, "vector": applied.vector}),
        );
        entry(&mut map, "gravity", scene.gravity.is_some(), &scene.gravity)?;
        entry(&mut map, "torque", !scene.torque.is_empty(), &self.by_joint(&scene.torque))?;
        let springs: Vec<_> = scene.springs.iter().map(|spring| self.spring(spring)).collect();
        entry(&mut map, "virtual", !springs.is_empty(), &springs)?;
        entry(&mut map, "impulse", !scene.impulses.is_empty(), &impulses.collect::<Vec<_>>())?;
        map.end()
    }
}

fn entry<M: SerializeMap>(
    map: &mut M,
    name: &str,
    given: bool,
    value: &impl Serialize,
) -> std::result::Result<(), M::Error> {
    if given { map.serialize_entry(name, value) } else { Ok(()) }
}

/// Whether every state of the box has the same outcomes, as lists of modes; `"unknown"` without a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(inline, extend("enum" = [true, false, "unknown"])))]
#[serde(into = "Value", try_from = "Value")]
pub struct HoldsRecord(pub Option<bool>);

impl From<HoldsRecord> for Value {
    fn from(holds: HoldsRecord) -> Self {
        holds.0.map_or("unknown".into(), Value::Bool)
    }
}

impl TryFrom<Value> for HoldsRecord {
    type Error = &'static str;

    fn try_from(value: Value) -> std::result::Result<Self, Self::Error> {
        let is_known = value.is_boolean() || value == "unknown";
        is_known.then_some(Self(value.as_bool())).ok_or("expected true, false or \"unknown\"")
    }
}

impl From<&Robustness> for HoldsRecord {
    fn from(holds: &Robustness) -> Self {
        Self(match holds {
            Robustness::Everywhere => Some(true),
            Robustness::Not(_) => Some(false),
            Robustness::Unknown => None,
        })
    }
}

/// A state of the box with other outcomes.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Counterexample")]
pub struct CounterexampleRecord<'a> {
    /// The state as it is read, with the contacts by name.
    #[cfg_attr(feature = "schema", schemars(schema_with = "any_object"))]
    pub state: Box<RawValue>,
    /// Its verdict.
    pub verdict: Verdict,
    /// Its outcomes' lists of modes.
    pub outcomes: Cow<'a, [Vec<Mode>]>,
}

impl<'a> CounterexampleRecord<'a> {
    /// Returns the counterexample in what was found about a state of `robot`; `None` if there is none.
    pub fn of(robot: &'a Robot, holds: &'a Robustness) -> Option<Self> {
        let Robustness::Not(found) = holds else { return None };
        let state = raw_state(robot, &found.state)?;
        Some(Self { state, verdict: found.verdict, outcomes: Cow::Borrowed(&found.outcomes) })
    }
}

/// The schema of any object: states have a schema of their own.
#[cfg(feature = "schema")]
pub(super) fn any_object(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    schemars::json_schema!({"type": "object"})
}
