//! Doubtful robots: which joints they keep, and their cautions, word for word.

use super::*;
use std::fmt::Write;

/// A pitch joint with its axis tilted by 5 degrees.
const TILTED: (&str, &str) = ("revolute", "0 1 0.087488663525924");

const INERTIA: &str = "<inertia ixx=\"0.01\" iyy=\"0.01\" izz=\"0.01\"/>";

/// Lists the joints and cautions of each case.
fn listed<'a>(cases: impl IntoIterator<Item = (&'a str, Robot)>) -> String {
    let mut text = String::new();
    for (what, robot) in cases {
        writeln!(text, "{what}\n    keeps: {}", names(&robot).join(" ")).expect("a string takes all");
        for caution in &robot.reading().cautions {
            writeln!(text, "    {caution}").expect("a string takes all");
        }
    }
    text
}

/// Adds attributes to the frame of the joint that leads to this link.
fn framed(text: &str, child: &str, attributes: &str) -> String {
    let joint = format!("<child link=\"{child}\"/><origin");
    text.replace(&joint, &format!("{joint} {attributes}"))
}

/// Adds an element at the end of the first joint.
fn with_element(text: &str, element: &str) -> String {
    text.replacen("</joint>", &format!("{element}</joint>"), 1)
}

fn limited(text: &str, limits: &str) -> String {
    with_element(text, &format!("<limit {limits} effort=\"1\" velocity=\"1\"/>"))
}

/// Legs like those of Digit: hinges behind an abduction, tilted by 0.375 rad to the left and to the right.
fn tilted_legs() -> String {
    let leg = |side: &str, tilt: f64| {
        let [abduct, hip, knee, ankle] = ["abduct", "hip", "knee", "ankle"].map(|name| format!("{side}_{name}"));
        let [upper, thigh, lower, foot] = ["upper", "thigh", "lower", "foot"].map(|name| format!("{side}_{name}"));
        let hinge = |name: &str, [parent, child]: [&str; 2], roll: f64, axis: &str| {
            format!(
                "<joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
                 <origin xyz=\"0 0 -0.5\" rpy=\"{roll} 0 0\"/><axis xyz=\"{axis}\"/></joint>"
            )
        };
        [
            [&upper, &thigh, &lower, &foot].map(|name| link(name, 1.0, [0.0; 2], 1.0, "")).concat(),
            hinge(&abduct, ["torso", &upper], 0.0, "1 0 0"),
            hinge(&hip, [&upper, &thigh], tilt, "0 1 0"),
            hinge(&knee, [&thigh, &lower], 0.0, "0 1 0"),
            hinge(&ankle, [&lower, &foot], 0.0, "0 -1 0"),
        ]
        .concat()
    };
    urdf::robot(&[link("torso", 5.0, [0.0; 2], 1.0, ""), leg("left", 0.375), leg("right", -0.375)])
}

