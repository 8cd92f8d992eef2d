//! How far the f64 numbers of an elimination may be off: the first layer of every proof.
//!
//! In the scale of [`Scale`] (velocities c_i / (S sqrt(G_ii)), impulses L_i sqrt(G_ii) / S) a tableau has two classes
//! of rows, velocities and impulses, and each row coefficients of the impulses still open and a constant. For each of
//! the four one [`Class`] holds how large its f64 entries are and how far they may be from the true ones. Every step of
//! the elimination is a sum of products and a quotient, so the bounds of a tableau follow from those of the last:
//!
//! ```text
//!     x y:    |x| e_y + |y| e_x + e_x e_y + rounding      x / p:   (e_x + |x / p| e_p) / (|p| - e_p) + rounding
//! ```
//!
//! (Higham 2002, chapter 3). Rounding is relative, so the scale may be applied after the fact. A pivot that may be zero
//! makes every bound infinite. The bounds' own rounding is covered by [`SLACK`]. Constants that are sums of products with
//! numbers that are exactly zero are so themselves: those of contacts that rest, next to others that move.

use super::enumerate::Tableau;
use super::slack::Scale;
use crate::law::Impulse;
use crate::planar::Pair;

const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;
/// What a few operations lose, in the scale.
const ROUNDINGS: f64 = 16.0 * f64::EPSILON;
/// Covers the roundings of the bounds themselves, a few dozen operations per contact.
const SLACK: f64 = 1.0 + 1e-6;

/// Entries of one kind: none is larger than `size` in f64, none farther than `error` from the truth.
#[derive(Debug, Clone, Copy, Default)]
pub struct Class {
    pub size: f64,
    pub error: f64,
}

impl Class {
    fn product(self, other: Self) -> Self {
        let size = self.size * other.size;
        let error = self.size * other.error + other.size * self.error + self.error * other.error;
        Self { size, error: error + UNIT_ROUNDOFF * size }
    }

    fn plus(self, other: Self) -> Self {
        let size = self.size + other.size;
        Self { size, error: self.error + other.error + UNIT_ROUNDOFF * (size + self.error + other.error) }
    }

    /// Divided by a number of exactly this computed magnitude.
    fn over(self, pivot: f64, error: f64) -> Self {
        let least = pivot - error;
        if least > 0.0 {
            let size = self.size / pivot;
            Self { size, error: (self.error + size * error) / least + UNIT_ROUNDOFF * size }
        } else {
            Self { size: f64::INFINITY, error: f64::INFINITY }
        }
    }

    fn or(self, other: Self) -> Self {
        Self { size: self.size.max(other.size), error: self.error.max(other.error) }
    }
}

/// The bounds of one tableau.
#[derive(Debug, Clone, Copy, Default)]
pub struct Bound {
    /// Coefficients of velocity rows.
    pub velocity: Class,
    /// Constants of velocity rows.
    pub velocity_constant: Class,
    /// Coefficients of impulse rows; a slide's lambda counts as the larger entry of its impulse.
    pub impulse: Class,
    /// Constants of impulse rows.
    pub impulse_constant: Class,
    /// Bits of the rows whose constants are exactly zero, whatever the rest is.
    pub still: u32,
    /// The error that the problem came with.
    given: f64,
}

impl Bound {
    /// After the elimination of `unknowns` (1 or 2) impulses: `top` is what is divided by the pivot or determinant. The
    /// `last` contact leaves no coefficients.
    fn eliminated(self, unknowns: usize, pivot: f64, pivot_error: f64, top: [Class; 2], last: bool) -> Self {
        let along = |factor: Class, solved: Class, own: Class| {
            let part = factor.product(solved);
            if unknowns == 1 { own.plus(part) } else { own.plus(part).plus(part) }
        };
        let [coefficient, constant] = top;
        let constant = constant.over(pivot, pivot_error);
        let mut next = Self {
            velocity_constant: along(self.velocity, constant, self.velocity_constant),
            impulse_constant: along(self.impulse, constant, self.impulse_constant).or(constant),
            given: self.given,
            ..Self::default()
        };
        if !last {
            let coefficient = coefficient.over(pivot, pivot_error);
            next.velocity = along(self.velocity, coefficient, self.velocity);
            next.impulse = along(self.impulse, coefficient, self.impulse).or(coefficient);
        }
        next
    }

    /// After a contact slides: its row along its ray, both scaled to length one, is the pivot.
    pub fn slide(self, pivot: f64, last: bool) -> Self {
        // Along a ray of two parts whose sizes add up to one: one more rounding for each product, one for the sum.
        let along = |class: Class| Class { error: class.error + 3.0 * UNIT_ROUNDOFF * class.size, ..class };
        let bent = Self { velocity: along(self.velocity), impulse: along(self.impulse), ..self };
        bent.eliminated(1, pivot, bent.velocity.error, [self.velocity, self.velocity_constant], last)
    }

