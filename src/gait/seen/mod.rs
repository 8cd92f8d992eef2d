//! A recording as a whole: how low its feet come, and whether its rows and columns are consistent.

mod order;
mod motion;

use self::motion::Motion;
use self::order::Order;
use super::clip::{Clock, ClockStep};
use super::{Heights, Sample, Sampled, Thresholds};
use crate::Robot;
use crate::error::rounded;
use std::sync::Mutex;

/// The fewest touchdowns or ends of descents from which a common level is computed.
const ENOUGH: usize = 4;

/// Observations of a recording.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// The least height of a foot \[m\].
    lowest: Option<f64>,
    /// The first oddity of the joints of the first state that has one, in words.
    pub oddity: Option<String>,
    order: Order,
    motion: Motion,
    /// The depth below z = 0 of each touchdown \[m\], with recorded heights and without deep touchdowns.
    depths: Vec<f64>,
    touchdowns: usize,
    /// The heights at which the lowest foot has ended descents that are no touchdowns, because they are too high or in
    /// the ground of a simulation \[m\]; and the row of the last one.
    ends: Vec<f64>,
    last_end: Option<usize>,
}

impl Seen {
    /// Returns notes if velocities are not the rates of positions: if the base's are in its own axes, and if others are
    /// in other units or have another sign.
    pub fn misfit<S>(samples: impl Iterator<Item = Sampled<S>>, robot: &Robot) -> [Option<String>; 2] {
        let (mut clock, mut motion) = (Clock::default(), Motion::default());
        for Sample { state, time, .. } in samples.flatten() {
            motion.add(&state, time, clock.step(time), true, robot);
        }
        [motion.turned(), motion.misfit(robot)]
    }

    /// Passes `samples` on and adds their order and positions to `seen`. Velocities are not looked at.
    pub fn watching<'r, S>(
        samples: impl Iterator<Item = Sampled<S>> + 'r,
        (robot, seen): (&'r Robot, &'r Mutex<Self>),
    ) -> impl Iterator<Item = Sampled<S>> + 'r {
        let mut clock = Clock::default();
        samples.inspect(move |sampled| {
            if let (Ok(sample), Ok(mut seen)) = (sampled, seen.lock()) {
                seen.follow(sample, clock.step(sample.time), false, robot);
            }
        })
    }

    /// Adds the next sample, with the height of its lowest foot \[m\].
    pub(super) fn add<S>(&mut self, sample: &Sample<S>, step: ClockStep, lowest: f64, robot: &Robot) {
        self.lowest = Some(self.lowest.map_or(lowest, |before| before.min(lowest)));
        if self.oddity.is_none() {
            self.oddity = sample.state.oddities_of_motion(robot).into_iter().next();
        }
        // Velocities that were computed from positions are consistent with them.
        let is_recorded = sample.rate_over == [sample.time; 2];
        self.follow(sample, step, is_recorded, robot);
    }

    fn follow<S>(&mut self, sample: &Sample<S>, step: ClockStep, is_recorded: bool, robot: &Robot) {
        self.order.add(sample.time, step);
        self.motion.add(&sample.state, sample.time, step, is_recorded, robot);
    }

    /// Adds a touchdown, with its depth below z = 0 if that shows the ground \[m\].
    pub(super) fn add_touchdown(&mut self, depth: Option<f64>) {
        self.touchdowns += 1;
        self.depths.extend(depth);
    }

    /// Adds the end \[m\] of a descent of the lowest foot as in `ends`; several points in one row count as one foot.
    pub(super) fn add_end(&mut self, row: usize, height: f64) {
        if self.last_end.replace(row) != Some(row) {
            self.ends.push(height);
        }
    }

    /// Returns the message for a recording without touchdowns.
    pub fn nothing_found(&self, thresholds: Thresholds, heights: Heights) -> String {
        if self.order.stands_still() {
            return "no touchdown found: the time never rises from row to row".to_owned();
        }
        let Thresholds { drop, slow, ground, .. } = thresholds;
        // Rounds to 0.1 mm, and turns -0 into 0.
        let lowest = self.lowest.map(|lowest| (1e4 * lowest).round() / 1e4 + 0.0).filter(|lowest| lowest.is_finite());
        let reached = lowest.map_or(String::new(), |lowest| format!("the lowest foot comes to z = {lowest} m; "));
        let must = match heights {
            Heights::True => " and cross z = 0 (see `drop`)".to_owned(),
            Heights::Recorded => format!(
                ", faster than {slow:.4} m/s, to at most {ground:.4} m above the ground (see `drop`, `ground_height`)"
            ),
        };
        let odd = self.oddity.as_ref().map_or(String::new(), |odd| format!("; {odd}"));
        format!("no touchdown found: {reached}a foot must descend {drop:.4} m or more{must}{odd}")
    }

    /// Describes oddities of the recording.
    pub fn notes(&self, robot: &Robot, thresholds: Thresholds) -> impl Iterator<Item = String> {
        self.order.notes().chain(self.motion.notes(robot)).chain(self.offset(thresholds)).chain(self.end(thresholds))
    }

    /// Notes descents that end too high or, in a simulation, far below z = 0: more than half as many as touchdowns.
    fn end(&self, Thresholds { ground, .. }: Thresholds) -> Option<String> {
        let count = self.ends.len();
        let middle = median(&self.ends).filter(|_| 2 * count > self.touchdowns)?;
        let level = rounded(middle);
        if middle > ground {
            Some(format!(
                "the lowest foot has ended {count} descents at z = {level} m, in the middle of all: the ground must be \
                 level and at z = 0 (see `ground_height`)"
            ))
        } else if middle < -0.5 * ground {
            Some(format!(
                "feet go down to z = {level} m after their touchdowns, in the middle of all: if the ground is not that \
                 soft, shift q_base_z so that it is z = 0"
            ))
        } else {
            None
        }
    }

    /// Notes that touchdowns are not at z = 0, if most of them are on one side of it.
    fn offset(&self, thresholds: Thresholds) -> Option<String> {
        let middle = median(&self.depths)?;
        (middle.abs() > 0.5 * thresholds.ground).then(|| {
            format!(
                "feet reach the ground at z = {} m, in the middle of all touchdowns: shift q_base_z so that the \
                 ground is z = 0{}",
                rounded(-middle),
                if middle > 0.0 { ", or, if feet sink into a simulation's soft ground, give `simulated`" } else { "" }
            )
        })
    }
}

/// Returns the median; `None` of fewer than [`ENOUGH`] heights.
fn median(heights: &[f64]) -> Option<f64> {
    let mut heights = heights.to_vec();
    heights.sort_unstable_by(f64::total_cmp);
    heights.get(heights.len() / 2).copied().filter(|_| heights.len() >= ENOUGH)
}
