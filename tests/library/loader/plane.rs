//! Which plane, which joints stay in it, and what becomes of the others.

use super::*;
use heelstrike::robot::{FreezeReason, Plane, PlaneReason};

fn in_plane(plane: Plane) -> Reduction {
    Reduction { plane: Some(plane), ..Reduction::default() }
}

/// The last four joints of a chain of seven as two arms that hang from `a`.
fn with_arms(chain: &str) -> String {
    let raised = |text: &str, from: char, to: char, place: &str| {
        let ends = |parent: char, place: &str| {
            format!("<parent link=\"{parent}\"/><child link=\"{to}\"/><origin xyz=\"{place}\"/>")
        };
        text.replace(&ends(from, "0 0 -1"), &ends('a', place))
    };
    raised(&raised(chain, 'd', 'e', "0 1 0"), 'f', 'g', "0 -1 0")
}

fn still<'a>(robot: &'a Robot, joint: &str) -> &'a FreezeReason {
    &robot.frozen(joint).expect("a frozen joint").reason
}

#[test]
fn the_common_direction_of_hinges_gives_the_plane() {
    for (axis, plane, sign) in [
        ("0 1 0", Plane::XZ, 1.0),
        ("0 -1 5e-4", Plane::XZ, -1.0),
        ("1 0 0", Plane::YZ, -1.0),
        ("-2 0 0", Plane::YZ, 1.0),
        ("0 0 1", Plane::XY, -1.0),
    ] {
        let robot = load(&massive(&[("continuous", axis), ("revolute", axis)]));
        assert_eq!((robot.reading().plane, robot.reading().plane_because), (plane, PlaneReason::CommonAxis), "{axis}");
        // The normal of y-z is -x and that of x-y is -z.
        assert!(robot.joints().iter().all(|joint| joint.axis == Axis::Revolute { sign }), "{axis}");
        assert_eq!(robot.reading().better_plane, None);
    }
}

#[test]
fn plane_without_a_common_direction_is_that_of_legs() {
    let robot = load(&massive(&[("continuous", "1 0 0"), ROLL, PITCH]));
    assert_eq!((robot.reading().plane, robot.reading().plane_because), (Plane::YZ, PlaneReason::Legs));
    assert_eq!((robot.reading().better_plane, names(&robot)), (None, vec!["j", "k"]));
    // Of equally many the usual one.
    let robot = load(&massive(&[ROLL, PITCH]));
    assert_eq!((robot.reading().plane, robot.reading().plane_because), (Plane::XZ, PlaneReason::Legs));
    // Two arms, whose ends are higher than the foot, do not count.
    let arms = with_arms(&massive(&[PITCH, PITCH, PITCH, ROLL, ROLL, ROLL, ROLL]));
    let robot = load(&arms);
    assert_eq!((robot.reading().plane, names(&robot)), (Plane::XZ, vec!["j", "k", "l"]));
    // An axis that lies between them is nearer to the normal of one.
    let oblique = ("revolute", "0 1 0.4");
    let robot = load(&massive(&[ROLL, oblique, oblique]));
    assert_eq!(robot.reading().plane, Plane::XZ);

    let robot = reduce(&massive(&[ROLL, ROLL, PITCH]), &in_plane(Plane::XZ));
    assert_eq!((robot.reading().better_plane, names(&robot)), (Some((Plane::YZ, 2)), vec!["l"]));
    assert!(robot.reading().plane_in_words().ends_with("plane yz would keep 2 joints"));
    let given = reduce(&massive(&[("continuous", "1 0 0"), PITCH]), &in_plane(Plane::YZ));
    assert_eq!((given.reading().plane_because, names(&given)), (PlaneReason::Asked, vec!["j"]));
    // No hinge has a direction.
    let slide = load(&massive(&[("prismatic", "0 1 0"), ("prismatic", "0 0 1")]));
    assert_eq!((slide.reading().plane_because, names(&slide)), (PlaneReason::Usual, vec!["k"]));
}

