//! The reduced robot: an immutable planar floating-base tree of rigid bodies.
//!
//! ```text
//!     Description (links and joints of the file, 3-D) --reduce--> Robot (bodies and joints, planar)
//! ```
//!
//! Links joined by fixed and frozen joints are one [`Body`]. A body's frame has its origin at its joint's origin (the
//! root body: at the root link's origin) and, at zero joint coordinates, the axes of the plane. So no constant rotation
//! stands between a body and its parent, and where the file turns nothing its numbers are kept bit for bit.
//!
//! ```text
//!     Description --pose--> axes in the pose --plane--> plane --role--> revolute, prismatic or fixed
//!     --base--> where the robot begins --tree--> bodies, places of links --composite, outline--> inertias, feet
//! ```

mod composite;
mod plane;
mod reference_pose;
mod legs;
mod reading;
mod role;
mod caution;
mod left_out;
mod base;
mod shape;
mod outline;
mod tree;
mod reduce;

pub(crate) use caution::LONGEST;
pub use plane::Plane;
pub use reading::{FreezeReason, FrozenJoint, PlaneReason, Reading};
pub use reduce::Reduction;
pub use shape::{FootShape, Rim};

use crate::error::Reason;
use crate::planar::Vector;
use crate::scalar::Real;
use composite::{LinkInertia, composites};

/// How the root body is attached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// It moves freely: q = [x, z, pitch, joints...].
    Floating,
    /// It is bolted to the world: q = [joints...].
    Fixed,
}

/// A robot reduced to its plane. It never changes; threads share it.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// let robot = heelstrike::Robot::from_urdf(urdf)?;
/// assert_eq!(robot.coordinates().collect::<Vec<_>>(), ["x", "z", "pitch", "hip"]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Robot {
    pub(crate) name: String,
    pub(crate) base: Base,
    pub(crate) bodies: Vec<Body>,
    pub(crate) joints: Vec<Joint>,
    pub(crate) mimic_joints: Vec<MimicJoint>,
    pub(crate) links: Vec<Link>,
    pub(crate) left_out: Vec<LeftOutPart>,
    pub(crate) reading: Reading,
}

/// Links that no moving joint separates.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The link that carries the body's frame.
    pub name: String,
    /// The joint between the body and its parent; `None` for the root.
    pub joint: Option<ParentJoint>,
    /// Mass \[kg\].
    pub mass: f64,
    /// CoG in the body's frame \[m\].
    pub com: Vector<f64>,
    /// Moment of inertia about the plane's normal through the CoG \[kg m^2\].
    pub moment: f64,
}

/// The joint between a body and its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum ParentJoint {
    /// A joint with a coordinate of its own: an index into [`Robot::joints`].
    Joint(usize),
    /// A mimic joint: an index into [`Robot::mimic_joints`].
    Mimic(usize),
    /// A fixed joint: the body is rigid on its parent (an index into [`Robot::bodies`]), with its origin there in the
    /// parent's frame \[m\], and kept apart only on request (see [`Reductions`](crate::reductions::Reductions)).
    Fixed { parent: usize, origin: Vector<f64> },
}

/// A joint that moves in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name in the file.
    pub name: String,
    /// The parent body (an index into [`Robot::bodies`]).
    pub parent: usize,
    /// The body it moves.
    pub child: usize,
    /// Its origin in the parent body's frame, at coordinate zero \[m\].
    pub origin: Vector<f64>,
    /// How it moves the child.
    pub axis: Axis,
    /// The least and the greatest coordinate, as the file has them \[rad or m\]. They do not enter an impact.
    pub limits: Option<[f64; 2]>,
}

/// A mimic joint: q = multiplier q_mimicked + offset (URDF's `<mimic>`).
#[derive(Debug, Clone, PartialEq)]
pub struct MimicJoint {
    /// The joint itself.
    pub joint: Joint,
    /// The joint that it mimics (an index into [`Robot::joints`]).
    pub mimicked: usize,
    /// How much it moves for a unit of the mimicked joint \[1, m/rad, rad/m\].
    pub multiplier: f64,
    /// Its coordinate where that of the mimicked joint is zero \[rad, m\].
    pub offset: f64,
}

/// The motion of a joint for a coordinate that grows.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Axis {
    /// It rotates the child about the plane's normal; `sign` is +1 where the URDF's axis points along the normal, -1
    /// where against it.
    Revolute { sign: f64 },
    /// It moves the child along a unit vector of the parent body's frame.
    Prismatic { direction: Vector<f64> },
}

