//! Reads URDF text into a checked description: links and joints in three dimensions, as the file gives them, forming
//! one tree. The only user of urdf-rs and roxmltree.
//!
//! ```text
//!     text --repair, xml--> elements --draft: values in urdf-rs's types--> links, joints --tree--> Description
//! ```
//!
//! urdf-rs's own reader is too trusting and too strict: it drops non-numbers from a vector, reads a missing `<inertial>`
//! as a mass of zero, and refuses an incomplete `<limit>`. So every element is checked with its place in the text.
//! Nothing here opens a file, starts a process or recurses, and time and memory grow linearly with the text.

mod pose;
mod xml;
mod repair;
mod elements;
mod mesh;
mod values;
mod draft;
mod mimic;
mod tree;

pub use mesh::{Fetched, Mesh};
pub use pose::{Matrix, Pose, apply, product, turn, unit};

use crate::error::{Error, Location, Result};

/// A robot as its file gives it: checked, and joined into one tree.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// # let urdf = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/minimalistic.urdf"));
/// let description = heelstrike::Description::from_urdf(urdf)?;
/// assert_eq!(description.links[description.root].name, "left_leg");
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Description {
    /// The robot's name; empty where the file gives none.
    pub name: String,
    /// The links in the file's order; at least one, no name twice.
    pub links: Vec<UrdfLink>,
    /// The joints in the file's order; no name twice, but a joint may be named like a link.
    pub joints: Vec<UrdfJoint>,
    /// The link that is no joint's child (an index into [`Description::links`]).
    pub root: usize,
    /// Elements that were passed over, in the order in which they first occur.
    pub ignored: Vec<Ignored>,
    /// Attributes and elements that are not read and perhaps misspelt, and limits that cannot be, each with its
    /// line.
    pub misspelt: Vec<String>,
    /// The joints whose transmissions in the file have a rotor inertia, which is not read.
    pub rotors: Vec<String>,
}

/// A link of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfLink {
    /// Its name, which no other link has.
    pub name: String,
    /// Its inertia; `None` if the file has no `<inertial>`, which differs from a mass of zero.
    pub inertial: Option<Inertial>,
    /// Its collision shapes in the file's order.
    pub collisions: Vec<Collision>,
    /// The joint whose child it is (an index into [`Description::joints`]); `None` for the root.
    pub joint: Option<usize>,
    /// Where its element begins.
    pub location: Location,
}

/// Mass, CoG and inertia of a link.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Inertial {
    /// The CoG and the axes of the inertia, in the link's frame.
    pub origin: Pose,
    /// Mass \[kg\], never negative.
    pub mass: f64,
    /// Inertia about the CoG in the axes of `origin`, symmetric \[kg m^2\]; `None` if the file has no `<inertia>`.
    /// Finite, but otherwise as the file has it: many files give one that no body can have.
    pub inertia: Option<Matrix>,
}

/// A collision shape of a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    /// The shape's frame in the link's frame.
    pub origin: Pose,
    /// The shape itself.
    pub geometry: Geometry,
}

/// A shape about the origin of its own frame; all sizes are finite and none is negative \[m\].
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
#[non_exhaustive]
pub enum Geometry {
    /// A box with sides of these whole lengths along x, y and z.
    Box { size: [f64; 3] },
    /// A cylinder about the z axis.
    Cylinder { radius: f64, length: f64 },
    /// A cylinder about the z axis with a half ball on each end, which `length` does not count.
    Capsule { radius: f64, length: f64 },
    /// A ball; a radius of 0 is a point.
    Sphere { radius: f64 },
    /// A mesh: the file's name as given, factors along x, y and z (a negative one mirrors), and what was read of the
    /// file, before the factors.
    Mesh { file: String, scale: [f64; 3], mesh: Mesh },
    /// A shape that URDF does not know, by its element's tag.
    Unknown { tag: String },
}

/// A joint of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfJoint {
    /// Its name, which no other joint has.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Its parent link (an index into [`Description::links`]).
    pub parent: usize,
    /// Its child link, whose frame is the joint's.
    pub child: usize,
    /// The joint's frame in the parent link's frame, at coordinate zero.
    pub origin: Pose,
    /// Its axis in the joint's frame, of any length; not zero where `kind` has an axis. (1, 0, 0) where the file has
    /// none.
    pub axis: [f64; 3],
    /// Whether the file has an axis.
    pub has_axis: bool,
    /// The joint that it mimics, if any.
    pub mimic: Option<Mimic>,
    /// The least and the greatest coordinate \[rad or m\], perhaps infinite; `None` if the file has none, or none that leave
    /// room.
    pub limits: Option<[f64; 2]>,
    /// Where its element begins.
    pub location: Location,
}

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum JointKind {
    /// Does not move.
    Fixed,
    /// Rotates about its axis, between limits.
    Revolute,
    /// Rotates about its axis without limits.
    Continuous,
    /// Translates along its axis.
    Prismatic,
    /// Translates and rotates in the plane normal to its axis.
    Planar,
    /// Leaves all six degrees of freedom.
    Floating,
    /// Rotates about every axis (a later addition to URDF).
    Spherical,
}

