//! Studies that are refused as a whole.

use super::{assert_refused, case};
use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::pipeline::Options;
use heelstrike::robot::Reduction;
use heelstrike::state::Defaults;
use heelstrike::sweep::{Model, Study};

/// A study of the parameter a from 0 to 1 with these other fields.
fn study(rest: &str) -> String {
    format!(r#"{{"parameters": {{"a": {{"from": 0, "to": 1, "steps": 5}}}}, {rest}}}"#)
}

/// A study with these parameters.
fn parameters(fields: &str) -> String {
    format!(r#"{{"parameters": {{{fields}}}, "state": {{"friction": 1}}}}"#)
}

/// A study whose friction is this JSON.
fn friction(value: &str) -> String {
    study(&format!("\"state\": {{\"friction\": {value}}}"))
}

/// A study of this robot.
fn robot(fields: &str) -> String {
    study(&format!("\"state\": {{\"friction\": 1}}, \"robot\": {fields}"))
}

#[test]
fn studies_are_refused_word_for_word() {
    let urdf = std::fs::read_to_string("urdf/ramone.urdf").expect("the file");
    let description = Description::from_urdf(&urdf).expect("a description");
    let reduction = Reduction::default();
    let ramone = Robot::reduce(&description, &reduction).expect("a robot");
    let long = "1+".repeat(500_000);
    let cases = vec![
        case("no study", "[]".into(), "?"),
        case("no study", "{}".into(), "?"),
        case("no study", r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 5}}}"#.into(), "?"),
        case("no study", study(r#""state": [], "constants": {}"#), "?"),
        case("no study", study(r#""state": {}, "constant": {}"#), "?"),
        case("parameters", parameters(""), "?"),
        case(
            "parameters",
            parameters(
                r#""a": {"from": 0, "to": 1, "steps": 5}, "b": {"from": 0, "to": 1, "steps": 5}, "c": {"from": 0, "to": 1, "steps": 5}"#,
            ),
            "?",
        ),
        case("parameters", parameters(r#""a": 1"#), "?"),
        case("parameters", parameters(r#""a": {"from": 0, "to": 1}"#), "?"),
        case("parameters", parameters(r#""a": {"from": 0, "to": 1, "step": 5}"#), "?"),
        case("ranges", parameters(r#""a": {"from": 1, "to": 0, "steps": 5}"#), "?"),
        case("ranges", parameters(r#""a": {"from": 1, "to": 1, "steps": 5}"#), "?"),
        case("ranges", parameters(r#""a": {"from": -1.7e308, "to": 1.7e308, "steps": 5}"#), "?"),
        case("ranges", parameters(r#""a": {"from": 0, "to": "2*b", "steps": 5}"#), "?"),
        case("ranges", parameters(r#""a": {"from": 1, "to": 1.0000000000000002, "steps": 5}"#), "?"),
        case("steps", parameters(r#""a": {"from": 0, "to": 1, "steps": 1}"#), "?"),
        case("steps", parameters(r#""a": {"from": 0, "to": 1, "steps": 1e9}"#), "?"),
        case("steps", parameters(r#""a": {"from": 0, "to": 1, "steps": 2.5}"#), "?"),
        case("steps", parameters(r#""a": {"from": 0, "to": 1, "steps": -3}"#), "?"),
        case(
            "steps",
            parameters(r#""a": {"from": 0, "to": 1, "steps": 10000}, "b": {"from": 0, "to": 1, "steps": 10000}"#),
            "?",
        ),
        case("names", parameters(r#""leg angle": {"from": 0, "to": 1, "steps": 5}"#), "?"),
        case("names", parameters(r#""2a": {"from": 0, "to": 1, "steps": 5}"#), "?"),
        case("names", parameters(r#""": {"from": 0, "to": 1, "steps": 5}"#), "?"),
        case("names", study(r#""constants": {"a": 1}, "state": {}"#), "?"),
        case("names", parameters(r#""α": {"from": 0, "to": 1, "steps": 5}"#), "?"),
        case("constants", study(r#""constants": {"b": "c", "c": "b"}, "state": {}"#), "?"),
        case("constants", study(r#""constants": {"b": "2*a"}, "state": {}"#), "?"),
        case("constants", study(r#""constants": {"b": "infinite"}, "state": {}"#), "?"),
        case("constants", study(r#""constants": {"b": [1]}, "state": {}"#), "?"),
        case(
            "constants",
            study(&format!(
                "\"constants\": {{{}}}, \"state\": {{}}",
                (0..100_000).map(|k| format!("\"c{k}\": {k}")).collect::<Vec<_>>().join(", ")
            )),
            "?",
        ),
        case("unknown names", study(r#""constants": {"knee": 1}, "state": {"friction": "2*kne + 1"}"#), "?"),
        case("unknown names", friction("\"beta\""), "?"),
        case("unknown names", friction("\"sine(a)\""), "?"),
        case("unknown names", friction("\"infinit\""), "?"),
        case("unknown names", friction("\"α\""), "?"),
        case("expressions", friction("\"sin\""), "?"),
        case("expressions", friction("\"sin()\""), "?"),
        case("expressions", friction("\"(a\""), "?"),
        case("expressions", friction("\"\""), "?"),
        case("expressions", friction("\"1 2\""), "?"),
        case("no value", friction("\"1/(a-a)\""), "?"),
        case("no value", friction("\"sqrt(-1-a)\""), "?"),
        case("no value", friction("\"1e308*10 + a\""), "?"),
        case("no value", friction("\"nan\""), "?"),
        case("no value", friction("\"-1-a\""), "?"),
        case("size", friction(&format!("\"{}\"", "(".repeat(1_000_000))), "?"),
        case("size", friction(&format!("\"{}\"", "-".repeat(1_000_000))), "?"),
        case("size", friction(&format!("\"{long}\"")), "?"),
        case("size", friction(&format!("\"{}\"", "x".repeat(1_000_000))), "?"),
        case("size", study(&format!("\"state\": {}", "[".repeat(100_000))), "?"),
        case("robots", robot("[]"), "?"),
        case("robots", robot(r#"{"link": {}}"#), "?"),
        case("robots", robot(r#"{"links": {"left_fot": {"mass": 1}}}"#), "?"),
        case("robots", robot(r#"{"joints": {"left_hipp": {"origin": [0, 0, 0]}}}"#), "?"),
        case("robots", robot(r#"{"links": {"torso": {"weight": 1}}}"#), "?"),
        case("robot's numbers", robot(r#"{"links": {"torso": {"mass": "-1-a"}}}"#), "?"),
        case("robot's numbers", robot(r#"{"links": {"torso": {"inertia": -1}}}"#), "?"),
        case("robot's numbers", robot(r#"{"links": {"torso": {"com": [0, 1]}}}"#), "?"),
        case("robot's numbers", robot(r#"{"links": {"torso": {"radius": 0.1}}}"#), "?"),
        case("robot's numbers", robot(r#"{"joints": {"left_hip": {"origin": "a"}}}"#), "?"),
        case("no expressions", study(r#""state": {"stance": "a", "friction": 1}"#), "?"),
        case("no expressions", study(r#""state": {"held": ["2*a"], "friction": 1}"#), "?"),
        case("no expressions", study(r#""state": {"friction": {"a": 1}}"#), "?"),
        case("no expressions", study(r#""state": {"2*a": 1}"#), "?"),
        case("no expressions", study(r#""state": {"id": [1], "friction": 1}"#), "?"),
    ];
    assert_refused(cases, 60, &["sweep", "urdf/ramone.urdf", "-"], |text| {
        let study = Study::from_json(text)?;
        let defaults = Defaults::default();
        let options = Options::default();
        Model { study: &study, description: &description, reduction: &reduction, robot: &ramone, options, defaults }
            .readable()
    });
}
