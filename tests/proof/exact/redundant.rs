//! Redundant contacts against all exact cells: outcomes, families with their corners, impulse ranges, rejections.
//!
//! ```sh
//! HEELSTRIKE_REDUNDANT=200000 cargo test --release --test proof -- --nocapture redundant_contacts_have_every_cell
//! ```

use super::cells::{Cell, cells, impulse_range, is_solvable, modes_of};
use super::digits::exact;
use super::enumeration::{Friction, Problem};
use super::{numbers, rounded, solve_json};
use crate::support::digits::check;
use crate::support::parallel::total;
use crate::support::random::Random;
use crate::support::rational::{Matrix, delassus, ratio, times, to_f64};
use crate::support::scaled::largest;
use dashu_ratio::RBig;
use heelstrike::impact::{
    self, Analysis, ContactProblem, Family, ListedRejections, Mode, Outcome, Rejection, RejectionReason, Verdict,
};
use heelstrike::{Defaults, analyze, read};
use std::collections::BTreeSet;

/// A contact problem given by mass matrix, contact Jacobian and velocity, so that the crate knows its redundancy.
struct Mechanism {
    masses: Vec<RBig>,
    jacobian: Matrix,
    velocity: Vec<RBig>,
    friction: Vec<Friction>,
    restitution: Vec<RBig>,
}

impl Mechanism {
    fn random(random: &mut Random) -> Self {
        let contacts = random.pick(&[1, 2, 2, 2, 2, 3, 3, 4]);
        Self::on(contacts, random)
    }

    fn on(contacts: i64, random: &mut Random) -> Self {
        let ratio_of_masses = random.pick(&[1.0, 4.0, 1e4, 1e8, 1e12]);
        let mass = |random: &mut Random| exact(random.pick(&[1.0, 1.0, 2.0, ratio_of_masses]));
        let (masses, jacobian): (Vec<RBig>, Vec<Vec<i64>>) = match random.whole(0, 3) {
            // Arbitrary rows, many of them dependent.
            0 | 1 => {
                let freedoms = random.whole(1, (2 * contacts).min(4)) as usize;
                let entry = |random: &mut Random| random.pick(&[0, 0, 0, 1, -1, 2, -2]);
                let row = |random: &mut Random| (0..freedoms).map(|_| entry(random)).collect();
                let rows = (0..2 * contacts).map(|_| row(random)).collect();
                ((0..freedoms).map(|_| mass(random)).collect(), rows)
            }
            // A plank on many supports, at two heights.
            2 => {
                let supports: Vec<[i64; 2]> =
                    (0..contacts).map(|_| [random.whole(-3, 3), random.pick(&[1, 1, 1, 2])]).collect();
                let rows = supports.iter().flat_map(|&[x, z]| [vec![1, 0, -z], vec![0, 1, x]]).collect();
                ((0..3).map(|_| mass(random)).collect(), rows)
            }
            // Separate bodies with one contact each; in some of them friction loads the contact as much as it brakes
            // it.
            _ => {
                let freedoms = 3 * contacts as usize;
                let mut rows = vec![vec![0; freedoms]; 2 * contacts as usize];
                for contact in 0..contacts as usize {
                    let (x, z) = (random.pick(&[-1, -1, 0, 1]), random.whole(0, 2));
                    rows[2 * contact][3 * contact..][..3].copy_from_slice(&[1, 0, z]);
                    rows[2 * contact + 1][3 * contact..][..3].copy_from_slice(&[0, 1, -x]);
                }
                let mass = mass(random);
                (vec![mass; freedoms], rows)
            }
        };
        let frictions = [0.0, 1e-12, 1e-6, 0.5, 1.0, 1.0, 2.0, 2.0, 3.0, 1e6, 1e12, f64::INFINITY, f64::INFINITY];
        let friction = |random: &mut Random| Some(random.pick(&frictions)).filter(|mu| mu.is_finite()).map(exact);
        let restitution = |random: &mut Random| ratio(random.pick(&[0, 0, 0, 0, 1, 2]), 2);
        Self {
            velocity: masses.iter().map(|_| ratio(random.pick(&[0, 0, 1, -1, 2, -3]), 1)).collect(),
            friction: (0..contacts).map(|_| friction(random)).collect(),
            restitution: (0..contacts).map(|_| restitution(random)).collect(),
            jacobian: jacobian.iter().map(|row| row.iter().map(|&entry| ratio(entry, 1)).collect()).collect(),
            masses,
        }
    }

