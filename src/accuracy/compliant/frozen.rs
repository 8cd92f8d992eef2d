//! Compliant contact through an impact while the robot's configuration is frozen.
//!
//! ```text
//! L' = lambda     delta' = -c_n     s' as in ground.rs     c = c_free + G L
//! ```
//!
//! With times and lengths in units of 1/sqrt(k_n), the result does not depend on k_n: stiffness alone changes nothing,
//! but damping and ratios do.

use super::ground::{SoftGround, Suspension, mean_mobility};
use super::integrate::{StiffEquations, integrate};
use crate::impact::ContactProblem;
use crate::planar::Pair;
use crate::{Reason, Result};
use nalgebra::DMatrix;

/// The relative tolerance of the integration, unless the caller gives another one.
pub const TOLERANCE: f64 = 1e-10;

/// The end of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct CompliantRun {
    /// Impulse of each contact, [tangential, normal] \[N s\].
    pub impulse: Vec<Pair<f64>>,
    /// Contact velocities after the impact, [tangential, normal] \[m/s\].
    pub velocity_after: Vec<Pair<f64>>,
    /// Steps of the integrator.
    pub steps: usize,
    /// Whether all contacts opened or came to rest; false for a run that was cut off before.
    pub ended: bool,
}

/// The greatest number of contacts of a run.
const MOST_CONTACTS: usize = 10;
/// The duration of the longest run, in the model's own time.
const HORIZON: f64 = 1e9;
/// Forces below this part of the first ones, and approach speeds below the root of this part, count as zero.
const SETTLED: f64 = 1e-10;

/// Integrates through the impact; the restitution of `problem` is not used.
///
/// # Errors
/// Returns an error for more than ten contacts and for a `ground` out of range, and [`Reason::Unsupported`] if the
/// integrator gives up.
pub fn run(problem: &ContactProblem, ground: SoftGround, tolerance: f64) -> Result<CompliantRun> {
    ground.check()?;
    let contacts = problem.contacts();
    if contacts > MOST_CONTACTS {
        return Err(Reason::TooManyContacts { contacts, limit: MOST_CONTACTS }.into());
    }
    let speeds = problem.velocity_free().iter().flatten();
    let speed = speeds.fold(0.0, |speed: f64, entry| speed.max(entry.abs()));
    if speed == 0.0 {
        let still = vec![[0.0; 2]; contacts];
        return Ok(CompliantRun { impulse: still.clone(), velocity_after: still, steps: 0, ended: true });
    }
    let mean_mobility = mean_mobility(|row, column| problem.delassus(row, column), contacts);
    let (spring, damper) =
        if ground.damping_ratio.is_finite() { (1.0, 2.0 * ground.damping_ratio) } else { (0.0, 1.0) };
    let rows = 2 * contacts;
    let model = Frozen {
        mobility: (0..rows * rows).map(|at| problem.delassus(at / rows, at % rows) / mean_mobility).collect(),
        free: problem.velocity_free().iter().map(|c| c.map(|entry| entry / speed)).collect(),
        suspension: Suspension::new(ground, spring, damper, problem.friction()),
    };
    let end = integrate(&model, &vec![0.0; 4 * contacts], [tolerance, 0.01 * tolerance], HORIZON)?;
    let impulse = |i: usize| [0, 1].map(|k| end.state[2 * i + k] * speed / mean_mobility);
    Ok(CompliantRun {
        impulse: (0..contacts).map(impulse).collect(),
        velocity_after: model.velocity(&end.state).into_iter().map(|c| c.map(|entry| entry * speed)).collect(),
        steps: end.steps,
        ended: end.ended,
    })
}

/// The equations in units in which the mean mobility, the greatest speed, and k_n (or d_n if k_n is zero) are one. A
/// state holds the impulses of all contacts, then their depths, then their stretches.
#[derive(Debug)]
struct Frozen {
    /// G (2n x 2n).
    mobility: Vec<f64>,
    /// c_free.
    free: Vec<Pair<f64>>,
    suspension: Suspension,
}

impl Frozen {
    fn velocity(&self, state: &[f64]) -> Vec<Pair<f64>> {
        let rows = 2 * self.free.len();
        let change = |row: usize| -> f64 { (0..rows).map(|at| self.mobility[row * rows + at] * state[at]).sum() };
        self.free.iter().enumerate().map(|(i, c)| [c[0] + change(2 * i), c[1] + change(2 * i + 1)]).collect()
    }

    /// Returns the force on each contact and the rate of its stretch.
    fn forces(&self, state: &[f64], velocity: &[Pair<f64>]) -> Vec<(Pair<f64>, f64)> {
        let (depths, stretches) = state[2 * velocity.len()..].split_at(velocity.len());
        let force = |(i, c): (usize, &Pair<f64>)| self.suspension.force(i, depths[i], stretches[i], *c);
        velocity.iter().enumerate().map(force).collect()
    }
}

impl StiffEquations for Frozen {
    fn rates(&self, state: &[f64]) -> Vec<f64> {
        let velocity = self.velocity(state);
        let forces = self.forces(state, &velocity);
        let depths = velocity.iter().map(|c| -c[1]);
        forces.iter().flat_map(|(force, _)| *force).chain(depths).chain(forces.iter().map(|(_, rate)| *rate)).collect()
    }

    fn jacobian(&self, state: &[f64], _: &[f64]) -> DMatrix<f64> {
        let n = self.free.len();
        let mut jacobian = DMatrix::zeros(4 * n, 4 * n);
        for (i, c) in self.velocity(state).into_iter().enumerate() {
            let parts = self.suspension.force_derivatives(i, state[2 * n + i], state[3 * n + i], c);
            for (axis, [by_depth, by_stretch, by_slip, by_approach]) in parts.into_iter().enumerate() {
                for at in 0..2 * n {
                    let [slip, approach] = [2 * i, 2 * i + 1].map(|row| self.mobility[row * 2 * n + at]);
                    jacobian[(2 * i + axis, at)] = by_slip * slip + by_approach * approach;
                    jacobian[(2 * n + i, at)] = -approach;
                }
                jacobian[(2 * i + axis, 2 * n + i)] = by_depth;
                jacobian[(2 * i + axis, 3 * n + i)] = by_stretch;
            }
            for at in 0..4 * n {
                let by_itself = f64::from(at == 3 * n + i);
                jacobian[(3 * n + i, at)] = self.suspension.stretch_rate(jacobian[(2 * i, at)], by_itself);
            }
        }
        jacobian
    }

    /// Returns whether all contacts are open or at rest.
    fn has_ended(&self, state: &[f64]) -> bool {
        let velocity = self.velocity(state);
        let settled = SETTLED * self.suspension.damping[1];
        let pushed =
            self.forces(state, &velocity).iter().any(|(force, _)| force.iter().any(|part| part.abs() > settled));
        // An open contact that approaches the ground strikes again.
        !pushed && velocity.iter().all(|c| c[1] >= -SETTLED.sqrt())
    }
}
