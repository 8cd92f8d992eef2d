//! The contact problem: what is left of robot and state once only the contacts matter.
//!
//! ```text
//!     c+ = c_free + G L,    c_free = c- + (effect of applied impulses)
//! ```
//!
//! with the laws of each contact (paper, section 2). It can be built from matrices alone and knows no robot.

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

/// Matrices are formed for at most so many contacts, whether or not their outcomes are sought.
pub const MATRIX_LIMIT: usize = 500;

/// Refuses more contacts than [`MATRIX_LIMIT`].
///
/// # Errors
/// [`Reason::MatricesTooLarge`].
pub(crate) fn check_matrix_size(contacts: usize) -> Result<()> {
    if contacts <= MATRIX_LIMIT {
        return Ok(());
    }
    let reason = Reason::MatricesTooLarge { contacts, limit: MATRIX_LIMIT };
    Err(Error::new(reason).hint("name the contacts that matter by hand, or lower the contact tolerance"))
}

impl ContactProblem {
    /// A problem from its matrices: `delassus` 2n x 2n by rows, rows and columns [tangential, normal] per contact \[1/kg\];
    /// `velocity_before` \[m/s\], `friction` and `restitution` (0 to 1) one entry per contact.
    ///
    /// # Errors
    /// Lengths that do not fit, more contacts than [`MATRIX_LIMIT`], numbers that are not finite, negative friction, restitution outside 0..1, and a Delassus
    /// matrix that is asymmetric or indefinite beyond the rounding of its largest entry.
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
        for (place, length) in [("friction", friction.len()), ("restitution", restitution.len())] {
            if length != contacts {
                return Err(Error::new(Reason::Inconsistent(format!("{contacts} contacts, but {length} values")))
                    .at(place)
                    .hint("give one number for all contacts or a list with one entry per contact"));
            }
        }
        for (index, &entry) in delassus.iter().enumerate() {
            finite(entry, || format!("entry [{}][{}] of delassus", index / rows, index % rows))?;
        }
        let problem = Self {
            delassus,
            velocity_free: velocity_before.clone(),
            approach: approach(&velocity_before),
            velocity_before,
            friction,
            restitution,
            factor: None,
            noise: None,
        };
        problem.check_contacts()?;
        problem.check_range()?;
        problem.check_definite()?;
        Ok(problem)
    }

    /// A problem from the dynamics, so that exact redundancy survives where a rounded G would lose it: M (dofs x dofs), J
    /// (two rows per contact: tangential, normal; dofs columns), v (dofs).
    ///
    /// # Errors
    /// As [`ContactProblem::new`]; also a mass matrix that is asymmetric or not positive definite.
    pub fn from_dynamics(
        mass_matrix: &[Vec<f64>],
        contact_jacobian: &[Vec<f64>],
        velocity: &[f64],
        friction: Vec<Friction>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        let dofs = velocity.len();
        check_matrix_size(friction.len())?;
        let shape = |place: &'static str, matrix: &[Vec<f64>], rows: usize| {
            let fits = matrix.len() == rows && matrix.iter().all(|row| row.len() == dofs);
            if fits {
                return matrix
                    .iter()
                    .flatten()
                    .try_for_each(|&entry| finite(entry, || format!("an entry of {place}")).map(drop));
            }
            Err(Error::new(Reason::Inconsistent(format!("{place} must have {rows} rows of {dofs} numbers")))
                .at(place)
                .hint("its columns are the entries of `velocity`"))
        };
        shape("mass_matrix", mass_matrix, dofs)?;
        shape("contact_jacobian", contact_jacobian, 2 * friction.len())?;
        for &entry in velocity {
            finite(entry, || "an entry of velocity".into())?;
        }
        let cholesky = dense_cholesky(mass_matrix)?;
        let mut rows = Vec::with_capacity(contact_jacobian.len() * dofs);
        for row in contact_jacobian {
            rows.extend(forward_substituted(&cholesky, row));
        }
        let pairs = || contact_jacobian.chunks_exact(2);
        let products =
            |row: &[f64], size: fn(f64) -> f64| row.iter().zip(velocity).map(|(j, v)| size(j * v)).sum::<f64>();
        let before = pairs().map(|pair| [0, 1].map(|k| products(&pair[k], |product| product))).collect();
        let noise = pairs().map(|pair| [0, 1].map(|k| VELOCITY_ROUNDING * products(&pair[k], f64::abs))).collect();
        Self::from_factor(Factor { rows, columns: dofs }, before, noise, friction, restitution)
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
        let row = |i: usize| &factor.rows[i * factor.columns..(i + 1) * factor.columns];
        let count = 2 * velocity_before.len();
        let mut delassus = vec![0.0; count * count];
        for i in 0..count {
            for j in 0..=i {
                let entry = row(i).iter().zip(row(j)).map(|(a, b)| a * b).sum();
                let entry = finite(entry, || format!("entry [{i}][{j}] of J M^-1 J^T"))?;
                delassus[i * count + j] = entry;
                delassus[j * count + i] = entry;
            }
        }
        let problem = Self {
            delassus,
            velocity_free: velocity_before.clone(),
            approach: approach(&velocity_before),
            velocity_before,
            friction,
            restitution,
            factor: Some(factor),
            noise: Some(noise),
        };
        problem.check_contacts()?;
        problem.check_range()?;
        Ok(problem)
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
        let approach = approach(&velocity_before);
        let (factor, noise) = (Some(factor), Some(noise));
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

    /// Products of two entries of G must stay far from overflow and underflow.
    fn check_range(&self) -> Result<()> {
        let rows = 2 * self.contacts();
        for row in 0..rows {
            let diagonal = finite(self.delassus(row, row), || format!("delassus[{row}][{row}]"))?;
            if diagonal > 0.0 && !(SMALLEST_MOBILITY..LARGEST_MOBILITY).contains(&diagonal) {
                let what = format!("delassus[{row}][{row}]");
                let allowed = "0 or between 1e-120 and 1e120 1/kg";
                return Err(Error::new(Reason::OutOfRange { what, allowed, value: diagonal })
                    .hint("choose units of mass and length nearer to the robot's own"));
            }
        }
        Ok(())
    }

    fn check_contacts(&self) -> Result<()> {
        for (contact, velocity) in self.velocity_before.iter().enumerate() {
            for &entry in velocity {
                finite(entry, || format!("velocity_before of contact {contact}"))?;
            }
            for entry in self.velocity_free[contact] {
                finite(entry, || format!("the velocity of contact {contact} after the applied impulses"))?;
            }
            if let Friction::Finite(mu) = self.friction[contact]
                && !(mu.is_finite() && mu >= 0.0)
            {
                let allowed = "zero, positive or \"infinite\"";
                return Err(Error::new(Reason::OutOfRange { what: "friction".into(), allowed, value: mu })
                    .at(format!("friction of contact {contact}")));
            }
            let restitution = self.restitution[contact];
            if !(0.0..=1.0).contains(&restitution) {
                let allowed = "between 0 and 1";
                return Err(Error::new(Reason::OutOfRange { what: "restitution".into(), allowed, value: restitution })
                    .at(format!("restitution of contact {contact}")));
            }
        }
        Ok(())
    }

    /// Symmetry entry by entry, then definiteness by elimination with diagonal pivoting, both to n eps of the largest
    /// entry.
    fn check_definite(&self) -> Result<()> {
        let rows = 2 * self.contacts();
        let largest = self.delassus.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let rounding = 4.0 * rows as f64 * f64::EPSILON * largest;
        let mut rest = nalgebra::DMatrix::from_row_slice(rows, rows, &self.delassus);
        for i in 0..rows {
            for j in 0..i {
                if (rest[(i, j)] - rest[(j, i)]).abs() > rounding {
                    return Err(Error::new(Reason::Inconsistent(format!(
                        "the Delassus matrix is not symmetric: {} against {}",
                        rest[(i, j)],
                        rest[(j, i)]
                    )))
                    .at(format!("delassus[{i}][{j}]"))
                    .hint("G = J M^-1 J^T is symmetric; check the order of rows and columns"));
                }
            }
        }
        for _ in 0..rows {
            let Some(pivot) = (0..rows).max_by(|&i, &j| rest[(i, i)].total_cmp(&rest[(j, j)])) else { break };
            let indefinite = (0..rows).find(|&i| rest[(i, i)] < -rounding);
            let coupled = || (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j)));
            let stray = (rest[(pivot, pivot)] <= rounding)
                .then(|| coupled().find(|&(i, j)| rest[(i, j)].abs() > 4.0 * rounding))
                .flatten();
            if let Some((i, j)) = indefinite.map(|i| (i, i)).or(stray) {
                return Err(Error::new(Reason::Inconsistent(
                    "the Delassus matrix is indefinite: an impulse there would gain energy".into(),
                ))
                .at(format!("delassus[{i}][{j}]"))
                .hint("G = J M^-1 J^T is positive semidefinite; check signs and units"));
            }
            let diagonal = rest[(pivot, pivot)];
            if diagonal <= rounding {
                break;
            }
            let column = rest.column(pivot).clone_owned();
            for i in 0..rows {
                for j in 0..rows {
                    rest[(i, j)] -= column[i] * column[j] / diagonal;
                }
            }
        }
        Ok(())
    }
}

