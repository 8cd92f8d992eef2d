//! From URDF text to robot: what is read and with which digits, what is merged, skipped or refused, and with which
//! words.
//!
//! These tests cover what a user sees of the loader through `Robot`; details of one stage are tested next to its code.

use crate::support::command::read;
use crate::support::impact::{reduced as reduce, robot as load};
use crate::support::robots::{ROBOTS, robot_and_reference};
use crate::support::urdf::{self, HINGE, joint, link};
use heelstrike::description::Description;
use heelstrike::planar::Vector;
use heelstrike::robot::{Axis, Base, LeftOutPart, Link, ParentJoint, Reduction, Rim, Robot};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

mod base;
mod cautions;
mod plane;
mod untidy;

/// Center and radius of a link's only shape, which must be a disc.
fn disc(link: &Link) -> ([f64; 2], f64) {
    let [shape] = &link.shapes[..] else { panic!("one shape") };
    match (shape.corners(), shape.rim) {
        (&[center], Rim::Circle { radius }) => (center.components(), radius),
        other => panic!("{other:?} is no disc"),
    }
}

/// Loads a robot with these joints frozen at values.
fn holding(text: &str, hold: &[(usize, f64)]) -> Robot {
    reduce(text, &Reduction { hold: hold.to_vec(), ..Reduction::default() })
}

/// urdf-rs's own reader, which checks less, finds the same values in files that it accepts.
#[test]
fn values_are_those_that_urdf_rs_reads() {
    let mut compared = 0;
    for folder in ROBOTS {
        let text = read(&robot_and_reference::<Value>(folder).0);
        let (Ok(theirs), ours) =
            (urdf_rs::read_from_string(&text), Description::from_urdf(&text).expect("a good file"))
        else {
            continue;
        };
        let pose = |pose: &urdf_rs::Pose| (pose.xyz.0, pose.rpy.0);
        for (own, other) in ours.links.iter().zip(&theirs.links) {
            let urdf_rs::Inertial { origin, mass, inertia } = &other.inertial;
            let urdf_rs::Inertia { ixx, ixy, ixz, iyy, iyz, izz } = *inertia;
            let inertial = own.inertial.clone().unwrap_or_default();
            let matrix = [[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]];
            assert_eq!((&own.name, inertial.mass), (&other.name, mass.value));
            assert_eq!((inertial.origin.xyz, inertial.origin.rpy), pose(origin), "{}", own.name);
            assert_eq!(inertial.inertia.unwrap_or_default(), matrix, "{}", own.name);
            let places = own.collisions.iter().map(|own| (own.origin.xyz, own.origin.rpy)).collect::<Vec<_>>();
            assert_eq!(places, other.collision.iter().map(|own| pose(&own.origin)).collect::<Vec<_>>(), "{}", own.name);
        }
        for (own, other) in ours.joints.iter().zip(&theirs.joints) {
            assert_eq!(
                (&own.name, own.origin.xyz, own.origin.rpy),
                (&other.name, other.origin.xyz.0, other.origin.rpy.0)
            );
            assert_eq!((own.axis, &ours.links[own.child].name), (other.axis.xyz.0, &other.child.link));
        }
        // The link `world` need not be in the file.
        let named =
            ours.links.iter().filter(|own| own.name != "world" || theirs.links.iter().any(|t| t.name == own.name));
        assert_eq!((named.count(), ours.joints.len()), (theirs.links.len(), theirs.joints.len()));
        compared += 1;
    }
    assert!(compared > 4, "{compared} robots");
}

/// Adds a <mimic> element to a revolute joint.
fn with_mimic(text: &str, joint: &str, mimic: &str) -> String {
    let joint = format!("name=\"{joint}\" type=\"revolute\">");
    text.replace(&joint, &format!("{joint}<mimic {mimic}/>"))
}

/// A robot with these elements, which begin on line 2.
fn robot(body: &str) -> String {
    format!("<robot name=\"r\">\n{body}\n</robot>")
}

/// Revolute joints by their axes.
const ROLL: (&str, &str) = ("revolute", "1 0 0");
const PITCH: (&str, &str) = ("revolute", "0 1 0");
const YAW: (&str, &str) = ("revolute", "0 0 1");

