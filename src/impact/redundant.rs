//! Combinations that elimination cannot decide: contacts that depend on each other, vanishing pivots.
//!
//! ```text
//!     G = Z Z^T      c = c_free + Z w,  w = Z^T L      rows of the modes: Z_E w = -c_E,  L = B lambda in the cones
//! ```
//!
//! Rank is decided on the rows of Z scaled to length one (the condition of G squares theirs). Where the rows of the modes
//! determine the velocity but not the impulses, the impulses form a convex set; the combination is an outcome exactly when
//! that set is not empty, which a linear program answers, and the impulse told is its member of least norm. A velocity that
//! the modes exclude only by depending on others (a flat foot whose heel sticks cannot slide at the toe) belongs to the list
//! of modes that says so: its redundant twin.

use super::basis::{Agreement, Basis, dot, solve};
use super::generators::{Generators, slide_ray};
use super::mode::{Friction, Mode};
use super::outcome::{Because, Motion};
use super::problem::ContactProblem;
use super::program::{Affine, least_impulse, opens, widest_slack};
use super::sign::{Scale, SlackKind};
use crate::scalar::Sign;

/// A scaled number within this of zero is not told from zero: the tolerance of the programs, above that of the rank.
const TOLERANCE: f64 = 1e-9;
/// A margin within this of zero, where the modes ask for a velocity that is not, is the rounding of one that the equations
/// hold at zero (heel and toe of a flat foot cannot slide apart); so is a coefficient of rows of length one.
const ROUNDING: f64 = 1e-12;
/// Slacks are not followed beyond this: the impulses are then unbounded.
const UNBOUNDED: f64 = 1e3;

/// A problem's rows Z, scaled to length one, and c_free (with the bounce on normal rows) in the same scale.
#[derive(Debug, Clone)]
pub struct Rows {
    columns: usize,
    rows: Vec<Vec<f64>>,
    free: Vec<f64>,
}

/// What became of a combination.
#[derive(Debug, Clone)]
pub struct Judged {
    /// Positive: valid. Negative: rejected with a reason. Zero: a velocity that must differ from zero vanishes to rounding,
    /// so that this is a redundant twin of the outcome with the same velocity, if there is one. Else not told.
    pub sign: Sign,
    /// Why not, where rejected.
    pub because: Because,
    /// The smallest slack, where there is one.
    pub margin: Option<f64>,
    /// Impulse and velocity after, where the combination has a solution.
    pub motion: Option<Motion>,
    /// Whether the impulse is the only one.
    pub impulse_unique: bool,
    /// Whether an impulse inequality is zero for every admissible impulse.
    pub border: bool,
}

impl Judged {
    fn without_solution(because: Because) -> Self {
        Self { sign: Sign::Negative, because, margin: None, motion: None, impulse_unique: false, border: false }
    }
}

impl Rows {
    /// The rows of a problem: those it was built from, else by elimination of G with diagonal pivoting.
    pub fn of(problem: &ContactProblem, scale: &Scale) -> Self {
        let count = 2 * problem.contacts();
        let rows: Vec<Vec<f64>> = match problem.factor() {
            Some(factor) => (0..count)
                .map(|row| {
                    let entries = &factor.rows[row * factor.columns..(row + 1) * factor.columns];
                    entries.iter().map(|entry| entry / scale.mobility[row]).collect()
                })
                .collect(),
            None => factorized(problem, scale),
        };
        let columns = rows.first().map_or(0, Vec::len);
        let free = problem
            .velocity_free()
            .iter()
            .enumerate()
            .flat_map(|(contact, &[t, n])| [t, n + problem.bounce(contact)])
            .zip(&scale.mobility)
            .map(|(c, mobility)| c / (mobility * scale.speed))
            .collect();
        Self { columns, rows, free }
    }

