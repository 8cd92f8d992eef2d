//! Painleve's rod, whose lower end slides along the ground, against its closed form: p = 1 + (l/k)^2 cos(theta)
//! (cos(theta) - mu s sin(theta)) and b_n = l omega^2 sin(theta) - g.

use super::{forces, modes, outcomes, rod};
use crate::support::random::Random;
use heelstrike::Impact;
use heelstrike::impact::{Mode, Verdict};
use serde_json::json;

const GRAVITY: f64 = 9.81;

/// A rod with its center ahead of its lower end, at the inclination `theta` \[rad\].
#[derive(Debug, Clone, Copy)]
struct Rod {
    half: f64,
    /// k^2 of the moment m k^2.
    square: f64,
    theta: f64,
    omega: f64,
    friction: f64,
    /// Velocity of the lower end along the ground. If it is backward, friction drives the end into the ground.
    slide: f64,
}

impl Rod {
    fn pressure(&self) -> f64 {
        let (sin, cos) = self.theta.sin_cos();
        let driven = if self.slide < 0.0 { self.friction } else { -self.friction };
        1.0 + self.half * self.half / self.square * cos * (cos - driven * sin)
    }

    fn lift(&self) -> f64 {
        self.half * self.omega * self.omega * self.theta.sin() - GRAVITY
    }

    /// From the center to the lower end.
    fn end(&self) -> [f64; 2] {
        let (sin, cos) = self.theta.sin_cos();
        [-self.half * cos, -self.half * sin]
    }

    fn forces(&self) -> Box<Impact> {
        let [x, z] = self.end();
        let rod = rod(2.0, self.square);
        forces(
            &rod,
            json!({
                "position": {"base": {"z": -z}},
                "velocity": {"base": {"x": self.slide - z * self.omega, "z": x * self.omega, "pitch": self.omega}},
                "contacts": [{"link": "rod", "offset": [x, 0.0, z]}],
                "friction": self.friction,
            }),
        )
    }
}

#[test]
fn rod_is_in_the_region_of_its_closed_form() {
    let mut random = Random::new(3);
    let mut seen = [0; 4];
    for _ in 0..400 {
        let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
        let rod = Rod {
            half: between(0.2, 2.0),
            square: between(0.01, 0.5),
            theta: between(0.05, 1.5),
            omega: between(-8.0, 8.0),
            friction: between(0.0, 4.0),
            slide: between(-1.0, 1.0),
        };
        let found = rod.forces();
        let analysis = found.analysis.as_ref().unwrap();
        let on = vec![if rod.slide < 0.0 { Mode::SlideMinus } else { Mode::SlidePlus }];
        let (pressure, lift) = (rod.pressure(), rod.lift());
        if pressure.abs() < 1e-6 || lift.abs() < 1e-6 {
            continue;
        }
        let (region, expected, verdict) = match (pressure > 0.0, lift > 0.0) {
            (true, true) => (0, vec![vec![Mode::Separate]], Verdict::Unique),
            (true, false) => (1, vec![on.clone()], Verdict::Unique),
            (false, true) => (2, vec![vec![Mode::Separate], on.clone()], Verdict::Ambiguous),
            (false, false) => (3, vec![], Verdict::None),
        };
        seen[region] += 1;
        assert_eq!((modes(&found), analysis.verdict, analysis.proven), (expected, verdict, true), "{rod:?}");
        for outcome in outcomes(&found).iter().filter(|outcome| outcome.modes == on) {
            let force = -2.0 * lift / pressure;
            // The lower end is rounded to f64, which p amplifies where it is near 1e-6.
            assert!((outcome.impulse[0][1] - force).abs() < 1e-9 * force.abs(), "{rod:?} {outcome:?}");
            assert_eq!(outcome.velocity_after[0][1], 0.0);
        }
        // If there are no finite forces, an impact without approach ends the slide.
        let shock =
            found.sustained.unwrap().shock.map(|shock| shock.iter().map(|own| own.modes.clone()).collect::<Vec<_>>());
        assert_eq!(shock, (verdict == Verdict::None).then(|| vec![vec![Mode::Stick]]), "{rod:?}");
    }
    assert!(seen.iter().all(|&count| count > 10), "{seen:?}");
}
