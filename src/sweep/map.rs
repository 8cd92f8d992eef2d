//! The regions of a study with two parameters, as areas between curves.
//!
//! ```text
//!     grid of points --[line] along every edge--> crossings --cell by cell--> segments --joined--> curves, areas
//! ```
//!
//! A curve that enters a cell through one edge leaves it through another: two crossings of the same two regions, at
//! which the same inequalities are zero, are the ends of one piece. A cell whose crossings cannot be paired is
//! quartered; where three regions meet, the crossings of the last cell meet in its middle. Every crossing is a zero of
//! the deciding quantity or is found by bisection. More points are inserted until curves are straight to 5e-5 of the
//! ranges.

use super::cell::{GridCell, Trace};
use super::edge::{Edge, GridLine, Segment};
use super::interior::{deepest_nodes, distance};
use super::line::{Probe, RESOLUTION};
use super::model::{RobotStudy, Solver};
use super::parallel::Workers;
use super::polyline::{loops, polylines};
use super::regime::Regime;
use super::transition::Transition;
use super::{Findings, letter};
use crate::impact::Verdict;
use crate::read::{Parameter, Study};
use crate::{Error, Reason};
use serde::{Serialize, Serializer};
use std::sync::Arc;

/// The least number of cells along each parameter through which curves are traced.
pub const CELLS: usize = 64;

/// The greatest memory of a map's grid \[MB\].
const MEMORY: usize = 400;

/// The distance of the outermost grid lines from the ends of the ranges, as a fraction of them: many studies are
/// degenerate at these ends.
const INSIDE: f64 = 1e-7;

/// The offset of all other grid lines from an even division, as a fraction of a cell: curves often meet at round
/// numbers.
const BESIDE: f64 = 0.013_7;

/// All areas of a study with two parameters.
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct Map {
    /// The different regimes, in the order in which the grid meets them.
    pub areas: Vec<Area>,
    /// The borders between the areas.
    pub curves: Vec<BorderCurve>,
    /// Whether contacts depend on each other somewhere. Combinations without a unique solution are not followed.
    pub dependent: bool,
    /// Oddities of the states in the middle and at the ends of the ranges, in sentences.
    pub oddities: Vec<String>,
}

/// The area of one regime.
#[derive(Debug, Clone)]
pub struct Area {
    /// The regime of all points of the area.
    pub regime: Arc<Regime>,
    /// Closed loops of points (first parameter, second parameter) with the area on their left. The first point is not
    /// repeated.
    pub loops: Vec<Vec<[f64; 2]>>,
    /// For each connected part, a point well inside and its distance from the edge as a fraction of the ranges.
    pub middles: Vec<([f64; 2], f64)>,
    /// The verdict at the first of these points, or at a node that strikes if nothing does there; `None` if refused.
    pub verdict: Option<Verdict>,
    /// The reason why states of the area are refused, from that point or from next to a border.
    pub refused: Option<Error>,
}

/// A border between two areas.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BorderCurve {
    /// The areas on its left and on its right, as indices; written as their letters.
    #[serde(rename = "between", serialize_with = "as_letters")]
    #[cfg_attr(feature = "schema", schemars(with = "[String; 2]"))]
    pub sides: [usize; 2],
    /// What changes there; `below` is its left side.
    #[serde(flatten)]
    pub transition: Transition,
    /// Its points, in the order of the parameters; of a closed curve the first is the last.
    pub points: Vec<[f64; 2]>,
}

fn as_letters<S: Serializer>(sides: &[usize; 2], serializer: S) -> Result<S::Ok, S::Error> {
    sides.map(letter).serialize(serializer)
}

/// Returns the number of grid lines along a parameter.
fn lines(parameter: &Parameter) -> usize {
    let steps = parameter.steps - 1;
    steps * CELLS.div_ceil(steps) + 1
}

/// Returns the grid lines along a parameter.
fn places(parameter: &Parameter) -> Vec<f64> {
    let cells = lines(parameter) - 1;
    let part = |k: usize| match k {
        0 => INSIDE,
        k if k == cells => 1.0 - INSIDE,
        k => (k as f64 + BESIDE) / cells as f64,
    };
    (0..=cells).map(|k| parameter.from + parameter.range() * part(k)).collect()
}

/// The grid through which borders are traced, with the regimes at its nodes and the borders across its edges.
struct Grid<'p> {
    parameters: [&'p Parameter; 2],
    xs: Vec<f64>,
    ys: Vec<f64>,
    resolution: [f64; 2],
    /// Regimes, row by row.
    nodes: Vec<Arc<Regime>>,
    rows: Vec<Edge>,
    /// Edges, column by column.
    columns: Vec<Edge>,
}

