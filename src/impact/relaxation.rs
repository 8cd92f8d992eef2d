//! Whether any impulses lead to the modes of some contacts, whatever the others do: a linear relaxation.
//!
//! ```text
//!     undecided contact   xi_n >= 0                       L in the cone of all modes
//!     decided contact     the signs of its velocity       L zero, on its ray or in that cone
//! ```
//!
//! Velocities are affine in the multipliers of the rays. The dual simplex method pivots in f64 until every variable is
//! in its range, or until one cannot get there (Chvatal, *Linear Programming*, 1983, chapters 3 and 10). Its row then
//! claims that nothing leads there: with the multipliers y of the velocities and sigma of the rays (Farkas)
//!
//! ```text
//!     y . xi + sigma . lambda = y . xi_free < 0,   sigma = -y G rays,   though no term may be negative
//! ```
//!
//! Nothing that f64 has done is trusted: a [`Claim`] is shown to hold by an error bound ([`Relaxation::shows`]), or in
//! numbers that know their signs ([`Claim::holds`]).

use super::linear::{Unsettled, extended, settled, solve};
use super::problem::{ContactProblem, Errors};
use super::slack::Scale;
use crate::law::{Impulse, Law, Mode};
use crate::planar::Pair;
use crate::scalar::Ordered;
use nalgebra::{DMatrix, DVector};
use std::cmp::Ordering;

/// Scaled numbers nearer to zero count as zero where f64 chooses its way.
const TOLERANCE: f64 = 1e-9;
/// What strict inequalities keep from zero where f64 chooses its way.
const STRICT: f64 = 1e-7;
/// More pivots per row than this show nothing.
const PIVOTS: usize = 6;
/// What is added to the diagonal of a G that may be singular.
const DAMPING: f64 = 1e-9;
/// The least eigenvalue of a scaled G that counts as regular.
const REGULAR: f64 = 1e-6;

/// The values that a variable may take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Range {
    above_zero: bool,
    below_zero: bool,
}

impl Range {
    const FREE: Self = Self { above_zero: true, below_zero: true };
    const ABOVE: Self = Self { above_zero: true, below_zero: false };
    const BELOW: Self = Self { above_zero: false, below_zero: true };
    const ZERO: Self = Self { above_zero: false, below_zero: false };

    fn of(sign: Ordering) -> Self {
        match sign {
            Ordering::Greater => Self::ABOVE,
            Ordering::Equal => Self::ZERO,
            Ordering::Less => Self::BELOW,
        }
    }

    /// Whether a multiple of the variable, by a factor of this sign, is nowhere negative.
    fn admits(self, factor: Ordering) -> bool {
        match factor {
            Ordering::Greater => !self.below_zero,
            Ordering::Equal => true,
            Ordering::Less => !self.above_zero,
        }
    }
}

/// One ray of a contact's cone; its multiplier is a variable.
#[derive(Debug, Clone, Copy)]
struct Ray {
    contact: usize,
    entries: Pair<f64>,
    /// Whether its opposite is in the cone, too.
    both: bool,
}

impl Ray {
    fn all(laws: &[Law]) -> impl Iterator<Item = Self> {
        laws.iter().enumerate().flat_map(|(contact, law)| {
            law.rays().into_iter().map(move |(entries, both)| Self { contact, entries, both })
        })
    }

    /// The range of its multiplier if its contact has this mode, or any.
    fn range(&self, law: &Law, mode: Option<Mode>) -> Range {
        let own = if self.both { Range::FREE } else { Range::ABOVE };
        match mode.map(|mode| law.impulse(mode)) {
            None | Some(Impulse::Free) => own,
            Some(Impulse::Zero) => Range::ZERO,
            Some(Impulse::Along([t, n])) if t * self.entries[1] == n * self.entries[0] => {
                let forward = t * self.entries[0] + n * self.entries[1] > 0.0;
                if forward {
                    Range::ABOVE
                } else if self.both {
                    Range::BELOW
                } else {
                    Range::ZERO
                }
            }
            Some(Impulse::Along(_)) => Range::ZERO,
        }
    }
}

/// Basic variables as affine functions of the others. Variables below 2n are velocities, the others multipliers of
/// rays.
#[derive(Debug, Clone, Default)]
struct Dictionary {
    /// By rows: per basic variable its coefficients of the nonbasic ones, then its value.
    entries: Vec<f64>,
    basic: Vec<usize>,
    nonbasic: Vec<usize>,
    ranges: Vec<Range>,
}