#[test]
fn each_plane_takes_its_own_components_bit_for_bit() {
    let text = robot(
        "<link name=\"a\"><inertial><origin xyz=\"0.1 0.2 0.3\"/><mass value=\"2\"/>\
         <inertia ixx=\"0.11\" ixy=\"0\" ixz=\"0\" iyy=\"0.12\" iyz=\"0\" izz=\"0.13\"/></inertial></link>\
         <link name=\"b\"><inertial><mass value=\"1\"/></inertial><collision><geometry><box size=\"2 4 6\"/></geometry>\
         </collision></link><joint name=\"j\" type=\"fixed\"><parent link=\"a\"/><child link=\"b\"/>\
         <origin xyz=\"0.7 0.8 0.9\"/></joint>",
    );
    let alone = text.replace("<mass value=\"1\"/>", "<mass value=\"0\"/>");
    for (plane, com, moment, point, corner) in [
        (Plane::XZ, [0.1, 0.3], 0.12, [0.7 + 1.0, 0.9 + 3.0], [0.7 + 1.0, 0.9 + 3.0]),
        (Plane::YZ, [0.2, 0.3], 0.11, [0.8 + 2.0, 0.9 + 3.0], [0.8 + 2.0, 0.9 + 3.0]),
        (Plane::XY, [0.1, 0.2], 0.13, [0.7 + 1.0, 0.8 + 2.0], [0.7 + 1.0, 0.8 + 2.0]),
        (Plane::ZY, [0.3, 0.2], 0.11, [0.9 + 3.0, 0.8 + 2.0], [0.9 + 3.0, 0.8 + 2.0]),
        (Plane::ZX, [0.3, 0.1], 0.12, [0.9 + 3.0, 0.7 + 1.0], [0.9 + 3.0, 0.7 + 1.0]),
        (Plane::YX, [0.2, 0.1], 0.13, [0.8 + 2.0, 0.7 + 1.0], [0.8 + 2.0, 0.7 + 1.0]),
    ] {
        let robot = reduce(&alone, &in_plane(plane));
        assert_eq!((robot.bodies()[0].com.components(), robot.bodies()[0].moment), (com, moment), "{plane:?}");
        assert_eq!(robot.links()[1].point::<f64>([1.0, 2.0, 3.0]), point);
        let [shape] = &robot.links()[1].shapes[..] else { panic!("one shape") };
        let corners = shape.corners();
        assert!(corners.contains(&corner.into()), "{plane:?}: {corners:?}");
    }
}

#[test]
fn joints_that_leave_the_plane_are_frozen_at_zero() {
    let text = massive(&[ROLL, PITCH, ("continuous", "0 -1 0.0787"), PITCH]);
    let robot = load(&text);
    assert_eq!(names(&robot), ["k", "m"]);
    let bodies: Vec<_> =
        robot.bodies().iter().map(|body| (body.name.as_str(), body.mass, body.com.components())).collect();
    // a and b are one body with its CoG half way; so are c and d, behind k.
    assert_eq!(bodies, [("a", 2.0, [0.0, -0.5]), ("c", 2.0, [0.0, -0.5]), ("e", 1.0, [0.0, 0.0])]);
    assert_eq!(robot.joints()[0].origin, [0.0, -2.0]);
    let expected = [
        left_out("joint \"j\"", "frozen at zero, its axis being 90.00 degrees off the plane's normal: welded into a"),
        left_out("joint \"l\"", "frozen at zero, its axis being 4.50 degrees off the plane's normal: welded into c"),
    ];
    assert_eq!(robot.left_out(), expected);

    let slides = reduce(&massive(&[("prismatic", "0 1 0"), ("prismatic", "1 0 1")]), &Reduction::default());
    let why = "frozen at zero, its axis being 90.00 degrees off the plane: welded into a";
    assert_eq!(slides.left_out(), [left_out("joint \"j\"", why)]);
    assert_eq!(names(&slides), ["k"]);
}

