//! How the root is attached, and with which link the robot begins.

use super::*;
use crate::support::impact::try_impact;
use heelstrike::pipeline::Options;
use heelstrike::robot::{FreezeReason, FrozenJoint};

const X: (&str, &str) = ("prismatic", "1 0 0");
const Y: (&str, &str) = ("prismatic", "0 1 0");
const Z: (&str, &str) = ("prismatic", "0 0 1");
const FIXED: (&str, &str) = ("fixed", "1 0 0");

/// The kind of base, the first body, and the joints.
fn found(robot: &Robot) -> (Base, &str, Vec<&str>) {
    (robot.base(), &robot.bodies()[0].name, names(robot))
}

/// Renames the root of a chain to `world`.
fn world(text: &str) -> String {
    text.replace("\"a\"", "\"world\"")
}

#[test]
fn root_floats_by_its_mass_and_joints() {
    let (mass, fixed_to) = ("the root has mass", "what is fixed to the root has mass");
    let alone = "the root is massless and joint \"j\" alone carries the robot";
    let several = "the root is massless, but several joints carry the robot";
    let fixed = chain(&[0.0, 1.0, 1.0], &[FIXED, PITCH]);
    let forked = chain(&[0.0, 1.0, 1.0], &[PITCH, PITCH]).replace("<parent link=\"b\"/>", "<parent link=\"a\"/>");
    let in_file = "the file's own chain of joints \"j\", \"k\", \"l\" is the base itself";
    let in_space = "the file's own chain of joints \"j\", \"l\", \"n\" is the base itself";
    for (text, expected, kg, because) in [
        // A root with mass, however little.
        (chain(&[0.001, 1.0], &[PITCH]), (Base::Floating, "a", vec!["j"]), 1.001, mass),
        // Massless roots to which links with mass are fixed, by a fixed joint or a frozen one.
        (fixed.clone(), (Base::Floating, "a", vec!["k"]), 2.0, fixed_to),
        (chain(&[0.0, 1.0, 1.0], &[ROLL, PITCH]), (Base::Floating, "a", vec!["k"]), 2.0, fixed_to),
        // Massless roots that carry the robot by a rail, by one hinge and by two.
        (chain(&[0.0, 1.0, 1.0], &[X, PITCH]), (Base::Fixed, "a", vec!["j", "k"]), 2.0, alone),
        (chain(&[0.0, 1.0], &[PITCH]), (Base::Fixed, "a", vec!["j"]), 1.0, alone),
        (forked, (Base::Floating, "a", vec!["j", "k"]), 2.0, several),
        // Incomplete chains of a base: without pitch, with two slides along one line, with mass on the way.
        (chain(&[0.0, 0.0, 1.0], &[X, Z]), (Base::Fixed, "a", vec!["j", "k"]), 1.0, alone),
        (chain(&[0.0, 0.0, 0.0, 1.0], &[X, X, PITCH]), (Base::Fixed, "a", vec!["j", "k", "l"]), 1.0, alone),
        (chain(&[0.0, 0.1, 0.0, 1.0], &[X, Z, PITCH]), (Base::Fixed, "a", vec!["j", "k", "l"]), 1.1, alone),
        // A root named `world` is bolted, with what is fixed to it, unless a complete chain frees it.
        (world(&fixed), (Base::Fixed, "world", vec!["k"]), 1.0, "the root is named world"),
        (world(&chain(&[5.0, 0.0, 0.0, 1.0], &[X, Z, PITCH])), (Base::Floating, "d", vec![]), 1.0, in_file),
        // A complete chain in three dimensions: the yaw behind the pitch is frozen, so that the base is the link
        // between them.
        (
            chain(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 1.0], &[X, Y, Z, ROLL, PITCH, YAW, PITCH]),
            (Base::Floating, "f", vec!["p"]),
            3.0,
            in_space,
        ),
    ] {
        let robot = load(&text);
        let signs = robot.bodies().iter().flat_map(|body| [body.mass, body.moment]);
        assert!(signs.into_iter().all(f64::is_sign_positive), "{text}");
        let base = if robot.base() == Base::Floating { 3 } else { 0 };
        assert_eq!(robot.dofs(), base + expected.2.len(), "{text}");
        assert_eq!((found(&robot), robot.mass()), (expected, kg), "{text}");
        assert_eq!(robot.reading().base_because, because, "{text}");
    }
}

