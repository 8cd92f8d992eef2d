//! `impact --plot` and `inspect --plot`: pictures of robots as snapshots, always the same bytes and never large; what
//! is not drawn and why.
//!
//! The snapshots have a line per element. Look at a changed picture itself before its snapshot is accepted.

use super::{Run, heelstrike, heelstrike_reads, place};
use std::path::Path;

/// No SVG is larger \[bytes\].
const LARGEST: usize = 500_000;

fn plotted(args: &[&str], name: &str) -> (Run, String) {
    let path = place(name);
    let run = heelstrike(&[args, &["--plot", &path]].concat());
    (run, path)
}

/// The SVG, drawn twice.
pub(super) fn svg(args: &[&str], name: &str) -> String {
    let drawn = ["a", "b"].map(|time| {
        let (run, path) = plotted(args, &format!("{name}_{time}.svg"));
        assert_eq!((run.status, run.stderr.as_str()), (0, ""));
        std::fs::read_to_string(path).expect("an SVG")
    });
    let [svg, again] = drawn;
    assert_eq!(svg, again);
    assert!(svg.len() < LARGEST, "{} bytes", svg.len());
    svg.replace("><", ">\n<")
}

#[test]
fn an_outcome_is_drawn_with_its_arrows() {
    insta::assert_snapshot!("picture_ramone", svg(&["impact", "urdf/ramone.urdf", "examples/ramone.json"], "ramone"));
}

#[test]
fn outcomes_stand_side_by_side() {
    let svg = svg(&["impact", "urdf/minimalistic.urdf", "examples/minimalistic.json"], "minimalistic");
    for title in ["1: left_leg lifts off", "2: left_leg sticks", "3: left_leg slides forward"] {
        assert!(svg.contains(title), "{title}");
    }
    insta::assert_snapshot!("picture_minimalistic", svg);
}

#[test]
fn a_profile_is_drawn_where_the_robot_is() {
    insta::assert_snapshot!("picture_stairs", svg(&["impact", "urdf/ramone.urdf", "examples/stairs.json"], "stairs"));
}

#[test]
fn loops_are_drawn_closed() {
    insta::assert_snapshot!(
        "picture_five_bar",
        svg(&["impact", "urdf/five_bar.urdf", "examples/five_bar.json"], "loop")
    );
}

#[test]
fn a_robot_is_drawn_with_its_names() {
    insta::assert_snapshot!("picture_inspect_ramone", svg(&["inspect", "urdf/ramone.urdf"], "inspect_ramone"));
    insta::assert_snapshot!("picture_inspect_a1", svg(&["inspect", "tests/data/robots/a1/a1.urdf"], "inspect_a1"));
}

#[test]
fn every_robot_can_be_drawn() {
    let robots = ["h1/h1", "acrobot/Acrobot", "cartpole/cartpole", "upkie/upkie", "solo8/solo"];
    for robot in robots {
        let path = format!("tests/data/robots/{robot}.urdf");
        let name = robot.replace('/', "_");
        let svg = svg(&["inspect", &path], &name);
        assert!(svg.contains("CoG, its area by mass"), "{robot}");
    }
}

