//! The states of a batch, their margins as a picture, and their page.

use super::{MOST, Page, PageAxis, PageRegion, PageState};
use crate::draw::ListedKeyframe;
use crate::draw::plot::{
    self, Band, Color, LegendEntry, LegendKey, Mark, Panel, Picture, PlotAxis, PlotShape, Rendered, Stroke,
};
use crate::write::words;
use crate::{Mode, Verdict};

/// States in their order, at most [`MOST`] of them: of more every second, third ... one is kept.
#[derive(Debug, Clone, Default)]
pub struct Gait {
    states: Vec<ListedKeyframe>,
    halvings: u32,
    count: usize,
}

/// Successive states with the same outcomes, at least one, and their values on the axis.
struct GaitRun<'g> {
    states: &'g [ListedKeyframe],
    at: &'g [f64],
}

impl Gait {
    pub fn push(&mut self, state: ListedKeyframe) {
        if self.count.is_multiple_of(1 << self.halvings) {
            self.states.push(state);
        }
        self.count += 1;
        if self.states.len() > MOST {
            self.halvings += 1;
            let mut kept = [true, false].into_iter().cycle();
            self.states.retain(|_| kept.next().unwrap_or(true));
        }
    }

    /// The order of the states: their times if all have one and none decreases, else their lines.
    fn order(&self) -> (&'static str, Vec<f64>) {
        let times: Option<Vec<f64>> = self.states.iter().map(|state| state.time).collect();
        match times.filter(|times| times.is_sorted()) {
            Some(times) => ("time", times),
            None => ("line", self.states.iter().map(|state| state.line as f64).collect()),
        }
    }

    fn runs<'g>(&'g self, order: &'g [f64]) -> Vec<GaitRun<'g>> {
        let mut rest = order;
        let runs = self.states.chunk_by(|a, b| happening(a) == happening(b)).map(|states| {
            let (at, later) = rest.split_at(states.len());
            rest = later;
            GaitRun { states, at }
        });
        runs.collect()
    }

    pub fn picture(&self, robot: &str) -> Picture {
        let (name, order) = self.order();
        let runs = self.runs(&order);
        let label = if name == "time" { "time [s]" } else { name };
        let shapes = runs.iter().flat_map(GaitRun::shapes).collect();
        let axes = Panel::new(PlotAxis::new(label), PlotAxis::new("margin"));
        let looks = LOOKS.iter().filter(|look| runs.iter().any(|run| run.look().answer == look.answer));
        Picture {
            title: format!("{robot}: margins of all outcomes; marks are single states"),
            rows: vec![vec![Panel { size: (640.0, 260.0), bands: bands(&runs), shapes, ..axes }]],
            legend: looks.map(|look| LegendEntry::new(look.words, LegendKey::Fill(look.fill))).collect(),
        }
    }

    pub fn page(&self, robot: &str, rendered: Rendered) -> Page {
        let (name, order) = self.order();
        let runs = self.runs(&order);
        let region = |run: &GaitRun| {
            let StateLook { words, fill, .. } = run.look();
            PageRegion { name: (*words).into(), fill: fill.hex(), borders: Vec::new() }
        };
        let numbers = runs.iter().enumerate().flat_map(|(number, run)| vec![number; run.states.len()]);
        let page_state = |(state, region): (&ListedKeyframe, usize)| {
            let line = format!("line {}", state.line);
            let name = state.id.as_ref().map_or(line.clone(), |id| format!("{}, {line}", words::id(id)));
            PageState { keyframe: state.keyframe.clone(), region: Some(region), name: Some(name) }
        };
        let states: Vec<PageState> = self.states.iter().zip(numbers).map(page_state).collect();
        let regions = runs.iter().map(region).collect();
        let thinned = || format!("this page shows one of every {} of the {} states", 1 << self.halvings, self.count);
        let notes = (self.halvings > 0).then(thinned).into_iter().collect();
        let axes = vec![PageAxis { name: name.into(), values: order.clone() }];
        let title = format!("{robot}, state by state");
        Page { title, axes, regions, notes, ..Page::of(&states, rendered) }
    }
}

