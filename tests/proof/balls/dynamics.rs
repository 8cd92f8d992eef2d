//! From a robot's numbers and a state to the contact problem, by absolute poses and a dense mass matrix.
//!
//! ```text
//!     M = sum over bodies of m Jc^T Jc + I w^T w,    M = L D L^T,    Y = L^-1 J^T,    G = Y^T D^-1 Y
//! ```
//!
//! Angles are summed before their cosine is taken, every velocity is that of a point in the world, and nothing is
//! recursive but the poses.

use crate::balls::number::Number;
use heelstrike::impact::{Friction, Mode};
use heelstrike::planar::Vector;
use heelstrike::robot::{Axis, ParentJoint, Robot};
use heelstrike::state::{Ground, NamedContact, State};
use std::cmp::Ordering;

/// What the contacts need to know; rows 2k (tangential) and 2k + 1 (normal) belong to contact k.
pub struct Problem<N> {
    /// G \[1/kg\].
    pub delassus: Vec<Vec<N>>,
    /// Velocities that the contacts had if the ground gave no impulse \[m/s\].
    pub free: Vec<N>,
    /// c_n- of each contact, before any applied impulse \[m/s\].
    pub approach: Vec<N>,
    pub friction: Vec<Friction>,
    pub restitution: Vec<f64>,
    /// Of contacts that slide already, the mode that they slide on with; forces are asked for then.
    pub slides: Vec<Option<Mode>>,
    /// dq/dt before the impact, that of a stance included.
    pub velocity: Vec<N>,
    /// What each row's impulse changes in dq/dt: the columns of M^-1 J^T; empty unless wanted.
    pub responses: Vec<Vec<N>>,
    /// (M^-1)_ii by coordinate, if wanted; zero of a braked one.
    pub ease: Vec<N>,
    /// The precision of all numbers.
    pub bits: usize,
}

/// A pair in the plane, [forward, up].
type Pair<N> = [N; 2];

/// A body's place in the world; velocities of its origin and rates of its angle are by coordinate, which moves at one.
#[derive(Clone)]
struct Pose<N> {
    angle: N,
    turn: Pair<N>,
    origin: Pair<N>,
    velocities: Vec<Pair<N>>,
    rates: Vec<f64>,
}

impl<N: Number> Pose<N> {
    /// A vector of the body's frame in the world's axes. A positive angle turns up toward forward.
    fn axes(&self, [x, z]: &Pair<N>) -> Pair<N> {
        let [cos, sin] = &self.turn;
        [cos.times(x).plus(&sin.times(z)), cos.times(z).minus(&sin.times(x))]
    }

    fn point(&self, local: &Pair<N>) -> Pair<N> {
        add(&self.origin, &self.axes(local))
    }

    /// Velocities of a point of the body.
    fn velocities(&self, point: &Pair<N>, bits: usize) -> Vec<Pair<N>> {
        let [x, z] = [0, 1].map(|k| point[k].minus(&self.origin[k]));
        let velocity = |(origin, &rate): (&Pair<N>, &f64)| {
            let rate = N::new(rate, bits);
            [origin[0].plus(&z.times(&rate)), origin[1].minus(&x.times(&rate))]
        };
        self.velocities.iter().zip(&self.rates).map(velocity).collect()
    }
}

fn add<N: Number>(a: &Pair<N>, b: &Pair<N>) -> Pair<N> {
    [a[0].plus(&b[0]), a[1].plus(&b[1])]
}

/// Sum of products, where zeros cost nothing.
fn dot<'a, N: Number + 'a>(pairs: impl IntoIterator<Item = (&'a N, &'a N)>, bits: usize) -> N {
    let mut sum = N::new(0.0, bits);
    for (a, b) in pairs {
        if !a.is_zero() && !b.is_zero() {
            sum = sum.plus(&a.times(b));
        }
    }
    sum
}

