//! Contact Jacobian at the material points, and the contact velocities c = J v.
//!
//! A column is the velocity of the contact point for a unit rate of one joint: turned(r) of a revolute joint at
//! distance r, the direction of a prismatic one. r is summed from the contact inward, so that no large positions are
//! subtracted. Source: Featherstone 2008, section 2.9 and the paper, section 2. Cost: O(n depth).

use super::contact_point::ContactPoint;
use super::workspace::Workspace;
use crate::dynamics::plan::{Motion, Plan};
use crate::planar::Vector;
use crate::scalar::Real;

/// Computes J (2n x nv, rows tangential and normal per contact) and c (n, \[m/s\]) for `velocity` (dq/dt by
/// coordinate).
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
    let mut speeds = std::mem::take(&mut workspace.contact_velocity);
    jacobian.clear();
    jacobian.resize(2 * contacts.len() * nv, T::zero());
    speeds.clear();
    for (index, contact) in contacts.iter().enumerate() {
        let axes = contact.axes();
        let arm = contact.arm(workspace);
        let (rows_t, rows_n) = jacobian[2 * index * nv..2 * (index + 1) * nv].split_at_mut(nv);
        let speed = walk(plan, contact.body, arm, velocity, workspace, |column, unit| {
            plan.bring(&mut rows_t[column], axes[0].dot(unit));
            plan.bring(&mut rows_n[column], axes[1].dot(unit));
        });
        speeds.push(axes.map(|axis| axis.dot(speed)));
    }
    if let Some(stance) = stance {
        let rest = contacts[stance];
        let origin = rest.arm(workspace);
        let spin = spin(plan, rest.body, velocity);
        for (contact, speed) in contacts.iter().zip(&mut speeds).filter(|(contact, _)| contact.body == rest.body) {
            let across = (contact.arm(workspace) - origin).perpendicular() * spin;
            *speed = contact.axes().map(|axis| axis.dot(across));
        }
        speeds[stance] = [T::zero(); 2];
    }
    workspace.contact_jacobian = jacobian;
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
    mut tell: impl FnMut(usize, Vector<T>),
) -> Vector<T> {
    let (mut at, mut arm) = (body, arm);
    let mut speed = Vector::zero();
    loop {
        let body = &plan.bodies[at];
        let unit = match body.motion {
            Motion::Root => break,
            Motion::Revolute { rate, .. } => Some(arm.perpendicular() * rate),
            Motion::Prismatic { .. } => Some(workspace.direction[at]),
            Motion::Fixed => None,
        };
        if let Some(unit) = unit {
            if let Some(column) = body.column {
                tell(column, unit);
            }
            speed += unit * velocity[body.coordinate];
        }
        arm += workspace.arm[at];
        match body.parent {
            Some(parent) => at = parent,
            None => break,
        }
    }
    if plan.floating {
        let [x, z] = Vector::axes();
        let units = [x, z, arm.perpendicular()];
        for (column, unit) in units.into_iter().enumerate() {
            tell(column, unit);
            speed += unit * velocity[column];
        }
    }
    speed
}

/// Rate at which a body turns about the plane's normal \[rad/s\].
pub(super) fn spin<T: Real>(plan: &Plan<T>, body: usize, velocity: &[T]) -> T {
    let mut rate = if plan.floating { velocity[2] } else { T::zero() };
    let mut at = Some(body);
    while let Some(index) = at {
        let body = &plan.bodies[index];
        if let Motion::Revolute { rate: own, .. } = body.motion {
            rate = rate + own * velocity[body.coordinate];
        }
        at = body.parent;
    }
    rate
}
