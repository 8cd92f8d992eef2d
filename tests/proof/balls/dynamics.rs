//! The contact problem of a robot and a state, by absolute poses and a dense mass matrix.
//!
//! ```text
//!     M = sum over bodies of m Jc^T Jc + I w^T w,    M = L D L^T,    Y = L^-1 J^T,    G = Y^T D^-1 Y
//! ```
//!
//! Angles are summed before their cosine is taken, every velocity is that of a point in the world, and only the poses
//! are recursive.

use crate::balls::loads::loads;
use crate::balls::number::Number;
use crate::balls::poses::{Pair, Pose, add, dot, poses};
use heelstrike::impact::{Friction, Mode};
use heelstrike::planar::Vector;
use heelstrike::robot::Robot;
use heelstrike::state::{Ground, LinkPoint, NamedContact, State};
use std::cmp::Ordering;

/// The contact problem; rows 2k (tangential) and 2k + 1 (normal) belong to contact k.
pub struct Problem<N> {
    /// G \[1/kg\].
    pub delassus: Vec<Vec<N>>,
    /// Contact velocities without an impulse of the ground \[m/s\].
    pub free: Vec<N>,
    /// c_n- of each contact, before any applied impulse \[m/s\].
    pub approach: Vec<N>,
    pub friction: Vec<Friction>,
    pub restitution: Vec<f64>,
    /// For forces: the mode in which a contact that slides already slides on.
    pub slides: Vec<Option<Mode>>,
    /// dq/dt before the impact, as a stance and loops determine it.
    pub velocity: Vec<N>,
    /// Change of dq/dt per unit of each row's impulse: the columns of M^-1 J^T; empty unless asked for.
    pub responses: Vec<Vec<N>>,
    /// (M^-1)_ii by coordinate, zero for a braked one; all zero unless asked for.
    pub ease: Vec<N>,
    /// The precision of all numbers.
    pub bits: usize,
}

/// A dense factorization M = L D L^T.
struct Factor<N> {
    /// L below the diagonal, D on it.
    rows: Vec<Vec<N>>,
    bits: usize,
}

impl<N: Number> Factor<N> {
    /// Factorizes M; `None` if a pivot is not certainly positive.
    fn new(mut rows: Vec<Vec<N>>, bits: usize) -> Option<Self> {
        for k in 0..rows.len() {
            let pivot = rows[k][k].clone();
            if pivot.sign() != Some(Ordering::Greater) {
                return None;
            }
            let column: Vec<N> = rows[k + 1..].iter().map(|row| row[k].clone()).collect();
            for (i, entry) in column.iter().enumerate() {
                if entry.is_zero() {
                    continue;
                }
                let row = &mut rows[k + 1 + i];
                row[k] = entry.over(&pivot);
                for (j, other) in column[..=i].iter().enumerate() {
                    if !other.is_zero() {
                        row[k + 1 + j] = row[k + 1 + j].minus(&row[k].times(other));
                    }
                }
            }
        }
        Some(Self { rows, bits })
    }

    /// L^-1 b.
    fn forward(&self, b: &[N]) -> Vec<N> {
        let mut solved: Vec<N> = Vec::with_capacity(b.len());
        for (row, entry) in self.rows.iter().zip(b) {
            let known = dot(row.iter().zip(&solved), self.bits);
            solved.push(entry.minus(&known));
        }
        solved
    }

    /// L^-T D^-1 b.
    fn backward(&self, b: &[N]) -> Vec<N> {
        let mut solved: Vec<N> = b.iter().zip(&self.rows).enumerate().map(|(k, (b, row))| b.over(&row[k])).collect();
        for k in (0..solved.len()).rev() {
            let below = (k + 1..solved.len()).map(|i| (&self.rows[i][k], &solved[i]));
            let known = dot(below, self.bits);
            solved[k] = solved[k].minus(&known);
        }
        solved
    }

