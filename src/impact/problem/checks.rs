//! Checks of the input of a contact problem, however it was built.

use super::ContactProblem;
use crate::error::{Error, Reason, Result, finite};
use crate::law::Friction;

/// The most contacts for which matrices are formed, whether or not their outcomes are computed.
pub const MATRIX_LIMIT: usize = 500;

/// Returns an error if there are more contacts than [`MATRIX_LIMIT`].
pub(crate) fn check_matrix_size(contacts: usize) -> Result<()> {
    if contacts <= MATRIX_LIMIT {
        return Ok(());
    }
    let reason = Reason::MatricesTooLarge { contacts, limit: MATRIX_LIMIT };
    Err(Error::new(reason).hint("leave out the contacts that matter least"))
}

/// Bounds of the diagonal entries of G: beyond them, products of two entries would underflow or overflow \[1/kg\].
const SMALLEST_MOBILITY: f64 = 1e-120;
const LARGEST_MOBILITY: f64 = 1e120;
/// The largest |c| / sqrt(G_ii): the square of a larger one, an energy, comes near overflow \[sqrt J\].
const LARGEST_SPEED: f64 = 1e145;

fn out_of_range(what: String, allowed: &'static str, value: f64) -> Error {
    Error::new(Reason::OutOfRange { what, allowed, value })
}

impl ContactProblem {
    /// Checks that products of two entries of G stay far from overflow and underflow.
    pub(super) fn check_range(&self) -> Result<()> {
        let rows = 2 * self.contacts();
        for row in 0..rows {
            let diagonal = finite(self.delassus(row, row), || format!("delassus[{row}][{row}]"))?;
            if diagonal > 0.0 && !(SMALLEST_MOBILITY..LARGEST_MOBILITY).contains(&diagonal) {
                let error =
                    out_of_range(format!("delassus[{row}][{row}]"), "0 or between 1e-120 and 1e120 1/kg", diagonal);
                return Err(error.hint("choose units of mass and length nearer to the robot's own"));
            }
            let (before, free) = (self.velocity_before[row / 2][row % 2], self.velocity_free[row / 2][row % 2]);
            let speed = before.abs().max(free.abs()) / if diagonal > 0.0 { diagonal.sqrt() } else { 1.0 };
            if speed > LARGEST_SPEED {
                let what = format!("velocity_before of contact {}", row / 2);
                return Err(out_of_range(what, "small enough for its energy to be a number", before)
                    .hint("choose units of length and time nearer to the robot's own"));
            }
        }
        Ok(())
    }

    pub(super) fn check_contacts(&self) -> Result<()> {
        for (contact, velocity) in self.velocity_before.iter().enumerate() {
            for &entry in velocity {
                finite(entry, || format!("velocity_before of contact {contact}"))?;
            }
            for entry in self.velocity_free[contact] {
                finite(entry, || format!("the velocity of contact {contact} after the applied impulses"))?;
            }
            if let Friction::Finite(mu) = self.laws[contact].friction()
                && !(mu.is_finite() && mu >= 0.0)
            {
                return Err(out_of_range("friction".into(), "zero, positive or \"infinite\"", mu)
                    .at(format!("friction of contact {contact}")));
            }
            let restitution = self.restitution[contact];
            if !(0.0..=1.0).contains(&restitution) {
                return Err(out_of_range("restitution".into(), "between 0 and 1", restitution)
                    .at(format!("restitution of contact {contact}")));
            }
        }
        Ok(())
    }

    /// Checks the symmetry of G entry by entry, then its definiteness by elimination with diagonal pivoting. The
    /// tolerance of an entry is a multiple of n eps times the geometric mean of its two diagonal entries, so that units
    /// and mass ratios do not matter. Returns true if G is positive definite beyond doubt.
    pub(super) fn check_definite(&self) -> Result<bool> {
        let rows = 2 * self.contacts();
        let rounding = 4.0 * rows as f64 * f64::EPSILON;
        let sizes: Vec<f64> = (0..rows).map(|i| self.delassus(i, i).max(0.0).sqrt()).collect();
        let mut symmetric = true;
        for i in 0..rows {
            for j in 0..i {
                let (lower, upper) = (self.delassus(i, j), self.delassus(j, i));
                symmetric &= lower == upper;
                if (lower - upper).abs() > rounding * sizes[i] * sizes[j] {
                    let reason = format!("the Delassus matrix is not symmetric: {lower} against {upper}");
                    return Err(Error::new(Reason::Inconsistent(reason))
                        .at(format!("delassus[{i}][{j}]"))
                        .hint("G = J M^-1 J^T is symmetric; check the order of rows and columns"));
                }
            }
        }
        // A row without mobility must be zero, so its entries are not scaled.
        let scale = |i: usize| if sizes[i] > 0.0 { sizes[i] } else { 1.0 };
        let mut rest = nalgebra::DMatrix::from_fn(rows, rows, |i, j| self.delassus(i, j) / scale(i) / scale(j));
        let mut beyond_doubt = 0;
        for _ in 0..rows {
            let Some(pivot) = (0..rows).max_by(|&i, &j| rest[(i, i)].total_cmp(&rest[(j, j)])) else { break };
            let allowed = |i: usize, j: usize| if sizes[i] * sizes[j] > 0.0 { rounding } else { 0.0 };
            let indefinite = (0..rows).find(|&i| rest[(i, i)] < -allowed(i, i)).map(|i| (i, i));
            let stray = || {
                let mut coupled = (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j)));
                coupled.find(|&(i, j)| rest[(pivot, pivot)] <= rounding && rest[(i, j)].abs() > 4.0 * allowed(i, j))
            };
            if let Some(place) = indefinite.or_else(stray) {
                let (i, j) = self.offending(&sizes, rounding).unwrap_or(place);
                let reason = "the Delassus matrix is indefinite: an impulse there would gain energy";
                return Err(Error::new(Reason::Inconsistent(reason.into()))
                    .at(format!("delassus[{i}][{j}]"))
                    .hint("G = J M^-1 J^T is positive semidefinite; check signs and units"));
            }
            let diagonal = rest[(pivot, pivot)];
            if diagonal <= rounding {
                break;
            }
            // The elimination adds about as much rounding again.
            beyond_doubt += usize::from(symmetric && diagonal > 16.0 * rounding);
            let column = rest.column(pivot).clone_owned();
            for i in 0..rows {
                for j in 0..rows {
                    rest[(i, j)] -= column[i] * column[j] / diagonal;
                }
            }
        }
        Ok(beyond_doubt == rows)
    }

    /// The entry that alone makes an indefinite G so: a negative diagonal entry, or else the entry that exceeds the
    /// geometric mean of its two diagonal entries by the most. `None` if no single entry does.
    fn offending(&self, sizes: &[f64], rounding: f64) -> Option<(usize, usize)> {
        let rows = 2 * self.contacts();
        // Infinite for a nonzero entry with a diagonal entry that is not positive; NaN for a zero entry there.
        let excess = |(i, j): (usize, usize)| {
            let entry = if i == j { -self.delassus(i, i) } else { self.delassus(i, j).abs() };
            entry / sizes[i] / sizes[j] - 1.0
        };
        let diagonal = (0..rows).map(|i| (i, i));
        let below = (0..rows).flat_map(|i| (0..i).map(move |j| (i, j)));
        let worst = |places: &mut dyn Iterator<Item = (usize, usize)>| {
            let places = places.filter(|&place| excess(place) > rounding);
            places.max_by(|&a, &b| excess(a).total_cmp(&excess(b)))
        };
        worst(&mut diagonal.into_iter()).or_else(|| worst(&mut below.into_iter()))
    }
}
