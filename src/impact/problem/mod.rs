//! The contact problem: what is left of robot and state once only the contacts matter.
//!
//! ```text
//!     c+ = c_free + G L,    c_free = c- + (effect of applied impulses)
//! ```
//!
//! with the laws of each contact (paper, section 2). It can be built from matrices alone and knows no robot.

mod checks;
mod dense;

pub use checks::MATRIX_LIMIT;
pub(crate) use checks::check_matrix_size;

use super::mode::Friction;
use crate::error::{Error, Reason, Result, finite};
use crate::planar::Vector;
use crate::scalar::Real;

/// A contact problem of n contacts; vectors have two entries per contact, [tangential, normal].
///
/// It runs on any [`Real`]; whoever fills one in another number fills it by [`ContactProblem::map`].
#[derive(Debug, Clone)]
pub struct ContactProblem<T = f64> {
    /// G, 2n x 2n by rows \[1/kg\].
    delassus: Vec<T>,
    /// c- of the given state \[m/s\].
    velocity_before: Vec<Vector<T>>,
    /// c- and the effect of applied impulses \[m/s\].
    velocity_free: Vec<Vector<T>>,
    /// min(c_n-, 0) \[m/s\].
    approach: Vec<T>,
    friction: Vec<Friction>,
    restitution: Vec<f64>,
    /// Z, 2n rows with G = Z Z^T, where it is known better than from G.
    factor: Option<Factor>,
    /// What the velocities may be off by, where they were computed; none where they were given \[m/s\].
    noise: Option<Vec<Vector<f64>>>,
}

/// Rows Z with G = Z Z^T; their singular values show the rank that rounding hides in G.
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    /// Two rows per contact, one after the other \[1/sqrt(kg)\].
    pub rows: Vec<f64>,
    /// Length of a row.
    pub columns: usize,
}

/// What a number of a problem is; rows 2i (tangential) and 2i + 1 (normal) belong to contact i.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entry {
    /// An entry of the Delassus matrix.
    Delassus {
        /// Its row.
        row: usize,
        /// Its column.
        column: usize,
    },
    /// An entry of a contact velocity.
    Velocity {
        /// Its row.
        row: usize,
    },
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
    pub fn velocity_before(&self) -> &[Vector<T>] {
        &self.velocity_before
    }

    /// Contact velocities if the ground gave no impulse \[m/s\].
    pub fn velocity_free(&self) -> &[Vector<T>] {
        &self.velocity_free
    }

    /// Friction of each contact.
    pub fn friction(&self) -> &[Friction] {
        &self.friction
    }

    /// Newton restitution of each contact.
    pub fn restitution(&self) -> &[f64] {
        &self.restitution
    }

    /// What Newton's law adds to c_n+: e min(c_n-, 0), so that xi_n = c_n+ + bounce (Moreau's form) \[m/s\].
    pub fn bounce(&self, contact: usize) -> T {
        T::from_f64(self.restitution[contact]) * self.approach[contact]
    }

    /// The same problem in another number.
    pub fn map<U: Real>(&self, number: impl Fn(T) -> U) -> ContactProblem<U> {
        self.map_entries(|_, value| number(value))
    }

    /// The same problem in another number, which may depend on what the entry is.
    pub fn map_entries<U: Real>(&self, number: impl Fn(Entry, T) -> U) -> ContactProblem<U> {
        let rows = 2 * self.contacts();
        let delassus = |index: usize| Entry::Delassus { row: index / rows, column: index % rows };
        let vectors = |list: &[Vector<T>]| -> Vec<Vector<U>> {
            let vector = |(i, c): (usize, &Vector<T>)| [0, 1].map(|k| number(Entry::Velocity { row: 2 * i + k }, c[k]));
            list.iter().enumerate().map(vector).collect()
        };
        let approach = |(i, &c): (usize, &T)| number(Entry::Velocity { row: 2 * i + 1 }, c);
        ContactProblem {
            delassus: self.delassus.iter().enumerate().map(|(index, &entry)| number(delassus(index), entry)).collect(),
            velocity_before: vectors(&self.velocity_before),
            velocity_free: vectors(&self.velocity_free),
            approach: self.approach.iter().enumerate().map(approach).collect(),
            friction: self.friction.clone(),
            restitution: self.restitution.clone(),
            factor: None,
            noise: None,
        }
    }
}

