//! One parameter: panels below each other, for each contact its velocity after and its impulse.

use super::{Kind, angles};
use crate::impact::{Mode, Motion};
use crate::planar::Vector;
use crate::report::picture::{Axis, Band, Colour, Dash, Entry, Key, Legend, Panel, Picture, Point, Shape, Stroke};
use crate::report::words;
use crate::sweep::{Course, Place, Region, Survey};

/// What is drawn of a contact.
struct Quantity {
    label: &'static str,
    /// Its name within a sentence.
    name: &'static str,
    of: fn(&Motion) -> &[Vector<f64>],
}

const QUANTITIES: [Quantity; 2] = [
    Quantity { label: "velocity after [m/s]", name: "velocity after", of: |motion| &motion.velocity_after },
    Quantity { label: "impulse [N s]", name: "impulse", of: |motion| &motion.impulse },
];

/// The components and their lines: where both are the same, the wider one is seen behind the other.
const COMPONENTS: [(&str, Stroke); 2] =
    [("tangential", Stroke::solid(Colour::Blue, 2.8)), ("normal", Stroke::solid(Colour::Vermilion, 1.6))];

/// Inside of the axes \[px\].
const WIDTH: f64 = 540.0;
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
pub fn picture(x: Axis, survey: &Survey, courses: &[Course]) -> Picture {
    let styles = Styles::of(survey);
    let whole = Whole { survey, courses, styles: &styles };
    let mut panels = whole.contacts().iter().flat_map(|contact| whole.of_contact(contact)).collect::<Vec<_>>();
    if panels.is_empty() {
        let nothing = Axis { bare: true, ..Axis::default() };
        panels.push(Panel { size: (WIDTH, STRIP), ..Panel::new(Axis::default(), nothing) });
    }
    for (index, panel) in panels.iter_mut().enumerate() {
        let letter = |kind: &Kind| if index == 0 { kind.letter.clone() } else { String::new() };
        panel.bands = bands(survey, |kind| (letter(kind), kind.colour));
    }
    let mut explained = angles::panels(survey, courses);
    let angles = !explained.is_empty();
    // These have letters of their own.
    explained.iter_mut().for_each(|panel| panel.bands = bands(survey, |_| (String::new(), Colour::White)));
    panels.extend(explained);
    let last = panels.len() - 1;
    for (index, panel) in panels.iter_mut().enumerate() {
        panel.x = Axis { bare: index < last, ..x.clone() };
    }
    let legend = Legend { entries: styles.legend(survey, angles), below: true };
    Picture { title: String::new(), rows: panels.into_iter().map(|panel| vec![panel]).collect(), legend }
}

/// The regions, each with a letter and a colour.
fn bands(survey: &Survey, look: impl Fn(&Kind) -> (String, Colour)) -> Vec<Band> {
    let band = |region: &Region| {
        let (letter, fill) = look(&kind(region));
        Band { from: region.from, to: region.to, letter, fill }
    };
    survey.regions.iter().map(band).collect()
}

/// Whether a region is wide enough for lines in it.
fn is_seen(region: &Region, survey: &Survey) -> bool {
    let range: f64 = survey.regions.iter().map(|region| region.to - region.from).sum();
    WIDTH * (region.to - region.from) >= range
}

fn kind(region: &Region) -> Kind<'_> {
    Kind::new(region.kind, &region.regime, region.refused.as_ref())
}

/// Everything along the parameter.
struct Whole<'a> {
    survey: &'a Survey,
    courses: &'a [Course],
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
                    let point = |place: &Place| -> Option<Point> {
                        let (_, motion) = place.outcomes.get(branch)?;
                        Some((place.at, (quantity.of)(motion).get(index)?[axis]))
                    };
                    let points: Vec<Point> = course.places.iter().filter_map(point).collect();
                    ranges.extend(shown(&points));
                    let stroke = Stroke { dash: self.styles.dash(contacts, modes), ..stroke };
                    shapes.push(Shape::Line { points, stroke });
                }
            }
        }
        let within = ranges.into_iter().reduce(|(low, high), (least, most)| (low.min(least), high.max(most)));
        let y = Axis { label: quantity.label.into(), within, ..Axis::default() };
        Panel { shapes, size: (WIDTH, HEIGHT), ..Panel::new(Axis::default(), y) }
    }
}

/// What of a curve's values a panel has to show: all of them, but not what grows like 1 / x toward a pole at its end.
fn shown(points: &[Point]) -> Option<(f64, f64)> {
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

/// How the lines of each outcome are drawn.
struct Styles<'a>(Vec<Style<'a>>);

