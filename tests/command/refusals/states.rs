//! States and problems that are refused.

use super::{assert_refused, lines};
use crate::{RAMONE, schema};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::read::Problem;
use heelstrike::state::{Defaults, State};

/// States of RAMone, one per line.
const STATES: &str = r#"
[1]
1
"friction"
null
friction: 1
<robot name="r">
id;q_base_z
yes; no
{
{"friction": 1
{"position": {"base": {"x":
{"stance": "left_fo
{"velocity": {"base": {"x": NaN}}}
{"velocity": {"base": {"x": Infinity}}}
{"velocity": {"base": {"x": -1e999}}}
{"velocity": {"base": {"x": 01}}}
{"contacts": [{"link": "left_foot", "offset": [0, 0, 1e400]}]}
{"id": 1, "i\u0064": 2}
{"position": {"joints": {"left_hip": 1, "left_hip": 1}}}
{"position": {"base": {"x": 1, "z": 1, "x": 1}}}
{"held": ["left_hip", "left_hip"]}
{"frictoin": 1}
{"position": {"base": {"y": 0}}}
{"velocity": {"base": {"qw": 1}}}
{"position": [0, 0.44, 0]}
{"stance": "left_fot"}
{"place": "lowset"}
{"place": "lowest", "stance": "left_foot"}
{"position": {"joints": {"left_hipp": 0}}}
{"friction": {"left_leg": 1}}
{"held": ["torso"]}
{"id": null}
{"id": [1]}
{"id": {"k": 1}}
{"id": true}
{"ground": {"slope": 1.5707963267948966}}
{"ground": {"slope": -2}}
{"ground": {"slope": "steep"}}
{"ground": {"profile": [[0, 0], [1, 1e999]]}}
{"ground": {"profile": [[1, 0], [0, 0]]}}
{"ground": {"profile": [[-1e308, 0], [1e308, 0]]}}
{"ground": {"profile": []}}
{"ground": 0.1}
{"restitution": 1.5}
{"restitution": -1e-300}
{"restitution": {"left_foot": 2}}
{"restitution": "1"}
{"friction": -0.5}
{"friction": "Infinite"}
{"friction": [1]}
{"contacts": [{"link": "left_foot", "radius": -1}]}
{"contacts": [{"offset": [0, 0, 0]}]}
{"impulse": [{"link": "torso", "vector": [0, 0, 0]}]}
{"rotor_inertia": {"left_hip": -1}}
{"stance": "left_foot", "position": {"base": {"x": 0}}}
{"friction": 1, "contacts": [{"link": "left_foot", "offset": [1e200, 0, 0]}]}
{"friction": 1, "contacts": [], "velocity": {"joints": {"left_hip": 1e200}}}
{"friction": 1, "contacts": [], "velocity": {"base": {"x": -1e200}, "joints": {"left_hip": 1e9}}}
{"position": {"bases": {}}}
{"velocity": {"joints": {"left_hip": "1"}}}
{"velocity": {"base": {"z": 0}}, "stance": "left_foot"}
{"friction": {"right_fot": 1}}
{"restitution": {"default": -1}}
{"ground": {"profile": [[0, 0], [1, 0], [1, 0.2]]}}
{"ground": {"profile": [[0, 0]]}}
{"ground": {"profile": [[0, 0], [1]]}}
{"ground": {"slope": 0, "profile": [[0, 0], [1, 0]]}}
{"uncertainty": {"frict": 0.1}}
{"uncertainty": 0.1}
{"uncertainty": {"position": -0.1}}
{"uncertainty": {"velocity": {"joints": {"left_knie": 0.1}}}}
{"uncertainty": {"friction": {"left_foot": "infinite"}}}
{"uncertainty": {"rotor_inertia": {"left_hip": -1}}}
{"stance": "left_foot", "uncertainty": {"velocity": {"base": {"x": 0.1}}}}
{"held": ["left_knie"]}
{"contacts": [{"link": "left_foot", "offset": [0, 0]}]}
{"impulse": [{"link": "torso"}]}
{"id": 1, "id": 2}
{"position": {"joints": {"left_hip": 1, "left_hip": 2}}}
{"position": {"base": {"pitch": 1e999}}}
{"position": {"base": {"pitch": NaN}}}
{"friction": 0.8 "place": "lowest"}
{"friction": 0,8}
{friction: 0.8}
id,q_base_x,v_base_x
{"position": {"base": {"x": null}}}
{"position": {"base": [0, 1, 0]}}
{"position": {"base": {"yaw": 0}}}
{"delassus": [[1]]}
{"parameters": {}}
{"mu": 1}
{"resting_speed": 0.01}
"#;

#[test]
fn states_are_refused_word_for_word() {
    let robot = &schema::RAMONE.robot;
    let feet = |count| vec![r#"{"link": "left_foot"}"#; count].join(", ");
    let cases = lines(STATES, "@").chain([
        String::new(),
        "{\"id\": 1,\n \"id\": 2}".into(),
        "[".repeat(200_000),
        "{\"position\":".repeat(200_000),
        format!("{{\"position\": {}{}}}", "[".repeat(200), "]".repeat(200)),
        format!("{{\"{}\": 1}}", "x".repeat(1_000_000)),
        format!("{{\"id\": \"{0}\", \"frictoin\": 1, \"more\": \"{0}\"}}", "x".repeat(500_000)),
        format!("{{\"stance\": \"{}\"}}", "é".repeat(500_000)),
        format!("{{\"friction\": 1, \"contacts\": [{}]}}", feet(200_000)),
        format!("{{\"friction\": 1, \"contacts\": [{}]}}", feet(17)),
    ]);
    assert_refused("states", cases, &["impact", RAMONE, "-"], |text| {
        let state = State::from_json(text, robot, &Defaults::default())?;
        Pipeline::new(robot, Options::default()).impact(&state)?.into_analysis().map(drop)
    });
}

/// Contact problems, one per line.
const PROBLEMS: &str = r#"
[[]]
{"delassus": [[2, 1], [1
{"friction": 1}
{"delassus": [[1, 0], [0, 1]], "friction": 1}
{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]]}
{"delassus": [[1, 0], [0, 1]], "velocity_before": [0, -1], "friction": 1}
{"delassus": [[1, 0]], "velocity_before": [[0, -1]], "friction": 1}
{"delassus": [[1, 0], [0]], "velocity_before": [[0, -1]], "friction": 1}
{"delassus": [], "velocity_before": [[0, -1]], "friction": 1}
{"delassus": [[1, 0], [0, "1"]], "velocity_before": [[0, -1]], "friction": 1}
{"delassus": [[2, 1], [0.9, 2]], "velocity_before": [[0, -1]], "friction": 1}
{"delassus": [[1, 2], [2, 1]], "velocity_before": [[0, -1]], "friction": 1}
{"delassus": [[1, 0], [0, -1]], "velocity_before": [[0, -1]], "friction": 1}
{"mass_matrix": [[0]], "velocity": [1], "friction": 1, "contact_jacobian": [[1], [0]]}
{"mass_matrix": [[1, 0], [0, 1]], "velocity": [1], "friction": 1, "contact_jacobian": [[1], [0]]}
{"delassus": [[1e999, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": 1}
{"mass_matrix": [[1]], "velocity": [1], "friction": 1, "contact_jacobian": [[1e200], [1e200]]}
{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0]], "friction": 1}
{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": [1, 1]}
{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": [-1]}
{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": 1, "restitution": 2}
{"mass_matrix": [[1]], "contact_jacobian": [[1]], "velocity": [1], "friction": 1}
{"mass_matrix": [[1]], "delassus": [[1, 0], [0, 1]], "friction": 1}
{"position": {"base": {"x": 0}}, "friction": 1}
"#;

#[test]
fn problems_are_refused_word_for_word() {
    let many = vec!["[1]"; 1_000_000].join(",");
    let many = format!(r#"{{"mass_matrix": [[1]], "velocity": [1], "friction": 1, "contact_jacobian": [{many}]}}"#);
    assert_refused("problems", lines(PROBLEMS, "@").chain([many]), &["solve", "-"], |text| {
        let problem = Problem::from_json(text, &Defaults::default())?;
        heelstrike::impact::analyze(&problem.contact, heelstrike::impact::ListedRejections::Nothing).map(drop)
    });
}
