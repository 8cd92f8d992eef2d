//! Linear equations and inequalities with free variables.
//!
//! ```text
//!     A x = b  -->  x = x0 + N s, by elimination with full pivoting;    is there an s with p + Q s >= 0 (or > 0)?
//! ```

use crate::balls::number::Number;
use std::cmp::Ordering;

/// The rule by which a number counts as zero.
#[derive(Debug, Clone, Copy)]
pub struct Zero {
    /// Whether this is the highest precision, at which numbers below 2^-150 of their scale count as zero.
    pub last: bool,
}

/// 2^-150.
const SMALL: f64 = 7.006492321624085e-46;

impl Zero {
    /// `number` compared with zero; `None` if undecided.
    pub fn sign<N: Number>(self, number: &N, scale: f64) -> Option<Ordering> {
        let small = || self.last && number.size() < SMALL * scale;
        number.sign().or_else(|| small().then_some(Ordering::Equal))
    }
}

/// An affine function of the free variables: constant + sum of factors * s.
#[derive(Debug, Clone)]
pub struct Affine<N> {
    pub constant: N,
    pub factors: Vec<N>,
}

impl<N: Number> Affine<N> {
    /// A constant, with zero factors of the `free` variables.
    pub fn constant(constant: N, free: usize, bits: usize) -> Self {
        Self { constant, factors: vec![N::new(0.0, bits); free] }
    }

    pub fn plus(&self, other: &Self) -> Self {
        let factors = self.factors.iter().zip(&other.factors).map(|(a, b)| a.plus(b)).collect();
        Self { constant: self.constant.plus(&other.constant), factors }
    }

    pub fn times(&self, factor: &N) -> Self {
        let factors = self.factors.iter().map(|entry| entry.times(factor)).collect();
        Self { constant: self.constant.times(factor), factors }
    }
}

/// All solutions of a system of equations.
pub struct Solution<N> {
    /// The unknowns as functions of the free variables.
    pub values: Vec<Affine<N>>,
    /// Number of free variables; zero in a regular system.
    pub free: usize,
    /// Sign of the determinant of a regular system.
    pub sign: i8,
}

/// The result of solving a system of equations.
pub enum Solved<N> {
    /// Not decided by this precision.
    Open,
    Contradictory,
    Solution(Solution<N>),
}

/// Solves the square system `rows` = [A | b] in `bits` bits; `scale` and `scale_right` are the scales of A and b.
pub fn solve<N: Number>(mut rows: Vec<Vec<N>>, zero: Zero, scale: f64, scale_right: f64, bits: usize) -> Solved<N> {
    let n = rows.len();
    let mut columns: Vec<usize> = (0..n).collect();
    let mut sign = 1;
    let mut rank = 0;
    while rank < n {
        let k = rank;
        let places = (k..n).flat_map(|row| (k..n).map(move |column| (row, column)));
        let at = |(row, column): (usize, usize)| -> &N { &rows[row][column] };
        let signed = |&place: &(usize, usize)| at(place).sign().is_some_and(Ordering::is_ne);
        let largest = places.clone().filter(signed).max_by(|&a, &b| at(a).size().total_cmp(&at(b).size()));
        let Some((row, column)) = largest else {
            if !places.into_iter().all(|place| zero.sign(at(place), scale) == Some(Ordering::Equal)) {
                return Solved::Open;
            }
            break;
        };
        if row != k {
            rows.swap(row, k);
            sign = -sign;
        }
        if column != k {
            rows.iter_mut().for_each(|row| row.swap(column, k));
            columns.swap(column, k);
            sign = -sign;
        }
        if rows[k][k].sign() == Some(Ordering::Less) {
            sign = -sign;
        }
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot_row = &above[k];
        for row in below {
            if row[k].is_zero() {
                continue;
            }
            let factor = row[k].over(&pivot_row[k]);
            for (entry, over) in row.iter_mut().zip(pivot_row).skip(k + 1) {
                *entry = entry.minus(&factor.times(over));
            }
        }
        rank += 1;
    }
    let mut open = false;
    for row in &rows[rank..] {
        match zero.sign(&row[n], scale_right) {
            None => open = true,
            Some(Ordering::Equal) => {}
            Some(_) => return Solved::Contradictory,
        }
    }
    if open {
        return Solved::Open;
    }

    // Unknowns beyond the rank are free; the others follow from the last to the first.
    let free = n - rank;
    let mut values = vec![Affine::constant(N::new(0.0, bits), free, bits); n];
    (rank..n).for_each(|column| values[column].factors[column - rank] = N::new(1.0, bits));
    for k in (0..rank).rev() {
        let mut rest = Affine::constant(rows[k][n].clone(), free, bits);
        for column in k + 1..n {
            rest = rest.plus(&values[column].times(&rows[k][column].negative()));
        }
        let over = |number: &N| number.over(&rows[k][k]);
        values[k] = Affine { constant: over(&rest.constant), factors: rest.factors.iter().map(over).collect() };
    }
    let mut ordered: Vec<(usize, Affine<N>)> = columns.into_iter().zip(values).collect();
    ordered.sort_by_key(|&(column, _)| column);
    Solved::Solution(Solution { values: ordered.into_iter().map(|(_, value)| value).collect(), free, sign })
}

/// The inequality `value >= 0`, or `> 0` where it is strict.
#[derive(Debug, Clone)]
pub struct Inequality<N> {
    pub value: Affine<N>,
    /// The size of the constant; factors have the size `scale / unit`.
    pub scale: f64,
    pub strict: bool,
}

/// The largest number of inequalities that is tested; more are left undecided.
const MOST: usize = 4000;

/// Whether some choice of the free variables, each of size `unit`, satisfies all inequalities; `None` if undecided.
///
/// Fourier-Motzkin elimination: a variable is eliminated by adding each inequality that bounds it from below to each
/// that bounds it from above.
pub fn feasible<N: Number>(mut list: Vec<Inequality<N>>, zero: Zero, unit: f64) -> Option<bool> {
    let free = list.first().map_or(0, |first| first.value.factors.len());
    for _ in 0..free {
        let (mut lower, mut upper, mut rest) = (Vec::new(), Vec::new(), Vec::new());
        for mut inequality in list {
            let factor = inequality.value.factors.pop().expect("one for each free number");
            match zero.sign(&factor, inequality.scale / unit)? {
                Ordering::Equal => rest.push(inequality),
                Ordering::Greater => lower.push((factor, inequality)),
                Ordering::Less => upper.push((factor.negative(), inequality)),
            }
        }
        if rest.len() + lower.len() * upper.len() > MOST {
            return None;
        }
        for (a, below) in &lower {
            for (b, above) in &upper {
                rest.push(Inequality {
                    value: below.value.times(b).plus(&above.value.times(a)),
                    scale: below.scale * b.size() + above.scale * a.size(),
                    strict: below.strict || above.strict,
                });
            }
        }
        list = rest;
    }
    let mut decided = true;
    for Inequality { value, scale, strict } in &list {
        match zero.sign(&value.constant, *scale) {
            None => decided = false,
            Some(Ordering::Less) => return Some(false),
            Some(Ordering::Equal) if *strict => return Some(false),
            Some(_) => {}
        }
    }
    decided.then_some(true)
}