/// A variable that cannot get into its range, and the sign of what it lacks.
#[derive(Debug, Clone, Copy)]
pub struct Lack {
    variable: usize,
    sign: f64,
}

/// That nothing leads to these modes of the first contacts, and the dictionary whose row says so.
#[derive(Debug, Clone)]
pub struct Claim {
    pub modes: Vec<Mode>,
    lack: Lack,
    basic: Vec<usize>,
    ranges: Vec<Range>,
}

/// The relaxation of one problem in f64, free of units; memory that is reused.
#[derive(Debug, Clone, Default)]
pub struct Relaxation {
    rows: usize,
    laws: Vec<Law>,
    rays: Vec<Ray>,
    /// Scaled velocities by the rays' multipliers, then without impulses: row by row.
    response: Vec<f64>,
    /// What their entries may be off by.
    errors: Pair<f64>,
    /// Whether these errors are bounds.
    is_known: bool,
    /// Whether f64 shows that G is regular.
    pub is_regular: bool,
    /// A bound of the sum of all multipliers; infinite if there is none.
    reach: f64,
    /// After the decisions on the first contacts.
    depths: Vec<Dictionary>,
    multipliers: [Vec<f64>; 2],
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
        // Scaled impulses along each ray; their entries' sizes add up to one. Friction may be so great that its products
        // with mobilities are not.
        let along: Vec<Pair<f64>> = self
            .rays
            .iter()
            .map(|ray| {
                let greatest = ray.entries[0].abs().max(ray.entries[1].abs());
                let [t, n] = [0, 1].map(|row| ray.entries[row] / greatest * mobility[2 * ray.contact + row]);
                [t, n].map(|entry| entry / (t.abs() + n.abs()))
            })
            .collect();
        self.response.clear();
        for (row, own) in mobility.iter().enumerate() {
            let by_rays = self
                .rays
                .iter()
                .zip(&along)
                .map(|(ray, [t, n])| t * scaled(row, 2 * ray.contact) + n * scaled(row, 2 * ray.contact + 1));
            self.response.extend(by_rays.chain([problem.free_row(row) / (own * scale.speed)]));
        }
        let width = self.rays.len() + 1;
        let largest = self.response.chunks_exact(width).map(|row| row[width - 1].abs()).fold(1.0, f64::max);
        let rounding = (rows + 24) as f64 * f64::EPSILON;
        self.errors = [errors.delassus + rounding, scale.noise + rounding * largest];
        let matrix = DMatrix::from_fn(rows, rows, scaled);
        let up = DVector::from_fn(rows, |row, _| if row % 2 == 1 { 1.0 / mobility[row] } else { 0.0 });
        self.is_known = errors.delassus.is_finite() && scale.is_far_from_underflow();
        let is_bounded = self.is_known && problem.laws().iter().all(Law::is_dissipative);
        self.is_regular = false;
        self.reach = if is_bounded { self.bound(&matrix, &up.unscale(up.amax()), &along) } else { f64::INFINITY };
        self.depths.resize_with(problem.contacts() + 1, Dictionary::default);
        let multipliers = self.rays.iter().map(|ray| ray.range(&self.laws[ray.contact], None));
        let velocities = (0..rows).map(|row| if row % 2 == 1 { Range::ABOVE } else { Range::FREE });
        self.depths[0] = Dictionary {
            entries: self.response.clone(),
            basic: (0..rows).collect(),
            nonbasic: (rows..rows + self.rays.len()).collect(),
            ranges: velocities.chain(multipliers).collect(),
        };
    }

    /// A bound of the sum of all multipliers of impulses that a contact law may give, which do no positive work: L . xi
    /// <= 0. With p^2 = L G L, any z and rho = xi_free - G z:
    ///
    /// ```text
    ///     p^2 <= -L . xi_free <= p sqrt(z G z) + sum(lambda) |rho|
    ///     sum(lambda) <= p sqrt(w G w) / kappa   if w G ray >= kappa > 0 for all rays
    ///     sum(lambda) <= p sqrt(2n / least eigenvalue of G) / least normal entry of a ray
    /// ```
    ///
    /// The first w is a motion that lifts all contacts.
    fn bound(&mut self, matrix: &DMatrix<f64>, up: &DVector<f64>, along: &[Pair<f64>]) -> f64 {
        let rows = self.rows;
        let width = self.rays.len() + 1;
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
        let least = along.iter().filter(|entries| entries[1] != 0.0).map(|entries| entries[1]).fold(1.0, f64::min);
        // A Cholesky factor exists only if rounding hides no negative eigenvalue (Rump 2006).
        self.is_regular = (matrix - DMatrix::identity(rows, rows) * REGULAR).cholesky().is_some()
            && rows as f64 * (of_matrix + rows as f64 * f64::EPSILON) < 0.5 * REGULAR;
        let by_eigenvalue = if self.is_regular { (2.0 * rows as f64 / REGULAR).sqrt() / least } else { f64::INFINITY };
        let per_root = by_lift.min(by_eigenvalue);
        let rest = (&free - matrix * &z).amax() + of_free + z.lp_norm(1) * of_matrix;
        per_root * (size(&z) + per_root * rest)
    }

    /// Decides the mode of a contact after all before it; what lacks if that is impossible in f64.
    pub fn decide(&mut self, contact: usize, mode: Mode) -> Option<Lack> {
        let (before, after) = self.depths.split_at_mut(contact + 1);
        let dictionary = &mut after[0];
        dictionary.copy(&before[contact]);
        for (row, sign) in [2 * contact, 2 * contact + 1].into_iter().zip(self.laws[contact].velocity(mode)) {
            if let Some(sign) = sign {
                dictionary.ranges[row] = Range::of(sign);
                if sign.is_ne() {
                    dictionary.keep_from_zero(row, sign);
                }
            }
        }
        for (index, ray) in self.rays.iter().enumerate().filter(|(_, ray)| ray.contact == contact) {
            dictionary.ranges[self.rows + index] = ray.range(&self.laws[contact], Some(mode));
        }
        dictionary.impossible()
    }

    /// What the last decision, the one of the last of these contacts, claims.
    pub fn claim(&self, modes: &[Mode], lack: Lack) -> Claim {
        let Dictionary { basic, ranges, .. } = &self.depths[modes.len()];
        Claim { modes: modes.to_vec(), lack, basic: basic.clone(), ranges: ranges.clone() }
    }

    /// Whether error bounds show that the last decision, on `contact`, is impossible.
    pub fn shows(&mut self, contact: usize, Lack { variable, sign }: Lack) -> bool {
        let Dictionary { entries, basic, nonbasic, ranges } = &self.depths[contact + 1];
        let width = self.rays.len() + 1;
        let Some(row) = basic.iter().position(|&other| other == variable).filter(|_| self.is_known) else {
            return false;
        };
        let [y, sums] = &mut self.multipliers;
        y.clear();
        y.resize(ranges.len(), 0.0);
        y[variable] = sign;
        for (&variable, &coefficient) in nonbasic.iter().zip(&entries[row * width..]) {
            y[variable] = -sign * coefficient;
        }
        let mut size = 0.0;
        // y . (response of the rays, xi_free); what it says of the rays is computed from the velocities' alone.
        sums.clear();
        sums.resize(width, 0.0);
        for (row, response) in self.response.chunks_exact(width).enumerate() {
            let range = ranges[row];
            let factor = if range.admits(y[row].total_cmp(&0.0)) { y[row] } else { 0.0 };
            if factor != 0.0 {
                size += factor.abs();
                sums.iter_mut().zip(response).for_each(|(sum, entry)| *sum += factor * entry);
            }
        }
        if sums.iter().any(|sum| !sum.is_finite()) {
            return false;
        }
        let wrong = |(sum, range): (&f64, &Range)| match range {
            Range { above_zero: true, below_zero: false } => *sum,
            Range { above_zero: false, below_zero: true } => -*sum,
            Range { above_zero: true, below_zero: true } => sum.abs(),
            _ => f64::NEG_INFINITY,
        };
        let [of_matrix, of_free] = self.errors;
        let worst = sums.iter().zip(&ranges[self.rows..]).map(wrong).fold(f64::NEG_INFINITY, f64::max);
        let gain = (worst + size * of_matrix).max(0.0);
        let gain = if gain > 0.0 { gain * self.reach } else { 0.0 };
        sums[width - 1] + (size * of_free + gain) * (1.0 + 1e-6) < 0.0
    }
}

