//! Recorded gaits (`data/gaits`) through the binary, on the robots' files as others wrote them: every outcome of the
//! reference states, and the touchdowns found in the tables, planar and in three dimensions, with options as a user
//! gives them.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use serde_json::Value;

use crate::support::answers::answers;
use crate::support::command::{heelstrike, read};
use crate::support::scaled::{Differences, largest};

const FRICTIONS: [&str; 3] = ["0.4", "0.8", "infinite"];

/// Of the largest velocity or impulse: Delassus matrices here have conditions up to 1e4.
const TOLERANCE: f64 = 1e-12;

/// A gait and how its robot is given.
struct Gait {
    name: &'static str,
    /// The robot's file, then feet for a robot without shapes.
    robot: &'static [&'static str],
}

const RABBIT: Gait = Gait {
    name: "rabbit_walk",
    robot: &["robots/rabbit/five_link_walker.urdf", "--contact=right_shin:0,0,0.4", "--contact=left_shin:0,0,0.4"],
};
const A1: Gait = Gait { name: "a1_walk", robot: &["robots/a1/a1.urdf"] };
const H1_WALK: Gait = Gait { name: "h1_walk", robot: &["robots/h1/h1.urdf"] };
const H1_RUN: Gait = Gait { name: "h1_run", robot: &["robots/h1/h1.urdf"] };

#[derive(Deserialize)]
struct Reference {
    states: Vec<Expected>,
}

#[derive(Deserialize)]
struct Expected {
    rule: String,
    csv_row: usize,
    shift_z: f64,
    striking: String,
    touching: Vec<String>,
    state: Value,
    redundant: bool,
    by_friction: BTreeMap<String, Outcomes>,
}

#[derive(Deserialize)]
struct Outcomes {
    outcomes: Vec<Outcome>,
}

/// Redundant contacts have no impulses there, and a margin of the velocities alone.
#[derive(Deserialize)]
struct Outcome {
    modes: Vec<String>,
    impulse: Option<Vec<[f64; 2]>>,
    velocity_after: Vec<[f64; 2]>,
    margin: Option<f64>,
}

impl Expected {
    /// Whether it is this touchdown that was found: the same foot at the same row.
    fn is(&self, found: &Value) -> bool {
        let touchdown = &found["touchdown"];
        touchdown["row"] == self.csv_row && touchdown["striking"].as_str().map(link) == Some(link(&self.striking))
    }
}

fn path(name: &str) -> String {
    format!("tests/data/{name}")
}

impl Gait {
    fn reference(&self) -> Vec<Expected> {
        let text = read(&path(&format!("gaits/{}.reference.json", self.name)));
        let Reference { states } = serde_json::from_str(&text).expect("the reference is readable");
        states
    }

    fn outcomes_are_those_of_the_reference(&self) {
        let expected = self.reference();
        let states: Vec<Value> = expected.iter().map(|expected| expected.state.clone()).collect();
        let mut differences = Differences::default();
        for friction in FRICTIONS {
            let answers = answers(&["batch", &path(self.robot[0]), "-", "--friction", friction], &states);
            for (answer, expected) in answers.into_iter().zip(&expected) {
                let place = format!("{} at friction {friction}", expected.state["id"]);
                let answer = answer.unwrap_or_else(|error| panic!("{place}: {error}"));
                assert!(answer.proven, "{place}");
                let found: BTreeMap<_, _> =
                    answer.outcomes.iter().map(|outcome| (outcome.modes.clone(), outcome)).collect();
                let expected_outcomes = &expected.by_friction[friction].outcomes;
                let modes: BTreeSet<_> = expected_outcomes.iter().map(|outcome| outcome.modes.clone()).collect();
                assert_eq!(found.keys().cloned().collect::<BTreeSet<_>>(), modes, "{place}");
                assert_eq!(answer.outcomes.len(), expected_outcomes.len(), "{place}");
                for should in expected_outcomes {
                    let is = found[&should.modes];
                    let mut compare = |what: &str, is: &[[f64; 2]], should: &[[f64; 2]]| {
                        let size = largest(should.as_flattened());
                        differences.compare(
                            &format!("{place}: {what}"),
                            is.as_flattened(),
                            should.as_flattened(),
                            TOLERANCE * size,
                        );
                    };
                    compare("velocity_after", &is.velocity_after, &should.velocity_after);
                    if let Some(impulse) = &should.impulse {
                        compare("impulse", &is.impulse, impulse);
                    }
                    assert_eq!(is.impulse_unique, !expected.redundant, "{place}");
                    if !expected.redundant {
                        let (is, should) = (is.margin.expect("a margin"), should.margin.expect("a margin"));
                        differences.compare(&format!("{place}: margin"), &[is], &[should], TOLERANCE);
                    }
                }
            }
        }
        differences.finish();
    }

