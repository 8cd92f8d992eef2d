//! One parameter: panels below each other, for each contact its velocity after and its impulse.

use super::style::{COMPONENTS, Styles};
use super::{Kind, WIDTH, angles, fills_along, is_seen};
use crate::draw::plot::{Arrangement, Band, Color, Legend, Panel, Picture, PlotAxis, PlotPoint, Shape, Stroke};
use crate::impact::Motion;
use crate::sweep::{CurvePoint, Region, RegionCurves, Survey};
use crate::write::sweep::Happening;

/// What is drawn of a contact.
struct Quantity {
    label: &'static str,
    /// Its name within a sentence.
    name: &'static str,
    of: fn(&Motion) -> &[[f64; 2]],
}

const QUANTITIES: [Quantity; 2] = [
    Quantity { label: "velocity after [m/s]", name: "velocity after", of: |motion| &motion.velocity_after },
    Quantity { label: "impulse [N s]", name: "impulse", of: |motion| &motion.impulse },
];

/// Height inside of the axes \[px\].
const HEIGHT: f64 = 176.0;
/// Without anything but the letters of regions.
const STRIP: f64 = 30.0;

/// A curve that grows by more than this in its last eighth has a pole, beside which it is shown up to so many times what it is
/// in its middle half.
const POLE: f64 = 4.0;
const BESIDE_POLE: f64 = 1.5;

/// What is less than this part of the same quantity of other contacts is zero but for rounding.
const ZERO: f64 = 1e-12;

/// What the regions of a survey look like, whose outcomes follow these courses.
pub fn picture(x: PlotAxis, survey: &Survey, courses: &[RegionCurves]) -> Picture {
    let kinds = kinds(survey);
    let styles = Styles::of(survey, &kinds);
    let whole = Whole { survey, courses, styles: &styles };
    let mut panels = whole.contacts().iter().flat_map(|contact| whole.of_contact(contact)).collect::<Vec<_>>();
    if panels.is_empty() {
        let nothing = PlotAxis { bare: true, ..PlotAxis::default() };
        panels.push(Panel { size: (WIDTH, STRIP), ..Panel::new(PlotAxis::default(), nothing) });
    }
    for (index, panel) in panels.iter_mut().enumerate() {
        let letter = |kind: &Kind| if index == 0 { kind.letter.clone() } else { String::new() };
        panel.bands = bands(survey, &kinds, |kind| (letter(kind), kind.color));
    }
    let mut explained = angles::panels(survey, courses);
    let angles = !explained.is_empty();
    // These have letters of their own.
    explained.iter_mut().for_each(|panel| panel.bands = bands(survey, &kinds, |_| (String::new(), Color::White)));
    panels.extend(explained);
    let last = panels.len() - 1;
    for (index, panel) in panels.iter_mut().enumerate() {
        panel.x = PlotAxis { bare: index < last, ..x.clone() };
    }
    let legend = Legend { entries: styles.legend(&kinds, angles), arrangement: Arrangement::Columns };
    Picture { title: String::new(), rows: panels.into_iter().map(|panel| vec![panel]).collect(), legend }
}

/// The regions, each with a letter and a color.
fn bands(survey: &Survey, kinds: &[Kind], look: impl Fn(&Kind) -> (String, Color)) -> Vec<Band> {
    let band = |region: &Region| {
        let (letter, fill) = look(&kinds[region.kind]);
        Band { from: region.from, to: region.to, letter, fill }
    };
    survey.regions.iter().map(band).collect()
}

/// Every kind of region, in the order of letters.
fn kinds(survey: &Survey) -> Vec<Kind<'_>> {
    let mut firsts: Vec<&Region> = Vec::new();
    for region in &survey.regions {
        if region.kind == firsts.len() {
            firsts.push(region);
        }
    }
    firsts
        .iter()
        .zip(fills_along(survey))
        .map(|(region, color)| {
            Kind::new(region.kind, Happening::of(&region.regime, region.verdict, region.refused.as_ref()), color)
        })
        .collect()
}

/// Everything along the parameter.
struct Whole<'a> {
    survey: &'a Survey,
    courses: &'a [RegionCurves],
    styles: &'a Styles<'a>,
}

