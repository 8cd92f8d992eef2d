//! The summary of a batch, for people and as JSON.

use super::*;

/// Strikes with c = [x, -1], a state at rest, one in the air and a broken line. With G = diag(0.75, 0.5) 1/kg, sticking
/// takes the impulse L = [-x / 0.75, 2], so a friction of |x| / 1.5; the disc has 0.5.
fn discs() -> String {
    let at_rest = json!({"id": "at rest", "position": {"base": {"z": 0.5}}});
    let aloft = json!({"position": {"base": {"z": 1}}});
    format!("{}{}{}{at_rest}\n\n{aloft}\nopps\n", strike(1, 0.3), strike(2, 1.5), strike(3, -3.0))
}

#[test]
fn the_summary_counts_and_names() {
    let path = file("summary.json", "what was there before");
    let run = batch(&["-", "--friction", "0.5", "--summary", &path], discs());
    assert_eq!(run.status, 1);
    let mut summary = parsed(&read(&path));
    let near = summary["smallest_margins"].as_array_mut().expect("a list").iter_mut();
    let margins: Vec<f64> = near.map(|near| near["margin"].take().as_f64().expect("a number")).collect();
    // With S = max |c_i| / sqrt(G_ii): state 1 (cone) (0.5 L_n - |L_t|) / (S sqrt(0.25 / G_nn + 1 / G_tt)), S = 1 /
    // sqrt(G_nn); state 3 L_n sqrt(G_nn) / S, S = 3 / sqrt(G_tt); state 2 c_t+ / (S sqrt(G_tt)) = 0.75 / 1.5.
    let expected = [0.6 / (2.0_f64.sqrt() * (11.0_f64 / 6.0).sqrt()), 2.0 * 0.375_f64.sqrt() / 3.0, 0.5];
    for (margin, expected) in margins.iter().zip(expected) {
        // The tolerance allows for a few roundings of numbers of order one.
        assert!((margin - expected).abs() < 1e-14, "{margin} {expected}");
    }
    let count = |modes: &[&str], outcomes: u64| {
        let contacts: Vec<&str> = modes.iter().map(|_| "disc").collect();
        json!({"contacts": contacts, "modes": modes, "outcomes": outcomes})
    };
    let expected = json!({
        "states": 6,
        "refused": 1,
        "verdicts": {"unique": 3, "ambiguous": 0, "none": 0, "undecided": 0, "no_impact": 1, "no_contact": 1},
        "smallest_margins": [
            {"id": 1, "line": 1, "margin": null},
            {"id": 3, "line": 3, "margin": null},
            {"id": 2, "line": 2, "margin": null},
        ],
        "more_friction": {"states": 2, "greatest": {"id": 3, "line": 3, "friction": 2.0}},
        "resting": 0,
        "modes": [count(&["stick"], 2), count(&["slide+"], 1), count(&["slide-"], 1), count(&[], 1)],
        "other_modes": 0,
    });
    assert_eq!(summary, expected);
    let for_people = "\
6 states: 3 unique, 1 without impact, 1 without contact, 1 refused
smallest margins with an impulse: 0.31 1 (line 1), 0.41 3 (line 3), 0.50 2 (line 2)
all outcomes slide because friction is too small: 2; most is needed by 3 (line 3): 2.000
       2 x disc stick
       1 x disc slide+
       1 x disc slide-
";
    assert!(run.stderr.ends_with(for_people), "{}", run.stderr);
}

#[test]
fn odd_states_are_counted_and_the_first_is_named() {
    let path = place("odd.json");
    let turned = |pitch: f64| json!({"position": {"base": {"z": 0.5, "pitch": pitch}}});
    let states = [1.0, 90.0, 180.0].map(|pitch| format!("{}\n", turned(pitch))).concat();
    let run = batch(&["-", "--brief", "--friction", "1", "--summary", &path], states);
    let what = "pitch = 90 rad is more than a turn; degrees?";
    let expected = json!({"states": 2, "first": {"line": 2, "what": what}});
    assert_eq!(parsed(&read(&path))["odd_states"], expected);
    let line = format!("states with odd numbers: 2, the first line 2: {what}\n");
    assert!(run.stderr.contains(&line), "{}", run.stderr);
}

