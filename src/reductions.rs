//! What a scene does not need and so does not pay for: each reduction with its own switch.
//!
//! ```text
//!     file  --weld, massless-->  bodies  --held-->  columns  --reach, merge-->  contacts  --frictionless-->  combinations
//! ```
//!
//! With or without a reduction the outcomes, velocities and impulses are the same to 1e-12 of scale;
//! `tests/library/reductions` compares them. [`left_out`](crate::left_out) gives what each saves, and what can never be
//! left out.

/// The reductions to make; all by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reductions {
    /// Merges links on fixed and frozen joints into their parent bodies. Without it each is a body of its own, on a
    /// joint without a coordinate.
    pub weld: bool,
    /// Drops massless links without shapes on such joints. Without it each is a body, even if all others are merged.
    pub massless: bool,
    /// Gives braked joints no column in the mass matrix. Without it they have one, and constraint impulses keep their
    /// rates. A braked joint that moves no mass needs this reduction: the mass matrix is singular without it.
    pub held: bool,
    /// Skips shapes whose bounding circle is too high. Without it the lowest points of every shape are computed.
    pub reach: bool,
    /// Lets the outer two of a body's detected points on a straight ground act for those between them. Without it each
    /// point is a contact.
    pub merge: bool,
    /// Shares one elimination between the modes of a closed contact without friction, which differ only in the sign of
    /// its velocity. Without it each is solved by itself.
    pub frictionless: bool,
    /// Takes the condition of a lone contact's Delassus matrix in closed form. Without it the eigenvalues are computed
    /// as for any number of contacts.
    pub lone: bool,
}

impl Reductions {
    /// Every reduction.
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
