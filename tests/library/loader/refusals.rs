//! Files that are refused, word for word.

use super::*;

fn refused(text: &str) -> (String, Option<String>) {
    let error = Robot::from_urdf(text).expect_err("a refusal");
    (error.to_string(), error.remedy().map(String::from))
}

#[track_caller]
fn assert_refused(text: &str, message: &str, hint: Option<&str>) {
    assert_eq!(refused(text), (message.into(), hint.map(String::from)), "of {text}");
}

#[test]
fn what_is_no_urdf_is_refused() {
    assert_refused("", "the text holds no XML element", Some("give the text of a URDF file, which begins with <robot"));
    assert_refused(
        "<robot>\n<link name=\"a\">\n </lnik></robot>",
        "3:2: not well-formed XML: expected 'link' tag, not 'lnik'",
        None,
    );
    assert_refused(
        "<robot><link",
        "1:1: not well-formed XML: the root node was opened but never closed",
        Some("the text ends too early: is it whole?"),
    );
    let outermost = Some("the outermost element of a URDF file is <robot>");
    assert_refused("<roboter/>", "1:1: <roboter>: <robot> is missing", outermost);
    assert_refused("<sdf/>", "1:1: <sdf>: <robot> is missing", Some("this is an SDF file; convert it to URDF"));
    assert_refused("<robot/>", "1:1: a <link> is missing", None);
    let expand = Some("expand the file first: xacro FILE > robot.urdf");
    assert_refused(
        "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">\n  <xacro:leg/></robot>",
        "2:3: <xacro:leg> is not URDF",
        expand,
    );
    assert_refused(
        &two_links("revolute", "<origin xyz=\"0 ${l} 0\"/>"),
        "4:68: joint \"j\": \"0 ${l} 0\" is not URDF",
        expand,
    );
}

#[test]
fn names_given_twice_unknown_or_missing_are_refused() {
    let twice = robot("<link name=\"a\"/>\n<link name=\"a\"/>");
    assert_refused(&twice, "3:1: link \"a\" is given twice", None);
    let joint = "<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/></joint>";
    let twice = robot(&format!("<link name=\"a\"/><link name=\"b\"/>\n{joint}\n{joint}"));
    assert_refused(&twice, "4:1: joint \"j\" is given twice", None);
    assert_refused(&robot("<link/>"), "2:1: the attribute name of <link> is missing", None);

    let unknown = two_links("fixed", "").replace("<child link=\"b\"/>", "<child link=\"bb\"/>");
    assert_refused(&unknown, "4:48: joint \"j\": the robot has no link named \"bb\"", Some("did you mean b?"));
    let world = two_links("fixed", "").replace("<child link=\"b\"/>", "<child link=\"world\"/>");
    assert_refused(&world, "4:48: joint \"j\": the robot has no link named \"world\"", None);
    let childless = two_links("fixed", "").replace("<child link=\"b\"/>", "");
    assert_refused(&childless, "4:1: joint \"j\": <child> is missing", None);
    assert_refused(
        &two_links("revolut", ""),
        "4:1: joint \"j\": unknown joint type \"revolut\"",
        Some("did you mean revolute?"),
    );
}

#[test]
fn what_is_no_tree_is_refused() {
    let links = "<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>";
    let joint = |name: &str, parent: &str, child: &str| {
        format!("\n<joint name=\"{name}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>")
    };
    let tree = |joints: &[String]| robot(&format!("{links}{}", joints.concat()));
    assert_refused(
        &tree(&[joint("i", "a", "c"), joint("j", "b", "c")]),
        "4:1: joint \"j\": link \"c\" would have two parents: it is the child of joint \"i\" too",
        Some("cut the loop open: a link hangs on one joint"),
    );
    assert_refused(
        &tree(&[joint("i", "a", "c")]),
        "2:17: link \"b\": links \"a\" and \"b\" are both roots",
        Some("make one of them the child of a joint"),
    );
    let cut = Some("cut the cycle open: one link must be no joint's child");
    assert_refused(
        &tree(&[joint("i", "b", "c"), joint("j", "c", "b")]),
        "4:1: joint \"j\": link \"b\" hangs on itself: the joints form a cycle",
        cut,
    );
    assert_refused(
        &tree(&[joint("i", "a", "b"), joint("j", "b", "c"), joint("k", "c", "a")]),
        "5:1: joint \"k\": link \"a\" hangs on itself: the joints form a cycle",
        cut,
    );
    let itself = robot(&format!("<link name=\"a\"/>{}", joint("i", "a", "a")));
    assert_refused(&itself, "3:1: joint \"i\": link \"a\" hangs on itself: the joints form a cycle", cut);
}

