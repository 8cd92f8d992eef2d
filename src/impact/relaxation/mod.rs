//! A linear relaxation: whether any impulses lead to given modes of the first contacts, whatever the other contacts do.
//!
//! ```text
//!     undecided contact   xi_n >= 0                       L in the cone that holds those of all modes
//!     decided contact     the signs of its velocity       L zero, on its ray or in that cone
//! ```
//!
//! Velocities are affine in the multipliers of the rays. The dual simplex method pivots in f64 until every variable is
//! in its range, or until one cannot get there (Chvatal, *Linear Programming*, 1983, chapters 3 and 10). The row of
//! that variable then claims that no impulses lead to these modes: with multipliers y of the velocities and sigma of
//! the rays (Farkas)
//!
//! ```text
//!     y . xi + sigma . lambda = y . xi_free < 0,   sigma = -y G rays,   although no term on the left is negative
//! ```
//!
//! No f64 result is trusted: a [`Claim`] is shown by an error bound ([`Relaxation::shows`]), or in numbers with more
//! digits ([`Claim::shown`]).

mod ranges;
mod dictionary;
mod claim;

pub use claim::Claim;
pub use dictionary::Lack;

use super::kernel::{Kernel, Relation};
use super::linear::Unsettled;
use super::problem::{ContactProblem, Errors};
use super::rank::{REGULAR, is_definite};
use super::slack::Scale;
use crate::law::{Law, Mode};
use crate::planar::Pair;
use crate::scalar::Ordered;
use dictionary::{Dictionary, LANES};
use nalgebra::{DMatrix, DVector};
use ranges::{Range, Ranges, Ray};
use std::cmp::Ordering;

/// The number of nogoods that are kept.
const NOGOODS: usize = 256;
/// The addition to the diagonal of a G that may be singular.
const DAMPING: f64 = 1e-9;

/// The relaxation of one problem in f64, free of units; its memory is reused.
#[derive(Debug, Clone, Default)]
pub struct Relaxation {
    rows: usize,
    laws: Vec<Law>,
    rays: Vec<Ray>,
    /// The scaled velocities by rows: their coefficients of the rays' multipliers, padding, and their free values.
    response: Vec<f64>,
    /// Errors of the entries of `response`: of the coefficients and of the values without impulses.
    errors: Pair<f64>,
    /// Whether `errors` are bounds.
    is_known: bool,
    /// Whether f64 shows that G is regular.
    pub is_regular: bool,
    /// An upper bound of the sum of all multipliers; infinite if none is known.
    reach: f64,
    /// For each contact, its variables as bits, and their ranges in each of its modes.
    by_contact: Vec<(u64, Vec<(Mode, Ranges)>)>,
    /// The dictionary after the decisions on the first contacts, by their number.
    depths: Vec<Dictionary>,
    multipliers: [Vec<f64>; 2],
    /// The nogoods of the claims that were shown: ranges that a nogood does not allow are impossible.
    nogoods: Vec<Ranges>,
    /// How many nogoods were found.
    shown: usize,
}

