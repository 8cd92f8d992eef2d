//! Solves combinations whose equations are singular, because contacts depend on each other or a pivot vanishes.
//!
//! ```text
//!     L = B lambda      c = c_free + G B lambda      rows that the modes hold at zero: linear equations for lambda
//! ```
//!
//! The solutions are lambda = origin + free y. There are three cases.
//!
//! * The equations determine the velocity but not the impulses. The admissible impulses form a convex set, and the
//!   combination is an outcome exactly if that set is not empty, which a linear program decides. The listed impulse is
//!   its member of least norm.
//! * The velocity belongs to other modes because contacts depend on each other: a flat foot whose heel sticks cannot
//!   slide at the toe. The combination is then the redundant twin of the one with those modes, and rejected.
//! * Even the velocity depends on y. The combination is a family: a convex set of velocities, given by its dimension
//!   and its corners. Its closure holds velocities of other modes, so that a corner may be another combination's
//!   outcome. It is bounded: L.c+ <= sum of L_n e |c_n-|, so that L.G L = L.(c+ - c_free) grows no faster than L does.
//!
//! No tolerance decides anything: see [`super::linear`]. Contacts that are known to share a tangential row have one
//! equation for it, and directions that shift tangential impulse from one to the other change no velocity.

use super::corners::corners;
use super::digits::{Numbers, Solution, is_known, is_known_range};
use super::generators::Generators;
use super::index::index;
use super::least_impulse::least_impulse;
use super::linear::{LinearFunction, Solutions, Unsettled, are_zero, extended, settled, solve};
use super::needed::friction_needed;
use super::outcome::{Range, Rejection, RejectionReason};
use super::problem::ContactProblem;
use super::simplex::{Program, vanishing, widest};
use super::slack::Scale;
use crate::law::{Impulse, Inequality, Law, Mode};
use crate::scalar::{Ordered, dot};
use std::cmp::Ordering;

/// The first cap of the least slack, free of units: it keeps the impulses small if they are unbounded.
const CAP: f64 = 1e3;

/// If the least slack reaches this, the impulses are unbounded.
const UNBOUNDED: f64 = 1e12;

/// Violated inequalities within this relative distance of the worst one count as equal when one of them is named.
const EQUALLY_BAD: f64 = 1e-9;

/// The result for a combination of modes.
#[derive(Debug)]
pub enum Solved<F = ()> {
    Rejected(Rejection),
    /// An outcome: only one velocity has these modes.
    Outcome(Solution),
    /// The equations are singular, and the velocities form a set. While it is computed, `F` is the solutions that the
    /// inequalities admit; their origin is an interior point.
    Family(F),
}

/// The dimension of a family, and the velocities at the corners of its closure, `[c_t, xi_n]` by rows \[m/s\].
pub type FamilyCorners<T> = (usize, Vec<Vec<T>>);

/// An inequality as a function on the solutions, scaled free of units.
struct Constraint<T> {
    contact: usize,
    inequality: Inequality,
    function: LinearFunction<T>,
}

/// The solutions of a combination's equations, with the velocities and inequalities as functions of y.
pub struct Space<T> {
    solutions: Solutions<T>,
    /// The velocities `[c_t, xi_n]` by rows \[m/s\].
    velocity: Vec<LinearFunction<T>>,
    inequalities: Vec<Constraint<T>>,
}

impl<T: Ordered> Space<T> {
    fn is_one_velocity(&self) -> Result<bool, Unsettled> {
        are_zero(self.velocity.iter().flat_map(|row| row.coefficients.iter().copied()))
    }

    fn functions(&self) -> Vec<LinearFunction<T>> {
        self.inequalities.iter().map(|constraint| constraint.function.clone()).collect()
    }
}

/// The equations of one combination of a problem.
pub struct Equations<'a, T> {
    problem: &'a ContactProblem<T>,
    scale: &'a Scale,
    modes: &'a [Mode],
    generators: Generators,
    shared: Vec<SharedImpulse>,
}

/// A sticking contact that shares its tangential row with another sticking contact: the places of both tangential
/// impulses in lambda (`first` is the other contact's), and the row.
#[derive(Clone, Copy)]
struct SharedImpulse {
    first: usize,
    other: usize,
    row: usize,
}

