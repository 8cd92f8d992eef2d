//! A robot and its state seen another way: mirrored, in other units, under other names, with axes flipped, on a slope.

use super::problems::mirror;
use crate::support::impact::{impact, robot, velocities_after};
use crate::support::mechanism::{Kind, Mechanism, Point};
use crate::support::random::Random;
use crate::support::scaled::{largest, near};
use heelstrike::impact::{Analysis, Mode, Outcome, Verdict};
use heelstrike::pipeline::Impact;
use serde_json::{Value, json};

const MODELS: u64 = 400;

/// A tree of links, each but the root on a moving joint of its own, in a state, with contacts on different links.
#[derive(Debug, Clone)]
struct Model {
    mechanism: Mechanism,
    q: Vec<f64>,
    v: Vec<f64>,
    slope: f64,
    contacts: Vec<(usize, Point, f64)>,
    /// By contact.
    friction: Vec<Value>,
    restitution: Vec<f64>,
}

impl Model {
    fn random(seed: u64) -> Self {
        let random = &mut Random::new(seed);
        let count = random.whole(2, 5) as usize;
        let pair = |random: &mut Random| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let mut mechanism = Mechanism::of(random.between(0.5, 4.0), pair(random), random.between(0.05, 0.5));
        for k in 1..count {
            let parent = mechanism.links[random.whole(0, k as i64 - 1) as usize].name.clone();
            let mass = random.between(0.5, 4.0);
            mechanism = mechanism.with(&format!("link_{k}"), &parent, pair(random), mass, pair(random)).but(|link| {
                link.moment = random.between(0.05, 0.5);
                let (sin, cos) = random.between(-3.0, 3.0).sin_cos();
                link.kind =
                    if random.once_in(5) { Kind::Slide([cos, sin]) } else { Kind::Turn(random.pick(&[1.0, -1.0])) };
            });
        }
        let of = [0.0, 0.4, 1.5, f64::INFINITY, f64::INFINITY];
        let contacts = random.whole(1, 3).min(1 + count as i64 / 2) as usize;
        let links = random.permutation(count).into_iter().take(contacts);
        let friction = |mu: f64| if mu.is_finite() { json!(mu) } else { json!("infinite") };
        Self {
            mechanism,
            q: (0..count + 2).map(|_| random.between(-2.0, 2.0)).collect(),
            v: (0..count + 2).map(|k| random.between(-2.0, if k == 1 { 0.5 } else { 2.0 })).collect(),
            slope: 0.0,
            contacts: links.map(|link| (link, pair(random), random.pick(&[0.0, 0.125]))).collect(),
            friction: (0..contacts).map(|_| friction(random.pick(&of))).collect(),
            restitution: (0..contacts).map(|_| random.pick(&[0.0, 0.0, 0.3])).collect(),
        }
    }

    fn state(&self) -> Value {
        let names = self.contacts.iter().map(|(link, ..)| self.mechanism.links[*link].name.clone());
        let mut state = self.mechanism.state(0, &self.q, &self.v, &self.contacts);
        state["friction"] = names.clone().zip(self.friction.clone()).collect();
        state["restitution"] = names.zip(self.restitution.iter().map(|e| json!(e))).collect();
        state["ground"] = json!({"slope": self.slope});
        state
    }

    fn impact(&self) -> Box<Impact> {
        impact(&robot(&self.mechanism.urdf(0)), self.state())
    }

    /// What `impact` of the command line needs to repeat a failure.
    fn report(&self, seed: u64) -> String {
        format!("seed {seed}\n{}{}", self.mechanism.urdf(0), self.state())
    }

    /// Contacts and links with their points changed.
    fn map_points(&mut self, change: impl Fn(Point) -> Point) {
        self.contacts.iter_mut().for_each(|(_, point, _)| *point = change(*point));
        self.mechanism.map_points(change);
    }
}

fn analysis(impact: &Impact) -> &Analysis {
    impact.analysis.as_ref().expect("at most three contacts")
}

