//! The contact problem: what is left of robot and state once only the contacts matter.
//!
//! ```text
//!     c+ = c_free + G L,    c_free = c- + (effect of applied impulses)
//! ```
//!
//! with the laws of each contact (paper, section 2). It can be built from matrices alone and knows no robot.

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
/// It runs on any [`Real`]; [`ContactProblem::map`] makes one in another number. [`Analysis`](crate::Analysis) has an
/// example.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ContactProblem<T = f64> {
    /// G, 2n x 2n by rows \[1/kg\].
    delassus: Vec<T>,
    /// c- of the given state \[m/s\].
    velocity_before: Vec<Pair<T>>,
    /// c- and the effect of applied impulses \[m/s\].
    velocity_free: Vec<Pair<T>>,
    /// min(c_n-, 0) \[m/s\].
    approach: Vec<T>,
    laws: Vec<Law>,
    restitution: Vec<f64>,
    /// What [`Source::shared_tangent`] says of each contact; empty if nothing is known.
    shared: Vec<Option<usize>>,
    origin: Origin,
}

/// What the numbers of a problem that is its own source come from.
#[derive(Debug, Clone, Default, PartialEq)]
enum Origin {
    #[default]
    Given,
    /// G and c- were computed from M, J and v.
    Dynamics(Box<Dynamics>),
    /// A given G was asymmetric by its rounding, and was replaced by its mean with its transpose, which is positive definite
    /// beyond doubt.
    Symmetrized,
    /// A given G was indefinite by its rounding, and was replaced by Z Z^T.
    Repaired(FactorRows),
}

impl<T: Real> ContactProblem<T> {
    /// Number of contacts n.
    pub fn contacts(&self) -> usize {
        self.velocity_before.len()
    }

    /// Entry of the Delassus matrix; rows and columns 2i (tangential) and 2i + 1 (normal) belong to contact i.
    pub fn delassus(&self, row: usize, column: usize) -> T {
        self.delassus[row * 2 * self.contacts() + column]
    }

    /// Contact velocities of the given state, before any applied impulse \[m/s\].
    pub fn velocity_before(&self) -> &[Pair<T>] {
        &self.velocity_before
    }

    /// The same problem with another law for all contacts.
    pub(crate) fn under(&self, law: Law) -> Self {
        Self { laws: vec![law; self.contacts()], ..self.clone() }
    }

    /// Contact velocities if the ground gave no impulse \[m/s\].
    pub fn velocity_free(&self) -> &[Pair<T>] {
        &self.velocity_free
    }

    /// The law of each contact.
    pub fn laws(&self) -> &[Law] {
        &self.laws
    }

    /// Friction of each contact.
    pub fn friction(&self) -> impl Iterator<Item = Friction> {
        self.laws.iter().map(Law::friction)
    }

    /// Newton restitution of each contact.
    pub fn restitution(&self) -> &[f64] {
        &self.restitution
    }

    /// What Newton's law adds to c_n+: e min(c_n-, 0), so that xi_n = c_n+ + bounce (Moreau's form) \[m/s\].
    pub fn bounce(&self, contact: usize) -> T {
        T::from_f64(self.restitution[contact]) * self.approach[contact]
    }

    /// A row's velocity without impulses, with the bounce on a normal row: c_t, or xi_n = c_n + bounce.
    pub fn free_row(&self, row: usize) -> T {
        let free = self.velocity_free[row / 2][row % 2];
        if row % 2 == 1 && self.restitution[row / 2] != 0.0 { free + self.bounce(row / 2) } else { free }
    }

    /// The contact whose tangential row this one has as well, if that is known.
    pub(super) fn shared_tangent(&self, contact: usize) -> Option<usize> {
        self.shared.get(contact).copied().flatten()
    }

    /// The same problem in another number.
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
    /// A problem from numbers whose signs depend on their precision, already known to be one in f64.
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
            // Not a number, so that everything that depends on it stays open.
            Sign::Undecided => T::one() / T::zero(),
        };
        let approach = velocity_before.iter().map(approach).collect();
        let (shared, origin) = (Vec::new(), Origin::Given);
        Self { delassus, velocity_before, velocity_free, approach, laws, restitution, shared, origin }
    }

    /// The same problem, in which it is known which contacts share their tangential rows.
    pub(super) fn sharing(self, shared: Vec<Option<usize>>) -> Self {
        Self { shared, ..self }
    }
}

impl ContactProblem {
    /// A problem from its matrices: `delassus` 2n x 2n by rows, rows and columns [tangential, normal] per contact
    /// \[1/kg\]; `velocity_before` \[m/s\], `friction` and `restitution` (0 to 1) one entry per contact.
    ///
    /// # Errors
    /// Lengths that do not fit, more contacts than [`MATRIX_LIMIT`], numbers that are not finite, negative friction,
    /// restitution outside 0..1, and a Delassus matrix that is asymmetric or indefinite: each entry counts against the
    /// geometric mean of its own two diagonal entries, beyond rounding.
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

    /// Whether G and c- themselves were given, and every digit of them is meant.
    pub fn is_given(&self) -> bool {
        matches!(self.origin, Origin::Given)
    }

    /// Takes the mean of G and its transpose; false if G is symmetric.
    fn symmetrize(&mut self) -> bool {
        let rows = 2 * self.contacts();
        let mut found = false;
        for (i, j) in (0..rows).flat_map(|i| (0..i).map(move |j| (i, j))) {
            let (own, other) = (self.delassus(i, j), self.delassus(j, i));
            if own != other {
                // Half of each, since their sum may overflow.
                let mean = 0.5 * own + 0.5 * other;
                (self.delassus[i * rows + j], self.delassus[j * rows + i]) = (mean, mean);
                found = true;
            }
        }
        found
    }

    /// Whether the G that was given is asymmetric, by rounding alone, and was replaced by one that is not.
    pub fn is_symmetrized(&self) -> bool {
        matches!(self.origin, Origin::Symmetrized)
    }

    /// Whether the G that was given is indefinite, by rounding alone, and was replaced by one that is not.
    pub fn is_repaired(&self) -> bool {
        matches!(self.origin, Origin::Repaired(_))
    }

    /// A problem from parts that the dynamics computed: G, c-, and c- with the change by applied impulses.
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

    /// Becomes another problem, as [`ContactProblem::checked`], with the friction and restitution of each contact.
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

    /// The same problem, without applied impulses, for the nearest f64 of another `velocity` before, and what these are
    /// off by \[m/s\].
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
        // Units of each row do not matter, and powers of two do not round.
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
        // No pair is at fault, but three together are: what the elimination leaves of the last one is negative.
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
        let [exact, rounded] = [exact, rounded].map(|own| crate::impact::analyze(&own, false.into()).unwrap());
        assert!(exact.proven && rounded.proven);
        assert_eq!(exact.outcomes[0].modes, rounded.outcomes[0].modes);
        // Rows that are equal but for the digit that makes it asymmetric: the mean is definite by that digit alone.
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
