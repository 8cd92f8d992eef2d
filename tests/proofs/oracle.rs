//! Every outcome of a state, by one dense linear solve for each of the 4^n lists of modes, in balls.
//!
//! A contact that separates has no unknown, one that slides one (L_n, or with infinite friction L_t), one that sticks two
//! (one at friction 0). Where 256 bits leave a sign open it is tried with 448 and 832; a number that these hold below
//! 2^-150 of its scale is taken for zero, and the state for one on a border.

use crate::dynamics::{Problem, problem};
use crate::number::{Ball, Number};
use heelstrike::impact::{Friction, Mode};
use heelstrike::robot::Robot;
use heelstrike::state::State;
use std::cmp::Ordering;

/// The precisions that are tried, one after the other.
const BITS: [usize; 3] = [256, 448, 832];

/// What is below this part of its scale at the highest precision counts as zero: 2^-150.
const ZERO: f64 = 7.006492321624085e-46;

/// An outcome, as far as signs tell it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Outcome {
    /// One mode per contact.
    pub modes: Vec<Mode>,
    /// Sign of det A; none on a border.
    pub index: Option<i8>,
}

/// All that the oracle knows about a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Every outcome, in the order of its modes.
    pub outcomes: Vec<Outcome>,
    /// Lists of modes whose equations no precision solved: contacts that depend on each other.
    pub open: usize,
    /// The precision that it took.
    pub bits: usize,
}

/// Every outcome of the contacts that the state names; none where the mass matrix is singular.
pub fn answer(robot: &Robot, state: &State) -> Option<Answer> {
    let mut outcomes = Vec::new();
    let mut open: Option<Vec<Vec<Mode>>> = None;
    for bits in BITS {
        let problem = problem::<Ball>(robot, state, bits)?;
        let last = bits == BITS[BITS.len() - 1];
        let lists = open.take().unwrap_or_else(|| lists(problem.friction.len()));
        let mut left = Vec::new();
        for modes in lists {
            match judge(&problem, &modes, last) {
                Judgement::Outcome(index) => outcomes.push(Outcome { modes, index }),
                Judgement::None => {}
                Judgement::Open => left.push(modes),
            }
        }
        if left.is_empty() || last {
            outcomes.sort();
            return Some(Answer { outcomes, open: left.len(), bits });
        }
        open = Some(left);
    }
    None
}

/// The lists of modes that f64 takes for outcomes; nothing is proven by them.
pub fn guess(robot: &Robot, state: &State) -> Vec<Vec<Mode>> {
    let Some(problem) = problem::<f64>(robot, state, 0) else { return Vec::new() };
    let mut lists = lists(problem.friction.len());
    lists.retain(|modes| matches!(judge(&problem, modes, false), Judgement::Outcome(_)));
    lists
}

/// All 4^n lists of modes.
fn lists(contacts: usize) -> Vec<Vec<Mode>> {
    let modes = |number: usize| (0..contacts).map(|k| Mode::ALL[number >> (2 * k) & 3]).collect();
    (0..1 << (2 * contacts)).map(modes).collect()
}

/// What a list of modes comes to.
enum Judgement {
    /// An outcome with its index, which it lacks on a border.
    Outcome(Option<i8>),
    /// No outcome.
    None,
    /// Not told by this precision.
    Open,
}

/// Of which of the two kinds of numbers a slack is; they have scales of their own.
#[derive(Clone, Copy)]
enum Kind {
    Speed,
    Impulse,
}

/// The signs of a list's inequalities, as they come in.
struct Signs {
    scales: [f64; 2],
    /// Whether what is not told apart from zero, but very small, is zero.
    last: bool,
    negative: bool,
    open: bool,
    border: bool,
}

impl Signs {
    /// How `number` compares with zero; none where it is not told.
    fn of<N: Number>(&self, number: &N, kind: Kind) -> Option<Ordering> {
        let small = || self.last && number.size() < ZERO * self.scales[kind as usize];
        number.sign().or_else(|| small().then_some(Ordering::Equal))
    }

