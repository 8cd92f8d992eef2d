//! Loops in singular poses, in which they hold fewer directions: which part of K counts, and when that is proven. The
//! expected Delassus matrix comes from `support::mechanism` and from rows of K that are worked out by hand.

use crate::constraints::four_bar::bolted;
use crate::constraints::{assert_near, impact, matrices};
use crate::support::impact::{loop_impulses, outcomes};
use crate::support::mechanism::{Mechanism, Point, point};
use crate::support::urdf::Axis;
use heelstrike::pipeline::Impact;
use nalgebra::DMatrix;
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

/// Tolerance in eps: a few dozen roundings of matrices of condition below 1e3.
const ROUNDINGS: f64 = 1e5;

/// G = J M^-1 J' less the motions that the rows K prevent.
fn held(mechanism: &Mechanism, q: &[f64], contact: (&str, Point), rows: &DMatrix<f64>) -> DMatrix<f64> {
    let joints = 3..q.len();
    let inverse = mechanism.mass_matrix(q).view_range(joints.clone(), joints.clone()).try_inverse().expect("regular");
    let rates = mechanism.point_rates(q, contact.0, contact.1);
    let feet = rates.columns_range(joints);
    let coupling = rows * &inverse * feet.transpose();
    let of_rows = (rows * &inverse * rows.transpose()).try_inverse().expect("independent rows");
    feet * &inverse * feet.transpose() - coupling.transpose() * of_rows * coupling
}

fn strike(mechanism: &Mechanism, q: &[f64], v: &[f64], (loops, contact): (Value, (&str, Point))) -> Box<Impact> {
    let mut state = mechanism.state(0, q, v, &[]);
    state["loops"] = json!([loops]);
    state["contacts"] = json!([point(contact.0, contact.1)]);
    for part in ["position", "velocity"] {
        state[part].as_object_mut().expect("an object").remove("base");
    }
    state["friction"] = json!(0.7);
    impact(&bolted(mechanism), &state)
}

fn is_proven(found: &Impact) -> bool {
    let analysis = found.analysis.as_ref().expect("an answer");
    assert!(analysis.outcomes.iter().all(|outcome| outcome.proven == analysis.proven));
    analysis.proven
}

/// Asserts that rounding decides how many directions the loop holds, and that only the certain one is taken as held.
#[track_caller]
fn assert_doubtful(found: &Impact, expected: &DMatrix<f64>) {
    assert!(!is_proven(found));
    assert!(found.notes[0].contains("hold 1 of 2 directions, and nothing is proven"), "{:?}", found.notes);
    assert_near(&matrices(found).delassus, expected, ROUNDINGS);
    for outcome in outcomes(found) {
        assert!(outcome.impulse.iter().flatten().all(|entry| entry.abs() < 10.0), "{:?}", outcome.impulse);
    }
    assert!(loop_impulses(found).iter().flatten().flatten().all(|entry| entry.abs() < 10.0));
}

/// The second link, of the same length as the first, is folded back on it. Its end is at the first's hinge, whose
/// column of K is zero; with the f64 next to pi it is 6e-17.
#[test]
fn a_column_that_rounding_makes_holds_nothing() {
    let crank = Mechanism::of(1.0, [0.0; 2], 1.0).with("one", "root", [0.0; 2], 1.0, [0.0, -0.25]);
    let mechanism = crank.with("two", "one", [0.0, -0.5], 1.0, [0.0, -0.25]);
    let (q, v) = ([0.0, 0.0, 0.0, 0.3, PI], [0.0, 0.0, 0.0, -1.0, 0.0]);
    let ends = json!({"a": point("two", [0.0, -0.5]), "b": point("root", [0.0; 2])});
    let contact = ("one", [0.1, -0.5]);
    let found = strike(&mechanism, &q, &v, (ends, contact));
    // The certain row keeps the second hinge from moving.
    assert_doubtful(&found, &held(&mechanism, &q, contact, &DMatrix::from_row_slice(1, 2, &[0.0, 1.0])));
}

