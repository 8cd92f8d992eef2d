//! The paper's models and states, and their reference values in `data/paper.json` (40 digits).

use heelstrike::Mode;
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Lower leg, knee to foot center, and upper leg of RAMone \[m\].
const SHANK: f64 = 0.2385;
const THIGH: f64 = 0.2;

/// A model of the reference and the URDF file it is read from.
pub struct Model {
    pub name: &'static str,
    pub urdf: &'static str,
    /// The legs' moment of inertia, which replaces that of the file.
    pub inertia: Option<&'static str>,
    pub kneed: bool,
}

pub const MODELS: [Model; 6] = [
    Model { name: "minimalistic", urdf: "minimalistic", inertia: None, kneed: false },
    Model { name: "pdw_j0.04", urdf: "pdw", inertia: None, kneed: false },
    Model { name: "pdw_j0.24", urdf: "pdw", inertia: Some("0.24"), kneed: false },
    Model { name: "pdw_j0.44", urdf: "pdw", inertia: Some("0.44"), kneed: false },
    Model { name: "ramone_table1_script_precision", urdf: "ramone", inertia: None, kneed: true },
    Model { name: "ramone_as_computed_in_paper", urdf: "ramone_paper", inertia: None, kneed: true },
];

/// Reference values of a model: states by leg angle, and regions `[start, "modes|modes"]` by friction.
#[derive(Deserialize)]
pub struct Reference {
    pub at: BTreeMap<String, At>,
    pub regions: BTreeMap<String, Vec<(String, String)>>,
}

/// One state; contact rows are [trailing x, y, leading x, y].
#[derive(Deserialize)]
pub struct At {
    pub mass_matrix: Vec<Vec<f64>>,
    pub contact_jacobian: Vec<Vec<f64>>,
    pub delassus: Vec<Vec<f64>>,
    pub contact_velocity_before: [f64; 4],
    pub three_cases: BTreeMap<String, [f64; 4]>,
    pub outcomes: BTreeMap<String, Vec<Expected>>,
    pub pose: Option<Pose>,
}

#[derive(Deserialize)]
pub struct Expected {
    pub modes: [Mode; 2],
    pub impulse: [f64; 4],
    pub velocity_after: [f64; 4],
}

#[derive(Deserialize)]
pub struct Pose {
    hip: [f64; 2],
    knee: f64,
    pitch: f64,
}

pub static REFERENCE: LazyLock<BTreeMap<String, Reference>> =
    LazyLock::new(|| serde_json::from_str(include_str!("../data/paper.json")).expect("the reference is readable"));

impl Model {
    /// The trailing and the leading link.
    pub fn feet(&self) -> [&'static str; 2] {
        if self.kneed { ["left_foot", "right_foot"] } else { ["left_leg", "right_leg"] }
    }

    /// The state at leg angle `alpha`: the trailing foot rests on the ground, the robot turns about it at 1 rad/s
    /// counter-clockwise, and the joints are at rest. `pose` replaces the angles that are computed here.
    pub fn state(&self, alpha: f64, pose: Option<&Pose>, friction: &str) -> Value {
        let friction = friction.parse().map_or(json!(friction), |number: f64| json!(number));
        let (pitch, joints) = if self.kneed {
            let bend = (SHANK / THIGH).atan();
            let computed = Pose { hip: [bend + alpha, bend - alpha], knee: -FRAC_PI_2, pitch: 0.0 };
            let Pose { hip: [trailing, leading], knee, pitch } = *pose.unwrap_or(&computed);
            let joints = json!({"left_hip": trailing, "left_knee": knee, "right_hip": leading, "right_knee": knee});
            (-pitch, joints)
        } else {
            // Angles from straight down: trailing +alpha, leading -alpha; the root is the trailing leg.
            (-alpha, json!({"hip": -2.0 * alpha}))
        };
        json!({
            "id": format!("{} {alpha} {friction}", self.name),
            "position": {"base": {"pitch": pitch}, "joints": joints},
            "velocity": {"base": {"pitch": -1.0}},
            "stance": self.feet()[0],
            "friction": friction,
        })
    }
}
