//! Recorded gaits (`data/gaits`) through the command, with robot files as their authors wrote them: every outcome of
//! the reference states, and the touchdowns found in the tables, planar and in three dimensions, with options as a user
//! gives them.

use std::collections::BTreeMap;

use heelstrike::write::Touchdown;
use heelstrike::{Mode, Report};
use serde::Deserialize;
use serde_json::Value;

use crate::support::answers::answers;
use crate::support::command::{heelstrike, read};
use crate::support::scaled::{Differences, largest, near};

const FRICTIONS: [&str; 3] = ["0.4", "0.8", "infinite"];

/// Relative to the largest velocity or impulse. The Delassus matrices here have condition numbers up to 1e4.
const TOLERANCE: f64 = 1e-12;

/// A gait and how its robot is given: the file, then feet for a robot without shapes.
struct Gait<'a> {
    name: &'a str,
    robot: &'a [&'a str],
}

/// How a table's name ends, the options that it needs, and whether it has velocities.
struct Table {
    ending: &'static str,
    options: &'static [&'static str],
    has_velocities: bool,
}

const PLANAR: Table = Table { ending: ".csv", options: &[], has_velocities: true };
const SPATIAL: Table = Table { ending: ".3d.csv", options: &["--velocity", "central"], has_velocities: false };

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

/// An outcome of the reference. For redundant contacts it has no impulses, and a margin of the velocities alone.
#[derive(Deserialize)]
struct Outcome {
    modes: Vec<Mode>,
    impulse: Option<Vec<[f64; 2]>>,
    velocity_after: Vec<[f64; 2]>,
    margin: Option<f64>,
}

impl Expected {
    /// Whether the report is of this touchdown: the same foot at the same row.
    fn is(&self, found: &Report) -> bool {
        // A report names a row by its line: the row 0 of the reference is line 2, after the header.
        let same = |found: &Touchdown| found.row == self.csv_row + 2 && link(&found.striking) == link(&self.striking);
        found.touchdown.as_ref().is_some_and(same)
    }
}

fn path(name: &str) -> String {
    format!("tests/data/{name}")
}

