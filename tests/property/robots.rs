//! A robot and its state seen another way: mirrored, in other units, under other names, with axes flipped, on a slope.

use super::problems::mirror;
use crate::support::impact::velocities_after;
use crate::support::random::Random;
use crate::support::urdf::{self, Axis};
use heelstrike::Robot;
use heelstrike::impact::{Analysis, Mode, Outcome, Verdict};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::state::{Defaults, State};
use serde_json::{Value, json};

const MODELS: u64 = 400;

/// A tree of links, each but the root on a moving joint of its own, in a state, with contacts on different links.
#[derive(Debug, Clone)]
struct Model {
    links: Vec<Link>,
    base: Coordinates,
    slope: f64,
    contacts: Vec<Contact>,
}

/// A link and the joint that moves it; the root has no use for the latter.
#[derive(Debug, Clone)]
struct Link {
    name: String,
    mass: f64,
    com: [f64; 2],
    moment: f64,
    joint: String,
    parent: usize,
    origin: [f64; 2],
    axis: Axis,
    position: f64,
    velocity: f64,
}

#[derive(Debug, Clone)]
struct Coordinates {
    position: [f64; 3],
    velocity: [f64; 3],
}

#[derive(Debug, Clone)]
struct Contact {
    link: usize,
    offset: [f64; 2],
    radius: f64,
    friction: Value,
    restitution: f64,
}

impl Model {
    fn random(seed: u64) -> Self {
        let random = &mut Random::new(seed);
        let count = random.whole(2, 5) as usize;
        let pair = |random: &mut Random| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let links = (0..count).map(|index| Link {
            name: format!("link_{index}"),
            mass: random.between(0.5, 4.0),
            com: pair(random),
            moment: random.between(0.05, 0.5),
            joint: format!("joint_{index}"),
            parent: if index > 0 { random.whole(0, index as i64 - 1) as usize } else { 0 },
            origin: pair(random),
            axis: if random.once_in(5) {
                Axis::Prismatic(pair(random))
            } else {
                Axis::Revolute(random.pick(&[1.0, -1.0]))
            },
            position: random.between(-2.0, 2.0),
            velocity: random.between(-2.0, 2.0),
        });
        let links: Vec<Link> = links.collect();
        let contacts =
            random.permutation(count).into_iter().take(random.whole(1, 3).min(1 + count as i64 / 2) as usize);
        let contacts: Vec<usize> = contacts.collect();
        let contacts = contacts.into_iter().map(|link| Contact {
            link,
            offset: pair(random),
            radius: random.pick(&[0.0, 0.125]),
            friction: random.pick(&[json!(0), json!(0.4), json!(1.5), json!("infinite"), json!("infinite")]),
            restitution: random.pick(&[0.0, 0.0, 0.3]),
        });
        let contacts = contacts.collect();
        let fall = random.between(-3.0, 0.5);
        let base = Coordinates {
            position: [random.between(-1.0, 1.0), random.between(0.0, 1.0), random.between(-2.0, 2.0)],
            velocity: [random.between(-2.0, 2.0), fall, random.between(-2.0, 2.0)],
        };
        Self { links, base, slope: 0.0, contacts }
    }

    fn urdf(&self) -> String {
        let links = self.links.iter().map(|link| urdf::link(&link.name, link.mass, link.com, link.moment, ""));
        let joints = self.links.iter().skip(1).map(|link| {
            let ends = [&self.links[link.parent].name, &link.name].map(String::as_str);
            urdf::joint(&link.joint, link.axis, ends, link.origin, "")
        });
        urdf::robot(&links.chain(joints).collect::<Vec<_>>())
    }

    fn state(&self) -> Value {
        let joints = |value: &dyn Fn(&Link) -> f64| -> Value {
            self.links.iter().skip(1).map(|link| (link.joint.clone(), json!(value(link)))).collect()
        };
        let base = |[x, z, pitch]: [f64; 3]| json!({"x": x, "z": z, "pitch": pitch});
        let by_link = |value: &dyn Fn(&Contact) -> Value| -> Value {
            self.contacts.iter().map(|contact| (self.links[contact.link].name.clone(), value(contact))).collect()
        };
        let contacts = self.contacts.iter().map(|contact| {
            let [x, z] = contact.offset;
            json!({"link": self.links[contact.link].name, "offset": [x, 0, z], "radius": contact.radius})
        });
        json!({
            "position": {"base": base(self.base.position), "joints": joints(&|link| link.position)},
            "velocity": {"base": base(self.base.velocity), "joints": joints(&|link| link.velocity)},
            "friction": by_link(&|contact| contact.friction.clone()),
            "restitution": by_link(&|contact| json!(contact.restitution)),
            "ground": {"slope": self.slope},
            "contacts": contacts.collect::<Vec<_>>(),
        })
    }