impl Dictionary {
    fn copy(&mut self, other: &Self) {
        self.entries.clone_from(&other.entries);
        self.basic.clone_from(&other.basic);
        self.nonbasic.clone_from(&other.nonbasic);
        self.ranges.clone_from(&other.ranges);
    }

    /// Counts a velocity from where it is strictly positive or negative.
    fn keep_from_zero(&mut self, variable: usize, sign: Ordering) {
        let from = f64::from(sign as i8) * STRICT;
        let width = self.nonbasic.len() + 1;
        if let Some(row) = self.basic.iter().position(|&basic| basic == variable) {
            self.entries[(row + 1) * width - 1] -= from;
        } else if let Some(column) = self.nonbasic.iter().position(|&nonbasic| nonbasic == variable) {
            for row in self.entries.chunks_exact_mut(width) {
                row[width - 1] += row[column] * from;
            }
        }
    }

    /// Brings all variables into their ranges, or finds one that cannot get there.
    fn impossible(&mut self) -> Option<Lack> {
        let width = self.nonbasic.len() + 1;
        for _ in 0..PIVOTS * self.basic.len() {
            let (mut most, mut worst) = (TOLERANCE, None);
            for (row, (&variable, entries)) in self.basic.iter().zip(self.entries.chunks_exact(width)).enumerate() {
                let (value, range) = (entries[width - 1], self.ranges[variable]);
                let sign = if value < 0.0 && !range.below_zero {
                    1.0
                } else if value > 0.0 && !range.above_zero {
                    -1.0
                } else {
                    continue;
                };
                if value.abs() > most {
                    (most, worst) = (value.abs(), Some((row, sign)));
                }
            }
            let (row, sign) = worst?;
            let (mut most, mut entering) = (TOLERANCE, None);
            let coefficients = &self.entries[row * width..][..width - 1];
            for (column, (&variable, &coefficient)) in self.nonbasic.iter().zip(coefficients).enumerate() {
                let (slope, range) = (sign * coefficient, self.ranges[variable]);
                let moves = if slope > 0.0 { range.above_zero } else { range.below_zero };
                if moves && slope.abs() > most {
                    (most, entering) = (slope.abs(), Some(column));
                }
            }
            match entering {
                Some(column) => self.pivot(row, column),
                None => return Some(Lack { variable: self.basic[row], sign }),
            }
        }
        None
    }

