//! Finds the touchdowns of a recording, sample by sample, in memory for the last moments alone.

use super::carry::{Onward, on_line};
use super::clip::{Clock, Step};
use super::points::Points;
use super::{At, Sample, Sampled, Thresholds, Touchdown, Touching};
use crate::planar::Vector;
use crate::robot::Robot;
use crate::state::NamedContact;
use crate::state::State;
use crate::{Error, Reason, Result};
use std::collections::VecDeque;

/// The touchdowns in `samples`, states of `robot` with the `feet` that were added to it; refused samples in their
/// place.
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
        clock: Clock::default(),
        counted: 0,
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
    clock: Clock,
    /// Samples so far, refused ones too.
    counted: usize,
    /// The last samples of the clip: as far back as a descent that ends now can have been above its end, and some more.
    window: VecDeque<Frame<S>>,
    /// One per point.
    descents: Vec<Descent>,
    ready: VecDeque<std::result::Result<Touchdown<S>, (S, Error)>>,
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

/// When a descent becomes a touchdown.
#[derive(Debug, Clone, Copy)]
enum Moment {
    /// At a row as it is.
    Row(usize),
    /// After the row `at` of the window and before the next, where the point is at `height` \[m\]; the rows up to
    /// `smooth` are before the impact.
    After { at: usize, height: f64, smooth: usize },
}

impl Moment {
    /// The row of the window that it is, or the last one before it.
    fn row(self) -> usize {
        let (Self::Row(at) | Self::After { at, .. }) = self;
        at
    }
}

/// So many rows before the moment of contact are used for the state at it.
const BEFORE: usize = 3;

impl<S: Clone, I: Iterator<Item = Sampled<S>>> Iterator for Touchdowns<'_, S, I> {
    type Item = std::result::Result<Touchdown<S>, (S, Error)>;

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
                Some(Err(refused)) => self.ready.push_back(Err(refused)),
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
}

