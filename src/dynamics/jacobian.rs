//! Contact Jacobian at the material points, the contact velocities c = J v, and the kinetic energy.
//!
//! A column is the velocity of the contact point for a unit rate of one joint: turned(r) of a revolute joint at
//! distance r, the direction of a prismatic one. r is summed from the contact inward, so that no large positions are
//! subtracted. Source: Featherstone 2008, section 2.9 and the paper, section 2. Cost: O(n depth).

use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::{Rotation, Vector};
use crate::scalar::Real;

/// A body's rate of turn \[rad/s\], and the velocity of its origin in the world's axes \[m/s\].
pub type Motion<T> = (T, Vector<T>);

/// A material point in touch with the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint<T = f64> {
    /// The body, an index into the plan's bodies (those of [`Robot::bodies`](crate::Robot)).
    pub body: usize,
    /// The point, or the center of the circle, in the body's frame \[m\].
    pub center: Vector<T>,
    /// Radius of the circle \[m\]: the point is at the center - radius * normal.
    pub radius: T,
    /// Turn from the world's axes to the ground's (tangent, normal) at the contact.
    pub ground: Rotation<T>,
}

impl<T: Real> ContactPoint<T> {
    /// The ground's unit tangent and normal in the world's axes.
    pub fn axes(&self) -> [Vector<T>; 2] {
        Vector::axes().map(|axis| self.ground.apply(axis))
    }

    /// The point from its body's origin, in the world's axes \[m\].
    pub fn arm(&self, workspace: &Workspace<T>) -> Vector<T> {
        let [_, normal] = self.axes();
        workspace.rotation[self.body].apply(self.center) - normal * self.radius
    }
}

/// Computes J (n x nv, [tangential, normal] per contact and column) and c (n, \[m/s\]) for `velocity`, dq/dt.
///
/// With a `stance` (an index into `contacts`) that contact is exactly at rest, and so are further contacts of a body
/// that does not turn: base velocities are taken as the ones that make it so.
pub fn contact_jacobian<T: Real>(
    plan: &Plan<T>,
    contacts: &[ContactPoint<T>],
    velocity: &[T],
    stance: Option<usize>,
    workspace: &mut Workspace<T>,
) {
    let nv = plan.columns();
    let mut jacobian = std::mem::take(&mut workspace.contact_jacobian);
    let mut branches = std::mem::take(&mut workspace.branch);
    let mut speeds = std::mem::take(&mut workspace.contact_velocity);
    jacobian.clear();
    jacobian.resize(contacts.len() * nv, [T::zero(); 2]);
    branches.clear();
    speeds.clear();
    for (index, contact) in contacts.iter().enumerate() {
        let axes = contact.axes();
        let arm = contact.arm(workspace);
        let own = &mut jacobian[index * nv..][..nv];
        let mut branch = None;
        let speed = walk(plan, contact.body, arm, velocity, workspace, |column, unit| {
            branch = branch.max(Some(column));
            plan.bring(&mut own[column][0], axes[0].dot(unit));
            plan.bring(&mut own[column][1], axes[1].dot(unit));
        });
        branches.push(branch);
        speeds.push(axes.map(|axis| axis.dot(speed)));
    }
    if let Some(stance) = stance {
        let rest = contacts[stance];
        let turning = spin(plan, rest.body, velocity);
        for (contact, speed) in contacts.iter().zip(&mut speeds).filter(|(contact, _)| contact.body == rest.body) {
            let across = (contact.arm(workspace) - rest.arm(workspace)).perpendicular() * turning;
            *speed = contact.axes().map(|axis| axis.dot(across));
        }
        speeds[stance] = [T::zero(); 2];
    }
    workspace.contact_jacobian = jacobian;
    workspace.branch = branches;
    workspace.contact_velocity = speeds;
}

