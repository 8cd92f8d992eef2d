//! The direction that pictures call forward, and the mirroring of pictures for robots that walk along -x.

use crate::impact::{Explanation, mirrored};
use crate::planar::{Pair, Vector};
use crate::sweep::{Findings, Regime, RegionCurves, Transition};
use crate::{Mode, Outcome};
use std::sync::Arc;

/// The direction along x that is called forward and drawn to the right.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Forward {
    /// Along +x, as in all input and output.
    #[default]
    Along,
    /// Along -x: pictures are mirrored, and the names of sliding forward and sliding backward are swapped.
    Against,
}

impl Forward {
    /// Returns the text that a title ends with; it is empty if nothing is mirrored.
    pub(super) fn remark(self) -> &'static str {
        match self {
            Self::Along => "",
            Self::Against => " (mirrored: forward is \u{2212}x)",
        }
    }

    fn modes(modes: &mut [Mode]) {
        modes.iter_mut().for_each(|mode| *mode = mode.mirrored());
    }

    fn pairs(pairs: &mut [Pair<f64>]) {
        pairs.iter_mut().for_each(|[t, _]| *t = 0.0 - *t);
    }

    pub(super) fn vector(vector: &mut Vector<f64>) {
        vector.x = 0.0 - vector.x;
    }

    pub(super) fn outcomes(self, outcomes: &mut [Outcome]) {
        for outcome in outcomes.iter_mut().filter(|_| self == Self::Against) {
            Self::modes(&mut outcome.modes);
            Self::pairs(&mut outcome.impulse);
            Self::pairs(&mut outcome.velocity_after);
        }
    }

    pub(super) fn findings(self, found: &Findings) -> Findings {
        let mut found = found.clone();
        if self == Self::Along {
            return found;
        }
        let regime = |regime: &mut Arc<Regime>| {
            if let Regime::Answered { outcomes, undecided, .. } = Arc::make_mut(regime) {
                outcomes.iter_mut().chain(undecided).for_each(|modes| Self::modes(modes));
            }
        };
        let transition = |transition: &mut Transition| {
            transition.ended.iter_mut().for_each(|ended| Self::modes(&mut ended.modes));
        };
        match &mut found {
            Findings::Along(survey) => {
                survey.regions.iter_mut().for_each(|region| regime(&mut region.regime));
                survey.borders.iter_mut().for_each(|border| transition(&mut border.transition));
            }
            Findings::Map(map) => {
                map.areas.iter_mut().for_each(|area| regime(&mut area.regime));
                map.curves.iter_mut().for_each(|curve| transition(&mut curve.transition));
            }
        }
        found
    }

    pub(super) fn curves(self, curves: &mut [RegionCurves]) {
        for place in curves.iter_mut().flat_map(|curve| &mut curve.places).filter(|_| self == Self::Against) {
            for (modes, motion) in &mut place.outcomes {
                Self::modes(modes);
                Self::pairs(&mut motion.impulse);
                Self::pairs(&mut motion.velocity_after);
            }
            if let Some(Explanation { beta, gamma, .. }) = &mut place.explanation {
                beta.iter_mut().for_each(|beta| *beta = -*beta);
                gamma.iter_mut().for_each(|gamma| *gamma = mirrored(*gamma));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Keyframe;
    use crate::state::State;
    use crate::{Defaults, Options, Pipeline, Robot};

    #[test]
    fn a_mirrored_robot_is_where_the_mirror_has_it() {
        let robot = Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).unwrap();
        let state = include_str!("../../examples/ramone.json");
        let state = State::from_json(state, &robot, &Defaults::default()).unwrap();
        let impact = Pipeline::new(&robot, Options::default()).impact(&state).unwrap();
        let ahead = Keyframe::of_impact(&robot, &[], &state, &impact);
        let mut behind = ahead.clone();
        behind.face(Forward::Against);
        let [ahead, behind] = [ahead, behind].map(|keyframe| (keyframe.drawing.unwrap(), keyframe.answer.unwrap()));
        let seen = |at: Vector| Vector::new(-at.x, at.z);
        for (a, b) in ahead.0.bodies.iter().zip(&behind.0.bodies) {
            let (a, b) = (a.world(a.com.unwrap()), b.world(b.com.unwrap()));
            assert!((seen(a) - b).length() < 1e-15, "{a:?} {b:?}");
        }
        assert_eq!(seen(ahead.0.outcomes[0].impulse[1]), behind.0.outcomes[0].impulse[1]);
        assert_eq!(ahead.1.outcomes[0].modes, [Mode::SlidePlus, Mode::Stick]);
        assert_eq!(behind.1.outcomes[0].modes, [Mode::SlideMinus, Mode::Stick]);
    }
}