    fn pivot(&mut self, row: usize, column: usize) {
        let width = self.nonbasic.len() + 1;
        let (before, rest) = self.entries.split_at_mut(row * width);
        let (own, after) = rest.split_at_mut(width);
        let inverse = 1.0 / own[column];
        own.iter_mut().for_each(|entry| *entry *= -inverse);
        own[column] = inverse;
        for other in before.chunks_exact_mut(width).chain(after.chunks_exact_mut(width)) {
            let factor = std::mem::take(&mut other[column]);
            other.iter_mut().zip(&*own).for_each(|(entry, own)| *entry += factor * own);
        }
        std::mem::swap(&mut self.basic[row], &mut self.nonbasic[column]);
    }
}

impl Claim {
    /// Whether the claim holds in exact numbers, the strictness of inequalities included.
    pub fn holds<T: Ordered>(&self, problem: &ContactProblem<T>) -> Result<bool, Unsettled> {
        let rows = 2 * problem.contacts();
        let rays: Vec<Ray> = Ray::all(problem.laws()).collect();
        let response = |row: usize, ray: &Ray| {
            let [t, n] = ray.entries.map(T::from_f64);
            t * problem.delassus(row, 2 * ray.contact) + n * problem.delassus(row, 2 * ray.contact + 1)
        };
        let (own, sign) = (self.lack.variable, T::from_f64(self.lack.sign));
        // The multipliers y of velocities outside the basis make those of the rays inside it zero.
        let unknown: Vec<usize> = (0..rows).filter(|row| !self.basic.contains(row)).collect();
        let equations = self.basic.iter().filter(|&&variable| variable >= rows).map(|&variable| {
            let ray = &rays[variable - rows];
            let coefficients: Vec<T> = unknown.iter().map(|&row| response(row, ray)).collect();
            let right = match own {
                row if row < rows => sign * response(row, ray),
                _ if own == variable => sign,
                _ => T::zero(),
            };
            extended(&coefficients, -right)
        });
        let Some(found) = solve(unknown.len(), equations.collect())? else { return Ok(false) };
        let mut factors: Vec<(usize, T)> = unknown.into_iter().zip(found.origin).collect();
        factors.extend((own < rows).then_some((own, sign)));
        let mut is_strict = false;
        for &(row, factor) in &factors {
            let factor = settled(factor)?;
            if !self.ranges[row].admits(factor) {
                return Ok(false);
            }
            let contact = row / 2;
            let moves = self.modes.get(contact).and_then(|&mode| problem.laws()[contact].velocity(mode)[row % 2]);
            is_strict |= factor.is_ne() && moves.is_some_and(Ordering::is_ne);
        }
        for (index, ray) in rays.iter().enumerate() {
            let range = self.ranges[rows + index];
            if range == Range::ZERO || self.basic.contains(&(rows + index)) {
                continue;
            }
            let sum = factors.iter().fold(T::zero(), |sum, &(row, factor)| sum - factor * response(row, ray));
            if !range.admits(settled(sum)?) {
                return Ok(false);
            }
        }
        let total = factors.iter().fold(T::zero(), |sum, &(row, factor)| sum + factor * problem.free_row(row));
        Ok(match settled(total)? {
            Ordering::Less => true,
            Ordering::Equal => is_strict,
            Ordering::Greater => false,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;
    use crate::scalar::{Ball, Certified, Real};

    /// One body of mass 1 on two points, one above the other's line: both strike.
    fn struck(friction: Friction) -> ContactProblem {
        let rows = [[1.0, 0.0, 0.5], [0.0, 1.0, -1.0], [1.0, 0.0, 0.5], [0.0, 1.0, 1.0]];
        let dot = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let delassus = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b)).collect::<Vec<_>>()).collect();
        ContactProblem::new(delassus, vec![[0.5, -1.0]; 2], vec![friction; 2], vec![0.0; 2]).unwrap()
    }

