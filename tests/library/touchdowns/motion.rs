//! What counts as a touchdown, and which state is taken, for feet that move up and down.

use super::{samples, touchdowns};
use crate::support::impact::robot;
use crate::support::urdf::{self, Axis, collision, joint, link};
use heelstrike::Robot;
use heelstrike::gait::{
    At, Difference, Heights, Landing, Sample, Sampled, Seen, Thresholds, Touching, find, rates, unwrapped,
};
use heelstrike::read::table::Rates;
use std::f64::consts::TAU;
use std::sync::Mutex;

/// A block and two feet, at x = 0 and x = 1 m, that slide along z on joints of their own; `scale` is the size of a
/// meter in the unit of length.
pub fn lift(scale: f64) -> Robot {
    let ball = collision([0.0; 2], &format!("sphere radius=\"{}\"", 0.1 * scale));
    let foot = |name: &str, x: f64| {
        let rail = joint(format!("j{name}"), Axis::Prismatic([0.0, 1.0]), ["block", name], [x, 0.0], "");
        link(name, 1.0, [0.0; 2], 1.0, &ball) + &rail
    };
    robot(&urdf::robot(&[link("block", 1.0, [0.0; 2], 1.0, ""), foot("a", 0.0), foot("b", scale)]))
}

/// The samples of a table without velocities, which are computed as differences.
fn differences(table: &str, robot: &Robot, difference: Difference) -> Vec<Sampled<usize>> {
    rates(samples(table, robot, Rates::Time).into_iter(), difference).collect()
}

/// Angles that a recording wraps into one turn have the same rates as angles that go on.
#[test]
fn a_turn_that_wraps_goes_on() {
    let robot = robot(&urdf::body(0.5, ""));
    let found = |kept: fn(f64) -> f64| -> Vec<f64> {
        let pitch = (0..50).map(|row| 0.3 * f64::from(row));
        let rows = pitch.enumerate().map(|(row, pitch)| format!("0.{row:02},{}\n", kept(pitch)));
        let table = format!("time,q_base_pitch\n{}", rows.collect::<String>());
        let whole = unwrapped(samples(&table, &robot, Rates::Time).into_iter(), &robot);
        rates(whole, Difference::Central).map(|sample| sample.expect("a sample").state.velocity[2]).collect()
    };
    let on = found(|pitch| pitch);
    assert!(on.iter().all(|rate| (rate - 30.0).abs() < 1e-9), "{on:?}");
    for kept in [|pitch: f64| pitch.sin().atan2(pitch.cos()), |pitch: f64| pitch.rem_euclid(TAU)] {
        let wrapped = found(kept);
        assert!(wrapped.iter().all(|rate| (rate - 30.0).abs() < 1e-9), "{wrapped:?}");
    }
}

/// The touchdowns of rows [time, height of a, height of b].
fn lifted(rows: &[[f64; 3]], at: At, touching: Touching) -> Vec<Sample<usize>> {
    lifted_at(1.0, rows, at, touching)
}

fn lifted_at(scale: f64, rows: &[[f64; 3]], at: At, touching: Touching) -> Vec<Sample<usize>> {
    touchdowns(Heights::Recorded, &lift(scale), &[], lifting(scale, rows), at, touching)
}

/// The samples of rows [time, height of a, height of b].
fn lifting(scale: f64, rows: &[[f64; 3]]) -> Vec<Sampled<usize>> {
    let mut table = "time,q_base_z,q_ja,q_jb\n".to_owned();
    // The sphere's lowest point is its radius below its link.
    table.extend(rows.iter().map(|[time, a, b]| format!("{time},{},{a},{b}\n", 0.1 * scale)));
    differences(&table, &lift(scale), Difference::Backward)
}

#[track_caller]
fn assert_near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() < within, "{found} {expected}");
}

fn landing(touchdown: &Sample<usize>) -> &Landing {
    touchdown.landing.as_ref().unwrap()
}

