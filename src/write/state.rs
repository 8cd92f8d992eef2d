//! A state in the format in which it is read.

use crate::Robot;
use crate::law::Friction;
use crate::state::{ByLink, Ground, LinkPoint, Named, State, Uncertainty};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};
use serde_json::{Value, json};

impl State {
    /// The state as the JSON object from which [`State::from_json`] reads it again.
    ///
    /// What a state leaves out when it is read, such as the base's x and z with a stance, is left out here, too.
    pub fn to_json(&self, robot: &Robot) -> String {
        // A state has no keys that are not strings, so that this cannot fail.
        serde_json::to_string(&StateRecord { robot, state: self }).unwrap_or_default()
    }
}

/// A state that is written with the names of its robot.
pub(super) struct StateRecord<'a> {
    pub robot: &'a Robot,
    pub state: &'a State,
}

impl StateRecord<'_> {
    fn coordinates(&self, values: &[f64]) -> Named<Named> {
        let mut named = self.robot.coordinates().map(str::to_owned).zip(values.iter().copied());
        // With a stance the base's x and z follow from the rest.
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

    /// Values of all joints, and then of the mimic joints.
    fn by_joint(&self, values: &[f64]) -> Named {
        let mimic = self.robot.mimic_joints.iter().map(|mimic| &mimic.joint.name);
        let names = self.robot.joints.iter().map(|joint| &joint.name).chain(mimic);
        names.cloned().zip(values.iter().copied()).collect()
    }

    fn point(&self, point: LinkPoint) -> Value {
        json!({"link": self.link(point.link), "offset": point.offset})
    }

    fn uncertainty(&self, uncertainty: &Uncertainty) -> Value {
        let Uncertainty { position, velocity, friction, rotor_inertia } = uncertainty;
        let same = |values: &[f64]| values.windows(2).all(|pair| pair[0] == pair[1]).then(|| values.first().copied());
        let half_widths = |values: &[f64]| match same(values) {
            Some(width) => json!(width.unwrap_or(0.0)),
            None => json!(self.coordinates(values)),
        };
        let rotors = match same(rotor_inertia) {
            Some(width) => json!(width.unwrap_or(0.0)),
            None => json!(self.by_joint(rotor_inertia)),
        };
        json!({
            "position": half_widths(position), "velocity": half_widths(velocity),
            "friction": self.by_link(friction, |width| json!(width)), "rotor_inertia": rotors,
        })
    }
}

impl Serialize for StateRecord<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let State { id, position, velocity, scene, uncertainty } = self.state;
        let mut map = serializer.serialize_map(None)?;
        if let Some(id) = id {
            map.serialize_entry("id", id)?;
        }
        map.serialize_entry("position", &self.coordinates(position))?;
        map.serialize_entry("velocity", &self.coordinates(velocity))?;
        if scene.friction != ByLink::default() {
            map.serialize_entry("friction", &self.by_link(&scene.friction, friction))?;
        }
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
            let held = scene.held.iter().map(|&joint| &self.robot.joints[joint].name);
            map.serialize_entry("held", &held.collect::<Vec<_>>())?;
        }
        if !scene.rotor_inertia.is_empty() {
            map.serialize_entry("rotor_inertia", &self.by_joint(&scene.rotor_inertia))?;
        }
        if let Some(contacts) = &scene.contacts {
            let contacts = contacts.iter().map(
                |contact| json!({"link": self.link(contact.link), "offset": contact.offset, "radius": contact.radius}),
            );
            map.serialize_entry("contacts", &contacts.collect::<Vec<_>>())?;
        }
        if !scene.loops.is_empty() {
            let loops = scene.loops.iter().map(|own| json!({"a": self.point(own.a), "b": self.point(own.b)}));
            map.serialize_entry("loops", &loops.collect::<Vec<_>>())?;
        }
        if let Some(uncertainty) = uncertainty {
            map.serialize_entry("uncertainty", &self.uncertainty(uncertainty))?;
        }
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
