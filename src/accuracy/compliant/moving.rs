//! Compliant contact through an impact while the robot moves: what of the frozen limit is left at a finite stiffness.
//!
//! ```text
//!     M(q) v' + h(q, v) = J(q)^T lambda,     delta = depth of the contact point,     lambda and s as in the frozen model
//! ```
//!
//! h holds gravity, Coriolis and centrifugal forces. The impact lasts some multiple of sqrt(m / k_n), so that the difference
//! from the frozen model falls with 1 / sqrt(k_n).

use super::frozen::{GREATEST_FRICTION, Ground};
use super::integrate::{Equations, Limits, integrate};
use crate::Result;
use crate::dynamics::plan::{Motion, Plan, Posture};
use crate::dynamics::{
    ContactPoint, Workspace, add_impulse, contact_jacobian, delassus, factorize, kinematics, mass_matrix,
};
use crate::law::Friction;
use crate::planar::{Vector, difference, dot, scaled, sum, turned};
use crate::{Error, Reason};
use differential_equations::ode::ODE;
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
    /// [`Reason::Unsupported`] where the integrator gives up, and for robots of more than 60 coordinates and contacts.
    pub fn run(&self, ground: Ground, stiffness: f64, tolerance: f64) -> Result<Vec<f64>> {
        match 2 * self.position.len() + self.contacts.len() {
            0..=16 => self.integrate::<16>(ground, stiffness, tolerance),
            17..=32 => self.integrate::<32>(ground, stiffness, tolerance),
            33..=64 => self.integrate::<64>(ground, stiffness, tolerance),
            65..=128 => self.integrate::<128>(ground, stiffness, tolerance),
            _ => Err(Error::new(Reason::Unsupported("compliant contact of so large a robot".into()))
                .hint("hold joints that matter little")),
        }
    }

    fn integrate<const N: usize>(&self, ground: Ground, stiffness: f64, tolerance: f64) -> Result<Vec<f64>> {
        let model = Model::new(self, ground, stiffness);
        let dofs = self.position.len();
        let mut start = [0.0; N];
        for (entry, rate) in start[dofs..].iter_mut().zip(self.velocity) {
            *entry = rate / model.speed;
        }
        let horizon = HORIZON * (1.0 + ground.damping_ratio);
        let end = integrate(&model, start, Limits { relative: tolerance, absolute: tolerance, horizon })?;
        Ok(end.state[dofs..2 * dofs].iter().map(|rate| rate * model.speed).collect())
    }
}

/// The equations; the first entries of a state are what q has changed by, then follow v and the stretches, in units of
/// `period` and `speed`, in which all of them are of order one.
#[derive(Debug)]
struct Model<'a> {
    robot: &'a Moving<'a>,
    stiffness: Vector<f64>,
    damping: Vector<f64>,
    friction: Vec<f64>,
    /// Where the contact points were at first.
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
    posture: Posture,
    column: Vec<f64>,
}

impl<'a> Model<'a> {
    fn new(robot: &'a Moving<'a>, ground: Ground, stiffness: f64) -> Self {
        let mut memory = Memory::default();
        let Memory { workspace, posture, .. } = &mut memory;
        posture.set(robot.plan, robot.position);
        kinematics(robot.plan, posture, workspace);
        mass_matrix(robot.plan, workspace);
        factorize(robot.plan, workspace);
        contact_jacobian(robot.plan, robot.contacts, robot.velocity, None, workspace);
        delassus(robot.plan, workspace);
        let rows = 2 * robot.contacts.len();
        let normal = (0..robot.contacts.len()).map(|i| workspace.delassus[(2 * i + 1) * (rows + 1)].ln());
        let mean_mobility = (normal.sum::<f64>() / robot.contacts.len().max(1) as f64).exp();
        let start = robot.contacts.iter().map(|contact| place(robot.plan, contact, &[0.0; 2], workspace)).collect();
        let damping = 2.0 * ground.damping_ratio * (stiffness / mean_mobility).sqrt();
        Self {
            stiffness: [ground.stiffness_ratio * stiffness, stiffness],
            damping: [ground.tangential_damping * damping, damping],
            friction: robot
                .friction
                .iter()
                .map(|friction| match *friction {
                    Friction::Finite(mu) => mu.min(GREATEST_FRICTION),
                    Friction::Infinite => GREATEST_FRICTION,
                })
                .collect(),
            start,
            period: (1.0 / (stiffness * mean_mobility)).sqrt(),
            speed: robot.velocity.iter().fold(f64::MIN_POSITIVE, |speed: f64, rate| speed.max(rate.abs())),
            memory: RefCell::new(memory),
            robot,
        }
    }

