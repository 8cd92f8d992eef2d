//! The index of an outcome whose equations are singular: the sign of det B (paper, section 2).
//!
//! ```text
//!     B = G_NR - G_NS G_SS^+ G_SR     S: rows of sticking contacts, N: normal rows of sliding ones, R: their rays
//! ```
//!
//! If sticking contacts share a tangential row, S contains it once.

use super::linear::{Unsettled, settled};
use super::problem::ContactProblem;
use crate::law::{Impulse, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, subtract};

/// The sign of det B; if det B is zero, that of the lowest nonzero coefficient of det(B + s I), `None` without any.
pub fn index<T: Ordered>(problem: &ContactProblem<T>, modes: &[Mode]) -> Result<Option<i8>, Unsettled> {
    let mut stuck: Vec<usize> = Vec::new();
    let mut sliding: Vec<(usize, Pair<T>)> = Vec::new();
    for (contact, (&mode, law)) in modes.iter().zip(problem.laws()).enumerate() {
        match law.impulse(mode) {
            Impulse::Zero => {}
            Impulse::Along(ray) => sliding.push((contact, ray.map(T::from_f64))),
            Impulse::Free => {
                let is_stuck = |&other: &usize| problem.laws()[other].impulse(modes[other]) == Impulse::Free;
                let shared = problem.shared_tangent(contact).filter(is_stuck);
                stuck.extend((2 * contact..2 * contact + 2).skip(usize::from(shared.is_some())));
            }
        }
    }
    if sliding.is_empty() {
        return Ok(Some(1));
    }
    // Rows: S, then N. Columns: S, then R.
    let rows = stuck.iter().copied().chain(sliding.iter().map(|(contact, _)| 2 * contact + 1));
    let mut matrix: Vec<Vec<T>> = rows
        .map(|row| {
            let held = stuck.iter().map(|&column| problem.delassus(row, column));
            let slid = sliding.iter().map(|&(contact, [t, n])| {
                problem.delassus(row, 2 * contact) * t + problem.delassus(row, 2 * contact + 1) * n
            });
            held.chain(slid).collect()
        })
        .collect();
    let mut open: Vec<usize> = (0..stuck.len()).collect();
    // Once all remaining diagonal entries are zero, the matrix rest of G_SS is zero, since it is positive semidefinite.
    while let Some(pivot) = pivot(&open, &matrix)? {
        let place = open.swap_remove(pivot);
        let inverse = T::one() / matrix[place][place];
        let pivot_row = matrix[place].clone();
        for row in (0..matrix.len()).filter(|row| open.contains(row) || *row >= stuck.len()) {
            let factor = matrix[row][place] * inverse;
            subtract(&mut matrix[row], &pivot_row, factor);
        }
    }
    let schur: Vec<Vec<T>> = matrix[stuck.len()..].iter().map(|row| row[stuck.len()..].to_vec()).collect();
    lowest_coefficient(&schur)
}

/// The place in `open` of the pivot, the diagonal entry that is farthest from zero; `None` if all are shown to be zero.
fn pivot<T: Ordered>(open: &[usize], matrix: &[Vec<T>]) -> Result<Option<usize>, Unsettled> {
    let mut best: Option<(usize, f64)> = None;
    for (place, &index) in open.iter().enumerate() {
        let number = matrix[index][index];
        if settled(number)?.is_ne() && best.is_none_or(|(_, size)| number.to_f64().abs() > size) {
            best = Some((place, number.to_f64().abs()));
        }
    }
    Ok(best.map(|(place, _)| place))
}

/// The sign of the lowest nonzero coefficient of det(B + s I); `None` if all are zero. Uses the method of Faddeev and
/// LeVerrier for det(s I - B) with -B in place of B: M_k = B M_(k-1) + c_k I, c_k = -trace(B M_(k-1)) / k.
fn lowest_coefficient<T: Ordered>(matrix: &[Vec<T>]) -> Result<Option<i8>, Unsettled> {
    let size = matrix.len();
    let negative: Vec<Vec<T>> = matrix.iter().map(|row| row.iter().map(|&entry| -entry).collect()).collect();
    let mut power: Vec<Vec<T>> =
        (0..size).map(|i| (0..size).map(|j| if i == j { T::one() } else { T::zero() }).collect()).collect();
    let mut coefficients = vec![T::one()];
    for k in 1..=size {
        let product = |row: &Vec<T>| -> Vec<T> {
            let entry = |j: usize| row.iter().zip(&power).fold(T::zero(), |sum, (&a, other)| sum + a * other[j]);
            (0..size).map(entry).collect()
        };
        let product: Vec<Vec<T>> = negative.iter().map(product).collect();
        let trace = (0..size).fold(T::zero(), |sum, i| sum + product[i][i]);
        let coefficient = -(trace / T::from_f64(k as f64));
        power = product;
        for (i, row) in power.iter_mut().enumerate() {
            row[i] = row[i] + coefficient;
        }
        coefficients.push(coefficient);
    }
    for &coefficient in coefficients.iter().rev() {
        let sign = settled(coefficient)?;
        if sign.is_ne() {
            return Ok(Some(sign as i8));
        }
    }
    Ok(None)
}