/// The velocity rows that a combination sets to zero.
fn zero_rows(modes: &[Mode], laws: &[Law]) -> impl Iterator<Item = usize> {
    let rows = modes.iter().zip(laws).flat_map(|(&mode, law)| law.velocity(mode)).enumerate();
    rows.filter_map(|(row, sign)| (sign == Some(Ordering::Equal)).then_some(row))
}

impl<'a, T: Ordered> Equations<'a, T> {
    pub fn of(problem: &'a ContactProblem<T>, scale: &'a Scale, modes: &'a [Mode]) -> Self {
        let generators = Generators::of(modes, problem.laws());
        let is_free = |&contact: &usize| problem.laws()[contact].impulse(modes[contact]) == Impulse::Free;
        let shared = (0..modes.len()).filter(is_free).filter_map(|contact| {
            let with = problem.shared_tangent(contact).filter(is_free)?;
            Some(SharedImpulse {
                first: generators.place(with, 0),
                other: generators.place(contact, 0),
                row: 2 * contact,
            })
        });
        Self { problem, scale, modes, shared: shared.collect(), generators }
    }

    /// Whether two sticking contacts are known to share a tangential row, so that their impulses are not determined.
    pub fn are_shared(&self) -> bool {
        !self.shared.is_empty()
    }

    pub fn solve(&self) -> Result<Solved<Space<T>>, Unsettled> {
        let rejection = |because| Rejection::of(self.modes, because);
        let Some(solutions) = self.solutions()? else {
            return Ok(Solved::Rejected(rejection(RejectionReason::NoSolution)));
        };
        let space = self.space(solutions, self.shared.len());
        // A velocity that is zero for all solutions belongs to other modes.
        let mut is_of_others = false;
        for constraint in space.inequalities.iter().filter(|constraint| constraint.inequality.is_strict()) {
            is_of_others |= constraint.function.is_constant()? && settled(constraint.function.constant)?.is_eq();
        }
        let functions = space.functions();
        // A velocity that is always zero keeps the least slack from exceeding zero.
        let cap = T::from_f64(if is_of_others { 0.0 } else { CAP });
        let found = widest(&functions, space.solutions.directions.len(), cap);
        let found = found.and_then(|(inside, least)| Ok((inside, least, settled(least)?)));
        let twin = rejection(RejectionReason::RedundantTwin);
        let (inside, least, standing) = match found {
            Ok((inside, .., Ordering::Less)) => return Ok(Solved::Rejected(self.rejected(&space, &inside))),
            Ok(_) if is_of_others => return Ok(Solved::Rejected(twin)),
            // The combination may also violate an inequality.
            Err(_) if is_of_others => return Ok(Solved::Rejected(twin.provisional())),
            found => found?,
        };
        if space.is_one_velocity()? {
            let is_at_cap = settled(least - cap)?.is_ge();
            let farther = |cap: f64| widest(&functions, space.solutions.directions.len(), T::from_f64(cap));
            let least = if is_at_cap { farther(UNBOUNDED)?.1 } else { least };
            return Ok(Solved::Outcome(self.outcome(&space, &inside, least)?));
        }
        let origin = space.solutions.at(&inside);
        if standing.is_gt() {
            return Ok(Solved::Family(self.space(Solutions { origin, ..space.solutions }, self.shared.len())));
        }
        let from_inside: Vec<LinearFunction<T>> = functions.iter().map(|each| each.seen_from(&inside)).collect();
        let (equalities, inner) = vanishing(&from_inside)?;
        if equalities.iter().any(|&place| space.inequalities[place].inequality.is_strict()) {
            return Ok(Solved::Rejected(twin));
        }
        let shifted = Solutions { origin, ..space.solutions };
        let origin = shifted.at(&inner);
        let left = shifted.where_zero(equalities.iter().map(|&place| &from_inside[place]))?.ok_or(Unsettled)?;
        let space = self.space(Solutions { origin, ..left }, 0);
        if space.is_one_velocity()? {
            // The inequalities determine the velocity, which the equations leave free.
            let still = vec![T::zero(); space.solutions.directions.len()];
            return Ok(Solved::Outcome(self.outcome(&space, &still, T::zero())?));
        }
        Ok(Solved::Family(space))
    }