    fn mass_matrix(&self) -> Matrix {
        let entry = |i: usize, j: usize| if i == j { self.masses[i].clone() } else { RBig::ZERO };
        (0..self.masses.len()).map(|i| (0..self.masses.len()).map(|j| entry(i, j)).collect()).collect()
    }

    fn problem(&self) -> Problem {
        let [_, delassus] = delassus(&self.mass_matrix(), &self.jacobian).expect("masses");
        let (friction, restitution) = (self.friction.clone(), self.restitution.clone());
        Problem { delassus, velocity_before: times(&self.jacobian, &self.velocity), friction, restitution }
    }

    fn analysis(&self, rejections: ListedRejections) -> Analysis {
        let rows = |matrix: &Matrix| matrix.iter().map(|row| numbers(row)).collect::<Vec<_>>();
        let friction = self.friction.iter().map(rounded).collect();
        let (masses, jacobian) = (rows(&self.mass_matrix()), rows(&self.jacobian));
        let (velocity, restitution) = (numbers(&self.velocity), numbers(&self.restitution));
        let problem = ContactProblem::from_dynamics(&masses, &jacobian, &velocity, friction, restitution);
        impact::analyze(&problem.expect("a contact problem"), rejections).expect("few contacts")
    }
}

/// Numbers of compared cells of one velocity, families, families of two dimensions and more, and corners.
#[derive(Default)]
struct Tally {
    isolated: u64,
    families: u64,
    areas: u64,
    corners: u64,
}

