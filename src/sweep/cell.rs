//! The borders within one cell of the plane of two parameters.

use super::line::{Bracket, Point, RESOLUTION, brackets, stretches};
use super::map::{Along, place};
use super::model::Solver;
use super::regime::Regime;
use super::transition::Transition;
use crate::planar::Vector;
use std::sync::Arc;

/// How often a cell is quartered, and how many cells come of one at most.
const QUARTERINGS: usize = 9;
const MOST_CELLS: usize = 400;

/// How far a curve may be from its chord, as part of the ranges, and to what its points between crossings are bisected.
const SEEN: f64 = 5e-5;
const FOUND: f64 = 1e-9;

/// How often a chord is halved.
const BENDS: usize = 6;

/// Where a cell is halved: beside its middle, which may be a special place.
const HALF: f64 = 0.506_17;

/// A border that crosses an edge.
#[derive(Debug, Clone)]
pub struct Crossing {
    /// Where.
    pub at: f64,
    /// The regimes at smaller and at greater values.
    pub below: Arc<Regime>,
    pub above: Arc<Regime>,
    pub turns: Arc<Transition>,
}

/// An edge of a cell, from its least to its greatest place.
#[derive(Debug, Clone)]
pub struct Edge {
    pub from: f64,
    pub to: f64,
    /// The regime at its beginning.
    pub first: Arc<Regime>,
    /// In ascending order.
    pub crossings: Vec<Crossing>,
}

/// In which direction an edge is walked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    Forward,
    Backward,
}

/// A piece of a border, or of the frame around everything.
#[derive(Debug, Clone)]
pub struct Segment {
    pub from: Vector<f64>,
    pub to: Vector<f64>,
    /// The regime on its left.
    pub left: Arc<Regime>,
    /// On its right; of the frame that on its left.
    pub right: Arc<Regime>,
    /// What turns; none of the frame.
    pub turns: Option<Arc<Transition>>,
}

/// A cell: its least and its greatest corner, and its edges below, to the right, above and to the left.
#[derive(Debug, Clone)]
pub struct Cell {
    pub corners: [Vector<f64>; 2],
    pub edges: [Edge; 4],
}

/// Traces borders through cells.
pub struct Trace<'s, 'm> {
    solver: &'s mut Solver<'m>,
    resolution: Vector<f64>,
    cells: usize,
    /// What was found.
    pub segments: Vec<Segment>,
}

/// A border that enters a cell, met on a walk around it, counter-clockwise.
#[derive(Debug, Clone)]
struct Entry {
    point: Vector<f64>,
    before: Arc<Regime>,
    after: Arc<Regime>,
    /// What turns, with `before` below; none at a corner.
    turns: Option<Arc<Transition>>,
}

impl Edge {
    /// Finds all crossings between two points.
    pub fn search(along: &mut Along, a: Point, b: Point, resolution: f64) -> Self {
        let (from, to) = (a.at, b.at);
        let found = brackets(along, &a, &b, resolution);
        let (stretches, borders) = stretches(a.clone(), b, &found, resolution);
        let (axis, fixed) = (along.axis, along.fixed);
        let crossing = |bracket: &Bracket| Crossing {
            at: bracket.at(),
            below: Arc::clone(&bracket.below.regime),
            above: Arc::clone(&bracket.above.regime),
            turns: Arc::new(Transition::at(along.solver, bracket, |at| place(axis, fixed, at).to_vec())),
        };
        let crossings = borders.iter().map(crossing).collect();
        let first = stretches.first().map_or(a.regime, |stretch| Arc::clone(&stretch.regime));
        Self { from, to, first, crossings }
    }

    fn last(&self) -> &Arc<Regime> {
        self.crossings.last().map_or(&self.first, |crossing| &crossing.above)
    }

    /// The part of it between two places.
    fn part(&self, from: f64, to: f64) -> Self {
        let before = self.crossings.iter().rfind(|crossing| crossing.at <= from);
        Self {
            from,
            to,
            first: before.map_or(&self.first, |crossing| &crossing.above).clone(),
            crossings: self
                .crossings
                .iter()
                .filter(|crossing| from < crossing.at && crossing.at <= to)
                .cloned()
                .collect(),
        }
    }

    /// The regime at a place.
    fn at(&self, at: f64) -> Arc<Regime> {
        self.part(at, self.to).first
    }