#[test]
fn frozen_joints_keep_their_values() {
    // j turns about x by a quarter, so that the z axis of k points to -y: k stays.
    let text = massive(&[("revolute", "2 0 0"), YAW, ("prismatic", "0 0 1")]);
    let hold =
        |hold: &[(usize, f64)]| Reduction { plane: Some(Plane::XZ), hold: hold.to_vec(), ..Reduction::default() };
    let robot = reduce(&text, &hold(&[(0, FRAC_PI_2)]));
    assert_eq!((names(&robot), robot.joints()[0].axis), (vec!["k"], Axis::Revolute { sign: -1.0 }));
    assert_eq!(still(&robot, "j"), &FreezeReason::Asked { value: FRAC_PI_2 });
    // The origin of k, 1 m down in b's frame, lies 1 m to the left: dropped.
    assert_at(robot.joints()[0].origin, [0.0, -1.0]);

    // A slide that is frozen carries its child along: 1 m down and 0.25 m up.
    let robot = reduce(&text, &hold(&[(2, 0.25)]));
    assert_eq!(names(&robot), [""; 0]);
    assert_eq!(robot.links()[3].point::<f64>([0.0; 3]), [0.0, -2.75]);
    let why = "frozen at 0.25 as asked: welded into a";
    assert!(robot.left_out().contains(&left_out("joint \"l\"", why)), "{:?}", robot.left_out());

    // A joint of the plane can be frozen as well, and then gives no plane.
    let robot = holding(&massive(&[ROLL, YAW]), &[(0, 0.0)]);
    assert_eq!((robot.reading().plane, names(&robot)), (Plane::XY, vec!["k"]));

    // j dips the nose by a: what hung down points backward by sin a.
    let robot = holding(&massive(&[PITCH, PITCH]), &[(0, 0.3)]);
    assert_at(robot.joints()[0].origin, [-0.3_f64.sin(), -1.0 - 0.3_f64.cos()]);
}

#[test]
fn what_cannot_be_held_is_refused() {
    let text = massive(&[("fixed", "0 1 0"), PITCH, ("floating", "0 1 0")]);
    let mimic = with_mimic(&text.replace("fixed", "revolute"), "j", "joint=\"k\"");
    for (text, hold, refusal) in [
        (&text, &[(0, 0.0)][..], "6:1: joint \"j\": it cannot be frozen at a value: it is fixed"),
        (&text, &[(2, 0.0)], "8:1: joint \"l\": it cannot be frozen at a value: it is floating"),
        (&text, &[(1, 0.0), (1, 1.0)], "7:1: joint \"k\": frozen joint \"k\" is given twice"),
        (&text, &[(1, f64::NAN)], "7:1: joint \"k\": the value at which it is frozen must be a finite number, not NaN"),
        (&mimic, &[(0, 0.0)], "6:1: joint \"j\": it cannot be frozen by itself: it follows joint \"k\""),
    ] {
        let description = Description::from_urdf(text).expect("a description");
        let reduction = Reduction { hold: hold.to_vec(), ..Reduction::default() };
        assert_eq!(Robot::reduce(&description, &reduction).expect_err("a refusal").to_string(), refusal);
    }
}

#[test]
fn joints_without_one_axis_are_frozen_with_a_caution() {
    for kind in ["planar", "floating", "spherical", "ball"] {
        let word = kind.replace("ball", "spherical");
        let robot = load(&massive(&[PITCH, (kind, "0 1 0")]));
        assert_eq!(names(&robot), ["j"]);
        let why = format!("frozen at zero, being {word}: welded into b");
        assert_eq!(robot.left_out(), [left_out("joint \"k\"", &why)]);
        let caution = "k could move in the plane and is frozen all the same, having no single axis: replace it by revolute \
                       and prismatic joints";
        assert_eq!(robot.reading().cautions, [caution]);
    }
}