/// Compares an analysis with all exact cells. Returns an error that describes the first difference.
fn compare(problem: &Problem, cells: &[Cell], analysis: &Analysis) -> Result<Tally, String> {
    let outcomes = &analysis.outcomes;
    let mut tally = Tally::default();
    // Every combination is a cell of one velocity, a family or rejected.
    let isolated = || cells.iter().filter(|cell| cell.dimension == 0);
    let many = || cells.iter().filter(|cell| cell.dimension > 0);
    let lists = |cells: &mut dyn Iterator<Item = &Cell>| -> BTreeSet<(Vec<Mode>, usize)> {
        cells.map(|cell| (cell.modes.clone(), cell.dimension)).collect()
    };
    let found = analysis.families.iter().map(|family| (family.modes.clone(), family.dimension));
    let (found, expected) = (Vec::from_iter(found), lists(&mut many()));
    if found.len() != expected.len() || BTreeSet::from_iter(found.iter().cloned()) != expected {
        return Err(format!("families {found:?}\nnot {expected:?}"));
    }
    let is_family = |modes: &Vec<Mode>| analysis.families.iter().any(|family| family.modes == *modes);
    let alone = Vec::from_iter(outcomes.iter().map(|outcome| &outcome.modes).filter(|modes| !is_family(modes)));
    let expected = lists(&mut isolated());
    if alone.len() != expected.len() || alone.iter().any(|modes| !expected.contains(&((*modes).clone(), 0))) {
        return Err(format!("outcomes {alone:?}\nnot {expected:?}"));
    }
    let rejected: BTreeSet<&Vec<Mode>> = analysis.rejected.iter().map(|rejection| &rejection.modes).collect();
    let all = rejected.iter().copied().chain(cells.iter().map(|cell| &cell.modes)).collect::<BTreeSet<_>>().len();
    let count = 1 << (2 * problem.friction.len());
    if all != count || analysis.rejected.len() + cells.len() != count {
        return Err(format!("{} cells and {} rejected are not {count}", cells.len(), analysis.rejected.len()));
    }
    for Rejection { modes, because, .. } in &analysis.rejected {
        let right = match because {
            RejectionReason::NoSolution | RejectionReason::NothingHolds { .. } => [false, false],
            RejectionReason::Violated { .. } => [true, false],
            _ => [true, true],
        };
        let is = is_solvable(problem, modes);
        // A combination without a solution may be called violated if it has none only because of the second equation of
        // a contact that sticks without friction.
        let frictionless = |(mode, mu): (&Mode, &Friction)| *mode == Mode::Stick && *mu == Some(RBig::ZERO);
        let is_named = is == [false; 2] && right == [true, false];
        if is != right && !(is_named && modes.iter().zip(&problem.friction).any(frictionless)) {
            return Err(format!("{modes:?}: solvable, and closed: {is:?}, but {because:?}"));
        }
    }
    // All corners are outcomes, and outcomes with the modes of a family are corners.
    let mut corners: BTreeSet<(Vec<Mode>, Vec<RBig>)> = BTreeSet::new();
    for cell in many() {
        let own = cell.corners.iter().map(|corner| (modes_of(problem, corner), corner.clone()));
        corners.extend(own);
        tally.areas += u64::from(cell.dimension > 1);
    }
    let mut places: Vec<(usize, Vec<RBig>)> = Vec::new();
    let of_isolated = isolated().map(|cell| (cell.modes.clone(), cell.corners[0].clone()));
    let all: BTreeSet<(Vec<Mode>, Vec<RBig>)> = of_isolated.chain(corners.iter().cloned()).collect();
    if all.len() != outcomes.len() {
        return Err(format!("{} outcomes, not {}", outcomes.len(), all.len()));
    }
    for (modes, velocity) in &all {
        let should = numbers(velocity);
        let apart = |outcome: &Outcome| {
            let difference = outcome.velocity_after.as_flattened().iter().zip(&should).map(|(is, should)| is - should);
            largest(&difference.collect::<Vec<_>>())
        };
        let free = |at: &usize| outcomes[*at].modes == *modes && !places.iter().any(|(other, _)| other == at);
        let mut near: Vec<usize> = (0..outcomes.len()).filter(free).collect();
        near.sort_by(|&a, &b| apart(&outcomes[a]).total_cmp(&apart(&outcomes[b])));
        if near.len() > 1 {
            // Outcomes whose velocities are equal in f64 may differ in their impulses.
            let range = impulse_range(problem, modes, velocity);
            let least: Vec<f64> = range.iter().map(|ends| ends[0].as_ref().map_or(f64::NAN, to_f64)).collect();
            let same = |place: &usize| {
                let impulse = outcomes[*place].impulse.as_flattened();
                impulse.iter().zip(&least).filter(|(is, should)| is == should).count()
            };
            let fits = |place: &usize| compare_outcome(problem, &outcomes[*place], velocity).is_ok();
            near.sort_by_key(|place| std::cmp::Reverse((fits(place), same(place))));
        }
        let place = *near.first().ok_or(format!("no outcome {modes:?} with the velocity {should:?}"))?;
        compare_outcome(problem, &outcomes[place], velocity)?;
        if outcomes[place].family != corners.contains(&(modes.clone(), velocity.clone())) {
            return Err(format!("{modes:?} at {should:?}: family {}", outcomes[place].family));
        }
        places.push((place, velocity.clone()));
    }
    for cell in many() {
        let family = analysis.families.iter().find(|family| family.modes == cell.modes);
        let corners = family.map(|family: &Family| family.corners.clone()).unwrap_or_default();
        let of = |place: &usize| places.iter().find(|(other, _)| other == place).map(|(_, velocity)| velocity.clone());
        let found: BTreeSet<_> = corners.iter().filter_map(of).collect();
        if corners.len() != cell.corners.len() || found != cell.corners.iter().cloned().collect() {
            return Err(format!("{:?} with corners {corners:?}, not {:?}", cell.modes, cell.corners));
        }
    }
    let right = match outcomes.len() {
        0 => Verdict::None,
        1 if outcomes[0].impulse.concat().iter().all(|&entry| entry == 0.0) => Verdict::NoImpact,
        1 => Verdict::Unique,
        _ => Verdict::Ambiguous,
    };
    if analysis.verdict != right || !analysis.proven {
        return Err(format!("{}, not {right}; proven {}", analysis.verdict, analysis.proven));
    }
    tally.isolated = isolated().count() as u64;
    tally.families = many().count() as u64;
    tally.corners = corners.len() as u64;
    Ok(tally)
}

