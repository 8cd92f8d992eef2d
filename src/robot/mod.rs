//! The reduced robot: an immutable planar floating-base tree of rigid bodies.
//!
//! ```text
//!     Description (links and joints of the file, 3-D) --reduce--> Robot (bodies and joints, planar)
//! ```
//!
//! Links connected by fixed and frozen joints are one [`Body`]. The frame of a body has its origin at the origin of its
//! joint (the frame of the root body: at the root link's origin) and, at zero joint coordinates, the axes of the plane.
//! So there is no constant rotation between a body and its parent, and numbers of the file that need no rotation keep
//! their bits.
//!
//! ```text
//!     Description --pose--> axes in the pose --plane--> plane --role--> revolute, prismatic or fixed
//!     --base--> root of the robot --tree--> bodies, poses of links --composite, outline--> inertias, feet
//! ```

mod composite;
mod plane;
mod reference_pose;
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
    /// The root body moves freely: q = [x, z, pitch, joints...].
    Floating,
    /// The root body is fixed to the world: q = [joints...].
    Fixed,
}

/// A robot reduced to its plane. It is immutable, and threads can share it.
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

/// A rigid body: links that no moving joint separates.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// The link that carries the body's frame.
    pub name: String,
    /// The joint between the body and its parent; `None` for the root.
    pub joint: Option<ParentJoint>,
    /// Mass \[kg\].
    pub mass: f64,
    /// Center of mass in the body's frame \[m\].
    pub com: Vector<f64>,
    /// Moment of inertia about the plane's normal through the center of mass \[kg m^2\].
    pub moment: f64,
}

/// The joint between a body and its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum ParentJoint {
    /// A joint with its own coordinate: an index into [`Robot::joints`].
    Joint(usize),
    /// A mimic joint: an index into [`Robot::mimic_joints`].
    Mimic(usize),
    /// A fixed joint to `parent` (an index into [`Robot::bodies`]); `origin` is the body's origin in the parent's frame
    /// \[m\]. Such bodies are separate only on request (see [`Reductions`](crate::reductions::Reductions)).
    Fixed { parent: usize, origin: Vector<f64> },
}

/// A joint that moves in the plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// The joint's name in the file.
    pub name: String,
    /// The parent body (an index into [`Robot::bodies`]).
    pub parent: usize,
    /// The child body, which the joint moves.
    pub child: usize,
    /// The joint's origin in the parent body's frame, at coordinate zero \[m\].
    pub origin: Vector<f64>,
    /// How it moves the child.
    pub axis: Axis,
    /// The smallest and the largest coordinate in the file \[rad or m\]. They do not affect an impact.
    pub limits: Option<[f64; 2]>,
}

/// A mimic joint: q = multiplier q_mimicked + offset (URDF's `<mimic>`).
#[derive(Debug, Clone, PartialEq)]
pub struct MimicJoint {
    /// The joint; its coordinate is not in q.
    pub joint: Joint,
    /// The mimicked joint (an index into [`Robot::joints`]).
    pub mimicked: usize,
    /// Change of the coordinate per unit of the mimicked joint's coordinate \[1, m/rad, rad/m\].
    pub multiplier: f64,
    /// The coordinate if that of the mimicked joint is zero \[rad, m\].
    pub offset: f64,
}

/// The motion of a joint as its coordinate increases.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Axis {
    /// The joint rotates the child about the plane's normal; `sign` is +1, or -1 if the URDF's axis points against it.
    Revolute { sign: f64 },
    /// The joint moves the child along a unit vector in the parent body's frame.
    Prismatic { direction: Vector<f64> },
}

impl Axis {
    /// Returns whether the coordinate is an angle.
    pub fn is_revolute(&self) -> bool {
        matches!(self, Self::Revolute { .. })
    }
}

/// A link of the file, and its pose in the reduced tree.
#[derive(Debug, Clone)]
pub struct Link {
    /// The link's name in the file.
    pub name: String,
    /// The body that contains the link (an index into [`Robot::bodies`]).
    pub body: usize,
    /// The rows of the link's pose in the body's frame for forward and up, the two directions of the plane: `[rotation
    /// row (3), translation]`.
    pub pose: [[f64; 4]; 2],
    /// Collision shapes in the body's frame.
    pub shapes: Vec<FootShape>,
    /// Whether the file gives the link an `<inertial>`.
    pub has_inertial: bool,
    /// The line of the file on which the link begins; `None` if the robot does not come from a file.
    pub line: Option<usize>,
}

