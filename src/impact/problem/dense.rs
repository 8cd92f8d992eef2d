//! Contact problems from M, J and v as dense matrices.

use super::checks::check_matrix_size;
use super::{ContactProblem, Origin};
use crate::error::{Error, Reason, Result, finite};
use crate::law::Law;
use crate::planar::Pair;
use crate::scalar::{Real, dot, subtract};

/// M, J and v, as given if M is symmetric.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dynamics {
    /// dofs x dofs, by rows.
    mass_matrix: Vec<Vec<f64>>,
    /// Whether M was asymmetric by rounding and was replaced by its mean with its transpose.
    pub is_symmetrized: bool,
    /// Two rows per contact, dofs columns.
    contact_jacobian: Vec<Vec<f64>>,
    /// The velocity of each coordinate, dofs entries.
    velocity: Vec<f64>,
}

impl Dynamics {
    /// Computes G = J M^-1 J^T by rows and c = J v in numbers of any kind. The elimination needs no pivoting because M
    /// is positive definite. Also returns the pivots that it leaves on M's diagonal.
    pub fn numbers<T: Real>(&self) -> (Vec<T>, Vec<Pair<T>>, Vec<T>) {
        let dofs = self.velocity.len();
        let exact = |matrix: &[Vec<f64>]| -> Vec<Vec<T>> {
            matrix.iter().map(|row| row.iter().map(|&entry| T::from_f64(entry)).collect()).collect()
        };
        let (mut mass, jacobian) = (exact(&self.mass_matrix), exact(&self.contact_jacobian));
        let mut forward = jacobian.clone();
        for k in 0..dofs {
            for i in k + 1..dofs {
                let factor = mass[i][k] / mass[k][k];
                let (above, below) = mass.split_at_mut(i);
                subtract(&mut below[0][k..], &above[k][k..], factor);
                for right in &mut forward {
                    right[i] = right[i] - factor * right[k];
                }
            }
        }
        // Both orders of the product are averaged, so that G is symmetric in f64 and equal rows have equal entries.
        let divided = |row: &Vec<T>| (0..dofs).map(|k| row[k] / mass[k][k]).collect();
        let quotients: Vec<Vec<T>> = forward.iter().map(divided).collect();
        let entry = |i: usize, j: usize| dot(&quotients[i], &forward[j]) + dot(&quotients[j], &forward[i]);
        let rows = forward.len();
        let delassus = (0..rows * rows).map(|at| entry(at / rows, at % rows) * T::from_f64(0.5)).collect();
        let velocity: Vec<T> = self.velocity.iter().map(|&entry| T::from_f64(entry)).collect();
        let before =
            jacobian.chunks_exact(2).map(|pair| [dot(&pair[0], &velocity), dot(&pair[1], &velocity)]).collect();
        (delassus, before, (0..dofs).map(|k| mass[k][k]).collect())
    }
}