struct Style<'a> {
    contacts: &'a [String],
    modes: &'a [Mode],
    /// Its own dashes; none where it needs none to be told from others, and is known by its region.
    dash: Option<Dash>,
    /// Of the first region in which it is valid.
    colour: Colour,
    /// The letters of the regions in which it is valid.
    letters: Vec<String>,
    /// Whether another outcome is valid beside it somewhere.
    ambiguous: bool,
    /// Whether its lines are seen anywhere.
    seen: bool,
}

impl<'a> Styles<'a> {
    /// Where some region is ambiguous, each outcome that is seen has its own dashes wherever it is valid; of more outcomes than there are
    /// dashes only those of ambiguous regions have.
    fn of(survey: &'a Survey) -> Self {
        let mut styles: Vec<Style> = Vec::new();
        for region in &survey.regions {
            let contacts = region.regime.contacts();
            let Kind { letter, colour, .. } = kind(region);
            let outcomes = region.regime.outcomes().unwrap_or_default();
            for modes in outcomes.iter().filter(|modes| !modes.is_empty()) {
                let ambiguous = outcomes.len() > 1 && is_seen(region, survey);
                match styles.iter_mut().find(|style| (style.contacts, style.modes) == (contacts, modes)) {
                    Some(style) => {
                        style.ambiguous |= ambiguous;
                        style.seen |= is_seen(region, survey);
                        if !style.letters.contains(&letter) {
                            style.letters.push(letter.clone());
                        }
                    }
                    None => {
                        let letters = vec![letter.clone()];
                        styles.push(Style {
                            contacts,
                            modes,
                            dash: None,
                            colour,
                            letters,
                            ambiguous,
                            seen: is_seen(region, survey),
                        });
                    }
                }
            }
        }
        let seen = styles.iter().filter(|style| style.seen).count();
        let all = seen <= Dash::ALL.len() && styles.iter().any(|style| style.ambiguous);
        let dashed = styles.iter_mut().filter(|style| style.ambiguous || all && style.seen);
        dashed.zip(Dash::ALL.into_iter().cycle()).for_each(|(style, dash)| style.dash = Some(dash));
        Self(styles)
    }

    fn dash(&self, contacts: &[String], modes: &[Mode]) -> Dash {
        let own = self.0.iter().find(|style| (style.contacts, style.modes) == (contacts, modes));
        own.and_then(|style| style.dash).unwrap_or(Dash::Solid)
    }

    /// Components, what angles there are, outcomes with the letters of their regions, regions without any.
    fn legend(&self, survey: &Survey, angles: bool) -> Vec<Entry> {
        let mut entries = Vec::new();
        if !self.0.is_empty() {
            entries.extend(COMPONENTS.map(|(name, stroke)| Entry { name: name.into(), key: Key::Line(stroke) }));
        }
        if angles {
            entries.extend(angles::legend());
        }
        entries.extend(self.0.iter().map(|Style { contacts, modes, dash, colour, letters, .. }| {
            let words = words::modes(contacts.iter().map(String::as_str), modes);
            let line = |dash| Key::Line(Stroke { dash, ..Stroke::solid(Colour::Black, 1.6) });
            let key = dash.map_or(Key::Fill(*colour), line);
            Entry { name: format!("{}: {words}", letters.join(", ")), key }
        }));
        let mut told = Vec::new();
        for region in &survey.regions {
            let Kind { letter, colour, happening } = kind(region);
            let answered = happening.outcomes.unwrap_or_default().iter().any(|modes| !modes.is_empty());
            let lines = if answered { happening.not_excluded() } else { happening.lines() };
            if !lines.is_empty() && !told.contains(&letter) {
                entries.push(Entry { name: format!("{letter}: {}", lines.join("\n")), key: Key::Fill(colour) });
                told.push(letter);
            }
        }
        entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_shown_whole_but_for_poles() {
        let curve =
            |f: &dyn Fn(f64) -> f64| (0..=160).map(|k| f64::from(k) / 160.0).map(|x| (x, f(x))).collect::<Vec<_>>();
        assert_eq!(shown(&curve(&|x| x * x * x - 0.5)), Some((-0.5, 0.5)));
        assert_eq!(shown(&curve(&|x| 1.0 / (1.001 - x))), Some((1.0 / 1.001, 1.5 / 0.251)));
        assert_eq!(shown(&curve(&|x| -1.0 / (0.001 + x))), Some((-1.5 / 0.251, -1.0 / 1.001)));
    }
}
