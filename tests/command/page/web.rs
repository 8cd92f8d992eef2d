//! The live page: its answers equal those of the tool, and how it behaves in a browser.
//!
//! `web/build` makes the page and HEELSTRIKE_PAGE names it; without a page these tests print a note and pass.

use super::browser::found;
use super::{BLOCK, RAMONE, WALKER, list};
use crate::support::random::Random;
use crate::{heelstrike_reads, parsed, place, read};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_6;
use std::path::PathBuf;

/// The environment variable that names the built page.
const VARIABLE: &str = "HEELSTRIKE_PAGE";

const WINDOW: (u32, u32) = (1280, 800);

/// Number of random states per robot.
const STATES: usize = 334;

/// A copy of the built page for the running test; `None`, with a note, if there is no page.
fn page() -> Option<PathBuf> {
    let Some(built) = std::env::var_os(VARIABLE).filter(|name| !name.is_empty()) else {
        eprintln!("skipped: {VARIABLE} names no page; `web/build FILE.html` makes one");
        return None;
    };
    let copy = place("live.html");
    std::fs::copy(&built, &copy).unwrap_or_else(|error| panic!("{}: {error}", built.display()));
    Some(copy.into())
}

/// Runs a script once the page's core is ready, and returns what it found; `None` without a page or browser.
fn driven(window: (u32, u32), script: &str) -> Option<Value> {
    let script = format!("ready.then(async (ask) => {{{script}}}).catch((error) => found({{ failed: error.stack }}));");
    let found = found(&page()?, window, &script)?;
    assert_eq!(found["failed"], Value::Null);
    Some(found)
}

/// A random state that mostly touches the ground in one or two points, often with extreme values.
fn state(random: &mut Random, robot: &str) -> Value {
    let speeds = |random: &mut Random, most: f64| match random.whole(0, 3) {
        0 => 0.0,
        1 => random.pick(&[-1.0, 1.0]),
        _ => random.between(-most, most),
    };
    let any = [random.between(0.0, 3.0), random.between(0.05, 1.5), random.uniform()];
    let friction = random.pick(&[json!(0), json!(0.3), json!(1), json!("infinite"), json!(any[0])]);
    let mut state = json!({"friction": friction});
    let joints: &[&str] = match robot {
        RAMONE => &["left_hip", "left_knee", "right_hip", "right_knee"],
        WALKER => &["hip"],
        _ => &[],
    };
    let alpha = random.pick(&[0.5, 1.4, FRAC_PI_6, any[1]]);
    let (pitch, own) = match robot {
        RAMONE => {
            let pose = parsed(&read("examples/ramone.json"));
            (0.0, joints.iter().map(|joint| pose["position"]["joints"][joint].as_f64().expect("an angle")).collect())
        }
        WALKER => (-alpha, vec![-2.0 * alpha]),
        _ => (0.0, Vec::new()),
    };
    // In this pose both feet touch; an offset of the pitch leaves one.
    let off = if random.once_in(3) { random.between(-0.5, 0.5) } else { 0.0 };
    state["position"]["base"]["pitch"] = json!(pitch + off);
    for (joint, angle) in joints.iter().zip(own) {
        state["position"]["joints"][joint] = json!(angle);
    }
    for joint in joints {
        state["velocity"]["joints"][joint] = json!(speeds(random, 5.0));
    }
    state["velocity"]["base"]["pitch"] = json!(speeds(random, 5.0));
    match (random.whole(0, 4), robot) {
        (0, _) => state["position"]["base"]["z"] = json!(random.between(-0.1, 1.0)),
        (1 | 2, WALKER) => state["stance"] = json!("left_leg"),
        (1 | 2, RAMONE) => state["stance"] = json!("left_foot"),
        _ => state["place"] = json!("lowest"),
    }
    if state.get("stance").is_none() {
        state["velocity"]["base"]["x"] = json!(speeds(random, 2.0));
        state["velocity"]["base"]["z"] = json!(speeds(random, 2.0));
    }
    if random.once_in(4) {
        state["restitution"] = json!(random.pick(&[0.3, 1.0, any[2]]));
    }
    if random.once_in(6) {
        state["ground"]["slope"] = json!(random.between(-0.3, 0.3));
    }
    if random.once_in(40) {
        state["wrong"] = json!(1);
    }
    state
}

