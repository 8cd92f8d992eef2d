//! Combinations whose equations are singular: contacts that depend on each other, vanishing pivots.
//!
//! ```text
//!     L = B lambda      c = c_free + G B lambda      rows that the modes hold at zero: linear equations for lambda
//! ```
//!
//! The equations leave lambda = origin + free y. Where they determine the velocity but not the impulses, the impulses
//! form a convex set; the combination is an outcome exactly when that set is not empty, which a linear program answers,
//! and the impulse listed is its member of least norm. A velocity that the modes exclude only by depending on others (a
//! flat foot whose heel sticks cannot slide at the toe) belongs to the list of modes that says so: its redundant twin.
//! If even the velocity depends on y it is a family, given by its ends. No tolerance decides: see [`super::linear`].

use super::generators::Generators;
use super::index::index;
use super::linear::{LinearFunction, Solutions, Unsettled, extended, maximize, settled, solve, widest};
use super::outcome::{Motion, Range, Rejection, RejectionReason};
use super::problem::ContactProblem;
use super::program::least_impulse;
use super::slack::Scale;
use crate::law::{Condition, Inequality, Mode};
use crate::scalar::Ordered;
use std::cmp::Ordering;

/// Slacks are not followed beyond this: the impulses are then unbounded.
const UNBOUNDED: f64 = 1e3;

/// The solutions of a combination whose equations are singular.
#[derive(Debug, Clone)]
pub enum SingularCase {
    Rejected(Rejection),
    /// Its velocity is the only one of these modes.
    Valid(SingularOutcome),
    /// Its velocities form a set: the two ends. An end's own modes may be others, if it lies on the set's rim.
    Family([SingularOutcome; 2]),
}

/// One velocity and the impulses that lead to it.
#[derive(Debug, Clone)]
pub struct SingularOutcome {
    /// The strict modes of the velocity.
    pub modes: Vec<Mode>,
    /// The velocity and the least impulse.
    pub motion: Motion,
    /// The smallest slack; `None` if there is none.
    pub margin: Option<f64>,
    /// Least and greatest of every impulse's entry; `None` if the impulse is the only one.
    pub range: Option<Vec<[Range; 2]>>,
    /// The impulse inequalities that are zero for every admissible impulse, by contact.
    pub at_zero: Vec<(usize, Inequality)>,
    /// Sign of det B; `None` on a border.
    pub index: Option<i8>,
    /// How far velocity and impulse may be off, in the scale of margins.
    pub error: f64,
}

/// An inequality on the solutions, in the scale of margins.
struct Constraint<T> {
    contact: usize,
    inequality: Inequality,
    function: LinearFunction<T>,
}

/// Solves one combination; `rounded` is the same problem in f64.
pub fn solve_singular<T: Ordered>(
    problem: &ContactProblem<T>,
    rounded: &ContactProblem,
    scale: &Scale,
    modes: &[Mode],
) -> Result<SingularCase, Unsettled> {
    let generators = Generators::of(modes, problem.laws());
    let equations =
        zero_rows(modes).map(|row| extended(&generators.velocity_row(problem, row), -problem.free_row(row))).collect();
    let Some(solutions) = solve(generators.count(), equations)? else {
        return Ok(SingularCase::Rejected(Rejection::of(modes, RejectionReason::NoSolution)));
    };
    Equations { problem, rounded, scale, modes, generators }.weigh(&solutions)
}

/// The velocity rows that a combination sets to zero.
fn zero_rows(modes: &[Mode]) -> impl Iterator<Item = usize> {
    let rows = modes.iter().flat_map(|mode| mode.velocity()).enumerate();
    rows.filter_map(|(row, sign)| (sign == Some(Ordering::Equal)).then_some(row))
}

struct Equations<'a, T> {
    problem: &'a ContactProblem<T>,
    rounded: &'a ContactProblem,
    scale: &'a Scale,
    modes: &'a [Mode],
    generators: Generators,
}

