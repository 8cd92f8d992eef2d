//! Elements of URDF files in the x-z plane.

use std::fmt::Display;

/// The URDF of a robot with these elements.
pub fn robot(elements: &[String]) -> String {
    format!("<robot name=\"mechanism\">\n{}</robot>\n", elements.concat())
}

/// The URDF of a robot of one link of 2 kg with its CoG at its origin.
pub fn body(moment: f64, collisions: &str) -> String {
    robot(&[link("body", 2.0, [0.0; 2], moment, collisions)])
}

/// A link with the same moment of inertia about every axis, and its `<collision>` elements.
pub fn link(name: impl Display, mass: f64, [x, z]: [f64; 2], moment: f64, collisions: &str) -> String {
    format!(
        "<link name=\"{name}\"><inertial><origin xyz=\"{x} 0 {z}\"/><mass value=\"{mass}\"/>\
         <inertia ixx=\"{moment}\" iyy=\"{moment}\" izz=\"{moment}\"/></inertial>{collisions}</link>\n"
    )
}

/// A `<collision>` of a shape such as `sphere radius="0.1"`.
pub fn collision([x, z]: [f64; 2], shape: &str) -> String {
    format!("<collision><origin xyz=\"{x} 0 {z}\"/><geometry><{shape}/></geometry></collision>")
}

pub const POINT: &str = "sphere radius=\"0\"";

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Axis {
    /// About the plane's normal, times this sign.
    Revolute(f64),
    /// Along this direction.
    Prismatic([f64; 2]),
    Fixed,
    /// About the vertical, out of the plane.
    OffPlane,
}

/// A revolute joint about the plane's normal.
pub const HINGE: Axis = Axis::Revolute(1.0);

/// A joint with wide limits and with `more` elements.
pub fn joint(name: impl Display, axis: Axis, ends: [&str; 2], [x, z]: [f64; 2], more: &str) -> String {
    let (kind, axis) = match axis {
        Axis::Revolute(sign) => ("revolute", format!("0 {sign} 0")),
        Axis::Prismatic([x, z]) => ("prismatic", format!("{x} 0 {z}")),
        Axis::Fixed => ("fixed", "1 0 0".to_owned()),
        Axis::OffPlane => ("revolute", "0 0 1".to_owned()),
    };
    let limit = "<limit lower=\"-9\" upper=\"9\" effort=\"9\" velocity=\"9\"/>";
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{}\"/><child link=\"{}\"/><origin xyz=\"{x} 0 {z}\"/>\
         <axis xyz=\"{axis}\"/>{limit}{more}</joint>\n",
        ends[0], ends[1]
    )
}