/// Panics unless `other` is struck as `model`, whose impact is `impact`, seen another way: tangential numbers times
/// `side` (-1 in a mirror), impulses and contact velocities in these units, and v as `first` takes it from that of
/// `other`. Another view rounds every number once more; with conditions of G up to some 1e5 that moves an answer by
/// some 1e-11 of its largest entry.
fn assert_seen(
    [model, other]: [&Model; 2],
    impact: &Impact,
    side: f64,
    units: [f64; 2],
    first: &dyn Fn(&[f64]) -> Vec<f64>,
    context: &dyn Fn() -> String,
) {
    let other = &other.impact();
    let (analysis, others) = (analysis(impact), analysis(other));
    assert_eq!(analysis.verdict, others.verdict, "{}", context());
    assert_eq!(analysis.outcomes.len(), others.outcomes.len(), "{}", context());
    assert_eq!(analysis.index_sum, others.index_sum, "{}", context());
    for (outcome, velocity) in analysis.outcomes.iter().zip(&velocities_after(impact)) {
        let modes = outcome.modes.iter().map(|&mode| if side < 0.0 { mirror(mode) } else { mode });
        let modes: Vec<Mode> = modes.collect();
        let place = others.outcomes.iter().position(|other| other.modes == modes);
        let place = place.unwrap_or_else(|| panic!("no {modes:?} among {:?}\n{}", others.outcomes, context()));
        let twin = &others.outcomes[place];
        assert_eq!(outcome.index, twin.index, "{}", context());
        assert_near(&[outcome.margin.expect("one")], &[twin.margin.expect("one")], 1.0, "margin", context);
        let seen = |values: &[[f64; 2]], unit: f64| -> Vec<f64> {
            values.iter().flat_map(|[t, n]| [side * unit * t, unit * n]).collect()
        };
        let [push, speed] = units;
        assert_near(&seen(&outcome.impulse, push), &twin.impulse.concat(), 0.0, "impulse", context);
        let before = largest(&seen(&impact.velocity_before, speed));
        let after = seen(&outcome.velocity_after, speed);
        assert_near(&after, &twin.velocity_after.concat(), before, "velocity after", context);
        let other = first(&velocities_after(other)[place]);
        assert_near(velocity, &other, largest(&model.v), "v after", context);
    }
}

/// Both equal to 1e-9 of the largest entry or `scale`.
fn assert_near(a: &[f64], b: &[f64], scale: f64, what: &str, context: &dyn Fn() -> String) {
    let scale = scale.max(largest(a));
    assert!(near(a, b, 1e-9 * scale), "{what}: {a:?} is not {b:?}\n{}", context());
}

/// Runs `check` on every model that is decided; most must be.
fn for_every_model(check: impl Fn(u64, &Model, &Impact)) {
    let (mut ambiguous, mut decided) = (0, 0);
    for seed in 0..MODELS {
        let model = Model::random(seed);
        let impact = model.impact();
        if analysis(&impact).verdict != Verdict::Undecided {
            check(seed, &model, &impact);
            decided += 1;
            ambiguous += i32::from(analysis(&impact).outcomes.len() > 1);
        }
    }
    assert!(decided > MODELS - 4, "only {decided} are decided");
    assert!(ambiguous > 5, "only {ambiguous} are ambiguous");
}

#[test]
fn a_mirrored_robot_slides_the_other_way() {
    for_every_model(|seed, model, impact| {
        let mut mirrored = model.clone();
        mirrored.map_points(|[x, z]| [-x, z]);
        for link in &mut mirrored.mechanism.links {
            match &mut link.kind {
                Kind::Slide(along) => along[0] = -along[0],
                Kind::Turn(sign) => *sign = -*sign,
                _ => {}
            }
        }
        let seen = |v: &[f64]| [&[-v[0], v[1], -v[2]], &v[3..]].concat();
        (mirrored.q, mirrored.v) = (seen(&model.q), seen(&model.v));
        assert_seen([model, &mirrored], impact, -1.0, [1.0; 2], &seen, &|| model.report(seed));
    });
}

