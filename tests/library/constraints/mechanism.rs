//! A planar mechanism written down twice: as URDF, and as Jacobians of its CoGs by which M = sum m J'J + I w'w is
//! summed up body by body, without recursion.

use crate::support::urdf::{self, Axis};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::state::{Defaults, State};
use heelstrike::{Result, Robot};
use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};

/// How a part moves against its parent.
#[derive(Debug, Clone, Copy)]
pub enum Joint {
    /// About +y or -y.
    Turn(f64),
    /// Along a direction of the parent's frame, of length one.
    Slide([f64; 2]),
}

/// A link behind a joint, both called the same.
#[derive(Debug, Clone)]
pub struct Part {
    pub name: &'static str,
    /// Of the parts before it, or the root.
    pub parent: &'static str,
    pub joint: Joint,
    pub origin: [f64; 2],
    pub mass: f64,
    pub com: [f64; 2],
    pub moment: f64,
    /// The joint it follows, multiplier, offset.
    pub follows: Option<(&'static str, f64, f64)>,
}

/// A floating root and its descendants.
#[derive(Debug, Clone)]
pub struct Mechanism {
    pub root: (f64, [f64; 2], f64),
    pub parts: Vec<Part>,
}

/// A part whose CoG lies at `com`, with some moment.
pub fn part(name: &'static str, parent: &'static str, origin: [f64; 2], mass: f64, com: [f64; 2]) -> Part {
    Part { name, parent, joint: Joint::Turn(1.0), origin, mass, com, moment: 0.02 * mass, follows: None }
}

impl Mechanism {
    pub fn urdf(&self) -> String {
        let (mass, com, moment) = self.root;
        let mut elements = vec![urdf::link("root", mass, com, moment, "")];
        for part in &self.parts {
            let axis = match part.joint {
                Joint::Turn(sign) => Axis::Revolute(sign),
                Joint::Slide(along) => Axis::Prismatic(along),
            };
            let mimic = part.follows.map_or(String::new(), |(mimicked, multiplier, offset)| {
                format!("<mimic joint=\"{mimicked}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>")
            });
            elements.push(urdf::link(part.name, part.mass, part.com, part.moment, ""));
            elements.push(urdf::joint(part.name, axis, [part.parent, part.name], part.origin, &mimic));
        }
        urdf::robot(&elements)
    }

    pub fn robot(&self) -> Robot {
        Robot::from_urdf(&self.urdf()).unwrap_or_else(|error| panic!("{error}\n{}", self.urdf()))
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.parts.iter().position(|part| part.name == name)
    }

    /// The parts with a coordinate of their own.
    pub fn independent(&self) -> Vec<usize> {
        (0..self.parts.len()).filter(|&index| self.parts[index].follows.is_none()).collect()
    }

    /// The coordinates of all joints from those that are independent, and T of v_all = T v.
    pub fn tied(&self, q: &[f64]) -> (Vec<f64>, DMatrix<f64>) {
        let independent = self.independent();
        let mut all = q[..3].to_vec();
        let mut map = DMatrix::zeros(3 + self.parts.len(), 3 + independent.len());
        map.view_mut((0, 0), (3, 3)).fill_with_identity();
        for (index, part) in self.parts.iter().enumerate() {
            let (leader, multiplier, offset) = match part.follows {
                Some((leader, multiplier, offset)) => (self.index(leader).expect("a leader"), multiplier, offset),
                None => (index, 1.0, 0.0),
            };
            let place = 3 + independent.iter().position(|&own| own == leader).expect("a leader that leads");
            all.push(multiplier * q[place] + offset);
            map[(3 + index, place)] = multiplier;
        }
        (all, map)
    }

