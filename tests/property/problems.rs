//! Contact problems given as matrices.

use crate::support::parallel::total;
use crate::support::random::Random;
use heelstrike::impact::{Analysis, ContactProblem, Friction, Mode, Verdict, analyse};
use std::collections::BTreeMap;

/// The parts of a contact problem, kept for transforming and printing.
#[derive(Debug, Clone)]
struct Parts {
    delassus: Vec<Vec<f64>>,
    velocity_before: Vec<[f64; 2]>,
    friction: Vec<Friction>,
    restitution: Vec<f64>,
}

impl Parts {
    fn analyse(&self) -> Analysis {
        let problem = ContactProblem::new(
            self.delassus.concat(),
            self.velocity_before.clone(),
            self.friction.clone(),
            self.restitution.clone(),
        );
        let problem = problem.unwrap_or_else(|error| panic!("{error}\n{}", self.json()));
        analyse(&problem, false).unwrap_or_else(|error| panic!("{error}\n{}", self.json()))
    }

    /// As `heelstrike solve` reads it.
    fn json(&self) -> String {
        let friction: Vec<serde_json::Value> = self
            .friction
            .iter()
            .map(|friction| match friction {
                Friction::Finite(mu) => (*mu).into(),
                Friction::Infinite => "infinite".into(),
            })
            .collect();
        serde_json::json!({"delassus": self.delassus, "velocity_before": self.velocity_before, "friction": friction,
                           "restitution": self.restitution})
        .to_string()
    }

    /// A regular problem: G = A A^T with a Gaussian A of 2n rows and as many columns or some more.
    fn random(random: &mut Random) -> Self {
        let contacts = random.whole(1, 4) as usize;
        let columns = 2 * contacts + random.whole(0, 3) as usize;
        let a: Vec<Vec<f64>> = (0..2 * contacts).map(|_| (0..columns).map(|_| gauss(random)).collect()).collect();
        let product = |i: usize, j: usize| a[i].iter().zip(&a[j]).map(|(x, y)| x * y).sum();
        let delassus = (0..2 * contacts).map(|i| (0..2 * contacts).map(|j| product(i.max(j), i.min(j))).collect());
        let mut velocity_before: Vec<[f64; 2]> =
            (0..contacts).map(|_| [2.0 * gauss(random), gauss(random) - 0.7]).collect();
        if contacts > 1 && random.once_in(4) {
            // One contact rests exactly and another one strikes, as of a walker.
            velocity_before[0] = [0.0, 0.0];
            velocity_before[1][1] = -0.1 - gauss(random).abs();
        }
        let kind = random.whole(0, 3);
        let friction = |random: &mut Random| match if kind == 3 { random.whole(0, 2) } else { kind } {
            0 => Friction::ZERO,
            1 => Friction::Finite((1.5 * gauss(random) - 0.5).exp()),
            _ => Friction::Infinite,
        };
        let restitution = |random: &mut Random| match random.whole(0, 5) {
            0 => 1.0,
            1 | 2 => random.uniform(),
            _ => 0.0,
        };
        Self {
            delassus: delassus.collect(),
            velocity_before,
            friction: (0..contacts).map(|_| friction(random)).collect(),
            restitution: (0..contacts).map(|_| restitution(random)).collect(),
        }
    }

    fn frictionless(&self) -> bool {
        self.friction.iter().all(|friction| friction.is_zero())
    }
}

/// Box and Muller.
fn gauss(random: &mut Random) -> f64 {
    let radius = (-2.0 * (1.0 - random.uniform()).ln()).sqrt();
    radius * (std::f64::consts::TAU * random.uniform()).cos()
}

/// Modes and margin of every outcome, in an order of its own.
fn margins(analysis: &Analysis) -> BTreeMap<Vec<Mode>, f64> {
    let margin = |outcome: &heelstrike::impact::Outcome| outcome.margin.expect("one inequality at least");
    analysis.outcomes.iter().map(|outcome| (outcome.modes.clone(), margin(outcome))).collect()
}

