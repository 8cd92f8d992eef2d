//! The states of a batch, their margins as a picture, and their page.

use super::{MOST, Page, PageAxis, PageRegion, PageState};
use crate::draw::ListedKeyframe;
use crate::draw::plot::{self, Band, Color, LegendEntry, LegendKey, Mark, Panel, Picture, PlotShape, Rendered, Stroke};
use crate::impact::Verdict;
use crate::law::Mode;
use serde_json::Value;

/// States in their order, at most [`MOST`] of them: of more every second, third ... one is kept.
#[derive(Debug, Clone)]
pub struct Gait {
    states: Vec<ListedKeyframe>,
    every: usize,
    count: usize,
}

impl Default for Gait {
    fn default() -> Self {
        Self { states: Vec::new(), every: 1, count: 0 }
    }
}

/// Successive states with the same outcomes.
struct GaitRun<'g> {
    states: &'g [ListedKeyframe],
    /// Their values on the axis.
    at: &'g [f64],
}

impl Gait {
    /// Takes the next state.
    pub fn push(&mut self, state: ListedKeyframe) {
        if self.count.is_multiple_of(self.every) {
            self.states.push(state);
        }
        self.count += 1;
        if self.states.len() > MOST {
            self.every *= 2;
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
        let mut from = 0;
        self.states
            .chunk_by(|a, b| happening(a) == happening(b))
            .map(|states| {
                let at = &order[from..from + states.len()];
                from += states.len();
                GaitRun { states, at }
            })
            .collect()
    }

    /// The margins of all outcomes against time or line.
    pub fn picture(&self, robot: &str) -> Picture {
        let (name, order) = self.order();
        let runs = self.runs(&order);
        let axis = |label: &str| plot::PlotAxis { label: label.into(), ..plot::PlotAxis::default() };
        let label = if name == "time" { "time [s]" } else { name };
        let shapes = runs.iter().flat_map(GaitRun::shapes).collect();
        let bands = bands(&runs);
        let panel = Panel { size: (640.0, 260.0), bands, shapes, ..Panel::new(axis(label), axis("margin")) };
        let occurs = |kind: &StateKind| runs.iter().any(|run| run.kind() == *kind);
        let entry =
            |kind: StateKind| LegendEntry { name: kind.look().words.into(), key: LegendKey::Fill(kind.look().fill) };
        Picture {
            title: format!("{robot}: margins of all outcomes"),
            rows: vec![vec![panel]],
            legend: StateKind::ALL.into_iter().filter(occurs).map(entry).collect(),
        }
    }

    /// The page; `rendered` is the picture.
    pub fn page(&self, robot: &str, rendered: Rendered) -> Page {
        let (name, order) = self.order();
        let runs = self.runs(&order);
        let region = |run: &GaitRun| PageRegion {
            name: run.kind().look().words.into(),
            fill: run.kind().look().fill.hex(),
            borders: Vec::new(),
        };
        let numbers = runs.iter().enumerate().flat_map(|(number, run)| vec![number; run.states.len()]);
        let page_state = |(state, region): (&ListedKeyframe, usize)| {
            let line = format!("line {}", state.line);
            let name = match &state.id {
                Some(Value::String(id)) => format!("{id}, {line}"),
                Some(id) => format!("{id}, {line}"),
                None => line,
            };
            PageState { keyframe: state.keyframe.clone(), region: Some(region), name: Some(name) }
        };
        let states: Vec<PageState> = self.states.iter().zip(numbers).map(page_state).collect();
        let regions = runs.iter().map(region).collect();
        let thinned = || format!("this page shows one of every {} of the {} states", self.every, self.count);
        let notes = (self.every > 1).then(thinned).into_iter().collect();
        let axes = vec![PageAxis { name: name.into(), values: order.clone() }];
        Page::new(format!("{robot}, state by state"), axes, regions, &states, rendered, notes)
    }
}

/// More bands are not distinguishable.
const BANDS: usize = 400;

/// A band for all neighboring runs of one kind; no bands if they are not distinguishable.
fn bands(runs: &[GaitRun]) -> Vec<Band> {
    let mut bands: Vec<(StateKind, Band)> = Vec::new();
    for run in runs {
        let [Some(&from), Some(&to)] = [run.at.first(), run.at.last()] else { continue };
        match bands.last_mut() {
            Some((kind, band)) if *kind == run.kind() => band.to = to,
            last => {
                // Neighbours meet half way.
                let from = last.map_or(from, |(_, band)| {
                    band.to = 0.5 * (band.to + from);
                    band.to
                });
                bands.push((run.kind(), Band { from, to, letter: String::new(), fill: run.kind().look().fill }));
            }
        }
    }
    if bands.len() > BANDS { Vec::new() } else { bands.into_iter().map(|(_, band)| band).collect() }
}

/// The verdict, and the modes of all outcomes; `None` if the state is refused.
fn happening(state: &ListedKeyframe) -> Option<(Verdict, Vec<&[Mode]>)> {
    let answer = state.keyframe.answer.as_ref().ok()?;
    Some((answer.verdict, answer.outcomes.iter().map(|outcome| outcome.modes.as_slice()).collect()))
}

impl GaitRun<'_> {
    fn kind(&self) -> StateKind {
        let verdict = self.states.first().and_then(|state| state.keyframe.answer.as_ref().ok());
        verdict.map_or(StateKind::Refused, |answer| StateKind::Answered(answer.verdict))
    }

