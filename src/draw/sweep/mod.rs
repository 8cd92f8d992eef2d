//! Pictures of studies.
//!
//! ```text
//!     Survey --> RegionCurves --[along]---------> velocities after and impulses of each contact, regions shaded
//!                             --[angles, place]-> beta and gamma, and the regions between them
//!     Map    --[map, place]---------------------> areas with letters in the plane of two parameters
//! ```

mod place;
mod angles;
mod along;
mod map;

use crate::draw::Forward;
use crate::draw::plot::{Color, Picture, PlotAxis};
use crate::sweep::{Findings, Map, Regime, Region, RegionCurves, RobotStudy, Survey, Workers};
use crate::write::sweep::Happening;
use crate::write::words::grouped;
use std::hash::Hash;

/// The width of panels along a parameter, inside their axes \[px\].
const WIDTH: f64 = 540.0;

/// Returns the picture of the findings of `model`. Reports [`work`] pieces of work to `workers`.
pub fn of(model: &RobotStudy, findings: &Findings, forward: Forward, workers: Workers) -> Picture {
    let names: Vec<String> = model.study.parameters().iter().map(|known| with_greek_letters(&known.name)).collect();
    let title = format!("{} against {}{}", model.robot.name, names.join(" and "), forward.remark());
    let mut curves = match findings {
        Findings::Along(survey) => RegionCurves::of(model, survey, workers),
        Findings::Map(_) => Vec::new(),
    };
    forward.curves(&mut curves);
    let picture = match forward.findings(findings) {
        Findings::Along(survey) => along::picture(axis(model, 0), model.study.question(), &survey, &curves),
        Findings::Map(map) => map::picture([axis(model, 0), axis(model, 1)], model.study.question(), &map),
    };
    Picture { title, ..picture }
}

/// Returns the number of pieces of work for the picture of the findings.
pub fn work(model: &RobotStudy, findings: &Findings) -> usize {
    match findings {
        Findings::Along(survey) => RegionCurves::work(model, survey),
        Findings::Map(_) => 0,
    }
}

fn axis(model: &RobotStudy, parameter: usize) -> PlotAxis {
    let Some(known) = model.study.parameters().get(parameter) else { return PlotAxis::default() };
    let name = with_greek_letters(&known.name);
    let label = model.unit(parameter).map_or(name.clone(), |unit| format!("{name} [{unit}]"));
    PlotAxis { range: Some((known.from, known.to)), ..PlotAxis::new(label) }
}

/// Replaces the names of Greek letters in a name by the letters: `delta_alpha` becomes δ_α.
fn with_greek_letters(name: &str) -> String {
    const NAMES: [&str; 24] = [
        "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu",
        "xi", "omicron", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
    ];
    let letter = |part: &str| "αβγδεζηθικλμνξοπρστυφχψω".chars().nth(NAMES.iter().position(|name| *name == part)?);
    let part = |part: &str| letter(part).map_or(part.to_owned(), |letter| letter.to_string());
    name.split('_').map(part).collect::<Vec<_>>().join("_")
}

/// The letter, the color and the outcomes of a kind of region.
struct KindLook<'a> {
    letter: String,
    color: Color,
    happening: Happening<'a>,
}

/// Returns each thing once, in the order of first occurrence.
pub(in crate::draw) fn different<T: Clone + Eq + Hash>(things: impl Iterator<Item = T>) -> Vec<T> {
    grouped(things.map(|thing| (thing, ()))).into_iter().map(|(thing, _)| thing).collect()
}

/// Returns whether a region is at least a pixel wide in a panel of full width, so that lines in it are visible.
fn is_seen(region: &Region, survey: &Survey) -> bool {
    let range: f64 = survey.regions.iter().map(|region| region.to - region.from).sum();
    WIDTH * (region.to - region.from) >= range
}

/// Returns the first region of every kind along a parameter, in the order of letters.
fn firsts(survey: &Survey) -> Vec<&Region> {
    grouped(survey.regions.iter().map(|region| (region.kind, region))).into_iter().map(|(_, alike)| alike[0]).collect()
}

/// Returns the color of every kind of region along a parameter, in the order of letters.
pub(crate) fn fills_along(survey: &Survey) -> Vec<Color> {
    let regimes: Vec<&Regime> = firsts(survey).iter().map(|region| &*region.regime).collect();
    let borders: Vec<[usize; 2]> = survey.regions.windows(2).map(|pair| [pair[0].kind, pair[1].kind]).collect();
    colors(&regimes, &borders)
}

/// Returns the color of every area of a map, in the order of letters.
pub(crate) fn fills_of_map(map: &Map) -> Vec<Color> {
    let regimes: Vec<&Regime> = map.areas.iter().map(|area| &*area.regime).collect();
    let borders: Vec<[usize; 2]> = map.curves.iter().map(|curve| curve.sides).collect();
    colors(&regimes, &borders)
}

/// Chooses a color for each regime. Neighbors, which `borders` separate, differ in hue, and in lightness if possible.
fn colors(regimes: &[&Regime], borders: &[[usize; 2]]) -> Vec<Color> {
    let mut tints: Vec<Option<usize>> = Vec::new();
    for (kind, regime) in regimes.iter().enumerate() {
        let neighbor = |&[a, b]: &[usize; 2]| if a == kind { tints.get(b) } else { tints.get(a).filter(|_| b == kind) };
        let neighbors: Vec<usize> = borders.iter().filter_map(neighbor).copied().flatten().collect();
        let count = |same: &dyn Fn(&usize) -> bool| neighbors.iter().filter(|&tint| same(tint)).count();
        let cost = |tint: &usize| {
            let used = tints.iter().flatten().filter(|&other| other == tint).count();
            (count(&|other| other == tint), count(&|other| other % 2 == tint % 2), used, *tint)
        };
        let answered = matches!(regime, Regime::Answered { .. });
        let tint = answered.then(|| (0..Color::TINTS).min_by_key(cost)).flatten();
        tints.push(tint);
    }
    tints.into_iter().map(|tint| tint.map_or(Color::Pale, Color::Tint)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_greek_letters_become_letters() {
        let names = ["alpha", "delta_alpha", "left_hip_angle", "alphabet", "mu", "l_1"].map(with_greek_letters);
        assert_eq!(names, ["α", "δ_α", "left_hip_angle", "alphabet", "μ", "l_1"]);
    }

    #[test]
    fn neighbors_differ_in_color() {
        let regime = Regime::Answered { contacts: Vec::new(), outcomes: Vec::new(), undecided: Vec::new() };
        let regimes = [&regime; 20];
        // Each kind borders on the one before it, and on one that is 8 before it.
        let borders: Vec<[usize; 2]> =
            (1..20).map(|kind| [kind - 1, kind]).chain((8..20).map(|k| [k, k - 8])).collect();
        let colors = colors(&regimes, &borders);
        assert_eq!(colors.len(), 20);
        assert!(borders.iter().all(|&[a, b]| colors[a] != colors[b]), "{colors:?}");
    }
}
