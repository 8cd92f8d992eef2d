//! The regions of a study of two parameters, as areas between curves.
//!
//! ```text
//!     grid of points --[line] along every edge--> crossings --cell by cell--> segments --chained--> curves, areas
//! ```
//!
//! A curve that crosses an edge of a cell leaves it through another: crossings of the same two regions, at which the same
//! inequalities turn, are two ends of one piece. A cell whose crossings do not pair so is quartered, and where three regions
//! meet, at the last, its crossings meet in its middle. Every crossing is bisected, and points between two of them until a
//! curve is straight to 5e-5 of the ranges.

use super::cell::{Cell, Edge, Side, Trace};
use super::chain::{chains, loops};
use super::line::{Landscape, Point, RESOLUTION};
use super::model::{Model, Solver, Watched};
use super::parallel::Workers;
use super::regime::Regime;
use super::transition::Transition;
use crate::Error;
use crate::impact::Verdict;
use crate::planar::Vector;
use crate::read::Parameter;
use std::sync::Arc;

/// Curves are traced through at least so many cells along each parameter.
pub const CELLS: usize = 64;

/// How far the outermost lines of the grid lie inside the ranges, as part of them: on their ends many studies are degenerate.
const INSIDE: f64 = 1e-7;

/// How far all other lines lie beside the places that divide the range evenly, as part of a cell: round numbers are where
/// curves meet.
const BESIDE: f64 = 0.013_7;

/// All areas of a study of two parameters.
#[derive(Debug, Clone)]
pub struct Map {
    /// The different regimes, in the order in which the grid meets them.
    pub areas: Vec<Area>,
    /// The borders between them.
    pub curves: Vec<Curve>,
    /// Whether contacts depend on each other somewhere: combinations without a unique solution are not followed.
    pub dependent: bool,
}

/// Where one regime holds.
#[derive(Debug, Clone)]
pub struct Area {
    /// What happens there.
    pub regime: Arc<Regime>,
    /// Closed loops of points (first parameter, second parameter) with the area on their left; the first point is not repeated.
    pub loops: Vec<Vec<Vector<f64>>>,
    /// For each connected part a point well inside of it, and how far that is from its edge as part of the ranges.
    pub middles: Vec<(Vector<f64>, f64)>,
    /// The verdict at such a point; none where states are refused.
    pub verdict: Option<Verdict>,
    /// Where states are refused: why, as at such a point or beside a border.
    pub refused: Option<Error>,
}

/// A border between two areas.
#[derive(Debug, Clone)]
pub struct Curve {
    /// The areas on its left and on its right, as indices.
    pub sides: [usize; 2],
    /// Its points; of a closed one the first is the last.
    pub points: Vec<Vector<f64>>,
    /// What turns there; `below` is its left side.
    pub turns: Transition,
}

/// The points of a line in the plane of two parameters.
pub(super) struct Along<'s, 'm> {
    pub solver: &'s mut Solver<'m>,
    /// Which parameter varies.
    pub axis: usize,
    /// The other one's value.
    pub fixed: f64,
}

impl Along<'_, '_> {
    pub fn place(&self, at: f64) -> Vector<f64> {
        place(self.axis, self.fixed, at)
    }
}

/// The point whose coordinate `axis` is `at` and whose other one is `fixed`.
pub(super) fn place(axis: usize, fixed: f64, at: f64) -> Vector<f64> {
    if axis == 0 { [at, fixed] } else { [fixed, at] }
}

impl Landscape for Along<'_, '_> {
    fn regime(&mut self, at: f64) -> Arc<Regime> {
        let place = self.place(at);
        self.solver.regime(&place)
    }

    fn watched(&mut self, at: f64) -> Option<Watched> {
        let place = self.place(at);
        self.solver.watched(&place)
    }
}

/// The lines of the grid along a parameter.
fn lines(parameter: &Parameter) -> Vec<f64> {
    let steps = parameter.steps - 1;
    let cells = steps * CELLS.div_ceil(steps);
    let part = |k: usize| match k {
        0 => INSIDE,
        k if k == cells => 1.0 - INSIDE,
        k => (k as f64 + BESIDE) / cells as f64,
    };
    (0..=cells).map(|k| parameter.from + parameter.range() * part(k)).collect()
}

