//! Integrates the stiff equations of a compliant impact, from first contact until all contacts are open or at rest.
//!
//! ```text
//! y' = f(y)   from y(0)   until the model has ended, or to the horizon
//! ```
//!
//! Source: Hairer and Wanner, *Solving ODEs II* (1996), section IV.8 (Radau IIA of order 5).

use crate::budget::{ROUNDS, is_spent_after};
use crate::{Error, Reason, Result};
use differential_equations::control::ControlFlag;
use differential_equations::error::Error as IntegrationError;
use differential_equations::interpolate::Interpolation;
use differential_equations::linalg::Matrix;
use differential_equations::methods::ImplicitRungeKutta;
use differential_equations::ode::{ODE, solve_ode};
use differential_equations::solout::Solout;
use differential_equations::solution::Solution;
use nalgebra::DMatrix;

/// The first step, in the model's own time; it is short because the damper's force acts at once.
const FIRST_STEP: f64 = 1e-6;
/// The number of steps after which the integrator gives up.
const MOST_STEPS: usize = 5_000;
/// A run cannot end within this many steps, because every run begins without forces.
const FEWEST_STEPS: usize = 2;

/// Equations of an impact, in units in which times and states are of order one.
pub(super) trait StiffEquations {
    /// Returns f(y), the rates of the state.
    fn rates(&self, state: &[f64]) -> Vec<f64>;

    /// Returns the derivatives of the rates by the state, by forward differences unless the model overrides it.
    fn jacobian(&self, state: &[f64], rates: &[f64]) -> DMatrix<f64> {
        let count = rates.len();
        let mut jacobian = DMatrix::zeros(count, count);
        let mut moved = state.to_vec();
        for (column, &entry) in state[..count].iter().enumerate() {
            let by = f64::EPSILON.sqrt() * entry.abs().max(1.0);
            moved[column] += by;
            for (row, rate) in self.rates(&moved).into_iter().enumerate() {
                jacobian[(row, column)] = (rate - rates[row]) / by;
            }
            moved[column] = entry;
        }
        jacobian
    }

    /// Returns whether nothing more happens from `state` on.
    fn has_ended(&self, state: &[f64]) -> bool;
}

/// The end of a run.
#[derive(Debug, Clone)]
pub(super) struct RunEnd {
    /// The last state.
    pub state: Vec<f64>,
    /// Steps of the integrator, the start included.
    pub steps: usize,
    /// Whether the model had ended; false if the horizon or the budget came first.
    pub ended: bool,
}

/// Integrates from `start` with a relative and an absolute tolerance, to `horizon` in the model's own time. The
/// integrator is compiled for a few lengths of arrays: states that models see, and [`RunEnd::state`], are padded with
/// zeros.
///
/// # Errors
/// Returns [`Reason::Unsupported`] if the integrator gives up, or if the start is longer than the longest array.
pub(super) fn integrate(
    model: &dyn StiffEquations,
    start: &[f64],
    tolerances: [f64; 2],
    horizon: f64,
) -> Result<RunEnd> {
    let integrate = match start.len() {
        0..=4 => integrate_array::<4>,
        5..=8 => integrate_array::<8>,
        9..=16 => integrate_array::<16>,
        17..=40 => integrate_array::<40>,
        41..=128 => integrate_array::<128>,
        _ => {
            let reason = Reason::Unsupported("compliant contact of so large a robot".into());
            return Err(Error::new(reason).hint("hold joints that matter little"));
        }
    };
    integrate(model, start, tolerances, horizon)
}

fn integrate_array<const N: usize>(
    model: &dyn StiffEquations,
    start: &[f64],
    [relative, absolute]: [f64; 2],
    horizon: f64,
) -> Result<RunEnd> {
    // Tolerances are given per entry: version 0.7 applies the power 2/3 to a single tolerance once per entry.
    let mut method =
        ImplicitRungeKutta::radau5().rtol([relative; N]).atol([absolute; N]).h0(FIRST_STEP).max_steps(MOST_STEPS);
    let mut first = [0.0; N];
    first[..start.len()].copy_from_slice(start);
    let mut run = Run { model, end: RunEnd { state: first.to_vec(), steps: 0, ended: false } };
    solve_ode(&mut method, &System(model), 0.0, horizon, &first, &mut run).map_err(|error| gave_up(&error))?;
    Ok(run.end)
}

fn gave_up<const N: usize>(error: &IntegrationError<f64, [f64; N]>) -> Error {
    let why = match error {
        IntegrationError::MaxSteps { .. } => "it takes too many steps",
        IntegrationError::StepSize { .. } => "its steps became too small",
        _ => "its equations have no solution in f64",
    };
    let reason = Reason::Unsupported(format!("the integration of the compliant contact ended early: {why}"));
    Error::new(reason).hint("take another tolerance, or damping and friction that are less extreme")
}

/// A model in the form that the integrator takes.
struct System<'m>(&'m dyn StiffEquations);

impl<const N: usize> ODE<f64, [f64; N]> for System<'_> {
    fn diff(&self, _: f64, state: &[f64; N], rates: &mut [f64; N]) {
        rates.fill(0.0);
        rates.iter_mut().zip(self.0.rates(state)).for_each(|(rate, value)| *rate = value);
    }

    fn jacobian(&self, _: f64, state: &[f64; N], jacobian: &mut Matrix<f64>) {
        let dense = self.0.jacobian(state, &self.0.rates(state));
        for (row, column) in (0..dense.nrows()).flat_map(|row| (0..dense.ncols()).map(move |column| (row, column))) {
            jacobian[(row, column)] = dense[(row, column)];
        }
    }
}

/// Ends a run when its model has ended, and keeps the last state.
struct Run<'m> {
    model: &'m dyn StiffEquations,
    end: RunEnd,
}

impl<const N: usize> Solout<f64, [f64; N]> for Run<'_> {
    fn solout<I: Interpolation<f64, [f64; N]> + ?Sized>(
        &mut self,
        _: f64,
        _: f64,
        state: &[f64; N],
        _: &[f64; N],
        _: &mut I,
        _: &mut Solution<f64, [f64; N]>,
    ) -> ControlFlag<f64, [f64; N]> {
        let steps = self.end.steps + 1;
        self.end = RunEnd { state: state.to_vec(), steps, ended: self.model.has_ended(state) };
        let ends = self.end.ended && steps > FEWEST_STEPS || is_spent_after(ROUNDS);
        if ends { ControlFlag::Terminate } else { ControlFlag::Continue }
    }
}
