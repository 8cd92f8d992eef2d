//! Finds the touchdowns of a recording, sample by sample, in memory for the last moments alone.

use super::carry::{Interpolation, Onward, on_line};
use super::clip::{Clock, ClockStep};
use super::points::Points;
use super::{At, Heights, Landing, Sample, Sampled, Thresholds, Touching};
use crate::contact::Feet;
use crate::pipeline::CONTACT_TOLERANCE;
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::NamedContact;
use crate::{Error, Reason, Result};
use std::collections::VecDeque;

/// The touchdowns in `samples`, states of `robot` with the `feet` that were added to it: each the sample at the moment
/// of contact, with its landing. Refused samples stay in their place.
///
/// # Errors
/// [`Reason::Missing`] for a robot that has nothing to touch the ground with.
pub fn find<'r, S: Clone, I: Iterator<Item = Sampled<S>>>(
    samples: I,
    robot: &'r Robot,
    feet: &[NamedContact],
    at: At,
    touching: Touching,
) -> Result<Touchdowns<'r, S, I>> {
    let points = Points::new(robot, feet);
    if points.is_empty() {
        let reason =
            Reason::Missing("a foot of the robot, which has no collision shape that could touch the ground,".into());
        return Err(Error::new(reason).hint("name the feet, as in `feet: left_shin:0,0,0.4`"));
    }
    Ok(Touchdowns {
        samples,
        points,
        thresholds: Thresholds::of(robot, feet),
        at,
        touching,
        heights: Heights::default(),
        level: CONTACT_TOLERANCE * Feet::new(robot, feet).size(),
        clock: Clock::default(),
        counted: 0,
        last: None,
        window: VecDeque::new(),
        descents: Vec::new(),
        ready: VecDeque::new(),
    })
}

/// The touchdowns of a recording; see [`find`].
#[derive(Debug)]
pub struct Touchdowns<'r, S, I> {
    samples: I,
    points: Points<'r>,
    thresholds: Thresholds,
    at: At,
    touching: Touching,
    heights: Heights,
    /// A point that stops no higher is on the ground, where heights are true \[m\].
    level: f64,
    clock: Clock,
    /// The row before the last touchdown.
    last: Option<usize>,
    /// Samples so far, refused ones too.
    counted: usize,
    /// The last samples of the clip: as far back as a descent that ends now can have been above its end, and some more.
    window: VecDeque<Frame<S>>,
    /// One per point.
    descents: Vec<Descent>,
    ready: VecDeque<Sampled<S>>,
}

/// A sample and where its points are.
#[derive(Debug)]
struct Frame<S> {
    sample: Sample<S>,
    row: usize,
    places: Vec<Vector<f64>>,
    /// How far each point's height is from that to which the rows before lead, as noise: its standard deviation if it
    /// is random \[m\]. Empty where rows are missing.
    noise: Vec<f64>,
    /// The next sample has the same time.
    before_impact: bool,
}

/// How a point moves.
#[derive(Debug, Clone, Copy)]
struct Descent {
    /// Its greatest height since it last was not falling \[m\].
    from: f64,
    falling: bool,
}

/// When a point's descent becomes a touchdown.
#[derive(Debug, Clone, Copy)]
struct Strike {
    point: usize,
    /// The row of the window that it is, or the last one before it.
    row: usize,
    /// Of a moment between that row and the next, the point's height \[m\].
    height: Option<f64>,
    /// The last row before the impact.
    smooth: usize,
    /// How the state is found from the rows before.
    onward: Way,
}

/// How a motion is carried on to a touchdown.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Way {
    /// Slowing down, to a height above its end: by the last rows.
    Soft,
    /// To where it ends, by the polynomial through so many rows.
    Through(usize),
    /// To where it ends, by the line of least squares through so many rows.
    Along(usize),
}

/// So many rows before the moment of contact are used for the state at it.
const BEFORE: usize = 3;
/// The same where rows have no noise.
const SMOOTH: usize = 6;
/// The noise of a height is measured on so many rows, and a line is laid through no more.
const MEASURED: usize = 64;
/// So many rows of a clip and more measure noise.
const FEWEST: usize = 12;
/// A point without noise: that is so small a part of its fall from row to row.
const CLEAN: f64 = 1e-4;
/// The median of |x| over the standard deviation of a normal x.
const MEDIAN: f64 = 0.6745;
/// A moment between two rows is halved until it is known to 2^-44 of their distance.
const HALVINGS: usize = 44;