/// More bands are not distinguishable.
const BANDS: usize = 400;

/// A band for all neighboring runs of one kind; no bands if they are not distinguishable.
fn bands(runs: &[GaitRun]) -> Vec<Band> {
    let mut bands: Vec<Band> = Vec::new();
    let mut last = None;
    for run in runs {
        let (from, to, look) = (run.at[0], run.at[run.at.len() - 1], run.look());
        match bands.last_mut() {
            Some(band) if last == Some(look.answer) => band.to = to,
            before => {
                // Neighbors meet half way.
                let from = before.map_or(from, |band| {
                    band.to = 0.5 * (band.to + from);
                    band.to
                });
                bands.push(Band { from, to, letter: String::new(), fill: look.fill });
            }
        }
        last = Some(look.answer);
    }
    if bands.len() > BANDS { Vec::new() } else { bands }
}

/// The verdict, and the modes of all outcomes; `None` if the state is refused.
fn happening(state: &ListedKeyframe) -> Option<(Verdict, Vec<&[Mode]>)> {
    let answer = state.keyframe.answer.as_ref().ok()?;
    Some((answer.verdict, answer.outcomes.iter().map(|outcome| &*outcome.modes).collect()))
}

impl GaitRun<'_> {
    fn look(&self) -> &'static StateLook {
        let answer = self.states[0].keyframe.answer.as_ref().ok().map(|answer| answer.verdict);
        LOOKS.iter().find(|look| look.answer == answer).unwrap_or(&LOOKS[0])
    }

    /// A line for each outcome, or a mark for a single state.
    fn shapes(&self) -> Vec<PlotShape> {
        let StateLook { answer, color, mark, .. } = *self.look();
        let marks = |points| PlotShape::Marks { points, mark, color, size: plot::MARK };
        if answer.is_none() {
            return vec![marks(self.at.iter().map(|&at| (at, 0.0)).collect())];
        }
        let curve = |outcome: usize| -> Vec<plot::PlotPoint> {
            let margin = |state: &ListedKeyframe| state.keyframe.answer.as_ref().ok()?.outcomes.get(outcome)?.margin;
            self.at.iter().zip(self.states).map(|(&at, state)| (at, margin(state).unwrap_or(f64::NAN))).collect()
        };
        let outcomes = self.states[0].keyframe.answer.as_ref().map_or(0, |answer| answer.outcomes.len());
        let shape = |outcome: usize| match self.states {
            [_] => marks(curve(outcome)),
            _ => PlotShape::Line { points: curve(outcome), stroke: Stroke::solid(color, 1.6) },
        };
        (0..outcomes).map(shape).collect()
    }
}

struct StateLook {
    /// `None` if they are refused.
    answer: Option<Verdict>,
    words: &'static str,
    /// Of lines and marks.
    color: Color,
    /// Of bands, and of the track behind the slider.
    fill: Color,
    mark: Mark,
}

static LOOKS: [StateLook; 7] = {
    const fn look(answer: Option<Verdict>, words: &'static str, color: Color, fill: Color, mark: Mark) -> StateLook {
        StateLook { answer, words, color, fill, mark }
    }
    [
        look(Some(Verdict::Unique), "unique", Color::Blue, Color::Tint(3), Mark::Circle),
        look(Some(Verdict::Ambiguous), "ambiguous", Color::Vermilion, Color::Tint(1), Mark::Diamond),
        look(Some(Verdict::None), "none", Color::Black, Color::Tint(5), Mark::Star),
        look(Some(Verdict::Undecided), "undecided", Color::Purple, Color::Tint(5), Mark::Triangle),
        look(Some(Verdict::NoImpact), "no impact", Color::Green, Color::Tint(2), Mark::Circle),
        look(Some(Verdict::NoContact), "no contact", Color::Gray, Color::White, Mark::Ring),
        look(None, "refused", Color::Black, Color::Pale, Mark::Cross),
    ]
};
