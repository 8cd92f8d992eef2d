//! Every outcome of a state, by one dense linear solve for each of the 4^n lists of modes, in balls.
//!
//! A contact that separates has no unknown, one that slides one (L_n, or with infinite friction L_t), one that sticks
//! two (one at friction 0). Where 256 bits leave a sign open it is tried with 832; a number that these hold below
//! 2^-150 of its scale is taken for zero, and the state for one on a border. Where that makes equations dependent, the
//! impulses that are left free are eliminated from the inequalities one by one (Fourier and Motzkin).

use crate::balls::dynamics::{Problem, problem};
use crate::balls::linear::{Affine, Inequality, Solved, Zero, feasible, solve};
use crate::balls::number::{Ball, Number};
use heelstrike::impact::{Friction, Mode};
use heelstrike::robot::Robot;
use heelstrike::state::State;
use std::cmp::Ordering;

/// The precisions that are tried, one after the other.
const BITS: [usize; 2] = [256, 832];

/// An outcome, as far as signs tell it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Outcome {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// What becomes of its index.
    pub index: Index,
}

/// The sign of det A, where it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Index {
    /// It has.
    Sign(i8),
    /// An inequality is zero.
    Border,
    /// Contacts depend on each other, so that det A = 0.
    Redundant,
}

/// All that the oracle knows about a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Every outcome, in the order of its modes.
    pub outcomes: Vec<Outcome>,
    /// Lists of modes that no precision told: whole families of velocities, or many free impulses.
    pub open: usize,
    /// Whether the equations of some list depend on each other: then no outcome need exist, nor their indices add up.
    pub dependent: bool,
    /// The precision that it took.
    pub bits: usize,
}

/// Every outcome of the contacts that the state names; `None` if the mass matrix is singular.
pub fn answer(robot: &Robot, state: &State) -> Option<Answer> {
    let mut outcomes = Vec::new();
    let mut dependent = false;
    let mut open: Option<Vec<Vec<Mode>>> = None;
    for bits in BITS {
        let problem = problem::<Ball>(robot, state, bits)?;
        let last = bits == BITS[BITS.len() - 1];
        let lists = open.take().unwrap_or_else(|| lists(problem.friction.len()));
        let mut left = Vec::new();
        for modes in lists {
            match judge(&problem, &modes, Zero { last }) {
                Judgement::Outcome(index) => {
                    dependent |= index == Index::Redundant;
                    outcomes.push(Outcome { modes, index });
                }
                Judgement::None => {}
                Judgement::Dependent => dependent = true,
                Judgement::Open => left.push(modes),
            }
        }
        if left.is_empty() || last {
            outcomes.sort();
            return Some(Answer { outcomes, open: left.len(), dependent, bits });
        }
        open = Some(left);
    }
    None
}

/// The lists of modes that f64 takes for outcomes; nothing is proven by them.
pub fn guess(robot: &Robot, state: &State) -> Vec<Vec<Mode>> {
    let Some(problem) = problem::<f64>(robot, state, 0) else { return Vec::new() };
    let mut lists = lists(problem.friction.len());
    lists.retain(|modes| matches!(judge(&problem, modes, Zero { last: false }), Judgement::Outcome(_)));
    lists
}

/// All 4^n lists of modes.
fn lists(contacts: usize) -> Vec<Vec<Mode>> {
    let modes = |number: usize| (0..contacts).map(|k| Mode::ALL[number >> (2 * k) & 3]).collect();
    (0..1 << (2 * contacts)).map(modes).collect()
}

/// What a list of modes comes to.
enum Judgement {
    /// An outcome.
    Outcome(Index),
    /// No outcome.
    None,
    /// No outcome, of equations that depend on each other.
    Dependent,
    /// Not told by this precision.
    Open,
}

/// An entry of L, or L_n of a slide, which brings L_t = slope * L_n with it.
struct Unknown<N> {
    row: usize,
    slope: Option<N>,
}

impl<N: Number> Unknown<N> {
    /// An entry of L alone.
    fn single(row: usize) -> Self {
        Self { row, slope: None }
    }

    /// What one unit of it adds to a contact velocity.
    fn effect(&self, problem: &Problem<N>, row: usize) -> N {
        let entry = &problem.delassus[row][self.row];
        match &self.slope {
            Some(slope) if !slope.is_zero() => entry.plus(&problem.delassus[row][self.row - 1].times(slope)),
            _ => entry.clone(),
        }
    }
}