/// Where every body is; the root's origin lies at zero, since only differences of points count.
fn poses<N: Number>(robot: &Robot, position: &[N], bits: usize) -> Vec<Pose<N>> {
    let number = |value: f64| N::new(value, bits);
    let base = robot.base_dofs();
    let mut poses: Vec<Pose<N>> = Vec::with_capacity(robot.bodies.len());
    for body in &robot.bodies {
        let pose = match body.joint {
            None => {
                let angle = if base == 3 { position[2].clone() } else { number(0.0) };
                let origin = [number(0.0), number(0.0)];
                let (mut velocities, mut rates) = (vec![origin.clone(); robot.dofs()], vec![0.0; robot.dofs()]);
                if base == 3 {
                    velocities[0] = [number(1.0), number(0.0)];
                    velocities[1] = [number(0.0), number(1.0)];
                    rates[2] = 1.0;
                }
                Pose { turn: angle.cos_sin(), angle, origin, velocities, rates }
            }
            Some(ParentJoint::Mimic(_) | ParentJoint::Fixed { .. }) => unreachable!("no robot here has them"),
            Some(ParentJoint::Joint(index)) => {
                let joint = &robot.joints[index];
                let parent = &poses[joint.parent];
                let coordinate = base + index;
                let mut pose = Pose { origin: parent.point(&joint.origin.map(number).components()), ..parent.clone() };
                let displacement = position[coordinate].clone();
                let own = match joint.axis {
                    Axis::Revolute { sign } => {
                        pose.angle = parent.angle.plus(&displacement.times(&number(sign)));
                        pose.turn = pose.angle.cos_sin();
                        pose.rates[coordinate] = sign;
                        [number(0.0), number(0.0)]
                    }
                    Axis::Prismatic { direction } => {
                        let direction = parent.axes(&direction.map(number).components());
                        pose.origin = add(&pose.origin, &direction.clone().map(|entry| entry.times(&displacement)));
                        direction
                    }
                };
                pose.velocities = parent.velocities(&pose.origin, bits);
                pose.velocities[coordinate] = own;
                pose
            }
        };
        poses.push(pose);
    }
    poses
}

/// A dense factorization M = L D L^T.
struct Factor<N> {
    /// Below the diagonal L, on it D.
    rows: Vec<Vec<N>>,
    bits: usize,
}

impl<N: Number> Factor<N> {
    /// `None` if a pivot is not positive for certain.
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

