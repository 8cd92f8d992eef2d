//! What a recording shows as a whole: how low its feet come, and whether its columns fit each other.

use super::Sample;
use super::clip::ClockStep;
use crate::Robot;
use crate::error::shortest_within;

/// Velocities fit positions if they are between this part and this many times dq/dt: recordings are noisy.
const FIT: [f64; 2] = [0.5, 2.0];
/// They are proportional to dq/dt from this correlation on; of noise it is up to 0.5.
const CORRELATED: f64 = 0.8;
/// A coordinate that moves at less on average may be noise about one that stands \[m/s, rad/s\].
const MOVING: f64 = 0.1;
/// Time that goes back by no more steps is that of rows out of order.
const FEW_STEPS: f64 = 10.0;
/// So many rows are compared at least.
const ENOUGH: usize = 30;

/// What has been seen of a recording.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The least height of a foot \[m\].
    pub lowest: f64,
    /// What is odd about the joints of the first state with such joints, in words.
    pub odd_joint: Option<String>,
    rows: usize,
    /// Whether time ever rises from one row to the next.
    rises: bool,
    /// How often time goes back by a few steps, within the clip.
    returns: usize,
    /// The times before and after the first time that it does \[s\].
    first_return: Option<[f64; 2]>,
    /// The times of the clip's first row and of the row before, and the last step forward \[s\].
    clip: [f64; 2],
    step: f64,
    /// Of each coordinate the sums of v^2, of (dq/dt)^2 and of their product over steps from row to row.
    sums: Vec<[f64; 3]>,
    steps: usize,
    /// Positions and velocities of the row before.
    last: [Vec<f64>; 2],
}

impl Default for Seen {
    /// Nothing yet.
    fn default() -> Self {
        Self {
            lowest: f64::INFINITY,
            odd_joint: None,
            rows: 0,
            rises: false,
            returns: 0,
            first_return: None,
            clip: [f64::INFINITY; 2],
            step: 0.0,
            sums: Vec::new(),
            steps: 0,
            last: Default::default(),
        }
    }
}

impl Seen {
    /// Adds the next sample, whose lowest foot is at this height \[m\].
    pub(super) fn add<S>(&mut self, sample: &Sample<S>, step: ClockStep, lowest: f64, robot: &Robot) {
        self.lowest = self.lowest.min(lowest);
        let state = &sample.state;
        if self.odd_joint.is_none() {
            self.odd_joint = state.odd_joints(robot).next();
        }
        self.rows += 1;
        if let ClockStep::Later(passed) = step {
            (self.rises, self.step) = (true, passed);
        }
        let [first, before] = self.clip;
        // A clip of its own begins anywhere.
        if first < sample.time && sample.time < before && before - sample.time <= FEW_STEPS * self.step {
            self.returns += 1;
            self.first_return.get_or_insert([before, sample.time]);
        }
        self.clip = [if step == ClockStep::NewClip { sample.time } else { first }, sample.time];
        // Velocities that were taken from positions fit them.
        let is_recorded = sample.rate_over == [sample.time; 2];
        if let (ClockStep::Later(passed), true) = (step, is_recorded) {
            self.sums.resize(state.position.len(), [0.0; 3]);
            self.steps += 1;
            let positions = self.last[0].iter().zip(&state.position);
            let velocities = self.last[1].iter().zip(&state.velocity);
            for (sums, ((from, to), (before, after))) in self.sums.iter_mut().zip(positions.zip(velocities)) {
                let (rate, velocity) = ((to - from) / passed, 0.5 * (before + after));
                sums.iter_mut()
                    .zip([velocity * velocity, rate * rate, velocity * rate])
                    .for_each(|(sum, own)| *sum += own);
            }
        }
        for (last, own) in self.last.iter_mut().zip([&state.position, &state.velocity]) {
            own.clone_into(last);
        }
    }

    /// Whether time rises from no row to the next.
    pub fn stands_still(&self) -> bool {
        self.rows > 1 && !self.rises
    }

    /// That rows are not in the order of their times.
    pub fn disorder(&self) -> Option<String> {
        let [before, after] = self.first_return?;
        let [before, after] = [before, after].map(|time| shortest_within(time, 0.01 * (before - after)));
        let times = if self.returns == 1 { "once".to_owned() } else { format!("{} times", self.returns) };
        Some(format!(
            "rows are not in the order of time, which goes back {times}, first from {before} s to {after} s: a new clip begins \
             there"
        ))
    }

    /// That velocities of the recording are not the rates of its positions, as in other units or of other sign.
    pub fn misfit(&self, robot: &Robot) -> Option<String> {
        let misfit = |(name, &[squared, rates, product]): (&str, &[f64; 3])| {
            let (correlation, factor) = (product / (squared * rates).sqrt(), product / rates);
            if squared == 0.0 && rates > MOVING * MOVING * self.steps as f64 {
                Some(format!("{name} is 0 although it moves"))
            } else if correlation < -CORRELATED {
                Some(format!("{name} has the opposite sign of dq/dt"))
            } else if correlation > CORRELATED && !(FIT[0]..=FIT[1]).contains(&factor) {
                Some(format!("{name} is {factor:.3} times dq/dt"))
            } else {
                None
            }
        };
        let found: Vec<String> = robot.coordinates().zip(&self.sums).filter_map(misfit).collect();
        let first = found.first().filter(|_| self.steps >= ENOUGH)?;
        let also = if found.len() > 1 { format!(", and {} more", found.len() - 1) } else { String::new() };
        Some(format!(
            "velocities do not fit positions over time: v of {first}{also}; are they of these coordinates, in m, rad and s?"
        ))
    }
}
