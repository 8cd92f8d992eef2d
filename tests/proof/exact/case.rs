//! A random tree in a random state with random contacts, and its exact impact.

use super::enumeration::{Enumeration, Friction, Problem, enumerate};
use super::tree::{Motions, Point, Tree, kinetic_energy};
use crate::support::random::Random;
use crate::support::rational::{Matrix, delassus, dot, rank, ratio, times, to_f64};
use dashu_ratio::RBig;
use heelstrike::Robot;
use heelstrike::impact;
use heelstrike::state::{ByLink, NamedContact, Scene, State};

/// A contact on a link: a point, or a circle that touches at its bottom.
#[derive(Debug, Clone)]
pub struct Contact {
    pub body: usize,
    pub center: Point,
    /// Component of the center along the plane's normal; it must not matter.
    pub sideways: RBig,
    pub radius: RBig,
}

/// A state of a tree.
pub struct Case {
    pub seed: u64,
    pub motions: Motions,
    pub contacts: Vec<Contact>,
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
            contacts.iter().flat_map(|at| placed[at.body].bottom_jacobian(&at.center, &at.radius)).collect();
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
        let friction = contacts.iter().map(|at| frictions[at.body].clone()).collect();
        let restitution = contacts.iter().map(|at| restitutions[at.body].clone()).collect();
        let problem = Problem { delassus, velocity_before, friction, restitution };
        Some(Self { seed, motions, contacts, mass_matrix, jacobian, response, problem })
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

    /// The state as the library holds it; angles are those whose cosine and sine the case holds.
    pub fn state(&self, robot: &Robot) -> State {
        let Motions { cos, sin, displacement, velocity } = &self.motions;
        // Where the angle moves, the displacement is zero; elsewhere the angle is.
        let position = |k: usize| to_f64(&displacement[k]) + to_f64(&sin[k]).atan2(to_f64(&cos[k]));
        let link = |at: &Contact| robot.link(&Tree::link(at.body)).expect("a link of the file");
        let contact = |at: &Contact| {
            let [x, z] = at.center.each_ref().map(to_f64);
            NamedContact { link: link(at), offset: [x, to_f64(&at.sideways), z], radius: to_f64(&at.radius) }
        };
        let links = || self.contacts.iter().map(link);
        let Problem { friction, restitution, .. } = &self.problem;
        let scene = Scene {
            friction: ByLink { default: None, links: links().zip(friction.iter().map(rounded)).collect() },
            restitution: ByLink { default: None, links: links().zip(restitution.iter().map(to_f64)).collect() },
            contacts: Some(self.contacts.iter().map(contact).collect()),
            ..Scene::default()
        };
        let position = (0..cos.len()).map(position).collect();
        let velocity = velocity.iter().map(to_f64).collect();
        State { id: Some(self.seed.into()), position, velocity, scene, ..State::default() }
    }
}

/// Friction as the library holds it.
pub fn rounded(friction: &Friction) -> impact::Friction {
    friction.as_ref().map_or(impact::Friction::Infinite, |mu| impact::Friction::Finite(to_f64(mu)))
}

impl Contact {
    fn random(body: usize, random: &mut Random) -> Self {
        let eighths = |random: &mut Random| ratio(random.whole(-8, 8), 8);
        Self {
            body,
            center: [eighths(random), eighths(random)],
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