/// Links a, b, c ... of these masses in a chain, each 1 m below the one before, with joints j, k, l ... of these types
/// and axes; one element per line.
fn chain(masses: &[f64], joints: &[(&str, &str)]) -> String {
    let letter = |first: char, k: usize| (first..='z').nth(k).expect("few");
    let link = |(k, &mass): (usize, &f64)| match letter('a', k) {
        name if mass == 0.0 => format!("<link name=\"{name}\"></link>\n"),
        name => link(name, mass, [0.0; 2], mass, ""),
    };
    let joint = |(k, (kind, axis)): (usize, &(&str, &str))| {
        let [name, parent, child] = [letter('j', k), letter('a', k), letter('a', k + 1)];
        format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
             <origin xyz=\"0 0 -1\"/><axis xyz=\"{axis}\"/></joint>\n"
        )
    };
    robot(&masses.iter().enumerate().map(link).chain(joints.iter().enumerate().map(joint)).collect::<String>())
}

/// A chain of links of 1 kg.
fn massive(joints: &[(&str, &str)]) -> String {
    chain(&vec![1.0; joints.len() + 1], joints)
}

/// Moves the last four joints of a chain of seven to two arms that hang from `a`.
fn with_arms(chain: &str) -> String {
    let raised = |text: &str, from: char, to: char, place: &str| {
        let ends = |parent: char, place: &str| {
            format!("<parent link=\"{parent}\"/><child link=\"{to}\"/><origin xyz=\"{place}\"/>")
        };
        text.replace(&ends(from, "0 0 -1"), &ends('a', place))
    };
    raised(&raised(chain, 'd', 'e', "0 1 0"), 'f', 'g', "0 -1 0")
}

fn names(robot: &Robot) -> Vec<&str> {
    robot.joints().iter().map(|joint| joint.name.as_str()).collect()
}

#[track_caller]
fn only_caution(robot: &Robot) -> &str {
    let [caution] = &robot.reading().cautions[..] else { panic!("{:?}", robot.reading().cautions) };
    caution
}

/// Links `a` and `b` of 1 kg, and a joint of this type with these elements.
fn two_links(kind: &str, elements: &str) -> String {
    massive(&[(kind, "")]).replace("<origin xyz=\"0 0 -1\"/><axis xyz=\"\"/>", elements)
}

/// Asserts equality to 1e-15, the rounding of a few operations on numbers of order one.
#[track_caller]
fn assert_at(found: Vector, [x, z]: [f64; 2]) {
    assert!((found.x - x).abs() < 1e-15 && (found.z - z).abs() < 1e-15, "{found:?} is not {x}, {z}");
}

fn left_out(what: &str, why: &str) -> LeftOutPart {
    LeftOutPart { what: what.into(), why: why.into() }
}

// Robots of other projects.

#[test]
fn wheels_are_discs_and_unread_meshes_left_out() {
    let upkie = load(include_str!("../../data/robots/upkie/upkie.urdf"));
    let tire = &upkie.links()[upkie.link("left_wheel_tire").expect("a tire")];
    assert_eq!(disc(tire).1, 0.05);

    let solo = load(include_str!("../../data/robots/solo8/solo.urdf"));
    assert!(solo.links().iter().all(|link| link.shapes.is_empty()));
    let foot = "collision mesh \"package://example-robot-data/robots/solo_description/meshes/obj/with_foot/solo_foot.obj\" \
                of link \"FL_FOOT\"";
    assert!(solo.left_out().contains(&left_out(foot, "its file was not read")), "{:?}", solo.left_out());
    assert!(
        solo.left_out().contains(&left_out("12 <limit> in <joint>", "joint limits enter neither an impact nor forces"))
    );
}

#[test]
fn a_robot_without_a_name_is_called_one() {
    let urdf = massive(&[]).replacen("name=", "noname=", 1);
    assert_eq!(load(&urdf).name(), "robot", "{urdf}");
}

#[test]
fn quarter_turns_leave_a_symmetric_robot_symmetric() {
    // Its fixed joints turn by 1.5707963267948966, whose cosine in f64 is 6e-17.
    let upkie = load(include_str!("../../data/robots/upkie/upkie.urdf"));
    let bits = |point: Vector| point.components().map(f64::to_bits);
    for (left, right) in [(1, 4), (2, 5), (3, 6)] {
        let [left, right] = [left, right].map(|body: usize| &upkie.bodies()[body]);
        let joints = [left, right].map(|body| body.joint);
        let [Some(ParentJoint::Joint(a)), Some(ParentJoint::Joint(b))] = joints else { panic!("{joints:?}") };
        assert_eq!(bits(upkie.joints()[a].origin), bits(upkie.joints()[b].origin), "{}", right.name);
        assert_eq!(upkie.joints()[a].origin.x, 0.0, "{}", left.name);
        assert_eq!(bits(left.com), bits(right.com), "{}", right.name);
        assert_eq!([left.mass, left.moment], [right.mass, right.moment], "{}", right.name);
    }
}

