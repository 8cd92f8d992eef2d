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
}

/// So many rows before the moment of contact are used for the state at it.
const BEFORE: usize = 3;
/// The same where heights are true.
const SIMULATED: usize = 6;
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
        match self.clock.step(sample.time) {
            ClockStep::NewClip => {
                self.end_clip();
                self.descents = places.iter().map(|place| Descent { from: place.z, falling: false }).collect();
            }
            ClockStep::Impact => {
                self.window.back_mut().into_iter().for_each(|last| last.before_impact = true);
            }
            ClockStep::Later(passed) if self.heights == Heights::Recorded => self.follow(&places, passed),
            ClockStep::Later(_) => {}
        }
        // A point that falls at `slow` or faster was `above` its level no longer ago than this; twice that is kept.
        let oldest = sample.time - 2.0 * self.thresholds.above / self.thresholds.slow;
        let kept = if self.heights == Heights::True { SIMULATED + 1 } else { BEFORE };
        while self.window.get(kept).is_some_and(|frame| frame.sample.time < oldest) {
            self.window.pop_front();
        }
        self.window.push_back(Frame { sample, row: self.counted, places, before_impact: false });
        if self.heights == Heights::True {
            self.reach_ground();
        }
    }

    /// Follows every point to the last row of the window, where heights are true.
    fn reach_ground(&mut self) {
        let Some(row) = self.window.len().checked_sub(2) else { return };
        let mut strikes = Vec::new();
        for point in 0..self.descents.len() {
            let Descent { from, falling } = self.descents[point];
            let [last, height] = [row, row + 1].map(|row| self.height(point, row));
            let strike = Strike { point, row, height: Some(0.0), smooth: row };
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

    /// The rows from which the motion goes on after `row`, the last one first: none from before an impact.
    fn smooth_rows(&self, row: usize) -> Vec<usize> {
        let is_after_impact = |row: usize| self.last.is_some_and(|last| self.window[row].row <= last);
        let before = (0..row).rev().take_while(|&row| !(self.window[row].before_impact || is_after_impact(row)));
        std::iter::once(row).chain(before).take(SIMULATED).collect()
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
        let position = self.onward_position(&self.smooth_rows(row), self.window[row + 1].sample.time);
        self.points.at(&position)[point].z
    }

    /// Follows every point to its next place, `passed` \[s\] after the last.
    fn follow(&mut self, places: &[Vector<f64>], passed: f64) {
        let Thresholds { drop, slow, ground, above, .. } = self.thresholds;
        let Some(last) = self.window.back() else { return };
        let mut ended = Vec::new();
        for (point, (place, descent)) in places.iter().zip(&mut self.descents).enumerate() {
            let (height, last) = (place.z, last.places[point].z);
            if (height - last) / passed < -slow {
                descent.falling = true;
                continue;
            }
            if descent.falling {
                if descent.from - last >= drop && last <= ground {
                    ended.push((point, last + above));
                }
                *descent = Descent { from: height, falling: false };
            }
            descent.from = descent.from.max(height);
        }
        // The point came to rest after the row before the last, or after the last.
        let smooth = self.window.len().saturating_sub(2);
        self.strike(ended.into_iter().filter_map(|(point, height)| self.moment(point, height, smooth)).collect());
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
                Some(Strike { point, row: before_impact.unwrap_or(end), height: None, smooth: end })
            } else {
                // It goes on through the ground, which this recording does not know of.
                self.moment(point, 0.0, end)
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

    /// When the point was last as high as `height`; an impact that the recording itself marks after that is the moment.
    fn moment(&self, point: usize, height: f64, smooth: usize) -> Option<Strike> {
        let row = self.window.iter().rposition(|frame| frame.places[point].z >= height)?;
        let after = Strike { point, row, height: Some(height), smooth: smooth.max(row) };
        let marked = |&row: &usize| self.window[row].before_impact && self.height(point, row) < height;
        let marked = (row..self.window.len()).find(marked).map(|row| Strike { row, height: None, ..after });
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
    fn sample(&mut self, &Strike { point, row, height, smooth }: &Strike) -> Sample<S> {
        if self.heights == Heights::True {
            return self.simulated(point, row, height.is_some());
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

    /// The sample of `row`, the last one above the ground, at the moment at which `point` is at height zero, if it
    /// `crosses` that before the next row.
    fn simulated(&mut self, point: usize, row: usize, crosses: bool) -> Sample<S> {
        let mut sample = self.window[row].sample.clone();
        let rows = self.smooth_rows(row);
        if crosses && self.at == At::Crossing {
            let [start, end] = [row, row + 1].map(|row| self.window[row].sample.time);
            if self.onward_height(point, row) <= self.level {
                let (mut above, mut below) = (start, end);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (above + below);
                    let position = self.onward_position(&rows, middle);
                    *(if self.points.at(&position)[point].z > 0.0 { &mut above } else { &mut below }) = middle;
                }
                (sample.time, sample.state.position) = (below, self.onward_position(&rows, below));
            } else {
                let [from, to] = [row, row + 1].map(|row| self.height(point, row));
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
            let interpolation = Interpolation::at(sample.time, &times);
            let state = |at: usize| &self.window[rows[at]].sample.state;
            for (entry, own) in sample.state.velocity.iter_mut().enumerate() {
                *own = match sample.rate_over[0] < sample.rate_over[1] {
                    true => interpolation.rate(|at| state(at).position[entry]),
                    false => interpolation.value(|at| state(at).velocity[entry]),
                };
            }
        }
        sample
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
