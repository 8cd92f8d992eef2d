//! Points of one body on one line of ground: the outer two act for all of them.

use heelstrike::Robot;
use heelstrike::pipeline::{Impact, LeftOut, Options};
use heelstrike::reductions::Reductions;
use heelstrike::state::NamedContact;
use serde_json::{Value, json};

use super::comparison::floating;
use crate::support::impact::{outcomes, robot, try_impact};
use crate::support::mechanism::{Mechanism, Point};
use crate::support::parallel::total;
use crate::support::random::Random;
use crate::support::scaled::{largest, near};
use crate::support::urdf::{self, POINT, collision, link};

/// A robot, points of it that lie on the ground, and a state.
struct Case {
    robot: Robot,
    feet: Vec<NamedContact>,
    state: Value,
    /// Its largest rate before the impact.
    rate: f64,
}

/// The contact tolerance of the cases \[m\].
const TOLERANCE: f64 = 0.1;

/// A random robot of three links, whose root stands with three to five points, and at times its shin with one. The
/// points are exactly on level ground or on a tilted line, or inner ones are off it: as far as their friction cones let
/// them act through the outer two, or farther.
fn case(seed: u64) -> Case {
    let mut random = Random::new(seed);
    let mut point = |size: f64| -> Point { [random.between(-size, size), random.between(-size, size)] };
    let [root, hip, thigh, knee, shin] = [0.3, 0.5, 0.2, 0.5, 0.2].map(&mut point);
    let mechanism = Mechanism::of(random.between(1.0, 5.0), root, random.between(0.05, 0.5))
        .with("thigh", "root", hip, random.between(0.5, 2.0), thigh)
        .with("shin", if random.once_in(2) { "root" } else { "thigh" }, knee, random.between(0.2, 1.0), shin);
    let mut numbers = || -> Vec<f64> { (0..5).map(|_| random.between(-1.0, 1.0)).collect() };
    let (mut q, mut v) = (numbers(), numbers());
    if random.once_in(4) {
        // A body that falls straight.
        v = vec![0.0, -1.0, 0.0, 0.0, 0.0];
    }
    q[..3].fill(0.0);
    let height = random.between(0.2, 1.0);
    let bounce = if random.once_in(2) { 0.0 } else { random.between(0.0, 1.0) };
    let friction = [Some(0.0), Some(random.between(0.05, 2.0)), None][random.whole(0, 2) as usize];
    let mut places: Vec<f64> = (0..random.whole(3, 5)).map(|_| random.between(-0.3, 0.3)).collect();
    places.sort_by(f64::total_cmp);
    let [rear, front] = [places[0], places[places.len() - 1]];
    let (is_flat, reach) = (random.once_in(2), if random.once_in(2) { 1.0 } else { 4.0 });
    let tilt = if random.once_in(3) { random.between(-0.1, 0.1) } else { 0.0 };
    let mut feet: Vec<NamedContact> = (places.iter())
        .map(|&x| {
            let room = (x - rear).min(front - x) / friction.unwrap_or(1.0).max(1e-3);
            let off = if is_flat { 0.0 } else { (reach * room).min(0.5 * TOLERANCE) * random.between(-1.0, 1.0) };
            NamedContact { link: 0, offset: [x, 0.0, off + tilt * x - height], radius: 0.0 }
        })
        .collect();
    if random.once_in(3) {
        // The point of the shin that is at (x, -height) in the world.
        let (link, x) = (2, random.between(-0.3, 0.3));
        let [origin, along, up] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|own| mechanism.point(&q, link, own));
        let at = |end: Point| (end[0] - origin[0]) * (x - origin[0]) - (end[1] - origin[1]) * (height + origin[1]);
        let place = mechanism.links[link].place;
        feet.push(NamedContact { link, offset: [at(along) - place[0], 0.0, at(up) - place[1]], radius: 0.0 });
    }
    let joints = |of: &[f64]| json!({"thigh": of[3], "shin": of[4]});
    let state = json!({
        "position": {"base": {"z": height}, "joints": joints(&q)},
        "velocity": {"base": {"x": v[0], "z": v[1], "pitch": v[2]}, "joints": joints(&v)},
        "friction": friction.map_or(json!("infinite"), |mu| json!(mu)), "restitution": bounce,
    });
    Case { robot: floating(&mechanism.urdf(0), Reductions::ALL), feet, state, rate: largest(&v) }
}

