//! What changes nothing: a segment cut in two, another place, a mirror.

use super::*;
use crate::support::urdf::{HINGE, collision, joint, link};
use proptest::prelude::*;

/// A walker over stairs, seen in a mirror where `mirrored` is -1: a box and a disc for feet.
#[derive(Debug, Clone)]
struct Walker {
    x: f64,
    pitch: f64,
    hips: [f64; 2],
    rates: [f64; 5],
    /// Width and rise of each step, from x = -1.3 on.
    steps: Vec<(f64, f64)>,
}

impl Walker {
    fn any() -> impl Strategy<Value = Self> {
        let steps = prop::collection::vec((0.15..0.6, prop_oneof![-0.2..0.2, Just(0.0)]), 16);
        let rates = prop::array::uniform5(-1.0..1.0);
        let pitch = prop_oneof![Just(0.0), -0.4..0.4];
        let hips = (prop_oneof![Just(0.0), -0.6..0.6], -0.6..0.6);
        (-0.5..0.5, pitch, hips, rates, steps).prop_map(
            |(x, pitch, (one, other), rates, steps): (f64, f64, _, _, _)| {
                // The box is level half the time.
                let hip = if one == 0.0 { -pitch } else { one };
                Self { x, pitch, hips: [hip, other], rates, steps }
            },
        )
    }

    fn profile(&self) -> Vec<[f64; 2]> {
        let mut points = vec![[-1.3, 0.0]];
        for &(width, rise) in &self.steps {
            let [x, z] = points[points.len() - 1];
            points.push([x + width, z]);
            points.push([x + width + 0.01, z + rise]);
        }
        points
    }

    fn robot(mirrored: f64) -> Robot {
        let leg = |name: &str, x: f64, foot: &str| {
            let foot = collision([mirrored * 0.03, -0.5], foot);
            let link = link(name, 1.0, [mirrored * 0.02, -0.2], 0.03, &foot);
            link + &joint(name, HINGE, ["body", name], [mirrored * x, -0.1], "")
        };
        let legs = [leg("one", 0.2, r#"box size="0.24 0.1 0.06""#), leg("two", -0.15, r#"sphere radius="0.07""#)];
        robot(&urdf::robot(&[link("body", 4.0, [mirrored * 0.05, 0.1], 0.3, ""), legs.concat()]))
    }

    fn state(&self, mirrored: f64, height: f64, profile: &[[f64; 2]], shift: [f64; 2]) -> Value {
        let [u, w, rate, one, two] = self.rates;
        let m = mirrored;
        let place = [m * self.x + shift[0], height + shift[1], m * self.pitch];
        let mut state = state(place, [m * u, w, m * rate], 0.7, profile);
        state["position"]["joints"] = json!({"one": m * self.hips[0], "two": m * self.hips[1]});
        state["velocity"]["joints"] = json!({"one": m * one, "two": m * two});
        state
    }

    fn answer(robot: &Robot, state: &Value) -> Option<Impact> {
        let options = Options { contact_tolerance: Some(Self::TOLERANCE), ..Options::default() };
        try_impact(robot, options, state).ok()
    }

    /// The height at which the walker touches, half of the tolerance above the one at which it is refused.
    fn landed(&self, robot: &Robot) -> f64 {
        let profile = self.profile();
        let (mut low, mut high) = (-5.0, 5.0);
        while high - low > 1e-9 {
            let middle = 0.5 * (low + high);
            match Self::answer(robot, &self.state(1.0, middle, &profile, [0.0; 2])) {
                Some(_) => high = middle,
                None => low = middle,
            }
        }
        high + 0.5 * Self::TOLERANCE
    }

    const TOLERANCE: f64 = 1e-6;
}

fn sorted(mut numbers: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    // By coarse digits, so that rounding does not change the order.
    numbers.sort_by(|a, b| {
        let coarse = |row: &Vec<f64>| row.iter().map(|entry| (entry * 1e6).round() as i64).collect::<Vec<_>>();
        coarse(a).cmp(&coarse(b))
    });
    numbers
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn points_on_a_segment_change_nothing(walker in Walker::any(), cuts in prop::collection::vec(0.0..1.0, 32)) {
        let robot = Walker::robot(1.0);
        let (profile, height) = (walker.profile(), walker.landed(&robot));
        let mut fine = Vec::new();
        for (pair, cut) in profile.windows(2).zip(&cuts) {
            let [[x, z], [to_x, to_z]] = [pair[0], pair[1]];
            fine.push([x, z]);
            fine.push([x + cut * (to_x - x), z + cut * (to_z - z)]);
        }
        fine.push(profile[profile.len() - 1]);
        fine.dedup_by(|a, b| a[0] <= b[0]);
        let answer = |profile: &[[f64; 2]]| {
            Walker::answer(&robot, &walker.state(1.0, height, profile, [0.0; 2])).expect("it touches")
        };
        let (coarse, fine) = (answer(&profile), answer(&fine));
        prop_assert!(!coarse.contacts.is_empty());
        prop_assert_eq!(coarse.contacts.len(), fine.contacts.len());
        assert_same_outcomes(&coarse, &fine);
    }

    #[test]
    fn a_shifted_scene_is_the_same(walker in Walker::any(), shift in prop::array::uniform2(-3.0..3.0)) {
        let robot = Walker::robot(1.0);
        let (profile, height) = (walker.profile(), walker.landed(&robot));
        let shifted: Vec<[f64; 2]> = profile.iter().map(|[x, z]| [x + shift[0], z + shift[1]]).collect();
        let answer = |profile: &[[f64; 2]], shift| {
            Walker::answer(&robot, &walker.state(1.0, height, profile, shift)).expect("it touches")
        };
        let (here, there) = (answer(&profile, [0.0; 2]), answer(&shifted, shift));
        prop_assert_eq!(here.contacts.len(), there.contacts.len());
        // Risers 0.01 m wide turn by the rounding of their ends.
        assert_same_outcomes(&here, &there);
    }

    #[test]
    fn a_mirrored_scene_has_the_mirrored_outcomes(walker in Walker::any()) {
        let (robot, image) = (Walker::robot(1.0), Walker::robot(-1.0));
        let (profile, height) = (walker.profile(), walker.landed(&robot));
        let mirrored: Vec<[f64; 2]> = profile.iter().rev().map(|[x, z]| [-x, *z]).collect();
        let answer = |robot: &Robot, sign: f64, profile: &[[f64; 2]]| {
            Walker::answer(robot, &walker.state(sign, height, profile, [0.0; 2])).expect("it touches")
        };
        let (one, other) = (answer(&robot, 1.0, &profile), answer(&image, -1.0, &mirrored));
        let flip = |impact: &Impact, sign: f64| -> Vec<Vec<f64>> {
            let of = |v: &Vec<f64>| v.iter().enumerate().map(|(at, v)| if at == 1 { *v } else { sign * v }).collect();
            velocities_after(impact).iter().map(of).collect()
        };
        prop_assert_eq!(one.contacts.len(), other.contacts.len());
        let (a, b) = (sorted(flip(&one, 1.0)), sorted(flip(&other, -1.0)));
        prop_assert_eq!(a.len(), b.len());
        for (a, b) in a.as_slice().concat().iter().zip(b.as_slice().concat()) {
            prop_assert!((a - b).abs() < 1e-10, "{:?} {:?}", velocities_after(&one), velocities_after(&other));
        }
    }
}
