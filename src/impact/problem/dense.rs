//! A problem from M, J and v as dense matrices.

use super::checks::check_matrix_size;
use super::{ContactProblem, Factor, VELOCITY_ROUNDING};
use crate::error::{Error, Reason, Result, finite};
use crate::impact::mode::Friction;

impl ContactProblem {
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