/// Velocity of the point at `arm` from the origin of `body`, in the world's axes \[m/s\].
pub fn point_velocity<T: Real>(
    plan: &Plan<T>,
    body: usize,
    arm: Vector<T>,
    velocity: &[T],
    workspace: &Workspace<T>,
) -> Vector<T> {
    walk(plan, body, arm, velocity, workspace, |_, _| {})
}

/// Walks from a point to the root: reports what every joint on the way adds to the velocity of the point for a unit
/// rate of its column, and returns the velocity for all rates, braked joints' included.
pub(super) fn walk<T: Real>(
    plan: &Plan<T>,
    body: usize,
    arm: Vector<T>,
    velocity: &[T],
    workspace: &Workspace<T>,
    mut visit: impl FnMut(usize, Vector<T>),
) -> Vector<T> {
    let (mut arm, mut speed) = (arm, Vector::zero());
    for (index, body) in plan.way_to_root(body) {
        let unit = match body.motion {
            JointMotion::Root => break,
            JointMotion::Revolute { rate, .. } => Some(arm.perpendicular() * rate),
            JointMotion::Prismatic { .. } => Some(workspace.direction[index]),
            JointMotion::Fixed => None,
        };
        if let Some(unit) = unit {
            if let Some(column) = body.column {
                visit(column, unit);
            }
            speed += unit * velocity[body.coordinate];
        }
        arm += workspace.arm[index];
    }
    if plan.floating {
        let [x, z] = Vector::axes();
        for (column, unit) in [x, z, arm.perpendicular()].into_iter().enumerate() {
            visit(column, unit);
            speed += unit * velocity[column];
        }
    }
    speed
}

/// Rate at which a body turns about the plane's normal \[rad/s\].
pub(super) fn spin<T: Real>(plan: &Plan<T>, body: usize, velocity: &[T]) -> T {
    let base = if plan.floating { velocity[2] } else { T::zero() };
    plan.way_to_root(body).fold(base, |rate, (_, body)| match body.motion {
        JointMotion::Revolute { rate: own, .. } => rate + own * velocity[body.coordinate],
        _ => rate,
    })
}

/// Kinetic energy \[J\] for `velocity` (dq/dt, braked joints included): body by body, independent of the mass matrix.
///
/// ```text
///     T = sum of 1/2 (m u.u + 2 omega u.turned(h) + I omega^2) + 1/2 rotor rate^2
/// ```
///
/// with u the velocity of a body's origin, h and I its first and second moments about it; `motions` is scratch.
pub fn kinetic_energy<T: Real>(
    plan: &Plan<T>,
    velocity: &[T],
    workspace: &Workspace<T>,
    motions: &mut Vec<Motion<T>>,
) -> T {
    let mut twice = T::zero();
    motions.clear();
    for (index, body) in plan.bodies.iter().enumerate() {
        let (mut rate, mut origin) = match body.parent {
            Some(parent) => motions[parent],
            None if plan.floating => (velocity[2], Vector { x: velocity[0], z: velocity[1] }),
            None => (T::zero(), Vector::zero()),
        };
        if body.parent.is_some() {
            origin += workspace.arm[index].perpendicular() * rate;
        }
        match body.motion {
            JointMotion::Root | JointMotion::Fixed => {}
            JointMotion::Revolute { rate: own, .. } => rate = rate + own * velocity[body.coordinate],
            JointMotion::Prismatic { .. } => origin += workspace.direction[index] * velocity[body.coordinate],
        }
        motions.push((rate, origin));
        let first = workspace.rotation[index].apply(body.inertia.first);
        let cross = rate * origin.dot(first.perpendicular());
        twice = twice + body.inertia.mass * origin.dot(origin) + cross + cross + body.inertia.second * rate * rate;
        if !matches!(body.motion, JointMotion::Root | JointMotion::Fixed) {
            let own = velocity[body.coordinate];
            twice = twice + body.rotor * own * own;
        }
    }
    T::from_f64(0.5) * twice
}