impl<S: Clone, I> Touchdowns<'_, S, I> {
    /// Takes the next sample.
    fn take(&mut self, sample: Sample<S>) {
        let places = self.points.at(&sample.state.position);
        match self.clock.step(sample.time) {
            Step::NewClip => {
                self.end_clip();
                self.descents = places.iter().map(|place| Descent { from: place.z, falling: false }).collect();
            }
            Step::Impact => {
                if let Some(last) = self.window.back_mut() {
                    last.before_impact = true;
                }
            }
            Step::Later(passed) => self.follow(&places, passed),
        }
        // A point that falls at `slow` or faster was `above` its level no longer ago than this; twice that is kept.
        let oldest = sample.time - 2.0 * self.thresholds.above / self.thresholds.slow;
        while self.window.get(BEFORE).is_some_and(|frame| frame.sample.time < oldest) {
            self.window.pop_front();
        }
        self.window.push_back(Frame { sample, row: self.counted, places, before_impact: false });
    }

    /// Follows every point to its next place, `passed` \[s\] after the last.
    fn follow(&mut self, places: &[Vector<f64>], passed: f64) {
        let Thresholds { drop, slow, ground, above, .. } = self.thresholds;
        // The point came to rest after the row before the last, or after the last.
        let smooth = self.window.len().saturating_sub(2);
        let mut struck = Vec::new();
        for (point, place) in places.iter().enumerate() {
            let Some(last) = self.window.back().map(|last| last.places[point].z) else {
                return;
            };
            let (height, mut descent) = (place.z, self.descents[point]);
            if (height - last) / passed < -slow {
                descent.falling = true;
            } else {
                if descent.falling {
                    if descent.from - last >= drop && last <= ground {
                        struck.extend(self.moment(point, last + above, smooth).map(|moment| (point, moment)));
                    }
                    descent = Descent { from: height, falling: false };
                }
                descent.from = descent.from.max(height);
            }
            self.descents[point] = descent;
        }
        self.strike(struck);
    }

    /// Ends the clip: a point that is still falling has reached the ground if it is at z = 0.
    fn end_clip(&mut self) {
        let Thresholds { drop, above, .. } = self.thresholds;
        let mut struck = Vec::new();
        for (point, &Descent { from, falling }) in self.descents.iter().enumerate() {
            let Some(last) = self.window.back().map(|last| last.places[point].z).filter(|_| falling) else {
                continue;
            };
            if from - last < drop || last > above {
                continue;
            }
            let moment = match last >= -above {
                true => Some(Moment::Row(self.last_before_impact())),
                // It goes on through the ground, which this recording does not know of.
                false => self.moment(point, 0.0, self.window.len() - 1),
            };
            struck.extend(moment.map(|moment| (point, moment)));
        }
        self.strike(struck);
        self.window.clear();
        self.descents.clear();
    }

    /// The last frame of the window, of two with the same time the first.
    fn last_before_impact(&self) -> usize {
        let last = self.window.len() - 1;
        let twin = last.checked_sub(1).filter(|&before| self.window[before].before_impact);
        twin.unwrap_or(last)
    }

    /// When the point was last as high as `height`; an impact that the recording itself marks after that is the moment.
    fn moment(&self, point: usize, height: f64, smooth: usize) -> Option<Moment> {
        let last = self.window.iter().rposition(|frame| frame.places[point].z >= height)?;
        let marked = |&frame: &usize| {
            let Frame { places, before_impact, .. } = &self.window[frame];
            *before_impact && places[point].z < height
        };
        let after = Moment::After { at: last, height, smooth: smooth.max(last) };
        Some((last..self.window.len()).find(marked).map_or(after, Moment::Row))
    }

    /// Makes touchdowns of the points that strike and are free to; those that strike together are one.
    fn strike(&mut self, mut struck: Vec<(usize, Moment)>) {
        struck.retain(|&(point, moment)| {
            self.points.is_free(point, &self.window[moment.row()].places, self.thresholds.together)
        });
        let mut left = VecDeque::from(struck);
        while let Some((striking, moment)) = left.pop_front() {
            let also = left.iter().filter(|&&other| self.together((striking, moment), other));
            let also: Vec<usize> = also.map(|&(point, _)| point).collect();
            left.retain(|(point, _)| !also.contains(point));
            let (mut state, time, at) = self.state(striking, moment);
            let together = self.thresholds.together;
            let (shift_z, contact) = self.points.touch(&mut state, striking, &also, self.touching, together);
            let Frame { sample, row, .. } = &self.window[at];
            let (row, source) = (*row, sample.source.clone());
            let finite = state.position.iter().chain(&state.velocity).all(|entry| entry.is_finite());
            self.ready.push_back(if finite {
                Ok(Touchdown { state, row, time, striking: contact, shift_z, source })
            } else {
                let reason = "the robot is too far away or too fast to be placed on the ground".to_owned();
                Err((source, Error::new(Reason::Inconsistent(reason))))
            });
        }
    }

    /// Whether two points strike at the same moment.
    fn together(&self, (one, when): (usize, Moment), (other, its): (usize, Moment)) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= self.thresholds.together;
        let alike = |at: usize| close(self.window[at].places[one].z, self.window[at].places[other].z);
        match (when, its) {
            (Moment::Row(at), Moment::Row(same)) => at == same && alike(at),
            (Moment::After { at, height, .. }, Moment::After { at: same, height: its, .. }) => {
                at == same && alike(at) && close(height, its)
            }
            _ => false,
        }
    }

    /// The state of a point's touchdown, its time, and the frame that it is of.
    fn state(&self, point: usize, moment: Moment) -> (State, f64, usize) {
        let at = moment.row();
        let Frame { sample, .. } = &self.window[at];
        let (mut state, mut time) = (sample.state.clone(), sample.time);
        if let (At::Crossing, Moment::After { height, smooth, .. }, Some(next)) =
            (self.at, moment, self.window.get(at + 1))
        {
            let first = (0..at).rfind(|&row| self.window[row].before_impact).map_or(0, |impact| impact + 1);
            let onward = if smooth > at { None } else { self.onward(point, first, at, height) };
            match onward {
                Some((onward, later)) => {
                    time += later;
                    for (entry, own) in state.position.iter_mut().enumerate() {
                        *own = onward.value(|back| self.window[at - back].sample.state.position[entry], later);
                    }
                }
                None => {
                    let (above, below) = (self.height(point, at), self.height(point, at + 1));
                    let part = if below < above { ((above - height) / (above - below)).clamp(0.0, 1.0) } else { 0.0 };
                    time += part * (next.sample.time - time);
                    for (own, next) in state.position.iter_mut().zip(&next.sample.state.position) {
                        *own += part * (next - *own);
                    }
                }
            }
            self.velocity(first, smooth, time, &mut state.velocity);
        }
        (state, time, at)
    }

    fn height(&self, point: usize, row: usize) -> f64 {
        self.window[row].places[point].z
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