/// Returns how many points are merged, or an error if the answers with and without merging differ: in the verdict, the
/// modes of the contacts that remain or, by more than 1e-12 of scale, velocities after the impact or the sum of all
/// impulses.
fn compare(Case { robot, feet, state, rate }: Case) -> Result<usize, String> {
    let answer = |merge: bool| -> Box<Impact> {
        let reductions = Reductions { merge, ..Reductions::ALL };
        let options =
            Options { feet: feet.clone(), contact_tolerance: Some(TOLERANCE), reductions, ..Options::default() };
        try_impact(&robot, options, &state).unwrap_or_else(|error| panic!("{error}\n{state}"))
    };
    let [merged, whole] = [true, false].map(answer);
    let inner = merged.left_out.iter().map(|left| if let LeftOut::Merged(own) = left { own.inner } else { 0 }).sum();
    assert_eq!((merged.contacts.len() + inner, whole.contacts.len()), (feet.len(), feet.len()));
    // The places of the remaining contacts among all.
    let remain: Vec<usize> = (merged.contacts.iter())
        .map(|own| whole.contacts.iter().position(|other| own.center == other.center && own.link == other.link))
        .collect::<Option<_>>()
        .ok_or("another point")?;
    let verdict = |impact: &Impact| impact.analysis.as_ref().map(|own| (own.verdict, own.proven));
    if verdict(&merged) != verdict(&whole) {
        return Err(format!("{:?} and {:?}", verdict(&merged), verdict(&whole)));
    }
    if !verdict(&whole).is_some_and(|(_, proven)| proven) {
        return Err("the whole is not proven".to_owned());
    }
    let mass: f64 = robot.mass();
    for one in outcomes(&merged) {
        let same = outcomes(&whole).iter().any(|other| {
            let modes = remain.iter().map(|&at| other.modes[at]);
            let sum = |list: &[[f64; 2]], k: usize| list.iter().map(|own| own[k]).sum::<f64>();
            let [own, others] = [one, other].map(|own| own.velocity().collect::<Vec<_>>());
            let sums = [one, other].map(|own| [0, 1].map(|k| sum(&own.impulse, k)));
            let size = rate.max(largest(&own));
            modes.eq(one.modes.iter().copied())
                && near(&own, &others, 1e-12 * size)
                && near(&sums[0], &sums[1], 1e-12 * mass * size)
        });
        if !same {
            return Err(format!("{one:?}\nis none of {:?}", outcomes(&whole)));
        }
    }
    let counts = [&merged, &whole].map(|impact| outcomes(impact).len());
    if counts[0] == counts[1] { Ok(inner) } else { Err(format!("{counts:?} outcomes")) }
}

/// `HEELSTRIKE_STATES=20000 cargo test --release --test library -- --nocapture outer_points` checks more states.
#[test]
fn outer_points_act_for_all() {
    let states = std::env::var("HEELSTRIKE_STATES").ok().and_then(|states| states.parse().ok());
    let states = states.unwrap_or(60);
    let [merged, wrong] = total(states, |seed| {
        let case = case(seed);
        let state = case.state.to_string();
        match compare(case) {
            Ok(inner) => [inner as u64, 0],
            Err(what) => {
                println!("seed {seed}: {what}\n{state}");
                [0, 1]
            }
        }
    });
    println!("{merged} points were merged");
    // Every other case is flat and has two inner points on average.
    assert!(merged > states, "{merged}");
    assert_eq!(wrong, 0);
}

/// If a body bounces and turns, c_t differs along a tilted line: a point between the ends may stick while both slide.
#[test]
fn points_on_a_tilted_line_stay_where_they_bounce() {
    let foot = |x: f64| collision([x, 0.0], POINT);
    let plank = urdf::robot(&[link("plank", 2.0, [0.0, 0.1], 0.02, &[-0.3, 0.02, 0.3].map(foot).concat())]);
    for (bounce, contacts, count) in [(0.5, 3, 2), (0.0, 2, 1)] {
        let state = json!({"friction": 0.8, "restitution": bounce, "place": "lowest", "position": {"base": {"pitch": 1e-3}},
            "velocity": {"base": {"z": -1, "pitch": 1}}});
        let options = Options { contact_tolerance: Some(1e-3), ..Options::default() };
        let found = try_impact(&robot(&plank), options, &state).expect("an answer");
        assert_eq!((found.contacts.len(), outcomes(&found).len()), (contacts, count), "e = {bounce}");
    }
}