/// Rows of 10 ms at which foot a has these heights and foot b stands at 0.
fn one_foot(heights: &[f64]) -> Vec<[f64; 3]> {
    (0..).zip(heights).map(|(at, height)| [f64::from(at) * 0.01, *height, 0.0]).collect()
}

#[test]
fn the_state_is_the_last_row_above_the_level_of_rest() {
    let rows = one_foot(&[0.05, 0.04, 0.03, 0.02, 0.01, 0.005, 0.005, 0.005, 0.05]);
    let touchdowns = lifted(&rows, At::Row, Touching::Strike);
    let [touchdown @ Sample { state, .. }] = &touchdowns[..] else { panic!("{touchdowns:?}") };
    let Landing { row: 4, striking, shift_z, .. } = landing(touchdown) else { panic!("{touchdown:?}") };
    assert_eq!(striking, "a");
    assert_near(*shift_z, -0.01, 1e-15);
    assert_near(state.position[1], 0.09, 1e-15);
    // The backward difference: 10 mm in 10 ms.
    assert_near(state.velocity[3], -1.0, 1e-12);
}

#[test]
fn crossing_goes_on_as_the_foot_fell() {
    let rows = one_foot(&[0.05, 0.04, 0.03, 0.02, 0.01, 0.004, 0.004, 0.004]);
    let touchdowns = lifted(&rows, At::Crossing, Touching::Strike);
    let [touchdown @ Sample { time, state, .. }] = &touchdowns[..] else { panic!("{touchdowns:?}") };
    let Landing { row: 4, shift_z, .. } = landing(touchdown) else { panic!("{touchdown:?}") };
    // The foot falls at 1 m/s from 10 mm to where it is stopped at once.
    assert_near(*time, 0.04 + (0.01 - 0.004), 1e-12);
    assert_near(state.position[3], 0.004, 1e-12);
    assert_near(*shift_z, -0.004, 1e-12);
    // The rate of the fall, not that of the row in which the foot is stopped.
    assert_near(state.velocity[3], -1.0, 1e-12);
}

#[test]
fn a_foot_that_slows_down_touches_above_its_level() {
    // It slows down at 10 m/s^2, in rows of 1 ms, and rests after 48 ms. In the last 5 ms it falls too slowly to count.
    let rows: Vec<[f64; 3]> = (0..60)
        .map(|row| f64::from(row) * 1e-3)
        .map(|time| [time, 5.0 * (0.048_f64 - time).max(0.0).powi(2) + 0.003, 0.0])
        .collect();
    let high = [[-2e-3, 0.03, 0.0], [-1e-3, 0.02, 0.0]];
    let touchdowns = lifted(&[&high[..], &rows].concat(), At::Crossing, Touching::Strike);
    let [touchdown @ Sample { state, time, .. }] = &touchdowns[..] else { panic!("{touchdowns:?}") };
    assert!(landing(touchdown).is_early);
    // Too few rows show neither noise nor that there is none.
    let few: Vec<[f64; 3]> = high.into_iter().chain(rows.into_iter().step_by(8)).collect();
    let short = lifted(&few, At::Crossing, Touching::Strike);
    assert!(short.iter().all(|touchdown| !landing(touchdown).is_early) && short.len() == 1, "{short:?}");
    // 2 mm above its level a foot that slows down touches.
    let level = 5.0 * 0.005_f64.powi(2) + 2e-3;
    assert_near(state.position[3], level + 0.003, 1e-12);
    // Tolerances: a line between rows is 1.25 um off the parabola, here at 0.2 m/s; backward differences are half a row
    // late.
    let later = (level / 5.0).sqrt();
    assert_near(*time, 0.048 - later, 1e-5);
    assert_near(state.velocity[3], -10.0 * later, 1e-4);
}

