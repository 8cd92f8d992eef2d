//! Robots in mid-flight, against forward dynamics by articulated bodies, written here a second time: in the axes of
//! each body, with classical accelerations A of its origin and alpha of its turn.
//!
//! ```text
//!     (n, f) = I_A (alpha, A) + p_A      (alpha, A)_i = X_i (alpha, A)_p + c_i + S_i q''_i      p_i = (0, -m omega^2 com)
//! ```
//!
//! Source: Featherstone 2008, section 7.3. Cost: O(nb).

use super::forces;
use crate::support::command::read;
use crate::support::impact::{outcomes, robot};
use crate::support::random::Random;
use crate::support::robots::{ROBOTS, by_name, robot_and_reference};
use crate::support::urdf::{self, HINGE, joint, link};
use heelstrike::Robot;
use heelstrike::planar::Vector;
use heelstrike::robot::{Axis, Base, ParentJoint};
use nalgebra::{Matrix3, Vector3};
use serde_json::{Value, json};

const GRAVITY: f64 = 9.81;

/// Linear parts of a vector (turn, forward, up).
fn turned(angle: f64, [x, z]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x + sin * z, cos * z - sin * x]
}

/// A body with its joint on the way outward.
struct Body {
    parent: Option<usize>,
    /// From the parent's (alpha, A) to its own.
    transform: Matrix3<f64>,
    /// Its joint's motion, and the joint's number.
    motion: Option<(Vector3<f64>, usize)>,
    /// What it accelerates by while nothing else does.
    drift: Vector3<f64>,
    inertia: Matrix3<f64>,
    bias: Vector3<f64>,
}

/// The accelerations by coordinate of a robot without mimic joints that nothing touches.
fn forward_dynamics(robot: &Robot, q: &[f64], v: &[f64], torque: &[f64]) -> Vec<f64> {
    let base = robot.base_dofs();
    let mut spins: Vec<f64> = Vec::new();
    let mut bodies: Vec<Body> = Vec::new();
    for own in &robot.bodies {
        let (mut parent, mut transform, mut motion, mut drift) = (None, Matrix3::identity(), None, Vector3::zeros());
        let mut spin = if base == 3 { v[2] } else { 0.0 };
        if let Some(mover) = own.joint {
            let (ahead, origin, axis) = robot.hinge(mover);
            let (at, rate) = match mover {
                ParentJoint::Joint(index) => (q[base + index], v[base + index]),
                _ => (0.0, 0.0),
            };
            let (mut arm, mut angle, turning) = ([origin.x, origin.z], 0.0, spins[ahead]);
            let mut across = [0.0; 2];
            (spin, parent) = (turning, Some(ahead));
            match (axis, mover) {
                (Some(Axis::Revolute { sign }), ParentJoint::Joint(index)) => {
                    (angle, spin) = (sign * at, turning + sign * rate);
                    motion = Some((Vector3::new(sign, 0.0, 0.0), index));
                }
                (Some(Axis::Prismatic { direction: Vector { x, z } }), ParentJoint::Joint(index)) => {
                    arm = [arm[0] + x * at, arm[1] + z * at];
                    across = [2.0 * turning * z * rate, -2.0 * turning * x * rate];
                    motion = Some((Vector3::new(0.0, x, z), index));
                }
                _ => {}
            }
            let back = |vector: [f64; 2]| turned(-angle, vector);
            let [lever, x, z] = [back([arm[1], -arm[0]]), back([1.0, 0.0]), back([0.0, 1.0])];
            transform = Matrix3::new(1.0, 0.0, 0.0, lever[0], x[0], z[0], lever[1], x[1], z[1]);
            let square = turning * turning;
            let [x, z] = back([across[0] - square * arm[0], across[1] - square * arm[1]]);
            drift = Vector3::new(0.0, x, z);
        }
        let (mass, Vector { x, z }) = (own.mass, own.com);
        let inertia = Matrix3::new(
            own.moment + mass * (x * x + z * z),
            mass * z,
            -mass * x,
            mass * z,
            mass,
            0.0,
            -mass * x,
            0.0,
            mass,
        );
        let bias = Vector3::new(0.0, -mass * spin * spin * x, -mass * spin * spin * z);
        spins.push(spin);
        bodies.push(Body { parent, transform, motion, drift, inertia, bias });
    }
    // Inward: (U, D, u) of each joint.
    let mut joints = vec![None; bodies.len()];
    for index in (0..bodies.len()).rev() {
        let Body { parent, transform, motion, drift, inertia, bias } = &bodies[index];
        let (mut inertia, mut bias) = (*inertia, *bias);
        if let Some((motion, joint)) = motion {
            let effect = inertia * motion;
            let (pivot, push) = (motion.dot(&effect), torque[*joint] - motion.dot(&bias));
            joints[index] = Some((effect, pivot, push));
            inertia -= effect * effect.transpose() / pivot;
            bias += effect * (push / pivot);
        }
        bias += inertia * drift;
        let (inertia, bias) = (transform.transpose() * inertia * transform, transform.transpose() * bias);
        if let Some(parent) = *parent {
            bodies[parent].inertia += inertia;
            bodies[parent].bias += bias;
        }
    }
    // Outward, against gravity: as if all were lifted.
    let mut found = vec![0.0; robot.dofs()];
    let mut all: Vec<Vector3<f64>> = Vec::new();
    for (index, Body { parent, transform, motion, drift, inertia, bias }) in bodies.iter().enumerate() {
        let mut own = match parent {
            Some(parent) => transform * all[*parent] + drift,
            None if robot.base == Base::Fixed => Vector3::new(0.0, 0.0, GRAVITY),
            None => -inertia.lu().solve(bias).expect("a mass"),
        };
        if let (Some((motion, joint)), Some((effect, pivot, push))) = (motion, joints[index]) {
            found[base + joint] = (push - effect.dot(&own)) / pivot;
            own += motion * found[base + joint];
        }
        all.push(own);
    }
    if base == 3 {
        let [x, z] = turned(q[2], [all[0][1], all[0][2]]);
        found[..3].copy_from_slice(&[x, z - GRAVITY, all[0][0]]);
    }
    found
}

