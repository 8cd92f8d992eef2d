//! Motions in three dimensions, projected clip by clip.

use super::samples;
use crate::support::command::read;
use crate::support::impact::robot;
use crate::support::scaled::near;
use crate::support::urdf;
use heelstrike::Robot;
use heelstrike::gait::{Dropped, Sampled, sagittal};
use heelstrike::read::table::Rates;
use proptest::prelude::*;
use std::sync::Mutex;

fn body() -> Robot {
    robot(&urdf::body(1.0, &urdf::collision([0.0; 2], "sphere radius=\"0.1\"")))
}

const HEADER: &str = "time,q_base_qy,q_base_x,q_base_qw,q_base_z,q_base_y,q_base_qz,q_base_qx\n";

/// Time, x, y, z, yaw, pitch, roll.
type Row = [f64; 7];

/// The table of a motion.
fn table(rows: &[Row]) -> String {
    let mut table = HEADER.to_owned();
    for [time, x, y, z, yaw, pitch, roll] in rows {
        let ([sy, cy], [sp, cp], [sr, cr]) = (half(*yaw), half(*pitch), half(*roll));
        let qw = cy * cp * cr + sy * sp * sr;
        let qx = cy * cp * sr - sy * sp * cr;
        let qy = cy * sp * cr + sy * cp * sr;
        let qz = sy * cp * cr - cy * sp * sr;
        table += &format!("{time},{qy},{x},{qw},{z},{y},{qz},{qx}\n");
    }
    table
}

fn half(angle: f64) -> [f64; 2] {
    [(0.5 * angle).sin(), (0.5 * angle).cos()]
}

/// The projected rows, and what was left out.
fn projected(table: &str, robot: &Robot) -> (Vec<Sampled<usize>>, Dropped) {
    let dropped = Mutex::new(Dropped::default());
    let found = sagittal(samples(table, robot, Rates::Time).into_iter(), &dropped).collect();
    (found, dropped.into_inner().unwrap())
}

fn positions(table: &str) -> Vec<Vec<f64>> {
    let (samples, _) = projected(table, &body());
    samples.into_iter().map(|sampled| sampled.unwrap().state.position).collect()
}

fn close(found: &[Vec<f64>], expected: &[Vec<f64>]) {
    // Tolerance: rounding of sums of up to ten meters.
    assert!(near(&found.concat(), &expected.concat(), 1e-13), "{found:?} {expected:?}");
}

#[test]
fn each_clip_has_a_heading_of_its_own() {
    let ahead = [[0.0, 0.0, 0.0, 1.0, 0.2, 0.0, 0.1], [0.1, 1.0, 0.5, 1.0, -0.2, 0.0, 0.0]];
    let back = [[0.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0], [0.1, -1.0, 0.0, 1.0, 3.0, 0.0, -0.3]];
    let (found, dropped) = projected(&table(&[ahead, back].concat()), &body());
    let x: Vec<f64> = found.iter().map(|sampled| sampled.as_ref().unwrap().state.position[0]).collect();
    close(&[x], &[vec![0.0, 1.0, 0.0, -3.0_f64.cos()]]);
    // The first clip is 0.25 m to the sides of the line through its middle, the second only half of sin 3.
    close(&[vec![dropped.roll, dropped.yaw, dropped.sideways]], &[vec![0.3, 0.2, 0.25]]);
}

#[test]
fn refused_rows_stay_and_a_circle_has_no_heading() {
    let rows: Vec<Row> = (0..3).map(|row| [0.1 * f64::from(row), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]).collect();
    let robot = body();
    let broken = table(&rows).replacen("0.1,0,0,1,", "0.1,0,0,0.5,", 1);
    let (found, _) = projected(&broken, &robot);
    let refused: Vec<bool> = found.iter().map(Result::is_err).collect();
    assert_eq!(refused, [false, true, false]);
    let (line, error) = found[1].as_ref().unwrap_err();
    assert_eq!(*line, 3);
    assert_eq!(error.to_string(), "3:9: q_base_qw: the length of the quaternion must be 1, not 0.5");

    let step = std::f64::consts::FRAC_PI_2;
    let circle: Vec<Row> = (0..4).map(|row| [f64::from(row), 0.0, 0.0, 1.0, f64::from(row) * step, 0.0, 0.0]).collect();
    let (found, _) = projected(&table(&circle), &robot);
    for refused in found {
        let (_, error) = refused.map(|_| ()).unwrap_err();
        assert!(error.to_string().contains("all the way round"), "{error}");
    }
}

#[test]
fn recorded_robots_match_the_reduced_tables() {
    for (name, gait, at_x) in [("a1", "a1_walk", 5e-9), ("h1", "h1_walk", 5e-9), ("h1", "h1_run", 5e-8)] {
        let robot = robot(&read(&format!("tests/data/robots/{name}/{name}.urdf")));
        let (found, _) = projected(&read(&format!("tests/data/gaits/{gait}.3d.csv")), &robot);
        let planar = samples(&read(&format!("tests/data/gaits/{gait}.csv")), &robot, Rates::Columns);
        assert_eq!(found.len(), planar.len());
        for (found, planar) in found.iter().zip(&planar) {
            let (found, planar) = (found.as_ref().unwrap(), planar.as_ref().unwrap());
            for (at, (is, should)) in found.state.position.iter().zip(&planar.state.position).enumerate() {
                // The tables in three dimensions have nine digits.
                let tolerance = if at == 0 { at_x } else { 5e-9 };
                assert!((is - should).abs() < tolerance, "{gait}, line {}: {is} {should}", found.source);
            }
        }
    }
}

/// A random motion with yaw, pitch and roll.
fn walk() -> impl Strategy<Value = Vec<Row>> {
    let row = (-1.0..1.0, -1.0..1.0, 0.5..1.5, -0.6..0.6, -1.0..1.0, -0.5..0.5);
    prop::collection::vec(row, 2..12).prop_map(|rows| {
        let timed = |(at, (x, y, z, yaw, pitch, roll)): (u32, _)| [f64::from(at), x, y, z, yaw, pitch, roll];
        (0..).zip(rows).map(timed).collect()
    })
}

proptest! {
    #[test]
    fn yawing_a_whole_recording_changes_nothing(rows in walk(), yaw in -3.0..3.0_f64) {
        let turned: Vec<Row> = rows.iter().map(|&[time, x, y, z, own, pitch, roll]| {
            let (sin, cos) = yaw.sin_cos();
            [time, cos * x - sin * y, sin * x + cos * y, z, own + yaw, pitch, roll]
        }).collect();
        close(&positions(&table(&turned)), &positions(&table(&rows)));
    }

    #[test]
    fn stepping_aside_changes_nothing(rows in walk(), aside in -5.0..5.0_f64) {
        // All rows look along x, which is therefore the heading.
        let straight = |aside: f64| -> Vec<Row> {
            rows.iter().map(|&[time, x, y, z, _, pitch, _]| [time, x, y + aside, z, 0.0, pitch, 0.0]).collect()
        };
        close(&positions(&table(&straight(aside))), &positions(&table(&straight(0.0))));
    }
}
