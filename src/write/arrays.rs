//! Results as arrays: the cells of a table of results as numbers, for many states one after the other.

use super::csv::{border, families, no_column, notes};
use super::{Columns, ErrorObject};
use crate::impact::CONTACT_LIMIT;
use crate::{Impact, Result, Verdict};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The answers to many states. Lists per state have one entry per state. Lists per outcome have one entry for each
/// outcome of each state; those of state `k` lie between `offsets[k]` and `offsets[k + 1]`. Matrices are row by row.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Arrays {
    /// The contacts, in the order of the matrices' columns; not serialized, because arrays that are read back do not
    /// grow.
    #[serde(skip)]
    contacts: Arc<[String]>,
    /// Per state: the verdict as a number, in the order of [`Verdict`]; [`Arrays::REFUSED`] for a refused state.
    pub verdict: Vec<u8>,
    /// Per state: whether every combination is decided by an error bound.
    pub all_proven: Vec<bool>,
    /// The index of each state's first outcome, and the number of all outcomes at the end.
    pub offsets: Vec<i64>,
    /// Per outcome and contact: the mode as a number, in the order of [`Mode`](crate::Mode); [`Arrays::OPEN`] if the
    /// contact is not closed.
    pub modes: Vec<i8>,
    /// Per outcome and contact: impulse [tangential, normal] \[N s\], or force \[N\]; NaN if the contact is not closed
    /// or the outcome is not decided.
    pub impulse: Vec<f64>,
    /// Per outcome and coordinate: v after the impact \[m/s, rad/s\], or with forces its rate \[m/s^2, rad/s^2\]; NaN
    /// if the outcome is not decided.
    pub velocity_after: Vec<f64>,
    /// Per outcome: the smallest slack; NaN if there is no inequality.
    pub margin: Vec<f64>,
    /// Per outcome: the sign of det A, the determinant of the equations of its modes; 0 if it is not defined.
    pub index: Vec<i8>,
    /// Per outcome: whether an error bound shows every sign.
    pub proven: Vec<bool>,
    /// Per outcome: whether it is a corner of a family.
    pub family: Vec<bool>,
    /// Per refused state: why it was refused.
    pub error: Texts,
    /// Per state: its notes.
    pub notes: Texts,
    /// Per outcome on a border: the inequalities that are zero.
    pub border: Texts,
    /// Per outcome that is a corner: the modes of its families.
    pub families: Texts,
}

/// Texts for a few entries of a list, many of which are equal.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Texts {
    /// Pairs of an entry of the list and the index of its text in `known`.
    pub at: Vec<(usize, usize)>,
    /// The texts; a text that equals one of the last few is not stored again.
    pub known: Vec<String>,
}

/// The number of last texts that a new text is compared with.
const NEAR: usize = 16;

impl Texts {
    fn push(&mut self, at: usize, text: String) {
        if text.is_empty() {
            return;
        }
        let far = self.known.len().saturating_sub(NEAR);
        let near = self.known[far..].iter().rposition(|known| *known == text);
        let place = near.map_or(self.known.len(), |near| far + near);
        if near.is_none() {
            self.known.push(text);
        }
        self.at.push((at, place));
    }

    fn clear(&mut self) {
        self.at.clear();
        self.known.clear();
    }

    /// Appends the texts of a list whose entries follow `before` earlier entries.
    fn append(&mut self, before: usize, other: Self) {
        for (at, place) in other.at {
            self.push(before + at, other.known[place].clone());
        }
    }
}

impl Arrays {
    /// The `verdict` of a refused state.
    pub const REFUSED: u8 = Verdict::ALL.len() as u8;
    /// The entry of `modes` for a contact that is not closed.
    pub const OPEN: i8 = -1;

    /// Creates empty arrays for answers with the contacts of these `columns`.
    pub fn new(columns: &Columns) -> Self {
        Self::of(columns.contacts().into(), 0)
    }

    /// Creates empty arrays for the same contacts, with capacity for `states` states of one outcome each.
    pub fn for_states(&self, states: usize) -> Self {
        Self::of(Arc::clone(&self.contacts), states)
    }