    /// Solves the equations of the rows that the modes hold at zero; the directions of shared impulses come first.
    fn solutions(&self) -> Result<Option<Solutions<T>>, Unsettled> {
        let Self { problem, modes, generators, shared, .. } = self;
        let is_left_out = |place: usize| shared.iter().any(|impulse| impulse.other == place);
        let equation = |row: usize| {
            let entries = generators.velocity_row(problem, row).into_iter().enumerate();
            let kept = entries.filter(|&(place, _)| !is_left_out(place)).map(|(_, entry)| entry);
            kept.chain([-problem.free_row(row)]).collect()
        };
        let rows = zero_rows(modes, problem.laws()).filter(|row| shared.iter().all(|impulse| impulse.row != *row));
        let Some(Solutions { origin, directions }) =
            solve(generators.count() - shared.len(), rows.map(equation).collect())?
        else {
            return Ok(None);
        };
        let padded = |kept: Vec<T>| -> Vec<T> {
            let mut kept = kept.into_iter();
            let entry = |place| if is_left_out(place) { None } else { kept.next() };
            (0..generators.count()).map(entry).map(|entry| entry.unwrap_or(T::zero())).collect()
        };
        let mut origin = padded(origin);
        let mut all = Vec::new();
        for &SharedImpulse { first, other, .. } in shared {
            // Each contact takes half: a tangential impulse of zero would make its two cone slacks equal, and plain
            // balls cannot order equal numbers.
            let half = origin[first].scaled(0.5);
            (origin[first], origin[other]) = (origin[first] - half, half);
            let mut direction = vec![T::zero(); generators.count()];
            (direction[first], direction[other]) = (T::one(), -T::one());
            all.push(direction);
        }
        all.extend(directions.into_iter().map(padded));
        Ok(Some(Solutions { origin, directions: all }))
    }

    /// The corners of the combination's family; `None` if there are too many. Returns an error if the combination is
    /// not shown to be a family.
    pub fn family(&self) -> Result<Option<FamilyCorners<T>>, Unsettled> {
        let Solved::Family(Space { solutions, velocity: rows, inequalities }) = self.solve()? else {
            return Err(Unsettled);
        };
        // Independent velocity rows are coordinates of the family; the others are linear in them.
        let mut coordinates: Vec<LinearFunction<T>> = Vec::new();
        let mut factors: Vec<Vec<T>> = Vec::new();
        for row in &rows {
            let equation =
                |at: usize| coordinates.iter().chain([row]).map(|row| row.coefficients[at]).collect::<Vec<T>>();
            let equations = (0..solutions.directions.len()).map(equation).collect();
            if let Some(dependent) = solve(coordinates.len(), equations)? {
                factors.push(dependent.origin);
            } else {
                factors.push(extended(&vec![T::zero(); coordinates.len()], T::one()));
                coordinates.push(row.clone());
            }
        }
        let functions: Vec<LinearFunction<T>> = inequalities.into_iter().map(|each| each.function).collect();
        let Some(corners) = corners(&functions, &coordinates)? else { return Ok(None) };
        let velocity = |corner: Vec<T>| -> Result<Vec<T>, Unsettled> {
            let from: Vec<T> = corner.iter().zip(&coordinates).map(|(&at, row)| at - row.constant).collect();
            let entry = |(row, factors): (&LinearFunction<T>, &Vec<T>)| {
                let entry = row.constant + dot(factors, &from);
                Ok(if settled(entry)?.is_eq() { T::zero() } else { entry })
            };
            rows.iter().zip(&factors).map(entry).collect()
        };
        let corners = corners.into_iter().map(velocity).collect::<Result<_, _>>()?;
        Ok(Some((coordinates.len(), corners)))
    }

    /// The outcome of the combination with this velocity, `[c_t, xi_n]` by rows.
    pub fn outcome_at(&self, velocity: &[T]) -> Result<Solution, Unsettled> {
        let Self { problem, generators, .. } = self;
        let equation =
            |row: usize| extended(&generators.velocity_row(problem, row), velocity[row] - problem.free_row(row));
        let solutions = solve(generators.count(), (0..velocity.len()).map(equation).collect())?.ok_or(Unsettled)?;
        let still = vec![T::zero(); solutions.directions.len()];
        let fixed = |&constant: &T| LinearFunction { constant, coefficients: still.clone() };
        let space = self.space_of(solutions, velocity.iter().map(fixed).collect());
        let pressing = space.inequalities.iter().filter(|constraint| !constraint.inequality.is_strict());
        let functions: Vec<LinearFunction<T>> = pressing.map(|constraint| constraint.function.clone()).collect();
        let (inside, least) = widest(&functions, still.len(), T::from_f64(CAP))?;
        let outcome = self.outcome(&space, &inside, least)?;
        Ok(Solution { index: None, margin: None, ..outcome })
    }

