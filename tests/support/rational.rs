//! Rational numbers and exact linear algebra: Gauss-Jordan elimination on rationals, Bareiss elimination on integers.

use dashu_base::{Gcd, Sign};
use dashu_int::{IBig, UBig};
use dashu_ratio::{RBig, Relaxed};

/// Rows of rationals.
pub type Matrix = Vec<Vec<RBig>>;

/// `numerator / denominator`.
pub fn ratio(numerator: i64, denominator: i64) -> RBig {
    RBig::from_parts_signed(IBig::from(numerator), IBig::from(denominator))
}

/// The f64 nearest to `value`; for a dyadic of few digits it is `value` itself.
pub fn to_f64(value: &RBig) -> f64 {
    value.to_f64().value()
}

/// The f64 nearest to `numerator / denominator`.
pub fn quotient(numerator: &IBig, denominator: &IBig) -> f64 {
    Relaxed::from_parts_signed(numerator.clone(), denominator.clone()).to_f64().value()
}

/// -1, 0 or 1.
pub fn sign(value: &IBig) -> i8 {
    match (value.is_zero(), value.sign()) {
        (true, _) => 0,
        (_, Sign::Positive) => 1,
        (_, Sign::Negative) => -1,
    }
}

pub fn dot(a: &[RBig], b: &[RBig]) -> RBig {
    let mut sum = RBig::ZERO;
    for (x, y) in a.iter().zip(b) {
        if !x.is_zero() && !y.is_zero() {
            sum += x * y;
        }
    }
    sum
}

pub fn times(matrix: &Matrix, vector: &[RBig]) -> Vec<RBig> {
    matrix.iter().map(|row| dot(row, vector)).collect()
}

pub fn transposed(matrix: &Matrix) -> Matrix {
    (0..matrix[0].len()).map(|column| matrix.iter().map(|row| row[column].clone()).collect()).collect()
}

/// Applies Gauss-Jordan elimination to the first `columns` columns and returns their rank.
fn eliminate(rows: &mut Matrix, columns: usize) -> usize {
    let mut rank = 0;
    for column in 0..columns {
        let Some(pivot) = (rank..rows.len()).find(|&row| !rows[row][column].is_zero()) else { continue };
        rows.swap(rank, pivot);
        let divisor = rows[rank][column].clone();
        let pivot_row: Vec<RBig> = rows[rank].iter().map(|entry| entry / &divisor).collect();
        for row in rows.iter_mut() {
            let factor = row[column].clone();
            if !factor.is_zero() {
                for (entry, above) in row.iter_mut().zip(&pivot_row).skip(column) {
                    *entry -= &factor * above;
                }
            }
        }
        rows[rank] = pivot_row;
        rank += 1;
    }
    rank
}

/// X with `matrix` X = `right`; `None` if `matrix` is singular.
pub fn solve(matrix: &Matrix, right: &Matrix) -> Option<Matrix> {
    let n = matrix.len();
    let mut rows: Matrix = matrix.iter().zip(right).map(|(a, b)| a.iter().chain(b).cloned().collect()).collect();
    (eliminate(&mut rows, n) == n).then(|| rows.into_iter().map(|row| row[n..].to_vec()).collect())
}

/// M^-1 J^T and G = J M^-1 J^T; `None` if M is singular.
pub fn delassus(mass_matrix: &Matrix, jacobian: &Matrix) -> Option<[Matrix; 2]> {
    let response = solve(mass_matrix, &transposed(jacobian))?;
    // A robot that cannot move has a response without rows.
    let column = |contact: usize| response.iter().map(|row| row[contact].clone()).collect();
    let columns: Matrix = (0..jacobian.len()).map(column).collect();
    let delassus = jacobian.iter().map(|row| times(&columns, row)).collect();
    Some([response, delassus])
}

pub fn rank(matrix: &Matrix) -> usize {
    eliminate(&mut matrix.clone(), matrix.first().map_or(0, Vec::len))
}

/// The least common denominator of `values`.
pub fn common_denominator<'a>(values: impl IntoIterator<Item = &'a RBig>) -> UBig {
    values.into_iter().fold(UBig::ONE, |common, value| {
        let denominator = value.denominator();
        let shared = (&common).gcd(denominator);
        common / shared * denominator
    })
}

/// `scale * value`, which must be an integer.
pub fn whole(value: &RBig, scale: &UBig) -> IBig {
    value.numerator() * IBig::from(scale / value.denominator())
}

/// The solution of a square system of integers: x = numerators / determinant.
pub struct Cramer {
    pub determinant: IBig,
    pub numerators: Vec<IBig>,
}

/// Solves `rows` = [A | b] without fractions (Bareiss 1968); `None` if det A = 0.
pub fn cramer(mut rows: Vec<Vec<IBig>>) -> Option<Cramer> {
    let n = rows.len();
    let mut previous = IBig::ONE;
    let mut odd = false;
    for k in 0..n {
        let pivot = (k..n).find(|&row| !rows[row][k].is_zero())?;
        if pivot != k {
            rows.swap(k, pivot);
            odd = !odd;
        }
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot_row = &above[k];
        for row in below {
            let factor = row[k].clone();
            for (entry, over) in row.iter_mut().zip(pivot_row).skip(k) {
                let mut minor = &*entry * &pivot_row[k];
                if !factor.is_zero() && !over.is_zero() {
                    minor -= &factor * over;
                }
                *entry = minor / &previous;
            }
        }
        previous = pivot_row[k].clone();
    }
    // The last pivot is det A up to its sign. Every numerator is det A times an unknown, an integer by Cramer's rule.
    let last = previous;
    let mut numerators = vec![IBig::ZERO; n];
    for row in (0..n).rev() {
        let mut sum = &rows[row][n] * &last;
        for column in row + 1..n {
            sum -= &rows[row][column] * &numerators[column];
        }
        numerators[row] = sum / &rows[row][row];
    }
    if odd {
        numerators.iter_mut().for_each(|numerator| *numerator = -std::mem::take(numerator));
    }
    Some(Cramer { determinant: if odd { -last } else { last }, numerators })
}
