//! Touchdowns of simulations, whose heights are exact: motions whose moment of contact is known in closed form.

use super::{samples, touchdowns};
use crate::support::command::{file, heelstrike, heelstrike_reads};
use crate::support::impact::{impact, robot};
use crate::support::random::Random;
use crate::support::urdf::{self, HINGE, POINT, collision, joint, link};
use heelstrike::Robot;
use heelstrike::gait::{At, Difference, Heights, Sample, Sampled, Touching, rates};
use heelstrike::read::table::Rates;
use serde_json::Value;
use std::fmt::Write;

/// Gravity \[m/s^2\].
const G: f64 = 9.81;

/// A motion with one touchdown.
struct Motion {
    robot: Robot,
    /// Columns of q after the time, and of v.
    columns: [&'static str; 2],
    strikes: f64,
    /// q and v before the touchdown, at this time.
    before: fn(f64) -> [Vec<f64>; 2],
    /// q and v after the touchdown, at this time since then.
    after: fn(f64) -> [Vec<f64>; 2],
}

fn point_at(x: f64, z: f64) -> String {
    collision([x, z], POINT)
}

/// Let go 1 m above the ground; it bounces to half its speed.
fn ball() -> Motion {
    let rebound = |time: f64| {
        let speed = 0.5 * (2.0 * G).sqrt();
        [vec![0.1 + (speed - 0.5 * G * time) * time], vec![speed - G * time]]
    };
    Motion {
        robot: robot(&urdf::body(1.0, &collision([0.0; 2], "sphere radius=\"0.1\""))),
        columns: ["q_base_z", "v_base_z"],
        strikes: (2.0 / G).sqrt(),
        before: |time| [vec![1.1 - 0.5 * G * time * time], vec![-G * time]],
        after: rebound,
    }
}

/// A rod of 1 m spins at 3 rad/s while it falls. Its front end strikes after 0.4 s, and the rod stays where it then is.
fn rod() -> Motion {
    let fall = |time: f64| {
        let height = 0.5 * G * 0.16 + 0.5 * 1.4_f64.sin() - 0.5 * G * time * time;
        [vec![height, 0.2 + 3.0 * time], vec![-G * time, 3.0]]
    };
    Motion {
        robot: robot(&urdf::body(1.0, &(point_at(0.5, 0.0) + &point_at(-0.5, 0.0)))),
        columns: ["q_base_z,q_base_pitch", "v_base_z,v_base_pitch"],
        strikes: 0.4,
        before: fall,
        after: |_| [vec![0.5 * 1.4_f64.sin(), 1.4], vec![0.0; 2]],
    }
}

/// A compass walker with legs of 1 m at the absolute angles a = 0.1 + 0.8 t and -(0.5 - 0.4 t - 0.3 t^2) and the hip at
/// (sin a, cos a). Both feet are on the ground when the angles are opposite; the walker then stays there.
fn walker() -> Motion {
    let swing = |time: f64| {
        let (a, rate) = (0.1 + 0.8 * time, 0.8);
        let (swing, swings) = (-(0.5 - 0.4 * time - 0.3 * time * time), 0.4 + 0.6 * time);
        [vec![a.sin(), a.cos(), a, swing], vec![rate * a.cos(), -rate * a.sin(), rate, swings]]
    };
    let stays = |_| {
        let a = 0.1 + 0.8 * ((1.92_f64.sqrt() - 1.2) / 0.6);
        [vec![a.sin(), a.cos(), a, -a], vec![0.0; 4]]
    };
    Motion {
        robot: robot(&walker_urdf()),
        columns: ["q_base_x,q_base_z,q_jstance,q_jswing", "v_base_x,v_base_z,v_jstance,v_jswing"],
        strikes: (1.92_f64.sqrt() - 1.2) / 0.6,
        before: swing,
        after: stays,
    }
}

fn walker_urdf() -> String {
    let leg = |name: &str| {
        let hinge = joint(format!("j{name}"), HINGE, ["hip", name], [0.0; 2], "");
        link(name, 1.0, [0.0, -0.5], 0.1, &point_at(0.0, -1.0)) + &hinge
    };
    urdf::robot(&[link("hip", 5.0, [0.0; 2], 1.0, ""), leg("stance"), leg("swing")])
}

impl Motion {
    /// The table with a row every `step` \[s\], the first a `phase` of it late.
    fn table(&self, step: f64, phase: f64, with_rates: bool, until: f64) -> String {
        let [positions, velocities] = self.columns;
        let mut table =
            format!("time,{positions}{}\n", if with_rates { format!(",{velocities}") } else { String::new() });
        let rows = (0..).map(|row| (f64::from(row) + phase) * step).take_while(|time| *time < until);
        for time in rows {
            let [q, v] = if time < self.strikes { (self.before)(time) } else { (self.after)(time - self.strikes) };
            write!(table, "{time:?}").expect("a string takes all");
            let numbers = q.iter().chain(v.iter().filter(|_| with_rates));
            numbers.for_each(|number| write!(table, ",{number:?}").expect("a string takes all"));
            table.push('\n');
        }
        table
    }

