//! Random trees with fixed joints, massless links, joints that leave the plane or are braked, shapes high above the
//! ground, and one contact or several with all kinds of friction.

use heelstrike::pipeline::Impact;
use heelstrike::reductions::Reductions;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use serde_json::{Value, json};

use super::comparison::{FEWER, answer, difference, floating, largest_rate};
use crate::constraints::assert_struck;
use crate::support::impact::{modes, outcomes};
use crate::support::mechanism::{Link, Mechanism, Point, mechanism, motion};
use crate::support::scaled::{largest, near};
use std::collections::BTreeSet;

/// A mechanism with a motion, contacts and frictions.
#[derive(Debug, Clone)]
pub struct Case {
    pub mechanism: Mechanism,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub contacts: Vec<(usize, Point, f64)>,
    pub friction: Vec<Value>,
    pub held: BTreeSet<usize>,
}

fn friction() -> impl Strategy<Value = Value> {
    prop_oneof![Just(json!(0.0)), Just(json!("infinite")), (0.1..2.0f64).prop_map(|mu| json!(mu))]
}

/// A random case.
pub fn case() -> impl Strategy<Value = Case> {
    mechanism().prop_flat_map(|mechanism| {
        let links = mechanism.links.len();
        let point = (0..links, prop::array::uniform2(-0.5..0.5f64), prop_oneof![Just(0.0), 0.01..0.1f64]);
        let numbers = (motion(links - 1, 1.0, 1.5), motion(links - 1, 1.0, 2.0));
        let contacts = prop::collection::vec(point, 1..4);
        let friction = prop::collection::vec(friction(), links);
        let held = prop::collection::vec(1..links, 0..3);
        (Just(mechanism), numbers, contacts, friction, held).prop_map(
            |(mechanism, (q, v), contacts, friction, held)| {
                let held = held.into_iter().filter(|&link| mechanism.links[link].moves()).collect();
                Case { mechanism, q, v, contacts, friction, held }
            },
        )
    })
}

impl Case {
    /// The state for the URDF with this root, with contacts named by hand.
    pub fn state(&self, root: usize) -> Value {
        let mut state = self.mechanism.state(root, &self.q, &self.v, &self.contacts);
        let name = |link: usize| self.mechanism.links[link].name.clone();
        state["friction"] = self.friction.iter().enumerate().map(|(link, mu)| (name(link), mu.clone())).collect();
        state["held"] = self.held.iter().map(|&link| name(link)).collect();
        state
    }

    /// The robot's coordinates among those of all joints.
    fn moving(&self) -> Vec<usize> {
        (0..self.q.len()).filter(|&k| k < 3 || self.mechanism.links[k - 2].moves()).collect()
    }

