//! Pictures of studies with one parameter: panels with the velocity after and the impulse of each contact.

use super::{KindLook, WIDTH, angles, different, fills_along, firsts, is_seen};
use crate::draw::plot::{
    Band, Color, Dash, LegendEntry, LegendKey, Panel, Picture, PlotAxis, PlotPoint, PlotShape, Stroke, range,
};
use crate::error::visible;
use crate::impact::Motion;
use crate::law::Mode;
use crate::pipeline::Aspect;
use crate::sweep::{CurvePoint, Region, RegionCurves, Survey, letter};
use crate::write::sweep::Happening;
use crate::write::words::{self, DrawnNames, Wording, grouped};

struct PlottedQuantity {
    name: (&'static str, &'static str),
    of: fn(&Motion) -> &[[f64; 2]],
}

/// The height inside the axes of a panel, and of all panels of a column; with the legend they fit on a page \[px\].
const HEIGHT: f64 = 176.0;
const PAGE: f64 = 660.0;
/// The number of panels in a column, and the width of panels in one, two, and more columns \[px\]. If there are panels
/// of angles, with texts between their curves, all panels keep the full width.
const COLUMN: usize = 6;
const WIDTHS: [f64; 3] = [WIDTH, 420.0, 340.0];
/// The height of a panel that contains only the letters of regions \[px\].
const STRIP: f64 = 30.0;

/// A curve that grows by more than `POLE` in its first or last eighth has a pole. It is shown up to `NEAR_POLE` times
/// the greatest value in its middle half.
const POLE: f64 = 4.0;
const NEAR_POLE: f64 = 1.5;

/// Values below this share of the largest value of the same quantity among the contacts of an outcome count as zero.
const ZERO: f64 = 1e-12;

/// Returns the picture of a survey; `courses` are the curves of its regions.
pub fn picture<'s>(x: PlotAxis, aspect: Aspect, survey: &'s Survey, courses: &[RegionCurves]) -> Picture {
    let look = |(region, color): (&'s Region, Color)| KindLook {
        letter: letter(region.kind),
        color,
        happening: Happening::of(aspect, &region.regime, region.verdict, region.refused.as_ref()),
    };
    let kinds: Vec<KindLook> = firsts(survey).into_iter().zip(fills_along(survey)).map(look).collect();
    let styles = OutcomeStyles::of(survey, &kinds);
    let DrawnNames { given, taken, .. } = Wording::of(aspect).drawn;
    let quantities = [
        PlottedQuantity { name: taken, of: |motion| &motion.velocity_after },
        PlottedQuantity { name: given, of: |motion| &motion.impulse },
    ];
    let whole = Curves { survey, courses, styles: &styles, quantities };
    let seen = survey.regions.iter().filter(|region| is_seen(region, survey));
    let contacts = different(seen.flat_map(|region| region.regime.contacts()));
    let mut panels: Vec<Panel> = contacts.into_iter().flat_map(|contact| whole.of_contact(contact)).collect();
    if panels.is_empty() {
        let nothing = PlotAxis { bare: true, ..PlotAxis::default() };
        panels.push(Panel { size: (WIDTH, STRIP), ..Panel::new(PlotAxis::default(), nothing) });
    }
    let colored = panels.len();
    panels.extend(angles::panels(survey, courses));
    let angles = panels.len() > colored;
    let (count, columns) = (panels.len(), panels.len().div_ceil(COLUMN));
    let rows = count.div_ceil(columns);
    for (index, panel) in panels.iter_mut().enumerate() {
        // Panels of angles show regions of their own, so their bands have neither letters nor colors.
        let is_colored = index < colored;
        let band = |&Region { from, to, kind, .. }: &Region| {
            let KindLook { letter, color, .. } = &kinds[kind];
            let letter = if is_colored && index % rows == 0 { letter.clone() } else { String::new() };
            Band { from, to, letter, fill: if is_colored { *color } else { Color::White } }
        };
        panel.bands = survey.regions.iter().map(band).collect();
        panel.x = PlotAxis { bare: (index + 1) % rows > 0 && index + 1 < count, ..x.clone() };
        if is_colored {
            panel.size.1 = panel.size.1.min(PAGE / rows as f64);
        }
        if !angles {
            panel.size.0 = WIDTHS[(columns - 1).min(2)];
        }
    }
    let legend = styles.legend(&kinds, angles);
    let row = |row: usize| panels.iter().skip(row).step_by(rows).cloned().collect();
    Picture { title: String::new(), rows: (0..rows).map(row).collect(), legend }
}

