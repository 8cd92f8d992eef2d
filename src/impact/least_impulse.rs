//! The impulse of least norm among all admissible impulses.
//!
//! ```text
//!     min_y |L0 + D y|^2   with   f_i(y) = constant + coefficients . y >= 0
//! ```

use super::linear::{LinearFunction, Unsettled, settled, solve};
use crate::scalar::{Ordered, dot};
use std::cmp::Ordering;

/// Returns the y that minimizes |L0 + D y| where no function is negative. The `directions` are the columns of D and
/// linearly independent. The method is a primal active-set method (Nocedal and Wright 2006, section 16.5) that starts
/// at y = 0, where no function may be negative.
pub fn least_impulse<T: Ordered>(
    origin: &[T],
    directions: &[Vec<T>],
    functions: &[LinearFunction<T>],
) -> Result<Vec<T>, Unsettled> {
    let mut y = vec![T::zero(); directions.len()];
    let mut binding: Vec<usize> = Vec::new();
    // Each round binds a function or releases one. The rule of the lowest index prevents cycles at a degenerate corner.
    for _ in 0..ROUNDS * (functions.len() + 1) {
        let (target, multipliers) = least_on_face(origin, directions, functions, &binding)?;
        let step: Vec<T> = target.iter().zip(&y).map(|(&to, &from)| to - from).collect();
        if let Some((blocking, share)) = first_reached(functions, &binding, &y, &step)? {
            for (entry, &change) in y.iter_mut().zip(&step) {
                *entry = *entry + share * change;
            }
            binding.push(blocking);
            continue;
        }
        y = target;
        let mut pulling: Option<usize> = None;
        for (place, &multiplier) in multipliers.iter().enumerate() {
            if settled(multiplier)?.is_lt() && pulling.is_none_or(|other| binding[place] < binding[other]) {
                pulling = Some(place);
            }
        }
        match pulling {
            Some(place) => drop(binding.swap_remove(place)),
            None => return Ok(y),
        }
    }
    Err(Unsettled)
}

const ROUNDS: usize = 8;

/// Returns the y that minimizes |L0 + D y| where the `binding` functions are zero, and the multiplier of each of them.
fn least_on_face<T: Ordered>(
    origin: &[T],
    directions: &[Vec<T>],
    functions: &[LinearFunction<T>],
    binding: &[usize],
) -> Result<(Vec<T>, Vec<T>), Unsettled> {
    let free = directions.len();
    // D'D y - A' m = -D' L0,  A y = -constants: A has the binding functions' coefficients, m the multipliers.
    let mut equations: Vec<Vec<T>> = Vec::with_capacity(free + binding.len());
    for (index, direction) in directions.iter().enumerate() {
        let mut equation: Vec<T> = directions.iter().map(|other| dot(direction, other)).collect();
        equation.extend(binding.iter().map(|&function| -functions[function].coefficients[index]));
        equation.push(-dot(direction, origin));
        equations.push(equation);
    }
    for &function in binding {
        let mut equation = functions[function].coefficients.clone();
        equation.resize(free + binding.len(), T::zero());
        equation.push(-functions[function].constant);
        equations.push(equation);
    }
    let found = solve(free + binding.len(), equations)?.ok_or(Unsettled)?;
    let multipliers = found.origin[free..].to_vec();
    Ok((found.origin[..free].to_vec(), multipliers))
}

/// The first function to reach zero along `step`, and the fraction of the step there; `None` if none does.
fn first_reached<T: Ordered>(
    functions: &[LinearFunction<T>],
    binding: &[usize],
    y: &[T],
    step: &[T],
) -> Result<Option<(usize, T)>, Unsettled> {
    let mut first: Option<(usize, T)> = None;
    for (index, function) in functions.iter().enumerate().filter(|(index, _)| !binding.contains(index)) {
        let slope = function.change(step);
        if settled(slope)?.is_ge() {
            continue;
        }
        let share = function.at(y) / -slope;
        let limit = first.map_or(T::one(), |(_, share)| share);
        if settled(share - limit)? == Ordering::Less {
            first = Some((index, share));
        }
    }
    Ok(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::linear::tests::{Number, affine, numbers};

    fn least(origin: &[f64], directions: &[&[f64]], functions: &[LinearFunction<Number>]) -> Vec<f64> {
        let directions: Vec<Vec<Number>> = directions.iter().map(|direction| numbers(direction)).collect();
        least_impulse(&numbers(origin), &directions, functions).unwrap().iter().map(|entry| entry.to_f64()).collect()
    }

    #[test]
    fn the_least_impulse_lies_on_the_face_that_binds() {
        // L = (1 - y, y); the free optimum is y = 1/2.
        assert_eq!(least(&[1.0, 0.0], &[&[-1.0, 1.0]], &[affine(0.25, &[-1.0])]), [0.25]);
        assert_eq!(least(&[1.0, 0.0], &[&[-1.0, 1.0]], &[affine(0.75, &[-1.0])]), [0.5]);
        assert_eq!(least(&[1.0, 0.0], &[&[-1.0, 1.0]], &[]), [0.5]);
    }

    #[test]
    fn a_function_that_binds_on_the_way_is_let_go_again() {
        // L = (y1, y2) + (-2, -1) is shortest at (2, 1). y2 >= y1 - 1/2 binds on the way, only y1 <= 5/4 at the end.
        let functions = [affine(0.5, &[-1.0, 1.0]), affine(1.25, &[-1.0, 0.0])];
        assert_eq!(least(&[-2.0, -1.0], &[&[1.0, 0.0], &[0.0, 1.0]], &functions), [1.25, 1.0]);
    }

    #[test]
    fn a_degenerate_corner_is_left() {
        // Three functions vanish at the start; the optimum (1, 0) lies along one of them.
        let functions = [affine(0.0, &[0.0, 1.0]), affine(0.0, &[1.0, 1.0]), affine(0.0, &[1.0, 0.0])];
        assert_eq!(least(&[-1.0, 1.0], &[&[1.0, 0.0], &[0.0, 1.0]], &functions), [1.0, 0.0]);
    }
}