#[test]
fn axes_that_are_all_a_little_off_get_a_caution() {
    // tan 5 degrees.
    let tilted = ("revolute", "0 1 0.087488663525924");
    let text = massive(&[ROLL, tilted, tilted]);
    let robot = load(&text);
    assert!(robot.joints().is_empty());
    let caution = only_caution(&robot);
    let held = "2 of 3 joints that could move are frozen only because their axes are 5.0 degrees off the plane (k, l); to keep them";
    // From y + z tan 5 degrees back to y is a turn about x by minus 5 degrees.
    assert_eq!(caution, format!("{held}: `hold: j=-0.087266`"));
    assert_eq!(names(&holding(&text, &[(0, -0.087266)])), ["k", "l"]);

    // A mounting that is tilted cannot be frozen elsewhere.
    let mounted = massive(&[("fixed", "1 0 0"), PITCH, PITCH, ROLL])
        .replace("<child link=\"b\"/><origin", "<child link=\"b\"/><origin rpy=\"0.0872665 0 0\"");
    let robot = load(&mounted);
    let caution = only_caution(&robot);
    assert!(caution.ends_with("(k, l); to keep them: straighten the rpy of j"), "{caution}");

    // What a tilted joint carries is in line again: straightening its frame would tilt that.
    let turned = |text: String, child: &str, roll: f64| {
        let joint = format!("<child link=\"{child}\"/><origin");
        text.replace(&joint, &format!("{joint} rpy=\"{roll} 0 0\""))
    };
    let undone = turned(turned(massive(&[PITCH, PITCH, PITCH]), "b", 0.3), "c", -0.3);
    let caution = only_caution(&load(&undone)).to_owned();
    assert!(caution.ends_with("(j); to keep them: give j the axis \"0 0.955336 -0.29552\""), "{caution}");
    let kept = load(&undone.replacen("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0.955336 -0.29552\"/>", 1));
    assert_eq!(names(&kept), ["j", "k", "l"]);

    // Two shoulders are no reason to shout.
    let robot = load(&with_arms(&massive(&[PITCH, PITCH, PITCH, tilted, PITCH, tilted, PITCH])));
    assert!(robot.reading().cautions.is_empty(), "{:?}", robot.reading().cautions);

    let aside = load(&massive(&[("revolute", "1 1 2"), YAW]));
    let caution = only_caution(&aside);
    assert!(caution.starts_with("no joint moves in this plane"), "{caution}");
}

#[test]
fn oblique_axis_of_a_leg_gets_a_caution() {
    // tan 40 degrees; its origin is in line, its axis is not.
    let robot = load(&massive(&[("revolute", "0 1 0.839099631"), PITCH, PITCH]));
    assert_eq!(names(&robot), ["k", "l"]);
    let expected = "1 of 3 joints that could move are frozen only because their axes are 40.0 degrees off the plane (j); to \
                    keep them: straighten the axis of j";
    assert_eq!(only_caution(&robot), expected);
}

#[test]
fn each_hinge_has_one_remedy() {
    // As Digit has it: hinges behind an abduction that are tilted by 0.375 rad, to the left and to the right.
    let leg = |side: &str, tilt: f64| {
        let [hip, knee, ankle] = ["hip", "knee", "ankle"].map(|name| format!("{side}_{name}"));
        let part = |name: &str| link(name, 1.0, [0.0; 2], 1.0, "");
        let hinge = |name: &str, ends: [&str; 2], rpy: f64, axis: &str| {
            let place = format!("<origin xyz=\"0 0 -0.5\" rpy=\"{rpy} 0 0\"/><axis xyz=\"{axis}\"/>");
            let ends = format!("<parent link=\"{}\"/><child link=\"{}\"/>", ends[0], ends[1]);
            format!("<joint name=\"{name}\" type=\"revolute\">{ends}{place}</joint>")
        };
        let (upper, lower, foot) = (format!("{side}_upper"), format!("{side}_lower"), format!("{side}_foot"));
        let (thigh, abduct) = (format!("{side}_thigh"), format!("{side}_abduct"));
        [
            [&upper, &thigh, &lower, &foot].map(|name| part(name)).concat(),
            hinge(&abduct, ["torso", &upper], 0.0, "1 0 0"),
            hinge(&hip, [&upper, &thigh], tilt, "0 1 0"),
            hinge(&knee, [&thigh, &lower], 0.0, "0 1 0"),
            hinge(&ankle, [&lower, &foot], 0.0, "0 -1 0"),
        ]
        .concat()
    };
    let torso = link("torso", 5.0, [0.0; 2], 1.0, "");
    let text = urdf::robot(&[torso, leg("left", 0.375), leg("right", -0.375)]);
    let robot = load(&text);
    assert!(robot.joints().is_empty());
    let expected = "6 of 8 joints that could move are frozen only because their axes are 21.5 degrees off the plane (left_hip, \
                    left_knee, left_ankle, 3 more); to keep them: `hold: left_abduct=-0.375000`, `hold: \
                    right_abduct=0.375000`";
    assert_eq!(only_caution(&robot), expected);
    let held = holding(&text, &[(0, -0.375), (4, 0.375)]);
    assert_eq!(names(&held), ["left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle"]);
    assert!(held.reading().cautions.is_empty());
}