#[test]
fn a_foot_that_is_stopped_at_once_touches_its_level() {
    // The foot falls at 0.5 m/s, then at 0.2 m/s in rows of 1 ms, until it stays at 0 between two of them.
    let rows: Vec<[f64; 3]> = (0..40)
        .map(|row| f64::from(row) * 1e-3)
        .map(|time| [time, (0.0057 - 0.2 * time + 0.3 * (0.012_f64 - time).max(0.0)).max(0.0), 0.0])
        .collect();
    let high = [[-2e-3, 0.03, 0.0], [-1e-3, 0.02, 0.0]];
    let touchdowns = lifted(&[&high[..], &rows].concat(), At::Crossing, Touching::Strike);
    let [touchdown @ Sample { state, time, .. }] = &touchdowns[..] else { panic!("{touchdowns:?}") };
    assert!(!landing(touchdown).is_early);
    assert_near(state.position[3], 0.0, 1e-12);
    assert_near(*time, 0.0057 / 0.2, 1e-12);
    assert_near(state.velocity[3], -0.2, 1e-9);
}

#[test]
fn rates_before_another_foots_impact_are_not_used() {
    // Foot b strikes at 20 ms, which slows foot a to 1 m/s. Foot a is stopped at 4 mm.
    let robot = lift(1.0);
    let rows = [[0.0, 0.06, -2.0], [0.01, 0.04, -2.0], [0.02, 0.02, -2.0], [0.02, 0.02, -1.0], [0.03, 0.01, -1.0]];
    let stopped = [[0.04, 0.004, 0.0], [0.05, 0.004, 0.0]];
    let mut table = "time,q_base_z,q_ja,v_ja\n".to_owned();
    table.extend(rows.iter().chain(&stopped).map(|[time, a, rate]| format!("{time},0.1,{a},{rate}\n")));
    let rows = samples(&table, &robot, Rates::Columns);
    let found = touchdowns(Heights::Recorded, &robot, &[], rows, At::Crossing, Touching::Strike);
    let [Sample { state, time, .. }] = &found[..] else { panic!("one touchdown: {found:?}") };
    assert_near(*time, 0.03 + (0.01 - 0.004), 1e-12);
    assert_near(state.velocity[3], -1.0, 1e-12);
}

/// Gravity of the test's drop \[m/s^2\].
const G: f64 = 9.81;

/// The tables, with velocities and without, of a ball that is dropped from 1 m and stays on the ground: rows at 10 Hz,
/// the first one `phase` \[s\] after the drop.
fn drop(phase: f64) -> [String; 2] {
    let mut tables = ["time,q_base_z,v_base_z\n", "time,q_base_z\n"].map(str::to_owned);
    for row in 0..8 {
        let time = phase + 0.1 * f64::from(row);
        let (height, velocity) = match 1.0 - 0.5 * G * time * time {
            height if height > 0.0 => (height, -G * time),
            _ => (0.0, 0.0),
        };
        tables[0] += &format!("{time},{},{velocity}\n", 0.1 + height);
        tables[1] += &format!("{time},{}\n", 0.1 + height);
    }
    tables
}

#[test]
fn the_velocity_at_the_crossing_is_that_of_the_fall() {
    let robot = robot(&urdf::body(1.0, &collision([0.0; 2], "sphere radius=\"0.1\"")));
    let strikes = (2.0 * G).sqrt();
    for phase in (0..10).map(|part| f64::from(part) * 0.01) {
        let [recorded, bare] = drop(phase);
        for (from, samples) in [
            ("columns", samples(&recorded, &robot, Rates::Columns)),
            ("backward", differences(&bare, &robot, Difference::Backward)),
            ("central", differences(&bare, &robot, Difference::Central)),
        ] {
            let found = touchdowns(Heights::Recorded, &robot, &[], samples, At::Crossing, Touching::Strike);
            assert_eq!(found.len(), 1, "{from}, phase {phase}");
            let (velocity, time) = (found[0].state.velocity[1], found[0].time);
            assert!((velocity + strikes).abs() < 1e-9 * strikes, "{from}, phase {phase}: {velocity} m/s");
            assert!((time - strikes / G).abs() < 1e-9, "{from}, phase {phase}: {time} s");
        }
    }
}

