//! `accuracy`: tables for people with their times masked, the JSON's numbers, pictures, and what is refused.

use super::{heelstrike, heelstrike_reads, place};
use serde_json::Value;

const RAMONE: [&str; 5] = ["accuracy", "urdf/ramone.urdf", "examples/ramone.json", "--time", "0"];

fn json(args: &[&str]) -> Value {
    let run = heelstrike(&[args, &["--format", "json"]].concat());
    assert_eq!(run.status, 0, "{}", run.stderr);
    run.line()
}

/// The text with times masked, the advice that depends on them, and blanks as wide as they happen to be made one; so
/// are steps of an integration and what its tolerance leaves.
fn masked(text: &str) -> String {
    let word = |word: &str| match word {
        "ns" | "µs" | "ms" | "s" => "TIME".to_owned(),
        word if word.starts_with('[') || word.ends_with(']') => "..".to_owned(),
        word if word.contains('.') && word.contains("e-") => "<small>".to_owned(),
        word => word.to_owned(),
    };
    let line = |line: &str| {
        if line.starts_with("For G take f64 by ") {
            return "<advice>".to_owned();
        }
        let mut words: Vec<String> = line.split_whitespace().map(word).collect();
        // The number before a unit of time.
        while let Some(at) = words.iter().position(|word| word == "TIME") {
            words[at] = "<time>".to_owned();
            words.remove(at - 1);
        }
        // Steps at a tolerance.
        if let [first, steps, ..] = words.as_mut_slice()
            && first.starts_with("1e-")
        {
            *steps = "<steps>".to_owned();
        }
        words.join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_state_is_told_method_by_method() {
    let run = heelstrike(&RAMONE);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("accuracy_ramone", masked(&run.stdout));
}

#[test]
fn cases_are_told_by_their_digits_then_method_by_method() {
    let run = heelstrike(&["accuracy", "--case", "massless feet", "--time", "0"]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("accuracy_massless_feet", masked(&run.stdout));
}

#[test]
fn a_method_that_is_not_tried_is_told_with_its_reason() {
    let run = heelstrike(&["accuracy", "--case", "chain of 1000 links, folded", "--time", "0"]);
    let reason = "  double-double, sparse LTL is left out: with more than 300 coordinates it takes seconds\n";
    assert!(run.stdout.contains(reason), "{}", run.stdout);
}

#[test]
fn without_proofs_neither_they_nor_their_cost_are_told() {
    for mut args in [RAMONE.to_vec(), vec!["accuracy", "--case", "Hilbert G of two", "--time", "0"]] {
        let numbers = |args: &[&str]| -> Vec<String> {
            let accuracy = json(args);
            let study = &accuracy["studies"][0];
            assert_eq!(study["answer"]["proven"], !args.contains(&"--no-proof"), "{study}");
            let methods = study["methods"].as_array().expect("a list").iter();
            let whole = methods.filter(|method| method["work"] == "answer");
            whole.map(|method| method["number"].as_str().expect("a name").to_owned()).collect()
        };
        assert_eq!(numbers(&args), ["f64", "f64 with proof"]);
        args.push("--no-proof");
        assert_eq!(numbers(&args), ["f64"]);
        assert!(!heelstrike(&args).stdout.contains("the proof takes"));
    }
}

#[test]
fn the_json_holds_errors_times_and_conditions() {
    let accuracy = json(&RAMONE);
    let study = &accuracy["studies"][0];
    assert_eq!(study["answer"]["verdict"], "unique");
    assert!(study["condition"]["mass_matrix"].as_f64().is_some_and(|condition| (10.0..20.0).contains(&condition)));
    let methods = study["methods"].as_array().expect("a list");
    assert_eq!(methods.len(), 10);
    for method in methods {
        let time = &method["time"];
        let at = |name: &str| time[name].as_f64().expect("a number");
        assert!(0.0 < at("lower_quartile") && at("lower_quartile") <= at("median"), "{method}");
        assert!(at("median") <= at("upper_quartile"), "{method}");
    }
    let error = |at: usize| methods[at]["error"]["delassus"].as_f64().expect("a number");
    // Digits of f32, f64 and double-double, less two for the few dozen roundings.
    assert!((1e-9..1e-5).contains(&error(0)) && error(4) < 1e-14 && error(6) < 1e-28, "{study}");
    assert_eq!(accuracy["compliant"]["groups"][0]["runs"], 72);
}

#[test]
fn the_suite_is_picked_from_by_name() {
    let accuracy = json(&["accuracy", "--case", "massless feet", "--time", "0"]);
    let studies = accuracy["studies"].as_array().expect("a list");
    assert_eq!(studies.len(), 3);
    let refused: Vec<bool> = studies.iter().map(|study| study["refused"].is_string()).collect();
    assert_eq!(refused, [false, false, true]);

    let none = heelstrike(&["accuracy", "--case", "no such case"]);
    assert_eq!((none.status, none.stdout.as_str()), (2, ""));
    assert!(none.stderr.contains("--case"), "{}", none.stderr);
}

#[test]
fn a_picture_names_the_cases_or_says_what_a_mark_is() {
    let path = place("cases.svg");
    let drawn = |case: &str| {
        let plot = &path;
        let run = heelstrike(&["accuracy", "--case", case, "--time", "0", "--plot", plot]);
        assert_eq!(run.status, 0, "{}", run.stderr);
        std::fs::read_to_string(&path).expect("written")
    };
    let few = drawn("massless feet");
    // The loose feet are refused and have no mark.
    for (text, times) in [("massless feet, held", 1), ("massless feet with rotors", 1), ("massless feet, loose", 0)] {
        assert_eq!(few.matches(text).count(), times, "{text}");
    }
    for axis in ["largest error of G", "largest error of impulses and velocities after"] {
        assert_eq!(few.matches(axis).count(), 1, "{axis}");
    }
    let many = drawn("friction");
    assert!(many.contains("each mark is one of 13 cases by one method"));
    assert!(!many.contains("RAMone"));
}

#[test]
fn pictures_are_drawn_as_svg_and_png() {
    for (name, start) in [("a.svg", b"<svg".as_slice()), ("a.png", b"\x89PNG".as_slice())] {
        let path = place(name);
        let run = heelstrike(&[&RAMONE[..], &["--plot", &path]].concat());
        assert_eq!(run.status, 0, "{}", run.stderr);
        assert!(std::fs::read(&path).expect("written").starts_with(start), "{name}");
    }
}

#[test]
fn what_cannot_be_done_is_refused_with_its_remedy() {
    let ending = heelstrike(&[&RAMONE[..], &["--plot", "a.gif"]].concat());
    assert_eq!((ending.status, ending.stdout.as_str()), (2, ""));
    assert!(ending.stderr.contains(".svg or .png"), "{}", ending.stderr);

    let alone = heelstrike(&["accuracy", "urdf/ramone.urdf"]);
    assert_eq!((alone.status, alone.stdout.as_str()), (2, ""));

    let two = heelstrike_reads(&["accuracy", "urdf/ramone.urdf", "-"], "{}\n{}\n");
    assert_eq!((two.status, two.stdout.as_str()), (1, ""));
    assert!(two.stderr.contains(":2:1"), "{}", two.stderr);

    let broken = heelstrike_reads(&["accuracy", "urdf/ramone.urdf", "-"], r#"{"positon": {}}"#);
    assert_eq!((broken.status, broken.stdout.as_str()), (1, ""));
    assert!(broken.stderr.contains("position"), "{}", broken.stderr);
}