impl<'p> Grid<'p> {
    fn new(model: &RobotStudy, parameters: [&'p Parameter; 2], workers: Workers) -> Self {
        let [xs, ys] = parameters.map(places);
        let (nx, ny) = (xs.len(), ys.len());
        let resolution = parameters.map(|parameter| RESOLUTION * parameter.range());
        let begin = || Solver::new(model);
        let row = |solver: &mut Solver, y: f64| xs.iter().map(|&x| solver.regime(&[x, y])).collect::<Vec<_>>();
        let nodes = workers.map(ny, begin, |solver, k| row(solver, ys[k])).concat();
        let edge = |solver: &mut Solver, axis: usize, column: usize, row: usize| {
            let (along, fixed, at) = if axis == 0 { (&xs, ys[row], column) } else { (&ys, xs[column], row) };
            let other = if axis == 0 { row * nx + column + 1 } else { (row + 1) * nx + column };
            let ends = [(along[at], &nodes[row * nx + column]), (along[at + 1], &nodes[other])];
            let ends = ends.map(|(at, regime)| Probe { at, regime: Arc::clone(regime) });
            Edge::search(solver, GridLine { axis, fixed }, ends, resolution[axis])
        };
        // The work is shared line by line, because neighboring edges of a line share their ends.
        let row = |solver: &mut Solver, row| (0..nx - 1).map(|k| edge(solver, 0, k, row)).collect::<Vec<_>>();
        let column = |solver: &mut Solver, column| (0..ny - 1).map(|k| edge(solver, 1, column, k)).collect::<Vec<_>>();
        let (rows, columns) = (workers.map(ny, begin, row).concat(), workers.map(nx, begin, column).concat());
        Self { parameters, xs, ys, resolution, nodes, rows, columns }
    }

    fn cell(&self, k: usize) -> GridCell {
        let (nx, ny) = (self.xs.len(), self.ys.len());
        let (column, row) = (k % (nx - 1), k / (nx - 1));
        let edges = [
            &self.rows[row * (nx - 1) + column],
            &self.columns[(column + 1) * (ny - 1) + row],
            &self.rows[(row + 1) * (nx - 1) + column],
            &self.columns[column * (ny - 1) + row],
        ];
        let corners = [[self.xs[column], self.ys[row]], [self.xs[column + 1], self.ys[row + 1]]];
        GridCell { corners, edges: edges.map(Edge::clone) }
    }

    /// Returns the frame, counter-clockwise, in pieces of one regime each.
    fn frame(&self) -> Vec<Segment> {
        let (nx, ny) = (self.xs.len(), self.ys.len());
        let mut frame = Vec::new();
        let mut add = |forward: &Edge, backward: &Edge| {
            frame.extend(forward.pieces());
            frame.extend(backward.reversed().pieces().into_iter().rev());
        };
        for column in 0..nx - 1 {
            add(&self.rows[column], &self.rows[(ny - 1) * (nx - 1) + column]);
        }
        for row in 0..ny - 1 {
            add(&self.columns[(nx - 1) * (ny - 1) + row], &self.columns[row]);
        }
        frame
    }

    /// Moves a point on the outermost lines to the end of the range.
    fn outward(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let snapped = |at: f64, lines: &[f64], parameter: &Parameter| match lines {
            [least, ..] if at <= *least => parameter.from,
            [.., most] if at >= *most => parameter.to,
            _ => at,
        };
        [snapped(x, &self.xs, self.parameters[0]), snapped(y, &self.ys, self.parameters[1])]
    }

    fn node(&self, k: usize) -> [f64; 2] {
        [self.xs[k % self.xs.len()], self.ys[k / self.xs.len()]]
    }

    /// Finds, for each connected part of each area, the node farthest from the area's borders and this distance.
    /// Connection is that of the nodes.
    fn find_middles(&self, areas: &mut [Area]) {
        let ranges = [&self.xs, &self.ys].map(|lines| lines[lines.len() - 1] - lines[0]);
        let kinds: Vec<Option<usize>> = self.nodes.iter().map(|regime| index(areas, regime)).collect();
        for (area, nodes) in deepest_nodes(&kinds, self.xs.len()) {
            let room = nodes.into_iter().map(|k| self.node(k));
            let room = room.map(|at| (at, distance(at, &areas[area].loops, ranges)));
            areas[area].middles.extend(room.max_by(|a, b| a.1.total_cmp(&b.1)));
        }
    }
}

fn index(areas: &[Area], regime: &Arc<Regime>) -> Option<usize> {
    areas.iter().position(|area| area.regime == *regime)
}

impl Map {
    /// Computes the areas of `model`, whose study has two parameters; reports [`Map::work`] pieces of work to
    /// `workers`.
    pub fn of(model: &RobotStudy, workers: Workers) -> Self {
        let [first, second] = model.study.parameters() else { return Self::default() };
        let grid = Grid::new(model, [first, second], workers);
        let cells = (grid.xs.len() - 1) * (grid.ys.len() - 1);
        let trace = |solver: &mut Solver, k: usize| {
            let mut trace = Trace { solver, resolution: grid.resolution, cells: 0, segments: Vec::new() };
            trace.cell(grid.cell(k), 0);
            trace.segments
        };
        let segments = workers.map(cells, || Solver::new(model), trace).concat();
        let frame = grid.frame();
        let mut regimes: Vec<Arc<Regime>> = Vec::new();
        let met = grid.nodes.iter().chain(frame.iter().map(|piece| &piece.sides.left));
        for regime in met.chain(segments.iter().flat_map(|segment| [&segment.sides.left, &segment.sides.right])) {
            if !regimes.contains(regime) {
                regimes.push(Arc::clone(regime));
            }
        }
        // A regime without segments and pieces of the frame holds at a single point only.
        let area = |regime: Arc<Regime>| {
            let mut loops = loops(&segments, &frame, &regime);
            loops.iter_mut().flatten().for_each(|point| *point = grid.outward(*point));
            (!loops.is_empty()).then_some(Area { regime, loops, middles: Vec::new(), verdict: None, refused: None })
        };
        let mut areas: Vec<Area> = regimes.into_iter().filter_map(area).collect();
        grid.find_middles(&mut areas);
        let mut solver = Solver::new(model);
        let mut dependent = false;
        for area in &mut areas {
            let Some((middle, _)) = area.middles.first() else { continue };
            let inside = (0..grid.nodes.len()).filter(|&node| grid.nodes[node] == area.regime);
            let inner = solver.inner(middle, inside.map(|node| grid.node(node).to_vec()));
            (area.verdict, area.refused) = (inner.verdict, inner.refused);
            dependent |= inner.dependent;
        }
        let curve = |(segment, points): (&Segment, Vec<[f64; 2]>)| {
            let sides = [index(&areas, &segment.sides.left)?, index(&areas, &segment.sides.right)?];
            let points = points.into_iter().map(|point| grid.outward(point)).collect();
            let transition = segment.sides.transition.as_deref().cloned().unwrap_or_default();
            Some(BorderCurve { sides, points, transition })
        };
        let curves: Vec<BorderCurve> = polylines(&segments).into_iter().filter_map(curve).collect();
        for BorderCurve { sides, transition, .. } in &curves {
            for (side, refused) in sides.iter().zip(&transition.refused) {
                let area = &mut areas[*side];
                if area.regime.outcomes().is_none() && area.refused.is_none() {
                    area.refused.clone_from(refused);
                }
            }
        }
        Self { curves, areas, dependent, oddities: model.oddities() }
    }

