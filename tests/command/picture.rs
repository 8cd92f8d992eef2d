//! `--plot`: snapshots of pictures of robots and studies, whose bytes are reproducible and few; and the messages where
//! no picture is drawn.
//!
//! The snapshots have one line per element. Look at a changed picture itself before you accept its snapshot.

use super::support::urdf;
use super::{BLOCK, RAMONE, WALKER, file, fs, heelstrike, heelstrike_reads, place, read, walker};
use serde_json::json;
use std::path::Path;

const MINIMALISTIC: [&str; 3] = ["sweep", WALKER, "examples/paper/figures_3_and_6.json"];

/// The largest size of any SVG \[bytes\].
const LARGEST: usize = 500_000;

/// The SVG that the command plots, one element per line.
fn svg(args: &[&str], name: &str) -> String {
    let path = place(&format!("{name}.svg"));
    heelstrike(&[args, &["--plot", &path]].concat()).text();
    let svg = read(&path);
    assert!(svg.len() < LARGEST, "{name}: {} bytes", svg.len());
    svg.replace("><", ">\n<")
}

#[test]
fn robots_outcomes_and_regions_are_drawn() {
    let mut map = walker(json!({
        "alpha": {"from": 0.001, "to": 1.5697, "steps": 2},
        "j": {"from": 0.0, "to": 0.5, "steps": 2},
    }));
    let leg = json!({"inertia": "j", "com": [0, 0, -0.4]});
    map["robot"] = json!({"links": {"left_leg": leg, "right_leg": leg}});
    let map = file("inertia.json", map.to_string());
    for (name, arguments) in [
        // The velocity of a slide that is too slow for an arrow is written as a number.
        ("picture_ramone", &["impact", RAMONE, "examples/ramone.json"][..]),
        ("picture_stairs", &["impact", RAMONE, "examples/stairs.json"]),
        // A velocity arrow along an impulse arrow is drawn next to it.
        ("picture_five_bar", &["impact", "urdf/five_bar.urdf", "examples/five_bar.json"]),
        ("picture_inspect_ramone", &["inspect", RAMONE]),
        ("picture_inspect_a1", &["inspect", "tests/data/robots/a1/a1.urdf"]),
        ("sweep_minimalistic", &MINIMALISTIC),
        ("sweep_ramone_paper", &["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"]),
        ("sweep_explained", &[&MINIMALISTIC[..], &["--explain"]].concat()),
        ("sweep_map", &["sweep", "urdf/pdw.urdf", &map]),
    ] {
        insta::assert_snapshot!(name, svg(arguments, name));
    }
}

#[test]
fn every_robot_can_be_drawn() {
    for robot in ["h1/h1", "acrobot/Acrobot", "cartpole/cartpole", "upkie/upkie", "solo8/solo"] {
        let svg = svg(&["inspect", &format!("tests/data/robots/{robot}.urdf")], &robot.replace('/', "_"));
        assert!(svg.contains("CoG, area by mass"), "{robot}");
    }
}

/// Where a sole lands level, its corners push 1e12 times as hard, in a region too thin to be seen. The panels must
/// still show the impulses elsewhere.
#[test]
fn a_thin_region_hides_no_panel() {
    let robot = urdf::body(0.1, &urdf::collision([0.5, -0.5], "box size=\"0.4 0.1 0.2\""));
    let robot = file("sole.urdf", robot);
    let study = json!({"parameters": {"alpha": {"from": -0.5, "to": 0.7, "steps": 30}}, "state": {"place": "lowest",
        "friction": "infinite", "position": {"base": {"pitch": "alpha"}}, "velocity": {"base": {"x": 0.3, "z": -1}}}});
    let svg = svg(&["sweep", &robot, &file("sole.json", study.to_string())], "sole");
    assert!(svg.matches("impulse [N s]").count() >= 2, "{svg}");
}

/// A block slides only up to a friction of 0.57.
#[test]
fn what_is_zero_but_in_a_thin_region_is_named_so() {
    for (most, except) in [(1, "impulse [N s]"), (1000, "zero in every outcome, except in regions too thin to be seen")]
    {
        let study = json!({"parameters": {"mu": {"from": 0, "to": most, "steps": 20}}, "state": {"friction": "mu",
            "place": "lowest", "velocity": {"base": {"x": 0.1, "z": -1}}}});
        let svg = svg(&["sweep", BLOCK, &file("thin.json", study.to_string())], "thin");
        assert!(svg.contains(except) && svg.contains("is zero in every outcome") == (most > 1), "{svg}");
    }
}