    /// The inequality number >= 0, or > 0 where it is `strict`.
    fn require<N: Number>(&mut self, number: &N, kind: Kind, strict: bool) {
        match self.of(number, kind) {
            None => self.open = true,
            Some(Ordering::Less) => self.negative = true,
            Some(Ordering::Equal) if strict => self.negative = true,
            Some(Ordering::Equal) => self.border = true,
            Some(Ordering::Greater) => {}
        }
    }
}

/// Solves the equations of `modes` and tests their strict inequalities (`paper`, section "The collision").
fn judge<N: Number>(problem: &Problem<N>, modes: &[Mode], last: bool) -> Judgement {
    let bits = problem.bits;
    let zero = N::new(0.0, bits);
    // An unknown is L_row of one entry, or L_n of a slide, which brings L_t = slope * L_n with it.
    let mut unknowns: Vec<(usize, Option<N>)> = Vec::new();
    let mut equations: Vec<usize> = Vec::new();
    // Sign of what the unknowns that were put in lose against det A.
    let mut index = 1;
    for (k, &mode) in modes.iter().enumerate() {
        let (t, n) = (2 * k, 2 * k + 1);
        match (mode, problem.friction[k]) {
            (Mode::Separate, _) => {}
            (Mode::Stick, Friction::Finite(0.0)) => {
                unknowns.push((n, None));
                equations.push(n);
            }
            (Mode::Stick, _) => {
                unknowns.extend([(t, None), (n, None)]);
                equations.extend([t, n]);
            }
            (_, Friction::Finite(mu)) => {
                unknowns.push((n, Some(N::new(-mu * mode.direction(), bits))));
                equations.push(n);
            }
            (_, Friction::Infinite) => {
                // The rows (0, +-1) and (G_nt, G_nn) have the determinant -+G_nt.
                unknowns.push((t, None));
                equations.push(n);
                if mode == Mode::SlidePlus {
                    index = -index;
                }
            }
        }
    }
    // c_n- + e min(c_n-, 0) without an impulse; the law asks for zero of it, or more.
    let scales = [largest(&problem.free), largest(&problem.free) / largest_diagonal(problem)];
    let mut signs = Signs { scales, last, negative: false, open: false, border: false };
    let mut resting = Vec::with_capacity(2 * modes.len());
    for (row, free) in problem.free.iter().enumerate() {
        let (contact, normal) = (row / 2, row % 2 == 1);
        if !normal || problem.restitution[contact] == 0.0 {
            resting.push(free.clone());
            continue;
        }
        let approach = &problem.approach[contact];
        resting.push(match signs.of(approach, Kind::Speed) {
            None => return Judgement::Open,
            Some(Ordering::Less) => free.plus(&approach.times(&N::new(problem.restitution[contact], bits))),
            Some(_) => free.clone(),
        });
    }
    let coefficient = |row: usize, (column, slope): &(usize, Option<N>)| {
        let entry = &problem.delassus[row][*column];
        match slope {
            Some(slope) if !slope.is_zero() => entry.plus(&problem.delassus[row][column - 1].times(slope)),
            _ => entry.clone(),
        }
    };
    let rows = equations.iter().map(|&row| {
        let mut entries: Vec<N> = unknowns.iter().map(|unknown| coefficient(row, unknown)).collect();
        entries.push(resting[row].negative());
        entries
    });
    let Some((solution, sign)) = solve(rows.collect()) else { return Judgement::Open };
    index *= sign;

    let mut impulse = vec![zero.clone(); 2 * modes.len()];
    for ((row, slope), value) in unknowns.iter().zip(&solution) {
        impulse[*row] = value.clone();
        if let Some(slope) = slope {
            impulse[row - 1] = value.times(slope);
        }
    }
    for (k, &mode) in modes.iter().enumerate() {
        let (l_t, l_n) = (&impulse[2 * k], &impulse[2 * k + 1]);
        match (mode, problem.friction[k]) {
            (Mode::Separate, _) => {}
            (Mode::Stick, friction) => {
                signs.require(l_n, Kind::Impulse, false);
                if let Friction::Finite(mu) = friction
                    && mu != 0.0
                {
                    let bound = l_n.times(&N::new(mu, bits));
                    signs.require(&bound.minus(l_t), Kind::Impulse, false);
                    signs.require(&bound.plus(l_t), Kind::Impulse, false);
                }
            }
            (_, Friction::Finite(_)) => signs.require(l_n, Kind::Impulse, false),
            (Mode::SlidePlus, Friction::Infinite) => signs.require(&l_t.negative(), Kind::Impulse, false),
            (Mode::SlideMinus, Friction::Infinite) => signs.require(l_t, Kind::Impulse, false),
        }
        if signs.negative {
            return Judgement::None;
        }
    }
    let after = |row: usize| {
        unknowns
            .iter()
            .zip(&solution)
            .fold(resting[row].clone(), |sum, (unknown, value)| sum.plus(&coefficient(row, unknown).times(value)))
    };
    for (k, &mode) in modes.iter().enumerate() {
        match mode {
            Mode::Separate => signs.require(&after(2 * k + 1), Kind::Speed, true),
            Mode::SlidePlus => signs.require(&after(2 * k), Kind::Speed, true),
            Mode::SlideMinus => signs.require(&after(2 * k).negative(), Kind::Speed, true),
            Mode::Stick if problem.friction[k].is_zero() => match signs.of(&after(2 * k), Kind::Speed) {
                None => signs.open = true,
                Some(Ordering::Equal) => {}
                Some(_) => signs.negative = true,
            },
            Mode::Stick => {}
        }
        if signs.negative {
            return Judgement::None;
        }
    }
    if signs.open { Judgement::Open } else { Judgement::Outcome((!signs.border).then_some(index)) }
}

