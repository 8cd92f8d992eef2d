//! `accuracy`: tables for people with their times masked, the JSON's numbers, pictures, and what is refused.

use super::{each, heelstrike, heelstrike_reads, list, place, read, result};

const RAMONE: [&str; 5] = ["accuracy", "urdf/ramone.urdf", "examples/ramone.json", "--time", "0"];

/// The arguments for the cases of the suite whose names contain `name`.
fn cases(name: &str) -> [&str; 5] {
    ["accuracy", "--case", name, "--time", "0"]
}

/// The text without what differs between runs: times, the advice that depends on them, widths of blanks, steps of an
/// integration and the small errors that its tolerance leaves.
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
        // The number of integration steps at a tolerance.
        if let [first, steps, ..] = words.as_mut_slice()
            && first.starts_with("1e-")
        {
            *steps = "<steps>".to_owned();
        }
        // On ground this soft the robot moves so far that rounding decides where to: a change of 1e-15 in the input
        // changes the result by a tenth.
        if let ["1e4", "N/m", ..] = *words.iter().map(String::as_str).collect::<Vec<_>>() {
            words[2..].fill("<far>".to_owned());
        }
        words.join(" ")
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// If the integration of the compliant contact is given up, as from this state, the rest of the report remains.
#[test]
fn a_report_is_there_without_its_compliant_contact() {
    let state = read("examples/ramone.json").replace("0.3729729102424726", "0.3729729102424722");
    let run = heelstrike_reads(
        &["accuracy", "urdf/ramone.urdf", "-", "--time", "0"],
        state.replace("-1.0", "-1.000000000000001"),
    );
    let run = run.well();
    let why =
        "compliant contact is left out: the integration of the compliant contact ended early: it takes too many steps";
    assert!(run.stderr.contains(why) && !run.stdout.contains("k_n of the moving robot"), "{}", run.stderr);
    assert!(run.stdout.contains("articulated bodies"), "{}", run.stdout);
}

#[test]
fn every_method_has_a_line() {
    for (name, arguments) in [("accuracy_ramone", RAMONE), ("accuracy_massless_feet", cases("massless feet"))] {
        insta::assert_snapshot!(name, masked(&heelstrike(&arguments).text()));
    }
    let stdout = heelstrike(&["accuracy", "urdf/five_bar.urdf", "examples/five_bar.json", "--time", "0"]).stdout;
    let reason = "  f64, dense Cholesky is left out: loops are eliminated by the sparse factorization\n";
    assert!(stdout.contains(reason), "{stdout}");
}

#[test]
fn proofs_and_their_cost_are_left_out_without_proofs() {
    for arguments in [RAMONE, cases("Hilbert G of two")] {
        let without = [&arguments[..], &["--no-proof"]].concat();
        for (arguments, proven, expected) in
            [(&arguments[..], true, &["f64", "f64 with proof"][..]), (&without, false, &["f64"])]
        {
            let study = &result(arguments, "")["studies"][0];
            assert_eq!(study["answer"]["proven"], proven, "{study}");
            let whole = list(&study["methods"]).iter().filter(|method| method["work"] == "answer");
            let numbers: Vec<_> = whole.map(|method| method["number"].clone()).collect();
            assert_eq!(numbers, expected, "{arguments:?}");
        }
        assert!(!heelstrike(&without).stdout.contains("the proof takes"));
    }
}

#[test]
fn the_json_holds_errors_times_and_conditions() {
    let accuracy = result(&RAMONE, "");
    let study = &accuracy["studies"][0];
    assert_eq!(study["answer"]["verdict"], "unique");
    assert!(study["condition"]["mass_matrix"].as_f64().is_some_and(|condition| (10.0..20.0).contains(&condition)));
    let methods = list(&study["methods"]);
    assert_eq!(methods.len(), 10);
    for method in methods {
        let at = |name: &str| method["time"][name].as_f64().expect("a number");
        assert!(0.0 < at("lower_quartile") && at("lower_quartile") <= at("median"), "{method}");
        assert!(at("median") <= at("upper_quartile"), "{method}");
    }
    let error = |at: usize| methods[at]["error"]["delassus"].as_f64().expect("a number");
    // The bounds are the precision of f32, f64 and double-double, less two digits or more for a few dozen roundings.
    assert!((1e-9..1e-5).contains(&error(0)) && error(4) < 1e-14 && error(6) < 1e-28, "{study}");
    assert_eq!(accuracy["compliant"]["groups"][0]["runs"], 72);
}

#[test]
fn the_suite_is_picked_from_by_name() {
    let refused = each(&result(&cases("massless feet"), "")["studies"], "refused");
    assert_eq!(refused.iter().map(|refused| refused.is_string()).collect::<Vec<_>>(), [false, false, true]);
}

#[test]
fn a_picture_names_the_cases_or_explains_its_marks() {
    let path = place("cases.svg");
    let drawn = |case: &str| {
        heelstrike(&[&cases(case)[..], &["--plot", &path]].concat()).well();
        read(&path)
    };
    let few = drawn("massless feet");
    for (text, times) in [
        ("massless feet, held", 1),
        ("massless feet with rotors", 1),
        // The loose feet are refused and have no mark.
        ("massless feet, loose", 0),
        ("largest error of G", 1),
        ("largest error of impulses and velocities after", 1),
    ] {
        assert_eq!(few.matches(&format!(">{text}<")).count(), times, "{text}");
    }
    let many = drawn("friction");
    assert!(many.contains("each mark is one of 13 cases by one method"));
    assert!(!many.contains("RAMone"));
}

#[test]
fn wrong_arguments_and_states_are_refused() {
    let state = &["accuracy", "urdf/ramone.urdf", "-"][..];
    for (arguments, stdin, status, words) in [
        (&[&RAMONE[..], &["--plot", "a.gif"]].concat()[..], "", 2, ".svg or .png"),
        (&state[..2], "", 2, "error: "),
        (&cases("no such case"), "", 2, "--case"),
        (&["accuracy", "--friction", "1"], "", 2, "<ROBOT.urdf>"),
        (&["accuracy", "--place", "lowest", "--case", "massless"], "", 2, "cannot be used with"),
        (&["accuracy", "--list", "--budget", "1"], "", 2, "cannot be used with"),
        (&["accuracy", "--list", "--time", "1"], "", 2, "cannot be used with"),
        (state, "{}\n{}\n", 1, ":2:1"),
        (state, r#"{"positon": {}}"#, 1, "position"),
    ] {
        heelstrike_reads(arguments, stdin).refusal_with(status, words);
    }
}
