//! `sweep --plot`: pictures of studies as snapshots, the same bytes for any number of threads, with the text on
//! standard output as ever.
//!
//! The snapshots have a line per element. Look at a changed picture itself before its snapshot is accepted.

use std::path::Path;

use super::picture::svg;
use super::{WALKER, file, heelstrike, place, read, walker};
use serde_json::json;

const MINIMALISTIC: [&str; 3] = ["sweep", WALKER, "examples/paper/figures_3_and_6.json"];

/// How often a text stands in the picture.
fn count(svg: &str, text: &str) -> usize {
    svg.matches(&format!(">{text}<")).count()
}

#[test]
fn every_region_and_outcome_is_drawn() {
    let mut map = walker(json!({
        "alpha": {"from": 0.001, "to": 1.5697, "steps": 2},
        "j": {"from": 0.0, "to": 0.5, "steps": 2},
    }));
    let leg = json!({"inertia": "j", "com": [0, 0, -0.4]});
    map["robot"] = json!({"links": {"left_leg": leg, "right_leg": leg}});
    let map = file("inertia.json", map.to_string());
    for (name, arguments) in [
        ("sweep_minimalistic", &MINIMALISTIC[..]),
        ("sweep_ramone_paper", &["sweep", "urdf/ramone_paper.urdf", "examples/paper/table_1.json"]),
        ("sweep_explained", &[&MINIMALISTIC[..], &["--explain"]].concat()),
        ("sweep_map", &["sweep", "urdf/pdw.urdf", &map]),
    ] {
        insta::assert_snapshot!(name, svg(arguments, name));
    }
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
    assert_eq!(["A: nothing touches the ground", "h [m]", "impulse [N s]"].map(|text| count(&svg, text)), [1, 1, 0]);
}

#[test]
fn pictures_overwrite_no_input_and_have_a_known_ending() {
    heelstrike(&[&MINIMALISTIC[..], &["--plot", "picture.pdf"]].concat()).refusal(2);
    let own = file("own.svg", "{}");
    assert_eq!(heelstrike(&["sweep", WALKER, &own, "--plot", &own]).status, 1);
    assert_eq!(read(&own), "{}");
}