impl JointKind {
    pub(crate) const ALL: [Self; 7] =
        [Self::Fixed, Self::Revolute, Self::Continuous, Self::Prismatic, Self::Planar, Self::Floating, Self::Spherical];

    /// Whether the joint's motion depends on its axis.
    pub fn has_axis(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous | Self::Prismatic | Self::Planar)
    }

    /// Its name in URDF.
    pub fn name(self) -> &'static str {
        ["fixed", "revolute", "continuous", "prismatic", "planar", "floating", "spherical"][self as usize]
    }
}

/// A mimic joint's coordinate: `multiplier` times that of the mimicked joint plus `offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// The mimicked joint (an index into [`Description::joints`]).
    pub joint: usize,
    /// The factor, 1 if the file has none; in m, rad and their quotients.
    pub multiplier: f64,
    /// The summand, 0 if the file has none \[rad or m\].
    pub offset: f64,
}

/// Elements of one tag that were ignored, below elements of the tag `parent`: `robot`, `link` or `joint`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ignored {
    /// The tag of the element around them.
    pub parent: &'static str,
    /// Their own tag.
    pub tag: String,
    /// How many there are.
    pub count: usize,
}

impl Description {
    /// Reads and checks the text of a URDF file.
    ///
    /// Elements that are no part of URDF's mechanics (`gazebo`, `transmission`, `limit`, ...) are ignored and counted
    /// in [`Description::ignored`]; `visual` and `material` are ignored silently. URDF elements are those in the
    /// namespace of `<robot>`.
    ///
    /// # Errors
    /// Each with line, column and name of the element:
    /// * text that is not XML, a document type definition, a root other than `<robot>`, xacro elements;
    /// * elements nested deeper than 200 or with more than 100 attributes; more than 10,000 links, joints or collision
    ///   shapes, 2,000 moving joints, 1,000,000 XML nodes or attributes, 1,000 namespaces or kinds of unknown elements
    ///   (a refusal takes at most a second and 500 MB);
    /// * no link; a missing or duplicate name; a joint of unknown type or with an unknown link; anything but one tree;
    /// * text in place of a number, a number that is not finite, a negative mass or size, a zero axis.
    pub fn from_urdf(text: &str) -> Result<Self> {
        // Some programs end a file with zero bytes.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).trim_end_matches('\0');
        let mut description = draft::read(text)?;
        let root = tree::connect(&mut description.links, &description.joints);
        // As a <Joint> that is none.
        let of_robot = |name: &&String| name.starts_with('<') && name.contains(" in <robot>");
        let misspelt = |error: Error| match (error.remedy(), description.misspelt.iter().find(of_robot)) {
            (Some(remedy), Some(name)) => {
                let hint = format!("{remedy}; not read, and perhaps misspelt: {name}");
                error.hint(hint)
            }
            _ => error,
        };
        let has_foreign_joint = description.ignored.iter().any(|own| (own.parent, &*own.tag) == ("robot", "joint"));
        let of_other_programs = |error: Error| match error.remedy() {
            Some(remedy) if has_foreign_joint => {
                let hint =
                    format!("{remedy}; joints of another namespace, as <drake:joint>, are not read: write <joint>");
                error.hint(hint)
            }
            _ => error,
        };
        description.root = root.map_err(misspelt).map_err(of_other_programs)?;
        Ok(description)
    }

    /// The joint of that name (an index into [`Description::joints`]).
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}

/// A link as errors name it.
pub(crate) fn link_place(name: &str) -> String {
    format!("link \"{name}\"")
}

/// A joint as errors name it.
pub(crate) fn joint_place(name: &str) -> String {
    format!("joint \"{name}\"")
}

impl UrdfLink {
    /// `error` at this link.
    pub(crate) fn refuse(&self, error: impl Into<Error>) -> Error {
        error.into().at(link_place(&self.name)).on(self.location.line, self.location.column)
    }
}

