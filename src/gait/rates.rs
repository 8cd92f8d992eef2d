//! Velocities of a recording that has none: v = dq/dt by differences of rows.
//!
//! Rows of one time are an impact: no difference is taken across it, nor from one clip to the next, nor across a
//! refused row. At such an end the difference is one-sided.

use super::clip::{Clock, Step};
use super::{Sample, Sampled};
use crate::{Error, Reason};
use std::collections::VecDeque;

/// Which rows a velocity is taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Difference {
    /// The one before and the one after: smooth, but next to an impact it blends both sides where the recording has no
    /// two rows of its time.
    Central,
    /// The one before and the row itself; of the first row of a clip the row itself and the one after.
    Backward,
}

/// Gives every sample of `samples` the velocity from its neighbors; see [`Differentiated`].
pub fn rates<S, I: Iterator<Item = Sampled<S>>>(samples: I, difference: Difference) -> Differentiated<S, I> {
    Differentiated { samples, difference, clock: Clock::default(), before: None, pending: None, ready: VecDeque::new() }
}

/// The samples with their velocities, one sample late and in their order; one that has no neighbour is refused.
#[derive(Debug)]
pub struct Differentiated<S, I> {
    samples: I,
    difference: Difference,
    clock: Clock,
    /// Time and position of the neighbour before the pending sample.
    before: Option<(f64, Vec<f64>)>,
    pending: Option<Sample<S>>,
    ready: VecDeque<Sampled<S>>,
}

impl<S, I: Iterator<Item = Sampled<S>>> Iterator for Differentiated<S, I> {
    type Item = Sampled<S>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(ready) = self.ready.pop_front() {
                return Some(ready);
            }
            match self.samples.next() {
                Some(Ok(sample)) => {
                    let linked = matches!(self.clock.step(sample.time), Step::Later(_));
                    self.settle(linked.then_some(&sample));
                    self.pending = Some(sample);
                }
                Some(Err(refused)) => {
                    self.settle(None);
                    self.ready.push_back(Err(refused));
                }
                None => {
                    self.settle(None);
                    if self.ready.is_empty() {
                        return None;
                    }
                }
            }
        }
    }
}

impl<S, I> Differentiated<S, I> {
    /// Gives the pending sample its velocity, `after` being the neighbour that follows.
    fn settle(&mut self, after: Option<&Sample<S>>) {
        let before = self.before.take();
        let Some(mut sample) = self.pending.take() else {
            return;
        };
        let own = (sample.time, &sample.state.position);
        let before = before.as_ref().map(|(time, position)| (*time, position));
        let after = after.map(|after| (after.time, &after.state.position));
        let ends = match (self.difference, before, after) {
            (Difference::Central, Some(before), Some(after)) => Some((before, after)),
            (_, Some(before), _) => Some((before, own)),
            (_, None, Some(after)) => Some((own, after)),
            (_, None, None) => None,
        };
        let velocity = ends.map(|((from, start), (to, end))| -> Vec<f64> {
            start.iter().zip(end).map(|(start, end)| (end - start) / (to - from)).collect()
        });
        if let Some(((from, _), (to, _))) = ends {
            sample.rate_over = [from, to];
        }
        self.before = after.map(|_| (sample.time, sample.state.position.clone()));
        self.ready.push_back(match velocity {
            Some(velocity) if velocity.iter().all(|rate| rate.is_finite()) => {
                sample.state.velocity = velocity;
                Ok(sample)
            }
            Some(_) => {
                let reason = "the velocity to the next row is beyond all numbers".to_owned();
                Err((sample.source, Error::new(Reason::Inconsistent(reason)).at("time")))
            }
            None => {
                let reason = "the clip has no other row to find the velocity of this one from".to_owned();
                Err((sample.source, Error::new(Reason::Inconsistent(reason)).at("time")))
            }
        });
    }
}