impl<'a> Whole<'a> {
    /// Names of all contacts that occur where anything is seen.
    fn contacts(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        let seen = self.survey.regions.iter().filter(|region| is_seen(region, self.survey));
        for name in seen.flat_map(|region| region.regime.contacts()) {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }

    /// Panels of a contact: none of a quantity that is zero everywhere.
    fn of_contact(&self, contact: &str) -> Vec<Panel> {
        let (drawn, zero): (Vec<&Quantity>, Vec<&Quantity>) =
            QUANTITIES.iter().partition(|quantity| self.is_drawn(contact, quantity));
        let mut panels: Vec<Panel> = drawn.iter().map(|quantity| self.panel(contact, quantity)).collect();
        if let Some(first) = panels.first_mut() {
            first.title = contact.to_owned();
            for Quantity { name, .. } in zero {
                first.title.push_str(&format!("\n{name} is zero in every outcome"));
            }
        }
        panels
    }

    /// The quantities of a contact, or of all contacts, wherever they are known.
    fn is_drawn(&self, contact: &str, quantity: &Quantity) -> bool {
        let largest = |of: &dyn Fn(&str) -> bool| {
            let regions = self.survey.regions.iter().zip(self.courses);
            let places = regions.flat_map(|(region, course)| {
                let chosen: Vec<usize> =
                    (0..region.regime.contacts().len()).filter(|&index| of(&region.regime.contacts()[index])).collect();
                let motions = course.places.iter().flat_map(|place| &place.outcomes);
                motions
                    .flat_map(move |(_, motion)| chosen.clone().into_iter().map(|index| (quantity.of)(motion)[index]))
            });
            places.flatten().fold(0.0, |most: f64, number| most.max(number.abs()))
        };
        largest(&|name| name == contact) > ZERO * largest(&|_| true)
    }

    /// A quantity of a contact in all regions.
    fn panel(&self, contact: &str, quantity: &Quantity) -> Panel {
        let mut shapes = Vec::new();
        let mut ranges = Vec::new();
        for (axis, (_, stroke)) in COMPONENTS.into_iter().enumerate() {
            for (region, course) in self.survey.regions.iter().zip(self.courses) {
                let contacts = region.regime.contacts();
                let (Some(index), Some(first)) =
                    (contacts.iter().position(|name| name == contact), course.places.first())
                else {
                    continue;
                };
                for (branch, (modes, _)) in first.outcomes.iter().enumerate() {
                    let point = |place: &CurvePoint| -> Option<PlotPoint> {
                        let (_, motion) = place.outcomes.get(branch)?;
                        Some((place.at, (quantity.of)(motion).get(index)?[axis]))
                    };
                    let points: Vec<PlotPoint> = course.places.iter().filter_map(point).collect();
                    // Nobody sees a curve in a region that is but a line.
                    ranges.extend(shown(&points).filter(|_| is_seen(region, self.survey)));
                    let stroke = Stroke { dash: self.styles.dash(contacts, modes), ..stroke };
                    shapes.push(Shape::Line { points, stroke });
                }
            }
        }
        let within = ranges.into_iter().reduce(|(low, high), (least, most)| (low.min(least), high.max(most)));
        let y = PlotAxis { label: quantity.label.into(), within, ..PlotAxis::default() };
        Panel { shapes, size: (WIDTH, HEIGHT), ..Panel::new(PlotAxis::default(), y) }
    }
}

/// What of a curve's values a panel has to show: all of them, but not what grows like 1 / x toward a pole at its end.
fn shown(points: &[PlotPoint]) -> Option<(f64, f64)> {
    let (&(from, _), &(to, _)) = (points.first()?, points.last()?);
    let largest = |least: f64, most: f64| {
        let inner = points.iter().filter(|(at, _)| (least..=most).contains(&(at - from)));
        inner.fold(0.0, |largest: f64, (_, value)| largest.max(value.abs()))
    };
    let width = to - from;
    // A polynomial of low degree does not grow so much in the last eighth.
    let has_pole = largest(0.0, width) > POLE * largest(0.125 * width, 0.875 * width);
    let limit = if has_pole { BESIDE_POLE * largest(0.25 * width, 0.75 * width) } else { f64::INFINITY };
    let values = points.iter().map(|(_, value)| value.max(-limit).min(limit));
    values.map(|value| (value, value)).reduce(|(low, high), (least, most)| (low.min(least), high.max(most)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::plot::LegendKey;
    use crate::law::Mode;
    use crate::sweep::Regime;

    #[test]
    fn a_curve_is_shown_whole_but_for_poles() {
        let curve =
            |f: &dyn Fn(f64) -> f64| (0..=160).map(|k| f64::from(k) / 160.0).map(|x| (x, f(x))).collect::<Vec<_>>();
        let near = |shown: Option<(f64, f64)>, (low, high): (f64, f64)| {
            let (least, most) = shown.expect("a range");
            assert!((least - low).abs() < 1e-12 && (most - high).abs() < 1e-12, "{least} {most}");
        };
        near(shown(&curve(&|x| x * x * x - 0.5)), (-0.5, 0.5));
        near(shown(&curve(&|x| 1.0 / (1.001 - x))), (1.0 / 1.001, 1.5 / 0.251));
        near(shown(&curve(&|x| -1.0 / (0.001 + x))), (-1.5 / 0.251, -1.0 / 1.001));
    }

    /// Ten regions with six outcomes of two contacts each, all of them wavy.
    fn crowd() -> (Survey, Vec<RegionCurves>) {
        let modes = |outcome: usize| vec![Mode::ALL[outcome % 4], Mode::ALL[outcome / 4]];
        let regime = |region: usize| Regime::Answered {
            contacts: vec!["left_foot".into(), "right_foot".into()],
            outcomes: (0..6).map(|outcome| modes(outcome + region)).collect(),
            undecided: Vec::new(),
        };
        let region = |kind: usize| {
            let (from, to) = (0.1 * kind as f64, 0.1 * (kind + 1) as f64);
            Region { from, to, regime: regime(kind).into(), kind, verdict: None, refused: None }
        };
        let regions: Vec<Region> = (0..10).map(region).collect();
        let wave = |x: f64, phase: usize| libm::sin(20.0 * x + phase as f64);
        let motion = |x: f64, outcome: usize| {
            let pair = |shift: usize| [wave(x, outcome + shift), wave(x, outcome + shift + 2)];
            Motion { impulse: vec![pair(0), pair(1)], velocity_after: vec![pair(2), pair(3)] }
        };
        let place = |kind: usize, step: usize| {
            let at = 0.1 * (kind as f64 + step as f64 / 500.0);
            let outcomes = (0..6).map(|outcome| (modes(outcome + kind), motion(at, outcome))).collect();
            CurvePoint { at, outcomes, explanation: None }
        };
        let course = |kind: usize| RegionCurves { places: (0..=500).map(|step| place(kind, step)).collect() };
        let courses = (0..10).map(course).collect();
        (Survey { regions, borders: Vec::new(), dependent: false }, courses)
    }

    #[test]
    fn a_crowd_of_regions_and_outcomes_is_a_small_file() {
        let (survey, courses) = crowd();
        let x = PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let picture = picture(x, &survey, &courses);
        let lines: usize = picture.rows.iter().flatten().map(|panel| panel.shapes.len()).sum();
        assert_eq!(lines, 4 * 2 * 60);
        let svg = picture.svg().expect("a picture");
        assert!(svg.len() < 500_000, "{} bytes", svg.len());
        let told = picture.legend.entries.iter().filter(|entry| matches!(entry.key, LegendKey::Line(_))).count();
        assert_eq!(told, COMPONENTS.len() + 15, "each outcome once");
    }

    #[test]
    fn what_is_zero_everywhere_is_told_in_place_of_a_panel() {
        let (survey, mut courses) = crowd();
        for (_, motion) in
            courses.iter_mut().flat_map(|course| &mut course.places).flat_map(|place| &mut place.outcomes)
        {
            motion.velocity_after[1] = [0.0, 1e-17];
        }
        let picture = picture(PlotAxis::default(), &survey, &courses);
        let titles: Vec<&str> = picture.rows.iter().flatten().map(|panel| panel.title.as_str()).collect();
        assert_eq!(titles, ["left_foot", "", "right_foot\nvelocity after is zero in every outcome"]);
    }
}
