//! The state at which a point strikes.

use super::carry::{Interpolation, down_to, on_line};
use super::points::Points;
use super::strike::{Strike, Way};
use super::window::{BEFORE, Frame, Window};
use super::{At, Heights, Sample};

/// Number of bisections of the interval between two rows: the moment is known to 2^-44 of it.
const HALVINGS: usize = 44;

/// The data from which the state at a strike is computed.
#[derive(Debug)]
pub(super) struct Arrival<'a, 'r, S> {
    pub window: &'a Window<S>,
    pub points: &'a mut Points<'r>,
    pub at: At,
    pub heights: Heights,
    /// Tolerance of the height at which a point touches \[m\].
    pub level: f64,
}

impl<S: Clone> Arrival<'_, '_, S> {
    /// Returns the sample at the moment of a strike, with the row and source of the row before.
    pub fn sample(&mut self, &Strike { point, row, height, smooth, onward }: &Strike) -> Sample<S> {
        match (onward, height) {
            (Way::Through(rows), height) => return self.through(point, row, rows, height),
            (Way::Along(rows), Some(level)) => {
                if let Some((time, rows)) = self.window.along(point, row, rows, level) {
                    let next = self.window.frames.get(row + 1).map_or(time, |next| next.sample.time);
                    return self.on_line_of(&rows, time.min(next));
                }
            }
            _ => {}
        }
        let mut sample = self.window.frames[row].sample.clone();
        let first = (0..row).rfind(|&row| self.window.frames[row].before_impact).map_or(0, |impact| impact + 1);
        let (At::Crossing, Some(height), true) = (self.at, height, row + 1 < self.window.frames.len()) else {
            if sample.rate_over[1] > self.window.frames[smooth.max(row)].sample.time {
                self.velocity(first, smooth.max(row), sample.time, &mut sample.state.velocity);
            }
            return sample;
        };
        let onward = if smooth > row { None } else { self.onward(point, first, row, height) };
        if let Some((onward, later)) = onward {
            sample.time += later;
            for (entry, value) in sample.state.position.iter_mut().enumerate() {
                *value = onward.value(|back| self.window.frames[row - back].sample.state.position[entry]);
            }
        } else {
            self.between(point, row, height, &mut sample);
        }
        self.velocity(first, smooth, sample.time, &mut sample.state.velocity);
        sample
    }

