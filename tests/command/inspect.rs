//! `inspect`, and what options and cautions make of a robot.

use super::{RAMONE, heelstrike, heelstrike_reads};

#[test]
fn inspect_tells_what_was_read() {
    let run = heelstrike(&["inspect", RAMONE]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("inspect_ramone", run.stdout);
}

#[test]
fn inspect_of_every_robot_fits_a_screen_and_begins_with_what_a_user_needs() {
    for (folder, file) in [
        ("a1", "a1"),
        ("acrobot", "Acrobot"),
        ("cartpole", "cartpole"),
        ("h1", "h1"),
        ("planar_walker_torso", "PlanarWalkerWithTorso"),
        ("rabbit", "five_link_walker"),
        ("solo8", "solo"),
        ("upkie", "upkie"),
    ] {
        let run = heelstrike(&["inspect", &format!("tests/data/robots/{folder}/{file}.urdf")]);
        assert_eq!((run.status, run.stderr.as_str()), (0, ""));
        assert!(run.stdout.lines().count() <= 55, "{folder}: {}", run.stdout);
        // Without what is left of a line that was broken.
        let head = run.stdout.lines().skip(1).filter(|line| !line.starts_with("     "));
        let labels: Vec<&str> = head.take(6).filter_map(|line| line.split_whitespace().next()).collect();
        assert_eq!(labels, ["plane", "mass", "base", "joints", "coordinates", "feet"], "{folder}");
        insta::assert_snapshot!(format!("inspect_{folder}"), run.stdout);
    }
}

#[test]
fn plane_hold_and_base_shape_the_robot() {
    const A1: &str = "tests/data/robots/a1/a1.urdf";
    let inspect = |options: &[&str]| heelstrike(&[&["inspect", A1, "--format", "json"], options].concat());
    let yz = inspect(&["--plane", "yz"]).line();
    assert_eq!((&yz["plane"], &yz["plane_because"]), (&"yz".into(), &"as asked; plane xz would keep 8 joints".into()));
    let names: Vec<_> = yz["joints"].as_array().expect("joints").iter().map(|joint| &joint["name"]).collect();
    assert_eq!(names, ["FR_hip_joint", "FL_hip_joint", "RR_hip_joint", "RL_hip_joint"]);
    // Their axis is +x, the plane's normal -x.
    assert!(yz["joints"].as_array().expect("joints").iter().all(|joint| joint["sign"] == -1.0));

    let held = inspect(&["--hold", "FR_calf_joint=-1.5", "--hold", "FL_calf_joint=-1.5", "--base", "fixed"]).line();
    assert_eq!(held["coordinates"].as_array().map(Vec::len), Some(6));
    assert_eq!((&held["base"], &held["base_because"]), (&"fixed".into(), &"as asked".into()));
    let left = serde_json::json!({"name": "FR_calf_joint", "body": "FR_thigh", "why": "held at -1.5 as asked"});
    assert!(held["held"].as_array().expect("held").contains(&left), "{}", held["held"]);

    let unknown = inspect(&["--hold", "FR_calf=0"]);
    assert_eq!(unknown.status, 2);
    let told = "error: --hold: the robot has no joint named \"FR_calf\"\nhint: did you mean FR_calf_joint?\n";
    assert_eq!(unknown.stderr, told);
}

#[test]
fn a_state_that_names_a_held_joint_is_told_why_it_has_no_coordinate() {
    let state = r#"{"position": {"joints": {"FR_hip_joint": 0.1}}, "friction": 1}"#;
    let run = heelstrike_reads(&["impact", "tests/data/robots/a1/a1.urdf", "-"], state);
    assert_eq!(run.status, 1);
    let told = "joint \"FR_hip_joint\" has no coordinate: held at zero, its axis being 90.00 degrees off the plane's normal: \
                welded into base";
    assert!(run.stderr.contains(told), "{}", run.stderr);
}

#[test]
fn a_robot_that_loses_its_joints_is_told_loudly_by_every_command() {
    let link = |name: &str| {
        let inertia = "<inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/>";
        format!("<link name='{name}'><inertial><mass value='1'/>{inertia}</inertial></link>")
    };
    let joint = "<joint name='j' type='revolute'><origin rpy='0.0872665 0 0'/><axis xyz='0 1 0'/><parent link='a'/>\
                 <child link='b'/></joint>";
    let file = super::file("tilted.urdf", format!("<robot name='r'>{}{}{joint}</robot>", link("a"), link("b")));
    let word = "1 of 1 joints that could move are held only because their axes are 5.0 degrees off the plane (j); to keep \
                them: straighten the rpy of j";
    let inspect = heelstrike(&["inspect", &file]);
    assert!(inspect.stdout.replace("\n               ", " ").contains(word), "{}", inspect.stdout);
    let impact = heelstrike_reads(&["impact", &file, "-"], r#"{"friction": 1}"#);
    assert_eq!((impact.status, impact.stderr), (0, format!("note: {word}\n")));
}

#[test]
fn inspect_prints_the_reduced_robot_with_every_digit() {
    let run = heelstrike(&["inspect", "urdf/ramone_paper.urdf", "--format", "json"]);
    let robot = run.line();
    assert_eq!(robot["plane"], "xz");
    assert_eq!(robot["bodies"][2]["com"], serde_json::json!([0.0, -0.073265]));
    assert_eq!(robot["bodies"][2]["links"], serde_json::json!(["left_shank", "left_foot"]));
    assert_eq!(robot["joints"][0]["sign"], -1.0);
    assert_eq!(robot["feet"][1]["radius"], 0.02815);
}
