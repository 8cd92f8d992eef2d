//! Files that break a rule of XML, of URDF or of physics, and are read nevertheless.

use super::*;

/// A link of 1 kg.
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
        assert_eq!(robot.links().len(), 1, "{declaration}");
    }
    // A file that declares xacro need not use macros.
    let declared = "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">";
    assert_eq!(load(&format!("{declared}{LINK}</robot>")).links().len(), 1);
}

#[test]
fn undeclared_prefixes_are_listed_and_passed_over() {
    let text = format!(
        "<robot name=\"r\">\n{LINK}<sensor:camera name=\"c\"><sensor:image/></sensor:camera><controller:x/>\n\
         <link name=\"b\" drake:ignore=\"true\"/></robot>"
    );
    let refused = Robot::from_urdf(&text).expect_err("two roots");
    // The place refers to the text of the file.
    assert_eq!(refused.to_string(), "3:1: link \"b\": links \"a\" and \"b\" are both roots");
    let robot = load(&text.replace("<link name=\"b\" drake:ignore=\"true\"/>", ""));
    let listed = |tag: &str| left_out(&format!("<{tag}> in <robot>"), "no part of the robot's mechanics");
    assert_eq!(robot.left_out(), [left_out("link \"a\"", POINT), listed("camera"), listed("x")]);
}

/// Without this joint the tree is still complete, so the base would float without an error.
#[test]
fn a_joint_of_another_namespace_is_named() {
    let joint = "<drake:joint name=\"j\" type=\"universal\"><parent link=\"world\"/><child link=\"a\"/></drake:joint>";
    let robot = load(&format!("<robot name=\"r\">\n{LINK}{joint}</robot>"));
    let what = "joints of another namespace, as <drake:joint>, are not read: write <joint>, with <axis xyz=\"0 0 1\"/> for a \
                planar one of Drake";
    assert!(robot.reading().cautions.iter().any(|caution| caution == what), "{:?}", robot.reading().cautions);
    let why = "a joint of another namespace, which is not read";
    assert!(robot.left_out().contains(&left_out("<joint> in <robot>", why)), "{:?}", robot.left_out());
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
        assert_eq!((robot.bodies()[0].moment, robot.left_out()), (iyy, &[left_out("link \"a\"", why)][..]));
    }
    // A body may be a point mass.
    assert_eq!(load(&link(0.0, 0.0, 0.0)).left_out(), []);
}

#[test]
fn foreign_elements_at_a_shape_are_passed_over() {
    let geometry = |inside: &str| {
        let link = LINK.replace("</link>", &format!("<collision><geometry>{inside}</geometry></collision></link>"));
        Robot::from_urdf(&format!("<robot name=\"r\">{link}</robot>"))
    };
    let shapes = |inside: &str| geometry(inside).expect("a robot").links()[0].shapes.len();
    assert_eq!(shapes("<drake:declare_convex/><sphere radius=\"1\"/>"), 1);
    assert_eq!(shapes("<sphere radius=\"1\"/><drake:declare_convex/>"), 1);
    assert_eq!(shapes("<drake:capsule radius=\"1\" length=\"2\"/>"), 1);
    assert!(geometry("<sphere radius=\"1\"/><sphere radius=\"2\"/>").is_err());
}

#[test]
fn moment_that_is_negative_by_rounding_is_zero() {
    let link = |iyy: f64| {
        let inertia = format!("<inertia ixx=\"1e-3\" iyy=\"{iyy:e}\" izz=\"1e-3\"/>");
        Robot::from_urdf(&robot(&format!("<link name=\"a\"><inertial><mass value=\"1\"/>{inertia}</inertial></link>")))
    };
    let robot = link(-5e-20).expect("a robot");
    assert_eq!(robot.bodies()[0].moment, 0.0);
    let why = "its moment about the plane's normal is -5e-20 kg m^2, which is rounding: taken as 0";
    assert_eq!(robot.left_out(), [left_out("link \"a\"", why)]);
    assert!(link(-5e-10).is_err());
}

