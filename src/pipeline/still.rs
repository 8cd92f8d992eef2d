//! Contacts at rest, and the rows of G by which others depend on them.

use crate::scalar::Real;

/// A row of G is taken to follow from others if no more than this part of it is left: where it does not, c is of a
/// motion all the same.
const DEPENDENT: f64 = 1e-10;

/// The contacts at rest, next to which c of the others is taken, so that impulses can give c of all.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Still {
    /// Which contacts they are; empty if none is taken so.
    pub contacts: Vec<bool>,
    /// Their rows of G that count, 2 contact + axis, in the order in which every number eliminates them; empty if no
    /// other contact depends on them.
    pub rows: Vec<usize>,
}

impl Still {
    /// Keeps the contacts that have a new `place`; all at rest have one.
    pub fn keep(&mut self, place: impl Fn(usize) -> Option<usize>) {
        let mut at = 0..;
        self.contacts.retain(|_| at.next().and_then(&place).is_some());
        self.rows.iter_mut().for_each(|row| *row = place(*row / 2).map_or(*row, |at| 2 * at + *row % 2));
    }

    /// Finds the rows from G, and tells `also` which contacts those at rest leave no motion; they are still, too. `left`
    /// is scratch.
    pub fn find_rows(&mut self, delassus: &[f64], left: &mut Vec<f64>, mut also: impl FnMut(usize)) {
        let Self { contacts, rows } = self;
        let size = 2 * contacts.len();
        left.clear();
        left.extend(delassus);
        count_rows(left, delassus, |row| contacts[row / 2], |row| rows.push(row));
        let is_held = |row: usize| left[row * (size + 1)] <= DEPENDENT * delassus[row * (size + 1)];
        for (contact, still) in contacts.iter_mut().enumerate() {
            if !*still && is_held(2 * contact) && is_held(2 * contact + 1) {
                *still = true;
                also(contact);
            }
        }
        let moves = |row: usize| !contacts[row / 2];
        let beside = count_rows(left, delassus, moves, |_| {});
        left.copy_from_slice(delassus);
        if beside == count_rows(left, delassus, moves, |_| {}) {
            rows.clear();
        }
    }
}

/// How many of the `wanted` rows of G do not follow from others of them, the most independent first; takes the part along
/// these, which `chosen` is told, from all rows of `left`, which is G, or what rows before them left of it.
fn count_rows(
    left: &mut [f64],
    delassus: &[f64],
    wanted: impl Fn(usize) -> bool,
    mut chosen: impl FnMut(usize),
) -> usize {
    let size = delassus.len().isqrt();
    for count in 0.. {
        let share = |row: usize| left[row * (size + 1)] / delassus[row * (size + 1)];
        let shares = (0..size).filter(|&row| wanted(row)).map(|row| (row, share(row)));
        let independent = shares.filter(|(_, share)| *share > DEPENDENT);
        let Some((row, _)) = independent.max_by(|a, b| a.1.total_cmp(&b.1)) else { return count };
        chosen(row);
        (0..size).filter(|other| *other != row).for_each(|other| _ = eliminate(left, row, other));
        left[row * (size + 1)] = 0.0;
    }
    size
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

    /// G of rows (the same masses in all columns) of two contacts at rest and one that moves.
    fn found(rows: [[f64; 4]; 6]) -> (Still, Vec<usize>) {
        let entry = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let delassus: Vec<f64> = rows.iter().flat_map(|a| rows.iter().map(|b| entry(a, b))).collect();
        let (mut still, mut also) = (Still { contacts: vec![true, true, false], rows: Vec::new() }, Vec::new());
        still.find_rows(&delassus, &mut Vec::new(), |contact| also.push(contact));
        (still, also)
    }

    #[test]
    fn rows_count_where_another_contact_depends_on_them() {
        let [x, y, z, w] = [0, 1, 2, 3].map(|at| std::array::from_fn(|own| f64::from(u8::from(own == at))));
        let zero = [0.0; 4];
        // The third is free of the two at rest, of which one row follows from another.
        assert!(found([x, y, y, zero, z, w]).0.rows.is_empty());
        // One of its rows follows from both.
        let (still, also) = found([x, y, y, zero, [1.0, -2.0, 0.0, 0.0], w]);
        assert!(still.rows.len() == 2 && still.contacts == [true, true, false] && also.is_empty());
        // Both do: it is still, and no other depends on them.
        let (still, also) = found([x, y, z, zero, [1.0, -2.0, 0.0, 0.0], [0.0, 0.0, 3.0, 0.0]]);
        assert!(still.rows.is_empty() && still.contacts == [true; 3] && also == [2]);
    }
}
