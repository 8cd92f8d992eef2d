//! Infinite friction has no cone to test: the pair (a, b) = (1, 0) of a L_n >= b |L_t| asks for pressure alone. No
//! unreduced computation would be another; a huge finite coefficient must lead to the same modes.

use heelstrike::reductions::Reductions;
use proptest::prelude::*;
use serde_json::json;

use super::comparison::{answer, floating};
use super::trees::case;

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn huge_friction_leads_to_the_modes_of_infinite_friction(case in case()) {
        let robot = floating(&case.mechanism.urdf(0), Reductions::ALL);
        let outcomes = |friction| {
            let mut state = case.state(0);
            // Two contacts of one link may be pressed together without bound, which no finite friction allows.
            state["contacts"].as_array_mut().expect("a list").truncate(1);
            state["friction"] = friction;
            let analysis = answer(&robot, &state, Reductions::ALL).expect("an answer").analysis.expect("outcomes");
            let mut modes: Vec<_> = analysis.outcomes.iter().map(|outcome| outcome.modes.clone()).collect();
            modes.sort();
            modes
        };
        prop_assert_eq!(outcomes(json!("infinite")), outcomes(json!(1e12)));
    }
}