    /// Accelerations, rates of the stretches, and for each contact its normal force and speed.
    fn evaluate(&self, state: &[f64], rates: &mut [f64]) -> Vec<Vector<f64>> {
        let (plan, dofs) = (self.robot.plan, self.robot.position.len());
        let length = self.speed * self.period;
        let moved: Vec<f64> = state[..dofs].iter().map(|entry| entry * length).collect();
        let velocity: Vec<f64> = state[dofs..2 * dofs].iter().map(|entry| entry * self.speed).collect();
        let stretches = &state[2 * dofs..];
        let Memory { workspace, posture, column } = &mut *self.memory.borrow_mut();
        let position: Vec<f64> = self.robot.position.iter().zip(&moved).map(|(q, moved)| q + moved).collect();
        posture.set(plan, &position);
        kinematics(plan, posture, workspace);
        mass_matrix(plan, workspace);
        factorize(plan, workspace);
        contact_jacobian(plan, self.robot.contacts, &velocity, None, workspace);

        let mut accelerations = vec![0.0; dofs];
        for (body, force) in inertial_forces(plan, &velocity, workspace).into_iter().enumerate() {
            let com = workspace.rotation[body].apply(com(plan, body));
            add_impulse(plan, workspace, (body, com), force, column, &mut accelerations);
        }
        let base = if plan.floating { [moved[0], moved[1]] } else { [0.0; 2] };
        let mut touching = Vec::with_capacity(self.robot.contacts.len());
        for (index, contact) in self.robot.contacts.iter().enumerate() {
            let axes = contact.axes();
            let c = workspace.contact_velocity[index];
            let depth = dot(axes[1], difference(self.start[index], place(plan, contact, &base, workspace)));
            let push = self.stiffness[1] * depth - self.damping[1] * c[1];
            let normal = if depth < 0.0 { 0.0 } else { push.max(0.0) };
            let bound = self.friction[index] * normal;
            let spring = self.stiffness[0] * stretches[index] * length;
            let tangential = (-spring - self.damping[0] * c[0]).clamp(-bound, bound);
            rates[2 * dofs + index] = -(tangential + spring) / self.damping[0] / self.speed;
            let force = sum(scaled(tangential, axes[0]), scaled(normal, axes[1]));
            let arm = contact.arm(workspace);
            add_impulse(plan, workspace, (contact.body, arm), force, column, &mut accelerations);
            touching.push([normal, c[1]]);
        }
        rates[..dofs].copy_from_slice(&state[dofs..2 * dofs]);
        for (rate, acceleration) in rates[dofs..].iter_mut().zip(&accelerations) {
            *rate = acceleration * self.period / self.speed;
        }
        touching
    }
}

/// A contact point from where the root's origin was at first, which moved by `base`.
fn place(plan: &Plan, contact: &ContactPoint, base: &Vector<f64>, workspace: &Workspace) -> Vector<f64> {
    let mut point = sum(*base, contact.arm(workspace));
    let mut at = Some(contact.body);
    while let Some(body) = at {
        point = sum(point, workspace.arm[body]);
        at = plan.bodies[body].parent;
    }
    point
}

/// CoG in the body's frame; of a massless body its origin.
fn com(plan: &Plan, body: usize) -> Vector<f64> {
    let inertia = plan.bodies[body].inertia;
    if inertia.mass > 0.0 { scaled(1.0 / inertia.mass, inertia.first) } else { [0.0; 2] }
}

/// Weight, and minus mass times what the CoG accelerates while no joint does, of each body \[N\].
fn inertial_forces(plan: &Plan, velocity: &[f64], workspace: &Workspace) -> Vec<Vector<f64>> {
    let mut spins: Vec<f64> = Vec::with_capacity(plan.bodies.len());
    let mut origins: Vec<Vector<f64>> = Vec::with_capacity(plan.bodies.len());
    let mut forces = Vec::with_capacity(plan.bodies.len());
    for (index, body) in plan.bodies.iter().enumerate() {
        let (spin, origin) = match (body.parent, body.motion) {
            (None, _) => (if plan.floating { velocity[2] } else { 0.0 }, [0.0; 2]),
            (Some(parent), motion) => {
                let (spin, rate) = (spins[parent], velocity[body.coordinate]);
                let carried = difference(origins[parent], scaled(spin * spin, workspace.arm[index]));
                match motion {
                    Motion::Turn { sign, .. } => (spin + sign * rate, carried),
                    // Coriolis: twice the turn of the direction of sliding.
                    Motion::Slide { .. } => {
                        (spin, sum(carried, scaled(2.0 * spin * rate, turned(workspace.direction[index]))))
                    }
                    Motion::Root | Motion::Weld => (spin, carried),
                }
            }
        };
        let com = workspace.rotation[index].apply(com(plan, index));
        let acceleration = difference(origin, scaled(spin * spin, com));
        forces.push(scaled(-body.inertia.mass, sum(acceleration, [0.0, GRAVITY])));
        spins.push(spin);
        origins.push(origin);
    }
    forces
}

impl<const N: usize> ODE<f64, [f64; N]> for Model<'_> {
    fn diff(&self, _: f64, state: &[f64; N], rates: &mut [f64; N]) {
        self.evaluate(state, rates);
    }
}

impl<const N: usize> Equations<N> for Model<'_> {
    /// Whether all contacts are free.
    fn has_ended(&self, state: &[f64; N]) -> bool {
        let touching = self.evaluate(state, &mut [0.0; N]);
        touching.iter().all(|&[normal, speed]| normal == 0.0 && speed >= 0.0)
    }
}
