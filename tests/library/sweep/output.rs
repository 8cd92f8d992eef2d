//! Output of studies: samples, tables, text, notes, exit status, and what happens to refused samples.

use crate::support::command::{Run, heelstrike_reads};
use crate::sweep::command::{assert_begins, kneed, run, straight, sweep, written};
use serde_json::{Value, json};
use std::f64::consts::PI;

/// The JSON that `impact` writes for a state.
fn impact(robot: &str, state: &Value, arguments: &[&str]) -> Value {
    heelstrike_reads(&[&["impact", robot, "-", "--format", "json"], arguments].concat(), state.to_string()).line()
}

#[test]
fn every_sample_is_the_result_of_impact() {
    for arguments in [&[][..], &["--explain", "--matrices"], &["--brief"]] {
        let mut study = kneed();
        study["parameters"]["alpha"]["steps"] = json!(7);
        study["state"]["id"] = json!("alpha");
        let written: Value = written("urdf/ramone.urdf", &study, arguments);
        let samples = written["samples"].as_array().expect("a list");
        assert_eq!(samples.len(), 7);
        for sample in samples {
            let alpha = sample["alpha"].as_f64().expect("a number");
            let mut state = study["state"].clone();
            let bend = libm::atan2(0.2385, 0.2);
            state["position"]["joints"] = json!({
                "left_hip": bend + alpha, "left_knee": -PI / 2.0, "right_hip": bend - alpha, "right_knee": -PI / 2.0,
            });
            assert_eq!(sample["result"], impact("urdf/ramone.urdf", &state, arguments), "at {alpha}");
        }
    }
}

#[test]
fn samples_begin_at_from_and_end_at_to() {
    let mut study = straight(None);
    study["parameters"]["alpha"] = json!({"from": 0.1, "to": "pi/3", "steps": 4});
    let alphas: Vec<Value> =
        sweep("urdf/minimalistic.urdf", &study).samples.iter().map(|sample| sample["alpha"].clone()).collect();
    let third = (PI / 3.0 - 0.1) / 3.0;
    assert_eq!(alphas.len(), 4);
    assert_eq!((alphas[0].clone(), alphas[3].clone()), (json!(0.1), json!(PI / 3.0)));
    for (at, alpha) in alphas.iter().enumerate() {
        let off = alpha.as_f64().expect("a number") - (0.1 + third * at as f64);
        assert!(off.abs() < 1e-15, "{alphas:?}");
    }
}

/// Samples on the borders pi/12, pi/6 and 5 pi/12 do not add regions, wherever they lie.
#[test]
fn samples_on_borders_make_no_regions_of_their_own() {
    let mut study = straight(None);
    study["parameters"]["alpha"] = json!({"from": "pi/12", "to": "5*pi/12", "steps": 5});
    let found = sweep("urdf/minimalistic.urdf", &study);
    let expected = [(PI / 12.0, "slide-/stick"), (PI / 6.0, "stick/stick")];
    assert_begins("between borders", &found, &expected, 1e-12);
    assert_eq!((found.regions[0].from, found.regions[1].to), (PI / 12.0, 5.0 * PI / 12.0));
}

#[test]
fn text_is_for_people() {
    let run = run("urdf/minimalistic.urdf", &straight(None), &[]);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    insta::assert_snapshot!("minimalistic", run.stdout);
}

#[test]
fn joints_beyond_a_turn_are_noted_once() {
    let angles = json!({"from": 45, "to": 46, "steps": 2});
    let state = json!({"position": {"joints": {"left_hip": "a"}}, "place": "lowest", "friction": 1});
    let one = json!({"parameters": {"a": angles}, "state": state});
    let two = json!({"parameters": {"a": angles, "b": {"from": 0, "to": 1, "steps": 2}}, "state": state});
    for study in [one, two] {
        let found: Value = written("urdf/ramone.urdf", &study, &[]);
        let notes = found["notes"].as_array().expect("a list").iter().filter_map(Value::as_str);
        let odd: Vec<&str> = notes.filter(|note| note.contains("degrees?")).collect();
        assert_eq!(odd, ["left_hip = 45 rad is more than a turn; degrees?"]);
    }
}