fn largest<N: Number>(numbers: &[N]) -> f64 {
    numbers.iter().map(N::size).fold(0.0, f64::max)
}

fn largest_diagonal<N: Number>(problem: &Problem<N>) -> f64 {
    (0..problem.delassus.len()).map(|i| problem.delassus[i][i].size()).fold(0.0, f64::max)
}

/// The solution of `rows` = [A | b] and the sign of det A, by Gauss; none where no pivot of a column has a sign.
fn solve<N: Number>(mut rows: Vec<Vec<N>>) -> Option<(Vec<N>, i8)> {
    let n = rows.len();
    let mut sign = 1;
    for k in 0..n {
        let pivot = (k..n)
            .filter(|&row| matches!(rows[row][k].sign(), Some(Ordering::Less | Ordering::Greater)))
            .max_by(|&a, &b| rows[a][k].size().total_cmp(&rows[b][k].size()))?;
        if pivot != k {
            rows.swap(pivot, k);
            sign = -sign;
        }
        if rows[k][k].sign() == Some(Ordering::Less) {
            sign = -sign;
        }
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot_row = &above[k];
        for row in below {
            if row[k].is_zero() {
                continue;
            }
            let factor = row[k].over(&pivot_row[k]);
            for (entry, over) in row.iter_mut().zip(pivot_row).skip(k + 1) {
                *entry = entry.minus(&factor.times(over));
            }
        }
    }
    let mut solution: Vec<N> = Vec::with_capacity(n);
    // From the last unknown to the first.
    for k in (0..n).rev() {
        let mut rest = rows[k][n].clone();
        for (entry, known) in rows[k][k + 1..n].iter().rev().zip(&solution) {
            rest = rest.minus(&entry.times(known));
        }
        solution.push(rest.over(&rows[k][k]));
    }
    solution.reverse();
    Some((solution, sign))
}
