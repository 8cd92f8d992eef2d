//! Reads URDF text into a checked description: the links and joints of the file, in three dimensions, as one tree. This
//! is the only module that uses urdf-rs and roxmltree.
//!
//! ```text
//!     text --repair, xml--> elements --draft: values in urdf-rs's types--> links, joints --tree--> Description
//! ```
//!
//! urdf-rs's own reader accepts too much in some places and too little in others: it drops non-numbers from a vector,
//! reads a missing `<inertial>` as a mass of zero, and rejects an incomplete `<limit>`. So this module checks every
//! element itself and reports its location in the text. It opens no files, starts no processes and does not recurse.
//! Time and memory grow linearly with the text.

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

/// The caution about joints of another namespace. Drake's planar joint has no axis, so the axis must be added.
pub(crate) const FOREIGN_JOINTS: &str = "joints of another namespace, as <drake:joint>, are not read: write <joint>, with \
    <axis xyz=\"0 0 1\"/> for a planar one of Drake";

/// A robot as described by its file, checked and connected to one tree.
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
    /// The robot's name; empty if the file gives none.
    pub name: String,
    /// The links in the file's order. There is at least one, and names are unique.
    pub links: Vec<UrdfLink>,
    /// The joints in the file's order. Names are unique among joints; a joint may have the name of a link.
    pub joints: Vec<UrdfJoint>,
    /// The link that is no joint's child (an index into [`Description::links`]).
    pub root: usize,
    /// Elements that are not read, in the order of their first occurrence.
    pub ignored: Vec<Ignored>,
    /// Attributes and elements that are not read and may be misspelt, and impossible limits, each with its line.
    pub misspelt: Vec<String>,
    /// The joints whose transmissions have a rotor inertia in the file. It is not read.
    pub rotors: Vec<String>,
    /// The packages of meshes whose folder is guessed, each with that folder.
    pub guessed: Vec<String>,
}

/// A link of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfLink {
    /// The link's name, unique among links.
    pub name: String,
    /// The link's inertia; `None` if the file has no `<inertial>`, which differs from a mass of zero.
    pub inertial: Option<Inertial>,
    /// The link's collision shapes in the file's order.
    pub collisions: Vec<Collision>,
    /// The joint whose child is this link (an index into [`Description::joints`]); `None` for the root.
    pub joint: Option<usize>,
    /// Where the link's element begins.
    pub location: Location,
}

/// Mass, center of mass and inertia of a link.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Inertial {
    /// The center of mass and the axes of the inertia, in the link's frame.
    pub origin: Pose,
    /// Mass \[kg\], at least zero.
    pub mass: f64,
    /// Inertia about the center of mass in the axes of `origin`, symmetric \[kg m^2\]; `None` if the file has no
    /// `<inertia>`. It is finite, but otherwise unchecked: in many files no rigid body can have it.
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

/// A shape about the origin of its own frame. All sizes are finite and at least zero \[m\].
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
#[non_exhaustive]
pub enum Geometry {
    /// A box with these full side lengths along x, y and z.
    Box { size: [f64; 3] },
    /// A cylinder about the z axis.
    Cylinder { radius: f64, length: f64 },
    /// A cylinder about the z axis with a half ball at each end. `length` excludes the half balls.
    Capsule { radius: f64, length: f64 },
    /// A sphere; a radius of 0 means a point.
    Sphere { radius: f64 },
    /// A mesh: the file name as given, the scale factors along x, y and z (negative ones mirror), and the vertices read
    /// from the file, without scaling.
    Mesh { file: String, scale: [f64; 3], mesh: Mesh },
    /// A shape that URDF does not have, by the tag of its element.
    Unknown { tag: String },
}

/// A joint of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfJoint {
    /// The joint's name, unique among joints.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The parent link (an index into [`Description::links`]).
    pub parent: usize,
    /// The child link, whose frame is that of the joint.
    pub child: usize,
    /// The joint's frame in the parent link's frame, at coordinate zero.
    pub origin: Pose,
    /// The axis in the joint's frame, of any length, and nonzero if `kind` has an axis. It is (1, 0, 0) if the file
    /// gives none.
    pub axis: [f64; 3],
    /// Whether the file gives an axis.
    pub has_axis: bool,
    /// The mimicked joint, if this is a mimic joint.
    pub mimic: Option<Mimic>,
    /// The smallest and largest coordinate \[rad or m\], which may be infinite. `None` if the joint is neither revolute
    /// nor prismatic, or if the file gives no limits with lower < upper.
    pub limits: Option<[f64; 2]>,
    /// Where the joint's element begins.
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
    /// Leaves all six degrees of freedom free.
    Floating,
    /// Rotates about every axis (a later addition to URDF).
    Spherical,
}