#[test]
fn a_whole_chain_is_the_base_itself() {
    for joints in [[X, Z, PITCH, PITCH], [Z, X, PITCH, PITCH], [PITCH, X, Z, PITCH]] {
        let robot = load(&chain(&[0.0, 0.0, 0.0, 2.0, 1.0], &joints));
        assert_eq!(found(&robot), (Base::Floating, "d", vec!["m"]), "{joints:?}");
        assert_eq!(robot.coordinates().collect::<Vec<_>>(), ["x", "z", "pitch", "m"]);
        assert_eq!(robot.reading().outside, ["a", "b", "c"]);
        assert_eq!(robot.links().iter().map(|link| link.name.as_str()).collect::<Vec<_>>(), ["d", "e"]);
        let still: Vec<_> = robot
            .reading()
            .frozen
            .iter()
            .map(|FrozenJoint { name, reason: still, .. }| (name.as_str(), still))
            .collect();
        assert_eq!(still, [("j", &FreezeReason::Base), ("k", &FreezeReason::Base), ("l", &FreezeReason::Base)]);
        let why = "part of the floating base: x, z and pitch of d take its place";
        assert_eq!(robot.frozen("k").expect("the slide").why(), why);
    }
}

#[test]
fn a_turned_chain_keeps_the_axes_of_the_files_root() {
    // The last joint's frame is turned by a quarter turn about z, so that its x axis is the root's y. The torso's CoG,
    // at (0, -0.3, 0.2) in it, is at x = 0.3.
    let text = chain(&[0.0, 0.0, 0.0, 2.0], &[X, Z, ROLL])
        .replace(
            "<child link=\"d\"/><origin xyz=\"0 0 -1\"/>",
            &format!("<child link=\"d\"/><origin xyz=\"5 6 7\" rpy=\"0 0 {FRAC_PI_2}\"/>"),
        )
        .replace("<origin xyz=\"0 0 0\"/><mass value=\"2\"/>", "<origin xyz=\"0 -0.3 0.2\"/><mass value=\"2\"/>");
    let robot = load(&text);
    assert_eq!(found(&robot), (Base::Floating, "d", vec![]));
    assert_at(robot.bodies()[0].com, [0.3, 0.2]);
}

#[test]
fn a_planar_or_floating_joint_is_the_base_itself() {
    for kind in ["planar", "floating"] {
        let text = chain(&[0.0, 2.0, 1.0], &[(kind, "0 1 0"), PITCH]);
        for text in [text.clone(), world(&text), world(&text.replace("<link name=\"a\"></link>", ""))] {
            let robot = load(&text);
            assert_eq!(found(&robot), (Base::Floating, "b", vec!["k"]));
            assert_eq!(robot.reading().base_because, format!("{kind} joint \"j\" is the base itself"));
        }
        let bolted = reduce(&text, &Reduction { base: Some(Base::Fixed), ..Reduction::default() });
        assert_eq!(found(&bolted), (Base::Fixed, "a", vec!["k"]));
    }
}

#[test]
fn a_planar_joint_about_another_axis_slides() {
    let of_base = |axis: &str| load(&chain(&[0.0, 2.0, 1.0], &[("planar", axis), PITCH]));
    for (axis, along) in [("0 0 1", [1.0, 0.0]), ("0 0 -2", [1.0, 0.0]), ("1 0 0", [0.0, 1.0]), ("0 3 4", [1.0, 0.0])] {
        let robot = of_base(axis);
        assert_eq!(found(&robot), (Base::Fixed, "a", vec!["j", "k"]), "{axis}");
        assert_eq!(robot.joints()[0].axis, Axis::Prismatic { direction: along.into() }, "{axis}");
    }
    // Single joints give the same robot.
    let yaw = ("revolute", "0 0 1");
    let single = load(&chain(&[0.0, 0.0, 0.0, 2.0, 1.0], &[X, ("prismatic", "0 1 0"), yaw, PITCH]));
    assert_eq!(found(&single), (Base::Fixed, "a", vec!["j", "m"]));
    assert_eq!(single.joints()[0].axis, of_base("0 0 1").joints()[0].axis);
    // An axis near the plane's normal is taken as the normal.
    let robot = of_base("0 1 0.02");
    assert_eq!(found(&robot), (Base::Floating, "b", vec!["k"]));
    assert_eq!(
        only_caution(&robot),
        "planar, with an axis off the plane's normal, and taken as in the plane: j; straighten the axis"
    );
    // Without an <axis> the joint is taken to move in the plane.
    let text = chain(&[0.0, 2.0, 1.0], &[("planar", "0 0 1"), PITCH]).replace("<axis xyz=\"0 0 1\"/>", "");
    assert_eq!(found(&load(&text)), (Base::Floating, "b", vec!["k"]));
}