/// A chain of links, each as heavy as the others.
fn chain(links: usize) -> Robot {
    let mut elements: Vec<String> =
        (0..links).map(|at| link(format!("link_{at}"), 1.0, [0.1, -0.2], 0.02, "")).collect();
    elements.extend((1..links).map(|at| {
        let ends = [at - 1, at].map(|end| format!("link_{end}"));
        joint(format!("joint_{at}"), HINGE, [&ends[0], &ends[1]], [0.0, -0.4], "")
    }));
    robot(&urdf::robot(&elements))
}

fn named(robot: &Robot, values: &[f64]) -> Value {
    let names: Vec<String> = robot.coordinates().map(str::to_owned).collect();
    by_name(&names, robot.base_dofs(), values)
}

fn robots() -> impl Iterator<Item = (String, Robot)> {
    let others = ROBOTS.into_iter().map(|own| {
        let (path, _): (String, Value) = robot_and_reference(own);
        let robot = robot(&read(&path));
        (path, robot)
    });
    others.chain([3, 10, 30].map(|links| (format!("chain of {links}"), chain(links))))
}

#[test]
fn mid_flight_is_that_of_articulated_bodies() {
    let mut random = Random::new(2);
    let mut worst = 0.0_f64;
    for (name, robot) in robots().filter(|(_, robot)| robot.mimic_joints.is_empty()) {
        for _ in 0..20 {
            let mut list = |most: f64| (0..robot.dofs()).map(|_| random.between(-most, most)).collect::<Vec<f64>>();
            let (q, v, torque) = (list(1.5), list(3.0), list(5.0)[robot.base_dofs()..].to_vec());
            let joints = robot.joints.iter().zip(&torque).map(|(joint, torque)| (joint.name.clone(), json!(torque)));
            let state = json!({"position": named(&robot, &q), "velocity": named(&robot, &v), "contacts": [],
                "torque": joints.collect::<Value>()});
            let expected = forward_dynamics(&robot, &q, &v, &torque);
            let size = expected.iter().fold(GRAVITY, |most: f64, entry| most.max(entry.abs()));
            for (found, expected) in outcomes(&forces(&robot, &state))[0].velocity().zip(&expected) {
                let off = (found - expected).abs() / size;
                worst = worst.max(off);
                assert!(off < 1e-11, "{name}: {found} {expected}, {off:e}");
            }
        }
    }
    println!("at most {worst:e} of the greatest acceleration");
}

/// Whatever robot is dropped, it falls as it is.
#[test]
fn robot_that_is_dropped_falls_with_gravity() {
    for (name, robot) in robots().filter(|(_, robot)| robot.base == Base::Floating) {
        let q: Vec<f64> = (0..robot.dofs()).map(|at| 0.3 * at as f64).collect();
        let found = forces(&robot, json!({"position": named(&robot, &q), "contacts": []}));
        for (at, found) in outcomes(&found)[0].velocity().enumerate() {
            let expected = if at == 1 { -GRAVITY } else { 0.0 };
            assert!((found - expected).abs() < 1e-11 * GRAVITY, "{name}: {found} of coordinate {at}");
        }
    }
}
