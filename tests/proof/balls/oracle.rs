//! Every outcome of a state, by one dense linear solve in balls for each of the 4^n combinations of modes.
//!
//! A separating contact has no unknown, a sliding one has one (L_n, or L_t at infinite friction), a sticking one has
//! two (one at friction 0). A sign that 256 bits leave open is tried with 832 bits; a number that is then bounded below
//! 2^-150 of its scale counts as zero, and its state as on a border. If equations depend on each other, the free
//! impulses are eliminated from the inequalities one by one (Fourier-Motzkin).

use crate::balls::dynamics::{Problem, Terms, problem, terms};
use crate::balls::linear::{Affine, Inequality, Solution, Solved, Zero, feasible, solve};
use crate::balls::number::{Ball, Number};
use crate::balls::poses::dot;
use crate::support::digits::{Truth, needed};
use heelstrike::impact::{Friction, Mode};
use heelstrike::robot::Robot;
use heelstrike::state::State;
use std::cmp::Ordering;

/// The precisions that are tried, one after the other.
const BITS: [usize; 2] = [256, 832];

/// An outcome, as far as signs determine it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Outcome {
    pub modes: Vec<Mode>,
    pub index: Index,
}

/// The sign of det A, if it has one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Index {
    Sign(i8),
    /// An inequality is zero.
    Border,
    /// Contacts are redundant, so that det A = 0.
    Redundant,
}

/// All that the oracle knows about a state.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Answer {
    /// Every outcome, in the order of its modes.
    pub outcomes: Vec<Outcome>,
    /// Number of combinations that no precision decided: families, or many free impulses.
    pub open: usize,
    /// Whether the equations of some combination depend on each other. Then there need not be an outcome, and indices
    /// need not sum to one.
    pub dependent: bool,
    /// The precision that was needed.
    pub bits: usize,
}

/// Every outcome of the state's named contacts, of which the `resting` ones are exactly at rest; `None` if the mass
/// matrix is singular.
pub fn answer(robot: &Robot, state: &State, resting: &[bool]) -> Option<Answer> {
    answer_about(robot, state, resting, None)
}

/// Every outcome in sustained contact of the state's named contacts, which slide with these signs; `None` if the mass
/// matrix is singular.
pub fn forces(robot: &Robot, state: &State, slips: &[Ordering]) -> Option<Answer> {
    answer_about(robot, state, &[], Some(slips))
}

