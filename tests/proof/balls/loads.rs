//! The loads on a robot in sustained contact, and whether its motion and its forces balance.
//!
//! ```text
//!     h = torques + gravity - m J_com^T (d^2/dt^2 of the place on the way q + v t)      M a = h + J^T f + K^T l
//! ```
//!
//! Accelerations are second differences of positions, so that no velocity-dependent term is written out. Springs act by
//! virtual work on the velocities of their points.

use crate::balls::dynamics::{Terms, in_body, terms};
use crate::balls::number::{Ball, Number};
use crate::balls::poses::{Pair, Pose, dot, poses};
use heelstrike::impact::Outcome;
use heelstrike::robot::Robot;
use heelstrike::state::{LinkPoint, SpringEnd, State, VirtualSpring};

/// Loads and accelerations while no coordinate accelerates.
pub struct Loads<N> {
    /// h by coordinate; on a floating base without the springs' part.
    pub forces: Vec<N>,
    /// Acceleration of each contact's center, x and z.
    pub drifts: Vec<Pair<N>>,
    /// kappa: the acceleration by which each loop opens, x and z.
    pub openings: Vec<N>,
}

/// Joint torques of a spring, by coordinate; zero for a floating base.
fn spring<N: Number>(
    robot: &Robot,
    VirtualSpring { a, b, laws }: &VirtualSpring,
    poses: &[Pose<N>],
    (position, velocity): (&[N], &[N]),
    bits: usize,
) -> Vec<N> {
    let number = |value: f64| N::new(value, bits);
    let base = robot.base_dofs();
    let still = || vec![[number(0.0), number(0.0)]; robot.dofs()];
    // Position and pitch of an end, and their rates by coordinate.
    let end = |LinkPoint { link, offset }: LinkPoint| {
        let pose = &poses[robot.links()[link].body];
        let [x, z] = pose.point(&in_body(robot, link, offset, bits));
        let velocities = pose.velocities(&[x.clone(), z.clone()]);
        let place = match base {
            3 => [x.plus(&position[0]), z.plus(&position[1])],
            _ => [x, z],
        };
        (place, pose.angle.clone(), velocities, pose.rates.clone())
    };
    let (place_a, pitch_a, ways_a, rates_a) = end(*a);
    let (place_b, pitch_b, ways_b, rates_b) = match b {
        SpringEnd::Link(point) => end(*point),
        SpringEnd::World(place) => {
            (place.components().map(number), number(0.0), still(), vec![number(0.0); robot.dofs()])
        }
    };
    let ways = |axis: usize| -> Vec<N> {
        match axis {
            2 => rates_a.iter().zip(&rates_b).map(|(a, b)| a.minus(b)).collect(),
            _ => ways_a.iter().zip(&ways_b).map(|(a, b)| a[axis].minus(&b[axis])).collect(),
        }
    };
    let distance = [place_a[0].minus(&place_b[0]), place_a[1].minus(&place_b[1]), pitch_a.minus(&pitch_b)];
    let mut torque = vec![number(0.0); robot.dofs()];
    for (axis, (law, distance)) in laws.iter().zip(&distance).enumerate() {
        let ways = ways(axis);
        let rate = dot(ways.iter().zip(velocity), bits);
        let stretched = number(law.target).minus(distance).times(&number(law.stiffness));
        let force = stretched.minus(&rate.times(&number(law.damping))).plus(&number(law.constant));
        for (entry, way) in torque.iter_mut().zip(&ways).skip(base) {
            *entry = entry.plus(&way.times(&force));
        }
    }
    torque
}

/// The loads of a state whose bodies have these `poses`, for a `velocity` (dq/dt).
pub fn loads<N: Number>(
    robot: &Robot,
    state: &State,
    poses: &[Pose<N>],
    position: &[N],
    velocity: &[N],
    bits: usize,
) -> Loads<N> {
    let number = |value: f64| N::new(value, bits);
    let scene = &state.scene;
    // The step takes a third of the digits: its square and the rounding of the difference both stay small.
    let step = step::<N>(bits);
    let moved = |way: f64| {
        let shift = step.times(&number(way));
        let at: Vec<N> = position.iter().zip(velocity).map(|(q, v)| q.plus(&v.times(&shift))).collect();
        self::poses(robot, &at, bits)
    };
    let ways = [moved(-1.0), moved(1.0)];
    let accelerated = |body: usize, local: &Pair<N>| -> Pair<N> {
        let [at, behind, ahead] = [poses, &ways[0], &ways[1]].map(|poses| poses[body].point(local));
        let second = |k: usize| behind[k].plus(&ahead[k]).minus(&at[k]).minus(&at[k]);
        [second(0), second(1)].map(|entry| entry.over(&step).over(&step))
    };
    let gravity = number(scene.gravity.unwrap_or(9.81));
    let mut forces = vec![number(0.0); robot.dofs()];
    for (at, body) in robot.bodies().iter().enumerate() {
        let com = body.com.map(number).components();
        let [x, z] = accelerated(at, &com).map(|entry| entry.times(&number(-body.mass)));
        let force = [x, z.minus(&gravity.times(&number(body.mass)))];
        let velocities = poses[at].velocities(&poses[at].point(&com));
        for (entry, velocity) in forces.iter_mut().zip(&velocities) {
            *entry = entry.plus(&dot(velocity.iter().zip(&force), bits));
        }
    }
    for (entry, &torque) in forces[robot.base_dofs()..].iter_mut().zip(&scene.torque) {
        *entry = entry.plus(&number(torque));
    }
    for own in &scene.springs {
        let torque = spring(robot, own, poses, (position, velocity), bits);
        forces.iter_mut().zip(&torque).for_each(|(entry, torque)| *entry = entry.plus(torque));
    }
    let drift =
        |link: usize, offset: [f64; 3]| accelerated(robot.links()[link].body, &in_body(robot, link, offset, bits));
    let opening = |[a, b]: [LinkPoint; 2]| {
        let [a, b] = [a, b].map(|end| drift(end.link, end.offset));
        [a[0].minus(&b[0]), a[1].minus(&b[1])]
    };
    Loads {
        forces,
        drifts: scene.contacts.iter().flatten().map(|contact| drift(contact.link, contact.offset)).collect(),
        openings: scene.loops.iter().flat_map(|own| opening([own.a, own.b])).collect(),
    }
}

