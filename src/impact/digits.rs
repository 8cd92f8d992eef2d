//! The numbers of an outcome, and whether they have the digits that are promised.
//!
//! ```text
//!     V = max(own |c-|, own |c+|)                  a contact's scale of speed
//!     P = L_n                                      and of impulse
//!     c+                 of V
//!     L_n, L_t           of P, of max(|L_t|, min(mu, 1) P)
//!     energy_loss        of itself
//!     friction_needed    as the quotient of both impulses
//!     impulse_range      an end: of the largest of both ends and the entry itself
//!
//!     of a robot in f64  V >= min(S sqrt(G_ii), the fastest contact's |c|),  P >= min(S / sqrt(G_nn), the greatest |L|)
//! ```
//!
//! with S of [`Scale`]. Each is right to 1e-10 of that; what the numbers at hand do not show to [`DIGITS`] is computed
//! with more digits. Contacts that hardly feel a blow would else always need them.

use super::enumerate::Leaf;
use super::generators::Generators;
use super::outcome::Motion;
use super::problem::ContactProblem;
use super::slack::Scale;
use crate::law::{Friction, Impulse, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, Real, Rounded};
use nalgebra::DMatrix;

/// What a number of an outcome may be off by: 1e-10, with room for the quotient of two.
pub const DIGITS: f64 = 4e-11;

/// Less work has lost digits to underflow \[J\].
const LEAST_WORK: f64 = f64::MIN_POSITIVE / f64::EPSILON;
/// What the velocities of a problem may be off by, as part of their scale, before an outcome's numbers may lack digits,
/// with room for what an elimination makes of it.
const SLOW: f64 = DIGITS / 256.0;

/// An inverse in f64 is used if what is left of the identity is no more than this.
const VERIFIED: f64 = 0.1;

/// The scales of an outcome's numbers, per contact.
struct Scales<'a> {
    scale: &'a Scale,
    before: &'a [Pair<f64>],
    motion: &'a Motion,
    /// The greatest speed and the greatest impulse of all contacts, of a robot in f64.
    greatest: Pair<f64>,
}

impl<'a> Scales<'a> {
    fn of(scale: &'a Scale, before: &'a [Pair<f64>], motion: &'a Motion) -> Self {
        Self { scale, before, motion, greatest: [0.0; 2] }
    }

    fn of_robot(scale: &'a Scale, before: &'a [Pair<f64>], motion: &'a Motion) -> Self {
        let greatest = [largest(before).max(largest(&motion.velocity_after)), largest(&motion.impulse)];
        Self { scale, before, motion, greatest }
    }

    /// V of a contact \[m/s\].
    fn speed(&self, contact: usize) -> f64 {
        let mobility = self.scale.mobility[2 * contact].max(self.scale.mobility[2 * contact + 1]);
        let own = largest(&[self.before[contact], self.motion.velocity_after[contact]]);
        own.max(self.greatest[0].min(self.scale.speed * mobility))
    }

    /// What the tangential and the normal impulse of a contact are relative to \[N s\].
    fn impulse(&self, contact: usize, law: &Law) -> Pair<f64> {
        let [t, n] = self.motion.impulse[contact].map(f64::abs);
        let own = n.max(self.greatest[1].min(self.scale.speed / self.scale.mobility[2 * contact + 1]));
        [t.max(least_friction(law) * own), own]
    }
}

fn largest(pairs: &[Pair<f64>]) -> f64 {
    pairs.as_flattened().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()))
}

/// The numbers of an outcome.
#[derive(Debug, Clone)]
pub struct Numbers {
    pub motion: Motion,
    /// Kinetic energy that the contacts took \[J\].
    pub energy_loss: f64,
    /// |L_t| / L_n of each sticking contact that is pressed on the ground.
    pub friction_needed: Vec<Option<f64>>,
    /// Whether all have the digits that are promised.
    pub are_sharp: bool,
}

impl Numbers {
    /// Those of f64, of which [`f64_serves`] says whether they are sharp; `friction` is memory.
    pub fn of_motion(motion: Motion, modes: &[Mode], problem: &ContactProblem, mut friction: Vec<Option<f64>>) -> Self {
        let energy_loss = energy_loss(problem.velocity_before(), &motion.impulse, &motion.velocity_after);
        friction.clear();
        friction.extend(friction_needed(modes, problem.laws(), &motion.impulse));
        Self { motion, energy_loss, friction_needed: friction, are_sharp: true }
    }

