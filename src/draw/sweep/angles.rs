//! Panels of the angles beta and gamma of each contact against the parameter, with the paper's regions (its figure 10).
//!
//! ```text
//!                beta < 0              beta > 0 (its mirror image)
//!     A   0       .. pi + beta     beta      .. pi          lifts off
//!     B   pi+beta .. pi            0         .. beta        slides, however great the friction
//!     C   -pi     .. beta          beta - pi .. 0           stays
//!     E   beta    .. 0             -pi       .. beta - pi   all three
//! ```

use super::different;
use super::place::clear_of;
use crate::draw::plot::{Color, LegendEntry, LegendKey, Panel, Pixel, PlotAxis, PlotPoint, PlotShape, Stroke, TextBox};
use crate::error::visible;
use crate::impact::{Explanation, ImpulseRegion};
use crate::sweep::{CurvePoint, RegionCurves, Survey};
use std::f64::consts::PI;

const BETA: Stroke = Stroke::solid(Color::Black, 1.0);
const GAMMA: Stroke = Stroke::solid(Color::Green, 2.4);

/// Width and height inside the axes \[px\].
const SIZE: (f64, f64) = (super::WIDTH, 220.0);
/// The font size of labels \[px\].
const LETTERS: u32 = 12;

/// The regions of gamma, and what a contact does in each.
const REGIONS: [(ImpulseRegion, &str); 4] = [
    (ImpulseRegion::A, "lifts off"),
    (ImpulseRegion::B, "slides"),
    (ImpulseRegion::C, "stays"),
    (ImpulseRegion::E, "all three"),
];

/// An angle that changes by more than this between two samples is discontinuous \[rad\].
const JUMP: f64 = 0.5;

/// Returns a panel for each contact of a region with angles.
pub fn panels(survey: &Survey, courses: &[RegionCurves]) -> Vec<Panel> {
    let explained = |course: &RegionCurves| course.places.iter().any(|place| place.explanation.is_some());
    let regions = survey.regions.iter().zip(courses).filter(|(_, course)| explained(course));
    let names = different(regions.flat_map(|(region, _)| region.regime.contacts()));
    let (Some(first), Some(last)) = (survey.regions.first(), survey.regions.last()) else { return Vec::new() };
    let borders: Vec<f64> = survey.borders.iter().map(|border| border.at).collect();
    names.into_iter().map(|name| panel(name, &runs(name, survey, courses), (first.from, last.to), &borders)).collect()
}

pub fn legend() -> [LegendEntry; 2] {
    [("γ", GAMMA), ("0, β and β ± π", BETA)].map(|(name, stroke)| LegendEntry::new(name, LegendKey::Line(stroke)))
}

/// The angles of a contact \[rad\] at a value of the parameter.
#[derive(Debug, Clone, Copy)]
struct Angles {
    at: f64,
    beta: f64,
    gamma: f64,
}

/// Returns the runs of successive points at which a contact has angles.
fn runs(name: &str, survey: &Survey, courses: &[RegionCurves]) -> Vec<Vec<Angles>> {
    let places = survey.regions.iter().zip(courses).flat_map(|(region, course)| {
        let contact = region.regime.contacts().iter().position(|known| known == name);
        let angles = move |place: &CurvePoint| {
            let Explanation { beta, gamma, .. } = place.explanation.as_ref()?;
            Some(Angles { at: place.at, beta: *beta.get(contact?)?, gamma: *gamma.get(contact?)? })
        };
        // A region without points interrupts a run, too.
        course.places.iter().map(angles).chain(course.places.is_empty().then_some(None))
    });
    let places: Vec<Option<Angles>> = places.collect();
    let runs = places.split(Option::is_none).map(|run| run.iter().flatten().copied().collect());
    runs.filter(|run: &Vec<Angles>| !run.is_empty()).collect()
}

fn panel(name: &str, runs: &[Vec<Angles>], (from, to): (f64, f64), borders: &[f64]) -> Panel {
    let mut shapes = Vec::new();
    for run in runs {
        let line = |turn: f64| -> Vec<PlotPoint> { run.iter().map(|angles| (angles.at, angles.beta + turn)).collect() };
        shapes.extend([-PI, 0.0, PI].map(|turn| PlotShape::Line { points: line(turn), stroke: BETA }));
    }
    shapes.push(PlotShape::Line { points: vec![(from, 0.0), (to, 0.0)], stroke: BETA });
    let gamma: Vec<Vec<PlotPoint>> = runs.iter().flat_map(|run| unbroken(run)).collect();
    let pixel = |(x, y): PlotPoint| (SIZE.0 * (x - from) / (to - from), SIZE.1 * (y + PI) / (2.0 * PI));
    let curve: Vec<Vec<Pixel>> = gamma.iter().map(|piece| piece.iter().copied().map(pixel).collect()).collect();
    let walls = borders.iter().map(|&at| vec![pixel((at, -PI)), pixel((at, PI))]);
    let all: Vec<Vec<Pixel>> = curve.iter().cloned().chain(walls).collect();
    shapes.extend(gamma.into_iter().map(|points| PlotShape::Line { points, stroke: GAMMA }));
    for (region, words) in REGIONS {
        let ends = |angles: &Angles| strip(region, angles.beta).map(|angle| pixel((angles.at, angle)));
        let strips: Vec<Vec<[Pixel; 2]>> = runs.iter().map(|run| run.iter().map(ends).collect()).collect();
        // If there is no other place, the text may cover a border.
        if let Some((x, y)) = room(&strips, &all, words).or_else(|| room(&strips, &curve, words)) {
            let at = (from + (to - from) * x / SIZE.0, 2.0 * PI * y / SIZE.1 - PI);
            shapes.push(PlotShape::Text { at, text: words.into(), size: LETTERS });
        }
    }
    let y = PlotAxis { range: Some((-PI, PI)), in_pi: true, ..PlotAxis::new("angle [rad]") };
    let title = format!("{}\nwith infinite friction, while all other contacts stick", visible(name));
    Panel { title, shapes, size: SIZE, ..Panel::new(PlotAxis::default(), y) }
}

