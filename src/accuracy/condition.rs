//! The condition number of the mass matrix M, scaled to a unit diagonal to make it independent of units.
//!
//! ```text
//!     K = S M S,  S = diag(M_ii^-1/2),  condition = |K| |K^-1|
//! ```
//!
//! Both norms are found by power iteration, |K^-1| with the sparse factor of M. They are estimates from below. A step
//! takes O(nv depth), also for chains of a thousand links. Source: Golub and Van Loan, *Matrix Computations*, section
//! 8.2.

use crate::dynamics::Workspace;
use crate::dynamics::plan::Plan;

/// Power iterations; they give two digits, unless the two largest eigenvalues are closer than that.
const STEPS: usize = 60;

/// Returns the condition number of the scaled mass matrix; requires the results of `mass_matrix` and `factorize`.
pub fn mass_matrix_condition(plan: &Plan, workspace: &Workspace) -> f64 {
    let nv = plan.columns();
    let (mass, factor) = (&workspace.mass_matrix, &workspace.factor);
    let size: Vec<f64> = (0..nv).map(|i| mass[i * nv + i].sqrt()).collect();
    let multiplied = |x: &[f64]| -> Vec<f64> {
        let x: Vec<f64> = x.iter().zip(&size).map(|(x, size)| x / size).collect();
        let mut y: Vec<f64> = x.iter().zip(&size).map(|(x, size)| x * size * size).collect();
        for i in 0..nv {
            plan.for_ancestors(i, |j| {
                let entry = mass[i * nv + j];
                y[i] += entry * x[j];
                y[j] += entry * x[i];
            });
        }
        y.iter().zip(&size).map(|(y, size)| y / size).collect()
    };
    let solved = |x: &[f64]| -> Vec<f64> {
        let mut y: Vec<f64> = x.iter().zip(&size).map(|(x, size)| x * size).collect();
        factor.solve(plan, &mut y);
        y.iter().zip(&size).map(|(y, size)| y * size).collect()
    };
    growth(nv, multiplied) * growth(nv, solved)
}

/// Returns the norm of a symmetric linear map, by power iteration.
fn growth(length: usize, map: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    // The first vector neither misses a direction nor prefers one.
    let mut vector: Vec<f64> = (0..length).map(|index| libm::sin(1.0 + index as f64)).collect();
    let norm = |vector: &[f64]| vector.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
    for _ in 0..STEPS {
        let length = norm(&vector);
        vector.iter_mut().for_each(|entry| *entry /= length);
        vector = map(&vector);
    }
    norm(&vector)
}
