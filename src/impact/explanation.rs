//! Explains what each contact does (paper, section 4), for infinite friction and restitution 0.
//!
//! ```text
//!     M_c c+ = L + X      M_c: the contact's block of G^-1,   X: its rows of G^-1 c_free
//!     beta  = atan(M_nt / M_tt)       angle of the impulse that causes a purely tangential velocity change
//!     gamma = atan2(X_n, X_t)         angle of the reversed impulse that would stop the contact
//! ```
//!
//! All other contacts stick.

use super::outcome::{Explanation, ImpulseRegion};
use super::problem::ContactProblem;
use super::slack::Scale;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// X counts as zero if it is smaller than this part of the sum of the magnitudes of its terms.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// beta and gamma \[rad\] and the region of each contact; `None` if the Delassus matrix is singular.
pub fn explanation(problem: &ContactProblem, scale: &Scale) -> Option<Explanation> {
    let rows = 2 * problem.contacts();
    let mobility = &scale.mobility;
    // Scaling to a unit diagonal makes the factorization independent of units.
    let scaled = DMatrix::from_fn(rows, rows, |i, j| problem.delassus(i, j) / (mobility[i] * mobility[j]));
    let cholesky = scaled.cholesky()?;
    let free = DVector::from_fn(rows, |i, _| problem.velocity_free()[i / 2][i % 2] / mobility[i]);
    let taken = cholesky.solve(&free);
    let inverse = cholesky.inverse();
    let mut explanation = Explanation { beta: Vec::new(), gamma: Vec::new(), region: Vec::new() };
    for contact in 0..problem.contacts() {
        let (t, n) = (2 * contact, 2 * contact + 1);
        let mass_tt = inverse[(t, t)] / (mobility[t] * mobility[t]);
        let mass_nt = inverse[(n, t)] / (mobility[n] * mobility[t]);
        let beta = libm::atan(mass_nt / mass_tt);
        let [x_t, x_n] = [t, n].map(|row| {
            let size: f64 = (0..rows).map(|other| (inverse[(row, other)] * free[other]).abs()).sum();
            // -0 + 0 is +0.
            if taken[row].abs() <= ROUNDINGS * size { 0.0 } else { taken[row] / mobility[row] + 0.0 }
        });
        let gamma = libm::atan2(x_n, x_t);
        explanation.beta.push(beta);
        explanation.gamma.push(gamma);
        explanation.region.push(region(beta, gamma));
    }
    Some(explanation)
}

/// The region in the paper's figure 10, which is drawn for beta < 0; beta > 0 is its mirror image.
fn region(beta: f64, gamma: f64) -> ImpulseRegion {
    let (beta, gamma) = if beta <= 0.0 { (beta, gamma) } else { (-beta, mirrored(gamma)) };
    if beta < gamma && gamma < 0.0 {
        ImpulseRegion::E
    } else if 0.0 < gamma && gamma < PI + beta {
        ImpulseRegion::A
    } else if PI + beta < gamma && gamma < PI {
        ImpulseRegion::B
    } else {
        ImpulseRegion::C
    }
}

/// The angle of the vector with its tangential part reversed, in -pi..pi \[rad\].
pub(crate) fn mirrored(gamma: f64) -> f64 {
    if gamma >= 0.0 { PI - gamma } else { -PI - gamma }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::Errors;
    use crate::law::Friction;

    #[test]
    fn the_paper_s_body_has_its_regions() {
        // m = 1, CoG at (-1, 1), j = 1.
        let beta = (-0.5_f64).atan();
        for (gamma, region) in [
            (beta / 2.0, ImpulseRegion::E),
            (beta - 0.1, ImpulseRegion::C),
            (1.0, ImpulseRegion::A),
            (PI + beta - 0.01, ImpulseRegion::A),
            (PI + beta + 0.01, ImpulseRegion::B),
            (-PI + 0.1, ImpulseRegion::C),
        ] {
            // c = G X.
            let before = [2.0 * gamma.cos() + gamma.sin(), gamma.cos() + 2.0 * gamma.sin()];
            let delassus = vec![2.0, 1.0, 1.0, 2.0];
            let problem = ContactProblem::new(delassus, vec![before], vec![Friction::Infinite], vec![0.0]).unwrap();
            let mut scale = Scale::default();
            scale.measure(&problem, Errors::NONE);
            let found = explanation(&problem, &scale).unwrap();
            assert_eq!(found.region, [region], "gamma {gamma}");
            // A few roundings of numbers of order one.
            assert!((found.beta[0] - beta).abs() < 1e-14 && (found.gamma[0] - gamma).abs() < 1e-14);
        }
    }

    #[test]
    fn rounding_has_no_direction() {
        // c = G X with X = 0 at the first contact; products with G are rounded.
        let delassus: [[f64; 4]; 4] =
            [[1.7, 0.3, 0.4, -0.1], [0.3, 1.1, 0.2, 0.7], [0.4, 0.2, 1.3, 0.6], [-0.1, 0.7, 0.6, 1.9]];
        for step in 0..50 {
            let x = [0.0, 0.0, f64::from(step).sin(), f64::from(step).cos()];
            let row = |row: usize| delassus[row].iter().zip(x).map(|(entry, x)| entry * x).sum::<f64>();
            let before = vec![[row(0), row(1)], [row(2), row(3)]];
            let problem =
                ContactProblem::new(delassus.concat(), before, vec![Friction::Infinite; 2], vec![0.0; 2]).unwrap();
            let mut scale = Scale::default();
            scale.measure(&problem, Errors::NONE);
            let found = explanation(&problem, &scale).unwrap();
            assert_eq!((found.gamma[0], found.region[0]), (0.0, ImpulseRegion::C), "{x:?}");
        }
    }
}