/// Returns the lower and the upper end of a region of gamma \[rad\].
fn strip(region: ImpulseRegion, beta: f64) -> [f64; 2] {
    use ImpulseRegion::{A, B, C, E};
    let (regions, ends) = match beta <= 0.0 {
        true => ([C, E, A, B], [-PI, beta, 0.0, PI + beta, PI]),
        false => ([E, C, B, A], [-PI, beta - PI, 0.0, beta, PI]),
    };
    let at = regions.iter().position(|known| *known == region).unwrap_or_default();
    [ends[at], ends[at + 1]]
}

/// Splits the curve of gamma where it wraps from pi to -pi, and where it is discontinuous.
fn unbroken(run: &[Angles]) -> Vec<Vec<PlotPoint>> {
    let mut pieces: Vec<Vec<PlotPoint>> = vec![Vec::new()];
    for (at, angles) in run.iter().enumerate() {
        if let Some(last) = at.checked_sub(1).map(|before| run[before]) {
            let turn = libm::remainder(angles.gamma - last.gamma, 2.0 * PI);
            let wraps = (last.gamma + turn - angles.gamma).abs() > PI;
            let jumps = turn.abs() > JUMP;
            if wraps && !jumps {
                // Both pieces end at the edge of the panel, at the same value of the parameter.
                let edge = PI.copysign(last.gamma);
                let at = last.at + (angles.at - last.at) * (edge - last.gamma) / turn;
                pieces.last_mut().into_iter().for_each(|piece| piece.push((at, edge)));
                pieces.push(vec![(at, -edge)]);
            } else if jumps {
                pieces.push(Vec::new());
            }
        }
        pieces.last_mut().into_iter().for_each(|piece| piece.push((angles.at, angles.gamma)));
    }
    pieces
}

/// Returns the place \[px\] with the most room for a text between the ends of `strips` and apart from the curve; `None`
/// if there is no room.
fn room(strips: &[Vec<[Pixel; 2]>], curve: &[Vec<Pixel>], text: &str) -> Option<Pixel> {
    let half = TextBox::half_of(text, LETTERS);
    let mut best: Option<(f64, Pixel)> = None;
    for run in strips {
        for &[(x, low), (_, high)] in run {
            for share in [0.5, 0.35, 0.65, 0.2, 0.8] {
                let y = low + share * (high - low);
                let text = TextBox { middle: (x, y), half };
                if !text.is_within(SIZE) {
                    continue;
                }
                let edges = run.iter().filter(|[(at, _), _]| (at - x).abs() <= half.0);
                let inside = edges.fold(f64::INFINITY, |least, [(_, low), (_, high)]| least.min(y - low).min(high - y));
                let clear = (inside - half.1).min(clear_of(&text, curve));
                if clear > 2.0 && best.is_none_or(|(most, _)| clear > most + 1.0) {
                    best = Some((clear, (x, y)));
                }
            }
        }
    }
    best.map(|(_, point)| point)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(gammas: &[f64]) -> Vec<Angles> {
        gammas.iter().enumerate().map(|(at, &gamma)| Angles { at: at as f64, beta: 0.0, gamma }).collect()
    }

    #[test]
    fn angle_wraps_without_a_line_across_jumps() {
        let pieces = unbroken(&run(&[3.0, PI - 0.05, 0.15 - PI, -2.8]));
        let [(left, top), (entered, bottom)] = [pieces[0][2], pieces[1][0]];
        assert!((left - 1.25).abs() < 1e-12 && left == entered && pieces.len() == 2, "{pieces:?}");
        let back = unbroken(&run(&[-3.1, 3.1]));
        assert_eq!([top, bottom, back[0][1].1, back[1][0].1], [PI, -PI, -PI, PI]);
        let jump = unbroken(&run(&[0.1, 0.2, 2.0, 2.1]));
        assert_eq!(jump, [[(0.0, 0.1), (1.0, 0.2)], [(2.0, 2.0), (3.0, 2.1)]]);
    }

    #[test]
    fn strips_cover_the_whole_turn() {
        for beta in [-1.2, -0.3, 0.3, 1.2] {
            let strips = REGIONS.map(|(region, _)| strip(region, beta));
            let widths: f64 = strips.iter().map(|[low, high]| high - low).sum();
            assert!((widths - 2.0 * PI).abs() < 1e-12, "{beta}");
            assert!(strips.iter().all(|[low, high]| low < high && -PI <= *low && *high <= PI), "{beta}");
        }
        // The strips for beta and -beta are mirror images: gamma becomes pi - gamma.
        assert_eq!(strip(ImpulseRegion::B, -0.3), [PI - 0.3, PI]);
        assert_eq!(strip(ImpulseRegion::B, 0.3), [0.0, 0.3]);
    }
}