    /// The velocities and inequalities on `solutions`, whose first `still` directions change no velocity.
    fn space(&self, solutions: Solutions<T>, still: usize) -> Space<T> {
        let Self { problem, modes, generators, .. } = self;
        // If a contact shares its tangential row with a row that is held at zero, its row is zero as well.
        let original =
            |row: usize| problem.shared_tangent(row / 2).filter(|_| row.is_multiple_of(2)).map_or(row, |with| 2 * with);
        let zero: Vec<usize> = zero_rows(modes, problem.laws()).map(original).collect();
        let velocity = |row: usize| {
            if zero.contains(&original(row)) {
                let coefficients = vec![T::zero(); solutions.directions.len()];
                return LinearFunction { constant: T::zero(), coefficients };
            }
            let mut moved = solutions.affine(problem.free_row(row), &generators.velocity_row(problem, row));
            moved.coefficients[..still].fill(T::zero());
            moved
        };
        let velocity = (0..2 * modes.len()).map(velocity).collect();
        self.space_of(solutions, velocity)
    }

    fn space_of(&self, solutions: Solutions<T>, velocity: Vec<LinearFunction<T>>) -> Space<T> {
        let Self { problem, scale, modes, generators, .. } = self;
        let by_speed = T::one() / T::from_f64(scale.speed);
        let mut inequalities = Vec::new();
        for (contact, (&mode, law)) in modes.iter().zip(problem.laws()).enumerate() {
            law.conditions(mode, |inequality, function| {
                // The contact's two numbers: their constants, or their coefficients of a direction.
                let place = |which: usize| generators.place(contact, which);
                let number = |which: usize, at: Option<usize>| match (inequality.is_strict(), at) {
                    (true, None) => velocity[2 * contact + which].constant,
                    (true, Some(at)) => velocity[2 * contact + which].coefficients[at],
                    (false, None) => solutions.origin[place(which)],
                    (false, Some(at)) => solutions.directions[at][place(which)],
                };
                let factor = T::from_f64(scale.factor(contact, inequality, function)) * by_speed;
                let scaled = |at| factor * function.at(|which| number(which, at), |mu, impulse: T| impulse.scaled(mu));
                let coefficients = (0..solutions.directions.len()).map(|at| scaled(Some(at))).collect();
                let function = LinearFunction { constant: scaled(None), coefficients };
                inequalities.push(Constraint { contact, inequality, function });
            });
        }
        Space { solutions, velocity, inequalities }
    }

    fn rejected(&self, space: &Space<T>, y: &[T]) -> Rejection {
        let values = space.inequalities.iter().map(|inequality| (inequality, inequality.function.at(y).to_f64()));
        let least = values.clone().map(|(_, value)| value).fold(f64::INFINITY, f64::min);
        // At the optimum several are equally violated up to rounding; the first contact's is named, first its cone.
        let order = |violated: &Constraint<T>| (violated.contact, violated.inequality != Inequality::FrictionCone);
        let equals = values.filter(|(_, value)| *value <= least + EQUALLY_BAD * least.abs());
        let worst = equals.min_by_key(|(violated, _)| order(violated));
        let because = worst.map_or(RejectionReason::NoSolution, |(worst, _)| RejectionReason::Violated {
            contact: worst.contact,
            inequality: worst.inequality,
        });
        let Self { problem, scale, modes, generators, .. } = self;
        let impulse = generators.impulse(&space.solutions.at(y));
        let velocity: Vec<T> = space.velocity.iter().map(|row| row.at(y)).collect();
        let numbers = Numbers::of((problem, scale), modes, impulse.as_chunks().0, velocity.as_chunks().0);
        Rejection { margin: worst.map(|_| least), motion: Some(numbers.motion), ..Rejection::of(modes, because) }
    }

