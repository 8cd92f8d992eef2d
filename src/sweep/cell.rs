//! Traces borders through one cell of the plane of two parameters.

use super::edge::{Crossing, Edge, GridLine, Segment, Sides};
use super::line::{Along, Bracket, Landscape, Probe, RESOLUTION, bisect};
use super::model::Solver;
use std::sync::Arc;

/// The number of times that a cell is quartered, and the number of cells that this makes, at most.
const QUARTERINGS: usize = 9;
const MOST_CELLS: usize = 400;

/// The greatest distance of a curve from its chord, as a fraction of the ranges, and the accuracy of its inner points.
const STRAIGHT: f64 = 5e-5;
const FOUND: f64 = 1e-9;

/// The number of times that a chord is halved, at most.
const BENDS: usize = 6;

/// Where a cell is divided: near its middle, because the middle itself may be a special point.
const HALF: f64 = 0.506_17;

/// A cell: its least and its greatest corner, and its edges below, to the right, above and to the left.
#[derive(Debug, Clone)]
pub struct GridCell {
    pub corners: [[f64; 2]; 2],
    pub edges: [Edge; 4],
}

/// Traces borders through cells.
pub struct Trace<'s, 'm> {
    pub solver: &'s mut Solver<'m>,
    /// The accuracy of borders along each parameter.
    pub resolution: [f64; 2],
    /// The number of cells so far.
    pub cells: usize,
    pub segments: Vec<Segment>,
}

impl GridCell {
    /// Returns all borders that enter the cell, counter-clockwise from the least corner.
    fn entries(&self) -> Vec<Crossing> {
        let [below, right, above, left] = &self.edges;
        let walk = [below.clone(), right.clone(), above.reversed(), left.reversed()];
        let mut entries = Vec::new();
        let mut before = walk[3].last();
        for edge in &walk {
            // A border may pass through the corner itself; the two edges then disagree about the corner.
            if *before != edge.first {
                let sides = Sides { left: Arc::clone(before), right: Arc::clone(&edge.first), transition: None };
                entries.push(Crossing { point: edge.line.point(edge.from), sides });
            }
            entries.extend(edge.crossings.iter().cloned());
            before = edge.last();
        }
        entries
    }

    fn middle(&self) -> [f64; 2] {
        let [low, high] = self.corners;
        [0, 1].map(|axis| low[axis] + HALF * (high[axis] - low[axis]))
    }
}

impl<'s, 'm> Trace<'s, 'm> {
    /// Finds the segments of a cell, which is the result of this many `quarterings`.
    pub fn cell(&mut self, cell: GridCell, quarterings: usize) {
        self.cells += 1;
        let entries = cell.entries();
        if entries.is_empty() {
            return;
        }
        let alike = |a: &Sides, b: &Sides| a.transition.is_some() && a.is_same_as(&b.reversed());
        let pairs = pairs(&entries, alike).or_else(|| pairs(&entries, |_, _| true));
        let segment = |Crossing { point, sides }: &Crossing, to| Segment { from: *point, to, sides: sides.clone() };
        if let Some(pairs) = pairs {
            for [a, b] in pairs {
                self.bend(segment(&entries[a], entries[b].point), &cell.corners, BENDS);
            }
        } else if quarterings < QUARTERINGS && self.cells < MOST_CELLS {
            for quarter in self.quarters(&cell) {
                self.cell(quarter, quarterings + 1);
            }
        } else {
            let middle = cell.middle();
            self.segments.extend(entries.iter().map(|entry| segment(entry, middle)));
        }
    }

    /// Adds a segment of a cell with these `corners`. Points of the border are inserted until the segments are
    /// straight.
    fn bend(&mut self, chord: Segment, corners: &[[f64; 2]; 2], bends: usize) {
        match self.off_chord(&chord, corners).filter(|_| bends > 0) {
            None => self.segments.push(chord),
            Some(middle) => {
                let first = Segment { to: middle, ..chord.clone() };
                self.bend(first, corners, bends - 1);
                self.bend(Segment { from: middle, ..chord }, corners, bends - 1);
            }
        }
    }

