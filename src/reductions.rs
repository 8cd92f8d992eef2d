//! Switches for the reductions: each one omits work that a scene does not need.
//!
//! ```text
//!     file  --weld, massless-->  bodies  --held-->  columns  --reach, merge-->  contacts  --frictionless-->  combinations
//! ```
//!
//! With or without a reduction, the outcomes, velocities and impulses agree to 1e-12 of their scale;
//! `tests/library/reductions` compares them. [`left_out`](crate::left_out) lists what each reduction saves and what
//! cannot be left out.

/// Selects which reductions are applied. All of them are by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reductions {
    /// Merges links on fixed and frozen joints into their parent bodies. If off, each of these links is a separate
    /// body, on a joint without a coordinate.
    pub weld: bool,
    /// Drops links on fixed and frozen joints that have neither mass nor shape. If off, each of them is a body, even if
    /// `weld` merges all other links.
    pub massless: bool,
    /// Omits the columns of braked joints from the mass matrix. If off, the joints have columns, and constraint
    /// impulses keep their rates. A braked joint that moves no mass requires this reduction: else M is singular.
    pub held: bool,
    /// Skips shapes whose bounding circle is too high. If off, the lowest points of every shape are computed.
    pub reach: bool,
    /// Replaces the detected points of a body on straight ground by the outermost two. If off, each point is a contact.
    pub merge: bool,
    /// Shares one elimination between the modes of a closed contact without friction, because they differ only in the
    /// sign of the tangential velocity. If off, each mode is solved separately.
    pub frictionless: bool,
    /// Computes the condition number of a Delassus matrix with a single contact in closed form. If off, its eigenvalues
    /// are computed as for any number of contacts.
    pub lone: bool,
}

impl Reductions {
    /// Every reduction is on.
    pub const ALL: Self =
        Self { weld: true, massless: true, held: true, reach: true, merge: true, frictionless: true, lone: true };

    /// No reduction: everything is computed as if the scene needed it.
    pub const NONE: Self = Self {
        weld: false,
        massless: false,
        held: false,
        reach: false,
        merge: false,
        frictionless: false,
        lone: false,
    };
}

impl Default for Reductions {
    fn default() -> Self {
        Self::ALL
    }
}
