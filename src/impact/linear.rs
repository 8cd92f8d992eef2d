//! Solves linear equations without tolerances: each branch depends on a sign that was shown.
//!
//! The systems are small, a few contacts each, so plain dense elimination is enough. If a number may be zero in its
//! precision, the work ends as [`Unsettled`], and the caller starts again with more digits. A spent budget ends the
//! work the same way, because every loop here and in the modules that use this one asks for a sign in each round.

use crate::budget::is_spent;
use crate::scalar::{Ordered, Real, Sign, subtract};
use std::cmp::Ordering;

/// The error of a sign that needs more digits than the numbers have, or more time than the budget leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unsettled;

/// Compares a number with zero. Returns an error if its sign is undecided or the budget is spent.
pub fn settled<T: Ordered>(number: T) -> Result<Ordering, Unsettled> {
    if is_spent() {
        return Err(Unsettled);
    }
    match number.sign() {
        Sign::Negative => Ok(Ordering::Less),
        Sign::Zero => Ok(Ordering::Equal),
        Sign::Positive => Ok(Ordering::Greater),
        Sign::Undecided => Err(Unsettled),
    }
}

/// Whether all numbers are zero; stops at the first that is not.
pub fn are_zero<T: Ordered>(numbers: impl IntoIterator<Item = T>) -> Result<bool, Unsettled> {
    for number in numbers {
        if settled(number)?.is_ne() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// An affine function of y: `constant + coefficients . y`.
#[derive(Debug, Clone)]
pub struct LinearFunction<T> {
    pub constant: T,
    pub coefficients: Vec<T>,
}

impl<T: Real> LinearFunction<T> {
    pub fn at(&self, y: &[T]) -> T {
        self.from(self.constant, y)
    }

    /// The change of the function from y = 0 to `y`.
    pub fn change(&self, y: &[T]) -> T {
        self.from(T::zero(), y)
    }

    fn from(&self, constant: T, y: &[T]) -> T {
        self.coefficients.iter().zip(y).fold(constant, |sum, (&coefficient, &entry)| sum + coefficient * entry)
    }

    /// The same function as a function of the offset from `y`.
    pub fn seen_from(&self, y: &[T]) -> Self {
        Self { constant: self.at(y), coefficients: self.coefficients.clone() }
    }

    pub fn opposite(self) -> Self {
        let coefficients = self.coefficients.into_iter().map(|coefficient| -coefficient).collect();
        Self { constant: -self.constant, coefficients }
    }

    /// The function whose constant and coefficients `entry` computes from those of two functions.
    pub fn with(&self, other: &Self, entry: impl Fn(T, T) -> T) -> Self {
        let coefficients = self.coefficients.iter().zip(&other.coefficients).map(|(&own, &other)| entry(own, other));
        Self { constant: entry(self.constant, other.constant), coefficients: coefficients.collect() }
    }
}

/// The list with one more entry.
pub fn extended<T: Real>(list: &[T], last: T) -> Vec<T> {
    [list, &[last]].concat()
}

impl<T: Ordered> LinearFunction<T> {
    pub fn is_constant(&self) -> Result<bool, Unsettled> {
        are_zero(self.coefficients.iter().copied())
    }
}

/// All solutions of linear equations: origin + sum of y_j times direction j, with linearly independent directions.
#[derive(Debug, Clone)]
pub struct Solutions<T> {
    pub origin: Vec<T>,
    pub directions: Vec<Vec<T>>,
}

impl<T: Real> Solutions<T> {
    pub fn at(&self, y: &[T]) -> Vec<T> {
        self.moved(self.origin.clone(), y)
    }

    /// `x` moved along the directions by y.
    pub fn moved(&self, mut x: Vec<T>, y: &[T]) -> Vec<T> {
        for (direction, &factor) in self.directions.iter().zip(y) {
            for (entry, &change) in x.iter_mut().zip(direction) {
                *entry = *entry + factor * change;
            }
        }
        x
    }
}

impl<T: Ordered> Solutions<T> {
    /// Returns `constant + coefficients . x` on the solutions, as a function of y.
    pub fn affine(&self, constant: T, coefficients: &[T]) -> LinearFunction<T> {
        // Zeros are skipped, because most entries of a direction are zero.
        let along = |x: &Vec<T>| {
            let terms = coefficients.iter().zip(x).filter(|(_, entry)| entry.sign() != Sign::Zero);
            terms.fold(T::zero(), |sum, (&coefficient, &entry)| sum + coefficient * entry)
        };
        LinearFunction {
            constant: constant + along(&self.origin),
            coefficients: self.directions.iter().map(along).collect(),
        }
    }

    /// The solutions on which all `functions` of y are zero as well; `None` if there are none.
    pub fn where_zero<'f>(
        &self,
        functions: impl Iterator<Item = &'f LinearFunction<T>>,
    ) -> Result<Option<Self>, Unsettled>
    where
        T: 'f,
    {
        let equations = functions.map(|function| extended(&function.coefficients, -function.constant)).collect();
        let Some(inner) = solve(self.directions.len(), equations)? else { return Ok(None) };
        let direction = |z: &Vec<T>| self.moved(vec![T::zero(); self.origin.len()], z);
        let directions = inner.directions.iter().map(direction).collect();
        Ok(Some(Self { origin: self.at(&inner.origin), directions }))
    }
}

/// Solves `equations`, each with the coefficients of the `unknowns` and then the right-hand side; `None` if unsolvable.
pub fn solve<T: Ordered>(unknowns: usize, mut equations: Vec<Vec<T>>) -> Result<Option<Solutions<T>>, Unsettled> {
    let mut pivots = Vec::new();
    for column in 0..unknowns {
        let rank = pivots.len();
        let Some(row) = largest(&equations[rank..], column)? else { continue };
        equations.swap(rank, rank + row);
        let inverse = T::one() / equations[rank][column];
        for entry in &mut equations[rank][column..] {
            *entry = *entry * inverse;
        }
        let pivot = equations[rank].clone();
        for (other, equation) in equations.iter_mut().enumerate() {
            let factor = equation[column];
            if other != rank && factor.sign() != Sign::Zero {
                subtract(&mut equation[column + 1..], &pivot[column + 1..], factor);
                equation[column] = T::zero();
            }
        }
        pivots.push(column);
    }
    if !are_zero(equations[pivots.len()..].iter().map(|equation| equation[unknowns]))? {
        return Ok(None);
    }
    let mut origin = vec![T::zero(); unknowns];
    for (equation, &column) in equations.iter().zip(&pivots) {
        origin[column] = equation[unknowns];
    }
    let free = (0..unknowns).filter(|column| !pivots.contains(column));
    let direction = |unknown: usize| {
        let mut direction = vec![T::zero(); unknowns];
        direction[unknown] = T::one();
        for (equation, &column) in equations.iter().zip(&pivots) {
            direction[column] = -equation[unknown];
        }
        direction
    };
    Ok(Some(Solutions { origin, directions: free.map(direction).collect() }))
}

/// The row whose entry in `column` is farthest from zero; `None` if all entries are zero.
fn largest<T: Ordered>(rows: &[Vec<T>], column: usize) -> Result<Option<usize>, Unsettled> {
    let size = |row: &usize| rows[*row][column].to_f64().abs();
    let Some(row) = (0..rows.len()).max_by(|i, j| size(i).total_cmp(&size(j))) else { return Ok(None) };
    if settled(rows[row][column])?.is_ne() {
        return Ok(Some(row));
    }
    for (other, row) in rows.iter().enumerate() {
        if settled(row[column])?.is_ne() {
            return Ok(Some(other));
        }
    }
    Ok(None)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scalar::{Ball, Certified, DoubleDouble};

    pub type Number = Certified<Ball<DoubleDouble>>;

    pub fn numbers(entries: &[f64]) -> Vec<Number> {
        entries.iter().map(|&entry| Number::from_f64(entry)).collect()
    }

    pub fn affine(constant: f64, coefficients: &[f64]) -> LinearFunction<Number> {
        LinearFunction { constant: Number::from_f64(constant), coefficients: numbers(coefficients) }
    }
}
