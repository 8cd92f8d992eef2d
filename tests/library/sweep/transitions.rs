//! Transitions at borders that are known by hand.

use crate::sweep::command::{Border, Turn, straight, sweep};
use serde_json::json;
use std::f64::consts::PI;

fn sorted(border: &Border) -> Vec<Turn> {
    let mut turns = border.turns.clone();
    turns.sort();
    turns
}

fn turn(contact: &str, inequality: &str, modes: &str, valid: &str) -> Turn {
    let [contact, inequality, valid] = [contact, inequality, valid].map(str::to_owned);
    Turn { contact, inequality, modes: modes.split('/').map(str::to_owned).collect(), valid }
}

/// The paper's three cases of the trailing foot: lift-off needs c_n+ >= 0, a stop L_n >= 0, and a slide with infinite
/// friction needs c_t+ and L_t of opposite signs. c_n+ of lift-off and L_t of the slide are zero at the same borders,
/// and so are L_n of the stop and c_t+ of the slide.
#[test]
fn borders_of_the_biped_turn_by_the_trailing_foot() {
    let sweep = sweep("urdf/minimalistic.urdf", &straight(None));
    let expected = [
        (1.0, ("normal_velocity", "separate/stick", "below"), ("tangential_impulse", "slide-/stick", "above")),
        (2.0, ("normal_impulse", "stick/stick", "above"), ("tangential_velocity", "slide-/stick", "below")),
        (5.0, ("normal_velocity", "separate/stick", "above"), ("tangential_impulse", "slide+/stick", "above")),
    ];
    assert_eq!(sweep.borders.len(), expected.len());
    for (border, (twelfths, one, other)) in sweep.borders.iter().zip(expected) {
        let at = twelfths * PI / 12.0;
        let turns = [one, other].map(|(inequality, modes, valid)| turn("left_leg", inequality, modes, valid));
        assert!((border.at - at).abs() < 4e-12, "{} instead of {at}", border.at);
        assert_eq!(sorted(border), turns, "at {at}");
        assert!(border.opening.is_empty() && border.closing.is_empty());
    }
}

/// The paper's single body, G = [[2, 1], [1, 2]], struck by L_ext in one direction, slides if friction is below |L_t| /
/// L_n of sticking.
#[test]
fn a_cone_turns_where_friction_suffices() {
    let study = json!({
        "parameters": {"mu": {"from": 0.1, "to": 1.9, "steps": 5}},
        // L_ext = (-0.75, -1), so that sticking takes L = (0.75, 1); c- = G L_ext.
        "state": {"velocity": {"base": {"x": "2*(-0.75) - 1", "z": "-0.75 - 2"}}, "friction": "mu"},
    });
    let sweep = sweep("urdf/block.urdf", &study);
    let [border] = &sweep.borders[..] else { panic!("{:?}", sweep.borders) };
    assert!((border.at - 0.75).abs() < 4e-12, "{}", border.at);
    let expected = [("friction_cone", "stick", "above"), ("tangential_velocity", "slide-", "below")];
    let expected = expected.map(|(inequality, mode, valid)| turn("block", inequality, mode, valid));
    assert_eq!(sorted(border), expected);
}

/// A contact that is lifted off the ground leaves the set of contacts at the contact tolerance, which is the border.
#[test]
fn a_border_where_a_contact_opens_names_it() {
    let study = json!({
        "parameters": {"height": {"from": -0.1, "to": 1, "steps": 4}},
        "state": {"position": {"base": {"z": "max(0, height)"}}, "velocity": {"base": {"z": -1}}, "friction": 1},
    });
    let sweep = sweep("urdf/block.urdf", &study);
    let [below, above] = &sweep.regions[..] else { panic!("{:?}", sweep.regions) };
    let block = || vec!["block".to_owned()];
    assert_eq!((&below.contacts, &above.contacts), (&Some(block()), &Some(vec![])));
    assert_eq!(above.outcomes, Some(vec![vec![]]));
    let border = &sweep.borders[0];
    // The contact tolerance is 1e-6 of the robot's size, the distance of its CoG at (-1, 1).
    let tolerance = 1e-6 * f64::sqrt(2.0);
    assert!((border.at - tolerance).abs() < 2e-12, "{} instead of {tolerance}", border.at);
    assert_eq!((&border.opening, &border.closing, &border.turns), (&block(), &vec![], &vec![]));
}

/// A block that slides has the same modes where it does not move into the ground. A region has the verdict `no_impact`
/// only if this is so everywhere in it. Rounding makes no border.
#[test]
fn a_region_is_without_impact_only_as_a_whole() {
    let verdicts = |z: &str, steps: u32| -> Vec<Option<String>> {
        let study = json!({
            "parameters": {"a": {"from": -1, "to": 1, "steps": steps}},
            "state": {"velocity": {"base": {"x": 1, "z": z}}, "friction": 0.5},
        });
        sweep("urdf/block.urdf", &study).regions.into_iter().map(|region| region.verdict).collect()
    };
    for (z, verdict) in [
        ("-a^2", "unique"),
        ("min(a, 0)", "unique"),
        // It strikes at the first sample only.
        ("min(a + 0.999, 0)", "unique"),
        ("-(1 - cos(a))", "unique"),
        ("-abs(a*3/3 - a) - 1e-300", "unique"),
        ("0*a", "no_impact"),
    ] {
        for steps in [4, 21] {
            assert_eq!(verdicts(z, steps), [Some(verdict.to_owned())], "{z}");
        }
    }
}
