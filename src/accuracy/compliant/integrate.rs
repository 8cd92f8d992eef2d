//! An impact's equations through time, from its first moment until nothing more happens.
//!
//! ```text
//!     y' = f(y)   from y(0)   until the model has ended, or the horizon
//! ```
//!
//! Source: Hairer and Wanner, *Solving ODEs II* (1996), section IV.8 (Radau IIA of order 5).

use crate::{Error, Reason, Result};
use differential_equations::control::ControlFlag;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::ImplicitRungeKutta;
use differential_equations::ode::{ODE, solve_ode};
use differential_equations::solout::Solout;
use differential_equations::solution::Solution;

/// The first step, in the model's own time: the damper's force is there at once.
const FIRST_STEP: f64 = 1e-6;
/// Steps after which a run is given up.
const MOST_STEPS: usize = 5_000;
/// Steps before which no run has ended: all begin without forces.
const FEWEST_STEPS: usize = 2;

/// Equations of an impact in units in which times and states are of order one.
pub(super) trait Equations<const N: usize>: ODE<f64, [f64; N]> {
    /// Whether nothing more happens from `state` on.
    fn has_ended(&self, state: &[f64; N]) -> bool;
}

/// Where a run came to.
#[derive(Debug, Clone, Copy)]
pub(super) struct End<const N: usize> {
    /// The last state.
    pub state: [f64; N],
    /// Steps of the integrator.
    pub steps: usize,
    /// Whether it ended before the horizon.
    pub ended: bool,
}

/// How well and how long to integrate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Relative tolerance.
    pub relative: f64,
    /// Absolute tolerance of every entry.
    pub absolute: f64,
    /// The longest run, in the model's own time.
    pub horizon: f64,
}

/// Integrates from `start`.
///
/// # Errors
/// [`Reason::Unsupported`] where the integrator gives up.
pub(super) fn integrate<M: Equations<N>, const N: usize>(model: &M, start: [f64; N], limits: Limits) -> Result<End<N>> {
    let Limits { relative, absolute, horizon } = limits;
    // One tolerance for each entry: of a single one version 0.7 takes the power 2/3 once per entry.
    let mut method =
        ImplicitRungeKutta::radau5().rtol([relative; N]).atol([absolute; N]).h0(FIRST_STEP).max_steps(MOST_STEPS);
    let mut watch = Watch { model, end: End { state: start, steps: 0, ended: false } };
    solve_ode(&mut method, model, 0.0, horizon, &start, &mut watch).map_err(|error| gave_up(&error))?;
    Ok(watch.end)
}

/// The refusal of what the integrator could not go through.
fn gave_up(error: &impl std::fmt::Debug) -> Error {
    let why: String =
        format!("the integration of the compliant contact ended early: {error:?}").chars().take(200).collect();
    Error::new(Reason::Unsupported(why)).hint("take another tolerance, or damping and friction that are less extreme")
}

/// Ends a run with its model, and keeps the last state.
struct Watch<'m, M, const N: usize> {
    model: &'m M,
    end: End<N>,
}

impl<M: Equations<N>, const N: usize> Solout<f64, [f64; N]> for Watch<'_, M, N> {
    fn solout<I: Interpolation<f64, [f64; N]> + ?Sized>(
        &mut self,
        _: f64,
        _: f64,
        state: &[f64; N],
        _: &[f64; N],
        _: &mut I,
        _: &mut Solution<f64, [f64; N]>,
    ) -> ControlFlag<f64, [f64; N]> {
        self.end.steps += 1;
        self.end.state = *state;
        self.end.ended = self.model.has_ended(state);
        if self.end.ended && self.end.steps > FEWEST_STEPS { ControlFlag::Terminate } else { ControlFlag::Continue }
    }
}
