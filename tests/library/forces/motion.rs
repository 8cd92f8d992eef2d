//! Random mechanisms: what holds whatever the contacts do.

use super::{outcomes, try_forces};
use crate::support::impact::robot;
use crate::support::mechanism::{Kind, Link, Mechanism, mechanism, motion};
use heelstrike::contact::Placement;
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::{Defaults, State};
use nalgebra::DVector;
use proptest::prelude::*;
use proptest::sample::Index;
use serde_json::json;

const GRAVITY: f64 = 9.81;
/// Length of the five-bar's thigh \[m\].
const THIGH: f64 = 0.4;

fn kinetic(mechanism: &Mechanism, q: &[f64], v: &DVector<f64>) -> f64 {
    0.5 * v.dot(&(mechanism.mass_matrix(q) * v))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// d/dt of the kinetic energy is the power of gravity, of the torques and of the contacts.
    #[test]
    fn power_is_balanced(
        (mut mechanism, q, v, torque) in mechanism().prop_flat_map(|mechanism| {
            let joints = mechanism.links.len() - 1;
            (Just(mechanism), motion(joints, 1.0, 2.0), motion(joints, 1.0, 2.0), motion(joints, 1.0, 3.0))
        }),
        places in prop::collection::vec((any::<Index>(), prop::array::uniform2(-0.5..0.5f64)), 0..3),
    ) {
        // The plane is that of the hinges. What has no mass has no inertia in the file.
        prop_assume!(mechanism.links[1..].iter().any(|link| matches!(link.kind, Kind::Turn(_))));
        mechanism.links.iter_mut().filter(|link| link.mass == 0.0).for_each(|link| link.moment = 0.0);
        let still = |values: Vec<f64>| -> Vec<f64> {
            let moves = |index: usize| index < 3 || mechanism.links[index - 2].moves();
            values.into_iter().enumerate().map(|(index, value)| if moves(index) { value } else { 0.0 }).collect()
        };
        let (q, mut v, torque) = (still(q), DVector::from_vec(still(v)), still(torque));
        // Normal velocities are taken out, row by row.
        let contacts: Vec<_> = places.iter().map(|(link, at)| (link.index(mechanism.links.len()), *at, 0.0)).collect();
        let normal = |&(link, at, _): &(usize, [f64; 2], f64)| {
            let place = mechanism.links[link].place;
            let offset = [at[0] - place[0], at[1] - place[1]];
            let mut row = mechanism.point_rates(&q, &mechanism.links[link].name, offset).row(1).into_owned();
            for (index, own) in mechanism.links.iter().enumerate().skip(1) {
                if !own.moves() { row[2 + index] = 0.0 }
            }
            row
        };
        let rows: Vec<_> = contacts.iter().map(normal).collect();
        for _ in 0..4 {
            for row in &rows {
                let excess = row.transpose().dot(&v) / row.norm_squared();
                v -= row.transpose() * excess;
            }
        }
        let mut state = mechanism.state(0, &q, v.as_slice(), &contacts);
        let joints = mechanism.links.iter().skip(1).zip(&torque[3..]).filter(|(link, _)| link.moves());
        state["torque"] = joints.map(|(link, torque)| (link.name.clone(), json!(torque))).collect();
        state["friction"] = json!(0.4);
        let robot = robot(&mechanism.urdf(0));
        let Ok(found) = try_forces(&robot, &state) else { return Ok(()) };
        for outcome in outcomes(&found) {
            let mut moving = outcome.velocity();
            let mut own: Vec<f64> = (0..3).map(|_| moving.next().unwrap()).collect();
            let joints = mechanism.links.iter().skip(1);
            own.extend(joints.map(|link| if link.moves() { moving.next().unwrap() } else { 0.0 }));
            let a = DVector::from_vec(own);
            let energy = |time: f64| {
                let at: Vec<f64> = (0..q.len()).map(|k| q[k] + time * v[k] + 0.5 * time * time * a[k]).collect();
                kinetic(&mechanism, &at, &(&v + &a * time))
            };
            // A stencil of five points: errors of h^4 and of the rounding over h.
            let step = 1e-3;
            let change = 8.0 * (energy(step) - energy(-step)) - energy(2.0 * step) + energy(-2.0 * step);
            let change = change / (12.0 * step);
            let falls = |link: &Link| {
                let offset = [link.com[0] - link.place[0], link.com[1] - link.place[1]];
                -GRAVITY * link.mass * (mechanism.point_rates(&q, &link.name, offset) * &v)[1]
            };
            let falling: f64 = mechanism.links.iter().map(falls).sum();
            let driven: f64 = torque[3..].iter().zip(v.iter().skip(3)).map(|(torque, rate)| torque * rate).sum();
            let power = falling + driven - outcome.energy_loss;
            let size = a.amax().max(1.0) * v.amax().max(1.0) * 10.0;
            prop_assert!((change - power).abs() < 1e-9 * size * size, "{change} {power}");
        }
    }
}

/// Both ends of a loop accelerate alike, so that a step of second order keeps it closed to third order.
#[test]
fn loop_stays_closed_while_it_moves() {
    let robot = robot(include_str!("../../../urdf/five_bar.urdf"));
    let [hip, knee] = [0.6, -1.309842048791_f64];
    // Mirrored legs whose common end stays in the middle.
    let rate = -(1.0 + THIGH * hip.cos() / (0.5 * (hip + knee).cos()));
    let end = |link: &str| json!({"link": link, "offset": [0.0, 0.0, -0.5]});
    let state = json!({
        "position": {"joints": {"left_hip": hip, "left_knee": knee, "right_hip": -hip, "right_knee": -knee}},
        "velocity": {
            "base": {"x": 0.3, "pitch": 0.7},
            "joints": {"left_hip": 1.0, "left_knee": rate, "right_hip": -1.0, "right_knee": -rate}
        },
        "torque": {"left_hip": 2.0, "right_knee": -1.0},
        "loops": [{"a": end("left_shank"), "b": end("right_shank")}],
        "contacts": [],
    });
    let state = State::from_json(&state.to_string(), &robot, &Defaults::default()).unwrap();
    let found = Pipeline::new(&robot, Options::default()).forces(&state).unwrap();
    let outcome = &outcomes(&found)[0];
    let a: Vec<f64> = outcome.velocity().collect();
    assert!(outcome.loop_impulse.as_ref().unwrap()[0].length() > 1.0, "{outcome:?}");
    let gap = |time: f64| {
        let way = (0..a.len()).map(|k| state.position[k] + time * state.velocity[k] + 0.5 * time * time * a[k]);
        let placement = Placement::of_robot(&robot, &way.collect::<Vec<_>>());
        let at = |name: &str| {
            let link = &robot.links[robot.link(name).unwrap()];
            placement.world(link.body, link.point([0.0, 0.0, -0.5]))
        };
        at("left_shank") - at("right_shank")
    };
    let step = 1e-4;
    let second = (gap(step) + gap(-step) - gap(0.0) - gap(0.0)) * (1.0 / (step * step));
    // The next order is step^2 times the fourth power of rates of 3 rad/s; without kappa it is 0.04.
    assert!(second.length() < 1e-5, "{second:?}");
}
