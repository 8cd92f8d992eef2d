//! The contact problem and the feet of a state, for searches between states.

use super::{Aspect, Impact, Pipeline};
use crate::contact::{Contact, Surface};
use crate::error::Result;
use crate::impact::{ContactProblem, Errors};
use crate::planar::Pair;
use crate::state::State;

/// A state's contact problem, not yet analyzed.
#[derive(Debug, Clone)]
pub struct Unsolved {
    /// The closed contacts of the state.
    pub contacts: Vec<Contact>,
    /// Their contact problem, in f64.
    pub problem: ContactProblem,
    /// Height of each foot above the ground \[m\]; empty if the state names its contacts.
    pub clearance: Vec<f64>,
    /// What touches at each contact.
    pub touching: Vec<Touching>,
    /// [`Errors::delassus`] of the problem; infinite if no errors are known.
    pub delassus_error: f64,
    /// [`Errors::velocity`] of the problem; empty if no errors are known.
    pub velocity_errors: Vec<Pair<f64>>,
}

/// The parts of a foot and of the ground that meet at a contact. They change as a foot rolls or slides, while the
/// contact keeps its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Touching {
    /// The index of the contact's corner among all corners of its link's feet; `None` if it is at none, as on a corner
    /// of the ground, or if the state names its contacts.
    pub corner: Option<usize>,
    /// The number of the ground's segment or corner, counted together along x; 0 for a plane.
    pub ground: usize,
}

impl Unsolved {
    /// Returns the error bounds of the problem.
    pub fn errors(&self) -> Errors<'_> {
        Errors { delassus: self.delassus_error, velocity: Some(&self.velocity_errors), likely: [1.0; 2] }
    }
}

impl Pipeline<'_> {
    /// Returns the contact problem of a state in f64, without its analysis: of the impact or of the forces, as
    /// [`Options::aspect`](super::Options::aspect) selects.
    ///
    /// # Errors
    /// Returns the errors of [`Pipeline::answer`].
    pub fn unsolved(&mut self, state: &State) -> Result<Unsolved> {
        let prepared = match self.options.aspect {
            Aspect::Impact => self.prepare(state)?,
            Aspect::Forces => self.prepare_forces(state)?,
        };
        let Impact { placement, contacts, problem, .. } = *prepared.impact;
        let surface = Surface::new(&state.scene.ground);
        let is_named = state.scene.contacts.is_some();
        let feet = || self.feet.iter().filter(|_| !is_named);
        let corner = |contact: &Contact| {
            let on_link = feet().filter(|foot| foot.link == contact.link);
            on_link.flat_map(|foot| foot.outline.corners()).position(|corner| *corner == contact.center)
        };
        let touching = |contact| Touching { corner: corner(contact), ground: surface.part(contact) };
        // The known bounds are those of contact velocities, not of accelerations.
        let (delassus_error, velocity_errors) = match self.options.aspect {
            Aspect::Impact => (self.bounds.delassus, self.bounds.velocity.clone()),
            Aspect::Forces => (f64::INFINITY, Vec::new()),
        };
        Ok(Unsolved {
            clearance: feet().map(|foot| surface.clearance(foot, &placement)).collect(),
            touching: contacts.iter().map(touching).collect(),
            delassus_error,
            velocity_errors,
            contacts,
            problem,
        })
    }
}