/// Panics with the problem unless both have the same verdict, modes and, to 1e-9 of each, margins.
///
/// Transforming a problem rounds every number once, which moves a margin by eps times a condition: by 1e-12 in all but
/// two of these, by 7e-9 of a margin above 7 in the worst.
fn assert_same(analysis: &Analysis, other: &Analysis, context: &dyn Fn() -> String) {
    assert_eq!(analysis.verdict, other.verdict, "{}", context());
    let (margins, others) = (margins(analysis), margins(other));
    assert!(margins.keys().eq(others.keys()), "{margins:?}\n{others:?}\n{}", context());
    for (modes, margin) in &margins {
        let difference = (margin - others[modes]).abs();
        assert!(difference <= 1e-9 * margin.abs().max(1.0), "{modes:?}: {difference:e} of {margin}\n{}", context());
    }
    assert_eq!(analysis.index_sum, other.index_sum, "{}", context());
}

#[test]
fn indices_of_all_outcomes_sum_to_one() {
    const PROBLEMS: u64 = 100_000;
    let [undecided, ambiguous] = total(PROBLEMS, |seed| {
        let parts = Parts::random(&mut Random::new(seed));
        let analysis = parts.analyse();
        let context = || format!("seed {seed}: {}\n{:?}", parts.json(), analysis.outcomes);
        if analysis.verdict == Verdict::Undecided {
            return [1, 0];
        }
        let indices: Vec<Option<i8>> = analysis.outcomes.iter().map(|outcome| outcome.index).collect();
        assert!(indices.iter().all(|index| matches!(index, Some(1 | -1))), "{}", context());
        assert_eq!(indices.iter().flatten().map(|&index| i32::from(index)).sum::<i32>(), 1, "{}", context());
        assert_eq!(analysis.index_sum, Some(1), "{}", context());
        assert_eq!(indices.len() % 2, 1, "{}", context());
        let lists: BTreeMap<_, _> = analysis.outcomes.iter().map(|outcome| (&outcome.modes, ())).collect();
        assert_eq!(lists.len(), indices.len(), "doubled: {}", context());
        match analysis.verdict {
            Verdict::Unique | Verdict::NoImpact => assert_eq!(indices.len(), 1, "{}", context()),
            Verdict::Ambiguous => assert!(indices.len() >= 3 && !parts.frictionless(), "{}", context()),
            verdict => panic!("{verdict:?}: {}", context()),
        }
        [0, u64::from(indices.len() > 1)]
    });
    // A random slack rarely lies within its rounding: none of these was undecided when this was written.
    assert!(undecided <= PROBLEMS / 10_000, "{undecided} undecided");
    // The sum says something only where there are several: 5,186 were ambiguous when this was written.
    assert!(ambiguous > PROBLEMS / 100, "only {ambiguous} ambiguous");
}