impl Relaxation {
    pub fn load(&mut self, problem: &ContactProblem, scale: &Scale, errors: Errors<'_>) {
        let rows = 2 * problem.contacts();
        self.rows = rows;
        problem.laws().clone_into(&mut self.laws);
        self.rays.clear();
        self.rays.extend(Ray::all(problem.laws()));
        let mobility = &scale.mobility;
        let scaled = |i: usize, j: usize| problem.delassus(i, j) / (mobility[i] * mobility[j]);
        // Scaled impulses along each ray; the magnitudes of their entries add up to one. Dividing by the greatest entry
        // first keeps products of a huge friction with mobilities finite.
        let along = |ray: &Ray| {
            let greatest = ray.entries[0].abs().max(ray.entries[1].abs());
            let [t, n] = [0, 1].map(|row| ray.entries[row] / greatest * mobility[2 * ray.contact + row]);
            [t, n].map(|entry| entry / (t.abs() + n.abs()))
        };
        let along: Vec<Pair<f64>> = self.rays.iter().map(along).collect();
        self.response.clear();
        let width = (self.rays.len() + 1).next_multiple_of(LANES);
        for (row, size) in mobility.iter().enumerate() {
            let by_ray = |(ray, [t, n]): (&Ray, &Pair<f64>)| {
                t * scaled(row, 2 * ray.contact) + n * scaled(row, 2 * ray.contact + 1)
            };
            self.response.extend(self.rays.iter().zip(&along).map(by_ray));
            self.response.resize((row + 1) * width - 1, 0.0);
            self.response.push(problem.free_row(row) / (size * scale.speed));
        }
        let largest = self.response.chunks_exact(width).map(|row| row[width - 1].abs()).fold(1.0, f64::max);
        let rounding = (rows + 24) as f64 * f64::EPSILON;
        let free = scale.free(problem, errors);
        let noise = (0..rows).map(|row| free(row).error / (mobility[row] * scale.speed)).fold(0.0, f64::max);
        self.errors = [errors.delassus + rounding, noise + rounding * largest];
        let matrix = DMatrix::from_fn(rows, rows, scaled);
        let up = DVector::from_fn(rows, |row, _| if row % 2 == 1 { 1.0 / mobility[row] } else { 0.0 });
        self.is_known = errors.delassus.is_finite() && scale.is_far_from_underflow();
        let is_bounded = self.is_known && problem.laws().iter().all(Law::is_dissipative);
        self.is_regular = false;
        self.reach = if is_bounded { self.bound(&matrix, &up.unscale(up.amax()), &along) } else { f64::INFINITY };
        self.depths.resize_with(problem.contacts() + 1, Dictionary::default);
        self.shown = 0;
        self.nogoods.clear();
        self.by_contact.clear();
        let mut ranges = Ranges::default();
        for (contact, law) in self.laws.iter().enumerate() {
            let in_mode = |mode: Option<Mode>| {
                let mut ranges = Ranges::default();
                let signs = mode.map_or([None; 2], |mode| law.velocity(mode));
                for (side, undecided) in [Range::FREE, Range::ABOVE].into_iter().enumerate() {
                    let row = 2 * contact + side;
                    ranges.set(row, signs[side].map_or(undecided, Range::of));
                    ranges.moves |= u64::from(signs[side].is_some_and(Ordering::is_ne)) << row;
                }
                for (index, ray) in self.rays.iter().enumerate().filter(|(_, ray)| ray.contact == contact) {
                    ranges.set(rows + index, ray.range(law, mode));
                }
                ranges
            };
            let undecided = in_mode(None);
            ranges = ranges.replaced(0, undecided);
            let modes = law.modes().iter().copied().flatten().map(|&mode| (mode, in_mode(Some(mode))));
            self.by_contact.push((undecided.above_zero | undecided.below_zero, modes.collect()));
        }
        let root = &mut self.depths[0];
        self.response.clone_into(&mut root.entries);
        (root.width, root.ranges) = (width, ranges);
        (root.basic, root.nonbasic) = ((0..rows).collect(), (rows..rows + self.rays.len()).collect());
        // Pivots that all modes have in common are done once.
        root.impossible();
    }

