//! Studies of the minimalistic biped as text.

use crate::answer::{accepted, check_refusal};
use crate::choices::{Choices, field_names};
use crate::state::state_of;
use crate::support::subject::Subject;
use crate::watch::watched_for;
use heelstrike::Robot;
use heelstrike::read::documents::utf8;
use heelstrike::sweep::{Study, Survey, Workers};
use serde_json::{Value, json};
use std::sync::LazyLock;
use std::time::Duration;

crate::target!(any_study_is_answered_or_refused, 60, 0.1, check);

static BIPED: LazyLock<Subject> =
    LazyLock::new(|| Subject::new("minimalistic", include_str!("../../urdf/minimalistic.urdf")));

/// Words that mean something in a study.
static WORDS: LazyLock<String> = LazyLock::new(|| {
    field_names()
        + " left_leg hip alpha j 2 0.5 -1 1e999 1e-300 pi e sin(alpha) sqrt(alpha) 1/alpha alpha^2 atan2(alpha,j)
    (((( ---- infinite é"
});

/// A study with every field.
const FULL: &str = r#"{"parameters": {"alpha": {"from": "pi/20", "to": 1.5, "steps": 4}}, "constants": {"j": 0.04, "v": "-(1 + j)"},
 "state": {"id": 1, "position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}}, "velocity": {"base": {"pitch": "v"}},
  "stance": "left_leg", "friction": {"default": "0.2 + alpha", "left_leg": "infinite"}, "restitution": "j", "ground": {"slope": "j*alpha"}},
 "robot": {"links": {"left_leg": {"mass": "1 + alpha", "com": [0, 0, "-0.5*alpha"], "inertia": "j", "radius": "0.01*alpha"}},
  "joints": {"hip": {"origin": ["0.1*alpha", 0, 0]}}}}"#;

/// The text of a study whose state is mostly a good one, of which some numbers vary.
fn study_of(robot: &Robot, choices: &mut Choices) -> String {
    let state = state_of(robot, choices);
    let Ok(mut state) = serde_json::from_str(&state) else { return state };
    vary(&mut state, choices);
    let (from, range) = (choices.real(), choices.pick(&[1.0, 3.0, 1e-3, 1e-9]));
    let parameters = json!({"alpha": {"from": from, "to": from + range, "steps": 4}});
    let robot = json!({"links": {"left_leg": {"inertia": "0.01*alpha^2", "mass": "1 + j*alpha^2"}}});
    let mut study = json!({"parameters": parameters, "constants": {"j": 0.04}, "state": state});
    if choices.once_in(4) {
        study["robot"] = robot;
    }
    study.to_string()
}

/// Writes expressions in place of some numbers.
fn vary(value: &mut Value, choices: &mut Choices) {
    match value {
        Value::Number(number) if choices.once_in(3) => {
            let expression = choices.pick(&["alpha", "j*alpha", "-alpha^2", "sin(alpha)", "sqrt(alpha)", "1/alpha"]);
            *value = format!("{number} + {expression}").into();
        }
        Value::Array(entries) => entries.iter_mut().for_each(|entry| vary(entry, choices)),
        Value::Object(fields) => fields.values_mut().for_each(|field| vary(field, choices)),
        _ => {}
    }
}

/// What a study may take of a processor: of each sample, thousands of states are asked for.
const SLOW: Duration = Duration::from_secs(20);

/// More samples than this are not surveyed: studies are as long as they say.
const MOST_SAMPLES: usize = 20;

fn check(bytes: &[u8]) -> bool {
    let mut choices = Choices::new(bytes);
    let studies = [include_str!("../../examples/paper/figures_3_and_6.json"), FULL];
    let text = choices.text(&studies, &WORDS, |choices| study_of(&BIPED.robot, choices));
    let case = String::from_utf8_lossy(&text);
    let study = || accepted(utf8(&text).and_then(Study::from_json), &case);
    watched_for(SLOW, &case, || study().is_some_and(|study| survey(&study, &case)))
}

fn survey(study: &Study, case: &str) -> bool {
    let model = BIPED.model(study);
    let [parameter] = study.parameters() else { return false };
    if accepted(model.has_own_friction(), case).is_none() || parameter.steps > MOST_SAMPLES {
        return false;
    }
    let Survey { regions, borders, .. } = Survey::of(&model, Workers { threads: 1, done: &|| () });
    let ends = (regions.first().map(|region| region.from), regions.last().map(|region| region.to));
    assert_eq!(ends, (Some(parameter.from), Some(parameter.to)), "{case}");
    assert!(regions.iter().all(|region| region.from < region.to), "{case}");
    assert!(regions.windows(2).all(|pair| pair[0].to == pair[1].from && pair[0].regime != pair[1].regime), "{case}");
    assert_eq!(borders.len() + 1, regions.len(), "{case}");
    regions.iter().filter_map(|region| region.refused.as_ref()).for_each(|error| check_refusal(error, case));
    regions.iter().any(|region| region.refused.is_none())
}
