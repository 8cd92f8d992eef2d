//! Arrays of answers as a table.

use super::columnar::{ColumnBlock, ColumnWriter, ColumnarFormat, TOGETHER};
use super::csv::{Cell, RowSink};
use super::{Arrays, Columns};
use crate::{Mode, Result, Verdict};
use std::ops::Range;

impl Arrays {
    /// Appends the rows of these states, of which nothing is carried through; their ids are their numbers from 0.
    fn append_rows(&self, columns: &Columns, states: Range<usize>, out: &mut dyn RowSink) {
        let contacts = columns.contacts().len();
        let number = |own: f64| if own.is_nan() { Cell::Empty } else { Cell::Number(own) };
        for state in states {
            let mut cells = columns.cells(None, None, None);
            let verdict = Verdict::ALL.get(usize::from(self.verdict[state]));
            cells.0[0] = Cell::Integer(state as i64);
            cells.text(columns.named, verdict.map_or("refused", |verdict| verdict.name()));
            cells.0[columns.named + 3] = verdict.map_or(Cell::Empty, |_| Cell::Boolean(self.all_proven[state]));
            cells.text(columns.family() + 2, self.error.get(state));
            cells.text(columns.family() + 3, self.notes.get(state));
            let outcomes = self.offsets[state] as usize..self.offsets[state + 1] as usize;
            if outcomes.is_empty() {
                out.row(columns, &cells.0);
            }
            for (at, row) in outcomes.enumerate() {
                cells.0[columns.named + 1] = Cell::Integer(at as i64 + 1);
                cells.0[columns.named + 2] = number(self.margin[row]);
                cells.0[columns.named + 3] = Cell::Boolean(self.proven[row]);
                let modes = &self.modes[row * contacts..][..contacts];
                let impulses = self.impulse[2 * row * contacts..].chunks_exact(2);
                let places = (columns.contacts_start()..).step_by(columns.of_contact());
                for ((place, mode), impulse) in places.zip(modes).zip(impulses) {
                    let mode = usize::try_from(*mode).ok().and_then(|mode| Mode::ALL.get(mode));
                    cells.text(place, mode.map_or("", |mode| mode.name()));
                    impulse.iter().zip(place + 1..).for_each(|(&entry, at)| cells.0[at] = number(entry));
                }
                let velocity = &self.velocity_after[row * columns.coordinates..][..columns.coordinates];
                velocity.iter().zip(columns.velocities()..).for_each(|(&entry, at)| cells.number(at, entry));
                cells.text(columns.last(), self.border.get(row));
                cells.0[columns.family()] = Cell::Boolean(self.family[row]);
                cells.text(columns.family() + 1, self.families.get(row));
                out.row(columns, &cells.0);
            }
        }
    }

    /// All rows of these columns, as Arrow's stream: one per outcome, with the numbers of states from 0 for ids.
    ///
    /// # Errors
    /// As [`ColumnWriter::new`].
    pub fn arrow_stream(&self, columns: &Columns) -> Result<Vec<u8>> {
        let mut writer = ColumnWriter::new(columns, ColumnarFormat::ArrowStream)?;
        let (mut bytes, states) = (Vec::new(), self.verdict.len());
        for start in (0..states).step_by(TOGETHER) {
            let mut block = ColumnBlock::new(columns);
            self.append_rows(columns, start..states.min(start + TOGETHER), &mut block);
            bytes.append(&mut writer.write(block)?);
        }
        bytes.append(&mut writer.finish()?);
        Ok(bytes)
    }
}
