//! The map of the example `compliant_map`: the outcomes that overdamped contact of the minimalistic biped ends at.

#[path = "../../examples/compliant_map/map.rs"]
mod map;

use heelstrike::impact::{Friction, Mode};
use map::Biped;

#[test]
fn separatrix_matches_other_integrators() {
    // (d_t / d_n, speed \[m/s\] at the separatrix), computed beforehand with other integrators to two digits.
    let infinite = [(1.0, 0.80), (10.0, 0.43), (100.0, 0.056), (1000.0, 0.006)];
    let finite = [(1.0, 0.80), (10.0, 0.64), (100.0, 0.23), (1000.0, 0.17)];
    for (friction, expected) in [(Friction::Infinite, infinite), (Friction::Finite(10.0), finite)] {
        let biped = Biped::new(friction).expect("a run");
        for (ratio, speed) in expected {
            let found = biped.separatrix(ratio, 1.0).expect("a run").expect("a run");
            // Half a unit of the last digit, and 1e-4 m/s of the bisection.
            let unit = if speed < 0.1 { 0.001 } else { 0.01 };
            assert!((found - speed).abs() <= 0.5 * unit + 1e-4, "{friction} {ratio}: {found}");
        }
    }
}

#[test]
fn runs_end_at_lift_off_or_stop() {
    let map = Biped::new(Friction::Infinite).expect("a run").map(11, 9).expect("a run");
    assert_eq!((map.runs().count(), map.separatrix.len()), (99, 9));
    assert_eq!(map.near_negative_index(0.01).count(), 0);
    for (speed, ratio, cell) in map.runs() {
        assert_eq!(cell.index, Some(1), "{speed} {ratio} {cell:?}");
    }
    // Above 0.75 m/s the stop is the only rigid outcome; ground with little tangential damping does not end near it.
    assert!(map.runs().any(|(speed, _, cell)| speed > 0.75 && cell.distance > 0.5));
    let ends = |mode| map.runs().filter(|(_, _, cell)| cell.modes.first() == Some(&mode)).count();
    assert!(ends(Mode::Separate) > 10 && ends(Mode::Stick) > 10);
}
