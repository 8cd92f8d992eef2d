//! `inspect`: the robot that it shows, options that change the robot, and cautions about it.

use super::support::urdf;
use super::{RAMONE, WALKER, each, file, heelstrike, heelstrike_reads, list, place, read, result};
use serde_json::json;

const A1: &str = "tests/data/robots/a1/a1.urdf";

#[test]
fn every_robot_is_shown_with_what_a_user_needs_first() {
    for (name, path) in [
        ("ramone", RAMONE),
        ("a1", A1),
        ("acrobot", "tests/data/robots/acrobot/Acrobot.urdf"),
        ("cartpole", "tests/data/robots/cartpole/cartpole.urdf"),
        ("h1", "tests/data/robots/h1/h1.urdf"),
        ("planar_walker_torso", "tests/data/robots/planar_walker_torso/PlanarWalkerWithTorso.urdf"),
        ("rabbit", "tests/data/robots/rabbit/five_link_walker.urdf"),
        ("solo8", "tests/data/robots/solo8/solo.urdf"),
        ("upkie", "tests/data/robots/upkie/upkie.urdf"),
    ] {
        insta::assert_snapshot!(format!("inspect_{name}"), heelstrike(&["inspect", path]).text());
    }
}

#[test]
fn inspect_shows_everything_if_asked() {
    let cut = heelstrike(&["inspect", A1]).text();
    let whole = heelstrike(&["inspect", A1, "--all"]).text();
    assert!(cut.lines().count() == 40 && cut.ends_with("The rest: --all\n"), "{cut}");
    assert!(whole.lines().count() > 40 && !whole.contains("--all") && !whole.contains(" more lines"), "{whole}");
    // Each line of the short text is in the long one, except for the lines about omitted lines.
    let own = cut.lines().filter(|line| !line.contains(" more lines") && !line.contains("--all"));
    assert!(
        own.clone().count() > 30 && own.clone().all(|line| whole.lines().any(|other| other == line)),
        "{cut}{whole}"
    );
    // Equal shapes of one link are listed once, with their number.
    let shapes = "<collision><geometry><sphere radius='0.1'/></geometry></collision>".repeat(3);
    let file = file("shapes.urdf", urdf::body(1.0, &shapes));
    assert!(heelstrike(&["inspect", &file]).text().contains("feet         3 of body (circle of radius 0.1 m)\n"));
}

#[test]
fn plane_hold_and_base_shape_the_robot() {
    let inspect = |options: &[&str]| result(&[&["inspect", A1], options].concat(), "");
    let yz = inspect(&["--plane", "yz"]);
    assert_eq!((&yz["plane"], &yz["plane_because"]), (&"yz".into(), &"as asked; plane xz would keep 8 joints".into()));
    let names = each(&yz["joints"], "name");
    assert_eq!(names, ["FR_hip_joint", "FL_hip_joint", "RR_hip_joint", "RL_hip_joint"]);
    // The joints' axis is +x and the plane's normal is -x.
    assert!(list(&yz["joints"]).iter().all(|joint| joint["sign"] == -1.0));

    let held = inspect(&["--hold", "FR_calf_joint=-1.5", "--hold", "FL_calf_joint=-1.5", "--base", "fixed"]);
    assert_eq!(list(&held["coordinates"]).len(), 6);
    assert_eq!((&held["base"], &held["base_because"]), (&"fixed".into(), &"as asked".into()));
    let left = json!({"name": "FR_calf_joint", "body": "FR_thigh", "why": "frozen at -1.5 as asked"});
    assert!(list(&held["held"]).contains(&left), "{}", held["held"]);

    let twice = heelstrike(&["inspect", A1, "--hold", "FR_calf_joint=0", "--hold", "FR_calf_joint=1"]).refusal(2);
    assert_eq!(twice, "error: --hold: joint \"FR_calf_joint\" is given twice\n");
    let foot = ["--contact", "FR_calf:0,0,-0.2"];
    let twice = heelstrike(&[&["inspect", A1], &foot[..], &foot].concat()).refusal(2);
    assert_eq!(twice, "error: --contact: foot on link \"FR_calf\" is given twice\n");
    let unknown = heelstrike(&["inspect", A1, "--hold", "FR_calf=0"]).refusal(2);
    let expected = "error: --hold: the robot has no joint named \"FR_calf\"\nhint: did you mean FR_calf_joint?\n";
    assert_eq!(unknown, expected);
}