/// A part of the file that does not enter the analysis, for example `joint "left_ankle"`, with the reason, for example
/// `fixed: welded into left_shank`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LeftOutPart {
    /// The part, by kind and name.
    pub what: String,
    /// The reason, and what happened to the part.
    pub why: String,
}

impl Link {
    /// Returns the position in the body's planar frame of a point given in the link's 3-D frame \[m\].
    pub fn point<T: Real>(&self, offset: [f64; 3]) -> Vector<T> {
        let [x, y, z] = offset.map(T::from_f64);
        let [forward, up] = self.pose.map(|row| {
            let [a, b, c, d] = row.map(T::from_f64);
            // Links that are not rotated keep the given digits: adding a product with zero changes nothing.
            a * x + b * y + c * z + d
        });
        Vector::new(forward, up)
    }

    /// Returns the sum of the magnitudes of all terms in the coordinates of [`Link::point`] \[m\].
    pub fn stretch(&self, [x, y, z]: [f64; 3]) -> f64 {
        let terms = self.pose.iter().flat_map(|row| row.iter().zip([x, y, z, 1.0]));
        terms.map(|(a, b)| (a * b).abs()).sum()
    }

    /// Inverts [`Link::point`] up to rounding: returns the point in the link's 3-D frame that lies at `point` of the
    /// body's planar frame \[m\], in the plane through the link's origin.
    pub fn offset(&self, point: Vector<f64>) -> [f64; 3] {
        // The rows are orthonormal, so the transpose inverts the rotation.
        let [[.., x], [.., z]] = self.pose;
        let [along, up] = [point.x - x, point.z - z];
        std::array::from_fn(|axis| self.pose[0][axis] * along + self.pose[1][axis] * up)
    }
}

impl Robot {
    /// Returns the robot's name in the file; `robot` if it has none.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns how the root body is attached.
    pub fn base(&self) -> Base {
        self.base
    }

    /// Returns the rigid bodies. Each parent comes before its children, and the root has index 0.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Returns the joints that move independently, in the file's order. Joint `k` has coordinate `base_dofs + k`.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the mimic joints, in the file's order. They have no coordinates of their own.
    pub fn mimic_joints(&self) -> &[MimicJoint] {
        &self.mimic_joints
    }

    /// Returns the links of the file, in its order, without the links that belong to the base.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the parts of the file that do not enter the analysis, with reasons.
    pub fn left_out(&self) -> &[LeftOutPart] {
        &self.left_out
    }

    /// Returns how the file was read.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }

    /// Returns the number of coordinates of the base: 3 if it floats, else 0.
    pub fn base_dofs(&self) -> usize {
        if self.base == Base::Floating { 3 } else { 0 }
    }

    /// Returns the number of coordinates: those of the base, and one per joint.
    pub fn dofs(&self) -> usize {
        self.base_dofs() + self.joints.len()
    }

    /// Returns the units of each coordinate and of its rate, in the order of q.
    pub fn units(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        const LENGTH: (&str, &str) = ("m", "m/s");
        const ANGLE: (&str, &str) = ("rad", "rad/s");
        let joints = self.joints.iter().map(|joint| if joint.axis.is_revolute() { ANGLE } else { LENGTH });
        [LENGTH, LENGTH, ANGLE].into_iter().take(self.base_dofs()).chain(joints)
    }

    /// Returns the coordinates' names in the order of q: x, z, pitch if the base floats, then joints as in the file.
    pub fn coordinates(&self) -> impl Iterator<Item = &str> {
        let base = ["x", "z", "pitch"].into_iter().take(self.base_dofs());
        base.chain(self.joints.iter().map(|joint| joint.name.as_str()))
    }

    /// Returns the parent body of a joint, the joint's origin in that body's frame at coordinate zero \[m\], and its
    /// motion (`None` for a fixed joint).
    pub fn hinge(&self, mover: ParentJoint) -> (usize, Vector<f64>, Option<Axis>) {
        let joint = match mover {
            ParentJoint::Joint(joint) => &self.joints[joint],
            ParentJoint::Mimic(mimic) => &self.mimic_joints[mimic].joint,
            ParentJoint::Fixed { parent, origin } => return (parent, origin, None),
        };
        (joint.parent, joint.origin, Some(joint.axis))
    }

