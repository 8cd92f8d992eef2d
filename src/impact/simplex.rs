//! Linear programs in which every branch depends on a sign that was shown: the simplex method with Bland's rule (Chvatal,
//! *Linear Programming*, 1983, chapters 2, 3 and 8), block by block.
//!
//! Where functions fall into groups without a common entry of y, as those of one sole and those of another do, each
//! group is a program of its own. So no sign depends on numbers of different groups that cancel.

use super::linear::{LinearFunction, Unsettled, extended, settled};
use crate::planar::Pair;
use crate::scalar::{Ordered, Sign};
use std::cmp::Ordering;

/// Gives all members of a list of groups, which has the group of each, the same one.
pub fn join(groups: &mut [usize], members: impl Iterator<Item = usize>) {
    let mut first = None;
    for member in members {
        let (from, to) = (groups[member], *first.get_or_insert(groups[member]));
        groups.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
    }
}

/// Functions of y that may not be negative: linear programs of any objective.
pub struct Program<T> {
    dimension: usize,
    blocks: Vec<Block<T>>,
}

/// Entries of y that some function ties to each other, and these functions: programs of their own.
struct Block<T> {
    entries: Vec<usize>,
    functions: Vec<LinearFunction<T>>,
}

impl<T: Ordered> Program<T> {
    /// Each of the `functions` that is not constant is in one block.
    pub fn of(functions: &[LinearFunction<T>], dimension: usize) -> Self {
        let tied = |function: &LinearFunction<T>, entry: &usize| function.coefficients[*entry].sign() != Sign::Zero;
        let mut groups: Vec<usize> = (0..dimension).collect();
        for function in functions {
            join(&mut groups, (0..dimension).filter(|entry| tied(function, entry)));
        }
        let block = |group: usize| {
            let entries: Vec<usize> = (0..dimension).filter(|&entry| groups[entry] == group).collect();
            let own = functions.iter().filter(|function| entries.iter().any(|entry| tied(function, entry)));
            let kept = |function: &LinearFunction<T>| LinearFunction {
                constant: function.constant,
                coefficients: entries.iter().map(|&entry| function.coefficients[entry]).collect(),
            };
            Block { functions: own.map(kept).collect(), entries }
        };
        Self { blocks: (0..dimension).filter(|group| groups.contains(group)).map(block).collect(), dimension }
    }

    /// The y at which `objective . y` is greatest among those where no function is negative; `None` if it grows without
    /// bound. At y = 0 no function may be negative.
    pub fn maximize(&self, objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
        let mut y = vec![T::zero(); self.dimension];
        for block in &self.blocks {
            let gain: Vec<T> = block.entries.iter().map(|&entry| objective[entry]).collect();
            if gain.iter().any(|own| own.sign() != Sign::Zero) {
                let Some(best) = maximize_block(&block.functions, &gain)? else { return Ok(None) };
                block.put(&best, &mut y);
            }
        }
        Ok(Some(y))
    }
}

/// As [`Program::maximize`], of `functions` that are asked once.
pub fn maximize<T: Ordered>(functions: &[LinearFunction<T>], objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
    Program::of(functions, objective.len()).maximize(objective)
}

impl<T: Ordered> Block<T> {
    /// Takes over its entries of y.
    fn put(&self, own: &[T], y: &mut [T]) {
        self.entries.iter().zip(own).for_each(|(&entry, &value)| y[entry] = value);
    }

    /// As [`widest`], of this block alone.
    fn widest(&self, cap: T) -> Result<(Vec<T>, T), Unsettled> {
        let least = least(&self.functions, cap)?;
        // Unknowns y and s = rise above `least`; at y = 0, s = 0 every function is where it must be.
        let (one, still) = (T::one(), vec![T::zero(); self.entries.len()]);
        let shifted = self.functions.iter().map(|function| function.extended(function.constant - least, -one));
        let top = LinearFunction { constant: cap - least, coefficients: extended(&still, -one) };
        let program: Vec<LinearFunction<T>> = shifted.chain([top]).collect();
        // The cap bounds the program.
        let mut y = maximize_block(&program, &extended(&still, one))?.ok_or(Unsettled)?;
        let rise = y.pop().ok_or(Unsettled)?;
        Ok((y, least + rise))
    }
}

/// As [`Program::maximize`], of one block.
fn maximize_block<T: Ordered>(functions: &[LinearFunction<T>], objective: &[T]) -> Result<Option<Vec<T>>, Unsettled> {
    let free = objective.len();
    if let &[gain] = objective {
        // One entry goes on until the first function stops it.
        let rising = match settled(gain)? {
            Ordering::Equal => return Ok(Some(vec![T::zero()])),
            sign => sign.is_gt(),
        };
        let rows = functions.iter().enumerate().map(|(label, own)| (label, own.coefficients[0], own.constant));
        let stop = first_at_zero(rows, rising)?;
        let way = |(_, [value, speed]): (usize, Pair<T>)| if rising { value / speed } else { -(value / speed) };
        return Ok(stop.map(|stop| vec![way(stop)]));
    }
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

/// The least value of the functions at y = 0, at most `cap`.
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

    /// The row of the basic variable that reaches zero first.
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

/// Which of some functions, each its label, its slope and its value, reaches zero first where it falls, of several the one
/// with the lowest label; with its value and speed.
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
        // It reaches zero after value / speed, whose comparison needs no division.
        let first = match least {
            None => true,
            Some((other, [least, of_least])) => match settled(value * of_least - least * speed)? {
                Ordering::Less => true,
                Ordering::Equal => label < other,
                Ordering::Greater => false,
            },
        };
        if first {
            least = Some((label, [value, speed]));
        }
    }
    Ok(least)
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
    let is_constant = |function: &&LinearFunction<T>| function.coefficients.iter().all(|own| own.sign() == Sign::Zero);
    let mut smallest = least(functions.iter().filter(is_constant), cap)?;
    let mut y = vec![T::zero(); dimension];
    for block in Program::of(functions, dimension).blocks {
        let (own, value) = block.widest(cap)?;
        block.put(&own, &mut y);
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

    #[test]
    fn functions_without_a_common_entry_are_separate() {
        // |y1| <= 1/3 or so, y2 >= 1/4 at least by 1/8: in plain balls neither sees the other.
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
        let off =
            numbers(y).iter().zip([0.0, 1.25 / 3.0, 0.0]).map(|(own, expected)| (own - expected).abs()).sum::<f64>();
        assert!(off < 1e-15 && least.to_f64() == 0.3, "{off} {least:?}");
        let negative = [&functions[..], &[affine(-0.5, [0.0; 3])]].concat();
        assert_eq!(widest(&negative, 3, cap).unwrap().1.to_f64(), -0.5);
        let objective = [1.0, -1.0, 0.0].map(Ball::from_f64);
        assert_eq!(maximize(&functions, &objective).unwrap().map(numbers), Some(vec![third, -0.125, 0.0]));
        // Nothing holds the last entry.
        assert!(maximize(&functions, &[0.0, 0.0, 1.0].map(Ball::from_f64)).unwrap().is_none());
        assert_eq!(maximize(&[], &[Ball::zero(); 2]).unwrap().map(numbers), Some(vec![0.0; 2]));
    }
}
