//! Slacks: the values of a combination's inequalities, scaled free of units.

use super::enumerate::Leaf;
use super::problem::{ContactProblem, Errors};
use crate::law::{Function, Inequality, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ball, Ordered, Real, Rounded};

/// One inequality of a combination, with its value.
#[derive(Debug, Clone, Copy)]
pub struct Slack<T> {
    pub contact: usize,
    pub inequality: Inequality,
    pub function: Function,
    /// The value before scaling: \[m/s\] of a velocity, \[N s\] of an impulse or a cone.
    pub number: T,
}

/// Calls `visitor` with every slack of the combination `modes`, one of those that the leaf stands for.
pub fn slacks<T: Real>(leaf: &Leaf<'_, T>, modes: &[Mode], laws: &[Law], mut visitor: impl FnMut(Slack<T>)) {
    for (contact, (&mode, law)) in modes.iter().zip(laws).enumerate() {
        let numbers = leaf.numbers(contact);
        law.conditions(mode, |inequality, function| {
            let number = function.at(|which| numbers[which], |mu, impulse| impulse.scaled(mu));
            visitor(Slack { contact, inequality, function, number });
        });
    }
}

/// The magnitudes of a problem, which make its slacks free of units.
///
/// S = max |c_free| / sqrt(G_ii) \[sqrt J\]; see [`Function::scale`].
#[derive(Debug, Clone, Default)]
pub struct Scale {
    /// S \[sqrt J\]; 1 if no contact moves.
    pub speed: f64,
    /// sqrt(G_ii) of every row \[1/sqrt(kg)\]; a row with G_ii = 0 has the largest value of the other rows.
    pub mobility: Vec<f64>,
    /// Bound of the errors of the f64 problem's scaled velocities.
    pub noise: f64,
    /// Likely errors of the scaled velocities.
    pub likely_noise: f64,
    /// Likely errors of the scaled entries of G.
    pub likely_rounding: f64,
    /// The ratio of the likely error to the error bound of a number that was computed from them.
    pub likely_part: f64,
}

/// The relative rounding of a few operations.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;

/// The estimated errors of G and c_free, free of units: measured below 3e-15 for G.
const ESTIMATED: f64 = 64.0 * f64::EPSILON;

impl Scale {
    /// Measures a problem, reusing the memory; `errors` are the error bounds of its numbers.
    pub fn measure(&mut self, problem: &ContactProblem, errors: Errors<'_>) {
        let rows = 2 * problem.contacts();
        self.mobility.clear();
        self.mobility.extend((0..rows).map(|row| problem.delassus(row, row).max(0.0).sqrt()));
        let largest = self.mobility.iter().copied().fold(0.0, f64::max);
        let fallback = if largest > 0.0 { largest } else { 1.0 };
        for mobility in &mut self.mobility {
            if *mobility <= 0.0 {
                *mobility = fallback;
            }
        }
        let entries = problem.velocity_free().iter().flatten().zip(&self.mobility);
        self.speed = entries.map(|(c, mobility)| c.abs() / mobility).fold(0.0, f64::max);
        let bounces = (0..problem.contacts()).map(|i| problem.bounce(i).abs() / self.mobility[2 * i + 1]);
        if self.speed == 0.0 {
            // An applied impulse may cancel c- exactly, so that only the bounce is left.
            self.speed = bounces.fold(0.0, f64::max);
        }
        if self.speed == 0.0 {
            // Speeds that underflow in the division are not zero; this tiny scale leaves their signs undecided in f64.
            let at_rest = problem.velocity_free().iter().flatten().all(|&c| c == 0.0);
            self.speed = if at_rest { 1.0 } else { f64::MIN_POSITIVE };
        }
        let noise = errors.velocity.unwrap_or_default().iter().flatten().zip(&self.mobility);
        self.noise = noise.map(|(noise, mobility)| noise / (mobility * self.speed)).fold(0.0, f64::max);
        let [of_delassus, of_velocity] = errors.likely;
        (self.likely_noise, self.likely_rounding) = (of_velocity * self.noise, of_delassus * errors.delassus);
        if (0..problem.contacts()).any(|contact| problem.bounce(contact) != 0.0) {
            // The bounce and its sum with c_n are rounded; each is at most S sqrt(G_nn).
            self.noise += 4.0 * f64::EPSILON;
            self.likely_noise += 4.0 * f64::EPSILON;
        }
        let likely = self.likely_noise + self.likely_rounding + ROUNDINGS;
        self.likely_part = likely / (errors.delassus + self.noise + ROUNDINGS);
    }

