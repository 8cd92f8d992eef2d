//! The studies of the paper's models: the leg angle `alpha`, each model pivoting about its trailing foot at 1 rad/s.

use serde_json::{Value, json};

pub const STEPS: usize = 50;

/// From where to where the leg angle goes; at 0 both feet are one point.
pub const RANGE: [f64; 2] = [0.001, 1.57];

/// Two straight legs; with `inertia`, that of both legs.
pub fn straight(inertia: Option<f64>) -> Value {
    let mut study = json!({
        "parameters": {"alpha": {"from": RANGE[0], "to": RANGE[1], "steps": STEPS}},
        "state": {
            "position": {"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}},
            "velocity": {"base": {"pitch": -1}},
            "stance": "left_leg",
            "friction": "infinite",
        },
    });
    if let Some(inertia) = inertia {
        study["constants"] = json!({"j": inertia});
        study["robot"] = json!({"links": {"left_leg": {"inertia": "j"}, "right_leg": {"inertia": "j"}}});
    }
    study
}

/// RAMone: knees at a right angle, the main body upright.
pub fn kneed() -> Value {
    json!({
        "parameters": {"alpha": {"from": RANGE[0], "to": RANGE[1], "steps": STEPS}},
        "constants": {"upper": 0.2, "lower": 0.2385, "knee": "-pi/2", "bend": "atan2(lower, upper)"},
        "state": {
            "position": {"joints": {
                "left_hip": "bend + alpha", "left_knee": "knee", "right_hip": "bend - alpha", "right_knee": "knee",
            }},
            "velocity": {"base": {"pitch": -1}},
            "stance": "left_foot",
            "friction": "infinite",
        },
    })
}