#[test]
fn joints_off_the_plane_are_named_with_a_remedy() {
    let tilted = massive(&[ROLL, TILTED, TILTED]);
    let mounted = framed(&massive(&[("fixed", "1 0 0"), PITCH, PITCH, ROLL]), "b", "rpy=\"0.0872665 0 0\"");
    // The second frame undoes the tilt of the first: straightening the first would tilt what it carries.
    let undone = framed(&framed(&massive(&[PITCH; 3]), "b", "rpy=\"0.3 0 0\""), "c", "rpy=\"-0.3 0 0\"");
    let kept = undone.replacen("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0.955336 -0.29552\"/>", 1);
    let shoulders = with_arms(&massive(&[PITCH, PITCH, PITCH, TILTED, PITCH, TILTED, PITCH]));
    // Links c and d are both children of b and tilted to opposite sides.
    let hung = massive(&[ROLL, PITCH, PITCH]).replace("<parent link=\"c\"/>", "<parent link=\"b\"/>");
    let sides = framed(&framed(&hung, "c", "rpy=\"0.3 0 0\""), "d", "rpy=\"-0.3 0 0\"");
    let mimicking = with_element(&massive(&[ROLL, TILTED, TILTED, PITCH]), "<mimic joint=\"m\"/>");
    let oblique = ("revolute", "0 1 0.839099631");
    let limits = |limits: &str| {
        let axis = "<axis xyz=\"1 0 0\"/>";
        let limits = format!("{axis}<limit {limits} effort=\"1\" velocity=\"1\"/>");
        load(&massive(&[PITCH, PITCH, ROLL]).replace(axis, &limits))
    };
    let held = |value: f64| holding(&massive(&[PITCH, PITCH]), &[(0, value)]);
    let cautions = listed([
        ("hinges 5 degrees off behind a roll", load(&tilted)),
        ("the same, held as advised", holding(&tilted, &[(0, -0.087266)])),
        ("the same, within limits", load(&limited(&tilted, "lower=\"-0.1\" upper=\"0.1\""))),
        ("the same, beyond limits", load(&limited(&tilted, "lower=\"-0.05\" upper=\"0.1\""))),
        ("the same, with a slide", load(&massive(&[ROLL, TILTED, ("prismatic", "0 -0.087488663525924 1")]))),
        ("the same, where the roll follows another joint", load(&mimicking)),
        ("the same, where another hinge would be turned out of line", load(&massive(&[ROLL, TILTED, TILTED, PITCH]))),
        ("a tilted mounting", load(&mounted)),
        ("a tilted frame that the next one undoes", load(&undone)),
        ("the same, with the axis as advised", load(&kept)),
        ("two hinges tilted to both sides", load(&sides)),
        ("legs like those of Digit", load(&tilted_legs())),
        ("the same, held as advised", holding(&tilted_legs(), &[(0, -0.375), (4, 0.375)])),
        ("two tilted shoulders", load(&shoulders)),
        ("an oblique axis of a leg", load(&massive(&[oblique, PITCH, PITCH]))),
        ("an axis off by digits", load(&massive(&[PITCH, ("revolute", "0 1 0.0016"), PITCH]))),
        ("axes of no plane", load(&massive(&[("revolute", "1 1 2"), YAW]))),
        ("no axis", load(&massive(&[PITCH, ROLL]).replace("<axis xyz=\"1 0 0\"/>", ""))),
        ("frozen beyond limits", limits("lower=\"0.3\" upper=\"0.8\"")),
        ("frozen beyond limits by the digits of the file", limits("lower=\"0.008\" upper=\"0.8\"")),
        ("held at 1.5", held(1.5)),
        ("held at 90", held(90.0)),
    ]);
    insta::assert_snapshot!(cautions);
}