#[test]
fn world_has_no_mass_and_needs_no_definition() {
    let heavy = world(&chain(&[5.0, 1.0], &[PITCH])).replace(
        "<link name=\"world\">",
        "<link name=\"world\"><collision><geometry><box size=\"9 9 1\"/></geometry></collision>",
    );
    let robot = load(&heavy);
    assert_eq!((found(&robot), robot.mass()), ((Base::Fixed, "world", vec!["j"]), 1.0));
    assert!(robot.links()[0].shapes.is_empty());
    let why = "bolted to the world: it cannot strike the ground";
    assert!(robot.left_out().contains(&left_out("collision shapes of link \"world\"", why)), "{:?}", robot.left_out());

    let robot = load(&world(&chain(&[0.0, 1.0], &[PITCH]).replace("<link name=\"a\"></link>", "")));
    assert_eq!(found(&robot), (Base::Fixed, "world", vec!["j"]));
    assert_eq!(robot.links().iter().map(|link| link.name.as_str()).collect::<Vec<_>>(), ["b", "world"]);
}

#[test]
fn the_base_can_be_asked_for() {
    let asked = |text: &str, base| reduce(text, &Reduction { base: Some(base), ..Reduction::default() });
    let walker = chain(&[0.0, 0.0, 0.0, 2.0, 1.0], &[X, Z, PITCH, PITCH]);
    assert_eq!(found(&asked(&walker, Base::Fixed)), (Base::Fixed, "a", vec!["j", "k", "l", "m"]));
    assert_eq!(found(&asked(&walker, Base::Floating)), (Base::Floating, "d", vec!["m"]));
    let pendulum = chain(&[0.0, 1.0], &[PITCH]);
    assert_eq!(found(&asked(&pendulum, Base::Floating)), (Base::Floating, "a", vec!["j"]));
    let floating = chain(&[1.0, 1.0], &[PITCH]);
    let robot = asked(&floating, Base::Fixed);
    assert_eq!((found(&robot), robot.dofs(), robot.mass()), ((Base::Fixed, "a", vec!["j"]), 1, 1.0));
    assert_eq!(robot.reading().base_because, "as asked");
}

#[test]
fn nearly_massless_chain_gets_a_caution() {
    let robot = load(&chain(&[1e-3, 1e-3, 1e-3, 2.0, 1.0], &[X, Z, PITCH, PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "a", vec!["j", "k", "l", "m"]));
    let caution = only_caution(&robot);
    assert!(caution.contains("\"j\", \"k\", \"l\"") && caution.contains("`base: fixed`"), "{caution}");
    // Under a massless root the chain is the base nevertheless.
    let robot = load(&chain(&[0.0, 1e-6, 1e-6, 2.0, 1.0], &[X, Z, PITCH, PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "d", vec!["m"]));
    let caution = only_caution(&robot);
    assert!(caution.contains("weigh 0.000002 kg, which is left out"), "{caution}");
    // With a carriage of 1 kg it is not.
    let robot = load(&chain(&[0.0, 1.0, 0.0, 2.0, 1.0], &[X, Z, PITCH, PITCH]));
    assert_eq!(found(&robot), (Base::Fixed, "a", vec!["j", "k", "l", "m"]));
}

#[test]
fn links_of_the_base_have_no_contacts() {
    let text = chain(&[0.0, 0.0, 0.0, 2.0], &[X, Z, PITCH]);
    let robot = load(&text);
    let state = r#"{"friction": 1, "contacts": [{"link": "b"}]}"#;
    let refused = try_impact(&robot, Options::default(), state).expect_err("a link of the base");
    assert!(refused.to_string().ends_with("link \"b\" is part of the base, not of the robot"), "{refused}");
    let robot = load(&text.replace(
        "<link name=\"c\">",
        "<link name=\"c\"><collision><geometry><sphere radius=\"0\"/></geometry></collision>",
    ));
    let caution = only_caution(&robot);
    assert!(caution.starts_with("part of the base, so that its collision shapes are left out: c;"), "{caution}");
}

#[test]
fn a_joint_that_is_fixed_to_the_base_belongs_to_it() {
    let robot = load(&chain(&[0.0, 0.0, 0.0, 0.0, 2.0], &[FIXED, X, Z, PITCH]));
    assert_eq!(robot.reading().outside, ["a", "b", "c", "d"]);
    assert!(
        robot.reading().frozen.iter().all(|joint| joint.reason == FreezeReason::Base),
        "{:?}",
        robot.reading().frozen
    );
}

#[test]
fn a_bolted_robot_of_which_nothing_moves_is_refused() {
    let still = Description::from_urdf(&world(&two_links("fixed", ""))).expect("a description");
    let refused = Robot::reduce(&still, &Reduction::default()).expect_err("nothing moves");
    assert_eq!(refused.to_string(), "robot: nothing that moves has mass");
    let remedy = "its root is bolted to the world; give `base: floating` to set it free";
    assert_eq!(refused.remedy(), Some(remedy));
}
