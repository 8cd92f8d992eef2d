//! A robot compiled for the hot path: flat arrays, without columns for braked joints.
//!
//! ```text
//!     Robot + braked joints + rotor inertias --> Plan<T>
//! ```
//!
//! Moving coordinates are the *columns* of the plan. They are numbered from the root outward, so that the parent of a
//! column (the nearest moving joint between it and the root, lambda in Featherstone 2008) has a smaller number. The
//! coordinates of the user's q keep the file's order. A braked joint keeps its place in the chain of bodies but has no
//! column.
//!
//! A mimic joint shares the column of its mimicked joint. Its motion is given for a unit rate of the mimicked joint:
//!
//! ```text
//!     v_joints = T v,   M = T^T M_joints T,   J = J_joints T         a row of T has one entry: 1, or the multiplier
//! ```
//!
//! T is never formed: the contributions of several bodies to one entry are added up. A column then belongs to more than
//! one branch. Its parent is its parent in the elimination tree of M, so the factorization fills in only ancestors of a
//! column.

use crate::planar::{Inertia, Rotation, Vector};
use crate::robot::{Axis, Base, MimicJoint, ParentJoint, Robot};
use crate::scalar::{Real, Trigonometry};

/// A plan is long if one of its branches has at least this many columns.
const LONG: usize = 12;

/// Marks a column that has no parent.
const NONE: usize = usize::MAX;

/// A robot compiled for one set of braked joints, in numbers of type `T`.
#[derive(Debug, Clone, Default)]
pub struct Plan<T = f64> {
    /// Bodies from the root outward.
    pub(crate) bodies: Vec<PlanBody<T>>,
    /// Parent of each column in the elimination tree of M, or [`NONE`]. Without mimic joints it is the nearest moving
    /// joint between the column's joint and the root.
    parents: Vec<usize>,
    /// The coordinate (index into q) of each column, from the root outward.
    pub(crate) coordinates: Vec<usize>,
    /// Number of entries of a [`Configuration`]: one per coordinate and per mimic joint.
    pub(crate) places: usize,
    pub(crate) floating: bool,
    /// Whether any column moves more than one joint.
    pub(crate) has_mimics: bool,
    /// Whether any joint is prismatic, including braked ones.
    pub(crate) has_slides: bool,
    /// Whether a branch has at least [`LONG`] columns. Then algorithms whose cost grows faster than the number of
    /// columns are too slow: M and its factor, and walks from each body to the root.
    pub(crate) is_long: bool,
}

/// A rigid body and the joint that moves it.
#[derive(Debug, Clone)]
pub(crate) struct PlanBody<T> {
    pub parent: Option<usize>,
    /// Origin of the joint in the parent's frame \[m\].
    pub origin: Vector<T>,
    pub motion: JointMotion<T>,
    /// The joint's coordinate, or that of its mimicked joint. Meaningless for the root and for fixed joints.
    pub coordinate: usize,
    /// Index of the joint's angle or displacement in a [`Configuration`].
    pub place: usize,
    /// Ratio to the mimicked joint, if this is a mimic joint.
    pub mimic: Option<MimicRatio>,
    /// The joint's column; for the root, the last column of the base (pitch). `None` if the joint is braked or fixed,
    /// or if the base is fixed.
    pub column: Option<usize>,
    /// Inertia about the body's origin, in the body's axes.
    pub inertia: Inertia<T>,
    /// Rotor inertia as seen by the coordinate, added to the diagonal of the mass matrix \[kg m^2\].
    pub rotor: T,
}

/// A joint's motion. `rate` is the motion for a unit rate of its coordinate, times the multiplier of a mimic joint.
#[derive(Debug, Clone, Copy)]
pub(crate) enum JointMotion<T> {
    Root,
    Revolute { sign: T, rate: T },
    Prismatic { direction: Vector<T>, rate: Vector<T> },
    Fixed,
}

/// The ratio of a mimic joint: its coordinate is multiplier q + offset, with q that of the mimicked joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MimicRatio {
    pub multiplier: f64,
    pub offset: f64,
}

/// Rotations and displacements at a configuration. Each list has one entry per coordinate of q, then one per mimic
/// joint of the robot.
#[derive(Debug, Clone, Default)]
pub struct Configuration<T = f64> {
    /// Cosines and sines of pitch and of revolute joints; the identity for x, z and prismatic joints.
    pub turns: Vec<Rotation<T>>,
    /// Displacements of x, z and prismatic joints \[m\]. An entry of pitch or of a revolute joint is its angle in q,
    /// and zero for a revolute mimic joint.
    pub displacement: Vec<T>,
}

impl<T: Trigonometry> Configuration<T> {
    /// Sets all entries from exactly `position` (q). In f64, the result has the same bits on every platform.
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
    /// Returns the rotation by exactly multiplier * `angle` + offset, composed of rotations by f64 angles.
    ///
    /// The rounding error of the product is neglected if it lies below the range of f64 (|multiplier angle| < 1e-290).
    fn turn<T: Trigonometry>(self, angle: f64) -> Rotation<T> {
        let product = self.multiplier * angle;
        let error = libm::fma(self.multiplier, angle, -product);
        // Zero angles are skipped, because they rotate nothing in any number type.
        let parts = [error, self.offset].into_iter().filter(|&part| part != 0.0);
        parts.fold(Rotation::by(product), |turn, part| turn.then(Rotation::by(part)))
    }
}

impl Plan {
    /// Returns the rotation of a body at `position` (q), in numbers of any type.
    pub(crate) fn rotation<N: Trigonometry>(&self, body: usize, position: &[f64]) -> Rotation<N> {
        let turns = self.way_to_root(body).filter_map(|(_, body)| {
            let turn = self.turn(body, position)?;
            let is_back = matches!(body.motion, JointMotion::Revolute { sign, .. } if sign < 0.0);
            Some(if is_back { turn.back() } else { turn })
        });
        // Rotations of the plane commute.
        turns.fold(Rotation::identity(), Rotation::then)
    }
}

