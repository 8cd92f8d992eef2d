//! The borders that cross an edge of a cell in the plane of two parameters.

use super::line::{Along, Bracket, Probe, brackets, stretches};
use super::model::Solver;
use super::regime::Regime;
use super::transition::Transition;
use std::sync::Arc;

/// A line of the plane, parallel to an axis.
#[derive(Debug, Clone, Copy)]
pub struct GridLine {
    /// The parameter that varies.
    pub axis: usize,
    /// The other one's value.
    pub fixed: f64,
}

impl GridLine {
    pub fn point(self, at: f64) -> [f64; 2] {
        if self.axis == 0 { [at, self.fixed] } else { [self.fixed, at] }
    }
}

/// A border that crosses an edge.
#[derive(Debug, Clone)]
pub struct Crossing {
    pub at: f64,
    /// The regimes at smaller and at greater values.
    pub below: Arc<Regime>,
    pub above: Arc<Regime>,
    pub transition: Arc<Transition>,
}

/// An edge of a cell, from its least to its greatest place.
#[derive(Debug, Clone)]
pub struct Edge {
    pub line: GridLine,
    pub from: f64,
    pub to: f64,
    /// The regime at `from`.
    pub first: Arc<Regime>,
    /// In ascending order.
    pub crossings: Vec<Crossing>,
}

/// In which direction an edge is walked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    Forward,
    Backward,
}

/// A straight piece of a border, or of the frame around everything.
#[derive(Debug, Clone)]
pub struct Segment {
    pub from: [f64; 2],
    pub to: [f64; 2],
    /// The regime on its left.
    pub left: Arc<Regime>,
    /// The regime on its right; of the frame the left one.
    pub right: Arc<Regime>,
    /// What changes, with `left` below; `None` for the frame.
    pub transition: Option<Arc<Transition>>,
}

impl Edge {
    /// Finds all crossings between two places of a line.
    pub fn search(solver: &mut Solver, line: GridLine, [a, b]: [Probe; 2], resolution: f64) -> Self {
        let (from, to) = (a.at, b.at);
        let place = |at: f64| line.point(at).to_vec();
        let found = brackets(&mut Along { solver, place }, &a, &b, resolution);
        let (stretches, borders) = stretches(a.clone(), b, &found, resolution);
        let crossing = |bracket: &Bracket| Crossing {
            at: bracket.at(),
            below: Arc::clone(&bracket.below.regime),
            above: Arc::clone(&bracket.above.regime),
            transition: Arc::new(Transition::at(solver, bracket, place)),
        };
        let crossings = borders.iter().map(crossing).collect();
        let first = stretches.first().map_or(a.regime, |stretch| Arc::clone(&stretch.regime));
        Self { line, from, to, first, crossings }
    }

    pub fn last(&self) -> &Arc<Regime> {
        self.crossings.last().map_or(&self.first, |crossing| &crossing.above)
    }

    pub fn part(&self, from: f64, to: f64) -> Self {
        let before = self.crossings.iter().rfind(|crossing| crossing.at <= from);
        let inside = |crossing: &&Crossing| from < crossing.at && crossing.at <= to;
        Self {
            line: self.line,
            from,
            to,
            first: Arc::clone(before.map_or(&self.first, |crossing| &crossing.above)),
            crossings: self.crossings.iter().filter(inside).cloned().collect(),
        }
    }

    pub fn at(&self, at: f64) -> Arc<Regime> {
        self.part(at, self.to).first
    }

    /// Its pieces of one regime each, which lies on their left.
    pub fn pieces(&self, direction: Direction) -> Vec<Segment> {
        let mut pieces = Vec::new();
        let (mut from, mut regime) = (self.from, &self.first);
        let ends = self.crossings.iter().map(|crossing| (crossing.at, &crossing.above)).chain([(self.to, self.last())]);
        for (to, next) in ends {
            let [a, b] = [from, to].map(|at| self.line.point(at));
            let (a, b) = if direction == Direction::Forward { (a, b) } else { (b, a) };
            let (left, right) = (Arc::clone(regime), Arc::clone(regime));
            pieces.push(Segment { from: a, to: b, left, right, transition: None });
            (from, regime) = (to, next);
        }
        pieces
    }
}
