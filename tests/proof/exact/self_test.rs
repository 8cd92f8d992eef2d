//! The oracle against what is worked by hand, without the crate.

use super::cells::cells;
use super::enumeration::{Enumeration, Friction, Problem, enumerate};
use crate::support::rational::{Matrix, ratio};
use crate::support::scaled::near;
use dashu_ratio::RBig;
use heelstrike::impact::Mode;

fn matrix(rows: &[&[i64]]) -> Matrix {
    rows.iter().map(|row| row.iter().map(|&x| ratio(x, 1)).collect()).collect()
}

/// All combinations of one contact without restitution.
fn of_one_contact(delassus: &[&[i64]], velocity_before: [RBig; 2], friction: Friction) -> Enumeration {
    let (velocity_before, friction, restitution) = (velocity_before.into(), vec![friction], vec![RBig::ZERO]);
    enumerate(&Problem { delassus: matrix(delassus), velocity_before, friction, restitution })
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