#[test]
fn a_robot_in_the_air_has_the_ground_below_it_and_no_arrows() {
    let state = r#"{"position": {"base": {"z": 0.8}}, "velocity": {"base": {"z": -1}}, "friction": 1}"#;
    let path = place("air.svg");
    let run = heelstrike_reads(&["impact", "urdf/ramone.urdf", "-", "--plot", &path], state);
    assert_eq!(run.status, 0, "{}", run.stderr);
    let svg = std::fs::read_to_string(path).expect("an SVG");
    assert!(svg.contains("nothing changes"), "{svg}");
    assert!(svg.contains(r##"fill="#e4e4e4""##), "{svg}");
    assert!(!svg.contains("velocity"), "{svg}");
}

#[test]
fn of_a_refused_state_nothing_is_drawn() {
    let path = place("refused.svg");
    let args = ["impact", "urdf/ramone.urdf", "-", "--plot", &path];
    let run = heelstrike_reads(&args, r#"{"position": {"base": {"z": -1}}, "friction": 1}"#);
    assert_eq!(run.status, 1);
    assert!(run.stderr.ends_with("note: no picture is drawn of a state that is refused\n"), "{}", run.stderr);
    assert!(!Path::new(&path).exists());
}

#[test]
fn of_several_states_none_is_answered_where_a_picture_is_asked_for() {
    let path = place("several.svg");
    let args = ["impact", "urdf/ramone.urdf", "-", "--plot", &path];
    let run = heelstrike_reads(&args, r#"{"friction": 1} {"friction": 2}"#);
    assert_eq!((run.status, run.stdout.as_str()), (2, ""));
    assert_eq!(
        run.stderr,
        "error: --plot: a picture is drawn of one state, and several are given\nhint: give the states one by one\n"
    );
    assert!(!Path::new(&path).exists());
}

#[test]
fn a_picture_does_not_replace_what_is_read() {
    let path = place("robot.svg");
    std::fs::copy("urdf/block.urdf", &path).expect("a copy");
    let robot = path.as_str();
    let run = heelstrike(&["inspect", robot, "--plot", robot]);
    assert_eq!(run.status, 1);
    assert!(run.stderr.contains("is an input of this command"), "{}", run.stderr);
    assert_eq!(std::fs::read(path).expect("the robot"), std::fs::read("urdf/block.urdf").expect("the robot"));
}

#[test]
fn a_picture_and_the_results_are_two_files() {
    let (name, again) = (place("both.svg"), place("./both.svg"));
    let (name, again) = (name.as_str(), again.as_str());
    for command in [
        &["inspect", "urdf/block.urdf"][..],
        &["impact", "urdf/ramone.urdf", "examples/ramone.json"],
        &["sweep", "urdf/minimalistic.urdf", "examples/paper/figure_7.json"],
        &["batch", "urdf/ramone.urdf", "examples/ramone.json"],
        &["accuracy", "--case", "massless", "--time", "0"],
    ] {
        let run = heelstrike(&[command, &["-o", name, "--plot", again]].concat());
        let told = "error: --plot: results and picture would be written to the same file\nhint: name two files\n";
        assert_eq!((run.status, run.stdout.as_str(), run.stderr.as_str()), (2, "", told), "{command:?}");
    }
    let run = heelstrike(&["batch", "urdf/ramone.urdf", "-", "--summary", name, "--plot", again]);
    assert!(run.status == 2 && run.stderr.contains("summary and picture"), "{}", run.stderr);
    assert!(!Path::new(name).exists());
}

#[test]
fn a_file_that_cannot_be_written_is_told_before_the_work() {
    let path = &place("no_such_directory/x.svg");
    for command in [
        &["batch", "urdf/ramone.urdf", "examples/gait/ramone_walk.ndjson", "--plot"][..],
        &["sweep", "urdf/minimalistic.urdf", "examples/paper/figure_7.json", "--plot"],
        &["sweep", "urdf/minimalistic.urdf", "examples/paper/figure_7.json", "-o"],
    ] {
        let run = heelstrike(&[command, &[path]].concat());
        assert_eq!((run.status, run.stdout.as_str()), (1, ""), "{command:?}");
        assert!(run.stderr.starts_with("error: the output cannot be written: "), "{}", run.stderr);
        assert!(run.stderr.contains("no_such_directory"), "{}", run.stderr);
    }
}

#[test]
fn a_png_is_drawn_as_well() {
    let (run, path) = plotted(&["inspect", "urdf/five_bar.urdf"], "five_bar.png");
    assert_eq!(run.status, 0, "{}", run.stderr);
    assert_eq!(&std::fs::read(path).expect("a PNG")[..8], b"\x89PNG\r\n\x1a\n");
}