/// Compares an outcome's numbers with those of its exact velocity, each relative to its scale.
fn compare_outcome(problem: &Problem, outcome: &Outcome, velocity: &[RBig]) -> Result<(), String> {
    let (should, before) = (numbers(velocity), numbers(&problem.velocity_before));
    let mobility: Vec<f64> = (0..before.len()).map(|row| to_f64(&problem.delassus[row][row]).sqrt()).collect();
    let energy = before.iter().zip(&mobility).filter(|(_, mobility)| **mobility > 0.0);
    let energy = largest(&energy.map(|(c, mobility)| c / mobility).collect::<Vec<_>>());
    let fastest = largest(&before).max(largest(&should));
    for (contact, is) in outcome.velocity_after.iter().enumerate() {
        let own = 2 * contact..2 * contact + 2;
        let speed = fastest.min(energy * largest(&mobility[own.clone()]));
        let speed = speed.max(largest(&should[own.clone()])).max(largest(&before[own.clone()]));
        for (is, should) in is.iter().zip(&should[own]) {
            check(&format!("{:?}: velocity of {contact}", outcome.modes), *is, *should, speed)?;
        }
    }
    let range = impulse_range(problem, &outcome.modes, velocity);
    let unique = range.iter().all(|[least, most]| least.is_some() && least == most);
    if unique != outcome.impulse_unique {
        return Err(format!("{:?}: unique {}, but {range:?}", outcome.modes, outcome.impulse_unique));
    }
    let ends: Vec<[Option<f64>; 2]> =
        range.iter().map(|ends| ends.each_ref().map(|end| end.as_ref().map(to_f64))).collect();
    let impulse = outcome.impulse.as_flattened();
    let size = |list: &[Option<f64>]| largest(&list.iter().flatten().copied().collect::<Vec<_>>());
    for (row, should) in ends.iter().enumerate() {
        let (contact, normal) = (row / 2, 2 * (row / 2) + 1);
        let name = format!("{:?}: impulse {row}", outcome.modes);
        let Some(given) = &outcome.impulse_range else {
            let most = largest(&ends.iter().flatten().flatten().copied().collect::<Vec<_>>());
            let push = if mobility[normal] > 0.0 { most.min(energy / mobility[normal]) } else { most };
            let push = push.max(size(ends[2 * contact..=normal].as_flattened()));
            let least = problem.friction[contact].as_ref().map_or(1.0, |mu| to_f64(mu).min(1.0));
            check(&name, impulse[row], should[0].unwrap_or(f64::NAN), if row == normal { push } else { least * push })?;
            continue;
        };
        for (is, should) in given.as_flattened()[row].iter().zip(should) {
            match (is, should) {
                (Some(is), Some(should)) => check(&name, *is, *should, size(&ends[row]).max(impulse[row].abs()))?,
                (None, None) => {}
                _ => return Err(format!("{name} is within {:?}, not {:?}", given.as_flattened()[row], ends[row])),
            }
        }
    }
    Ok(())
}