impl UrdfJoint {
    /// `error` at this joint.
    pub(crate) fn refuse(&self, error: impl Into<Error>) -> Error {
        error.into().at(joint_place(&self.name)).on(self.location.line, self.location.column)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_values_arrive_in_their_places() {
        let text = r#"<robot name="r">
            <link name="a">
              <inertial>
                <inertia ixx="1" ixy="2" ixz="3" iyy="4" iyz="5" izz="6"/>
                <mass value=" 7.25 "/>
                <origin rpy="0.1 0.2 0.3" xyz=" 1e-3  +.5
                  -2. "/>
              </inertial>
              <collision><geometry><box size="1 2 3"/></geometry></collision>
              <visual><geometry><sphere radius="nonsense"/></geometry></visual>
              <collision><origin xyz="4 5 6"/><geometry><cylinder radius="0.5" length="2"/></geometry></collision>
              <collision><geometry><capsule radius="0.5" length="2"/></geometry></collision>
              <collision><geometry><sphere radius="0"/></geometry></collision>
              <collision><geometry><mesh filename="a &amp; b.stl" scale="1 -1 1"/></geometry></collision>
              <collision><geometry><plane normal="0 0 1"/></geometry></collision>
            </link>
            <joint name="j" type="prismatic"><child link="b"/><parent link="a"/><axis xyz="0 0 -3"/></joint>
            <joint name="k" type="revolute"><parent link="b"/><child link="c"/><mimic joint="j" multiplier="-2"/></joint>
            <link name="b"><inertial><mass value="0"/><inertia ixx="0" iyy="0" izz="0"/></inertial></link>
            <link name="c"/></robot>"#;
        let robot = Description::from_urdf(text).expect("a description");
        let link = &robot.links[0];
        let origin = Pose { xyz: [1e-3, 0.5, -2.0], rpy: [0.1, 0.2, 0.3] };
        let inertia = Some([[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]]);
        assert_eq!(link.inertial, Some(Inertial { origin, mass: 7.25, inertia }));
        // A missing inertial is no mass of zero.
        let zero = Inertial { origin: Pose::default(), mass: 0.0, inertia: Some([[0.0; 3]; 3]) };
        assert_eq!((&robot.links[1].inertial, &robot.links[2].inertial), (&Some(zero), &None));
        let shapes: Vec<&Geometry> = link.collisions.iter().map(|collision| &collision.geometry).collect();
        let expected = [
            Geometry::Box { size: [1.0, 2.0, 3.0] },
            Geometry::Cylinder { radius: 0.5, length: 2.0 },
            Geometry::Capsule { radius: 0.5, length: 2.0 },
            Geometry::Sphere { radius: 0.0 },
            Geometry::Mesh { file: "a & b.stl".into(), scale: [1.0, -1.0, 1.0], mesh: Mesh::Unread },
            Geometry::Unknown { tag: "plane".into() },
        ];
        assert_eq!(shapes, expected.each_ref());
        assert_eq!(link.collisions[1].origin, Pose { xyz: [4.0, 5.0, 6.0], rpy: [0.0; 3] });

        let [j, k] = robot.joints.as_slice() else { panic!("two joints") };
        assert_eq!((j.kind, j.parent, j.child, j.axis), (JointKind::Prismatic, 0, 1, [0.0, 0.0, -3.0]));
        let mimic = Some(Mimic { joint: 0, multiplier: -2.0, offset: 0.0 });
        assert_eq!((k.axis, &k.mimic), ([1.0, 0.0, 0.0], &mimic));
        assert_eq!((robot.root, robot.links[0].joint, robot.links[2].joint), (0, None, Some(1)));
    }

    #[test]
    fn untidy_files_are_read() {
        // No name, a default namespace, CRLF, a byte order mark, a foreign tag, a limit without velocity, a zero byte.
        let text = "\u{feff}<?xml version=\"1.0\"?>\r\n<robot xmlns=\"http://drake.mit.edu\" xmlns:d=\"d\" version=\"1.2\">\r\n\
            <d:link name=\"not one\"/><gazebo reference=\"x\"><link name=\"nor this\"/></gazebo><gazebo/>\r\n\
            <link name=\"Rad é 1\"><collision><geometry><sphere radius=\"0\"/></geometry></collision></link>\r\n\
            <link name=\"j\"/><joint name=\"j\" type=\"revolute\"><parent link=\"Rad é 1\"/><child link=\"j\"/>\
            <limit effort=\"x\"/></joint></robot>\0";
        let robot = Description::from_urdf(text).expect("a description");
        assert_eq!((robot.name.as_str(), robot.links[0].name.as_str(), robot.links.len()), ("", "Rad é 1", 2));
        assert_eq!((robot.links[0].location, robot.joints[0].location.line), (Location { line: 4, column: 1 }, 5));
        let ignored: Vec<_> =
            robot.ignored.iter().map(|Ignored { parent, tag, count }| (*parent, tag.as_str(), *count)).collect();
        assert_eq!(ignored, [("robot", "link", 1), ("robot", "gazebo", 2), ("joint", "limit", 1)]);
    }
}
