//! The contact problem: everything about a robot and its state that matters for the impact law.
//!
//! ```text
//!     c+ = c_free + G L,    c_free = c- + (effect of applied impulses)
//! ```
//!
//! with one contact law per contact (paper, section 2). A problem can also be built from matrices, without a robot.

mod checks;
mod source;
mod dense;
mod repair;

pub use checks::MATRIX_LIMIT;
pub(crate) use checks::check_matrix_size;
pub(crate) use source::{Attempt, Precision, Rung, climb};
pub use source::{Errors, Ladder, Source};
pub(super) use source::{PrecisionTask, Remembered, escalate};

use self::dense::Dynamics;
use self::repair::{FactorRows, is_semidefinite};
use crate::error::{Error, Reason, Result, finite};
use crate::law::{Friction, Law};
use crate::planar::Pair;
use crate::scalar::{Ball, DoubleDouble, Ordered, Real, Sign};

/// A contact problem of n contacts; vectors have two entries per contact, [tangential, normal].
///
/// Its numbers can be of any type that implements [`Real`]; [`ContactProblem::map`] converts them.
/// [`Analysis`](crate::Analysis) has an example.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactProblem<T = f64> {
    /// G, 2n x 2n by rows \[1/kg\].
    delassus: Vec<T>,
    /// c-, the contact velocities of the given state \[m/s\].
    velocity_before: Vec<Pair<T>>,
    /// c_free: c- plus the effect of applied impulses \[m/s\].
    velocity_free: Vec<Pair<T>>,
    /// min(c_n-, 0) \[m/s\].
    approach: Vec<T>,
    laws: Vec<Law>,
    restitution: Vec<f64>,
    /// [`Source::shared_tangent`] of each contact; empty if nothing is known.
    shared: Vec<Option<usize>>,
    origin: Origin,
}

/// The origin of the numbers of a problem that has no other [`Source`].
#[derive(Debug, Clone, Default, PartialEq)]
enum Origin {
    #[default]
    Given,
    /// G and c- were computed from M, J and v.
    Dynamics(Box<Dynamics>),
    /// The given G was asymmetric by rounding and was replaced by its mean with its transpose, which is positive
    /// definite beyond doubt.
    Symmetrized,
    /// The given G was indefinite by rounding and was replaced by Z Z^T.
    Repaired(FactorRows),
}

impl<T: Real> ContactProblem<T> {
    /// Number of contacts n.
    pub fn contacts(&self) -> usize {
        self.velocity_before.len()
    }

    /// An entry of the Delassus matrix \[1/kg\]; contact i has the rows and columns 2i (tangential) and 2i + 1
    /// (normal).
    pub fn delassus(&self, row: usize, column: usize) -> T {
        self.delassus[row * 2 * self.contacts() + column]
    }

    /// Contact velocities of the given state, before any applied impulse, [tangential, normal] per contact \[m/s\].
    pub fn velocity_before(&self) -> &[Pair<T>] {
        &self.velocity_before
    }

    /// The same problem with another law for all contacts.
    pub(crate) fn under(&self, law: Law) -> Self {
        Self { laws: vec![law; self.contacts()], ..self.clone() }
    }

    /// Contact velocities without contact impulses, [tangential, normal] per contact \[m/s\].
    pub fn velocity_free(&self) -> &[Pair<T>] {
        &self.velocity_free
    }

    /// The law of each contact.
    pub fn laws(&self) -> &[Law] {
        &self.laws
    }

    /// The friction of each contact.
    pub fn friction(&self) -> impl Iterator<Item = Friction> {
        self.laws.iter().map(Law::friction)
    }

    /// The coefficient of Newton's restitution of each contact, 0 to 1.
    pub fn restitution(&self) -> &[f64] {
        &self.restitution
    }

    /// The bounce e min(c_n-, 0) of a contact \[m/s\], so that xi_n = c_n+ + bounce (Newton's law in Moreau's form).
    pub fn bounce(&self, contact: usize) -> T {
        T::from_f64(self.restitution[contact]) * self.approach[contact]
    }

    /// The velocity of a row without impulses \[m/s\]: c_t of a tangential row, xi_n = c_n + bounce of a normal row.
    pub fn free_row(&self, row: usize) -> T {
        let free = self.velocity_free[row / 2][row % 2];
        if row % 2 == 1 && self.restitution[row / 2] != 0.0 { free + self.bounce(row / 2) } else { free }
    }