// Joints.

#[test]
fn an_axis_has_a_sign_and_is_brought_into_line() {
    let why = |angle: &str| format!("its axis is {angle} rad off the plane's normal: taken as exactly on it");
    // Rolled by a quarter turn, b's own z axis is the root's -y.
    for (roll, axis, sign, off) in [
        (0.0, "0 1 0", 1.0, None),
        (0.0, "0 -1 0", -1.0, None),
        (0.0, "0 1e300 0", 1.0, None),
        (0.0, "0 -1e-310 0", -1.0, None),
        (0.0, "0.0009 1 0", 1.0, Some("9.0e-4")),
        (0.0, "0 1 5e-4", 1.0, Some("5.0e-4")),
        (FRAC_PI_2, "0 0 1", -1.0, None),
    ] {
        for kind in ["revolute", "continuous"] {
            let robot = load(&two_links(kind, &format!("<origin rpy=\"{roll} 0 0\"/><axis xyz=\"{axis}\"/>")));
            assert_eq!(robot.joints()[0].axis, Axis::Revolute { sign }, "{axis}");
            let expected: Vec<_> = off.map(|angle| left_out("joint \"j\"", &why(angle))).into_iter().collect();
            assert_eq!(robot.left_out(), expected, "{axis}");
        }
    }
}

#[test]
fn a_slide_has_its_direction_in_the_roots_axes() {
    let direction = |joint: &str| match load(&two_links("prismatic", joint)).joints()[0].axis {
        Axis::Prismatic { direction } => direction,
        Axis::Revolute { .. } => panic!("it turns"),
    };
    assert_eq!(direction("<axis xyz=\"0 0 -2\"/>"), [0.0, -1.0]);
    assert_eq!(direction("<axis xyz=\"0.6 0 0.8\"/>"), [0.6, 0.8]);
    assert_eq!(direction(""), [1.0, 0.0]);
    // Pitched by a: x points down by sin a.
    let Vector { x, z } = direction("<origin rpy=\"0 0.3 0\"/>");
    assert!((x - 0.3_f64.cos()).abs() < 1e-16 && (z + 0.3_f64.sin()).abs() < 1e-16);
}

#[test]
fn joints_keep_their_order_and_parents_come_first() {
    let link = |name: &str| link(name, 1.0, [0.0; 2], 1.0, "");
    let hinge = |name: &str, parent: &str, child: &str| joint(name, HINGE, [parent, child], [0.0; 2], "");
    let text = urdf::robot(&[
        hinge("ankle", "shin", "foot"),
        link("foot"),
        hinge("knee", "thigh", "shin"),
        ["shin", "thigh", "root"].map(link).concat(),
        hinge("hip", "root", "thigh"),
        hinge("tail", "root", "tip"),
        link("tip"),
    ]);
    let robot = load(&text);
    assert_eq!(robot.coordinates().skip(3).collect::<Vec<_>>(), ["ankle", "knee", "hip", "tail"]);
    let bodies: Vec<_> = robot.bodies().iter().map(|body| (body.name.as_str(), body.joint)).collect();
    let joint = |joint| Some(ParentJoint::Joint(joint));
    let expected = [("root", None), ("thigh", joint(2)), ("shin", joint(1)), ("foot", joint(0)), ("tip", joint(3))];
    assert_eq!(bodies, expected);
    assert_eq!(robot.links().iter().map(|link| link.body).collect::<Vec<_>>(), [3, 2, 1, 0, 4]);
}

// Welding.

