//! The states of a batch, their margins as a picture, and their page.

use super::{Axis, Page, Region, STILLS, Still};
use crate::draw::ListedKeyframe;
use crate::draw::plot::{
    self, Arrangement, Band, Color, Legend, LegendEntry, LegendKey, Mark, Panel, Picture, Rendered, Shape, Stroke,
};
use crate::impact::Verdict;
use crate::law::Mode;
use serde_json::Value;

/// States in their order, at most [`STILLS`] of them: of more every second, third ... one is kept.
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

/// States that follow each other and have the same outcomes.
struct Run<'g> {
    states: &'g [ListedKeyframe],
    /// What the first one is called on the axis, and the others.
    at: &'g [f64],
}

impl Gait {
    /// Takes the next state.
    pub fn push(&mut self, state: ListedKeyframe) {
        if self.count.is_multiple_of(self.every) {
            self.states.push(state);
        }
        self.count += 1;
        if self.states.len() > STILLS {
            self.every *= 2;
            let mut kept = [true, false].into_iter().cycle();
            self.states.retain(|_| kept.next().unwrap_or(true));
        }
    }

    /// What the states are ordered by: their times where all have one that does not fall back, else their lines.
    fn order(&self) -> (&'static str, Vec<f64>) {
        let times: Option<Vec<f64>> = self.states.iter().map(|state| state.time).collect();
        match times.filter(|times| times.is_sorted()) {
            Some(times) => ("time", times),
            None => ("line", self.states.iter().map(|state| state.line as f64).collect()),
        }
    }

    fn runs<'g>(&'g self, order: &'g [f64]) -> Vec<Run<'g>> {
        let mut from = 0;
        self.states
            .chunk_by(|a, b| happening(a) == happening(b))
            .map(|states| {
                let at = &order[from..from + states.len()];
                from += states.len();
                Run { states, at }
            })
            .collect()
    }

    /// The margins of all outcomes against time or line.
    pub fn picture(&self, robot: &str) -> Picture {
        let (name, order) = self.order();
        let runs = self.runs(&order);
        let axis = |label: &str| plot::PlotAxis { label: label.into(), ..plot::PlotAxis::default() };
        let label = if name == "time" { "time [s]" } else { name };
        let shapes = runs.iter().flat_map(Run::shapes).collect();
        let bands = bands(&runs);
        let panel = Panel { size: (640.0, 260.0), bands, shapes, ..Panel::new(axis(label), axis("margin")) };
        let told = |kind: &Kind| runs.iter().any(|run| run.kind() == *kind);
        let entry = |kind: Kind| LegendEntry { name: kind.words().into(), key: LegendKey::Fill(kind.fill()) };
        Picture {
            title: format!("{robot}: margins of all outcomes"),
            rows: vec![vec![panel]],
            legend: Legend {
                entries: Kind::ALL.into_iter().filter(told).map(entry).collect(),
                arrangement: Arrangement::Rows,
            },
        }
    }

    /// The page; `rendered` is the picture.
    pub fn page(&self, robot: &str, rendered: Rendered) -> Page {
        let (name, order) = self.order();
        let runs = self.runs(&order);
        let region =
            |run: &Run| Region { name: run.kind().words().into(), fill: run.kind().fill().hex(), borders: Vec::new() };
        let numbers = runs.iter().enumerate().flat_map(|(number, run)| vec![number; run.states.len()]);
        let still = |(state, region): (&ListedKeyframe, usize)| {
            let line = format!("line {}", state.line);
            let name = match &state.id {
                Some(Value::String(id)) => format!("{id}, {line}"),
                Some(id) => format!("{id}, {line}"),
                None => line,
            };
            Still { keyframe: state.keyframe.clone(), region: Some(region), name: Some(name) }
        };
        let stills: Vec<Still> = self.states.iter().zip(numbers).map(still).collect();
        let regions = runs.iter().map(region).collect();
        let thinned = || format!("this page shows one of every {} of the {} states", self.every, self.count);
        let notes = (self.every > 1).then(thinned).into_iter().collect();
        let axes = vec![Axis { name: name.into(), values: order.clone() }];
        Page::new(format!("{robot}, state by state"), axes, regions, &stills, rendered, notes)
    }
}

/// So many bands are seen apart.
const BANDS: usize = 400;

