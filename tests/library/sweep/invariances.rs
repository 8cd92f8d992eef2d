//! The same study written another way has the same regions.

use crate::sweep::command::{RANGE, Sweep, kneed, run, sweep};
use serde_json::{Value, json};

const ROBOT: &str = "urdf/ramone_paper.urdf";

/// Asserts that both have the same regions; `place` maps places of `other` to the parameter of `one`, of this range.
fn assert_same(one: &Sweep, other: &Sweep, place: impl Fn(f64) -> f64, range: f64) {
    assert_eq!(one.regions.len(), other.regions.len());
    for (one, other) in one.regions.iter().zip(&other.regions) {
        assert_eq!((&one.letter, &one.contacts, one.set()), (&other.letter, &other.contacts, other.set()));
        for (at, there) in [(one.from, other.from), (one.to, other.to)] {
            assert!((at - place(there)).abs() <= 4e-12 * range, "{at} instead of {}", place(there));
        }
    }
    for (one, other) in one.borders.iter().zip(&other.borders) {
        assert_eq!(one.turns, other.turns);
    }
}

/// The study with a word replaced everywhere in its text.
fn renamed(study: &Value, word: &str, by: &str) -> Value {
    serde_json::from_str(&study.to_string().replace(word, by)).expect("JSON")
}

#[test]
fn a_rescaled_parameter_has_the_same_regions() {
    let one = sweep(ROBOT, &kneed());
    for factor in [1e-6, 0.3, 1e6] {
        let mut study = renamed(&kneed(), "alpha", "(factor*beta)");
        let [from, to] = RANGE.map(|end| end / factor);
        study["parameters"] = json!({"beta": {"from": from, "to": to, "steps": 50}});
        study["constants"]["factor"] = json!(factor);
        assert_same(&one, &sweep(ROBOT, &study), |beta| factor * beta, 1.57);
    }
}

#[test]
fn a_reversed_parameter_has_the_regions_reversed() {
    let mut study = renamed(&kneed(), "alpha", "(-beta)");
    let [from, to] = RANGE;
    study["parameters"] = json!({"beta": {"from": -to, "to": -from, "steps": 50}});
    let (one, other) = (sweep(ROBOT, &kneed()), sweep(ROBOT, &study));
    assert_eq!(one.regions.len(), other.regions.len());
    for (one, other) in one.regions.iter().zip(other.regions.iter().rev()) {
        assert_eq!(one.set(), other.set());
        assert!((one.from + other.to).abs() < 4e-12 && (one.to + other.from).abs() < 4e-12);
    }
    for (one, other) in one.borders.iter().zip(other.borders.iter().rev()) {
        let [mut here, mut there] = [one, other].map(|border| border.turns.clone());
        there.iter_mut().for_each(|turn| turn.valid = if turn.valid == "below" { "above" } else { "below" }.to_owned());
        here.sort();
        there.sort();
        assert_eq!(here, there);
    }
}

#[test]
fn threads_do_not_change_a_byte() {
    // JSON has everything that text and tables are written from.
    let with = |threads: &str| run(ROBOT, &kneed(), &["--format", "json", "--threads", threads]).well().stdout;
    assert_eq!(with("1"), with("4"));
}