/// A level crank and a slide along z: both ends of the pin move along z alone.
#[test]
fn a_level_crank_does_not_hold_its_slide_sideways() {
    let mechanism = Mechanism::of(1.0, [0.0; 2], 1.0)
        .with("crank", "root", [0.0; 2], 1.0, [0.0, -0.25])
        .with("slide", "root", [0.0; 2], 1.0, [0.0; 2])
        .but(|link| link.kind = Axis::Prismatic([0.0, 1.0]));
    let (q, v) = ([0.0, 0.0, 0.0, FRAC_PI_2, 0.0], [0.0, 0.0, 0.0, -1.0, -0.5]);
    let ends = json!({"a": point("crank", [0.0, -0.5]), "b": point("slide", [-0.5, 0.0])});
    let contact = ("slide", [0.1, -0.5]);
    let found = strike(&mechanism, &q, &v, (ends, contact));
    assert_doubtful(&found, &held(&mechanism, &q, contact, &DMatrix::from_row_slice(1, 2, &[0.5, -1.0])));
}

/// The lengths of three links between two hinges of the root that are apart by their sum.
const LENGTHS: [f64; 3] = [0.25, 0.5, 0.375];
const CONTACT: (&str, Point) = ("two", [0.1, -0.2]);

/// Two links hang from one hinge; the third is on the other hinge, which is below the first.
fn four_bar() -> Mechanism {
    let [one, two, three] = LENGTHS;
    Mechanism::of(1.0, [0.0; 2], 1.0)
        .with("one", "root", [0.0; 2], 0.8, [0.01, -0.1])
        .with("two", "one", [0.0, -one], 1.2, [0.0, -0.25])
        .with("three", "root", [0.0, -(one + two + three)], 0.9, [0.0, 0.15])
}

/// The impact of the four-bar bent by an angle at the first hinge, with the pin where the links then meet.
fn bent(angle: f64, rates: [f64; 3]) -> Box<Impact> {
    let [one, two, _] = LENGTHS;
    let mechanism = four_bar();
    let q = [0.0, 0.0, 0.0, angle, -1.5 * angle, 0.0];
    let ends = mechanism.meeting(0, &q, (2, [0.0, -one - two]), 3);
    strike(&mechanism, &q, &[&[0.0; 3][..], &rates].concat(), (ends, CONTACT))
}

/// Rates that keep the straight four-bar closed: they move the pin along x, (l1 + l2) q1' + l2 q2' = -l3 q3'.
fn rates() -> [f64; 3] {
    let [one, two, three] = LENGTHS;
    [0.5, -0.3, -((one + two) * 0.5 - two * 0.3) / three]
}

/// K of the straight four-bar.
fn straight_row() -> DMatrix<f64> {
    let [one, two, three] = LENGTHS;
    DMatrix::from_row_slice(1, 3, &[one + two, two, three])
}

#[test]
fn an_exactly_straight_four_bar_is_proven() {
    let found = bent(0.0, rates());
    assert!(is_proven(&found), "{:?}", found.notes);
    assert_near(&matrices(&found).delassus, &held(&four_bar(), &[0.0; 6], CONTACT, &straight_row()), ROUNDINGS);
    let note = "loops[0] (two - three) is already closed along z by what else holds its points: that is left out, its \
                impulse is 0";
    assert_eq!(found.notes, [note]);
}

/// The four-bar is straight along another direction, which no f64 angle has exactly.
#[test]
fn a_straight_four_bar_by_rounding_is_not_proven() {
    for turn in [0.7_f64, -1.9, FRAC_PI_2] {
        let [one, two, three] = LENGTHS;
        let along = |length: f64| [-length * turn.sin(), -length * turn.cos()];
        let mut mechanism = four_bar();
        let shift = along(one + two + three);
        let link = &mut mechanism.links[3];
        link.com = [link.com[0] - link.place[0] + shift[0], link.com[1] - link.place[1] + shift[1]];
        link.place = shift;
        let q = [0.0, 0.0, 0.0, turn, 0.0, turn];
        let ends = json!({"a": point("two", [0.0, -two]), "b": point("three", [0.0, three])});
        let found = strike(&mechanism, &q, &[&[0.0; 3][..], &rates()].concat(), (ends, CONTACT));
        assert_doubtful(&found, &held(&mechanism, &q, CONTACT, &straight_row()));
    }
}

/// A gap g of the loop amounts to a bend by sqrt(g), so that the pose does not show smaller bends.
#[test]
fn a_bend_within_the_root_of_the_gap_is_doubtful() {
    for (angle, certain) in [(1e-2, true), (1e-4, true), (1e-6, true), (1e-9, false), (1e-11, false), (1e-14, false)] {
        let found = bent(angle, [0.0; 3]);
        assert_eq!(is_proven(&found), certain, "{angle:e}: {:?}", found.notes);
        assert_eq!(found.notes.iter().any(|note| note.contains("nothing is proven")), !certain);
    }
}