    /// Whether f64 finds these beginnings impossible, whether it shows so, and whether exact numbers do.
    fn found(problem: &ContactProblem, modes: &[Mode]) -> Option<(bool, bool)> {
        let (mut relaxation, mut scale) = (Relaxation::default(), Scale::default());
        scale.measure(problem, Errors::NONE);
        relaxation.load(problem, &scale, Errors::NONE);
        let lacks: Vec<Option<Lack>> =
            modes.iter().enumerate().map(|(contact, &mode)| relaxation.decide(contact, mode)).collect();
        let lack = lacks.last().copied().flatten()?;
        let claim = relaxation.claim(modes, lack);
        let exact = problem.map(Certified::<Ball>::from_f64);
        Some((relaxation.shows(modes.len() - 1, lack), claim.holds(&exact).unwrap()))
    }

    #[test]
    fn what_is_impossible_is_shown() {
        use Mode::{Separate, SlideMinus, SlidePlus, Stick};
        for (friction, modes, expected) in [
            // The body falls flat: one point alone turns the other into the ground.
            (0.3, vec![Separate, Separate], Some((true, true))),
            (0.3, vec![Separate, Stick], Some((true, true))),
            (0.3, vec![SlideMinus], Some((true, true))),
            (0.3, vec![SlidePlus, SlidePlus], None),
            (0.8, vec![Stick, Stick], None),
            // Both points move along the ground alike, so that only strictness speaks against these: no bound shows it.
            (0.8, vec![Stick, SlidePlus], Some((false, true))),
            (0.8, vec![SlidePlus, Stick], Some((false, true))),
        ] {
            assert_eq!(found(&struck(Friction::Finite(friction)), &modes), expected, "{friction} {modes:?}");
        }
    }

    #[test]
    fn a_false_claim_is_seen_through() {
        // A claim about another problem, in which the first point may well leave.
        let problem = struck(Friction::Finite(0.3));
        let (mut relaxation, mut scale) = (Relaxation::default(), Scale::default());
        scale.measure(&problem, Errors::NONE);
        relaxation.load(&problem, &scale, Errors::NONE);
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
        assert_eq!(claim.holds(&exact), Ok(false));
    }
}