impl JointKind {
    pub(crate) const ALL: [Self; 7] =
        [Self::Fixed, Self::Revolute, Self::Continuous, Self::Prismatic, Self::Planar, Self::Floating, Self::Spherical];

    /// Returns whether the joint's motion depends on its axis.
    pub fn has_axis(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous | Self::Prismatic | Self::Planar)
    }

    /// Returns the kind's name in URDF.
    pub fn name(self) -> &'static str {
        ["fixed", "revolute", "continuous", "prismatic", "planar", "floating", "spherical"][self as usize]
    }
}

/// A mimic joint's coordinate: `multiplier` times that of the mimicked joint plus `offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    /// The mimicked joint (an index into [`Description::joints`]).
    pub joint: usize,
    /// The factor, by default 1; its unit is m, rad or a quotient of these.
    pub multiplier: f64,
    /// The summand, by default 0 \[rad or m\].
    pub offset: f64,
}

/// Elements with the same tag that are not read, inside elements with the tag `parent`: `robot`, `link` or `joint`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ignored {
    /// The tag of the enclosing element.
    pub parent: &'static str,
    /// The tag of the elements.
    pub tag: String,
    /// Number of the elements.
    pub count: usize,
}

impl Description {
    /// Reads and checks the text of a URDF file.
    ///
    /// Elements that are not part of URDF's mechanics (`gazebo`, `transmission`, `limit`, ...) are not read, and are
    /// counted in [`Description::ignored`]. `visual` and `material` are ignored without counting. Only elements in the
    /// namespace of `<robot>` are URDF elements.
    ///
    /// # Errors
    /// Returns an error with line, column and name of the element in these cases:
    /// * The text is not XML, has a document type definition, has a root other than `<robot>`, or contains xacro
    ///   elements.
    /// * Elements are nested deeper than 200 or have more than 100 attributes. There are more than 10,000 links, joints
    ///   or collision shapes, 2,000 moving joints, 1,000,000 XML nodes or attributes, 1,000 namespaces or kinds of
    ///   unknown elements (a refusal takes at most a second and 500 MB).
    /// * There is no link, a name is missing or duplicate, a joint has an unknown type or link, or the joints do not
    ///   form one tree.
    /// * There is text in place of a number, a number that is not finite, a negative mass or size, or a zero axis.
    pub fn from_urdf(text: &str) -> Result<Self> {
        // Some programs append zero bytes to a file.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).trim_end_matches('\0');
        let mut description = draft::read(text)?;
        let tree = tree::connect(&description.links, &description.joints);
        // For example, <Joint> in place of <joint>.
        let of_robot = |name: &&String| name.starts_with('<') && name.contains(" in <robot>");
        let misspelt = description.misspelt.iter().find(of_robot);
        let misspelt = misspelt.map(|name| format!("not read, and perhaps misspelt: {name}"));
        let foreign = description.has_foreign_joints().then(|| FOREIGN_JOINTS.to_owned());
        let (inward, root) = tree.map_err(|error: Error| {
            let Some(remedy) = error.remedy().map(str::to_owned) else { return error };
            let hints: Vec<String> = [remedy].into_iter().chain(misspelt).chain(foreign).collect();
            error.hint(hints.join("; "))
        })?;
        description.root = root;
        description.links.iter_mut().zip(inward).for_each(|(link, joint)| link.joint = joint);
        Ok(description)
    }

    /// Returns whether the file has joints that are not read because their namespace is not that of `<robot>`.
    pub(crate) fn has_foreign_joints(&self) -> bool {
        self.ignored.iter().any(|element| (element.parent, &*element.tag) == ("robot", "joint"))
    }

    /// Returns the index in [`Description::joints`] of the joint with this name; `None` if there is none.
    pub fn joint(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }
}

/// Returns the name of a link for use in errors.
pub(crate) fn link_place(name: &str) -> String {
    format!("link \"{name}\"")
}

/// Returns the name of a joint for use in errors.
pub(crate) fn joint_place(name: &str) -> String {
    format!("joint \"{name}\"")
}

impl UrdfLink {
    /// Returns `error` with the place of this link.
    pub(crate) fn refuse(&self, error: impl Into<Error>) -> Error {
        error.into().at(link_place(&self.name)).on(self.location.line, self.location.column)
    }
}

impl UrdfJoint {
    /// Returns `error` with the place of this joint.
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
        // A missing <inertial> differs from a mass of zero.
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
        // No name, a default namespace, CRLF, a byte order mark, a foreign element, a limit without velocity, a zero
        // byte.
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
