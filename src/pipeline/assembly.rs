//! From a configuration to G and c, step by step, in numbers of any kind.
//!
//! ```text
//!     configuration --place--> poses --factorize--> M = L^T D L, or articulated bodies --rest, close--> v
//!     v, points --contact_jacobian--> J, c = J v --delassus--> G = J M^-1 J^T      impulses p --applied, free--> c_free
//!                                                                loads --acceleration, contact_accelerations--> c'_free
//! ```
//!
//! Each step reads what the steps before it left in the workspace. The f64 pipeline finds contacts and bounds its
//! rounding between the steps. [`super::exact`] runs the steps for every other number type, and `accuracy` times each.

use super::still::{Still, eliminate};
use crate::dynamics::plan::{Configuration, Plan};
use crate::dynamics::{
    Closed, Constraints, ContactPoint, Loop, Motion, PointImpulse, SpringLoad, SpringPoint, Workspace,
    add_articulated_impulse, add_impulse, articulated_acceleration, articulated_delassus, articulated_inertias, bias,
    close, contact_jacobian, delassus, demands, eliminate_loops, factorize, kinematics, loop_impulse, mass_matrix,
    orthogonalize, point_velocity,
};
use crate::planar::{Pair, Vector};
use crate::robot::Robot;
use crate::scalar::Real;
use crate::state::{LinkPoint, Scene, SpringEnd, VirtualSpring};

/// The loads on a robot in sustained contact, apart from the contact forces.
#[derive(Debug, Clone, Copy)]
pub struct Loads<'a> {
    pub robot: &'a Robot,
    /// Gravity, torques and virtual springs.
    pub scene: &'a Scene,
    /// q, with the placed base.
    pub position: &'a [f64],
    /// For each body whether it does not rotate, up to the rounding of its rates; an empty list means false for all.
    pub steady: &'a [bool],
}

/// A row of G is set to zero if the loops reduce its diagonal entry to this fraction or less: (1000 eps)^2, because G
/// is quadratic in velocities. Nearly dependent rows of K leave more.
const HELD: f64 = (1e3 * f64::EPSILON) * (1e3 * f64::EPSILON);

/// How M^-1 is applied.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Elimination {
    /// M = L^T D L along the tree's branches.
    #[default]
    Ltl,
    /// Articulated bodies, without M, mimic joints and constraints: faster for long chains, with narrower enclosures.
    ArticulatedBodies,
}

/// The dynamics of one state, with reusable memory.
#[derive(Debug, Clone, Default)]
pub struct Assembly<T = f64> {
    pub plan: Plan<T>,
    pub configuration: Configuration<T>,
    pub elimination: Elimination,
    pub workspace: Workspace<T>,
    pub points: Vec<ContactPoint<T>>,
    /// Coordinates of braked joints that nevertheless have a column.
    pub kept: Vec<usize>,
    pub loops: Vec<Loop<T>>,
    /// The independent rows of the loops, in the order in which every number type eliminates them.
    pub rows: Vec<usize>,
    /// Whether the rank of the loops does not depend on digits that the pose does not have.
    pub is_rank_certain: bool,
    column: Vec<T>,
    /// Scratch of the elimination of contacts at rest.
    pub(super) left: Vec<T>,
    pub(super) motions: Vec<Motion<T>>,
}

impl Assembly {
    /// Does the same as [`Assembly::delassus`], and sets the rows of contacts that the loops hold to exactly zero.
    pub fn rounded_delassus(&mut self) {
        if !self.is_constrained() {
            return self.delassus();
        }
        delassus(&self.plan, &mut self.workspace);
        let size = 2 * self.points.len();
        let free: Vec<f64> = self.workspace.delassus.iter().step_by(size + 1).copied().collect();
        eliminate_loops(&self.plan, &mut self.workspace);
        let delassus = &mut self.workspace.delassus;
        for (row, free) in free.into_iter().enumerate() {
            if delassus[row * (size + 1)] <= HELD * free {
                (0..size).for_each(|other| (delassus[row * size + other], delassus[other * size + row]) = (0.0, 0.0));
            }
        }
    }
}

impl<T: Real> Assembly<T> {
    pub fn new(plan: Plan<T>) -> Self {
        Self { plan, ..Self::default() }
    }

    pub fn place(&mut self) {
        kinematics(&self.plan, &self.configuration, &mut self.workspace);
    }

    /// Prepares M^-1.
    pub fn factorize(&mut self) {
        match self.elimination {
            Elimination::Ltl => {
                mass_matrix(&self.plan, &mut self.workspace);
                factorize(&self.plan, &mut self.workspace);
            }
            Elimination::ArticulatedBodies => articulated_inertias(&self.plan, &mut self.workspace),
        }
    }

    /// Switches from articulated bodies to M = L^T D L, for results that only M gives.
    pub fn take_mass_matrix(&mut self) {
        if self.elimination == Elimination::ArticulatedBodies {
            self.elimination = Elimination::Ltl;
            self.factorize();
        }
    }

