//! The dual simplex method in f64. It only searches; other modules prove its results.

use super::ranges::Ranges;
use std::cmp::Ordering;

/// Scaled numbers nearer to zero than this count as zero in the search.
const TOLERANCE: f64 = 1e-9;
/// The distance from zero that strict inequalities keep in the search.
const STRICT: f64 = 1e-7;
/// The search gives up after this many pivots per row.
const PIVOTS: usize = 6;
/// Rows are padded to a multiple of this length.
pub const LANES: usize = 4;

/// Basic variables as affine functions of the nonbasic ones. The first 2n are velocities, the others multipliers.
#[derive(Debug, Clone, Default)]
pub struct Dictionary {
    /// One row per basic variable: its coefficients of the nonbasic variables, padding, and last its value.
    pub entries: Vec<f64>,
    pub width: usize,
    pub basic: Vec<usize>,
    pub nonbasic: Vec<usize>,
    pub ranges: Ranges,
}

/// A variable that cannot reach its range, and the sign of the change that it lacks.
#[derive(Debug, Clone, Copy)]
pub struct Lack {
    pub variable: usize,
    pub sign: f64,
}

impl Dictionary {
    pub fn copy(&mut self, other: &Self) {
        self.entries.clone_from(&other.entries);
        self.basic.clone_from(&other.basic);
        self.nonbasic.clone_from(&other.nonbasic);
        self.width = other.width;
    }

    /// Measures a velocity from [`STRICT`] in the direction `sign`, so that a strict sign keeps it away from zero.
    pub fn keep_from_zero(&mut self, variable: usize, sign: Ordering) {
        let from = f64::from(sign as i8) * STRICT;
        let width = self.width;
        if let Some(row) = self.basic.iter().position(|&basic| basic == variable) {
            self.entries[(row + 1) * width - 1] -= from;
        } else if let Some(column) = self.nonbasic.iter().position(|&nonbasic| nonbasic == variable) {
            for row in self.entries.chunks_exact_mut(width) {
                row[width - 1] += row[column] * from;
            }
        }
    }

    /// Pivots until all variables are in their ranges. Returns one that cannot; `None` also if it gives up.
    pub fn impossible(&mut self) -> Option<Lack> {
        let width = self.width;
        for _ in 0..PIVOTS * self.basic.len() {
            let (mut most, mut worst) = (TOLERANCE, None);
            for (row, (&variable, entries)) in self.basic.iter().zip(self.entries.chunks_exact(width)).enumerate() {
                let (value, range) = (entries[width - 1], self.ranges.get(variable));
                let sign = if value < 0.0 && !range.below_zero {
                    1.0
                } else if value > 0.0 && !range.above_zero {
                    -1.0
                } else {
                    continue;
                };
                if value.abs() > most {
                    (most, worst) = (value.abs(), Some((row, sign)));
                }
            }
            let (row, sign) = worst?;
            let (mut most, mut entering) = (TOLERANCE, None);
            let coefficients = &self.entries[row * width..][..width - 1];
            for (column, (&variable, &coefficient)) in self.nonbasic.iter().zip(coefficients).enumerate() {
                let (slope, range) = (sign * coefficient, self.ranges.get(variable));
                let moves = if slope > 0.0 { range.above_zero } else { range.below_zero };
                if moves && slope.abs() > most {
                    (most, entering) = (slope.abs(), Some(column));
                }
            }
            match entering {
                Some(column) => self.pivot(row, column),
                None => return Some(Lack { variable: self.basic[row], sign }),
            }
        }
        None
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let width = self.width;
        let (before, rest) = self.entries.split_at_mut(row * width);
        let (pivot_row, after) = rest.split_at_mut(width);
        let inverse = 1.0 / pivot_row[column];
        pivot_row.iter_mut().for_each(|entry| *entry *= -inverse);
        pivot_row[column] = inverse;
        for other in before.chunks_exact_mut(width).chain(after.chunks_exact_mut(width)) {
            let factor = std::mem::take(&mut other[column]);
            for (entries, pivots) in other.as_chunks_mut::<LANES>().0.iter_mut().zip(pivot_row.as_chunks::<LANES>().0) {
                entries.iter_mut().zip(pivots).for_each(|(entry, pivot)| *entry += factor * pivot);
            }
        }
        std::mem::swap(&mut self.basic[row], &mut self.nonbasic[column]);
    }
}