#[test]
fn a_hinge_is_held_only_where_that_serves_all_beyond_it() {
    // tan 5 degrees.
    let tilted = ("revolute", "0 1 0.087488663525924");
    let within = |limits: &str| {
        let limits = format!("<limit {limits} effort=\"1\" velocity=\"1\"/></joint>");
        only_caution(&load(&massive(&[ROLL, tilted, tilted]).replacen("</joint>", &limits, 1))).to_owned()
    };
    assert!(within("lower=\"-0.1\" upper=\"0.1\"").ends_with(": `hold: j=-0.087266`"));
    assert!(within("lower=\"-0.05\" upper=\"0.1\"").ends_with(": straighten the axis of k, straighten the axis of l"));
    // A slide in the plane of what is tilted is turned with it.
    let robot = load(&massive(&[ROLL, tilted, ("prismatic", "0 -0.087488663525924 1")]));
    assert!(only_caution(&robot).ends_with("(k, l); to keep them: `hold: j=-0.087266`"));
    // What follows another joint cannot be held by itself.
    let follows = "<mimic joint=\"m\"/></joint>";
    let robot = load(&massive(&[ROLL, tilted, tilted, PITCH]).replacen("</joint>", follows, 1));
    let caution = &robot.reading().cautions[0];
    assert!(caution.ends_with("(k, l); to keep them: straighten the axis of k, straighten the axis of l"), "{caution}");
    // What is in line already would be turned out of it.
    let robot = load(&massive(&[ROLL, tilted, tilted, PITCH]));
    assert_eq!(names(&robot), ["m"]);
    assert!(only_caution(&robot).ends_with("(k, l); to keep them: straighten the axis of k, straighten the axis of l"));
    // Two shoulders that are tilted to both sides behind one hinge.
    let place = "<origin xyz=\"0 0 -1\"/>";
    let side = |parent: &str, tilt: f64| format!("<parent link=\"{parent}\"/>@<origin rpy=\"{tilt} 0 0\"/>");
    let text = massive(&[ROLL, PITCH, PITCH]);
    let [left, right] = [("b", "c", 0.3), ("c", "d", -0.3)].map(|(parent, child, tilt)| {
        let from = format!("<parent link=\"{parent}\"/><child link=\"{child}\"/>{place}");
        (from, side("b", tilt).replace('@', &format!("<child link=\"{child}\"/>")))
    });
    let robot = load(&text.replace(&left.0, &left.1).replace(&right.0, &right.1));
    assert!(only_caution(&robot).ends_with("(k, l); to keep them: straighten the rpy of k, straighten the rpy of l"));
}

#[test]
fn a_joint_frozen_outside_its_limits_is_named() {
    let limited = |limits: &str| {
        let axis = "<axis xyz=\"1 0 0\"/>";
        let limits = format!("{axis}<limit {limits} effort=\"1\" velocity=\"1\"/>");
        load(&massive(&[PITCH, PITCH, ROLL]).replace(axis, &limits)).reading().cautions.clone()
    };
    let expected = "frozen at zero, which is beyond their limits: l in [0.3, 0.8]; give values (`hold: NAME=VALUE`), which may turn \
         joints beyond them out of the plane";
    assert_eq!(limited("lower=\"0.3\" upper=\"0.8\""), [expected]);
    assert_eq!(limited("lower=\"0.008\" upper=\"0.8\""), [""; 0], "by the digits of the file");
}

#[test]
fn axis_tolerance_keeps_axes_that_are_off_by_digits() {
    let text = massive(&[PITCH, ("revolute", "0 1 0.0016"), PITCH]);
    let robot = load(&text);
    assert_eq!(names(&robot), ["j", "l"]);
    let expected = "1 of 3 joints that could move are frozen only because their axes are 0.092 degrees off the plane (k); to \
                    keep them: `axis_tolerance: 1.8e-3`";
    assert_eq!(only_caution(&robot), expected);
    let robot = reduce(&text, &Reduction { axis_tolerance: Some(1.8e-3), ..Reduction::default() });
    assert_eq!((names(&robot), robot.reading().plane_because), (vec!["j", "k", "l"], PlaneReason::CommonAxis));
    let in_degrees = Robot::reduce(
        &Description::from_urdf(&text).unwrap(),
        &Reduction { axis_tolerance: Some(3.0), ..Reduction::default() },
    );
    let refused = in_degrees.expect_err("a hinge across the plane");
    assert_eq!(refused.to_string(), "`axis_tolerance` must be between 0 and 0.5 rad, not 3");
    let why = "its axis is 1.6e-3 rad off the plane's normal: taken as exactly on it";
    assert_eq!(robot.left_out(), [left_out("joint \"k\"", why)]);
}