    /// The touchdowns that `batch` finds in the table of this ending.
    fn touchdowns(&self, table: &str, options: &[&str]) -> Vec<Value> {
        let (robot, table) = (path(self.robot[0]), path(&format!("gaits/{}{table}", self.name)));
        let first = ["batch", &robot, &table];
        let arguments = [&first[..], &self.robot[1..], &["--touchdowns", "--at", "row"], options].concat();
        heelstrike(&arguments).well().lines()
    }

    /// Every touchdown of the reference is found, and none beyond, with the same end of the same foot.
    fn touchdowns_are_those_of_the_reference(&self, table: &str, options: &[&str]) {
        let options = [options, &["--friction", "0.8", "--touching", "strike"]].concat();
        let found = self.touchdowns(table, &options);
        let expected: BTreeMap<(usize, String), Expected> =
            self.reference().into_iter().map(|state| ((state.csv_row, state.striking.clone()), state)).collect();
        assert_eq!(found.len(), expected.len(), "{}{table}", self.name);
        for expected in expected.values() {
            let place = format!("{}{table}: {} at row {}", self.name, expected.striking, expected.csv_row);
            let [touchdown] = found.iter().filter(|found| expected.is(found)).collect::<Vec<_>>()[..] else {
                panic!("{place}")
            };
            let shift_z = touchdown["touchdown"]["shift_z"].as_f64().expect("a shift");
            // Tables in three dimensions have nine digits, of an x of 33 m, too.
            assert!((shift_z - expected.shift_z).abs() < 1e-8, "{place}: {shift_z} {}", expected.shift_z);
            // Heel and toe are 0.28 m apart.
            let x = touchdown["contacts"][0]["point"][0].as_f64().expect("a point");
            let should = self.strikes_at(expected);
            assert!((x - should).abs() < 1e-7, "{place}: {x} {should}");
        }
    }

    /// Where the striking contact of a reference state is.
    fn strikes_at(&self, expected: &Expected) -> f64 {
        let robot = path(self.robot[0]);
        let states = std::slice::from_ref(&expected.state);
        let answer = answers(&["batch", &robot, "-", "--friction", "0.8"], states).remove(0).expect("an answer");
        let at = expected.touching.iter().position(|name| *name == expected.striking).expect("it touches");
        answer.contacts[at].point.expect("a point")[0]
    }