/// Reads the contact law off the outcomes in its textbook form: Signorini's complementarity and Coulomb's law.
#[test]
fn outcomes_keep_the_contact_law() {
    let [closed, slipping] = total(20_000, |seed| {
        let parts = Parts::random(&mut Random::new(seed));
        let analysis = parts.analyse();
        let mut counts = [0, 0];
        if analysis.verdict == Verdict::Undecided {
            return counts;
        }
        for outcome in &analysis.outcomes {
            let context = || format!("seed {seed}: {}\n{outcome:?}", parts.json());
            let (l, after) = (outcome.impulse.concat(), outcome.velocity_after.concat());
            let before = parts.velocity_before.concat();
            let flow = |i: usize| parts.delassus[i].iter().zip(&l).map(|(g, l)| g * l);
            // The equations hold to eps times the growth of the elimination: 8.4e-13 was the worst seen.
            let size_of = |i: usize| before[i].abs() + flow(i).map(f64::abs).sum::<f64>();
            for i in 0..l.len() {
                let error = (before[i] + flow(i).sum::<f64>() - after[i]).abs();
                assert!(error <= 1e-11 * size_of(i), "row {i}: {error:e}\n{}", context());
            }
            for (k, friction) in parts.friction.iter().enumerate() {
                let (t, n) = (2 * k, 2 * k + 1);
                let (speed, impulse) =
                    (1e-11 * size_of(t).max(size_of(n)), 1e-11 * l.iter().fold(0.0, |m: f64, x| m.max(x.abs())));
                let xi = after[n] + parts.restitution[k] * before[n].min(0.0);
                assert!(xi >= -speed && l[n] >= -impulse, "contact {k}\n{}", context());
                assert!(xi <= speed || (l[n] == 0.0 && l[t] == 0.0), "contact {k} pushes and leaves\n{}", context());
                if xi > speed {
                    continue;
                }
                counts[0] += 1;
                let slips = after[t].abs() > speed;
                counts[1] += u64::from(slips);
                assert!(!slips || l[t] * after[t].signum() <= impulse, "friction drives contact {k}\n{}", context());
                match friction {
                    Friction::Finite(mu) => {
                        let bound = mu * l[n];
                        let slack = impulse * (1.0 + mu);
                        assert!(l[t].abs() <= bound + slack, "contact {k} leaves its cone\n{}", context());
                        assert!(!slips || l[t].abs() >= bound - slack, "contact {k} slips early\n{}", context());
                    }
                    Friction::Infinite => {
                        assert!(!slips || l[n].abs() <= impulse, "contact {k} slips under load\n{}", context());
                    }
                }
            }
            let work: f64 = (0..l.len()).map(|i| -0.5 * l[i] * (before[i] + after[i])).sum();
            let size: f64 = (0..l.len()).map(|i| (l[i] * before[i]).abs() + (l[i] * after[i]).abs()).sum();
            // A sum of 2n products.
            assert!(
                (outcome.energy_loss - work).abs() <= 1e-13 * size,
                "{} is not {work}\n{}",
                outcome.energy_loss,
                context()
            );
        }
        counts
    });
    assert!(closed > 20_000 && slipping > 2_000, "{closed} closed, {slipping} slipping contacts were seen");
}

#[test]
fn units_change_no_verdict_and_no_margin() {
    // G is in 1/kg, velocities in m/s.
    let [compared] = total(3_000, |seed| {
        let parts = Parts::random(&mut Random::new(seed));
        let analysis = parts.analyse();
        if analysis.verdict == Verdict::Undecided {
            return [0];
        }
        for (mass, length, time) in [
            (1e6, 1.0, 1.0),
            (1e-6, 1.0, 1.0),
            (1.0, 1e6, 1.0),
            (1.0, 1e-6, 1.0),
            (1.0, 1.0, 1e6),
            (1.0, 1.0, 1e-6),
            (1e-6, 1e6, 1e-6),
        ] {
            let mut scaled = parts.clone();
            scaled.delassus.iter_mut().flatten().for_each(|g| *g /= mass);
            scaled.velocity_before.iter_mut().flatten().for_each(|c| *c *= length / time);
            let context =
                || format!("seed {seed}, units of mass {mass}, length {length}, time {time}: {}", parts.json());
            assert_same(&analysis, &scaled.analyse(), &context);
        }
        [1]
    });
    assert!(compared > 2_990, "only {compared} were compared");
}

#[test]
fn the_order_of_contacts_does_not_matter() {
    let [compared] = total(10_000, |seed| {
        let mut random = Random::new(seed);
        let parts = Parts::random(&mut random);
        let analysis = parts.analyse();
        if analysis.verdict == Verdict::Undecided {
            return [0];
        }
        let order = random.permutation(parts.friction.len());
        let rows: Vec<usize> = order.iter().flat_map(|&k| [2 * k, 2 * k + 1]).collect();
        let permuted = Parts {
            delassus: rows.iter().map(|&i| rows.iter().map(|&j| parts.delassus[i][j]).collect()).collect(),
            velocity_before: order.iter().map(|&k| parts.velocity_before[k]).collect(),
            friction: order.iter().map(|&k| parts.friction[k]).collect(),
            restitution: order.iter().map(|&k| parts.restitution[k]).collect(),
        };
        let mut other = permuted.analyse();
        for outcome in &mut other.outcomes {
            let mut modes = outcome.modes.clone();
            order.iter().zip(&outcome.modes).for_each(|(&k, &mode)| modes[k] = mode);
            outcome.modes = modes;
        }
        assert_same(&analysis, &other, &|| format!("seed {seed}, order {order:?}: {}", parts.json()));
        [1]
    });
    assert!(compared > 9_990, "only {compared} were compared");
}