    /// Returns the mass of all bodies that can move \[kg\]: with a fixed base, not the root and bodies fixed to it.
    pub fn mass(&self) -> f64 {
        (0..self.bodies.len()).filter(|&body| self.moves(body)).map(|body| self.bodies[body].mass).sum()
    }

    /// Returns the index in [`Robot::links`] of the link with this name; `None` if there is none.
    pub fn link(&self, name: &str) -> Option<usize> {
        self.links.iter().position(|link| link.name == name)
    }

    /// Returns the joints with coordinates of their own, then the mimic joints.
    pub(crate) fn moving_joints(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().chain(self.mimic_joints.iter().map(|mimic| &mimic.joint))
    }

    /// Returns the reason why no link has this name.
    pub fn no_link(&self, name: &str) -> Reason {
        if self.reading.outside.iter().any(|outside| outside == name) {
            return Reason::Inconsistent(format!("link \"{name}\" is part of the base, not of the robot"));
        }
        Reason::UnknownName { what: "link", name: name.to_owned() }
    }

    /// Returns the index in [`Robot::joints`] of the joint with this name; `None` if there is none.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// Returns the joint of the file with this name if it has no coordinate, being frozen or part of the base.
    pub fn frozen(&self, name: &str) -> Option<&FrozenJoint> {
        self.reading.frozen.iter().find(|frozen| frozen.name == name)
    }

    /// Follows fixed joints from `body` toward the root as far as there are any, and returns the last body.
    pub(crate) fn rigid_body(&self, body: usize) -> usize {
        let mut at = body;
        while let Some(ParentJoint::Fixed { parent, .. }) = self.bodies[at].joint {
            at = parent;
        }
        at
    }

    /// Returns whether a body can move. The root of a fixed base cannot, nor can bodies on fixed joints to it.
    fn moves(&self, body: usize) -> bool {
        self.base == Base::Floating || self.bodies[self.rigid_body(body)].joint.is_some()
    }

    /// Returns for each body with all that is fixed to it the center of mass in its frame \[m\] and the moment of
    /// inertia about it \[kg m^2\]; `None` for a fixed body.
    fn wholes(&self) -> Vec<Option<(Vector<f64>, f64)>> {
        let mut parts = Vec::with_capacity(self.bodies.len());
        // For each body, the result of `rigid_body`, and the body's origin in that body's frame.
        let mut grounds: Vec<(usize, Vector<f64>)> = Vec::with_capacity(self.bodies.len());
        for (index, body) in self.bodies.iter().enumerate() {
            let (ground, place) = match body.joint {
                Some(ParentJoint::Fixed { parent, origin }) => (grounds[parent].0, grounds[parent].1 + origin),
                _ => (index, Vector::zero()),
            };
            grounds.push((ground, place));
            parts.push((ground, LinkInertia::new(body.mass, place + body.com, body.moment)));
        }
        let wholes = composites(self.bodies.len(), parts).into_iter().enumerate();
        wholes.map(|(index, (_, center, moment))| (grounds[index].0 == index).then_some((center, moment))).collect()
    }

    /// Returns the greatest distance from the root's origin to a center of mass or to one of these shapes of bodies,
    /// with all joints at zero \[m\]; 1 m if the robot is a single point.
    pub(crate) fn size<'s>(&self, shapes: impl Iterator<Item = (usize, &'s FootShape)>) -> f64 {
        let mut origins = vec![Vector::zero(); self.bodies.len()];
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some((parent, origin, _)) = body.joint.map(|mover| self.hinge(mover)) {
                origins[index] = origins[parent] + origin;
            }
        }
        let distance = |body: usize, point: Vector<f64>| (origins[body] + point).length();
        let wholes = self.wholes().into_iter().enumerate();
        let centers = wholes.filter_map(|(index, whole)| Some(distance(index, whole?.0)));
        let soles = shapes.map(|(body, shape)| {
            let corners = shape.corners().iter().map(|&corner| distance(body, corner));
            corners.fold(0.0, f64::max) + shape.rim.bound()
        });
        let size = centers.chain(soles).fold(0.0, f64::max);
        if size > 0.0 { size } else { 1.0 }
    }
}