    /// An upper bound of the sum of all multipliers. It holds for impulses within the contact laws that do no positive
    /// work, L . xi <= 0. With p^2 = L G L, any z and rho = xi_free - G z:
    ///
    /// ```text
    ///     p^2 <= -L . xi_free <= p sqrt(z G z) + sum(lambda) |rho|
    ///     sum(lambda) <= p sqrt(w G w) / kappa   if w G ray >= kappa > 0 for all rays
    ///     sum(lambda) <= p sqrt(2n / least eigenvalue of G) / least normal entry of a ray
    /// ```
    ///
    /// w solves G w = u, where u is a velocity that lifts all contacts.
    fn bound(&mut self, matrix: &DMatrix<f64>, up: &DVector<f64>, along: &[Pair<f64>]) -> f64 {
        let rows = self.rows;
        let width = self.response.len() / rows;
        let [of_matrix, of_free] = self.errors;
        let size = |y: &DVector<f64>| {
            let l1 = y.lp_norm(1);
            ((y.dot(&(matrix * y))).max(0.0) + of_matrix * l1 * l1).sqrt()
        };
        let damped = matrix + DMatrix::identity(rows, rows) * DAMPING;
        let Some(factor) = damped.cholesky() else { return f64::INFINITY };
        let free = DVector::from_fn(rows, |row, _| self.response[(row + 1) * width - 1]);
        let (w, z) = (factor.solve(up), factor.solve(&free));
        let lifts = |column: usize| (0..rows).map(|row| w[row] * self.response[row * width + column]).sum::<f64>();
        let is_two_way = self.rays.iter().any(|ray| ray.both);
        let kappa = (0..self.rays.len()).map(lifts).fold(f64::INFINITY, f64::min) - w.lp_norm(1) * of_matrix;
        let by_lift = if kappa > 0.0 && !is_two_way { size(&w) / kappa } else { f64::INFINITY };
        // The normal part of a ray may be too small for f64.
        let pushing = self.rays.iter().zip(along).filter(|(ray, _)| ray.entries[1] != 0.0);
        let least = pushing.map(|(_, entries)| entries[1]).fold(1.0, f64::min);
        self.is_regular = is_definite(matrix.clone(), of_matrix);
        let is_bounded = self.is_regular && least.is_normal();
        let by_eigenvalue = if is_bounded { (2.0 * rows as f64 / REGULAR).sqrt() / least } else { f64::INFINITY };
        let per_root = by_lift.min(by_eigenvalue);
        let rest = (&free - matrix * &z).amax() + of_free + z.lp_norm(1) * of_matrix;
        per_root * (size(&z) + per_root * rest)
    }

    /// Decides the mode of a contact after all contacts before it; returns what f64 finds lacking.
    pub fn decide(&mut self, contact: usize, mode: Mode) -> Option<Lack> {
        let ranges = self.ranges(contact, mode);
        let (before, after) = self.depths.split_at_mut(contact + 1);
        let dictionary = &mut after[0];
        dictionary.copy(&before[contact]);
        for (row, sign) in [2 * contact, 2 * contact + 1].into_iter().zip(self.laws[contact].velocity(mode)) {
            if let Some(sign) = sign.filter(|sign| sign.is_ne()) {
                dictionary.keep_from_zero(row, sign);
            }
        }
        dictionary.ranges = ranges;
        dictionary.impossible()
    }

    /// The ranges of all variables if the contact has this mode, after the decisions on all contacts before it.
    fn ranges(&self, contact: usize, mode: Mode) -> Ranges {
        let (variables, modes) = &self.by_contact[contact];
        let ranges = modes.iter().find(|(other, _)| *other == mode).map_or_else(Ranges::default, |(_, ranges)| *ranges);
        self.depths[contact].ranges.replaced(*variables, ranges)
    }

    /// Whether a nogood excludes this mode of the contact after the decisions on all contacts before it.
    pub fn excludes(&mut self, contact: usize, mode: Mode) -> bool {
        self.has_shown(self.ranges(contact, mode))
    }

    fn has_shown(&mut self, ranges: Ranges) -> bool {
        let found = self.nogoods.iter().position(|nogood| !nogood.allows(ranges));
        // Moves a nogood that applies toward the front, where it is found sooner.
        found.inspect(|&index| self.nogoods.swap(index, index / 2)).is_some()
    }

    fn learn(&mut self, nogood: Ranges) {
        self.shown += 1;
        if self.nogoods.len() < NOGOODS {
            self.nogoods.push(nogood);
        } else {
            self.nogoods[self.shown % NOGOODS] = nogood;
        }
    }

