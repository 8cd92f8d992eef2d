//! Random planar trees of rigid bodies and their exact kinematics in absolute coordinates.
//!
//! The plane is x-z, angles turn right-handed about +y: [x, z] -> [c x + s z, -s x + c z]. Every body knows its turn,
//! its origin and the Jacobians of both, written down from the root outward; the mass matrix is the plain sum over
//! bodies of m Jc^T Jc + I w^T w.

use crate::support::random::Random;
use crate::support::rational::{Matrix, dot, ratio, times, to_f64, zeros};
use crate::support::urdf::{self, Axis};
use dashu_ratio::RBig;

/// [x, z].
pub type Point = [RBig; 2];

#[derive(Debug, Clone)]
pub enum Motion {
    /// About +y times the sign.
    Turn(i64),
    /// Along x and z in the parent's frame; whole numbers whose length is whole too.
    Slide([i64; 2]),
    /// None.
    Fixed,
}

#[derive(Debug, Clone)]
pub struct Body {
    pub parent: Option<usize>,
    pub motion: Motion,
    /// Length of the axis in the file, which must not matter.
    pub axis_length: i64,
    pub origin: Point,
    pub mass: RBig,
    pub com: Point,
    pub moment: RBig,
}

#[derive(Debug, Clone)]
pub struct Tree {
    pub bodies: Vec<Body>,
    /// Order of the links in the file.
    pub link_order: Vec<usize>,
    /// Order of the joints in the file, by their child body.
    pub joint_order: Vec<usize>,
}

/// q and v of a tree in the order x, z, pitch, joints of the file; of a turning coordinate q is held as cosine and
/// sine.
#[derive(Debug, Clone)]
pub struct Motions {
    pub cos: Vec<RBig>,
    pub sin: Vec<RBig>,
    pub displacement: Vec<RBig>,
    pub velocity: Vec<RBig>,
}

/// Turn, origin and their Jacobians of one body.
pub struct Placed {
    cos: RBig,
    sin: RBig,
    origin: Point,
    /// d origin / d q, rows x and z.
    origin_jacobian: [Vec<RBig>; 2],
    /// d turn / d q.
    turn_jacobian: Vec<RBig>,
}

impl Placed {
    /// A vector of the body's frame in the world's axes.
    fn turned(&self, [x, z]: &Point) -> Point {
        [&self.cos * x + &self.sin * z, &self.cos * z - &self.sin * x]
    }

    pub fn point(&self, local: &Point) -> Point {
        let [x, z] = self.turned(local);
        [&self.origin[0] + x, &self.origin[1] + z]
    }

    /// Jacobian of the material point that is at `arm` from the body's origin, in the world's axes.
    fn jacobian_at(&self, arm: &Point) -> [Vec<RBig>; 2] {
        let [dx, dz] = &self.origin_jacobian;
        [
            dx.iter().zip(&self.turn_jacobian).map(|(d, w)| d + w * &arm[1]).collect(),
            dz.iter().zip(&self.turn_jacobian).map(|(d, w)| d - w * &arm[0]).collect(),
        ]
    }

    pub fn jacobian(&self, local: &Point) -> [Vec<RBig>; 2] {
        self.jacobian_at(&self.turned(local))
    }

    /// Jacobian of the material point at the bottom of a circle.
    pub fn bottom_jacobian(&self, center: &Point, radius: &RBig) -> [Vec<RBig>; 2] {
        let [x, z] = self.turned(center);
        self.jacobian_at(&[x, z - radius])
    }
}

impl Tree {
    pub fn link(body: usize) -> String {
        format!("link_{body}")
    }

    pub fn joint(body: usize) -> String {
        format!("joint_{body}")
    }

    /// Child bodies of the moving joints in the file's order; the `k`th is coordinate 3 + k.
    pub fn moving(&self) -> Vec<usize> {
        self.joint_order.iter().copied().filter(|&body| !matches!(self.bodies[body].motion, Motion::Fixed)).collect()
    }

    pub fn dofs(&self) -> usize {
        3 + self.moving().len()
    }

    /// One to six bodies.
    pub fn random(random: &mut Random) -> Self {
        let count = random.pick(&[1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6, 6]);
        let point = |random: &mut Random| [ratio(random.whole(-4, 4), 4), ratio(random.whole(-4, 4), 4)];
        let bodies = (0..count).map(|body| {
            let motion = match random.whole(1, 10) {
                1 => Motion::Slide(random.pick(&[[1, 0], [0, 1], [-1, 0], [0, -1], [3, 4], [-4, 3]])),
                2 => Motion::Fixed,
                _ => Motion::Turn(random.pick(&[1, -1])),
            };
            Body {
                parent: (body > 0).then(|| random.whole(0, body as i64 - 1) as usize),
                motion: if body == 0 { Motion::Fixed } else { motion },
                axis_length: random.whole(1, 2),
                origin: if body == 0 { [RBig::ZERO, RBig::ZERO] } else { point(random) },
                mass: ratio(random.whole(1, 16), 4),
                com: point(random),
                moment: ratio(random.whole(0, 8), 16),
            }
        });
        let bodies: Vec<Body> = bodies.collect();
        let joints: Vec<usize> = random.permutation(count as usize - 1).into_iter().map(|joint| joint + 1).collect();
        Self { bodies, link_order: random.permutation(count as usize), joint_order: joints }
    }

