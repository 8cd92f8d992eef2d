//! `accuracy`: tables for people with their times masked, the JSON's numbers, pictures, and what is refused.

use super::{heelstrike, heelstrike_reads};
use serde_json::Value;

const RAMONE: [&str; 5] = ["accuracy", "urdf/ramone.urdf", "examples/ramone.json", "--time", "0"];

fn json(args: &[&str]) -> Value {
    let run = heelstrike(&[args, &["--format", "json"]].concat());
    assert_eq!(run.status, 0, "{}", run.stderr);
    run.line()
}

/// The text with times masked, and blanks as wide as they happen to be made one.
fn masked(text: &str) -> String {
    let word = |word: &str| match word {
        "ns" | "µs" | "ms" | "s" => "TIME".to_owned(),
        word if word.starts_with('[') || word.ends_with(']') => "..".to_owned(),
        word => word.to_owned(),
    };
    let line = |line: &str| {
        let mut words: Vec<String> = line.split_whitespace().map(word).collect();
        // The number before a unit of time.
        while let Some(at) = words.iter().position(|word| word == "TIME") {
            words[at] = "<time>".to_owned();
            words.remove(at - 1);
        }
        words.join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_state_is_told_method_by_method() {
    let run = heelstrike(&RAMONE);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    let text = masked(&run.stdout);
    // What hangs on the last bit of an f64 stands in no snapshot; the JSON's numbers are checked below.
    let names: Vec<&str> = text.lines().skip(4).take(10).filter_map(|line| line.split("<time>").next()).collect();
    assert_eq!(
        names,
        [
            "f32, sparse LTL G ",
            "f32, articulated bodies G ",
            "f64, sparse LTL G ",
            "f64, dense Cholesky G ",
            "f64, articulated bodies G ",
            "double-double, sparse LTL G ",
            "double-double, articulated bodies G ",
            "reference, articulated bodies G ",
            "f64 verdict ",
            "f64 with proof verdict ",
        ]
    );
    assert!(
        text.starts_with("ramone (alpha = 0.5): unique, 1 outcome, proven.\nCondition: mass matrix 14.0293,"),
        "{text}"
    );
    assert!(text.contains("Take f64 by articulated bodies for G"), "{text}");
    assert!(text.contains("1 slide+, stick (index +1): nearest of 72 runs"), "{text}");
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
    let text = heelstrike(&["accuracy", "--case", "massless feet", "--time", "0"]);
    assert_eq!(text.status, 0);
    assert!(text.stdout.starts_with("3 stiff and extreme cases"), "{}", text.stdout);

    let none = heelstrike(&["accuracy", "--case", "no such case"]);
    assert_eq!((none.status, none.stdout.as_str()), (2, ""));
    assert!(none.stderr.contains("--case"), "{}", none.stderr);
}

#[test]
fn pictures_are_drawn_as_svg_and_png() {
    let directory = std::env::temp_dir().join(format!("heelstrike-accuracy-{}", std::process::id()));
    std::fs::create_dir_all(&directory).expect("a directory");
    for (name, start) in [("a.svg", b"<svg".as_slice()), ("a.png", b"\x89PNG".as_slice())] {
        let path = directory.join(name);
        let run = heelstrike(&[&RAMONE[..], &["--plot", path.to_str().expect("UTF-8")]].concat());
        assert_eq!(run.status, 0, "{}", run.stderr);
        assert!(std::fs::read(&path).expect("written").starts_with(start), "{name}");
    }
    std::fs::remove_dir_all(&directory).expect("removed");
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
