//! Solves linear programs without tolerances: each branch depends on a sign that was shown. The method is the simplex
//! method with Bland's rule (Chvatal, *Linear Programming*, 1983, chapters 2, 3 and 8), applied block by block.
//!
//! If the functions fall into groups without a common entry of y, as for two separate soles, each group is a program of
//! its own. Then no sign depends on numbers of different groups that cancel.

use super::linear::{LinearFunction, Unsettled, extended, settled};
use crate::planar::Pair;
use crate::scalar::{Ordered, Sign};
use std::cmp::Ordering;

/// Merges the groups of all `members`; `groups` holds the group of each element.
pub fn join(groups: &mut [usize], members: impl Iterator<Item = usize>) {
    let mut first = None;
    for member in members {
        let (from, to) = (groups[member], *first.get_or_insert(groups[member]));
        groups.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
    }
}

/// The feasible set of linear programs, where no function of y is negative; each call gives another objective.
pub struct Program<T> {
    dimension: usize,
    blocks: Vec<Block<T>>,
}

/// Entries of y that the functions tie to each other, with these functions: an independent program.
struct Block<T> {
    entries: Vec<usize>,
    functions: Vec<LinearFunction<T>>,
}

impl<T: Ordered> Program<T> {
    /// Splits `functions` into blocks. Each function that is not constant is in exactly one block.
    pub fn of(functions: &[LinearFunction<T>], dimension: usize) -> Self {
        let tied = |function: &LinearFunction<T>, entry: &usize| function.coefficients[*entry].sign() != Sign::Zero;
        let mut groups: Vec<usize> = (0..dimension).collect();
        for function in functions {
            join(&mut groups, (0..dimension).filter(|entry| tied(function, entry)));
        }
        let block = |group: usize| {
            let entries: Vec<usize> = (0..dimension).filter(|&entry| groups[entry] == group).collect();
            let of_group = functions.iter().filter(|function| entries.iter().any(|entry| tied(function, entry)));
            let kept = |function: &LinearFunction<T>| LinearFunction {
                constant: function.constant,
                coefficients: entries.iter().map(|&entry| function.coefficients[entry]).collect(),
            };
            Block { functions: of_group.map(kept).collect(), entries }
        };
        Self { blocks: (0..dimension).filter(|group| groups.contains(group)).map(block).collect(), dimension }
    }

    /// Returns the y that maximizes `objective . y` where no function is negative; `None` if the objective is
    /// unbounded. At y = 0 no function may be negative.
    pub fn maximize(&self, objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
        let mut y = vec![T::zero(); self.dimension];
        for block in &self.blocks {
            let gain: Vec<T> = block.entries.iter().map(|&entry| objective[entry]).collect();
            if gain.iter().any(|coefficient| coefficient.sign() != Sign::Zero) {
                let Some(best) = maximize_block(&block.functions, &gain)? else { return Ok(None) };
                block.put(&best, &mut y);
            }
        }
        Ok(Some(y))
    }
}

/// Does the same as [`Program::maximize`] for a program that is solved only once.
pub fn maximize<T: Ordered>(functions: &[LinearFunction<T>], objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
    Program::of(functions, objective.len()).maximize(objective)
}

impl<T: Ordered> Block<T> {
    /// Writes the block's own entries into `y`.
    fn put(&self, values: &[T], y: &mut [T]) {
        self.entries.iter().zip(values).for_each(|(&entry, &value)| y[entry] = value);
    }

    /// Does the same as [`widest`] for this block alone.
    fn widest(&self, cap: T) -> Result<(Vec<T>, T), Unsettled> {
        let least = least(&self.functions, cap)?;
        let (one, still) = (T::one(), vec![T::zero(); self.entries.len()]);
        if settled(cap - least)?.is_eq() {
            return Ok((still, least));
        }
        // The unknowns are y and s, the rise above `least`. At y = 0, s = 0 no function is negative.
        let top = LinearFunction { constant: cap, coefficients: still.clone() };
        let shifted = |function: &LinearFunction<T>| LinearFunction {
            constant: function.constant - least,
            coefficients: extended(&function.coefficients, -one),
        };
        let program: Vec<LinearFunction<T>> = self.functions.iter().chain([&top]).map(shifted).collect();
        // The cap bounds the program.
        let mut y = maximize_block(&program, &extended(&still, one))?.ok_or(Unsettled)?;
        let rise = y.pop().ok_or(Unsettled)?;
        Ok((y, least + rise))
    }
}