#[test]
fn small_robots_touch_down_as_large_ones_do() {
    // Swings near a threshold: feet that touch down, scuff over the ground or come down too little.
    let swings = [
        &[0.05, 0.04, 0.03, 0.02, 0.01, 0.005, 0.005, 0.05][..],
        &[0.05, 0.04, 0.03, 0.0215, 0.0215, 0.03],
        &[0.0, 0.0115, 0.006, 0.0, 0.0],
        &[0.05, 0.04, 0.0206, 0.0198, 0.0195, 0.0195],
    ];
    let found = |scale: f64, part: f64| {
        let rows = |heights: &[f64]| -> Vec<[f64; 3]> {
            one_foot(heights).into_iter().map(|[time, a, b]| [time, a * part, b * part]).collect()
        };
        swings.map(|heights| {
            let touchdowns = lifted_at(scale, &rows(heights), At::Crossing, Touching::Strike);
            touchdowns.iter().map(|touchdown| landing(touchdown).row).collect::<Vec<_>>()
        })
    };
    let expected = found(1.0, 1.0);
    assert!(expected.iter().any(Vec::is_empty) && expected.iter().any(|rows| !rows.is_empty()), "{expected:?}");
    // Feet are recorded as far above the ground on large robots as on small ones, so that thresholds do not grow.
    for scale in [10.0, 1e3, 1e6] {
        assert_eq!(found(scale, 1.0), expected, "{scale}");
    }
    // The robot's size, from the foot at x = 1 and its radius; feet of robots below 0.25 m are lifted less.
    let (size, small) = (1.1, 0.25);
    for scale in [0.1, 1e-3, 1e-6] {
        assert_eq!(found(scale, scale * size / small), expected, "{scale}");
    }
}