#[test]
fn answers_of_the_page_are_those_of_the_tool() {
    let mut verdicts: BTreeMap<String, usize> = BTreeMap::new();
    for (seed, robot) in [RAMONE, WALKER, BLOCK].into_iter().enumerate() {
        let mut random = Random::new(19 + seed as u64);
        let states: Vec<Value> = (0..STATES).map(|_| state(&mut random, robot)).collect();
        let script = format!(
            "const [urdf, states] = [{}, {}];{}",
            json!(read(robot)),
            // The states are texts, so that the browser neither parses nor prints their numbers.
            json!(states.iter().map(Value::to_string).collect::<Vec<_>>()),
            include_str!("scripts/states.js")
        );
        let Some(found) = driven(WINDOW, &script) else { return };
        let lines: String = states.iter().map(|state| format!("{state}\n")).collect();
        let native = heelstrike_reads(&["impact", robot, "-", "--format", "json"], lines);
        let answers = list(&found["results"]);
        assert_eq!(answers.len(), STATES);
        for ((state, answer), line) in states.iter().zip(answers).zip(native.stdout.lines()) {
            let (answer, result) = (answer.as_str().expect("a text"), parsed(line));
            match result.get("error") {
                // The page's answers have no line numbers.
                Some(error) if result.get("verdict").is_none() => {
                    assert_eq!(parsed(answer)["error"], *error, "{state}")
                }
                _ => assert_eq!(answer, line, "{robot}: {state}"),
            }
            *verdicts.entry(result["verdict"].as_str().unwrap_or("refused").to_owned()).or_default() += 1;
        }
        eprintln!("{robot}: {} ms for each answer", found["each"]);
    }
    for (verdict, least) in [("ambiguous", 20), ("unique", 300), ("no_impact", 20), ("no_contact", 20), ("refused", 20)]
    {
        assert!(verdicts.get(verdict).is_some_and(|count| *count >= least), "{verdict}: {verdicts:?}");
    }
}

#[test]
fn the_page_follows_what_its_reader_does() {
    let Some(found) =
        driven(WINDOW, &format!("const block = {};{}", json!(read(BLOCK)), include_str!("scripts/web.js")))
    else {
        return;
    };
    // The page opens with RAMone on two feet, one of which slides, with the same answer as the tool.
    let native = heelstrike_reads(&["impact", RAMONE, "examples/ramone.json", "--format", "json"], "").well().line();
    let answer = |result: &Value| (result["verdict"].clone(), result["outcomes"][0]["margin"].clone());
    assert_eq!(answer(&found["opened"]["result"]), answer(&native));
    assert_eq!(found["opened"]["sentence"], "Exactly one outcome. Proven.");
    assert!(found["opened"]["told"].as_str().expect("words").contains("left_foot slides forward, right_foot sticks"));
    assert_eq!(found["unnamed"], json!([]), "every control has a label");
    // Sliders, number fields, check boxes and selections change the state.
    assert_eq!((&found["slid"]["rate"], &found["typed"]["rate"]), (&json!(2), &json!(-1.25)));
    assert_ne!(found["slid"]["result"]["outcomes"], found["opened"]["result"]["outcomes"]);
    assert_eq!((&found["finite"], &found["free"]["stance"]), (&json!(0.6), &Value::Null));
    // Friction by link has no cursor in the regions along a single friction.
    assert_eq!(found["by_link"], json!({"shown": "by link", "told": "by link", "cursors": 0}));
    // Without a stance the base stays where it was, so that both feet touch.
    assert!(found["free"]["told"].as_str().expect("words").contains("right_foot"), "{}", found["free"]);
    // A dragged link turns clockwise with the pointer, which is negative about its joint's axis.
    let [before, after] = ["before", "after"].map(|step| found["dragged"][step].as_f64().expect("an angle"));
    assert!(
        (before - after - found["dragged"]["turn"].as_f64().expect("an angle")).abs() < 0.02,
        "{}",
        found["dragged"]
    );
    // A click in the regions along the rate of turning sets the rate.
    assert!(found["swept"]["regions"].as_u64() >= Some(2), "{}", found["swept"]);
    assert_eq!(found["swept"]["struck"], found["swept"]["state"]);
    // A pasted state is kept in the address and opened from it.
    assert_eq!(found["pasted"]["sentence"], "Three outcomes are equally valid. Proven.");
    assert_eq!(found["pasted"]["chosen"], json!(["false", "true", "false"]));
    assert_eq!(found["reopened"], found["linked"]);
    // Dropped files.
    assert_eq!((&found["dropped"]["title"], &found["dropped"]["dials"]), (&json!("heelstrike: block"), &json!(9)));
    for (what, why) in [("refused", "a <link> is missing"), ("wrong_state", "frition: unknown field")] {
        assert!(found[what].as_str().expect("words").starts_with(&format!("Refused: {why}")), "{}", found[what]);
    }
}

#[test]
fn the_live_page_fits_into_narrow_windows() {
    // A headless window is at least 500 pixels wide, so the script sets the page's width.
    let script = include_str!("scripts/narrow.js");
    for window in [(390, 844), (1280, 800)] {
        let script = format!("const width = {};{script}", window.0);
        let Some(found) = driven(window, &script) else { return };
        assert_eq!(found["beyond"], json!([]), "{window:?}");
        assert!(found["parts"].as_u64() > Some(100), "{found}");
    }
}