struct Curves<'a> {
    survey: &'a Survey,
    courses: &'a [RegionCurves],
    styles: &'a OutcomeStyles<'a>,
    quantities: [PlottedQuantity; 2],
}

impl Curves<'_> {
    /// Returns the panels of a contact, without quantities that are zero in all visible regions. The title names these.
    fn of_contact(&self, contact: &str) -> Vec<Panel> {
        let (drawn, zero): (Vec<_>, Vec<_>) =
            self.quantities.iter().partition(|quantity| self.is_anywhere(contact, quantity, false));
        let mut panels: Vec<Panel> = drawn.iter().map(|quantity| self.panel(contact, quantity)).collect();
        if let Some(first) = panels.first_mut() {
            let zero = zero.iter().map(|quantity| {
                let is_hidden = self.is_anywhere(contact, quantity, true);
                let except = if is_hidden { ", except in regions too thin to be seen" } else { "" };
                format!("\n{} is zero in every outcome{except}", quantity.name.0)
            });
            first.title = visible(contact).into_owned() + &zero.collect::<String>();
        }
        panels
    }

    /// Returns whether a quantity of a contact is not zero in some outcome of a visible region, or of a `hidden` one.
    fn is_anywhere(&self, contact: &str, quantity: &PlottedQuantity, hidden: bool) -> bool {
        let largest = |pairs: &[[f64; 2]]| pairs.as_flattened().iter().map(|entry| entry.abs()).fold(0.0, f64::max);
        let regions = self.survey.regions.iter().zip(self.courses);
        let mut regions = regions.filter(|(region, _)| is_seen(region, self.survey) != hidden);
        regions.any(|(region, course)| {
            let Some(index) = region.regime.contacts().iter().position(|name| name == contact) else { return false };
            let mut motions = course.places.iter().flat_map(|place| &place.outcomes);
            motions.any(|(_, motion)| {
                let pairs = (quantity.of)(motion);
                pairs.get(index..=index).is_some_and(|pair| largest(pair) > ZERO * largest(pairs))
            })
        })
    }

    /// Returns the panel of a quantity of a contact, over all regions.
    fn panel(&self, contact: &str, quantity: &PlottedQuantity) -> Panel {
        let (mut shapes, mut ranges) = (Vec::new(), Vec::new());
        for (axis, (_, stroke)) in COMPONENTS.into_iter().enumerate() {
            for (region, course) in self.survey.regions.iter().zip(self.courses) {
                let contacts = region.regime.contacts();
                let Some(index) = contacts.iter().position(|name| name == contact) else { continue };
                let outcomes = course.places.first().map_or(&[][..], |first| &first.outcomes);
                for (branch, (modes, _)) in outcomes.iter().enumerate() {
                    let point = |place: &CurvePoint| -> Option<PlotPoint> {
                        let (_, motion) = place.outcomes.get(branch)?;
                        Some((place.at, (quantity.of)(motion).get(index)?[axis]))
                    };
                    let points: Vec<PlotPoint> = course.places.iter().filter_map(point).collect();
                    // Regions as narrow as a line do not count: their curves are not visible.
                    ranges.extend(shown(&points).filter(|_| is_seen(region, self.survey)));
                    let stroke = Stroke { dash: self.styles.dash(contacts, modes), ..stroke };
                    shapes.push(PlotShape::Line { points, stroke });
                }
            }
        }
        let within = range(ranges.into_iter().flat_map(|(least, most)| [least, most]));
        let y = PlotAxis { within, ..PlotAxis::new(format!("{} [{}]", quantity.name.0, quantity.name.1)) };
        Panel { shapes, size: (WIDTH, HEIGHT), ..Panel::new(PlotAxis::default(), y) }
    }
}

/// Returns the range of values that a panel shows: all values of the curve, except those that grow like 1 / x toward a
/// pole at an end. `None` if there are no points.
fn shown(points: &[PlotPoint]) -> Option<(f64, f64)> {
    let (&(from, _), &(to, _)) = (points.first()?, points.last()?);
    let largest = |least: f64, most: f64| {
        let inner = points.iter().filter(|(at, _)| (least..=most).contains(&(at - from)));
        inner.fold(0.0, |largest: f64, (_, value)| largest.max(value.abs()))
    };
    let width = to - from;
    // A polynomial of low degree grows by less in an eighth of the curve.
    let has_pole = largest(0.0, width) > POLE * largest(0.125 * width, 0.875 * width);
    let limit = if has_pole { NEAR_POLE * largest(0.25 * width, 0.75 * width) } else { f64::INFINITY };
    range(points.iter().map(|(_, value)| value.max(-limit).min(limit)))
}

