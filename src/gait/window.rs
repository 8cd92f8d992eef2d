//! The last rows of a clip, and how its motion goes on after one of them.

use super::Sample;
use super::carry::Interpolation;
use crate::planar::Vector;
use std::collections::VecDeque;

/// So many rows before the moment of contact are used for the state at it.
pub(super) const BEFORE: usize = 3;
/// The same where rows have no noise.
pub(super) const SMOOTH: usize = 6;

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

    /// q at `time` if the motion of these rows goes on.
    pub fn onward_position(&self, rows: &[usize], time: f64) -> Vec<f64> {
        let times = self.times(rows.iter().copied());
        let interpolation = Interpolation::at(time, &times);
        let position = |at: usize| &self.frames[rows[at]].sample.state.position;
        (0..position(0).len()).map(|entry| interpolation.value(|at| position(at)[entry])).collect()
    }
}
