//! A robot compiled for the hot path: flat arrays, without columns for braked joints.
//!
//! ```text
//!     Robot + braked joints + rotor inertias --> Plan<T>
//! ```
//!
//! Moving coordinates are the *columns* of the plan. They are numbered from the root outward, so that a column's parent
//! (the nearest moving joint below it in the tree, lambda in Featherstone 2008) comes before it; the coordinates of the
//! user's q keep the file's order. A braked joint keeps its place in the chain of bodies and loses its column.
//!
//! A mimic joint shares the column of the mimicked one, and its motion is that for a unit rate of that joint:
//!
//! ```text
//!     v_joints = T v,   M = T^T M_joints T,   J = J_joints T         a row of T has one entry: 1, or the multiplier
//! ```
//!
//! T is never formed: what several bodies bring to one entry is added up. A column then belongs to more than one
//! branch, and its parent is that of the elimination tree: the factorization fills in nothing beyond its ancestors.

use crate::planar::{Inertia, Rotation, Vector};
use crate::robot::{Axis, Base, MimicJoint, ParentJoint, Robot};
use crate::scalar::{Real, Trigonometry};

/// From how many columns on in one branch a plan is long.
const LONG: usize = 12;

/// The parent of a column that has none.
const NONE: usize = usize::MAX;

/// A robot compiled in numbers of kind `T`.
#[derive(Debug, Clone, Default)]
pub struct Plan<T = f64> {
    /// Bodies from the root outward.
    pub(crate) bodies: Vec<PlanBody<T>>,
    /// Parent of each column in the elimination tree of M, [`NONE`] if it has none; without mimic joints the nearest moving
    /// joint below it.
    parents: Vec<usize>,
    /// The coordinate (index into q) of each column, from the root outward.
    pub(crate) coordinates: Vec<usize>,
    /// Entries of a [`Configuration`]: coordinates and mimic joints.
    pub(crate) places: usize,
    pub(crate) floating: bool,
    /// Whether some column moves more than one joint.
    pub(crate) has_mimics: bool,
    /// Whether a joint slides, braked or not.
    pub(crate) has_slides: bool,
    /// Whether a branch has so many columns that what grows faster than their number costs more than it saves: M and its
    /// factor, walks from each body to the root.
    pub(crate) is_long: bool,
}

/// A rigid body and the joint that moves it.
#[derive(Debug, Clone)]
pub(crate) struct PlanBody<T> {
    pub parent: Option<usize>,
    /// Origin of the joint in the parent's frame \[m\].
    pub origin: Vector<T>,
    pub motion: JointMotion<T>,
    /// The joint's coordinate, or that of the joint it mimics; of no meaning for the root and for fixed joints.
    pub coordinate: usize,
    /// Where a [`Configuration`] has the joint's angle or displacement.
    pub place: usize,
    /// How it follows, if it does.
    pub mimic: Option<MimicRatio>,
    /// The joint's column, or for the root the last of the base (pitch); `None` if it is braked or bolted.
    pub column: Option<usize>,
    /// About the body's origin, in its own axes.
    pub inertia: Inertia<T>,
    /// Added to the mass matrix's diagonal, as seen by the coordinate \[kg m^2\].
    pub rotor: T,
}

/// The joint's motion in numbers of the plan; `rate` is its motion for a unit rate of its coordinate.
#[derive(Debug, Clone, Copy)]
pub(crate) enum JointMotion<T> {
    Root,
    Revolute { sign: T, rate: T },
    Prismatic { direction: Vector<T>, rate: Vector<T> },
    Fixed,
}

/// A mimic joint's coordinate: multiplier q + offset, with q that of the mimicked joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MimicRatio {
    pub multiplier: f64,
    pub offset: f64,
}

/// Turns and displacements of a configuration: one entry per coordinate of q, then one per mimic joint of the robot: of
/// pitch and turning joints the turn, of x, z and sliding joints the displacement \[m\].
#[derive(Debug, Clone, Default)]
pub struct Configuration<T = f64> {
    /// Cosines and sines; of sliding coordinates the identity.
    pub turns: Vec<Rotation<T>>,
    /// Displacements \[m\]; of turning coordinates zero.
    pub displacement: Vec<T>,
}

impl<T: Trigonometry> Configuration<T> {
    /// Takes the cosines and sines of exactly `position` (q), in f64 the same bits on every platform.
    pub fn set(&mut self, plan: &Plan<T>, position: &[f64]) {
        self.displacement.clear();
        self.displacement.extend(position.iter().map(|&entry| T::from_f64(entry)));
        self.displacement.resize(plan.places, T::zero());
        self.turns.clear();
        self.turns.resize(plan.places, Rotation::identity());
        for body in &plan.bodies {
            let place = body.place;
            if let Some(turn) = plan.turn::<T>(body, position) {
                self.turns[place] = turn;
            } else if let (JointMotion::Prismatic { .. }, Some(mimic)) = (body.motion, body.mimic) {
                let value = position.get(body.coordinate).copied().unwrap_or(0.0);
                let [multiplier, value, offset] = [mimic.multiplier, value, mimic.offset].map(T::from_f64);
                self.displacement[place] = multiplier * value + offset;
            }
        }
    }
}