#[test]
fn a_batch_in_which_nothing_touches_says_so() {
    let line = "no foot touches the ground in any state (see --place, and --touchdowns of recordings)\n";
    let raised = |z: f64| format!("{}\n", json!({"position": {"base": {"z": z}}, "velocity": {"base": {"z": -1}}}));
    let said = |states: String| batch(&["-", "--brief", "--friction", "1"], states).stderr.contains(line);
    assert!(said([500.0, 501.0].map(raised).concat()));
    assert!(!said([500.0, 501.0].map(raised).concat() + "{oops\n"));
    assert!(!said([0.5, 501.0, 502.0].map(raised).concat()));
}

/// The disc descends, slowed down at 10 m/s^2, and is at rest on the ground from 0.08 s on.
#[test]
fn early_touchdowns_are_counted_of_recorded_heights() {
    let path = place("early.json");
    let row = |row: u8| {
        let time = f64::from(row) * 1e-3;
        format!("{time},{}\n", 0.5 + 5.0 * (0.08_f64 - time).max(0.0).powi(2))
    };
    let table = format!("time,q_base_z\n{}", (0..100).map(row).collect::<String>());
    let asked = ["-", "--input-format", "csv", "--touchdowns", "--velocity", "central", "--friction", "1", "--summary"];
    let line = "touchdowns taken above the ground, from heights without noise: 1; if they are of a simulation, give --simulated\n";
    for (more, early) in [(&[][..], json!(1)), (&["--simulated"], Value::Null)] {
        let run = batch(&[&asked[..], &[&path], more].concat(), table.clone());
        let summary = parsed(&read(&path));
        assert_eq!((&summary["states"], &summary["early"]), (&json!(1), &early), "{}", run.stderr);
        assert_eq!(run.stderr.contains(line), early == 1, "{}", run.stderr);
    }
}

#[test]
fn forces_are_answered_and_summed_up() {
    let path = place("forces.json");
    let resting = |x: f64| {
        let velocity = json!({"base": {"x": x, "pitch": if x == 0.0 { 0.0 } else { 3.0 }}});
        format!("{}\n", json!({"position": {"base": {"z": 0.5}}, "velocity": velocity}))
    };
    let states = resting(0.0) + &resting(1.0) + &strike(3, 0.0);
    let run = batch(&["-", "--friction", "0.5", "--forces", "--summary", &path], states.clone());
    let lines = run.lines();
    // The weight of 2 kg.
    assert_eq!(lines[0]["outcomes"][0]["force"], json!([[0.0, 19.62]]));
    assert_eq!(lines[1]["outcomes"][0]["force"], json!([[9.81, 19.62]]));
    assert!(lines[2]["error"]["message"].as_str().expect("a message").contains("that is an impact"));
    let summary = parsed(&read(&path));
    assert_eq!((&summary["question"], &summary["verdicts"]["unique"]), (&json!("forces"), &json!(2)));
    assert!(run.stderr.contains("smallest margins with a force"), "{}", run.stderr);
    let refused = batch(&["-", "--friction", "0.5", "--forces", "--summary", &path], "oops\n");
    assert_eq!((refused.status, &parsed(&read(&path))["question"]), (1, &json!("forces")));
    let table = batch(&["-", "--friction", "0.5", "--forces", "--output-format", "csv"], states).stdout;
    let head =
        "id,line,verdict,outcome,margin,proven,mode_disc,f_disc_t,f_disc_n,a_base_x,a_base_z,a_base_pitch,border";
    assert!(table.starts_with(head), "{table}");
    assert!(table.contains(",stick,0.0,19.62,0.0,0.0,0.0,"), "{table}");
}