    /// Rank of G.
    pub fn rank(&self) -> usize {
        let mut basis = Basis::new(self.columns);
        basis.extend(&self.rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
        basis.rank()
    }

    /// Judges one combination; frictionless contacts have their own mode here.
    pub fn judge(&self, problem: &ContactProblem, scale: &Scale, modes: &[Mode]) -> Judged {
        let zero = zero_rows(modes);
        let rows: Vec<&[f64]> = zero.iter().map(|&row| self.rows[row].as_slice()).collect();
        let right: Vec<f64> = zero.iter().map(|&row| -self.free[row]).collect();
        let (w, basis, agreement) = solve(self.columns, &rows, &right);
        if agreement == Agreement::Fails {
            return Judged::without_solution(Because::NoSolution);
        }
        let mut doubtful = agreement == Agreement::Doubtful;
        for (contact, &mode) in modes.iter().enumerate() {
            let row = match mode {
                Mode::Separate => 2 * contact + 1,
                Mode::SlidePlus | Mode::SlideMinus => 2 * contact,
                Mode::Stick => continue,
            };
            let reach = TOLERANCE * (1.0 + dot(&w, &w).sqrt());
            if basis.spans(&self.rows[row]) && (self.free[row] + dot(&self.rows[row], &w)).abs() <= reach {
                return Judged::without_solution(Because::RedundantTwin);
            }
        }
        let generators = Generators::of(&self.rows, problem, scale, modes);
        let equations: Vec<Vec<f64>> = basis.rows().map(|unit| generators.against(unit)).collect();
        let right: Vec<f64> = basis.rows().map(|unit| dot(unit, &w)).collect();
        let rows: Vec<&[f64]> = equations.iter().map(Vec::as_slice).collect();
        let (origin, span, agreement) = solve(generators.count(), &rows, &right);
        if agreement == Agreement::Fails {
            return Judged::without_solution(Because::NoSolution);
        }
        doubtful |= agreement == Agreement::Doubtful;
        let free: Vec<Vec<f64>> = span.complement().rows().map(<[f64]>::to_vec).collect();
        let slacks = self.slacks(problem, scale, modes, &generators, &origin, &free);
        let judged = self.weigh(problem, scale, modes, &generators, (origin, free), slacks);
        let sign = if doubtful && judged.sign != Sign::Negative { Sign::Undecided } else { judged.sign };
        Judged { sign, ..judged }
    }

    /// Every slack of the combination as a function of the free parameters y of lambda = origin + free y.
    fn slacks(
        &self,
        problem: &ContactProblem,
        scale: &Scale,
        modes: &[Mode],
        generators: &Generators,
        origin: &[f64],
        free: &[Vec<f64>],
    ) -> Vec<(usize, SlackKind, Affine)> {
        let affine = |constant: f64, of_lambda: &[f64]| Affine {
            constant: constant + dot(of_lambda, origin),
            coefficients: free.iter().map(|direction| without_noise(dot(of_lambda, direction))).collect(),
        };
        let velocity = |row: usize, sign: f64| {
            let of_lambda: Vec<f64> = generators.against(&self.rows[row]).iter().map(|entry| sign * entry).collect();
            affine(sign * self.free[row], &of_lambda)
        };
        let impulse = |row: usize, factor: f64| generators.impulse_row(row, factor);
        let mut slacks = Vec::new();
        for (contact, &mode) in modes.iter().enumerate() {
            let (t, n) = (2 * contact, 2 * contact + 1);
            let friction = problem.friction()[contact];
            match mode {
                Mode::Separate => slacks.push((contact, SlackKind::Separation, velocity(n, 1.0))),
                Mode::Stick => {
                    slacks.push((contact, SlackKind::Pressure, affine(0.0, &impulse(n, 1.0))));
                    if let Friction::Finite(mu) = friction
                        && mu > 0.0
                    {
                        let (by_n, by_t) = (mu / scale.mobility[n], 1.0 / scale.mobility[t]);
                        let length = by_n.hypot(by_t);
                        for side in [-1.0, 1.0] {
                            let reach = impulse(n, by_n / length);
                            let pull = impulse(t, side * by_t / length);
                            let both: Vec<f64> = reach.iter().zip(&pull).map(|(a, b)| a + b).collect();
                            slacks.push((contact, SlackKind::Cone, affine(0.0, &both)));
                        }
                    }
                }
                Mode::SlidePlus | Mode::SlideMinus => {
                    let (kind, row, factor) = match friction {
                        Friction::Infinite => (SlackKind::Drag, t, -mode.direction()),
                        Friction::Finite(_) => (SlackKind::Pressure, n, 1.0),
                    };
                    slacks.push((contact, kind, affine(0.0, &impulse(row, factor))));
                    slacks.push((contact, SlackKind::Slip, velocity(t, mode.direction())));
                }
            }
        }
        slacks
    }

    /// Chooses among the free impulses and reads the signs.
    fn weigh(
        &self,
        problem: &ContactProblem,
        scale: &Scale,
        modes: &[Mode],
        generators: &Generators,
        (origin, free): (Vec<f64>, Vec<Vec<f64>>),
        slacks: Vec<(usize, SlackKind, Affine)>,
    ) -> Judged {
        // Whatever the velocities are off by is as good as the programs' own tolerance.
        let size = (1.0 + scale.noise / TOLERANCE) * (1.0 + dot(&origin, &origin).sqrt());
        let functions: Vec<Affine> = slacks.iter().map(|(_, _, slack)| slack.clone()).collect();
        let strict = |index: usize| slacks[index].1.is_strict();
        let widest = if free.is_empty() { None } else { widest_slack(&functions, free.len(), UNBOUNDED) };
        // Where the velocities themselves form a set, no single one may be told as the outcome.
        let family = self.rows.iter().any(|row| {
            let of_lambda = generators.against(row);
            free.iter().any(|direction| dot(&of_lambda, direction).abs() > TOLERANCE)
        });
        let open = family || (widest.is_none() && !free.is_empty());
        let inside = widest.as_ref().is_some_and(|(_, least)| *least > TOLERANCE * size);
        // What the modes hold at zero is at rest already: no impulse is needed, and its own inequalities are all zero.
        let resting = !open && !origin.is_empty() && origin.iter().all(|&entry| entry == 0.0);
        let border = resting && !inside;
        let mut y = vec![0.0; free.len()];
        if let Some((widest, _)) = widest
            && !border
        {
            y = widest;
        }
        let values: Vec<f64> = functions.iter().map(|slack| slack.at(&y)).collect();
        let decisive = (0..values.len()).filter(|&index| !border || strict(index));
        let least = decisive.min_by(|&i, &j| values[i].total_cmp(&values[j]));
        let margin = least.map(|least| values[least]);
        let vanishes = |(index, value): (usize, &f64)| strict(index) && value.abs() <= TOLERANCE * size;
        let sign = match margin.map_or(Sign::Positive, |margin| Sign::within(margin, TOLERANCE * size)) {
            Sign::Undecided if margin >= Some(-ROUNDING * size) && values.iter().enumerate().any(vanishes) => {
                Sign::Zero
            }
            Sign::Positive if open => Sign::Undecided,
            sign => sign,
        };
        // Generators are independent, so that a free direction always changes the impulses.
        let mut impulse_unique = free.is_empty();
        if border {
            let pressing: Vec<Affine> =
                (0..values.len()).filter(|&index| !strict(index)).map(|index| functions[index].clone()).collect();
            impulse_unique |= !opens(&pressing, free.len());
        } else if sign == Sign::Positive && resting {
            y = vec![0.0; free.len()];
        } else if sign == Sign::Positive && !impulse_unique {
            let directions: Vec<Vec<f64>> = free.iter().map(|lambda| generators.raw_impulse(lambda, scale)).collect();
            y = least_impulse(&generators.raw_impulse(&origin, scale), &directions, &functions, &y);
        }
        let margin = if border && sign == Sign::Positive { Some(0.0) } else { margin };
        let mut lambda = origin;
        for (direction, factor) in free.iter().zip(&y) {
            for (entry, part) in lambda.iter_mut().zip(direction) {
                *entry += factor * part;
            }
        }
        let impulse = generators.raw_impulse(&lambda, scale).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        let mut velocity: Vec<f64> = (0..self.rows.len())
            .map(|row| {
                let scaled = self.free[row] + dot(&generators.against(&self.rows[row]), &lambda);
                scaled * scale.mobility[row] * scale.speed
            })
            .collect();
        for row in zero_rows(modes) {
            velocity[row] = 0.0;
        }
        let velocity_after = velocity
            .chunks_exact(2)
            .enumerate()
            .map(|(contact, pair)| [pair[0], pair[1] - problem.bounce(contact)])
            .collect();
        Judged {
            sign,
            because: least.map_or(Because::NoSolution, |least| slacks[least].1.violation(slacks[least].0)),
            // A margin at the cap is that of impulses without bound.
            margin: margin.filter(|margin| *margin < UNBOUNDED * (1.0 - TOLERANCE)),
            motion: Some(Motion { impulse, velocity_after }),
            impulse_unique,
            border,
        }
    }

    /// Sign of det B, where B is the Schur complement on the sliding contacts (normal row x slide direction) after the
    /// sticking rows are eliminated by rank; none where B is singular.
    pub fn index(&self, problem: &ContactProblem, scale: &Scale, modes: &[Mode]) -> Option<i8> {
        let holds = |contact: usize| modes[contact] == Mode::Stick && !problem.friction()[contact].is_zero();
        let contacts = 0..modes.len();
        let stuck: Vec<&[f64]> = contacts
            .clone()
            .filter(|&contact| holds(contact))
            .flat_map(|contact| [self.rows[2 * contact].as_slice(), self.rows[2 * contact + 1].as_slice()])
            .collect();
        let mut basis = Basis::new(self.columns);
        basis.extend(&stuck);
        let sliding: Vec<usize> =
            contacts.filter(|&contact| modes[contact] != Mode::Separate && !holds(contact)).collect();
        let rests: Vec<Vec<f64>> = sliding.iter().map(|&contact| basis.rest(&self.rows[2 * contact + 1])).collect();
        let rays: Vec<Vec<f64>> = sliding
            .iter()
            .map(|&contact| {
                let ray = slide_ray(problem, scale, contact, modes[contact]);
                let [t, n] = [&self.rows[2 * contact], &self.rows[2 * contact + 1]];
                t.iter().zip(n).map(|(t, n)| ray[0] * t + ray[1] * n).collect()
            })
            .collect();
        let mut schur: Vec<Vec<f64>> = rests.iter().map(|row| rays.iter().map(|ray| dot(row, ray)).collect()).collect();
        let mut sign = 1;
        while !schur.is_empty() {
            let last = schur.len() - 1;
            let places = (0..=last).flat_map(|i| (0..=last).map(move |j| (i, j)));
            let (i, j) = places.max_by(|&(i, j), &(k, l)| schur[i][j].abs().total_cmp(&schur[k][l].abs()))?;
            let pivot = schur[i][j];
            if pivot.abs() <= TOLERANCE {
                return None;
            }
            // Moving the pivot to the last row and column by swaps changes the sign once for each real swap.
            for swapped in [i, j] {
                sign = if swapped == last { sign } else { -sign };
            }
            schur.swap(i, last);
            schur.iter_mut().for_each(|row| row.swap(j, last));
            sign = if pivot < 0.0 { -sign } else { sign };
            let pivot_row = schur.pop()?;
            for row in &mut schur {
                let factor = row[last] / pivot;
                row.truncate(last);
                for (entry, above) in row.iter_mut().zip(&pivot_row) {
                    *entry -= factor * above;
                }
            }
        }
        Some(sign)
    }
}

/// A coefficient of rows and directions of length one, unless it is no more than their rounding: a program would follow
/// such a slope to any distance.
fn without_noise(coefficient: f64) -> f64 {
    if coefficient.abs() <= ROUNDING { 0.0 } else { coefficient }
}

/// The velocity rows that a combination sets to zero.
fn zero_rows(modes: &[Mode]) -> Vec<usize> {
    let of = |(contact, &mode): (usize, &Mode)| {
        let tangential = (mode == Mode::Stick).then_some(2 * contact);
        let normal = (mode != Mode::Separate).then_some(2 * contact + 1);
        tangential.into_iter().chain(normal)
    };
    modes.iter().enumerate().flat_map(of).collect()
}

/// Z with G = Z Z^T to rounding, rows scaled to length one: elimination with diagonal pivoting.
fn factorized(problem: &ContactProblem, scale: &Scale) -> Vec<Vec<f64>> {
    let count = 2 * problem.contacts();
    let mut rest: Vec<Vec<f64>> = (0..count)
        .map(|i| (0..count).map(|j| problem.delassus(i, j) / (scale.mobility[i] * scale.mobility[j])).collect())
        .collect();
    let mut rows = vec![Vec::new(); count];
    for _ in 0..count {
        let Some(pivot) = (0..count).max_by(|&i, &j| rest[i][i].total_cmp(&rest[j][j])) else { break };
        let diagonal = rest[pivot][pivot];
        if diagonal <= 8.0 * count as f64 * f64::EPSILON {
            break;
        }
        let column: Vec<f64> = rest.iter().map(|row| row[pivot] / diagonal.sqrt()).collect();
        for (i, line) in rest.iter_mut().enumerate() {
            rows[i].push(column[i]);
            for (entry, other) in line.iter_mut().zip(&column) {
                *entry -= column[i] * other;
            }
            // What is left of the pivot is zero by construction, and its rounding must not count as rank again.
            line[pivot] = 0.0;
        }
        rest[pivot].fill(0.0);
    }
    rows
}