    /// The magnitudes of a problem in numbers with error bounds.
    pub fn of<T: Ordered>(problem: &ContactProblem<T>) -> Self {
        let mut scale = Self::default();
        scale.measure(&problem.map(T::to_f64), Errors::NONE);
        scale
    }

    /// Estimates the errors of a problem about whose rounding nothing is known; `velocity` is memory for those of
    /// c_free.
    pub fn estimate<'a>(&self, velocity: &'a mut Vec<Pair<f64>>) -> Errors<'a> {
        velocity.clear();
        let error = |mobility: f64| ESTIMATED * mobility * self.speed;
        velocity.extend(self.mobility.as_chunks().0.iter().map(|&[t, n]| [error(t), error(n)]));
        Errors { delassus: ESTIMATED, velocity: Some(velocity), likely: [1.0; 2] }
    }

    /// Returns the entries of G with their error bounds, by row and column \[1/kg\].
    pub fn delassus(&self, problem: &ContactProblem, errors: Errors<'_>) -> impl Fn(usize, usize) -> Rounded {
        let relative = if self.is_far_from_underflow() { errors.delassus } else { f64::INFINITY };
        move |row, column| {
            let error = relative * (self.mobility[row] * self.mobility[column]);
            Rounded { value: problem.delassus(row, column), error }
        }
    }

    /// Returns the velocities without impulses with their error bounds, by row \[m/s\].
    pub fn free(&self, problem: &ContactProblem, errors: Errors<'_>) -> impl Fn(usize) -> Rounded {
        move |row| {
            let (contact, value) = (row / 2, problem.free_row(row));
            let bound = errors.velocity.map_or(0.0, |errors| errors[contact][row % 2]);
            let error = match problem.restitution()[contact] {
                bouncing if row % 2 == 1 && bouncing != 0.0 => {
                    // The bounce and the sum are rounded, and the bounce may underflow.
                    let rounding = f64::EPSILON * (problem.bounce(contact).abs() + value.abs()) + f64::MIN_POSITIVE;
                    bound * (1.0 + bouncing) + if problem.velocity_before()[contact][1] < 0.0 { rounding } else { 0.0 }
                }
                _ => bound,
            };
            Rounded { value, error: if errors.delassus.is_finite() { error } else { f64::INFINITY } }
        }
    }

    /// The problem as balls around its f64 numbers, in which shared tangential rows are copies of one row.
    pub fn enclosed(
        &self,
        problem: &ContactProblem,
        errors: Errors<'_>,
        shared: Vec<Option<usize>>,
    ) -> ContactProblem<Ball> {
        let contacts = problem.contacts();
        let entry = self.delassus(problem, errors);
        let original = |row: usize| shared[row / 2].filter(|_| row.is_multiple_of(2)).map_or(row, |with| 2 * with);
        let ball = |mid: f64, radius: f64| Ball { mid, radius };
        let columns = |row: usize| (0..2 * contacts).map(move |column| [row, column]);
        let delassus = (0..2 * contacts).flat_map(columns).map(|at| {
            let Rounded { value, error } = entry(original(at[0]), original(at[1]));
            ball(value, error)
        });
        let velocity = |list: &[Pair<f64>]| -> Vec<Pair<Ball>> {
            let entry = |row: usize| {
                let (contact, axis) = (row / 2, row % 2);
                ball(list[contact][axis], errors.velocity.map_or(0.0, |errors| errors[contact][axis]))
            };
            (0..contacts).map(|contact| [2 * contact, 2 * contact + 1].map(|row| entry(original(row)))).collect()
        };
        let (before, free) = (velocity(problem.velocity_before()), velocity(problem.velocity_free()));
        let (laws, restitution) = (problem.laws().to_vec(), problem.restitution().to_vec());
        ContactProblem::of_parts(delassus.collect(), before, free, laws, restitution).sharing(shared)
    }

    /// Whether products of the problem's magnitudes stay far enough from underflow that all rounding is relative.
    pub fn is_far_from_underflow(&self) -> bool {
        let least = self.mobility.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.mobility.iter().copied().fold(0.0, f64::max);
        self.mobility.is_empty() || (self.speed * least > 1e-200 && self.speed * most < 1e200 && most < 1e60 * least)
    }

    /// The value of a slack scaled free of units; `number` is the nearest f64 of its value.
    #[inline]
    pub fn scaled<T>(&self, slack: &Slack<T>, number: f64) -> f64 {
        number / self.speed * self.factor(slack.contact, slack.inequality, slack.function)
    }

    /// The factor that makes the value of a contact's inequality free of units once it is divided by S.
    #[inline]
    pub fn factor(&self, contact: usize, inequality: Inequality, function: Function) -> f64 {
        function.scale(inequality, [self.mobility[2 * contact], self.mobility[2 * contact + 1]])
    }
}
