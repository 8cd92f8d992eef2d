//! Contacts at rest, and the rows of G by which others depend on them.

use crate::scalar::Real;

/// A row of G follows from others if no more than this part of it is left, or than G is known to.
const DEPENDENT: f64 = 1e-12;

/// A greater relative error of G leaves nothing known.
pub const WELL_KNOWN: f64 = 1e-4;

/// The contacts at rest, next to which c of the others is taken, so that impulses can give c of all.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Still {
    /// Which contacts they are; empty if none is taken so.
    pub contacts: Vec<bool>,
    /// Their rows of G that count, 2 contact + axis, in the order in which every number eliminates them; empty if no
    /// other contact depends on them.
    pub rows: Vec<usize>,
    /// Other contacts whose rows all follow from these: no impulse moves them while these rest.
    pub held: Vec<usize>,
}

impl Still {
    /// Keeps the contacts that have a new `place`; all at rest have one.
    pub fn keep(&mut self, place: impl Fn(usize) -> Option<usize>) {
        let mut at = 0..;
        self.contacts.retain(|_| at.next().and_then(&place).is_some());
        self.rows.iter_mut().for_each(|row| *row = place(*row / 2).map_or(*row, |at| 2 * at + *row % 2));
    }

    /// Finds the rows, and the contacts that they hold, from G, of which entries are known to `error`; `left` is scratch.
    pub fn find_rows(&mut self, delassus: &[f64], error: f64, left: &mut Vec<f64>) {
        let Self { contacts, rows, held } = self;
        let tolerance = if error < WELL_KNOWN { error.max(DEPENDENT) } else { DEPENDENT };
        let known = Known { delassus, tolerance };
        left.clear();
        left.extend(delassus);
        known.count_rows(left, |row| contacts[row / 2], |row| rows.push(row));
        let is_held = |row: &usize| known.share(left, *row).is_none_or(|share| share <= tolerance);
        let moving = (0..contacts.len()).filter(|&contact| !contacts[contact]);
        held.extend(moving.filter(|contact| [2 * contact, 2 * contact + 1].iter().all(is_held)));
        let moves = |row: usize| !contacts[row / 2];
        let beside = known.count_rows(left, moves, |_| {});
        left.copy_from_slice(delassus);
        if beside == known.count_rows(left, moves, |_| {}) {
            rows.clear();
        }
    }
}

/// G, and what part of a row is nothing.
struct Known<'a> {
    delassus: &'a [f64],
    tolerance: f64,
}

impl Known<'_> {
    /// What part of a row is left; `None` of one that cannot move.
    fn share(&self, left: &[f64], row: usize) -> Option<f64> {
        let diagonal = row * (self.delassus.len().isqrt() + 1);
        (self.delassus[diagonal] > 0.0).then(|| left[diagonal] / self.delassus[diagonal])
    }

    /// Counts the `wanted` rows that do not follow from others of them, the most independent first, and reports each to
    /// `chosen`. Takes the part along these from all rows of `left`, which is G, or what rows before them left of it.
    fn count_rows(&self, left: &mut [f64], wanted: impl Fn(usize) -> bool, mut chosen: impl FnMut(usize)) -> usize {
        let size = self.delassus.len().isqrt();
        let mut count = 0;
        loop {
            let shares = (0..size).filter(|&row| wanted(row)).filter_map(|row| Some((row, self.share(left, row)?)));
            let independent = shares.filter(|(_, share)| *share > self.tolerance);
            let Some((row, _)) = independent.max_by(|a, b| a.1.total_cmp(&b.1)) else { return count };
            chosen(row);
            count += 1;
            (0..size).filter(|other| *other != row).for_each(|other| _ = eliminate(left, row, other));
            left[row * (size + 1)] = 0.0;
        }
    }
}

/// Takes the part along `row` of a square matrix from its row `other`, and gives how much of it that was.
pub fn eliminate<T: Real>(matrix: &mut [T], row: usize, other: usize) -> T {
    let size = matrix.len().isqrt();
    let share = matrix[other * size + row] / matrix[row * size + row];
    for column in 0..size {
        matrix[other * size + column] = matrix[other * size + column] - share * matrix[row * size + column];
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is found from rows (the same masses in all columns) of two contacts at rest and one that moves.
    fn found(rows: [[f64; 4]; 6]) -> Still {
        let entry = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let delassus: Vec<f64> = rows.iter().flat_map(|a| rows.iter().map(|b| entry(a, b))).collect();
        let mut still = Still { contacts: vec![true, true, false], ..Still::default() };
        still.find_rows(&delassus, 0.0, &mut Vec::new());
        still
    }

    #[test]
    fn rows_count_where_another_contact_depends_on_them() {
        let [x, y, z, w] = [0, 1, 2, 3].map(|at| std::array::from_fn(|own| f64::from(u8::from(own == at))));
        let zero = [0.0; 4];
        // The third is free of the two at rest, of which one row follows from another.
        let free = found([x, y, y, zero, z, w]);
        assert!(free.rows.is_empty() && free.held.is_empty());
        // One of its rows follows from both, or both do.
        let half = found([x, y, y, zero, [1.0, -2.0, 0.0, 0.0], w]);
        assert!(half.rows.len() == 2 && half.held.is_empty());
        let held = found([x, y, z, zero, [1.0, -2.0, 0.0, 0.0], [0.0, 0.0, 3.0, 0.0]]);
        assert!(held.rows.len() == 3 && held.held == [2]);
        // A row that is nearly the same does not follow.
        let near = found([x, zero, [1.0, 1e-5, 0.0, 0.0], zero, [1.0, 0.0, 1e-5, 0.0], w]);
        assert!(near.rows.is_empty() && near.held.is_empty());
    }
}