    /// The contact that has exactly the same tangential row as this one; `None` if no such contact is known.
    pub(super) fn shared_tangent(&self, contact: usize) -> Option<usize> {
        self.shared.get(contact).copied().flatten()
    }

    /// Returns the same problem with every number converted by `number`.
    pub fn map<U: Real>(&self, number: impl Fn(T) -> U) -> ContactProblem<U> {
        let vectors = |list: &[Pair<T>]| list.iter().map(|c| c.map(&number)).collect();
        ContactProblem {
            delassus: self.delassus.iter().map(|&entry| number(entry)).collect(),
            velocity_before: vectors(&self.velocity_before),
            velocity_free: vectors(&self.velocity_free),
            approach: self.approach.iter().map(|&entry| number(entry)).collect(),
            laws: self.laws.clone(),
            restitution: self.restitution.clone(),
            shared: Vec::new(),
            origin: Origin::Given,
        }
    }
}

impl<T: Ordered> ContactProblem<T> {
    /// Builds a problem from numbers whose signs depend on their precision. The caller has already checked it in f64.
    pub(crate) fn of_parts(
        delassus: Vec<T>,
        velocity_before: Vec<Pair<T>>,
        velocity_free: Vec<Pair<T>>,
        laws: Vec<Law>,
        restitution: Vec<f64>,
    ) -> Self {
        let approach = |c: &Pair<T>| match c[1].sign() {
            Sign::Negative => c[1],
            Sign::Zero | Sign::Positive => T::zero(),
            // Division by zero makes the number unknown, so that everything that depends on it stays undecided.
            Sign::Undecided => T::one() / T::zero(),
        };
        let approach = velocity_before.iter().map(approach).collect();
        let (shared, origin) = (Vec::new(), Origin::Given);
        Self { delassus, velocity_before, velocity_free, approach, laws, restitution, shared, origin }
    }

    /// Returns the same problem with [`Self::shared_tangent`] set for each contact.
    pub(super) fn sharing(self, shared: Vec<Option<usize>>) -> Self {
        Self { shared, ..self }
    }
}

impl ContactProblem {
    /// Builds a problem from its matrices: `delassus` has 2n x 2n entries by rows, with rows and columns [tangential,
    /// normal] per contact \[1/kg\]; `velocity_before` \[m/s\], `friction` and `restitution` (0 to 1) have one entry
    /// per contact.
    ///
    /// # Errors
    /// Returns an error if lengths do not match, if there are more contacts than [`MATRIX_LIMIT`], if a number is not
    /// finite, if a friction is negative or a restitution outside 0..1, and if the Delassus matrix is asymmetric or
    /// indefinite beyond rounding, each entry relative to the geometric mean of its two diagonal entries.
    pub fn new(
        delassus: Vec<f64>,
        velocity_before: Vec<Pair<f64>>,
        friction: Vec<impl Into<Law>>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        let contacts = velocity_before.len();
        check_matrix_size(contacts)?;
        let rows = 2 * contacts;
        if delassus.len() != rows * rows {
            let entries = delassus.len();
            let reason =
                format!("the Delassus matrix must have {rows} x {rows} entries, two rows per contact, not {entries}");
            return Err(Error::new(Reason::Inconsistent(reason))
                .at("delassus")
                .hint("give two rows and columns per contact: tangential, normal"));
        }
        for (index, &entry) in delassus.iter().enumerate() {
            finite(entry, || format!("entry [{}][{}] of delassus", index / rows, index % rows))?;
        }
        let free = velocity_before.clone();
        let mut problem = Self::checked(delassus, velocity_before, free, friction, restitution)?;
        let is_definite = problem.check_definite()?;
        if !problem.symmetrize() {
            if is_definite || is_semidefinite(&problem) {
                return Ok(problem);
            }
        } else if problem.check_definite()? {
            return Ok(Self { origin: Origin::Symmetrized, ..problem });
        }
        let rows = FactorRows::of(&problem);
        Ok(Self { delassus: rows.delassus(), origin: Origin::Repaired(rows), ..problem })
    }

    /// Whether G and c- themselves were given and are used unchanged, so that every digit of them is exact.
    pub fn is_given(&self) -> bool {
        matches!(self.origin, Origin::Given)
    }