#[test]
fn cautions_about_a_varied_robot_are_noted() {
    let state = json!({"velocity": {"base": {"z": -1}}, "place": "lowest", "friction": 1});
    let notes = |mass: [f64; 2]| {
        let parameters = json!({"m": {"from": mass[0], "to": mass[1], "steps": 2}});
        let study = json!({"parameters": parameters, "state": state, "robot": {"links": {"torso": {"mass": "m"}}}});
        written::<Value>("urdf/ramone.urdf", &study, &[])["notes"].to_string()
    };
    assert!(!notes([5.0, 10.0]).contains("ball of steel"), "{}", notes([5.0, 10.0]));
    assert!(
        notes([5000.0, 90000.0]).contains("kg, more than a ball of steel around all of it"),
        "{}",
        notes([5e3, 9e4])
    );
}

/// No impact depends on gravity, which is noted. A periodic dependence may be equal at both ends and in the middle.
#[test]
fn a_parameter_without_effect_and_a_box_are_noted() {
    let notes_of = |robot: Value, more: Value| {
        let mut state = json!({"velocity": {"base": {"z": -1}}, "place": "lowest", "friction": 1});
        state.as_object_mut().expect("an object").extend(more.as_object().cloned().expect("an object"));
        let parameters = json!({"a": {"from": 1, "to": 3, "steps": 3}});
        let study = json!({"parameters": parameters, "state": state, "robot": robot});
        let found: Value = written("urdf/ramone.urdf", &study, &[]);
        let all = found["notes"].as_array().expect("a list").iter().filter_map(Value::as_str);
        all.filter(|note| note.contains("uncertainty") || note.contains("depends on a"))
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let notes = |more: Value| notes_of(json!({}), more);
    let idle = "nothing was found that depends on a: has it an effect on an impact?";
    assert_eq!(notes(json!({"gravity": "a"})), [idle]);
    // The plane is x-z.
    let shank = |com: Value| json!({"links": {"left_shank": {"com": com}}});
    assert_eq!(notes_of(shank(json!([0, "-0.01*a", -0.165])), json!({})), [idle]);
    assert!(notes_of(shank(json!(["-0.01*a", 0, -0.165])), json!({})).is_empty());
    let changing = [
        json!({"friction": "3 + cos(2*pi*a)"}),
        json!({"velocity": {"base": {"z": -1}, "joints": {"right_knee": "a"}}}),
        json!({"rotor_inertia": {"right_knee": "a"}}),
    ];
    assert!(changing.into_iter().all(|change| notes(change).is_empty()));
    let boxes = "the regions are those of the states as given: whether these hold within their uncertainty, the samples \
                 of JSON and tables say";
    assert_eq!(notes(json!({"uncertainty": {"position": "1e-3*a"}})), [boxes]);
}

/// Above p = 0.3 the square root has no value; below, nothing touches.
fn partly_refused() -> Value {
    json!({
        "parameters": {"p": {"from": 0, "to": 1, "steps": 5}},
        "state": {"position": {"base": {"z": "1 + sqrt(0.3 - p)"}}, "friction": 1},
    })
}

#[test]
fn refused_samples_stand_in_their_place() {
    let Run { status, stdout, stderr, .. } = run("urdf/block.urdf", &partly_refused(), &["--format", "json"]);
    assert_eq!(status, 1);
    assert!(stderr.contains("the expression has no value"), "{stderr}");
    let found: Value = serde_json::from_str(&stdout).expect("JSON");
    let regions = found["regions"].as_array().expect("a list");
    assert_eq!(regions.len(), 2, "{regions:#?}");
    assert_eq!((&regions[0]["outcomes"], &regions[0]["contacts"]), (&json!([[]]), &json!([])));
    assert!(regions[0].get("error").is_none());
    let border = regions[0]["to"].as_f64().expect("a number");
    assert!((border - 0.3).abs() <= 1e-12, "{border}");
    let samples = found["samples"].as_array().expect("a list");
    for (at, sample) in samples.iter().enumerate() {
        let result = &sample["result"];
        if at < 2 {
            assert_eq!(result["verdict"], "no_contact");
        } else {
            assert_eq!(result["error"]["place"], "state.position.base.z");
            assert!(result.get("verdict").is_none() && regions[1].get("outcomes").is_none());
        }
        assert_eq!(sample["p"], json!(0.25 * at as f64));
    }
}

#[test]
fn samples_refused_outside_regions_are_counted() {
    let link = json!({"com": [0, 0, -0.4], "inertia": "j"});
    let study = json!({
        "parameters": {"j": {"from": 0, "to": 0.5, "steps": 5}},
        "state": {"stance": "left_leg", "velocity": {"base": {"pitch": 1e-5}}, "friction": "infinite"},
        "robot": {"links": {"left_leg": link, "right_leg": link}},
    });
    let Run { status, stderr, .. } = run("urdf/pdw.urdf", &study, &["--format", "json", "--quiet"]);
    assert_eq!(status, 1);
    assert!(stderr.contains("1 of 5 samples are refused\nhint: the `error` of each"), "{stderr}");
    // The text does not list samples.
    let Run { status, stderr, .. } = run("urdf/pdw.urdf", &study, &["--quiet"]);
    assert_eq!(status, 1);
    assert!(stderr.contains("1 of 5 samples are refused\nhint: --format json lists"), "{stderr}");
}

#[test]
fn a_refused_region_says_why_it_is_refused() {
    // The square root has a value above 0.6, and within 1e-7 of 0.3, the middle of the range below.
    let study = json!({
        "parameters": {"p": {"from": 0, "to": 1, "steps": 4}},
        "state": {"position": {"base": {"z": "1 + sqrt(max(p - 0.6, 1e-14 - (p - 0.3)^2))"}}, "friction": 1},
    });
    let Run { status, stdout, stderr, .. } = run("urdf/block.urdf", &study, &["--format", "text"]);
    assert_eq!(status, 1, "{stdout}");
    assert!(stderr.contains("the expression has no value"), "{stderr}");
    assert!(stdout.contains("A  0 .. 0.6  refused: the expression has no value"), "{stdout}");
}

#[test]
fn tables_add_parameter_and_region_to_those_of_batch() {
    let mut study = straight(None);
    study["parameters"]["alpha"]["steps"] = json!(4);
    let Run { status, stdout, .. } = run("urdf/minimalistic.urdf", &study, &["--format", "csv"]);
    assert_eq!(status, 0);
    let mut lines = stdout.lines();
    let header = "id,verdict,outcome,margin,proven,mode_left_leg,p_left_leg_t,p_left_leg_n,mode_right_leg,p_right_leg_t,\
                  p_right_leg_n,v_after_base_x,v_after_base_z,v_after_base_pitch,v_after_hip,alpha,region,border,family,families,error,notes";
    assert_eq!(lines.next(), Some(header));
    // The samples are 0.001, 0.524, 1.047 and 1.57; the last one has three outcomes.
    let rows: Vec<&str> = lines.collect();
    let of = |name: &str| -> Vec<&str> {
        let at = header.split(',').position(|known| known == name).expect("a column");
        rows.iter().map(|row| row.split(',').nth(at).expect("a cell")).collect()
    };
    assert_eq!(of("region"), ["A", "C", "C", "D", "D", "D"]);
    assert_eq!(of("outcome"), ["1", "1", "1", "1", "2", "3"]);
    assert_eq!(of("mode_left_leg"), ["separate", "stick", "stick", "separate", "stick", "slide+"]);
    assert_eq!([of("alpha")[0], of("alpha")[5]], ["0.001", "1.57"]);

    let Run { status, stdout, .. } = run("urdf/block.urdf", &partly_refused(), &["--format", "csv"]);
    assert_eq!(status, 1);
    let rows: Vec<&str> = stdout.lines().skip(1).collect();
    assert_eq!(rows.len(), 5, "{stdout}");
    assert!(rows[1].contains("no_contact") && rows[2].contains("the expression has no value"), "{stdout}");
}

#[test]
fn a_border_to_what_is_refused_says_so() {
    let study = json!({
        "parameters": {"s": {"from": -1, "to": 1, "steps": 9}},
        "state": {"position": {"base": {"z": "s/10"}}, "velocity": {"base": {"z": -1}}, "friction": 0.5}
    });
    let Run { status, stdout, .. } = run("urdf/block.urdf", &study, &[]);
    assert_eq!(status, 1);
    assert!(stdout.contains(": from B on states are answered\n"), "{stdout}");
    assert!(stdout.contains(": block touches the ground in B only\n"), "{stdout}");
}
