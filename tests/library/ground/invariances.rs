//! Changes of a scene that do not change its outcomes: a segment cut in two, another place, a mirror image.

use super::*;
use crate::support::urdf::{HINGE, collision, joint, link};
use proptest::prelude::*;

/// A walker that touches stairs with a box and a disc as feet; it is mirrored where `side` is -1.
#[derive(Debug, Clone)]
struct Walker {
    /// x, z, pitch.
    place: [f64; 3],
    hips: [f64; 2],
    rates: [f64; 5],
    profile: Vec<[f64; 2]>,
}

const TOLERANCE: f64 = 1e-6;

impl Walker {
    fn any() -> impl Strategy<Value = Self> {
        // Width and rise of each step, from x = -1.3 on.
        let steps = prop::collection::vec((0.15..0.6, prop_oneof![-0.2..0.2, Just(0.0)]), 16);
        let rates = prop::array::uniform5(-1.0..1.0);
        let pitch = prop_oneof![Just(0.0), -0.4..0.4];
        let hips = (prop_oneof![Just(0.0), -0.6..0.6], -0.6..0.6);
        (-0.5..0.5, pitch, hips, rates, steps).prop_map(
            |(x, pitch, (one, other), rates, steps): (f64, f64, _, _, Vec<(f64, f64)>)| {
                // The box is level half the time.
                let hip = if one == 0.0 { -pitch } else { one };
                let mut profile = vec![[-1.3, 0.0]];
                for (width, rise) in steps {
                    let [x, z] = profile[profile.len() - 1];
                    profile.extend([[x + width, z], [x + width + 0.01, z + rise]]);
                }
                Self { place: [x, 0.0, pitch], hips: [hip, other], rates, profile }.landed()
            },
        )
    }

    /// Puts the walker at the height where it touches, half of the tolerance above the one at which it is refused.
    fn landed(mut self) -> Self {
        let (mut low, mut high) = (-5.0, 5.0);
        while high - low > 1e-9 {
            self.place[1] = 0.5 * (low + high);
            *if self.try_strike(1.0, &self.profile, [0.0; 2]).is_ok() { &mut high } else { &mut low } = self.place[1];
        }
        self.place[1] = high + 0.5 * TOLERANCE;
        self
    }

