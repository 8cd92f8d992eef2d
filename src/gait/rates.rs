//! Velocities for a recording without them: v = dq/dt by differences of rows.
//!
//! Rows of one time are an impact. No difference is taken across an impact, across the end of a clip, or across a
//! refused row. At these ends the difference is one-sided.

use super::clip::{Clock, ClockStep};
use super::{Sample, Sampled};
use crate::{Error, Reason};

/// The rows from which a velocity is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Difference {
    /// The row before and the row after. This is smooth, but next to an impact it blends both sides unless the
    /// recording has two rows of that time.
    Central,
    /// The row before and the row itself; for the first row of a clip, the row itself and the row after.
    Backward,
}

/// Computes each sample's velocity from its neighbors, in order and one sample late. Refuses one without a neighbor.
pub fn rates<S>(samples: impl Iterator<Item = Sampled<S>>, difference: Difference) -> impl Iterator<Item = Sampled<S>> {
    let mut pending = PendingSample { difference, sample: None, before: None };
    let mut clock = Clock::default();
    samples.map(Some).chain([None]).flat_map(move |next| {
        let (sample, refused) = match next {
            Some(Ok(sample)) => (Some(sample), None),
            other => (None, other),
        };
        let linked = |sample: &&Sample<S>| matches!(clock.step(sample.time), ClockStep::Later(_));
        let settled = pending.settle(sample.as_ref().filter(linked));
        pending.sample = sample;
        settled.into_iter().chain(refused)
    })
}

/// The sample that waits for the next one.
struct PendingSample<S> {
    difference: Difference,
    sample: Option<Sample<S>>,
    /// Time and position of the sample before it.
    before: Option<(f64, Vec<f64>)>,
}

impl<S> PendingSample<S> {
    /// Computes the velocity of the sample; `after` is the neighbor that follows.
    fn settle(&mut self, after: Option<&Sample<S>>) -> Option<Sampled<S>> {
        let before = self.before.take();
        let mut sample = self.sample.take()?;
        let own = (sample.time, &sample.state.position);
        let before = before.as_ref().map(|(time, position)| (*time, position));
        let ends = match (self.difference, before, after.map(|after| (after.time, &after.state.position))) {
            (Difference::Central, Some(before), Some(after)) => Some((before, after)),
            (_, Some(before), _) => Some((before, own)),
            (_, None, after) => after.map(|after| (own, after)),
        };
        let refused = match ends {
            Some(((from, start), (to, end))) => {
                sample.rate_over = [from, to];
                let rates = start.iter().zip(end).map(|(start, end)| (end - start) / (to - from));
                sample.state.velocity = rates.collect();
                let finite = sample.state.velocity.iter().all(|rate| rate.is_finite());
                (!finite).then_some("the velocity to the next row is beyond all numbers")
            }
            None => Some(
                "no neighboring row of its clip has another time, so that its velocity is not known: time must rise from row to row",
            ),
        };
        self.before = after.map(|_| (sample.time, sample.state.position.clone()));
        Some(match refused {
            None => Ok(sample),
            Some(reason) => Err((sample.source, Error::new(Reason::Inconsistent(reason.to_owned())).at("time"))),
        })
    }
}
