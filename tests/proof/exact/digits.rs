//! Exact values of every printed number of an outcome, and those of a flat foot in closed form.

use super::enumeration::{Combination, Problem};
use super::numbers;
use crate::balls::environment;
use crate::support::digits::{Truth, check, needed};
use crate::support::parallel::total;
use crate::support::random::Random;
use crate::support::rational::{dot, ratio, to_f64};
use dashu_ratio::RBig;
use heelstrike::impact::{self, ContactProblem, Friction, Mode, Outcome};

pub fn exact(value: f64) -> RBig {
    RBig::try_from(value).expect("a finite number")
}

/// 2 to a power.
pub fn power(exponent: i64) -> RBig {
    exact((exponent as f64).exp2())
}

/// A random coefficient from 1e-12 to 1e12.
pub fn coefficient(random: &mut Random) -> f64 {
    10_f64.powf(random.between(-12.0, 12.0))
}

fn pairs(rows: &[RBig]) -> Vec<[f64; 2]> {
    rows.chunks_exact(2).map(|pair| [to_f64(&pair[0]), to_f64(&pair[1])]).collect()
}

/// sqrt(G_ii) of each row.
fn roots(delassus: &[Vec<RBig>]) -> Vec<[f64; 2]> {
    let diagonal: Vec<RBig> = delassus.iter().enumerate().map(|(i, row)| row[i].clone()).collect();
    pairs(&diagonal).into_iter().map(|pair| pair.map(f64::sqrt)).collect()
}

pub fn truth(problem: &Problem, combination: &Combination) -> Truth {
    let (impulse, after) = (combination.impulse.exact(), combination.velocity_after.exact());
    let work = dot(&impulse, &problem.velocity_before) + dot(&impulse, &after);
    Truth {
        of_robot: false,
        mobility: roots(&problem.delassus),
        before: pairs(&problem.velocity_before),
        after: pairs(&after),
        energy_loss: to_f64(&(work / ratio(-2, 1))),
        friction_needed: needed(&combination.modes, &pairs(&impulse)),
        impulse: pairs(&impulse),
        rates: Vec::new(),
    }
}

/// A body with a flat foot that two sticking contacts stop. The normal impulses are unique; of the tangential ones only
/// the sum is.
struct FlatFoot {
    mass: RBig,
    moment: RBig,
    /// Height of the center of mass.
    height: RBig,
    places: [RBig; 2],
    /// x, z, pitch.
    velocity: [RBig; 3],
    friction: [f64; 2],
}

impl FlatFoot {
    fn random(random: &mut Random) -> Self {
        let eighths = |random: &mut Random, low| ratio(random.whole(low, 16), 8);
        let equal = random.once_in(2);
        let first = coefficient(random);
        let friction = [first, if equal { first } else { coefficient(random) }];
        let [mass, moment] = [0, 1].map(|_| power(random.whole(-20, 20)));
        let (height, places) = (eighths(random, 1), [-eighths(random, 1), eighths(random, 1)]);
        // Impulses within the friction cones, and the velocity that they stop, rounded to f64.
        let pressed = [0, 1].map(|_| eighths(random, 1) * power(random.whole(-10, 10)));
        let most = to_f64(&pressed[0]) * friction[0] + to_f64(&pressed[1]) * friction[1];
        let along = exact(most * random.between(-1.0, 1.0));
        let torque = &height * &along + &places[0] * &pressed[0] + &places[1] * &pressed[1];
        let velocity =
            [-along / &mass, -(&pressed[0] + &pressed[1]) / &mass, torque / &moment].map(|speed| exact(to_f64(&speed)));
        Self { mass, moment, height, places, velocity, friction }
    }

    fn jacobian(&self) -> Vec<Vec<RBig>> {
        let row =
            |x: &RBig| [vec![RBig::ONE, RBig::ZERO, -self.height.clone()], vec![RBig::ZERO, RBig::ONE, -x.clone()]];
        self.places.iter().flat_map(row).collect()
    }

    fn outcome(&self) -> Option<Outcome> {
        let diagonal = [&self.mass, &self.mass, &self.moment].map(to_f64);
        let mass: Vec<Vec<f64>> =
            (0..3).map(|i| (0..3).map(|j| if i == j { diagonal[i] } else { 0.0 }).collect()).collect();
        let jacobian: Vec<Vec<f64>> = self.jacobian().iter().map(|row| numbers(row)).collect();
        let friction = self.friction.map(Friction::Finite).to_vec();
        let problem = ContactProblem::from_dynamics(&mass, &jacobian, &numbers(&self.velocity), friction, vec![0.0; 2]);
        let analysis = impact::analyze(&problem.expect("a contact problem"), impact::ListedRejections::Nothing)
            .expect("two contacts");
        analysis.outcomes.into_iter().find(|outcome| outcome.modes == [Mode::Stick; 2])
    }
}