/// What a mode asks of its contact; rows are those of L and c+.
enum Demand {
    /// factor * L_row >= 0.
    Push { row: usize, factor: f64 },
    /// mu L_n - side * L_t >= 0, L_n being that row.
    Cone { row: usize, mu: f64, side: f64 },
    /// factor * c_row > 0 (xi_n for a normal row).
    Speed { row: usize, factor: f64 },
    /// c_row = 0.
    Rest { row: usize },
}

/// The unknowns and equations (rows of c+) of a list of modes, and the sign of what putting in the known impulses takes
/// from det A.
fn equations<N: Number>(problem: &Problem<N>, modes: &[Mode]) -> (Vec<Unknown<N>>, Vec<usize>, i8) {
    let (mut unknowns, mut equations, mut index) = (Vec::new(), Vec::new(), 1);
    for (k, &mode) in modes.iter().enumerate() {
        let (t, n) = (2 * k, 2 * k + 1);
        match (mode, problem.friction[k]) {
            (Mode::Separate, _) => {}
            (Mode::Stick, Friction::Finite(0.0)) => {
                unknowns.push(Unknown::single(n));
                equations.push(n);
            }
            (Mode::Stick, _) => {
                unknowns.extend([Unknown::single(t), Unknown::single(n)]);
                equations.extend([t, n]);
            }
            (_, Friction::Finite(mu)) => {
                let slope = N::new(-mu * mode.direction(), problem.bits);
                unknowns.push(Unknown { row: n, slope: Some(slope) });
                equations.push(n);
            }
            (_, Friction::Infinite) => {
                // The rows (0, +-1) and (G_nt, G_nn) have the determinant -+G_nt.
                unknowns.push(Unknown::single(t));
                equations.push(n);
                if mode == Mode::SlidePlus {
                    index = -index;
                }
            }
        }
    }
    (unknowns, equations, index)
}

/// The inequalities of the modes, impulses first: most lists fail by them, and velocities cost more.
fn demands(modes: &[Mode], friction: &[Friction]) -> Vec<Demand> {
    let mut demands = Vec::new();
    for (k, (&mode, &friction)) in modes.iter().zip(friction).enumerate() {
        let (t, n) = (2 * k, 2 * k + 1);
        match (mode, friction) {
            (Mode::Separate, _) => {}
            (Mode::Stick, Friction::Finite(mu)) if mu != 0.0 => {
                demands.push(Demand::Push { row: n, factor: 1.0 });
                demands.extend([1.0, -1.0].map(|side| Demand::Cone { row: n, mu, side }));
            }
            (Mode::Stick, _) | (_, Friction::Finite(_)) => demands.push(Demand::Push { row: n, factor: 1.0 }),
            (_, Friction::Infinite) => demands.push(Demand::Push { row: t, factor: -mode.direction() }),
        }
    }
    for (k, (&mode, friction)) in modes.iter().zip(friction).enumerate() {
        let (t, n) = (2 * k, 2 * k + 1);
        match mode {
            Mode::Separate => demands.push(Demand::Speed { row: n, factor: 1.0 }),
            Mode::Stick if friction.is_zero() => demands.push(Demand::Rest { row: t }),
            Mode::Stick => {}
            Mode::SlidePlus | Mode::SlideMinus => demands.push(Demand::Speed { row: t, factor: mode.direction() }),
        }
    }
    demands
}

/// c_t and xi_n of all contacts if the ground gives no impulse; `None` if the sign of an approach is undecided.
fn resting<N: Number>(problem: &Problem<N>, zero: Zero, scale: f64) -> Option<Vec<N>> {
    let row = |(row, free): (usize, &N)| {
        let (contact, normal) = (row / 2, row % 2 == 1);
        let restitution = problem.restitution[contact];
        if !normal || restitution == 0.0 {
            return Some(free.clone());
        }
        // xi_n = c_n+ + e min(c_n-, 0).
        let approach = &problem.approach[contact];
        Some(match zero.sign(approach, scale)? {
            Ordering::Less => free.plus(&approach.times(&N::new(restitution, problem.bits))),
            _ => free.clone(),
        })
    };
    problem.free.iter().enumerate().map(row).collect()
}

