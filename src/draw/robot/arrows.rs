//! Impulses and velocities as arrows, and how long they are drawn.
//!
//! ```text
//!     the greatest of all outcomes of the drawing  -->  LONGEST of the robot's size
//! ```

use super::{Drawing, Touch};
use crate::contact::Contact;
use crate::law::Mode;
use crate::pipeline::Impact;
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::state::State;
use serde::Serialize;

/// A vector at a point.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Arrow {
    /// Where it acts \[m\].
    pub point: Vector<f64>,
    /// What it is, in its own unit.
    pub vector: Vector<f64>,
}

/// What an outcome does to the contacts.
#[derive(Debug, Clone, Serialize)]
pub struct Effect {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// The impulse that the ground gives to each \[N s\].
    pub impulse: Vec<Vector<f64>>,
    /// The velocity of each after the impact \[m/s\].
    pub velocity_after: Vec<Vector<f64>>,
}

/// The longest arrow, as a part of the robot's size.
const LONGEST: f64 = 0.4;

impl Drawing {
    /// Adds contacts, outcomes and applied impulses, drawn beside a robot of this size \[m\].
    pub(super) fn act(&mut self, robot: &Robot, state: &State, impact: &Impact, size: f64) {
        let in_world = |vectors: &[Pair<f64>]| -> Vec<Vector<f64>> {
            impact.contacts.iter().zip(vectors).map(|(contact, &vector)| contact.ground.apply(vector.into())).collect()
        };
        let touch = |(contact, velocity_before): (&Contact, Vector<f64>)| Touch {
            name: contact.name.clone(),
            point: contact.point,
            normal: contact.normal(),
            velocity_before,
        };
        self.contacts = impact.contacts.iter().zip(in_world(&impact.velocity_before)).map(touch).collect();
        let outcomes = impact.analysis.as_ref().map_or(&[][..], |analysis| &analysis.outcomes);
        self.outcomes = outcomes
            .iter()
            .map(|outcome| Effect {
                modes: outcome.modes.clone(),
                impulse: in_world(&outcome.impulse),
                velocity_after: in_world(&outcome.velocity_after),
            })
            .collect();
        let applied = state.scene.impulses.iter().map(|applied| {
            let link = &robot.links[applied.link];
            let point = impact.placement.world(link.body, link.point(applied.offset));
            Arrow { point, vector: applied.vector }
        });
        self.applied = applied.collect();

        let impulses = self.outcomes.iter().flat_map(|outcome| &outcome.impulse);
        let impulses = longest(impulses.chain(self.applied.iter().map(|applied| &applied.vector)));
        let before = self.contacts.iter().map(|contact| &contact.velocity_before);
        let velocities = longest(self.outcomes.iter().flat_map(|outcome| &outcome.velocity_after).chain(before));
        let scale = |most: f64| if most > 0.0 { LONGEST * size / most } else { 0.0 };
        (self.impulse_scale, self.velocity_scale) = (scale(impulses), scale(velocities));
    }
}

fn longest<'a>(vectors: impl Iterator<Item = &'a Vector<f64>>) -> f64 {
    vectors.map(|vector| vector.length()).fold(0.0, f64::max)
}
