//! The oracle against what is known about it without the crate.

use super::case::Case;
use super::cells::{cells, impulse_range};
use super::enumeration::{Enumeration, Friction, Problem, enumerate};
use super::tree::{Motion, Tree};
use crate::support::random::Random;
use crate::support::rational::{Matrix, cramer, dot, ratio, times, to_f64};
use crate::support::scaled::near;
use dashu_int::IBig;
use dashu_ratio::RBig;
use heelstrike::impact::Mode;

fn matrix(rows: &[&[i64]]) -> Matrix {
    rows.iter().map(|row| row.iter().map(|&x| ratio(x, 1)).collect()).collect()
}

/// The case of each seed below `count` that has one.
fn cases(count: u64) -> impl Iterator<Item = Case> {
    (0..count).filter_map(|seed| Case::random(&Tree::random(&mut Random::new(seed)), seed))
}

/// All combinations of one contact without restitution.
fn of_one_contact(delassus: &[&[i64]], velocity_before: [RBig; 2], friction: Friction) -> Enumeration {
    let (velocity_before, friction, restitution) = (velocity_before.into(), vec![friction], vec![RBig::ZERO]);
    enumerate(&Problem { delassus: matrix(delassus), velocity_before, friction, restitution })
}

#[test]
fn cramer_solves_with_row_exchanges() {
    // [0 2 | 6; 3 1 | 9] has determinant -6, x = 2, y = 3.
    let whole = |row: [i64; 3]| row.map(IBig::from).to_vec();
    let solution = cramer(vec![whole([0, 2, 6]), whole([3, 1, 9])]).expect("regular");
    assert_eq!(solution.determinant, IBig::from(-6));
    assert_eq!(solution.numerators, [IBig::from(-12), IBig::from(-18)]);
    assert!(cramer(vec![whole([1, 2, 6]), whole([2, 4, 9])]).is_none());
}

#[test]
fn the_papers_block_has_three_outcomes_in_region_e() {
    // G = [2 1; 1 2], beta = -26.6 degrees; the impulse X = (1, -1/4) that strikes it points between beta and 0.
    let all = of_one_contact(&[&[2, 1], &[1, 2]], [ratio(7, 4), ratio(1, 2)], None);
    let found: Vec<_> =
        all.outcomes().map(|o| (o.modes[0], o.index, o.impulse.exact(), o.velocity_after.exact())).collect();
    let pair = |a, b| vec![a, b];
    let expected = [
        (Mode::Separate, 1, pair(RBig::ZERO, RBig::ZERO), pair(ratio(7, 4), ratio(1, 2))),
        (Mode::Stick, 1, pair(ratio(-1, 1), ratio(1, 4)), pair(RBig::ZERO, RBig::ZERO)),
        (Mode::SlidePlus, -1, pair(ratio(-1, 2), RBig::ZERO), pair(ratio(3, 4), RBig::ZERO)),
    ];
    assert_eq!(found, expected);
    // By hand: S = 7/4 / sqrt 2; of separate the slack is 1/2 / (S sqrt 2) = 2/7; of stick 1/4 sqrt 2 / S = 2/7; of
    // slide+ the least of 3/4 / (7/4) and 1/2 sqrt 2 / S = 4/7.
    let margins: Vec<f64> = all.combinations[..3].iter().map(|combination| combination.margin).collect();
    assert!(near(&margins, &[2.0 / 7.0, 2.0 / 7.0, 3.0 / 7.0], 1e-15), "{margins:?}");
}

#[test]
fn a_finite_cone_has_its_own_scale() {
    // G = diag(1, 4), mu = 1/2, c- = (1, -4): S = max(1, 2), L = (-1, 1), cone 1/2 - 1 over S sqrt(1/16 + 1).
    let all = of_one_contact(&[&[1, 0], &[0, 4]], [ratio(1, 1), ratio(-4, 1)], Some(ratio(1, 2)));
    let stick = all.combinations.iter().find(|c| c.modes == [Mode::Stick]).expect("det A = 4");
    assert!((stick.margin + 0.5 / (2.0 * (1.0f64 / 16.0 + 1.0).sqrt())).abs() < 1e-15);
    let modes: Vec<_> = all.outcomes().map(|o| o.modes.clone()).collect();
    assert_eq!(modes, [[Mode::SlidePlus]]);
}

