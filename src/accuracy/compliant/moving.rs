//! Compliant contact through an impact while the robot moves: what of the frozen limit is left at a finite stiffness.
//!
//! ```text
//!     M(q) v' + h(q, v) = J(q)^T lambda,   delta = depth of the contact point,   lambda and s as in the frozen model
//! ```
//!
//! h holds gravity, Coriolis and centrifugal forces. The impact lasts some multiple of sqrt(m / k_n), so that the
//! difference from the frozen model falls with 1 / sqrt(k_n).

use super::ground::{SoftGround, Suspension, mean_mobility};
use super::integrate::{Limits, StiffEquations, integrate};
use crate::Result;
use crate::contact::Placement;
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{
    ContactPoint, PointImpulse, Workspace, add_impulse, bias, contact_jacobian, delassus, factorize, kinematics,
    mass_matrix,
};
use crate::law::Friction;
use crate::planar::{Pair, Vector};
use std::cell::RefCell;

/// Downward, as everywhere on Earth \[m/s^2\].
const GRAVITY: f64 = 9.81;
/// The longest run, in units of sqrt(m / k_n) (1 + damping ratio).
const HORIZON: f64 = 1e2;

/// A robot just before it strikes, ready to be integrated.
#[derive(Debug)]
pub struct Moving<'a> {
    /// The robot.
    pub plan: &'a Plan,
    /// q \[m, rad\].
    pub position: &'a [f64],
    /// v \[m/s, rad/s\].
    pub velocity: &'a [f64],
    /// The closed contacts.
    pub contacts: &'a [ContactPoint],
    /// Friction of each contact.
    pub friction: &'a [Friction],
}

impl Moving<'_> {
    /// v when all contacts have come free, or after the longest run, on a ground of `stiffness` k_n \[N/m\].
    ///
    /// # Errors
    /// [`Reason::Unsupported`](crate::Reason::Unsupported) if the integrator gives up, and for robots of more than 60
    /// coordinates and contacts.
    pub fn run(&self, ground: SoftGround, stiffness: f64, tolerance: f64) -> Result<Vec<f64>> {
        let dofs = self.position.len();
        let model = Equation::new(self, ground, stiffness);
        let mut start = vec![0.0; 2 * dofs + self.contacts.len()];
        for (entry, rate) in start[dofs..].iter_mut().zip(self.velocity) {
            *entry = rate / model.speed;
        }
        let horizon = HORIZON * (1.0 + ground.damping_ratio);
        let end = integrate(&model, &start, Limits { relative: tolerance, absolute: tolerance, horizon })?;
        Ok(end.state[dofs..2 * dofs].iter().map(|rate| rate * model.speed).collect())
    }
}

/// The equation of motion. A state holds what q has changed by, then v and the stretches, in units of `period` and
/// `speed`, in which all of them are of order one.
#[derive(Debug)]
struct Equation<'a> {
    robot: &'a Moving<'a>,
    suspension: Suspension,
    /// The contact points at first.
    start: Vec<Vector<f64>>,
    /// sqrt(m / k_n), m the inverse of the contacts' mean mobility \[s\].
    period: f64,
    /// The greatest rate.
    speed: f64,
    memory: RefCell<Memory>,
}

#[derive(Debug, Default)]
struct Memory {
    workspace: Workspace,
    configuration: Configuration,
    column: Vec<f64>,
}

impl Memory {
    /// Everything that the equation of motion needs at q and v.
    fn move_to(&mut self, robot: &Moving, position: &[f64], velocity: &[f64]) {
        let Self { workspace, configuration, .. } = self;
        configuration.set(robot.plan, position);
        kinematics(robot.plan, configuration, workspace);
        mass_matrix(robot.plan, workspace);
        factorize(robot.plan, workspace);
        contact_jacobian(robot.plan, robot.contacts, velocity, None, workspace);
    }
}

impl<'a> Equation<'a> {
    fn new(robot: &'a Moving<'a>, ground: SoftGround, stiffness: f64) -> Self {
        let mut memory = Memory::default();
        memory.move_to(robot, robot.position, robot.velocity);
        let workspace = &mut memory.workspace;
        delassus(robot.plan, workspace);
        let contacts = robot.contacts.len();
        let mean_mobility = mean_mobility(|row, column| workspace.delassus[row * 2 * contacts + column], contacts);
        let damping = 2.0 * ground.damping_ratio * (stiffness / mean_mobility).sqrt();
        let placement = Placement::new(robot.plan, workspace, Vector::zero());
        let points = robot.contacts.iter().map(|contact| place(contact, &placement, workspace));
        Self {
            suspension: Suspension::new(ground, stiffness, damping, robot.friction.iter().copied()),
            start: points.collect(),
            period: (1.0 / (stiffness * mean_mobility)).sqrt(),
            speed: robot.velocity.iter().fold(f64::MIN_POSITIVE, |speed: f64, rate| speed.max(rate.abs())),
            memory: RefCell::new(memory),
            robot,
        }
    }

    /// Rates of the state, and for each contact its normal force and speed.
    fn evaluate(&self, state: &[f64]) -> (Vec<f64>, Vec<Pair<f64>>) {
        let Moving { plan, position, contacts, .. } = *self.robot;
        let dofs = position.len();
        let length = self.speed * self.period;
        let moved: Vec<f64> = state[..dofs].iter().map(|entry| entry * length).collect();
        let velocity: Vec<f64> = state[dofs..2 * dofs].iter().map(|entry| entry * self.speed).collect();
        let memory = &mut *self.memory.borrow_mut();
        let position: Vec<f64> = position.iter().zip(&moved).map(|(q, moved)| q + moved).collect();
        memory.move_to(self.robot, &position, &velocity);
        let Memory { workspace, column, .. } = memory;

        bias(plan, &velocity, GRAVITY, workspace);
        let mut free = workspace.bias.clone();
        workspace.factor.solve(plan, &mut free);
        let mut accelerations = vec![0.0; dofs];
        plan.coordinates.iter().zip(&free).for_each(|(&coordinate, own)| accelerations[coordinate] = -own);
        let base = if plan.floating { Vector::new(moved[0], moved[1]) } else { Vector::zero() };
        let placement = Placement::new(plan, workspace, base);
        let mut touching = Vec::with_capacity(contacts.len());
        let mut stretches = Vec::with_capacity(contacts.len());
        for (index, contact) in contacts.iter().enumerate() {
            let axes = contact.axes();
            let c = workspace.contact_velocity[index];
            let depth = axes[1].dot(self.start[index] - place(contact, &placement, workspace));
            let ([tangential, normal], stretch) =
                self.suspension.force(index, depth, state[2 * dofs + index] * length, c);
            let force = axes[0] * tangential + axes[1] * normal;
            let force = PointImpulse { body: contact.body, arm: contact.arm(workspace), vector: force };
            add_impulse(plan, workspace, force, column, &mut accelerations);
            stretches.push(stretch / self.speed);
            touching.push([normal, c[1]]);
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

    /// Whether all contacts are free.
    fn has_ended(&self, state: &[f64]) -> bool {
        self.evaluate(state).1.iter().all(|&[normal, speed]| normal == 0.0 && speed >= 0.0)
    }
}

/// A contact point.
fn place(contact: &ContactPoint, placement: &Placement, workspace: &Workspace) -> Vector<f64> {
    placement.world(contact.body, Vector::zero()) + contact.arm(workspace)
}
