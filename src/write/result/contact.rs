//! Contacts, and feet that are none.

use crate::planar::{Pair, Vector};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A closed contact.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "Contact")]
pub struct ContactRecord<'a> {
    /// The URDF link that carries the shape; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub link: Option<Cow<'a, str>>,
    /// Its name, which is its link's, or link/0, link/1 ... if a link has several.
    pub name: Cow<'a, str>,
    /// The contact point in the world \[m\]; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<Vector<f64>>,
    /// Unit normal of the ground, toward the robot; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<Vector<f64>>,
    /// Height above the ground along the normal \[m\]; of a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gap: Option<f64>,
    /// Its velocity before the impact, [tangential, normal] \[m/s\].
    pub velocity_before: Pair<f64>,
}

/// A foot that does not touch, or that is too deep in the ground.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename = "NearestFoot")]
pub struct NearestRecord<'a> {
    /// The URDF link that carries it.
    pub name: Cow<'a, str>,
    /// Height of its lowest point above the ground along the normal \[m\], negative below it.
    pub height: f64,
    /// How that point moves before the impact, [tangential, normal] \[m/s\].
    pub velocity: Pair<f64>,
}

impl<'a> ContactRecord<'a> {
    pub(super) fn of_problem(name: &'a str, velocity_before: Pair<f64>) -> Self {
        Self { name: Cow::Borrowed(name), velocity_before, ..Self::default() }
    }
}
