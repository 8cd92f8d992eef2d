//! The numbers of an outcome, and whether they have the promised digits.
//!
//! ```text
//!     V = max(own |c-|, own |c+|)                  the speed scale of a contact
//!     P = L_n                                      the impulse scale of a contact
//!
//!     c+                 has the scale V
//!     L_n, L_t           P, max(|L_t|, min(mu, 1) P)
//!     energy_loss        itself
//!     friction_needed    that of the quotient of both impulses
//!     impulse_range      of an end: the largest of both ends and the entry itself
//!
//!     a robot in f64     V >= min(S sqrt(G_ii), the fastest contact's |c|), P >= min(S / sqrt(G_nn), the greatest |L|)
//! ```
//!
//! with S of [`Scale`]. Each number is right to 1e-10 of its scale. A number whose error exceeds [`DIGITS`] is computed
//! again with more digits. The larger scales of the last line avoid this for contacts that the impact hardly affects.

use super::enumerate::Leaf;
use super::generators::Generators;
use super::outcome::{Motion, Range};
use super::problem::ContactProblem;
use super::slack::Scale;
use crate::law::{Impulse, Inequality, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, Real, Rounded};
use nalgebra::DMatrix;

/// The allowed error of an outcome's number, relative to its scale: 1e-10, with room for the quotient of two.
pub const DIGITS: f64 = 4e-11;

/// Work below this has lost digits to underflow \[J\].
const LEAST_WORK: f64 = f64::MIN_POSITIVE / f64::EPSILON;
/// The relative error of a problem's velocities beyond which an outcome's numbers may lack digits; it leaves room for
/// the growth of errors in an elimination.
const SLOW: f64 = DIGITS / 256.0;

/// An f64 inverse X of A is used if no row sum of |I - A X| exceeds this.
const VERIFIED: f64 = 0.1;

/// The scales of an outcome's numbers, per contact.
struct Scales<'a> {
    scale: &'a Scale,
    before: &'a [Pair<f64>],
    motion: &'a Motion,
    /// The greatest speed and the greatest impulse of all contacts if f64 computed the problem of a robot; else zeros.
    greatest: Pair<f64>,
}

impl<'a> Scales<'a> {
    fn of(scale: &'a Scale, before: &'a [Pair<f64>], motion: &'a Motion, is_of_robot: bool) -> Self {
        let greatest = || [largest(before).max(largest(&motion.velocity_after)), largest(&motion.impulse)];
        Self { scale, before, motion, greatest: if is_of_robot { greatest() } else { [0.0; 2] } }
    }

    /// The speed scale V of a contact \[m/s\].
    fn speed(&self, contact: usize) -> f64 {
        let mobility = self.scale.mobility[2 * contact].max(self.scale.mobility[2 * contact + 1]);
        let speed = largest(&[self.before[contact], self.motion.velocity_after[contact]]);
        speed.max(self.greatest[0].min(self.scale.speed * mobility))
    }

    /// The scales of the tangential and the normal impulse of a contact \[N s\].
    fn impulse(&self, contact: usize, law: &Law) -> Pair<f64> {
        let [t, n] = self.motion.impulse[contact].map(f64::abs);
        let normal = n.max(self.greatest[1].min(self.scale.speed / self.scale.mobility[2 * contact + 1]));
        [t.max(least_friction(law) * normal), normal]
    }
}

fn largest(pairs: &[Pair<f64>]) -> f64 {
    pairs.as_flattened().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()))
}

/// The numbers of an outcome.
#[derive(Debug, Clone)]
pub struct Numbers {
    pub motion: Motion,
    /// The kinetic energy that the contacts dissipate \[J\].
    pub energy_loss: f64,
    /// |L_t| / L_n of each sticking contact that is pressed on the ground.
    pub friction_needed: Vec<Option<f64>>,
    /// Whether all numbers have the promised digits.
    pub are_precise: bool,
}

impl Numbers {
    /// The numbers as f64 computed them; [`f64_has_digits`] checks their digits. `friction` is reused memory.
    pub fn of_motion(motion: Motion, modes: &[Mode], problem: &ContactProblem, mut friction: Vec<Option<f64>>) -> Self {
        let energy_loss = energy_loss(problem.velocity_before(), &motion.impulse, &motion.velocity_after);
        friction.clear();
        friction.extend(friction_needed(modes, problem.laws(), &motion.impulse));
        Self { motion, energy_loss, friction_needed: friction, are_precise: true }
    }

