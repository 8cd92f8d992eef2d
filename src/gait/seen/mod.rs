//! What a recording shows as a whole: how low its feet come, and whether its rows and its columns fit each other.

mod order;
mod motion;

use self::motion::Motion;
use self::order::Order;
use super::clip::ClockStep;
use super::{Sample, Thresholds};
use crate::Robot;
use crate::error::rounded;

/// So many touchdowns have a level in common.
const ENOUGH: usize = 4;

/// What has been seen of a recording.
#[derive(Debug, Clone, Default)]
pub struct Seen {
    /// The least height of a foot so far \[m\].
    pub lowest: Option<f64>,
    /// What is odd about the joints of the first state with such joints, in words.
    pub odd_joint: Option<String>,
    order: Order,
    motion: Motion,
    /// How far below z = 0 each touchdown was found where heights are recorded, apart from deep ones \[m\].
    depths: Vec<f64>,
}

impl Seen {
    /// Adds the next sample, whose lowest foot is at this height \[m\].
    pub(super) fn add<S>(&mut self, sample: &Sample<S>, step: ClockStep, lowest: f64, robot: &Robot) {
        self.lowest = Some(self.lowest.map_or(lowest, |before| before.min(lowest)));
        let Sample { state, time, .. } = sample;
        if self.odd_joint.is_none() {
            self.odd_joint = state.odd_joints(robot).next();
        }
        self.order.add(*time, step);
        // Velocities that were taken from positions fit them.
        let is_recorded = sample.rate_over == [*time; 2];
        self.motion.add(state, *time, step, is_recorded, robot);
    }

    /// Adds a touchdown so far below z = 0 \[m\].
    pub(super) fn add_depth(&mut self, depth: f64) {
        self.depths.push(depth);
    }

    /// Whether time rises from no row to the next.
    pub fn stands_still(&self) -> bool {
        self.order.stands_still()
    }

    /// The step of time \[s\], if it is too long for any gait, as in milliseconds.
    pub fn long_step(&self) -> Option<f64> {
        self.order.long_step()
    }

    /// What is odd about the recording.
    pub fn notes(&self, robot: &Robot, thresholds: Thresholds) -> impl Iterator<Item = String> {
        self.order.notes().chain(self.motion.notes(robot)).chain(self.offset(thresholds))
    }

    /// That touchdowns are not at z = 0, most on one side of it.
    fn offset(&self, thresholds: Thresholds) -> Option<String> {
        let mut depths = self.depths.clone();
        depths.sort_unstable_by(f64::total_cmp);
        let middle = *depths.get(depths.len() / 2).filter(|_| depths.len() >= ENOUGH)?;
        (middle.abs() > 0.5 * thresholds.ground).then(|| {
            format!(
                "feet reach the ground at z = {} m, in the middle of all touchdowns: shift q_base_z so that the \
                 ground is z = 0",
                rounded(-middle)
            )
        })
    }
}