    /// After a contact sticks: the determinant of its block, scaled to a unit diagonal.
    pub fn stick(self, determinant: f64, last: bool) -> Self {
        let square = self.velocity.product(self.velocity);
        let twice = square.plus(square);
        let right = self.velocity.product(self.velocity_constant);
        self.eliminated(2, determinant, twice.error, [twice, right.plus(right)], last)
    }

    /// With the sizes that the entries have in place of the ones that they may have.
    pub fn measured(mut self, [velocity, velocity_constant, impulse, impulse_constant]: [f64; 4]) -> Self {
        self.velocity.size = velocity;
        self.velocity_constant.size = velocity_constant;
        self.impulse.size = impulse;
        self.impulse_constant.size = impulse_constant;
        self
    }

    /// How far a scaled number is likely to be off, if the problem's own errors are the likely ones of `scale`.
    pub fn likely_error(&self, scale: &Scale) -> f64 {
        let growth = self.velocity_constant.error.max(self.impulse_constant.error) / (self.given + ROUNDINGS);
        growth * (scale.likely_noise + scale.likely_rounding + ROUNDINGS)
    }

    /// How far a scaled velocity (or its constant's slack) may be off.
    pub fn velocity_error(&self) -> f64 {
        (self.velocity_constant.error + 4.0 * UNIT_ROUNDOFF * self.velocity_constant.size) * SLACK
    }

    /// How far a scaled impulse or cone slack may be off: a cone's is a combination of two impulses of length one.
    pub fn impulse_error(&self) -> f64 {
        let Class { size, error } = self.impulse_constant;
        (1.5 * error + 8.0 * UNIT_ROUNDOFF * size) * SLACK
    }
}

/// Whether products of the problem's magnitudes stay so far from underflow that all rounding is relative.
pub fn is_far_from_underflow(scale: &Scale) -> bool {
    let (least, most) = scale
        .mobility
        .iter()
        .fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), &mobility| (least.min(mobility), most.max(mobility)));
    scale.mobility.is_empty() || (scale.speed * least > 1e-200 && scale.speed * most < 1e200 && most < 1e60 * least)
}

/// Bounds of every tableau on the way to a leaf; memory that is reused.
#[derive(Debug, Clone, Default)]
pub struct LeafBounds {
    depths: Vec<Bound>,
    /// 1 / sqrt(G_ii) of every row.
    inverse: Vec<f64>,
    speed: f64,
}

impl LeafBounds {
    /// Begins with a G off by `delassus` (relative to sqrt(G_ii G_jj)) and scaled velocities off by `noise`.
    pub fn load(&mut self, tableau: &Tableau<f64>, scale: &Scale, delassus: f64, noise: f64) {
        self.inverse.clear();
        self.inverse.extend(scale.mobility.iter().map(|mobility| 1.0 / mobility));
        self.speed = scale.speed;
        self.depths.clear();
        self.depths.resize(scale.mobility.len() / 2 + 1, Bound::default());
        let known = delassus.is_finite() && is_far_from_underflow(scale);
        let [delassus, noise] = if known { [delassus, noise] } else { [f64::INFINITY; 2] };
        let start = Bound {
            velocity: Class { size: 0.0, error: delassus },
            velocity_constant: Class { size: 0.0, error: noise },
            still: scale.still,
            given: delassus + noise,
            ..Bound::default()
        };
        self.depths[0] = start.measured(self.sizes(tableau, 0));
    }

    pub fn at(&self, depth: usize) -> &Bound {
        &self.depths[depth]
    }

    /// Follows the elimination of `contact` from the tableau of depth `source`.
    pub fn follow(&mut self, tableau: &Tableau<f64>, contact: usize, source: usize) {
        let (impulse, pivot) = tableau.decided(contact);
        let [t, n] = [self.inverse[2 * contact], self.inverse[2 * contact + 1]];
        let last = contact + 2 == self.depths.len();
        let mut next = match impulse {
            Impulse::Zero => self.depths[source],
            Impulse::Along(ray) => self.depths[source].slide((pivot * n / self.size(contact, ray)).abs(), last),
            Impulse::Free => self.depths[source].stick((pivot * (t * n) * (t * n)).abs(), last),
        };
        // No impulse is added to any row if the contact's own constants are zero and its pivot is not.
        let read = impulse.unknowns() << (2 * contact);
        let is_none = self.depths[source].still & read == read && next.impulse_constant.error.is_finite();
        next.still = if is_none { self.depths[source].still } else { 0 };
        // No later step asks how large the constants of the last are.
        self.depths[contact + 1] = if last { next } else { next.measured(self.sizes(tableau, contact + 1)) };
    }

