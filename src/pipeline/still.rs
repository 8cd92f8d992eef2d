//! Contacts at rest, and the rows of G through which other contacts depend on them.

use crate::scalar::Real;

/// A row of G depends on others if at most this fraction of it is left; the error of G replaces it if it is greater.
const DEPENDENT: f64 = 1e-12;

/// The relative rounding of a row of G, with room for its sums.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A determinant of the scaled G above this is far from all rounding.
const REGULAR: f64 = 1e-6;

/// If the relative error of G is not below this, nothing is known.
pub const WELL_KNOWN: f64 = 1e-4;

/// The contacts at rest. The c of other contacts is adjusted to them, so that all of c belongs to one motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Still {
    /// Whether each contact is at rest; empty if none is taken so.
    pub contacts: Vec<bool>,
    /// Independent rows of G of the contacts at rest (2 contact + axis), in the order in which every number type
    /// eliminates them; empty if no other contact depends on them.
    pub rows: Vec<usize>,
    /// Other contacts whose rows all depend on these: no impulse moves them while the contacts at rest stay so.
    pub held: Vec<usize>,
}

impl Still {
    /// Keeps the contacts that have a new `place`, and renumbers them and their rows. All contacts at rest must have
    /// one.
    pub fn keep(&mut self, place: impl Fn(usize) -> Option<usize>) {
        let mut at = 0..;
        self.contacts.retain(|_| at.next().and_then(&place).is_some());
        self.rows.iter_mut().for_each(|row| *row = place(*row / 2).map_or(*row, |at| 2 * at + *row % 2));
        self.held = self.held.iter().copied().filter_map(place).collect();
    }

    /// Finds the rows and the held contacts from G, whose entries have the relative `error`; `scratch` is memory.
    pub fn find_rows(&mut self, delassus: &[f64], error: f64, scratch: &mut Vec<f64>) {
        let Self { contacts, rows, held } = self;
        let tolerance = if error < WELL_KNOWN { error.max(DEPENDENT) } else { DEPENDENT };
        scratch.clear();
        scratch.resize(delassus.len() + 2 * contacts.len(), 0.0);
        let (left, growth) = scratch.split_at_mut(delassus.len());
        let mut pivoting = Pivoting { delassus, tolerance, left, growth };
        if pivoting.is_regular() {
            return;
        }
        pivoting.start();
        pivoting.count(|row| contacts[row / 2], |row| rows.push(row));
        let moving = (0..contacts.len()).filter(|&contact| !contacts[contact]);
        held.extend(moving.filter(|contact| [2 * contact, 2 * contact + 1].iter().all(|row| pivoting.follows(*row))));
        let moves = |row: usize| !contacts[row / 2];
        let beside = pivoting.count(moves, |_| {});
        pivoting.start();
        if beside == pivoting.count(moves, |_| {}) {
            rows.clear();
        }
    }
}

/// Elimination of rows of G, the most independent row first.
struct Pivoting<'a> {
    delassus: &'a [f64],
    /// A row of which a smaller fraction is left counts as zero.
    tolerance: f64,
    /// The part of G that is left by the eliminated rows.
    left: &'a mut [f64],
    /// The growth of the rounding of each row by these eliminations; infinite for an eliminated row.
    growth: &'a mut [f64],
}

impl Pivoting<'_> {
    fn start(&mut self) {
        self.left.copy_from_slice(self.delassus);
        self.growth.fill(1.0);
    }

    /// Returns whether all rows are clearly independent, which is nearly always so.
    ///
    /// With rows scaled to a unit diagonal, G has this determinant, and no row's remainder is smaller than it.
    fn is_regular(&mut self) -> bool {
        self.start();
        let size = self.growth.len();
        let mut determinant = 1.0;
        for row in 0..size {
            determinant *= self.share(row);
            if determinant.is_nan() || determinant <= REGULAR.max(2.0 * self.tolerance) {
                return false;
            }
            // Only the part below the diagonal is updated: nothing else is read here.
            let (above, below) = self.left.split_at_mut((row + 1) * size);
            let pivot_row = &above[row * size + row..];
            for other in below.chunks_exact_mut(size) {
                let (share, others) = (other[row] / pivot_row[0], &mut other[row + 1..]);
                others.iter_mut().zip(&pivot_row[1..]).for_each(|(entry, pivot)| *entry -= share * pivot);
            }
        }
        true
    }

    /// Returns whether only rounding is left of a row.
    fn follows(&self, row: usize) -> bool {
        self.share(row) <= self.tolerance + ROUNDING * self.growth[row]
    }

    /// The fraction of a row that is left; zero for a row that cannot move.
    fn share(&self, row: usize) -> f64 {
        let diagonal = row * (self.growth.len() + 1);
        if self.delassus[diagonal] > 0.0 { self.left[diagonal] / self.delassus[diagonal] } else { 0.0 }
    }

    /// Eliminates the `wanted` rows that do not depend on others, and reports each to `chosen`; returns their number.
    fn count(&mut self, wanted: impl Fn(usize) -> bool, mut chosen: impl FnMut(usize)) -> usize {
        let size = self.growth.len();
        let mut count = 0;
        loop {
            let open = (0..size).filter(|&row| wanted(row) && !self.follows(row));
            let Some(row) = open.max_by(|a, b| self.share(*a).total_cmp(&self.share(*b))) else { return count };
            chosen(row);
            count += 1;
            self.growth[row] = f64::INFINITY;
            for other in (0..size).filter(|other| *other != row) {
                if self.growth[other] < f64::INFINITY && self.delassus[other * (size + 1)] > 0.0 {
                    let share = eliminate(self.left, size, row, other);
                    self.left[other * size + row] = 0.0;
                    let scale = self.delassus[row * (size + 1)] / self.delassus[other * (size + 1)];
                    self.growth[other] += share * share * scale;
                }
            }
        }
    }
}