    /// The numbers of a combination from an `impulse` and velocities `xi`, `[c_t, xi_n]`, with error bounds.
    pub fn of<T: Ordered>(
        (problem, scale): (&ContactProblem<T>, &Scale),
        modes: &[Mode],
        impulse: &[Pair<T>],
        xi: &[Pair<T>],
    ) -> Self {
        let (laws, before) = (problem.laws(), problem.velocity_before());
        let after: Vec<Pair<T>> =
            xi.iter().enumerate().map(|(contact, &xi)| after(xi, contact, modes, problem)).collect();
        let energy = energy_loss(before, impulse, &after);
        let motion = Motion { impulse: nearest(impulse), velocity_after: nearest(&after) };
        let nearest_before = nearest(before);
        let scales = Scales::of(scale, &nearest_before, &motion, false);
        let of_contact = |contact: usize| {
            let ([t, n], after) = (impulse[contact], after[contact]);
            let [of_t, of_n] = scales.impulse(contact, &laws[contact]);
            let speed = scales.speed(contact);
            let known = |number, size| is_known(number, size, scale.digits());
            after.iter().all(|&entry| known(entry, speed)) && known(n, of_n) && known(t, of_t)
        };
        Self {
            are_precise: is_known(energy, 0.0, scale.digits()) && (0..modes.len()).all(of_contact),
            energy_loss: energy.to_f64(),
            friction_needed: friction_needed(modes, laws, &motion.impulse).collect(),
            motion,
        }
    }

    /// Takes over the friction `needed` by contacts whose impulses are not unique, checked to `digits`.
    pub fn take_friction<T: Ordered>(&mut self, needed: &[Option<T>], laws: &[Law], digits: f64) {
        let known =
            |(needed, law): (&Option<T>, &Law)| needed.is_none_or(|ratio| is_known(ratio, least_friction(law), digits));
        self.are_precise &= needed.iter().zip(laws).all(known);
        let nearest = |(needed, law): (&Option<T>, &Law)| needed.map(|ratio| law.friction().limit(ratio.to_f64()));
        self.friction_needed = needed.iter().zip(laws).map(nearest).collect();
    }
}

/// An outcome, before it is listed.
#[derive(Debug)]
pub struct Solution {
    /// The strict modes of the velocity.
    pub modes: Vec<Mode>,
    /// The numbers of the velocity and the impulse of least norm.
    pub numbers: Numbers,
    /// The sign of det A, or of det B of singular equations; `None` on a border.
    pub index: Option<i8>,
    /// The smallest slack; `None` if there is none.
    pub margin: Option<f64>,
    /// The least and greatest value of every entry of the impulse; `None` if the impulse is unique.
    pub range: Option<Vec<Pair<Range>>>,
    /// The impulse inequalities that are zero for every admissible impulse, by contact.
    pub at_zero: Vec<(usize, Inequality)>,
}

fn nearest<T: Ordered>(list: &[Pair<T>]) -> Vec<Pair<f64>> {
    list.iter().map(|pair| pair.map(T::to_f64)).collect()
}

impl Scale {
    /// The error bound, relative to a number's scale, up to which its likely error keeps the promised digits.
    pub fn digits(&self) -> f64 {
        DIGITS / self.likely_part
    }

    /// Whether the contacts are so slow that the rounding of c likely costs digits of an outcome.
    pub fn is_slow(&self) -> bool {
        self.likely_noise > SLOW && self.likely_noise.is_finite()
    }
}

/// Whether the error of a number is at most `digits` times its magnitude, or times `scale` if that is larger. A number
/// beyond the range of f64 is not known.
pub fn is_known<T: Ordered>(number: T, scale: f64, digits: f64) -> bool {
    let magnitude = number.to_f64().abs();
    magnitude.is_finite() && number.error() <= digits * scale.max(magnitude)
}

/// Whether the errors of both ends of a range are at most `digits` times the largest magnitude of the ends and `value`.
pub fn is_known_range<T: Ordered>(ends: [Option<T>; 2], value: T, digits: f64) -> bool {
    let scale = ends.into_iter().flatten().fold(value.to_f64().abs(), |most, end| most.max(end.to_f64().abs()));
    ends.into_iter().flatten().all(|end| is_known(end, scale, digits))
}

