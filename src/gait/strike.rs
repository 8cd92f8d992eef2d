//! Decides when a descent that has ended was a strike.

use super::carry::Interpolation;
use super::window::{BEFORE, SMOOTH, Window};
use super::{At, Thresholds};

/// A point has no noise if it is at most this fraction of the point's fall from row to row.
const CLEAN: f64 = 1e-4;

/// The moment at which a point's descent becomes a touchdown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strike {
    pub point: usize,
    /// The row in the window at this moment, or the last one before it.
    pub row: usize,
    /// The height of the point at a moment between that row and the next \[m\].
    pub height: Option<f64>,
    /// The last row before the impact.
    pub smooth: usize,
    /// How the state is extrapolated from the rows before.
    pub onward: Way,
}

/// The extrapolation of a motion to a touchdown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// By the last rows, to a height above the end of the descent: the point slows down.
    Soft,
    /// By the polynomial through this many rows, to the end of the descent.
    Through(usize),
    /// By the least-squares line through this many rows, to the end of the descent.
    Along(usize),
}

impl Strike {
    /// The strike of a point after `row` in a recording with true heights.
    pub fn after(point: usize, row: usize, height: Option<f64>) -> Self {
        Self { point, row, height, smooth: row, onward: Way::Through(SMOOTH) }
    }
}

impl<S> Window<S> {
    /// Returns the strike of a point whose descent ended at the height `end`, as its last `rows` rows show.
    pub fn stopped(&self, point: usize, rows: usize, end: f64, at: At, thresholds: Thresholds) -> Option<Strike> {
        let now = self.frames.len() - 1;
        // The point came to rest after the row before the last one, or after the last one.
        let soft = || self.moment(point, end + thresholds.above, now - 1, now.saturating_sub(2));
        if rows > 2 {
            return self.fallen_along(point, rows, end).or_else(soft);
        }
        let soft = soft()?;
        match (at, soft.height) {
            (At::Crossing, Some(_)) => Some(self.hit(point, thresholds.slow).unwrap_or(soft)),
            _ => Some(soft),
        }
    }

    /// Returns the strike of a point that was stopped at once, from more than twice `slow` \[m/s\].
    fn hit(&self, point: usize, slow: f64) -> Option<Strike> {
        let now = self.frames.len() - 1;
        let end = self.height(point, now).min(self.height(point, now - 1));
        (now.saturating_sub(2)..now).find_map(|row| {
            let fallen = self.height(point, row.checked_sub(1)?) - self.height(point, row);
            let through = if self.deviation(point) <= CLEAN * fallen { SMOOTH } else { BEFORE };
            let rows = self.smooth_rows(row, through);
            let times = self.times(rows.iter().copied());
            let onward = Interpolation::at(self.frames[row + 1].sample.time, &times);
            let height = |at: usize| self.height(point, rows[at]);
            // Twice the speed below which a descent has ended.
            let hits = rows.len() > 1 && onward.value(height) <= end && onward.rate(height) < -2.0 * slow;
            hits.then_some(Strike { point, row, height: Some(end), smooth: row, onward: Way::Through(through) })
        })
    }

    /// Returns the strike of a point with noise: where the line through its last `rows` falling rows reaches its level.
    fn fallen_along(&self, point: usize, rows: usize, level: f64) -> Option<Strike> {
        let now = self.frames.len() - 1;
        let over = level + 2.0 * self.deviation(point);
        let is_over = |row: usize| self.height(point, row) > over;
        let mut row = (1..=now).rev().find(|&row| is_over(row) && is_over(row - 1))?;
        // Noise affects which row is the last one above the level. It affects the line less.
        for _ in 0..2 {
            let time = self.along(point, row, rows, level)?.0;
            row = (0..=now).rev().find(|&row| self.frames[row].sample.time < time)?;
        }
        let strike = Strike { point, row, height: Some(level), smooth: row, onward: Way::Along(rows) };
        let marked = (row..=now).find(|&row| self.frames[row].before_impact);
        Some(marked.map_or(strike, |row| Strike { row, height: None, onward: Way::Soft, ..strike }))
    }

    /// Returns the moment at which the point was last as high as `height`, at row `end` or before. If the recording
    /// itself marks an impact after that, this is the moment.
    pub fn moment(&self, point: usize, height: f64, end: usize, smooth: usize) -> Option<Strike> {
        let row = (0..=end).rev().find(|&row| self.height(point, row) >= height)?;
        let after = Strike { point, row, height: Some(height), smooth: smooth.max(row), onward: Way::Soft };
        let marked = |&row: &usize| self.frames[row].before_impact && self.height(point, row) < height;
        let marked = (row..=end).find(marked).map(|row| Strike { row, height: None, ..after });
        Some(marked.unwrap_or(after))
    }

    /// Returns whether two points strike at the same moment, with a difference in height of at most `within` \[m\].
    pub fn together(&self, one: &Strike, other: &Strike, within: f64) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= within;
        one.row == other.row
            && close(self.height(one.point, one.row), self.height(other.point, one.row))
            && match (one.height, other.height) {
                (Some(one), Some(other)) => close(one, other),
                (one, other) => one == other,
            }
    }
}