#[test]
fn a_state_that_names_a_frozen_joint_is_refused() {
    let state = r#"{"position": {"joints": {"FR_hip_joint": 0.1}}, "friction": 1}"#;
    let stderr = heelstrike_reads(&["impact", A1, "-"], state).refusal(1);
    let reason = "joint \"FR_hip_joint\" has no coordinate: frozen at zero, its axis being 90.00 degrees off the plane's normal: \
                  welded into base";
    assert!(stderr.contains(reason), "{stderr}");
    assert!(stderr.ends_with("hint: pose it by --hold FR_hip_joint=VALUE\n"), "{stderr}");
    // A misspelt name is likened to frozen joints, too.
    let stderr = heelstrike_reads(&["impact", A1, "-"], state.replace("FR_hip", "FR_hipp")).refusal(1);
    assert!(stderr.ends_with("hint: did you mean FR_hip_joint?\n"), "{stderr}");
}

#[test]
fn every_command_warns_of_a_robot_that_loses_joints() {
    let [a, b] = ["a", "b"].map(|name| urdf::link(name, 1.0, [0.0; 2], 1.0, ""));
    let joint = "<joint name='j' type='revolute'><origin rpy='0.0872665 0 0'/><axis xyz='0 1 0'/><parent link='a'/>\
                 <child link='b'/></joint>";
    let file = file("tilted.urdf", urdf::robot(&[a, b, joint.to_owned()]));
    let word = "1 of 1 joints that could move is frozen only because its axis is 5.0 degrees off the plane (j); to keep \
                it: straighten the rpy of j";
    let inspect = heelstrike(&["inspect", &file]);
    assert!(inspect.stdout.replace("\n               ", " ").contains(word), "{}", inspect.stdout);
    let impact = heelstrike_reads(&["impact", &file, "-"], r#"{"friction": 1}"#);
    assert_eq!((impact.status, impact.stderr), (0, format!("note: {word}\n")));
}

/// The hips of A1, posed as in a recording, tilt the legs beyond them.
#[test]
fn the_remedy_for_posed_hips_keeps_the_legs() {
    let hips = ["FL_hip_joint=0.08", "FR_hip_joint=-0.08", "RL_hip_joint=0.05", "RR_hip_joint=-0.08"];
    let posed: Vec<&str> =
        ["inspect", A1].into_iter().chain(hips.into_iter().flat_map(|hip| ["--hold", hip])).collect();
    let kept = |more: &[&str]| heelstrike(&[&posed[..], more].concat()).stdout.replace("\n               ", " ");
    let frozen = kept(&[]);
    let remedy =
        "leave FR_hip_joint and the like at zero, or take what they tilt as in the plane by --axis-tolerance 8.8e-2\n";
    assert!(frozen.contains("0 kept") && frozen.contains(remedy), "{frozen}");
    let kept = kept(&["--axis-tolerance", "8.8e-2"]);
    assert!(kept.contains("8 kept"), "{kept}");
}

#[test]
fn the_reduced_robot_is_written_with_every_digit() {
    let robot = result(&["inspect", "urdf/ramone_paper.urdf"], "");
    assert_eq!(robot["plane"], "xz");
    let shank = &robot["bodies"][2];
    assert_eq!((&shank["com"], &shank["links"]), (&json!([0.0, -0.073265]), &json!(["left_shank", "left_foot"])));
    assert_eq!((&robot["joints"][0]["sign"], &robot["feet"][1]["radius"]), (&json!(-1.0), &json!(0.02815)));
}

#[test]
fn a_state_poses_the_robot_in_its_picture() {
    let drawn = |arguments: &[&str], state: &str| {
        let path = place("pose.svg");
        heelstrike_reads(&[&["inspect", WALKER, "--plot", &path], arguments].concat(), state).well();
        read(&path)
    };
    let at = |state: serde_json::Value| drawn(&["--state", "-"], &state.to_string());
    assert_eq!(at(json!({})), drawn(&[], ""));
    // The picture's axes include the base at x = 40 m. With a stance, the stance's lowest point is the origin.
    assert!(at(json!({"position": {"base": {"x": 40}}})).contains(">40.0</text>"));
    let high = json!({"position": {"joints": {"hip": 0.4}}, "stance": "left_leg"});
    let low = json!({"position": {"base": {"pitch": -1.4}, "joints": {"hip": -2.8}}, "stance": "left_leg"});
    let [upright, flat] = [at(high), at(low)].map(|svg| svg.contains(">1.0</text>"));
    assert!(upright && !flat, "the hip is 1 m high, or 0.17 m");
    let refused =
        heelstrike_reads(&["inspect", WALKER, "--plot", &place("pose.svg"), "--state", "-"], "{\"velocity\": 1}");
    assert!(refused.refusal(1).contains("<stdin>:1:2"));
    assert!(heelstrike(&["inspect", WALKER, "--state", "-"]).refusal(2).contains("--plot"));
}
