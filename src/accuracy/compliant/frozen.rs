//! Compliant contact through an impact while the robot's configuration stands still.
//!
//! ```text
//!     L' = lambda     delta' = -c_n     s' = -(lambda_t + k_t s) / d_t          c = c- + G L
//!     lambda_n = max(0, k_n delta - d_n c_n) where delta >= 0, else 0           Kelvin-Voigt without tension
//!     lambda_t = -k_t s - d_t c_t, kept within -+mu lambda_n                    spring and damper in a row with friction
//! ```
//!
//! delta is the depth of a contact and s the stretch of its tangential spring; both start at zero. With times and lengths in
//! units of 1/sqrt(k_n) nothing of the result depends on k_n: stiffness alone changes nothing, damping and ratios do.
//! Source: Brogliato, *Nonsmooth Mechanics* (2016), section 2.1.

use super::integrate::{End, Equations, Limits, integrate};
use crate::impact::ContactProblem;
use crate::law::Friction;
use crate::planar::Vector;
use crate::{Reason, Result};
use differential_equations::linalg::Matrix;
use differential_equations::ode::ODE;

/// The ground's parameters that matter while the configuration stands still, the same for all contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// d_n / (2 sqrt(k_n m)), m the inverse of the contacts' mean mobility; infinite where the spring plays no part.
    pub damping_ratio: f64,
    /// k_t / k_n.
    pub stiffness_ratio: f64,
    /// d_t / d_n.
    pub tangential_damping: f64,
}

/// What stands for infinite friction: a spring and damper need a normal force to be held by.
pub const GREATEST_FRICTION: f64 = 1e6;

/// Relative tolerance of the integration, unless another one is asked for.
pub const TOLERANCE: f64 = 1e-10;

/// Where a run ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Impulse of each contact, [tangential, normal] \[N s\].
    pub impulse: Vec<Vector<f64>>,
    /// Contact velocities after it, [tangential, normal] \[m/s\].
    pub velocity_after: Vec<Vector<f64>>,
    /// Steps of the integrator.
    pub steps: usize,
    /// Whether all contacts came free or to rest; false where the run was cut off before.
    pub ended: bool,
}

/// Integrates through the impact; the restitution of `problem` has no part in it.
///
/// # Errors
/// [`Reason::Unsupported`] where the integrator gives up.
pub fn run(problem: &ContactProblem, ground: Ground, tolerance: f64) -> Result<Run> {
    let model = Model::new(problem, ground);
    // The integrator takes arrays alone; what is over stays zero.
    let (state, steps, ended) = match model.contacts {
        0 | 1 => model.integrate::<4>(tolerance),
        2 => model.integrate::<8>(tolerance),
        3 | 4 => model.integrate::<16>(tolerance),
        5..=10 => model.integrate::<40>(tolerance),
        contacts => return Err(Reason::TooManyContacts { contacts, limit: 10 }.into()),
    }?;
    let impulse = |i: usize| [0, 1].map(|k| state[2 * i + k] * model.speed / model.mean_mobility);
    let after = model.velocity(&state).into_iter().map(|c| c.map(|entry| entry * model.speed));
    Ok(Run { impulse: (0..model.contacts).map(impulse).collect(), velocity_after: after.collect(), steps, ended })
}

/// The longest run, in the model's own time.
const HORIZON: f64 = 1e9;
/// Forces and approaches of less than this part of the first ones change nothing any more.
const SETTLED: f64 = 1e-10;

/// The equations in units in which k_n (or d_n, where there is no k_n), the mean mobility and the greatest speed are one.
#[derive(Debug)]
struct Model {
    contacts: usize,
    /// G, 2n x 2n.
    mobility: Vec<f64>,
    /// c-.
    free: Vec<Vector<f64>>,
    friction: Vec<f64>,
    stiffness: Vector<f64>,
    damping: Vector<f64>,
    /// Greatest speed of a contact \[m/s\].
    speed: f64,
    /// Geometric mean of the contacts' G_nn \[1/kg\].
    mean_mobility: f64,
}

/// What a contact does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Phase {
    Open,
    Held,
    /// Friction has the sign of the number and its greatest magnitude.
    Slipping(f64),
}

impl Model {
    fn new(problem: &ContactProblem, ground: Ground) -> Self {
        let contacts = problem.contacts();
        let rows = 2 * contacts;
        let speeds = problem.velocity_free().iter().flatten();
        let speed = speeds.fold(0.0, |speed: f64, entry| speed.max(entry.abs()));
        let normal = (0..contacts).map(|i| problem.delassus(2 * i + 1, 2 * i + 1).ln());
        let mean_mobility = (normal.sum::<f64>() / contacts.max(1) as f64).exp();
        let spring = f64::from(u8::from(ground.damping_ratio.is_finite()));
        let damper = if ground.damping_ratio.is_finite() { 2.0 * ground.damping_ratio } else { 1.0 };
        Self {
            contacts,
            mobility: (0..rows * rows).map(|at| problem.delassus(at / rows, at % rows) / mean_mobility).collect(),
            free: problem.velocity_free().iter().map(|c| c.map(|entry| entry / speed)).collect(),
            friction: problem
                .friction()
                .map(|friction| match friction {
                    Friction::Finite(mu) => mu.min(GREATEST_FRICTION),
                    Friction::Infinite => GREATEST_FRICTION,
                })
                .collect(),
            stiffness: [ground.stiffness_ratio * spring, spring],
            damping: [ground.tangential_damping * damper, damper],
            speed,
            mean_mobility,
        }
    }