#[test]
fn a_negative_moment_is_kept_if_its_body_has_another() {
    let text = |iyy: &str| {
        chain(&[1.0, 2.0, 0.0], &[("fixed", "1 0 0"), PITCH]).replacen("iyy=\"1\"", &format!("iyy=\"{iyy}\""), 1)
    };
    // The two links are 1 m apart, which gives 2 / 3 kg m^2.
    let robot = load(&text("-0.5"));
    assert!((robot.bodies()[0].moment - (2.0 - 0.5 + 2.0 / 3.0)).abs() < 1e-15, "{:?}", robot.bodies()[0]);
    let caution = "with an inertia that no body has, one moment being more than the other two together: a; correct it";
    assert!(robot.reading().cautions.iter().any(|own| own == caution), "{:?}", robot.reading().cautions);
    for weld in [false, true] {
        let reductions = heelstrike::reductions::Reductions { weld, ..Default::default() };
        let reduced = |iyy: &str| {
            let description = Description::from_urdf(&text(iyy)).expect("a description");
            Robot::reduce(&description, &Reduction { reductions, ..Reduction::default() })
        };
        assert!(reduced("-0.5").is_ok());
        let refused = reduced("-3").expect_err("a negative sum").to_string();
        let reason = "2:1: link \"a\": the moment of inertia about the plane's normal must be at least 0, not -0.33333";
        assert!(refused.starts_with(reason), "{refused}");
    }
}

#[test]
fn an_origin_inside_a_geometry_is_named() {
    let inside = "<origin xyz=\"9 9 9\"/><sphere radius=\"1\"/>";
    let collision = format!("\n<collision>\n<geometry>\n{inside}</geometry></collision></link>");
    let robot = load(&robot(&LINK.replace("</link>", &collision)));
    assert_eq!(disc(&robot.links()[0]), ([0.0; 2], 1.0));
    let caution = "not read, and perhaps misspelt: <origin> in <geometry> on line 5 (in <collision>?)";
    assert!(robot.reading().cautions.iter().any(|own| own == caution), "{:?}", robot.reading().cautions);
}

#[test]
fn an_element_given_twice_alike_counts_once() {
    let axis = "<axis xyz=\"0 1 0\"/>";
    let text = massive(&[PITCH]);
    assert_eq!(names(&load(&text.replace(axis, &axis.repeat(2)))), ["j"]);
    assert!(Robot::from_urdf(&text.replace(axis, &format!("{axis}<axis xyz=\"0 -1 0\"/>"))).is_err());
}

#[test]
fn macros_in_what_is_seen_are_passed_over() {
    let seen = |element: &str| {
        let mesh = format!("<{element}><geometry><mesh filename=\"$(find x)/y.stl\"/></geometry></{element}></link>");
        Robot::from_urdf(&robot(&LINK.replace("</link>", &mesh)))
    };
    assert!(seen("visual").is_ok());
    assert!(seen("collision").is_err());
}

#[test]
fn hyphens_in_comments_are_passed_over() {
    let text = format!("<robot>\n<!-- <a> -- <!-- ä --->{LINK}<!-- <link -->\n<link name=\"b\"/></robot>");
    // A comment ends at the first `-->`, and places are those of the file.
    let refused = Robot::from_urdf(&text).expect_err("two roots");
    assert_eq!(refused.to_string(), "3:1: link \"b\": links \"a\" and \"b\" are both roots");
    assert_eq!(load(&text.replace("<link name=\"b\"/>", "")).links().len(), 1);
}

#[test]
fn a_sole_turned_by_3_14_is_flat() {
    let corners = |roll: f64| {
        let sole = format!(
            "<collision><origin rpy=\"{roll} 0 0\"/><geometry><cylinder radius=\"0.1\" length=\"0.03\"/></geometry>\
             </collision>"
        );
        let robot = load(&urdf::robot(&[link("a", 1.0, [0.0; 2], 1.0, &sole)]));
        robot.links()[0].shapes[0].corners().len()
    };
    assert_eq!([0.0, 314.0 / 100.0, 1e-2].map(corners), [4, 4, 2]);
}
