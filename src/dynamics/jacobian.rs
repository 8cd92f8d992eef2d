//! Contact Jacobian at the material points, the contact velocities c = J v, and the kinetic energy.
//!
//! A column is the velocity of the contact point for a unit rate of one joint: turned(r) (r rotated by +90 degrees) for
//! a revolute joint with the arm r from the joint to the point, or the axis of a prismatic joint. r is summed from the
//! contact toward the root, which avoids differences of large positions. Source: Featherstone 2008, section 2.9, and
//! the paper, section 2. Cost: O(n depth).

use super::workspace::Workspace;
use crate::dynamics::plan::{JointMotion, Plan};
use crate::planar::{Rotation, Vector};
use crate::scalar::Real;

/// A body's angular velocity \[rad/s\], and the velocity of its origin in the world's axes \[m/s\].
pub type Motion<T> = (T, Vector<T>);

/// A material point of a body that touches the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPoint<T = f64> {
    /// The body, an index into the plan's bodies, which are those of [`Robot::bodies`](crate::Robot).
    pub body: usize,
    /// The point if `radius` is zero, else the center of the circle, in the body's frame \[m\].
    pub center: Vector<T>,
    /// Radius of the circle \[m\]. The contact point is at center - radius * normal.
    pub radius: T,
    /// Rotation from the world's axes to the tangent and normal of the ground at the contact.
    pub ground: Rotation<T>,
}

impl<T: Real> ContactPoint<T> {
    /// Returns the ground's unit tangent and normal in the world's axes.
    pub fn axes(&self) -> [Vector<T>; 2] {
        Vector::axes().map(|axis| self.ground.apply(axis))
    }

    /// Returns the vector from the body's origin to the contact point, in the world's axes \[m\].
    pub fn arm(&self, workspace: &Workspace<T>) -> Vector<T> {
        let [_, normal] = self.axes();
        workspace.rotation[self.body].apply(self.center) - normal * self.radius
    }
}

/// Computes J (n x nv, [tangential, normal] per contact and column) and c (n, \[m/s\]) for `velocity`, dq/dt.
///
/// `stance` is the index of a contact that is exactly at rest: its velocity is set to zero. Other contacts of its body
/// then move by the body's rotation alone. `velocity` must contain the base velocity that belongs to this stance.
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
        let entries = &mut jacobian[index * nv..][..nv];
        let mut branch = None;
        let speed = walk(plan, contact.body, arm, velocity, workspace, |column, unit| {
            branch = branch.max(Some(column));
            plan.bring(&mut entries[column][0], axes[0].dot(unit));
            plan.bring(&mut entries[column][1], axes[1].dot(unit));
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

/// Returns the velocity of the point at `arm` from the origin of `body`, in the world's axes \[m/s\].
pub fn point_velocity<T: Real>(
    plan: &Plan<T>,
    body: usize,
    arm: Vector<T>,
    velocity: &[T],
    workspace: &Workspace<T>,
) -> Vector<T> {
    walk(plan, body, arm, velocity, workspace, |_, _| {})
}

/// Walks from a point to the root. Reports the velocity of the point for a unit rate of each column on the path, joint
/// by joint. Returns the velocity for all rates in `velocity`, including those of braked joints.
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

/// Returns the angular velocity of a body about the plane's normal \[rad/s\].
pub(super) fn spin<T: Real>(plan: &Plan<T>, body: usize, velocity: &[T]) -> T {
    let base = if plan.floating { velocity[2] } else { T::zero() };
    plan.way_to_root(body).fold(base, |spin, (_, body)| match body.motion {
        JointMotion::Revolute { rate, .. } => spin + rate * velocity[body.coordinate],
        _ => spin,
    })
}

/// Computes the kinetic energy \[J\] for `velocity` (dq/dt, including braked joints), as a sum over bodies without M:
///
/// ```text
///     T = sum of 1/2 (m u.u + 2 omega u.turned(h) + I omega^2) + 1/2 rotor rate^2
/// ```
///
/// where u is the velocity of a body's origin, and h and I are its first and second moments about it. `motions` is
/// scratch.
pub fn kinetic_energy<T: Real>(
    plan: &Plan<T>,
    velocity: &[T],
    workspace: &Workspace<T>,
    motions: &mut Vec<Motion<T>>,
) -> T {
    let mut twice = T::zero();
    motions.clear();
    for (index, body) in plan.bodies.iter().enumerate() {
        let (mut spin, mut origin) = match body.parent {
            Some(parent) => motions[parent],
            None if plan.floating => (velocity[2], Vector { x: velocity[0], z: velocity[1] }),
            None => (T::zero(), Vector::zero()),
        };
        if body.parent.is_some() {
            origin += workspace.arm[index].perpendicular() * spin;
        }
        match body.motion {
            JointMotion::Root | JointMotion::Fixed => {}
            JointMotion::Revolute { rate, .. } => spin = spin + rate * velocity[body.coordinate],
            JointMotion::Prismatic { .. } => origin += workspace.direction[index] * velocity[body.coordinate],
        }
        motions.push((spin, origin));
        let first = workspace.rotation[index].apply(body.inertia.first);
        let cross = spin * origin.dot(first.perpendicular());
        twice = twice + body.inertia.mass * origin.dot(origin) + cross + cross + body.inertia.second * spin * spin;
        if !matches!(body.motion, JointMotion::Root | JointMotion::Fixed) {
            let rate = velocity[body.coordinate];
            twice = twice + body.rotor * rate * rate;
        }
    }
    T::from_f64(0.5) * twice
}
