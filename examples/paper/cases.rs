//! Checks claims against the outcomes and the rejected combinations of one state.

use super::along::Modes;
use super::exhibit::Found;
use super::figures::Finding;
use heelstrike::impact::Mode;
use heelstrike::planar::Pair;

fn name(modes: &[Mode]) -> String {
    modes.iter().map(ToString::to_string).collect::<Vec<_>>().join("/")
}

/// Checks that the outcomes are these.
pub fn outcomes(found: &Found, expected: &[Modes]) -> Result<Finding, String> {
    let outcomes: Vec<String> = found.analysis()?.outcomes.iter().map(|outcome| name(&outcome.modes)).collect();
    Ok(Finding { agrees: Some(outcomes == expected), words: outcomes.join(" or ") })
}

/// One of the paper's cases with velocity after \[m/s\] and impulse \[N s\] of the trailing foot, each tangential and
/// normal.
pub type Case = (Modes, Pair<f64>, Pair<f64>);

/// Checks that the cases have these numbers in units of `unit`, to one in the last of three digits, and that `valid` is
/// the only outcome.
pub fn cases(found: &Found, unit: f64, expected: &[Case], valid: Modes) -> Result<Finding, String> {
    const LAST_DIGIT: f64 = 1e-3;
    let analysis = found.analysis()?;
    let outcomes = analysis.outcomes.iter().map(|outcome| {
        (name(&outcome.modes), outcome.velocity_after.first().copied(), outcome.impulse.first().copied())
    });
    let rejected = analysis.rejected.iter().filter_map(|rejection| {
        let motion = rejection.motion.as_ref()?;
        Some((name(&rejection.modes), motion.velocity_after.first().copied(), motion.impulse.first().copied()))
    });
    let all: Vec<_> = outcomes.chain(rejected).collect();
    let mut agrees = matches!(&analysis.outcomes[..], [only] if name(&only.modes) == valid);
    let mut words = Vec::new();
    for (modes, velocity, impulse) in expected {
        let of_case = all.iter().find(|(listed, ..)| listed == modes);
        let Some((_, Some(c), Some(l))) = of_case else { return Err(format!("{modes} has no numbers")) };
        let [c, l] = [c, l].map(|vector| vector.map(|value| value / unit));
        let near = |is: Pair<f64>, printed: &Pair<f64>| {
            is.iter().zip(printed).all(|(is, printed)| (is - printed).abs() <= LAST_DIGIT)
        };
        agrees &= near(c, velocity) && near(l, impulse);
        words.push(format!("{modes} c = ({:.3}, {:.3}), L = ({:.3}, {:.3})", c[0], c[1], l[0], l[1]));
    }
    Ok(Finding { words: words.join("; "), agrees: Some(agrees) })
}
