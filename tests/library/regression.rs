//! Regressions: cases that were once answered wrongly, with their right answers. Reviews, fuzzing and comparison with
//! an exact solver found them.

use crate::support::impact::{impact, ramone, robot, try_impact};
use crate::support::urdf::{self, HINGE, POINT, collision, joint, link};
use heelstrike::impact::{
    Analysis, ContactProblem, Family, Friction, Inequality, ListedRejections, Mode, RejectionReason, Verdict, analyze,
};
use heelstrike::pipeline::Options;
use heelstrike::robot::Base;
use heelstrike::{Defaults, Robot, State};

use Mode::{Separate, SlideMinus, Stick};

fn solve<const N: usize>(delassus: &[f64], before: [[f64; 2]; N], friction: [Friction; N], e: [f64; N]) -> Analysis {
    let problem = ContactProblem::new(delassus.to_vec(), before.to_vec(), friction.to_vec(), e.to_vec());
    analyze(&problem.expect("a good problem"), ListedRejections::Nothing).expect("few contacts")
}

fn mu(mu: f64) -> Friction {
    Friction::Finite(mu)
}

fn modes(analysis: &Analysis) -> Vec<&[Mode]> {
    analysis.outcomes.iter().map(|outcome| outcome.modes.as_slice()).collect()
}

fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-13
}

