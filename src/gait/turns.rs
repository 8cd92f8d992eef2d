//! Unwraps angles that a recording gives within one turn only.

use super::clip::{Clock, ClockStep};
use super::{Sample, Sampled};
use crate::robot::{Base, Joint, Robot};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Rounded angles may exceed a turn by this much \[rad\].
const ROUNDED: f64 = 1e-3;

/// Continues the pitch of the base and the angles of joints without limits where they jump by about a turn from one row
/// to the next within \[-pi, pi\] or \[0, 2 pi\]. Whole turns are added to all later rows of the clip.
pub fn unwrapped<'r, S>(
    samples: impl Iterator<Item = Sampled<S>> + 'r,
    robot: &'r Robot,
) -> impl Iterator<Item = Sampled<S>> + 'r {
    let pitch = (robot.base == Base::Floating).then_some(2);
    // A mimic joint with a multiplier that is not whole would be in another pose after a turn.
    let is_whole = |at: usize| {
        let mut followers = robot.mimic_joints.iter().filter(|mimic| mimic.mimicked == at);
        followers.all(|mimic| mimic.joint.axis.is_revolute() && mimic.multiplier.fract() == 0.0)
    };
    let turns = |joint: &Joint| joint.axis.is_revolute() && joint.limits.is_none();
    let joints = robot.joints.iter().enumerate().filter(|(at, joint)| turns(joint) && is_whole(*at));
    let angles: Vec<usize> = pitch.into_iter().chain(joints.map(|(at, _)| robot.base_dofs() + at)).collect();
    let (mut clock, mut before, mut turns) = (Clock::default(), Vec::new(), Vec::new());
    samples.map(move |sampled| {
        let mut sample: Sample<S> = sampled?;
        let given = sample.state.position.clone();
        if clock.step(sample.time) == ClockStep::NewClip {
            before.clone_from(&given);
            turns = vec![0.0; given.len()];
        }
        for &angle in &angles {
            turns[angle] -= jump(before[angle], given[angle]);
            sample.state.position[angle] += TAU * turns[angle];
        }
        before = given;
        Ok(sample)
    })
}

/// Returns the number of turns by which an angle jumps.
fn jump(before: f64, now: f64) -> f64 {
    let within =
        |least: f64, most: f64| [before, now].iter().all(|angle| (least - ROUNDED..=most + ROUNDED).contains(angle));
    let turns = ((now - before) / TAU).round();
    let is_wrapped = (within(-PI, PI) || within(0.0, TAU)) && (now - before - TAU * turns).abs() <= FRAC_PI_2;
    if is_wrapped { turns } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_ends_of_one_turn_are_jumped_over() {
        for (before, now, turns) in [
            (3.1, -3.1, -1.0),
            (-3.0, 3.1, 1.0),
            (0.1, 6.2, 1.0),
            (6.2, 0.2, -1.0),
            (3.1, 3.2, 0.0),
            (4.0, -2.2, 0.0),
            (-2.0, 2.0, 0.0),
            (0.0, 4.0, 0.0),
            (100.0, 106.2, 0.0),
        ] {
            assert_eq!(jump(before, now), turns, "{before} {now}");
        }
    }
}