/// The smallest scale of a tangential impulse, min(mu, 1), as a share of the normal impulse's scale.
pub fn least_friction(law: &Law) -> f64 {
    law.friction().limit(1.0)
}

/// c+ of a contact from its `[c_t, xi_n]` \[m/s\].
pub fn after<T: Real>([c_t, xi_n]: Pair<T>, contact: usize, modes: &[Mode], problem: &ContactProblem<T>) -> Pair<T> {
    let c_t = if modes[contact] == Mode::Stick { T::zero() } else { c_t };
    [c_t, if problem.restitution()[contact] == 0.0 { xi_n } else { xi_n - problem.bounce(contact) }]
}

/// -1/2 L.(c- + c+).
fn energy_loss<T: Real>(before: &[Pair<T>], impulse: &[Pair<T>], after: &[Pair<T>]) -> T {
    let moves = impulse.iter().zip(before.iter().zip(after));
    let work = moves.fold(T::zero(), |sum, (l, (c, after))| sum + l[0] * (c[0] + after[0]) + l[1] * (c[1] + after[1]));
    T::zero() - T::from_f64(0.5) * work
}

/// |L_t| / L_n of each sticking contact with L_n > 0; its friction cone was shown to hold, which rounding may exceed.
fn friction_needed(modes: &[Mode], laws: &[Law], impulse: &[Pair<f64>]) -> impl Iterator<Item = Option<f64>> {
    let needed = |((&mode, law), l): ((&Mode, &Law), &Pair<f64>)| {
        (mode == Mode::Stick && l[1] > 0.0).then(|| law.friction().limit(l[0].abs() / l[1]))
    };
    modes.iter().zip(laws).zip(impulse).map(needed)
}

/// Whether the f64 numbers of a leaf, including the `margin`, have the promised digits, judged by their likely errors,
/// or else by their sensitivity to the errors of the problem.
pub fn f64_has_digits(
    leaf: &Leaf<'_, Rounded>,
    modes: &[Mode],
    (problem, scale): (&ContactProblem, &Scale),
    (motion, margin): (&Motion, Option<f64>),
) -> bool {
    let candidate = Candidate { leaf, modes, problem, scale, motion, margin: margin.unwrap_or(0.0).max(1.0) };
    candidate.has_digits(|contact| leaf.numbers(contact).map(|number| scale.likely_part * number.error))
        || candidate.has_digits_by_sensitivity()
}

/// An outcome in f64.
struct Candidate<'a> {
    leaf: &'a Leaf<'a, Rounded>,
    modes: &'a [Mode],
    problem: &'a ContactProblem,
    scale: &'a Scale,
    motion: &'a Motion,
    /// The scale of the margin: at least 1.
    margin: f64,
}

