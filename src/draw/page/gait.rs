//! The states of a batch: a picture of their margins and needed friction, and their page.

use super::{MOST, Page, PageAxis, PageRegion, PageState, Weight};
use crate::draw::plot::{
    self, Band, Color, Dash, LegendEntry, LegendKey, Mark, Panel, Picture, PlotAxis, PlotShape, Rendered, Stroke,
};
use crate::draw::{Forward, KeyframeAnswer, ListedKeyframe};
use crate::error::visible;
use crate::pipeline::Aspect;
use crate::write::words;
use crate::{Friction, Mode, Verdict};

/// States in their order. If there are more than [`MOST`], every second, fourth, eighth ... is kept.
#[derive(Debug, Clone, Default)]
pub struct Gait {
    forward: Forward,
    /// Whether the states are single moments, with nothing known about the time between them.
    apart: bool,
    states: Vec<ListedKeyframe>,
    /// The different frictions of the contacts of all states, including states that are not kept; at most two of them.
    frictions: Vec<Friction>,
    halvings: u32,
    count: usize,
}

impl Gait {
    /// Creates a gait without states. `apart` says whether its states will be single moments.
    pub fn new(forward: Forward, apart: bool) -> Self {
        Self { forward, apart, ..Self::default() }
    }

    /// Adds the next state.
    pub fn push(&mut self, mut state: ListedKeyframe) {
        for contact in state.keyframe.drawing.iter().flat_map(|drawing| &drawing.contacts) {
            if self.frictions.len() < 2 && !self.frictions.contains(&contact.friction) {
                self.frictions.push(contact.friction);
            }
        }
        if self.count.is_multiple_of(1 << self.halvings) {
            state.keyframe.face(self.forward);
            self.states.push(state);
        }
        self.count += 1;
        if self.states.len() > MOST {
            self.halvings += 1;
            let mut kept = [true, false].into_iter().cycle();
            self.states.retain(|_| kept.next().unwrap_or(true));
        }
    }

    /// Returns what orders the states: their times if all have one and none decreases, else their lines.
    fn order(&self) -> (&'static str, Vec<f64>) {
        let times: Option<Vec<f64>> = self.states.iter().map(|state| state.time).collect();
        match times.filter(|times| times.is_sorted()) {
            Some(times) => ("time", times),
            None => ("line", self.states.iter().map(|state| state.line as f64).collect()),
        }
    }

    /// Groups successive states with the same verdict and outcomes.
    fn runs(&self) -> impl Iterator<Item = &[ListedKeyframe]> {
        self.states.chunk_by(|a, b| happening(a) == happening(b))
    }

