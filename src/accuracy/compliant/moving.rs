//! Compliant contact through an impact while the robot moves: how much a finite stiffness differs from the frozen
//! limit.
//!
//! ```text
//!     M(q) v' + h(q, v) = J(q)^T lambda,   delta = depth of the contact point,   lambda and s as in the frozen model
//! ```
//!
//! h contains Coriolis and centrifugal forces, but no gravity, which exerts no impulse and would keep feet on the
//! ground until the longest run ends. The impact lasts some multiple of sqrt(m / k_n), so that the difference from the
//! frozen model falls with 1 / sqrt(k_n).

use super::ground::{SoftGround, Suspension, mean_mobility};
use super::integrate::{StiffEquations, integrate};
use crate::Result;
use crate::contact::Placement;
use crate::impact::ContactProblem;
use crate::pipeline::assembly::{Assembly, Elimination, Loads};
use crate::pipeline::exact::ExactState;
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::state::Scene;
use std::cell::RefCell;

/// The duration of the longest run, in units of sqrt(m / k_n) (1 + damping ratio); m is the inverse of the contacts'
/// mean mobility.
const HORIZON: f64 = 1e2;

/// Forces and speeds below this part of those at which contacts close count as zero.
const NOTHING: f64 = 1e-8;

/// Finer than the difference that remains at a stiffness of 1e12 N/m.
const TOLERANCE: f64 = 1e-9;

/// Returns v \[m/s, rad/s\] when all contacts have opened, or after the longest run, on a ground of `stiffness` k_n
/// \[N/m\]. `assembly` holds the closed contacts, and `velocity` is v just before they strike.
///
/// # Errors
/// Returns [`Reason::Unsupported`](crate::Reason::Unsupported) if the integrator gives up, or if twice the number of
/// coordinates plus the number of contacts exceeds 128.
pub(super) fn run(
    state: &ExactState,
    (assembly, velocity): (&Assembly, &[f64]),
    problem: &ContactProblem,
    ground: SoftGround,
    stiffness: f64,
) -> Result<Vec<f64>> {
    let mut assembly = assembly.clone();
    move_to(&mut assembly, state.position, velocity);
    assembly.delassus();
    let contacts = assembly.points.len();
    let mobility = |row: usize, column: usize| assembly.workspace.delassus[row * 2 * contacts + column];
    let mean_mobility = mean_mobility(mobility, contacts);
    let damping = 2.0 * ground.damping_ratio * (stiffness / mean_mobility).sqrt();
    let speed = velocity.iter().fold(f64::MIN_POSITIVE, |speed: f64, rate| speed.max(rate.abs()));
    let model = Equation {
        robot: state.robot,
        position: state.position,
        suspension: Suspension::new(ground, stiffness, damping, problem.friction()),
        start: places(&assembly, Vector::zero()),
        mean_mobility,
        period: (1.0 / (stiffness * mean_mobility)).sqrt(),
        speed,
        closing: assembly.workspace.contact_velocity.iter().fold(0.0, |most: f64, c| most.max(-c[1])),
        assembly: RefCell::new(assembly),
    };
    let dofs = velocity.len();
    let mut start = vec![0.0; 2 * dofs + contacts];
    start[dofs..].iter_mut().zip(velocity).for_each(|(entry, rate)| *entry = rate / speed);
    let end = integrate(&model, &start, [TOLERANCE; 2], HORIZON * (1.0 + ground.damping_ratio))?;
    Ok(end.state[dofs..2 * dofs].iter().map(|rate| rate * speed).collect())
}

/// The equation of motion. A state holds the change of q since the start, then v, then the stretches of the tangential
/// springs, in units of `period` and `speed`, in which all of them are of order one.
#[derive(Debug)]
struct Equation<'a> {
    robot: &'a Robot,
    /// q at the start \[m, rad\].
    position: &'a [f64],
    suspension: Suspension,
    /// The contact points at the start.
    start: Vec<Vector<f64>>,
    /// 1 / m \[1/kg\].
    mean_mobility: f64,
    /// sqrt(m / k_n) \[s\].
    period: f64,
    /// The greatest magnitude in v at the start.
    speed: f64,
    /// The greatest speed at which a contact approaches the ground at the start \[m/s\].
    closing: f64,
    /// The dynamics, at the state that was evaluated last.
    assembly: RefCell<Assembly>,
}

/// Computes everything that the equation of motion needs at q and v.
fn move_to(assembly: &mut Assembly, position: &[f64], velocity: &[f64]) {
    assembly.configuration.set(&assembly.plan, position);
    assembly.place();
    assembly.factorize();
    assembly.contact_jacobian(velocity, None);
}

/// Returns the contact points, with the root's origin at `base`.
fn places(assembly: &Assembly, base: Vector<f64>) -> Vec<Vector<f64>> {
    let placement = Placement::new(&assembly.plan, &assembly.workspace, base);
    let place = |body| placement.world(body, Vector::zero());
    assembly.points.iter().map(|point| place(point.body) + point.arm(&assembly.workspace)).collect()
}

impl Equation<'_> {
    /// Returns the rates of the state, and for each contact its normal force and normal velocity.
    fn evaluate(&self, state: &[f64]) -> (Vec<f64>, Vec<Pair<f64>>) {
        let dofs = self.position.len();
        let length = self.speed * self.period;
        let moved: Vec<f64> = state[..dofs].iter().map(|entry| entry * length).collect();
        let velocity: Vec<f64> = state[dofs..2 * dofs].iter().map(|entry| entry * self.speed).collect();
        let assembly = &mut *self.assembly.borrow_mut();
        let position: Vec<f64> = self.position.iter().zip(&moved).map(|(q, moved)| q + moved).collect();
        move_to(assembly, &position, &velocity);

        let scene = Scene { gravity: Some(0.0), ..Scene::default() };
        let loads = Loads { robot: self.robot, scene: &scene, position: &position, steady: &[] };
        let (mut accelerations, _) = assembly.acceleration(&velocity, loads);
        let base = if assembly.plan.floating { Vector::new(moved[0], moved[1]) } else { Vector::zero() };
        let mut touching = Vec::with_capacity(self.start.len());
        let mut stretches = Vec::with_capacity(self.start.len());
        for (index, (start, place)) in self.start.iter().zip(places(assembly, base)).enumerate() {
            let [_, up] = assembly.points[index].axes();
            let c = assembly.workspace.contact_velocity[index];
            let depth = up.dot(*start - place);
            let (force, stretch) = self.suspension.force(index, depth, state[2 * dofs + index] * length, c);
            assembly.add_contact_impulse(Elimination::Ltl, index, force, &mut accelerations);
            stretches.push(stretch / self.speed);
            touching.push([force[1], c[1]]);
        }
        let accelerations = accelerations.iter().map(|acceleration| acceleration * self.period / self.speed);
        let rates = state[dofs..2 * dofs].iter().copied().chain(accelerations).chain(stretches).collect();
        (rates, touching)
    }
}

impl StiffEquations for Equation<'_> {
    fn rates(&self, state: &[f64]) -> Vec<f64> {
        self.evaluate(state).0
    }

    /// Returns whether all contacts are open, or practically at rest without a force.
    fn has_ended(&self, state: &[f64]) -> bool {
        let force = self.closing / (self.mean_mobility * self.period);
        let touching = self.evaluate(state).1;
        touching.iter().all(|&[normal, speed]| normal <= NOTHING * force && speed >= -NOTHING * self.closing)
    }
}
