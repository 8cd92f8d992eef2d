//! Finds the touchdowns of a recording sample by sample, and keeps only the last samples in memory.

use super::arrival::{Arrival, is_difference};
use super::carry::{Interpolation, REACH};
use super::clip::{Clock, ClockStep};
use super::noise::MEASURED;
use super::points::Points;
use super::seen::Seen;
use super::strike::{Strike, Way};
use super::window::{Frame, PREDICTED, SMOOTH, Window};
use super::{At, Heights, Landing, Sample, Sampled, Thresholds, Touching};
use crate::contact::Feet;
use crate::pipeline::CONTACT_TOLERANCE;
use crate::robot::Robot;
use crate::state::NamedContact;
use crate::{Error, Reason, Result};
use std::collections::VecDeque;
use std::sync::Mutex;

/// Heights count as free of noise if it is at most this fraction of [`Thresholds::above`].
const EXACT: f64 = 1e-3;
/// Noise hides an impact for at most `HIDDEN` rows, and is at most `NOISE` times its standard deviation.
const HIDDEN: usize = 8;
const NOISE: f64 = 5.0;
/// The time over which the earlier speed of a foot is measured \[s\].
const SHORTLY: f64 = 0.01;
/// The greatest deceleration of a foot by its leg, as a multiple of [`Thresholds::slow`] per second: 25 m/s^2.
const BRAKES: f64 = 500.0;
/// A point strikes before another if that is earlier by at least this part of the time from row to row.
const EARLIER: f64 = 0.01;
/// The greatest depth to which feet sink, as a multiple of the default [`Thresholds::ground`].
const DEEP: f64 = 5.0;

/// Finds the touchdowns in `samples`, which are states of `robot` with its additional `feet`. Each touchdown is the
/// sample at the moment of contact, with its landing. Refused samples stay in their place.
///
/// # Errors
/// Returns [`Reason::Missing`] if the robot has nothing that can touch the ground.
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
    let thresholds = Thresholds::of(robot, feet);
    Ok(Touchdowns {
        samples,
        robot,
        points,
        thresholds,
        deep: DEEP * thresholds.ground,
        at,
        touching,
        heights: Heights::default(),
        level: CONTACT_TOLERANCE * Feet::new(robot, feet).size(),
        seen: None,
        clock: Clock::default(),
        counted: 0,
        window: Window { frames: VecDeque::new() },
        descents: Vec::new(),
        ready: VecDeque::new(),
    })
}

/// The touchdowns of a recording; see [`find`].
#[derive(Debug)]
pub struct Touchdowns<'r, S, I> {
    samples: I,
    robot: &'r Robot,
    points: Points<'r>,
    thresholds: Thresholds,
    /// A foot deeper than this does not merely sink into the ground \[m\].
    deep: f64,
    at: At,
    touching: Touching,
    heights: Heights,
    /// With true heights, a point that stops at most this high is on the ground \[m\].
    level: f64,
    /// Collects observations about the recording, for notes.
    seen: Option<&'r Mutex<Seen>>,
    clock: Clock,
    /// The number of samples so far, including refused ones.
    counted: usize,
    /// The last samples of the clip: those in which a descent that ends now can have been above its end, and some more.
    window: Window<S>,
    /// The descent of each point.
    descents: Vec<Descent>,
    ready: VecDeque<Sampled<S>>,
}

/// The state of a point's motion.
#[derive(Debug, Clone, Copy)]
struct Descent {
    /// The point's greatest height since it last was not falling \[m\].
    from: f64,
    falling: bool,
    /// Whether the point has struck and continues into the ground.
    sinks: bool,
}

impl Descent {
    /// A point that does not fall yet, at this height.
    fn from(height: f64) -> Self {
        Self { from: height, falling: false, sinks: false }
    }
}

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

impl<'r, S, I> Touchdowns<'r, S, I> {
    /// Replaces the thresholds, which follow from the robot's size by default.
    pub fn with(self, thresholds: Thresholds) -> Self {
        Self { thresholds, ..self }
    }

    /// Sets the meaning of the recorded heights.
    pub fn meaning(self, heights: Heights) -> Self {
        Self { heights, ..self }
    }

    /// Adds observations about the recording to `seen`.
    pub fn noting(self, seen: &'r Mutex<Seen>) -> Self {
        Self { seen: Some(seen), ..self }
    }
}