#[test]
fn a_mirrored_problem_slides_the_other_way() {
    let [compared] = total(10_000, |seed| {
        let parts = Parts::random(&mut Random::new(seed));
        let analysis = parts.analyse();
        if analysis.verdict == Verdict::Undecided {
            return [0];
        }
        let mut mirrored = parts.clone();
        for (i, row) in mirrored.delassus.iter_mut().enumerate() {
            row.iter_mut().enumerate().filter(|(j, _)| (i + j) % 2 == 1).for_each(|(_, g)| *g = -*g);
        }
        mirrored.velocity_before.iter_mut().for_each(|c| c[0] = -c[0]);
        let mut other = mirrored.analyse();
        other.outcomes.iter_mut().flat_map(|outcome| &mut outcome.modes).for_each(|mode| *mode = mirror(*mode));
        assert_same(&analysis, &other, &|| format!("seed {seed}: {}", parts.json()));
        [1]
    });
    assert!(compared > 9_990, "only {compared} were compared");
}

/// The mode seen from the other side of the plane.
pub fn mirror(mode: Mode) -> Mode {
    match mode {
        Mode::SlidePlus => Mode::SlideMinus,
        Mode::SlideMinus => Mode::SlidePlus,
        mode => mode,
    }
}

/// Contacts that do not act on each other, and points straight below or beside a CoG: structural zeros in G, which no
/// random matrix has.
#[test]
fn uncoupled_contacts_are_decided_one_by_one() {
    let [decided] = total(2_000, |seed| {
        let mut random = Random::new(seed);
        let contacts = random.whole(2, 3) as usize;
        let single: Vec<Parts> = (0..contacts).map(|_| Parts::single(&mut random)).collect();
        let mut joint = Parts {
            delassus: vec![vec![0.0; 2 * contacts]; 2 * contacts],
            velocity_before: single.iter().map(|one| one.velocity_before[0]).collect(),
            friction: single.iter().map(|one| one.friction[0]).collect(),
            restitution: single.iter().map(|one| one.restitution[0]).collect(),
        };
        for (k, one) in single.iter().enumerate() {
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                joint.delassus[2 * k + i][2 * k + j] = one.delassus[i][j];
            }
        }
        let mut expected = vec![Vec::new()];
        for one in &single {
            let modes: Vec<Mode> = one.analyse().outcomes.iter().map(|outcome| outcome.modes[0]).collect();
            let longer = expected.iter().flat_map(|list| modes.iter().map(|&mode| [&list[..], &[mode]].concat()));
            expected = longer.collect();
        }
        expected.sort();
        let analysis = joint.analyse();
        let found: Vec<Vec<Mode>> = margins(&analysis).into_keys().collect();
        assert_eq!(found, expected, "seed {seed}, {:?}: {}", analysis.verdict, joint.json());
        assert_ne!(analysis.verdict, Verdict::Undecided, "seed {seed}: {}", joint.json());
        [1]
    });
    assert_eq!(decided, 2_000);
}

impl Parts {
    /// One contact that strikes; half of them without coupling between the tangential and the normal direction.
    fn single(random: &mut Random) -> Self {
        let (a, b, c) = (gauss(random), gauss(random), gauss(random));
        let coupling = if random.once_in(2) { 0.0 } else { a * b };
        Self {
            delassus: vec![vec![a * a + 0.1, coupling], vec![coupling, b * b + 0.1 + c * c]],
            velocity_before: vec![[gauss(random), -0.1 - gauss(random).abs()]],
            friction: vec![random.pick(&[Friction::ZERO, Friction::Finite(0.7), Friction::Infinite])],
            restitution: vec![0.0],
        }
    }
}