impl Axis {
    /// Whether the coordinate is an angle.
    pub fn is_revolute(&self) -> bool {
        matches!(self, Self::Revolute { .. })
    }
}

/// A link of the file and its place in the reduced tree.
#[derive(Debug, Clone)]
pub struct Link {
    /// Its name in the file.
    pub name: String,
    /// The body it belongs to.
    pub body: usize,
    /// The plane's two rows of the link's pose in the body's frame: `[rotation row (3), translation]` for forward and
    /// up.
    pub pose: [[f64; 4]; 2],
    /// Collision shapes in the body's frame.
    pub shapes: Vec<FootShape>,
    /// True where the file gives the link an `<inertial>`.
    pub has_inertial: bool,
    /// The line of the file on which it begins; `None` for a robot of no file.
    pub line: Option<usize>,
}

/// Something of the file that does not enter the analysis, as in `joint "left_ankle"`, and why, as in `fixed: welded
/// into left_shank`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOutPart {
    /// The part, by kind and name.
    pub what: String,
    /// The reason, and what became of it.
    pub why: String,
}

impl Link {
    /// A point of the link's own 3-D frame in its body's planar frame \[m\].
    pub fn point<T: Real>(&self, offset: [f64; 3]) -> Vector<T> {
        let [x, y, z] = offset.map(T::from_f64);
        let [forward, up] = self.pose.map(|row| {
            let [a, b, c, d] = row.map(T::from_f64);
            // Unturned links keep the given digits: adding a product with zero changes nothing.
            a * x + b * y + c * z + d
        });
        Vector::new(forward, up)
    }

    /// What the coordinates of [`Link::point`] are added up from, by magnitude \[m\].
    pub fn stretch(&self, [x, y, z]: [f64; 3]) -> f64 {
        let terms = self.pose.iter().flat_map(|row| row.iter().zip([x, y, z, 1.0]));
        terms.map(|(a, b)| (a * b).abs()).sum()
    }

    /// The point of the link's own 3-D frame, in the plane through its origin, that lies at `point` in its body's
    /// planar frame \[m\], up to rounding.
    pub fn offset(&self, point: Vector<f64>) -> [f64; 3] {
        // The rows are orthonormal, so that their transpose turns back.
        let [[.., x], [.., z]] = self.pose;
        let [along, up] = [point.x - x, point.z - z];
        std::array::from_fn(|axis| self.pose[0][axis] * along + self.pose[1][axis] * up)
    }
}

impl Robot {
    /// The robot's name in the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How the root is attached.
    pub fn base(&self) -> Base {
        self.base
    }

    /// Rigid bodies; a parent comes before its children, the root is 0.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Joints that move independently, in the file's order: joint `k` is coordinate `base_dofs + k`.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Joints that mimic one of these, in the file's order; they have no coordinate of their own.
    pub fn mimic_joints(&self) -> &[MimicJoint] {
        &self.mimic_joints
    }

    /// The links of the file, in its order; without those that are the base itself.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// What of the file does not enter the analysis, and why.
    pub fn left_out(&self) -> &[LeftOutPart] {
        &self.left_out
    }

    /// How the file was read.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Number of coordinates of the base: 3 if it floats, else 0.
    pub fn base_dofs(&self) -> usize {
        match self.base {
            Base::Floating => 3,
            Base::Fixed => 0,
        }
    }

    /// Number of coordinates: those of the base and one per joint.
    pub fn dofs(&self) -> usize {
        self.base_dofs() + self.joints.len()
    }

    /// The units of each coordinate and of its rate, in the order of q.
    pub fn units(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        const LENGTH: (&str, &str) = ("m", "m/s");
        const ANGLE: (&str, &str) = ("rad", "rad/s");
        let joints = self.joints.iter().map(|joint| match joint.axis {
            Axis::Revolute { .. } => ANGLE,
            Axis::Prismatic { .. } => LENGTH,
        });
        [LENGTH, LENGTH, ANGLE].into_iter().take(self.base_dofs()).chain(joints)
    }

    /// Names of the coordinates in the order of q: x, z, pitch (if the base floats), then the joints in the file's
    /// order.
    pub fn coordinates(&self) -> impl Iterator<Item = &str> {
        let base = ["x", "z", "pitch"].into_iter().take(self.base_dofs());
        base.chain(self.joints.iter().map(|joint| joint.name.as_str()))
    }

