//! Which link is the root is a matter of writing: another one changes no outcome.

use heelstrike::reductions::Reductions;
use proptest::prelude::*;

use super::comparison::{answer, difference, floating};
use super::trees::case;

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn every_link_may_be_the_root(case in case()) {
        let answer = |root: usize| {
            let robot = floating(&case.mechanism.urdf(root), Reductions::ALL);
            answer(&robot, &case.state(root), Reductions::ALL).expect("an answer")
        };
        let one = answer(0);
        for root in 1..case.mechanism.links.len() {
            let other = answer(root);
            let places = |impact: &heelstrike::pipeline::Impact| impact.contacts.iter().flat_map(|own| own.point.components()).collect::<Vec<_>>();
            for (a, b) in places(&one).into_iter().zip(places(&other)) {
                // Sums of a few lengths of order one.
                prop_assert!((a - b).abs() < 1e-13 * 16.0, "root {root}: points {a} and {b}");
            }
            prop_assert_eq!(difference(&one, &other, None), Ok(()), "root {}\n{}", root, case.state(root));
        }
    }
}