impl<S: Clone, I> Touchdowns<'_, S, I> {
    fn take(&mut self, sample: Sample<S>) {
        let places = self.points.at(&sample.state.position);
        let step = self.clock.step(sample.time);
        if let Some(Ok(mut seen)) = self.seen.map(Mutex::lock) {
            let lowest = places.iter().fold(f64::INFINITY, |least, place| least.min(place.z));
            seen.add(&sample, step, lowest, self.robot);
        }
        match step {
            ClockStep::NewClip => {
                self.end_clip();
                self.descents = places.iter().map(|place| Descent::from(place.z)).collect();
            }
            ClockStep::Impact => {
                self.window.frames.back_mut().into_iter().for_each(|last| last.before_impact = true);
            }
            ClockStep::Later(_) => {}
        }
        // A point that falls at `slow` or faster was `above` its level at most this long ago. Twice that time is kept.
        let oldest = sample.time - 2.0 * self.thresholds.above / self.thresholds.slow;
        let kept = if self.heights == Heights::True { SMOOTH + PREDICTED + 1 } else { 3 * MEASURED };
        while self.window.frames.get(kept).is_some_and(|frame| frame.sample.time < oldest) {
            self.window.frames.pop_front();
        }
        let noise = if self.heights == Heights::True { Vec::new() } else { self.window.noise(sample.time, &places) };
        let row = self.counted;
        let frame = Frame { sample, row, places, noise, before_impact: false, strikes: 0, struck: None };
        self.window.frames.push_back(frame);
        match (self.heights, step) {
            (Heights::True, _) => self.reach_ground(),
            (Heights::Recorded, ClockStep::Later(passed)) => self.follow(passed),
            _ => {}
        }
    }

    /// Follows every point to the last row of the window, with true heights.
    fn reach_ground(&mut self) {
        let Some(row) = self.window.frames.len().checked_sub(2) else { return };
        let before = row.checked_sub(1);
        let (mut strikes, mut risen) = (Vec::new(), Vec::new());
        for point in 0..self.descents.len() {
            let Descent { from, falling, mut sinks } = self.descents[point];
            let [last, height] = [row, row + 1].map(|row| self.window.height(point, row));
            let stops = falling && last > self.level && height <= last + self.level;
            if from - last.min(height) >= self.thresholds.drop {
                let found = if last > self.level && height < -self.level {
                    Some((row, Some(0.0)))
                } else if last.abs() <= self.level && falling && self.window.frames[row].before_impact {
                    Some((row, None))
                } else if last.abs() <= self.level && falling {
                    // The point may be stopped already in the first row on the ground. If heights are rounded by as
                    // much as `level`, it may be stopped in the row before, too.
                    let stopped = |row: &usize| self.window.height(point, row + 1) <= 2.0 * self.level;
                    let mut rows = [row.checked_sub(2).filter(stopped), before].into_iter().flatten();
                    let found = rows.find(|&row| self.onward_height(point, row) <= self.level);
                    Some((found.or(before).unwrap_or(row), Some(0.0)))
                } else {
                    None
                };
                sinks |= found.is_some();
                strikes.extend(found.map(|(row, height)| Strike::after(point, row, height)));
                if falling && last > self.level && height > last + self.level {
                    risen.push(point);
                }
            }
            if sinks && height >= last {
                self.see_end(row, last);
            }
            // A point that is as high as in the row before may have bounced, if the next row is higher.
            let fell = || before.is_some_and(|before| self.window.height(point, before) > last + self.level);
            let falling = height < last || stops && fell();
            sinks &= falling;
            let from = if falling && last > self.level && height >= -self.level { from } else { height };
            self.descents[point] = Descent { from, falling, sinks };
        }
        strikes.sort_by_key(|strike: &Strike| strike.row);
        self.strike(strikes);
        // These may have bounced or, after a strike of another point, stopped above the ground.
        let bounced = risen.into_iter().filter_map(|point| {
            let mut rows = [before, Some(row)].into_iter().flatten().map(|row| Strike::after(point, row, Some(0.0)));
            rows.find(|strike| self.bounces(strike))
        });
        let bounced = bounced.collect();
        self.strike(bounced);
    }

    /// Returns whether a point bounces after the row of a strike, before any other point strikes. It rebounds at most
    /// twice as fast, so at most twice as far as it would have gone into the ground.
    fn bounces(&mut self, strike: &Strike) -> bool {
        let &Strike { point, row, .. } = strike;
        let onward = self.onward_height(point, row);
        if onward > 0.0 || self.window.height(point, row + 1) > -2.0 * onward + self.level {
            return false;
        }
        let position = self.arrival(At::Crossing, strike).state.position;
        let places = self.points.at(&position);
        let earlier = EARLIER * (onward - self.window.height(point, row));
        (0..places.len()).all(|other| places[other].z >= earlier || self.window.height(other, row) <= self.level)
    }

    /// Returns the sample at a strike.
    fn arrival(&mut self, at: At, strike: &Strike) -> Sample<S> {
        let Self { window, points, heights, level, .. } = self;
        Arrival { window, points, at, heights: *heights, level: *level }.sample(strike)
    }

    /// Notes the height at which the lowest foot ends a descent that is no touchdown, or that continues in the ground.
    fn see_end(&self, row: usize, end: f64) {
        let Frame { places, row, .. } = &self.window.frames[row];
        let lowest = places.iter().fold(f64::INFINITY, |least, place| least.min(place.z));
        if let Some(Ok(mut seen)) = self.seen.filter(|_| end <= lowest + self.thresholds.ground).map(Mutex::lock) {
            seen.add_end(*row, end);
        }
    }

    /// Returns whether a point fell more than twice as fast shortly before a sample, and is slowed down already.
    fn is_slowed(&mut self, point: usize, sample: &Sample<S>) -> bool {
        let before = |time: f64| self.window.frames.iter().rposition(|frame| frame.sample.time <= time);
        let Some(to) = before(sample.time - SHORTLY) else { return false };
        let Some(from) = before(self.window.frames[to].sample.time - SHORTLY) else { return false };
        let [start, end] = [from, to].map(|row| self.window.frames[row].sample.time);
        let fell = (self.window.height(point, from) - self.window.height(point, to)) / (end - start);
        let falls = -self.points.rate(point, &sample.state);
        let passed = sample.time - 0.5 * (start + end);
        passed <= 3.0 * SHORTLY && fell > f64::max(2.0 * falls, falls + BRAKES * self.thresholds.slow * passed)
    }

    /// Returns the height at the row after `row` to which a point's motion leads \[m\].
    fn onward_height(&mut self, point: usize, row: usize) -> f64 {
        let (motion, next) = (self.window.motion(row, SMOOTH, true), self.window.frames[row + 1].sample.time);
        let position = self.window.onward_position(&motion, next);
        self.points.at(&position)[point].z
    }

    /// Follows every point to the last row of the window, which is `passed` \[s\] after the one before.
    fn follow(&mut self, passed: f64) {
        let Thresholds { drop, slow, ground, .. } = self.thresholds;
        let now = self.window.frames.len() - 1;
        let mut ended = Vec::new();
        for point in 0..self.descents.len() {
            let rows = self.window.rows_of_rate(point, passed, slow).min(now + 1);
            let (rate, height, end) = if rows == 2 {
                let [last, height] = [now - 1, now].map(|row| self.window.height(point, row));
                ((height - last) / passed, height, last)
            } else {
                let line = Interpolation::along(0.0, &self.window.times((0..rows).map(|at| now - at)));
                (
                    line.rate(|at| self.window.height(point, now - at)),
                    self.window.mean(point, rows),
                    self.window.mean(point, rows.div_ceil(2)),
                )
            };
            let descent = &mut self.descents[point];
            if rate < -slow {
                descent.falling = true;
                continue;
            }
            if descent.falling {
                let ends = descent.from - end >= drop;
                *descent = Descent::from(height);
                if ends && end <= ground {
                    ended.push((point, rows, end));
                } else if ends {
                    self.see_end(now, end);
                }
            }
            let descent = &mut self.descents[point];
            descent.from = descent.from.max(height);
        }
        let stopped = |(point, rows, end)| self.window.stopped(point, rows, end, self.at, self.thresholds);
        self.strike(ended.into_iter().filter_map(stopped).collect());
    }

    /// Moves a strike before the impact if recorded velocities show that its point was stopped at once on its level.
    /// Noise of the point's height may hide this for some rows.
    fn before_stop(&mut self, strike: Strike) -> Strike {
        let Strike { point, row, height, smooth, onward } = strike;
        let Some(height) = height.filter(|_| !is_difference(&self.window.frames[row].sample)) else { return strike };
        let Thresholds { above, slow, .. } = self.thresholds;
        let level = if onward == Way::Soft { height - above } else { height };
        let level = level + NOISE * self.window.deviation(point) + EXACT * above;
        let rows = self.window.smooth_rows(smooth, HIDDEN + 2);
        let rates: Vec<f64> =
            rows.iter().map(|&row| self.points.rate(point, &self.window.frames[row].sample.state)).collect();
        let times = self.window.times(rows.iter().copied());
        let is_stopped = |&after: &usize| {
            let [now, last, earlier] = [0, 1, 2].map(|back| rates[after + back]);
            let [step, before] = [0, 1].map(|back| times[after + back] - times[after + back + 1]);
            let falls = last + (last - earlier).min(0.0) * (step / before);
            let reaches = self.window.height(point, rows[after + 1]) + falls * step <= level;
            let stays = now > 0.0 || self.window.height(point, rows[after]) <= level;
            last < -2.0 * slow && now > 0.5 * last && step <= REACH * before && reaches && stays
        };
        let last = (0..rows.len().saturating_sub(2)).find(is_stopped).map_or(smooth, |after| rows[after + 1]);
        Strike { row: row.min(last), smooth: last, ..strike }
    }

    /// Marks the row before a strike as followed by a touchdown. Returns the strike from which its state is computed,
    /// and whether true heights show no velocity between it and another touchdown.
    fn mark(&mut self, strike: Strike) -> (Strike, bool) {
        let Frame { sample, strikes, .. } = &self.window.frames[strike.row];
        let (is_true, differences, shares) = (self.heights == Heights::True, is_difference(sample), *strikes > 0);
        let alone = if is_true && differences { self.window.before_alone(strike.row) } else { None };
        let is_crowded = is_true && (shares || alone.is_some());
        let struck = (is_true && !is_crowded).then(|| self.arrival(At::Crossing, &strike));
        let frame = &mut self.window.frames[strike.row];
        frame.struck = struck.map(|sample| (sample.time, sample.state.position));
        frame.strikes += 1;
        (alone.map_or(strike, |row| Strike { row, ..strike }), is_crowded)
    }

    /// Ends the clip. A point that is still falling has reached the ground if it is at z = 0.
    fn end_clip(&mut self) {
        let (Thresholds { drop, above, .. }, is_true) = (self.thresholds, self.heights == Heights::True);
        let end = self.window.frames.len().saturating_sub(1);
        // The first of two rows with the same time.
        let before = end.checked_sub(1);
        let before_impact = before.filter(|&before| self.window.frames[before].before_impact);
        let strike = |(point, &Descent { from, falling, .. }): (usize, &Descent)| {
            let last = self.window.height(point, end);
            if !falling || from - last < drop || last > if is_true { self.level } else { above } {
                None
            } else if is_true {
                Some(Strike::after(point, before?, Some(0.0)))
            } else if last >= -above {
                Some(Strike { point, row: before_impact.unwrap_or(end), height: None, smooth: end, onward: Way::Soft })
            } else {
                // The point continues through the ground, which this recording does not show.
                self.window.moment(point, 0.0, end, end)
            }
        };
        self.strike(self.descents.iter().enumerate().filter_map(strike).collect());
        self.window.frames.clear();
        self.descents.clear();
    }

    /// Makes touchdowns of the strikes whose points are free toward the ground, in the order of time. Simultaneous
    /// strikes are one touchdown.
    fn strike(&mut self, mut strikes: Vec<Strike>) {
        let (together, at, touching) = (self.thresholds.together, self.at, self.touching);
        let mut touchdowns = Vec::new();
        strikes.retain(|strike| self.points.is_free(strike.point, &self.window.frames[strike.row].places, together));
        while !strikes.is_empty() {
            let first = strikes.remove(0);
            let (also, later): (Vec<_>, Vec<_>) =
                strikes.into_iter().partition(|other| self.window.together(&first, other, together));
            strikes = later;
            let is_recorded = self.heights == Heights::Recorded;
            let first = if is_recorded { self.before_stop(first) } else { first };
            let also: Vec<usize> = also.iter().map(|strike| strike.point).collect();
            let (first, is_crowded) = self.mark(first);
            let mut sample = self.arrival(at, &first);
            let level = (!is_recorded).then_some(self.level);
            let (shift_z, striking) =
                self.points.touch(&mut sample.state, (first.point, &also), touching, (together, level));
            let exact = EXACT * self.thresholds.above;
            let is_clean = || self.window.measured(first.point).is_some_and(|noise| noise <= exact);
            let is_early = is_recorded && first.onward == Way::Soft && first.height.is_some() && is_clean();
            let is_slowed = is_recorded && self.is_slowed(first.point, &sample);
            let row = self.window.frames[first.row].row;
            let is_deep = shift_z > self.deep;
            // The heights of another row are not those of the ground, and deep touchdowns get a note of their own.
            let is_level = is_recorded && at == At::Crossing && !is_deep;
            if let Some(Ok(mut seen)) = self.seen.map(Mutex::lock) {
                seen.add_touchdown(is_level.then_some(shift_z));
            }
            let landing = Landing { row, striking, shift_z, at, touching, is_early, is_slowed, is_deep, is_crowded };
            sample.landing = Some(landing);
            let finite = sample.state.position.iter().chain(&sample.state.velocity).all(|entry| entry.is_finite());
            let time = sample.time;
            let sampled = if finite {
                Ok(sample)
            } else {
                let reason = "the robot is too far away or too fast to be placed on the ground".to_owned();
                Err((sample.source, Error::new(Reason::Inconsistent(reason))))
            };
            touchdowns.push((time, row, sampled));
        }
        // The strikes may be those of several rows.
        touchdowns.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        self.ready.extend(touchdowns.into_iter().map(|(.., sampled)| sampled));
    }
}