impl<S: Clone, I: Iterator<Item = Sampled<S>>> Iterator for Touchdowns<'_, S, I> {
    type Item = Sampled<S>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(ready) = self.ready.pop_front() {
                return Some(ready);
            }
            match self.samples.next() {
                Some(Ok(sample)) if sample.state.scene.stance.is_some() => {
                    let reason = Reason::Unsupported("a stance hides the height of the feet".into());
                    let error = Error::new(reason).at("stance").hint("give the base's x and z instead");
                    self.ready.push_back(Err((sample.source, error)));
                }
                Some(Ok(sample)) => self.take(sample),
                Some(refused) => self.ready.push_back(refused),
                None => {
                    self.end_clip();
                    return self.ready.pop_front();
                }
            }
            self.counted += 1;
        }
    }
}

impl<S, I> Touchdowns<'_, S, I> {
    /// The touchdowns by other thresholds than those of the robot's size.
    pub fn with(self, thresholds: Thresholds) -> Self {
        Self { thresholds, ..self }
    }

    /// The touchdowns of a recording whose heights are meant so.
    pub fn meaning(self, heights: Heights) -> Self {
        Self { heights, ..self }
    }
}

impl<S: Clone, I> Touchdowns<'_, S, I> {
    fn take(&mut self, sample: Sample<S>) {
        let places = self.points.at(&sample.state.position);
        let step = self.clock.step(sample.time);
        match step {
            ClockStep::NewClip => {
                self.end_clip();
                self.descents = places.iter().map(|place| Descent { from: place.z, falling: false }).collect();
            }
            ClockStep::Impact => {
                self.window.back_mut().into_iter().for_each(|last| last.before_impact = true);
            }
            ClockStep::Later(_) => {}
        }
        // A point that falls at `slow` or faster was `above` its level no longer ago than this; twice that is kept.
        let oldest = sample.time - 2.0 * self.thresholds.above / self.thresholds.slow;
        let kept = if self.heights == Heights::True { SMOOTH + 1 } else { 3 * MEASURED };
        while self.window.get(kept).is_some_and(|frame| frame.sample.time < oldest) {
            self.window.pop_front();
        }
        let noise = if self.heights == Heights::True { Vec::new() } else { self.noise(sample.time, &places) };
        self.window.push_back(Frame { sample, row: self.counted, places, noise, before_impact: false });
        match (self.heights, step) {
            (Heights::True, _) => self.reach_ground(),
            (Heights::Recorded, ClockStep::Later(passed)) => self.follow(passed),
            _ => {}
        }
    }

    /// The noise of all points, at `places` after the window's rows.
    fn noise(&self, time: f64, places: &[Vector<f64>]) -> Vec<f64> {
        let Some(first) = self.window.len().checked_sub(SMOOTH) else { return Vec::new() };
        let rows = || self.window.range(first..);
        if rows().any(|frame| frame.before_impact) {
            return Vec::new();
        }
        let onward = Interpolation::at(time, &rows().map(|frame| frame.sample.time).collect::<Vec<_>>());
        let height = |point: usize| onward.value(|at| self.window[first + at].places[point].z);
        let noise = onward.noise();
        places.iter().enumerate().map(|(point, place)| (height(point) - place.z).abs() / noise).collect()
    }

    /// The standard deviation of a point's noise \[m\]: by its median, so that impacts do not count.
    fn deviation(&self, point: usize) -> f64 {
        let noise = self.window.iter().rev().filter_map(|frame| frame.noise.get(point)).take(MEASURED);
        let mut noise: Vec<f64> = noise.copied().collect();
        if noise.len() < FEWEST {
            return 0.0;
        }
        let middle = noise.len() / 2;
        *noise.select_nth_unstable_by(middle, f64::total_cmp).1 / MEDIAN
    }

    /// How many rows, each `passed` \[s\] after the one before, show the rate of a point: two, or if their noise is
    /// faster than [`Thresholds::slow`], so many that that of the line through them is two thirds of it.
    fn rows_of_rate(&self, point: usize, passed: f64) -> usize {
        let noise = self.deviation(point) / (self.thresholds.slow * passed);
        if 2.0 * noise * noise <= 1.0 {
            return 2;
        }
        // The slope of n rows has the variance 12 / (n^3 - n) of one row's.
        let shows = |&rows: &usize| 27.0 * noise * noise <= (rows * rows * rows - rows) as f64;
        (3..MEASURED).find(shows).unwrap_or(MEASURED)
    }

    /// Follows every point to the last row of the window, where heights are true.
    fn reach_ground(&mut self) {
        let Some(row) = self.window.len().checked_sub(2) else { return };
        let mut strikes = Vec::new();
        for point in 0..self.descents.len() {
            let Descent { from, falling } = self.descents[point];
            let [last, height] = [row, row + 1].map(|row| self.height(point, row));
            let strike = Strike { point, row, height: Some(0.0), smooth: row, onward: Way::Through(SMOOTH) };
            if from - last.min(height) >= self.thresholds.drop && last > 0.0 {
                if height <= 0.0 {
                    strikes.push(strike);
                } else if falling && height >= last {
                    // It stops a rounding above the ground, or has bounced since the row before or the one before that.
                    let bounced = [row.checked_sub(1), Some(row)].into_iter().flatten();
                    let bounced = bounced.filter(|&row| self.onward_height(point, row) <= 0.0).min();
                    let stops = (last <= self.level).then_some(Strike { height: None, ..strike });
                    strikes.extend(stops.or(bounced.map(|row| Strike { row, smooth: row, ..strike })));
                }
            }
            let falling = height < last;
            let from = if falling && height > 0.0 { from } else { height };
            self.descents[point] = Descent { from, falling };
        }
        self.strike(strikes);
    }

    /// The rows from which the motion goes on after `row`, the last one first and `most` in all: none from before an
    /// impact.
    fn smooth_rows(&self, row: usize, most: usize) -> Vec<usize> {
        let is_after_impact = |row: usize| self.last.is_some_and(|last| self.window[row].row <= last);
        let before = (0..row).rev().take_while(|&row| !(self.window[row].before_impact || is_after_impact(row)));
        std::iter::once(row).chain(before).take(most).collect()
    }

    /// q at `time` if the motion of these rows goes on.
    fn onward_position(&self, rows: &[usize], time: f64) -> Vec<f64> {
        let times: Vec<f64> = rows.iter().map(|&row| self.window[row].sample.time).collect();
        let interpolation = Interpolation::at(time, &times);
        let position = |at: usize| &self.window[rows[at]].sample.state.position;
        (0..position(0).len()).map(|entry| interpolation.value(|at| position(at)[entry])).collect()
    }

    /// How high a point would be at the row after `row` \[m\].
    fn onward_height(&mut self, point: usize, row: usize) -> f64 {
        let position = self.onward_position(&self.smooth_rows(row, SMOOTH), self.window[row + 1].sample.time);
        self.points.at(&position)[point].z
    }

    /// Follows every point to the last row of the window, `passed` \[s\] after the one before.
    fn follow(&mut self, passed: f64) {
        let Thresholds { drop, slow, ground, .. } = self.thresholds;
        let now = self.window.len() - 1;
        let mut ended = Vec::new();
        for point in 0..self.descents.len() {
            let rows = self.rows_of_rate(point, passed).min(now + 1);
            let (rate, height, end) = if rows == 2 {
                let [last, height] = [now - 1, now].map(|row| self.height(point, row));
                ((height - last) / passed, height, last)
            } else {
                let line = Interpolation::along(0.0, &self.times(now, rows));
                (
                    line.rate(|at| self.height(point, now - at)),
                    self.mean(point, rows),
                    self.mean(point, rows.div_ceil(2)),
                )
            };
            let descent = &mut self.descents[point];
            if rate < -slow {
                descent.falling = true;
                continue;
            }
            if descent.falling {
                if descent.from - end >= drop && end <= ground {
                    ended.push((point, rows, end));
                }
                *descent = Descent { from: height, falling: false };
            }
            descent.from = descent.from.max(height);
        }
        self.strike(ended.into_iter().filter_map(|(point, rows, end)| self.stopped(point, rows, end)).collect());
    }

    /// The times of so many rows up to `row`, the last one first.
    fn times(&self, row: usize, rows: usize) -> Vec<f64> {
        (0..rows).map(|at| self.window[row - at].sample.time).collect()
    }

    /// The mean height of a point in the last `rows` rows.
    fn mean(&self, point: usize, rows: usize) -> f64 {
        let sum: f64 = self.window.iter().rev().take(rows).map(|frame| frame.places[point].z).sum();
        sum / rows as f64
    }

    /// The strike of a point whose descent ended at the height `end`, known by its last `rows` rows.
    fn stopped(&self, point: usize, rows: usize, end: f64) -> Option<Strike> {
        let now = self.window.len() - 1;
        // The point came to rest after the row before the last, or after the last.
        let soft = || self.moment(point, end + self.thresholds.above, now - 1, now.saturating_sub(2));
        if rows > 2 {
            return self.fallen_along(point, rows, end).or_else(soft);
        }
        let soft = soft()?;
        match (self.at, soft.height) {
            (At::Crossing, Some(_)) => Some(self.hit(point).unwrap_or(soft)),
            _ => Some(soft),
        }
    }

    /// The strike of a point that was stopped at once, between two of the last three rows.
    fn hit(&self, point: usize) -> Option<Strike> {
        let Thresholds { slow, .. } = self.thresholds;
        let now = self.window.len() - 1;
        let end = self.height(point, now).min(self.height(point, now - 1));
        (now.saturating_sub(2)..now).find_map(|row| {
            let fallen = self.height(point, row.checked_sub(1)?) - self.height(point, row);
            let through = if self.deviation(point) <= CLEAN * fallen { SMOOTH } else { BEFORE };
            let rows = self.smooth_rows(row, through);
            let times: Vec<f64> = rows.iter().map(|&row| self.window[row].sample.time).collect();
            let onward = Interpolation::at(self.window[row + 1].sample.time, &times);
            let height = |at: usize| self.height(point, rows[at]);
            // Twice as fast as a point that does not fall any more.
            let hits = rows.len() > 1 && onward.value(height) <= end && onward.rate(height) < -2.0 * slow;
            hits.then_some(Strike { point, row, height: Some(end), smooth: row, onward: Way::Through(through) })
        })
    }

    /// The strike of a point with noise: where the line through its last `rows` falling rows meets its level.
    fn fallen_along(&self, point: usize, rows: usize, level: f64) -> Option<Strike> {
        let now = self.window.len() - 1;
        let over = level + 2.0 * self.deviation(point);
        let is_over = |row: usize| self.height(point, row) > over;
        let mut row = (1..=now).rev().find(|&row| is_over(row) && is_over(row - 1))?;
        // Noise decides which row is over it; the line does so less.
        for _ in 0..2 {
            let time = self.along(point, row, rows, level)?.0;
            row = (0..=now).rev().find(|&row| self.window[row].sample.time < time)?;
        }
        let strike = Strike { point, row, height: Some(level), smooth: row, onward: Way::Along(rows) };
        let marked = (row..=now).find(|&row| self.window[row].before_impact);
        Some(marked.map_or(strike, |row| Strike { row, height: None, onward: Way::Soft, ..strike }))
    }

    /// When the line through the last `rows` rows of a point up to `row` is down at `level`, and these rows, the last
    /// one first.
    fn along(&self, point: usize, row: usize, rows: usize, level: f64) -> Option<(f64, Vec<usize>)> {
        let before = self.smooth_rows(row, rows);
        let times: Vec<f64> = before.iter().map(|&row| self.window[row].sample.time).collect();
        let line = Interpolation::along(times[0], &times);
        let height = |at: usize| self.height(point, before[at]);
        let later = (level - line.value(height)) / line.rate(height);
        (before.len() > 2 && line.rate(height) < 0.0 && later.is_finite()).then(|| (times[0] + later, before))
    }

    /// Ends the clip: a point that is still falling has reached the ground if it is at z = 0.
    fn end_clip(&mut self) {
        if self.heights == Heights::True {
            self.descents.clear();
        }
        let Thresholds { drop, above, .. } = self.thresholds;
        let end = self.window.len().saturating_sub(1);
        // Of two rows with the same time the first.
        let before_impact = end.checked_sub(1).filter(|&before| self.window[before].before_impact);
        let strike = |(point, &Descent { from, falling }): (usize, &Descent)| {
            let last = self.height(point, end);
            if !falling || from - last < drop || last > above {
                None
            } else if last >= -above {
                Some(Strike { point, row: before_impact.unwrap_or(end), height: None, smooth: end, onward: Way::Soft })
            } else {
                // It goes on through the ground, which this recording does not know of.
                self.moment(point, 0.0, end, end)
            }
        };
        self.strike(self.descents.iter().enumerate().filter_map(strike).collect());
        self.window.clear();
        self.descents.clear();
        self.last = None;
    }

    fn height(&self, point: usize, row: usize) -> f64 {
        self.window[row].places[point].z
    }

    /// When the point was last as high as `height`, at row `end` or before; an impact that the recording itself marks
    /// after that is the moment.
    fn moment(&self, point: usize, height: f64, end: usize, smooth: usize) -> Option<Strike> {
        let row = (0..=end).rev().find(|&row| self.height(point, row) >= height)?;
        let after = Strike { point, row, height: Some(height), smooth: smooth.max(row), onward: Way::Soft };
        let marked = |&row: &usize| self.window[row].before_impact && self.height(point, row) < height;
        let marked = (row..=end).find(marked).map(|row| Strike { row, height: None, ..after });
        Some(marked.unwrap_or(after))
    }

    /// Makes touchdowns of the points that strike and are free to; those that strike together are one.
    fn strike(&mut self, mut strikes: Vec<Strike>) {
        let (together, at, touching) = (self.thresholds.together, self.at, self.touching);
        strikes.retain(|strike| self.points.is_free(strike.point, &self.window[strike.row].places, together));
        let last = strikes.iter().map(|strike| self.window[strike.row].row).max();
        while !strikes.is_empty() {
            let first = strikes.remove(0);
            let (also, later): (Vec<_>, Vec<_>) = strikes.into_iter().partition(|other| self.together(&first, other));
            strikes = later;
            let also: Vec<usize> = also.iter().map(|strike| strike.point).collect();
            let mut sample = self.sample(&first);
            let (shift_z, striking) = self.points.touch(&mut sample.state, first.point, &also, touching, together);
            sample.landing = Some(Landing { row: self.window[first.row].row, striking, shift_z, at, touching });
            let finite = sample.state.position.iter().chain(&sample.state.velocity).all(|entry| entry.is_finite());
            self.ready.push_back(if finite {
                Ok(sample)
            } else {
                let reason = "the robot is too far away or too fast to be placed on the ground".to_owned();
                Err((sample.source, Error::new(Reason::Inconsistent(reason))))
            });
        }
        self.last = last.or(self.last);
    }

    /// Whether two points strike at the same moment.
    fn together(&self, one: &Strike, other: &Strike) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= self.thresholds.together;
        one.row == other.row
            && close(self.height(one.point, one.row), self.height(other.point, one.row))
            && match (one.height, other.height) {
                (Some(one), Some(other)) => close(one, other),
                (one, other) => one == other,
            }
    }

    /// The sample at the moment of a strike; its row and source are those of the row before.
    fn sample(&mut self, &Strike { point, row, height, smooth, onward }: &Strike) -> Sample<S> {
        match (onward, height) {
            (Way::Through(rows), height) => return self.through(point, row, rows, height),
            (Way::Along(rows), Some(level)) => {
                if let Some((time, rows)) = self.along(point, row, rows, level) {
                    return self.on_line_of(&rows, time);
                }
            }
            _ => {}
        }
        let mut sample = self.window[row].sample.clone();
        let first = (0..row).rfind(|&row| self.window[row].before_impact).map_or(0, |impact| impact + 1);
        let (At::Crossing, Some(height), Some(next)) = (self.at, height, self.window.get(row + 1)) else {
            if sample.rate_over[1] > self.window[smooth.max(row)].sample.time {
                self.velocity(first, smooth.max(row), sample.time, &mut sample.state.velocity);
            }
            return sample;
        };
        let onward = if smooth > row { None } else { self.onward(point, first, row, height) };
        if let Some((onward, later)) = onward {
            sample.time += later;
            for (entry, own) in sample.state.position.iter_mut().enumerate() {
                *own = onward.value(|back| self.window[row - back].sample.state.position[entry], later);
            }
        } else {
            let (above, below) = (self.height(point, row), next.places[point].z);
            let part = if below < above { ((above - height) / (above - below)).clamp(0.0, 1.0) } else { 0.0 };
            sample.time += part * (next.sample.time - sample.time);
            for (own, next) in sample.state.position.iter_mut().zip(&next.sample.state.position) {
                *own += part * (next - *own);
            }
        }
        self.velocity(first, smooth, sample.time, &mut sample.state.velocity);
        sample
    }

    /// The sample of `row`, the last one above the ground, at the moment at which `point` is down at `level`, if that is
    /// before the next row, by the polynomial through `most` rows.
    fn through(&mut self, point: usize, row: usize, most: usize, level: Option<f64>) -> Sample<S> {
        let mut sample = self.window[row].sample.clone();
        let rows = self.smooth_rows(row, most);
        if let (Some(level), At::Crossing) = (level, self.at) {
            let [start, end] = [row, row + 1].map(|row| self.window[row].sample.time);
            let down = self.onward_position(&rows, end);
            if self.points.at(&down)[point].z <= level + self.level {
                let (mut above, mut below) = (start, end);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (above + below);
                    let position = self.onward_position(&rows, middle);
                    *(if self.points.at(&position)[point].z > level { &mut above } else { &mut below }) = middle;
                }
                (sample.time, sample.state.position) = (below, self.onward_position(&rows, below));
            } else {
                let [from, to] = [row, row + 1].map(|row| self.height(point, row) - level);
                let part = (from / (from - to)).clamp(0.0, 1.0);
                sample.time += part * (end - start);
                let next = &self.window[row + 1].sample.state.position;
                for (own, next) in sample.state.position.iter_mut().zip(next) {
                    *own += part * (next - *own);
                }
            }
        }
        if rows.len() > 1 {
            let times: Vec<f64> = rows.iter().map(|&row| self.window[row].sample.time).collect();
            // Recorded rates may have noise that heights do not show.
            let used = if self.heights == Heights::Recorded && !is_difference(&sample) { 2 } else { rows.len() };
            self.carry_velocity(&rows, &Interpolation::at(sample.time, &times[..used]), &mut sample);
        }
        sample
    }

    /// The sample at `time` on the line through `rows`, the last one first.
    fn on_line_of(&self, rows: &[usize], time: f64) -> Sample<S> {
        let mut sample = self.window[rows[0]].sample.clone();
        let times: Vec<f64> = rows.iter().map(|&row| self.window[row].sample.time).collect();
        if self.at == At::Crossing {
            sample.time = time;
            let line = Interpolation::along(time, &times);
            for (entry, own) in sample.state.position.iter_mut().enumerate() {
                *own = line.value(|at| self.window[rows[at]].sample.state.position[entry]);
            }
        }
        self.carry_velocity(rows, &Interpolation::along(sample.time, &times), &mut sample);
        sample
    }

    /// Gives a sample the velocity of `rows`: as recorded, or the rate of their positions.
    fn carry_velocity(&self, rows: &[usize], onward: &Interpolation, sample: &mut Sample<S>) {
        let state = |at: usize| &self.window[rows[at]].sample.state;
        let differences = is_difference(sample);
        for (entry, own) in sample.state.velocity.iter_mut().enumerate() {
            *own = match differences {
                true => onward.rate(|at| state(at).position[entry]),
                false => onward.value(|at| state(at).velocity[entry]),
            };
        }
    }

    /// How the motion of rows `first` to `at` goes on, and how much later the point is at `height`, if that is before
    /// the next row.
    fn onward(&self, point: usize, first: usize, at: usize, height: f64) -> Option<(Onward, f64)> {
        let rows = (first..=at).rev().take(BEFORE);
        let times: Vec<f64> = rows.map(|row| self.window[row].sample.time).collect();
        let next = self.window[at + 1].sample.time - self.window[at].sample.time;
        let onward = Onward::from(&times, next)?;
        let later = onward.down_to(height, |back| self.height(point, at - back))?;
        (later <= next).then_some((onward, later))
    }

    /// Replaces `velocity` by that at `time`, from the rows `first` to `smooth`.
    fn velocity(&self, first: usize, smooth: usize, time: f64, velocity: &mut [f64]) {
        let ends = self.window[smooth].sample.time;
        let middle = |sample: &Sample<S>| 0.5 * (sample.rate_over[0] + sample.rate_over[1]);
        let mut around: [Option<&Sample<S>>; 2] = [None; 2];
        for Frame { sample, .. } in self.window.range(first..=smooth) {
            if sample.rate_over[1] <= ends && around[1].is_none_or(|last| middle(last) < time) {
                around = [around[1], Some(sample)];
            }
        }
        let [before, Some(last)] = around else { return };
        let before = before.unwrap_or(last);
        for (entry, own) in velocity.iter_mut().enumerate() {
            let value = |sample: &Sample<S>| (middle(sample), sample.state.velocity[entry]);
            *own = on_line([value(before), value(last)], time);
        }
    }
}

/// Whether the velocity of a sample was taken from rows.
fn is_difference<S>(sample: &Sample<S>) -> bool {
    sample.rate_over[0] < sample.rate_over[1]
}
