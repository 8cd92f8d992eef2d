//! The borders that cross one edge of a cell in the plane of two parameters.

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
    /// The value of the other parameter.
    pub fixed: f64,
}

impl GridLine {
    pub fn point(self, at: f64) -> [f64; 2] {
        if self.axis == 0 { [at, self.fixed] } else { [self.fixed, at] }
    }
}

/// The regimes on both sides of a border, and the change between them.
#[derive(Debug, Clone)]
pub struct Sides {
    pub left: Arc<Regime>,
    pub right: Arc<Regime>,
    /// The transition from left (`below`) to right; `None` at a corner and along the frame.
    pub transition: Option<Arc<Transition>>,
}

impl Sides {
    pub fn reversed(&self) -> Self {
        let transition = self.transition.as_ref().map(|transition| Arc::new(transition.reversed()));
        Self { left: Arc::clone(&self.right), right: Arc::clone(&self.left), transition }
    }

    pub fn is_same_as(&self, other: &Self) -> bool {
        (&self.left, &self.right) == (&other.left, &other.right)
            && match (&self.transition, &other.transition) {
                (Some(own), Some(other)) => own.is_same_as(other),
                (own, other) => own.is_none() && other.is_none(),
            }
    }
}

/// A border that crosses an edge or passes through its end. Its left side comes before it in the edge's direction.
#[derive(Debug, Clone)]
pub struct Crossing {
    pub point: [f64; 2],
    pub sides: Sides,
}

/// An edge of a cell, from its least to its greatest place or back.
#[derive(Debug, Clone)]
pub struct Edge {
    pub line: GridLine,
    pub from: f64,
    pub to: f64,
    /// The regime at `from`.
    pub first: Arc<Regime>,
    /// All crossings, in the order from `from` to `to`.
    pub crossings: Vec<Crossing>,
}

/// A straight piece of a border, or of the frame of the map. A piece of the frame has its left regime on both sides.
#[derive(Debug, Clone)]
pub struct Segment {
    pub from: [f64; 2],
    pub to: [f64; 2],
    pub sides: Sides,
}

impl Edge {
    /// Finds all crossings between two places of a line.
    pub fn search(solver: &mut Solver, line: GridLine, [a, b]: [Probe; 2], resolution: f64) -> Self {
        let (from, to) = (a.at, b.at);
        let place = |at: f64| line.point(at).to_vec();
        let found = brackets(&mut Along { solver, place }, &a, &b, resolution);
        let (stretches, borders) = stretches(a.clone(), b, &found, resolution);
        let crossing = |bracket: &Bracket| {
            let [left, right] = [&bracket.below, &bracket.above].map(|probe| Arc::clone(&probe.regime));
            let transition = Some(Arc::new(Transition::at(solver, bracket, place)));
            Crossing { point: line.point(bracket.at()), sides: Sides { left, right, transition } }
        };
        let crossings = borders.iter().map(crossing).collect();
        let first = stretches.first().map_or(a.regime, |[first, _]| Arc::clone(&first.regime));
        Self { line, from, to, first, crossings }
    }

    pub fn last(&self) -> &Arc<Regime> {
        self.crossings.last().map_or(&self.first, |crossing| &crossing.sides.right)
    }

    pub fn part(&self, from: f64, to: f64) -> Self {
        let end = |end: f64| self.crossings.partition_point(|crossing| crossing.point[self.line.axis] <= end);
        let (begin, end) = (end(from), end(to));
        let before = self.crossings[..begin].last();
        let first = Arc::clone(before.map_or(&self.first, |crossing| &crossing.sides.right));
        Self { line: self.line, from, to, first, crossings: self.crossings[begin..end].to_vec() }
    }

    pub fn at(&self, at: f64) -> Arc<Regime> {
        self.part(at, self.to).first
    }

    /// Returns the same edge in the opposite direction.
    pub fn reversed(&self) -> Self {
        let reversed = |crossing: &Crossing| Crossing { sides: crossing.sides.reversed(), ..*crossing };
        let crossings = self.crossings.iter().rev().map(reversed).collect();
        Self { line: self.line, from: self.to, to: self.from, first: Arc::clone(self.last()), crossings }
    }

    /// Returns its pieces, each with the regime of the edge there as its left side.
    pub fn pieces(&self) -> Vec<Segment> {
        let mut pieces = Vec::new();
        let (mut from, mut regime) = (self.line.point(self.from), &self.first);
        let ends = self.crossings.iter().map(|crossing| (crossing.point, &crossing.sides.right));
        for (to, next) in ends.chain([(self.line.point(self.to), self.last())]) {
            let sides = Sides { left: Arc::clone(regime), right: Arc::clone(regime), transition: None };
            pieces.push(Segment { from, to, sides });
            (from, regime) = (to, next);
        }
        pieces
    }
}