    /// A line for each outcome, or a mark for a single state.
    fn shapes(&self) -> Vec<PlotShape> {
        let kind = self.kind();
        let marks =
            |points| PlotShape::Marks { points, mark: kind.look().mark, color: kind.look().color, size: plot::MARK };
        let outcomes =
            |state: &ListedKeyframe| state.keyframe.answer.as_ref().map_or(0, |answer| answer.outcomes.len());
        if kind == StateKind::Refused {
            return vec![marks(self.at.iter().map(|&at| (at, 0.0)).collect())];
        }
        let curve = |outcome: usize| -> Vec<plot::PlotPoint> {
            let margin = |state: &ListedKeyframe| state.keyframe.answer.as_ref().ok()?.outcomes.get(outcome)?.margin;
            self.at.iter().zip(self.states).map(|(&at, state)| (at, margin(state).unwrap_or(f64::NAN))).collect()
        };
        let count = self.states.first().map_or(0, outcomes);
        let shape = |outcome: usize| match self.states {
            [_] => marks(curve(outcome)),
            _ => PlotShape::Line { points: curve(outcome), stroke: Stroke::solid(kind.look().color, 1.6) },
        };
        (0..count).map(shape).collect()
    }
}

/// How the states of a kind are drawn.
struct StateLook {
    words: &'static str,
    /// Of lines and marks.
    color: Color,
    /// Of bands, and of the track behind the slider.
    fill: Color,
    mark: Mark,
}

/// The answer for a state, in brief.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StateKind {
    Answered(Verdict),
    Refused,
}

impl StateKind {
    const ALL: [Self; 7] = [
        Self::Answered(Verdict::Unique),
        Self::Answered(Verdict::Ambiguous),
        Self::Answered(Verdict::None),
        Self::Answered(Verdict::Undecided),
        Self::Answered(Verdict::NoImpact),
        Self::Answered(Verdict::NoContact),
        Self::Refused,
    ];

    fn look(self) -> StateLook {
        let look = |words, color, fill, mark| StateLook { words, color, fill, mark };
        match self {
            Self::Answered(Verdict::Unique) => look("unique", Color::Blue, Color::Tint(3), Mark::Circle),
            Self::Answered(Verdict::Ambiguous) => look("ambiguous", Color::Vermilion, Color::Tint(1), Mark::Diamond),
            Self::Answered(Verdict::None) => look("none", Color::Black, Color::Tint(5), Mark::Star),
            Self::Answered(Verdict::Undecided) => look("undecided", Color::Purple, Color::Tint(5), Mark::Triangle),
            Self::Answered(Verdict::NoImpact) => look("no impact", Color::Green, Color::Tint(2), Mark::Circle),
            Self::Answered(Verdict::NoContact) => look("no contact", Color::Gray, Color::White, Mark::Ring),
            Self::Refused => look("refused", Color::Black, Color::Pale, Mark::Cross),
        }
    }
}