    /// Where every body is.
    pub fn place(&self, motions: &Motions) -> Vec<Placed> {
        let dofs = self.dofs();
        let moving = self.moving();
        let unit = |coordinate: usize| {
            let mut row = vec![RBig::ZERO; dofs];
            row[coordinate] = RBig::ONE;
            row
        };
        let mut placed: Vec<Placed> = vec![Placed {
            cos: motions.cos[2].clone(),
            sin: motions.sin[2].clone(),
            origin: [motions.displacement[0].clone(), motions.displacement[1].clone()],
            origin_jacobian: [unit(0), unit(1)],
            turn_jacobian: unit(2),
        }];
        for (index, body) in self.bodies.iter().enumerate().skip(1) {
            let parent = &placed[body.parent.expect("only the root has none")];
            let coordinate = moving.iter().position(|&child| child == index).map(|joint| 3 + joint);
            let mut next = Placed {
                cos: parent.cos.clone(),
                sin: parent.sin.clone(),
                origin: parent.point(&body.origin),
                origin_jacobian: parent.jacobian(&body.origin),
                turn_jacobian: parent.turn_jacobian.clone(),
            };
            match (&body.motion, coordinate) {
                (Motion::Turn(sign), Some(k)) => {
                    let (c, s) = (&motions.cos[k], &motions.sin[k] * ratio(*sign, 1));
                    next.cos = &parent.cos * c - &parent.sin * &s;
                    next.sin = &parent.sin * c + &parent.cos * &s;
                    next.turn_jacobian[k] = ratio(*sign, 1);
                }
                (Motion::Slide([x, z]), Some(k)) => {
                    let length = ((x * x + z * z) as f64).sqrt() as i64;
                    let shift = &motions.displacement[k];
                    let local: Point = [ratio(*x, length), ratio(*z, length)];
                    let moved = [&body.origin[0] + &local[0] * shift, &body.origin[1] + &local[1] * shift];
                    next.origin = parent.point(&moved);
                    next.origin_jacobian = parent.jacobian(&moved);
                    let [along_x, along_z] = parent.turned(&local);
                    next.origin_jacobian[0][k] = along_x;
                    next.origin_jacobian[1][k] = along_z;
                }
                _ => {}
            }
            placed.push(next);
        }
        placed
    }

    /// M = sum of m Jc^T Jc + I w^T w.
    pub fn mass_matrix(&self, placed: &[Placed]) -> Matrix {
        let dofs = self.dofs();
        let mut matrix = zeros(dofs, dofs);
        for (body, place) in self.bodies.iter().zip(placed) {
            let [x, z] = place.jacobian(&body.com);
            for (factor, row) in [(&body.mass, &x), (&body.mass, &z), (&body.moment, &place.turn_jacobian)] {
                for i in 0..dofs {
                    if row[i].is_zero() {
                        continue;
                    }
                    let left = factor * &row[i];
                    for j in 0..dofs {
                        if !row[j].is_zero() {
                            matrix[i][j] += &left * &row[j];
                        }
                    }
                }
            }
        }
        matrix
    }

    /// The tree as a URDF file; every number in it is exact.
    pub fn urdf(&self) -> String {
        let links = self.link_order.iter().map(|&index| {
            let body = &self.bodies[index];
            urdf::link(Self::link(index), to_f64(&body.mass), body.com.each_ref().map(to_f64), to_f64(&body.moment), "")
        });
        let joints = self.joint_order.iter().map(|&index| {
            let body = &self.bodies[index];
            let axis = match body.motion {
                Motion::Turn(sign) => Axis::Revolute((sign * body.axis_length) as f64),
                Motion::Slide(along) => Axis::Prismatic(along.map(|x| (x * body.axis_length) as f64)),
                Motion::Fixed => Axis::Fixed,
            };
            let ends = [Self::link(body.parent.expect("only the root has none")), Self::link(index)];
            let joint =
                urdf::joint(Self::joint(index), axis, [&ends[0], &ends[1]], body.origin.each_ref().map(to_f64), "");
            if index % 2 == 0 { joint } else { joint.replace("revolute", "continuous") }
        });
        urdf::robot(&links.chain(joints).collect::<Vec<_>>())
    }

    /// A random state: angles with rational cosine and sine, the rest dyadic.
    pub fn random_motions(&self, random: &mut Random) -> Motions {
        let mut motions = Motions { cos: Vec::new(), sin: Vec::new(), displacement: Vec::new(), velocity: Vec::new() };
        let turns: Vec<bool> = [false, false, true]
            .into_iter()
            .chain(self.moving().iter().map(|&body| matches!(self.bodies[body].motion, Motion::Turn(_))))
            .collect();
        for turn in turns {
            let (cos, sin) = if turn { random_angle(random) } else { (RBig::ONE, RBig::ZERO) };
            motions.cos.push(cos);
            motions.sin.push(sin);
            motions.displacement.push(if turn { RBig::ZERO } else { ratio(random.whole(-4, 4), 4) });
            motions.velocity.push(ratio(random.whole(-16, 16), 8));
        }
        // What strikes the ground mostly falls.
        motions.velocity[1] -= ratio(random.whole(0, 8), 4);
        motions
    }
}

/// cos and sin of twice the angle whose tangent is p/q (Pythagorean triples).
fn random_angle(random: &mut Random) -> (RBig, RBig) {
    let (p, q) = random.pick(&[(0, 1), (1, 4), (1, 3), (1, 2), (2, 3), (3, 4), (1, 1), (3, 2), (2, 1)]);
    let p = p * random.pick(&[1, -1]);
    let length = q * q + p * p;
    (ratio(q * q - p * p, length), ratio(2 * p * q, length))
}

/// 1/2 v.M v.
pub fn kinetic_energy(mass_matrix: &Matrix, velocity: &[RBig]) -> RBig {
    dot(&times(mass_matrix, velocity), velocity) / ratio(2, 1)
}