/// Does the same as [`Program::maximize`] for one block.
fn maximize_block<T: Ordered>(functions: &[LinearFunction<T>], objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
    let free = objective.len();
    if let &[gain] = objective {
        // A single entry moves until the first function becomes zero.
        let rising = match settled(gain)? {
            Ordering::Equal => return Ok(Some(vec![T::zero()])),
            sign => sign.is_gt(),
        };
        let rows = functions.iter().enumerate().map(|(label, row)| (label, row.coefficients[0], row.constant));
        let stop = first_at_zero(rows, rising)?;
        let way = |(_, [value, speed]): (usize, Pair<T>)| if rising { value / speed } else { -(value / speed) };
        return Ok(stop.map(|stop| vec![way(stop)]));
    }
    let mut dictionary = Dictionary {
        rows: functions.iter().map(|function| extended(&function.coefficients, function.constant)).collect(),
        gain: objective.to_vec(),
        // Labels below `free` are entries of y, which may have any sign; the others are the values of the functions.
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

/// The smallest of `cap` and the functions' values at y = 0.
fn least<'f, T: Ordered + 'f>(
    functions: impl IntoIterator<Item = &'f LinearFunction<T>>,
    cap: T,
) -> Result<T, Unsettled> {
    let mut least = cap;
    for function in functions {
        if settled(function.constant - least)?.is_lt() {
            least = function.constant;
        }
    }
    Ok(least)
}

/// A simplex dictionary: the basic variables as affine functions of the nonbasic ones, which are zero.
struct Dictionary<T> {
    /// One row per basic variable: its coefficients of the nonbasic variables, then its value.
    rows: Vec<Vec<T>>,
    /// The objective's coefficient of each nonbasic variable.
    gain: Vec<T>,
    basic: Vec<usize>,
    nonbasic: Vec<usize>,
    /// Variables with labels below this may have any sign.
    free: usize,
}

impl<T: Ordered> Dictionary<T> {
    /// The entering column: the variable with the lowest label that improves the objective, and whether it must rise.
    /// Entries of y have the lowest labels.
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

    /// The row of the basic variable that reaches zero first; `None` if none does.
    fn leaving(&self, column: usize, rising: bool) -> Result<Option<usize>, Unsettled> {
        let bound = self.rows.iter().zip(&self.basic).filter(|(_, label)| **label >= self.free);
        let rows = bound.map(|(entries, &label)| (label, entries[column], entries[self.nonbasic.len()]));
        let first = first_at_zero(rows, rising)?;
        Ok(first.and_then(|(first, _)| self.basic.iter().position(|&label| label == first)))
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let inverse = T::one() / self.rows[row][column];
        let mut solved: Vec<T> = self.rows[row].iter().map(|&entry| -(entry * inverse)).collect();
        solved[column] = inverse;
        let lines = self.rows.iter_mut().chain([&mut self.gain]).enumerate().filter(|(other, _)| *other != row);
        for (_, line) in lines.filter(|(_, line)| line[column].sign() != Sign::Zero) {
            let factor = line[column];
            for (index, entry) in line.iter_mut().enumerate() {
                *entry = if index == column { factor * inverse } else { *entry + factor * solved[index] };
            }
        }
        self.rows[row] = solved;
        std::mem::swap(&mut self.basic[row], &mut self.nonbasic[column]);
    }
}

/// Returns the label, value and speed of the function that reaches zero first; among equals, that with the lowest
/// label. Each function is given as its label, slope and value. `None` if none falls.
fn first_at_zero<T: Ordered>(
    functions: impl Iterator<Item = (usize, T, T)>,
    rising: bool,
) -> Result<Option<(usize, Pair<T>)>, Unsettled> {
    let mut least: Option<(usize, Pair<T>)> = None;
    for (label, slope, value) in functions {
        let speed = if rising { -slope } else { slope };
        if settled(speed)?.is_le() {
            continue;
        }
        // A function reaches zero after value / speed; comparing two quotients needs no division.
        let first = match least {
            None => true,
            Some((other, [least, of_least])) => {
                settled(value * of_least - least * speed)?.then(label.cmp(&other)).is_lt()
            }
        };
        if first {
            least = Some((label, [value, speed]));
        }
    }
    Ok(least)
}

/// Returns the places of those `functions` that are zero wherever no function is negative, and a y at which no other
/// function is zero. At y = 0 no function may be negative.
pub fn vanishing<T: Ordered>(functions: &[LinearFunction<T>]) -> Result<(Vec<usize>, Vec<T>), Unsettled> {
    let mut y = vec![T::zero(); functions.first().map_or(0, |function| function.coefficients.len())];
    let mut all = Vec::new();
    for (place, function) in functions.iter().enumerate() {
        if settled(function.at(&y))?.is_gt() {
            continue;
        }
        // The function may be unbounded, so its value is limited to one.
        let top = LinearFunction { constant: -T::one(), ..function.clone() }.opposite();
        let rows: Vec<LinearFunction<T>> = functions.iter().map(|each| each.seen_from(&y)).chain([top]).collect();
        let best = maximize(&rows, &function.coefficients)?.ok_or(Unsettled)?;
        if settled(function.change(&best))?.is_eq() {
            all.push(place);
            continue;
        }
        // At half of the step, functions that are positive stay positive.
        for (entry, step) in y.iter_mut().zip(best) {
            *entry = *entry + step * T::from_f64(0.5);
        }
    }
    Ok((all, y))
}

/// Returns the y that maximizes the smallest function, and that smallest value, which is at most `cap`. Without the cap
/// the value could be unbounded.
pub fn widest<T: Ordered>(functions: &[LinearFunction<T>], dimension: usize, cap: T) -> Result<(Vec<T>, T), Unsettled> {
    let is_constant = |row: &&LinearFunction<T>| row.coefficients.iter().all(|entry| entry.sign() == Sign::Zero);
    let mut smallest = least(functions.iter().filter(is_constant), cap)?;
    let mut y = vec![T::zero(); dimension];
    for block in Program::of(functions, dimension).blocks {
        let (best, value) = block.widest(cap)?;
        block.put(&best, &mut y);
        if settled(value - smallest)?.is_lt() {
            smallest = value;
        }
    }
    Ok((y, smallest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::linear::tests::{Number, affine, numbers};
    use crate::scalar::{Ball, Real};

    #[test]
    fn a_degenerate_program_does_not_cycle() {
        // Beale's example, which cycles under the largest-coefficient rule; the rows x >= 0 are functions. The maximum
        // is 1/20.
        let unit = |axis: usize| std::array::from_fn(|entry| f64::from(u8::from(entry == axis)));
        let mut rows: Vec<LinearFunction<Number>> = (0..4).map(|axis| affine(0.0, &unit(axis) as &[f64; 4])).collect();
        rows.push(affine(0.0, &[-0.25, 60.0, 0.04, -9.0]));
        rows.push(affine(0.0, &[-0.5, 90.0, 0.02, -3.0]));
        rows.push(affine(1.0, &[0.0, 0.0, -1.0, 0.0]));
        let objective = numbers(&[0.75, -150.0, 0.02, -6.0]);
        let y = maximize(&rows, &objective).unwrap().unwrap();
        let value = affine(0.0, &[0.75, -150.0, 0.02, -6.0]).at(&y).to_f64();
        // 0.04 and 0.02 are not exact, so neither is the corner.
        assert!((value - 0.05).abs() < 1e-15, "{value}");
    }

    #[test]
    fn functions_without_a_common_entry_are_separate() {
        // |y1| <= 1/3 and -1/8 <= y2 <= 3/2: in plain balls, neither block may affect the other.
        let third = 1.0 / 3.0;
        let affine = |constant: f64, coefficients: [f64; 3]| LinearFunction {
            constant: Ball::from_f64(constant),
            coefficients: coefficients.map(Ball::<f64>::from_f64).to_vec(),
        };
        let functions = [
            affine(third, [1.0, 0.0, 0.0]),
            affine(third, [-1.0, 0.0, 0.0]),
            affine(0.125, [0.0, 1.0, 0.0]),
            affine(0.75, [0.0, -0.5, 0.0]),
            affine(0.3, [0.0; 3]),
        ];
        let numbers = |y: Vec<Ball>| y.into_iter().map(Ordered::to_f64).collect::<Vec<_>>();
        let cap = Ball::from_f64(1e3);
        let (y, least) = widest(&functions, 3, cap).unwrap();
        let off = numbers(y).iter().zip([0.0, 1.25 / 3.0, 0.0]).map(|(y, expected)| (y - expected).abs()).sum::<f64>();
        assert!(off < 1e-15 && least.to_f64() == 0.3, "{off} {least:?}");
        let negative = [&functions[..], &[affine(-0.5, [0.0; 3])]].concat();
        assert_eq!(widest(&negative, 3, cap).unwrap().1.to_f64(), -0.5);
        let objective = [1.0, -1.0, 0.0].map(Ball::from_f64);
        assert_eq!(maximize(&functions, &objective).unwrap().map(numbers), Some(vec![third, -0.125, 0.0]));
        // No function bounds the last entry.
        assert!(maximize(&functions, &[0.0, 0.0, 1.0].map(Ball::from_f64)).unwrap().is_none());
        assert_eq!(maximize(&[], &[Ball::zero(); 2]).unwrap().map(numbers), Some(vec![0.0; 2]));
    }
}