impl Map {
    /// The areas of `model`, whose study has two parameters; tells `workers` of [`Map::work`] pieces of work.
    pub fn of(model: &Model, workers: Workers) -> Self {
        let [first, second] = model.study.parameters() else {
            return Self { areas: Vec::new(), curves: Vec::new(), dependent: false };
        };
        let (xs, ys) = (lines(first), lines(second));
        let (nx, ny) = (xs.len(), ys.len());
        let resolution = [RESOLUTION * first.range(), RESOLUTION * second.range()];
        let begin = || Solver::new(model);
        let nodes = workers.map(nx * ny, begin, |solver, k| solver.regime(&[xs[k % nx], ys[k / nx]]));
        let edge = |solver: &mut Solver, axis: usize, column: usize, row: usize| {
            let (along, fixed, at) = if axis == 0 { (&xs, ys[row], column) } else { (&ys, xs[column], row) };
            let other = if axis == 0 { row * nx + column + 1 } else { (row + 1) * nx + column };
            let ends = [(along[at], &nodes[row * nx + column]), (along[at + 1], &nodes[other])];
            let [a, b] = ends.map(|(at, regime)| Point { at, regime: Arc::clone(regime) });
            Edge::search(&mut Along { solver, axis, fixed }, a, b, resolution[axis])
        };
        let rows = workers.map((nx - 1) * ny, begin, |solver, k| edge(solver, 0, k % (nx - 1), k / (nx - 1)));
        let columns = workers.map(nx * (ny - 1), begin, |solver, k| edge(solver, 1, k % nx, k / nx));
        let cell = |k: usize| {
            let (column, row) = (k % (nx - 1), k / (nx - 1));
            Cell {
                corners: [[xs[column], ys[row]], [xs[column + 1], ys[row + 1]]],
                edges: [
                    rows[row * (nx - 1) + column].clone(),
                    columns[row * nx + column + 1].clone(),
                    rows[(row + 1) * (nx - 1) + column].clone(),
                    columns[row * nx + column].clone(),
                ],
            }
        };
        let segments = workers.map((nx - 1) * (ny - 1), begin, |solver, k| {
            let mut trace = Trace::new(solver, resolution);
            trace.cell(cell(k));
            trace.segments
        });
        let segments: Vec<_> = segments.into_iter().flatten().collect();

        // The frame, counter-clockwise, in pieces of one regime each.
        let mut frame = Vec::new();
        for column in 0..nx - 1 {
            frame.extend(rows[column].pieces(0, ys[0], Side::Forward));
            frame.extend(rows[(ny - 1) * (nx - 1) + column].pieces(0, ys[ny - 1], Side::Backward));
        }
        for row in 0..ny - 1 {
            frame.extend(columns[row * nx + nx - 1].pieces(1, xs[nx - 1], Side::Forward));
            frame.extend(columns[row * nx].pieces(1, xs[0], Side::Backward));
        }
        let mut regimes: Vec<Arc<Regime>> = Vec::new();
        let met = nodes.iter().chain(frame.iter().map(|piece| &piece.left));
        for regime in met.chain(segments.iter().flat_map(|segment| [&segment.left, &segment.right])) {
            if !regimes.contains(regime) {
                regimes.push(Arc::clone(regime));
            }
        }
        // What has neither a segment nor a piece of the frame is a point.
        let outward = |[x, y]: Vector<f64>| [snapped(x, &xs, first), snapped(y, &ys, second)];
        let mut areas: Vec<Area> = regimes
            .into_iter()
            .filter_map(|regime| {
                let mut loops = loops(&segments, &frame, &regime);
                loops.iter_mut().flatten().for_each(|point| *point = outward(*point));
                (!loops.is_empty()).then_some(Area { regime, loops, middles: Vec::new(), verdict: None, refused: None })
            })
            .collect();
        super::middle::find(&nodes, (&xs, &ys), &mut areas);
        let mut solver = begin();
        let mut dependent = false;
        for area in &mut areas {
            let Some((middle, _)) = area.middles.first() else { continue };
            let inner = solver.inner(middle);
            (area.verdict, area.refused) = (inner.verdict, inner.refused);
            dependent |= inner.dependent;
        }
        let index = |regime: &Arc<Regime>| areas.iter().position(|area| area.regime == *regime);
        let curves = chains(&segments).into_iter().filter_map(|chain| {
            let sides = [index(&chain.left)?, index(&chain.right)?];
            Some(Curve { sides, points: chain.points.into_iter().map(outward).collect(), turns: chain.turns })
        });
        let curves: Vec<Curve> = curves.collect();
        for Curve { sides, turns, .. } in &curves {
            for (side, refused) in sides.iter().zip([&turns.refused_below, &turns.refused_above]) {
                let area = &mut areas[*side];
                if area.regime.outcomes().is_none() && area.refused.is_none() {
                    area.refused.clone_from(refused);
                }
            }
        }
        Self { curves, areas, dependent }
    }

    /// How many pieces of work a map of `model` has.
    pub fn work(model: &Model) -> usize {
        let [first, second] = model.study.parameters() else { return 0 };
        let (nx, ny) = (lines(first).len(), lines(second).len());
        nx * ny + (nx - 1) * ny + nx * (ny - 1) + (nx - 1) * (ny - 1)
    }
}

/// A place on the outermost lines is taken to the end of the range.
fn snapped(at: f64, lines: &[f64], parameter: &Parameter) -> f64 {
    match lines {
        [least, ..] if at <= *least => parameter.from,
        [.., most] if at >= *most => parameter.to,
        _ => at,
    }
}
