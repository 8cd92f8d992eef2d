//! What a scene does not need, and so does not pay for: each reduction with a switch of its own.
//!
//! ```text
//!     file  --weld, massless-->  bodies  --held-->  columns  --reach-->  contacts  --frictionless-->  combinations
//! ```
//!
//! With or without a reduction the outcomes, velocities and impulses are the same to 1e-12 of scale; `tests/reductions`
//! compares them. [`left_out`](crate::left_out) tells what each saves, and what can never be left out.

/// Which reductions are made; by default all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reductions {
    /// Links on fixed joints, and on joints that leave the plane or are asked to be held, are welded into their parents.
    /// Else each is a body of its own, on a joint without a coordinate.
    pub weld: bool,
    /// Massless links without shapes on such joints are no bodies. Else each is one, also where all others are welded.
    pub massless: bool,
    /// Joints that a state holds have no column in the mass matrix. Else they have one, and constraint impulses keep their
    /// rates. A held joint that moves no mass cannot do without this reduction: the mass matrix is singular.
    pub held: bool,
    /// A shape whose bounding circle is too high is not asked for its lowest points. Else every shape is.
    pub reach: bool,
    /// The modes of a closed contact without friction, which differ in the sign of its velocity alone, share one elimination.
    /// Else each is solved by itself.
    pub frictionless: bool,
    /// The condition of a lone contact's Delassus matrix is taken in closed form. Else by the eigenvalues of any number of
    /// contacts.
    pub lone: bool,
}

impl Reductions {
    /// Every reduction.
    pub const ALL: Self = Self { weld: true, massless: true, held: true, reach: true, frictionless: true, lone: true };

    /// None: everything is computed as if the scene needed it.
    pub const NONE: Self =
        Self { weld: false, massless: false, held: false, reach: false, frictionless: false, lone: false };
}

impl Default for Reductions {
    fn default() -> Self {
        Self::ALL
    }
}