    /// The largest of the scaled entries that later steps read: coefficients and constants of velocity rows, then of
    /// impulse rows; as many contacts are decided as the depth says.
    fn sizes(&self, tableau: &Tableau<f64>, depth: usize) -> [f64; 4] {
        let mut sizes = [0.0_f64; 4];
        for row in 0..self.inverse.len() {
            let (contact, normal) = (row / 2, row % 2 == 1);
            let impulse = match (contact < depth).then(|| tableau.decided(contact).0) {
                Some(Impulse::Free) => Some(1.0 / self.inverse[row]),
                Some(Impulse::Along(ray)) if normal => Some(self.size(contact, ray)),
                _ => None,
            };
            let (class, factor, speed) = match impulse {
                Some(factor) => (2, factor, self.speed),
                None => (0, self.inverse[row], self.speed),
            };
            let (entries, open) = (tableau.row(depth, row), 2 * depth..self.inverse.len());
            for (entry, inverse) in entries[open.clone()].iter().zip(&self.inverse[open]) {
                sizes[class] = sizes[class].max((entry * factor * inverse).abs());
            }
            sizes[class + 1] = sizes[class + 1].max((entries[self.inverse.len()] * factor / speed).abs());
        }
        sizes
    }

    /// The size of a ray in the scale: the sum of the sizes of its entries times sqrt(G_tt) and sqrt(G_nn).
    fn size(&self, contact: usize, ray: Pair<f64>) -> f64 {
        ray[0].abs() / self.inverse[2 * contact] + ray[1].abs() / self.inverse[2 * contact + 1]
    }
}

#[cfg(test)]
mod tests {
    use super::super::enumerate::Leaf;
    use super::super::problem::{ContactProblem, Errors};
    use super::*;
    use crate::law::Friction;
    use crate::scalar::{Interval, Ordered, Real};
    use proptest::prelude::*;

    /// Follows the bounds and compares those of every leaf with its numbers.
    struct Watch<'a> {
        bounds: LeafBounds,
        scale: &'a Scale,
        problem: &'a ContactProblem,
    }

    impl super::super::enumerate::Visitor<f64> for Watch<'_> {
        fn eliminated(&mut self, tableau: &Tableau<f64>, contact: usize, source: usize) {
            self.bounds.follow(tableau, contact, source);
        }

        fn leaf(&mut self, leaf: &Leaf<'_, f64>) {
            let bound = self.bounds.at(leaf.depth);
            let mobility = &self.scale.mobility;
            Interval::scope(512, || {
                let mut tableau = Tableau::<Interval>::default();
                tableau.load(&self.problem.map(Interval::from_f64));
                let exact = tableau.leaf(leaf.modes);
                for (row, mobility) in mobility.iter().enumerate() {
                    let far = |own: f64, exact: Interval| (exact - Interval::from_f64(own)).to_f64().abs();
                    let velocity = far(leaf.velocity(row / 2)[row % 2], exact.velocity(row / 2)[row % 2]);
                    let impulse = far(leaf.impulse(row / 2)[row % 2], exact.impulse(row / 2)[row % 2]);
                    if bound.still >> row & 1 == 1 {
                        assert!(
                            [velocity, impulse] == [0.0; 2] && leaf.numbers(row / 2)[row % 2] == 0.0,
                            "row {row} moves"
                        );
                    }
                    for (error, allowed) in [
                        (velocity / (mobility * self.scale.speed), bound.velocity_error()),
                        (impulse * mobility / self.scale.speed, bound.impulse_error()),
                    ] {
                        assert!(error.is_nan() || error <= allowed, "{:?}: {error:e} > {allowed:e}", leaf.modes);
                    }
                }
            });
        }
    }

    proptest! {
        #[test]
        fn numbers_keep_within_their_bounds(
            mut rows in prop::collection::vec(prop::collection::vec(-1.0..1.0f64, 7), 6),
            before in prop::collection::vec(
                prop_oneof![2 => prop::array::uniform2(-1.0..1.0f64), 1 => Just([0.0; 2])],
                3,
            ),
            friction in prop::collection::vec(
                prop_oneof![Just(Friction::ZERO), Just(Friction::Infinite), (0.01..10.0f64).prop_map(Friction::Finite)],
                3,
            ),
            light in -8..8i32,
        ) {
            rows[2].iter_mut().for_each(|entry| *entry *= 10f64.powi(light));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let delassus = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b))).collect();
            let problem = ContactProblem::new(delassus, before, friction, vec![0.5, 0.0, 0.0]).unwrap();
            let mut scale = Scale::default();
            scale.measure(&problem, Errors::NONE);
            let mut tableau = Tableau::default();
            tableau.load(&problem);
            let mut bounds = LeafBounds::default();
            bounds.load(&tableau, &scale, 0.0, 0.0);
            tableau.visit(&mut Watch { bounds, scale: &scale, problem: &problem });
        }
    }
}
