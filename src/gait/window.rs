//! The last rows of a clip, and the continuation of its motion after one of them.

use super::Sample;
use super::carry::Interpolation;
use crate::planar::Vector;
use std::collections::VecDeque;

/// The number of rows before the moment of contact that determine the state at it.
pub(super) const BEFORE: usize = 3;
/// The same number for rows without noise.
pub(super) const SMOOTH: usize = 6;

/// The number of rows that show how well the rows before them predict a motion.
pub(super) const FORETOLD: usize = 2;
/// With fewer rows than this, predictions are not compared.
const LEAST: usize = 6;

/// The last rows of a clip.
#[derive(Debug)]
pub(super) struct Window<S> {
    pub frames: VecDeque<Frame<S>>,
    /// The row before the last touchdown.
    pub last: Option<usize>,
}

/// A sample, and the places of its points.
#[derive(Debug)]
pub(super) struct Frame<S> {
    pub sample: Sample<S>,
    pub row: usize,
    pub places: Vec<Vector<f64>>,
    /// The distance of each point's height from the one to which the rows before lead, scaled to the standard deviation
    /// of a random noise \[m\]. Empty if rows are missing.
    pub noise: Vec<f64>,
    /// Whether the next sample has the same time.
    pub before_impact: bool,
}

impl<S> Window<S> {
    /// Returns the height of a point at a row \[m\].
    pub fn height(&self, point: usize, row: usize) -> f64 {
        self.frames[row].places[point].z
    }

    /// Returns the times of `rows` \[s\].
    pub fn times(&self, rows: impl IntoIterator<Item = usize>) -> Vec<f64> {
        rows.into_iter().map(|row| self.frames[row].sample.time).collect()
    }

    /// Returns at most `most` rows from which the motion continues after `row`, the last one first. None is from before
    /// an impact.
    pub fn smooth_rows(&self, row: usize, most: usize) -> Vec<usize> {
        let is_after_impact = |row: usize| self.last.is_some_and(|last| self.frames[row].row <= last);
        let before = (0..row).rev().take_while(|&row| !(self.frames[row].before_impact || is_after_impact(row)));
        std::iter::once(row).chain(before).take(most).collect()
    }

    /// Returns the continuation of the motion after `row`, by at most `most` rows. For rows without noise (`exact`),
    /// each coordinate uses as many rows as have predicted it best.
    pub fn motion(&self, row: usize, most: usize, exact: bool) -> Motion {
        let mut rows = self.smooth_rows(row, if exact { most + FORETOLD } else { most });
        let state = |at: usize| &self.frames[rows[at]].sample.state;
        let coordinates = state(0).position.len();
        if !exact || rows.len() < LEAST {
            let used = vec![rows.len().min(most); coordinates];
            return Motion { position: used.clone(), velocity: used, rows };
        }
        let times = self.times(rows.iter().copied());
        // For each number of rows, the predicted rows (counted back from the last one) with their weights.
        let foretelling: Vec<Vec<(usize, Interpolation)>> = (1..=most.min(rows.len() - 1))
            .map(|used| {
                let of = (0..FORETOLD).filter(|back| back + used < times.len());
                of.map(|back| (back, Interpolation::at(times[back], &times[back + 1..][..used]))).collect()
            })
            .collect();
        let used = |value: &dyn Fn(usize) -> f64| {
            let off = |(back, by): &(usize, Interpolation)| (by.value(|at| value(back + 1 + at)) - value(*back)).abs();
            let off: Vec<f64> = foretelling.iter().map(|of| of.iter().map(off).fold(0.0, f64::max)).collect();
            let least = off.iter().copied().fold(f64::INFINITY, f64::min);
            let used = off.iter().position(|&off| off == least).map_or(1, |place| place + 1);
            // Predictions by more rows are unknown: if the greatest number was best, one more may be.
            if used == foretelling.len() { (used + 1).min(most) } else { used }
        };
        let position = (0..coordinates).map(|entry| used(&|at| state(at).position[entry])).collect();
        let velocity = (0..coordinates).map(|entry| used(&|at| state(at).velocity[entry])).collect();
        rows.truncate(most);
        Motion { position, velocity, rows }
    }

    /// Returns the weights for `time` of the last row of a motion alone, of its last two rows, and so on.
    pub fn onward(&self, motion: &Motion, time: f64) -> Vec<Interpolation> {
        let times = self.times(motion.rows.iter().copied());
        (1..=times.len()).map(|used| Interpolation::at(time, &times[..used])).collect()
    }

    /// Returns q at `time` if the motion continues.
    pub fn onward_position(&self, motion: &Motion, time: f64) -> Vec<f64> {
        let onward = self.onward(motion, time);
        let value = |(entry, &used): (usize, &usize)| {
            onward[used - 1].value(|at| self.frames[motion.rows[at]].sample.state.position[entry])
        };
        motion.position.iter().enumerate().map(value).collect()
    }
}

/// The continuation of a motion after a row.
#[derive(Debug)]
pub(super) struct Motion {
    /// That row and the rows before it, the last one first.
    pub rows: Vec<usize>,
    /// The number of these rows that each coordinate uses, and the number that its rate uses.
    pub position: Vec<usize>,
    pub velocity: Vec<usize>,
}
