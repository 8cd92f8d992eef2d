//! Random trees with fixed joints, massless links, joints that leave the plane or are held, shapes high above the
//! ground, and one contact or several with all kinds of friction.

use heelstrike::reductions::Reductions;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::comparison::{FEWER, answer, difference, floating, largest_rate};
use crate::support::mechanism::{Mechanism, Motion, Point, mechanism, motion};

/// A mechanism on its way to the ground.
#[derive(Debug, Clone)]
pub struct Case {
    pub mechanism: Mechanism,
    pub position: Motion,
    pub velocity: Motion,
    pub contacts: Vec<(usize, Point, f64)>,
    pub friction: Vec<Value>,
    pub held: Vec<usize>,
}

fn friction() -> impl Strategy<Value = Value> {
    prop_oneof![Just(json!(0.0)), Just(json!("infinite")), (0.1..2.0f64).prop_map(|mu| json!(mu))]
}

/// A mechanism, a motion, contacts and friction by link.
pub fn case() -> impl Strategy<Value = Case> {
    mechanism().prop_flat_map(|mechanism| {
        let (links, joints) = (mechanism.links.len(), mechanism.joints.len());
        let point = (0..links, prop::array::uniform2(-0.5..0.5f64), prop_oneof![Just(0.0), 0.01..0.1f64]);
        (
            Just(mechanism),
            motion(joints, 1.0, 1.5),
            motion(joints, 1.0, 2.0),
            prop::collection::vec(point, 1..4),
            prop::collection::vec(friction(), links),
            prop::collection::vec(0..joints, 0..3),
        )
            .prop_map(|(mechanism, position, velocity, contacts, friction, mut held)| {
                held.retain(|&joint| mechanism.moves(joint));
                held.dedup();
                Case { mechanism, position, velocity, contacts, friction, held }
            })
    })
}

impl Case {
    /// The state for the URDF with this root, with contacts named by hand.
    pub fn state(&self, root: usize) -> Value {
        let mut state = self.mechanism.state(root, &self.position, &self.velocity, &self.contacts);
        let fields = state.as_object_mut().expect("an object");
        let friction = self.friction.iter().enumerate().map(|(link, mu)| (format!("link{link}"), mu.clone()));
        fields.insert("friction".into(), Value::Object(friction.collect()));
        let mut held: Vec<String> = self.held.iter().map(|joint| format!("joint{joint}")).collect();
        held.sort();
        held.dedup();
        fields.insert("held".into(), json!(held));
        state
    }

    /// The same state over ground at the height of its lowest sphere, whose link is then found to touch.
    fn landing(&self) -> Option<Value> {
        let height = |link: usize, (centre, radius): (Point, f64)| {
            self.mechanism.point(&self.position, &self.velocity, link, centre)[0][1] - radius
        };
        let spheres = self.mechanism.links.iter().enumerate();
        let heights = spheres.flat_map(|(link, own)| own.spheres.iter().map(move |&sphere| height(link, sphere)));
        let lowest = heights.min_by(f64::total_cmp)?;
        let mut state = self.state(0);
        state.as_object_mut().expect("an object").remove("contacts");
        let z = &mut state["position"]["base"]["z"];
        *z = json!(z.as_f64().expect("a number") - lowest);
        Some(state)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn nothing_hangs_on_what_is_left_out(case in case()) {
        let urdf = case.mechanism.urdf(0);
        let reduced = floating(&urdf, Reductions::ALL);
        for state in [Some(case.state(0)), case.landing()].into_iter().flatten() {
            let one = answer(&reduced, &state, Reductions::ALL).expect("an answer");
            for reductions in FEWER {
                let other = answer(&floating(&urdf, reductions), &state, reductions).expect("an answer");
                prop_assert_eq!(difference(&one, &other, Some(largest_rate(&state))), Ok(()), "{:?}\n{}", reductions, state);
            }
        }
    }

    #[test]
    fn held_joints_and_loops_are_eliminated_together(
        case in case(),
        links in prop::array::uniform2(any::<prop::sample::Index>()),
        point in prop::array::uniform2(-0.5..0.5f64),
    ) {
        // All joints at rest, so that no loop opens.
        let mut case = case;
        case.velocity.joints.fill(0.0);
        let [link, other] = links.map(|link| link.index(case.mechanism.links.len()));
        let mut state = case.state(0);
        state["loops"] = json!([case.mechanism.meeting(0, &case.position, (link, point), other)]);
        let urdf = case.mechanism.urdf(0);
        let one = answer(&floating(&urdf, Reductions::ALL), &state, Reductions::ALL).expect("an answer");
        // The same f64 numbers of the robot: what a loop holds may lie on a border, where one rounding leads to other
        // modes.
        let reductions = Reductions { weld: true, massless: true, ..Reductions::NONE };
        let other = answer(&floating(&urdf, Reductions::ALL), &state, reductions).expect("an answer");
        prop_assert_eq!(difference(&one, &other, Some(largest_rate(&state))), Ok(()), "{}", state);
    }
}
