//! Compliant contact next to the rigid impact.
//!
//! Most simulators press a robot's feet into a ground of springs and dampers and integrate through the impact. In
//! general the end of the integration is not a rigid outcome. It depends on the damping and on the ratios of tangential
//! to normal parameters, but, while the configuration is frozen, not on the stiffness.

mod integrate;
mod ground;
mod frozen;
mod moving;
mod comparison;

pub use comparison::{
    ByStiffness, ByTolerance, Comparison, Group, NEAR, NearestOutcome, Target, compare, distance, landing,
};
pub use frozen::{CompliantRun, TOLERANCE, run};
pub use ground::{GREATEST_FRICTION, SoftGround};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accuracy::robots;
    use crate::impact::{ContactProblem, ListedRejections, analyze};
    use crate::law::Friction;
    use crate::pipeline::Options;
    use crate::state::{Defaults, State};

    #[test]
    fn mass_on_spring_leaves_as_in_the_textbook() {
        // m x'' + d x' + k x = 0 from x = 0 lifts off, without tension, when its acceleration vanishes, at the speed
        // exp(-zeta phi / sqrt(1 - zeta^2)), phi = acos(2 zeta^2 - 1) for zeta < 1 (Brogliato 2016, section 2.1.3).
        let problem =
            ContactProblem::new(vec![0.5, 0.0, 0.0, 0.5], vec![[0.0, -3.0]], vec![Friction::ZERO], vec![0.0]).unwrap();
        for zeta in [0.05f64, 0.3, 0.8] {
            let ground = SoftGround { damping_ratio: zeta, stiffness_ratio: 1.0, tangential_damping: 1.0 };
            let run = run(&problem, ground, TOLERANCE).unwrap();
            let root = (1.0 - zeta * zeta).sqrt();
            let phase = (2.0 * zeta * root).atan2(2.0 * zeta * zeta - 1.0);
            let expected = 3.0 * (-zeta * phase / root).exp();
            assert!(run.ended);
            // The kink at lift-off costs some of the tolerance's ten digits.
            assert!((run.velocity_after[0][1] - expected).abs() < 1e-6, "{zeta}: {run:?} {expected}");
        }
    }

    #[test]
    fn one_overdamped_contact_with_much_friction_stops() {
        let problem =
            ContactProblem::new(vec![2.0, 1.0, 1.0, 2.0], vec![[0.5, -1.0]], vec![Friction::Infinite], vec![0.0])
                .unwrap();
        let ground = SoftGround { damping_ratio: f64::INFINITY, stiffness_ratio: 1.0, tangential_damping: 1.0 };
        let run = run(&problem, ground, TOLERANCE).unwrap();
        let outcome = &analyze(&problem, ListedRejections::Nothing).unwrap().outcomes[0];
        for (found, expected) in run.impulse.iter().flatten().zip(outcome.impulse.iter().flatten()) {
            assert!((found - expected).abs() < 1e-8, "{run:?} {outcome:?}");
        }
    }

    #[test]
    fn rest_stays_and_many_contacts_are_refused() {
        let ground = SoftGround { damping_ratio: 1.0, stiffness_ratio: 1.0, tangential_damping: 1.0 };
        let still = |contacts: usize| {
            let unit =
                (0..4 * contacts * contacts).map(|at| f64::from(u8::from(at % (2 * contacts + 1) == 0))).collect();
            ContactProblem::new(unit, vec![[0.0; 2]; contacts], vec![Friction::ZERO; contacts], vec![0.0; contacts])
                .unwrap()
        };
        assert_eq!(run(&still(1), ground, TOLERANCE).unwrap().impulse, [[0.0; 2]]);
        assert!(run(&still(11), ground, TOLERANCE).is_err());
    }

    #[test]
    fn a_ground_without_dampers_is_refused() {
        let problem =
            ContactProblem::new(vec![2.0, 1.0, 1.0, 2.0], vec![[0.5, -1.0]], vec![Friction::Infinite], vec![0.0])
                .unwrap();
        for (ratios, refused) in [
            ([0.0, 1.0, 1.0], "damping_ratio must be greater than 0, not 0"),
            ([f64::NAN, 1.0, 1.0], "damping_ratio must be greater than 0, not NaN"),
            ([1.0, -1.0, 1.0], "stiffness_ratio must be 0 or more, not -1"),
            ([1.0, 1.0, 0.0], "tangential_damping must be greater than 0, not 0"),
            ([1.0, 1.0, f64::INFINITY], "tangential_damping must be a finite number, not inf"),
        ] {
            let [damping_ratio, stiffness_ratio, tangential_damping] = ratios;
            let ground = SoftGround { damping_ratio, stiffness_ratio, tangential_damping };
            assert_eq!(run(&problem, ground, TOLERANCE).unwrap_err().to_string(), refused);
        }
    }

    #[test]
    fn moving_biped_converges_to_the_frozen_one() {
        let robot = robots::minimalistic().unwrap();
        let state = include_str!("../../../examples/minimalistic.json");
        let state = State::from_json(state, &robot, &Defaults::default()).unwrap();
        let comparison = compare(&robot, &state, &Options::default()).unwrap().unwrap();

        let changes: Vec<f64> = comparison.stiffnesses.iter().filter_map(|row| row.change).collect();
        assert_eq!(changes.len(), 5);
        for pair in changes.windows(2).skip(1) {
            // A stiffness greater by a factor of 100 reduces the change to a tenth.
            assert!((pair[0] / pair[1] - 10.0).abs() < 0.5, "{changes:?}");
        }
        // Every setting ends nearest to lift-off, and the nearer, the more damping it has. The medians 0.5, 0.14, 0.04
        // and 0.01 were measured beforehand over other ratios.
        let medians: Vec<f64> = comparison.groups[1..7].iter().map(|group| group.distance[1]).collect();
        for (found, expected) in medians.iter().zip([0.5, 0.4, 0.14, 0.04, 0.01, 0.0]) {
            assert!((found - expected).abs() < 0.05, "{medians:?}");
        }
        assert_eq!((comparison.unsettled, &comparison.groups[0].nearest), (0, &vec![72, 0, 0]));
        let index = |at: usize| comparison.outcomes[at].index;
        assert_eq!([index(0), index(1), index(2)], [Some(1), Some(1), Some(-1)]);
    }
}