#[test]
fn missing_axis_is_named_with_its_line() {
    let robot = load(&massive(&[PITCH, ROLL]).replace("<axis xyz=\"1 0 0\"/>", ""));
    let expected =
        "without an <axis>, and so about or along x: k on line 6; name the axis, as in <axis xyz=\"0 1 0\"/>";
    assert_eq!(only_caution(&robot), expected);
}

#[test]
fn elements_that_close_loops_are_named() {
    let robot = load(&massive(&[PITCH]).replace("</robot>", "<loop_joint name=\"l\"/></robot>"));
    let expected = "what closes loops in the file is left out (loop_joint): close them by `loops` in each state";
    assert_eq!(only_caution(&robot), expected);
    let why = "a tree of joints has no loops: states close them by `loops`";
    assert!(robot.left_out().contains(&left_out("<loop_joint> in <robot>", why)), "{:?}", robot.left_out());
}

#[test]
fn a_joint_held_in_degrees_is_named() {
    let text = massive(&[PITCH, PITCH]);
    let caution = |value| {
        let held = Reduction { hold: vec![(0, value)], ..Reduction::default() };
        reduce(&text, &held).reading().cautions.clone()
    };
    assert_eq!(caution(1.5), [""; 0]);
    assert_eq!(caution(90.0), ["held beyond limits, or in degrees: j = 90 rad is more than a turn"]);
}

#[test]
fn rotor_inertia_of_the_file_is_noted() {
    let caution = |value: &str| {
        let rotor = format!("<drake:gear_ratio value=\"9\"/><drake:rotor_inertia value=\"{value}\"/>");
        let more = format!("<transmission><joint name=\"j\"/><actuator name=\"m\">{rotor}</actuator></transmission>");
        load(&massive(&[PITCH]).replace("</robot>", &(more + "</robot>"))).reading().cautions.clone()
    };
    let words = "rotor inertia of the file is not read (j): give it times the gear ratio squared, by `rotor_inertia` in each \
                 state";
    assert_eq!(caution("0"), Vec::<String>::new());
    assert_eq!(caution("1e-4"), [words]);
}

#[test]
fn misspelt_names_are_named_with_their_lines() {
    let text = massive(&[PITCH]);
    let caution = |from: &str, to: &str| {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text);
        load(&changed).reading().cautions.iter().find(|caution| caution.contains("misspelt")).cloned()
    };
    assert_eq!(caution("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\" rpy=\"0\"/>"), None);
    let misspelt = caution("<origin ", "<orign ").unwrap();
    assert!(misspelt.starts_with("not read, and perhaps misspelt: <orign> in <"), "{misspelt}");
    for (from, to, named) in [
        ("<inertia ", "<inertia size=\"1\" ", "size of <inertia> on line 2 (<box>?)"),
        ("<inertial>", "<inertial mass=\"2\">", "mass of <inertial> on line 2 (<mass>?)"),
        ("<origin xyz=", "<origin pos=", "pos of <origin> on line"),
        ("<origin xyz=", "<origin quaternion=\"1 0 0 0\" xyz=", "quaternion of <origin> on line 2 (rpy?)"),
        ("<origin ", "<com ", "<com> in <inertial> on line 2"),
        ("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 1 0\"><origin/></axis>", "<origin> in <axis> on line"),
        ("<origin xyz=\"0 0 -1\"/>", "<origin>0 0 -1</origin>", "text in <origin> on line 4 (xyz or rpy?)"),
        ("<link name=\"a\">", "<link name=\"a\" mass=\"3\">", "mass of <link> on line 2 (<mass>?)"),
        ("<link name=\"a\">", "<link name=\"a\"><link name=\"x\"/>", "<link> in <link> on line 2 (in <robot>?)"),
        ("<link name=\"a\">", "<inertial/><link name=\"a\">", "<inertial> in <robot> on line 2 (in <link>?)"),
        (
            "<link name=\"a\">",
            "<link name=\"a\"><visual><inertial/></visual>",
            "<inertial> in <visual> on line 2 (in <link>?)",
        ),
    ] {
        assert!(caution(from, to).unwrap_or_default().contains(named), "{to}: {:?}", caution(from, to));
    }
    let misspelt = caution("<axis xyz=", "<axis xzy=").unwrap();
    assert!(misspelt.contains("xzy of <axis> on line ") && misspelt.contains(" (xyz?)"), "{misspelt}");
    let limits = |limits: &str| caution("<axis ", &format!("<limit {limits}/><axis "));
    for (given, named) in [("lower=\"2\" upper=\"-1\"", "2 to -1"), ("upper=\"1,5\"", "0 to 1,5")] {
        assert!(
            limits(given).is_some_and(|caution| caution.ends_with(&format!(" (no limit from {named})"))),
            "{given}"
        );
    }
    assert_eq!(limits("effort=\"1\" velocity=\"x\""), None);
    let unread = text.replace("<inertia ", "<inertia size=\"1\" ");
    let unread = unread.replace("<joint ", "<Joint ").replace("</joint>", "</Joint>");
    let refused = Robot::from_urdf(&unread).expect_err("two roots");
    let remedy = "make one of them the child of a joint; not read, and perhaps misspelt: <Joint> in <robot> on line 4 (<joint>?)";
    assert_eq!(refused.remedy(), Some(remedy));
    // As other formats call them.
    let named = limits("min=\"-1\" max=\"1\"").unwrap();
    assert!(named.contains("min of <limit> on line 4 (lower?), max of <limit> on line 4 (upper?)"), "{named}");
}

