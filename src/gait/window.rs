//! The last rows of a clip, and how its motion goes on after one of them.

use super::Sample;
use super::carry::Interpolation;
use crate::planar::Vector;
use std::collections::VecDeque;

/// So many rows before the moment of contact are used for the state at it.
pub(super) const BEFORE: usize = 3;
/// The same where rows have no noise.
pub(super) const SMOOTH: usize = 6;

/// So many rows show how well rows before them foretell a motion.
pub(super) const FORETOLD: usize = 2;
/// Fewer rows than this show nothing of that.
const LEAST: usize = 6;

/// The last rows of a clip.
#[derive(Debug)]
pub(super) struct Window<S> {
    pub frames: VecDeque<Frame<S>>,
    /// The row before the last touchdown.
    pub last: Option<usize>,
}

/// A sample and where its points are.
#[derive(Debug)]
pub(super) struct Frame<S> {
    pub sample: Sample<S>,
    pub row: usize,
    pub places: Vec<Vector<f64>>,
    /// How far each point's height is from that to which the rows before lead, as noise: its standard deviation if it
    /// is random \[m\]. Empty where rows are missing.
    pub noise: Vec<f64>,
    /// The next sample has the same time.
    pub before_impact: bool,
}

impl<S> Window<S> {
    /// How high a point is at a row \[m\].
    pub fn height(&self, point: usize, row: usize) -> f64 {
        self.frames[row].places[point].z
    }

    /// The times of `rows` \[s\].
    pub fn times(&self, rows: impl IntoIterator<Item = usize>) -> Vec<f64> {
        rows.into_iter().map(|row| self.frames[row].sample.time).collect()
    }

    /// The rows from which the motion goes on after `row`, the last one first and `most` in all: none from before an
    /// impact.
    pub fn smooth_rows(&self, row: usize, most: usize) -> Vec<usize> {
        let is_after_impact = |row: usize| self.last.is_some_and(|last| self.frames[row].row <= last);
        let before = (0..row).rev().take_while(|&row| !(self.frames[row].before_impact || is_after_impact(row)));
        std::iter::once(row).chain(before).take(most).collect()
    }

    /// How the motion goes on after `row`, by `most` rows at most; of rows without noise (`exact`) by as many as
    /// have foretold each coordinate best.
    pub fn motion(&self, row: usize, most: usize, exact: bool) -> Motion {
        let mut rows = self.smooth_rows(row, if exact { most + FORETOLD } else { most });
        let state = |at: usize| &self.frames[rows[at]].sample.state;
        let coordinates = state(0).position.len();
        if !exact || rows.len() < LEAST {
            let used = vec![rows.len().min(most); coordinates];
            return Motion { position: used.clone(), velocity: used, rows };
        }
        let times = self.times(rows.iter().copied());
        // By how many rows, and each of which row, counted back.
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
            // What more rows would have foretold is not known.
            if used == foretelling.len() { (used + 1).min(most) } else { used }
        };
        let position = (0..coordinates).map(|entry| used(&|at| state(at).position[entry])).collect();
        let velocity = (0..coordinates).map(|entry| used(&|at| state(at).velocity[entry])).collect();
        rows.truncate(most);
        Motion { position, velocity, rows }
    }

    /// How the last row of a motion, its last two and so on give what they carry on at `time`.
    pub fn onward(&self, motion: &Motion, time: f64) -> Vec<Interpolation> {
        let times = self.times(motion.rows.iter().copied());
        (1..=times.len()).map(|used| Interpolation::at(time, &times[..used])).collect()
    }

    /// q at `time` if a motion goes on.
    pub fn onward_position(&self, motion: &Motion, time: f64) -> Vec<f64> {
        let onward = self.onward(motion, time);
        let value = |(entry, &used): (usize, &usize)| {
            onward[used - 1].value(|at| self.frames[motion.rows[at]].sample.state.position[entry])
        };
        motion.position.iter().enumerate().map(value).collect()
    }
}

/// How a motion goes on after a row.
#[derive(Debug)]
pub(super) struct Motion {
    /// That row and those before it, the last one first.
    pub rows: Vec<usize>,
    /// By how many of them each coordinate goes on, and its rate.
    pub position: Vec<usize>,
    pub velocity: Vec<usize>,
}