    fn samples(&self, table: &str, with_rates: bool) -> Vec<Sampled<usize>> {
        match with_rates {
            true => samples(table, &self.robot, Rates::Columns),
            false => rates(samples(table, &self.robot, Rates::Time).into_iter(), Difference::Central).collect(),
        }
    }

    fn found(&self, table: &str, with_rates: bool, at: At) -> Vec<Sample<usize>> {
        let samples = self.samples(table, with_rates);
        touchdowns(Heights::True, &self.robot, &[], samples, at, Touching::default())
    }

    /// The entries of q or v that have columns.
    fn entries(&self, part: usize, all: &[f64]) -> Vec<f64> {
        let prefix = ["q_", "v_"][part];
        let name = |column: &str| column.trim_start_matches(prefix).trim_start_matches("base_").to_owned();
        let place =
            |column: &str| self.robot.coordinates().position(|known| known == name(column)).expect("a coordinate");
        self.columns[part].split(',').map(|column| all[place(column)]).collect()
    }
}

#[test]
fn the_moment_is_that_of_the_motion() {
    for (name, motion) in [("ball", ball()), ("rod", rod()), ("walker", walker())] {
        let [q, v] = (motion.before)(motion.strikes);
        for (step, with_rates) in [1e-3, 2e-3, 5e-3, 1e-2].into_iter().flat_map(|step| [(step, true), (step, false)]) {
            for phase in [0.0, 0.123, 0.456, 0.789] {
                let table = motion.table(step, phase, with_rates, motion.strikes + 20.0 * step);
                let found = motion.found(&table, with_rates, At::Crossing);
                let case = format!("{name}, {step} s, phase {phase}, rates {with_rates}");
                let [touchdown] = &found[..] else { panic!("{case}: {} touchdowns", found.len()) };
                let late = touchdown.time - motion.strikes;
                assert!(late.abs() < 1e-6 * step, "{case}: {late:e} s");
                let near = |part: usize, found: &[f64], expected: &[f64], within: f64| {
                    for (found, expected) in motion.entries(part, found).iter().zip(expected) {
                        assert!((found - expected).abs() < within, "{case}: {found} {expected}");
                    }
                };
                near(0, &touchdown.state.position, &q, 1e-6 * step * 10.0);
                // Tolerance: the rate of a polynomial of fifth degree, up to one step beyond its points.
                near(1, &touchdown.state.velocity, &v, 1e-6);
                let state = touchdown.state.to_json(&motion.robot).expect("a state");
                for contact in impact(&motion.robot, state).contacts {
                    assert!(contact.gap.abs() < 1e-9 * step, "{case}: {:e} m", contact.gap);
                }
            }
        }
    }
}

#[test]
fn accelerations_may_jump_at_every_row() {
    let step = 0.002;
    for seed in 0..40 {
        let mut random = Random::new(seed);
        // A ball that controllers push and turn, with new accelerations in each row.
        let [mut height, mut turn, mut falls, mut turns] = [0.5, 0.0, 0.0, random.between(-1.0, 1.0)];
        let mut table = "time,q_base_z,q_base_pitch,v_base_z,v_base_pitch\n".to_owned();
        let mut row = 0;
        let [speed, rate] = loop {
            let time = f64::from(row) * step;
            writeln!(table, "{time:?},{:?},{turn:?},{falls:?},{turns:?}", 0.1 + height).unwrap();
            row += 1;
            let [a, b] = [-G + random.between(-20.0, 20.0), random.between(-20.0, 20.0)];
            let next = height + (falls + 0.5 * a * step) * step;
            if next < 0.0 {
                let left = 2.0 * height / ((falls * falls - 2.0 * a * height).sqrt() - falls);
                let strikes = [falls + a * left, turns + b * left];
                writeln!(table, "{:?},0.1,{:?},0,0", time + step, turn + turns * left).unwrap();
                writeln!(table, "{:?},0.1,{:?},0,0", time + 2.0 * step, turn + turns * left).unwrap();
                break strikes;
            }
            (height, turn) = (next, turn + (turns + 0.5 * b * step) * step);
            (falls, turns) = (falls + a * step, turns + b * step);
        };
        let ball = ball().robot;
        let samples = samples(&table, &ball, Rates::Columns);
        let found = touchdowns(Heights::True, &ball, &[], samples, At::Crossing, Touching::Strike);
        let [touchdown] = &found[..] else { panic!("{} touchdowns of seed {seed}", found.len()) };
        // The most by which a velocity changes from row to row.
        let most = (G + 20.0) * step;
        for (own, truth) in touchdown.state.velocity[1..].iter().zip([speed, rate]) {
            assert!((own - truth).abs() < 2.0 * most, "{own} is not {truth}, seed {seed}");
        }
    }
}

#[test]
fn slow_rows_are_kept_as_long_as_fast_ones() {
    // Down along a polynomial of the fifth degree, which six rows determine.
    fn height(left: f64) -> [Vec<f64>; 2] {
        [vec![0.1 + 0.1 * left + 0.02 * left.powi(5)], vec![-0.1 - 0.1 * left.powi(4)]]
    }
    let motion =
        Motion { strikes: 3.05, before: |time| height(3.05 - time), after: |_| [vec![0.1], vec![0.0]], ..ball() };
    for step in [0.01, 0.1, 0.2, 0.4] {
        let found = motion.found(&motion.table(step, 0.3, true, 3.05 + 5.0 * step), true, At::Crossing);
        let [Sample { time, state, .. }] = &found[..] else { panic!("{step} s: {} touchdowns", found.len()) };
        assert!((time - motion.strikes).abs() < 1e-9, "{step} s: {time}");
        assert!((state.velocity[1] + 0.1).abs() < 1e-9, "{step} s: {}", state.velocity[1]);
    }
}

#[test]
fn a_body_may_rest_a_rounding_above_the_ground() {
    let exact = Motion { after: |_| [vec![0.1], vec![0.0]], ..ball() };
    let rounded = Motion { after: |_| [vec![0.1 + 1e-16], vec![0.0]], ..ball() };
    let higher = Motion { after: |_| [vec![0.1 + 1e-9], vec![0.0]], ..ball() };
    for (at, motion) in [exact, rounded, higher].into_iter().enumerate() {
        for phase in [0.0, 0.3, 0.6, 0.9] {
            let found = motion.found(&motion.table(0.01, phase, true, 1.0), true, At::Crossing);
            let [Sample { time, state, .. }] = &found[..] else { panic!("{at}, phase {phase}: {}", found.len()) };
            assert!((time - motion.strikes).abs() < 1e-8, "{at}, phase {phase}: {time}");
            assert!((state.velocity[1] + G * time).abs() < 1e-8, "{at}, phase {phase}: {}", state.velocity[1]);
        }
    }
}

/// Integrators that stop at an impact write rows there with the velocity before it, after it or both, at a height up to
/// a rounding above or below the ground.
#[test]
fn a_row_at_the_impact_may_be_before_or_after_it() {
    let motion = ball();
    let [time, speed] = [motion.strikes, (2.0 * G).sqrt()];
    let row = |time: f64, z: f64, v: f64| format!("{time:?},{z:?},{v:?}\n");
    let fall: String =
        [0.0, 0.05, 0.11, 0.18, 0.24, 0.33, 0.41].map(|t| row(t, 1.1 - 0.5 * G * t * t, -G * t)).concat();
    for z in [0.1, 0.1_f64.next_up(), 0.1_f64.next_down(), 0.1 + 1e-9, 0.1 - 1e-9, 0.1 - 5e-7] {
        let [before, after] = [row(time, z, -speed), row(time, z, 0.5 * speed)];
        let bounced = after.clone() + &row(time + 0.03, 0.1 + 0.03 * (0.5 * speed - 0.015 * G), 0.5 * speed - 0.03 * G);
        // At rest the ball sinks by drift, or jitters.
        let stays = |lower: fn(f64) -> f64| -> String {
            let rests = (0..60).map(f64::from).map(|at| row(time + 1e-3 * at, z + lower(at), 0.0));
            rests.collect()
        };
        let [sinks, jitters] = [stays(|at| -1e-12 * at), stays(|at| [1e-15, -1e-15, 0.0][at as usize % 3])];
        for (case, end) in [
            ("both", before.clone() + &bounced),
            ("both", before.clone() + &sinks),
            ("end", before),
            ("after", bounced),
            ("after", sinks),
            ("after", jitters),
        ] {
            let table = format!("time,q_base_z,v_base_z\n{fall}{end}");
            let found = motion.found(&table, true, At::Crossing);
            let [Sample { time: found, state, .. }] = &found[..] else { panic!("{case} {z:?}: {}", found.len()) };
            assert!((found - time).abs() < 1e-8, "{case} {z:?}: {found}");
            assert!((state.velocity[1] + speed).abs() < 1e-7, "{case} {z:?}: {}", state.velocity[1]);
            // If both rows are on the ground, the first is taken as it is.
            let is_given = case != "both" || z < 0.1 - 1e-8 || state.velocity[1] == -speed;
            assert!(is_given, "{z:?}: {:?}", state.velocity[1]);
        }
    }
}

#[test]
fn a_standing_heel_takes_part_when_its_toe_strikes() {
    // The heel is on the ground, or sunk into it by a third of a millimeter.
    [0.1, 0.1003].into_iter().for_each(strike_with_a_toe);
}

fn strike_with_a_toe(heel: f64) {
    let pivot = |time: f64| {
        let (sin, cos) = (time - 0.5).sin_cos();
        let position = [0.2 * cos + 0.1 * sin, 0.1 * cos - 0.2 * sin, time - 0.5];
        [position.to_vec(), vec![0.1 * cos - 0.2 * sin, -0.1 * sin - 0.2 * cos, 1.0]]
    };
    let motion = Motion {
        robot: robot(&urdf::body(1.0, &(point_at(-0.2, -heel) + &point_at(0.2, -0.1)))),
        columns: ["q_base_x,q_base_z,q_base_pitch", "v_base_x,v_base_z,v_base_pitch"],
        strikes: 0.5,
        before: pivot,
        after: |_| [vec![0.2, 0.1, 0.0], vec![0.0; 3]],
    };
    let found = motion.found(&motion.table(0.005, 0.4, true, 1.0), true, At::Crossing);
    let [touchdown] = &found[..] else { panic!("{} touchdowns", found.len()) };
    let answer = impact(&motion.robot, touchdown.state.to_json(&motion.robot).expect("a state"));
    assert_eq!(answer.contacts.len(), 2);
    for outcome in &answer.analysis.expect("an analysis").outcomes {
        assert!(outcome.velocity_after.iter().all(|[_, normal]| *normal >= -1e-12), "{outcome:?}");
    }
}

#[test]
fn a_simulation_that_ends_aloft_has_no_touchdown() {
    let motion = ball();
    // The last row is 0.4 mm above the ground, where a recorded foot of this size would have touched.
    let end = motion.strikes - 4e-4 / (2.0 * G).sqrt();
    let step = end / 100.0;
    let table = motion.table(step, 0.0, true, end + 0.5 * step);
    assert!(motion.found(&table, true, At::Crossing).is_empty());
    // With one more row it touches down.
    assert_eq!(motion.found(&motion.table(step, 0.0, true, end + 1.5 * step), true, At::Crossing).len(), 1);
}

#[test]
fn rates_at_the_last_row_use_none_beyond_the_impact() {
    let motion = ball();
    for phase in [0.0, 0.3, 0.6, 0.9] {
        let table = motion.table(0.02, phase, false, 0.6);
        let [Sample { time, state, .. }] = &motion.found(&table, false, At::Row)[..] else { panic!("one touchdown") };
        assert!((state.velocity[1] + G * time).abs() < 1e-9, "{} at {time}", state.velocity[1]);
    }
}

#[test]
fn a_touchdown_can_be_asked_again() {
    let motion = walker();
    let robot = file("compass.urdf", walker_urdf());
    let table = file("compass.csv", motion.table(5e-3, 0.3, true, 0.5));
    let ask = ["batch", &robot, &table, "--friction", "0.7", "--touchdowns", "--simulated", "--touching", "strike"];
    let result = heelstrike(&ask).well().line();
    let again = heelstrike_on(&["impact", &robot, "-", "--format", "json"], &result["touchdown"]["state"]);
    assert_eq!(again["outcomes"], result["outcomes"]);
    assert_eq!(again["contacts"], result["contacts"]);

    let csv = heelstrike(&[&ask[..], &["--output-format", "csv"]].concat()).well().stdout;
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let (names, cells) = (lines.next().expect("a header"), lines.next().expect("a row"));
    let before = |name: &&str| name.starts_with("q_") || name.starts_with("v_") && !name.starts_with("v_after_");
    let kept = |cells: &[&str]| -> String {
        let kept = names.iter().zip(cells).filter(|(name, _)| before(name)).map(|(_, cell)| *cell);
        kept.collect::<Vec<_>>().join(",") + "\n"
    };
    let again = ["batch", &robot, "-", "--input-format", "csv", "--friction", "0.7", "--contact-tolerance", "1e-9"];
    let again = heelstrike_reads(&again, kept(&names) + &kept(&cells)).well().line();
    // The foot that stood is also detected, and lifts off without an impulse.
    let after = |result: &Value| result["outcomes"][0]["joint_velocity_after"].clone();
    assert_eq!(after(&again), after(&result));
}

fn heelstrike_on(arguments: &[&str], state: &Value) -> Value {
    heelstrike_reads(arguments, state.to_string()).well().line()
}

/// A level rod, its front end lower by 1 mm, that falls until this end strikes after 0.4 s.
fn nearly_level_rod(after: fn(f64) -> [Vec<f64>; 2]) -> Motion {
    const TILT: f64 = 1e-3;
    let fall = |time: f64| [vec![0.5 * G * (0.16 - time * time) + 0.5 * TILT.sin(), TILT], vec![-G * time, 0.0]];
    Motion { before: fall, after, ..rod() }
}

#[test]
fn a_foot_that_another_stops_aloft_does_not_strike() {
    let stays = nearly_level_rod(|_| [vec![0.5 * 1e-3_f64.sin(), 1e-3], vec![0.0; 2]]);
    let rises = nearly_level_rod(|time| {
        let turn = 1e-3 + 0.5 * time;
        [vec![0.5 * turn.sin(), turn], vec![0.25 * turn.cos(), 0.5]]
    });
    let bounces = nearly_level_rod(|time| {
        let (turn, height) = (1e-3 + 0.5 * time, 0.5 * 1e-3_f64.sin() + 2.0 * time - 0.5 * G * time * time);
        [vec![height, turn], vec![2.0 - G * time, 0.5]]
    });
    for (name, motion) in [("stays", stays), ("rises", rises), ("bounces", bounces)] {
        for (step, with_rates) in [2e-3, 5e-3, 1e-2].into_iter().flat_map(|step| [(step, true), (step, false)]) {
            for phase in [0.0, 0.2, 0.4, 0.6, 0.8] {
                let found = motion.found(&motion.table(step, phase, with_rates, 0.6), with_rates, At::Crossing);
                let case = format!("{name}, {step} s, phase {phase}, rates {with_rates}");
                let [touchdown] = &found[..] else { panic!("{case}: {} touchdowns", found.len()) };
                assert!((touchdown.time - 0.4).abs() < 1e-8, "{case}: {}", touchdown.time);
                let [speed, turn] = [1, 2].map(|entry| touchdown.state.velocity[entry]);
                assert!((speed + 0.4 * G).abs() < 1e-6 && turn.abs() < 1e-6, "{case}: {speed}, {turn}");
            }
        }
    }
}

#[test]
fn only_a_foot_that_rises_again_has_bounced() {
    let stops = Motion { strikes: (2.0 * 0.996 / G).sqrt(), after: |_| [vec![0.104], vec![0.0]], ..ball() };
    let bounces = |time: f64| {
        let speed = (2.0 * G).sqrt();
        [vec![0.1 + (speed - 0.5 * G * time) * time], vec![speed - G * time]]
    };
    let bounces = Motion { after: bounces, ..ball() };
    for with_rates in [true, false] {
        for phase in [0.0, 0.2, 0.4, 0.6, 0.8] {
            let table = stops.table(0.01, phase, with_rates, 0.6);
            assert!(stops.found(&table, with_rates, At::Crossing).is_empty(), "phase {phase}, rates {with_rates}");
        }
        // Also if the rows before and after are at the same height.
        let phase = (bounces.strikes / 0.01 - 0.5).fract();
        for phase in [phase, phase - 1e-9, phase + 1e-9, phase + 0.2] {
            let found = bounces.found(&bounces.table(0.01, phase, with_rates, 0.6), with_rates, At::Crossing);
            let [touchdown] = &found[..] else { panic!("phase {phase}: {} touchdowns", found.len()) };
            assert!((touchdown.time - bounces.strikes).abs() < 1e-8, "phase {phase}: {}", touchdown.time);
        }
    }
}

/// A tilted rod falls until its front end strikes after 0.4 s. It then turns about this end at 2 rad/s, until the rear
/// end strikes 10 ms later.
fn slapping_rod() -> Motion {
    const TILT: f64 = 0.02;
    let fall = |time: f64| [vec![0.5 * G * (0.16 - time * time) + 0.5 * TILT.sin(), TILT], vec![-G * time, 0.0]];
    let slap = |time: f64| {
        let turn = TILT - 2.0 * time;
        if turn < 0.0 { [vec![0.0; 2], vec![0.0; 2]] } else { [vec![0.5 * turn.sin(), turn], vec![-turn.cos(), -2.0]] }
    };
    Motion { before: fall, after: slap, ..rod() }
}

#[test]
fn a_strike_a_row_after_another_has_the_motion_between() {
    let motion = slapping_rod();
    // The first row after the first strike, as a part of the step. One or two rows are between the strikes.
    for (step, part) in [0.006, 0.008].into_iter().flat_map(|step| [0.5, 0.7, 0.9].map(|part| (step, part))) {
        for with_rates in [true, false] {
            let table = motion.table(step, (0.4 / step + part).fract(), with_rates, 0.6);
            let case = format!("{step} s, {part}, rates {with_rates}");
            let found = motion.found(&table, with_rates, At::Crossing);
            let [first, second] = &found[..] else { panic!("{case}: {} touchdowns", found.len()) };
            assert!((first.time - 0.4).abs() < 1e-8, "{case}: {}", first.time);
            assert!((second.time - 0.41).abs() < 1e-6, "{case}: {}", second.time);
            // Tolerance: the sine of the tilt is not a line.
            let [speed, turn] = [1, 2].map(|entry| second.state.velocity[entry]);
            assert!((speed + 1.0).abs() < 1e-3 && (turn + 2.0).abs() < 1e-6, "{case}: {speed}, {turn}");
            assert!(found.iter().all(|touchdown| touchdown.landing.as_ref().is_some_and(|own| !own.is_crowded)));
            let at_row = motion.found(&table, with_rates, At::Row);
            assert!((at_row[1].state.velocity[2] + 2.0).abs() < 1e-6, "{case}: {:?}", at_row[1].state.velocity);
        }
    }
}

#[test]
fn a_strike_too_near_another_has_the_state_before_both() {
    let motion = slapping_rod();
    // The only row between the strikes is just after the first one, or there is none.
    for (step, part) in [(0.008, 0.3), (0.02, 0.9)] {
        let found = motion.found(&motion.table(step, (0.4 / step + part).fract(), false, 0.6), false, At::Crossing);
        let [first, second] = &found[..] else { panic!("{step} s: {} touchdowns", found.len()) };
        for touchdown in [first, second] {
            let [speed, turn] = [1, 2].map(|entry| touchdown.state.velocity[entry]);
            assert!((speed + G * touchdown.time).abs() < 1e-6 && turn.abs() < 1e-6, "{step} s: {speed}, {turn}");
        }
        let is_crowded = |touchdown: &Sample<usize>| touchdown.landing.as_ref().is_some_and(|own| own.is_crowded);
        assert_eq!([first, second].map(is_crowded), [false, true], "{step} s");
    }
}