/// What a product J v loses to rounding, relative to the sum of its terms' magnitudes.
pub(crate) const VELOCITY_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Diagonal entries of G outside these would let products of two of them underflow or overflow \[1/kg\].
const SMALLEST_MOBILITY: f64 = 1e-120;
const LARGEST_MOBILITY: f64 = 1e120;

/// min(c_n-, 0) of each contact.
fn approach(velocity_before: &[Vector<f64>]) -> Vec<f64> {
    velocity_before.iter().map(|c| c[1].min(0.0)).collect()
}

/// Lower Cholesky factor of a dense symmetric matrix, by rows.
fn dense_cholesky(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
    let size = matrix.len();
    let largest = matrix.iter().flatten().fold(0.0, |most: f64, entry| most.max(entry.abs()));
    let rounding = 4.0 * size as f64 * f64::EPSILON * largest;
    if let Some(place) = (0..size).find(|&i| matrix[i][i] < 0.0) {
        let (what, value) = ("an entry of the mass matrix's diagonal".into(), matrix[place][place]);
        return Err(Error::new(Reason::OutOfRange { what, allowed: "positive", value })
            .at(format!("mass_matrix[{place}][{place}]")));
    }
    let mut lower = vec![vec![0.0; size]; size];
    for i in 0..size {
        for j in 0..=i {
            if (matrix[i][j] - matrix[j][i]).abs() > rounding {
                return Err(Error::new(Reason::Inconsistent("the mass matrix is not symmetric".into()))
                    .at(format!("mass_matrix[{i}][{j}]")));
            }
            let rest = matrix[i][j] - (0..j).map(|k| lower[i][k] * lower[j][k]).sum::<f64>();
            if i != j {
                lower[i][j] = rest / lower[j][j];
            } else if rest > 4.0 * size as f64 * f64::EPSILON * matrix[i][i] {
                lower[i][i] = rest.sqrt();
            } else {
                return Err(Error::new(Reason::Singular(format!("coordinate {i}")))
                    .at(format!("mass_matrix[{i}][{i}]"))
                    .hint("every coordinate needs inertia: add a mass, or a rotor inertia on the diagonal"));
            }
        }
    }
    Ok(lower)
}

/// y with `lower` y = `right`.
fn forward_substituted(lower: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let mut y = Vec::with_capacity(right.len());
    for (row, &entry) in lower.iter().zip(right) {
        let known: f64 = row.iter().zip(&y).map(|(a, b)| a * b).sum();
        y.push((entry - known) / row[y.len()]);
    }
    y
}

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