    /// A part's angle, and its own and its origin's velocities for a unit rate of every joint.
    fn pose(&self, q: &[f64], name: &str) -> (f64, DVector<f64>, DMatrix<f64>) {
        let columns = 3 + self.parts.len();
        let Some(index) = self.index(name) else {
            let mut spin = DVector::zeros(columns);
            spin[2] = 1.0;
            let mut speed = DMatrix::zeros(2, columns);
            speed[(0, 0)] = 1.0;
            speed[(1, 1)] = 1.0;
            return (q[2], spin, speed);
        };
        let part = &self.parts[index];
        let (angle, mut spin, _) = self.pose(q, part.parent);
        let (value, column) = (q[3 + index], 3 + index);
        let shifted = match part.joint {
            Joint::Turn(_) => part.origin,
            Joint::Slide([x, z]) => [part.origin[0] + value * x, part.origin[1] + value * z],
        };
        let mut speed = self.point_rates(q, part.parent, shifted);
        let own = match part.joint {
            Joint::Turn(sign) => {
                spin[column] = sign;
                sign * value
            }
            Joint::Slide(direction) => {
                let along = turn(angle, direction);
                speed[(0, column)] = along[0];
                speed[(1, column)] = along[1];
                0.0
            }
        };
        (angle + own, spin, speed)
    }

    /// Velocity of a part's point for a unit rate of every joint (2 rows).
    pub fn point_rates(&self, q: &[f64], name: &str, offset: [f64; 2]) -> DMatrix<f64> {
        let (angle, spin, mut speed) = self.pose(q, name);
        let [x, z] = turn(angle, offset);
        for (column, spin) in spin.iter().enumerate() {
            // About +y: what lies above moves forward.
            speed[(0, column)] += spin * z;
            speed[(1, column)] -= spin * x;
        }
        speed
    }

    /// M of all joints, as if none followed another.
    pub fn mass_matrix(&self, q: &[f64]) -> DMatrix<f64> {
        let (mass, com, moment) = self.root;
        let bodies = self.parts.iter().map(|part| (part.name, part.mass, part.com, part.moment));
        let mut sum = DMatrix::zeros(3 + self.parts.len(), 3 + self.parts.len());
        for (name, mass, com, moment) in bodies.chain([("root", mass, com, moment)]) {
            let (_, spin, _) = self.pose(q, name);
            let speed = self.point_rates(q, name, com);
            sum += mass * speed.transpose() * &speed + moment * &spin * spin.transpose();
        }
        sum
    }

    /// A state of the independent coordinates.
    pub fn state(&self, q: &[f64], v: &[f64]) -> Value {
        let named = |values: &[f64]| {
            let joints = self.independent().into_iter().zip(&values[3..]);
            let joints: serde_json::Map<_, _> =
                joints.map(|(index, value)| (self.parts[index].name.to_owned(), json!(value))).collect();
            json!({"base": {"x": values[0], "z": values[1], "pitch": values[2]}, "joints": joints})
        };
        json!({"position": named(q), "velocity": named(v), "friction": 0.7})
    }
}

/// `[x, z]` turned by `angle` about +y.
fn turn(angle: f64, [x, z]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [cos * x + sin * z, cos * z - sin * x]
}

/// A point of a link, as states name it.
pub fn point(link: &str, [x, z]: [f64; 2]) -> Value {
    json!({"link": link, "offset": [x, 0.0, z]})
}

pub fn try_impact(robot: &Robot, state: &Value) -> Result<Impact> {
    let options = Options { matrices: true, ..Options::default() };
    let state = State::from_json(&state.to_string(), robot, &Defaults::default())?;
    Pipeline::new(robot, options).impact(&state)
}

pub fn impact(robot: &Robot, state: &Value) -> Impact {
    try_impact(robot, state).unwrap_or_else(|error| panic!("{error} {:?}\n{state}", error.remedy()))
}

pub fn matrix(rows: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
}

pub fn flat(vectors: &[[f64; 2]]) -> DVector<f64> {
    DVector::from_vec(vectors.concat())
}

/// Asserts that both agree to `parts` eps of the expected one's largest entry.
#[track_caller]
pub fn assert_near(found: &DMatrix<f64>, expected: &DMatrix<f64>, parts: f64) {
    assert_eq!(found.shape(), expected.shape());
    let error = (found - expected).amax() / expected.amax();
    assert!(error <= parts * f64::EPSILON, "{error:e}\n{found}\n{expected}");
}