    /// Replaces G by its mean with its transpose; returns false if G is already symmetric.
    fn symmetrize(&mut self) -> bool {
        let rows = 2 * self.contacts();
        let mut found = false;
        for (i, j) in (0..rows).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let (lower, upper) = (self.delassus(i, j), self.delassus(j, i));
            if lower != upper {
                // Each is halved first, because their sum may overflow.
                let mean = 0.5 * lower + 0.5 * upper;
                (self.delassus[i * rows + j], self.delassus[j * rows + i]) = (mean, mean);
                found = true;
            }
        }
        found
    }

    /// Whether the given G was asymmetric, by rounding alone, and was replaced by a symmetric matrix.
    pub fn is_symmetrized(&self) -> bool {
        matches!(self.origin, Origin::Symmetrized)
    }

    /// Whether the given M was asymmetric, by rounding alone, and was replaced by a symmetric matrix.
    pub fn is_mass_symmetrized(&self) -> bool {
        matches!(&self.origin, Origin::Dynamics(dynamics) if dynamics.is_symmetrized)
    }

    /// Whether the given G was indefinite, by rounding alone, and was replaced by a semidefinite matrix.
    pub fn is_repaired(&self) -> bool {
        matches!(self.origin, Origin::Repaired(_))
    }

    /// Builds a problem from parts that the dynamics computed: G \[1/kg\], c- and c_free \[m/s\].
    pub(crate) fn checked(
        delassus: Vec<f64>,
        velocity_before: Vec<Pair<f64>>,
        velocity_free: Vec<Pair<f64>>,
        friction: Vec<impl Into<Law>>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        let contacts = velocity_before.len();
        for (place, length) in [("friction", friction.len()), ("restitution", restitution.len())] {
            if length != contacts {
                return Err(Error::new(Reason::Inconsistent(format!("{contacts} contacts, but {length} values")))
                    .at(place)
                    .hint("give one number for all contacts or a list with one entry per contact"));
            }
        }
        let laws = friction.into_iter().map(Into::into).collect();
        let (approach, shared, origin) = (Vec::new(), Vec::new(), Origin::Given);
        let mut problem =
            Self { delassus, velocity_before, velocity_free, approach, laws, restitution, shared, origin };
        problem.complete()?;
        Ok(problem)
    }

    /// Overwrites this problem with another one, reusing its memory. The checks are those of
    /// [`ContactProblem::checked`]; `contacts` gives the friction and restitution of each contact.
    pub(crate) fn renew(
        &mut self,
        delassus: &[f64],
        velocity_before: &[Pair<f64>],
        velocity_free: &[Pair<f64>],
        contacts: impl Iterator<Item = Result<(Friction, f64)>>,
    ) -> Result<()> {
        delassus.clone_into(&mut self.delassus);
        velocity_before.clone_into(&mut self.velocity_before);
        velocity_free.clone_into(&mut self.velocity_free);
        self.laws.clear();
        self.restitution.clear();
        for contact in contacts {
            let (friction, restitution) = contact?;
            self.laws.push(friction.into());
            self.restitution.push(restitution);
        }
        self.origin = Origin::Given;
        self.complete()
    }

    /// Returns the same problem, without applied impulses, for another `velocity` before the impact, rounded to f64.
    /// Also returns the error of each rounded velocity \[m/s\].
    pub(super) fn moving(&self, velocity: &[Pair<Ball<DoubleDouble>>]) -> (Self, Vec<Pair<f64>>) {
        let nearest: Vec<Pair<f64>> = velocity.iter().map(|c| c.map(Ordered::to_f64)).collect();
        let off = velocity.iter().map(|c| c.map(Ball::error_of_nearest)).collect();
        let mut problem = Self { velocity_before: nearest.clone(), velocity_free: nearest, ..self.clone() };
        problem.take_approach();
        (problem, off)
    }

    fn take_approach(&mut self) {
        self.approach.clear();
        self.approach.extend(self.velocity_before.iter().map(|c| c[1].min(0.0)));
    }

    fn complete(&mut self) -> Result<()> {
        self.take_approach();
        self.check_contacts()?;
        self.check_range()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_matrix_is_refused_at_its_entry() {
        let refused = |delassus: &[f64]| {
            let contacts = delassus.len().isqrt() / 2;
            let (friction, restitution) = (vec![Friction::Infinite; contacts], vec![0.0; contacts]);
            let problem = ContactProblem::new(delassus.to_vec(), vec![[0.0, -1.0]; contacts], friction, restitution);
            problem.err().map(|error| error.place().unwrap_or_default().to_owned())
        };
        // The units of the rows must not matter. Powers of two scale without rounding.
        let place = |delassus: &[f64]| {
            let rows = delassus.len().isqrt();
            let unit = |row: usize| [1.0, f64::exp2(-40.0), f64::exp2(33.0), 0.5][row];
            let scaled: Vec<f64> =
                delassus.iter().enumerate().map(|(at, entry)| unit(at / rows) * unit(at % rows) * entry).collect();
            assert_eq!(refused(delassus), refused(&scaled), "{delassus:?}");
            refused(delassus)
        };
        assert_eq!(place(&[1.0, 2.0, 2.0, 4.0]), None, "singular is not indefinite");
        assert_eq!(place(&[2.0, 1.0, 1.0, f64::NAN]).as_deref(), Some(""));
        assert_eq!(place(&[2.0, 1.0, 1.0 + 1e-14, 2.0]).as_deref(), Some("delassus[1][0]"), "asymmetric");
        assert_eq!(place(&[2.0, 1.0, 1.0 + 1e-15, 2.0]), None, "asymmetric by rounding");
        assert_eq!(place(&[2.0, 1e-20, 1e-20, 0.0]).as_deref(), Some("delassus[1][0]"));
        // 2 exceeds the geometric mean of 1 and 1.5.
        assert_eq!(place(&[1.0, 2.0, 2.0, 1.5]).as_deref(), Some("delassus[1][0]"));
        assert_eq!(place(&[0.0, 1.0, 1.0, 0.0]).as_deref(), Some("delassus[1][0]"));
        let mut g = [[4.0, 0.0, 0.0, 0.0], [0.0, 3.0, 0.0, 2.5], [0.0, 0.0, 1.0, 0.0], [0.0, 2.5, 0.0, 2.0]];
        assert_eq!(place(g.as_flattened()).as_deref(), Some("delassus[3][1]"));
        // No two rows alone are inconsistent, but the three together are: elimination leaves a negative last pivot.
        g = [[1.0, -0.9, -0.9, 0.0], [-0.9, 1.0, -0.9, 0.0], [-0.9, -0.9, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        assert_eq!(place(g.as_flattened()).as_deref(), Some("delassus[0][0]"));
    }

    #[test]
    fn a_matrix_made_asymmetric_by_rounding_is_its_mean() {
        let solve = |other: f64| {
            let delassus = vec![2.0, 1.0, other, 2.0];
            let problem = ContactProblem::new(delassus, vec![[0.5, -1.0]], vec![Friction::Finite(0.9)], vec![0.0]);
            problem.unwrap_or_else(|error: Error| panic!("{error}"))
        };
        let [exact, rounded] = [1.0, 1.0 + f64::EPSILON].map(solve);
        assert_eq!([exact.is_symmetrized(), rounded.is_symmetrized()], [false, true]);
        assert!(!rounded.is_repaired() && rounded.delassus(0, 1) == rounded.delassus(1, 0));
        let [exact, rounded] = [exact, rounded].map(|problem| crate::impact::analyze(&problem, false.into()).unwrap());
        assert!(exact.proven && rounded.proven);
        assert_eq!(exact.outcomes[0].modes, rounded.outcomes[0].modes);
        // Rows that are equal except for the digit that makes the matrix asymmetric, which alone makes the mean
        // definite.
        let rows = [[2.0, -1.0, 2.0, 1.0], [-1.0, 2.0, -1.0, 0.0], [2.0, -1.0, 2.0, 1.0], [1.0, 0.0, 1.0, 2.0]];
        let mut delassus = rows.concat();
        delassus[8] -= 2.0 * f64::EPSILON;
        let velocity = vec![[0.5, -1.0], [0.500_000_000_1, -1.0]];
        let nearly = ContactProblem::new(delassus, velocity, vec![Friction::Infinite; 2], vec![0.0; 2]).unwrap();
        assert_eq!([nearly.is_symmetrized(), nearly.is_repaired()], [false, true]);
        assert!(!crate::impact::analyze(&nearly, false.into()).unwrap().proven);
    }

    #[test]
    fn lengths_that_do_not_fit_are_refused() {
        let friction = vec![Friction::Infinite; 2];
        let given = ContactProblem::new(vec![1.0, 0.0, 0.0, 1.0], vec![[0.0, -1.0]], friction.clone(), vec![0.0]);
        assert_eq!(given.unwrap_err().place(), Some("friction"));
        let identity = [vec![1.0, 0.0], vec![0.0, 1.0]];
        let dynamics =
            ContactProblem::from_dynamics(&identity, &identity, &[0.0, -1.0], friction[1..].to_vec(), vec![]);
        assert_eq!(dynamics.unwrap_err().place(), Some("restitution"));
    }
}
