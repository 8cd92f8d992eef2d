//! `--budget`, and inputs that are refused before any work because of their size.

use super::*;
use support::nearly::nearly_dependent;

/// Runs the command, which must end within 240 s.
fn ends(arguments: &[&str], stdin: &str) -> Run {
    finished(command().args(arguments).write_stdin(stdin).timeout(std::time::Duration::from_secs(240)))
}

#[test]
fn ten_nearly_singular_contacts_end_with_little_text() {
    let problem = nearly_dependent(10).to_string();
    let run = ends(&["solve", "-", "--brief", "--budget", "0.2"], &problem).well();
    assert!(run.stdout.len() < 40_000, "{} bytes", run.stdout.len());
    let sentence = "Undecided: the budget of work ended (--budget), and ";
    assert!(run.stdout.contains(sentence) && run.stdout.contains(" of 1048576 combinations of modes are open"));
    // Undecided combinations have no numbers, and none of them is said to fail.
    let whole = ends(&["solve", "-", "--budget", "0.2"], &problem).well().stdout;
    assert!(
        whole.contains(", not excluded\n  what it would be is not known\n")
            && !whole.contains("combinations of modes fail")
    );
    assert!(run.stdout.contains(", not excluded\n"));
    let brief = ends(&["solve", "-", "--brief", "--format", "json", "--budget", "0.2"], &problem).well().line();
    assert_eq!((&brief["verdict"], &brief["proven"]), (&json!("undecided"), &json!(false)));
    assert_eq!((&brief["open"]["combinations"], &brief["open"]["beyond_budget"]), (&json!(1_048_576), &json!(true)));
    assert!(list(&brief["outcomes"]).len() <= 200);
}

#[test]
fn feet_and_calves_in_the_ground_are_decided_in_time() {
    // At these tolerances the quadruped's calves count as touching the ground as well.
    let rows: Vec<String> = read("tests/data/gaits/a1_walk.csv").lines().take(3).map(str::to_owned).collect();
    let arguments = ["batch", "tests/data/robots/a1/a1.urdf", "-", "--input-format", "csv", "--friction", "0.7"];
    for tolerance in ["0.02", "0.05"] {
        let options = ["--contact-tolerance", tolerance, "--budget", "0.05", "--brief"];
        let answers = ends(&[&arguments[..], &options].concat(), &(rows.join("\n") + "\n")).well().lines();
        let found = answers.iter().map(|answer| (list(&answer["contacts"]).len(), answer["proven"].clone()));
        assert_eq!(found.collect::<Vec<_>>(), [(8, json!(true)), (8, json!(true))], "{answers:?}");
    }
}

/// The block at rest on twelve named contacts along a line, which merging would reduce to two. Because all velocities
/// are zero, every combination of modes is close to an outcome.
fn resting_on_many_points() -> Value {
    let points: Vec<Value> =
        (0..12).map(|at| json!({"link": "block", "offset": [0.01 * f64::from(at), 0, -0.1]})).collect();
    json!({"velocity": {"base": {}}, "friction": 0.5, "contacts": points})
}

#[test]
fn a_rank_that_is_not_known_is_not_printed() {
    let arguments = ["impact", BLOCK, "-", "--no-reduction=merge", "--format", "json", "--budget"];
    let rank = |budget| ends(&[&arguments[..], &[budget]].concat(), &resting_on_many_points().to_string()).line();
    assert!(rank("0")["rank"].is_null());
    // A rigid body in the plane has three degrees of freedom.
    assert_eq!(rank("infinite")["rank"], json!(3));
}

#[test]
fn a_batch_of_hard_states_ends_as_a_whole() {
    let hard = resting_on_many_points();
    let easy = json!({"velocity": {"base": {"z": -1}}, "friction": 0.5, "place": "lowest"});
    let states = format!("{hard}\n").repeat(12) + &easy.to_string();
    let run = |more: &[&str]| {
        let summary = place("summary.json");
        let arguments = ["batch", BLOCK, "-", "--no-reduction=merge", "--brief", "--budget", "0.01", "--threads", "1"];
        let run = ends(&[&arguments[..], &["--summary", &summary], more].concat(), &states).well();
        assert_eq!(each(&json!(run.lines()), "verdict")[12], "unique");
        assert!(run.stderr.contains("undecided because the budget of work ended (--budget): 12"), "{}", run.stderr);
        let counts = parsed(&read(&summary));
        assert_eq!((&counts["beyond_budget"], &counts["verdicts"]["undecided"]), (&json!(12), &json!(12)));
        run.stderr
    };
    let less = "answers beyond --budget took so long together that one had";
    // Each answer may take a sixth of the remaining total: the twelfth one gets 0.01 s * (5/6)^11.
    assert!(run(&[]).contains(&format!("{less} 1.35e-3 s: see --budget-total")), "{}", run(&[]));
    assert!(run(&["--budget-total", "0.03"]).contains(less));
    for enough in ["1", "infinite"] {
        assert!(!run(&["--budget-total", enough]).contains(less), "{enough}");
    }
}