    /// Those of a combination solved in numbers that know their own errors: impulses, and velocities `[c_t, xi_n]`.
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
        let scales = Scales::of(scale, &nearest_before, &motion);
        let of_contact = |contact: usize| {
            let ([t, n], after) = (impulse[contact], after[contact]);
            let [of_t, of_n] = scales.impulse(contact, &laws[contact]);
            let speed = scales.speed(contact);
            let known = |number, size| is_known(number, size, scale.digits());
            after.iter().all(|&entry| known(entry, speed)) && known(n, of_n) && known(t, of_t)
        };
        Self {
            are_sharp: is_known(energy, 0.0, scale.digits()) && (0..modes.len()).all(of_contact),
            energy_loss: energy.to_f64(),
            friction_needed: friction_needed(modes, laws, &motion.impulse).collect(),
            motion,
        }
    }

    /// Takes over the friction that contacts need whose impulses are not unique, to so many `digits`.
    pub fn take_friction<T: Ordered>(&mut self, needed: &[Option<T>], laws: &[Law], digits: f64) {
        let known =
            |(needed, law): (&Option<T>, &Law)| needed.is_none_or(|ratio| is_known(ratio, least_friction(law), digits));
        self.are_sharp &= needed.iter().zip(laws).all(known);
        let nearest = |(needed, law): (&Option<T>, &Law)| needed.map(|ratio| at_most(law, ratio.to_f64()));
        self.friction_needed = needed.iter().zip(laws).map(nearest).collect();
    }
}

fn nearest<T: Ordered>(list: &[Pair<T>]) -> Vec<Pair<f64>> {
    list.iter().map(|pair| pair.map(T::to_f64)).collect()
}

impl Scale {
    /// Up to what bound of its error a number likely has the digits that are promised.
    pub fn digits(&self) -> f64 {
        DIGITS / self.likely_part
    }

    /// Whether the contacts are so slow that the rounding of c likely takes digits of an outcome.
    pub fn is_slow(&self) -> bool {
        self.likely_noise > SLOW && self.likely_noise.is_finite()
    }
}

/// Whether a number is known to so many `digits`, as of [`DIGITS`], of itself or of a `scale` that is larger.
pub fn is_known<T: Ordered>(number: T, scale: f64, digits: f64) -> bool {
    number.error() <= digits * scale.max(number.to_f64().abs())
}

/// Whether the ends of a range are known to their digits of the largest of both and `own`, which lies between.
pub fn is_known_range<T: Ordered>(ends: [Option<T>; 2], own: T, digits: f64) -> bool {
    let scale = ends.into_iter().flatten().fold(own.to_f64().abs(), |most, end| most.max(end.to_f64().abs()));
    ends.into_iter().flatten().all(|end| is_known(end, scale, digits))
}

/// The share of the normal impulse that counts as a tangential impulse's scale.
pub fn least_friction(law: &Law) -> f64 {
    match law.friction() {
        Friction::Finite(mu) => mu.min(1.0),
        Friction::Infinite => 1.0,
    }
}

/// c+ of a contact with `[c_t, xi_n]`.
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

/// |L_t| / L_n of each sticking contact that is pressed on the ground, whose cone was shown to hold.
fn friction_needed(modes: &[Mode], laws: &[Law], impulse: &[Pair<f64>]) -> impl Iterator<Item = Option<f64>> {
    let needed = |((&mode, law), l): ((&Mode, &Law), &Pair<f64>)| {
        (mode == Mode::Stick && l[1] > 0.0).then(|| at_most(law, l[0].abs() / l[1]))
    };
    modes.iter().zip(laws).zip(impulse).map(needed)
}

/// A ratio that rounding may have lifted beyond the friction.
fn at_most(law: &Law, ratio: f64) -> f64 {
    match law.friction() {
        Friction::Finite(mu) => ratio.min(mu),
        Friction::Infinite => ratio,
    }
}

/// Whether the f64 numbers of a leaf have their digits, those of the `margin` included: by what is likely of their
/// errors, or else by how they depend on the problem.
pub fn f64_serves(
    leaf: &Leaf<'_, Rounded>,
    modes: &[Mode],
    (problem, scale): (&ContactProblem, &Scale),
    (motion, margin): (&Motion, Option<f64>),
) -> bool {
    let candidate = Candidate { leaf, modes, problem, scale, motion, margin: margin.unwrap_or(0.0).max(1.0) };
    candidate.serves(|contact| leaf.numbers(contact).map(|own| scale.likely_part * own.error))
        || candidate.serves_by_sensitivity()
}