    fn impact(&self) -> Impact {
        let robot = Robot::from_urdf(&self.urdf()).unwrap_or_else(|error| panic!("{error}\n{}", self.urdf()));
        let state = State::from_json(&self.state().to_string(), &robot, &Defaults::default());
        let state = state.unwrap_or_else(|error| panic!("{error}\n{}", self.state()));
        let impact = Pipeline::new(&robot, Options::default()).impact(&state);
        impact.unwrap_or_else(|error| panic!("{error}\n{}{}", self.urdf(), self.state()))
    }

    /// What `impact` of the command line needs to repeat a failure.
    fn report(&self, seed: u64) -> String {
        format!("seed {seed}\n{}{}", self.urdf(), self.state())
    }
}

fn analysis(impact: &Impact) -> &Analysis {
    impact.analysis.as_ref().expect("at most three contacts")
}

/// How the numbers of another view follow from the first one's.
struct View<'a> {
    mode: fn(Mode) -> Mode,
    /// Of L_t and L_n.
    impulse: [f64; 2],
    /// Of c_t and c_n.
    contact_velocity: [f64; 2],
    /// v of the first view from v of the other one.
    velocity: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl View<'_> {
    /// Panics unless `other` is struck as the first view says: `model` and its `impact`. Another view rounds every
    /// number once more; with conditions of G up to some 1e5 that moves an answer by some 1e-11 of its largest entry.
    fn check(&self, model: &Model, impact: &Impact, other: &Model, context: &dyn Fn() -> String) {
        let other = &other.impact();
        let (analysis, others) = (analysis(impact), analysis(other));
        assert_eq!(analysis.verdict, others.verdict, "{}", context());
        assert_eq!(analysis.outcomes.len(), others.outcomes.len(), "{}", context());
        assert_eq!(analysis.index_sum, others.index_sum, "{}", context());
        for (outcome, velocity) in analysis.outcomes.iter().zip(&velocities_after(impact)) {
            let modes: Vec<Mode> = outcome.modes.iter().map(|&mode| (self.mode)(mode)).collect();
            let place = others.outcomes.iter().position(|other| other.modes == modes);
            let place = place.unwrap_or_else(|| panic!("no {modes:?} among {:?}\n{}", others.outcomes, context()));
            let twin = &others.outcomes[place];
            assert_eq!(outcome.index, twin.index, "{}", context());
            assert_near(&[outcome.margin.expect("one")], &[twin.margin.expect("one")], 1.0, "margin", context);
            let turned = |values: &[[f64; 2]], [t, n]: [f64; 2]| -> Vec<f64> {
                values.iter().flat_map(|value| [t * value[0], n * value[1]]).collect()
            };
            let impulse = turned(&outcome.impulse, self.impulse);
            assert_near(&impulse, &twin.impulse.concat(), 0.0, "impulse", context);
            let before = largest(&turned(&impact.velocity_before, self.contact_velocity));
            let after = turned(&outcome.velocity_after, self.contact_velocity);
            assert_near(&after, &twin.velocity_after.concat(), before, "velocity after", context);
            let before = model.links.iter().map(|link| link.velocity).chain(model.base.velocity);
            let scale = largest(&before.collect::<Vec<f64>>());
            assert_near(velocity, &(self.velocity)(&velocities_after(other)[place]), scale, "v after", context);
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// Both equal to 1e-9 of the largest entry or `scale`.
fn assert_near(a: &[f64], b: &[f64], scale: f64, what: &str, context: &dyn Fn() -> String) {
    let scale = scale.max(largest(a));
    let near = a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * scale);
    assert!(near, "{what}: {a:?} is not {b:?}\n{}", context());
}

/// Runs `check` on every model that is decided; most must be.
fn for_every_model(check: impl Fn(u64, &Model, &Impact)) {
    let mut ambiguous = 0;
    let mut decided = 0;
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
        for link in &mut mirrored.links {
            link.com[0] = -link.com[0];
            link.origin[0] = -link.origin[0];
            match &mut link.axis {
                Axis::Revolute(_) | Axis::Fixed => (link.position, link.velocity) = (-link.position, -link.velocity),
                Axis::Prismatic(direction) => direction[0] = -direction[0],
            }
        }
        mirrored.contacts.iter_mut().for_each(|contact| contact.offset[0] = -contact.offset[0]);
        for k in [0, 2] {
            mirrored.base.position[k] = -mirrored.base.position[k];
            mirrored.base.velocity[k] = -mirrored.base.velocity[k];
        }
        let turns: Vec<bool> = model.links.iter().skip(1).map(|link| !link.axis.slides()).collect();
        let signs = |k: usize| if k == 0 || k == 2 || (k > 2 && turns[k - 3]) { -1.0 } else { 1.0 };
        let view = View {
            mode: mirror,
            impulse: [-1.0, 1.0],
            contact_velocity: [-1.0, 1.0],
            velocity: &|v| v.iter().enumerate().map(|(k, v)| signs(k) * v).collect(),
        };
        view.check(model, impact, &mirrored, &|| model.report(seed));
    });
}