impl ContactProblem {
    /// Builds a problem from the dynamics: M (dofs x dofs), J (two rows per contact, tangential then normal; dofs
    /// columns) and v (dofs), in consistent units. Exactly redundant contacts stay so, which a rounded G would not
    /// preserve.
    ///
    /// # Errors
    /// Returns the errors of [`ContactProblem::new`], and one if the mass matrix is asymmetric or not positive
    /// definite.
    pub fn from_dynamics(
        mass_matrix: &[Vec<f64>],
        contact_jacobian: &[Vec<f64>],
        velocity: &[f64],
        friction: Vec<impl Into<Law>>,
        restitution: Vec<f64>,
    ) -> Result<Self> {
        let dofs = velocity.len();
        check_matrix_size(friction.len())?;
        let shape = |place: &'static str, matrix: &[Vec<f64>], rows: usize| {
            if matrix.len() != rows || matrix.iter().any(|row| row.len() != dofs) {
                let reason = Reason::Inconsistent(format!("{place} must have {rows} rows of {dofs} numbers"));
                return Err(Error::new(reason).at(place).hint("its columns are the entries of \"velocity\""));
            }
            let mut entries = matrix.iter().flatten();
            entries.try_for_each(|&entry| finite(entry, || format!("an entry of {place}")).map(drop))
        };
        shape("mass_matrix", mass_matrix, dofs)?;
        shape("contact_jacobian", contact_jacobian, 2 * friction.len())?;
        for &entry in velocity {
            finite(entry, || "an entry of velocity".into())?;
        }
        check_symmetry(mass_matrix)?;
        // Each is halved first, because their sum may overflow.
        let mean = |a: f64, b: f64| if a == b { a } else { 0.5 * a + 0.5 * b };
        let row = |i: usize| (0..dofs).map(|j| mean(mass_matrix[i][j], mass_matrix[j][i])).collect();
        let symmetric: Vec<Vec<f64>> = (0..dofs).map(row).collect();
        let dynamics = Dynamics {
            is_symmetrized: symmetric != mass_matrix,
            mass_matrix: symmetric,
            contact_jacobian: contact_jacobian.to_vec(),
            velocity: velocity.to_vec(),
        };
        let (delassus, before, left) = dynamics.numbers::<f64>();
        let rounding = 4.0 * dofs as f64 * f64::EPSILON;
        let is_lost = |&k: &usize| left[k].is_nan() || left[k] <= rounding * dynamics.mass_matrix[k][k];
        if let Some(k) = (0..dofs).find(is_lost) {
            return Err(Error::new(Reason::Singular(format!("coordinate {k}")))
                .at(format!("mass_matrix[{k}][{k}]"))
                .hint("every coordinate needs inertia: add a mass, or a rotor inertia on the diagonal"));
        }
        for (at, &entry) in delassus.iter().enumerate() {
            let rows = 2 * before.len();
            finite(entry, || format!("entry [{}][{}] of J M^-1 J^T", at / rows, at % rows))?;
        }
        let mut problem = Self::checked(delassus, before.clone(), before, friction, restitution)?;
        problem.origin = Origin::Dynamics(Box::new(dynamics));
        Ok(problem)
    }
}

fn check_symmetry(mass_matrix: &[Vec<f64>]) -> Result<()> {
    let size = mass_matrix.len();
    if let Some(place) = (0..size).find(|&i| mass_matrix[i][i] < 0.0) {
        let (what, value) = ("an entry of the mass matrix's diagonal".into(), mass_matrix[place][place]);
        return Err(Error::new(Reason::OutOfRange { what, allowed: "positive", value })
            .at(format!("mass_matrix[{place}][{place}]")));
    }
    let rounding = 4.0 * size as f64 * f64::EPSILON;
    let differs = |&(i, j): &(usize, usize)| {
        let scale = mass_matrix[i][i].sqrt() * mass_matrix[j][j].sqrt();
        (mass_matrix[i][j] - mass_matrix[j][i]).abs() > rounding * scale
    };
    match (0..size).flat_map(|i| (0..i).map(move |j| (i, j))).find(differs) {
        Some((i, j)) => Err(Error::new(Reason::Inconsistent("the mass matrix is not symmetric".into()))
            .at(format!("mass_matrix[{i}][{j}]"))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;

    /// Equal contacts have equal entries in f64, too.
    #[test]
    fn equal_contacts_have_equal_entries() {
        let mass = [vec![2.3, 0.7, -0.4], vec![0.7, 1.9, 0.3], vec![-0.4, 0.3, 0.8]];
        let [tangential, normal] = [[0.9, -0.1, 0.37], [0.21, 1.1, -0.43]].map(|row| row.to_vec());
        let rows = [&tangential, &normal, &tangential, &normal].map(Clone::clone);
        let velocity = [0.1, -1.0, 0.2];
        let problem = ContactProblem::from_dynamics(&mass, &rows, &velocity, vec![Friction::ZERO; 2], vec![0.0; 2]);
        let problem = problem.expect("valid");
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            assert_eq!(problem.delassus(i, j), problem.delassus(i % 2, j % 2), "{i} {j}");
            assert_eq!(problem.delassus(i, j), problem.delassus(j, i), "{i} {j}");
        }
    }

    /// Neither products of two rows nor the pivots of M leave the range of f64 before G does.
    #[test]
    fn a_problem_in_far_units_is_refused_with_its_size() {
        for unit in [1e-200, 1e200] {
            let square = [vec![unit, 0.0], vec![0.0, unit]];
            let found = ContactProblem::from_dynamics(&square, &square, &[1.0, -1.0], vec![Friction::ZERO], vec![0.0]);
            let error = found.expect_err("out of range");
            assert!(matches!(error.reason(), Reason::OutOfRange { value, .. } if *value == unit), "{error}");
        }
    }
}