impl ContactProblem {
    /// A problem from its matrices: `delassus` 2n x 2n by rows, rows and columns [tangential, normal] per contact \[1/kg\];
    /// `velocity_before` \[m/s\], `friction` and `restitution` (0 to 1) one entry per contact.
    ///
    /// # Errors
    /// Lengths that do not fit, more contacts than [`MATRIX_LIMIT`], numbers that are not finite, negative friction,
    /// restitution outside 0..1, and a Delassus matrix that is asymmetric or indefinite beyond the rounding of its largest
    /// entry.
    pub fn new(
        delassus: Vec<f64>,
        velocity_before: Vec<Vector<f64>>,
        friction: Vec<Friction>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        let contacts = velocity_before.len();
        check_matrix_size(contacts)?;
        let rows = 2 * contacts;
        if delassus.len() != rows * rows {
            return Err(Error::new(Reason::Inconsistent(format!(
                "{contacts} contacts need a Delassus matrix of {rows} x {rows} entries, not {}",
                delassus.len()
            )))
            .at("delassus")
            .hint("give two rows and columns per contact: tangential, normal"));
        }
        for (index, &entry) in delassus.iter().enumerate() {
            finite(entry, || format!("entry [{}][{}] of delassus", index / rows, index % rows))?;
        }
        let free = velocity_before.clone();
        let problem = Self::checked(delassus, (velocity_before, free), (friction, restitution), None)?;
        problem.check_definite()?;
        Ok(problem)
    }

    /// A problem from the rows Z of G = Z Z^T (two per contact, each of `columns` entries), and from velocities known up to
    /// `noise`.
    ///
    /// # Errors
    /// As [`ContactProblem::new`].
    pub fn from_factor(
        factor: Factor,
        velocity_before: Vec<Vector<f64>>,
        noise: Vec<Vector<f64>>,
        friction: Vec<Friction>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        check_matrix_size(velocity_before.len())?;
        let count = 2 * velocity_before.len();
        if factor.rows.len() != count * factor.columns {
            return Err(Error::new(Reason::Inconsistent(format!(
                "{count} rows of {} entries are needed, not {} entries",
                factor.columns,
                factor.rows.len()
            )))
            .at("factor")
            .hint("give two rows per contact: tangential, normal"));
        }
        let row = |i: usize| &factor.rows[i * factor.columns..(i + 1) * factor.columns];
        let mut delassus = vec![0.0; count * count];
        for i in 0..count {
            for j in 0..=i {
                let entry = row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum();
                let entry = finite(entry, || format!("entry [{i}][{j}] of J M^-1 J^T"))?;
                delassus[i * count + j] = entry;
                delassus[j * count + i] = entry;
            }
        }
        let free = velocity_before.clone();
        Self::checked(delassus, (velocity_before, free), (friction, restitution), Some((factor, noise)))
    }

    /// A problem from parts that the dynamics computed: G with its factor, c-, the change by applied impulses included in
    /// `velocity_free`, and what these velocities may be off by.
    ///
    /// # Errors
    /// As [`ContactProblem::new`], of numbers that overflowed or lie outside the range.
    pub(crate) fn from_parts(
        (delassus, factor): (Vec<f64>, Factor),
        velocity_before: Vec<Vector<f64>>,
        velocity_free: Vec<Vector<f64>>,
        noise: Vec<Vector<f64>>,
        friction: Vec<Friction>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        Self::checked(delassus, (velocity_before, velocity_free), (friction, restitution), Some((factor, noise)))
    }

    /// The one place where a problem is put together; `computed` is its factor and noise, none where G was given.
    fn checked(
        delassus: Vec<f64>,
        (velocity_before, velocity_free): (Vec<Vector<f64>>, Vec<Vector<f64>>),
        (friction, restitution): (Vec<Friction>, Vec<f64>),
        computed: Option<(Factor, Vec<Vector<f64>>)>,
    ) -> Result<Self> {
        let contacts = velocity_before.len();
        let noise = computed.as_ref().map_or(contacts, |(_, noise)| noise.len());
        for (place, length) in
            [("friction", friction.len()), ("restitution", restitution.len()), ("noise of the velocities", noise)]
        {
            if length != contacts {
                return Err(Error::new(Reason::Inconsistent(format!("{contacts} contacts, but {length} values")))
                    .at(place)
                    .hint("give one number for all contacts or a list with one entry per contact"));
            }
        }
        let approach = velocity_before.iter().map(|c| c[1].min(0.0)).collect();
        let (factor, noise) = computed.unzip();
        let problem = Self { delassus, velocity_before, velocity_free, approach, friction, restitution, factor, noise };
        problem.check_contacts()?;
        problem.check_range()?;
        Ok(problem)
    }

