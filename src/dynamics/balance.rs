//! Error bounds of G computed by articulated bodies, from the residual momentum of its motions.
//!
//! For a unit impulse along row r, let u_r be the velocities of all bodies b, with |u|^2 = sum of u_b . I_b u_b, which
//! is twice the kinetic energy. Then G_rs = J_s u_r, and |u_r|^2 = G_rr. Let w be any motion that the joints allow, and
//! F any impulses in the joints that do no work in such motions. They bound the distance of w from u_r (W. Prager, J.
//! L. Synge, "Approximations in elasticity based on the concept of function space", Quart. Appl. Math. 5, 1947):
//!
//! ```text
//!     |w - u_r|^2 <= sum over b of (I_b w_b - p_b) . I_b^-1 (I_b w_b - p_b)       p_b: F and contact on b
//!     |J_s w - G_rs| = |<u_s, w - u_r>| <= sqrt(G_ss) |w - u_r|
//! ```
//!
//! w is the motion that f64 computed. F is what w requires, summed from the outermost body toward the root. Both are
//! taken as exactly these f64 numbers, so no error propagates from body to body:
//!
//! 1. At a revolute joint, F has no moment but that of the rotor; the rest of the summed moment stays on the body. At a
//!    prismatic joint, F has no force along the joint. A rotor counts as a separate body.
//! 2. The origins in w violate a joint by a rounding error delta. Moving all bodies that the joint carries by delta
//!    gives a motion that the joints allow. Its distance from w is sqrt(mass carried) |delta|.
//! 3. The error of a rotation is [`TURN`] u per joint between the body and the root (see [`bounds`](super::bounds));
//!    that of an arm is this times its length.
//!
//! There is no bound if a body has no mass or no moment of inertia. All bounds are doubled to cover the terms of second
//! order. These are small, because a bound above one tenth counts as unknown. Cost: O(n nb + n^2).

use super::articulated::set_in_motion;
use super::articulated_inertia::Wrench;
use super::jacobian::{ContactPoint, Motion};
use super::stretch::{Arm, LIKELY, SMALL, SUM, Stretched, UNIT_ROUNDOFF, length};
use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan, PlanBody};
use crate::planar::Vector;

/// Roundings of a rotation per joint: 4 in its cosine and sine and 3 in the product, for the sum of both components.
const TURN: f64 = 16.0;
/// Roundings of the ground's axes, and of the position of a point along them.
const GROUND: f64 = 64.0 * UNIT_ROUNDOFF;
/// Covers the underflow of a few products.
const UNDERFLOW: f64 = 1e-300;

/// Memory of the computation, reused.
#[derive(Debug, Clone, Default)]
pub(super) struct Balance {
    bodies: Vec<BodyScale>,
    passed: Vec<Passed>,
    motions: Vec<Motion<f64>>,
    /// Bound on the distance of each body's origin in w from where the joints allow it \[m/s\].
    apart: Vec<f64>,
    rates: Vec<f64>,
}

/// Quantities of a body that are the same for all rows of G.
#[derive(Debug, Clone, Copy)]
struct BodyScale {
    /// Mass times the vector from the origin to the center of mass, in the world's axes, and an upper bound on its
    /// length \[kg m\].
    first: Vector<f64>,
    first_length: f64,
    /// Upper bound on the distance of the center of mass from the origin \[m\].
    com: f64,
    /// 1 / sqrt(mass), and 1 / sqrt(moment of inertia about the center of mass).
    per_mass: f64,
    per_moment: f64,
    /// Square root of the mass that the joint carries.
    carried: f64,
    /// Error of the rotation.
    turn: f64,
}

impl BodyScale {
    fn of(body: &PlanBody<f64>, stretched: &Stretched, first: Vector<f64>) -> Self {
        let first_length = length(first);
        let (mass, com) = (body.inertia.mass, first_length / body.inertia.mass);
        Self {
            first,
            first_length,
            com,
            per_mass: 1.0 / mass.sqrt(),
            per_moment: 1.0 / central_moment(body).sqrt(),
            carried: stretched.mass.sqrt(),
            turn: TURN * (stretched.depth + 1) as f64 * UNIT_ROUNDOFF,
        }
    }
}

/// Lower bound on the moment of inertia about the center of mass; not positive, or NaN, if it may be zero.
pub(super) fn central_moment(body: &PlanBody<f64>) -> f64 {
    let (mass, first, second) = (body.inertia.mass, body.inertia.first, body.inertia.second);
    second * (1.0 - SUM) - first.dot(first * (1.0 / mass)) * (1.0 + SUM) - UNDERFLOW
}