    /// Returns the picture of the margins and needed friction of the contacts of every impact.
    pub fn picture(&self, robot: &str) -> Picture {
        let (name, order) = self.order();
        let label = if name == "time" { "time [s]" } else { name };
        let span = plot::range(order.iter().copied()).unwrap_or_default();
        let room = if span.0 < span.1 { 0.04 * (span.1 - span.0) } else { ALONE };
        let range = (span.0 - room, span.1 + room);
        let x = PlotAxis { range: Some(range), ..PlotAxis::new(label) };
        let contacts = |(_, state, _): (_, &ListedKeyframe, _)| Some(state.keyframe.drawing.as_ref()?.contacts.len());
        let crowd = self.impacts().filter_map(contacts).max().unwrap_or(0);
        let beside = BESIDE.min(0.8 * WIDTH / (crowd * self.impacts().count()) as f64);
        let size = plot::MARK.min(0.5 * beside).max(2.0);
        // The band of a single moment is as wide as its marks.
        let apart = 0.5 * (crowd + 1) as f64 * beside * (range.1 - range.0) / WIDTH;
        let reach = if self.apart { apart } else { f64::INFINITY };
        let (feet, marks) = self.marks(&order, beside * (range.1 - range.0) / WIDTH);
        let values: [(&str, MarkValue); 2] =
            [("margin", |mark| mark.margin), ("friction needed", |mark| mark.friction)];
        let panel = |(quantity, value)| panel(quantity, x.clone(), &marks, size, value);
        let mut panels: Vec<Panel> = values.into_iter().filter_map(panel).collect();
        // In the last panel, that of needed friction, a line marks the friction of all contacts unless it is far above.
        let is_near = |mu: f64| {
            marks.iter().filter_map(|mark| mark.friction).any(|needed| needed.is_finite() && mu < FAR * needed)
        };
        let given_friction = self.friction().filter(|&mu| is_near(mu));
        if let (Some(mu), Some(needed)) = (given_friction, panels.last_mut()) {
            needed.y.range = None;
            needed.shapes.insert(0, PlotShape::Line { points: vec![(range.0, mu), (range.1, mu)], stroke: GIVEN });
        }
        if panels.is_empty() {
            let y = PlotAxis { bare: true, ..PlotAxis::default() };
            panels.push(Panel { size: (WIDTH, 60.0), ..Panel::new(x, y) });
        }
        let aspect = self.impacts().next().map_or(Aspect::default(), |(.., answer)| answer.aspect);
        let given = words::Wording::of(aspect).drawn.given.0;
        let last = panels.len() - 1;
        for (at, panel) in panels.iter_mut().enumerate() {
            (panel.bands, panel.x.bare) = (bands(&self.states, &order, reach), at < last);
        }
        if crowd > 1 {
            let more = panels[0].title.replace('\n', ", ");
            panels[0].title = format!("\ncontacts of one state stand side by side{more}");
        }
        let looks = LOOKS.into_iter().filter(|candidate| self.states.iter().any(|state| look(state) == *candidate));
        let entry = |name: &str, key| LegendEntry::new(name, key);
        let feet = feet.iter().enumerate();
        let legend = feet.map(|(foot, name)| entry(name, LegendKey::Mark(Mark::Circle, FEET[foot % FEET.len()])));
        let shapes = MODES.iter().filter(|(mode, ..)| marks.iter().any(|mark| mark.mode == *mode));
        let legend = legend.chain(shapes.map(|(_, shape, words)| entry(words, LegendKey::Mark(*shape, Color::Gray))));
        let line = given_friction.map(|mu| entry(&format!("friction {mu}"), LegendKey::Line(GIVEN)));
        let legend = legend.chain(line);
        let (count, all, remark) = (self.impacts().count(), self.states.len(), self.forward.remark());
        Picture {
            title: format!("{robot}: {count} of {all} states have {given}s{remark}"),
            rows: panels.into_iter().map(|panel| vec![panel]).collect(),
            legend: legend.chain(looks.map(|(_, words, fill)| entry(words, LegendKey::Fill(fill)))).collect(),
        }
    }

    /// Returns the states whose verdict is neither no impact, no contact nor none, with their indices and answers.
    fn impacts(&self) -> impl Iterator<Item = (usize, &ListedKeyframe, &KeyframeAnswer)> {
        self.states.iter().enumerate().filter_map(|(number, state)| {
            let answer = state.keyframe.answer.as_ref().ok()?;
            let happens = !matches!(answer.verdict, Verdict::NoImpact | Verdict::NoContact | Verdict::None);
            happens.then_some((number, state, answer))
        })
    }

    /// Returns the friction of all contacts; `None` if it differs between contacts, is infinite or is not positive.
    fn friction(&self) -> Option<f64> {
        let [Friction::Finite(mu)] = self.frictions[..] else { return None };
        (mu > 0.0).then_some(mu)
    }