#[test]
fn fixed_links_are_merged_with_their_turned_inertia() {
    let text = robot(&format!(
        "{}<link name=\"b\"><inertial><origin xyz=\"0 7 1\"/><mass value=\"3\"/>\
         <inertia ixx=\"0.2\" ixy=\"0\" ixz=\"0\" iyy=\"9\" iyz=\"0\" izz=\"0.1\"/></inertial>\
         <collision><geometry><sphere radius=\"0.1\"/></geometry></collision></link>\n{}<joint name=\"weld\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>\
         <origin xyz=\"2 5 0\" rpy=\"0 {FRAC_PI_2} {FRAC_PI_2}\"/></joint>\n\
         <joint name=\"hinge\" type=\"continuous\"><parent link=\"b\"/><child link=\"c\"/><axis xyz=\"1 0 0\"/>\
         <origin xyz=\"0 0 1\" rpy=\"0 -{FRAC_PI_2} 0\"/></joint>",
        link("a", 1.0, [0.0, 4.0], 0.5, ""),
        link("c", 1.0, [0.0; 2], 1.0, "")
    ));
    // The fixed joint turns b's x to the root's -z, y to -x and z to y: b's CoG is at (2 - 7, 5 + 1, 0), its moment
    // izz.
    let robot = load(&text);
    let body = &robot.bodies()[0];
    assert_eq!((robot.bodies().len(), body.mass), (2, 4.0));
    // CoG (-5 * 3 / 4, 4 / 4), arms (3.75, 3) and (-1.25, -1).
    let expected = [-3.75, 1.0, 0.5 + 3.75 * 3.75 + 9.0 + 0.1 + 3.0 * (1.25 * 1.25 + 1.0)];
    for (value, expected) in [body.com.x, body.com.z, body.moment].into_iter().zip(expected) {
        assert!((value - expected).abs() < 1e-14, "{value} is not {expected}");
    }
    // The point (1, 2, 3) of b: (2, 5, 0) + (-2, 3, -1).
    assert_at(robot.links()[1].point::<f64>([1.0, 2.0, 3.0]), [0.0, -1.0]);
    assert_eq!((disc(&robot.links()[1]), robot.links()[1].body), (([2.0, 0.0], 0.1), 0));
    // The hinge stands in the merged body at (2, 6, 0); c's x is b's z, the normal.
    assert_at(robot.joints()[0].origin, [2.0, 0.0]);
    assert_eq!((robot.joints()[0].parent, robot.joints()[0].axis), (0, Axis::Revolute { sign: 1.0 }));
}

#[test]
fn a_box_foot_keeps_its_exact_corners_through_a_weld() {
    let robot = load(&urdf::robot(&[
        link("a", 1.0, [0.0; 2], 1.0, ""),
        format!("<link name=\"foot\">{}</link>", urdf::collision([0.05, 0.0], "box size=\"0.2 0.1 0.04\"")),
        joint("j", urdf::Axis::Fixed, ["a", "foot"], [0.0, -0.3], ""),
    ]));
    let [polygon] = &robot.links()[1].shapes[..] else { panic!("one polygon") };
    let (rear, front, low, high) = (0.05 - 0.1, 0.05 + 0.1, -0.3 - 0.02, -0.3 + 0.02);
    assert_eq!(polygon.corners(), [[rear, low], [front, low], [front, high], [rear, high]]);
}

#[test]
fn links_without_inertial_or_inertia_are_read() {
    let text = robot(
        "<link name=\"a\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"2\"/></inertial></link><link name=\"b\"/>\
         <joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>",
    );
    let robot = load(&text);
    assert_eq!(
        (robot.bodies()[0].mass, robot.bodies()[0].com, robot.bodies()[0].moment),
        (2.0, Vector::new(0.1, 0.0), 0.0)
    );
    assert_eq!(robot.links().iter().map(|link| link.has_inertial).collect::<Vec<_>>(), [true, false]);
    let expected = [
        left_out("joint \"j\"", "fixed: welded into a"),
        left_out("link \"a\"", "its <inertial> has no <inertia>: taken as a point mass"),
    ];
    assert_eq!(robot.left_out(), expected);
}

#[test]
fn skipped_shapes_are_listed_one_by_one() {
    let shapes = ["mesh filename=\"foot.stl\"", "plane", "sphere radius=\"1\""];
    let shapes = shapes.map(|shape| urdf::collision([0.0; 2], shape)).concat();
    let robot = load(&urdf::body(1.0, &shapes));
    assert_eq!(robot.links()[0].shapes.len(), 1);
    let expected = [
        left_out("collision mesh \"foot.stl\" of link \"body\"", "its file was not read"),
        left_out("collision <plane> of link \"body\"", "no shape of URDF"),
    ];
    assert_eq!(robot.left_out(), expected);
}

#[test]
fn a_long_chain_is_reduced_without_recursion() {
    // 2,000 joints move, the most that may, and alternate with fixed ones.
    let count = 4_001;
    let links = (0..count).map(|k| link(format!("l{k}"), 1.0, [0.0, -0.5], 0.1, ""));
    let joints = (1..count).map(|k| {
        let [parent, child] = [k - 1, k].map(|k| format!("l{k}"));
        joint(format!("j{k}"), if k % 2 == 0 { urdf::Axis::Fixed } else { HINGE }, [&parent, &child], [0.0, -1.0], "")
    });
    let robot = load(&urdf::robot(&links.chain(joints).collect::<Vec<_>>()));
    assert_eq!((robot.bodies().len(), robot.joints().len()), (count / 2 + 1, count / 2));
    assert_eq!(robot.bodies()[1].com, [0.0, -1.0]);
}
