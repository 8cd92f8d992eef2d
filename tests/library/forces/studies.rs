//! Studies that ask for forces: Painleve's uniform rod over its friction, its angle and its rate of turn.

use crate::support::urdf;
use crate::sweep::studies::with;
use heelstrike::impact::{Inequality, Verdict};
use heelstrike::law::Mode::{self, Separate, SlideMinus};
use heelstrike::sweep::{Findings, Side, Survey, Workers};
use serde_json::{Value, json};

const GRAVITY: f64 = 9.81;
const WORKERS: Workers<'static> = Workers { threads: 2, done: &|| () };

/// A rod of length 1 whose lower end slides backward.
fn study(parameters: Value, constants: Value) -> Value {
    json!({
        "question": "forces", "parameters": parameters, "constants": constants,
        "state": {
            "position": {"base": {"z": "0.5*sin(theta)"}},
            "velocity": {"base": {"x": "0.5*sin(theta)*omega - 1", "z": "-0.5*cos(theta)*omega", "pitch": "omega"}},
            "contacts": [{"link": "rod", "offset": ["-0.5*cos(theta)", 0, "-0.5*sin(theta)"]}],
            "friction": "mu",
        },
    })
}

fn findings<T>(study: &Value, ask: impl FnOnce(Findings) -> T) -> T {
    let rod = urdf::robot(&[urdf::link("rod", 2.0, [0.0, 0.0], 2.0 / 12.0, "")]);
    with(&rod, study, 0, |model| ask(Findings::of(model, WORKERS)))
}

fn survey(study: &Value) -> Survey {
    findings(study, |findings| match findings {
        Findings::Along(survey) => survey,
        Findings::Map(_) => panic!("one parameter"),
    })
}

/// The friction at which p = 1 + 3 cos(theta) (cos(theta) - mu sin(theta)) is zero.
fn friction_at_pole(theta: f64) -> f64 {
    let (sin, cos) = theta.sin_cos();
    (1.0 + 3.0 * cos * cos) / (3.0 * cos * sin)
}

#[test]
fn force_has_no_bound_where_the_paradox_begins() {
    for (omega, verdicts) in [(3.0, [Verdict::Unique, Verdict::None]), (7.0, [Verdict::Unique, Verdict::Ambiguous])] {
        let mu = json!({"mu": {"from": 0.5, "to": 4, "steps": 4}});
        let survey = survey(&study(mu, json!({"theta": 0.9, "omega": omega})));
        let found: Vec<Verdict> = survey.regions.iter().filter_map(|region| region.verdict).collect();
        assert_eq!(found, verdicts);
        let [border] = &survey.borders[..] else { panic!("{survey:?}") };
        assert!((border.at - friction_at_pole(0.9)).abs() < 1e-11, "{}", border.at);
        let ended: Vec<_> = border.transition.ended.iter().map(|own| (own.inequality, &*own.modes, own.side)).collect();
        // Below the pole the rod slides on; for the greater omega, at which it also lifts off, it can slide above the
        // pole.
        let side = if omega < 5.0 { Side::Below } else { Side::Above };
        assert_eq!(ended, [(Inequality::UnboundedForce, &[SlideMinus][..], side)]);
    }
}

/// The pole belongs to one foot, and the inequality that is violated most beyond it belongs to the other.
#[test]
fn the_foot_whose_force_has_no_bound_is_named() {
    let leg = |link: &str| json!({"link": link, "offset": [0, 0, -1]});
    let study = json!({
        "question": "forces", "parameters": {"mu": {"from": 0, "to": 4, "steps": 9}},
        "state": {
            "position": {"base": {"pitch": 0.1}, "joints": {"hip": -0.3}}, "velocity": {"base": {"x": 1}},
            "friction": "mu", "torque": {"hip": 5}, "contacts": [leg("left_leg"), leg("right_leg")],
        },
    });
    let walker = include_str!("../../../urdf/minimalistic.urdf");
    let found = with(walker, &study, 0, |model| Findings::of(model, WORKERS));
    let Findings::Along(survey) = found else { panic!("one parameter") };
    let border = survey.borders.iter().find(|border| (border.at - 0.87216649).abs() < 1e-6).expect("the pole");
    let ended: Vec<_> = border.transition.ended.iter().map(|own| (&*own.contact, own.inequality)).collect();
    assert!(ended.contains(&("left_leg", Inequality::UnboundedForce)), "{ended:?}");
}

#[test]
fn force_and_acceleration_end_where_the_rod_lifts() {
    // b_n = omega^2 sin(theta) / 2 - g.
    let lifts = (2.0 * GRAVITY / 0.9_f64.sin()).sqrt();
    for (mu, force, acceleration) in [(0.5, Side::Below, Side::Above), (2.0, Side::Above, Side::Above)] {
        let omega = json!({"omega": {"from": 1, "to": 8, "steps": 4}});
        let survey = survey(&study(omega, json!({"theta": 0.9, "mu": mu})));
        let [border] = &survey.borders[..] else { panic!("{survey:?}") };
        assert!((border.at - lifts).abs() < 1e-11, "{} {lifts}", border.at);
        let mut ended: Vec<_> =
            border.transition.ended.iter().map(|own| (own.modes[0], own.inequality, own.side)).collect();
        ended.sort_by_key(|(mode, ..)| *mode);
        let expected =
            [(Separate, Inequality::NormalAcceleration, acceleration), (SlideMinus, Inequality::NormalForce, force)];
        assert_eq!(ended, expected, "{mu}");
    }
}

#[test]
fn map_has_the_four_regions_of_the_rod() {
    let parameters = json!({"theta": {"from": 0.05, "to": 1.5, "steps": 5}, "mu": {"from": 0, "to": 4, "steps": 5}});
    findings(&study(parameters, json!({"omega": 5.2})), |findings| {
        let Findings::Map(map) = findings else { panic!("two parameters") };
        let mut found: Vec<&[Vec<Mode>]> = map.areas.iter().filter_map(|area| area.regime.outcomes()).collect();
        found.sort();
        let both = [vec![Separate], vec![SlideMinus]];
        assert_eq!(found, [&[][..], &both[..1], &both, &both[1..]]);
        let is_pole = |own: &heelstrike::sweep::EndedOutcome| own.inequality == Inequality::UnboundedForce;
        let poles = map.curves.iter().filter(|curve| curve.transition.ended.iter().any(is_pole));
        let points: Vec<[f64; 2]> = poles.flat_map(|curve| curve.points.iter().copied()).collect();
        assert!(points.len() > 50);
        // JSON sorts the parameters' names. The outermost points are moved to the end of the range, and where four
        // regions meet their borders are joined within a cell of 1e-4 of the ranges.
        let meeting = (2.0 * GRAVITY / (5.2 * 5.2)).asin();
        for &[mu, theta] in points.iter().filter(|[mu, theta]| *mu < 4.0 && (theta - meeting).abs() > 1e-3) {
            // Points are found to 1e-9 of the ranges, and the curve is as steep as 50.
            assert!((mu - friction_at_pole(theta)).abs() < 1e-7 * mu, "{theta} {mu}");
        }
        let least = points.iter().fold(f64::INFINITY, |least, &[mu, _]| least.min(mu));
        // The curve is straight to 5e-5 of the ranges between its points.
        assert!((least - 4.0 / 3.0).abs() < 1e-3, "{least}");
    });
}