    /// Adds what the kernel's relations exclude, as nogoods with y = z and y = -z.
    pub fn learn_from(&mut self, kernel: &Kernel) {
        for Relation { terms, constant } in &kernel.relations {
            for (constant, turned) in [(*constant, false), (constant.reverse(), true)] {
                let mut nogood = Ranges::default();
                for &(row, sign) in terms {
                    nogood.set(row, Range { above_zero: sign.is_lt() != turned, below_zero: sign.is_gt() != turned });
                    nogood.moves |= u64::from(constant.is_eq()) << row;
                }
                if constant.is_le() {
                    self.learn(nogood);
                }
            }
        }
    }

    /// Whether a claim holds in exact numbers, including the strictness of inequalities.
    pub fn confirms<T: Ordered>(&mut self, claim: &Claim, problem: &ContactProblem<T>) -> Result<bool, Unsettled> {
        let holds = self.has_shown(claim.ranges)
            || T::freeing(|| claim.shown(problem))?.map(|nogood| self.learn(nogood)).is_some();
        Ok(holds)
    }

    /// The claim of the last decision, which was on the last contact in `modes`.
    pub fn claim(&self, modes: &[Mode], lack: Lack) -> Claim {
        let Dictionary { basic, ranges, .. } = &self.depths[modes.len()];
        Claim { modes: modes.to_vec(), lack, basic: basic.clone(), ranges: *ranges }
    }

