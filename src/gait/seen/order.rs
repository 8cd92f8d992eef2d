//! Checks whether the rows of a recording follow each other in time.

use crate::error::{rounded, shortest_within};
use crate::gait::clip::ClockStep;

/// If time goes back by at most this many steps, rows are out of order.
const FEW_STEPS: f64 = 10.0;
/// Rows are missing in a step that is this many times as long as the next one and as the longest before without a gap.
const GAP: f64 = 1.8;
/// A recording of a gait has several rows in this time \[s\].
const LONG: f64 = 0.5;
/// The accuracy with which a time is shown \[s\].
const ACCURATE: f64 = 1e-6;
/// If more than this fraction of rows has a gap, steps are uneven and no rows are missing.
const FEW_GAPS: f64 = 0.05;

/// Observations of the times.
#[derive(Debug, Clone, Default)]
pub(super) struct Order {
    rows: usize,
    /// Where time goes back by a few steps, within the clip.
    returns: Found,
    gaps: Found,
    /// Where three rows have the same time.
    halts: Found,
    /// The times of the clip's first row and of the row before \[s\].
    clip: [f64; 2],
    /// The shortest step forward of all, and the last one of the clip \[s\].
    shortest: Option<f64>,
    last_step: Option<f64>,
    /// The longest step of the clip before the last step, without gaps \[s\].
    longest: Option<f64>,
    /// The number of rows that have the current time.
    together: usize,
}

/// The number of findings, and the times between which the first one lies \[s\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Found {
    count: usize,
    first: Option<[f64; 2]>,
}

impl Found {
    pub fn add(&mut self, first: [f64; 2]) {
        self.count += 1;
        self.first.get_or_insert(first);
    }

    /// Describes how often and when; `None` if nothing was found.
    pub fn text(&self) -> Option<String> {
        let [from, to] = self.first?;
        let times = if self.count == 1 { "once".to_owned() } else { format!("{} times", self.count) };
        let digits = |tolerance| [from, to].map(|time| shortest_within(time, tolerance));
        Some(match from == to {
            true => format!("{times}, first at {} s", digits(ACCURATE)[0]),
            false => {
                let [from, to] = digits(0.01 * (to - from).abs());
                format!("{times}, first from {from} s to {to} s")
            }
        })
    }
}

impl Order {
    /// Adds the time of the next row \[s\].
    pub fn add(&mut self, time: f64, step: ClockStep) {
        self.rows += 1;
        let [first, before] = self.clip;
        match step {
            ClockStep::Later(passed) => {
                self.shortest = Some(self.shortest.map_or(passed, |shortest| shortest.min(passed)));
                match (self.last_step, self.longest) {
                    (Some(last), Some(longest)) if last > GAP * passed.max(longest) => {
                        self.gaps.add([before - last, before]);
                    }
                    (Some(last), longest) => self.longest = Some(longest.unwrap_or(last).max(last)),
                    (None, _) => {}
                }
                self.last_step = Some(passed);
            }
            ClockStep::Impact if self.together == 2 => self.halts.add([time; 2]),
            ClockStep::Impact => {}
            ClockStep::NewClip => {
                // A clip of its own may begin at any time.
                let few = self.last_step.map_or(0.0, |step| FEW_STEPS * step);
                if first < time && time < before && before - time <= few {
                    self.returns.add([before, time]);
                }
                (self.last_step, self.longest) = (None, None);
            }
        }
        self.together = if step == ClockStep::Impact { self.together + 1 } else { 1 };
        self.clip = [if step == ClockStep::NewClip { time } else { first }, time];
    }

    /// Returns whether time never rises from one row to the next.
    pub fn stands_still(&self) -> bool {
        self.rows > 1 && self.shortest.is_none()
    }

    /// Describes oddities of the times.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        let few_gaps = self.gaps.count as f64 <= FEW_GAPS * self.rows as f64;
        let gaps = self.gaps.text().filter(|_| few_gaps);
        let halts = self.halts.text().filter(|_| !self.stands_still());
        let odd = [
            (self.returns.text(), "rows are not in the order of time, which goes back", "a new clip begins there"),
            (gaps, "rows seem to be missing", "what happens there is missed or less accurate"),
            (halts, "more than two rows have the same time", "is it rounded? each row needs its own"),
        ];
        let odd = odd.into_iter().filter_map(|(when, what, then)| Some(format!("{what} {}: {then}", when?)));
        let step = self.shortest.filter(|step| *step > LONG).map(rounded);
        odd.chain(step.map(|step| format!("rows are {step} s apart: is the time in seconds?")))
    }
}
