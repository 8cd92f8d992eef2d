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
//! If even the velocity depends on y it is a family: a convex set of velocities, given by its dimension and its
//! corners. A family's closure holds velocities of other modes, so that a corner may be another combination's outcome.
//! It is bounded: L.c+ <= sum of L_n e |c_n-|, so that L.G L = L.(c+ - c_free) grows no faster than L does. No
//! tolerance decides: see [`super::linear`].

use super::corners::corners;
use super::digits::{Numbers, is_known, is_known_range};
use super::generators::Generators;
use super::index::index;
use super::linear::{LinearFunction, Solutions, Unsettled, extended, maximize, settled, solve, vanishing, widest};
use super::needed::friction_needed;
use super::outcome::{Motion, Range, Rejection, RejectionReason};
use super::problem::ContactProblem;
use super::program::least_impulse;
use super::slack::Scale;
use crate::law::{Condition, Inequality, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, dot};
use std::cmp::Ordering;

/// Slacks are not followed beyond this: the impulses are then unbounded.
const UNBOUNDED: f64 = 1e3;

/// The solutions of a combination whose equations are singular.
#[derive(Debug, Clone)]
pub enum SingularCase<F = ()> {
    Rejected(Rejection),
    /// Its velocity is the only one of these modes.
    Valid(SingularOutcome),
    /// Its velocities form a set.
    Family(F),
}

/// The velocities of a family, `[c_t, xi_n]` by rows \[m/s\].
pub struct FamilyVelocities<T> {
    pub dimension: usize,
    /// Those of each corner of the closure.
    pub corners: Vec<Vec<T>>,
}

/// One velocity and the impulses that lead to it.
#[derive(Debug, Clone)]
pub struct SingularOutcome {
    /// The strict modes of the velocity.
    pub modes: Vec<Mode>,
    /// Those of the velocity and the least impulse.
    pub numbers: Numbers,
    /// The smallest slack; `None` if there is none.
    pub margin: Option<f64>,
    /// Least and greatest of every impulse's entry; `None` if the impulse is the only one.
    pub range: Option<Vec<[Range; 2]>>,
    /// The impulse inequalities that are zero for every admissible impulse, by contact.
    pub at_zero: Vec<(usize, Inequality)>,
    /// Sign of det B; `None` on a border.
    pub index: Option<i8>,
}

/// An inequality on the solutions, in the scale of margins.
struct Constraint<T> {
    contact: usize,
    inequality: Inequality,
    function: LinearFunction<T>,
}

/// A combination of a problem.
pub struct Equations<'a, T> {
    problem: &'a ContactProblem<T>,
    scale: &'a Scale,
    modes: &'a [Mode],
    generators: Generators,
}

/// The velocity rows that a combination sets to zero.
fn zero_rows(modes: &[Mode], laws: &[Law]) -> impl Iterator<Item = usize> {
    let rows = modes.iter().zip(laws).flat_map(|(&mode, law)| law.velocity(mode)).enumerate();
    rows.filter_map(|(row, sign)| (sign == Some(Ordering::Equal)).then_some(row))
}

impl<'a, T: Ordered> Equations<'a, T> {
    pub fn of(problem: &'a ContactProblem<T>, scale: &'a Scale, modes: &'a [Mode]) -> Self {
        Self { problem, scale, modes, generators: Generators::of(modes, problem.laws()) }
    }

    pub fn solve(&self) -> Result<SingularCase, Unsettled> {
        Ok(match self.velocities()? {
            SingularCase::Rejected(rejection) => SingularCase::Rejected(rejection),
            SingularCase::Valid(outcome) => SingularCase::Valid(outcome),
            SingularCase::Family(_) => SingularCase::Family(()),
        })
    }