    fn of(contacts: Arc<[String]>, states: usize) -> Self {
        let mut offsets = Vec::with_capacity(states + 1);
        offsets.push(0);
        Self {
            verdict: Vec::with_capacity(states),
            all_proven: Vec::with_capacity(states),
            offsets,
            modes: Vec::with_capacity(states * contacts.len()),
            impulse: Vec::with_capacity(2 * states * contacts.len()),
            margin: Vec::with_capacity(states),
            index: Vec::with_capacity(states),
            proven: Vec::with_capacity(states),
            family: Vec::with_capacity(states),
            contacts,
            ..Self::default()
        }
    }

    /// Removes all answers, and keeps the allocated memory.
    pub fn clear(&mut self) {
        self.offsets.clear();
        self.offsets.push(0);
        for list in [&mut self.all_proven, &mut self.proven, &mut self.family] {
            list.clear();
        }
        for list in [&mut self.impulse, &mut self.velocity_after, &mut self.margin] {
            list.clear();
        }
        self.verdict.clear();
        self.modes.clear();
        self.index.clear();
        for texts in [&mut self.error, &mut self.notes, &mut self.border, &mut self.families] {
            texts.clear();
        }
    }

    /// Adds the answer to the next state; a state with a contact that has no columns is refused.
    pub fn push(&mut self, answer: Result<&Impact>) {
        if let Err(error) = answer.and_then(|impact| self.answered(impact)) {
            self.error.push(self.verdict.len(), ErrorObject::new(&error).to_string());
            self.verdict.push(Self::REFUSED);
            self.all_proven.push(false);
        }
        self.offsets.push(self.margin.len() as i64);
    }

    fn answered(&mut self, impact: &Impact) -> Result<()> {
        let analysis = impact.analyzed()?;
        let columns = self.contacts.len();
        let place = |name: &str| self.contacts.iter().position(|known| known == name).ok_or_else(|| no_column(name));
        let mut places = [0; CONTACT_LIMIT];
        for (place_of, contact) in places.iter_mut().zip(&impact.contacts) {
            *place_of = place(&contact.name)?;
        }
        self.notes.push(self.verdict.len(), notes(impact));
        for (at, outcome) in analysis.outcomes.iter().enumerate() {
            let (row, start) = (self.margin.len(), self.modes.len());
            let number = |entry| if outcome.decided { entry } else { f64::NAN };
            self.modes.resize(start + columns, Self::OPEN);
            self.impulse.resize(2 * (start + columns), f64::NAN);
            for ((&place, mode), impulse) in places.iter().zip(&outcome.modes).zip(&outcome.impulse) {
                self.modes[start + place] = *mode as i8;
                self.impulse[2 * (start + place)..][..2].copy_from_slice(&impulse.map(number));
            }
            self.velocity_after.extend(outcome.velocity().map(number));
            self.margin.push(outcome.margin.unwrap_or(f64::NAN));
            self.index.push(outcome.index.unwrap_or(0));
            self.proven.push(outcome.proven);
            self.family.push(outcome.family);
            if outcome.border.is_some() {
                self.border.push(row, border(outcome));
            }
            if !analysis.families.is_empty() {
                self.families.push(row, families(&analysis.families, at));
            }
        }
        self.verdict.push(analysis.verdict as u8);
        self.all_proven.push(analysis.proven);
        Ok(())
    }

    /// Appends the answers to the states that follow; both must have the same contacts.
    pub fn append(&mut self, mut next: Self) {
        let (states, outcomes) = (self.verdict.len(), self.margin.len());
        self.offsets.extend(next.offsets.iter().skip(1).map(|offset| offset + outcomes as i64));
        self.verdict.append(&mut next.verdict);
        self.all_proven.append(&mut next.all_proven);
        self.modes.append(&mut next.modes);
        self.impulse.append(&mut next.impulse);
        self.velocity_after.append(&mut next.velocity_after);
        self.margin.append(&mut next.margin);
        self.index.append(&mut next.index);
        self.proven.append(&mut next.proven);
        self.family.append(&mut next.family);
        self.error.append(states, next.error);
        self.notes.append(states, next.notes);
        self.border.append(outcomes, next.border);
        self.families.append(outcomes, next.families);
    }
}