    /// Returns the velocity of a contact point in the world's axes \[m/s\].
    pub fn velocity_of(&self, point: &ContactPoint<T>, velocity: &[T]) -> Vector<T> {
        point_velocity(&self.plan, point.body, point.arm(&self.workspace), velocity, &self.workspace)
    }

    /// Sets the base's velocity so that `foot` is at rest.
    pub fn rest(&self, foot: &ContactPoint<T>, velocity: &mut [T]) {
        velocity[..2].fill(T::zero());
        let moving = self.velocity_of(foot, velocity);
        velocity[..2].copy_from_slice(&(-moving).components());
    }

    /// Returns whether M^-1 can be applied by articulated bodies, which support neither mimic joints nor constraints.
    pub fn has_articulated_bodies(&self) -> bool {
        !self.plan.has_mimics && !self.is_constrained()
    }

    /// Returns whether there are constraints: loops, or braked joints that have a column.
    pub fn is_constrained(&self) -> bool {
        !(self.loops.is_empty() && self.kept.is_empty())
    }

    /// Prepares the constraints. When the loops are closed in a velocity, `foot` stays at rest.
    pub fn constrain(&mut self, foot: Option<ContactPoint<T>>) {
        if self.is_constrained() {
            let constraints = Constraints { kept: &self.kept, rows: &self.rows };
            let foot = foot.filter(|_| !self.loops.is_empty());
            orthogonalize(&self.plan, &self.loops, constraints, foot, &mut self.workspace);
        }
    }

    /// Changes `velocity` to the nearest one that keeps the loops closed; returns the amplitudes of the constraints.
    pub fn close(&self, velocity: &mut [T]) -> Vec<T> {
        if self.loops.is_empty() {
            return Vec::new();
        }
        close(&self.plan, &self.loops, Closed::Velocity, velocity, &self.workspace)
    }

    /// Adds the response of the constraints to a `change` of velocity or to an acceleration, as `closed` selects.
    /// Returns the loops' impulses on their points a.
    pub fn add_constraint_response(&self, closed: Closed<'_, T>, change: &mut [T]) -> Vec<Vector<T>> {
        if !self.is_constrained() {
            return Vec::new();
        }
        let amplitudes = close(&self.plan, &self.loops, closed, change, &self.workspace);
        loop_impulse(self.loops.len(), &amplitudes, &self.workspace)
    }

    /// Returns h = tau - b by column \[N, N m\]. Requires the kinematics.
    pub fn load(&mut self, velocity: &[T], loads: Loads<'_>) -> &[T] {
        self.drive(velocity, loads);
        let Self { plan, workspace, column, .. } = self;
        bias(plan, velocity, T::from_f64(loads.scene.gravity()), loads.steady, workspace);
        column.iter_mut().zip(&workspace.bias).for_each(|(entry, &bias)| *entry = *entry - bias);
        column
    }

    /// Computes tau by column.
    fn drive(&mut self, velocity: &[T], loads: Loads<'_>) {
        let springs = self.springs(velocity, loads);
        self.column.clear();
        self.column.extend(self.plan.coordinates.iter().map(|&coordinate| {
            let Some(joint) = coordinate.checked_sub(loads.robot.base_dofs()) else { return T::zero() };
            let given = loads.scene.torque.get(joint).map_or(T::zero(), |&torque| T::from_f64(torque));
            springs.iter().fold(given, |sum, spring| sum + spring.generalized[coordinate])
        }));
    }

    /// Returns the acceleration by coordinate from the loads alone, without contacts and constraints \[m/s^2,
    /// rad/s^2\], and kappa of each loop.
    pub fn acceleration(&mut self, velocity: &[T], loads: Loads<'_>) -> (Vec<T>, Vec<Vector<T>>) {
        match self.elimination {
            Elimination::Ltl => {
                self.load(velocity, loads);
                self.workspace.factor.solve(&self.plan, &mut self.column);
            }
            Elimination::ArticulatedBodies => {
                self.drive(velocity, loads);
                let Self { plan, workspace, column, motions, .. } = self;
                demands(plan, velocity, T::from_f64(loads.scene.gravity()), loads.steady, workspace);
                articulated_acceleration(plan, workspace, column, motions);
            }
        }
        let Self { plan, workspace, column, loops, .. } = self;
        let mut acceleration = vec![T::zero(); velocity.len()];
        for (&coordinate, &entry) in plan.coordinates.iter().zip(column.iter()) {
            acceleration[coordinate] = entry;
        }
        (acceleration, loops.iter().map(|pair| pair.drift(workspace)).collect())
    }

