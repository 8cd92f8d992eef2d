//! The crate against the exact oracle of this folder: what is compared with rational arithmetic belongs here.

mod case;
mod cells;
mod digits;
mod enumeration;
mod redundant;
mod self_test;
mod tree;

use crate::support::answers::{Answer, answers, named_velocity};
use crate::support::command::place;
use crate::support::parallel::{added, total};
use crate::support::random::Random;
use crate::support::rational::{self, ratio, to_f64};
use crate::support::scaled::{largest, near};
use case::{Case, rounded};
use dashu_ratio::RBig;
use enumeration::{Combination, Enumeration, Friction, Problem, enumerate};
use heelstrike::Robot;
use heelstrike::dynamics::plan::Configuration;
use heelstrike::impact::{self, Analysis, ContactProblem, Mode, Outcome, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::State;
use std::collections::BTreeMap;
use tree::Tree;

/// Compares the crate's outcomes with all exact ones, or says what differs.
///
/// All tolerances are those of the issue, 1e-9 of scale: eps times a condition, with numbers as short as these 3.5e-12
/// was the worst seen. The margin is free of units; its scale is 1.
fn compare(problem: &Problem, all: &Enumeration, verdict: Verdict, outcomes: &[Outcome]) -> Result<(), String> {
    let exact: BTreeMap<&Vec<Mode>, &Combination> = all.outcomes().map(|exact| (&exact.modes, exact)).collect();
    let found: BTreeMap<&Vec<Mode>, &Outcome> = outcomes.iter().map(|found| (&found.modes, found)).collect();
    if !exact.keys().eq(found.keys()) || outcomes.len() != exact.len() {
        return Err(format!("{verdict}, outcomes {:?}\nnot {:?}", found.keys(), exact.keys()));
    }
    let before = numbers(&problem.velocity_before);
    let after: Vec<Vec<f64>> = exact.values().map(|exact| exact.velocity_after.rounded()).collect();
    let impulses: Vec<Vec<f64>> = exact.values().map(|exact| exact.impulse.rounded()).collect();
    let (speed, push) = (largest(&before).max(largest(&after.concat())), largest(&impulses.concat()));
    let right = match exact.len() {
        1 if push == 0.0 => Verdict::NoImpact,
        1 => Verdict::Unique,
        _ => Verdict::Ambiguous,
    };
    if verdict != right {
        return Err(format!("verdict {verdict}, not {right}"));
    }
    for (k, (exact, found)) in exact.values().zip(found.values()).enumerate() {
        let taken: f64 = (0..before.len()).map(|i| -0.5 * impulses[k][i] * (before[i] + after[k][i])).sum();
        for (what, is, should, scale) in [
            ("velocity after", found.velocity_after.as_flattened(), &*after[k], speed),
            ("impulse", found.impulse.as_flattened(), &impulses[k], push),
            ("index", &[found.index.map_or(f64::NAN, f64::from)], &[f64::from(exact.index)], 0.0),
            ("margin", found.margin.as_slice(), &[exact.margin], exact.margin.max(1.0)),
            ("energy loss", &[found.energy_loss], &[taken], speed * push),
        ] {
            if !near(is, should, 1e-9 * scale) {
                return Err(format!("{:?}: {what} {is:?}, not {should:?}", exact.modes));
            }
        }
    }
    Ok(())
}

fn numbers(values: &[RBig]) -> Vec<f64> {
    values.iter().map(to_f64).collect()
}

/// The crate's analysis of a problem.
fn analyze_problem(problem: &Problem, seed: u64) -> Analysis {
    let contact_problem = ContactProblem::new(
        numbers(&problem.delassus.concat()),
        problem.velocity_before.chunks(2).map(|c| [to_f64(&c[0]), to_f64(&c[1])]).collect(),
        problem.friction.iter().map(rounded).collect(),
        numbers(&problem.restitution),
    );
    let analysis = contact_problem.and_then(|problem| impact::analyze(&problem, impact::ListedRejections::Nothing));
    analysis.unwrap_or_else(|error| panic!("seed {seed}: {error}\n{problem:?}"))
}

/// G = A A^T / 4 with whole numbers up to `most` in A, so that f64 holds G exactly; `None` if it is singular.
fn delassus(random: &mut Random, contacts: usize, most: i64) -> Option<rational::Matrix> {
    let rows = 2 * contacts;
    let columns = rows + random.whole(0, 2) as usize;
    let row = |random: &mut Random| (0..columns).map(|_| random.whole(-most, most)).collect();
    let a: Vec<Vec<i64>> = (0..rows).map(|_| row(random)).collect();
    let entry = |i: usize, j: usize| ratio(a[i].iter().zip(&a[j]).map(|(x, y)| x * y).sum(), 4);
    let delassus: rational::Matrix = (0..rows).map(|i| (0..rows).map(|j| entry(i, j)).collect()).collect();
    (rational::rank(&delassus) == rows).then_some(delassus)
}

/// Up to four contacts and no dynamics.
#[test]
fn matrices_have_exact_outcomes() {
    let [compared, ambiguous] = total(8_000, |seed| {
        let mut random = Random::new(seed);
        let contacts = random.whole(1, 4) as usize;
        // The smallest entries give zeros in G and in the pivots of an elimination.
        let most = random.pick(&[1, 2, 5]);
        let Some(delassus) = delassus(&mut random, contacts, most) else { return [0, 0] };
        let frictions = [Some(ratio(0, 1)), Some(ratio(1, 2)), Some(ratio(3, 1)), None, None];
        let problem = Problem {
            delassus,
            velocity_before: (0..2 * contacts).map(|i| ratio(random.whole(-9, 9) - (i as i64 % 2) * 4, 4)).collect(),
            friction: (0..contacts).map(|_| random.pick(&frictions)).collect(),
            restitution: (0..contacts).map(|_| ratio(random.pick(&[0, 0, 0, 1, 4]), 4)).collect(),
        };
        let all = enumerate(&problem);
        // No slack in these is within 1e-9 but exact zeros: they are borders.
        if all.clearance() < 1e-9 {
            return [0, 0];
        }
        let analysis = analyze_problem(&problem, seed);
        compare(&problem, &all, analysis.verdict, &analysis.outcomes)
            .unwrap_or_else(|difference| panic!("seed {seed}: {difference}\n{}", solve_json(&problem)));
        [1, u64::from(analysis.outcomes.len() > 1)]
    });
    assert!(compared > 7_000 && ambiguous > 300, "{compared} compared, {ambiguous} ambiguous");
}

/// A problem with a known outcome that lies on borders, by c- = c+ - G L in numbers that f64 holds: some contacts leave
/// at no speed, rest without a load, need all of their friction, or slide at no speed. In two of three problems one
/// number is then off by 2^-1 to 2^-52 of itself. `None` if G is singular.
fn beside_borders(random: &mut Random) -> Option<Problem> {
    let contacts = random.whole(1, 3) as usize;
    let delassus = delassus(random, contacts, 3)?;
    let frictions = [Some(ratio(0, 1)), Some(ratio(1, 4)), Some(ratio(1, 1)), Some(ratio(3, 1)), None];
    let mut friction: Vec<Friction> = (0..contacts).map(|_| random.pick(&frictions)).collect();
    let restitution: Vec<RBig> = (0..contacts).map(|_| ratio(random.pick(&[0, 0, 0, 1]), 1)).collect();
    // [t, n] of impulse and of (c_t, xi_n) after.
    let (mut impulse, mut after) = (Vec::new(), Vec::new());
    for mu in &friction {
        let load = ratio(random.whole(0, 4), 2);
        let side = ratio(random.pick(&[-1, 1]), 1);
        // At infinite friction a load bears any push, and a slide has none.
        let edge = mu.as_ref().map_or_else(|| ratio(random.whole(0, 4), 2), |mu| mu * &load);
        let zero = || ratio(0, 1);
        let (l, c) = match random.whole(0, 3) {
            0 => ([zero(), zero()], [ratio(random.whole(-4, 4), 2), ratio(random.whole(0, 2), 2)]),
            1 => ([zero(), load], [zero(), zero()]),
            2 => ([-&side * edge, load], [zero(), zero()]),
            _ => {
                let load = if mu.is_none() { zero() } else { load };
                ([-&side * edge, load], [side * ratio(random.whole(0, 2), 2), zero()])
            }
        };
        impulse.extend(l);
        after.extend(c);
    }
    let mut velocity_before: Vec<RBig> =
        after.iter().zip(rational::times(&delassus, &impulse)).map(|(after, change)| after - change).collect();
    for (contact, e) in restitution.iter().enumerate() {
        let normal = &mut velocity_before[2 * contact + 1];
        // xi_n counts an approach 1 + e times.
        if *normal < RBig::ZERO {
            *normal = &*normal / (ratio(1, 1) + e);
        }
    }
    let off = RBig::ONE + ratio(random.pick(&[-1, 1]), 1 << random.whole(1, 52));
    // As f64 holds it: what is compared is what the library is given.
    let pushed = |value: &RBig| RBig::try_from(to_f64(&(value * &off))).expect("a finite number");
    match random.whole(0, 2) {
        0 => {}
        1 => {
            let entry = random.whole(0, 2 * contacts as i64 - 1) as usize;
            velocity_before[entry] = pushed(&velocity_before[entry]);
        }
        _ => {
            let entry = random.whole(0, contacts as i64 - 1) as usize;
            friction[entry] = friction[entry].as_ref().map(pushed);
        }
    }
    Some(Problem { delassus, velocity_before, friction, restitution })
}

/// Matrices that are given are exact, so that a sign of theirs may stay undecided but not be wrong, however small.
#[test]
fn matrices_beside_borders_have_exact_outcomes() {
    let [compared, borders, near, undecided] = total(16_000, |seed| {
        let Some(problem) = beside_borders(&mut Random::new(seed)) else { return [0; 4] };
        let all = enumerate(&problem);
        // With det A = 0 and more than one solution the exact oracle does not say which is admissible.
        if all.dependent > 0 {
            return [0; 4];
        }
        let analysis = analyze_problem(&problem, seed);
        // At friction 0 the oracle has no slack for L_t = 0, and so no index.
        let frictionless = problem.friction.contains(&Some(RBig::ZERO));
        // Without any velocity no slack has a size, and all are zero.
        let clear = |outcome: &Combination| outcome.margin > 0.0 && outcome.margin.is_finite();
        let index = |outcome: &Combination| (clear(outcome) && !frictionless).then_some(outcome.index);
        let expected: BTreeMap<_, _> = all.outcomes().map(|outcome| (&outcome.modes, index(outcome))).collect();
        let index = |outcome: &Outcome| outcome.index.filter(|_| !frictionless);
        let found: BTreeMap<_, _> = analysis.outcomes.iter().map(|outcome| (&outcome.modes, index(outcome))).collect();
        let border = u64::from(!all.outcomes().all(clear));
        if analysis.verdict == Verdict::Undecided {
            assert!(!analysis.proven, "seed {seed}: undecided, but proven\n{}", solve_json(&problem));
            return [0, 0, 0, 1];
        }
        assert_eq!(found, expected, "seed {seed}: {}\n{}", analysis.verdict, solve_json(&problem));
        assert_eq!(found.len(), analysis.outcomes.len(), "seed {seed}: {}", solve_json(&problem));
        let clearance = all.clearance();
        [1, border, u64::from(clearance > 0.0 && clearance < 1e-9), 0]
    });
    let counts = format!("{compared} compared, {borders} on and {near} next to a border, {undecided} undecided");
    assert!(compared >= 10_000 && borders > 5_000 && near > 1_000 && undecided * 300 < compared, "{counts}");
}

/// As `heelstrike solve` reads it.
fn solve_json(problem: &Problem) -> serde_json::Value {
    let friction = |friction: &Friction| friction.as_ref().map_or("infinite".into(), |mu| to_f64(mu).into());
    serde_json::json!({
        "delassus": problem.delassus.iter().map(|row| numbers(row)).collect::<Vec<_>>(),
        "velocity_before": problem.velocity_before.chunks(2).map(numbers).collect::<Vec<_>>(),
        "friction": problem.friction.iter().map(friction).collect::<Vec<serde_json::Value>>(),
        "restitution": numbers(&problem.restitution),
    })
}

/// States of each robot; some are left out, because G is singular or a border is near.
const STATES: u64 = 13;

/// The robot of that number, and its states that are off every border.
fn robot(number: u64) -> (Tree, Robot, Vec<(Case, Enumeration)>) {
    let tree = Tree::random(&mut Random::new(number));
    let robot = Robot::from_urdf(&tree.urdf()).unwrap_or_else(|error| panic!("{error}\n{}", tree.urdf()));
    let cases = (0..STATES).filter_map(|state| Case::random(&tree, 1000 * number + state));
    let all = cases.map(|case| {
        let all = case.enumerate();
        (case, all)
    });
    let clear = all.filter(|(_, all)| all.clearance() > 1e-9).collect();
    (tree, robot, clear)
}

/// The crate's analysis of a case, from the cosines and sines of its angles.
fn analyze(robot: &Robot, case: &Case) -> heelstrike::Result<Analysis> {
    let configuration = Configuration {
        cos: numbers(&case.motions.cos),
        sin: numbers(&case.motions.sin),
        displacement: numbers(&case.motions.displacement),
    };
    let State { velocity, scene, .. } = case.state(robot);
    let friction = case.problem.friction.iter().map(rounded).collect();
    let contacts = scene.contacts.unwrap_or_default();
    let mut pipeline = Pipeline::new(robot, Options::default());
    let restitution = numbers(&case.problem.restitution);
    impact::analyze(
        &pipeline.contact_problem(&configuration, &velocity, &contacts, friction, restitution)?,
        impact::ListedRejections::Nothing,
    )
}

#[test]
fn trees_have_exact_outcomes() {
    let [compared, ambiguous, three] = total(1_050, |number| {
        let (tree, robot, cases) = robot(number);
        let mut counts = [0, 0, 0];
        for (case, all) in &cases {
            let fail = |difference: &str| -> ! { panic!("{}", report(&tree, &robot, case, difference)) };
            let analysis = analyze(&robot, case).unwrap_or_else(|error| fail(&error.to_string()));
            compare(&case.problem, all, analysis.verdict, &analysis.outcomes)
                .unwrap_or_else(|difference| fail(&difference));
            counts = added(counts, [true, analysis.outcomes.len() > 1, case.contacts.len() > 2].map(u64::from));
        }
        counts
    });
    let counts = format!("{compared} compared, {ambiguous} ambiguous, {three} with three contacts");
    assert!(compared >= 10_000 && ambiguous > 300 && three > 1_000, "{counts}");
}

/// Everything that is needed to run a case by hand.
fn report(tree: &Tree, robot: &Robot, case: &Case, difference: &str) -> String {
    let state = case.state(robot).to_json(robot);
    format!("robot {}, seed {}: {difference}\n{}{state}", case.seed / 1000, case.seed, tree.urdf())
}

#[test]
fn the_binary_has_exact_outcomes() {
    let folder = place("");
    let [compared, ambiguous] = total(110, |number| {
        let (tree, robot, cases) = robot(number);
        let path = format!("{folder}{number}.urdf");
        std::fs::write(&path, tree.urdf()).expect("the target directory can be written");
        let state = |(case, _): &(Case, _)| serde_json::from_str(&case.state(&robot).to_json(&robot)).expect("JSON");
        let states: Vec<_> = cases.iter().map(state).collect();
        let mut counts = [0, 0];
        for ((case, all), answer) in cases.iter().zip(answers(&["batch", &path, "-"], &states)) {
            check_line(&tree, case, all, &answer)
                .unwrap_or_else(|error| panic!("{}", report(&tree, &robot, case, &error)));
            counts = added(counts, [1, u64::from(answer.outcomes.len() > 1)]);
        }
        counts
    });
    assert!(compared >= 1_000 && ambiguous > 30, "{compared} compared, {ambiguous} ambiguous");
}

/// Compares a line of the batch with the exact outcomes, coordinates by their names.
fn check_line(tree: &Tree, case: &Case, all: &Enumeration, answer: &Answer) -> Result<(), String> {
    let Answer { outcomes, report } = answer;
    compare(&case.problem, all, report.verdict.ok_or("no verdict")?, outcomes)?;
    if report.index_sum != Some(Some(1)) || report.rank != Some(case.problem.delassus.len()) {
        return Err(format!("index sum {:?}, rank {:?}", report.index_sum, report.rank));
    }
    let energy = to_f64(&tree::kinetic_energy(&case.mass_matrix, &case.motions.velocity));
    // A sum of as many products as M has entries, without cancellation beyond that of M itself.
    if !near(report.kinetic_energy.as_slice(), &[energy], 1e-12 * energy) {
        return Err(format!("kinetic energy {:?}, not {energy}", report.kinetic_energy));
    }
    let found: Vec<&str> = report.contacts.iter().filter_map(|contact| contact.link.as_deref()).collect();
    let links: Vec<String> = case.contacts.iter().map(|contact| Tree::link(contact.body)).collect();
    if found != links {
        return Err(format!("contacts {found:?}, not {links:?}"));
    }
    let joints = tree.moving().into_iter().map(Tree::joint);
    let coordinates: Vec<String> = ["x", "z", "pitch"].map(String::from).into_iter().chain(joints).collect();
    for outcome in outcomes {
        let exact = all.outcomes().find(|exact| exact.modes == outcome.modes).ok_or("compared before")?;
        let (names, given) = named_velocity(outcome);
        let after = numbers(&case.velocity_after(&exact.impulse.exact()));
        let scale = largest(&numbers(&case.motions.velocity)).max(largest(&after));
        if names != coordinates || !near(&given, &after, 1e-9 * scale) {
            return Err(format!("{:?}: velocities {names:?} {given:?}", outcome.modes));
        }
    }
    Ok(())
}