#[test]
fn digits_of_a_flat_foot_are_right() {
    let [compared, clipped] = total(environment("HEELSTRIKE_PROBLEMS", 2_000), |seed| {
        let foot = FlatFoot::random(&mut Random::new(seed));
        // The foot stops: M v + J^T L = 0.
        let along = -&foot.mass * &foot.velocity[0];
        let down = -&foot.mass * &foot.velocity[1];
        let torque = &foot.moment * &foot.velocity[2] - &foot.height * &along;
        let second = (torque - &foot.places[0] * &down) / (&foot.places[1] - &foot.places[0]);
        let pressed = [&down - &second, second];
        let mu = foot.friction.map(exact);
        let cones = [&mu[0] * &pressed[0], &mu[1] * &pressed[1]];
        // The foot does not stick if the rounding of its velocity has moved the impulses out of the cones.
        let size = along.clone().max(-along.clone());
        if pressed.iter().any(|n| *n <= RBig::ZERO) || size > &cones[0] + &cones[1] {
            return [0; 2];
        }
        let range = |own: usize| {
            let other = &cones[1 - own];
            [(-&cones[own]).max(&along - other), cones[own].clone().min(&along + other)]
        };
        let ranges = [range(0), range(1)];
        let half = &along / ratio(2, 1);
        let within = |[low, high]: &[RBig; 2], x: &RBig| x.clone().max(low.clone()).min(high.clone());
        let tangential = [0, 1].map(|own| within(&ranges[own], &half));
        let needed = |own: usize| {
            if foot.friction[0] == foot.friction[1] {
                return to_f64(&(&size / &down));
            }
            let least = within(&ranges[own], &RBig::ZERO);
            to_f64(&(least.clone().max(-least) / &pressed[own]))
        };
        let inertias = [&foot.mass, &foot.mass, &foot.moment];
        let energy = foot.velocity.iter().zip(inertias).fold(RBig::ZERO, |sum, (v, m)| sum + m * v * v) / ratio(2, 1);
        let before: Vec<RBig> = foot.jacobian().iter().map(|row| dot(row, &foot.velocity)).collect();
        let square = |row: &Vec<RBig>| row.iter().zip(inertias).fold(RBig::ZERO, |sum, (j, m)| sum + j * j / m);
        let squares: Vec<RBig> = foot.jacobian().iter().map(square).collect();
        let truth = Truth {
            of_robot: false,
            mobility: pairs(&squares).into_iter().map(|pair| pair.map(f64::sqrt)).collect(),
            before: pairs(&before),
            after: vec![[0.0; 2]; 2],
            impulse: [0, 1].map(|own| [to_f64(&tangential[own]), to_f64(&pressed[own])]).to_vec(),
            energy_loss: to_f64(&energy),
            friction_needed: [0, 1].map(|own| Some(needed(own))).to_vec(),
            rates: Vec::new(),
        };
        let found = foot.outcome().unwrap_or_else(|| panic!("seed {seed}: the foot does not stick"));
        let fail = |difference: String| -> ! { panic!("seed {seed}: {difference}\n{found:?}\n{truth:?}") };
        if !found.proven {
            fail("not proven".into());
        }
        truth.check(&found, &foot.friction.map(Friction::Finite)).unwrap_or_else(|difference| fail(difference));
        let printed = found.impulse_range.clone().unwrap_or_default();
        // No range is printed on the edge of both cones, where the impulses are unique.
        for (own, entries) in printed.iter().enumerate() {
            let [low, high] = ranges[own].each_ref().map(to_f64);
            let scale = low.abs().max(high.abs());
            for (is, should) in entries[0].into_iter().zip([low, high]) {
                check("end", is.unwrap_or(f64::NAN), should, scale).unwrap_or_else(|difference| fail(difference));
            }
            for is in entries[1] {
                let should = truth.impulse[own][1];
                check("load", is.unwrap_or(f64::NAN), should, 0.0).unwrap_or_else(|difference| fail(difference));
            }
        }
        if printed.is_empty() && ranges[0][0] != ranges[0][1] {
            fail("no range".into());
        }
        [1, u64::from(tangential[0] != half)]
    });
    println!("{compared} flat feet, {clipped} of them with a shortest impulse on the edge of a cone");
    assert!(compared > 1_500 && clipped > 300, "{compared} {clipped}");
}
