//! Checks whether the positions and velocities of a recording are consistent.

use super::order::Found;
use crate::Robot;
use crate::error::rounded;
use crate::gait::clip::ClockStep;
use crate::robot::Base;
use crate::state::State;

/// Velocities are consistent if they are between these multiples of dq/dt: recordings are noisy.
const FIT: [f64; 2] = [0.55, 1.8];
/// From this correlation on, they count as proportional to dq/dt; noise reaches up to 0.5.
const CORRELATED: f64 = 0.8;
/// From this correlation on, there is so little noise that they must be between these multiples.
const CLEAN: f64 = 0.999;
const FIT_IF_CLEAN: [f64; 2] = [0.95, 1.05];
/// Steps are fine if the squared changes of dq/dt are below this fraction of its squares. In longer ones the mean
/// velocity of two rows is less than dq/dt, by (omega h)^2 / 12 of an oscillation.
const FINE: f64 = 0.1;
/// A coordinate whose mean speed is less may be noise about one that stands \[m/s, rad/s\].
const MOVING: f64 = 0.1;
/// The fewest steps that are compared.
const ENOUGH: usize = 30;
/// A step that differs more from the velocity is a jump \[m/s\] \[rad/s\].
const FASTEST: [f64; 2] = [8.0, 100.0];
/// A step that moves no farther is no jump \[m\] \[rad\].
const NEAR: f64 = 1e-3;
/// Rotated by the pitch, the base's velocity fits better if its squared errors are less than this fraction.
const BETTER: f64 = 0.5;
/// The least error of the base's velocity for which it is said to be in its own frame \[m/s\].
const APART: f64 = 0.01;

/// Observations of the motion.
#[derive(Debug, Clone, Default)]
pub(super) struct Motion {
    /// For each coordinate, sums over the steps of v^2, (dq/dt)^2, their product, and the squared change of dq/dt.
    sums: Vec<[f64; 4]>,
    /// dq/dt of the previous step; empty at the start of a clip.
    rates: Vec<f64>,
    /// Sums of squared differences from dq/dt of the base's velocity, as it is and rotated by the pitch.
    errors: [f64; 2],
    steps: usize,
    /// Rows at which positions stand still while the robot moves, and rows at which positions jump.
    repeats: Found,
    jumps: Found,
    /// Rows of the same time with different positions.
    pairs: Found,
    /// The first coordinate that jumps, and its speed.
    jumped: Option<String>,
    /// Whether the robot moved in the step before, and the time since which it has stood still after that \[s\].
    moved: bool,
    stands_since: Option<f64>,
    /// Positions and velocities of the row before.
    last: [Vec<f64>; 2],
}

impl Motion {
    /// Adds the next row at `time` \[s\]. `is_recorded` is false if its velocity was computed from positions.
    pub fn add(&mut self, state: &State, time: f64, step: ClockStep, is_recorded: bool, robot: &Robot) {
        if let ClockStep::Later(passed) = step {
            let rates: Vec<f64> =
                self.last[0].iter().zip(&state.position).map(|(from, to)| (to - from) / passed).collect();
            let velocities: Vec<f64> = match is_recorded {
                true => self.last[1].iter().zip(&state.velocity).map(|(from, to)| 0.5 * (from + to)).collect(),
                false => vec![0.0; rates.len()],
            };
            self.follow(&rates, &velocities, (time, passed), robot);
            if is_recorded {
                self.compare(&rates, &velocities, 0.5 * passed, state, robot);
            }
        }
        let far = |(from, to): (&f64, &f64)| (to - from).abs() > NEAR;
        if step == ClockStep::Impact && self.last[0].iter().zip(&state.position).any(far) {
            self.pairs.add([time; 2]);
        }
        if step == ClockStep::NewClip {
            (self.moved, self.stands_since) = (false, None);
            self.rates.clear();
        }
        for (last, current) in self.last.iter_mut().zip([&state.position, &state.velocity]) {
            current.clone_into(last);
        }
    }