#[test]
fn bad_numbers_are_refused() {
    let mass = |value: &str| {
        robot(&format!(
            "<link name=\"a\"><inertial>\n  <mass value=\"{value}\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>"
        ))
    };
    assert_refused(&mass("-1"), "3:3: link \"a\": value of <mass> must be at least 0, not -1", None);
    assert_refused(&mass("NaN"), "3:3: link \"a\": value of <mass> must be a finite number, not NaN", None);
    assert_refused(&mass("1e999"), "3:3: link \"a\": value of <mass> must be a finite number, not inf", None);
    assert_refused(&mass("1,5"), "3:3: link \"a\": value of <mass> must be a number, not \"1,5\"", None);
    assert_refused(&mass(""), "3:3: link \"a\": the attribute value of <mass> is missing", None);
    let massless = mass("1").replace("<mass value=\"1\"/>", "");
    assert_refused(&massless, "2:16: link \"a\": <mass> is missing", None);
    let negative = mass("1").replace("iyy=\"1\"", "iyy=\"-0.5\"");
    assert_refused(
        &negative,
        "2:1: link \"a\": the moment of inertia about the plane's normal must be at least 0, not -0.5",
        None,
    );

    // urdf-rs alone would read the first as 1 2 3.
    let origin = |xyz: &str| two_links("fixed", &format!("<origin xyz=\"{xyz}\"/>"));
    assert_refused(&origin("1 2 x 3"), "4:65: joint \"j\": xyz of <origin> must be 3 numbers, not \"1 2 x 3\"", None);
    assert_refused(&origin("1 2"), "4:65: joint \"j\": xyz of <origin> must be 3 numbers, not \"1 2\"", None);
    assert_refused(
        &two_links("revolute", "<axis xyz=\"0 -0 0\"/>"),
        "4:68: joint \"j\": xyz of <axis> is zero, so the joint has no direction",
        None,
    );
    let shape =
        |shape: &str| robot(&format!("<link name=\"a\"><collision><geometry>{shape}</geometry></collision></link>"));
    assert_refused(
        &shape("<sphere radius=\"-1\"/>"),
        "2:37: link \"a\": radius of <sphere> must be at least 0, not -1",
        None,
    );
    assert_refused(
        &shape("<box size=\"1 -2 3\"/>"),
        "2:37: link \"a\": size of <box> must be at least 0, not -2",
        None,
    );
    assert_refused(
        &shape("<cylinder radius=\"1\"/>"),
        "2:37: link \"a\": the attribute length of <cylinder> is missing",
        None,
    );
    assert_refused(&shape(""), "2:27: link \"a\": a shape in <geometry> is missing", None);
    assert_refused(
        &shape("<box size=\"1 1 1\"/><sphere radius=\"1\"/>"),
        "2:56: link \"a\": <sphere> is a second shape in one <geometry>",
        Some("give each shape a <collision> of its own"),
    );
    let twice = two_links("fixed", "<origin/>\n<origin/>");
    assert_refused(&twice, "5:1: joint \"j\": element \"origin\" is given twice", None);
    let quaternion = two_links("fixed", "<origin quat_xyzw=\"0 0 0 1\"/>");
    assert_refused(
        &quaternion,
        "4:65: joint \"j\": quat_xyzw of <origin> is not handled",
        Some("give the turn as rpy"),
    );
}

#[test]
fn a_robot_without_mass_or_beyond_f64_is_refused() {
    assert_refused(
        &robot("<link name=\"a\"/>"),
        "robot: nothing that moves has mass",
        Some("give the links <inertial> elements with a mass"),
    );
    let heavy = two_links("fixed", "").replace("<mass value=\"1\"/>", "<mass value=\"1e308\"/>");
    assert_refused(&heavy, "link \"a\": the inertia of the welded body must be a finite number, not inf", None);
    let far = two_links("fixed", "<origin xyz=\"1e300 0 0\"/>");
    assert_refused(&far, "link \"a\": the inertia of the welded body must be a finite number, not inf", None);
}
