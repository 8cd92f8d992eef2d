//! Impacts on edges, in notches and against risers, with outcomes worked out by hand.

use super::*;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

#[test]
fn a_sole_across_an_edge_stands_on_corner_and_edge() {
    let found = impact(&sole(), state([0.0, 0.1, 0.0], FALLING, 0.5, &step(0.1, -0.2)));
    assert_touches(&found, &[[[-0.2, 0.0], [0.0, 1.0]], [[0.1, 0.0], [0.0, 1.0]]]);
    assert_close(&found.contacts[1].center.components(), &[0.1, -0.1]);
    // The CoG is between both contacts, so that the box stops. L1 + L2 = 2 kg * 1 m/s, and 0.2 L1 = 0.1 L2 keeps it
    // from turning. Opposite tangential impulses would be possible; the shortest ones are zero.
    let (impulse, after) = only_outcome(&found);
    assert_close(impulse.as_flattened(), &[0.0, 2.0 / 3.0, 0.0, 4.0 / 3.0]);
    assert_close(&after, &[0.0; 3]);
}

#[test]
fn a_sole_with_its_weight_beyond_the_edge_tips() {
    let found = impact(&sole(), state([0.0, 0.1, 0.0], FALLING, 0, &step(-0.1, -0.2)));
    assert_touches(&found, &[[[-0.2, 0.0], [0.0, 1.0]], [[-0.1, 0.0], [0.0, 1.0]]]);
    // Only the edge pushes, 0.1 m behind the CoG: L = 1 / (1 / m + x^2 / I) = 1 / 0.52, I w = 0.1 L. The rear corner
    // rises.
    let (impulse, after) = only_outcome(&found);
    let l = 1.0 / 0.52;
    assert_close(impulse.as_flattened(), &[0.0, 0.0, 0.0, l]);
    assert_close(&after, &[0.0, l / 2.0 - 1.0, 0.1 * l / 0.5]);
}

#[test]
fn foot_on_corner_is_struck_toward_its_middle() {
    // The middle of a sole on an edge, with the nose 0.3 rad down: the sole's own normal. A disc on a ridge that is too
    // steep to be touched elsewhere: the direction to its center.
    let (edge, ridge) = (step(0.0, -1.0), [[-0.1, -2.0], [0.0, 0.0], [0.1, -2.0]]);
    let discs = [-0.7, -0.2, 0.4, 1.2].map(|angle| (disc(), 0.5, angle, 0.0, &ridge[..]));
    for (robot, r, angle, pitch, profile) in [(sole(), 0.1, 0.3, 0.3, &edge[..])].into_iter().chain(discs) {
        let (sin, cos) = f64::sin_cos(angle);
        let found = impact(&robot, state([r * sin, r * cos, pitch], FALLING, "infinite", profile));
        assert_touches(&found, &[[[0.0, 0.0], [sin, cos]]]);
        // Along t = (cos, -sin) and n = (sin, cos), c- = (sin, -cos). The normal goes through the CoG, which is r away:
        // L_n = m cos, L_t = -sin / (1 / m + r^2 / I). The impulse at the point -r n turns the body by I w = -r L_t.
        let (impulse, after) = only_outcome(&found);
        let [t, n] = [-sin / (0.5 + r * r / 0.5), 2.0 * cos];
        assert_close(&impulse[0], &[t, n]);
        assert_close(&after, &[(t * cos + n * sin) / 2.0, -1.0 + (n * cos - t * sin) / 2.0, -r * t / 0.5]);
    }
}

#[test]
fn a_disc_or_a_point_in_a_notch_touches_both_sides() {
    let notch = [[-3.0, 3.0], [0.0, 0.0], [3.0, 3.0]];
    let found = impact(&disc(), state([0.0, 0.5 * SQRT_2, 0.0], FALLING, 0, &notch));
    let r = 0.5 * FRAC_1_SQRT_2;
    let s = FRAC_1_SQRT_2;
    assert_touches(&found, &[[[-r, r], [s, s]], [[r, r], [-s, s]]]);
    assert_eq!([&*found.contacts[0].name, &*found.contacts[1].name], ["body/0", "body/1"]);
    // Each pushes up with L / sqrt 2; together they take 2 kg m/s.
    let (impulse, after) = only_outcome(&found);
    assert_close(impulse.as_flattened(), &[0.0, SQRT_2, 0.0, SQRT_2]);
    assert_close(&after, &[0.0; 3]);

    let found = impact(&point(), state([0.0; 3], FALLING, 0, &notch));
    assert_touches(&found, &[[[0.0, 0.0], [s, s]], [[0.0, 0.0], [-s, s]]]);
    assert_close(&only_outcome(&found).1, &[0.0; 3]);
}

#[test]
fn a_toe_against_a_riser_touches_tread_and_riser() {
    // The box pushes its toe into the corner of the step: the tread carries it, the riser takes its forward momentum.
    let stairs = [[-2.0, 0.0], [0.2, 0.0], [0.2 + 1e-9, 0.5], [2.0, 0.5]];
    let found = impact(&sole(), state([0.0, 0.1, 0.0], [1.0, -1.0, 0.0], 0, &stairs));
    let up = [0.0, 1.0];
    let points: Vec<[f64; 2]> = found.contacts.iter().map(|contact| contact.point.components()).collect();
    assert_close(points.as_flattened(), &[-0.2, 0.0, 0.2, 0.0, 0.2, 0.0, 0.2, 0.2]);
    assert_eq!([found.contacts[0].normal(), found.contacts[1].normal()], [up, up]);
    for contact in &found.contacts[2..] {
        let Vector { x, z } = contact.normal();
        assert!(x == -1.0 && (z - 2e-9).abs() < 1e-15, "{:?}", contact.normal());
    }
    // The riser, 1e-9 m wide and 0.5 m high, leans by 2e-9, with which the body need not stop exactly.
    let after = only_outcome(&found).1;
    assert!(after.iter().all(|speed| speed.abs() < 1e-8), "{after:?}");
}