    /// Its pieces of one regime each, which lies on their left.
    pub fn pieces(&self, axis: usize, fixed: f64, side: Side) -> Vec<Segment> {
        let mut pieces = Vec::new();
        let (mut from, mut regime) = (self.from, &self.first);
        let ends = self.crossings.iter().map(|crossing| (crossing.at, &crossing.above)).chain([(self.to, self.last())]);
        for (to, next) in ends {
            let [a, b] = [from, to].map(|at| place(axis, fixed, at));
            let (a, b) = if side == Side::Forward { (a, b) } else { (b, a) };
            pieces.push(Segment { from: a, to: b, left: Arc::clone(regime), right: Arc::clone(regime), turns: None });
            (from, regime) = (to, next);
        }
        pieces
    }
}

impl Cell {
    /// All borders that enter, counter-clockwise from the least corner.
    fn entries(&self) -> Vec<Entry> {
        let [[x0, y0], [x1, y1]] = self.corners;
        let walk = [(0, y0, Side::Forward), (1, x1, Side::Forward), (0, y1, Side::Backward), (1, x0, Side::Backward)];
        let mut entries: Vec<Entry> = Vec::new();
        let mut ends = Vec::new();
        for (edge, (axis, fixed, side)) in self.edges.iter().zip(walk) {
            let entry = |crossing: &Crossing| {
                let (before, after, turns) = match side {
                    Side::Forward => (&crossing.below, &crossing.above, Arc::clone(&crossing.turns)),
                    Side::Backward => (&crossing.above, &crossing.below, Arc::new(crossing.turns.reversed())),
                };
                let point = place(axis, fixed, crossing.at);
                Entry { point, before: Arc::clone(before), after: Arc::clone(after), turns: Some(turns) }
            };
            let own: Vec<Entry> = match side {
                Side::Forward => edge.crossings.iter().map(entry).collect(),
                Side::Backward => edge.crossings.iter().rev().map(entry).collect(),
            };
            let (first, last) = match side {
                Side::Forward => (&edge.first, edge.last()),
                Side::Backward => (edge.last(), &edge.first),
            };
            ends.push((entries.len(), Arc::clone(first), Arc::clone(last)));
            entries.extend(own);
        }
        // A border may pass through a corner itself: then two edges do not agree about it.
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        for k in (0..4).rev() {
            let (at, after, _) = &ends[k];
            let (_, _, before) = &ends[(k + 3) % 4];
            if before != after {
                let (before, after) = (Arc::clone(before), Arc::clone(after));
                entries.insert(*at, Entry { point: corners[k], before, after, turns: None });
            }
        }
        entries
    }

    fn middle(&self) -> Vector<f64> {
        let [low, high] = self.corners;
        [0, 1].map(|axis| low[axis] + HALF * (high[axis] - low[axis]))
    }
}

impl<'s, 'm> Trace<'s, 'm> {
    /// A trace that bisects borders to `resolution` along each parameter.
    pub fn new(solver: &'s mut Solver<'m>, resolution: Vector<f64>) -> Self {
        Self { solver, resolution, cells: 0, segments: Vec::new() }
    }

    /// Finds the segments of a cell.
    pub fn cell(&mut self, cell: Cell) {
        self.within(cell, 0);
    }

    fn within(&mut self, cell: Cell, quarterings: usize) {
        self.cells += 1;
        let entries = cell.entries();
        if entries.is_empty() {
            return;
        }
        let alike = |a: &Entry, b: &Entry| match (&a.turns, &b.turns) {
            (Some(a), Some(b)) => a.is_same_as(&b.reversed()),
            _ => false,
        };
        let pairs = pairs(&entries, alike).or_else(|| pairs(&entries, |_, _| true));
        if let Some(pairs) = pairs {
            for [a, b] in pairs {
                self.bend(segment(&entries[a], entries[b].point), BENDS);
            }
        } else if quarterings < QUARTERINGS && self.cells < MOST_CELLS {
            for quarter in self.quarters(&cell) {
                self.within(quarter, quarterings + 1);
            }
        } else {
            let middle = cell.middle();
            self.segments.extend(entries.iter().map(|entry| segment(entry, middle)));
        }
    }

    /// Adds a segment, with points of the border between its ends as long as it is not straight.
    fn bend(&mut self, chord: Segment, bends: usize) {
        match self.off_chord(&chord).filter(|_| bends > 0) {
            None => self.segments.push(chord),
            Some(middle) => {
                let first = Segment { to: middle, ..chord.clone() };
                self.bend(first, bends - 1);
                self.bend(Segment { from: middle, ..chord }, bends - 1);
            }
        }
    }