    /// The same state with its lowest sphere on the ground, whose contact is then detected; `None` without spheres.
    fn landing(&self) -> Option<Value> {
        let links = self.mechanism.links.iter().enumerate();
        let heights = links.flat_map(|(link, own)| {
            let height = move |&(center, radius)| self.mechanism.point(&self.q, link, center)[1] - radius;
            own.spheres.iter().map(height)
        });
        let lowest = heights.min_by(f64::total_cmp)?;
        let mut state = self.state(0);
        state.as_object_mut().expect("an object").remove("contacts");
        state["position"]["base"]["z"] = json!(self.q[1] - lowest);
        Some(state)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, ..ProptestConfig::default() })]

    #[test]
    fn nothing_depends_on_what_is_left_out(case in case()) {
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

    /// M, J and G against sums over the bodies by velocities of points, without recursion.
    #[test]
    fn matrices_are_sums_over_the_bodies(mut case in case()) {
        case.held.clear();
        case.contacts.iter_mut().for_each(|(.., radius)| *radius = 0.0);
        // The file has no inertia for links without mass.
        case.mechanism.links.iter_mut().filter(|link| link.mass == 0.0).for_each(|link| link.moment = 0.0);
        let moving = case.moving();
        let Case { mechanism, q, v, contacts, .. } = &case;
        let rates = contacts.iter().map(|&(link, [x, z], _)| {
            let Link { name, place, .. } = &mechanism.links[link];
            mechanism.point_rates(q, name, [x - place[0], z - place[1]]).select_columns(&moving)
        });
        let rates: Vec<_> = rates.collect();
        let jacobian = DMatrix::from_fn(2 * rates.len(), moving.len(), |i, j| rates[i / 2][(i % 2, j)]);
        let mass = mechanism.mass_matrix(q).select_rows(&moving).select_columns(&moving);
        let v = DVector::from_fn(moving.len(), |k, _| v[moving[k]]);
        let robot = floating(&mechanism.urdf(0), Reductions::ALL);
        let found = answer(&robot, &case.state(0), Reductions::ALL).expect("an answer");
        assert_struck(&found, &mass, &jacobian, &v, 1e6);
    }

    /// Units change by powers of two, which change no digit of the numbers given.
    #[test]
    fn units_change_no_outcome(case in case(), exponents in prop::array::uniform3(prop_oneof![Just(0), Just(20), Just(-20)])) {
        let [mass, length, time] = exponents.map(|exponent| f64::exp2(f64::from(exponent)));
        let mut scaled = Case { mechanism: case.mechanism.in_units(mass, length), ..case.clone() };
        for (_, point, radius) in &mut scaled.contacts {
            (*point, *radius) = (point.map(|entry| entry * length), *radius * length);
        }
        let units_of_q = case.mechanism.units_of_coordinates(length);
        scaled.q.iter_mut().zip(&units_of_q).for_each(|(q, unit)| *q *= unit);
        scaled.v.iter_mut().zip(&units_of_q).for_each(|(v, unit)| *v *= unit / time);
        let [one, other] = [&case, &scaled].map(|case| {
            let robot = floating(&case.mechanism.urdf(0), Reductions::ALL);
            answer(&robot, &case.state(0), Reductions::ALL).expect("an answer")
        });
        let verdict = |impact: &Impact| impact.analysis.as_ref().map(|own| (own.verdict, own.proven, own.index_sum));
        prop_assert_eq!(verdict(&one), verdict(&other));
        prop_assert_eq!(modes(&one), modes(&other));
        for (one, other) in outcomes(&one).iter().zip(outcomes(&other)) {
            prop_assert_eq!(one.index, other.index);
            let energy = mass * length * length / time / time;
            let own: Vec<f64> = one.velocity().collect();
            let units = case.moving().into_iter().map(|k| units_of_q[k] / time);
            let found: Vec<f64> = other.velocity().zip(units).map(|(rate, unit)| rate / unit).collect();
            // If all stops, only rounding of the motion before is left.
            let size = largest(&own).max(largest(&case.v));
            prop_assert!(near(&found, &own, 1e-12 * size), "{found:?} {own:?}");
            for (own, unit, found) in [
                (one.impulse.concat(), mass * length / time, other.impulse.concat()),
                (one.velocity_after.concat(), length / time, other.velocity_after.concat()),
                (vec![one.energy_loss], energy, vec![other.energy_loss]),
                (one.margin.into_iter().collect(), 1.0, other.margin.into_iter().collect()),
            ] {
                let own: Vec<f64> = own.iter().map(|entry| entry * unit).collect();
                // The promised 1e-10 only: which decimals a state has depends on its units.
                prop_assert!(near(&found, &own, 1e-10 * largest(&own)), "{found:?} {own:?}");
            }
        }
    }

    #[test]
    fn held_joints_and_loops_are_eliminated_together(
        mut case in case(),
        links in prop::array::uniform2(any::<prop::sample::Index>()),
        point in prop::array::uniform2(-0.5..0.5f64),
    ) {
        // All joints at rest, so that no loop opens.
        case.v[3..].fill(0.0);
        let [link, other] = links.map(|link| link.index(case.mechanism.links.len()));
        let mut state = case.state(0);
        state["loops"] = json!([case.mechanism.meeting(0, &case.q, (link, point), other)]);
        let urdf = case.mechanism.urdf(0);
        let one = answer(&floating(&urdf, Reductions::ALL), &state, Reductions::ALL).expect("an answer");
        // Only reductions that leave the robot's f64 numbers as they are: with a loop a state may be on a border, where
        // another rounding leads to other modes.
        let reductions = Reductions { weld: true, massless: true, ..Reductions::NONE };
        let other = answer(&floating(&urdf, Reductions::ALL), &state, reductions).expect("an answer");
        prop_assert_eq!(difference(&one, &other, Some(largest_rate(&state))), Ok(()), "{}", state);
    }

    /// The choice of the root changes nothing.
    #[test]
    fn every_link_may_be_the_root(case in case()) {
        let answer = |root: usize| {
            let robot = floating(&case.mechanism.urdf(root), Reductions::ALL);
            answer(&robot, &case.state(root), Reductions::ALL).expect("an answer")
        };
        let one = answer(0);
        for root in 1..case.mechanism.links.len() {
            let other = answer(root);
            for (a, b) in one.contacts.iter().zip(&other.contacts) {
                // Tolerance: sums of a few lengths of order one.
                prop_assert!((a.point - b.point).length() < 1e-13 * 16.0, "root {root}: {:?} and {:?}", a.point, b.point);
            }
            prop_assert_eq!(difference(&one, &other, None), Ok(()), "root {}\n{}", root, case.state(root));
        }
    }
}