    /// a^T D^-1 b.
    fn product(&self, a: &[N], b: &[N]) -> N {
        let mut sum = N::new(0.0, self.bits);
        for (k, (a, b)) in a.iter().zip(b).enumerate() {
            if !a.is_zero() && !b.is_zero() {
                sum = sum.plus(&a.times(b).over(&self.rows[k][k]));
            }
        }
        sum
    }
}

/// The terms of a state's equations.
pub struct Terms<N> {
    pub poses: Vec<Pose<N>>,
    /// The coordinates that move, without those of braked joints.
    pub free: Vec<usize>,
    /// The mass matrix of these coordinates, its lower triangle.
    pub mass_matrix: Vec<Vec<N>>,
    /// The ground's tangent and normal.
    pub axes: [Pair<N>; 2],
    /// J by contact, tangential and normal, over all coordinates.
    pub rows: Vec<[Vec<N>; 2]>,
    /// K, x and z of each loop, over all coordinates.
    pub loops: Vec<Vec<N>>,
}

/// A point of a link in its body's frame.
pub fn in_body<N: Number>(robot: &Robot, link: usize, offset: [f64; 3], bits: usize) -> Pair<N> {
    let number = |value: f64| N::new(value, bits);
    robot.links()[link].pose.map(|row| {
        let [x, y, z] = [0, 1, 2].map(|k| number(row[k]).times(&number(offset[k])));
        x.plus(&y).plus(&z).plus(&number(row[3]))
    })
}

/// The terms of a state at `position`; `None` if the ground is not straight.
pub fn terms<N: Number>(robot: &Robot, state: &State, position: &[N], bits: usize) -> Option<Terms<N>> {
    let number = |value: f64| N::new(value, bits);
    let scene = &state.scene;
    let poses = poses::<N>(robot, position, bits);
    let free: Vec<usize> = (0..robot.dofs())
        .filter(|coordinate| !scene.braked.iter().any(|held| robot.base_dofs() + held == *coordinate))
        .collect();

    let mut mass_matrix = vec![vec![number(0.0); free.len()]; free.len()];
    for (body, pose) in robot.bodies().iter().zip(&poses) {
        let velocities = pose.velocities(&pose.point(&body.com.map(number).components()));
        let [mass, moment] = [body.mass, body.moment].map(number);
        for (i, row) in mass_matrix.iter_mut().enumerate() {
            let pushed = velocities[free[i]].clone().map(|entry| entry.times(&mass));
            let spun = pose.rates[free[i]].times(&moment);
            for (j, entry) in row[..=i].iter_mut().enumerate() {
                let other = &velocities[free[j]];
                *entry = entry.plus(&dot(pushed.iter().zip(other), bits));
                *entry = entry.plus(&spun.times(&pose.rates[free[j]]));
            }
        }
    }
    for (own, rotor) in scene.rotor_inertia.iter().enumerate() {
        let mimic = own.checked_sub(robot.joints().len()).map(|mimic| &robot.mimic_joints()[mimic]);
        let (joint, ratio) = mimic.map_or((own, 1.0), |mimic| (mimic.mimicked, mimic.multiplier));
        let Some(at) = free.iter().position(|&coordinate| coordinate == robot.base_dofs() + joint) else { continue };
        let [rotor, ratio] = [*rotor, ratio].map(number);
        mass_matrix[at][at] = mass_matrix[at][at].plus(&rotor.times(&ratio).times(&ratio));
    }

    // The ground's tangent and normal. A positive slope, uphill toward +x, turns against the pitch. For a profile, here
    // of one segment, they are the rounded numbers that the product uses.
    let [cos, sin] = match &scene.ground {
        Ground::Slope(slope) => number(*slope).cos_sin(),
        Ground::Profile(profile) => {
            let [Vector { x, z }, Vector { x: to_x, z: to_z }] = profile.points()[..] else { return None };
            let length = f64::hypot(to_x - x, to_z - z);
            [number((to_x - x) / length), number((to_z - z) / length)]
        }
    };
    let axes = [[cos.clone(), sin.clone()], [sin.negative(), cos]];
    let row = |contact: &NamedContact| {
        let pose = &poses[robot.links()[contact.link].body];
        let radius = number(-contact.radius);
        let reach = axes[1].clone().map(|entry| entry.times(&radius));
        let point = add(&pose.point(&in_body(robot, contact.link, contact.offset, bits)), &reach);
        let velocities = pose.velocities(&point);
        axes.each_ref().map(|axis| velocities.iter().map(|v| dot(v.iter().zip(axis), bits)).collect())
    };
    let rows = scene.contacts.iter().flatten().map(row).collect();
    let moving = |end: LinkPoint| {
        let pose = &poses[robot.links()[end.link].body];
        pose.velocities(&pose.point(&in_body(robot, end.link, end.offset, bits)))
    };
    let ends = scene.loops.iter().map(|own| [own.a, own.b].map(moving));
    let tie = |[a, b]: [Vec<Pair<N>>; 2]| {
        [0, 1].map(|axis| a.iter().zip(&b).map(|(a, b)| a[axis].minus(&b[axis])).collect::<Vec<N>>())
    };
    let loops = ends.flat_map(tie).collect();
    Some(Terms { poses, free, mass_matrix, axes, rows, loops })
}

