//! Studies that are refused as a whole.

use super::{assert_refused, case};
use heelstrike::Robot;
use heelstrike::description::Description;
use heelstrike::pipeline::Options;
use heelstrike::robot::Reduction;
use heelstrike::state::Defaults;
use heelstrike::sweep::{RobotStudy, Study};

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
        case("no study", "[]".into(), "1:1: expected an object, found a list"),
        case(
            "no study",
            "{}".into(),
            "1:1: \"parameters\" is missing | as in \"parameters\": {\"alpha\": {\"from\": 0, \"to\": 1, \"steps\": 50}}",
        ),
        case(
            "no study",
            r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 5}}}"#.into(),
            "1:1: \"state\" is missing | as in `impact`, with expressions where numbers stand",
        ),
        case("no study", study(r#""state": [], "constants": {}"#), "1:57: state: expected an object, found a list"),
        case(
            "no study",
            study(r#""state": {}, "constant": {}"#),
            "1:70: constant: unknown field \"constant\" | did you mean constants?",
        ),
        case(
            "parameters",
            parameters(""),
            "1:2: parameters: a study varies one or two parameters, not 0 | make the others constants",
        ),
        case(
            "parameters",
            parameters(
                r#""a": {"from": 0, "to": 1, "steps": 5}, "b": {"from": 0, "to": 1, "steps": 5}, "c": {"from": 0, "to": 1, "steps": 5}"#,
            ),
            "1:2: parameters: a study varies one or two parameters, not 3 | make the others constants",
        ),
        case("parameters", parameters(r#""a": 1"#), "1:17: parameters.a: expected an object, found a number"),
        case(
            "parameters",
            parameters(r#""a": {"from": 0, "to": 1}"#),
            "1:17: parameters.a: \"steps\" is missing | a parameter is {\"from\": 0, \"to\": 1, \"steps\": 50}",
        ),
        case(
            "parameters",
            parameters(r#""a": {"from": 0, "to": 1, "step": 5}"#),
            "1:43: parameters.a.step: unknown field \"step\" | did you mean steps?",
        ),
        case(
            "ranges",
            parameters(r#""a": {"from": 1, "to": 0, "steps": 5}"#),
            "1:17: parameters.a: the range from 1.0 to 0.0 is empty or endless | \"from\" has to be less than \"to\"",
        ),
        case(
            "ranges",
            parameters(r#""a": {"from": 1, "to": 1, "steps": 5}"#),
            "1:17: parameters.a: the range from 1.0 to 1.0 is empty or endless | \"from\" has to be less than \"to\"",
        ),
        case(
            "ranges",
            parameters(r#""a": {"from": -1.7e308, "to": 1.7e308, "steps": 5}"#),
            "1:17: parameters.a: the range from -1.7e308 to 1.7e308 is empty or endless | \"from\" has to be less than \"to\"",
        ),
        case(
            "ranges",
            parameters(r#""a": {"from": 0, "to": "2*b", "steps": 5}"#),
            "1:43: parameters.a.to: the expression has no value: unknown variable: b | only pi, e and functions such as sin and atan2 are known here",
        ),
        case(
            "ranges",
            parameters(r#""a": {"from": 1, "to": 1.0000000000000002, "steps": 5}"#),
            "1:17: parameters.a: the range from 1.0 to 1.0000000000000002 has no room for 5 different samples | take fewer of them, or a wider range",
        ),
        case(
            "steps",
            parameters(r#""a": {"from": 0, "to": 1, "steps": 1}"#),
            "1:43: parameters.a.steps: the number of samples must be a whole number from 2 to 10000000, not 1",
        ),
        case(
            "steps",
            parameters(r#""a": {"from": 0, "to": 1, "steps": 1e9}"#),
            "1:43: parameters.a.steps: the number of samples must be a whole number from 2 to 10000000, not 1000000000",
        ),
        case(
            "steps",
            parameters(r#""a": {"from": 0, "to": 1, "steps": 2.5}"#),
            "1:43: parameters.a.steps: the number of samples must be a whole number from 2 to 10000000, not 2.5",
        ),
        case(
            "steps",
            parameters(r#""a": {"from": 0, "to": 1, "steps": -3}"#),
            "1:43: parameters.a.steps: the number of samples must be a whole number from 2 to 10000000, not -3",
        ),
        case(
            "steps",
            parameters(r#""a": {"from": 0, "to": 1, "steps": 10000}, "b": {"from": 0, "to": 1, "steps": 10000}"#),
            "1:2: parameters: more than 10000000 samples are not accepted",
        ),
        case(
            "names",
            parameters(r#""leg angle": {"from": 0, "to": 1, "steps": 5}"#),
            "1:17: parameters.leg angle: \"leg angle\" is no name that an expression can use | take letters, digits and _, no digit first",
        ),
        case(
            "names",
            parameters(r#""2a": {"from": 0, "to": 1, "steps": 5}"#),
            "1:17: parameters.2a: \"2a\" is no name that an expression can use | take letters, digits and _, no digit first",
        ),
        case(
            "names",
            parameters(r#""": {"from": 0, "to": 1, "steps": 5}"#),
            "1:1: parameters.: \"\" is no name that an expression can use | take letters, digits and _, no digit first",
        ),
        case(
            "names",
            study(r#""constants": {"a": 1}, "state": {}"#),
            "1:17: parameters.a: name \"a\" is given twice | it is a constant already",
        ),
        case(
            "names",
            parameters(r#""α": {"from": 0, "to": 1, "steps": 5}"#),
            "1:17: parameters.α: \"α\" is no name that an expression can use | take letters, digits and _, no digit first",
        ),
        case(
            "constants",
            study(r#""constants": {"b": "c", "c": "b"}, "state": {}"#),
            "1:57: constants: each of these constants needs another one, or itself: b, c | give one of them a number",
        ),
        case(
            "constants",
            study(r#""constants": {"b": "2*a"}, "state": {}"#),
            "1:79: constants.b: the expression has no value: unknown variable: a | a is a parameter, and constants do not vary: write it into the state",
        ),
        case(
            "constants",
            study(r#""constants": {"b": "infinite"}, "state": {}"#),
            "1:77: constants.b: the expression has no value: unknown variable: infinite | only pi, e and functions such as sin and atan2 are known here",
        ),
        case(
            "constants",
            study(r#""constants": {"b": [1]}, "state": {}"#),
            "1:71: constants.b: expected a number or an expression, found a list",
        ),
        case(
            "constants",
            study(&format!(
                "\"constants\": {{{}}}, \"state\": {{}}",
                (0..100_000).map(|k| format!("\"c{k}\": {k}")).collect::<Vec<_>>().join(", ")
            )),
            "1:57: constants: more than 256 constants are not accepted",
        ),
        case(
            "unknown names",
            study(r#""constants": {"knee": 1}, "state": {"friction": "2*kne + 1"}"#),
            "1:108: state.friction: the expression has no value: unknown variable: kne | did you mean knee?",
        ),
        case(
            "unknown names",
            friction("\"beta\""),
            "1:80: state.friction: the expression has no value: unknown variable: beta | known here are a, beside pi, e and functions such as sin and atan2",
        ),
        case(
            "unknown names",
            friction("\"sine(a)\""),
            "1:80: state.friction: the expression has no value: unknown function: sine | did you mean sin?",
        ),
        case(
            "unknown names",
            friction("\"infinit\""),
            "1:80: state.friction: the expression has no value: unknown variable: infinit | did you mean infinite?",
        ),
        case(
            "unknown names",
            friction("\"α\""),
            "1:80: state.friction: the expression has no value: unexpected character: α",
        ),
        case(
            "expressions",
            friction("\"sin\""),
            "1:80: state.friction: the expression has no value: unknown variable: sin | sin is a function, as in sin(1)",
        ),
        case(
            "expressions",
            friction("\"sin()\""),
            "1:80: state.friction: the expression has no value: wrong number of arguments: sin()",
        ),
        case(
            "expressions",
            friction("\"(a\""),
            "1:80: state.friction: the expression has no value: unclosed parenthesis: (",
        ),
        case(
            "expressions",
            friction("\"\""),
            "1:68: state.friction: the expression has no value: unexpected end of expression",
        ),
        case(
            "expressions",
            friction("\"1 2\""),
            "1:82: state.friction: the expression has no value: unexpected token: 2",
        ),
        case(
            "no value",
            friction("\"1/(a-a)\""),
            "1:80: state.friction: the expression has no value: division by zero: 1/(a-a)",
        ),
        case(
            "no value",
            friction("\"sqrt(-1-a)\""),
            "1:80: state.friction: the expression has no value: operand out of domain: sqrt(-1-a)",
        ),
        case(
            "no value",
            friction("\"1e308*10 + a\""),
            "1:80: state.friction: the expression has no value: overflow: 1e308*10",
        ),
        case(
            "no value",
            friction("\"nan\""),
            "1:80: state.friction: the expression has no value: unknown variable: nan | known here are a, beside pi, e and functions such as sin and atan2",
        ),
        case("no value", friction("\"-1-a\""), "1:79: state.friction: friction must be 0 or more, not -1"),
        case(
            "size",
            friction(&format!("\"{}\"", "(".repeat(1_000_000))),
            "1:112: state.friction: the expression has no value: expression nested too deeply: (",
        ),
        case(
            "size",
            friction(&format!("\"{}\"", "-".repeat(1_000_000))),
            "1:112: state.friction: the expression has no value: expression nested too deeply: -",
        ),
        case(
            "size",
            friction(&format!("\"{long}\"")),
            "1:1000080: state.friction: the expression has no value: unexpected end of expression",
        ),
        case(
            "size",
            friction(&format!("\"{}\"", "x".repeat(1_000_000))),
            "1:80: state.friction: the expression has no value: unknown variable: xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx | known here are a, beside pi, e and functions such as sin and atan2",
        ),
        case("size", study(&format!("\"state\": {}", "[".repeat(100_000))), "1:192: brackets are nested too deep"),
        case("robots", robot("[]"), "1:83: robot: expected an object, found a list"),
        case("robots", robot(r#"{"link": {}}"#), "1:93: robot.link: unknown field \"link\" | did you mean links?"),
        case(
            "robots",
            robot(r#"{"links": {"left_fot": {"mass": 1}}}"#),
            "1:103: robot.links.left_fot: the robot has no link named \"left_fot\" | did you mean left_foot?",
        ),
        case(
            "robots",
            robot(r#"{"joints": {"left_hipp": {"origin": [0, 0, 0]}}}"#),
            "1:104: robot.joints.left_hipp: the robot has no joint named \"left_hipp\" | did you mean left_hip?",
        ),
        case(
            "robots",
            robot(r#"{"links": {"torso": {"weight": 1}}}"#),
            "1:113: robot.links.torso.weight: unknown field \"weight\" | the fields here are mass, com, inertia, radius",
        ),
        case(
            "robot's numbers",
            robot(r#"{"links": {"torso": {"mass": "-1-a"}}}"#),
            "1:121: robot.links.torso.mass: mass must be 0 or more, not -1",
        ),
        case(
            "robot's numbers",
            robot(r#"{"links": {"torso": {"inertia": -1}}}"#),
            "1:113: robot.links.torso.inertia: the moment of inertia must be 0 or more, not -1",
        ),
        case(
            "robot's numbers",
            robot(r#"{"links": {"torso": {"com": [0, 1]}}}"#),
            "1:113: robot.links.torso.com: expected a list of 3 numbers, found 2 entries",
        ),
        case(
            "robot's numbers",
            robot(r#"{"links": {"torso": {"radius": 0.1}}}"#),
            "1:113: robot.links.torso.radius: the link has no round collision shape | a radius belongs to spheres, cylinders and capsules; name the link that carries the foot",
        ),
        case(
            "robot's numbers",
            robot(r#"{"joints": {"left_hip": {"origin": "a"}}}"#),
            "1:127: robot.joints.left_hip.origin: expected a list of 3 numbers, found a string",
        ),
        case(
            "no expressions",
            study(r#""state": {"stance": "a", "friction": 1}"#),
            "1:77: state.stance: the robot has no link named \"a\"",
        ),
        case(
            "no expressions",
            study(r#""state": {"held": ["2*a"], "friction": 1}"#),
            "1:76: state.held[0]: the robot has no joint named \"2*a\"",
        ),
        case(
            "no expressions",
            study(r#""state": {"friction": {"a": 1}}"#),
            "1:80: state.friction.a: the robot has no link named \"a\"",
        ),
        case(
            "no expressions",
            study(r#""state": {"2*a": 1}"#),
            "1:67: state.2*a: unknown field \"2*a\" | the fields here are id, position, velocity, friction, restitution, ground, stance, held, rotor_inertia, contacts, loops, uncertainty, impulse",
        ),
        case(
            "no expressions",
            study(r#""state": {"id": [1], "friction": 1}"#),
            "1:67: state.id: expected a string or a number, found a list",
        ),
    ];
    assert_refused(cases, 60, &["sweep", "urdf/ramone.urdf", "-"], |text| {
        let study = Study::from_json(text)?;
        let defaults = Defaults::default();
        let options = Options::default();
        RobotStudy {
            study: &study,
            description: &description,
            reduction: &reduction,
            robot: &ramone,
            options,
            defaults,
        }
        .readable()
    });
}