#[test]
fn redundant_contacts_have_every_cell() {
    let asked = std::env::var("HEELSTRIKE_REDUNDANT").ok().and_then(|count| count.parse().ok());
    let count = asked.unwrap_or(2_000);
    let keep_going = asked.is_some();
    let [compared, undecided, wrong, isolated, families, areas, corners] = total(count, |seed| {
        let mechanism = Mechanism::random(&mut Random::new(seed));
        let problem = mechanism.problem();
        let analysis = mechanism.analysis(ListedRejections::Everything);
        if analysis.verdict == Verdict::Undecided {
            return [1, 1, 0, 0, 0, 0, 0];
        }
        match compare(&problem, &cells(&problem), &analysis) {
            Ok(tally) => [1, 0, 0, tally.isolated, tally.families, tally.areas, tally.corners],
            Err(difference) => {
                let report = format!("seed {seed}: {difference}\n{}", solve_json(&problem));
                assert!(keep_going, "{report}");
                println!("{report}");
                [1, 0, 1, 0, 0, 0, 0]
            }
        }
    });
    let counts = format!(
        "{compared} compared, {undecided} undecided, {wrong} wrong; cells: {isolated} of one velocity, {families} \
         families, {areas} of them in two dimensions and more; {corners} corners"
    );
    println!("{counts}");
    assert!(wrong == 0 && undecided == 0 && families > count / 20 && areas > count / 1_000, "{counts}");
}

/// If no rejections are listed, many combinations are rejected at once; the answer is the same as one by one.
#[test]
fn combinations_rejected_at_once_leave_the_rest() {
    let count = 40;
    let [rejected, families] = total(count, |seed| {
        let mechanism = Mechanism::on(if seed % 4 == 0 { 5 } else { 4 }, &mut Random::new(1_000_000 + seed));
        let analysis = |rejections| mechanism.analysis(rejections);
        let [whole, divided] = [analysis(ListedRejections::Everything), analysis(ListedRejections::Nothing)];
        assert_eq!((&divided.outcomes, &divided.families), (&whole.outcomes, &whole.families), "seed {seed}");
        assert_eq!((divided.verdict, divided.proven), (whole.verdict, whole.proven), "seed {seed}");
        [whole.rejected.len() as u64, whole.families.len() as u64]
    });
    assert!(rejected > 200 * count && families > 0, "{rejected} rejected, {families} families");
}

/// Frictions and margins are as large as they are, and numbers beyond f64 are not called proven.
#[test]
fn numbers_of_redundant_contacts_have_any_size() {
    let outcome = |problem: &str| {
        let problem = read::Problem::from_json(problem, &Defaults::default()).expect("a problem");
        let outcomes = analyze(&problem.contact, ListedRejections::Nothing).expect("an answer").outcomes;
        outcomes.into_iter().find(|own| own.modes.iter().all(|mode| *mode == Mode::Stick)).expect("a sticking one")
    };
    // L_t = (1e12, -1e12) while both normal impulses share 1.
    let jammed = outcome(
        r#"{"delassus": [[1, 0, 1, 0], [0, 1, 0, 1], [1, 0, 2, 0], [0, 1, 0, 1]], "velocity_before": [[0, -1], [1e12, -1]],
            "friction": 1e13}"#,
    );
    let off = jammed.friction_needed.iter().map(|needed| (needed.expect("pressed") / 2e12 - 1.0).abs());
    assert!(jammed.proven && off.fold(0.0, f64::max) < 1e-10, "{:?}", jammed.friction_needed);
    // L_1 + L_2 = L_0 = 2048, in units of S / sqrt(G_ii).
    let wedged = outcome(
        r#"{"mass_matrix": [[1, 0], [0, 1]], "velocity": [0, -1], "friction": 0, "contact_jacobian":
            [[0, 1], [1, 0], [0, 1], [-1, 0.00048828125], [0, 1], [-1, 0.00048828125]]}"#,
    );
    let margin = 1024.0 * (1.0 + 2.0_f64.powi(-22)).sqrt();
    assert!(wedged.proven && (wedged.margin.expect("bounded") / margin - 1.0).abs() < 1e-10, "{wedged:?}");
    // L_n is 1e400 at least.
    let beyond = outcome(r#"{"delassus": [[1e-100, 0], [0, 0]], "velocity_before": [[-1, 0]], "friction": 1e-300}"#);
    assert!(!beyond.proven, "{beyond:?}");
}