    /// Looks for rows that repeat the one before and for jumps, in a step of length `passed` that ends at `time` \[s\].
    fn follow(&mut self, rates: &[f64], velocities: &[f64], (time, passed): (f64, f64), robot: &Robot) {
        let moves = rates.iter().any(|rate| rate.abs() > MOVING);
        let stands = rates.iter().all(|rate| *rate == 0.0);
        // A robot that comes to rest repeats its position, too, but does not move on.
        match self.stands_since.take() {
            Some(since) if moves => self.repeats.add([since; 2]),
            since if stands => self.stands_since = since.or(self.moved.then_some(time)),
            _ => {}
        }
        self.moved = moves;
        let jumps = |((&rate, velocity), (unit, _)): ((&f64, &f64), (&str, &str))| {
            let limit = FASTEST[usize::from(unit == "rad")];
            rate.abs().min((rate - velocity).abs()) > limit && rate.abs() * passed > NEAR
        };
        let Some(jumped) = rates.iter().zip(velocities).zip(robot.units()).position(jumps) else { return };
        self.jumps.add([time - passed, time]);
        let name = || robot.coordinates().zip(robot.units()).nth(jumped);
        if let (None, Some((name, (_, unit)))) = (&self.jumped, name()) {
            self.jumped = Some(format!("{name} at {} {unit}", rounded(rates[jumped])));
        }
    }

    /// Compares recorded velocities with positions. The `state` is `half` a step \[s\] after the middle of the step.
    fn compare(&mut self, rates: &[f64], velocities: &[f64], half: f64, state: &State, robot: &Robot) {
        self.sums.resize(rates.len(), [0.0; 4]);
        if self.rates.is_empty() {
            // The first step of a clip has no previous rates, so its change is zero.
            self.rates.extend(rates);
        }
        self.steps += 1;
        let before = self.rates.iter_mut().zip(rates).map(|(before, &rate)| std::mem::replace(before, rate) - rate);
        for ((sums, change), (&rate, &velocity)) in self.sums.iter_mut().zip(before).zip(rates.iter().zip(velocities)) {
            let products = [velocity * velocity, rate * rate, velocity * rate, change * change];
            sums.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
        if let (Base::Floating, &[x, z, turning, ..]) = (robot.base, rates) {
            let (sin, cos) = libm::sincos(state.position[2] - half * turning);
            let turned = [cos * velocities[0] + sin * velocities[1], cos * velocities[1] - sin * velocities[0]];
            for (error, [vx, vz]) in self.errors.iter_mut().zip([[velocities[0], velocities[1]], turned]) {
                *error += (vx - x) * (vx - x) + (vz - z) * (vz - z);
            }
        }
    }

    /// Describes oddities of the motion.
    pub fn notes(&self, robot: &Robot) -> impl Iterator<Item = String> {
        let misfit = self.misfit(robot);
        let repeats = self.repeats.text().map(|when| {
            format!(
                "rows repeat the positions of the row before, although the robot moves, {when}: velocities and touchdowns \
                 next to them may be false; leave such rows out"
            )
        });
        // Velocities in other units are no measure of jumps.
        let jumps = self.jumps.text().zip(self.jumped.as_ref()).filter(|_| misfit.is_none()).map(|(when, jumped)| {
            format!(
                "positions jump {when} ({jumped}): velocities and touchdowns there may be false; leave outliers out, and \
                 let time go back where another trial begins"
            )
        });
        let pairs = self.pairs.text().map(|when| {
            format!(
                "two rows of the same time have different positions {when}: is the time rounded? such rows count as the \
                 states before and after an impact"
            )
        });
        [repeats, jumps, pairs, self.turned(), misfit].into_iter().flatten()
    }

    /// Notes that the base's velocity is in its own axes.
    pub fn turned(&self) -> Option<String> {
        let [given, turned] = self.errors;
        let is_turned = self.steps >= ENOUGH && given > APART * APART * self.steps as f64 && turned < BETTER * given;
        is_turned.then(|| {
            "the base's velocity fits its positions over time if it is turned by the pitch: give it in the world's axes, \
             not the body's"
                .to_owned()
        })
    }

    /// Notes that velocities are not the rates of positions, as with other units or another sign.
    pub fn misfit(&self, robot: &Robot) -> Option<String> {
        let misfit = |(name, &[squared, rates, product, changes]): (&str, &[f64; 4])| {
            let (correlation, factor) = (product / (squared * rates).sqrt(), product / rates);
            let [least, most] = if correlation > CLEAN && changes < FINE * rates { FIT_IF_CLEAN } else { FIT };
            if changes > rates {
                // The poses have no order, or are too far apart for their difference to be a rate.
                None
            } else if squared == 0.0 && rates > MOVING * MOVING * self.steps as f64 {
                Some(format!("{name} is 0 although it moves"))
            } else if correlation < -CORRELATED {
                Some(format!("{name} has the opposite sign of dq/dt"))
            } else if correlation > CORRELATED && !(least..=most).contains(&factor) {
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