    /// a D^-1 b.
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

/// The contact problem of a state whose contacts are named; `None` if the mass matrix is not positive for certain.
///
/// A stance must name a link with one contact; those that are `resting` are exactly at rest, too.
///
/// With `slips`, the signs of the contacts' sliding velocities, all have accelerations in place of velocities: those of
/// points by second differences of their places on the way q + v t, and generalized forces body by body (d'Alembert).
pub fn problem<N: Number>(
    robot: &Robot,
    state: &State,
    resting: &[bool],
    slips: Option<&[Ordering]>,
    bits: usize,
) -> Option<Problem<N>> {
    problem_and_rates(robot, state, resting, slips, bits, false)
}

/// As [`problem`], with what impulses do to dq/dt if `rates` are wanted.
pub fn problem_and_rates<N: Number>(
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
    let poses = poses::<N>(robot, &position, bits);
    let free: Vec<usize> = (0..robot.dofs())
        .filter(|coordinate| !scene.braked.iter().any(|held| robot.base_dofs() + held == *coordinate))
        .collect();

    let mut mass_matrix = vec![vec![number(0.0); free.len()]; free.len()];
    for (body, pose) in robot.bodies.iter().zip(&poses) {
        let velocities = pose.velocities(&pose.point(&body.com.map(number).components()), bits);
        let [mass, moment] = [body.mass, body.moment].map(number);
        for (i, row) in mass_matrix.iter_mut().enumerate() {
            let pushed = velocities[free[i]].clone().map(|entry| entry.times(&mass));
            let spun = number(pose.rates[free[i]]).times(&moment);
            for (j, entry) in row[..=i].iter_mut().enumerate() {
                let other = &velocities[free[j]];
                *entry = entry.plus(&dot(pushed.iter().zip(other), bits));
                *entry = entry.plus(&spun.times(&number(pose.rates[free[j]])));
            }
        }
    }
    for (i, coordinate) in free.iter().enumerate() {
        let rotor = coordinate.checked_sub(robot.base_dofs()).and_then(|joint| scene.rotor_inertia.get(joint));
        mass_matrix[i][i] = mass_matrix[i][i].plus(&number(rotor.copied().unwrap_or(0.0)));
    }
    let factor = Factor::new(mass_matrix, bits)?;

    // The ground's tangent and normal; uphill toward +x is a turn against the pitch. Of a profile, here of one segment,
    // they are the rounded numbers that the product works with.
    let [cos, sin] = match &scene.ground {
        Ground::Slope(slope) => number(*slope).cos_sin(),
        Ground::Profile(profile) => {
            let [Vector { x, z }, Vector { x: to_x, z: to_z }] = profile.points()[..] else { return None };
            let length = f64::hypot(to_x - x, to_z - z);
            [number((to_x - x) / length), number((to_z - z) / length)]
        }
    };
    let axes = [[cos.clone(), sin.clone()], [sin.negative(), cos]];
    let in_body = |link: usize, offset: [f64; 3]| {
        robot.links[link].pose.map(|row| {
            let [x, y, z] = [0, 1, 2].map(|k| number(row[k]).times(&number(offset[k])));
            x.plus(&y).plus(&z).plus(&number(row[3]))
        })
    };
    let contacts = scene.contacts.as_deref().unwrap_or_default();
    let rows: Vec<[Vec<N>; 2]> = contacts
        .iter()
        .map(|contact| {
            let pose = &poses[robot.links[contact.link].body];
            let radius = number(-contact.radius);
            let reach = axes[1].clone().map(|entry| entry.times(&radius));
            let point = add(&pose.point(&in_body(contact.link, contact.offset)), &reach);
            let velocities = pose.velocities(&point, bits);
            let along = |axis: &Pair<N>| velocities.iter().map(|v| dot(v.iter().zip(axis), bits)).collect();
            [along(&axes[0]), along(&axes[1])]
        })
        .collect();

    let mut velocity: Vec<N> = state.velocity.iter().copied().map(number).collect();
    let stance = scene.stance.and_then(|link| contacts.iter().position(|contact| contact.link == link));
    if let Some(stance) = stance {
        // x and z go along the world's axes, so that the tangent's and normal's share are to be turned back; both are
        // as long as the ground's axes, which a profile's rounding leaves not quite at one.
        let square = dot(axes[0].iter().zip(&axes[0]), bits);
        velocity[..2].fill(number(0.0));
        let [t, n] = rows[stance].each_ref().map(|row| dot(row.iter().zip(&velocity), bits).negative().over(&square));
        for k in 0..2 {
            velocity[k] = axes[0][k].times(&t).plus(&axes[1][k].times(&n));
        }
    }
    let before = |(at, row): (usize, &Vec<N>)| {
        let rests = stance == Some(at / 2) || resting.get(at / 2) == Some(&true);
        if rests { number(0.0) } else { dot(row.iter().zip(&velocity), bits) }
    };
    let before: Vec<N> = rows.iter().flatten().enumerate().map(before).collect();

    let mut applied = vec![number(0.0); free.len()];
    for impulse in &scene.impulses {
        let pose = &poses[robot.links[impulse.link].body];
        let velocities = pose.velocities(&pose.point(&in_body(impulse.link, impulse.offset)), bits);
        let vector = impulse.vector.components().map(number);
        for (entry, coordinate) in applied.iter_mut().zip(&free) {
            *entry = entry.plus(&dot(velocities[*coordinate].iter().zip(&vector), bits));
        }
    }
    let before = match slips {
        None => before,
        Some(_) => {
            // A third of the digits for the step: its square and what is left of the difference stay small.
            let step = number(f64::exp2(-(bits as f64 / 3.0).floor()));
            let moved = |way: f64| {
                let shift = step.times(&number(way));
                let at: Vec<N> = position.iter().zip(&velocity).map(|(q, v)| q.plus(&v.times(&shift))).collect();
                self::poses(robot, &at, bits)
            };
            let ways = [moved(-1.0), moved(1.0)];
            let accelerated = |body: usize, local: &Pair<N>| -> Pair<N> {
                let [at, behind, ahead] = [&poses, &ways[0], &ways[1]].map(|poses| poses[body].point(local));
                let second = |k: usize| behind[k].plus(&ahead[k]).minus(&at[k]).minus(&at[k]);
                [second(0), second(1)].map(|entry| entry.over(&step).over(&step))
            };
            let gravity = number(scene.gravity.unwrap_or(9.81));
            for (at, body) in robot.bodies.iter().enumerate() {
                let com = body.com.map(number).components();
                let [x, z] = accelerated(at, &com).map(|entry| entry.times(&number(-body.mass)));
                let force = [x, z.minus(&gravity.times(&number(body.mass)))];
                let velocities = poses[at].velocities(&poses[at].point(&com), bits);
                for (entry, coordinate) in applied.iter_mut().zip(&free) {
                    *entry = entry.plus(&dot(velocities[*coordinate].iter().zip(&force), bits));
                }
            }
            for (entry, coordinate) in applied.iter_mut().zip(&free) {
                let torque = coordinate.checked_sub(robot.base_dofs()).and_then(|joint| scene.torque.get(joint));
                *entry = entry.plus(&number(torque.copied().unwrap_or(0.0)));
            }
            let drift = |contact: &NamedContact| {
                let center = in_body(contact.link, contact.offset);
                let drift = accelerated(robot.links[contact.link].body, &center);
                axes.each_ref().map(|axis| dot(drift.iter().zip(axis), bits))
            };
            contacts.iter().flat_map(drift).collect()
        }
    };
    let applied = factor.forward(&applied);
    let half: Vec<Vec<N>> = rows
        .iter()
        .flatten()
        .map(|row| factor.forward(&free.iter().map(|&coordinate| row[coordinate].clone()).collect::<Vec<N>>()))
        .collect();
    let mut delassus = vec![vec![number(0.0); half.len()]; half.len()];
    for i in 0..half.len() {
        for j in 0..=i {
            delassus[i][j] = factor.product(&half[i], &half[j]);
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
        free: before.iter().zip(&half).map(|(before, row)| before.plus(&factor.product(row, &applied))).collect(),
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
