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
const HEIGHT: f64 = 160.0;
/// Without anything but the letters of regions.
const STRIP: f64 = 30.0;

/// What is less than this part of the same quantity of other contacts is zero but for rounding.
const ZERO: f64 = 1e-12;

/// What the regions of a survey look like, whose outcomes follow these courses.
pub fn picture(x: Axis, survey: &Survey, courses: &[Course]) -> Picture {
    let styles = Styles::of(survey);
    let whole = Whole { survey, courses, styles: &styles };
    let mut panels = whole.contacts().iter().flat_map(|contact| whole.of_contact(contact)).collect::<Vec<_>>();
    let explained = angles::panels(survey, courses);
    let angles = !explained.is_empty();
    if panels.is_empty() {
        let nothing = Axis { bare: true, ..Axis::default() };
        panels.push(Panel { size: (WIDTH, STRIP), ..Panel::new(Axis::default(), nothing) });
    }
    panels.extend(explained);
    let last = panels.len() - 1;
    for (index, panel) in panels.iter_mut().enumerate() {
        panel.x = Axis { bare: index < last, ..x.clone() };
        panel.bands = bands(survey, index == 0);
    }
    let legend = Legend { entries: styles.legend(survey, angles), below: true };
    Picture { title: String::new(), rows: panels.into_iter().map(|panel| vec![panel]).collect(), legend }
}

/// The shaded regions, with their letters or without.
fn bands(survey: &Survey, lettered: bool) -> Vec<Band> {
    let band = |region: &Region| {
        let Kind { letter, colour, .. } = kind(region);
        Band { from: region.from, to: region.to, letter: if lettered { letter } else { String::new() }, fill: colour }
    };
    survey.regions.iter().map(band).collect()
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
    /// Names of all contacts that occur.
    fn contacts(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.survey.regions.iter().flat_map(|region| region.regime.contacts()) {
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
                first.title.push_str(&format!("\n{name} zero in every outcome"));
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
                    let stroke = Stroke { dash: self.styles.dash(contacts, modes), ..stroke };
                    shapes.push(Shape::Line { points: course.places.iter().filter_map(point).collect(), stroke });
                }
            }
        }
        let y = Axis { label: quantity.label.into(), ..Axis::default() };
        Panel { shapes, size: (WIDTH, HEIGHT), ..Panel::new(Axis::default(), y) }
    }
}

/// How the lines of each outcome are drawn.
struct Styles<'a>(Vec<Style<'a>>);

struct Style<'a> {
    contacts: &'a [String],
    modes: &'a [Mode],
    dash: Dash,
    /// The letters of the regions in which it is valid.
    letters: Vec<String>,
}

impl<'a> Styles<'a> {
    /// Each outcome of an ambiguous region has its own dashes, there and wherever else it is valid.
    fn of(survey: &'a Survey) -> Self {
        let mut styles: Vec<Style> = Vec::new();
        let mut dashes = Dash::ALL.into_iter().cycle();
        let outcomes = |region: &'a Region| region.regime.outcomes().unwrap_or_default();
        let ambiguous = |contacts: &[String], modes: &[Mode]| {
            let same = |region: &&Region| region.regime.contacts() == contacts && outcomes_hold(region, modes);
            survey.regions.iter().filter(same).any(|region| outcomes(region).len() > 1)
        };
        for region in &survey.regions {
            let (contacts, letter) = (region.regime.contacts(), kind(region).letter);
            for modes in outcomes(region).iter().filter(|modes| !modes.is_empty()) {
                match styles.iter_mut().find(|style| (style.contacts, style.modes) == (contacts, modes)) {
                    Some(style) if style.letters.contains(&letter) => {}
                    Some(style) => style.letters.push(letter.clone()),
                    None => {
                        let own = if ambiguous(contacts, modes) { dashes.next() } else { None };
                        let (dash, letters) = (own.unwrap_or(Dash::Solid), vec![letter.clone()]);
                        styles.push(Style { contacts, modes, dash, letters });
                    }
                }
            }
        }
        Self(styles)
    }

    fn dash(&self, contacts: &[String], modes: &[Mode]) -> Dash {
        let own = self.0.iter().find(|style| (style.contacts, style.modes) == (contacts, modes));
        own.map_or(Dash::Solid, |style| style.dash)
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
        entries.extend(self.0.iter().map(|Style { contacts, modes, dash, letters }| {
            let words = words::modes(contacts.iter().map(String::as_str), modes);
            let stroke = Stroke { dash: *dash, ..Stroke::solid(Colour::Black, 1.6) };
            Entry { name: format!("{}: {words}", letters.join(", ")), key: Key::Line(stroke) }
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

fn outcomes_hold(region: &Region, modes: &[Mode]) -> bool {
    region.regime.outcomes().is_some_and(|outcomes| outcomes.iter().any(|own| own == modes))
}
