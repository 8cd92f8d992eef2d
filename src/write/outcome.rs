//! An outcome as it is written.

use crate::Robot;
use crate::impact::outcome::{self, Range};
use crate::law::{Inequality, Mode};
use crate::planar::{Pair, Vector};
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

/// A consistent combination of modes.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Outcome<'a> {
    /// One mode per contact.
    pub modes: &'a [Mode],
    /// Contact impulses, [tangential, normal] per contact \[N s\].
    pub impulse: &'a [Pair<f64>],
    /// Contact velocities after the impact, [tangential, normal] per contact \[m/s\].
    pub velocity_after: &'a [Pair<f64>],
    /// Velocity of the base after the impact; of a robot that is not bolted to the world.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_velocity_after: Option<NamedVelocities<'a>>,
    /// Rates of the joints after the impact, held ones too; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_velocity_after: Option<NamedVelocities<'a>>,
    /// Impulse on point a of each loop, [x, z] in the world \[N s\]; the opposite acts on b. Of a state with loops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub loop_impulse: Option<&'a [Vector<f64>]>,
    /// Kinetic energy that the contacts took \[J\].
    pub energy_loss: f64,
    /// False where other impulses give the same velocities.
    pub impulse_unique: bool,
    /// Least and greatest of every entry of `impulse`, null where it has no bound; where other impulses give the same
    /// velocities.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub impulse_range: Option<&'a [Pair<Range>]>,
    /// |L_t| / L_n of each sticking contact that is pressed on the ground; null for others.
    pub friction_needed: &'a [Option<f64>],
    /// Sign of det A; null on a border.
    pub index: Option<i8>,
    /// The smallest slack of the outcome's inequalities, free of units.
    pub margin: Option<f64>,
    /// What is exactly zero, and the lists of modes beyond; on a border only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border: Option<Border<'a>>,
    /// True, and only then present, of an end of a family: every velocity between both ends is an outcome.
    #[serde(skip_serializing_if = "is_false")]
    pub family: bool,
    /// Every sign is shown by an error bound.
    pub proven: bool,
    /// False, and only then present, where the combination is neither shown nor excluded.
    #[serde(skip_serializing_if = "is_true")]
    pub decided: bool,
}

/// Where an outcome turns into others.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Border<'a> {
    /// The impulse inequalities that are exactly zero.
    pub at_zero: Vec<AtZero<'a>>,
    /// The lists of modes beyond, each different in one contact; where several inequalities are zero, so are combinations.
    pub neighbours: &'a [Vec<Mode>],
}

/// An impulse inequality that is zero.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AtZero<'a> {
    /// The contact's name.
    pub contact: &'a str,
    /// What is zero there.
    #[cfg_attr(feature = "schema", schemars(with = "ZeroImpulse"))]
    pub inequality: Inequality,
}

/// The schema of an inequality that is zero on an outcome's border: a velocity of zero belongs to another outcome.
#[cfg(feature = "schema")]
struct ZeroImpulse;

#[cfg(feature = "schema")]
impl schemars::JsonSchema for ZeroImpulse {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Zero".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let all = Inequality::json_schema(generator);
        let named = |inequality| {
            let wanted = serde_json::json!(inequality);
            all.get("oneOf")?.as_array()?.iter().find(|known| known["const"] == wanted).cloned()
        };
        let known: Vec<serde_json::Value> = Inequality::OF_IMPULSES.into_iter().filter_map(named).collect();
        schemars::json_schema!({"description": "An impulse inequality that is zero.", "oneOf": known})
    }
}

/// Velocities by name, written as an object in the order of q.
#[derive(Debug, Clone)]
pub struct NamedVelocities<'a>(pub Vec<(&'a str, f64)>);

impl Serialize for NamedVelocities<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for (name, velocity) in &self.0 {
            map.serialize_entry(name, velocity)?;
        }
        map.end()
    }
}

/// An outcome in brief.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OutcomeInBrief<'a> {
    /// One mode per contact.
    pub modes: &'a [Mode],
    /// Sign of det A.
    pub index: Option<i8>,
    /// The smallest slack of the outcome's inequalities, free of units.
    pub margin: Option<f64>,
    /// False, and only then present, where the combination is neither shown nor excluded.
    #[serde(skip_serializing_if = "is_true")]
    pub decided: bool,
}

fn is_true(flag: &bool) -> bool {
    *flag
}

fn is_false(flag: &bool) -> bool {
    !*flag
}

impl<'a> Outcome<'a> {
    pub(super) fn new(outcome: &'a outcome::Outcome, name: impl Fn(usize) -> &'a str) -> Self {
        let at_zero = |&(contact, inequality): &(usize, Inequality)| AtZero { contact: name(contact), inequality };
        Self {
            modes: &outcome.modes,
            impulse: &outcome.impulse,
            velocity_after: &outcome.velocity_after,
            base_velocity_after: None,
            joint_velocity_after: None,
            loop_impulse: None,
            energy_loss: outcome.energy_loss,
            impulse_unique: outcome.impulse_unique,
            impulse_range: outcome.impulse_range.as_deref(),
            friction_needed: &outcome.friction_needed,
            index: outcome.index,
            margin: outcome.margin,
            border: outcome.border.as_ref().map(|border| Border {
                at_zero: border.at_zero.iter().map(at_zero).collect(),
                neighbours: &border.neighbours,
            }),
            family: outcome.family,
            proven: outcome.proven,
            decided: outcome.decided,
        }
    }

    /// Names the entries of v after the impact.
    pub(super) fn set_velocity_after(&mut self, robot: &'a Robot, velocity: &[f64]) {
        let mut named = robot.coordinates().zip(velocity.iter().copied());
        let base: Vec<_> = named.by_ref().take(robot.base_dofs()).collect();
        self.base_velocity_after = (!base.is_empty()).then_some(NamedVelocities(base));
        self.joint_velocity_after = Some(NamedVelocities(named.collect()));
    }

    /// The same in brief.
    pub(super) fn brief(&self) -> OutcomeInBrief<'a> {
        OutcomeInBrief { modes: self.modes, index: self.index, margin: self.margin, decided: self.decided }
    }
}
