//! Files that break a rule of XML, of URDF or of physics, and are read all the same.

use super::*;

/// A massive link.
const LINK: &str = "<link name=\"a\"><inertial><mass value=\"1\"/></inertial></link>";

#[test]
fn a_misspelt_or_late_declaration_is_passed_over() {
    for declaration in [
        "<?xml verison=\"1.0\"?>",
        "<?xml version=\"1.0\" encoding=\"utf-8\">",
        "<?xml version='1.0' encoding='latin-9' standalone=perhaps?>",
        "\n\n<?xml version=\"1.0\"?>",
        "<!-- made by hand -->\n<?xml version=\"1.0\"?>\n<?xml-model href=\"x\"?>",
        "\u{feff}<?xml version=\"1.1\"?>",
    ] {
        let robot = load(&format!("{declaration}\r\n<robot>{LINK}</robot>"));
        assert_eq!(robot.links.len(), 1, "{declaration}");
    }
    // Declaring macros is not using them.
    let declared = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">";
    assert_eq!(load(&format!("{declared}{LINK}</robot>")).links.len(), 1);
}

#[test]
fn undeclared_prefixes_are_listed_and_passed_over() {
    let text = format!(
        "<robot name=\"r\">\n{LINK}<sensor:camera name=\"c\"><sensor:image/></sensor:camera><controller:x/>\n\
         <link name=\"b\" drake:ignore=\"true\"/></robot>"
    );
    let refused = Robot::from_urdf(&text).expect_err("two roots");
    // The place is that of the file.
    assert_eq!(refused.to_string(), "3:1: link \"b\": links \"a\" and \"b\" are both roots");
    let robot = load(&text.replace("<link name=\"b\" drake:ignore=\"true\"/>", ""));
    let listed = |tag: &str| left_out(&format!("<{tag}> in <robot>"), "no part of the robot's mechanics");
    assert_eq!(robot.left_out, [left_out("link \"a\"", POINT), listed("camera"), listed("x")]);
}

const POINT: &str = "its <inertial> has no <inertia>: taken as a point mass";

#[test]
fn an_inertia_that_no_body_has_is_listed() {
    let link = |ixx: f64, iyy: f64, izz: f64| {
        robot(&format!(
            "<link name=\"a\"><inertial><mass value=\"1\"/><inertia ixx=\"{ixx}\" iyy=\"{iyy}\" izz=\"{izz}\"/></inertial></link>"
        ))
    };
    let why = "no body can have its inertia: the moment about the plane's normal is taken as it is, the rest left out";
    for (ixx, iyy, izz) in [(0.0, 0.5, 0.0), (-1.0, 0.5, 0.5), (0.1, 0.5, 0.1)] {
        let robot = load(&link(ixx, iyy, izz));
        assert_eq!((robot.bodies[0].moment, &robot.left_out[..]), (iyy, &[left_out("link \"a\"", why)][..]));
    }
    // A point mass is a body.
    assert_eq!(load(&link(0.0, 0.0, 0.0)).left_out, []);
}