    /// Returns the force of each virtual spring. Requires the kinematics.
    pub fn springs(&self, velocity: &[T], loads: Loads<'_>) -> Vec<SpringLoad<T>> {
        let point = |LinkPoint { link, offset }: LinkPoint| {
            let link = &loads.robot.links[link];
            SpringPoint::Body(link.body, link.point(offset))
        };
        let load = |spring: &VirtualSpring| {
            let b = match spring.b {
                SpringEnd::Link(end) => point(end),
                SpringEnd::World(place) => SpringPoint::World(place.map(T::from_f64)),
            };
            let spring = ([point(spring.a), b], spring.laws);
            SpringLoad::of(spring, &self.plan, loads.position, velocity, &self.workspace)
        };
        loads.scene.springs.iter().map(load).collect()
    }

    /// Returns the contacts' accelerations J a + sigma for an acceleration a by coordinate.
    pub fn contact_accelerations(&self, acceleration: &[T]) -> Vec<Pair<T>> {
        let accelerations = self.points.iter().map(|point| {
            let total = self.velocity_of(point, acceleration) + point.drift(&self.workspace);
            point.axes().map(|axis| axis.dot(total))
        });
        accelerations.collect()
    }

    /// Computes J and c. The contact `stance` is exactly at rest.
    pub fn contact_jacobian(&mut self, velocity: &[T], stance: Option<usize>) {
        contact_jacobian(&self.plan, &self.points, velocity, stance, &mut self.workspace);
    }

    /// Replaces c by that of the motion in which the contacts `still` rest and which is nearest to v in kinetic energy:
    /// c_i - G_ir lambda with G_rr lambda = c_r. Calls `report` for each eliminated row of G with what is left of its c
    /// and of its pivot, and with G.
    pub fn settle(&mut self, Still { contacts, rows, .. }: &Still, mut report: impl FnMut(usize, Pair<T>, &[T])) {
        let Workspace { delassus, contact_velocity: speeds, .. } = &mut self.workspace;
        if !rows.is_empty() {
            let left = &mut self.left;
            left.clone_from(delassus);
            let size = 2 * contacts.len();
            for (done, &row) in rows.iter().enumerate() {
                report(row, [speeds[row / 2][row % 2], left[row * (size + 1)]], delassus);
                for other in (0..size).filter(|other| !rows[..=done].contains(other)) {
                    let share = eliminate(left, size, row, other);
                    speeds[other / 2][other % 2] = speeds[other / 2][other % 2] - share * speeds[row / 2][row % 2];
                }
            }
        }
        speeds.iter_mut().zip(contacts).filter(|(_, still)| **still).for_each(|(speed, _)| *speed = [T::zero(); 2]);
    }

    /// Computes G, without the directions that the constraints block.
    pub fn delassus(&mut self) {
        match self.elimination {
            Elimination::Ltl => delassus(&self.plan, &mut self.workspace),
            Elimination::ArticulatedBodies => articulated_delassus(&self.plan, &self.points, &mut self.workspace),
        }
        if self.is_constrained() {
            eliminate_loops(&self.plan, &mut self.workspace);
        }
    }

    /// Adds to `velocity` the change M^-1 J^T p by an impulse at a point. M^-1 must be prepared for `by`.
    pub fn add_impulse(&mut self, by: Elimination, impulse: PointImpulse<T>, velocity: &mut [T]) {
        let Self { plan, workspace, column, motions, .. } = self;
        match by {
            Elimination::Ltl => add_impulse(plan, workspace, impulse, column, velocity),
            Elimination::ArticulatedBodies => {
                add_articulated_impulse(plan, workspace, impulse, column, motions, velocity);
            }
        }
    }

    /// Does the same as [`Assembly::add_impulse`] for an impulse [tangential, normal] at a contact.
    pub fn add_contact_impulse(&mut self, by: Elimination, contact: usize, [t, n]: Pair<T>, velocity: &mut [T]) {
        let point = self.points[contact];
        let axes = point.axes();
        let vector = axes[0] * t + axes[1] * n;
        let arm = point.arm(&self.workspace);
        self.add_impulse(by, PointImpulse { body: point.body, arm, vector }, velocity);
    }

    /// Adds to a `change` of v, by coordinate, the effect of the applied impulses alone, without the constraints.
    pub fn apply(&mut self, robot: &Robot, scene: &Scene, change: &mut [T]) {
        for applied in &scene.impulses {
            let link = &robot.links[applied.link];
            let arm = self.workspace.rotation[link.body].apply(link.point(applied.offset));
            let impulse = PointImpulse { body: link.body, arm, vector: applied.vector.map(T::from_f64) };
            self.add_impulse(self.elimination, impulse, change);
        }
    }

    /// Returns c after a `change` of velocity. Only the change is multiplied by J, so that contacts at rest may stay
    /// so.
    pub fn free(&self, before: &[Pair<T>], change: &[T]) -> Vec<Pair<T>> {
        let free = before.iter().zip(&self.points).map(|(&[tangential, normal], point)| {
            let (more, axes) = (self.velocity_of(point, change), point.axes());
            [tangential + axes[0].dot(more), normal + axes[1].dot(more)]
        });
        free.collect()
    }
}