impl Gait<'_> {
    fn reference(&self) -> Vec<Expected> {
        let text = read(&path(&format!("gaits/{}.reference.json", self.name)));
        let mut reference: Value = serde_json::from_str(&text).expect("JSON");
        serde_json::from_value(reference["states"].take()).expect("the reference is readable")
    }

    fn outcomes_are_those_of_the_reference(&self) {
        let expected = self.reference();
        let states: Vec<Value> = expected.iter().map(|expected| expected.state.clone()).collect();
        let mut differences = Differences::default();
        for friction in FRICTIONS {
            let answers = answers(&["batch", &path(self.robot[0]), "-", "--friction", friction], &states);
            for (answer, expected) in answers.into_iter().zip(&expected) {
                let place = format!("{} at friction {friction}", expected.state["id"]);
                assert_eq!(answer.report.proven, Some(true), "{place}");
                let mut found: Vec<_> = answer.outcomes.iter().collect();
                let mut outcomes: Vec<_> = expected.by_friction[friction].outcomes.iter().collect();
                found.sort_by_key(|outcome| &outcome.modes);
                outcomes.sort_by_key(|outcome| &outcome.modes);
                assert!(found.iter().map(|is| &is.modes).eq(outcomes.iter().map(|should| &should.modes)), "{place}");
                for (is, should) in found.into_iter().zip(outcomes) {
                    let mut compare = |what: &str, is: &[[f64; 2]], should: &[[f64; 2]]| {
                        let (is, should) = (is.as_flattened(), should.as_flattened());
                        differences.compare(&format!("{place}: {what}"), is, should, TOLERANCE * largest(should));
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

    /// The touchdowns that `batch` finds in the table.
    fn touchdowns(&self, table: &Table, options: &[&str]) -> Vec<Report<'static>> {
        let (robot, file) = (path(self.robot[0]), path(&format!("gaits/{}{}", self.name, table.ending)));
        let first = ["batch", &robot, &file, "--touchdowns", "--at", "row"];
        let arguments = [&first[..], &self.robot[1..], table.options, options].concat();
        let stdout = heelstrike(&arguments).well().stdout;
        stdout.lines().map(|line| serde_json::from_str(line).expect("a result")).collect()
    }

    /// Checks that every touchdown of the reference is found, and no other, with the same end of the same foot.
    fn touchdowns_are_those_of_the_reference(&self, table: &Table) {
        let found = self.touchdowns(table, &["--friction", "0.8", "--touching", "strike"]);
        let expected: BTreeMap<(usize, String), Expected> =
            self.reference().into_iter().map(|state| ((state.csv_row, state.striking.clone()), state)).collect();
        assert_eq!(found.len(), expected.len(), "{}{}", self.name, table.ending);
        for expected in expected.values() {
            let place = format!("{}{}: {} at row {}", self.name, table.ending, expected.striking, expected.csv_row);
            let [found] = found.iter().filter(|found| expected.is(found)).collect::<Vec<_>>()[..] else {
                panic!("{place}")
            };
            let Touchdown { shift_z, state, .. } = found.touchdown.as_ref().expect("a touchdown");
            // Tables in three dimensions have nine digits, also for x up to 33 m.
            assert!((shift_z - expected.shift_z).abs() < 1e-8, "{place}: {shift_z} {}", expected.shift_z);
            // The offset distinguishes heel and toe, which are 0.28 m from each other.
            let offset = |state: &Value, at: usize| {
                [0, 2].map(|axis| state["contacts"][at]["offset"][axis].as_f64().expect("a number"))
            };
            let at = expected.touching.iter().position(|name| *name == expected.striking).expect("it touches");
            let is = offset(&serde_json::from_str(state.get()).expect("a state"), 0);
            let should = offset(&expected.state, at);
            assert!(near(&is, &should, 1e-9), "{place}: {is:?} {should:?}");
        }
    }

    /// Checks that the same feet take part, by each rule of the reference, and that touchdowns with recorded velocities
    /// end in the same modes.
    fn feet_that_touch_are_those_of_the_reference(&self, table: &Table) {
        let expected = self.reference();
        for (rule, touching) in [("stance", "slow"), ("5mm", "near:0.005"), ("20mm", "near:0.02")] {
            // Friction decides how touchdowns end, not which feet touch.
            let frictions = if table.has_velocities { &FRICTIONS[..] } else { &FRICTIONS[..1] };
            for &friction in frictions {
                let found = self.touchdowns(table, &["--friction", friction, "--touching", touching]);
                for expected in expected.iter().filter(|expected| expected.rule == rule) {
                    let place = format!("{}{}, {rule}, row {}", self.name, table.ending, expected.csv_row);
                    let found = found.iter().find(|found| expected.is(found)).unwrap_or_else(|| panic!("{place}"));
                    let mut feet: Vec<&str> = found.contacts.iter().filter_map(|foot| foot.link.as_deref()).collect();
                    let mut should: Vec<&str> = expected.touching.iter().map(|contact| link(contact)).collect();
                    feet.sort_unstable();
                    should.sort_unstable();
                    assert_eq!(feet, should, "{place}");
                    if table.has_velocities {
                        let should = expected.by_friction[friction].outcomes.iter().map(|outcome| &outcome.modes);
                        let found = found.outcomes.iter().flat_map(|all| all.iter()).map(|outcome| &outcome.modes);
                        assert!(found.eq(should), "{place} at friction {friction}");
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

/// Checks a gait on the robot's file and feet.
fn check(name: &str, robot: &[&str], tables: &[Table]) {
    let gait = Gait { name, robot };
    gait.outcomes_are_those_of_the_reference();
    for table in tables {
        gait.touchdowns_are_those_of_the_reference(table);
        gait.feet_that_touch_are_those_of_the_reference(table);
    }
}

#[test]
fn the_rabbits_walk() {
    let feet = ["--contact=right_shin:0,0,0.4", "--contact=left_shin:0,0,0.4"];
    check("rabbit_walk", &["robots/rabbit/five_link_walker.urdf", feet[0], feet[1]], &[PLANAR]);
}

#[test]
fn a_quadrupeds_trot() {
    check("a1_walk", &["robots/a1/a1.urdf"], &[PLANAR, SPATIAL]);
}

#[test]
fn touchdowns_are_in_the_order_of_time() {
    // Where the recording ends, feet of two rows strike and are found at once.
    let (robot, table) = (path("robots/a1/a1.urdf"), path("gaits/a1_walk.csv"));
    let stdout = heelstrike(&["batch", &robot, &table, "--touchdowns", "--friction", "0.6"]).well().stdout;
    let found = stdout.lines().map(|line| serde_json::from_str::<Report>(line).expect("a result"));
    let times: Vec<f64> = found.map(|report| report.touchdown.expect("a touchdown").time).collect();
    assert!(times.len() > 10 && times.is_sorted(), "{times:?}");
}

#[test]
fn a_humanoids_walk() {
    check("h1_walk", &["robots/h1/h1.urdf"], &[PLANAR, SPATIAL]);
}

#[test]
fn a_humanoids_run() {
    check("h1_run", &["robots/h1/h1.urdf"], &[PLANAR, SPATIAL]);
}

#[test]
fn what_a_spatial_motion_loses_is_noted_once() {
    let (robot, table) = (path("robots/a1/a1.urdf"), path("gaits/a1_walk.3d.csv"));
    let options = ["--velocity", "central", "--touchdowns", "--friction", "0.8"];
    let stderr = heelstrike(&[&["batch", &robot, &table], &options[..]].concat()).well().stderr;
    let notes: Vec<&str> = stderr.lines().filter(|line| line.starts_with("note: ")).collect();
    assert_eq!(
        notes,
        [
            "note: columns of joints without a coordinate are not read (see `heelstrike inspect`): q_FR_hip_joint, \
             q_FL_hip_joint, q_RR_hip_joint, q_RL_hip_joint",
            "note: the base is projected into its plane along the mean heading of each clip; left out: roll up to 0.069 rad, \
             yaw up to 0.002 rad, 0.008 m to the side",
        ]
    );
}