/// Returns whether this method can give a bound: there are no mimic joints, and every body except a fixed root has mass
/// and moment of inertia.
pub fn has_balance(plan: &Plan) -> bool {
    let is_heavy = |body: &PlanBody<f64>| central_moment(body) > 0.0;
    let moves = |body: &PlanBody<f64>| body.parent.is_some() || plan.floating;
    !plan.has_mimics && plan.bodies.iter().filter(|body| moves(body)).all(is_heavy)
}

/// The wrench that a body receives from the bodies it carries, with the errors of its force and of its moment.
#[derive(Debug, Clone, Copy)]
struct Passed {
    wrench: Wrench<f64>,
    force_error: f64,
    moment_error: f64,
}

impl Balance {
    /// Returns the error bound of an entry G_ij and its likely error, both relative to sqrt(G_ii G_jj). Both are
    /// infinite if nothing is known. `arms` belong to the `points`.
    pub fn errors(
        &mut self,
        plan: &Plan,
        stretched: &[Stretched],
        (points, arms): (&[ContactPoint], &[Arm]),
        workspace: &Workspace,
    ) -> [f64; 2] {
        self.bodies.clear();
        let bodies = plan.bodies.iter().zip(stretched).zip(&workspace.rotation);
        self.bodies.extend(
            bodies.map(|((body, stretched), turn)| BodyScale::of(body, stretched, turn.apply(body.inertia.first))),
        );
        let (nv, rows) = (plan.columns(), 2 * points.len());
        let entry = |row: usize, column: usize| workspace.delassus[row * rows + column];
        let can_move = |point: &ContactPoint| plan.way_to_root(point.body).any(|(_, body)| body.column.is_some());
        let [mut bound, mut seen] = [0.0_f64; 2];
        for (index, (point, arm)) in points.iter().zip(arms).enumerate() {
            if !can_move(point) {
                continue;
            }
            for (which, axis) in point.axes().into_iter().enumerate() {
                let row = 2 * index + which;
                self.rates.clear();
                self.rates.extend(workspace.half_by_d[index * nv..][..nv].iter().map(|pair| pair[which]));
                set_in_motion(plan, workspace, &mut self.rates, &mut self.motions);
                let norm = entry(row, row).sqrt();
                let jumps = self.jumps(plan, stretched, workspace) / norm;
                let [off, left] = self.imbalance(plan, stretched, workspace, (point, arm, axis), norm);
                for (other, (point, arm)) in points.iter().zip(arms).take(index + 1).enumerate() {
                    if !can_move(point) {
                        continue;
                    }
                    let (spin, origin) = self.motions[point.body];
                    let velocity = origin + point.arm(workspace).perpendicular() * spin;
                    let (speed, turning) = (length(origin), arm.length * spin.abs());
                    let turn = self.bodies[point.body].turn;
                    let rounding =
                        self.apart[point.body] + (SUM + GROUND) * (speed + turning) + (2.0 * turn + GROUND) * turning;
                    for (column, axis) in (2 * other..).zip(point.axes()) {
                        let scale = norm * entry(column, column).sqrt();
                        // If a row of G vanishes although its contact can move, there is no relative error bound.
                        let apart = (axis.dot(velocity) - entry(row, column)).abs();
                        let error = (apart + rounding) / scale + jumps + off;
                        if error.is_nan() || error >= SMALL {
                            return [f64::INFINITY; 2];
                        }
                        bound = bound.max(2.0 * error);
                        seen = seen.max(apart / scale + left);
                    }
                }
            }
        }
        let depth = stretched.iter().map(|body| body.depth).max().unwrap_or(0) + 1;
        [bound, seen + LIKELY * (UNIT_ROUNDOFF + bound / (TURN * depth as f64))]
    }

    /// Returns a bound on the distance from the motion to one that the joints allow \[sqrt J\].
    fn jumps(&mut self, plan: &Plan, stretched: &[Stretched], workspace: &Workspace) -> f64 {
        let mut sum = 0.0;
        self.apart.clear();
        for (index, body) in plan.bodies.iter().enumerate() {
            let Some(parent) = body.parent else {
                self.apart.push(0.0);
                continue;
            };
            let (scale, ((spin, _), (_, origin))) = (&self.bodies[index], (self.motions[parent], self.motions[index]));
            let mut jump = SUM * length(origin) + (SUM + scale.turn) * stretched[index].arm * spin.abs() + UNDERFLOW;
            if let (JointMotion::Prismatic { .. }, Some(column)) = (body.motion, body.column) {
                jump += (SUM + scale.turn) * length(workspace.direction[index]) * self.rates[column].abs();
            }
            sum += scale.carried * jump;
            self.apart.push(self.apart[parent] + jump);
        }
        sum
    }