#[test]
fn link_without_inertial_is_named_when_m_is_singular() {
    let text = chain(&[1.0, 1.0, 0.0], &[PITCH, PITCH]);
    let error = crate::support::impact::try_impact(&load(&text), Default::default(), "{}").expect_err("singular");
    let expected = "link \"c\" on line 4 of the robot's file has no <inertial>: name the joint in `held`, or give it a \
                    `rotor_inertia`";
    assert_eq!(error.remedy(), Some(expected));
}

// Mimic joints.

#[test]
fn a_mimic_joint_is_tied_to_the_last_mimicked_one() {
    // j follows k by 2 q + 0.5, k follows m by -3 q: j = -6 q_m + 0.5.
    let text = massive(&[PITCH, PITCH, PITCH, PITCH]);
    let text = with_mimic(&text, "j", "joint=\"k\" multiplier=\"2\" offset=\"0.5\"");
    let text = with_mimic(&text, "k", "joint=\"m\" multiplier=\"-3\"");
    let robot = load(&text);
    assert_eq!(names(&robot), ["l", "m"]);
    let mimics =
        robot.mimic_joints().iter().map(|own| (own.joint.name.as_str(), own.mimicked, own.multiplier, own.offset));
    assert_eq!(mimics.collect::<Vec<_>>(), [("j", 1, -6.0, 0.5), ("k", 1, -3.0, 0.0)]);
    let movers: Vec<_> = robot.bodies().iter().map(|body| body.joint).collect();
    let (mimic, joint) = (ParentJoint::Mimic, ParentJoint::Joint);
    assert_eq!(movers, [None, Some(mimic(0)), Some(mimic(1)), Some(joint(0)), Some(joint(1))]);
}