    /// As [`Equations::solve`]; the solutions of a family are those that the inequalities leave, with one in the
    /// interior of its set as their origin.
    fn velocities(&self) -> Result<SingularCase<Solutions<T>>, Unsettled> {
        let Self { problem, modes, generators, .. } = self;
        let equation = |row: usize| extended(&generators.velocity_row(problem, row), -problem.free_row(row));
        let Some(solutions) = solve(generators.count(), zero_rows(modes, problem.laws()).map(equation).collect())?
        else {
            return Ok(SingularCase::Rejected(Rejection::of(modes, RejectionReason::NoSolution)));
        };
        let inequalities = self.inequalities(&solutions);
        for Constraint { function, .. } in inequalities.iter().filter(|own| own.inequality.is_strict()) {
            if function.is_constant()? && settled(function.constant)?.is_eq() {
                return Ok(SingularCase::Rejected(Rejection::of(modes, RejectionReason::RedundantTwin)));
            }
        }
        let functions: Vec<LinearFunction<T>> = inequalities.iter().map(|own| own.function.clone()).collect();
        let (inside, least) = widest(&functions, solutions.directions.len(), T::from_f64(UNBOUNDED))?;
        let standing = settled(least)?;
        if standing.is_lt() {
            return Ok(SingularCase::Rejected(self.rejected(&solutions, &inequalities, &inside)));
        }
        if self.is_one_velocity(&solutions)? {
            return Ok(SingularCase::Valid(self.outcome(&solutions, &inside, least)?));
        }
        let mut space = Solutions { origin: solutions.at(&inside), ..solutions };
        if standing.is_eq() {
            let from_inside: Vec<LinearFunction<T>> = functions.iter().map(|each| each.seen_from(&inside)).collect();
            let (equalities, inner) = vanishing(&from_inside)?;
            // A velocity that is zero throughout belongs to other modes.
            if equalities.iter().any(|&place| inequalities[place].inequality.is_strict()) {
                return Ok(SingularCase::Rejected(Rejection::of(modes, RejectionReason::RedundantTwin)));
            }
            let origin = space.at(&inner);
            space = space.where_zero(equalities.iter().map(|&place| &from_inside[place]))?.ok_or(Unsettled)?;
            space.origin = origin;
            if self.is_one_velocity(&space)? {
                // What the equations leave free, the inequalities do not.
                let still = vec![T::zero(); space.directions.len()];
                return Ok(SingularCase::Valid(self.outcome(&space, &still, T::zero())?));
            }
        }
        Ok(SingularCase::Family(space))
    }

    /// The velocities of a combination that is a family; `None` if there are too many corners.
    pub fn family(&self) -> Result<Option<FamilyVelocities<T>>, Unsettled> {
        let SingularCase::Family(space) = self.velocities()? else { return Err(Unsettled) };
        let rows: Vec<LinearFunction<T>> = (0..2 * self.modes.len()).map(|row| self.velocity(&space, row)).collect();
        // Some rows are coordinates of the family, the others depend on them.
        let mut coordinates: Vec<LinearFunction<T>> = Vec::new();
        let mut factors: Vec<Vec<T>> = Vec::new();
        for row in &rows {
            let equation = |at: usize| {
                coordinates.iter().map(|own| own.coefficients[at]).chain([row.coefficients[at]]).collect::<Vec<T>>()
            };
            let equations = (0..space.directions.len()).map(equation).collect();
            if let Some(dependent) = solve(coordinates.len(), equations)? {
                factors.push(dependent.origin);
            } else {
                let own = std::iter::repeat_n(T::zero(), coordinates.len()).chain([T::one()]).collect();
                factors.push(own);
                coordinates.push(row.clone());
            }
        }
        let functions: Vec<LinearFunction<T>> =
            self.inequalities(&space).into_iter().map(|each| each.function).collect();
        let Some(corners) = corners(&functions, &coordinates)? else { return Ok(None) };
        let velocity = |corner: Vec<T>| -> Result<Vec<T>, Unsettled> {
            let from: Vec<T> = corner.iter().zip(&coordinates).map(|(&at, own)| at - own.constant).collect();
            let entry = |(row, factors): (&LinearFunction<T>, &Vec<T>)| {
                let entry = row.constant + dot(factors, &from);
                Ok(if settled(entry)?.is_eq() { T::zero() } else { entry })
            };
            rows.iter().zip(&factors).map(entry).collect()
        };
        let corners = corners.into_iter().map(velocity).collect::<Result<_, _>>()?;
        Ok(Some(FamilyVelocities { dimension: coordinates.len(), corners }))
    }