/// The contact problem of a state with named contacts; `None` if the mass matrix is not certainly positive definite.
///
/// A stance must name a link with one contact. Its contact and those that are `resting` are exactly at rest.
///
/// With `slips`, the signs of the contacts' sliding velocities, accelerations replace velocities: those of points by
/// second differences of their positions along q + v t, and generalized forces body by body (d'Alembert).
///
/// With `rates`, also computes how impulses change dq/dt.
pub fn problem<N: Number>(
    robot: &Robot,
    state: &State,
    resting: &[bool],
    slips: Option<&[Ordering]>,
    bits: usize,
    rates: bool,
) -> Option<Problem<N>> {
    let number = |value: f64| N::new(value, bits);
    let scene = &state.scene;
    let position: Vec<N> = state.position.iter().copied().map(number).collect();
    let Terms { poses, free, mass_matrix, axes, rows, loops } = terms(robot, state, &position, bits)?;
    let factor = Factor::new(mass_matrix, bits)?;
    let contacts = scene.contacts.as_deref().unwrap_or_default();
    let half =
        |row: &Vec<N>| factor.forward(&free.iter().map(|&coordinate| row[coordinate].clone()).collect::<Vec<N>>());
    let ties: Vec<Vec<N>> = loops.iter().map(half).collect();
    let products = |a: &[N]| ties.iter().map(|tie| factor.product(a, tie)).collect::<Vec<N>>();
    let tied = Factor::new(ties.iter().map(|tie| products(tie)).collect(), bits)?;

    let mut velocity: Vec<N> = state.velocity.iter().copied().map(number).collect();
    let stance = scene.stance.and_then(|link| contacts.iter().position(|contact| contact.link == link));
    if let Some(stance) = stance {
        // The base moves along the world's axes, so the tangential and normal components are turned back. They are
        // divided by the squared length of the ground's axes, which is not quite one for a rounded profile.
        let square = dot(axes[0].iter().zip(&axes[0]), bits);
        velocity[..2].fill(number(0.0));
        let [t, n] = rows[stance].each_ref().map(|row| dot(row.iter().zip(&velocity), bits).negative().over(&square));
        for k in 0..2 {
            velocity[k] = axes[0][k].times(&t).plus(&axes[1][k].times(&n));
        }
    }
    // The velocity becomes the nearest one, by kinetic energy, that keeps the loops closed.
    let openings: Vec<N> = loops.iter().map(|row| dot(row.iter().zip(&velocity), bits)).collect();
    for (tie, part) in ties.iter().zip(tied.backward(&tied.forward(&openings))) {
        for (&coordinate, entry) in free.iter().zip(factor.backward(tie)) {
            velocity[coordinate] = velocity[coordinate].minus(&entry.times(&part));
        }
    }
    let before = |(at, row): (usize, &Vec<N>)| {
        let rests = stance == Some(at / 2) || resting.get(at / 2) == Some(&true);
        if rests { number(0.0) } else { dot(row.iter().zip(&velocity), bits) }
    };
    let before: Vec<N> = rows.iter().flatten().enumerate().map(before).collect();

    let mut applied = vec![number(0.0); free.len()];
    for impulse in &scene.impulses {
        let pose = &poses[robot.links()[impulse.link].body];
        let velocities = pose.velocities(&pose.point(&in_body(robot, impulse.link, impulse.offset, bits)));
        let vector = impulse.vector.components().map(number);
        for (entry, coordinate) in applied.iter_mut().zip(&free) {
            *entry = entry.plus(&dot(velocities[*coordinate].iter().zip(&vector), bits));
        }
    }
    let mut opening = vec![number(0.0); loops.len()];
    let before = match slips {
        None => before,
        Some(_) => {
            let loads = loads(robot, state, &poses, &position, &velocity, bits);
            applied = free.iter().map(|&coordinate| loads.forces[coordinate].clone()).collect();
            opening = loads.openings;
            let along = |drift: &Pair<N>| axes.each_ref().map(|axis| dot(drift.iter().zip(axis), bits));
            loads.drifts.iter().flat_map(along).collect()
        }
    };
    let applied = factor.forward(&applied);
    let half: Vec<Vec<N>> = rows.iter().flatten().map(half).collect();
    // The coupling of each row to the loops, and the loops' own motion, by the factor of K M^-1 K^T.
    let held: Vec<Vec<N>> = half.iter().map(|row| tied.forward(&products(row))).collect();
    let pulled = products(&applied).iter().zip(&opening).map(|(own, opening)| own.plus(opening)).collect::<Vec<N>>();
    let pulled = tied.forward(&pulled);
    let mut delassus = vec![vec![number(0.0); half.len()]; half.len()];
    for i in 0..half.len() {
        for j in 0..=i {
            delassus[i][j] = factor.product(&half[i], &half[j]).minus(&tied.product(&held[i], &held[j]));
            delassus[j][i] = delassus[i][j].clone();
        }
    }
    let response = |half: &Vec<N>| {
        let mut response = vec![number(0.0); robot.dofs()];
        free.iter().zip(factor.backward(half)).for_each(|(&coordinate, entry)| response[coordinate] = entry);
        response
    };
    let mut ease = vec![number(0.0); robot.dofs()];
    for (at, &coordinate) in free.iter().enumerate().filter(|_| rates) {
        let unit: Vec<N> = (0..free.len()).map(|entry| number(if entry == at { 1.0 } else { 0.0 })).collect();
        let half = factor.forward(&unit);
        ease[coordinate] = factor.product(&half, &half);
    }
    Some(Problem {
        ease,
        responses: half.iter().filter(|_| rates).map(response).collect(),
        velocity,
        free: (before.iter().zip(half.iter().zip(&held)))
            .map(|(before, (row, held))| {
                before.plus(&factor.product(row, &applied)).minus(&tied.product(held, &pulled))
            })
            .collect(),
        approach: before.into_iter().skip(1).step_by(2).collect(),
        delassus,
        friction: contacts.iter().map(|contact| scene.friction.of(contact.link).expect("a friction")).collect(),
        restitution: match slips {
            None => contacts.iter().map(|contact| scene.restitution.of(contact.link).unwrap_or(0.0)).collect(),
            Some(_) => vec![0.0; contacts.len()],
        },
        slides: match slips {
            None => vec![None; contacts.len()],
            Some(slips) => slips.iter().map(|&slip| slip.is_ne().then(|| Mode::closed(slip))).collect(),
        },
        bits,
    })
}
