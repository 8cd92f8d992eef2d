//! The noise of heights, and lines through enough rows to show the motion despite it.

use super::carry::Interpolation;
use super::window::{SMOOTH, Window};
use crate::planar::Vector;

/// The number of rows on which the noise of a height is measured, and the most rows of a line.
pub(super) const MEASURED: usize = 64;
/// The fewest rows that measure noise.
const FEWEST: usize = 12;
/// The ratio of the median of |x| to the standard deviation for a normally distributed x.
const MEDIAN: f64 = 0.6745;

impl<S> Window<S> {
    /// Returns the noise of all points, which are at `places` in the row after the window's rows.
    pub fn noise(&self, time: f64, places: &[Vector<f64>]) -> Vec<f64> {
        let Some(first) = self.frames.len().checked_sub(SMOOTH) else { return Vec::new() };
        let rows = || self.frames.range(first..);
        if rows().any(|frame| frame.before_impact) {
            return Vec::new();
        }
        let onward = Interpolation::at(time, &rows().map(|frame| frame.sample.time).collect::<Vec<_>>());
        let height = |point: usize| onward.value(|at| self.frames[first + at].places[point].z);
        let noise = onward.noise();
        places.iter().enumerate().map(|(point, place)| (height(point) - place.z).abs() / noise).collect()
    }

    /// Returns the standard deviation of a point's noise \[m\], from the median, so that impacts do not affect it.
    pub fn deviation(&self, point: usize) -> f64 {
        self.measured(point).unwrap_or(0.0)
    }

    /// The same as [`Window::deviation`]; `None` if too few rows measure it.
    pub fn measured(&self, point: usize) -> Option<f64> {
        let noise = self.frames.iter().rev().filter_map(|frame| frame.noise.get(point)).take(MEASURED);
        let mut noise: Vec<f64> = noise.copied().collect();
        if noise.len() < FEWEST {
            return None;
        }
        let middle = noise.len() / 2;
        Some(*noise.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN)
    }

    /// Returns how many rows, each `passed` \[s\] after the one before, show the rate of a point: two or, if their
    /// noise is faster than `slow` \[m/s\], enough for a line whose slope has a noise of two thirds of `slow`.
    pub fn rows_of_rate(&self, point: usize, passed: f64, slow: f64) -> usize {
        let noise = self.deviation(point) / (slow * passed);
        if 2.0 * noise * noise <= 1.0 {
            return 2;
        }
        // The variance of the slope of n rows is 12 / (n^3 - n) times that of one row.
        let shows = |&rows: &usize| 27.0 * noise * noise <= (rows * rows * rows - rows) as f64;
        (3..MEASURED).find(shows).unwrap_or(MEASURED)
    }

    /// Returns the mean height of a point in the last `rows` rows.
    pub fn mean(&self, point: usize, rows: usize) -> f64 {
        let sum: f64 = self.frames.iter().rev().take(rows).map(|frame| frame.places[point].z).sum();
        sum / rows as f64
    }

    /// Returns when the line through a point's `rows` rows up to `row` reaches `level`, and these rows, last first.
    pub fn along(&self, point: usize, row: usize, rows: usize, level: f64) -> Option<(f64, Vec<usize>)> {
        let before = self.smooth_rows(row, rows);
        let times = self.times(before.iter().copied());
        let line = Interpolation::along(times[0], &times);
        let height = |at: usize| self.height(point, before[at]);
        let later = (level - line.value(height)) / line.rate(height);
        (before.len() > 2 && line.rate(height) < 0.0 && later.is_finite()).then(|| (times[0] + later, before))
    }
}
