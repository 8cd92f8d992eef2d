//! Whether a verdict holds if each of the state's numbers is known to an interval.
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
//! nothing. A box that leaves combinations open is halved, within a fixed effort. The contact set is that of the given
//! state, and so are the rows of its loops. Dependent contacts stay unknown (det A is zero everywhere), and so do long
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

/// More contacts than this are not tried on a box.
pub const CONTACT_LIMIT: usize = 5;

/// Whether the set of outcomes, as lists of modes, is the same for every state of a box.
#[derive(Debug, Clone)]
pub enum Robustness {
    /// It is, by bounds that include all rounding.
    Everywhere,
    /// It is not: a state of the box has others.
    Not(Box<Counterexample>),
    /// Neither was shown within the effort spent.
    Unknown,
}

/// A state of the box whose outcomes differ, as the proven analysis of that very state finds them.
#[derive(Debug, Clone)]
pub struct Counterexample {
    /// The state; its contacts are named, so that they are the same whatever their height.
    pub state: State,
    /// Its verdict.
    pub verdict: Verdict,
    /// Its outcomes' lists of modes.
    pub outcomes: Vec<Vec<Mode>>,
}
