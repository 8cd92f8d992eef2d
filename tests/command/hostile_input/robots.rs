//! Robots that are refused.

use super::{assert_refused, case};
use heelstrike::Robot;

fn robot(body: &str) -> String {
    format!("<robot name=\"r\">\n{body}</robot>")
}

fn mass(value: &str) -> String {
    robot(&format!(
        "<link name=\"a\"><inertial><mass value=\"{value}\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link>"
    ))
}

fn shape(shape: &str) -> String {
    robot(&format!("<link name=\"a\"><collision><geometry>{shape}</geometry></collision></link>"))
}

fn joint(kind: &str, body: &str) -> String {
    robot(&format!(
        "<link name=\"a\"/><link name=\"b\"/>\n\
         <joint name=\"j\" type=\"{kind}\"><parent link=\"a\"/><child link=\"b\"/>{body}</joint>"
    ))
}

/// Links a, b and c with a fixed joint for each pair of parent and child.
fn joints(pairs: &[(&str, &str)]) -> String {
    let joint = |(parent, child): &(&str, &str)| {
        format!(
            "<joint name=\"{parent}{child}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n"
        )
    };
    let joints: String = pairs.iter().map(joint).collect();
    robot(&format!("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>\n{joints}"))
}

fn chain(links: usize, kind: &str) -> String {
    let link = |k| format!("<link name=\"{k}\"/>\n");
    let joint = |k| {
        let parent = k - 1;
        format!("<joint name=\"{k}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{k}\"/></joint>\n")
    };
    robot(&(0..links).map(link).chain((1..links).map(joint)).collect::<String>())
}

