//! Touchdowns of recordings with noise: a walk of two feet whose moments of contact are known.

use super::{samples, touchdowns};
use crate::support::impact::robot;
use crate::support::random::Random;
use crate::support::urdf::{self, collision};
use heelstrike::gait::{At, Difference, Heights, Landing, Touching, rates};
use heelstrike::read::table::Rates;
use std::fmt::Write;

/// Gravity \[m/s^2\].
const G: f64 = 9.81;
/// The duration of a swing \[s\], on a parabola; the foot stands for the rest of a stride.
const SWING: f64 = 0.35;
const STRIDE: f64 = 0.8;
/// The speed at which it strikes \[m/s\].
const STRIKES: f64 = 0.5;
/// The number of strides of each foot.
const STRIDES: u32 = 6;

/// The time \[s\] and the foot.
type Strike = (f64, &'static str);

fn height(time: f64) -> f64 {
    let time = time.rem_euclid(STRIDE);
    if time < SWING { STRIKES * (SWING - time) * time / SWING } else { 0.0 }
}

/// A normally distributed number, to three digits, from the sum of twelve uniform ones.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.uniform()).sum::<f64>() - 6.0
}

/// A table of the walk with rows at this rate, with noise of this standard deviation \[m\] in the height of the base,
/// and its strikes.
fn walk(hertz: u32, noise: f64, seed: u64) -> (String, Vec<Strike>) {
    let mut random = Random::new(seed);
    let (step, level) = (1.0 / f64::from(hertz), random.between(-0.01, 0.01));
    let mut table = "time,q_base_z,q_ja,q_jb\n".to_owned();
    let first = random.uniform() * step;
    let end = f64::from(STRIDES) * STRIDE + 0.3;
    for time in (0..).map(|row| first + f64::from(row) * step).take_while(|time| *time < end) {
        let b = if time < 0.5 * STRIDE { 0.0 } else { height(time - 0.5 * STRIDE) };
        let shaken = noise * normal(&mut random);
        // The lowest point of a foot is its radius below its link.
        let [a, b] = [height(time), b].map(|height| height + level);
        writeln!(table, "{time:?},{:?},{a:?},{b:?}", 0.1 + shaken).expect("a string takes all");
    }
    let strikes = (0..STRIDES).map(f64::from).flat_map(|stride| {
        let strikes = stride * STRIDE + SWING;
        [(strikes, "a"), (strikes + 0.5 * STRIDE, "b")]
    });
    (table, strikes.filter(|(time, _)| *time < end - 0.1).collect())
}

/// The errors of time \[s\] and speed \[m/s\] of the touchdowns that are found by default; asserts their order.
fn errors(hertz: u32, noise: f64, seed: u64) -> Vec<[f64; 2]> {
    let (table, strikes) = walk(hertz, noise, seed);
    let robot = super::motion::lift(1.0);
    let samples = rates(samples(&table, &robot, Rates::Time).into_iter(), Difference::Central).collect();
    let found = touchdowns(Heights::Recorded, &robot, &[], samples, At::Crossing, Touching::Strike);
    let case = format!("{hertz} Hz, {noise} m, seed {seed}");
    assert_eq!(found.len(), strikes.len(), "{case}");
    let error = |(found, (time, foot)): (&heelstrike::gait::Sample<usize>, &Strike)| {
        let Some(Landing { striking, is_early, .. }) = &found.landing else { panic!("{case}: no landing") };
        assert_eq!((striking.as_str(), *is_early), (*foot, false), "{case} at {}", found.time);
        let joint = 3 + usize::from(striking == "b");
        [found.time - time, found.state.velocity[1] + found.state.velocity[joint] + STRIKES]
    };
    found.iter().zip(&strikes).map(error).collect()
}

#[test]
fn noise_leaves_every_touchdown() {
    // Limits are twice the errors measured on 400 touchdowns: the time that 90 % keep, and the mean speed.
    for (hertz, noise, moment, speed) in [
        (100, 1e-4, 1.6e-3, 0.02),
        (100, 1e-3, 10e-3, 0.12),
        (500, 1e-4, 1.2e-3, 0.02),
        (500, 1e-3, 8e-3, 0.12),
        (1000, 1e-3, 5e-3, 0.12),
        (1000, 3e-3, 10e-3, 0.2),
    ] {
        let all: Vec<[f64; 2]> = (1..=3).flat_map(|seed| errors(hertz, noise, seed)).collect();
        let case = format!("{hertz} Hz, {noise} m");
        let mut moments: Vec<f64> = all.iter().map(|[moment, _]| moment.abs()).collect();
        moments.sort_by(f64::total_cmp);
        let most = moments[moments.len() * 9 / 10];
        assert!(most < moment, "{case}: {most} s");
        let mean = all.iter().map(|[_, speed]| speed).sum::<f64>() / all.len() as f64;
        assert!(mean.abs() < speed, "{case}: {mean} m/s");
    }
}

