//! Poses of bodies and velocities of their points, by absolute angles and in the axes of the world.

use crate::balls::number::Number;
use heelstrike::robot::{Axis, MimicJoint, ParentJoint, Robot};

/// A pair in the plane, [forward, up].
pub type Pair<N> = [N; 2];

/// A body's pose in the world. Velocities of its origin and rates of its angle are per unit rate of each coordinate.
#[derive(Clone)]
pub struct Pose<N> {
    pub angle: N,
    turn: Pair<N>,
    pub origin: Pair<N>,
    velocities: Vec<Pair<N>>,
    pub rates: Vec<N>,
}

impl<N: Number> Pose<N> {
    /// A vector of the body's frame in the world's axes. A positive angle turns up toward forward.
    fn axes(&self, [x, z]: &Pair<N>) -> Pair<N> {
        let [cos, sin] = &self.turn;
        [cos.times(x).plus(&sin.times(z)), cos.times(z).minus(&sin.times(x))]
    }

    pub fn point(&self, local: &Pair<N>) -> Pair<N> {
        add(&self.origin, &self.axes(local))
    }

    /// Velocities of a point of the body, per unit rate of each coordinate.
    pub fn velocities(&self, point: &Pair<N>) -> Vec<Pair<N>> {
        let [x, z] = [0, 1].map(|k| point[k].minus(&self.origin[k]));
        let velocity =
            |(origin, rate): (&Pair<N>, &N)| [origin[0].plus(&z.times(rate)), origin[1].minus(&x.times(rate))];
        self.velocities.iter().zip(&self.rates).map(velocity).collect()
    }
}

pub fn add<N: Number>(a: &Pair<N>, b: &Pair<N>) -> Pair<N> {
    [a[0].plus(&b[0]), a[1].plus(&b[1])]
}

/// The sum of products; zeros are skipped.
pub fn dot<'a, N: Number + 'a>(pairs: impl IntoIterator<Item = (&'a N, &'a N)>, bits: usize) -> N {
    let mut sum = N::new(0.0, bits);
    for (a, b) in pairs {
        if !a.is_zero() && !b.is_zero() {
            sum = sum.plus(&a.times(b));
        }
    }
    sum
}

/// The poses of all bodies. The root's origin is at zero, because only differences of points count.
pub fn poses<N: Number>(robot: &Robot, position: &[N], bits: usize) -> Vec<Pose<N>> {
    let number = |value: f64| N::new(value, bits);
    let base = robot.base_dofs();
    let mut poses: Vec<Pose<N>> = Vec::with_capacity(robot.bodies().len());
    for body in robot.bodies() {
        let pose = match body.joint {
            None => {
                let angle = if base == 3 { position[2].clone() } else { number(0.0) };
                let origin = [number(0.0), number(0.0)];
                let (mut velocities, mut rates) = (vec![origin.clone(); robot.dofs()], vec![number(0.0); robot.dofs()]);
                if base == 3 {
                    velocities[0] = [number(1.0), number(0.0)];
                    velocities[1] = [number(0.0), number(1.0)];
                    rates[2] = number(1.0);
                }
                Pose { turn: angle.cos_sin(), angle, origin, velocities, rates }
            }
            Some(mover) => {
                // The joint's parent and origin, and if it moves its axis, coordinate and [multiplier, offset].
                let (parent, origin, moves) = match mover {
                    ParentJoint::Joint(index) => {
                        let joint = &robot.joints()[index];
                        (joint.parent, joint.origin, Some((joint.axis, base + index, [1.0, 0.0])))
                    }
                    ParentJoint::Mimic(index) => {
                        let MimicJoint { joint, mimicked, multiplier, offset } = &robot.mimic_joints()[index];
                        (joint.parent, joint.origin, Some((joint.axis, base + mimicked, [*multiplier, *offset])))
                    }
                    ParentJoint::Fixed { parent, origin } => (parent, origin, None),
                };
                let parent = &poses[parent];
                let mut pose = Pose { origin: parent.point(&origin.map(number).components()), ..parent.clone() };
                let (mut own, mut moved) = ([number(0.0), number(0.0)], 0);
                if let Some((axis, coordinate, [multiplier, offset])) = moves {
                    let multiplier = number(multiplier);
                    let displacement = multiplier.times(&position[coordinate]).plus(&number(offset));
                    match axis {
                        Axis::Revolute { sign } => {
                            pose.angle = parent.angle.plus(&displacement.times(&number(sign)));
                            pose.turn = pose.angle.cos_sin();
                            let rate = multiplier.times(&number(sign));
                            pose.rates[coordinate] = pose.rates[coordinate].plus(&rate);
                        }
                        Axis::Prismatic { direction } => {
                            let direction = parent.axes(&direction.map(number).components());
                            pose.origin = add(&pose.origin, &direction.clone().map(|entry| entry.times(&displacement)));
                            own = direction.map(|entry| entry.times(&multiplier));
                        }
                    }
                    moved = coordinate;
                }
                pose.velocities = parent.velocities(&pose.origin);
                if moves.is_some() {
                    pose.velocities[moved] = add(&pose.velocities[moved], &own);
                }
                pose
            }
        };
        poses.push(pose);
    }
    poses
}
