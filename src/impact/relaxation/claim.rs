//! Checks claims of f64 in numbers with error bounds.

use super::dictionary::Lack;
use super::ranges::{Range, Ranges, Ray};
use crate::impact::linear::{Unsettled, extended, settled, solve};
use crate::impact::problem::ContactProblem;
use crate::law::Mode;
use crate::scalar::Ordered;
use std::cmp::Ordering;

/// The claim that no impulses lead to these modes of the first contacts, with the dictionary whose row states it.
#[derive(Debug, Clone)]
pub struct Claim {
    pub modes: Vec<Mode>,
    pub lack: Lack,
    pub basic: Vec<usize>,
    pub ranges: Ranges,
}

impl Claim {
    /// Returns the claim's nogood; `None` if the claim does not hold in exact numbers, strictness included.
    pub fn shown<T: Ordered>(&self, problem: &ContactProblem<T>) -> Result<Option<Ranges>, Unsettled> {
        let rows = 2 * problem.contacts();
        let rays: Vec<Ray> = Ray::all(problem.laws()).collect();
        let response = |row: usize, ray: &Ray| {
            let [t, n] = ray.entries.map(T::from_f64);
            t * problem.delassus(row, 2 * ray.contact) + n * problem.delassus(row, 2 * ray.contact + 1)
        };
        let (lacking, sign) = (self.lack.variable, T::from_f64(self.lack.sign));
        // The multipliers y of nonbasic velocities are chosen so that the multipliers of basic rays are zero.
        let unknown: Vec<usize> = (0..rows).filter(|row| !self.basic.contains(row)).collect();
        let equations = self.basic.iter().filter(|&&variable| variable >= rows).map(|&variable| {
            let ray = &rays[variable - rows];
            let coefficients: Vec<T> = unknown.iter().map(|&row| response(row, ray)).collect();
            let right = match lacking {
                row if row < rows => sign * response(row, ray),
                _ if lacking == variable => sign,
                _ => T::zero(),
            };
            extended(&coefficients, -right)
        });
        let Some(found) = solve(unknown.len(), equations.collect())? else { return Ok(None) };
        let mut factors: Vec<(usize, T)> = unknown.into_iter().zip(found.origin).collect();
        factors.extend((lacking < rows).then_some((lacking, sign)));
        let mut nogood = Ranges::default();
        for &(row, factor) in &factors {
            let factor = settled(factor)?;
            if !self.ranges.get(row).admits(factor) {
                return Ok(None);
            }
            nogood.set(row, Range { above_zero: factor.is_lt(), below_zero: factor.is_gt() });
            nogood.moves |= u64::from(factor.is_ne()) << row;
        }
        for (index, ray) in rays.iter().enumerate() {
            if rows + index != lacking && self.basic.contains(&(rows + index)) {
                continue;
            }
            let range = self.ranges.get(rows + index);
            if range == Range::ZERO {
                nogood.set(rows + index, Range::FREE);
                continue;
            }
            let sum = factors.iter().fold(T::zero(), |sum, &(row, factor)| sum - factor * response(row, ray));
            let sum = settled(sum)?;
            if !range.admits(sum) {
                return Ok(None);
            }
            nogood.set(rows + index, Range { above_zero: sum.is_lt(), below_zero: sum.is_gt() });
        }
        let total = factors.iter().fold(T::zero(), |sum, &(row, factor)| sum + factor * problem.free_row(row));
        Ok(match settled(total)? {
            Ordering::Less => Some(Ranges { moves: 0, ..nogood }),
            Ordering::Equal if nogood.moves & self.ranges.moves != 0 => Some(nogood),
            Ordering::Equal | Ordering::Greater => None,
        })
    }
}
