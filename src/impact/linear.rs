//! Linear equations and linear programs in which every branch depends on a sign that was shown.
//!
//! Sizes are those of a few contacts, so plain dense elimination and the simplex method with Bland's rule serve
//! (Chvatal, *Linear Programming*, 1983, chapters 2, 3 and 8). No tolerance decides anything: a number that may be
//! zero in its precision ends the work as [`Unsettled`], and the caller starts again with more digits. So does a budget
//! that is spent: every loop here and in the rooms above asks for a sign in each round.

use crate::budget::is_spent;
use crate::planar::Pair;
use crate::scalar::{Ordered, Real, Sign, dot};
use std::cmp::Ordering;

/// A sign that needs more digits than the numbers have, or more time than there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Unsettled;

/// How a number compares with zero.
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

    /// Its change from y = 0 to `y`.
    pub fn change(&self, y: &[T]) -> T {
        self.from(T::zero(), y)
    }

    fn from(&self, constant: T, y: &[T]) -> T {
        self.coefficients.iter().zip(y).fold(constant, |sum, (&coefficient, &entry)| sum + coefficient * entry)
    }

    /// The same function with `y` as its origin.
    pub fn seen_from(&self, y: &[T]) -> Self {
        Self { constant: self.at(y), coefficients: self.coefficients.clone() }
    }

    pub fn opposite(self) -> Self {
        let coefficients = self.coefficients.into_iter().map(|coefficient| -coefficient).collect();
        Self { constant: -self.constant, coefficients }
    }

    /// A function of one more entry of y, with this `coefficient`.
    pub fn extended(&self, constant: T, coefficient: T) -> Self {
        Self { constant, coefficients: extended(&self.coefficients, coefficient) }
    }
}

/// The list and one entry more.
pub fn extended<T: Real>(list: &[T], last: T) -> Vec<T> {
    [list, &[last]].concat()
}