    /// Whether error bounds show that the last decision, which was on `contact`, is impossible.
    pub fn shows(&mut self, contact: usize, Lack { variable, sign }: Lack) -> bool {
        let Dictionary { entries, width, basic, nonbasic, ranges } = &self.depths[contact + 1];
        let width = *width;
        let Some(row) = basic.iter().position(|&other| other == variable).filter(|_| self.is_known) else {
            return false;
        };
        let [y, sums] = &mut self.multipliers;
        y.clear();
        y.resize(self.rows + self.rays.len(), 0.0);
        y[variable] = sign;
        for (&variable, &coefficient) in nonbasic.iter().zip(&entries[row * width..]) {
            y[variable] = -sign * coefficient;
        }
        let mut nogood = Ranges::default();
        let mut size = 0.0;
        // y . (response of the rays, xi_free). The rays' part is computed from the multipliers of the velocities alone.
        sums.clear();
        sums.resize(width, 0.0);
        for (row, (response, &factor)) in self.response.chunks_exact(width).zip(&*y).enumerate() {
            if factor != 0.0 && ranges.get(row).admits(factor.total_cmp(&0.0)) {
                nogood.set(row, Range { above_zero: factor < 0.0, below_zero: factor > 0.0 });
                size += factor.abs();
                sums.iter_mut().zip(response).for_each(|(sum, entry)| *sum += factor * entry);
            }
        }
        if sums.iter().any(|sum| !sum.is_finite()) {
            return false;
        }
        // The largest rate at which a ray's term can rise with its multiplier, within the multiplier's range.
        let wrong = |sum: f64, range: Range| {
            let above = if range.above_zero { sum } else { f64::NEG_INFINITY };
            above.max(if range.below_zero { -sum } else { f64::NEG_INFINITY })
        };
        let [of_matrix, of_free] = self.errors;
        let worst = (0..self.rays.len()).map(|ray| wrong(sums[ray], ranges.get(self.rows + ray)));
        let worst = worst.fold(-size * of_matrix, f64::max);
        let gain = worst + size * of_matrix;
        let gain = if gain > 0.0 { gain * self.reach } else { 0.0 };
        let is_shown = sums[width - 1] + (size * of_free + gain) * (1.0 + 1e-6) < 0.0;
        if is_shown {
            for (ray, &sum) in sums[..self.rays.len()].iter().enumerate() {
                nogood.set(self.rows + ray, Range { above_zero: sum > worst, below_zero: -sum > worst });
            }
            self.learn(nogood);
        }
        is_shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;
    use crate::scalar::{Ball, Certified, Real};

    /// One body of mass 1 on two points of the same height, left and right of its center; both strike the ground.
    fn struck(friction: Friction) -> ContactProblem {
        let rows = [[1.0, 0.0, 0.5], [0.0, 1.0, -1.0], [1.0, 0.0, 0.5], [0.0, 1.0, 1.0]];
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let delassus = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b)).collect::<Vec<_>>()).collect();
        ContactProblem::new(delassus, vec![[0.5, -1.0]; 2], vec![friction; 2], vec![0.0; 2]).unwrap()
    }

    fn loaded(problem: &ContactProblem) -> Relaxation {
        let (mut relaxation, mut scale) = (Relaxation::default(), Scale::default());
        scale.measure(problem, Errors::NONE);
        relaxation.load(problem, &scale, Errors::NONE);
        relaxation
    }

    /// `None` if f64 does not find these modes impossible; otherwise whether an error bound shows that they are, and
    /// whether exact numbers do.
    fn found(problem: &ContactProblem, modes: &[Mode]) -> Option<(bool, bool)> {
        let mut relaxation = loaded(problem);
        let lacks: Vec<Option<Lack>> =
            modes.iter().enumerate().map(|(contact, &mode)| relaxation.decide(contact, mode)).collect();
        let lack = lacks.last().copied().flatten()?;
        let claim = relaxation.claim(modes, lack);
        let exact = problem.map(Certified::<Ball>::from_f64);
        Some((relaxation.shows(modes.len() - 1, lack), claim.shown(&exact).unwrap().is_some()))
    }

    #[test]
    fn what_is_impossible_is_shown() {
        use Mode::{Separate, SlideMinus, SlidePlus, Stick};
        for (friction, modes, expected) in [
            // The body falls flat: an impulse at one point alone turns the other into the ground.
            (0.3, vec![Separate, Separate], Some((true, true))),
            (0.3, vec![Separate, Stick], Some((true, true))),
            (0.3, vec![SlideMinus], Some((true, true))),
            (0.3, vec![SlidePlus, SlidePlus], None),
            (0.8, vec![Stick, Stick], None),
            // Both points have the same tangential velocity, so only strictness excludes these, and no bound can show
            // it.
            (0.8, vec![Stick, SlidePlus], Some((false, true))),
            (0.8, vec![SlidePlus, Stick], Some((false, true))),
        ] {
            assert_eq!(found(&struck(Friction::Finite(friction)), &modes), expected, "{friction} {modes:?}");
        }
    }

    #[test]
    fn what_is_shown_once_excludes_what_lies_within() {
        use Mode::{Separate, SlidePlus, Stick};
        let problem = struck(Friction::Finite(0.3));
        let mut relaxation = loaded(&problem);
        relaxation.decide(0, SlidePlus);
        let lack = relaxation.decide(1, Separate).expect("the first point alone turns the second into the ground");
        assert!(!relaxation.excludes(1, Separate));
        assert!(relaxation.shows(1, lack));
        // A sticking point may pull back, which turns the second away from the ground.
        for (first, expected) in [(SlidePlus, true), (Separate, true), (Stick, false)] {
            relaxation.decide(0, first);
            let excluded = [Separate, Stick, SlidePlus].map(|second| relaxation.excludes(1, second));
            assert_eq!(excluded, [expected, false, false], "{first}");
        }
    }

    #[test]
    fn a_false_claim_is_seen_through() {
        // A claim about one problem is checked in another one, in which the first point may well slide backward.
        let problem = struck(Friction::Finite(0.3));
        let mut relaxation = loaded(&problem);
        let modes = [Mode::SlideMinus];
        let lack = relaxation.decide(0, modes[0]).expect("it slides the other way");
        let claim = relaxation.claim(&modes, lack);
        let backward = ContactProblem::new(
            (0..16).map(|entry| problem.delassus(entry / 4, entry % 4)).collect(),
            vec![[-0.5, -1.0]; 2],
            vec![Friction::Finite(0.3); 2],
            vec![0.0; 2],
        );
        let exact = backward.unwrap().map(Certified::<Ball>::from_f64);
        assert_eq!(claim.shown(&exact), Ok(None));
    }
}
