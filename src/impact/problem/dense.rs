//! A problem from M, J and v as dense matrices.

use super::checks::check_matrix_size;
use super::{ContactProblem, Origin};
use crate::error::{Error, Reason, Result, finite};
use crate::law::Law;
use crate::planar::Pair;
use crate::scalar::{Real, dot, subtract};

/// M, J and v as they were given, every digit meant; of M only what is on and below its diagonal.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Dynamics {
    /// dofs x dofs.
    mass_matrix: Vec<Vec<f64>>,
    /// Two rows per contact, dofs columns.
    contact_jacobian: Vec<Vec<f64>>,
    /// dofs.
    velocity: Vec<f64>,
}

impl Dynamics {
    /// G = J M^-1 J^T by rows and c = J v in numbers of any kind, without pivoting: M is positive definite.
    pub fn numbers<T: Real>(&self) -> (Vec<T>, Vec<Pair<T>>) {
        let dofs = self.velocity.len();
        let lower = |i: usize, j: usize| T::from_f64(self.mass_matrix[i.max(j)][i.min(j)]);
        let mut mass: Vec<Vec<T>> = (0..dofs).map(|i| (0..dofs).map(|j| lower(i, j)).collect()).collect();
        let jacobian: Vec<Vec<T>> =
            self.contact_jacobian.iter().map(|row| row.iter().map(|&entry| T::from_f64(entry)).collect()).collect();
        let mut solved = jacobian.clone();
        for k in 0..dofs {
            for i in k + 1..dofs {
                let factor = mass[i][k] / mass[k][k];
                let (above, below) = mass.split_at_mut(i);
                subtract(&mut below[0][k..], &above[k][k..], factor);
                for right in &mut solved {
                    right[i] = right[i] - factor * right[k];
                }
            }
        }
        for right in &mut solved {
            for i in (0..dofs).rev() {
                let known = (i + 1..dofs).fold(right[i], |rest, j| rest - mass[i][j] * right[j]);
                right[i] = known / mass[i][i];
            }
        }
        let delassus = jacobian.iter().flat_map(|row| solved.iter().map(|column| dot(row, column))).collect();
        let velocity: Vec<T> = self.velocity.iter().map(|&entry| T::from_f64(entry)).collect();
        let before =
            jacobian.chunks_exact(2).map(|pair| [dot(&pair[0], &velocity), dot(&pair[1], &velocity)]).collect();
        (delassus, before)
    }
}

impl ContactProblem {
    /// A problem from the dynamics, so that exact redundancy survives, which a rounded G would lose: M (dofs x dofs), J
    /// (two rows per contact: tangential, normal; dofs columns), v (dofs).
    ///
    /// # Errors
    /// As [`ContactProblem::new`]; also a mass matrix that is asymmetric or not positive definite.
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
        let cholesky = dense_cholesky(mass_matrix)?;
        let rows: Vec<Vec<f64>> = contact_jacobian.iter().map(|row| forward_substituted(&cholesky, row)).collect();
        let entry = |i: usize, j: usize| -> f64 { rows[i].iter().zip(&rows[j]).map(|(a, b)| a * b).sum() };
        let count = contact_jacobian.len();
        let mut delassus = vec![0.0; count * count];
        for i in 0..count {
            for j in 0..=i {
                let entry = finite(entry(i, j), || format!("entry [{i}][{j}] of J M^-1 J^T"))?;
                delassus[i * count + j] = entry;
                delassus[j * count + i] = entry;
            }
        }
        let speed = |row: &[f64]| row.iter().zip(velocity).map(|(j, v)| j * v).sum::<f64>();
        let before: Vec<Pair<f64>> =
            contact_jacobian.chunks_exact(2).map(|pair| [speed(&pair[0]), speed(&pair[1])]).collect();
        let mut problem = Self::checked(delassus, before.clone(), before, friction, restitution)?;
        problem.origin = Origin::Dynamics(Box::new(Dynamics {
            mass_matrix: mass_matrix.to_vec(),
            contact_jacobian: contact_jacobian.to_vec(),
            velocity: velocity.to_vec(),
        }));
        Ok(problem)
    }
}

/// Lower Cholesky factor of a dense symmetric matrix, by rows.
fn dense_cholesky(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>> {
    let size = matrix.len();
    let rounding = 4.0 * size as f64 * f64::EPSILON;
    if let Some(place) = (0..size).find(|&i| matrix[i][i] < 0.0) {
        let (what, value) = ("an entry of the mass matrix's diagonal".into(), matrix[place][place]);
        return Err(Error::new(Reason::OutOfRange { what, allowed: "positive", value })
            .at(format!("mass_matrix[{place}][{place}]")));
    }
    let mut lower = vec![vec![0.0; size]; size];
    for i in 0..size {
        for j in 0..=i {
            if (matrix[i][j] - matrix[j][i]).abs() > rounding * matrix[i][i].sqrt() * matrix[j][j].sqrt() {
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