/// Every column of a point's Jacobian is its central difference; the angles are turned by 2 atan(2^-20), the error of
/// the difference is of the order of its square.
#[test]
fn jacobians_are_derivatives_of_positions() {
    let tangent = ratio(1, 1 << 20);
    let square = &tangent * &tangent;
    let (c, s) = ((RBig::ONE - &square) / (RBig::ONE + &square), &tangent * ratio(2, 1) / (RBig::ONE + &square));
    let step = 2.0 * to_f64(&tangent).atan();
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let tree = Tree::random(&mut random);
        let motions = tree.random_motions(&mut random);
        let local = [ratio(3, 4), ratio(-5, 8)];
        let last = tree.bodies.len() - 1;
        let jacobian = tree.place(&motions)[last].jacobian(&local);
        let moving = tree.moving();
        for k in 0..tree.dofs() {
            let slides = k < 2 || (k > 2 && matches!(tree.bodies[moving[k - 3]].motion, Motion::Slide(_)));
            let at = |side: i64| {
                let mut moved = motions.clone();
                if slides {
                    moved.displacement[k] += &tangent * ratio(side, 1);
                } else {
                    let turn = &s * ratio(side, 1);
                    moved.cos[k] = &motions.cos[k] * &c - &motions.sin[k] * &turn;
                    moved.sin[k] = &motions.sin[k] * &c + &motions.cos[k] * &turn;
                }
                tree.place(&moved)[last].point(&local)
            };
            let (ahead, behind) = (at(1), at(-1));
            let width = 2.0 * if slides { to_f64(&tangent) } else { step };
            for row in 0..2 {
                let difference = to_f64(&(&ahead[row] - &behind[row])) / width;
                let entry = to_f64(&jacobian[row][k]);
                // step^2 / 6 times the arm (at most about 10), and no rounding before the quotient.
                assert!((difference - entry).abs() < 1e-10, "seed {seed}, coordinate {k}: {difference} is not {entry}");
            }
        }
    }
}

#[test]
fn impulses_balance_momentum_and_energy_exactly() {
    let mut checked = 0;
    for case in cases(300) {
        let seed = case.seed;
        let all = case.enumerate();
        // Rejected lists too: the balance holds for any impulse that solves the equations.
        for combination in all.combinations.iter().step_by(2) {
            let (impulse, after) = (combination.impulse.exact(), combination.velocity_after.exact());
            assert_eq!(times(&case.jacobian, &case.velocity_after(&impulse)), after, "seed {seed}");
            assert_eq!(case.energy_loss(&impulse), case.work(&impulse, &after), "seed {seed}");
            checked += 1;
        }
    }
    assert!(checked > 1000, "only {checked} were checked");
}

#[test]
fn outcomes_keep_the_contact_law_as_it_is_read() {
    // Complementarity and Coulomb's law in their usual form, without a word about modes.
    for case in cases(500) {
        let seed = case.seed;
        for outcome in case.enumerate().outcomes() {
            let (l, after) = (outcome.impulse.exact(), outcome.velocity_after.exact());
            let gained = times(&case.problem.delassus, &l);
            for (k, (mu, e)) in case.problem.friction.iter().zip(&case.problem.restitution).enumerate() {
                let (t, n) = (2 * k, 2 * k + 1);
                let before = &case.problem.velocity_before;
                assert_eq!(after[t], &before[t] + &gained[t]);
                let xi = &after[n] + e * before[n].clone().min(RBig::ZERO);
                assert!(xi >= RBig::ZERO && l[n] >= RBig::ZERO && (&xi * &l[n]).is_zero(), "seed {seed}");
                assert!(&l[t] * &after[t] <= RBig::ZERO, "seed {seed}: friction drives contact {k}");
                assert!(xi.is_zero() || (l[t].is_zero()), "seed {seed}: friction without contact {k}");
                let strength = if l[t] < RBig::ZERO { -l[t].clone() } else { l[t].clone() };
                match mu {
                    Some(mu) => {
                        assert!(strength <= mu * &l[n], "seed {seed}: contact {k} leaves its cone");
                        assert!(after[t].is_zero() || !xi.is_zero() || strength == mu * &l[n], "seed {seed}");
                    }
                    None => assert!(after[t].is_zero() || l[n].is_zero(), "seed {seed}"),
                }
            }
        }
    }
}

