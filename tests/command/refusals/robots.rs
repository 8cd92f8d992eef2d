//! Robots that are refused.

use super::{assert_refused, lines};
use heelstrike::Robot;

const ROBOT: &str = "<robot name=\"r\">\n@</robot>";
const MASS: &str = "<robot name=\"r\">\n<link name=\"a\"><inertial><mass value=\"@\"/>\
                    <inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial></link></robot>";
const SHAPE: &str = "<robot name=\"r\">\n<link name=\"a\"><collision><geometry>@</geometry></collision></link></robot>";

fn robot(body: &str) -> String {
    ROBOT.replace('@', body)
}

fn mass(value: &str) -> String {
    MASS.replace('@', value)
}

fn joint(kind: &str, body: &str) -> String {
    robot(&format!(
        "<link name=\"a\"/><link name=\"b\"/>\n\
         <joint name=\"j\" type=\"{kind}\"><parent link=\"a\"/><child link=\"b\"/>{body}</joint>"
    ))
}

/// Links a, b and c with a fixed joint for each pair of parent and child, such as "ab bc".
fn joints(pairs: &str) -> String {
    let joint = |pair: &str| {
        let (parent, child) = pair.split_at(1);
        format!("<joint name=\"{pair}\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"{child}\"/></joint>\n")
    };
    let joints: String = pairs.split(' ').map(joint).collect();
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

/// Whole files, one per line.
const FILES: &str = r#"
<!DOCTYPE r [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;"><!ENTITY c "&b;&b;&b;&b;">]>\n<robot>&c;</robot>
<!DOCTYPE r [<!ENTITY passwd SYSTEM "file:///etc/passwd">]>\n<robot name="&passwd;"/>
<?xml version="1.0"?>\n<!DOCTYPE robot SYSTEM "http://example.com/robot.dtd">\n<robot/>
<!DOCTYPE r [<!ENTITY % p SYSTEM "p.dtd"> %p;]>\n<robot/>
<robot name="&unknown;"><link name="a"/></robot>
<robot
<robot><link
<robot name="r">\n<link name="a
<robot>\n<link name="a"/>\n
<robot>\n<!-- to be continued
<robot><link name="a">\n</lnik></robot>
<robot>\n<link name="a">\n </lnik></robot>
{"friction": 1}
time,q_base_x\n0,1
<sdf/>
<sdf version="1.7"/>
<roboter/>
<robot/>
<robot name="r"/>
<robot xmlns:xacro="http://ros.org/wiki/xacro">\n  <xacro:leg/></robot>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/>\n<xacro:property name="l" value="1"/></robot>
<robot><link name="a"/>\n<xacro:property name="l" value="1"/></robot>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"><inertial>\n<xacro:mass/></inertial></link></robot>
<robot xmlns:xacro="http://wiki.ros.org/x">\n<xacro:leg/></robot>
<robot xmlns:drake="d"><link name="a"/>\n<link name="b"/><drake:joint name="j" type="planar"/></robot>
<robot>\n<link name="${p}a"><inertial><mass value="1"/></inertial></link></robot>
<robot><link name="a"/>\n<include filename="$(find x)/y.xacro"/></robot>
<robot><link name="a">\n<collision><geometry><sphere radius="$(arg r)"/></geometry></collision></link></robot>
<robot><link name="a"/></robot>\n<robot/>
<robot><link name="a"/>\n<!- a -></robot>
"#;

/// Contents of `<robot>`, one per line.
const ROBOTS: &str = r#"
<link name="a"/>\n<link name="a"/>
<link name="a" name="b"/>
<link name="a"><inertial><mass value="1"/></inertial>\n<inertial/></link>
<link name="a"><inertial>\n<inertia ixx="1" iyy="1" izz="1"/></inertial></link>
<link name="a"><collision><geometry></geometry></collision></link>
<link name=""/>
<link/>
<link name="a"/>
"#;

/// Contents of `<geometry>`, one per line.
const SHAPES: &str = r#"
<sphere radius="-0.1"/>
<box size="1 -2 3"/>
<cylinder radius="1" length="-1"/>
<cylinder radius="1"/>
<box size="1 1 1"/><sphere radius="1"/>
<mesh filename="a.stl" scale="0 -0 0e9"/>
<mesh filename="a.stl" scale="1 1 1 1"/>
"#;

/// A joint's type and its content besides parent a and child b, one joint per line.
const JOINTS: &str = r#"
fixed <origin xyz="1 2 x 3"/>
fixed <origin xyz="1 2"/>
fixed <origin xyz="0.07, 0, -0.69"/>
fixed <origin xyz="0,07 0 -0,69"/>
fixed <origin quat_xyzw="0 0 0 1"/>
fixed <origin/>\n<origin xyz="1 0 0"/>
fixed <parent link="b"/>
fixed </joint>\n<joint name="j" type="fixed"><parent link="a"/><child link="b"/>
continuous <mimic multiplier="2"/>
continuous <mimic joint=""/>
continuous <mimic joint="k" multiplier="x"/>
revolut <axis xyz="0 1 0"/>
 <axis xyz="0 1 0"/>
Fixed <axis xyz="0 1 0"/>
screw <axis xyz="0 1 0"/>
revolute <origin xyz="0 ${l} 0"/>
revolute <axis xyz="0 0 0"/>
prismatic <axis xyz="0 -0 0e9"/>
revolute <axis xyz="0 NaN 0"/>
revolute <axis xyz="0 1"/>
"#;

#[test]
fn robots_are_refused_word_for_word() {
    let typed = |line: String| line.split_once(' ').map(|(kind, body)| joint(kind, body)).expect("a type");
    let fixed = |part: &str, by: &str| joint("fixed", "").replace(part, by);
    let many = |count, one: fn(usize) -> String| (0..count).map(one).collect::<String>();
    let massive = |mass: &str| format!("<link name=\"a\"><inertial><mass value=\"{mass}\"/></inertial></link>");
    let cases = lines(FILES, "@")
        .chain(lines(ROBOTS, ROBOT))
        .chain(lines(SHAPES, SHAPE))
        .chain(lines(JOINTS, "@").map(typed))
        .chain(["NaN", "inf", "1e999", "1,5", "-1", "0", ""].map(mass))
        .chain(["ab bc ca", "ac bc", "ac", "ab", "bc cb", "aa"].map(joints))
        .chain([
            String::new(),
            " \n\t".into(),
            "\u{0}\u{1}ELF\u{2}".into(),
            mass("1").replace("iyy=\"1\"", "iyy=\"-0.5\""),
            fixed("<link name=\"a\"/>", &massive("1"))
                .replace("<link name=\"b\"/>", &massive("1e308").replace("\"a\"", "\"b\""))
                .replace("<child", "<origin xyz=\"9 0 0\"/><child"),
            fixed("<link name=\"b\"/>", &massive("1").replace("\"a\"", "\"b\""))
                .replace("<child", "<origin xyz=\"1e300 0 0\"/><child")
                .replace("<link name=\"a\"/>", &massive("1")),
            fixed("<child link=\"b\"/>", "<child link=\"a\"/>"),
            fixed("<child link=\"b\"/>", "<child link=\"B\"/>"),
            fixed("<child link=\"b\"/>", "<child link=\"bb\"/>"),
            fixed("<child link=\"b\"/>", "<child link=\"world\"/>"),
            fixed("<child link=\"b\"/>", ""),
            fixed("<parent link=\"a\"/>", "<parent link=\"world\"/>"),
            fixed("<child link=\"b\"/>", &format!("<child link=\"{}\"/>", "b".repeat(1_000_000))),
            format!("<robot><link name=\"a\"/><!-- {0} --><link nam=\"{0}\"/></robot>", "x".repeat(500_000)),
            format!("<robot>{}{}</robot>", "<a>".repeat(200_000), "</a>".repeat(200_000)),
            format!("<robot>\n<link name=\"a\">{}", "<collision>".repeat(200_000)),
            format!("<robot>{}<link name=\"a\"/>{}</robot>", "<robot>".repeat(201), "</robot>".repeat(201)),
            chain(300_000, "fixed"),
            chain(2_002, "continuous"),
            chain(10_002, "fixed").replacen("<link ", "<lonk ", 2),
            format!("<robot>\n{}</robot>", "<link name=\"a\"/>\n".repeat(1_000_000)),
            robot(&format!(
                "<link name=\"a\">{}</link>",
                "<collision><geometry><sphere radius=\"0\"/></geometry></collision>".repeat(10_001)
            )),
            robot(&format!("<link name=\"a\" {}/>", many(1_000_000, |k| format!("a{k}='' ")))),
            format!("<robot>{}", many(100_000, |k| format!("<a xmlns:n{k}=\"u{k}\">"))),
            robot(&many(200_000, |k| format!("<a{k}/>\n"))),
            robot(&format!("<a {}/>\n", many(100, |k| format!("a{k}='' "))).repeat(100_000)),
            robot(&"<a/>".repeat(2_000_000)),
            robot(&format!("<link name=\"a\">{}</link>", "<collison/>".repeat(200_000))),
        ]);
    assert_refused("robots", cases, &["inspect", "-"], |text| Robot::from_urdf(text).map(drop));
}
