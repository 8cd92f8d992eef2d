//! Map of the ends of overdamped contact for the paper's minimalistic biped at alpha = 1.4, which has three rigid
//! outcomes.
//!
//! The leading foot strikes as in the paper. The trailing foot, which rests in the paper, strikes too: its approach
//! speed and the ratio d_t / d_n span the map. Either the trailing foot lifts off or both feet stop; the curve between
//! the two is the separatrix. It differs from the border at which lift-off ceases to be a rigid outcome, so some runs
//! end near no outcome.

use heelstrike::Result;
use heelstrike::accuracy::compliant::{NEAR, NearestOutcome, SoftGround, landing, run};
use heelstrike::impact::{Analysis, ContactProblem, Friction, ListedRejections, Mode, analyze};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::planar::Pair;
use heelstrike::robot::Robot;
use heelstrike::state::{Defaults, State};
use nalgebra::{DMatrix, DVector};

/// The outcomes over approach speed and damping.
#[derive(Debug, Clone)]
pub struct LandingMap {
    /// Approach speeds of the trailing foot \[m/s\].
    pub speeds: Vec<f64>,
    /// Ratios d_t / d_n.
    pub ratios: Vec<f64>,
    /// One per ratio and speed, the speeds running fastest.
    pub cells: Vec<LandingCell>,
    /// For each ratio the speed beyond which both feet stop; `None` if they do not within the speeds.
    pub separatrix: Vec<Option<f64>>,
}

/// One run of the map.
#[derive(Debug, Clone, PartialEq)]
pub struct LandingCell {
    /// Modes of the nearest rigid outcome, trailing foot first.
    pub modes: Vec<Mode>,
    /// Index of that outcome.
    pub index: Option<i8>,
    /// Distance to that outcome, in the energy norm.
    pub distance: f64,
}

/// The biped just before it strikes.
#[derive(Debug, Clone)]
pub struct Biped {
    delassus: Vec<f64>,
    before: Vec<Pair<f64>>,
    friction: Friction,
}

/// Tolerance of a run: far below what a picture shows.
const TOLERANCE: f64 = 1e-8;

impl Biped {
    /// The biped in the paper's state, with this friction.
    pub fn new(friction: Friction) -> Result<Self> {
        let robot = Robot::from_urdf(include_str!("../../urdf/minimalistic.urdf"))?;
        let state = include_str!("../minimalistic.json");
        let state = State::from_json(state, &robot, &Defaults::default())?;
        let options = Options { matrices: true, ..Options::default() };
        let impact = Pipeline::new(&robot, options).impact(&state)?;
        let delassus = impact.matrices.map(|matrices| matrices.delassus.concat()).unwrap_or_default();
        Ok(Self { delassus, before: impact.velocity_before, friction })
    }

    /// The contact problem where the trailing foot comes down with `speed` \[m/s\].
    pub fn struck(&self, speed: f64) -> Result<ContactProblem> {
        let mut before = self.before.clone();
        if let Some(trailing) = before.first_mut() {
            *trailing = [0.0, -speed];
        }
        let contacts = before.len();
        ContactProblem::new(self.delassus.clone(), before, vec![self.friction; contacts], vec![0.0; contacts])
    }

    /// 1/2 c-^T G^-1 c-, the kinetic energy \[J\], because the biped has as many coordinates as contact rows.
    fn energy(&self, problem: &ContactProblem) -> f64 {
        let rows = 2 * problem.contacts();
        let before = DVector::from_iterator(rows, problem.velocity_before().iter().flatten().copied());
        let solved = DMatrix::from_row_slice(rows, rows, &self.delassus).lu().solve(&before);
        solved.map_or(f64::NAN, |momentum| 0.5 * momentum.dot(&before))
    }

    fn land(&self, speed: f64, ratio: f64) -> Result<(Analysis, Option<NearestOutcome>)> {
        let problem = self.struck(speed)?;
        let analysis = analyze(&problem, ListedRejections::Nothing)?;
        let ground = SoftGround { damping_ratio: f64::INFINITY, stiffness_ratio: 1.0, tangential_damping: ratio };
        let run = run(&problem, ground, TOLERANCE)?;
        let landing = landing(&problem, &analysis.outcomes, self.energy(&problem), &run);
        Ok((analysis, landing))
    }

    /// The cell at a speed and a ratio; without modes if there is no rigid outcome to compare with.
    pub fn cell(&self, speed: f64, ratio: f64) -> Result<LandingCell> {
        let (analysis, landing) = self.land(speed, ratio)?;
        Ok(landing.map_or(
            LandingCell { modes: Vec::new(), index: None, distance: f64::NAN },
            |NearestOutcome { outcome, distance }| {
                let outcome = &analysis.outcomes[outcome];
                LandingCell { modes: outcome.modes.clone(), index: outcome.index, distance }
            },
        ))
    }

    /// The speed up to `greatest` beyond which both feet stop, to 1e-4 of `greatest`; `None` if they do not.
    pub fn separatrix(&self, ratio: f64, greatest: f64) -> Result<Option<f64>> {
        let stops = |speed: f64| {
            self.cell(speed, ratio).map(|cell| cell.modes.first() == Some(&Mode::Stick) && cell.distance <= NEAR)
        };
        if !stops(greatest)? {
            return Ok(None);
        }
        let (mut lifts, mut stopped) = (0.0, greatest);
        while stopped - lifts > 1e-4 * greatest {
            let middle = 0.5 * (lifts + stopped);
            *if stops(middle)? { &mut stopped } else { &mut lifts } = middle;
        }
        Ok(Some(0.5 * (lifts + stopped)))
    }

    /// The map over `columns` speeds from 0 to 1 m/s and `rows` ratios from 0.1 to 1000, evenly on a logarithmic scale.
    pub fn map(&self, columns: usize, rows: usize) -> Result<LandingMap> {
        let even = |at: usize, count: usize| at as f64 / (count.max(2) - 1) as f64;
        let speeds: Vec<f64> = (0..columns).map(|at| even(at, columns)).collect();
        let ratios: Vec<f64> = (0..rows).map(|at| 0.1 * libm::pow(1e4, even(at, rows))).collect();
        let places = ratios.iter().flat_map(|&ratio| speeds.iter().map(move |&speed| (speed, ratio)));
        let cells = places.map(|(speed, ratio)| self.cell(speed, ratio)).collect::<Result<_>>()?;
        let separatrix = ratios.iter().map(|&ratio| self.separatrix(ratio, 1.0)).collect::<Result<_>>()?;
        Ok(LandingMap { speeds, ratios, cells, separatrix })
    }
}

impl LandingMap {
    /// Speed, ratio and cell of every run.
    pub fn runs(&self) -> impl Iterator<Item = (f64, f64, &LandingCell)> {
        let columns = self.speeds.len().max(1);
        let place = move |at: usize| (self.speeds[at % columns], self.ratios[at / columns]);
        self.cells.iter().enumerate().map(move |(at, cell)| {
            let (speed, ratio) = place(at);
            (speed, ratio, cell)
        })
    }

    /// Runs that end within `share` of an outcome of index -1.
    pub fn near_negative_index(&self, share: f64) -> impl Iterator<Item = (f64, f64, &LandingCell)> {
        self.runs().filter(move |(_, _, cell)| cell.index == Some(-1) && cell.distance <= share)
    }
}