    fn robot(side: f64) -> Robot {
        let leg = |name: &str, x: f64, foot: &str| {
            let foot = collision([side * 0.03, -0.5], foot);
            let link = link(name, 1.0, [side * 0.02, -0.2], 0.03, &foot);
            link + &joint(name, HINGE, ["body", name], [side * x, -0.1], "")
        };
        let legs = [leg("one", 0.2, r#"box size="0.24 0.1 0.06""#), leg("two", -0.15, r#"sphere radius="0.07""#)];
        robot(&urdf::robot(&[link("body", 4.0, [side * 0.05, 0.1], 0.3, ""), legs.concat()]))
    }

    /// The impact on this profile, with the walker moved by `shift`.
    fn try_strike(&self, side: f64, profile: &[[f64; 2]], shift: [f64; 2]) -> heelstrike::Result<Box<Impact>> {
        let ([x, z, pitch], [u, w, rate, one, two]) = (self.place, self.rates);
        let place = [side * x + shift[0], z + shift[1], side * pitch];
        let mut state = state(place, [side * u, w, side * rate], 0.7, profile);
        state["position"]["joints"] = json!({"one": side * self.hips[0], "two": side * self.hips[1]});
        state["velocity"]["joints"] = json!({"one": side * one, "two": side * two});
        let options = Options { contact_tolerance: Some(TOLERANCE), ..Options::default() };
        try_impact(&Self::robot(side), options, state)
    }

    fn strike(&self, side: f64, profile: &[[f64; 2]], shift: [f64; 2]) -> Box<Impact> {
        let found = self.try_strike(side, profile, shift).expect("it touches");
        assert!(!found.contacts.is_empty());
        found
    }
}

fn sorted(mut numbers: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    // Compares coarse digits, so that rounding does not change the order.
    numbers.sort_by(|a, b| {
        let coarse = |row: &Vec<f64>| row.iter().map(|entry| (entry * 1e6).round() as i64).collect::<Vec<_>>();
        coarse(a).cmp(&coarse(b))
    });
    numbers
}

#[test]
fn points_on_a_slope_are_that_slope_to_tilted_soles() {
    let options = Options { contact_tolerance: Some(0.3), ..Options::default() };
    for (slope, tilt) in [0.0, -0.3].into_iter().flat_map(|slope| (-80..=80).map(move |tilt| (slope, tilt))) {
        let place = json!({"base": {"x": 0.1, "pitch": 0.01 * f64::from(tilt) - slope}});
        let touching = |ground: Value| {
            let state = json!({"position": place, "friction": 0.5, "place": "lowest", "ground": ground});
            let found = try_impact(&sole(), options.clone(), state).unwrap();
            found.contacts.iter().map(|contact| contact.center.components()).collect::<Vec<_>>()
        };
        let rise = 3.0 * f64::tan(slope);
        let points = json!({"profile": [[-3, -rise], [3, rise]]});
        assert_eq!(touching(points), touching(json!({"slope": slope})), "{slope} {tilt}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn points_on_a_segment_change_nothing(walker in Walker::any(), cuts in prop::collection::vec(0.0..1.0, 32)) {
        let mut fine = Vec::new();
        for (pair, cut) in walker.profile.windows(2).zip(&cuts) {
            let [[x, z], [to_x, to_z]] = [pair[0], pair[1]];
            fine.extend([[x, z], [x + cut * (to_x - x), z + cut * (to_z - z)]]);
        }
        fine.extend(walker.profile.last());
        fine.dedup_by(|a, b| a[0] <= b[0]);
        let [coarse, fine] = [&walker.profile, &fine].map(|profile| walker.strike(1.0, profile, [0.0; 2]));
        prop_assert_eq!(coarse.contacts.len(), fine.contacts.len());
        assert_same_outcomes(&coarse, &fine);
    }

    #[test]
    fn a_shifted_scene_is_the_same(walker in Walker::any(), shift in prop::array::uniform2(-3.0..3.0)) {
        let shifted: Vec<[f64; 2]> = walker.profile.iter().map(|[x, z]| [x + shift[0], z + shift[1]]).collect();
        let (here, there) = (walker.strike(1.0, &walker.profile, [0.0; 2]), walker.strike(1.0, &shifted, shift));
        prop_assert_eq!(here.contacts.len(), there.contacts.len());
        // Not exactly the same: risers 0.01 m wide turn by the rounding of their ends.
        assert_same_outcomes(&here, &there);
    }

    #[test]
    fn a_mirrored_scene_has_the_mirrored_outcomes(walker in Walker::any()) {
        let mirrored: Vec<[f64; 2]> = walker.profile.iter().rev().map(|[x, z]| [-x, *z]).collect();
        let (one, other) = (walker.strike(1.0, &walker.profile, [0.0; 2]), walker.strike(-1.0, &mirrored, [0.0; 2]));
        prop_assert_eq!(one.contacts.len(), other.contacts.len());
        let flip = |impact: &Impact, sign: f64| -> Vec<Vec<f64>> {
            let of = |v: &Vec<f64>| v.iter().enumerate().map(|(at, v)| if at == 1 { *v } else { sign * v }).collect();
            velocities_after(impact).iter().map(of).collect()
        };
        let (a, b) = (sorted(flip(&one, 1.0)), sorted(flip(&other, -1.0)));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.as_slice().concat().iter().zip(b.as_slice().concat()) {
            prop_assert!((a - b).abs() < 1e-10, "{:?} {:?}", velocities_after(&one), velocities_after(&other));
        }
    }
}