    /// The last state, the number of steps, and whether it is an end.
    fn integrate<const N: usize>(&self, tolerance: f64) -> Result<(Vec<f64>, usize, bool)> {
        let start = [0.0; N];
        if self.speed == 0.0 {
            return Ok((start.to_vec(), 0, true));
        }
        let limits = Limits { relative: tolerance, absolute: 0.01 * tolerance, horizon: HORIZON };
        let End { state, steps, ended } = integrate(self, start, limits)?;
        Ok((state.to_vec(), steps, ended))
    }

    /// c = c- + G L, from the impulses in `state`: `scale` is 1, or 0 for the linear part alone.
    fn velocity_scaled(&self, state: &[f64], scale: f64) -> Vec<Vector<f64>> {
        let rows = 2 * self.contacts;
        let row = |row: usize| {
            let change: f64 = (0..rows).map(|column| self.mobility[row * rows + column] * state[column]).sum();
            scale * self.free[row / 2][row % 2] + change
        };
        (0..self.contacts).map(|i| [row(2 * i), row(2 * i + 1)]).collect()
    }

    fn velocity(&self, state: &[f64]) -> Vec<Vector<f64>> {
        self.velocity_scaled(state, 1.0)
    }

    /// Spring and damper of a contact, [tangential, normal], as if both held.
    fn pull(&self, state: &[f64], contact: usize, c: Vector<f64>) -> Vector<f64> {
        let (depth, stretch) = (state[2 * self.contacts + contact], state[3 * self.contacts + contact]);
        [-self.stiffness[0] * stretch - self.damping[0] * c[0], self.stiffness[1] * depth - self.damping[1] * c[1]]
    }

    fn phase(&self, state: &[f64], contact: usize, c: Vector<f64>) -> Phase {
        let [tangential, normal] = self.pull(state, contact, c);
        if state[2 * self.contacts + contact] < 0.0 || normal <= 0.0 {
            Phase::Open
        } else if tangential.abs() <= self.friction[contact] * normal {
            Phase::Held
        } else {
            Phase::Slipping(tangential.signum())
        }
    }

    fn force(&self, state: &[f64], contact: usize, c: Vector<f64>, phase: Phase) -> Vector<f64> {
        let [tangential, normal] = self.pull(state, contact, c);
        match phase {
            Phase::Open => [0.0; 2],
            Phase::Held => [tangential, normal],
            Phase::Slipping(sign) => [sign * self.friction[contact] * normal, normal],
        }
    }

    /// Rates of a state, which are linear in it and in `scale` while no contact changes its phase.
    fn rates(&self, state: &[f64], velocity: &[Vector<f64>], phases: &[Phase], rates: &mut [f64]) {
        let n = self.contacts;
        for contact in 0..n {
            let c = velocity[contact];
            let force = self.force(state, contact, c, phases[contact]);
            rates[2 * contact..2 * contact + 2].copy_from_slice(&force);
            rates[2 * n + contact] = -c[1];
            // What the damper in the row with friction carries moves the spring; the rest is slip.
            rates[3 * n + contact] = -(force[0] + self.stiffness[0] * state[3 * n + contact]) / self.damping[0];
        }
    }

    fn phases(&self, state: &[f64], velocity: &[Vector<f64>]) -> Vec<Phase> {
        (0..self.contacts).map(|contact| self.phase(state, contact, velocity[contact])).collect()
    }
}

impl<const N: usize> ODE<f64, [f64; N]> for Model {
    fn diff(&self, _: f64, state: &[f64; N], rates: &mut [f64; N]) {
        let velocity = self.velocity(state);
        let phases = self.phases(state, &velocity);
        self.rates(state, &velocity, &phases, rates);
    }

    fn jacobian(&self, _: f64, state: &[f64; N], jacobian: &mut Matrix<f64>) {
        let phases = self.phases(state, &self.velocity(state));
        let (mut unit, mut rates) = ([0.0; N], [0.0; N]);
        for column in 0..4 * self.contacts {
            unit[column] = 1.0;
            self.rates(&unit, &self.velocity_scaled(&unit, 0.0), &phases, &mut rates);
            unit[column] = 0.0;
            rates.iter().enumerate().for_each(|(row, &rate)| jacobian[(row, column)] = rate);
        }
    }
}

impl<const N: usize> Equations<N> for Model {
    /// Whether all contacts are free or at rest.
    fn has_ended(&self, state: &[f64; N]) -> bool {
        let velocity = self.velocity(state);
        let phases = self.phases(state, &velocity);
        (0..self.contacts).all(|contact| {
            let force = self.force(state, contact, velocity[contact], phases[contact]);
            let pushed = force.iter().any(|entry| entry.abs() > SETTLED * self.damping[1]);
            // A contact in the air that comes down strikes again.
            !pushed && velocity[contact][1] >= -SETTLED.sqrt()
        })
    }
}