/// Solves the equations of `modes` and tests their strict inequalities.
fn judge<N: Number>(problem: &Problem<N>, modes: &[Mode], zero: Zero) -> Judgement {
    let bits = problem.bits;
    let speed = largest(problem.free.iter());
    let mobility = largest((0..problem.delassus.len()).map(|i| &problem.delassus[i][i]));
    let push = speed / mobility;
    let Some(resting) = resting(problem, zero, speed) else { return Judgement::Open };
    let (unknowns, equations, index) = equations(problem, modes);
    let row = |&row: &usize| {
        let mut entries: Vec<N> = unknowns.iter().map(|unknown| unknown.effect(problem, row)).collect();
        entries.push(resting[row].negative());
        entries
    };
    let solution = match solve(equations.iter().map(row).collect(), zero, mobility, speed, bits) {
        Solved::Open => return Judgement::Open,
        Solved::Contradictory => return Judgement::Dependent,
        Solved::Solution(solution) => solution,
    };
    let free = solution.free;
    let impulse = |row: usize| -> Affine<N> {
        let of = |(unknown, value): (&Unknown<N>, &Affine<N>)| match &unknown.slope {
            _ if unknown.row == row => Some(value.clone()),
            Some(slope) if unknown.row == row + 1 => Some(value.times(slope)),
            _ => None,
        };
        unknowns
            .iter()
            .zip(&solution.values)
            .find_map(of)
            .unwrap_or_else(|| Affine::constant(N::new(0.0, bits), free, bits))
    };
    let velocity = |row: usize| -> Affine<N> {
        let start = Affine::constant(resting[row].clone(), free, bits);
        let add = |sum: Affine<N>, (unknown, value): (&Unknown<N>, &Affine<N>)| {
            sum.plus(&value.times(&unknown.effect(problem, row)))
        };
        unknowns.iter().zip(&solution.values).fold(start, add)
    };
    let (mut open, mut border) = (false, false);
    let mut inequalities = Vec::new();
    for demand in demands(modes, &problem.friction) {
        let number = |value: f64| N::new(value, bits);
        let (value, scale, strict) = match demand {
            Demand::Push { row, factor } => (impulse(row).times(&number(factor)), push, false),
            Demand::Cone { row, mu, side } => {
                let cone = impulse(row).times(&number(mu)).plus(&impulse(row - 1).times(&number(-side)));
                (cone, push, false)
            }
            Demand::Speed { row, factor } => (velocity(row).times(&number(factor)), speed, true),
            Demand::Rest { row } => {
                let value = velocity(row);
                if free == 0 {
                    match zero.sign(&value.constant, speed) {
                        None => open = true,
                        Some(Ordering::Equal) => {}
                        Some(_) => return Judgement::None,
                    }
                } else {
                    let opposite = value.times(&number(-1.0));
                    inequalities.push(Inequality { value: opposite, scale: speed, strict: false });
                    inequalities.push(Inequality { value, scale: speed, strict: false });
                }
                continue;
            }
        };
        if free > 0 {
            inequalities.push(Inequality { value, scale, strict });
            continue;
        }
        match zero.sign(&value.constant, scale) {
            None => open = true,
            Some(Ordering::Less) => return Judgement::None,
            Some(Ordering::Equal) if strict => return Judgement::None,
            Some(Ordering::Equal) => border = true,
            Some(Ordering::Greater) => {}
        }
    }
    if free == 0 {
        return match (open, border) {
            (true, _) => Judgement::Open,
            (false, true) => Judgement::Outcome(Index::Border),
            (false, false) => Judgement::Outcome(Index::Sign(index * solution.sign)),
        };
    }
    // Where what is free changes a velocity, every value of it is an outcome of its own.
    let family = || {
        let moved = |row: usize| velocity(row).factors.iter().any(|f| zero.sign(f, mobility) != Some(Ordering::Equal));
        (0..resting.len()).any(moved)
    };
    match feasible(inequalities, zero, push) {
        Some(false) => Judgement::Dependent,
        Some(true) if !family() => Judgement::Outcome(Index::Redundant),
        _ => Judgement::Open,
    }
}

fn largest<'a, N: Number + 'a>(numbers: impl Iterator<Item = &'a N>) -> f64 {
    numbers.map(N::size).fold(0.0, f64::max)
}
