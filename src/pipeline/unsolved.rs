//! The contact problem and the feet of a state, for searches between states.

use super::{Aspect, Impact, Pipeline};
use crate::contact::{Contact, Surface};
use crate::error::Result;
use crate::impact::ContactProblem;
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
    /// For each contact, the index of its corner among all corners of its link's feet; `None` if it is at none, as on a
    /// corner of the ground. Empty if the state names its contacts.
    pub corners: Vec<Option<usize>>,
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