/// Eliminates `row` of a square matrix of this size from its row `other`, and returns the factor.
pub fn eliminate<T: Real>(matrix: &mut [T], size: usize, row: usize, other: usize) -> T {
    let share = matrix[other * size + row] / matrix[row * size + row];
    for column in 0..size {
        matrix[other * size + column] = matrix[other * size + column] - share * matrix[row * size + column];
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The result for rows (with equal masses in all columns) of two contacts at rest and one that moves.
    fn found(rows: [[f64; 4]; 6]) -> Still {
        let entry = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let delassus: Vec<f64> = rows.iter().flat_map(|a| rows.iter().map(|b| entry(a, b))).collect();
        let mut still = Still { contacts: vec![true, true, false], ..Still::default() };
        still.find_rows(&delassus, 0.0, &mut Vec::new());
        still
    }

    #[test]
    fn rows_count_where_another_contact_depends_on_them() {
        let [x, y, z, w] = [0, 1, 2, 3].map(|at| std::array::from_fn(|i| f64::from(u8::from(i == at))));
        let zero = [0.0; 4];
        // The third contact is independent of the two at rest, one of whose rows depends on another.
        let free = found([x, y, y, zero, z, w]);
        assert!(free.rows.is_empty() && free.held.is_empty());
        // One of its rows depends on theirs, or both do.
        let half = found([x, y, y, zero, [1.0, -2.0, 0.0, 0.0], w]);
        assert!(half.rows.len() == 2 && half.held.is_empty());
        let held = found([x, y, z, zero, [1.0, -2.0, 0.0, 0.0], [0.0, 0.0, 3.0, 0.0]]);
        assert!(held.rows.len() == 3 && held.held == [2]);
        // A row that is nearly the same is independent.
        let near = found([x, zero, [1.0, 1e-5, 0.0, 0.0], zero, [1.0, 0.0, 1e-5, 0.0], w]);
        assert!(near.rows.is_empty() && near.held.is_empty());
    }

    #[test]
    fn contacts_that_stay_are_renumbered_everywhere() {
        let mut still = Still { contacts: vec![false, false, true, true], rows: vec![4, 7], held: vec![0, 1, 3] };
        still.keep(|at| at.checked_sub(1));
        assert_eq!(still, Still { contacts: vec![false, true, true], rows: vec![2, 5], held: vec![0, 2] });
    }

    #[test]
    fn regular_rows_follow_from_no_others() {
        // Two points of one body. The second also moves along the ground by itself, by less and less.
        let found = [1.0, 0.3, 0.1, 1e-2, 1e-4, 1e-9].map(|gives: f64| {
            let rows = [[1.0, 0.0, 0.7, 0.0], [0.0, 1.0, -0.4, 0.0], [1.0, 0.0, 0.9, gives], [0.0, 1.0, 0.5, 0.0]];
            let entry = |a: [f64; 4], b: [f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let delassus: Vec<f64> = rows.iter().flat_map(|a| rows.map(|b| entry(*a, b))).collect();
            let [mut left, mut growth] = [vec![0.0; 16], vec![0.0; 4]];
            let mut pivoting = Pivoting { delassus: &delassus, tolerance: 1e-6, left: &mut left, growth: &mut growth };
            let is_regular = pivoting.is_regular();
            pivoting.start();
            let independent = pivoting.count(|_| true, |_| {});
            assert!(!is_regular || independent == 4, "{gives}: {independent} rows");
            let mut still = Still { contacts: vec![true, false], ..Still::default() };
            still.find_rows(&delassus, 1e-6, &mut Vec::new());
            assert!(!is_regular || still.rows.is_empty() && still.held.is_empty());
            (is_regular, independent)
        });
        assert_eq!([found[0], found[4], found[5]], [(true, 4), (false, 3), (false, 3)]);
    }

    #[test]
    fn points_close_to_each_other_hold_their_body() {
        for apart in [1e-4, 1e-3, 1e-2] {
            for seed in 0..200 {
                let at = |which: u32| f64::from(seed * 7 + which * 3).sin();
                let near = [at(0) + apart * at(3).cos(), at(1) + apart * at(3).sin()];
                let points = [[at(0), at(1)], near, [at(4), at(5)]];
                let rows = points.map(|[x, z]| [[1.0, 0.0, 3.0 * z, 0.0], [0.0, 1.0, -3.0 * x, 0.0]]);
                let still = found(rows.as_flattened().try_into().expect("six rows"));
                assert!(still.rows.len() == 3 && still.held == [2], "{apart} {seed}: {still:?}");
            }
        }
    }
}
