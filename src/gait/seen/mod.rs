//! What a recording shows as a whole: how low its feet come, and whether its rows and its columns fit each other.

mod order;
mod motion;

use self::motion::Motion;
use self::order::Order;
use super::clip::{Clock, ClockStep};
use super::{Heights, Sample, Sampled, Thresholds};
use crate::Robot;
use crate::error::rounded;

/// So many touchdowns have a level in common.
const ENOUGH: usize = 4;

/// What has been seen of a recording.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// The least height of a foot \[m\].
    lowest: Option<f64>,
    /// What is odd about the joints of the first state with such joints, in words.
    pub oddity: Option<String>,
    order: Order,
    motion: Motion,
    /// How far below z = 0 each touchdown was found where heights are recorded, apart from deep ones \[m\].
    depths: Vec<f64>,
    touchdowns: usize,
    /// How high the lowest foot has ended descents that are none: too high, or in the ground of a simulation \[m\]; and
    /// the last row at which it has.
    ends: Vec<f64>,
    last_end: Option<usize>,
}

impl Seen {
    /// That the velocities of samples are not the rates of their positions, as in other units or of other sign.
    pub fn misfit<S>(samples: impl Iterator<Item = Sampled<S>>, robot: &Robot) -> Option<String> {
        let (mut clock, mut motion) = (Clock::default(), Motion::default());
        for Sample { state, time, .. } in samples.flatten() {
            motion.add(&state, time, clock.step(time), true, robot);
        }
        motion.misfit(robot)
    }

    /// Adds the next sample, whose lowest foot is at this height \[m\].
    pub(super) fn add<S>(&mut self, sample: &Sample<S>, step: ClockStep, lowest: f64, robot: &Robot) {
        self.lowest = Some(self.lowest.map_or(lowest, |before| before.min(lowest)));
        let Sample { state, time, .. } = sample;
        if self.oddity.is_none() {
            self.oddity = state.oddities(robot).into_iter().next();
        }
        self.order.add(*time, step);
        // Velocities that were taken from positions fit them.
        let is_recorded = sample.rate_over == [*time; 2];
        self.motion.add(state, *time, step, is_recorded, robot);
    }

    /// Adds a touchdown, so far below z = 0 where that shows the ground \[m\].
    pub(super) fn add_touchdown(&mut self, depth: Option<f64>) {
        self.touchdowns += 1;
        self.depths.extend(depth);
    }

    /// Adds the height \[m\] at which the lowest foot has ended a descent that is no touchdown, or goes on in the ground;
    /// several points of one row are one foot.
    pub(super) fn add_end(&mut self, row: usize, height: f64) {
        if self.last_end.replace(row) != Some(row) {
            self.ends.push(height);
        }
    }

    /// What to say if there is no touchdown.
    pub fn nothing_found(&self, thresholds: Thresholds, heights: Heights) -> String {
        if self.order.stands_still() {
            return "no touchdown found: the time never rises from row to row".to_owned();
        }
        let Thresholds { drop, slow, ground, .. } = thresholds;
        // To 0.1 mm, and 0 in place of -0.
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

    /// What is odd about the recording.
    pub fn notes(&self, robot: &Robot, thresholds: Thresholds) -> impl Iterator<Item = String> {
        self.order.notes().chain(self.motion.notes(robot)).chain(self.offset(thresholds)).chain(self.end(thresholds))
    }

    /// That most descents end too high above z = 0, or far below it in a simulation.
    fn end(&self, Thresholds { ground, .. }: Thresholds) -> Option<String> {
        let mut ends = self.ends.clone();
        ends.sort_unstable_by(f64::total_cmp);
        let are_most = ends.len() >= ENOUGH && 2 * ends.len() > self.touchdowns;
        let middle = *ends.get(ends.len() / 2).filter(|_| are_most)?;
        let (count, level) = (ends.len(), rounded(middle));
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

    /// That touchdowns are not at z = 0, most on one side of it.
    fn offset(&self, thresholds: Thresholds) -> Option<String> {
        let mut depths = self.depths.clone();
        depths.sort_unstable_by(f64::total_cmp);
        let middle = *depths.get(depths.len() / 2).filter(|_| depths.len() >= ENOUGH)?;
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
