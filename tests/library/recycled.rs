//! A pipeline reuses memory between answers, but no answer depends on those before.

use crate::support::impact::ramone;
use heelstrike::pipeline::{Aspect, Options, Pipeline};
use heelstrike::{Defaults, Friction, State};

/// Questions that differ in contacts, stance, uncertainty, forces and notes, so that data left by one shows in the
/// next.
const QUESTIONS: [(Aspect, &str); 8] = [
    (Aspect::Impact, include_str!("../../examples/ramone_measured.json")),
    (Aspect::Impact, r#"{"position": {"base": {"z": 2}}, "velocity": {"base": {"x": 1}}}"#),
    (Aspect::Forces, include_str!("../../examples/ramone_stands.json")),
    (Aspect::Impact, r#"{"position": {"base": {"z": -2}}}"#),
    (Aspect::Impact, include_str!("../../examples/ramone.json")),
    (
        Aspect::Impact,
        r#"{"velocity": {"base": {"z": -1}}, "place": "lowest", "impulse": [{"link": "torso", "vector": [1, 0]}]}"#,
    ),
    (Aspect::Forces, r#"{"position": {"base": {"z": 2}}}"#),
    (
        Aspect::Impact,
        r#"{"velocity": {"base": {"x": 1, "z": -1}}, "place": "lowest", "friction": {"default": 0, "left_foot": 0.1}}"#,
    ),
];

#[test]
fn answers_do_not_depend_on_those_before() {
    let robot = ramone();
    let options = Options { matrices: true, friction_needed: true, explain_up_to: 2, ..Options::default() };
    let defaults = Defaults { friction: Some(Friction::Finite(0.5)), ..Defaults::default() };
    let ask = |pipeline: &mut Pipeline, aspect, text| {
        let state = State::from_json(text, &robot, &defaults).unwrap_or_else(|error| panic!("{error}\n{text}"));
        if aspect == Aspect::Forces { pipeline.forces(&state) } else { pipeline.impact(&state) }
    };
    let mut kept = Pipeline::new(&robot, options.clone());
    let (mut answered, mut refused) = (0, 0);
    // Every ordered pair of questions.
    for (aspect, text) in QUESTIONS.iter().flat_map(|first| QUESTIONS.iter().flat_map(move |next| [first, next])) {
        let found = ask(&mut kept, *aspect, text);
        let expected = ask(&mut Pipeline::new(&robot, options.clone()), *aspect, text);
        assert_eq!(format!("{found:?}"), format!("{expected:?}"), "{text}");
        match found {
            Ok(impact) => {
                answered += 1;
                kept.recycle(impact);
            }
            Err(_) => refused += 1,
        }
    }
    assert!(answered > 100 && refused == 16, "{answered} {refused}");
}
