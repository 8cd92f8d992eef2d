//! Touchdowns in recorded gaits: those of the rabbit as the command prints them (here; all gaits are in
//! `tests/reference/gaits.rs`), what counts as a touchdown of feet that move up and down (`motion`), recordings with
//! noise (`noise`), simulations (`simulated`), and the projection of motions in three dimensions (`sagittal`).

mod motion;
mod noise;
mod sagittal;
mod simulated;

use crate::support::command::{heelstrike, read};
use crate::support::impact::robot;
use heelstrike::gait::{At, Difference, Heights, Sample, Sampled, Touching, find, rates};
use heelstrike::read::table::{Form, Header, Rates};
use heelstrike::state::NamedContact;
use heelstrike::{Defaults, Robot};
use serde_json::json;
use std::collections::BTreeMap;

const RABBIT: &str = "tests/data/robots/rabbit/five_link_walker.urdf";
const WALK: &str = "tests/data/gaits/rabbit_walk.csv";

/// The samples of a table, with the numbers of their lines.
fn samples(table: &str, robot: &Robot, from: Rates) -> Vec<Sampled<usize>> {
    let mut lines = (1..).zip(table.lines());
    let (_, first) = lines.next().unwrap();
    let header = Header::read(first.as_bytes(), Form::Csv, robot, from, &[]).unwrap();
    let mut rows = header.rows();
    lines
        .map(|(line, record)| {
            let row = rows.row(record.as_bytes(), line).unwrap().unwrap();
            let state = row.state(robot, &Defaults::default()).map_err(|error| (line, error))?;
            let time = row.time().map_err(|error| (line, error))?;
            let spatial = row.spatial().map_err(|error| (line, error))?;
            Ok(Sample { time, state, rate_over: [time; 2], spatial, landing: None, source: line })
        })
        .collect()
}

/// The touchdowns of samples, none of which may be refused.
fn touchdowns(
    heights: Heights,
    robot: &Robot,
    feet: &[NamedContact],
    samples: Vec<Sampled<usize>>,
    at: At,
    touching: Touching,
) -> Vec<Sample<usize>> {
    let found = find(samples.into_iter(), robot, feet, at, touching).unwrap().meaning(heights);
    found.map(Result::unwrap).collect()
}

/// The touchdowns of the rabbit.
fn rabbit(at: At, touching: Touching) -> Vec<Sample<usize>> {
    let robot = robot(&read(RABBIT));
    let foot = |link| NamedContact { link: robot.link(link).unwrap(), offset: [0.0, 0.0, 0.4], radius: 0.0 };
    let samples = samples(&read(WALK), &robot, Rates::Columns);
    touchdowns(Heights::Recorded, &robot, &["right_shin", "left_shin"].map(foot), samples, at, touching)
}

#[test]
fn rows_of_one_time_are_taken_as_they_are() {
    let [row, crossing] = [At::Row, At::Crossing].map(|at| rabbit(at, Touching::Strike));
    assert_eq!([row.len(), crossing.len()], [4, 4]);
    for (row, crossing) in row.iter().zip(&crossing) {
        assert_eq!((row.source, row.time), (crossing.source, crossing.time));
        assert_eq!(row.state.position, crossing.state.position);
    }
}

#[test]
fn velocities_from_the_time_stop_short_of_the_impact() {
    let (robot, table) = (robot(&read(RABBIT)), read(WALK));
    let recorded = samples(&table, &robot, Rates::Columns);
    // The same table without its columns of velocities.
    let kept = table.lines().next().unwrap().split(',').take_while(|name| !name.starts_with("v_")).count();
    let bare: String =
        table.lines().map(|line| line.split(',').take(kept).collect::<Vec<_>>().join(",") + "\n").collect();
    for difference in [Difference::Central, Difference::Backward] {
        let bare = samples(&bare, &robot, Rates::Time);
        let computed: Vec<Sampled<usize>> = rates(bare.into_iter(), difference).collect();
        assert_eq!(computed.len(), recorded.len());
        for (computed, recorded) in computed.iter().zip(&recorded) {
            let (computed, recorded) = (computed.as_ref().unwrap(), recorded.as_ref().unwrap());
            assert_eq!(computed.source, recorded.source);
            for (computed_rate, rate) in computed.state.velocity.iter().zip(&recorded.state.velocity) {
                // Tolerance: one-sided differences over 2 ms, with joint accelerations of up to 100 rad/s^2. Across an
                // impact they would be off by 5 rad/s.
                assert!((computed_rate - rate).abs() < 0.3, "line {}: {computed_rate} {rate}", computed.source);
            }
        }
    }
}

#[test]
fn a_robot_without_feet_is_refused() {
    let none = std::iter::empty::<Sampled<()>>();
    let error = find(none, &robot(&read(RABBIT)), &[], At::Row, Touching::Strike).map(|_| ()).unwrap_err();
    assert!(error.to_string().contains("foot"), "{error}");
    assert!(error.remedy().is_some_and(|hint| hint.contains("`feet: ")));
}

#[test]
fn touching_is_read_as_it_is_written() {
    for text in ["strike", "slow:0.35,0.02", "near:0.005"] {
        assert_eq!(text.parse::<Touching>().unwrap().to_string(), text);
    }
    for text in ["", "slow:0.35", "slow:-1,0", "near", "near:nan", "touch"] {
        assert!(text.parse::<Touching>().is_err(), "{text}");
    }
}

/// Checks the output of the command; `tests/reference/gaits.rs` compares the touchdowns with the reference.
#[test]
fn the_command_prints_line_and_foot_of_a_touchdown() {
    let feet = ["--contact", "right_shin:0,0,0.4", "--contact", "left_shin:0,0,0.4"];
    let walk = [&["batch", RABBIT, WALK, "--touchdowns", "--friction", "0.8"], &feet[..]].concat();
    let results = heelstrike(&[&walk[..], &["--at", "row"]].concat()).well().lines();
    assert_eq!(results.len(), 4);
    for (result, row) in results.iter().zip([91, 330, 595, 847]) {
        assert_eq!((&result["line"], &result["touchdown"]["row"]), (&json!(row), &json!(row)), "the line of the file");
    }
    let touchdown = &results[1]["touchdown"];
    assert_eq!((&touchdown["at"], &touchdown["touching"]), (&json!("row"), &json!("slow:0.35,0.02")));
    assert!((touchdown["time"].as_f64().unwrap() - 0.652).abs() < 0.01, "{touchdown}");

    let table = heelstrike(&[&walk[..], &["--touching", "strike", "--output-format", "csv"]].concat()).well().stdout;
    let rows: Vec<BTreeMap<String, String>> =
        csv::Reader::from_reader(table.as_bytes()).deserialize().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 4);
    for (row, (number, striking)) in rows.iter().zip([(91, "right"), (330, "left"), (595, "right"), (847, "left")]) {
        assert_eq!(row["touchdown_row"], number.to_string());
        assert_eq!(row["touchdown_striking"], format!("{striking}_shin"));
        assert_eq!(row[&format!("mode_{striking}_shin")], "stick");
        assert_eq!(row["time"], row["touchdown_time"]);
        assert_eq!([&row["touchdown_at"], &row["touchdown_touching"]], ["crossing", "strike"]);
        let other = if striking == "left" { "mode_right_shin" } else { "mode_left_shin" };
        assert_eq!(row[other], "", "the other foot takes no part");
    }
}