/// An outcome in f64.
struct Candidate<'a> {
    leaf: &'a Leaf<'a, Rounded>,
    modes: &'a [Mode],
    problem: &'a ContactProblem,
    scale: &'a Scale,
    motion: &'a Motion,
    /// The scale of the margin.
    margin: f64,
}

impl Candidate<'_> {
    /// Whether all have their digits if the two numbers of each contact, as the leaf has them, are off by `errors`.
    fn serves(&self, errors: impl Fn(usize) -> [f64; 2]) -> bool {
        let Self { modes, problem, scale, motion, margin, .. } = self;
        let scales = match scale.likely_rounding {
            0.0 => Scales::of,
            _ => Scales::of_robot,
        }(scale, problem.velocity_before(), motion);
        let noise = scale.likely_noise * scale.speed;
        let (mut work, mut doubt) = (0.0, 0.0);
        for (contact, (&mode, law)) in modes.iter().zip(problem.laws()).enumerate() {
            let mobility = [scale.mobility[2 * contact], scale.mobility[2 * contact + 1]];
            let (before, after) = (problem.velocity_before()[contact], motion.velocity_after[contact]);
            let [first, second] = errors(contact);
            let bounce = problem.restitution()[contact] * noise * mobility[1];
            // What c+ and L are off by.
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
        // Where products underflow, both may vanish.
        let is_pressed = motion.impulse.as_flattened().iter().any(|&entry| entry != 0.0);
        doubt <= DIGITS * f64::abs(work) && (!is_pressed || f64::abs(work) > LEAST_WORK)
    }

    /// As [`Candidate::serves`], entry by entry, with B that of the generators (Higham 2002, section 7.2).
    ///
    /// ```text
    ///     A = (G B) in the rows that L holds      |change of lambda| <= |A^-1| (|residual| + |errors of c_free + G L|)
    /// ```
    ///
    /// In units of the mobilities X = A^-1 in f64 is shown to be near enough: with R = I - A X and a greatest row sum of
    /// |R| of r < 1, |A^-1| y <= |X| (y + r / (1 - r) max y).
    fn serves_by_sensitivity(&self) -> bool {
        let Self { leaf, modes, problem, scale, .. } = self;
        let impulse: Vec<f64> =
            (0..modes.len()).flat_map(|contact| leaf.impulse(contact)).map(|own| own.value).collect();
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
        // One row for each generator, in the same order.
        let held = modes.iter().zip(problem.laws()).enumerate().flat_map(|(contact, (&mode, law))| {
            let first = match law.impulse(mode) {
                Impulse::Zero => 2,
                Impulse::Along(_) => 1,
                Impulse::Free => 0,
            };
            2 * contact + first..2 * contact + 2
        });
        let held: Vec<usize> = held.collect();
        let generators = Generators::of(modes, problem.laws());
        let rows: Vec<Vec<f64>> = (0..impulse.len()).map(|row| generators.velocity_row(problem, row)).collect();
        let (count, unit) = (held.len(), |at: usize| scale.mobility[held[at]]);
        let matrix = DMatrix::from_fn(count, count, |i, j| rows[held[i]][j] / (unit(i) * unit(j)));
        // Not by `try_inverse`, whose cofactors of four rows lose all digits where the determinant nearly vanishes.
        let Some(inverse) = matrix.clone().lu().try_inverse() else { return false };
        let lost = (count + 2) as f64 * f64::EPSILON * matrix.abs() * inverse.abs();
        let left = (DMatrix::identity(count, count) - &matrix * &inverse).abs() + lost;
        let greatest = left.row_iter().map(|row| row.sum()).fold(0.0, f64::max);
        if greatest.is_nan() || greatest > VERIFIED {
            return false;
        }
        let off: Vec<f64> = (0..count).map(|at| (residual(held[at]) + given(held[at])) / unit(at)).collect();
        let more = VERIFIED / (1.0 - VERIFIED) * off.iter().copied().fold(0.0, f64::max);
        let weighed = |a: f64, b: &f64| a.abs() * b;
        let change = |row: usize| {
            let off = off.iter().map(|off| off + more);
            inverse.row(row).iter().zip(off).map(|(a, off)| a.abs() * off).sum::<f64>() / unit(row)
        };
        let lambda: Vec<f64> = (0..count).map(change).collect();
        let velocity =
            |row: usize| given(row) + rows[row].iter().zip(&lambda).map(|(&a, b)| weighed(a, b)).sum::<f64>();
        let number = |row: usize| match held.iter().position(|&own| own == row) {
            Some(place) => lambda[place],
            None => velocity(row),
        };
        self.serves(|contact| [number(2 * contact), number(2 * contact + 1)])
    }
}