    /// Returns the names of the feet, and a mark for each contact in each outcome of every impact. The marks of one
    /// outcome are `beside` apart along x.
    fn marks(&self, order: &[f64], beside: f64) -> (Vec<String>, Vec<GaitMark>) {
        let (mut feet, mut marks): (Vec<String>, Vec<GaitMark>) = (Vec::new(), Vec::new());
        for (number, state, answer) in self.impacts() {
            let contacts = state.keyframe.drawing.as_ref().map_or(&[][..], |drawing| &drawing.contacts);
            let middle = 0.5 * contacts.len().saturating_sub(1) as f64;
            for outcome in &answer.outcomes {
                for (at, (contact, &mode)) in contacts.iter().zip(&outcome.modes).enumerate() {
                    let link = visible(&contact.link).into_owned();
                    let known = feet.iter().position(|foot| *foot == link);
                    let foot = known.unwrap_or(feet.len());
                    feet.extend(known.is_none().then_some(link));
                    let place = order[number] + beside * (at as f64 - middle);
                    // For a contact that slides, it is the friction with which no contact would slide.
                    let friction = outcome.friction_needed.get(at).copied().flatten().or(answer.friction_needed);
                    let friction = friction.filter(|_| mode != Mode::Separate);
                    marks.push(GaitMark { foot, mode, at: place, margin: outcome.margin, friction });
                }
            }
        }
        (feet, marks)
    }

    /// Creates the page of all states with this picture.
    pub fn page(&self, robot: &str, rendered: Rendered) -> Page {
        let (name, order) = self.order();
        let region = |run: &[ListedKeyframe]| {
            let (_, words, fill) = look(&run[0]);
            PageRegion { name: words.into(), fill: fill.hex(), borders: Vec::new() }
        };
        let numbers = self.runs().enumerate().flat_map(|(number, run)| vec![number; run.len()]);
        let page_state = |(state, region): (&ListedKeyframe, usize)| {
            let line = format!("line {}", state.line);
            let name = state.id.as_ref().map_or(line.clone(), |id| format!("{}, {line}", visible(&words::id(id))));
            PageState { keyframe: state.keyframe.clone(), region: Some(region), name: Some(name) }
        };
        let states: Vec<PageState> = self.states.iter().zip(numbers).map(page_state).collect();
        let regions = self.runs().map(region).collect();
        let thinned = || format!("this page shows one of every {} of the {} states", 1 << self.halvings, self.count);
        let notes = (self.halvings > 0).then(thinned).into_iter().collect();
        let axes = vec![PageAxis { name: name.into(), values: order.clone() }];
        let title = format!("{}, state by state", visible(robot));
        Page { title, axes, regions, notes, ..Page::of(&states, Weight::SIZE, rendered) }
    }
}

/// The largest number of bands that are distinguishable.
const BANDS: usize = 160;
/// How far the axis of a single state reaches on each side, in units of the axis.
const ALONE: f64 = 0.5;

/// Returns a band for each run of neighboring states with the same verdict. A band extends from its states half way to
/// the next one, and at most by `reach`. Returns no bands if there are too many to distinguish.
fn bands(states: &[ListedKeyframe], order: &[f64], reach: f64) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    let mut last = None;
    for (number, ((answer, _, fill), &at)) in states.iter().map(look).zip(order).enumerate() {
        let half = |other: Option<&f64>| other.map(|other| 0.5 * (other - at).abs());
        let before = number.checked_sub(1).and_then(|before| order.get(before));
        let [before, after] = [before, order.get(number + 1)].map(half);
        // The first and the last state are in the middle of their parts, and a single state in that of the axis.
        let side = |own: Option<f64>, other: Option<f64>| own.or(other).unwrap_or(ALONE).min(reach);
        let (from, to) = (at - side(before, after), at + side(after, before));
        match bands.last_mut() {
            Some(band) if last == Some(answer) && before.is_some_and(|half| half <= reach) => band.to = to,
            _ => bands.push(Band { from, to, letter: String::new(), fill }),
        }
        last = Some(answer);
    }
    if bands.len() > BANDS { Vec::new() } else { bands }
}

/// Returns the verdict and the modes of all outcomes; `None` if there is no answer.
fn happening(state: &ListedKeyframe) -> Option<(Verdict, Vec<&[Mode]>)> {
    let answer = state.keyframe.answer.as_ref().ok()?;
    Some((answer.verdict, answer.outcomes.iter().map(|outcome| &*outcome.modes).collect()))
}

/// The mark of a contact in an outcome: the index of its foot, its mode, its place along x and its values.
struct GaitMark {
    foot: usize,
    mode: Mode,
    at: f64,
    margin: Option<f64>,
    friction: Option<f64>,
}