/// The components and their strokes. The first is wider, so that it is visible behind the second if both are equal.
const COMPONENTS: [(&str, Stroke); 2] =
    [("tangential", Stroke::solid(Color::Blue, 2.8)), ("normal", Stroke::solid(Color::Vermilion, 1.6))];

struct OutcomeStyles<'a>(Vec<OutcomeStyle<'a>>);

struct OutcomeStyle<'a> {
    contacts: &'a [String],
    modes: &'a [Mode],
    /// The dashes of the outcome; `None` if its region identifies it.
    dash: Option<Dash>,
    /// The letters and colors of the regions in which the outcome is valid.
    letters: Vec<String>,
    colors: Vec<Color>,
    /// Whether another outcome is also valid in some visible region.
    ambiguous: bool,
    /// Whether the outcome is valid in a visible region.
    seen: bool,
}

impl<'a> OutcomeStyles<'a> {
    /// Assigns styles. If some visible region is ambiguous, each visible outcome has its own dashes in all regions. If
    /// there are more visible outcomes than dashes, only those of ambiguous regions have dashes.
    fn of(survey: &'a Survey, kinds: &[KindLook]) -> Self {
        let outcomes = |region: &'a Region| region.regime.outcomes().unwrap_or_default();
        let valid = survey.regions.iter().flat_map(|region| {
            let outcomes = outcomes(region).iter().filter(|modes| !modes.is_empty());
            outcomes.map(move |modes| ((region.regime.contacts(), &modes[..]), region))
        });
        let style = |((contacts, modes), regions): ((&'a [String], &'a [Mode]), Vec<&'a Region>)| {
            let seen = || regions.iter().filter(|region| is_seen(region, survey));
            let (ambiguous, seen) = (seen().any(|region| outcomes(region).len() > 1), seen().next().is_some());
            let looks = different(regions.iter().map(|region| region.kind)).into_iter().map(|kind| &kinds[kind]);
            let (letters, colors) = looks.map(|look| (look.letter.clone(), look.color)).unzip();
            OutcomeStyle { contacts, modes, dash: None, letters, colors, ambiguous, seen }
        };
        let mut styles: Vec<OutcomeStyle> = grouped(valid).into_iter().map(style).collect();
        let seen = styles.iter().filter(|style| style.seen).count();
        let all = seen <= Dash::ALL.len() && styles.iter().any(|style| style.ambiguous);
        let dashed = styles.iter_mut().filter(|style| style.ambiguous || all && style.seen);
        dashed.zip(Dash::ALL.into_iter().cycle()).for_each(|(style, dash)| style.dash = Some(dash));
        Self(styles)
    }

    fn dash(&self, contacts: &[String], modes: &[Mode]) -> Dash {
        let style = self.0.iter().find(|style| (style.contacts, style.modes) == (contacts, modes));
        style.and_then(|style| style.dash).unwrap_or(Dash::SOLID)
    }

    /// Returns the legend: components, angles, outcomes with the letters of their regions, regions without outcomes.
    fn legend(&self, kinds: &[KindLook], angles: bool) -> Vec<LegendEntry> {
        let mut entries = Vec::new();
        if !self.0.is_empty() {
            entries.extend(COMPONENTS.map(|(name, stroke)| LegendEntry::new(name, LegendKey::Line(stroke))));
        }
        if angles {
            entries.extend(angles::legend());
        }
        entries.extend(self.0.iter().map(|OutcomeStyle { contacts, modes, dash, letters, colors, .. }| {
            let sentence = words::modes(*contacts, modes);
            let line = |dash| LegendKey::LineIn(Stroke { dash, ..Stroke::solid(Color::Black, 1.6) }, colors.clone());
            let key = dash.map_or_else(|| LegendKey::Fill(colors[0]), line);
            LegendEntry::new(format!("{}: {sentence}", letters.join(", ")), key)
        }));
        for KindLook { letter, color, happening } in kinds {
            let answered = happening.outcomes.unwrap_or_default().iter().any(|modes| !modes.is_empty());
            let lines = if answered { happening.not_excluded() } else { happening.lines() };
            if !lines.is_empty() {
                entries.push(LegendEntry::new(format!("{letter}: {}", lines.join("\n")), LegendKey::Fill(*color)));
            }
        }
        entries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_shown_whole_except_at_poles() {
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
}
