//! Robustness: whether a verdict holds if each number of the state is known only to an interval.
//!
//! ```text
//!     box of states --affine numbers--> G, c, mu --minors--> det A, numerators --signs--> all combinations decided: yes
//!                          |                                                     some open: try states, halve the box
//!                          └── a state whose proven outcomes differ: no
//! ```
//!
//! The set of outcomes, as lists of modes, is the same on a box if every combination of modes is valid on all of it or
//! rejected on all of it. The numbers of a box are [`Affine`](crate::scalar::Affine): parts that depend on the same
//! uncertain quantity cancel, and the rest is of second order in the half-widths. A combination's unknowns are
//! numerators over det A by Cramer's rule. Numerators are polynomials, so that a pole inside the box (det A = 0) widens
//! nothing. A box that leaves combinations open is halved, within a fixed effort. The contacts and the rows of the
//! loops are those of the given state. Dependent contacts stay unknown (det A is zero everywhere), and so do long
//! chains, in which the second order grows from link to link.
//!
//! Cost: O(P) for each operation of the dynamics with P uncertain quantities, and 2n 9^n of them for the minors.

mod state_box;
mod combination;
mod kept;
mod search;

use crate::impact::Verdict;
use crate::law::Mode;
use crate::state::State;

/// Boxes with more contacts than this are not tried.
pub const CONTACT_LIMIT: usize = 5;

/// Whether the set of outcomes, as lists of modes, is the same for every state of a box.
#[derive(Debug, Clone)]
pub enum Robustness {
    /// The set is the same, shown by bounds that include all rounding.
    Everywhere,
    /// The set is not the same: a state of the box has other outcomes.
    Not(Box<Counterexample>),
    /// Neither was shown within the effort spent.
    Unknown,
}

/// A state of the box whose outcomes differ, as its own proven analysis shows.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Counterexample {
    /// The state. Its contacts are named, so that they stay contacts at any height.
    pub state: State,
    /// The verdict of that state.
    pub verdict: Verdict,
    /// The lists of modes of its outcomes.
    pub outcomes: Vec<Vec<Mode>>,
}
