//! Arrays of answers as a table.

use super::columnar::{ColumnBlock, ColumnWriter, TOGETHER};
use super::csv::{Cell, Row, RowSink};
use super::{Arrays, Columns};
use crate::read::table::Form;
use crate::{Mode, Result, Verdict};
use std::ops::Range;

impl Arrays {
    /// Appends the rows of these states, of which nothing is carried through; their ids are their numbers from 0.
    fn append_rows(&self, columns: &Columns, states: Range<usize>, out: &mut impl RowSink) {
        for state in states {
            let outcomes = self.offsets[state] as usize..self.offsets[state + 1] as usize;
            if outcomes.is_empty() {
                out.row(columns, |row| {
                    if self.state(columns, state, row).is_some() {
                        row.set(columns.named + 3, Cell::Boolean(self.all_proven[state]));
                    }
                });
            }
            for (count, at) in (1..).zip(outcomes) {
                out.row(columns, |row| {
                    self.state(columns, state, row);
                    self.outcome(columns, (count, at), row);
                });
            }
        }
    }

    /// Sets what all outcomes of a state have in common; gives its verdict, if it is not refused.
    fn state(&self, columns: &Columns, state: usize, row: &mut impl Row) -> Option<Verdict> {
        let verdict = Verdict::ALL.get(usize::from(self.verdict[state])).copied();
        row.set(0, Cell::Integer(state as i64));
        row.set(columns.named, Cell::Text(verdict.map_or("refused", Verdict::name)));
        row.set(columns.family() + 2, Cell::Text(self.error.get(state)));
        row.set(columns.family() + 3, Cell::Text(self.notes.get(state)));
        verdict
    }

    /// Sets the cells of an outcome, which is the state's number `count` and is `at` in the arrays.
    fn outcome(&self, columns: &Columns, (count, at): (i64, usize), row: &mut impl Row) {
        let contacts = columns.contacts().len();
        // Of what is not decided no number is known.
        let mut number = |place: usize, own: f64| {
            if !own.is_nan() {
                row.set(place, Cell::Number(own));
            }
        };
        number(columns.named + 2, self.margin[at]);
        let places = || (columns.contacts_start()..).step_by(columns.of_contact());
        for (place, impulse) in places().zip(self.impulse[2 * at * contacts..][..2 * contacts].chunks_exact(2)) {
            impulse.iter().zip(place + 1..).for_each(|(&entry, place)| number(place, entry));
        }
        let velocity = &self.velocity_after[at * columns.coordinates..][..columns.coordinates];
        velocity.iter().zip(columns.velocities()..).for_each(|(&entry, place)| number(place, entry));
        row.set(columns.named + 1, Cell::Integer(count));
        row.set(columns.named + 3, Cell::Boolean(self.proven[at]));
        for (place, mode) in places().zip(&self.modes[at * contacts..][..contacts]) {
            let mode = usize::try_from(*mode).ok().and_then(|mode| Mode::ALL.get(mode));
            row.set(place, Cell::Text(mode.map_or("", |mode| mode.name())));
        }
        row.set(columns.last(), Cell::Text(self.border.get(at)));
        row.set(columns.family(), Cell::Boolean(self.family[at]));
        row.set(columns.family() + 1, Cell::Text(self.families.get(at)));
    }

    /// All rows of these columns, as Arrow's stream: one per outcome, with the numbers of states from 0 for ids.
    ///
    /// # Errors
    /// As [`ColumnWriter::new`].
    pub fn arrow_stream(&self, columns: &Columns) -> Result<Vec<u8>> {
        let mut writer = ColumnWriter::new(columns, Form::Arrows)?;
        let (mut bytes, states) = (Vec::new(), self.verdict.len());
        for start in (0..states).step_by(TOGETHER) {
            let states = start..states.min(start + TOGETHER);
            let mut block = ColumnBlock::new(columns, states.len());
            self.append_rows(columns, states, &mut block);
            bytes.append(&mut writer.write(block)?);
        }
        bytes.append(&mut writer.finish()?);
        Ok(bytes)
    }
}