#[test]
fn doubtful_inertias_and_lengths_are_named() {
    let shape = urdf::collision([0.0, -0.5], "box size=\"0.1 0.1 0.9\"");
    let good = urdf::robot(&[link("a", 3.0, [0.0; 2], 0.05, &shape)]);
    let replaced = |from: &str, to: &str| {
        assert!(good.contains(from), "{good}");
        load(&good.replace(from, to))
    };
    let (mass, inertia) = ("mass value=\"3\"", "<inertia ixx=\"0.05\" iyy=\"0.05\" izz=\"0.05\"/>");
    let drawn = "<origin xyz=\"0 0 -0.5\"/><geometry>";
    let about_y = |moment: &str| replaced(inertia, &format!("<inertia ixx=\"0\" iyy=\"{moment}\" izz=\"0\"/>"));
    let alone = |mass: f64, moment: f64, shapes: &str| load(&urdf::robot(&[link("a", mass, [0.0; 2], moment, shapes)]));
    let shaped = |place: [f64; 2], shape: &str| alone(1.0, 1.0, &urdf::collision(place, shape));
    let ball = |mass: f64| alone(mass, 4e-3 * mass, &urdf::collision([0.0; 2], "sphere radius=\"0.1\""));
    let feet = ["ellipsoid radii=\"1 1 1\"", "plane normal=\"0 0 1\""].map(|shape| urdf::collision([0.0; 2], shape));
    let massless = |moment: f64| {
        let links = [link("a", 1.0, [0.0; 2], 1.0, ""), link("b", 0.0, [0.0; 2], moment, "")];
        load(&urdf::robot(&[links.concat(), joint("j", HINGE, ["a", "b"], [0.0, -1.0], "")]))
    };
    let moving =
        |lower: f64, upper: f64| load(&limited(&massive(&[PITCH]), &format!("lower=\"{lower}\" upper=\"{upper}\"")));
    // Joint j moves the massless b, and its mimic joint k moves c, which has mass.
    let links = [("a", 1.0), ("b", 0.0), ("c", 1.0)].map(|(name, mass)| link(name, mass, [0.0; 2], mass, ""));
    let joints = [("j", "b", ""), ("k", "c", "<mimic joint=\"j\"/>")];
    let joints = joints.map(|(name, child, more)| joint(name, HINGE, ["a", child], [0.0, -1.0], more));
    // A prismatic joint may extend the robot beyond its size at zero.
    let shape = urdf::collision([0.0; 2], "sphere radius=\"0.03\"");
    let ends = [link("body", 5.0, [0.0; 2], 4e-3, ""), link("foot", 5.0, [0.0; 2], 4e-3, &shape)];
    let slide = "<joint name=\"leg\" type=\"prismatic\"><parent link=\"body\"/><child link=\"foot\"/><axis xyz=\"0 0 1\"/>\
                 <limit lower=\"-1\" upper=\"0\"/></joint>";
    let cautions = listed([
        ("a body", replaced(inertia, inertia)),
        ("no inertia", replaced(inertia, "")),
        ("an inertia of a planar model", about_y("0.05")),
        ("the same, a small one", about_y("1e-4")),
        ("the same, too small for the mass", about_y("1e-9")),
        ("a point mass that is meant", about_y("0")),
        ("an inertia too small for the mass", replaced(inertia, &inertia.replace("0.05", "1e-9"))),
        ("an inertia too large for the mass", replaced(mass, "mass value=\"0.001\"")),
        ("the same without a shape", alone(3.0, 5000.0, "")),
        ("an inertia that may be without a shape", alone(3.0, 10.0, "")),
        ("an inertia of no body", replaced("izz=\"0.05\"", "izz=\"0.2\"")),
        ("an inertia without mass", massless(1.0)),
        ("neither mass nor inertia", massless(0.0)),
        ("the same, where what follows the joint has mass", load(&urdf::robot(&[links.concat(), joints.concat()]))),
        ("an rpy of 90", replaced(drawn, "<origin rpy=\"0 90 0\"/><geometry>")),
        ("an rpy of a whole turn", replaced(drawn, "<origin xyz=\"0 0 -0.5\" rpy=\"0 6.2832 0\"/><geometry>")),
        ("limits of -90 and 120", moving(-90.0, 120.0)),
        ("limits of -12.5 and 131", moving(-12.5, 131.0)),
        ("limits of -10 and 10", moving(-10.0, 10.0)),
        ("limits of five turns", moving(-31.4, 31.4)),
        ("a box of 400", shaped([0.0; 2], "box size=\"0.1 0.1 400\"")),
        ("a box of 4", shaped([0.0; 2], "box size=\"0.1 0.1 4\"")),
        ("a joint 350 away", load(&massive(&[PITCH]).replace("0 0 -1", "0 0 -350"))),
        ("a shape 500 away", shaped([0.0, -500.0], "sphere radius=\"0.02\"")),
        ("a shape that URDF does not have", alone(1.0, 1.0, &feet[0])),
        ("two of them", alone(1.0, 1.0, &feet.concat())),
        ("a ball of 32", ball(32.0)),
        ("a ball of 2000", ball(2000.0)),
        ("a heavy slide", load(&urdf::robot(&[ends.concat(), slide.to_owned()]))),
    ]);
    insta::assert_snapshot!(cautions);
}

#[test]
fn a_thigh_without_its_inertia_is_named() {
    let massive = |inertia: &str| format!("<inertial><mass value=\"1\"/>{inertia}</inertial>");
    let walker = |thigh: &str, knee: f64| {
        let links = [("body", &*massive(INERTIA)), ("thigh", thigh), ("shank", &massive(INERTIA))];
        let links = links.map(|(name, inertial)| format!("<link name=\"{name}\">{inertial}</link>"));
        let joints =
            [("hip", "body", "thigh", -0.5), ("knee", "thigh", "shank", knee)].map(|(name, parent, child, z)| {
                format!(
                    "<joint name=\"{name}\" type=\"continuous\"><parent link=\"{parent}\"/><child link=\"{child}\"/>\
                 <origin xyz=\"0 0 {z}\"/><axis xyz=\"0 1 0\"/></joint>"
                )
            });
        robot(&(links.concat() + &joints.concat()))
    };
    let about = |axis: &str| {
        massive(&INERTIA.replace("0.01", "0").replace(&format!("{axis}=\"0\""), &format!("{axis}=\"0.01\"")))
    };
    // A massless link has the mass of what is fixed to it, whether that is welded or kept apart.
    let fixed = walker("", -0.5).replace("\"knee\" type=\"continuous\"", "\"knee\" type=\"fixed\"");
    let kept = heelstrike::reductions::Reductions { weld: false, ..Default::default() };
    let cautions = listed([
        ("a whole inertia", load(&walker(&massive(INERTIA), -0.5))),
        ("a moment about z alone", load(&walker(&about("izz"), -0.5))),
        ("a moment about the normal alone", load(&walker(&about("iyy"), -0.5))),
        ("nothing", load(&walker("", -0.5))),
        ("nothing between two axes of one joint", load(&walker("", 0.0))),
        ("nothing, with the shank welded to it", load(&fixed)),
        (
            "nothing, with the shank fixed to it",
            reduce(&fixed, &Reduction { reductions: kept, ..Reduction::default() }),
        ),
    ]);
    insta::assert_snapshot!(cautions);
}

