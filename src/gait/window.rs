//! The last rows of a clip, and the continuation of its motion after one of them.

use super::Sample;
use super::carry::{Interpolation, REACH};
use crate::planar::Vector;
use std::collections::VecDeque;

/// The number of rows before the moment of contact that determine the state at it.
pub(super) const BEFORE: usize = 3;
/// The same number for rows without noise.
pub(super) const SMOOTH: usize = 6;

/// The number of rows that show how well the rows before them predict a motion.
pub(super) const PREDICTED: usize = 2;
/// With fewer rows than this, predictions are not compared.
const LEAST: usize = 6;

/// The last rows of a clip.
#[derive(Debug)]
pub(super) struct Window<S> {
    pub frames: VecDeque<Frame<S>>,
}

/// A sample, and the places of its points.
#[derive(Debug)]
pub(super) struct Frame<S> {
    pub sample: Sample<S>,
    pub row: usize,
    pub places: Vec<Vector<f64>>,
    /// The distance of each point's height from the extrapolation of the rows before, scaled to the standard deviation
    /// of the noise \[m\]. Empty if rows are missing.
    pub noise: Vec<f64>,
    /// Whether the next sample has the same time.
    pub before_impact: bool,
    /// The number of touchdowns between this sample and the next.
    pub strikes: usize,
    /// The time and q of the only one of them, if they are known.
    pub struck: Option<(f64, Vec<f64>)>,
}

impl<S> Frame<S> {
    /// Returns whether the motion after the sample does not continue that before it.
    fn ends_motion(&self) -> bool {
        self.before_impact || self.strikes > 0
    }
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

    /// Returns at most `most` rows up to `row` that no impact separates, the last one first.
    pub fn smooth_rows(&self, row: usize, most: usize) -> Vec<usize> {
        let before = (0..row).rev().take_while(|&row| !self.frames[row].ends_motion());
        std::iter::once(row).chain(before).take(most).collect()
    }

    /// Returns the continuation of the motion after `row`, by at most `most` rows. For rows without noise (`exact`),
    /// each coordinate uses as many rows as have predicted it best. If there are fewer than [`BEFORE`], it begins with
    /// the touchdown before them.
    pub fn motion(&self, row: usize, most: usize, exact: bool) -> Motion {
        let mut rows = self.smooth_rows(row, if exact { most + PREDICTED } else { most });
        let state = |at: usize| &self.frames[rows[at]].sample.state;
        let coordinates = state(0).position.len();
        if !exact || rows.len() < LEAST {
            let from = if exact && rows.len() < BEFORE { self.struck_before(&rows) } else { None };
            let used = |rows: usize| vec![rows.min(most); coordinates];
            return Motion { position: used(rows.len() + from.iter().len()), velocity: used(rows.len()), from, rows };
        }
        let times = self.times(rows.iter().copied());
        // For each number of rows, the predicted rows (counted back from the last one) with their weights.
        let predictions: Vec<Vec<(usize, Interpolation)>> = (1..=most.min(rows.len() - 1))
            .map(|used| {
                let of = (0..PREDICTED).filter(|back| back + used < times.len());
                of.map(|back| (back, Interpolation::at(times[back], &times[back + 1..][..used]))).collect()
            })
            .collect();
        let used = |value: &dyn Fn(usize) -> f64| {
            let off = |(back, by): &(usize, Interpolation)| (by.value(|at| value(back + 1 + at)) - value(*back)).abs();
            let off: Vec<f64> = predictions.iter().map(|of| of.iter().map(off).fold(0.0, f64::max)).collect();
            let least = off.iter().copied().fold(f64::INFINITY, f64::min);
            let used = off.iter().position(|&off| off == least).map_or(1, |place| place + 1);
            // Predictions by more rows are unknown. If the greatest number was best, one more may be better.
            if used == predictions.len() { (used + 1).min(most) } else { used }
        };
        let position = (0..coordinates).map(|entry| used(&|at| state(at).position[entry])).collect();
        let velocity = (0..coordinates).map(|entry| used(&|at| state(at).velocity[entry])).collect();
        rows.truncate(most);
        Motion { position, velocity, rows, from: None }
    }

    /// Returns time and q of the touchdown after which a motion of these `rows` begins, unless it is so near to the
    /// first of them that it does not show the rate.
    fn struck_before(&self, rows: &[usize]) -> Option<(f64, Vec<f64>)> {
        let (last, first) = (*rows.first()?, *rows.last()?);
        let [next, last_time, first_time] = [last + 1, last, first].map(|row| self.frames[row].sample.time);
        let struck = self.frames[first.checked_sub(1)?].struck.as_ref();
        struck.filter(|(time, _)| next - last_time <= REACH * (first_time - time)).cloned()
    }

    /// Returns the row before `row` if it is the only row of its motion, so that no rate of its own is known.
    pub fn before_alone(&self, row: usize) -> Option<usize> {
        let before = row.checked_sub(1)?;
        (self.frames[before].ends_motion() && self.struck_before(&[row]).is_none()).then_some(before)
    }

    /// Returns the weights for `time` of the last row of a motion alone, of its last two rows, and so on.
    pub fn onward(&self, motion: &Motion, time: f64) -> Vec<Interpolation> {
        let mut times = self.times(motion.rows.iter().copied());
        times.extend(motion.from.iter().map(|(time, _)| *time));
        (1..=times.len()).map(|used| Interpolation::at(time, &times[..used])).collect()
    }

    /// Returns q at `time` if the motion continues.
    pub fn onward_position(&self, motion: &Motion, time: f64) -> Vec<f64> {
        let onward = self.onward(motion, time);
        let value = |(entry, &used): (usize, &usize)| onward[used - 1].value(|at| self.position(motion, at)[entry]);
        motion.position.iter().enumerate().map(value).collect()
    }

    /// Returns q of a row of a motion, counted back from its last one, or of the touchdown before them.
    pub fn position<'a>(&'a self, motion: &'a Motion, at: usize) -> &'a [f64] {
        match (motion.rows.get(at), &motion.from) {
            (None, Some((_, position))) => position,
            _ => &self.frames[motion.rows[at]].sample.state.position,
        }
    }
}

/// The continuation of a motion after a row.
#[derive(Debug)]
pub(super) struct Motion {
    /// That row and the rows before it, the last one first.
    pub rows: Vec<usize>,
    /// Time and q of the touchdown with which it begins.
    pub from: Option<(f64, Vec<f64>)>,
    /// The number of these rows that each coordinate uses, and the number that its rate uses.
    pub position: Vec<usize>,
    pub velocity: Vec<usize>,
}