    /// Whether the only velocity of `space` is the one without impulses.
    fn is_free(&self, space: &Space<T>) -> Result<bool, Unsettled> {
        are_zero(space.velocity.iter().enumerate().map(|(row, entry)| entry.constant - self.problem.free_row(row)))
    }

    /// The outcome with the only velocity of `space` and its impulses. At `inside` the smallest inequality is positive,
    /// or zero as `least`, which is the greatest value that it can have.
    fn outcome(&self, space: &Space<T>, inside: &[T], least: T) -> Result<Solution, Unsettled> {
        let Self { problem, scale, modes, generators, .. } = self;
        let Space { solutions, velocity, inequalities } = space;
        // The velocities are determined; only impulses still depend on y.
        let pressing: Vec<_> = inequalities.iter().filter(|constraint| !constraint.inequality.is_strict()).collect();
        let shifted: Vec<_> = pressing.iter().map(|constraint| constraint.function.seen_from(inside)).collect();
        let mut at_zero: Vec<(usize, Inequality)> = Vec::new();
        if settled(least)?.is_eq() {
            for place in vanishing(&shifted)?.0 {
                let entry = (pressing[place].contact, pressing[place].inequality);
                if !at_zero.contains(&entry) {
                    at_zero.push(entry);
                }
            }
        }
        let at = solutions.at(inside);
        let from = generators.impulse(&at);
        let directions: Vec<Vec<T>> =
            solutions.directions.iter().map(|direction| generators.impulse(direction)).collect();
        // The impulse of each row as a function of y, seen from `inside`.
        let entry = |(row, &constant): (usize, &T)| LinearFunction {
            constant,
            coefficients: directions.iter().map(|direction| direction[row]).collect(),
        };
        let entries: Vec<LinearFunction<T>> = from.iter().enumerate().map(entry).collect();
        let program = Program::of(&shifted, directions.len());
        let mut ranges = Vec::new();
        let mut unique = true;
        for entry in &entries {
            if entry.is_constant()? {
                ranges.push([Some(entry.constant); 2]);
                continue;
            }
            let mut bound = |sign: T| -> Result<Option<T>, Unsettled> {
                let toward: Vec<T> = entry.coefficients.iter().map(|&each| sign * each).collect();
                let Some(best) = program.maximize(&toward)? else {
                    unique = false;
                    return Ok(None);
                };
                let change = entry.change(&best);
                unique &= settled(change)?.is_eq();
                Ok(Some(entry.constant + change))
            };
            ranges.push([bound(-T::one())?, bound(T::one())?]);
        }
        let impulse = if unique {
            from
        } else if self.is_free(space)? {
            vec![T::zero(); from.len()]
        } else {
            generators.impulse(&solutions.moved(at, &least_impulse(&from, &directions, &shifted)?))
        };
        let bounded = settled(least - T::from_f64(UNBOUNDED))?.is_lt();
        let margin = (!inequalities.is_empty() && bounded).then_some(least);
        let velocity: Vec<T> = velocity.iter().map(|row| row.constant).collect();
        let mut numbers = Numbers::of((problem, scale), modes, impulse.as_chunks().0, velocity.as_chunks().0);
        numbers.are_precise &= margin.is_none_or(|margin| is_known(margin, 1.0, scale.digits()));
        if !unique {
            let shortest = impulse.as_chunks().0;
            let needed = friction_needed(modes, problem.laws(), shortest, entries.as_chunks().0, &shifted)?;
            numbers.take_friction(&needed, problem.laws(), scale.digits());
        }
        let range = |(&ends, &value): (&[Option<T>; 2], &T)| {
            numbers.are_precise &= is_known_range(ends, value, scale.digits());
            ends.map(|end| end.map(T::to_f64))
        };
        let ranges: Option<Vec<Range>> = (!unique).then(|| ranges.iter().zip(&impulse).map(range).collect());
        Ok(Solution {
            numbers,
            margin: margin.map(T::to_f64),
            range: ranges.map(|ranges| ranges.as_chunks().0.to_vec()),
            index: if at_zero.is_empty() { index(problem, modes)? } else { None },
            at_zero,
            modes: modes.to_vec(),
        })
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