#[test]
fn thousands_of_rejections_are_counted() {
    let contacts = 7;
    let row = |row| (0..2 * contacts).map(|column| if row == column { 2.0 } else { 0.1 }).collect::<Vec<_>>();
    let problem = json!({
        "delassus": (0..2 * contacts).map(row).collect::<Vec<_>>(),
        "velocity_before": vec![[0.3, -1.0]; contacts],
        "friction": 0.5,
    });
    let problem = problem.to_string();
    let result = ends(&["solve", "-", "--format", "json", "--explain"], &problem).well().line();
    assert_eq!(list(&result["rejected"]).len(), 0);
    let note = "0 rejected combinations are listed; of 16383 others a search shows that nothing leads there";
    assert_eq!(result["notes"], json!([note]));
    let text = ends(&["solve", "-", "--explain", "--format", "text"], &problem).text();
    assert!(text.contains("the other 16383 combinations of modes fail.\n") && text.contains(note), "{text}");
}

#[test]
fn compliant_contact_ends_with_its_budget() {
    let arguments = ["accuracy", RAMONE, "examples/ramone.json", "--time", "1", "--format", "json", "--budget"];
    let run = |budget: &str| ends(&[&arguments[..], &[budget]].concat(), "").well();
    let without = run("0");
    assert!(without.stderr.contains("compliant contact is left out: the budget of work ended"), "{}", without.stderr);
    assert_eq!((&without.line()["compliant"], without.line()["studies"].is_array()), (&Value::Null, true));
    assert!(run("infinite").line()["compliant"].is_object());
}

#[test]
fn an_endless_range_is_refused_and_replaces_nothing() {
    let old = file("old.json", "old");
    let profile = json!({"profile": [[-9, 0], [9, 0]]});
    let closer = ", a smaller --contact-tolerance, so that fewer points of the profile touch at once";
    for (steps, ground, fewer, closer) in [
        (50, json!({"slope": 0}), "fewer than 50 samples of alpha, ", ""),
        (3, json!({"slope": 0}), "", ""),
        (3, profile, "", closer),
    ] {
        let mut study = walker(json!({"alpha": {"from": 0, "to": 1e17, "steps": steps}}));
        study["state"]["ground"] = ground;
        let run = ends(&["sweep", WALKER, "-", "--budget", "0.3", "-o", &old], &study.to_string());
        let refusal = run.refusal(1);
        assert!(
            refusal.contains("the budget of work ended") && refusal.contains("parameters.alpha.steps"),
            "{refusal}"
        );
        let remedy = format!("take {fewer}a narrower range of alpha than 0.0 to 1e17{closer}, or --budget 10.0");
        assert!(refusal.contains(&remedy), "{refusal}");
    }
    assert_eq!(fs::read_to_string(&old).expect("a file"), "old");
}

#[test]
fn a_study_with_too_many_samples_is_refused_at_once() {
    let parameter = |steps: u32| json!({"from": 0.1, "to": 1, "steps": steps});
    let large = walker(json!({"alpha": parameter(400_000), "b": parameter(2)})).to_string();
    let refusal = ends(&["sweep", WALKER, "-"], &large).refusal(1);
    assert!(refusal.contains("parameters.alpha.steps") && refusal.contains("MB of memory"), "{refusal}");
    // The largest number of samples that is accepted; there is no time for all of them.
    let study = walker(json!({"alpha": parameter(1_000_000)})).to_string();
    ends(&["sweep", WALKER, "-", "--budget", "0.1"], &study)
        .refusal_with(1, "take fewer than 1000000 samples of alpha");
}

#[test]
fn a_picture_with_endless_names_is_drawn_soon() {
    let name = format!("\"{}\"", "n".repeat(100_000));
    let urdf = file("long.urdf", read(BLOCK).replace("\"block\"", &name));
    for ending in ["png", "svg"] {
        let picture = place(&format!("picture.{ending}"));
        let state = r#"{"velocity": {"base": {"z": -1}}, "friction": 0.5, "place": "lowest"}"#;
        ends(&["impact", &urdf, "-", "--brief", "--plot", &picture], state).well();
        assert!(fs::metadata(&picture).expect("a picture").len() < 200_000);
    }
}

#[test]
fn a_budget_is_seconds_or_infinite() {
    let solve = |budget: &str| heelstrike(&["solve", "examples/problems/rod.json", "--budget", budget]);
    for budget in ["-1", "nan", "1e400", "soon", ""] {
        solve(budget).refusal_with(2, "a number of seconds from 0 on, or \"infinite\"");
    }
    assert_eq!(solve("infinite").text(), solve("0.5").text());
}