/// A body on two legs with flat feet 0.2 m long, the left one 0.3 m ahead of the body, the right one 0.3 m behind.
fn flat_footed() -> Robot {
    let leg = |name: &str, x: f64| {
        let foot = collision([0.0; 2], r#"box size="0.2 0.1 0.05""#);
        let hip = joint(format!("{name}_hip"), HINGE, ["body", name], [x, -1.0], "");
        link(name, 1.0, [0.0; 2], 0.1, &foot) + &hip
    };
    robot(&urdf::robot(&[link("body", 2.0, [0.0; 2], 1.0, ""), leg("left", 0.3), leg("right", -0.3)]))
}

/// A single body of 2 kg with a flat side 0.4 m long, 0.1 m below its CoG.
fn flat_box() -> Robot {
    robot(&urdf::body(0.5, &collision([0.0; 2], r#"box size="0.4 0.1 0.2""#)))
}

// Redundant contacts.

#[test]
fn free_tangential_impulses_earn_no_pressure() {
    let delassus = [65., -48., 65., -16., -48., 37., -48., 13., 65., -48., 65., -16., -16., 13., -16., 5.];
    let found = solve(&delassus, [[6., -3.], [6., -1.]], [Friction::Infinite; 2], [0.25, 0.5]);
    assert_eq!(modes(&found), [[Separate, Stick]]);
    let [_, l] = found.outcomes[0].impulse[..] else { panic!("two contacts") };
    // `near` allows for rounding of a few operations on numbers below a hundred.
    assert!(near(l[0], -2.0 / 23.0) && near(l[1], 1.0 / 46.0), "{l:?}");
}

#[test]
fn a_redundant_impulse_is_the_least() {
    let delassus = [2., -2., 2., 1., -2., 5., -2., -1., 2., -2., 2., 1., 1., -1., 1., 2.];
    let found = solve(&delassus, [[-3., -3.]; 2], [mu(0.5), mu(8.0)], [0.0; 2]);
    assert_eq!(modes(&found), [[Stick, Stick]]);
    for (found, expected) in found.outcomes[0].impulse.as_flattened().iter().zip([1., 2., 2., 1.]) {
        assert!(near(*found, expected), "{found} {expected}");
    }
}

/// In friction cones of 1e-12 the search starts at impulses of 1e15; double-double then left a relative error of 3e-6.
#[test]
fn impulse_in_thin_cones_keeps_its_digits() {
    let mut delassus = [0.0; 36];
    for (row, column, entry) in [(3, 3, 1.0), (3, 4, -1.0), (3, 5, -1.0), (4, 4, 1.0), (4, 5, 1.0), (5, 5, 1.0)] {
        (delassus[row * 6 + column], delassus[column * 6 + row]) = (entry, entry);
    }
    let analysis = solve(&delassus, [[0.0, 0.0], [0.0, -3.0], [3.0, 3.0]], [mu(1e-12); 3], [0.0; 3]);
    // n_1 = 3 + t_2 + n_2 with |t_2| <= 1e-12 n_2: the shortest impulse has n_1 alone.
    assert_eq!(analysis.outcomes[0].impulse, [[0.0, 0.0], [0.0, 3.0], [0.0, 0.0]]);
}

/// One contact moves the body 1e30 times less than the others: 256 bits decided the signs, but left a relative error of
/// 3e-9 in its impulse.
#[test]
fn an_impulse_of_a_light_contact_keeps_its_digits() {
    let jacobian = [[-3.0, -1.0], [1.5777218104420236e-30, 4.733165431326071e-30], [-2.0, -2.0], [-2.0, -2.0]];
    let rows = jacobian.as_flattened();
    let delassus: Vec<f64> = rows.iter().flat_map(|a| rows.iter().map(move |b| a * b)).collect();
    let analysis = solve(&delassus, jacobian.map(|row| row.map(|entry| -3.0 * entry)), [mu(1.6e-5); 4], [0.0; 4]);
    // Only contact 1 pushes forward. Its shortest impulse is on the edge of its friction cone, with J L = 3.
    let [tangential, normal] = jacobian[1];
    let expected = 3.0 / (normal + 1.6e-5 * tangential);
    let found = analysis.outcomes[0].impulse[1];
    let errors = [found[1] / expected - 1.0, found[0] / (1.6e-5 * expected) - 1.0];
    assert!(errors.iter().all(|error| error.abs() < 1e-12), "{found:?}");
}

/// A plank slides on two pairs of supports; how they share the load decides how much they brake it.
#[test]
fn ends_of_a_family_that_are_close_are_two() {
    // Mass and moment of inertia 1, supports 1 below the CoG.
    let jacobian: Vec<Vec<f64>> =
        [-2.0, -1.0, 1.0, 2.0].iter().flat_map(|&x| [vec![1.0, 0.0, -1.0], vec![0.0, 1.0, x]]).collect();
    let masses = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|row| row.to_vec());
    for apart in [0.25, 1e-9, 1e-15] {
        let friction = [0.0, apart, apart, 0.0].map(|more| mu(0.5 + more)).to_vec();
        let problem = ContactProblem::from_dynamics(&masses, &jacobian, &[3.0, -1.0, 0.0], friction, vec![0.0; 4]);
        let found = analyze(&problem.expect("a problem"), ListedRejections::Nothing).expect("four contacts");
        assert!(found.proven && found.verdict == Verdict::Ambiguous, "{found:?}");
        let slides = vec![Mode::SlidePlus; 4];
        let [Family { modes, dimension: 1, corners, .. }] = &found.families[..] else { panic!("{found:?}") };
        assert_eq!((modes, &corners[..]), (&slides, &[0, 1][..]), "{apart}");
        assert!(found.outcomes.iter().all(|outcome| outcome.modes == slides && outcome.family));
        let speeds = [0, 1].map(|end: usize| found.outcomes[end].velocity_after[0][0]);
        assert!((speeds[0] - speeds[1]).abs() < 4.0 * apart, "{speeds:?}");
    }
}

#[test]
fn contacts_that_squeeze_at_rest_are_on_no_border() {
    // L = s (1, 2) is admissible for every s: the normal impulse is not forced to zero.
    let found = solve(&[4., -2., -2., 1.], [[0., 0.]], [mu(2.0)], [0.0]);
    assert_eq!((found.verdict, found.outcomes[0].index, found.index_sum), (Verdict::NoImpact, Some(1), Some(1)));
    assert!(!found.outcomes[0].impulse_unique);
}

#[test]
fn a_twin_without_impulse_is_recognized() {
    let delassus = [11., -2., 10., -2., -2., 5., 0., 5., 10., 0., 12., 0., -2., 5., 0., 5.];
    let found = solve(&delassus, [[0., -1.]; 2], [Friction::ZERO, mu(8.0)], [0.25, 0.25]);
    assert_eq!((found.verdict, modes(&found)), (Verdict::Unique, vec![&[SlideMinus, Stick][..]]));
}

#[test]
fn ill_conditioned_matrix_keeps_its_digits() {
    // By hand: the t rows decouple; the n rows are [[a, -b], [-b, b + d]] with a = (1 + 2^-29) b and d = 2^-16.
    let (a, b, d) = (393_216.000_732_421_9, 393_216.0, 0.000_015_258_789_062_5);
    let delassus = [786_432., 0., 0., 0., 0., a, 0., -b, 0., 0., 786_432., 0., 0., -b, 0., b + d];
    let found = solve(&delassus, [[0., 0.], [0., -4.]], [mu(0.25); 2], [0.0; 2]);
    // G L = (0, 4): L_1 = 4 b / det, L_2 = 4 a / det with det = a (b + d) - b^2, computed without cancellation.
    let det = (a - b) * b + a * ((b + d) - b);
    let [first, second] = [found.outcomes[0].impulse[0][1], found.outcomes[0].impulse[1][1]];
    assert!((first / (4.0 * b / det) - 1.0).abs() < 1e-14, "{first}");
    assert!((second / (4.0 * a / det) - 1.0).abs() < 1e-14, "{second}");
}

#[test]
fn friction_at_the_end_of_f64_has_signs_and_margins() {
    // The pivot of a slide overflows, with which outcomes were wrong and yet proven.
    let found = solve(&[1., 3., 3., 9.], [[-2., 1.]], [mu(1e308)], [0.0]);
    assert_eq!((found.verdict, found.proven), (Verdict::NoImpact, true));
    // The cone is the half-plane L_n >= 0, so that the margin is the slack L_n sqrt(G_nn) = 0.1 / sqrt(0.5).
    let found = solve(&[1., 0., 0., 0.5], [[1., -0.1]], [mu(1.7e308)], [0.0]);
    assert!(found.outcomes[0].margin.is_some_and(|margin| near(margin, 0.1 / 0.5_f64.sqrt())), "{found:?}");
}

// Feet at rest.

#[test]
fn a_foot_at_rest_hides_no_velocity_into_the_ground() {
    // The pivot of the first contact's slide is 1e-8; its impulse is zero.
    let delassus = [2., 0.99999999, 0., 0.3, 0.99999999, 1., 0.2, 0.4, 0., 0.2, 2., 0., 0.3, 0.4, 0., 2.];
    let before = vec![[0., 0.], [0., -0.4]];
    let problem = ContactProblem::new(delassus.to_vec(), before, vec![mu(1.0), mu(0.5)], vec![0.0; 2]).unwrap();
    let analysis = analyze(&problem, ListedRejections::Everything).expect("few contacts");
    let rejected = analysis.rejected.iter().find(|own| own.modes == [Mode::SlidePlus, Separate]);
    let into_the_ground = RejectionReason::Violated { contact: 1, inequality: Inequality::NormalVelocity };
    assert_eq!(rejected.map(|own| own.because), Some(into_the_ground));
}

#[test]
fn a_flat_foot_rests_while_another_contact_leaves() {
    let state = r#"{"stance": "left", "velocity": {"base": {"pitch": 0.5}, "joints": {"left_hip": -0.5}}}"#;
    let found = impact(&flat_footed(), state);
    assert_eq!(found.contacts.len(), 4);
    let analysis = found.analysis.expect("few contacts");
    assert_eq!(analysis.verdict, Verdict::NoImpact);
    assert_eq!(analysis.outcomes[0].modes[..2], [Stick, Stick]);
    assert_eq!(analysis.outcomes[0].impulse, [[0.0; 2]; 4]);
}

#[test]
fn a_flat_foot_that_slides_along_takes_no_impulse() {
    let state = r#"{"position": {"base": {"z": 0.1}}, "velocity": {"base": {"x": 1.0}}}"#;
    let analysis = impact(&flat_box(), state).analysis.expect("few contacts");
    assert_eq!((analysis.verdict, analysis.outcomes[0].impulse.as_slice()), (Verdict::NoImpact, &[[0.0; 2]; 2][..]));
}

#[test]
fn a_speed_that_is_all_rounding_is_taken_as_rest() {
    // The rates of base and joints cancel at the foot, up to 1e-16 m/s.
    let state = |x: f64, z: f64| {
        format!(
            r#"{{"position": {{"base": {{"z": 0.60432}}, "joints": {{"left_hip": 0.3, "right_hip": 0.1}}}}, "friction": 0.6,
            "velocity": {{"base": {{"x": {x:?}, "z": {z:?}, "pitch": -0.1}}, "joints": {{"left_hip": 0.7, "left_knee": -0.2}}}},
            "contacts": [{{"link": "left_foot", "radius": 0.02815}}]}}"#
        )
    };
    let [x, z] = impact(&ramone(), state(0.0, 0.0)).velocity_before[0];
    let nulled = state(-x, -z);
    let strict = Options { resting_speed: Some(0.0), ..Options::default() };
    let at_its_word = try_impact(&ramone(), strict, &nulled).expect("an answer");
    let [t, n] = at_its_word.velocity_before[0];
    assert!(t.abs() < 1e-15 && n.abs() < 1e-15, "all but rounding is gone: {t} {n}");
    assert_ne!([t, n], [0.0; 2], "or the case shows nothing");
    // With exactly these f64 rates the foot leaves the ground, more slowly than f64 resolves.
    let analysis = at_its_word.analysis.expect("one contact");
    assert_eq!((analysis.verdict, analysis.proven), (Verdict::NoImpact, true));
    assert_eq!(analysis.outcomes[0].modes, [Separate]);
    assert!(at_its_word.notes.iter().any(|note| note.contains("`resting_speed`")), "{:?}", at_its_word.notes);

    let found = impact(&ramone(), &nulled);
    assert_eq!((&found.velocity_before[..], &found.resting[..]), (&[[0.0; 2]][..], &[true][..]));
    assert!(
        found.notes[0].contains(" is taken as exactly at rest although it moves at ")
            && found.notes[0].contains("(its velocity is rounded by up to"),
        "{:?}",
        found.notes
    );
    let analysis = found.analysis.expect("one contact");
    assert_eq!((analysis.verdict, analysis.proven), (Verdict::NoImpact, true));
    assert_eq!(analysis.outcomes[0].modes, [Stick]);

    // Rates of eight decimals leave some 1e-8 m/s, which is rest to their digits; 4e-7 m/s are more than their
    // rounding.
    let printed = |number: f64| (number * 1e8).round() / 1e8;
    let rests = |state: &str| impact(&ramone(), state).resting[0];
    assert!(rests(&state(printed(-x), printed(-z))));
    assert!(!rests(&state(printed(-x + 4e-7), printed(-z))));
    // With an uncertainty the foot is not at rest: its velocity may be anywhere in the box.
    assert!(!rests(&nulled.replacen('{', r#"{"uncertainty": {"velocity": 1e-3}, "#, 1)));
}

#[test]
fn digits_explain_only_what_nearly_cancels() {
    // 1 m below the base, the rates of x and pitch cancel except for `slip`; the terms add up to 2 m/s and more. The
    // pitch is known to half a decimal place of x, 0.05 rad, with which the foot may move at 0.05 m/s. Yet digits
    // explain no more than 1e-4 of the terms.
    let rests = |slip: f64| {
        let state = format!(
            r#"{{"position": {{"base": {{"x": 12345.6, "z": 1, "pitch": 0}}}}, "friction": 0.5,
            "velocity": {{"base": {{"x": {}, "pitch": 1}}}}, "contacts": [{{"link": "body", "offset": [0, 0, -1]}}]}}"#,
            1.0 + slip
        );
        impact(&flat_box(), state.as_str()).resting[0]
    };
    assert_eq!([1e-5, 1e-4, 4e-4, 1e-3, 1e-2].map(rests), [true, true, false, false, false]);
}

// Extremes.

#[test]
fn a_robot_that_cannot_move_answers() {
    let elements = [
        "<link name=\"base\"/>".to_owned(),
        link("rod", 1.0, [0.0, -1.0], 1.0, &collision([0.0, -1.0], POINT)),
        joint("j", HINGE, ["base", "rod"], [0.0, 1.0], ""),
    ];
    let robot = robot(&urdf::robot(&elements));
    assert_eq!(robot.base(), Base::Fixed);
    let found = impact(&robot, r#"{"held": ["j"]}"#);
    assert_eq!(found.analysis.expect("one contact").verdict, Verdict::NoImpact);
    // The braked joint keeps its rate, so that nothing can stop the foot: it slides.
    let driven = impact(&robot, r#"{"held": ["j"], "velocity": {"joints": {"j": 1.0}}}"#);
    let analysis = driven.analysis.expect("one contact");
    assert_eq!(analysis.rank, Some(0));
    assert_eq!((analysis.verdict, analysis.proven), (Verdict::NoImpact, true));
    assert_eq!(analysis.modes(), [[SlideMinus]]);
}

#[test]
fn numbers_that_overflow_are_refused_by_name() {
    let answer =
        |state: &str| try_impact(&flat_box(), Options::default(), state).and_then(|impact| impact.into_analysis());
    for (state, reason) in [
        (
            r#"{"contacts": [{"link": "body", "offset": [1e200, 0, 1e200]}], "velocity": {"base": {"z": -1}}}"#,
            "the Delassus matrix must be a finite number",
        ),
        (r#"{"velocity": {"base": {"x": 1e308, "z": -1e308}}, "position": {"base": {"z": 0.1}}}"#, "finite"),
        // Without a contact.
        (
            r#"{"position": {"base": {"z": 9}}, "impulse": [{"link": "body", "offset": [9, 0, 0], "vector": [0, 1e308]}]}"#,
            "a velocity after the applied impulses",
        ),
    ] {
        let refused = answer(state).expect_err(state).to_string();
        assert!(refused.contains(reason), "{refused}");
    }
}

#[test]
fn matrices_within_the_range_keep_their_digits() {
    let scaled = |unit: f64| {
        let delassus = [3.0 * unit, 0.5 * unit, 0.5 * unit, unit];
        ContactProblem::new(delassus.to_vec(), vec![[0.1, -1.0]], vec![mu(0.7)], vec![0.0])
    };
    assert!(scaled(1e-160).is_err() && scaled(1e154).is_err());
    // Sticking: 3 L_t + 0.5 L_n = -0.1 and 0.5 L_t + L_n = 1, in parts of 1 / `unit`, give `expected`.
    for unit in [1e-110, 1.0, 1e110] {
        let found = analyze(&scaled(unit).expect("within the range"), ListedRejections::Nothing).expect("one contact");
        let sticking = found.outcomes[0].impulse[0];
        assert!((found.outcomes[0].energy_loss * unit).is_finite());
        let expected = 1.0 / (1.0 - 0.5 * 0.5 / 3.0) * (1.0 + 0.1 * 0.5 / 3.0);
        assert!((sticking[1] * unit - expected).abs() < 1e-14, "{sticking:?}");
    }
}

/// The velocity change by the impulse was taken from its sum with a velocity next to which it vanishes. The contact was
/// then proven both to separate and to press.
#[test]
fn an_impulse_is_not_lost_beside_a_great_velocity() {
    let state = r#"{"friction": 0.5, "stance": "right_foot",
        "position": {"base": {"pitch": 0.4}, "joints": {"left_hip": 0.5, "left_knee": 0.4, "right_knee": 2.0}},
        "velocity": {"base": {"pitch": -3e112}}, "contacts": [{"link": "right_foot"}],
        "impulse": [{"link": "left_thigh", "offset": [0.8, 0, -2.0], "vector": [-0.9, 1.0]}]}"#;
    let analysis = impact(&ramone(), state).analysis.expect("outcomes");
    assert!(analysis.proven && analysis.verdict != Verdict::None);
    assert_eq!(analysis.index_sum, Some(1));
}

/// The rounding of heights was taken as that of the distance, so that far away every foot touched at any depth.
#[test]
fn a_far_base_does_not_change_which_feet_touch() {
    let block = robot(include_str!("../../urdf/block.urdf"));
    let at = |x: f64, z: f64, slope: f64| {
        let state = format!(
            r#"{{"friction": 1, "position": {{"base": {{"x": {x:?}, "z": {z:?}}}}}, "ground": {{"slope": {slope}}}}}"#
        );
        try_impact(&block, Options::default(), state)
    };
    assert_eq!(at(-3e173, 10.0, 0.0).expect("above the ground").contacts.len(), 0);
    assert!(at(-3e173, -10.0, 0.0).expect_err("in the ground").to_string().contains("deep in the ground"));
    let lost = at(-3e173, 10.0, 0.1).expect_err("nobody knows where the ground is").to_string();
    assert!(lost.contains("so far from the world's origin"), "{lost}");
}

// Stance and detection.

#[test]
fn stance_uses_lowest_point_at_any_tolerance() {
    let answer = |robot: &Robot, tolerance: f64, state: &str| {
        let options = Options { contact_tolerance: Some(tolerance), ..Options::default() };
        try_impact(robot, options, state).expect("an answer")
    };
    let state = r#"{"stance": "left_foot", "position": {"base": {"pitch": 0.123}, "joints": {"left_hip": 0.7, "left_knee": -1.1,
        "right_hip": 1.4, "right_knee": -2.0}}}"#;
    let found = answer(&ramone(), 0.0, state);
    assert_eq!(found.contacts.len(), 1);
    assert_eq!(found.velocity_before, [[0.0; 2]]);
    let found = answer(&flat_box(), 0.02, r#"{"stance": "body", "position": {"base": {"pitch": 0.05}}}"#);
    let at_origin = found.contacts.iter().find(|contact| contact.point == [0.0; 2]).expect("it stands at the origin");
    assert_eq!(at_origin.center, [0.2, -0.1], "the toe, with the nose down");
}

#[test]
fn a_gain_of_energy_is_noted() {
    let delassus = [3.019_756_771_129_185_5, 2.127_611_009_867_684, 2.127_611_009_867_684, 1.602_399_100_432_706_7];
    let problem =
        ContactProblem::new(delassus.into(), vec![[-1.18, -0.5876]], vec![mu(1.0)], vec![1.0]).expect("a problem");
    let found = analyze(&problem, ListedRejections::Nothing).expect("one contact");
    assert!(found.outcomes.iter().any(|outcome| outcome.energy_loss < 0.0));
    assert!(found.notes(&problem, || 0.0).any(|note| note.contains("add energy")));
}

#[test]
fn friction_by_link_is_a_states_own() {
    let given = Some(mu(0.8));
    let has_own = |friction: &str| {
        let defaults = Defaults { friction: given, ..Defaults::default() };
        let state = State::from_json(&format!("{{\"friction\": {friction}}}"), &ramone(), &defaults).expect("a state");
        state.scene.has_own_friction(given)
    };
    let frictions = ["0.8", "0.5", r#"{"left_foot": 0.5}"#, r#"{"left_foot": 0.8}"#, r#"{"default": 0.8}"#];
    assert_eq!(frictions.map(has_own), [false, true, true, false, false]);
}