    /// The same feet take part, by each rule of the reference; with recorded velocities they end in the same modes.
    fn feet_that_touch_are_those_of_the_reference(&self, table: &str, options: &[&str], velocities_recorded: bool) {
        let expected = self.reference();
        for (rule, touching) in [("stance", "slow"), ("5mm", "near:0.005"), ("20mm", "near:0.02")] {
            for friction in FRICTIONS {
                let options = [options, &["--friction", friction, "--touching", touching]].concat();
                let found = self.touchdowns(table, &options);
                for expected in expected.iter().filter(|expected| expected.rule == rule) {
                    let place = format!("{}{table}, {rule}, row {}", self.name, expected.csv_row);
                    let touchdown = found.iter().find(|found| expected.is(found)).unwrap_or_else(|| panic!("{place}"));
                    let contacts = touchdown["contacts"].as_array().expect("contacts");
                    let mut feet: Vec<&str> = contacts.iter().filter_map(|contact| contact["link"].as_str()).collect();
                    let mut should: Vec<&str> = expected.touching.iter().map(|contact| link(contact)).collect();
                    feet.sort_unstable();
                    should.sort_unstable();
                    assert_eq!(feet, should, "{place}");
                    if velocities_recorded {
                        let modes: Vec<Value> = touchdown["outcomes"]
                            .as_array()
                            .expect("outcomes")
                            .iter()
                            .map(|outcome| outcome["modes"].clone())
                            .collect();
                        let should: Vec<Value> = expected.by_friction[friction]
                            .outcomes
                            .iter()
                            .map(|outcome| Value::from(outcome.modes.clone()))
                            .collect();
                        assert_eq!(modes, should, "{place} at friction {friction}");
                    }
                }
            }
        }
    }
}

/// The link of a contact's name.
fn link(contact: &str) -> &str {
    contact.split('/').next().unwrap_or_default()
}

const CENTRAL: &[&str] = &["--velocity", "central"];

#[test]
fn the_rabbits_walk() {
    RABBIT.outcomes_are_those_of_the_reference();
    RABBIT.touchdowns_are_those_of_the_reference(".csv", &[]);
    RABBIT.feet_that_touch_are_those_of_the_reference(".csv", &[], true);
}

#[test]
fn a_quadrupeds_trot() {
    A1.outcomes_are_those_of_the_reference();
    A1.touchdowns_are_those_of_the_reference(".csv", &[]);
    A1.touchdowns_are_those_of_the_reference(".3d.csv", CENTRAL);
    A1.feet_that_touch_are_those_of_the_reference(".csv", &[], true);
    A1.feet_that_touch_are_those_of_the_reference(".3d.csv", CENTRAL, false);
}

#[test]
fn a_humanoids_walk() {
    H1_WALK.outcomes_are_those_of_the_reference();
    H1_WALK.touchdowns_are_those_of_the_reference(".csv", &[]);
    H1_WALK.touchdowns_are_those_of_the_reference(".3d.csv", CENTRAL);
    H1_WALK.feet_that_touch_are_those_of_the_reference(".csv", &[], true);
    H1_WALK.feet_that_touch_are_those_of_the_reference(".3d.csv", CENTRAL, false);
}

#[test]
fn a_humanoids_run() {
    H1_RUN.outcomes_are_those_of_the_reference();
    H1_RUN.touchdowns_are_those_of_the_reference(".csv", &[]);
    H1_RUN.touchdowns_are_those_of_the_reference(".3d.csv", CENTRAL);
    H1_RUN.feet_that_touch_are_those_of_the_reference(".csv", &[], true);
    H1_RUN.feet_that_touch_are_those_of_the_reference(".3d.csv", CENTRAL, false);
}

#[test]
fn what_a_motion_in_three_dimensions_loses_is_told_once() {
    let (robot, table) = (path("robots/a1/a1.urdf"), path("gaits/a1_walk.3d.csv"));
    let options = ["--velocity", "central", "--touchdowns", "--friction", "0.8"];
    let stderr = heelstrike(&[&["batch", &robot, &table], &options[..]].concat()).well().stderr;
    let notes: Vec<&str> = stderr.lines().filter(|line| line.starts_with("note: ")).collect();
    assert_eq!(
        notes,
        [
            "note: 4 columns not read, because their joints have no coordinate (see `heelstrike inspect`): q_FR_hip_joint, \
             q_FL_hip_joint, q_RR_hip_joint, q_RL_hip_joint",
            "note: the base is projected into its plane along the mean heading of each clip; left out: roll up to 0.069 rad, \
             yaw up to 0.002 rad, 0.008 m to the side",
        ]
    );
}