    /// The parent body of a joint, the joint's origin in that body's frame at coordinate zero \[m\], and its motion
    /// (`None` for a fixed joint).
    pub fn hinge(&self, mover: ParentJoint) -> (usize, Vector<f64>, Option<Axis>) {
        let joint = match mover {
            ParentJoint::Joint(joint) => &self.joints[joint],
            ParentJoint::Mimic(mimic) => &self.mimic_joints[mimic].joint,
            ParentJoint::Fixed { parent, origin } => return (parent, origin, None),
        };
        (joint.parent, joint.origin, Some(joint.axis))
    }

    /// Mass of all that can move: of a bolted robot without the root body \[kg\].
    pub fn mass(&self) -> f64 {
        (0..self.bodies.len()).filter(|&body| self.moves(body)).map(|body| self.bodies[body].mass).sum()
    }

    /// The index in [`Robot::links`] of the link of this name.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Why no link has that name.
    pub fn no_link(&self, name: &str) -> Reason {
        if self.reading.outside.iter().any(|outside| outside == name) {
            return Reason::Inconsistent(format!("link \"{name}\" is part of the base, not of the robot"));
        }
        Reason::UnknownName { what: "link", name: name.to_owned() }
    }

    /// The moving joint of that name.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The joint of that name in the file that has no coordinate in the reduced robot: it is frozen, or part of the
    /// base.
    pub fn frozen(&self, name: &str) -> Option<&FrozenJoint> {
        self.reading.frozen.iter().find(|frozen| frozen.name == name)
    }

    /// The body that `body` is rigid on in the end: itself, if it is not kept apart from another.
    pub(crate) fn rigid_body(&self, body: usize) -> usize {
        let mut at = body;
        while let Some(ParentJoint::Fixed { parent, .. }) = self.bodies[at].joint {
            at = parent;
        }
        at
    }

    /// Whether a body can move: not the root of a bolted robot, nor what is fixed to it.
    fn moves(&self, body: usize) -> bool {
        self.base == Base::Floating || self.bodies[self.rigid_body(body)].joint.is_some()
    }

    /// The CoG of each body together with all that is fixed to it, in its frame \[m\]; `None` for a body that is fixed
    /// to another.
    pub(crate) fn centers(&self) -> Vec<Option<Vector<f64>>> {
        let mut parts = Vec::with_capacity(self.bodies.len());
        // The body that each is rigid on in the end, and its own origin there.
        let mut grounds: Vec<(usize, Vector<f64>)> = Vec::with_capacity(self.bodies.len());
        for (index, body) in self.bodies.iter().enumerate() {
            let (ground, place) = match body.joint {
                Some(ParentJoint::Fixed { parent, origin }) => (grounds[parent].0, grounds[parent].1 + origin),
                _ => (index, Vector::zero()),
            };
            grounds.push((ground, place));
            parts.push((ground, LinkInertia::point(body.mass, place + body.com)));
        }
        let wholes = composites(self.bodies.len(), parts).into_iter().enumerate();
        wholes.map(|(index, (_, center, _))| (grounds[index].0 == index).then_some(center)).collect()
    }

    /// The greatest distance from the root's origin to a CoG or to one of these shapes of bodies, with all joints at
    /// zero \[m\]; of a robot that is one point 1 m.
    pub(crate) fn size<'s>(&self, shapes: impl Iterator<Item = (usize, &'s FootShape)>) -> f64 {
        let mut origins = vec![Vector::zero(); self.bodies.len()];
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some((parent, origin, _)) = body.joint.map(|mover| self.hinge(mover)) {
                origins[index] = origins[parent] + origin;
            }
        }
        let distance = |body: usize, point: Vector<f64>| (origins[body] + point).length();
        let centers = self.centers().into_iter().enumerate();
        let centers = centers.filter_map(|(index, center)| Some(distance(index, center?)));
        let soles = shapes.map(|(body, shape)| {
            let corners = shape.corners().iter().map(|&corner| distance(body, corner));
            corners.fold(0.0, f64::max) + shape.rim.bound()
        });
        let size = centers.chain(soles).fold(0.0, f64::max);
        if size > 0.0 { size } else { 1.0 }
    }
}