    /// Z with G = Z Z^T, where the problem was built from the dynamics.
    pub fn factor(&self) -> Option<&Factor> {
        self.factor.as_ref()
    }

    /// What the velocities may be off by \[m/s\]; none where they were given.
    pub fn noise(&self) -> Option<&[Vector<f64>]> {
        self.noise.as_deref()
    }
}

/// What a product J v loses to rounding, relative to the sum of its terms' magnitudes.
pub(crate) const VELOCITY_ROUNDING: f64 = 8.0 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::*;

    fn problem(delassus: Vec<f64>) -> Result<ContactProblem> {
        ContactProblem::new(delassus, vec![[0.0, -1.0]], vec![Friction::Infinite], vec![0.0])
    }

    #[test]
    fn asymmetric_and_indefinite_matrices_are_refused_with_the_entry() {
        assert_eq!(problem(vec![2.0, 1.0, 1.5, 2.0]).unwrap_err().place(), Some("delassus[1][0]"));
        assert_eq!(problem(vec![1.0, 2.0, 2.0, 1.5]).unwrap_err().place(), Some("delassus[0][0]"));
        assert!(problem(vec![0.0, 1.0, 1.0, 0.0]).is_err());
        assert!(problem(vec![1.0, 2.0, 2.0, 4.0]).is_ok(), "singular is not indefinite");
        assert!(problem(vec![2.0, 1.0, 1.0, f64::NAN]).is_err());
    }

    #[test]
    fn lengths_that_do_not_fit_are_refused_however_it_is_built() {
        let (one, two) = (vec![Friction::Infinite], vec![Friction::Infinite; 2]);
        let identity = [vec![1.0, 0.0], vec![0.0, 1.0]];
        let place = |problem: Result<ContactProblem>| problem.unwrap_err().place().map(str::to_owned);
        let given = ContactProblem::new(vec![1.0, 0.0, 0.0, 1.0], vec![[0.0, -1.0]], two.clone(), vec![0.0]);
        assert_eq!(place(given).as_deref(), Some("friction"));
        let dynamics = ContactProblem::from_dynamics(&identity, &identity, &[0.0, -1.0], one.clone(), vec![]);
        assert_eq!(place(dynamics).as_deref(), Some("restitution"));
        let factor = |rows: usize| Factor { rows: vec![1.0; rows], columns: 2 };
        let build =
            |rows, noise| ContactProblem::from_factor(factor(rows), vec![[0.0, -1.0]], noise, one.clone(), vec![0.0]);
        assert_eq!(place(build(3, vec![[0.0; 2]])).as_deref(), Some("factor"));
        assert_eq!(place(build(4, vec![])).as_deref(), Some("noise of the velocities"));
    }

    #[test]
    fn dynamics_and_delassus_give_the_same_problem() {
        let (mass, jacobian) = (vec![vec![4.0, 2.0], vec![2.0, 3.0]], vec![vec![1.0, 0.0], vec![1.0, 2.0]]);
        let built =
            ContactProblem::from_dynamics(&mass, &jacobian, &[0.5, -1.0], vec![Friction::Infinite], vec![0.0]).unwrap();
        // M^-1 = 1/8 [[3, -2], [-2, 4]].
        let by_hand = [[3.0, -1.0], [-1.0, 11.0]].map(|row| row.map(|entry| entry / 8.0));
        for (i, row) in by_hand.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                // Two roundings a step on numbers of order one.
                assert!((built.delassus(i, j) - entry).abs() < 8.0 * f64::EPSILON);
            }
        }
        assert_eq!(built.velocity_before(), [[0.5, -1.5]]);
    }
}