/// A band for all neighbouring runs of one kind, if they can be seen apart.
fn bands(runs: &[Run]) -> Vec<Band> {
    let mut bands: Vec<(Kind, Band)> = Vec::new();
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
                bands.push((run.kind(), Band { from, to, letter: String::new(), fill: run.kind().fill() }));
            }
        }
    }
    if bands.len() > BANDS { Vec::new() } else { bands.into_iter().map(|(_, band)| band).collect() }
}

/// The verdict, and the modes of all outcomes; nothing of what is refused.
fn happening(state: &ListedKeyframe) -> Option<(Verdict, Vec<&[Mode]>)> {
    let answer = state.keyframe.answer.as_ref().ok()?;
    Some((answer.verdict, answer.outcomes.iter().map(|outcome| outcome.modes.as_slice()).collect()))
}

impl Run<'_> {
    fn kind(&self) -> Kind {
        let verdict = self.states.first().and_then(|state| state.keyframe.answer.as_ref().ok());
        verdict.map_or(Kind::Refused, |answer| Kind::Answered(answer.verdict))
    }

    /// A line for each outcome, or a mark where there is a single state.
    fn shapes(&self) -> Vec<Shape> {
        let kind = self.kind();
        let marks = |points| Shape::Marks { points, mark: kind.mark(), color: kind.color(), size: plot::MARK };
        let outcomes =
            |state: &ListedKeyframe| state.keyframe.answer.as_ref().map_or(0, |answer| answer.outcomes.len());
        if kind == Kind::Refused {
            return vec![marks(self.at.iter().map(|&at| (at, 0.0)).collect())];
        }
        let curve = |outcome: usize| -> Vec<plot::PlotPoint> {
            let margin = |state: &ListedKeyframe| state.keyframe.answer.as_ref().ok()?.outcomes.get(outcome)?.margin;
            self.at.iter().zip(self.states).map(|(&at, state)| (at, margin(state).unwrap_or(f64::NAN))).collect()
        };
        let count = self.states.first().map_or(0, outcomes);
        let shape = |outcome: usize| match self.states {
            [_] => marks(curve(outcome)),
            _ => Shape::Line { points: curve(outcome), stroke: Stroke::solid(kind.color(), 1.6) },
        };
        (0..count).map(shape).collect()
    }
}

/// What is said of a state at a glance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Answered(Verdict),
    Refused,
}

impl Kind {
    const ALL: [Self; 7] = [
        Self::Answered(Verdict::Unique),
        Self::Answered(Verdict::Ambiguous),
        Self::Answered(Verdict::None),
        Self::Answered(Verdict::Undecided),
        Self::Answered(Verdict::NoImpact),
        Self::Answered(Verdict::NoContact),
        Self::Refused,
    ];

    fn words(self) -> &'static str {
        match self {
            Self::Answered(Verdict::Unique) => "unique",
            Self::Answered(Verdict::Ambiguous) => "ambiguous",
            Self::Answered(Verdict::None) => "none",
            Self::Answered(Verdict::Undecided) => "undecided",
            Self::Answered(Verdict::NoImpact) => "no impact",
            Self::Answered(Verdict::NoContact) => "no contact",
            Self::Refused => "refused",
        }
    }

    fn color(self) -> Color {
        match self {
            Self::Answered(Verdict::Unique) => Color::Blue,
            Self::Answered(Verdict::Ambiguous) => Color::Vermilion,
            Self::Answered(Verdict::None) | Self::Refused => Color::Black,
            Self::Answered(Verdict::Undecided) => Color::Purple,
            Self::Answered(Verdict::NoImpact) => Color::Green,
            Self::Answered(Verdict::NoContact) => Color::Gray,
        }
    }

    /// Behind the slider and under words.
    fn fill(self) -> Color {
        match self {
            Self::Answered(Verdict::Unique) => Color::Tint(3),
            Self::Answered(Verdict::Ambiguous) => Color::Tint(1),
            Self::Answered(Verdict::None | Verdict::Undecided) => Color::Tint(5),
            Self::Answered(Verdict::NoImpact) => Color::Tint(2),
            Self::Answered(Verdict::NoContact) => Color::White,
            Self::Refused => Color::Pale,
        }
    }

    fn mark(self) -> Mark {
        match self {
            Self::Answered(Verdict::Ambiguous) => Mark::Diamond,
            Self::Answered(Verdict::None) => Mark::Star,
            Self::Answered(Verdict::Undecided) => Mark::Triangle,
            Self::Answered(Verdict::NoContact) => Mark::Ring,
            Self::Answered(Verdict::Unique | Verdict::NoImpact) => Mark::Circle,
            Self::Refused => Mark::Cross,
        }
    }
}