impl Candidate<'_> {
    /// Whether all numbers have their digits if each contact's two numbers ([`Leaf::numbers`]) are off by `errors`.
    fn has_digits(&self, errors: impl Fn(usize) -> [f64; 2]) -> bool {
        let Self { modes, problem, scale, motion, margin, .. } = self;
        let scales = Scales::of(scale, problem.velocity_before(), motion, scale.likely_rounding != 0.0);
        let noise = scale.likely_noise * scale.speed;
        let (mut work, mut doubt) = (0.0, 0.0);
        for (contact, (&mode, law)) in modes.iter().zip(problem.laws()).enumerate() {
            let mobility = [scale.mobility[2 * contact], scale.mobility[2 * contact + 1]];
            let (before, after) = (problem.velocity_before()[contact], motion.velocity_after[contact]);
            let [first, second] = errors(contact);
            let bounce = problem.restitution()[contact] * noise * mobility[1];
            // The errors of c+ and of L.
            let (off, push) = match law.impulse(mode) {
                Impulse::Zero => ([first, second + bounce], [0.0; 2]),
                Impulse::Along(ray) => ([first, bounce], ray.map(|entry| entry.abs() * second)),
                Impulse::Free => ([0.0, bounce], [first, second]),
            };
            let [of_t, of_n] = scales.impulse(contact, law);
            let known = off[0].max(off[1]) <= DIGITS * scales.speed(contact)
                && push[0] <= DIGITS * of_t
                && push[1] <= DIGITS * of_n;
            if !known {
                return false;
            }
            for (row, l) in motion.impulse[contact].into_iter().enumerate() {
                let size = before[row].abs() + after[row].abs();
                work += l * (before[row] + after[row]);
                doubt += l.abs() * (noise * mobility[row] + off[row] + 2.0 * f64::EPSILON * size) + push[row] * size;
                let of_slack = (off[row] / mobility[row]).max(push[row] * mobility[row]) / scale.speed;
                if of_slack > 0.5 * DIGITS * margin {
                    return false;
                }
            }
        }
        // If products underflow, both sides may vanish.
        let is_pressed = motion.impulse.as_flattened().iter().any(|&entry| entry != 0.0);
        doubt <= DIGITS * f64::abs(work) && (!is_pressed || f64::abs(work) > LEAST_WORK)
    }

    /// Does the same as [`Candidate::has_digits`] with errors computed entry by entry from the sensitivity of lambda
    /// (Higham 2002, section 7.2); B is the matrix of the generators.
    ///
    /// ```text
    ///     A = (G B) in the rows that L holds      |change of lambda| <= |A^-1| (|residual| + |errors of c_free + G L|)
    /// ```
    ///
    /// A is scaled by the mobilities. X, its inverse in f64, is verified: with R = I - A X and r < 1 the greatest row
    /// sum of |R|, |A^-1| y <= |X| (y + r / (1 - r) max y).
    fn has_digits_by_sensitivity(&self) -> bool {
        let Self { leaf, modes, problem, scale, .. } = self;
        let impulse: Vec<f64> =
            (0..modes.len()).flat_map(|contact| leaf.impulse(contact)).map(|entry| entry.value).collect();
        let pressed: f64 = impulse.iter().zip(&scale.mobility).map(|(l, mobility)| l.abs() * mobility).sum();
        let rounding = scale.likely_rounding + impulse.len() as f64 * f64::EPSILON;
        let given = |row: usize| {
            let of_free = scale.mobility[row] * scale.likely_noise * scale.speed;
            of_free + f64::EPSILON * problem.free_row(row).abs() + scale.mobility[row] * rounding * pressed
        };
        let residual = |row: usize| {
            let moved: f64 = impulse.iter().enumerate().map(|(column, l)| problem.delassus(row, column) * l).sum();
            (problem.free_row(row) + moved).abs()
        };
        // The rows that L holds: one per generator, in the same order.
        let held = modes.iter().zip(problem.laws()).enumerate().flat_map(|(contact, (&mode, law))| {
            let end = 2 * (contact + 1);
            end - law.impulse(mode).unknowns()..end
        });
        let held: Vec<usize> = held.collect();
        let generators = Generators::of(modes, problem.laws());
        let rows: Vec<Vec<f64>> = (0..impulse.len()).map(|row| generators.velocity_row(problem, row)).collect();
        let (count, unit) = (held.len(), |at: usize| scale.mobility[held[at]]);
        let matrix = DMatrix::from_fn(count, count, |i, j| rows[held[i]][j] / (unit(i) * unit(j)));
        // `try_inverse` of the matrix uses cofactors for four rows, which lose all digits near a zero determinant.
        let Some(inverse) = matrix.clone().lu().try_inverse() else { return false };
        let lost = (count + 2) as f64 * f64::EPSILON * matrix.abs() * inverse.abs();
        let left = (DMatrix::identity(count, count) - &matrix * &inverse).abs() + lost;
        let greatest = left.row_iter().map(|row| row.sum()).fold(0.0, f64::max);
        if greatest.is_nan() || greatest > VERIFIED {
            return false;
        }
        let off: Vec<f64> = (0..count).map(|at| (residual(held[at]) + given(held[at])) / unit(at)).collect();
        let more = VERIFIED / (1.0 - VERIFIED) * off.iter().copied().fold(0.0, f64::max);
        let change = |row: usize| {
            let off = off.iter().map(|off| off + more);
            inverse.row(row).iter().zip(off).map(|(a, off)| a.abs() * off).sum::<f64>() / unit(row)
        };
        let lambda: Vec<f64> = (0..count).map(change).collect();
        let velocity = |row: usize| given(row) + rows[row].iter().zip(&lambda).map(|(a, b)| a.abs() * b).sum::<f64>();
        let number = |row: usize| match held.iter().position(|&other| other == row) {
            Some(place) => lambda[place],
            None => velocity(row),
        };
        self.has_digits(|contact| [number(2 * contact), number(2 * contact + 1)])
    }
}