#[test]
fn robots_are_refused_word_for_word() {
    let cases = vec![
        case("entities", "<!DOCTYPE r [<!ENTITY a \"lol\"><!ENTITY b \"&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;\">]>\n<robot>&c;</robot>".into(), "1:1: a document type definition is not accepted | remove the <!DOCTYPE ...> declaration; URDF needs none"),
        case("entities", "<!DOCTYPE r [<!ENTITY passwd SYSTEM \"file:///etc/passwd\">]>\n<robot name=\"&passwd;\"/>".into(), "1:1: a document type definition is not accepted | remove the <!DOCTYPE ...> declaration; URDF needs none"),
        case("entities", "<?xml version=\"1.0\"?>\n<!DOCTYPE robot SYSTEM \"http://example.com/robot.dtd\">\n<robot/>".into(), "2:1: a document type definition is not accepted | remove the <!DOCTYPE ...> declaration; URDF needs none"),
        case("entities", "<!DOCTYPE r [<!ENTITY % p SYSTEM \"p.dtd\"> %p;]>\n<robot/>".into(), "1:1: a document type definition is not accepted | remove the <!DOCTYPE ...> declaration; URDF needs none"),
        case("entities", "<robot name=\"&unknown;\"><link name=\"a\"/></robot>".into(), "1:14: not well-formed XML: unknown entity reference 'unknown'"),
        case("nesting", format!("<robot>{}{}</robot>", "<a>".repeat(200_000), "</a>".repeat(200_000)), "1:605: elements nested more than 200 deep are not accepted"),
        case("nesting", format!("<robot>\n<link name=\"a\">{}", "<collision>".repeat(200_000)), "1:1: not well-formed XML: the root node was opened but never closed | the text ends too early: is it whole?"),
        case("nesting", format!("<robot>{}<link name=\"a\"/>{}</robot>", "<robot>".repeat(201), "</robot>".repeat(201)), "1:1401: elements nested more than 200 deep are not accepted"),
        case("too many", chain(300_000, "fixed"), "10002:1: more than 10000 links are not accepted"),
        case("too many", format!("<robot>\n{}</robot>", "<link name=\"a\"/>\n".repeat(1_000_000)), "10002:1: more than 10000 links are not accepted"),
        case("too many", chain(2_002, "continuous"), "4004:1: more than 2000 joints that move are not accepted"),
        case("too many", robot(&format!("<link name=\"a\">{}</link>", "<collision><geometry><sphere radius=\"0\"/></geometry></collision>".repeat(10_001))), "2:1: link \"a\": more than 10000 collision shapes are not accepted"),
        case("too many", robot(&format!("<link name=\"a\" {}/>", (0..1_000_000).map(|k| format!("a{k}='' ")).collect::<String>())), "2:1: more than 100 attributes of one element are not accepted"),
        case(
            "too many of a kind",
            format!("<robot>{}", (0..100_000).map(|k| format!("<a xmlns:n{k}=\"u{k}\">")).collect::<String>()),
            "1:20791: more than 1000 namespaces are not accepted",
        ),
        case(
            "too many of a kind",
            robot(&(0..200_000).map(|k| format!("<a{k}/>\n")).collect::<String>()),
            "1002:1: more than 1000 kinds of unknown elements are not accepted",
        ),
        case(
            "too many of a kind",
            robot(&format!("<a {}/>\n", (0..100).map(|k| format!("a{k}='' ")).collect::<String>()).repeat(100_000)),
            "10001:1: more than 1000000 attributes are not accepted",
        ),
        case("too many of a kind", robot(&"<a/>".repeat(2_000_000)), "more than 1000000 XML nodes are not accepted"),
        case("too many of a kind", chain(10_002, "fixed").replacen("<link ", "<lonk ", 2), "20004:1: more than 10000 joints are not accepted"),
        case("numbers", mass("NaN"), "2:26: link \"a\": value of <mass> must be a finite number, not NaN"),
        case("numbers", mass("inf"), "2:26: link \"a\": value of <mass> must be a finite number, not inf"),
        case("numbers", mass("1e999"), "2:26: link \"a\": value of <mass> must be a finite number, not inf"),
        case("numbers", mass("1,5"), "2:26: link \"a\": value of <mass> must be a number, not \"1,5\""),
        case("numbers", joint("fixed", "<origin xyz=\"1 2 x 3\"/>"), "3:65: joint \"j\": xyz of <origin> must be 3 numbers, not \"1 2 x 3\""),
        case("given twice", robot("<link name=\"a\"/>\n<link name=\"a\"/>"), "3:1: link \"a\" is given twice"),
        case("given twice", joint("fixed", "</joint>\n<joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>"), "4:1: joint \"j\" is given twice"),
        case("given twice", robot("<link name=\"a\" name=\"b\"/>"), "2:16: attribute \"name\" is given twice"),
        case("given twice", robot("<link name=\"a\"><inertial><mass value=\"1\"/></inertial>\n<inertial/></link>"), "3:1: link \"a\": element \"inertial\" is given twice"),
        case("given twice", joint("fixed", "<parent link=\"b\"/>"), "3:65: joint \"j\": element \"parent\" is given twice"),
        case("no tree", joint("fixed", "").replace("<child link=\"b\"/>", "<child link=\"a\"/>"), "3:1: joint \"j\": link \"a\" hangs on itself: the joints form a cycle | cut the cycle open: one link must be no joint's child"),
        case("no tree", joints(&[("a", "b"), ("b", "c"), ("c", "a")]), "5:1: joint \"ca\": link \"a\" hangs on itself: the joints form a cycle | cut the cycle open: one link must be no joint's child"),
        case("no tree", joints(&[("a", "c"), ("b", "c")]), "4:1: joint \"bc\": link \"c\" would have two parents: it is the child of joint \"ac\" too | cut the loop open: a link hangs on one joint"),
        case("no tree", joints(&[("a", "b")]), "2:33: link \"c\": links \"a\" and \"c\" are both roots | make one of them the child of a joint"),
        case("no tree", joints(&[("b", "c"), ("c", "b")]), "4:1: joint \"cb\": link \"b\" hangs on itself: the joints form a cycle | cut the cycle open: one link must be no joint's child"),
        case("names", joint("fixed", "").replace("<child link=\"b\"/>", "<child link=\"B\"/>"), "3:48: joint \"j\": the robot has no link named \"B\""),
        case("names", joint("fixed", "").replace("<parent link=\"a\"/>", "<parent link=\"world\"/>"), "3:1: link \"world\": links \"a\" and \"world\" are both roots | make one of them the child of a joint"),
        case("names", robot("<link name=\"\"/>"), "2:1: the attribute name of <link> is missing"),
        case("names", joint("continuous", "<mimic joint=\"k\"/>"), "3:70: joint \"j\": the robot has no joint named \"k\""),
        case("names", joint("fixed", "").replace("<child link=\"b\"/>", &format!("<child link=\"{}\"/>", "b".repeat(1_000_000))), "3:48: joint \"j\": the robot has no link named \"bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb...bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb\""),
        case("joint types", joint("revolut", ""), "3:1: joint \"j\": unknown joint type \"revolut\" | did you mean revolute?"),
        case("joint types", joint("", ""), "3:1: joint \"j\": the attribute type of <joint> is missing"),
        case("joint types", joint("Fixed", ""), "3:1: joint \"j\": unknown joint type \"Fixed\" | did you mean fixed?"),
        case("joint types", joint("screw", ""), "3:1: joint \"j\": unknown joint type \"screw\""),
        case("axes", joint("revolute", "<axis xyz=\"0 0 0\"/>"), "3:68: joint \"j\": xyz of <axis> is zero, so the joint has no direction"),
        case("axes", joint("prismatic", "<axis xyz=\"0 -0 0e9\"/>"), "3:69: joint \"j\": xyz of <axis> is zero, so the joint has no direction"),
        case("axes", joint("revolute", "<axis xyz=\"0 NaN 0\"/>"), "3:68: joint \"j\": xyz of <axis> must be a finite number, not NaN"),
        case("axes", joint("revolute", "<axis xyz=\"0 1\"/>"), "3:68: joint \"j\": xyz of <axis> must be 3 numbers, not \"0 1\""),
        case("negative", mass("-1"), "2:26: link \"a\": value of <mass> must be at least 0, not -1"),
        case("negative", shape("<sphere radius=\"-0.1\"/>"), "2:37: link \"a\": radius of <sphere> must be at least 0, not -0.1"),
        case("negative", shape("<box size=\"1 -2 3\"/>"), "2:37: link \"a\": size of <box> must be at least 0, not -2"),
        case("negative", shape("<cylinder radius=\"1\" length=\"-1\"/>"), "2:37: link \"a\": length of <cylinder> must be at least 0, not -1"),
        case("negative", mass("1").replace("iyy=\"1\"", "iyy=\"-0.5\""), "2:1: link \"a\": the moment of inertia about the plane's normal must be at least 0, not -0.5"),
        case("cut", "<robot".into(), "the text holds no XML element | give the text of a URDF file, which begins with <robot"),
        case("cut", "<robot name=\"r\">\n<link name=\"a".into(), "1:1: not well-formed XML: unexpected end of stream | the text ends too early: is it whole?"),
        case("cut", "<robot>\n<link name=\"a\"/>\n".into(), "1:1: not well-formed XML: the root node was opened but never closed | the text ends too early: is it whole?"),
        case("cut", "<robot>\n<!-- to be continued".into(), "2:21: not well-formed XML: expected '-->'"),
        case("cut", "<robot><link name=\"a\">\n</lnik></robot>".into(), "2:1: not well-formed XML: expected 'link' tag, not 'lnik'"),
        case("no URDF", String::new(), "the text holds no XML element | give the text of a URDF file, which begins with <robot"),
        case("no URDF", " \n\t".into(), "the text holds no XML element | give the text of a URDF file, which begins with <robot"),
        case("no URDF", "{\"friction\": 1}".into(), "1:1: not well-formed XML: unknown token | give the text of a URDF file, which begins with <robot"),
        case("no URDF", "\u{0}\u{1}ELF\u{2}".into(), "1:1: not well-formed XML: unknown token | give the text of a URDF file, which begins with <robot"),
        case("no URDF", "<sdf version=\"1.7\"/>".into(), "1:1: <sdf>: <robot> is missing | this is an SDF file; convert it to URDF"),
        case("no mass", robot("<link name=\"a\"/>"), "robot: nothing that moves has mass | give the links <inertial> elements with a mass"),
        case("no mass", "<robot name=\"r\"/>".into(), "1:1: a <link> is missing"),
        case("no mass", mass("0"), "robot: nothing that moves has mass | give the links <inertial> elements with a mass"),
    ];
    assert_refused(cases, 50, &["inspect", "-"], |text| Robot::from_urdf(text).map(drop));
}

#[test]
fn a_chain_of_1000_links_is_read() {
    let inertial = "<inertial><mass value=\"1\"/></inertial>";
    let text =
        chain(1000, "continuous").replace("<link name=\"999\"/>", &format!("<link name=\"999\">{inertial}</link>"));
    let text = text.replace("type=\"continuous\">", "type=\"continuous\"><axis xyz=\"0 1 0\"/>");
    assert_eq!(Robot::from_urdf(&text).expect("a robot").joints.len(), 999);
}

#[test]
fn a_mesh_outside_its_package_is_not_opened() {
    // No mesh is read so far; whatever its path, it is told as left out.
    for path in ["package://robot/../../../../etc/passwd", "file:///dev/zero", "/dev/zero", "http://example.com/a.stl"]
    {
        let link = mass("1").replace(
            "</link>",
            &format!("<collision><geometry><mesh filename=\"{path}\"/></geometry></collision></link>"),
        );
        let robot = Robot::from_urdf(&link).expect("a robot");
        assert!(robot.links[0].shapes.is_empty());
        assert!(robot.left_out[0].what.contains(path), "{}", robot.left_out[0].what);
    }
}