#[test]
fn recorded_velocities_show_an_impact_that_noise_hides() {
    for (hertz, noise, bounces) in [(500, 3e-4, false), (200, 1e-3, false), (100, 3e-3, false), (500, 3e-4, true)] {
        let mut random = Random::new(5);
        // A ball is thrown up at these speeds, each time after it has stopped, or bounces.
        let throws: Vec<f64> = (0..40).map(|_| random.between(1.5, 2.5)).collect();
        let mut table = "time,q_base_z,v_base_z\n".to_owned();
        let (mut row, mut start) = (0, 0.0);
        for speed in &throws {
            let flight = 2.0 * speed / G;
            let end = start + flight + if bounces { 0.0 } else { 0.3 };
            for time in (row..).map(|row| f64::from(row) / f64::from(hertz)).take_while(|time| *time < end) {
                let since = time - start;
                let [height, rate] =
                    if since < flight { [(speed - 0.5 * G * since) * since, speed - G * since] } else { [0.0; 2] };
                writeln!(table, "{time:?},{:?},{rate:?}", 0.3 + height + noise * normal(&mut random)).unwrap();
                row += 1;
            }
            start = end;
        }
        let robot = robot(&urdf::body(1.0, &collision([0.0; 2], "sphere radius=\"0.3\"")));
        let samples = samples(&table, &robot, Rates::Columns);
        let found = touchdowns(Heights::Recorded, &robot, &[], samples, At::Crossing, Touching::Strike);
        let case = format!("{hertz} Hz, {noise} m");
        // The last touchdown may be missing, because it ends the clip.
        assert!(found.len() + 1 >= throws.len() && found.len() <= throws.len(), "{case}: {} found", found.len());
        for (touchdown, speed) in found.iter().zip(&throws) {
            let rate = touchdown.state.velocity[1];
            assert!((rate + speed).abs() < 0.15 * speed, "{case}: {rate} m/s is not -{speed}");
        }
    }
}

/// A ball that is slowed on its way, as by a knee that is stopped, has not touched down there.
#[test]
fn a_fall_that_is_slowed_goes_on() {
    // It falls at 1 m/s, and for the last `slowed` \[s\] before it strikes at half of that.
    for slowed in [0.02, 0.04, 0.06] {
        let height = |left: f64| if left < 0.0 { 0.0 } else { 0.5 * left + 0.5 * (left - slowed).max(0.0) };
        let mut table = "time,q_base_z,v_base_z\n".to_owned();
        for time in (0..60).map(|row| f64::from(row) / 100.0) {
            let left = 0.354 - time;
            let rate = if left > slowed { -1.0 } else { [-0.5, 0.0][usize::from(left < 0.0)] };
            writeln!(table, "{time:?},{:?},{rate:?}", 0.3 + height(left)).unwrap();
        }
        let robot = robot(&urdf::body(1.0, &collision([0.0; 2], "sphere radius=\"0.3\"")));
        let samples = samples(&table, &robot, Rates::Columns);
        let found = touchdowns(Heights::Recorded, &robot, &[], samples, At::Crossing, Touching::Strike);
        let [touchdown] = &found[..] else { panic!("{} touchdowns, slowed {slowed} s before", found.len()) };
        assert!((touchdown.time - 0.354).abs() < 0.005, "{} s, slowed {slowed} s before", touchdown.time);
        assert!((touchdown.state.velocity[1] + 0.5).abs() < 0.1, "{} m/s", touchdown.state.velocity[1]);
    }
}

#[test]
fn a_flat_foot_is_one_touchdown_whatever_the_noise_of_its_rates() {
    let mut random = Random::new(9);
    let mut table = "time,q_base_z,v_base_z,v_base_pitch\n".to_owned();
    for row in 0..1200 {
        // It comes down at 0.5 m/s and slows down over 30 ms; it stands, and is lifted again.
        let (time, cycle) = (f64::from(row) / 100.0, f64::from(row % 60) / 100.0);
        let [height, rate] = match cycle {
            ..0.09 => [0.06 - 0.5 * cycle, -0.5],
            ..0.45 => [0.015, -0.5].map(|start| start * ((0.09 - cycle) / 0.03).exp()),
            _ => [0.4 * (cycle - 0.45), 0.4],
        };
        writeln!(table, "{time:?},{height:?},{rate:?},{:?}", 0.1 * normal(&mut random)).unwrap();
    }
    let corners = [-0.5, 0.5].map(|x| collision([x, 0.0], "sphere radius=\"0\"")).concat();
    let robot = robot(&urdf::body(1.0, &(corners + &collision([0.0, 0.5], "sphere radius=\"0.1\""))));
    let samples = samples(&table, &robot, Rates::Columns);
    let found = touchdowns(Heights::Recorded, &robot, &[], samples, At::Crossing, Touching::Strike);
    let contacts: Vec<usize> = found.iter().map(|own| own.state.scene.contacts.as_ref().unwrap().len()).collect();
    assert_eq!(contacts, [2; 20]);
}

#[test]
fn without_noise_moments_are_true() {
    for hertz in [100, 500, 1000] {
        for [moment, speed] in errors(hertz, 0.0, 7) {
            assert!(moment.abs() < 1e-6 / f64::from(hertz), "{hertz} Hz: {moment:e} s");
            assert!(speed.abs() < 1e-6, "{hertz} Hz: {speed:e} m/s");
        }
    }
}