/// Returns the value of a mark that a panel shows.
type MarkValue = fn(&GaitMark) -> Option<f64>;

/// The width inside the axes, and the largest distance between the contacts of one outcome \[px\].
const WIDTH: f64 = 640.0;
const BESIDE: f64 = 9.0;
/// An axis is logarithmic if the largest value exceeds the least positive one by this factor.
const DECADES: f64 = 50.0;
/// Values that hardly differ have room on each side of their range: this share of the largest value.
const FLAT: f64 = 0.1;

/// The colors of feet, in turn.
const FEET: [Color; 6] = [Color::Blue, Color::Vermilion, Color::Green, Color::Purple, Color::Black, Color::Orange];

/// The line of the given friction. It is drawn if this friction is less than `FAR` times the friction that a contact
/// needs.
const FAR: f64 = 10.0;
const GIVEN: Stroke = Stroke { dash: Dash::DASHED, ..Stroke::solid(Color::Gray, 1.4) };

/// The marks of modes.
const MODES: [(Mode, Mark, &str); 4] = [
    (Mode::Separate, Mark::Triangle, "lifts off"),
    (Mode::Stick, Mark::Circle, "sticks"),
    (Mode::SlidePlus, Mark::Right, "slides forward"),
    (Mode::SlideMinus, Mark::Left, "slides backward"),
];

/// Returns the panel of a quantity of contacts; `None` if no contact has a finite value.
fn panel(label: &str, x: PlotAxis, marks: &[GaitMark], size: f64, value: MarkValue) -> Option<Panel> {
    let finite = |mark: &GaitMark| value(mark).filter(|value| value.is_finite());
    let (low, most) = plot::range(marks.iter().filter_map(finite))?;
    let positive = plot::range(marks.iter().filter_map(finite).filter(|value| *value > 0.0));
    let least = positive.map(|(least, _)| least).filter(|least| low >= 0.0 && most > DECADES * least);
    // Zero has no place on a logarithmic axis.
    let zero = least.map(|least| 0.1 * least);
    let place = |value: f64| zero.map_or(value, |zero| value.max(zero));
    let has_zero = zero.is_some() && marks.iter().filter_map(finite).any(|value| value == 0.0);
    let points = marks.iter().filter_map(|mark| Some(((mark.foot, mark.mode), (mark.at, place(finite(mark)?)))));
    let shape = |((foot, mode), points)| {
        let mark = MODES.iter().find(|look| look.0 == mode).map_or(Mark::Cross, |look| look.1);
        PlotShape::Marks { points, mark, color: FEET[foot % FEET.len()], size }
    };
    let shapes = words::grouped(points).into_iter().map(shape).collect();
    let room = FLAT * most.abs();
    let range = (zero.is_none() && most - low < 0.1 * room).then_some((low - room, most + room));
    let y = PlotAxis { logarithmic: zero.is_some(), range, ..PlotAxis::new(label) };
    let title = if has_zero { "\nthe lowest marks are zero".to_owned() } else { String::new() };
    Some(Panel { title, size: (WIDTH, 180.0), shapes, ..Panel::new(x, y) })
}

/// A verdict, or `None` if there is no answer, its name, and the color of its bands in the picture and behind the
/// slider.
type StateLook = (Option<Verdict>, &'static str, Color);

const LOOKS: [StateLook; 7] = [
    (Some(Verdict::Unique), "unique", Color::Tint(0)),
    (Some(Verdict::Ambiguous), "ambiguous", Color::Tint(1)),
    (Some(Verdict::None), "none", Color::Tint(5)),
    (Some(Verdict::Undecided), "undecided", Color::Tint(11)),
    (Some(Verdict::NoImpact), "no impact", Color::Tint(2)),
    (Some(Verdict::NoContact), "no contact", Color::White),
    (None, "refused", Color::Pale),
];

fn look(state: &ListedKeyframe) -> StateLook {
    let answer = state.keyframe.answer.as_ref().ok().map(|answer| answer.verdict);
    LOOKS.into_iter().find(|look| look.0 == answer).unwrap_or(LOOKS[0])
}