fn step<N: Number>(bits: usize) -> N {
    N::new(f64::exp2(-(bits as f64 / 3.0).floor()), bits)
}

/// The imbalance of the printed forces and accelerations of an `outcome`, relative to the size of the terms: first of M
/// a = h + J^T f + K^T l, with each row divided by the root of its diagonal entry of M; then of the rate of kinetic
/// energy against the power of all loads, the contacts' `power` included. The second is `None` if a brake may take
/// power or nothing moves.
pub fn imbalance(robot: &Robot, state: &State, outcome: &Outcome, power: f64) -> Option<(f64, Option<f64>)> {
    let bits = 256;
    let number = |value: f64| Ball::new(value, bits);
    let numbers = |list: &[f64]| list.iter().copied().map(number).collect::<Vec<Ball>>();
    let (position, velocity) = (numbers(&state.position), numbers(&state.velocity));
    let acceleration = numbers(&outcome.velocity().collect::<Vec<_>>());
    let Terms { poses, free, mass_matrix, rows, loops, .. } = terms::<Ball>(robot, state, &position, bits)?;
    let Loads { forces, .. } = loads(robot, state, &poses, &position, &velocity, bits);
    let pulls: Vec<f64> = outcome.loop_impulse.iter().flatten().flat_map(|own| own.components()).collect();
    let pushes = rows.iter().flatten().zip(outcome.impulse.as_flattened()).chain(loops.iter().zip(&pulls));
    let pushes: Vec<(&Vec<Ball>, Ball)> = pushes.map(|(row, &force)| (row, number(force))).collect();
    let (mut worst, mut largest, mut work) = (0.0_f64, f64::MIN_POSITIVE, 0.0);
    for (i, &coordinate) in free.iter().enumerate() {
        let mass = |j: usize| &mass_matrix[i.max(j)][i.min(j)];
        let inertia = free.iter().enumerate().map(|(j, &other)| mass(j).times(&acceleration[other]).negative());
        let terms = inertia.chain(pushes.iter().map(|(row, force)| row[coordinate].times(force)));
        let (sum, size) = terms
            .chain([forces[coordinate].clone()])
            .fold((number(0.0), 0.0), |(sum, size), term| (sum.plus(&term), size + term.size()));
        // The division makes rows comparable, whatever their units.
        let inertia = mass(i).size().sqrt();
        (worst, largest) = (worst.max(sum.size() / inertia), largest.max(size / inertia));
        work += size * velocity[coordinate].size();
    }
    if !state.scene.braked.is_empty() || work == 0.0 {
        return Some((worst / largest, None));
    }
    // A central difference: its error is step^2 = 2^-170 = 1e-51 of the next derivatives.
    let step = step::<Ball>(bits);
    let energy = |way: f64| {
        let time = step.times(&number(way));
        let half = number(0.5).times(&time).times(&time);
        let ahead = |((q, v), a): ((&Ball, &Ball), &Ball)| q.plus(&v.times(&time)).plus(&a.times(&half));
        let at: Vec<Ball> = position.iter().zip(&velocity).zip(&acceleration).map(ahead).collect();
        let rates: Vec<Ball> = velocity.iter().zip(&acceleration).map(|(v, a)| v.plus(&a.times(&time))).collect();
        let mass = terms::<Ball>(robot, state, &at, bits)?.mass_matrix;
        let twice = (0..rates.len()).flat_map(|i| (0..rates.len()).map(move |j| (i, j)));
        let parts = twice.map(|(i, j)| mass[i.max(j)][i.min(j)].times(&rates[i]).times(&rates[j]));
        Some(parts.fold(number(0.0), |sum, part| sum.plus(&part)).times(&number(0.5)))
    };
    let change = energy(1.0)?.minus(&energy(-1.0)?).over(&step.plus(&step));
    let gravity = number(state.scene.gravity.unwrap_or(9.81));
    let mut given = number(power);
    for (body, pose) in robot.bodies().iter().zip(&poses) {
        let com = pose.velocities(&pose.point(&body.com.map(number).components()));
        let rise = com.iter().zip(&velocity).fold(number(0.0), |sum, (way, rate)| sum.plus(&way[1].times(rate)));
        given = given.minus(&rise.times(&gravity).times(&number(body.mass)));
    }
    let mut torque = vec![number(0.0); robot.dofs()];
    for (entry, &own) in torque[robot.base_dofs()..].iter_mut().zip(&state.scene.torque) {
        *entry = number(own);
    }
    for own in &state.scene.springs {
        let asked = spring(robot, own, &poses, (&position, &velocity), bits);
        torque.iter_mut().zip(&asked).for_each(|(entry, asked)| *entry = entry.plus(asked));
    }
    let given = given.plus(&dot(torque.iter().zip(&velocity), bits));
    Some((worst / largest, Some(change.minus(&given).size() / work)))
}