    /// The point of the border beside a chord's middle, where it is farther from it than is seen and can be found.
    fn off_chord(&mut self, chord: &Segment) -> Option<Vector<f64>> {
        let ranges = self.resolution.map(|resolution| resolution / RESOLUTION);
        let along = [0, 1].map(|axis| (chord.to[axis] - chord.from[axis]) / ranges[axis]);
        let length = libm::hypot(along[0], along[1]);
        if length < SEEN {
            return None;
        }
        // To the chord's left, in units of the ranges.
        let beside = |off: f64| {
            let left = [-along[1] / length, along[0] / length];
            [0, 1].map(|axis| 0.5 * (chord.from[axis] + chord.to[axis]) + off * left[axis] * ranges[axis])
        };
        let solver = &mut *self.solver;
        let mut regime = |off: f64| solver.regime(&beside(off));
        let mut reach = SEEN;
        if regime(reach) == chord.left && regime(-reach) == chord.right {
            return None;
        }
        while reach < 0.5 * length {
            reach = (4.0 * reach).min(0.5 * length);
            let (mut left, mut right) = (reach, -reach);
            if regime(left) == chord.left && regime(right) == chord.right {
                while left - right > FOUND {
                    let middle = 0.5 * (left + right);
                    match regime(middle) {
                        found if found == chord.left => left = middle,
                        found if found == chord.right => right = middle,
                        // Something else lies between: these two do not meet here.
                        _ => return None,
                    }
                }
                return Some(beside(0.5 * (left + right)));
            }
        }
        None
    }

    /// The quarters of a cell; only the lines that part them are searched anew.
    fn quarters(&mut self, cell: &Cell) -> [Cell; 4] {
        let ([x0, y0], [x, y], [x1, y1]) = (cell.corners[0], cell.middle(), cell.corners[1]);
        let [below, right, above, left] = &cell.edges;
        let centre = self.solver.regime(&[x, y]);
        let mut search = |axis: usize, (from, at_from): (f64, Arc<Regime>), (to, at_to): (f64, Arc<Regime>)| {
            let fixed = if axis == 0 { y } else { x };
            let resolution = self.resolution[axis];
            let mut along = Along { solver: &mut *self.solver, axis, fixed };
            Edge::search(&mut along, Point { at: from, regime: at_from }, Point { at: to, regime: at_to }, resolution)
        };
        let to_left = search(0, (x0, left.at(y)), (x, Arc::clone(&centre)));
        let to_right = search(0, (x, Arc::clone(&centre)), (x1, right.at(y)));
        let to_below = search(1, (y0, below.at(x)), (y, Arc::clone(&centre)));
        let to_above = search(1, (y, centre), (y1, above.at(x)));
        let cell = |corners, edges| Cell { corners, edges };
        [
            cell([[x0, y0], [x, y]], [below.part(x0, x), to_below.clone(), to_left.clone(), left.part(y0, y)]),
            cell([[x, y0], [x1, y]], [below.part(x, x1), right.part(y0, y), to_right.clone(), to_below]),
            cell([[x, y], [x1, y1]], [to_right, right.part(y, y1), above.part(x, x1), to_above.clone()]),
            cell([[x0, y], [x, y1]], [to_left, to_above, above.part(x0, x), left.part(y, y1)]),
        ]
    }
}

/// The piece of a border that enters at `entry` and goes to `to`.
fn segment(entry: &Entry, to: Vector<f64>) -> Segment {
    let (left, right) = (Arc::clone(&entry.before), Arc::clone(&entry.after));
    Segment { from: entry.point, to, left, right, turns: entry.turns.clone() }
}

/// Entries two by two, each with the one that has the same regimes the other way round and is `alike`; none where one has
/// none or several such, or where pieces between them would cross.
fn pairs(entries: &[Entry], alike: impl Fn(&Entry, &Entry) -> bool) -> Option<Vec<[usize; 2]>> {
    let mut pairs = Vec::new();
    for (at, entry) in entries.iter().enumerate() {
        let fits = |other: &Entry| other.before == entry.after && other.after == entry.before && alike(entry, other);
        let mut partners = (0..entries.len()).filter(|&other| other != at && fits(&entries[other]));
        let partner = partners.next()?;
        if partners.next().is_some() {
            return None;
        }
        if at < partner {
            pairs.push([at, partner]);
        }
    }
    let crosses = |a: &[usize; 2], b: &[usize; 2]| {
        let inside = |k: usize| a[0] < k && k < a[1];
        inside(b[0]) != inside(b[1])
    };
    let apart = pairs.iter().enumerate().all(|(at, a)| pairs[..at].iter().all(|b| !crosses(a, b)));
    (apart && 2 * pairs.len() == entries.len()).then_some(pairs)
}