impl<T: Real> Plan<T> {
    /// Compiles `robot` for one set of braked joints, which keep their rates: `braked` holds indices into
    /// [`Robot::joints`]. `rotor_inertia` \[kg m^2\] has one entry per joint and then one per mimic joint; an empty
    /// slice means no rotors.
    ///
    /// A joint that mimics a braked joint does not change its rate either. A rotor at a mimic joint turns at the rate
    /// of that joint, so the coordinate of the mimicked joint sees multiplier^2 times its inertia.
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
        // The column of each joint, if it has one. For each body, the greatest column between it and the root.
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
            // The joint whose coordinate moves the body, and the body's own index in lists of joints and mimic joints;
            // `None` for a fixed joint. With it the ratio of a mimic joint.
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
            let rotor = moved.and_then(|(_, place)| rotor_inertia.get(place).copied());
            let rotor = number(rotor.unwrap_or(0.0));
            plan.bodies.push(PlanBody {
                parent: Some(parent),
                origin: origin.map(number),
                motion: match axis {
                    None => JointMotion::Fixed,
                    // The product is exact, because the sign is 1 or -1.
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
                place: moved.map_or(0, |(_, place)| base + place),
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

    /// Returns the rotation of a body's joint at `position` (q), without its sign; `None` if the joint does not rotate.
    fn turn<N: Trigonometry>(&self, body: &PlanBody<T>, position: &[f64]) -> Option<Rotation<N>> {
        let turns = match body.motion {
            JointMotion::Root => self.floating,
            motion => matches!(motion, JointMotion::Revolute { .. }),
        };
        let value = position.get(body.coordinate).copied().unwrap_or(0.0);
        turns.then(|| body.mimic.map_or_else(|| Rotation::by(value), |mimic| mimic.turn(value)))
    }

    /// Returns the column of a coordinate. `known` is its column if another joint with this coordinate has one already.
    fn column(&mut self, known: &mut Option<usize>, coordinate: usize) -> usize {
        self.has_mimics |= known.is_some();
        *known.get_or_insert_with(|| {
            self.parents.push(NONE);
            self.coordinates.push(coordinate);
            self.coordinates.len() - 1
        })
    }

    /// Adds `column`, that of a new body, to the columns between its `parent` and the root, so that all of them lie on
    /// one branch of the elimination tree. The others already do; `greatest` is their greatest. Returns the new one.
    fn join_branch(&mut self, column: usize, parent: usize, greatest: Option<usize>) -> Option<usize> {
        match greatest {
            // The columns before the greatest are its ancestors already, as x and z are ancestors of pitch.
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

    /// Makes `ancestor` an ancestor of `column` in the elimination tree, because M has an entry for both (J. W. H. Liu,
    /// "The role of elimination trees in sparse factorization", SIAM J. Matrix Anal. Appl. 11, 1990).
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

    /// Writes the contribution of one body to an entry. If a column moves several joints, contributions are summed.
    #[inline]
    pub(crate) fn bring(&self, entry: &mut T, part: T) {
        *entry = if self.has_mimics { *entry + part } else { part };
    }

    /// Returns `column` and its ancestors in the elimination tree, nearest first; nothing if `column` is `None`.
    #[inline]
    pub(crate) fn branch(&self, column: Option<usize>) -> impl Iterator<Item = usize> {
        std::iter::successors(column, |&column| self.parent(column))
    }

    #[inline]
    fn parent(&self, column: usize) -> Option<usize> {
        Some(self.parents[column]).filter(|&parent| parent != NONE)
    }

    /// Visits the ancestors of a column in the elimination tree, nearest first. The walk ends at the first index that
    /// is not less than `column`, which lets the compiler omit the bounds checks of slices with `column` entries.
    #[inline]
    pub(crate) fn for_ancestors(&self, column: usize, mut visit: impl FnMut(usize)) {
        let parents = &self.parents[..=column];
        let mut at = parents[column];
        while at < column {
            visit(at);
            at = parents[at];
        }
    }

    /// Returns the greatest column that the branches ending in `a` and `b` share.
    pub(crate) fn shared(&self, a: Option<usize>, b: Option<usize>) -> Option<usize> {
        let (mut a, mut b) = (a?, b?);
        while a != b {
            let greater = if a > b { &mut a } else { &mut b };
            *greater = self.parent(*greater)?;
        }
        Some(a)
    }

    /// Returns a body and the bodies between it and the root, with their indices.
    pub(crate) fn way_to_root(&self, body: usize) -> impl Iterator<Item = (usize, &PlanBody<T>)> {
        std::iter::successors(Some(body), |&body| self.bodies[body].parent).map(|body| (body, &self.bodies[body]))
    }

    /// As [`Plan::way_to_root`], without the bodies that also carry `other`.
    pub(crate) fn way_beyond(&self, body: usize, other: usize) -> impl Iterator<Item = (usize, &PlanBody<T>)> {
        let carries_both = move |at: usize| self.way_to_root(other).any(|(shared, _)| shared == at);
        self.way_to_root(body).take_while(move |&(at, _)| !carries_both(at))
    }

    /// Returns the coordinate of each column, as an index into q and [`Robot::coordinates`]. The mass matrix, the
    /// contact Jacobian and the bias forces have an entry per column, from the root outward, and not in the order of q.
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// Returns the number of columns: of the base's coordinates and of joints that are not braked.
    pub fn columns(&self) -> usize {
        self.coordinates.len()
    }
}
