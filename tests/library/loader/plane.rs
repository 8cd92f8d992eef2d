//! The choice of the plane, the joints that stay in it, and what happens to the others.

use super::*;
use heelstrike::robot::{FreezeReason, Plane, PlaneReason};

fn in_plane(plane: Plane) -> Reduction {
    Reduction { plane: Some(plane), ..Reduction::default() }
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
    // If two planes keep equally many joints, the usual one is taken.
    let robot = load(&massive(&[ROLL, PITCH]));
    assert_eq!((robot.reading().plane, robot.reading().plane_because), (Plane::XZ, PlaneReason::Legs));
    // Two arms, whose ends are higher than the foot, do not count.
    let arms = with_arms(&massive(&[PITCH, PITCH, PITCH, ROLL, ROLL, ROLL, ROLL]));
    let robot = load(&arms);
    assert_eq!((robot.reading().plane, names(&robot)), (Plane::XZ, vec!["j", "k", "l"]));
    // The root's origin may be lower than all feet: a leg that begins 3 m above it.
    let high = massive(&[ROLL, PITCH, ROLL]).replacen("0 0 -1", "0 0 3", 1);
    let robot = load(&high);
    assert_eq!((robot.reading().plane, names(&robot)), (Plane::YZ, vec!["j", "l"]));
    assert_eq!((robot.reading().plane_because, robot.reading().better_plane), (PlaneReason::Most, None));
    // An axis between two normals counts for the nearer one.
    let oblique = ("revolute", "0 1 0.4");
    let robot = load(&massive(&[ROLL, oblique, oblique]));
    assert_eq!(robot.reading().plane, Plane::XZ);

    let robot = reduce(&massive(&[ROLL, ROLL, PITCH]), &in_plane(Plane::XZ));
    assert_eq!((robot.reading().better_plane, names(&robot)), (Some((Plane::YZ, 2)), vec!["l"]));
    assert!(robot.reading().plane_in_words().ends_with("plane yz would keep 2 joints"));
    let given = reduce(&massive(&[("continuous", "1 0 0"), PITCH]), &in_plane(Plane::YZ));
    assert_eq!((given.reading().plane_because, names(&given)), (PlaneReason::Asked, vec!["j"]));
    // Without hinges nothing chooses a plane.
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
    // j turns by a quarter turn about x, so that the z axis of k points to -y: k stays.
    let text = massive(&[("revolute", "2 0 0"), YAW, ("prismatic", "0 0 1")]);
    let hold =
        |hold: &[(usize, f64)]| Reduction { plane: Some(Plane::XZ), hold: hold.to_vec(), ..Reduction::default() };
    let robot = reduce(&text, &hold(&[(0, FRAC_PI_2)]));
    assert_eq!((names(&robot), robot.joints()[0].axis), (vec!["k"], Axis::Revolute { sign: -1.0 }));
    assert_eq!(still(&robot, "j"), &FreezeReason::Asked { value: FRAC_PI_2 });
    // The origin of k, 1 m down in b's frame, is 1 m to the left, which the plane drops.
    assert_at(robot.joints()[0].origin, [0.0, -1.0]);

    // A slide that is frozen carries its child along: 1 m down and 0.25 m up.
    let robot = reduce(&text, &hold(&[(2, 0.25)]));
    assert_eq!(names(&robot), [""; 0]);
    assert_eq!(robot.links()[3].point::<f64>([0.0; 3]), [0.0, -2.75]);
    let why = "frozen at 0.25 as asked: welded into a";
    assert!(robot.left_out().contains(&left_out("joint \"l\"", why)), "{:?}", robot.left_out());

    // A joint in the plane can be frozen as well; it then does not count in the choice of the plane.
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
        let caution = "able to move in the plane but frozen, having no single axis: k; give revolute and prismatic joints \
                       instead";
        assert_eq!(robot.reading().cautions, [caution]);
    }
}

#[test]
fn axis_tolerance_keeps_axes_that_are_off_by_digits() {
    let text = massive(&[PITCH, ("revolute", "0 1 0.0016"), PITCH]);
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
    // It is frozen at its offset, because the mimicked joint is at zero.
    let frozen = still(&robot, "k");
    assert_eq!(frozen, &FreezeReason::Follows { mimicked: "j".into(), value: 0.1 });
    assert_eq!(frozen.to_string(), "frozen at 0.1 by j, which it follows");
    assert_at(robot.links()[2].point::<f64>([0.0, 0.0, -1.0]), [-0.1_f64.sin(), -2.0 - 0.1_f64.cos()]);

    // A mimicked joint that is frozen at a value takes its mimic joint along: 2 * 0.2 + 0.1.
    let robot = holding(&mimic("0 1 0"), &[(0, 0.2)]);
    let (first, both): (f64, f64) = (0.2, 0.2 + 2.0 * 0.2 + 0.1);
    let expected = [-first.sin() - both.sin(), -1.0 - first.cos() - both.cos()];
    assert_at(robot.links()[2].point::<f64>([0.0, 0.0, -1.0]), expected);

    // So is a mimic joint on the path to its mimicked joint, if that is off the plane after that turn, or fixed.
    let tilted = with_mimic(&massive(&[PITCH, ROLL]), "j", "joint=\"k\" multiplier=\"-0.5\" offset=\"0.6\"");
    for text in [tilted.clone(), tilted.replace("name=\"k\" type=\"revolute\"", "name=\"k\" type=\"fixed\"")] {
        let robot = load(&text);
        assert_eq!(still(&robot, "j"), &FreezeReason::Follows { mimicked: "k".into(), value: 0.6 });
        assert_at(robot.links()[1].point::<f64>([0.0, 0.0, -1.0]), [-0.6_f64.sin(), -1.0 - 0.6_f64.cos()]);
    }

    // A mimic joint on the path to its mimicked joint is not used to turn that into the plane, in which it would move.
    let quarter = "joint=\"l\" offset=\"1.5707963267948966\"";
    let robot = load(&with_mimic(&massive(&[PITCH, ROLL, ("revolute", "0 0 1")]), "k", quarter));
    assert_eq!(names(&robot), ["j"]);
    assert!(["k", "l"].iter().all(|name| matches!(still(&robot, name), FreezeReason::OffPlane { .. })));

    // A mimic joint off the plane is frozen for that reason; the mimicked joint stays.
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

// Names and order.

#[test]
fn names_and_order_in_the_file_change_nothing_else() {
    let text = massive(&[PITCH, ROLL, ("prismatic", "0 0 1"), ("revolute", "0 -1 0")]);
    // Replaces each letter by its counterpart from the end of the alphabet, which reverses their order, and then adds
    // spaces and an umlaut.
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