/// The named joints are those that make the mass matrix singular in a state without symmetries.
#[test]
fn joints_that_nothing_resists_are_named() {
    const DOWN: urdf::Axis = urdf::Axis::Prismatic([0.0, 1.0]);
    // Mass, height of the center of gravity and moment of inertia.
    const BODY: [f64; 3] = [2.0, -0.2, 0.1];
    const BOB: [f64; 3] = [2.0, -0.2, 0.0];
    const POINT: [f64; 3] = [2.0, 0.0, 0.0];
    const NOTHING: [f64; 3] = [0.0; 3];
    let massive = |name: &str, [mass, height, moment]: [f64; 3]| link(name, mass, [0.0, height], moment, "");
    // For each of the joints j, k and l: motion, height of the origin, parent and moved body.
    let moved = |root: [f64; 3], joints: &[(urdf::Axis, f64, &str, [f64; 3])]| {
        let joints = joints.iter().zip(["j", "k", "l"]).map(|(&(axis, height, parent, own), name)| {
            massive(&name.to_uppercase(), own) + &joint(name, axis, [parent, &name.to_uppercase()], [0.0, height], "")
        });
        urdf::robot(&[massive("root", root), joints.collect()])
    };
    let mimicked = moved(BODY, &[(HINGE, -0.5, "root", POINT), (HINGE, -0.5, "root", BOB)]);
    for (text, expected) in [
        (mimicked.replace("<child link=\"K\"/>", "<child link=\"K\"/><mimic joint=\"j\"/>"), None),
        (mimicked, Some("j")),
        (moved(BODY, &[(HINGE, -0.5, "root", BOB)]), None),
        (moved(BODY, &[(HINGE, -0.5, "root", POINT)]), Some("j")),
        (moved(BODY, &[(HINGE, -0.5, "root", NOTHING), (HINGE, 0.0, "J", BODY)]), Some("j")),
        (moved(BODY, &[(HINGE, -0.5, "root", POINT), (HINGE, 0.0, "J", POINT), (HINGE, 0.0, "K", BODY)]), Some("j, k")),
        (moved(BODY, &[(HINGE, -0.5, "root", NOTHING), (DOWN, 0.0, "J", BODY)]), None),
        (moved(BODY, &[(DOWN, -0.5, "root", NOTHING), (HINGE, 0.0, "J", BODY)]), None),
        (moved(BODY, &[(DOWN, -0.5, "root", NOTHING), (DOWN, 0.0, "J", BODY)]), Some("j")),
        (moved(BODY, &[(DOWN, -0.5, "root", POINT), (DOWN, 0.0, "J", BODY)]), None),
        // The hip of a compass walker.
        (moved(POINT, &[(HINGE, 0.0, "root", BODY), (HINGE, 0.0, "root", BODY)]), Some("the base's pitch")),
        (moved(BOB, &[(HINGE, 0.0, "root", BODY), (HINGE, -0.2, "root", BODY)]), None),
        (moved(NOTHING, &[(HINGE, 0.1, "root", BODY), (HINGE, 0.1, "root", BODY)]), Some("the base's pitch")),
        (moved(NOTHING, &[(HINGE, 0.1, "root", BODY), (HINGE, 0.2, "root", BODY)]), None),
    ] {
        let robot = load(&text);
        let found: Vec<_> = robot.reading().cautions.iter().filter(|caution| caution.contains("resists")).collect();
        let words = |joints| format!("nothing resists a motion of {joints} in any state: give what it moves ");
        assert!(found.len() == usize::from(expected.is_some()), "{expected:?}: {found:?}");
        assert!(
            found.iter().all(|caution| caution.starts_with(&words(expected.unwrap_or("")))),
            "{expected:?}: {found:?}"
        );
        let joints: serde_json::Map<_, _> =
            names(&robot).iter().zip([0.4, -0.9, 0.3]).map(|(name, at)| (name.to_string(), at.into())).collect();
        let state = serde_json::json!({
            "position": {"base": {"z": 1, "pitch": 0.2}, "joints": joints},
            "contacts": [{"link": "root", "offset": [0.1, 0, -0.3]}],
        });
        let answer = crate::support::impact::try_impact(&robot, Default::default(), state).map(|_| ());
        let singular = answer.is_err_and(|error| error.to_string().contains("the mass matrix is singular"));
        assert_eq!(singular, expected.is_some(), "{expected:?}");
    }
}

