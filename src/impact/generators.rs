//! The impulses that a combination of modes allows, as linear combinations of a few generators.
//!
//! ```text
//!     L = B lambda      a column of B: a contact's ray, or an axis (t or n) of a contact whose impulse is free
//! ```

use super::problem::ContactProblem;
use crate::law::{Impulse, Law, Mode};
use crate::planar::Pair;
use crate::scalar::Real;

/// The generators of a combination: L = sum of lambda_j times generator j; each belongs to one contact.
pub struct Generators {
    rows: usize,
    /// The contact of each generator and its entries [tangential, normal].
    rays: Vec<(usize, Pair<f64>)>,
}

impl Generators {
    pub fn of(modes: &[Mode], laws: &[Law]) -> Self {
        let mut rays = Vec::new();
        for (contact, (&mode, law)) in modes.iter().zip(laws).enumerate() {
            match law.impulse(mode) {
                Impulse::Zero => {}
                Impulse::Along(ray) => rays.push((contact, ray)),
                Impulse::Free => rays.extend([(contact, [1.0, 0.0]), (contact, [0.0, 1.0])]),
            }
        }
        Self { rows: 2 * modes.len(), rays }
    }

    pub fn count(&self) -> usize {
        self.rays.len()
    }

    /// A row of G B: the coefficients of lambda in the velocity of `row`.
    pub fn velocity_row<T: Real>(&self, problem: &ContactProblem<T>, row: usize) -> Vec<T> {
        let term = |column: usize, factor: f64| match factor {
            0.0 => None,
            1.0 => Some(problem.delassus(row, column)),
            factor => Some(T::from_f64(factor) * problem.delassus(row, column)),
        };
        let entry =
            |&(contact, ray): &(usize, Pair<f64>)| match (term(2 * contact, ray[0]), term(2 * contact + 1, ray[1])) {
                (Some(t), Some(n)) => t + n,
                (one, other) => one.or(other).unwrap_or(T::zero()),
            };
        self.rays.iter().map(entry).collect()
    }

    /// The index in lambda of a contact's number `which` (0 or 1). The inequalities of impulses are functions of these
    /// two numbers; for a contact with a ray both are its lambda.
    pub fn place(&self, contact: usize, which: usize) -> usize {
        let first = self.rays.iter().take_while(|(other, _)| *other < contact).count();
        let free = self.rays.get(first + 1).is_some_and(|(other, _)| *other == contact);
        first + usize::from(free && which == 1)
    }

    /// The impulse of every row \[N s\], from lambda.
    pub fn impulse<T: Real>(&self, lambda: &[T]) -> Vec<T> {
        let mut impulse = vec![T::zero(); self.rows];
        for (&(contact, ray), &factor) in self.rays.iter().zip(lambda) {
            for (row, part) in [2 * contact, 2 * contact + 1].into_iter().zip(ray) {
                // A product with 1 would add rounding.
                if part != 0.0 {
                    impulse[row] = impulse[row] + if part == 1.0 { factor } else { factor.scaled(part) };
                }
            }
        }
        impulse
    }
}