impl MimicRatio {
    /// The turn by exactly multiplier `angle` + offset, as f64 angles that add up to it.
    ///
    /// A product whose rounding error lies below the range of f64 (|multiplier angle| < 1e-290) is taken as rounded.
    fn turn<T: Trigonometry>(self, angle: f64) -> Rotation<T> {
        let product = self.multiplier * angle;
        let error = libm::fma(self.multiplier, angle, -product);
        // A part that is zero turns nothing, in any number.
        let parts = [error, self.offset].into_iter().filter(|&part| part != 0.0);
        parts.fold(Rotation::by(product), |turn, part| turn.then(Rotation::by(part)))
    }
}

impl Plan {
    /// The turn of a body at `position` (q), in numbers of any kind.
    pub(crate) fn rotation<N: Trigonometry>(&self, body: usize, position: &[f64]) -> Rotation<N> {
        let turns = self.way_to_root(body).filter_map(|(_, body)| {
            let turn = self.turn(body, position)?;
            let is_back = matches!(body.motion, JointMotion::Revolute { sign, .. } if sign < 0.0);
            Some(if is_back { turn.back() } else { turn })
        });
        // Turns of the plane commute.
        turns.fold(Rotation::identity(), Rotation::then)
    }
}

impl<T: Real> Plan<T> {
    /// Compiles `robot` with the joints `braked` (indices into [`Robot::joints`]) kept at their rate, and
    /// `rotor_inertia` per joint and then per mimic joint (empty for none) \[kg m^2\].
    ///
    /// A joint that mimics a braked one does not move either. A rotor at a mimic joint turns at that joint's rate, so
    /// that it adds multiplier^2 of its inertia to the mimicked joint's coordinate.
    pub fn new(robot: &Robot, braked: &[usize], rotor_inertia: &[f64]) -> Self {
        let base = robot.base_dofs();
        let floating = robot.base == Base::Floating;
        let mut plan = Self {
            bodies: Vec::with_capacity(robot.bodies.len()),
            parents: if floating { vec![NONE, 0, 1] } else { Vec::new() },
            coordinates: (0..base).collect(),
            places: robot.dofs() + robot.mimic_joints.len(),
            floating,
            has_mimics: false,
            has_slides: false,
            is_long: false,
        };
        // The column of each joint that has one, and of each body the greatest one on its way to the root.
        let mut columns = vec![None; robot.joints.len()];
        let mut greatest: Vec<Option<usize>> = Vec::with_capacity(robot.bodies.len());
        let number = |entry: f64| T::from_f64(entry);
        for body in &robot.bodies {
            let com = body.com.map(number);
            let mass = number(body.mass);
            let inertia = Inertia { mass, first: com * mass, second: number(body.moment) + mass * com.dot(com) };
            let Some(mover) = body.joint else {
                greatest.push(floating.then_some(2));
                plan.bodies.push(PlanBody {
                    parent: None,
                    origin: Vector::zero(),
                    motion: JointMotion::Root,
                    coordinate: 2,
                    place: 2,
                    mimic: None,
                    column: floating.then_some(2),
                    inertia,
                    rotor: T::zero(),
                });
                continue;
            };
            // The joint whose coordinate moves the body, and the body's own place in lists per joint and mimic joint;
            // `None` for a fixed joint. And its ratio.
            let (moved, mimic) = match mover {
                ParentJoint::Joint(index) => (Some((index, index)), None),
                ParentJoint::Mimic(index) => {
                    let MimicJoint { mimicked, multiplier, offset, .. } = robot.mimic_joints[index];
                    (Some((mimicked, robot.joints.len() + index)), Some(MimicRatio { multiplier, offset }))
                }
                ParentJoint::Fixed { .. } => (None, None),
            };
            let (parent, origin, axis) = robot.hinge(mover);
            let column = moved.filter(|(index, _)| !braked.contains(index));
            let column = column.map(|(index, _)| plan.column(&mut columns[index], base + index));
            greatest.push(match column {
                Some(column) => plan.join_branch(column, parent, greatest[parent]),
                None => greatest[parent],
            });
            let multiplier = mimic.map_or(1.0, |mimic| mimic.multiplier);
            let rotor = moved.and_then(|(_, own)| rotor_inertia.get(own).copied());
            let rotor = number(rotor.unwrap_or(0.0));
            plan.bodies.push(PlanBody {
                parent: Some(parent),
                origin: origin.map(number),
                motion: match axis {
                    None => JointMotion::Fixed,
                    // Exactly: the sign is one or minus one.
                    Some(Axis::Revolute { sign }) => {
                        JointMotion::Revolute { sign: number(sign), rate: number(sign * multiplier) }
                    }
                    Some(Axis::Prismatic { direction }) => {
                        let direction = direction.map(number);
                        let rate = if mimic.is_some() { direction * number(multiplier) } else { direction };
                        JointMotion::Prismatic { direction, rate }
                    }
                },
                coordinate: moved.map_or(0, |(index, _)| base + index),
                place: moved.map_or(0, |(_, own)| base + own),
                mimic,
                column,
                inertia,
                rotor: if mimic.is_some() { number(multiplier) * number(multiplier) * rotor } else { rotor },
            });
        }
        plan.has_slides = plan.bodies.iter().any(|body| matches!(body.motion, JointMotion::Prismatic { .. }));
        plan.is_long = (0..plan.columns()).any(|column| plan.branch(Some(column)).take(LONG).count() >= LONG);
        plan
    }

