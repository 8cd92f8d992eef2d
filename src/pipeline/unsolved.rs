//! A state's contact problem and its feet, as a search between states follows them.

use super::{Aspect, Impact, Pipeline};
use crate::contact::{Contact, Surface};
use crate::error::Result;
use crate::impact::ContactProblem;
use crate::state::State;

/// A state's contact problem, not yet analyzed.
#[derive(Debug, Clone)]
pub struct Unsolved {
    /// The closed contacts.
    pub contacts: Vec<Contact>,
    /// Their contact problem, in f64.
    pub problem: ContactProblem,
    /// How far each foot is from the ground \[m\]; empty if the state names its contacts.
    pub clearance: Vec<f64>,
    /// At which corner of its link's feet each contact is, counted through them, or `None` if it is at none, as on a
    /// corner of the ground; empty as well.
    pub corners: Vec<Option<usize>>,
}

impl Pipeline<'_> {
    /// The contact problem of a state as f64 has it, without its analysis: of its impact or of forces, as
    /// [`Options::aspect`](super::Options::aspect) says.
    ///
    /// # Errors
    /// As [`Pipeline::answer`].
    pub fn unsolved(&mut self, state: &State) -> Result<Unsolved> {
        let prepared = match self.options.aspect {
            Aspect::Impact => self.prepare(state)?,
            Aspect::Forces => self.prepare_forces(state)?,
        };
        let Impact { placement, contacts, problem, .. } = *prepared.impact;
        if state.scene.contacts.is_some() {
            return Ok(Unsolved { contacts, problem, clearance: Vec::new(), corners: Vec::new() });
        }
        let surface = Surface::new(&state.scene.ground);
        let clearance = self.feet.iter().map(|foot| surface.clearance(foot, &placement)).collect();
        let corner = |contact: &Contact| {
            let own = self.feet.iter().filter(|foot| foot.link == contact.link);
            own.flat_map(|foot| foot.outline.corners()).position(|corner| *corner == contact.center)
        };
        let corners = contacts.iter().map(corner).collect();
        Ok(Unsolved { contacts, problem, clearance, corners })
    }
}