    /// The outcome with this velocity, which is one of the combination's, `[c_t, xi_n]` by rows.
    pub fn outcome_at(&self, velocity: &[T]) -> Result<SingularOutcome, Unsettled> {
        let Self { problem, generators, .. } = self;
        let equation =
            |row: usize| extended(&generators.velocity_row(problem, row), velocity[row] - problem.free_row(row));
        let space = solve(generators.count(), (0..velocity.len()).map(equation).collect())?.ok_or(Unsettled)?;
        let pressing = self.inequalities(&space).into_iter().filter(|own| !own.inequality.is_strict());
        let functions: Vec<LinearFunction<T>> = pressing.map(|own| own.function).collect();
        let (inside, least) = widest(&functions, space.directions.len(), T::from_f64(UNBOUNDED))?;
        let outcome = self.outcome(&space, &inside, least)?;
        Ok(SingularOutcome { index: None, margin: None, ..outcome })
    }

    fn is_one_velocity(&self, solutions: &Solutions<T>) -> Result<bool, Unsettled> {
        for row in 0..2 * self.modes.len() {
            if !self.velocity(solutions, row).is_constant()? {
                return Ok(false);
            }
        }
        Ok(true)
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

    fn rejected(&self, solutions: &Solutions<T>, inequalities: &[Constraint<T>], y: &[T]) -> Rejection {
        let values = inequalities.iter().map(|inequality| (inequality, inequality.function.at(y).to_f64()));
        // The linear program makes several equally bad; of one contact's the cone is named.
        let order = |own: &Constraint<T>| (own.contact, own.inequality != Inequality::FrictionCone);
        let worst = values.min_by(|a, b| a.1.total_cmp(&b.1).then_with(|| order(a.0).cmp(&order(b.0))));
        let because = worst.map_or(RejectionReason::NoSolution, |(worst, _)| RejectionReason::Violated {
            contact: worst.contact,
            inequality: worst.inequality,
        });
        let at = Solutions { origin: solutions.at(y), directions: Vec::new() };
        Rejection {
            margin: worst.map(|(_, value)| value),
            motion: Some(self.motion(&at)),
            ..Rejection::of(self.modes, because)
        }
    }

    /// Whether the only velocity of `space` is that without impulses.
    fn is_free(&self, space: &Solutions<T>) -> Result<bool, Unsettled> {
        for row in 0..2 * self.modes.len() {
            if settled(self.velocity(space, row).constant - self.problem.free_row(row))?.is_ne() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The only velocity of `space`, with its impulses; at `inside` the smallest inequality is `least`, not negative.
    fn outcome(&self, space: &Solutions<T>, inside: &[T], least: T) -> Result<SingularOutcome, Unsettled> {
        let inequalities = self.inequalities(space);
        let dimension = space.directions.len();
        // Velocities are settled; only impulses still depend on y.
        let pressing: Vec<&Constraint<T>> = inequalities.iter().filter(|own| !own.inequality.is_strict()).collect();
        let shifted: Vec<LinearFunction<T>> = pressing.iter().map(|own| own.function.seen_from(inside)).collect();
        let mut at_zero: Vec<(usize, Inequality)> = Vec::new();
        if settled(least)?.is_eq() {
            for place in vanishing(&shifted)?.0 {
                let entry = (pressing[place].contact, pressing[place].inequality);
                if !at_zero.contains(&entry) {
                    at_zero.push(entry);
                }
            }
        }
        let at = space.at(inside);
        let mut ranges = Vec::new();
        let mut unique = true;
        if dimension > 0 {
            for row in 0..2 * self.modes.len() {
                let entry = space.affine(T::zero(), &self.generators.impulse_row::<T>(row));
                let here = entry.at(inside);
                let mut bound = |sign: T| -> Result<Option<T>, Unsettled> {
                    let toward: Vec<T> = entry.coefficients.iter().map(|&each| sign * each).collect();
                    let Some(best) = maximize(&shifted, &toward)? else {
                        unique = false;
                        return Ok(None);
                    };
                    let change = entry.change(&best);
                    unique &= settled(change)?.is_eq();
                    Ok(Some(here + change))
                };
                ranges.push([bound(-T::one())?, bound(T::one())?]);
            }
        }
        let lambda = if unique {
            at
        } else if self.is_free(space)? {
            vec![T::zero(); at.len()]
        } else {
            let directions: Vec<Vec<T>> =
                space.directions.iter().map(|direction| self.generators.impulse(direction)).collect();
            let start = Solutions { origin: at, directions: space.directions.clone() };
            start.at(&least_impulse(&self.generators.impulse(&start.origin), &directions, &shifted)?)
        };
        // A margin at the cap is that of impulses without bound.
        let bounded = settled(least - T::from_f64(UNBOUNDED))?.is_lt();
        let margin = (!inequalities.is_empty() && bounded).then_some(least);
        let [impulse, velocity] = self.solution(space, &lambda);
        let mut numbers = Numbers::of((self.problem, self.scale), self.modes, &impulse, &velocity);
        numbers.are_sharp &= margin.is_none_or(|margin| is_known(margin, 1.0));
        if !unique {
            let entry = |row: usize| {
                let entry = space.affine(T::zero(), &self.generators.impulse_row::<T>(row));
                LinearFunction { constant: entry.at(inside), ..entry }
            };
            let impulses: Vec<Pair<LinearFunction<T>>> =
                (0..self.modes.len()).map(|contact| [entry(2 * contact), entry(2 * contact + 1)]).collect();
            numbers.take_friction(
                &friction_needed(self.modes, self.problem.laws(), &impulses, &shifted)?,
                self.problem.laws(),
            );
        }
        let range = |(&ends, &own): (&[Option<T>; 2], &T)| {
            numbers.are_sharp &= is_known_range(ends, own);
            ends.map(|end| end.map(T::to_f64))
        };
        let ranges: Vec<Range> = ranges.iter().zip(impulse.as_flattened()).map(range).collect();
        Ok(SingularOutcome {
            numbers,
            margin: margin.map(T::to_f64),
            range: (!unique).then(|| ranges.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()),
            index: if at_zero.is_empty() { index(self.problem, self.modes)? } else { None },
            at_zero,
            modes: self.modes.to_vec(),
        })
    }

    /// The velocity and the impulse of the origin of `space`.
    fn motion(&self, space: &Solutions<T>) -> Motion {
        let [impulse, velocity] = self.solution(space, &space.origin);
        Motion::nearest(self.problem, self.modes, &impulse, &velocity)
    }

    /// The impulse that `lambda` gives, and the velocity of `space` at its origin, `[c_t, xi_n]` per contact.
    fn solution(&self, space: &Solutions<T>, lambda: &[T]) -> [Vec<Pair<T>>; 2] {
        let mut velocity: Vec<T> = (0..2 * self.modes.len()).map(|row| self.velocity(space, row).constant).collect();
        for row in zero_rows(self.modes, self.problem.laws()) {
            velocity[row] = T::zero();
        }
        let pairs = |rows: Vec<T>| rows.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        [pairs(self.generators.impulse(lambda)), pairs(velocity)]
    }
}

/// The strict modes of a velocity, `[c_t, xi_n]` by rows.
pub fn modes_of<T: Ordered>(velocity: &[T], laws: &[Law]) -> Result<Vec<Mode>, Unsettled> {
    let mode = |(pair, law): (&[T], &Law)| match settled(pair[1])? {
        Ordering::Greater => Ok(Mode::Separate),
        Ordering::Equal => Ok(law.closed(settled(pair[0])?)),
        Ordering::Less => Err(Unsettled),
    };
    velocity.chunks_exact(2).zip(laws).map(mode).collect()
}