#[test]
fn what_follows_has_columns_and_fields() {
    let states = strike(1, 0.0) + &strike(2, 30.0);
    let line = &batch(&["-", "--friction", "0.5", "--next", "--brief"], states.clone()).lines()[1];
    let next = json!({"verdict": "unique", "proven": true, "modes": [["slide+"]]});
    assert_eq!(line["outcomes"][0]["next"], next);
    let table = batch(&["-", "--friction", "0.5", "--next", "--output-format", "csv"], states).stdout;
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows[0].starts_with("id,line,verdict,outcome,margin,proven,next_verdict,next_modes,mode_disc"), "{table}");
    assert!(rows[1].contains("true,unique,stick,stick,") && rows[2].contains("true,unique,slide+,slide+,"), "{table}");
}

#[test]
fn a_single_state_has_a_summary_only_if_asked_for() {
    assert_eq!(batch(&["-", "--friction", "1"], strike(1, 0.0)).stderr, "");
    let path = file("single.json", "");
    let run = batch(&["-", "--friction", "1", "--summary", &path], strike(1, 0.0));
    assert!(run.stderr.starts_with("1 state: 1 unique\n"), "{}", run.stderr);
    assert_eq!(parsed(&read(&path))["states"], 1);
}

/// The walk of the README. Its standing foot is taken as at rest, although rounding moves it.
const WALK: [&str; 4] = ["batch", "urdf/ramone.urdf", "--friction", "0.6"];

#[test]
fn the_walk_at_its_word_is_ambiguous_by_rounding() {
    let strict = ["examples/gait/ramone_walk.csv", "--resting-speed", "0", "--brief"];
    let summary = heelstrike_reads(&[&WALK[..], &strict].concat(), "").stderr;
    assert!(summary.starts_with("102 states: 46 unique, 2 ambiguous, 54 without impact\n"), "{summary}");
    assert!(!summary.contains("at rest"), "{summary}");
}

/// A table with six decimals or more is known to half a unit of the last one, so that a foot which moves less rests.
/// With four decimals the motion may be real.
#[test]
fn a_walk_of_six_decimals_has_the_same_touchdowns() {
    let table = read("examples/gait/ramone_walk.csv");
    let rounded = |decimals: usize| {
        let cell = |cell: &str| cell.parse::<f64>().map_or(cell.to_owned(), |number| format!("{number:.decimals$}"));
        let line = |line: &str| line.split(',').map(cell).collect::<Vec<_>>().join(",") + "\n";
        let table: String = table.lines().map(line).collect();
        let arguments = ["-", "--input-format", "csv", "--contact-tolerance", "1e-4", "--brief"];
        heelstrike_reads(&[&WALK[..], &arguments].concat(), table).stderr
    };
    for decimals in [6, 8, 10] {
        let summary = rounded(decimals);
        assert!(summary.starts_with("102 states: 2 unique, 100 without impact\n"), "{decimals}: {summary}");
    }
    assert!(!rounded(4).contains("at rest"));
}

#[test]
fn states_with_notes_are_counted_and_the_first_is_named() {
    let walk = ["batch", RAMONE, "examples/gait/ramone_walk.csv", "--friction", "0.6"];
    let path = place("noted.json");
    let run = heelstrike(&[&walk[..], &["-o", &place("noted.ndjson"), "--summary", &path]].concat()).well();
    let noted = &parsed(&read(&path))["noted"];
    let lines = read(&place("noted.ndjson"));
    let near: Vec<&str> = lines.lines().filter(|line| line.contains("nearly touches")).collect();
    assert_eq!(noted["states"], near.len());
    assert_eq!(noted["first"]["line"], parsed(near[0])["line"]);
    assert!(run.stderr.contains(&format!("states with notes: {}, the first gait/", near.len())), "{}", run.stderr);
}