    /// Returns the sample at the moment at which `point` reaches `level`, by the polynomial through `most` rows. `row`
    /// is the last one above the ground; the moment is before the next row.
    fn through(&mut self, point: usize, row: usize, most: usize, level: Option<f64>) -> Sample<S> {
        let mut sample = self.window.frames[row].sample.clone();
        let motion = self.window.motion(row, most, self.heights == Heights::True);
        if let (Some(level), At::Crossing) = (level, self.at) {
            let [start, end] = [row, row + 1].map(|row| self.window.frames[row].sample.time);
            let down = self.window.onward_position(&motion, end);
            if self.points.at(&down)[point].z <= level + self.level {
                let (mut above, mut below) = (start, end);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (above + below);
                    let position = self.window.onward_position(&motion, middle);
                    *(if self.points.at(&position)[point].z > level { &mut above } else { &mut below }) = middle;
                }
                (sample.time, sample.state.position) = (below, self.window.onward_position(&motion, below));
            } else {
                self.between(point, row, level, &mut sample);
            }
        }
        if motion.rows.len() > 1 || motion.from.is_some() {
            let onward = self.window.onward(&motion, sample.time);
            let used = |entry: usize| match (is_difference(&sample), self.heights) {
                (true, _) => motion.position[entry].max(2),
                // Recorded rates may have noise even if heights have none.
                (false, Heights::Recorded) => 2,
                (false, Heights::True) => motion.velocity[entry],
            };
            let used: Vec<usize> = (0..sample.state.velocity.len()).map(used).collect();
            let position = |at: usize| self.window.position(&motion, at);
            self.carry_velocity(&motion.rows, position, |entry| &onward[used[entry] - 1], &mut sample);
        }
        sample
    }

    /// Moves a sample of `row` in time and positions to where the point crosses `level` on the line to the next row.
    fn between(&self, point: usize, row: usize, level: f64, sample: &mut Sample<S>) {
        let [from, to] = [row, row + 1].map(|row| self.window.height(point, row) - level);
        let part = if to < from { (from / (from - to)).clamp(0.0, 1.0) } else { 0.0 };
        let next = &self.window.frames[row + 1].sample;
        sample.time += part * (next.time - sample.time);
        for (value, next) in sample.state.position.iter_mut().zip(&next.state.position) {
            *value += part * (next - *value);
        }
    }

    /// Returns the sample at `time` on the least-squares line through `rows`, which begin with the last one.
    fn on_line_of(&self, rows: &[usize], time: f64) -> Sample<S> {
        let mut sample = self.window.frames[rows[0]].sample.clone();
        let times = self.window.times(rows.iter().copied());
        if self.at == At::Crossing {
            sample.time = time;
            let line = Interpolation::along(time, &times);
            for (entry, value) in sample.state.position.iter_mut().enumerate() {
                *value = line.value(|at| self.window.frames[rows[at]].sample.state.position[entry]);
            }
        }
        let line = Interpolation::along(sample.time, &times);
        let position = |at: usize| &self.window.frames[rows[at]].sample.state.position[..];
        self.carry_velocity(rows, position, |_| &line, &mut sample);
        sample
    }

    /// Sets a sample's velocity by weights `onward`: from the velocities recorded in `rows`, or as rate of positions.
    fn carry_velocity<'i>(
        &self,
        rows: &[usize],
        position: impl Fn(usize) -> &'i [f64],
        onward: impl Fn(usize) -> &'i Interpolation,
        sample: &mut Sample<S>,
    ) {
        let velocity = |at: usize| &self.window.frames[rows[at]].sample.state.velocity;
        let differences = is_difference(sample);
        for (entry, rate) in sample.state.velocity.iter_mut().enumerate() {
            *rate = match differences {
                true => onward(entry).rate(|at| position(at)[entry]),
                false => onward(entry).value(|at| velocity(at)[entry]),
            };
        }
    }

    /// Returns how much later than row `at` the point is at `height`, on the parabola through the last rows from
    /// `first` on, and the extrapolation to that moment. `None` if that is after the next row.
    fn onward(&self, point: usize, first: usize, at: usize, height: f64) -> Option<(Interpolation, f64)> {
        let times = self.window.times((first..=at).rev().take(BEFORE));
        let next = self.window.frames[at + 1].sample.time - times[0];
        let later = down_to(height, &times, |back| self.window.height(point, at - back), next)?;
        (later <= next).then(|| (Interpolation::at(times[0] + later, &times), later))
    }

    /// Replaces `velocity` by the one at `time`, computed from the rows `first` to `smooth`.
    fn velocity(&self, first: usize, smooth: usize, time: f64, velocity: &mut [f64]) {
        let ends = self.window.frames[smooth].sample.time;
        let middle = |sample: &Sample<S>| 0.5 * (sample.rate_over[0] + sample.rate_over[1]);
        let mut around: [Option<&Sample<S>>; 2] = [None; 2];
        for Frame { sample, .. } in self.window.frames.range(first..=smooth) {
            if sample.rate_over[1] <= ends && around[1].is_none_or(|last| middle(last) < time) {
                around = [around[1], Some(sample)];
            }
        }
        let [before, Some(last)] = around else { return };
        let before = before.unwrap_or(last);
        for (entry, rate) in velocity.iter_mut().enumerate() {
            let value = |sample: &Sample<S>| (middle(sample), sample.state.velocity[entry]);
            *rate = on_line([value(before), value(last)], time);
        }
    }
}

/// Returns whether the velocity of a sample was computed as a difference of rows.
pub(super) fn is_difference<S>(sample: &Sample<S>) -> bool {
    sample.rate_over[0] < sample.rate_over[1]
}
