//! A robot compiled for the hot path: flat arrays, held joints without a coordinate of their own.
//!
//! ```text
//!     Robot + held joints + rotor inertias --> Plan<T>
//! ```
//!
//! Moving coordinates are the *columns* of the plan. They are numbered from the root outward, so that a column's parent
//! (the nearest moving joint below it in the tree, lambda in Featherstone 2008) comes before it; the coordinates of the
//! user's q keep the file's order. A held joint keeps its place in the chain of bodies and loses its column.

use crate::planar::{Inertia, Rotation, Vector, dot, scaled};
use crate::robot::{Axis, Base, Robot};
use crate::scalar::Real;

/// A robot compiled in numbers of kind `T`.
#[derive(Debug, Clone)]
pub struct Plan<T = f64> {
    /// Bodies from the root outward.
    pub(crate) bodies: Vec<PlanBody<T>>,
    /// Parent column of each column.
    pub(crate) parents: Vec<Option<usize>>,
    /// Coordinate (index into q) of each column.
    pub(crate) coordinates: Vec<usize>,
    pub(crate) floating: bool,
}

/// A rigid body and the joint that moves it.
#[derive(Debug, Clone)]
pub(crate) struct PlanBody<T> {
    pub parent: Option<usize>,
    /// Origin of the joint in the parent's frame \[m\].
    pub origin: Vector<T>,
    pub motion: Motion<T>,
    /// The joint's coordinate; of no meaning for the root.
    pub coordinate: usize,
    /// The joint's column, or for the root the last of the base (pitch); none where it is held or bolted.
    pub column: Option<usize>,
    /// About the body's origin, in its own axes.
    pub inertia: Inertia<T>,
    /// Added to the mass matrix's diagonal \[kg m^2\].
    pub rotor: T,
}

/// The joint's motion in numbers of the plan.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Motion<T> {
    Root,
    Turn { sign: T },
    Slide { direction: Vector<T> },
}

/// Cosines, sines and displacements of a configuration, one entry per coordinate of q: of pitch and revolute joints cosine
/// and sine, of x, z and prismatic joints the displacement \[m\].
#[derive(Debug, Clone)]
pub struct Posture<T = f64> {
    /// Cosine of each angle.
    pub cos: Vec<T>,
    /// Sine of each angle.
    pub sin: Vec<T>,
    /// Each displacement \[m\].
    pub displacement: Vec<T>,
}

impl<T> Default for Posture<T> {
    fn default() -> Self {
        Self { cos: Vec::new(), sin: Vec::new(), displacement: Vec::new() }
    }
}

impl Posture {
    /// Takes the cosines and sines of `position` (q), the same bits on every platform.
    pub fn set(&mut self, position: &[f64]) {
        self.displacement.clear();
        self.displacement.extend_from_slice(position);
        self.cos.clear();
        self.sin.clear();
        for &angle in position {
            let Rotation { cos, sin } = Rotation::by(angle);
            self.cos.push(cos);
            self.sin.push(sin);
        }
    }
}

impl<T: Real> Posture<T> {
    pub(crate) fn turn(&self, coordinate: usize) -> Rotation<T> {
        Rotation { cos: self.cos[coordinate], sin: self.sin[coordinate] }
    }
}

impl<T: Real> Plan<T> {
    /// Compiles `robot` with the joints `held` (indices into [`Robot::joints`]) kept at their rate, and `rotor_inertia`
    /// per joint (empty for none) \[kg m^2\].
    pub fn new(robot: &Robot, held: &[usize], rotor_inertia: &[f64]) -> Self {
        let base = robot.base_dofs();
        let floating = robot.base == Base::Floating;
        let mut plan = Self {
            bodies: Vec::with_capacity(robot.bodies.len()),
            parents: if floating { vec![None, Some(0), Some(1)] } else { Vec::new() },
            coordinates: (0..base).collect(),
            floating,
        };
        for body in &robot.bodies {
            let number = |entry: f64| T::from_f64(entry);
            let com = body.com.map(number);
            let mass = number(body.mass);
            let inertia =
                Inertia { mass, first: scaled(mass, com), second: number(body.moment) + mass * dot(com, com) };
            let Some(index) = body.joint else {
                plan.bodies.push(PlanBody {
                    parent: None,
                    origin: [T::zero(); 2],
                    motion: Motion::Root,
                    coordinate: 0,
                    column: floating.then_some(2),
                    inertia,
                    rotor: T::zero(),
                });
                continue;
            };
            let joint = &robot.joints[index];
            let coordinate = base + index;
            let column = (!held.contains(&index)).then(|| {
                let below = std::iter::successors(Some(joint.parent), |&body| plan.bodies[body].parent);
                let parent = below.filter_map(|body| plan.bodies[body].column).next();
                plan.parents.push(parent);
                plan.coordinates.push(coordinate);
                plan.coordinates.len() - 1
            });
            plan.bodies.push(PlanBody {
                parent: Some(joint.parent),
                origin: joint.origin.map(number),
                motion: match joint.axis {
                    Axis::Turn { sign } => Motion::Turn { sign: number(sign) },
                    Axis::Slide { direction } => Motion::Slide { direction: direction.map(number) },
                },
                coordinate,
                column,
                inertia,
                rotor: number(rotor_inertia.get(index).copied().unwrap_or(0.0)),
            });
        }
        plan
    }

    /// Number of columns: the coordinates that are not held.
    pub fn columns(&self) -> usize {
        self.coordinates.len()
    }

    /// The coordinate (index into q) of each column, from the root outward.
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }
}