#[test]
fn a_robot_in_the_air_is_drawn_above_the_ground() {
    let state = r#"{"position": {"base": {"z": 0.8}}, "velocity": {"base": {"z": -1}}, "friction": 1}"#;
    let path = place("air.svg");
    heelstrike_reads(&["impact", RAMONE, "-", "--plot", &path], state).well();
    let svg = read(&path);
    assert!(svg.contains("nothing changes") && svg.contains(r##"fill="#e4e4e4""##), "{svg}");
    assert!(!svg.contains("velocity"), "no arrows: {svg}");
}

#[test]
fn refused_and_several_states_are_not_drawn() {
    let path = place("none.svg");
    let plot = |states: &str| heelstrike_reads(&["impact", RAMONE, "-", "--plot", &path], states);
    let run = plot(r#"{"position": {"base": {"z": -1}}, "friction": 1}"#);
    assert_eq!(run.status, 1);
    assert!(run.stderr.ends_with("note: no picture is drawn of a state that is refused\n"), "{}", run.stderr);
    let several =
        "error: --plot: a picture is drawn of one state, and several are given\nhint: give the states one by one\n";
    assert_eq!(plot(r#"{"friction": 1} {"friction": 2}"#).refusal(2), several);
    assert!(!Path::new(&path).exists());
}

#[test]
fn a_picture_does_not_replace_what_is_read() {
    for (command, name, content) in
        [(&["inspect"][..], "robot.svg", read("urdf/block.urdf")), (&["sweep", WALKER], "study.svg", "{}".to_owned())]
    {
        let path = file(name, &content);
        heelstrike(&[command, &[&path, "--plot", &path]].concat()).refusal_with(1, "is an input of this command");
        assert_eq!(read(&path), content);
    }
}

#[test]
fn a_picture_and_the_results_are_two_files() {
    let (name, again) = (&*place("both.svg"), &*place("./both.svg"));
    for command in [
        &["inspect", "urdf/block.urdf", "--format", "json"][..],
        &["impact", RAMONE, "examples/ramone.json", "--format", "json"],
        &["sweep", WALKER, "examples/paper/figure_7.json", "--format", "json"],
        &["batch", RAMONE, "examples/ramone.json", "--output-format", "ndjson"],
        &["accuracy", "--case", "massless", "--time", "0", "--format", "json"],
    ] {
        let stderr = heelstrike(&[command, &["-o", name, "--plot", again]].concat()).refusal(2);
        let expected = "error: --plot: results and picture would be written to the same file\nhint: name two files\n";
        assert_eq!(stderr, expected, "{command:?}");
    }
    let run = heelstrike(&["batch", RAMONE, "-", "--summary", name, "--plot", again]);
    assert!(run.status == 2 && run.stderr.contains("summary and picture"), "{}", run.stderr);
    assert!(!Path::new(name).exists());
}

#[test]
fn friction_is_a_line_if_all_contacts_have_the_same() {
    let walk = read("examples/gait/ramone_walk.ndjson");
    let given = "\"friction\": 0.6";
    let with = |mu: &str| given.replace("0.6", mu);
    for (name, states, is_drawn) in [
        ("one", walk.clone(), true),
        ("mixed", walk.replacen(given, &with("0.7"), 1), false),
        ("far", walk.replace(given, &with("600")), false),
        ("none", walk.replace(given, &with("0")), false),
        ("infinite", walk.replace(given, &with("\"infinite\"")), false),
    ] {
        let states = file(&format!("given_{name}.ndjson"), states);
        let picture = svg(&["batch", RAMONE, &states, "--quiet"], &format!("given_{name}"));
        let legend = picture.lines().filter(|line| line.contains(">friction ") && !line.contains(">friction needed"));
        assert_eq!(legend.count(), usize::from(is_drawn), "{name}");
    }
}

#[test]
fn an_unwritable_file_is_refused_before_the_work() {
    let path = &place("no_such_directory/x.svg");
    for command in [
        &["batch", RAMONE, "examples/gait/ramone_walk.ndjson", "--plot"][..],
        &["batch", RAMONE, "examples/gait/ramone_walk.ndjson", "--summary"],
        &["sweep", WALKER, "examples/paper/figure_7.json", "--plot"],
        &["sweep", WALKER, "examples/paper/figure_7.json", "-o"],
    ] {
        let stderr = heelstrike(&[command, &[path]].concat()).refusal(1);
        let start = "error: the output cannot be written: ";
        assert!(stderr.starts_with(start) && stderr.contains("no_such_directory"), "{stderr}");
    }
}

#[test]
fn the_ending_names_the_form_of_a_picture() {
    let accuracy = &["accuracy", RAMONE, "examples/ramone.json", "--time", "0"];
    for (arguments, name, start) in [
        (&["inspect", "urdf/five_bar.urdf"][..], "five_bar.png", &b"\x89PNG\r\n\x1a\n"[..]),
        (accuracy, "accuracy.png", b"\x89PNG\r\n\x1a\n"),
        (accuracy, "accuracy.svg", b"<svg"),
    ] {
        let path = place(name);
        heelstrike(&[arguments, &["--plot", &path]].concat()).well();
        let picture = fs::read(path).expect("a picture");
        assert!(picture.starts_with(start), "{name}");
        assert_eq!(picture.windows(4).any(|chunk| chunk == b"pHYs"), name.ends_with("png"), "{name} has its density");
    }
}

#[test]
fn a_picture_has_the_same_bytes_for_any_threads() {
    let with = |threads: &'static str| svg(&[&MINIMALISTIC[..], &["--threads", threads]].concat(), threads);
    assert_eq!(with("1"), with("5"));
}

#[test]
fn the_text_still_goes_to_standard_output() {
    let path = place("beside.svg");
    let plotted = heelstrike(&[&MINIMALISTIC[..], &["--plot", &path]].concat());
    assert_eq!(plotted.stdout, heelstrike(&MINIMALISTIC).stdout);
    assert!(Path::new(&path).exists());
}

#[test]
fn what_is_refused_is_gray_and_explained() {
    let mut refused = walker(json!({"alpha": {"from": 0.2, "to": 1.2, "steps": 20}}));
    refused["state"]["restitution"] = json!("alpha - 0.4");
    let refused = file("refused.json", refused.to_string());
    let path = place("refused.svg");
    let run = heelstrike(&["sweep", WALKER, &refused, "--plot", &path]);
    assert_eq!(run.status, 1, "{}", run.stderr);
    let svg = read(&path);
    assert!(svg.contains(">A: refused: restitution must be between 0 and 1") && svg.contains("#e4e4e4"), "{svg}");
}

#[test]
fn only_regions_are_drawn_where_nothing_touches() {
    let air = file(
        "air.json",
        r#"{"parameters": {"h": {"from": 5, "to": 6, "steps": 3}}, "state": {"position": {"base": {"z": "h"}, "joints": {"hip": 0.5}}, "friction": 1}}"#,
    );
    let svg = svg(&["sweep", WALKER, &air], "sweep_air");
    let texts = ["A: nothing touches the ground", "h [m]", "impulse [N s]"];
    assert_eq!(texts.map(|text| svg.matches(&format!(">{text}<")).count()), [1, 1, 0]);
}

#[test]
fn touchdowns_are_marks_by_foot_and_mode() {
    let states: Vec<String> = [0.4, 1.4]
        .map(|alpha: f64| {
            let position = json!({"base": {"pitch": -alpha}, "joints": {"hip": -2.0 * alpha}});
            let velocity = json!({"base": {"pitch": -1}});
            json!({"stance": "left_leg", "position": position, "velocity": velocity, "friction": 5}).to_string()
        })
        .to_vec();
    let states = file("touchdowns.ndjson", states.join("\n"));
    let path = place("touchdowns.svg");
    assert_eq!(heelstrike(&["batch", WALKER, &states, "--plot", &path]).status, 0);
    let svg = read(&path);
    // Discs are feet that stick. The first state has one outcome, the second three; the counts are of margins, of
    // friction needed (of which two coincide) and of the key.
    let discs = |color: &str| svg.matches(&format!(r##"r="4" fill="{color}"/>"##)).count();
    assert_eq!([discs("#0072b2"), discs("#d55e00")], [1 + 1 + 1, 4 + 3 + 1], "{svg}");
    for text in ["minimalistic: 2 of 2 states have impulses", "margin", "slides backward", "lifts off"] {
        assert!(svg.contains(&format!(">{text}<")), "{text}: {svg}");
    }
}

#[test]
fn contacts_at_one_place_are_told_apart() {
    let feet = ["FL", "FR", "RL", "RR"];
    let joints =
        feet.map(|leg| [(format!("{leg}_thigh_joint"), json!(0.8)), (format!("{leg}_calf_joint"), json!(-1.6))]);
    let joints: serde_json::Map<_, _> = joints.into_iter().flatten().collect();
    // The speed of the front left leg varies, its place does not.
    let drawn = |left: f64| {
        let velocity = json!({"base": {"x": 0.5, "z": -0.6}, "joints": {"FL_calf_joint": left}});
        let position = json!({"joints": joints});
        let state = json!({"friction": 0.7, "place": "lowest", "position": position, "velocity": velocity});
        let state = file("side.json", state.to_string());
        svg(&["impact", "tests/data/robots/a1/a1.urdf", &state], "side")
    };
    let count = |svg: &str, text: &str| svg.matches(&format!(">{text}<")).count();
    let alike = drawn(0.0);
    assert_eq!(
        ["FR_foot, FL_foot", "RR_foot, RL_foot", "2 \u{d7}"].map(|text| count(&alike, text)),
        [1, 1, 2],
        "{alike}"
    );
    // FL_foot is named at its place and at the tips of the arrows that differ.
    let apart = drawn(10.0);
    assert_eq!(["FL_foot", "FR_foot", "2 \u{d7}"].map(|text| count(&apart, text)), [2, 1, 1], "{apart}");
}

#[test]
fn many_contacts_at_one_place_are_named_in_short() {
    let points = vec![json!({"link": "block", "offset": [0, 0, 0]}); 10];
    let state = json!({"friction": 0.5, "contacts": points, "velocity": {"base": {"z": -1}}});
    let svg = svg(&["impact", BLOCK, &file("ten.json", state.to_string())], "ten");
    assert!(svg.contains(">block/0, block/1, block/2, block/3, block/4, block/5 and 4 more<"), "{svg}");
}

/// A1 with four feet and four points of its calves on the ground.
#[test]
fn curves_of_eight_contacts_fit_on_a_page() {
    let contact = |link: &str, z: f64| json!({"link": link, "offset": [z, 0, 0]});
    let legs = ["FR", "FL", "RR", "RL"];
    let contacts =
        [0.0, 0.02].map(|z| legs.map(|leg| contact(&format!("{leg}_{}", if z > 0.0 { "calf" } else { "foot" }), z)));
    let study = json!({"parameters": {"fast": {"from": -0.3, "to": 0.3, "steps": 3}}, "state": {"position": {
        "base": {"z": 0.3}, "joints": {"FR_thigh_joint": 0.7, "FR_calf_joint": -1.5, "RL_thigh_joint": 0.8}},
        "velocity": {"base": {"x": "fast", "z": -1}}, "contacts": contacts.concat(), "friction": 0}});
    let study = file("eight.json", study.to_string());
    let svg = svg(&["sweep", "tests/data/robots/a1/a1.urdf", &study], "eight");
    let size = |name: &str| {
        svg.split(&format!("{name}=\"")).nth(1).and_then(|rest| rest.split('"').next()?.parse::<f64>().ok())
    };
    let (width, height) = (size("width").expect("a width"), size("height").expect("a height"));
    assert!(width < 1400.0 && height < 1.4 * width, "{width} by {height}");
    assert!(legs.iter().all(|leg| svg.contains(&format!(">{leg}_foot<")) && svg.contains(&format!(">{leg}_calf<"))));
}

#[test]
fn a_mirror_reverses_what_is_forward() {
    let mirrored = svg(&["impact", RAMONE, "examples/ramone.json", "--mirror"], "mirrored");
    assert!(mirrored.contains("left_foot slides backward, right_foot sticks"), "{mirrored}");
    assert!(mirrored.contains("(mirrored: forward is \u{2212}x)<"), "{mirrored}");
    let sweep = ["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"];
    let [ahead, behind] = [svg(&sweep, "ahead"), svg(&[&sweep[..], &["--mirror"]].concat(), "behind")];
    let [forward, backward] = ["B, E: left_foot slides forward", "B, E: left_foot slides backward"];
    assert!(ahead.contains(forward) && behind.contains(backward) && !behind.contains(forward));
    // The mirrored slide is drawn below zero.
    assert!(ahead.contains(">10<") && behind.contains(">\u{2212}5<") && !behind.contains(">10<"));
    assert_eq!(heelstrike(&["impact", RAMONE, "examples/ramone.json", "--mirror"]).status, 2, "it needs a picture");
}