#[test]
fn units_change_no_verdict_and_no_margin_of_a_robot() {
    for_every_model(|seed, model, impact| {
        for (k, factor) in [0, 1, 2].into_iter().flat_map(|k| [(k, 1e6), (k, 1e-6)]) {
            let mut units = [1.0; 3];
            units[k] = factor;
            let [mass, length, time] = units;
            let mut scaled = Model { mechanism: model.mechanism.in_units(mass, length), ..model.clone() };
            for (_, point, radius) in &mut scaled.contacts {
                (*point, *radius) = (point.map(|x| x * length), *radius * length);
            }
            let units_of_q = model.mechanism.units_of_coordinates(length);
            scaled.q.iter_mut().zip(&units_of_q).for_each(|(q, unit)| *q *= unit);
            scaled.v.iter_mut().zip(&units_of_q).for_each(|(v, unit)| *v *= unit / time);
            let seen = |v: &[f64]| v.iter().zip(&units_of_q).map(|(v, unit)| v * time / unit).collect();
            let context = || format!("units of mass {mass}, length {length}, time {time}, {}", model.report(seed));
            assert_seen([model, &scaled], impact, 1.0, [mass * length / time, length / time], &seen, &context);
        }
    });
}

#[test]
fn a_flipped_axis_is_the_same_joint() {
    for_every_model(|seed, model, impact| {
        let sign = |k: usize| if k > 2 && (seed as usize + k).is_multiple_of(2) { -1.0 } else { 1.0 };
        let seen = |v: &[f64]| v.iter().enumerate().map(|(k, v)| sign(k) * v).collect::<Vec<f64>>();
        let mut flipped = model.clone();
        for (k, link) in flipped.mechanism.links.iter_mut().enumerate().skip(1) {
            match &mut link.kind {
                Kind::Turn(about) => *about *= sign(k + 2),
                Kind::Slide(along) => *along = along.map(|x| sign(k + 2) * x),
                _ => {}
            }
        }
        (flipped.q, flipped.v) = (seen(&model.q), seen(&model.v));
        assert_seen([model, &flipped], impact, 1.0, [1.0; 2], &seen, &|| model.report(seed));
    });
}

#[test]
fn names_do_not_matter() {
    for_every_model(|seed, model, impact| {
        let mut renamed = model.clone();
        let order = Random::new(seed).permutation(model.mechanism.links.len());
        for (link, number) in renamed.mechanism.links.iter_mut().zip(order) {
            // Another order of the alphabet.
            link.name = format!("{number} glied");
        }
        let unnamed = |outcome: &Outcome| Outcome { joint_velocity_after: None, ..outcome.clone() };
        let outcomes = |impact: &Impact| -> Vec<Outcome> { analysis(impact).outcomes.iter().map(unnamed).collect() };
        let other = renamed.impact();
        // Nothing is computed in another order, so that not a bit may change.
        assert_eq!(outcomes(impact), outcomes(&other), "{}", model.report(seed));
        assert_eq!(velocities_after(impact), velocities_after(&other), "{}", model.report(seed));
        assert_eq!(impact.velocity_before, other.velocity_before, "{}", model.report(seed));
    });
}

#[test]
fn a_slope_is_level_ground_seen_askew() {
    for_every_model(|seed, model, impact| {
        // Everything turned so that +x points uphill; a positive pitch turns the other way.
        let slope = [0.3, -0.7, 1.2][seed as usize % 3];
        let (sin, cos) = f64::sin_cos(slope);
        let turn = |v: [f64; 2], sin: f64| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
        let mut askew = model.clone();
        askew.slope = slope;
        askew.q[2] -= slope;
        askew.v[..2].copy_from_slice(&turn([model.v[0], model.v[1]], sin));
        let seen = |v: &[f64]| [&turn([v[0], v[1]], -sin)[..], &v[2..]].concat();
        assert_seen([model, &askew], impact, 1.0, [1.0; 2], &seen, &|| model.report(seed));
    });
}