#[test]
fn indices_of_all_outcomes_sum_to_one() {
    let (mut regular, mut ambiguous) = (0, 0);
    for case in cases(2000) {
        let seed = case.seed;
        let all = case.enumerate();
        if all.clearance() < 1e-12 {
            continue;
        }
        let indices: Vec<i32> = all.outcomes().map(|outcome| i32::from(outcome.index)).collect();
        assert_eq!(indices.iter().sum::<i32>(), 1, "seed {seed}: {indices:?}");
        let lists: Vec<_> = all.outcomes().map(|outcome| &outcome.modes).collect();
        assert!(lists.iter().enumerate().all(|(k, list)| !lists[..k].contains(list)), "seed {seed}: doubled");
        if case.problem.friction.iter().all(|mu| mu.as_ref().is_some_and(RBig::is_zero)) {
            assert_eq!(indices.len(), 1, "seed {seed}: frictionless");
        }
        regular += 1;
        ambiguous += i32::from(indices.len() > 1);
    }
    assert!(regular > 1000 && ambiguous > 20, "{regular} regular, {ambiguous} ambiguous");
}

#[test]
fn mass_matrices_give_the_energy_of_the_bodies() {
    for seed in 0..100 {
        let mut random = Random::new(seed);
        let tree = Tree::random(&mut random);
        let motions = tree.random_motions(&mut random);
        let placed = tree.place(&motions);
        let mut twice = RBig::ZERO;
        for (body, place) in tree.bodies.iter().zip(&placed) {
            // The turning speed from the velocities of two points, not from the turn's own Jacobian.
            let [vx, vz] = place.jacobian(&body.com).map(|row| dot(&row, &motions.velocity));
            let ahead = [&body.com[0] + RBig::ONE, body.com[1].clone()];
            let [ux, uz] = place.jacobian(&ahead).map(|row| dot(&row, &motions.velocity));
            let (dx, dz) = (ux - &vx, uz - &vz);
            twice += &body.mass * (&vx * &vx + &vz * &vz) + &body.moment * (&dx * &dx + &dz * &dz);
        }
        let mass_matrix = tree.mass_matrix(&placed);
        assert_eq!(super::tree::kinetic_energy(&mass_matrix, &motions.velocity), twice / ratio(2, 1), "seed {seed}");
    }
}

#[test]
fn cells_of_regular_contacts_are_their_outcomes() {
    let mut compared = 0;
    for case in cases(150) {
        let (seed, all) = (case.seed, case.enumerate());
        if all.dependent > 0 {
            continue;
        }
        let mut expected: Vec<_> =
            all.outcomes().map(|own| (own.modes.clone(), own.velocity_after.exact(), own.impulse.exact())).collect();
        let own = cells(&case.problem).into_iter().map(|cell| {
            assert_eq!((cell.dimension, cell.corners.len()), (0, 1), "seed {seed}");
            let range = impulse_range(&case.problem, &cell.modes, &cell.corners[0]);
            let [least, most] = [0, 1].map(|end| range.iter().map(|ends| ends[end].clone().unwrap()).collect());
            assert_eq!(least, most, "seed {seed}");
            (cell.modes, cell.corners[0].clone(), most)
        });
        let mut found: Vec<(Vec<Mode>, Vec<RBig>, Vec<RBig>)> = own.collect();
        expected.sort();
        found.sort();
        assert_eq!(found, expected, "seed {seed}");
        compared += found.len();
    }
    assert!(compared > 100, "only {compared} outcomes");
}

/// Two of the paper's bodies at their critical friction: either may rest, slide as before, or anything between.
#[test]
fn cells_of_an_area_have_its_edges_and_corners() {
    let one = RBig::ONE;
    let delassus = matrix(&[&[2, 1, 0, 0], &[1, 2, 0, 0], &[0, 0, 2, 1], &[0, 0, 1, 2]]);
    let velocity_before = vec![one.clone(), RBig::ZERO, one, RBig::ZERO];
    let (friction, restitution) = (vec![Some(ratio(2, 1)); 2], vec![RBig::ZERO; 2]);
    let cells = cells(&Problem { delassus, velocity_before, friction, restitution });
    let mut found: Vec<_> = cells.into_iter().map(|cell| (cell.modes, cell.dimension, cell.corners.len())).collect();
    found.sort();
    let [rests, slides] = [Mode::Stick, Mode::SlidePlus];
    let expected = [([rests, rests], 0, 1), ([rests, slides], 1, 2), ([slides, rests], 1, 2), ([slides, slides], 2, 4)];
    assert_eq!(found, expected.map(|(modes, dimension, corners)| (modes.to_vec(), dimension, corners)));
}