    /// By what a body's joint turns at `position` (q), before its sign; `None` if it does not turn.
    fn turn<N: Trigonometry>(&self, body: &PlanBody<T>, position: &[f64]) -> Option<Rotation<N>> {
        let turns = match body.motion {
            JointMotion::Root => self.floating,
            JointMotion::Revolute { .. } => true,
            JointMotion::Prismatic { .. } | JointMotion::Fixed => false,
        };
        let value = position.get(body.coordinate).copied().unwrap_or(0.0);
        turns.then(|| body.mimic.map_or_else(|| Rotation::by(value), |mimic| mimic.turn(value)))
    }

    /// The column of a coordinate, which may be known already from another joint that it moves.
    fn column(&mut self, known: &mut Option<usize>, coordinate: usize) -> usize {
        self.has_mimics |= known.is_some();
        *known.get_or_insert_with(|| {
            self.parents.push(NONE);
            self.coordinates.push(coordinate);
            self.coordinates.len() - 1
        })
    }

    /// Makes all columns on the way from a new body to the root each other's ancestors in the elimination tree, as they
    /// are without the body's own `column`; `greatest` of them is on the body's parent. Gives the greatest of all.
    fn join_branch(&mut self, column: usize, parent: usize, greatest: Option<usize>) -> Option<usize> {
        match greatest {
            // Whatever comes before the greatest is its ancestor already, as x and z are the pitch's.
            Some(other) if other < column => self.join(column, other),
            Some(_) => {
                let others: Vec<usize> = self.way_to_root(parent).filter_map(|(_, body)| body.column).collect();
                for other in others {
                    self.join(column.max(other), column.min(other));
                }
            }
            None => {}
        }
        Some(greatest.map_or(column, |other| other.max(column)))
    }

    /// Makes `ancestor` an ancestor of `column` in the elimination tree, for an entry of M that both share
    /// (J. W. H. Liu, "The role of elimination trees in sparse factorization", SIAM J. Matrix Anal. Appl. 11, 1990).
    fn join(&mut self, mut column: usize, mut ancestor: usize) {
        while column != ancestor {
            match self.parents[column] {
                NONE => {
                    self.parents[column] = ancestor;
                    return;
                }
                parent if parent >= ancestor => column = parent,
                parent => {
                    self.parents[column] = ancestor;
                    (column, ancestor) = (ancestor, parent);
                }
            }
        }
    }

    /// Takes what one body brings to an entry; where a column moves several, the entry is their sum.
    #[inline]
    pub(crate) fn bring(&self, entry: &mut T, part: T) {
        *entry = if self.has_mimics { *entry + part } else { part };
    }

    /// A column, if there is one, and its ancestors in the elimination tree, the nearest first.
    #[inline]
    pub(crate) fn branch(&self, column: Option<usize>) -> impl Iterator<Item = usize> {
        std::iter::successors(column, |&column| self.parent(column))
    }

    #[inline]
    fn parent(&self, column: usize) -> Option<usize> {
        Some(self.parents[column]).filter(|&parent| parent != NONE)
    }

    /// Visits the ancestors of a column in the elimination tree, the nearest first. All come before it, which is all that
    /// ends the walk: slices of `column` entries are indexed without a check.
    #[inline]
    pub(crate) fn for_ancestors(&self, column: usize, mut visit: impl FnMut(usize)) {
        let parents = &self.parents[..=column];
        let mut at = parents[column];
        while at < column {
            visit(at);
            at = parents[at];
        }
    }

    /// The greatest column that two branches share, which have these at their ends.
    pub(crate) fn shared(&self, a: Option<usize>, b: Option<usize>) -> Option<usize> {
        let (mut a, mut b) = (a?, b?);
        while a != b {
            let greater = if a > b { &mut a } else { &mut b };
            *greater = self.parent(*greater)?;
        }
        Some(a)
    }

    /// A body and those between it and the root, with their indices.
    pub(crate) fn way_to_root(&self, body: usize) -> impl Iterator<Item = (usize, &PlanBody<T>)> {
        std::iter::successors(Some(body), |&body| self.bodies[body].parent).map(|body| (body, &self.bodies[body]))
    }

    /// As [`Plan::way_to_root`], without the bodies that carry `other`, too.
    pub(crate) fn way_beyond(&self, body: usize, other: usize) -> impl Iterator<Item = (usize, &PlanBody<T>)> {
        let carries_both = move |at: usize| self.way_to_root(other).any(|(shared, _)| shared == at);
        self.way_to_root(body).take_while(move |&(at, _)| !carries_both(at))
    }

    /// Number of columns: the coordinates whose joints are not braked.
    pub fn columns(&self) -> usize {
        self.coordinates.len()
    }
}