    /// Returns the distance of the motion from u divided by `norm`, the length of u, with and without its own rounding.
    fn imbalance(
        &mut self,
        plan: &Plan,
        stretched: &[Stretched],
        workspace: &Workspace,
        (point, arm, axis): (&ContactPoint, &Arm, Vector<f64>),
        norm: f64,
    ) -> [f64; 2] {
        let nothing = Wrench { moment: 0.0, linear: Vector::zero() };
        self.passed.clear();
        self.passed.resize(plan.bodies.len(), Passed { wrench: nothing, force_error: 0.0, moment_error: 0.0 });
        self.passed[point.body] = Passed {
            wrench: Wrench::at(point.arm(workspace), -axis),
            force_error: GROUND,
            moment_error: 2.0 * (GROUND + self.bodies[point.body].turn) * arm.length,
        };
        // The initial value covers squares that underflow.
        let [mut squares, mut seen] = [1e-100; 2];
        for (index, body) in plan.bodies.iter().enumerate().rev() {
            if body.parent.is_none() && !plan.floating {
                // The ground supports a fixed root.
                continue;
            }
            let (scale, passed, (spin, origin)) = (&self.bodies[index], self.passed[index], self.motions[index]);
            let (mass, turning, speed) = (body.inertia.mass, spin.abs(), length(origin));
            let lever = scale.first.perpendicular();
            let wrench = passed.wrench.with(Wrench {
                linear: origin * mass + lever * spin,
                moment: body.inertia.second * spin + lever.dot(origin),
            });
            let off_center = scale.turn * scale.first_length;
            let force_error = passed.force_error
                + SUM * (mass * speed + scale.first_length * turning + length(passed.wrench.linear))
                + off_center * turning
                + UNDERFLOW;
            let moment_error = passed.moment_error
                + SUM * (body.inertia.second * turning + scale.first_length * speed + passed.wrench.moment.abs())
                + off_center * speed
                + UNDERFLOW;
            if let (Some(parent), Some(column)) = (body.parent, body.column) {
                let rate = self.rates[column];
                let sizes = rate.abs() + turning + self.motions[parent].0.abs();
                let part = SUM * sizes * body.rotor.sqrt() / norm;
                squares += part * part;
            }
            // The wrench that the joint transmits, the one that stays on the body, and the error of the joint's force.
            let (sent, left, inexact) = match (body.motion, body.column) {
                (JointMotion::Root, _) => (nothing, wrench, 0.0),
                (JointMotion::Fixed, _) | (_, None) => (wrench, nothing, 0.0),
                (JointMotion::Revolute { sign, .. }, Some(column)) => {
                    let moment = -sign * (body.rotor * self.rates[column]);
                    (
                        Wrench { moment, ..wrench },
                        Wrench { moment: wrench.moment - moment, linear: Vector::zero() },
                        0.0,
                    )
                }
                (JointMotion::Prismatic { .. }, Some(column)) => {
                    let (along, driven) = (workspace.direction[index], body.rotor * self.rates[column]);
                    let square = along.dot(along);
                    let left = along * ((along.dot(wrench.linear) + driven) / square);
                    let linear = wrench.linear - left;
                    let work = (along.dot(linear) + driven).abs()
                        + (SUM + scale.turn) * (length(along) * length(linear) + driven.abs());
                    (Wrench { linear, ..wrench }, Wrench { linear: left, moment: 0.0 }, 2.0 * work / square.sqrt())
                }
            };
            let [force, moment] = [length(left.linear), left.moment.abs()];
            let square = |force: f64, moment: f64| {
                let by_force = force * scale.per_mass / norm;
                let by_moment = (moment + scale.com * force) * scale.per_moment / norm;
                by_force * by_force + by_moment * by_moment
            };
            squares += square(force + force_error + SUM * length(sent.linear) + inexact, moment + moment_error);
            seen += square(force, moment);
            let Some(parent) = body.parent else { continue };
            let sum = self.passed[parent].wrench.with(sent.seen_from(workspace.arm[index]));
            let (force, arm) = (length(sent.linear), stretched[index].arm);
            let parent = &mut self.passed[parent];
            parent.wrench = sum;
            parent.force_error += inexact + SUM * length(sum.linear);
            parent.moment_error +=
                (SUM + scale.turn) * arm * force + SUM * (sent.moment.abs() + sum.moment.abs()) + arm * inexact;
        }
        [squares.sqrt(), seen.sqrt()]
    }
}