#[test]
fn a_point_that_the_foot_keeps_up_does_not_strike() {
    // A sole 0.2 m long and 20 mm thick, with a sphere of radius 15 mm inside its front end, turns on its heel.
    let sole =
        collision([0.1, 0.01], r#"box size="0.2 0.1 0.02""#) + &collision([0.18, 0.018], r#"sphere radius="0.015""#);
    let robot = robot(&urdf::body(1.0, &sole));
    // The heel stands at its recorded height. The toe comes down from 60 mm until the sole is level or, as in
    // recordings, not quite level.
    for rest in [-0.02, 0.0, 0.02_f64] {
        let mut table = "time,q_base_z,q_base_pitch\n".to_owned();
        let pitch = |row: u32| -(0.3 - 0.03 * f64::from(row)).max(rest);
        table.extend((0..15).map(|row| format!("{},-0.003,{}\n", f64::from(row) * 0.01, pitch(row))));
        let samples = differences(&table, &robot, Difference::Backward);
        let found = touchdowns(Heights::Recorded, &robot, &[], samples, At::Row, "near:0.05".parse().unwrap());
        assert_eq!(found.len(), 1, "rest at {rest}: {found:?}");
        let contacts = found[0].state.scene.contacts.as_ref().unwrap();
        let along: Vec<f64> = contacts.iter().map(|contact| (contact.offset[0] * 1e3).round()).collect();
        let radii: Vec<f64> = contacts.iter().map(|contact| contact.radius).collect();
        assert_eq!((along, radii), (vec![0.0, 200.0], vec![0.0; 2]), "heel and toe of the sole, rest at {rest}");
        assert_eq!(landing(&found[0]).striking, "body/1");
    }
}

#[test]
fn a_touchdown_comes_down_from_above_in_one_clip() {
    let slowly: Vec<f64> = (0..100).map(|row| 0.04 - 0.0004 * f64::from(row)).collect();
    let clips = |start: f64| -> Vec<[f64; 3]> {
        let stands = (0..4).map(|row| [start + f64::from(row) * 0.01, 0.0, 0.0]);
        one_foot(&[0.05, 0.04, 0.03, 0.02]).into_iter().chain(stands).collect()
    };
    for (what, rows, count) in [
        ("stops 3 cm above the ground", one_foot(&[0.10, 0.08, 0.06, 0.04, 0.03, 0.03, 0.05]), 0),
        ("comes down by 11 mm", one_foot(&[0.0, 0.011, 0.006, 0.0, 0.0, 0.0]), 0),
        ("comes down by 13 mm", one_foot(&[0.0, 0.013, 0.006, 0.0, 0.0, 0.0]), 1),
        ("sinks slowly", one_foot(&slowly), 0),
        ("stands in a clip that goes back in time", clips(0.0), 0),
        ("stands in a clip after a pause", clips(1.0), 0),
        ("stands in the next row", clips(0.04), 1),
    ] {
        assert_eq!(lifted(&rows, At::Row, Touching::Strike).len(), count, "{what}");
    }
}

#[test]
fn a_clip_may_end_with_the_touchdown() {
    let swing = [0.05, 0.04, 0.03, 0.02, 0.01, 0.0];
    let ends = |heights: &[f64], at| {
        let touchdowns = lifted(&one_foot(heights), at, Touching::Strike);
        touchdowns.iter().map(|touchdown| (landing(touchdown).row, touchdown.time)).collect::<Vec<_>>()
    };
    assert_eq!(ends(&swing, At::Row), [(5, 0.05)]);
    assert_eq!(ends(&swing, At::Crossing), [(5, 0.05)]);
    assert_eq!(ends(&swing[..5], At::Row), [], "it ends in the air");
    // The last row is below the ground: the touchdown is where the foot crosses it.
    let through = [0.05, 0.04, 0.03, 0.02, 0.01, -0.01];
    assert_eq!(ends(&through, At::Row), [(4, 0.04)]);
    let [(4, time)] = ends(&through, At::Crossing)[..] else { panic!("one touchdown after row 4") };
    assert!((time - 0.045).abs() < 1e-12, "{time}");
}

#[test]
fn who_touches_is_asked_of_every_other_foot() {
    // b stands at 5 mm or at 40 mm, or comes down as well.
    let swing = [0.05, 0.04, 0.03, 0.02, 0.01, 0.0, 0.0, 0.0];
    let with = |b: fn(f64) -> f64, touching: &str| {
        let rows: Vec<[f64; 3]> = one_foot(&swing).iter().map(|[time, a, _]| [*time, *a, b(*a)]).collect();
        let touching: Touching = touching.parse().unwrap();
        let touchdowns = lifted(&rows, At::Row, touching);
        let contacts = touchdowns[0].state.scene.contacts.as_ref().unwrap();
        (landing(&touchdowns[0]).striking.clone(), contacts.iter().map(|contact| contact.link).collect::<Vec<_>>())
    };
    let [a, b] = [1, 2];
    assert_eq!(with(|_| 0.005, "strike"), ("a".into(), vec![a]));
    assert_eq!(with(|_| 0.005, "slow"), ("a".into(), vec![a, b]));
    assert_eq!(with(|_| 0.005, "slow:0.35,0.004"), ("a".into(), vec![a]));
    assert_eq!(with(|_| 0.040, "slow"), ("a".into(), vec![a]));
    assert_eq!(with(|a| a + 0.001, "slow"), ("a".into(), vec![a]), "it moves at 1 m/s");
    assert_eq!(with(|a| a + 0.001, "near:0.002"), ("a".into(), vec![a, b]));
    assert_eq!(with(|a| a + 0.001, "near:0.0005"), ("a".into(), vec![a]));
}

#[test]
fn feet_that_come_down_together_are_one_touchdown() {
    let hop = |apart: f64| {
        let rows = one_foot(&[0.05, 0.04, 0.03, 0.02, 0.01, 0.0, 0.0, 0.0]);
        let rows: Vec<[f64; 3]> = rows.iter().map(|[time, a, _]| [*time, *a, a + apart]).collect();
        let touchdowns = lifted(&rows, At::Crossing, Touching::Strike);
        touchdowns.iter().map(|touchdown| touchdown.state.scene.contacts.as_ref().unwrap().len()).collect::<Vec<_>>()
    };
    assert_eq!(hop(0.0), [2]);
    assert_eq!(hop(1e-7), [2]);
    assert_eq!(hop(1e-4), [1, 1]);
}

#[test]
fn a_refused_row_stays_in_its_place() {
    let robot = lift(1.0);
    let mut table = "time,q_base_z,q_ja,v_ja\n".to_owned();
    let heights = ["0.05", "0.04", "x", "0.02", "0.01", "0", "0", "0"];
    table.extend((0..).zip(heights).map(|(row, height)| format!("{},0.1,{height},-1\n", f64::from(row) * 0.01)));
    let samples = samples(&table, &robot, Rates::Columns);
    let found: Vec<_> = find(samples.into_iter(), &robot, &[], At::Row, Touching::Strike).unwrap().collect();
    assert_eq!(found.len(), 2);
    let (line, error) = found[0].as_ref().unwrap_err();
    assert_eq!((*line, error.to_string().as_str()), (4, "4:10: q_ja: expected a number, found \"x\""));
    assert_eq!(landing(found[1].as_ref().unwrap()).row, 4);
}

#[test]
fn touchdowns_found_at_once_with_a_refusal_are_sorted() {
    // Both feet fall until the clip ends. Foot b crosses the ground first, then a, and there the rate of b's joint has
    // no value between its rows.
    let robot = lift(1.0);
    let mut table = "time,q_base_z,q_ja,q_jb,v_ja,v_jb\n".to_owned();
    for (row, rate) in (0..).zip(["-1", "-1", "-1", "-1", "-1", "1.7e308", "-1.7e308"]) {
        let time = f64::from(row) * 0.01;
        table += &format!("{time},0.1,{},{},-1,{rate}\n", 0.055 - time, 0.035 - time);
    }
    let samples = samples(&table, &robot, Rates::Columns);
    let found: Vec<_> = find(samples.into_iter(), &robot, &[], At::Crossing, Touching::Strike).unwrap().collect();
    let [Ok(first), Err((_, error))] = &found[..] else { panic!("a touchdown and a refusal: {found:?}") };
    assert_eq!((&*landing(first).striking, landing(first).row), ("b", 3));
    assert_eq!(error.to_string(), "the robot is too far away or too fast to be placed on the ground");
}

#[test]
fn numbers_beyond_all_measure_are_refused_and_end() {
    let rows = one_foot(&[1e308, -1e308, 1e308, -1e308, -1e308]);
    let robot = lift(1.0);
    for base in ["0.1", "1e308", "-1e308"] {
        let mut table = "time,q_base_z,q_ja,v_ja\n".to_owned();
        table.extend(rows.iter().map(|[time, a, _]| format!("{time},{base},{a:e},-1\n")));
        for at in [At::Row, At::Crossing] {
            let samples = samples(&table, &robot, Rates::Columns);
            let all: Vec<_> = find(samples.into_iter(), &robot, &[], at, Touching::default()).unwrap().collect();
            assert!((1..=2).contains(&all.len()), "{base}");
            for found in all {
                match found {
                    Ok(Sample { state, .. }) => {
                        assert!(state.position.iter().chain(&state.velocity).all(|entry| entry.is_finite()));
                    }
                    Err((_, error)) => {
                        assert_eq!(
                            error.to_string(),
                            "the robot is too far away or too fast to be placed on the ground"
                        );
                    }
                }
            }
        }
        let bare = table.lines().map(|line| line.rsplit_once(',').unwrap().0.to_owned() + "\n").collect::<String>();
        let computed = differences(&bare, &robot, Difference::Central);
        assert_eq!(computed.len(), rows.len());
        let error = computed[0].as_ref().map(|_| ()).unwrap_err();
        assert_eq!(error.1.to_string(), "time: the velocity to the next row is beyond all numbers");
    }
}

#[test]
fn a_foot_in_soft_ground_is_slowed() {
    // It falls at 1 m/s and is at 0 after 50 ms.
    let is_slowed = |step: f64, sinks: &dyn Fn(f64) -> f64| {
        let height = |time: f64| if time < 0.05 { 0.05 - time } else { -sinks(time - 0.05) };
        let times = (0..).map(|row| f64::from(row) * step).take_while(|&time| time < 0.3);
        let rows: Vec<[f64; 3]> = times.map(|time| [time, height(time), 0.0]).collect();
        let found = lifted(&rows, At::Crossing, Touching::Strike);
        assert_eq!(found.len(), 1);
        landing(&found[0]).is_slowed
    };
    assert!(is_slowed(1e-3, &|time| 6e-3 * (1.0 - (-time / 6e-3).exp())), "it sinks by 6 mm");
    for step in [1e-3, 1e-2, 2e-2] {
        assert!(!is_slowed(step, &|_| 0.0), "it stops at once");
        for brakes in [10.0, 20.0] {
            // The foot brakes until it rests.
            let sinks = |time: f64| time.min(1.0 / brakes) * (1.0 - 0.5 * brakes * time.min(1.0 / brakes));
            assert!(!is_slowed(step, &sinks), "{brakes} m/s^2 are those of a leg, every {step} s");
        }
    }
}

#[test]
fn a_ground_that_is_not_at_zero_is_noted() {
    // Both feet come down to a level, six times; the first row is 5 s before.
    let notes = |heights: Heights, level: f64| {
        let height = |row: usize| level + 5e-3 * (20 - (row % 60).min(20) + (row % 60).max(40) - 40) as f64;
        let rows = (0..360).map(|row| [row as f64 * 0.01, height(row), height(row)]);
        let rows: Vec<[f64; 3]> = std::iter::once([-5.0, 0.2, 0.2]).chain(rows).collect();
        let (robot, seen) = (lift(1.0), Mutex::new(Seen::default()));
        let found = find(lifting(1.0, &rows).into_iter(), &robot, &[], At::Crossing, Touching::Strike).unwrap();
        found.meaning(heights).noting(&seen).for_each(std::mem::drop);
        let notes: Vec<String> = seen.into_inner().unwrap().notes(&robot, Thresholds::of(&robot, &[])).collect();
        assert!(!notes.iter().any(|note| note.contains("in seconds")), "{notes:?}");
        notes.into_iter().find(|note| note.contains("in the middle of all: "))
    };
    let note = notes(Heights::Recorded, 0.05).unwrap();
    assert!(note.starts_with("the lowest foot has ended ") && note.contains("at z = 0.05 m,"), "{note}");
    assert_eq!(notes(Heights::Recorded, 5e-3), None);
    let note = notes(Heights::True, -0.015).unwrap();
    assert!(note.starts_with("feet go down to z = -0.015 m after their touchdowns"), "{note}");
    assert_eq!(notes(Heights::True, -0.005), None, "soft ground");
}

#[test]
fn a_foot_does_not_rebound_faster_than_twice_as_it_fell() {
    // The foot falls by 4 mm from row to row to the height `last`, and is at `next` in the next rows.
    let found = |last: f64, next: f64| {
        let heights = (0..9).rev().map(|row| last + 4e-3 * f64::from(row)).chain([next, next]);
        let rows: Vec<[f64; 3]> =
            (0..).zip(heights).map(|(row, height)| [f64::from(row) * 0.02, height, 0.1]).collect();
        touchdowns(Heights::True, &lift(1.0), &[], lifting(1.0, &rows), At::Crossing, Touching::Strike).len()
    };
    assert_eq!((found(2e-4, 5e-3), found(3.8e-3, 4e-3)), (1, 0));
}
