//! What the root is, and where the robot begins.

use super::*;
use crate::support::impact::try_impact;
use heelstrike::pipeline::Options;
use heelstrike::robot::{FreezeReason, FrozenJoint};

const X: (&str, &str) = ("prismatic", "1 0 0");
const Y: (&str, &str) = ("prismatic", "0 1 0");
const Z: (&str, &str) = ("prismatic", "0 0 1");
const FIXED: (&str, &str) = ("fixed", "1 0 0");

/// How the root is held, the body that the robot begins with, and its joints.
fn found(robot: &Robot) -> (Base, &str, Vec<&str>) {
    (robot.base, &robot.bodies[0].name, names(robot))
}

#[test]
fn a_root_with_mass_floats_however_little_it_weighs() {
    let robot = load(&chain(&[0.001, 1.0], &[PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "a", vec!["j"]));
    assert_eq!(robot.reading.base_because, "the root has mass");
    // Massless by itself, but fixed to what has mass.
    let robot = load(&chain(&[0.0, 1.0, 1.0], &[FIXED, PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "a", vec!["k"]));
    // A joint that is held fixes as well.
    let robot = load(&chain(&[0.0, 1.0, 1.0], &[ROLL, PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "a", vec!["k"]));
}

#[test]
fn a_whole_chain_under_a_massless_root_is_the_base_itself() {
    for joints in [[X, Z, PITCH, PITCH], [Z, X, PITCH, PITCH], [PITCH, X, Z, PITCH]] {
        let robot = load(&chain(&[0.0, 0.0, 0.0, 2.0, 1.0], &joints));
        assert_eq!(found(&robot), (Base::Floating, "d", vec!["m"]), "{joints:?}");
        assert_eq!(robot.coordinates().collect::<Vec<_>>(), ["x", "z", "pitch", "m"]);
        assert_eq!(robot.reading.outside, ["a", "b", "c"]);
        assert_eq!(robot.links.iter().map(|link| link.name.as_str()).collect::<Vec<_>>(), ["d", "e"]);
        let still: Vec<_> =
            robot.reading.frozen.iter().map(|FrozenJoint { name, reason: still, .. }| (name.as_str(), still)).collect();
        assert_eq!(still, [("j", &FreezeReason::Base), ("k", &FreezeReason::Base), ("l", &FreezeReason::Base)]);
        let why = "part of the floating base: x, z and pitch of d take its place";
        assert_eq!(robot.frozen("k").expect("the slide").why(), why);
    }
}

#[test]
fn a_three_dimensional_chain_is_the_base_itself_too() {
    let joints = [X, Y, Z, ROLL, PITCH, YAW, PITCH];
    let robot = load(&chain(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 1.0], &joints));
    // The yaw behind the pitch is held, so that the robot's root is the link between them.
    assert_eq!(found(&robot), (Base::Floating, "f", vec!["p"]));
    assert_eq!((robot.bodies[0].mass, robot.dofs()), (2.0, 4));
}

#[test]
fn the_robot_keeps_the_axes_of_the_files_root_behind_a_turned_chain() {
    // The last joint's frame is turned by a quarter about z, so that its own x axis is the root's y; the torso's CoG,
    // at (0, -0.3, 0.2) there, lies at x = 0.3.
    let text = chain(&[0.0, 0.0, 0.0, 2.0], &[X, Z, ROLL])
        .replace(
            "<child link=\"d\"/><origin xyz=\"0 0 -1\"/>",
            &format!("<child link=\"d\"/><origin xyz=\"5 6 7\" rpy=\"0 0 {FRAC_PI_2}\"/>"),
        )
        .replace("<origin xyz=\"0 0 0\"/><mass value=\"2\"/>", "<origin xyz=\"0 -0.3 0.2\"/><mass value=\"2\"/>");
    let robot = load(&text);
    assert_eq!(found(&robot), (Base::Floating, "d", vec![]));
    assert_at(robot.bodies[0].com, [0.3, 0.2]);
}

#[test]
fn a_planar_or_floating_joint_under_a_massless_root_is_the_base_itself() {
    for kind in ["planar", "floating"] {
        let text = chain(&[0.0, 2.0, 1.0], &[(kind, "0 1 0"), PITCH]);
        for text in [
            text.clone(),
            text.replace("\"a\"", "\"world\""),
            text.replace("<link name=\"a\"></link>", "").replace("\"a\"", "\"world\""),
        ] {
            let robot = load(&text);
            assert_eq!(found(&robot), (Base::Floating, "b", vec!["k"]));
            assert_eq!(robot.reading.base_because, format!("{kind} joint \"j\" is the base itself"));
        }
        let bolted = reduce(&text, &Reduction { base: Some(Base::Fixed), ..Reduction::default() });
        assert_eq!(found(&bolted), (Base::Fixed, "a", vec!["k"]));
    }
}

#[test]
fn a_massless_root_over_a_rail_or_a_single_hinge_is_bolted() {
    for (masses, joints, kept) in [
        (&[0.0, 1.0, 1.0][..], &[X, PITCH][..], &["j", "k"][..]),
        (&[0.0, 1.0], &[PITCH], &["j"]),
        // Incomplete: no pitch, two slides along one line, mass on the way.
        (&[0.0, 0.0, 1.0], &[X, Z], &["j", "k"]),
        (&[0.0, 0.0, 0.0, 1.0], &[X, X, PITCH], &["j", "k", "l"]),
        (&[0.0, 0.1, 0.0, 1.0], &[X, Z, PITCH], &["j", "k", "l"]),
    ] {
        let robot = load(&chain(masses, joints));
        assert_eq!(found(&robot), (Base::Fixed, "a", kept.to_vec()), "{joints:?}");
        assert_eq!(robot.reading.base_because, "the root is massless and joint \"j\" alone carries the robot");
        assert_eq!(robot.mass(), masses.iter().sum::<f64>());
    }
}

#[test]
fn a_root_named_world_is_bolted_unless_a_whole_chain_frees_it() {
    let world = |text: String| text.replace("\"a\"", "\"world\"");
    // What the world weighs does not count, and it has no feet.
    let heavy = world(chain(&[5.0, 1.0], &[PITCH])).replace(
        "<link name=\"world\">",
        "<link name=\"world\"><collision><geometry><box size=\"9 9 1\"/></geometry></collision>",
    );
    let robot = load(&heavy);
    assert_eq!((found(&robot), robot.mass()), ((Base::Fixed, "world", vec!["j"]), 1.0));
    assert!(robot.links[0].shapes.is_empty());
    let why = "bolted to the world: it cannot strike the ground";
    assert!(robot.left_out.contains(&left_out("collision shapes of link \"world\"", why)), "{:?}", robot.left_out);

    let robot = load(&world(chain(&[0.0, 1.0, 1.0], &[FIXED, PITCH])));
    assert_eq!(found(&robot), (Base::Fixed, "world", vec!["k"]));
    assert_eq!(robot.reading.base_because, "the root is named world");
    let robot = load(&world(chain(&[5.0, 0.0, 0.0, 1.0], &[X, Z, PITCH])));
    assert_eq!(found(&robot), (Base::Floating, "d", vec![]));
}

#[test]
fn the_world_needs_no_definition() {
    let text = chain(&[0.0, 1.0], &[PITCH]).replace("<link name=\"a\"></link>", "").replace("\"a\"", "\"world\"");
    let robot = load(&text);
    assert_eq!(found(&robot), (Base::Fixed, "world", vec!["j"]));
    assert_eq!(robot.links.iter().map(|link| link.name.as_str()).collect::<Vec<_>>(), ["b", "world"]);
}

#[test]
fn a_massless_root_between_several_joints_floats() {
    let leg = |name: &str| link(name, 1.0, [0.0, -0.5], 0.1, "");
    let hinge = |name: &str, leg: &str| joint(name, HINGE, ["hip", leg], [0.0; 2], "");
    let elements = ["<link name=\"hip\"/>".to_owned(), leg("l"), leg("r"), hinge("i", "l"), hinge("j", "r")];
    let robot = load(&urdf::robot(&elements));
    assert_eq!(found(&robot), (Base::Floating, "hip", vec!["i", "j"]));
    assert_eq!(robot.reading.base_because, "the root is massless, but several joints carry the robot");
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
    assert_eq!(robot.reading.base_because, "as asked");
}

#[test]
fn a_chain_whose_links_were_only_given_a_mass_gets_a_word() {
    let robot = load(&chain(&[1e-3, 1e-3, 1e-3, 2.0, 1.0], &[X, Z, PITCH, PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "a", vec!["j", "k", "l", "m"]));
    let caution = only_caution(&robot);
    assert!(caution.contains("\"j\", \"k\", \"l\"") && caution.contains("`base: fixed`"), "{caution}");
}

#[test]
fn a_chain_of_next_to_nothing_under_a_massless_root_is_the_base_all_the_same() {
    let robot = load(&chain(&[0.0, 1e-6, 1e-6, 2.0, 1.0], &[X, Z, PITCH, PITCH]));
    assert_eq!(found(&robot), (Base::Floating, "d", vec!["m"]));
    let caution = only_caution(&robot);
    assert!(caution.contains("weigh 0.000002 kg, which is left out"), "{caution}");
    // A carriage of 1 kg is none.
    let robot = load(&chain(&[0.0, 1.0, 0.0, 2.0, 1.0], &[X, Z, PITCH, PITCH]));
    assert_eq!(found(&robot), (Base::Fixed, "a", vec!["j", "k", "l", "m"]));
}

#[test]
fn a_link_of_the_base_is_no_place_for_a_contact() {
    let robot = load(&chain(&[0.0, 0.0, 0.0, 2.0], &[X, Z, PITCH]));
    let state = r#"{"friction": 1, "contacts": [{"link": "b"}]}"#;
    let refused = try_impact(&robot, Options::default(), state).expect_err("a link of the base");
    assert!(refused.to_string().ends_with("link \"b\" is part of the base, not of the robot"), "{refused}");
}

#[test]
fn a_joint_that_is_fixed_to_the_base_belongs_to_it() {
    let robot = load(&chain(&[0.0, 0.0, 0.0, 0.0, 2.0], &[FIXED, X, Z, PITCH]));
    assert_eq!(robot.reading.outside, ["a", "b", "c", "d"]);
    assert!(robot.reading.frozen.iter().all(|joint| joint.reason == FreezeReason::Base), "{:?}", robot.reading.frozen);
}

#[test]
fn a_foot_on_a_link_of_the_base_gets_a_word() {
    let text = chain(&[0.0, 0.0, 0.0, 2.0], &[X, Z, PITCH]).replace(
        "<link name=\"c\">",
        "<link name=\"c\"><collision><geometry><sphere radius=\"0\"/></geometry></collision>",
    );
    let robot = load(&text);
    let caution = only_caution(&robot);
    assert!(caution.starts_with("c has collision shapes but belongs to the base"), "{caution}");
}

#[test]
fn a_bolted_robot_of_which_nothing_moves_is_refused_with_the_remedy() {
    let still = Description::from_urdf(&two_links("fixed", "").replace("\"a\"", "\"world\"")).expect("a description");
    let refused = Robot::reduce(&still, &Reduction::default()).expect_err("nothing moves");
    assert_eq!(refused.to_string(), "robot: nothing that moves has mass");
    let remedy = "its root is bolted to the world; give `base: floating` to set it free";
    assert_eq!(refused.remedy(), Some(remedy));
}
