//! Which lists of modes no impulses can have, many lists at a time.
//!
//! ```text
//!     any mode    xi_n >= 0    L in the cone of all modes
//!     closed      xi_n  = 0    L in that cone
//!     one mode    as it says, with >= in place of >
//! ```
//!
//! A linear program shows whether impulses exist for such choices; if not, none of the lists of modes among them is an
//! outcome.

use super::linear::{LinearFunction, Unsettled, extended, settled, solve, widest};
use super::problem::ContactProblem;
use crate::law::{Impulse, Mode};
use crate::planar::Pair;
use crate::scalar::Ordered;
use std::cmp::Ordering;

/// The modes that are left for a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Choice {
    Any,
    Closed,
    One(Mode),
}

/// Whether impulses exist for the choices of all contacts.
pub fn is_possible<T: Ordered>(problem: &ContactProblem<T>, choices: &[Choice]) -> Result<bool, Unsettled> {
    // L is a sum of rays, each with its contact and whether it goes both ways.
    let mut rays: Vec<(usize, Pair<f64>, bool)> = Vec::new();
    let mut velocities: Vec<(usize, Ordering)> = Vec::new();
    for (contact, (&choice, law)) in choices.iter().zip(problem.laws()).enumerate() {
        let normal = 2 * contact + 1;
        let mode = match choice {
            Choice::Any => Mode::Separate,
            Choice::Closed => Mode::Stick,
            Choice::One(mode) => mode,
        };
        match law.impulse(mode) {
            Impulse::Zero if matches!(choice, Choice::One(_)) => {}
            Impulse::Along(ray) => rays.push((contact, ray, false)),
            Impulse::Zero | Impulse::Free => {
                rays.extend(law.rays().into_iter().map(|(ray, both)| (contact, ray, both)));
            }
        }
        match choice {
            Choice::Any => velocities.push((normal, Ordering::Greater)),
            Choice::Closed => velocities.push((normal, Ordering::Equal)),
            Choice::One(mode) => {
                let rows = [normal - 1, normal].into_iter().zip(law.velocity(mode));
                velocities.extend(rows.filter_map(|(row, sign)| Some((row, sign?))));
            }
        }
    }
    let along = |row: usize| -> Vec<T> {
        let entry = |&(contact, ray, _): &(usize, Pair<f64>, bool)| {
            let [t, n] = ray.map(T::from_f64);
            t * problem.delassus(row, 2 * contact) + n * problem.delassus(row, 2 * contact + 1)
        };
        rays.iter().map(entry).collect()
    };
    let zero = velocities.iter().filter(|(_, sign)| sign.is_eq());
    let equations = zero.map(|&(row, _)| extended(&along(row), -problem.free_row(row))).collect();
    let Some(solutions) = solve(rays.len(), equations)? else { return Ok(false) };
    let one_way = rays.iter().enumerate().filter(|(_, (_, _, both))| !both);
    let pushing = one_way.map(|(at, _)| LinearFunction {
        constant: solutions.origin[at],
        coefficients: solutions.directions.iter().map(|direction| direction[at]).collect(),
    });
    let moving = velocities.iter().filter(|(_, sign)| sign.is_ne()).map(|&(row, sign)| {
        let function = solutions.affine(problem.free_row(row), &along(row));
        if sign.is_gt() { function } else { function.opposite() }
    });
    let functions: Vec<LinearFunction<T>> = pushing.chain(moving).collect();
    let (_, least) = widest(&functions, solutions.directions.len(), T::zero())?;
    Ok(settled(least)?.is_ge())
}