#[test]
fn a_mimic_joint_of_a_frozen_joint_is_frozen_with_it() {
    let mimic = |axis: &str| {
        with_mimic(&massive(&[("revolute", axis), PITCH]), "k", "joint=\"j\" multiplier=\"2\" offset=\"0.1\"")
    };
    let robot = load(&mimic("1 0 0"));
    assert!(robot.joints().is_empty() && robot.mimic_joints().is_empty());
    // At its offset, as the mimicked one is at zero.
    let frozen = still(&robot, "k");
    assert_eq!(frozen, &FreezeReason::Follows { mimicked: "j".into(), value: 0.1 });
    assert_eq!(frozen.to_string(), "frozen at 0.1 by j, which it follows");
    assert_at(robot.links()[2].point::<f64>([0.0, 0.0, -1.0]), [-0.1_f64.sin(), -2.0 - 0.1_f64.cos()]);

    // A mimicked joint that is frozen at a value takes its mimic joint along: 2 * 0.2 + 0.1.
    let robot = holding(&mimic("0 1 0"), &[(0, 0.2)]);
    let (first, both): (f64, f64) = (0.2, 0.2 + 2.0 * 0.2 + 0.1);
    let expected = [-first.sin() - both.sin(), -1.0 - first.cos() - both.cos()];
    assert_at(robot.links()[2].point::<f64>([0.0, 0.0, -1.0]), expected);

    // So is one on the way to the joint that it mimics, which that turn leaves off the plane, or fixed.
    let tilted = with_mimic(&massive(&[PITCH, ROLL]), "j", "joint=\"k\" multiplier=\"-0.5\" offset=\"0.6\"");
    for text in [tilted.clone(), tilted.replace("name=\"k\" type=\"revolute\"", "name=\"k\" type=\"fixed\"")] {
        let robot = load(&text);
        assert_eq!(still(&robot, "j"), &FreezeReason::Follows { mimicked: "k".into(), value: 0.6 });
        assert_at(robot.links()[1].point::<f64>([0.0, 0.0, -1.0]), [-0.6_f64.sin(), -1.0 - 0.6_f64.cos()]);
    }

    // One on the way to the joint that it mimics does not turn that into the plane, where it would move.
    let quarter = "joint=\"l\" offset=\"1.5707963267948966\"";
    let robot = load(&with_mimic(&massive(&[PITCH, ROLL, ("revolute", "0 0 1")]), "k", quarter));
    assert_eq!(names(&robot), ["j"]);
    assert!(["k", "l"].iter().all(|name| matches!(still(&robot, name), FreezeReason::OffPlane { .. })));

    // A mimic joint off the plane is frozen as such; the mimicked one stays.
    let robot = load(&with_mimic(&massive(&[PITCH, ROLL]), "k", "joint=\"j\""));
    assert_eq!((names(&robot), robot.mimic_joints().len()), (vec!["j"], 0));
    assert!(matches!(still(&robot, "k"), FreezeReason::OffPlane { .. }));
    let words =
        "frozen at zero although what they follow moves, their axes being off the plane: k follows j; to keep both";
    assert!(
        robot.reading().cautions.iter().any(|caution| caution.starts_with(words)),
        "{:?}",
        robot.reading().cautions
    );
}

// Whatever the order and the names.

#[test]
fn names_and_order_in_the_file_change_nothing_else() {
    let text = massive(&[PITCH, ROLL, ("prismatic", "0 0 1"), ("revolute", "0 -1 0")]);
    // Each letter the one that stands opposite in the alphabet, so that their order turns round; joints named like
    // links.
    let opposite = |letter: char| char::from_u32('a' as u32 + 'z' as u32 - letter as u32).expect("a letter");
    let renamed: String = "abcdejklm".chars().fold(text.clone(), |text, letter| {
        text.replace(&format!("\"{letter}\""), &format!("\"*{}\"", opposite(letter)))
    });
    let (forward, renamed) = (load(&text), load(&renamed.replace('*', "a name ü ")));
    assert_eq!(renamed.joints()[0].name, "a name ü q");
    let numbers = |robot: &Robot| {
        let bodies: Vec<_> = robot.bodies().iter().map(|body| (body.mass, body.com, body.moment, body.joint)).collect();
        let joints: Vec<_> = robot.joints().iter().map(|joint| (joint.parent, joint.origin, joint.axis)).collect();
        (bodies, joints)
    };
    assert_eq!(numbers(&forward), numbers(&renamed));

    let elements = text.lines().rev().filter(|line| line.starts_with("<link") || line.starts_with("<joint"));
    let backward = load(&robot(&elements.collect::<String>()));
    assert_eq!(forward.bodies().len(), backward.bodies().len());
    for (a, b) in forward.bodies().iter().zip(backward.bodies()) {
        assert_eq!((&a.name, a.mass, a.com, a.moment), (&b.name, b.mass, b.com, b.moment));
    }
    assert_eq!(names(&forward).into_iter().rev().collect::<Vec<_>>(), names(&backward));
    for joint in forward.joints() {
        let other = &backward.joints()[backward.joint(&joint.name).expect("the joint")];
        assert_eq!(joint, other);
    }
}
