//! What a recording shows as a whole: how low its feet come, and whether its columns fit each other.

use super::Sample;
use super::clip::ClockStep;
use crate::Robot;

/// Velocities fit positions if they are between this part and this many times dq/dt: recordings are noisy.
const FIT: [f64; 2] = [0.5, 2.0];
/// They are proportional to dq/dt from this correlation on; of noise it is up to 0.5.
const CORRELATED: f64 = 0.8;
/// So many rows are compared at least.
const ENOUGH: usize = 30;

/// What has been seen of a recording.
#[derive(Debug, Clone)]
pub struct Seen {
    /// The least height of a foot \[m\].
    pub lowest: f64,
    /// What is odd about the joints of the first state with such joints, in words.
    pub odd_joint: Option<String>,
    /// Of each coordinate the sums of v^2, of (dq/dt)^2 and of their product over steps from row to row.
    sums: Vec<[f64; 3]>,
    steps: usize,
    /// Positions and velocities of the row before.
    last: [Vec<f64>; 2],
}

impl Default for Seen {
    /// Nothing yet.
    fn default() -> Self {
        Self { lowest: f64::INFINITY, odd_joint: None, sums: Vec::new(), steps: 0, last: Default::default() }
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

    /// That velocities of the recording are not the rates of its positions, as in other units or of other sign.
    pub fn misfit(&self, robot: &Robot) -> Option<String> {
        let misfit = |(name, &[squared, rates, product]): (&str, &[f64; 3])| {
            let (correlation, factor) = (product / (squared * rates).sqrt(), product / rates);
            if correlation < -CORRELATED {
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