#[test]
fn units_change_no_verdict_and_no_margin_of_a_robot() {
    for_every_model(|seed, model, impact| {
        let one = [1.0, 1.0, 1.0];
        let units = (0..3).flat_map(|k| {
            [1e6, 1e-6].map(|factor| {
                let mut units = one;
                units[k] = factor;
                units
            })
        });
        for [mass, length, time] in units {
            let mut scaled = model.clone();
            for link in &mut scaled.links {
                link.mass *= mass;
                link.moment *= mass * length * length;
                link.com.iter_mut().chain(&mut link.origin).for_each(|x| *x *= length);
                link.velocity /= time;
                if link.axis.slides() {
                    link.position *= length;
                    link.velocity *= length;
                }
            }
            for contact in &mut scaled.contacts {
                contact.offset.iter_mut().for_each(|x| *x *= length);
                contact.radius *= length;
            }
            scaled.base.position[..2].iter_mut().for_each(|x| *x *= length);
            scaled.base.velocity.iter_mut().for_each(|v| *v /= time);
            scaled.base.velocity[..2].iter_mut().for_each(|v| *v *= length);
            let slides: Vec<bool> = model.links.iter().skip(1).map(|link| link.axis.slides()).collect();
            let unit = |k: usize| if k < 2 || (k > 2 && slides[k - 3]) { length / time } else { 1.0 / time };
            let view = View {
                mode: |mode| mode,
                impulse: [mass * length / time; 2],
                contact_velocity: [length / time; 2],
                velocity: &|v| v.iter().enumerate().map(|(k, v)| v / unit(k)).collect(),
            };
            let units = format!("units of mass {mass}, length {length}, time {time}");
            view.check(model, impact, &scaled, &|| format!("{units}, {}", model.report(seed)));
        }
    });
}

#[test]
fn a_flipped_axis_with_its_coordinate_negated_is_the_same_joint() {
    for_every_model(|seed, model, impact| {
        let flips = |k: usize| (seed as usize + k).is_multiple_of(2);
        let mut flipped = model.clone();
        for (_, link) in flipped.links.iter_mut().enumerate().skip(1).filter(|(k, _)| flips(*k)) {
            match &mut link.axis {
                Axis::Revolute(sign) => *sign = -*sign,
                Axis::Prismatic(direction) => *direction = direction.map(|x| -x),
                Axis::Fixed => {}
            }
            (link.position, link.velocity) = (-link.position, -link.velocity);
        }
        let sign = |k: usize| if k > 2 && flips(k - 2) { -1.0 } else { 1.0 };
        let view = View {
            mode: |mode| mode,
            impulse: [1.0; 2],
            contact_velocity: [1.0; 2],
            velocity: &|v| v.iter().enumerate().map(|(k, v)| sign(k) * v).collect(),
        };
        view.check(model, impact, &flipped, &|| model.report(seed));
    });
}

#[test]
fn names_do_not_matter() {
    for_every_model(|seed, model, impact| {
        let mut renamed = model.clone();
        let order = Random::new(seed).permutation(model.links.len());
        for (link, number) in renamed.links.iter_mut().zip(order) {
            // Another order of the alphabet, names of joints and links the same.
            link.name = format!("{number} glied");
            link.joint = format!("{number} glied");
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
        askew.base.position[2] -= slope;
        let [x, z, rate] = model.base.velocity;
        let [x, z] = turn([x, z], sin);
        askew.base.velocity = [x, z, rate];
        let view = View {
            mode: |mode| mode,
            impulse: [1.0; 2],
            contact_velocity: [1.0; 2],
            velocity: &|v| [&turn([v[0], v[1]], -sin)[..], &v[2..]].concat(),
        };
        view.check(model, impact, &askew, &|| model.report(seed));
    });
}
