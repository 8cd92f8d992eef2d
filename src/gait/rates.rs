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
    let mut clock = Clock::default();
    // The sample that waits for the next one, and time and position of the sample before it.
    let (mut waiting, mut before): (Option<Sample<S>>, _) = (None, None);
    samples.map(Some).chain([None]).flat_map(move |next| {
        let (next, refused) = match next {
            Some(Ok(sample)) => (Some(sample), None),
            other => (None, other),
        };
        let after = next.as_ref().filter(|next| matches!(clock.step(next.time), ClockStep::Later(_)));
        let settled = waiting.take().map(|sample| {
            let place = after.map(|_| (sample.time, sample.state.position.clone()));
            settled(sample, std::mem::replace(&mut before, place), after, difference)
        });
        waiting = next;
        settled.into_iter().chain(refused)
    })
}

/// Computes the velocity of a sample from time and position of the sample `before` and from the one `after`.
fn settled<S>(
    mut sample: Sample<S>,
    before: Option<(f64, Vec<f64>)>,
    after: Option<&Sample<S>>,
    difference: Difference,
) -> Sampled<S> {
    let here = (sample.time, &sample.state.position);
    let before = before.as_ref().map(|(time, position)| (*time, position));
    let ends = match (difference, before, after.map(|after| (after.time, &after.state.position))) {
        (Difference::Central, Some(before), Some(after)) => Some((before, after)),
        (_, Some(before), _) => Some((before, here)),
        (_, None, after) => after.map(|after| (here, after)),
    };
    let reason = if let Some(((from, start), (to, end))) = ends {
        let rates: Vec<f64> = start.iter().zip(end).map(|(start, end)| (end - start) / (to - from)).collect();
        if rates.iter().all(|rate| rate.is_finite()) {
            (sample.rate_over, sample.state.velocity) = ([from, to], rates);
            return Ok(sample);
        }
        "the velocity to the next row is beyond all numbers"
    } else {
        "no neighboring row of its clip has another time, so that its velocity is not known: time must rise from row to row"
    };
    Err((sample.source, Error::new(Reason::Inconsistent(reason.to_owned())).at("time")))
}