#[test]
fn elements_that_are_not_read_are_named_with_their_lines() {
    let text = massive(&[PITCH]);
    let rotor = |value: &str| {
        let rotor = format!("<drake:gear_ratio value=\"9\"/><drake:rotor_inertia value=\"{value}\"/>");
        format!("<transmission><joint name=\"j\"/><actuator name=\"m\">{rotor}</actuator></transmission></robot>")
    };
    let [still, turning] = ["0", "1e-4"].map(rotor);
    let cases = [
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\" rpy=\"0\"/>"),
        ("<origin ", "<orign "),
        ("<inertia ", "<inertia size=\"1\" "),
        ("<inertial>", "<inertial mass=\"2\">"),
        ("<origin xyz=", "<origin pos="),
        ("<origin xyz=", "<origin quaternion=\"1 0 0 0\" xyz="),
        ("<origin ", "<com "),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\"><origin/></axis>"),
        ("<origin xyz=\"0 0 -1\"/>", "<origin>0 0 -1</origin>"),
        ("<link name=\"a\">", "<link name=\"a\" mass=\"3\">"),
        ("<link name=\"a\">", "<link name=\"a\"><link name=\"x\"/>"),
        ("<link name=\"a\">", "<inertial/><link name=\"a\">"),
        ("<link name=\"a\">", "<link name=\"a\"><visual><inertial/></visual>"),
        ("<axis xyz=", "<axis xzy="),
        ("<axis ", "<limit lower=\"2\" upper=\"-1\"/><axis "),
        ("<axis ", "<limit upper=\"1,5\"/><axis "),
        ("<axis ", "<limit effort=\"1\" velocity=\"x\"/><axis "),
        // Names of other formats.
        ("<axis ", "<limit min=\"-1\" max=\"1\"/><axis "),
        // A joint that does not exist.
        ("<axis ", "<mimic joint=\"left_j\" multiplier=\"2\"/><axis "),
        ("</robot>", "<loop_joint name=\"l\"/></robot>"),
        ("</robot>", &still),
        ("</robot>", &turning),
    ];
    let cautions = listed(cases.map(|(from, to)| {
        assert!(text.contains(from), "{from}");
        (to, load(&text.replacen(from, to, 1)))
    }));
    insta::assert_snapshot!(cautions);
    let loops = load(&text.replace("</robot>", "<loop_joint name=\"l\"/></robot>"));
    let why = "a tree of joints has no loops: states close them by `loops`";
    assert!(loops.left_out().contains(&left_out("<loop_joint> in <robot>", why)), "{:?}", loops.left_out());
    let unread = text.replace("<inertia ", "<inertia size=\"1\" ");
    let refused = Robot::from_urdf(&unread.replace("<joint ", "<Joint ").replace("</joint>", "</Joint>"));
    let remedy = "make one of them the child of a joint; not read, and perhaps misspelt: <Joint> in <robot> on line 4 (<joint>?)";
    assert_eq!(refused.expect_err("two roots").remedy(), Some(remedy));
}

/// A similar name is searched for a few mimics only: a file may have thousands of them.
#[test]
fn unknown_mimicked_joints_are_kept_up_to_a_limit() {
    let link = |at: usize| format!("<link name=\"l{at}\"/>");
    let joint = |at: usize| {
        let ends = format!("<parent link=\"l0\"/><child link=\"l{at}\"/>");
        format!("<joint name=\"joint_{at}\" type=\"fixed\">{ends}<mimic joint=\"join_{at}\"/><limt/></joint>")
    };
    let read = |most: usize| {
        let (links, joints): (String, String) = ((0..=most).map(link).collect(), (1..=most).map(joint).collect());
        Description::from_urdf(&format!("<robot>{links}{joints}</robot>")).expect("a description").misspelt
    };
    let found = read(60);
    let likened: Vec<bool> = found.iter().map(|own| own.contains("did you mean joint_")).collect();
    assert_eq!(likened[..5], [true, true, true, false, false]);
    assert!(found[59].starts_with("<mimic> of joint_60 ") && found[60].starts_with("<limt> in <joint> "));
    assert_eq!((found.len(), read(110).len()), (100, 100));
    let empty = with_mimic(&massive(&[PITCH]), "j", "joint=\"\"");
    let refused = Robot::from_urdf(&empty).expect_err("no name");
    assert!(refused.to_string().contains("the attribute joint of <mimic> is missing"), "{refused}");
}
