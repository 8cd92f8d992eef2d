//! `sweep --plot`: pictures of studies as snapshots, the same bytes for any number of threads, with the text on
//! standard output as ever.
//!
//! The snapshots have a line per element. Look at a changed picture itself before its snapshot is accepted.

use std::path::Path;

use super::picture::svg;
use super::{file, heelstrike, place};

const MINIMALISTIC: [&str; 3] = ["sweep", "urdf/minimalistic.urdf", "examples/paper/figures_3_and_6.json"];

/// How often a text stands in the picture.
fn count(svg: &str, text: &str) -> usize {
    svg.matches(&format!(">{text}<")).count()
}

#[test]
fn velocities_and_impulses_are_drawn_by_region() {
    let svg = svg(&MINIMALISTIC, "sweep_minimalistic");
    for (text, times) in [("A", 1), ("D", 1), ("velocity after [m/s]", 1), ("impulse [N s]", 2), ("α [rad]", 1)] {
        assert_eq!(count(&svg, text), times, "{text}");
    }
    assert_eq!(count(&svg, "velocity after is zero in every outcome"), 1, "the leading foot sticks");
    assert_eq!(count(&svg, "A, D: left_leg lifts off, right_leg sticks"), 1);
    insta::assert_snapshot!("sweep_minimalistic", svg);
}

#[test]
fn every_outcome_of_the_paper_s_ramone_has_its_own_dashes() {
    let svg = svg(&["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"], "sweep_ramone");
    for words in ["A, E: left_foot lifts off", "B, E: left_foot slides forward", "C, E: left_foot sticks"] {
        assert_eq!(count(&svg, &format!("{words}, right_foot sticks")), 1, "{words}");
    }
    insta::assert_snapshot!("sweep_ramone_paper", svg);
}

#[test]
fn beta_and_gamma_are_drawn_where_they_are_asked_for() {
    let svg = svg(&[&MINIMALISTIC[..], &["--explain"]].concat(), "sweep_explained");
    for (text, times) in [("angle [rad]", 2), ("slides", 2), ("all three", 2), ("γ", 1)] {
        assert_eq!(count(&svg, text), times, "{text}");
    }
    insta::assert_snapshot!("sweep_explained", svg);
}

#[test]
fn two_parameters_make_a_map() {
    let map = file(
        "inertia.json",
        r#"{
            "parameters": {"alpha": {"from": 0.001, "to": 1.5697, "steps": 2}, "j": {"from": 0.0, "to": 0.5, "steps": 2}},
            "robot": {"links": {"left_leg": {"inertia": "j", "com": [0, 0, -0.4]}, "right_leg": {"inertia": "j", "com": [0, 0, -0.4]}}},
            "state": {
                "position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}},
                "velocity": {"base": {"pitch": -1.0}}, "stance": "left_leg", "friction": "infinite"
            }
        }"#,
    );
    let svg = svg(&["sweep", "urdf/pdw.urdf", &map], "sweep_map");
    for text in
        ["α [rad]", "j [kg m²]", "A: left_leg lifts off, right_leg sticks", "or left_leg sticks, right_leg sticks"]
    {
        assert_eq!(count(&svg, text), 1, "{text}");
    }
    insta::assert_snapshot!("sweep_map", svg);
}

#[test]
fn a_picture_has_the_same_bytes_for_any_number_of_threads() {
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
fn what_is_refused_is_grey_and_told() {
    let refused = file(
        "refused.json",
        r#"{
            "parameters": {"alpha": {"from": 0.2, "to": 1.2, "steps": 20}},
            "state": {
                "position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}},
                "velocity": {"base": {"pitch": -1.0}}, "stance": "left_leg", "friction": "infinite",
                "restitution": "alpha - 0.4"
            }
        }"#,
    );
    let path = place("refused.svg");
    let run = heelstrike(&["sweep", "urdf/minimalistic.urdf", &refused, "--plot", &path]);
    assert_eq!(run.status, 1, "{}", run.stderr);
    let svg = std::fs::read_to_string(path).expect("an SVG");
    assert!(svg.contains(">A: refused: restitution must be between 0 and 1"), "{svg}");
    assert!(svg.contains("#e4e4e4"));
}

#[test]
fn where_nothing_touches_the_regions_alone_are_drawn() {
    let air = file(
        "air.json",
        r#"{"parameters": {"h": {"from": 5, "to": 6, "steps": 3}}, "state": {"position": {"base": {"z": "h"}, "joints": {"hip": 0.5}}, "friction": 1}}"#,
    );
    let svg = svg(&["sweep", "urdf/minimalistic.urdf", &air], "sweep_air");
    assert_eq!((count(&svg, "A: nothing touches the ground"), count(&svg, "h [m]")), (1, 1));
    assert_eq!(count(&svg, "impulse [N s]"), 0);
}

#[test]
fn pictures_overwrite_no_input_and_have_a_known_ending() {
    let run = heelstrike(&[&MINIMALISTIC[..], &["--plot", "picture.pdf"]].concat());
    assert_eq!((run.status, run.stdout.as_str()), (2, ""));
    let own = file("own.svg", "{}");
    let run = heelstrike(&["sweep", "urdf/minimalistic.urdf", &own, "--plot", &own]);
    assert_eq!(run.status, 1);
    assert_eq!(std::fs::read_to_string(own).expect("a file"), "{}");
}