impl<T: Ordered> LinearFunction<T> {
    pub fn is_constant(&self) -> Result<bool, Unsettled> {
        for &coefficient in &self.coefficients {
            if settled(coefficient)?.is_ne() {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

/// All solutions of linear equations: origin + sum of y_j times direction j, the directions independent.
#[derive(Debug, Clone)]
pub struct Solutions<T> {
    pub origin: Vec<T>,
    pub directions: Vec<Vec<T>>,
}

impl<T: Real> Solutions<T> {
    /// `constant + coefficients . x` on the solutions, as a function of y.
    pub fn affine(&self, constant: T, coefficients: &[T]) -> LinearFunction<T> {
        let along = |x: &Vec<T>| dot(coefficients, x);
        LinearFunction {
            constant: constant + along(&self.origin),
            coefficients: self.directions.iter().map(along).collect(),
        }
    }

    pub fn at(&self, y: &[T]) -> Vec<T> {
        self.moved(self.origin.clone(), y)
    }

    fn moved(&self, mut x: Vec<T>, y: &[T]) -> Vec<T> {
        for (direction, &factor) in self.directions.iter().zip(y) {
            for (entry, &part) in x.iter_mut().zip(direction) {
                *entry = *entry + factor * part;
            }
        }
        x
    }
}

impl<T: Ordered> Solutions<T> {
    /// The solutions on which `functions` of y are also zero; `None` if there are none.
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

/// The solutions of `equations`, each its coefficients of the `unknowns`, then the right-hand side; `None` without any.
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
            if other != rank {
                for (entry, &above) in equation[column..].iter_mut().zip(&pivot[column..]).skip(1) {
                    *entry = *entry - factor * above;
                }
                equation[column] = T::zero();
            }
        }
        pivots.push(column);
    }
    for equation in &equations[pivots.len()..] {
        if settled(equation[unknowns])?.is_ne() {
            return Ok(None);
        }
    }
    let mut origin = vec![T::zero(); unknowns];
    for (equation, &column) in equations.iter().zip(&pivots) {
        origin[column] = equation[unknowns];
    }
    let free = (0..unknowns).filter(|column| !pivots.contains(column));
    let direction = |own: usize| {
        let mut direction = vec![T::zero(); unknowns];
        direction[own] = T::one();
        for (equation, &column) in equations.iter().zip(&pivots) {
            direction[column] = -equation[own];
        }
        direction
    };
    Ok(Some(Solutions { origin, directions: free.map(direction).collect() }))
}

/// The row with the entry of a column that is farthest from zero; `None` if all are zero.
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

/// The y at which `objective . y` is greatest among those where no function is negative; `None` if it grows without
/// bound. At y = 0 no function may be negative.
pub fn maximize<T: Ordered>(functions: &[LinearFunction<T>], objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
    let free = objective.len();
    let mut dictionary = Dictionary {
        rows: functions.iter().map(|function| extended(&function.coefficients, function.constant)).collect(),
        gain: objective.to_vec(),
        // Labels below `free` are entries of y, which may take any sign; the others are the functions' own values.
        basic: (free..free + functions.len()).collect(),
        nonbasic: (0..free).collect(),
        free,
    };
    while let Some((column, rising)) = dictionary.entering()? {
        let Some(row) = dictionary.leaving(column, rising)? else { return Ok(None) };
        dictionary.pivot(row, column);
    }
    let mut y = vec![T::zero(); free];
    for (row, &label) in dictionary.rows.iter().zip(&dictionary.basic) {
        if label < free {
            y[label] = row[free];
        }
    }
    Ok(Some(y))
}

/// Basic variables as affine functions of the nonbasic ones, which are zero.
struct Dictionary<T> {
    /// Per basic variable its coefficients of the nonbasic ones, then its value.
    rows: Vec<Vec<T>>,
    /// What the objective gains by each nonbasic variable.
    gain: Vec<T>,
    basic: Vec<usize>,
    nonbasic: Vec<usize>,
    /// Labels below this belong to variables of any sign.
    free: usize,
}

impl<T: Ordered> Dictionary<T> {
    /// The variable of the lowest label that improves the objective, and whether it must rise. Entries of y come first.
    fn entering(&self) -> Result<Option<(usize, bool)>, Unsettled> {
        let mut order: Vec<usize> = (0..self.nonbasic.len()).collect();
        order.sort_by_key(|&column| self.nonbasic[column]);
        for column in order {
            match settled(self.gain[column])? {
                Ordering::Greater => return Ok(Some((column, true))),
                Ordering::Less if self.nonbasic[column] < self.free => return Ok(Some((column, false))),
                _ => {}
            }
        }
        Ok(None)
    }

    /// The basic variable that reaches zero first, of several the one with the lowest label.
    fn leaving(&self, column: usize, rising: bool) -> Result<Option<usize>, Unsettled> {
        let mut least: Option<(usize, Pair<T>)> = None;
        for (row, entries) in self.rows.iter().enumerate() {
            let slope = if rising { entries[column] } else { -entries[column] };
            if self.basic[row] < self.free || settled(slope)?.is_ge() {
                continue;
            }
            // It reaches zero after value / speed, whose comparison needs no division.
            let [value, speed] = [entries[self.nonbasic.len()], -slope];
            let first = match least {
                None => true,
                Some((other, [least, of_least])) => match settled(value * of_least - least * speed)? {
                    Ordering::Less => true,
                    Ordering::Equal => self.basic[row] < self.basic[other],
                    Ordering::Greater => false,
                },
            };
            if first {
                least = Some((row, [value, speed]));
            }
        }
        Ok(least.map(|(row, _)| row))
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let inverse = T::one() / self.rows[row][column];
        let mut solved: Vec<T> = self.rows[row].iter().map(|&entry| -(entry * inverse)).collect();
        solved[column] = inverse;
        let substitute = |line: &mut Vec<T>| {
            let factor = line[column];
            for (index, entry) in line.iter_mut().enumerate() {
                *entry = if index == column { factor * inverse } else { *entry + factor * solved[index] };
            }
        };
        for (other, line) in self.rows.iter_mut().enumerate() {
            if other != row {
                substitute(line);
            }
        }
        substitute(&mut self.gain);
        self.rows[row] = solved;
        std::mem::swap(&mut self.basic[row], &mut self.nonbasic[column]);
    }
}

/// Those of `functions` that are zero wherever none is negative, by their place, and a y at which no other one is zero.
/// At y = 0 no function may be negative.
pub fn vanishing<T: Ordered>(functions: &[LinearFunction<T>]) -> Result<(Vec<usize>, Vec<T>), Unsettled> {
    let mut y = vec![T::zero(); functions.first().map_or(0, |function| function.coefficients.len())];
    let mut all = Vec::new();
    for (place, function) in functions.iter().enumerate() {
        if settled(function.at(&y))?.is_gt() {
            continue;
        }
        // One is enough of a function that grows without bound.
        let top = LinearFunction { constant: -T::one(), ..function.clone() }.opposite();
        let rows: Vec<LinearFunction<T>> = functions.iter().map(|each| each.seen_from(&y)).chain([top]).collect();
        let best = maximize(&rows, &function.coefficients)?.ok_or(Unsettled)?;
        if settled(function.change(&best))?.is_eq() {
            all.push(place);
            continue;
        }
        // Half way there, what is positive stays so.
        for (entry, step) in y.iter_mut().zip(best) {
            *entry = *entry + step * T::from_f64(0.5);
        }
    }
    Ok((all, y))
}

/// The y whose smallest function is greatest, and that value, at most `cap`: an unbounded set needs one.
pub fn widest<T: Ordered>(functions: &[LinearFunction<T>], dimension: usize, cap: T) -> Result<(Vec<T>, T), Unsettled> {
    let mut least = cap;
    for function in functions {
        if settled(function.constant - least)?.is_lt() {
            least = function.constant;
        }
    }
    // Unknowns y and s = rise above `least`; at y = 0, s = 0 every function is where it must be.
    let (one, still) = (T::one(), vec![T::zero(); dimension]);
    let shifted = functions.iter().map(|function| function.extended(function.constant - least, -one));
    let top = LinearFunction { constant: cap - least, coefficients: extended(&still, -one) };
    let rows: Vec<LinearFunction<T>> = shifted.chain([top]).collect();
    // The cap bounds the program.
    let mut y = maximize(&rows, &extended(&still, one))?.ok_or(Unsettled)?;
    let rise = y.pop().ok_or(Unsettled)?;
    Ok((y, least + rise))
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

    #[test]
    fn a_degenerate_program_does_not_cycle() {
        // Beale's example, which cycles under the largest-coefficient rule; x >= 0 are rows here. Greatest 1/20.
        let unit = |own: usize| std::array::from_fn(|entry| f64::from(u8::from(entry == own)));
        let mut rows: Vec<LinearFunction<Number>> = (0..4).map(|own| affine(0.0, &unit(own) as &[f64; 4])).collect();
        rows.push(affine(0.0, &[-0.25, 60.0, 0.04, -9.0]));
        rows.push(affine(0.0, &[-0.5, 90.0, 0.02, -3.0]));
        rows.push(affine(1.0, &[0.0, 0.0, -1.0, 0.0]));
        let objective = numbers(&[0.75, -150.0, 0.02, -6.0]);
        let y = maximize(&rows, &objective).unwrap().unwrap();
        let value = affine(0.0, &[0.75, -150.0, 0.02, -6.0]).at(&y).to_f64();
        // 0.04 and 0.02 are not exact, so neither is the corner.
        assert!((value - 0.05).abs() < 1e-15, "{value}");
    }
}
