//! What the outcomes of an impact do to the robot, as lists with an entry per outcome.

use heelstrike::impact::Outcome;
use heelstrike::pipeline::Impact;

fn outcomes(impact: &Impact) -> &[Outcome] {
    impact.analysis.as_ref().map_or(&[], |analysis| &analysis.outcomes)
}

/// v after each outcome, in the order of q.
pub fn velocities_after(impact: &Impact) -> Vec<Vec<f64>> {
    outcomes(impact).iter().map(|outcome| outcome.velocity().collect()).collect()
}

/// The impulse on point a of each loop, for each outcome.
pub fn loop_impulses(impact: &Impact) -> Vec<Vec<[f64; 2]>> {
    let components = |outcome: &Outcome| outcome.loop_impulse.iter().flatten().map(|own| own.components()).collect();
    outcomes(impact).iter().map(components).collect()
}
