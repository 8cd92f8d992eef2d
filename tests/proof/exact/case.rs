//! A random tree in a random state with random contacts, and its exact impact.

use super::enumeration::{Enumeration, Friction, Problem, enumerate};
use super::tree::{Motion, Motions, Point, Tree, kinetic_energy};
use crate::support::random::Random;
use crate::support::rational::{Matrix, delassus, dot, rank, ratio, times, to_f64};
use dashu::rational::RBig;
use serde_json::{Value, json};

/// A contact on a link: a point, or a circle that touches at its bottom.
#[derive(Debug, Clone)]
pub struct Contact {
    pub body: usize,
    pub centre: Point,
    /// Component of the centre along the plane's normal; it must not matter.
    pub sideways: RBig,
    pub radius: RBig,
}

/// A state of a tree; friction and restitution belong to links, so two contacts of a link share them.
pub struct Case {
    pub seed: u64,
    pub motions: Motions,
    pub contacts: Vec<Contact>,
    pub friction: Vec<Friction>,
    pub restitution: Vec<RBig>,
    pub mass_matrix: Matrix,
    /// Two rows (t, n) per contact.
    pub jacobian: Matrix,
    /// M^-1 J^T.
    pub response: Matrix,
    pub problem: Problem,
}

impl Case {
    /// The case of that seed; `None` if M or G is singular or no contact moves.
    pub fn random(tree: &Tree, seed: u64) -> Option<Self> {
        let mut random = Random::new(seed);
        let mut motions = tree.random_motions(&mut random);
        let links = tree.bodies.len();
        // Two contacts on one rigid body have a singular G: every contact gets a body of its own.
        let most = random.pick(&[1, 2, 2, 3, 3]).min(tree.dofs() as i64 / 2) as usize;
        let bodies = random.permutation(links);
        let contacts: Vec<Contact> =
            bodies.into_iter().take(most).map(|body| Contact::random(body, &mut random)).collect();
        let frictions: Vec<Friction> = (0..links).map(|_| random_friction(&mut random)).collect();
        let restitutions: Vec<RBig> = (0..links).map(|_| random_restitution(&mut random)).collect();

        let placed = tree.place(&motions);
        let jacobian: Matrix =
            contacts.iter().flat_map(|at| placed[at.body].bottom_jacobian(&at.centre, &at.radius)).collect();
        if contacts.len() > 1 && random.once_in(3) {
            // The first contact rests, as a walker's trailing foot does.
            let at = times(&jacobian, &motions.velocity);
            motions.velocity[0] -= &at[0];
            motions.velocity[1] -= &at[1];
        }
        let mass_matrix = tree.mass_matrix(&placed);
        let [response, delassus] = delassus(&mass_matrix, &jacobian)?;
        let velocity_before = times(&jacobian, &motions.velocity);
        if rank(&delassus) < delassus.len() || velocity_before.iter().all(RBig::is_zero) {
            return None;
        }
        let friction: Vec<Friction> = contacts.iter().map(|at| frictions[at.body].clone()).collect();
        let restitution: Vec<RBig> = contacts.iter().map(|at| restitutions[at.body].clone()).collect();
        let problem =
            Problem { delassus, velocity_before, friction: friction.clone(), restitution: restitution.clone() };
        Some(Self { seed, motions, contacts, friction, restitution, mass_matrix, jacobian, response, problem })
    }

    pub fn enumerate(&self) -> Enumeration {
        enumerate(&self.problem)
    }

    /// v+ = v- + M^-1 J^T L.
    pub fn velocity_after(&self, impulse: &[RBig]) -> Vec<RBig> {
        self.motions.velocity.iter().zip(times(&self.response, impulse)).map(|(v, gain)| v + gain).collect()
    }

    /// The kinetic energy that L takes, from the velocities of all bodies.
    pub fn energy_loss(&self, impulse: &[RBig]) -> RBig {
        kinetic_energy(&self.mass_matrix, &self.motions.velocity)
            - kinetic_energy(&self.mass_matrix, &self.velocity_after(impulse))
    }

    /// -1/2 L.(c- + c+), which must be the same.
    pub fn work(&self, impulse: &[RBig], after: &[RBig]) -> RBig {
        -(dot(impulse, &self.problem.velocity_before) + dot(impulse, after)) / ratio(2, 1)
    }

    /// The state as the tool reads it; angles are those whose cosine and sine the case holds.
    pub fn state(&self, tree: &Tree) -> Value {
        let angle = |k: usize| to_f64(&self.motions.sin[k]).atan2(to_f64(&self.motions.cos[k]));
        let speed = |k: usize| to_f64(&self.motions.velocity[k]);
        let moving = tree.moving();
        let joints = |value: &dyn Fn(usize, usize) -> f64| -> Value {
            moving.iter().enumerate().map(|(k, &body)| (Tree::joint(body), json!(value(3 + k, body)))).collect()
        };
        let position = joints(&|k, body| match tree.bodies[body].motion {
            Motion::Slide(_) => to_f64(&self.motions.displacement[k]),
            _ => angle(k),
        });
        let by_link = |value: &dyn Fn(usize) -> Value| -> Value {
            self.contacts.iter().enumerate().map(|(k, at)| (Tree::link(at.body), value(k))).collect()
        };
        let contacts: Vec<Value> = self
            .contacts
            .iter()
            .map(|at| {
                let [x, z] = at.centre.each_ref().map(to_f64);
                json!({"link": Tree::link(at.body), "offset": [x, to_f64(&at.sideways), z], "radius": to_f64(&at.radius)})
            })
            .collect();
        json!({
            "id": self.seed,
            "position": {"base": {"x": to_f64(&self.motions.displacement[0]), "z": to_f64(&self.motions.displacement[1]),
                                  "pitch": angle(2)}, "joints": position},
            "velocity": {"base": {"x": speed(0), "z": speed(1), "pitch": speed(2)}, "joints": joints(&|k, _| speed(k))},
            "friction": by_link(&|k| self.friction[k].as_ref().map_or(json!("infinite"), |mu| json!(to_f64(mu)))),
            "restitution": by_link(&|k| json!(to_f64(&self.restitution[k]))),
            "contacts": contacts,
        })
    }
}

impl Contact {
    fn random(body: usize, random: &mut Random) -> Self {
        let eighths = |random: &mut Random| ratio(random.whole(-8, 8), 8);
        Self {
            body,
            centre: [eighths(random), eighths(random)],
            sideways: ratio(random.whole(-1, 1), 4),
            radius: if random.once_in(2) { RBig::ZERO } else { ratio(random.whole(1, 8), 16) },
        }
    }
}

fn random_friction(random: &mut Random) -> Friction {
    match random.whole(1, 5) {
        1 => Some(RBig::ZERO),
        2 | 3 => None,
        _ => Some(random.pick(&[ratio(1, 8), ratio(1, 2), ratio(3, 4), ratio(1, 1), ratio(5, 2), ratio(10, 1)])),
    }
}

fn random_restitution(random: &mut Random) -> RBig {
    if random.once_in(5) { random.pick(&[ratio(1, 4), ratio(1, 2), ratio(1, 1)]) } else { RBig::ZERO }
}
