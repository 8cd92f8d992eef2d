//! Motions in three dimensions along the mean heading of each clip:
//!
//! ```text
//!     x, y --[h: mean heading of the clip, see spatial]--> x = h . (x, y)          left out: h x (x, y), yaw from h, roll
//! ```
//!
//! z and pitch are those of the rows. The heading is known at a clip's end, so a clip is held in memory.

use super::clip::{Clock, Step};
use super::{Sample, Sampled};
use crate::gait::spatial::{Heading, Spatial};
use crate::{Error, Reason};
use std::collections::VecDeque;
use std::fmt;
use std::sync::Mutex;

/// How much of a motion in three dimensions is not in the plane: of each the largest.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dropped {
    /// The turn about the forward axis \[rad\].
    pub roll: f64,
    /// The turn about the vertical from the clip's heading \[rad\].
    pub yaw: f64,
    /// The distance from the line along the heading through the middle of the clip \[m\].
    pub sideways: f64,
}

/// Projects every sample of `samples` whose base is in three dimensions, and adds to `dropped` what is left out.
pub fn sagittal<S, I: Iterator<Item = Sampled<S>>>(samples: I, dropped: &Mutex<Dropped>) -> Sagittal<'_, S, I> {
    Sagittal { samples, dropped, clock: Clock::default(), clip: Vec::new(), ready: VecDeque::new() }
}

/// The projected samples in their order, a clip late; those in the plane and the refused ones as they are. Samples of a
/// clip that has no heading are refused.
#[derive(Debug)]
pub struct Sagittal<'d, S, I> {
    samples: I,
    dropped: &'d Mutex<Dropped>,
    clock: Clock,
    clip: Vec<Sampled<S>>,
    ready: VecDeque<Sampled<S>>,
}

impl<S, I: Iterator<Item = Sampled<S>>> Iterator for Sagittal<'_, S, I> {
    type Item = Sampled<S>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(ready) = self.ready.pop_front() {
                return Some(ready);
            }
            match self.samples.next() {
                Some(sampled) => {
                    let time = sampled.as_ref().ok().map(|sample| sample.time);
                    if time.is_some_and(|time| self.clock.step(time) == Step::NewClip) {
                        self.end_clip();
                    }
                    self.clip.push(sampled);
                }
                None if self.clip.is_empty() => return None,
                None => self.end_clip(),
            }
        }
    }
}

impl<S, I> Sagittal<'_, S, I> {
    fn end_clip(&mut self) {
        let clip = std::mem::take(&mut self.clip);
        let bases = || clip.iter().flatten().filter_map(|sample| sample.spatial.as_ref());
        let heading = Heading::mean(bases());
        if let (Some(heading), Ok(mut all)) = (heading, self.dropped.lock()) {
            all.add(heading, bases);
        }
        self.ready.extend(clip.into_iter().map(|sampled| along(heading, sampled?)));
    }
}

/// The sample with its x along the heading.
fn along<S>(heading: Option<Heading>, mut sample: Sample<S>) -> Sampled<S> {
    match (sample.spatial.take(), heading) {
        (Some(Spatial { origin, .. }), Some(heading)) => {
            [sample.state.position[0], _] = heading.along_and_across(origin);
            Ok(sample)
        }
        (Some(_), None) => {
            let reason = "the robot turns all the way round in its clip, which has no mean heading".to_owned();
            let error = Error::new(Reason::Inconsistent(reason)).at("q_base_qw");
            Err((sample.source, error.hint("cut the clip: a jump back in time begins another")))
        }
        (None, _) => Ok(sample),
    }
}

impl Dropped {
    /// Adds the bases of a clip.
    fn add<'s, B: Iterator<Item = &'s Spatial>>(&mut self, heading: Heading, bases: impl Fn() -> B) {
        let across = |base: &Spatial| heading.along_and_across(base.origin)[1];
        let (sum, count) = bases().fold((0.0, 0.0), |(sum, count), base| (sum + across(base), count + 1.0));
        for base in bases() {
            self.roll = self.roll.max(base.roll.abs());
            self.yaw = self.yaw.max(heading.yaw(base).abs());
            self.sideways = self.sideways.max((across(base) - sum / count).abs());
        }
    }
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { roll, yaw, sideways } = self;
        write!(f, "roll up to {roll:.3} rad, yaw up to {yaw:.3} rad, {sideways:.3} m to the side")
    }
}