impl<T: Ordered> Equations<'_, T> {
    fn weigh(&self, solutions: &Solutions<T>) -> Result<SingularCase, Unsettled> {
        let inequalities = self.inequalities(solutions);
        let velocities: Vec<LinearFunction<T>> =
            (0..2 * self.modes.len()).map(|row| self.velocity(solutions, row)).collect();
        for Constraint { function, .. } in inequalities.iter().filter(|own| own.inequality.is_strict()) {
            if function.is_constant()? && settled(function.constant)?.is_eq() {
                return Ok(SingularCase::Rejected(Rejection::of(self.modes, RejectionReason::RedundantTwin)));
            }
        }
        let dimension = solutions.directions.len();
        let functions: Vec<LinearFunction<T>> = inequalities.iter().map(|own| own.function.clone()).collect();
        let (inside, least) = widest(&functions, dimension, T::from_f64(UNBOUNDED))?;
        let standing = settled(least)?;
        if standing.is_lt() {
            return Ok(self.rejected(solutions, &inequalities, &inside));
        }
        let mut family = false;
        for velocity in &velocities {
            family |= !velocity.is_constant()?;
        }
        if !family {
            return Ok(SingularCase::Valid(self.outcome(solutions, self.modes.to_vec(), &inside, least)?));
        }
        // The rim of a family belongs to other modes; some velocity of its own must be left.
        if standing.is_eq() && !self.has_own_velocity(&inequalities, &inside)? {
            return Ok(SingularCase::Rejected(Rejection::of(self.modes, RejectionReason::RedundantTwin)));
        }
        let greatest = self.end(solutions, &inside, T::one())?;
        let least = self.end(solutions, &inside, -T::one())?;
        if self.has_velocity(&greatest, |row| self.velocity(&least, row).constant)? {
            // What the equations leave free, the inequalities do not.
            return Ok(SingularCase::Valid(SingularOutcome { margin: Some(0.0), ..self.end_outcome(&greatest)? }));
        }
        Ok(SingularCase::Family([self.end_outcome(&greatest)?, self.end_outcome(&least)?]))
    }

    fn velocity(&self, solutions: &Solutions<T>, row: usize) -> LinearFunction<T> {
        solutions.affine(self.problem.free_row(row), &self.generators.velocity_row(self.problem, row))
    }

    fn inequalities(&self, solutions: &Solutions<T>) -> Vec<Constraint<T>> {
        let problem = self.problem;
        let by_speed = T::one() / T::from_f64(self.scale.speed);
        let mut all = Vec::new();
        for (contact, (&mode, law)) in self.modes.iter().zip(problem.laws()).enumerate() {
            law.conditions(mode, |condition: Condition| {
                let rows: [(T, Vec<T>); 2] = [0, 1].map(|which| match condition.inequality.is_strict() {
                    true => {
                        let row = 2 * contact + which;
                        (problem.free_row(row), self.generators.velocity_row(problem, row))
                    }
                    false => (T::zero(), self.generators.number_row(contact, which)),
                });
                let factor = T::from_f64(self.scale.factor(contact, &condition)) * by_speed;
                let scaled = |number: &dyn Fn(usize) -> T| factor * condition.function.at(number, T::from_f64);
                let coefficients: Vec<T> =
                    (0..self.generators.count()).map(|at| scaled(&|which| rows[which].1[at])).collect();
                let function = solutions.affine(scaled(&|which| rows[which].0), &coefficients);
                all.push(Constraint { contact, inequality: condition.inequality, function });
            });
        }
        all
    }

    fn rejected(&self, solutions: &Solutions<T>, inequalities: &[Constraint<T>], y: &[T]) -> SingularCase {
        let values = inequalities.iter().map(|inequality| (inequality, inequality.function.at(y).to_f64()));
        // The linear program makes several equally bad; of one contact's the cone is named.
        let order = |own: &Constraint<T>| (own.contact, own.inequality != Inequality::FrictionCone);
        let worst = values.min_by(|a, b| a.1.total_cmp(&b.1).then_with(|| order(a.0).cmp(&order(b.0))));
        let because = worst.map_or(RejectionReason::NoSolution, |(worst, _)| RejectionReason::Violated {
            contact: worst.contact,
            inequality: worst.inequality,
        });
        SingularCase::Rejected(Rejection {
            margin: worst.map(|(_, value)| value),
            motion: Some(self.motion(solutions, y, self.modes)),
            ..Rejection::of(self.modes, because)
        })
    }

    /// Whether some point without a negative inequality has every strict one above zero.
    fn has_own_velocity(&self, inequalities: &[Constraint<T>], inside: &[T]) -> Result<bool, Unsettled> {
        // Unknowns y and s, s at most every strict inequality and at most 1: can it be positive?
        let shifted = |own: &Constraint<T>| {
            let strictly = if own.inequality.is_strict() { -T::one() } else { T::zero() };
            own.function.extended(own.function.at(inside), strictly)
        };
        let still = vec![T::zero(); inside.len()];
        let top = LinearFunction { constant: T::one(), coefficients: extended(&still, -T::one()) };
        let rows: Vec<LinearFunction<T>> = inequalities.iter().map(shifted).chain([top]).collect();
        let best = maximize(&rows, &extended(&still, T::one()))?.ok_or(Unsettled)?;
        best.last().map_or(Ok(false), |&rise| Ok(settled(rise)?.is_gt()))
    }

    /// Whether the only velocity of `space` has these entries.
    fn has_velocity(&self, space: &Solutions<T>, entry: impl Fn(usize) -> T) -> Result<bool, Unsettled> {
        for row in 0..2 * self.modes.len() {
            if settled(self.velocity(space, row).constant - entry(row))?.is_ne() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The end of a family at which its velocities, in the order of the rows, are greatest (`sign` 1) or least (-1):
    /// its impulses, one of which no inequality forbids as the origin.
    fn end(&self, solutions: &Solutions<T>, inside: &[T], sign: T) -> Result<Solutions<T>, Unsettled> {
        let mut space = solutions.clone();
        space.origin = solutions.at(inside);
        for row in 0..2 * self.modes.len() {
            let velocity = self.velocity(&space, row);
            if velocity.is_constant()? {
                continue;
            }
            let functions: Vec<LinearFunction<T>> =
                self.inequalities(&space).into_iter().map(|each| each.function).collect();
            let toward: Vec<T> = velocity.coefficients.iter().map(|&entry| sign * entry).collect();
            // Energy bounds every velocity.
            let best = maximize(&functions, &toward)?.ok_or(Unsettled)?;
            let point = space.at(&best);
            let rest = LinearFunction { constant: velocity.constant - velocity.at(&best), ..velocity };
            space = space.where_zero(&rest)?.ok_or(Unsettled)?;
            space.origin = point;
        }
        Ok(space)
    }

    fn end_outcome(&self, space: &Solutions<T>) -> Result<SingularOutcome, Unsettled> {
        let modes = self.modes_of(space)?;
        let y = vec![T::zero(); space.directions.len()];
        let mut outcome = self.outcome(space, modes, &y, T::zero())?;
        (outcome.index, outcome.margin) = (None, None);
        Ok(outcome)
    }

    /// The strict modes of the only velocity of `space`.
    fn modes_of(&self, space: &Solutions<T>) -> Result<Vec<Mode>, Unsettled> {
        let mut modes = self.modes.to_vec();
        for (contact, mode) in modes.iter_mut().enumerate() {
            let closed = *mode != Mode::Separate || settled(self.velocity(space, 2 * contact + 1).constant)?.is_eq();
            if closed && *mode != Mode::Stick {
                *mode = Mode::closed(settled(self.velocity(space, 2 * contact).constant)?);
            }
        }
        Ok(modes)
    }

    /// The only velocity of `space`, with its impulses; at `inside` the smallest inequality is `least`, not negative.
    fn outcome(
        &self,
        space: &Solutions<T>,
        modes: Vec<Mode>,
        inside: &[T],
        least: T,
    ) -> Result<SingularOutcome, Unsettled> {
        let inequalities = self.inequalities(space);
        let dimension = space.directions.len();
        // Velocities are settled; only impulses still depend on y.
        let pressing: Vec<&Constraint<T>> = inequalities.iter().filter(|own| !own.inequality.is_strict()).collect();
        let shifted: Vec<LinearFunction<T>> = pressing
            .iter()
            .map(|each| LinearFunction {
                constant: each.function.at(inside),
                coefficients: each.function.coefficients.clone(),
            })
            .collect();
        let mut at_zero: Vec<(usize, Inequality)> = Vec::new();
        if settled(least)?.is_eq() {
            for (own, function) in pressing.iter().zip(&shifted) {
                let vanishes = settled(function.constant)?.is_eq()
                    && match maximize(&shifted, &function.coefficients)? {
                        Some(best) => settled(function.at(&best))?.is_eq(),
                        None => false,
                    };
                let entry = (own.contact, own.inequality);
                if vanishes && !at_zero.contains(&entry) {
                    at_zero.push(entry);
                }
            }
        }
        let at = space.at(inside);
        let mut ranges = Vec::new();
        let mut unique = true;
        if dimension > 0 {
            for row in 0..2 * modes.len() {
                let entry = space.affine(T::zero(), &self.generators.impulse_row::<T>(row));
                let here = entry.at(inside);
                let mut bound = |sign: T| -> Result<Option<f64>, Unsettled> {
                    let toward: Vec<T> = entry.coefficients.iter().map(|&each| sign * each).collect();
                    let Some(best) = maximize(&shifted, &toward)? else {
                        unique = false;
                        return Ok(None);
                    };
                    let change = entry.change(&best);
                    unique &= settled(change)?.is_eq();
                    Ok(Some((here + change).to_f64()))
                };
                let least = bound(-T::one())?;
                ranges.push([least, bound(T::one())?]);
            }
        }
        let lambda = if unique {
            at
        } else if self.has_velocity(space, |row| self.problem.free_row(row))? {
            vec![T::zero(); at.len()]
        } else {
            let directions: Vec<Vec<T>> =
                space.directions.iter().map(|direction| self.generators.impulse(direction)).collect();
            let start = Solutions { origin: at, directions: space.directions.clone() };
            start.at(&least_impulse(&self.generators.impulse(&start.origin), &directions, &shifted)?)
        };
        // A margin at the cap is that of impulses without bound.
        let bounded = settled(least - T::from_f64(UNBOUNDED))?.is_lt();
        let margin = (!inequalities.is_empty() && bounded).then(|| least.to_f64());
        let (motion, error) = self.motion_of(space, &lambda, &modes);
        Ok(SingularOutcome {
            motion,
            error,
            margin,
            range: (!unique).then(|| ranges.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()),
            index: if at_zero.is_empty() { index(self.problem, &modes)? } else { None },
            at_zero,
            modes,
        })
    }

    fn motion(&self, solutions: &Solutions<T>, y: &[T], modes: &[Mode]) -> Motion {
        let at = Solutions { origin: solutions.at(y), directions: Vec::new() };
        self.motion_of(&at, &at.origin, modes).0
    }

    /// The velocity of `space` at its origin, with the impulse that `lambda` gives, and how far they may be off.
    fn motion_of(&self, space: &Solutions<T>, lambda: &[T], modes: &[Mode]) -> (Motion, f64) {
        let rows: Vec<T> = (0..2 * modes.len()).map(|row| self.velocity(space, row).constant).collect();
        let impulse = self.generators.impulse(lambda);
        let error = self.scale.error(rows.iter().copied(), impulse.iter().copied());
        let mut velocity: Vec<f64> = rows.iter().map(|row| row.to_f64()).collect();
        for row in zero_rows(modes) {
            velocity[row] = 0.0;
        }
        let bounced = velocity.chunks_exact(2).enumerate();
        let motion = Motion {
            impulse: impulse.chunks_exact(2).map(|pair| [pair[0].to_f64(), pair[1].to_f64()]).collect(),
            velocity_after: bounced.map(|(i, pair)| [pair[0], pair[1] - self.rounded.bounce(i)]).collect(),
        };
        (motion, error)
    }
}
