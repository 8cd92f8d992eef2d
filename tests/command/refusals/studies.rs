//! Studies that are refused as a whole.

use super::{assert_refused, lines};
use crate::schema::studies::read;

/// Parameters, one set per line.
const PARAMETERS: &str = r#"
"a": {"from": 0, "to": 1, "steps": 5}, "b": {"from": 0, "to": 1, "steps": 5}, "c": {"from": 0, "to": 1, "steps": 5}
"a": 1
"a": {"from": 0, "to": 1}
"a": {"from": 0, "to": 1, "step": 5}
"a": {"from": 1, "to": 0, "steps": 5}
"a": {"from": 1, "to": 1, "steps": 5}
"a": {"from": -1.7e308, "to": 1.7e308, "steps": 5}
"a": {"from": 0, "to": "2*b", "steps": 5}
"a": {"from": 1, "to": 1.0000000000000002, "steps": 5}
"a": {"from": 0, "to": 1, "steps": 1}
"a": {"from": 0, "to": 1, "steps": 1e9}
"a": {"from": 0, "to": 1, "steps": 2.5}
"a": {"from": 0, "to": 1, "steps": -3}
"a": {"from": 0, "to": 1, "steps": 10000}, "b": {"from": 0, "to": 1, "steps": 10000}
"leg angle": {"from": 0, "to": 1, "steps": 5}
"2a": {"from": 0, "to": 1, "steps": 5}
"": {"from": 0, "to": 1, "steps": 5}
"α": {"from": 0, "to": 1, "steps": 5}
"region": {"from": 0, "to": 1, "steps": 5}
"#;

/// Values of friction, one per line.
const FRICTION: &str = r#"
"beta"
"sine(a)"
"infinit"
"α"
"sin"
"sin()"
"(a"
""
"1 2"
"1/(a-a)"
"sqrt(-1-a)"
"1e308*10 + a"
"nan"
"-1-a"
"#;

/// Values of the field `robot`, one per line.
const ROBOT: &str = r#"
[]
{"link": {}}
{"links": {"left_fot": {"mass": 1}}}
{"joints": {"left_hipp": {"origin": [0, 0, 0]}}}
{"links": {"torso": {"weight": 1}}}
{"links": {"torso": {"mass": "-1-a"}}}
{"links": {"torso": {"inertia": -1}}}
{"links": {"torso": {"com": [0, 1]}}}
{"links": {"torso": {"radius": 0.1}}}
{"joints": {"left_hip": {"origin": "a"}}}
"#;

/// Fields besides the parameter, one set per line.
const FIELDS: &str = r#"
"state": [], "constants": {}
"state": {}, "constant": {}
"constants": {"a": 1}, "state": {}
"constants": {"b": "c", "c": "b"}, "state": {}
"constants": {"b": "2*a"}, "state": {}
"constants": {"b": "infinite"}, "state": {}
"constants": {"b": [1]}, "state": {}
"constants": {"knee": 1}, "state": {"friction": "2*kne + 1"}
"state": {"stance": "a", "friction": 1}
"state": {"held": ["2*a"], "friction": 1}
"state": {"friction": {"a": 1}}
"state": {"2*a": 1}
"state": {"id": [1], "friction": 1}
"#;

#[test]
fn studies_are_refused_word_for_word() {
    // Studies of the parameter a from 0 to 1, and some with other parameters.
    const STUDY: &str = r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 5}}, @}"#;
    const FRICTION_OF: &str = r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 5}}, "state": {"friction": @}}"#;
    const ROBOT_OF: &str =
        r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 5}}, "state": {"friction": 1}, "robot": @}"#;
    const PARAMETERS_OF: &str = r#"{"parameters": {@}, "state": {"friction": 1}}"#;
    let quoted = |text: &str, count: usize| FRICTION_OF.replace('@', &format!("\"{}\"", text.repeat(count)));
    let constants: Vec<String> = (0..100_000).map(|k| format!("\"c{k}\": {k}")).collect();
    let cases = ["[]", "{}", r#"{"parameters": {"a": {"from": 0, "to": 1, "steps": 5}}}"#].map(str::to_owned);
    let cases = cases
        .into_iter()
        .chain(lines(PARAMETERS, PARAMETERS_OF))
        .chain(lines(FRICTION, FRICTION_OF))
        .chain(lines(ROBOT, ROBOT_OF))
        .chain(lines(FIELDS, STUDY))
        .chain([
            PARAMETERS_OF.replace('@', ""),
            STUDY.replace('@', &format!("\"constants\": {{{}}}, \"state\": {{}}", constants.join(", "))),
            quoted("(", 1_000_000),
            quoted("-", 1_000_000),
            quoted("1+", 500_000),
            quoted("x", 1_000_000),
            STUDY.replace('@', &format!("\"state\": {}", "[".repeat(100_000))),
        ]);
    assert_refused("studies", cases, &["sweep", "urdf/ramone.urdf", "-"], read);
}