fn answer_about(robot: &Robot, state: &State, resting: &[bool], slips: Option<&[Ordering]>) -> Option<Answer> {
    let mut outcomes = Vec::new();
    let mut dependent = false;
    let mut open: Option<Vec<Vec<Mode>>> = None;
    for bits in BITS {
        let problem = problem::<Ball>(robot, state, resting, slips, bits, false)?;
        let last = bits == BITS[BITS.len() - 1];
        let lists = open.take().unwrap_or_else(|| {
            let may =
                |(mode, slides): (&Mode, &Option<Mode>)| slides.is_none_or(|own| [Mode::Separate, own].contains(mode));
            let mut lists = lists(problem.friction.len());
            lists.retain(|modes| modes.iter().zip(&problem.slides).all(may));
            lists
        });
        let mut left = Vec::new();
        for modes in lists {
            match judge(&problem, &modes, Zero { last }) {
                Judgment::Outcome(index) => {
                    dependent |= index == Index::Redundant;
                    outcomes.push(Outcome { modes, index });
                }
                Judgment::None => {}
                Judgment::Dependent => dependent = true,
                Judgment::Open => left.push(modes),
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

/// The combinations that are outcomes in f64, without any proof.
pub fn guess(robot: &Robot, state: &State) -> Vec<Vec<Mode>> {
    let Some(problem) = problem::<f64>(robot, state, &[], None, 0, false) else { return Vec::new() };
    let mut lists = lists(problem.friction.len());
    lists.retain(|modes| matches!(judge(&problem, modes, Zero { last: false }), Judgment::Outcome(_)));
    lists
}

/// The numbers of the outcome with these modes, for a state without applied impulses. With `slips` they are those of
/// forces, and the rates of base and joints start from those before. `None` if the equations depend on each other.
pub fn truth(robot: &Robot, state: &State, slips: Option<&[Ordering]>, modes: &[Mode]) -> Option<Truth> {
    let bits = BITS[BITS.len() - 1];
    let problem = problem::<Ball>(robot, state, &[], slips, bits, true)?;
    let zero = Zero { last: true };
    let [speed, mobility] =
        [largest(problem.free.iter()), largest((0..problem.free.len()).map(|i| &problem.delassus[i][i]))];
    let resting = resting(&problem, zero, speed)?;
    let (unknowns, equations, _) = equations(&problem, modes);
    let row = |&row: &usize| -> Vec<Ball> {
        let effects = unknowns.iter().map(|unknown| unknown.effect(&problem, row));
        effects.chain([resting[row].negative()]).collect()
    };
    let solved = solve(equations.iter().map(row).collect(), zero, mobility, speed, bits);
    let Solved::Solution(Solution { values, free: 0, .. }) = solved else { return None };
    let mut impulse = vec![Ball::new(0.0, bits); resting.len()];
    let mut after = problem.free.clone();
    for (unknown, value) in unknowns.iter().zip(&values) {
        impulse[unknown.row] = value.constant.clone();
        if let Some(slope) = &unknown.slope {
            impulse[unknown.row - 1] = value.constant.times(slope);
        }
        for (row, entry) in after.iter_mut().enumerate() {
            *entry = entry.plus(&value.constant.times(&unknown.effect(&problem, row)));
        }
    }
    let moved = (0..problem.velocity.len()).map(|coordinate| {
        let parts = problem.responses.iter().zip(&impulse).map(|(response, l)| response[coordinate].times(l));
        parts.fold(problem.velocity[coordinate].clone(), |sum, part| sum.plus(&part))
    });
    let moved: Vec<Ball> = moved.collect();
    // The loss is that of kinetic energy, unless a brake or a loop takes part, too.
    let loss = if slips.is_none() && state.scene.braked.is_empty() && state.scene.loops.is_empty() {
        let position: Vec<Ball> = state.position.iter().map(|&entry| Ball::new(entry, bits)).collect();
        let Terms { mass_matrix, .. } = terms::<Ball>(robot, state, &position, bits)?;
        let entry = |i: usize, j: usize| &mass_matrix[i.max(j)][i.min(j)];
        let twice = |v: &[Ball]| {
            let row = |i: usize| dot((0..v.len()).map(|j| (entry(i, j), &v[j])), bits).times(&v[i]);
            (0..v.len()).map(row).fold(Ball::new(0.0, bits), |sum, row| sum.plus(&row))
        };
        twice(&problem.velocity).minus(&twice(&moved)).times(&Ball::new(0.5, bits))
    } else {
        let work = impulse.iter().zip(problem.free.iter().zip(&after)).map(|(l, (c, after))| l.times(&c.plus(after)));
        work.fold(Ball::new(0.0, bits), |sum, work| sum.plus(&work)).times(&Ball::new(-0.5, bits))
    };
    // A number that 832 bits do not distinguish from zero becomes 0.
    let number = |ball: &Ball, scale: f64| match zero.sign(ball, scale) {
        Some(Ordering::Greater) => ball.size(),
        Some(Ordering::Less) => -ball.size(),
        _ => 0.0,
    };
    let pairs =
        |rows: &[Ball], scale: f64| rows.chunks(2).map(|c| [number(&c[0], scale), number(&c[1], scale)]).collect();
    let push = speed / mobility;
    let pushes: Vec<[f64; 2]> = pairs(&impulse, push);
    let diagonal: Vec<Ball> = (0..resting.len()).map(|row| problem.delassus[row][row].clone()).collect();
    // An upper bound on what the impulses do to a coordinate, whatever their signs: |(M^-1 J^T)_jr| <= sqrt((M^-1)_jj
    // G_rr).
    let pressed: f64 = (0..resting.len()).map(|r| impulse[r].size() * problem.delassus[r][r].size().sqrt()).sum();
    let rates = moved.iter().zip(&problem.velocity).zip(&problem.ease).map(|((after, before), ease)| {
        let scale = before.size().max(ease.size().sqrt() * pressed);
        [number(after, scale), scale]
    });
    Some(Truth {
        of_robot: true,
        rates: rates.collect(),
        mobility: pairs(&diagonal, 0.0).into_iter().map(|pair| pair.map(f64::sqrt)).collect(),
        before: pairs(&problem.free, speed),
        after: pairs(&after, speed),
        energy_loss: number(&loss, push * speed),
        friction_needed: needed(modes, &pushes),
        impulse: pushes,
    })
}

/// All 4^n combinations of modes.
fn lists(contacts: usize) -> Vec<Vec<Mode>> {
    let modes = |number: usize| (0..contacts).map(|k| Mode::ALL[number >> (2 * k) & 3]).collect();
    (0..1 << (2 * contacts)).map(modes).collect()
}

/// What is decided about a combination of modes.
enum Judgment {
    Outcome(Index),
    None,
    /// No outcome, and the equations depend on each other.
    Dependent,
    /// Not decided by this precision.
    Open,
}

/// An unknown entry of L; the L_n of a sliding contact also determines L_t = slope * L_n.
struct Unknown<N> {
    row: usize,
    slope: Option<N>,
}

impl<N: Number> Unknown<N> {
    /// What one unit of the unknown adds to the contact velocity of a row.
    fn effect(&self, problem: &Problem<N>, row: usize) -> N {
        let entry = &problem.delassus[row][self.row];
        match &self.slope {
            Some(slope) if !slope.is_zero() => entry.plus(&problem.delassus[row][self.row - 1].times(slope)),
            _ => entry.clone(),
        }
    }
}

/// How a value is compared with zero.
#[derive(Clone, Copy, PartialEq)]
enum Comparison {
    Positive,
    NotNegative,
    Zero,
}

/// The unknowns and equations (rows of c+) of a combination, and the sign that det A changes by when the known impulses
/// are substituted.
fn equations<N: Number>(problem: &Problem<N>, modes: &[Mode]) -> (Vec<Unknown<N>>, Vec<usize>, i8) {
    let (mut unknowns, mut equations, mut index) = (Vec::new(), Vec::new(), 1);
    let single = |row| Unknown { row, slope: None };
    for (k, &mode) in modes.iter().enumerate() {
        let (t, n) = (2 * k, 2 * k + 1);
        match (mode, problem.friction[k]) {
            (Mode::Separate, _) => {}
            (Mode::Stick, Friction::Finite(0.0)) => {
                unknowns.push(single(n));
                equations.push(n);
            }
            (Mode::Stick, _) => {
                unknowns.extend([single(t), single(n)]);
                equations.extend([t, n]);
            }
            (_, Friction::Finite(mu)) => {
                let slope = N::new(-mu * mode.direction(), problem.bits);
                unknowns.push(Unknown { row: n, slope: Some(slope) });
                equations.push(n);
            }
            (_, Friction::Infinite) => {
                // The rows (0, +-1) and (G_nt, G_nn) have the determinant -+G_nt.
                unknowns.push(single(t));
                equations.push(n);
                if mode == Mode::SlidePlus {
                    index = -index;
                }
            }
        }
    }
    (unknowns, equations, index)
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

/// Solves the equations of `modes` and tests their inequalities.
fn judge<N: Number>(problem: &Problem<N>, modes: &[Mode], zero: Zero) -> Judgment {
    let bits = problem.bits;
    let speed = largest(problem.free.iter());
    let mobility = largest((0..problem.delassus.len()).map(|i| &problem.delassus[i][i]));
    let push = speed / mobility;
    let Some(resting) = resting(problem, zero, speed) else { return Judgment::Open };
    let (unknowns, equations, index) = equations(problem, modes);
    let row = |&row: &usize| {
        let mut entries: Vec<N> = unknowns.iter().map(|unknown| unknown.effect(problem, row)).collect();
        entries.push(resting[row].negative());
        entries
    };
    let solution = match solve(equations.iter().map(row).collect(), zero, mobility, speed, bits) {
        Solved::Open => return Judgment::Open,
        Solved::Contradictory => return Judgment::Dependent,
        Solved::Solution(solution) => solution,
    };
    let free = solution.free;
    let impulse = |row: usize| -> Affine<N> {
        let of = |(unknown, value): (&Unknown<N>, &Affine<N>)| match &unknown.slope {
            _ if unknown.row == row => Some(value.clone()),
            Some(slope) if unknown.row == row + 1 => Some(value.times(slope)),
            _ => None,
        };
        let found = unknowns.iter().zip(&solution.values).find_map(of);
        found.unwrap_or_else(|| Affine::constant(N::new(0.0, bits), free, bits))
    };
    let velocity = |row: usize| -> Affine<N> {
        let start = Affine::constant(resting[row].clone(), free, bits);
        let add = |sum: Affine<N>, (unknown, value): (&Unknown<N>, &Affine<N>)| {
            sum.plus(&value.times(&unknown.effect(problem, row)))
        };
        unknowns.iter().zip(&solution.values).fold(start, add)
    };
    let number = |value: f64| N::new(value, bits);
    let pushes = |(k, &mode): (usize, &Mode)| {
        let (t, n) = (2 * k, 2 * k + 1);
        match (mode, problem.friction[k]) {
            (Mode::Separate, _) => vec![],
            (Mode::Stick, Friction::Finite(mu)) if mu != 0.0 => {
                let most = impulse(n).times(&number(mu));
                let cone = |side: f64| most.plus(&impulse(t).times(&number(side)));
                vec![impulse(n), cone(-1.0), cone(1.0)]
            }
            (Mode::Stick, _) | (_, Friction::Finite(_)) => vec![impulse(n)],
            (_, Friction::Infinite) => vec![impulse(t).times(&number(-mode.direction()))],
        }
    };
    let speeds = |(k, &mode): (usize, &Mode)| match mode {
        Mode::Separate => Some((velocity(2 * k + 1), Comparison::Positive)),
        Mode::Stick => problem.friction[k].is_zero().then(|| (velocity(2 * k), Comparison::Zero)),
        // A contact that slides already may slow down or speed up.
        _ if problem.slides[k].is_some() => None,
        _ => Some((velocity(2 * k).times(&number(mode.direction())), Comparison::Positive)),
    };
    // Impulses come first: most combinations fail by them, and velocities cost more.
    let pushes = modes.iter().enumerate().flat_map(pushes).map(|value| (value, push, Comparison::NotNegative));
    let speeds = modes.iter().enumerate().filter_map(speeds).map(|(value, comparison)| (value, speed, comparison));
    let (mut open, mut border) = (false, false);
    let mut inequalities = Vec::new();
    for (value, scale, comparison) in pushes.chain(speeds) {
        if free > 0 {
            if comparison == Comparison::Zero {
                inequalities.push(Inequality { value: value.times(&number(-1.0)), scale, strict: false });
            }
            inequalities.push(Inequality { value, scale, strict: comparison == Comparison::Positive });
            continue;
        }
        match (zero.sign(&value.constant, scale), comparison) {
            (None, _) => open = true,
            (Some(Ordering::Equal), Comparison::Zero) => {}
            (Some(Ordering::Equal), Comparison::NotNegative) => border = true,
            (Some(Ordering::Greater), Comparison::Positive | Comparison::NotNegative) => {}
            _ => return Judgment::None,
        }
    }
    if free == 0 {
        return match (open, border) {
            (true, _) => Judgment::Open,
            (false, true) => Judgment::Outcome(Index::Border),
            (false, false) => Judgment::Outcome(Index::Sign(index * solution.sign)),
        };
    }
    // If free variables change a velocity, every value of them is an outcome of its own: a family.
    let family = || {
        let moved = |row: usize| velocity(row).factors.iter().any(|f| zero.sign(f, mobility) != Some(Ordering::Equal));
        (0..resting.len()).any(moved)
    };
    match feasible(inequalities, zero, push) {
        Some(false) => Judgment::Dependent,
        Some(true) if !family() => Judgment::Outcome(Index::Redundant),
        _ => Judgment::Open,
    }
}

fn largest<'a, N: Number + 'a>(numbers: impl Iterator<Item = &'a N>) -> f64 {
    numbers.map(N::size).fold(0.0, f64::max)
}