    /// Returns the number of pieces of work for a map of `model`.
    pub fn work(model: &RobotStudy) -> usize {
        let [first, second] = model.study.parameters() else { return 0 };
        let [nx, ny] = [first, second].map(lines);
        2 * ny + nx + (nx - 1) * (ny - 1)
    }
}

impl Findings {
    /// Refuses a study whose map needs too much memory.
    ///
    /// # Errors
    /// Returns [`Reason::TooLarge`], with the number of samples as its place.
    pub fn check_memory(study: &Study) -> crate::Result<()> {
        let [first, second] = study.parameters() else { return Ok(()) };
        let nodes = lines(first) * lines(second);
        // Each list exists twice while the results of the threads are joined.
        let bytes = 2 * (size_of::<(usize, Arc<Regime>)>() + 2 * size_of::<(usize, Edge)>());
        let needed = nodes.saturating_mul(bytes) >> 20;
        if needed <= MEMORY {
            return Ok(());
        }
        let most = usize::from(second.steps > first.steps);
        let limit = (MEMORY << 20) / bytes;
        let hint = format!("take fewer samples: a map of {nodes} points is traced here, of at most {limit}");
        Err(study.refuse_steps(most, Reason::TooLarge { needed, limit: MEMORY }).hint(hint))
    }
}
