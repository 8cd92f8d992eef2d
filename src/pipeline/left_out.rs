//! Parts of one scene that do not enter its analysis; those of the robot's file are in [`Robot`](crate::Robot).

use super::Pipeline;
use crate::law::{Friction, Law};
use crate::state::Scene;

/// Something that this scene does not need.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum LeftOut {
    /// The column of a joint that keeps its rate (an index into [`Robot::joints`](crate::Robot)).
    Column(usize),
    /// This many collision shapes, which are too high to reach the ground.
    OutOfReach(usize),
    /// This many collision shapes, because contacts are named by hand.
    NotAsked(usize),
    /// The tangential impulses of these contacts, which have no friction.
    Tangential(Vec<usize>),
    /// The friction cones of these contacts, whose friction is infinite.
    Cone(Vec<usize>),
}

impl Pipeline<'_> {
    /// Lists what a scene leaves out; `out_of_reach` is how many shapes are too far from the ground.
    pub(super) fn left_out(&self, scene: &Scene, laws: &[Law], out_of_reach: usize) -> Vec<LeftOut> {
        let mut all = Vec::new();
        if self.options.reductions.held {
            all.extend(scene.held.iter().map(|&joint| LeftOut::Column(joint)));
        }
        let shapes = self.feet.iter().count();
        match scene.contacts {
            Some(_) if shapes > 0 => all.push(LeftOut::NotAsked(shapes)),
            None if out_of_reach > 0 => all.push(LeftOut::OutOfReach(out_of_reach)),
            _ => {}
        }
        let with = |wanted: Law| (0..laws.len()).filter(|&at| laws[at] == wanted).collect::<Vec<_>>();
        let [none, infinite] = [Friction::ZERO, Friction::Infinite].map(|friction| with(friction.into()));
        if self.options.reductions.frictionless && !none.is_empty() {
            all.push(LeftOut::Tangential(none));
        }
        if !infinite.is_empty() {
            all.push(LeftOut::Cone(infinite));
        }
        all
    }
}