    /// Returns the point of the border nearest to a chord's middle, within the cell; `None` if the chord is straight
    /// enough or the point is not found.
    fn off_chord(&mut self, chord: &Segment, corners: &[[f64; 2]; 2]) -> Option<[f64; 2]> {
        let ranges = self.resolution.map(|resolution| resolution / RESOLUTION);
        let along = [0, 1].map(|axis| (chord.to[axis] - chord.from[axis]) / ranges[axis]);
        let length = libm::hypot(along[0], along[1]);
        if length < STRAIGHT {
            return None;
        }
        let middle = [0, 1].map(|axis| 0.5 * (chord.from[axis] + chord.to[axis]));
        // A unit of the ranges to the left of the chord.
        let left_of = [-along[1] / length * ranges[0], along[0] / length * ranges[1]];
        let off_middle = |off: f64| [0, 1].map(|axis| middle[axis] + off * left_of[axis]);
        // The distance to the cell's edge on one side, and a little more, because the chord may lie on the edge.
        let room = |way: f64| {
            let to_edge = |axis: usize| {
                let [low, high] = corners.map(|corner| corner[axis]);
                let step = way * left_of[axis];
                let edge = if step > 0.0 { high } else { low };
                if step == 0.0 { f64::INFINITY } else { (edge - middle[axis]) / step }
            };
            to_edge(0).min(to_edge(1)).max(STRAIGHT)
        };
        let rooms = [room(-1.0), room(1.0)];
        let Sides { left, right, .. } = &chord.sides;
        let mut line = Along { solver: &mut *self.solver, place: |off: f64| off_middle(off).to_vec() };
        let mut reach = STRAIGHT;
        loop {
            let places = [-reach.min(rooms[0]), reach.min(rooms[1])];
            let [below, above] = places.map(|at| Probe { at, regime: line.regime(at) });
            let has_both = below.regime == *right && above.regime == *left;
            if reach == STRAIGHT && has_both {
                return None;
            }
            let found = bisect(&mut line, &below, &above, FOUND);
            // Only borders between these two regimes count: others may be near.
            let common = found.iter().filter(|border| border.below.regime == *right && border.above.regime == *left);
            let off = common.map(Bracket::at).min_by(|a, b| a.abs().total_cmp(&b.abs()));
            if let Some(off) = off {
                return (off.abs() > STRAIGHT).then(|| off_middle(off));
            }
            // If both sides were found without a common border, a third region lies between them.
            if has_both || reach >= rooms[0].max(rooms[1]) {
                return None;
            }
            reach *= 4.0;
        }
    }

    /// Returns the quarters of a cell. Only the lines between them are searched anew.
    fn quarters(&mut self, cell: &GridCell) -> [GridCell; 4] {
        let ([x0, y0], [x, y], [x1, y1]) = (cell.corners[0], cell.middle(), cell.corners[1]);
        let [below, right, above, left] = &cell.edges;
        let center = Probe { at: x, regime: self.solver.regime(&[x, y]) };
        let upward = Probe { at: y, ..center.clone() };
        let mut search = |axis: usize, ends: [Probe; 2]| {
            let line = GridLine { axis, fixed: if axis == 0 { y } else { x } };
            Edge::search(self.solver, line, ends, self.resolution[axis])
        };
        let to_left = search(0, [Probe { at: x0, regime: left.at(y) }, center.clone()]);
        let to_right = search(0, [center, Probe { at: x1, regime: right.at(y) }]);
        let to_below = search(1, [Probe { at: y0, regime: below.at(x) }, upward.clone()]);
        let to_above = search(1, [upward, Probe { at: y1, regime: above.at(x) }]);
        let cell = |corners, edges| GridCell { corners, edges };
        [
            cell([[x0, y0], [x, y]], [below.part(x0, x), to_below.clone(), to_left.clone(), left.part(y0, y)]),
            cell([[x, y0], [x1, y]], [below.part(x, x1), right.part(y0, y), to_right.clone(), to_below]),
            cell([[x, y], [x1, y1]], [to_right, right.part(y, y1), above.part(x, x1), to_above.clone()]),
            cell([[x0, y], [x, y1]], [to_left, to_above, above.part(x0, x), left.part(y, y1)]),
        ]
    }
}

/// Pairs each entry with the one that has the same regimes in reverse and is `alike`. `None` if an entry has no partner
/// or several, or if the segments between partners would cross.
fn pairs(entries: &[Crossing], alike: impl Fn(&Sides, &Sides) -> bool) -> Option<Vec<[usize; 2]>> {
    let mut pairs = Vec::new();
    for (at, Crossing { sides, .. }) in entries.iter().enumerate() {
        let fits = |Crossing { sides: other, .. }: &Crossing| {
            other.left == sides.right && other.right == sides.left && alike(sides, other)
        };
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
