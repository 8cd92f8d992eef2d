//! The friction that sticking contacts need if their impulses are not unique.
//!
//! ```text
//!     contacts of equal friction that share impulses whose sums are unique:  |sum L_t| / sum L_n      as of a flat foot
//!     all others:                                                            min |L_t| / L_n over the admissible impulses
//! ```
//!
//! The minimum is a linear program in w = s y with s = 1 / L_n (Charnes and Cooper 1962).

use super::linear::{LinearFunction, Unsettled, settled};
use super::simplex::{join, maximize};
use crate::law::{Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, Real};

/// |L_t| / L_n of each sticking contact that some admissible impulse presses on the ground. The impulses are functions of
/// y, admissible where no function is negative, as none is at y = 0.
pub fn friction_needed<T: Ordered>(
    modes: &[Mode],
    laws: &[Law],
    impulses: &[Pair<LinearFunction<T>>],
    functions: &[LinearFunction<T>],
) -> Result<Vec<Option<T>>, Unsettled> {
    let groups = groups(impulses)?;
    let mut needed = vec![None; modes.len()];
    for contact in (0..modes.len()).filter(|&contact| modes[contact] == Mode::Stick) {
        let members = || (0..modes.len()).filter(|&own| groups[own] == groups[contact] && modes[own] == Mode::Stick);
        let [t, n] = [0, 1].map(|entry| sum(members().map(|own| &impulses[own][entry])));
        let are_alike = members().all(|own| laws[own] == laws[contact]);
        needed[contact] = if are_alike && t.is_constant()? && n.is_constant()? {
            let is_pressed = settled(n.constant)?.is_gt();
            if is_pressed { Some(magnitude(t.constant)? / n.constant) } else { None }
        } else {
            least_ratio(&impulses[contact], functions)?
        };
    }
    Ok(needed)
}

/// The group of each contact: contacts whose impulses some direction of y changes together.
fn groups<T: Ordered>(impulses: &[Pair<LinearFunction<T>>]) -> Result<Vec<usize>, Unsettled> {
    let mut groups: Vec<usize> = (0..impulses.len()).collect();
    for direction in 0..impulses.first().map_or(0, |pair| pair[0].coefficients.len()) {
        let mut changed = Vec::new();
        for (contact, pair) in impulses.iter().enumerate() {
            let [t, n] = pair.each_ref().map(|entry| settled(entry.coefficients[direction]));
            if t?.is_ne() || n?.is_ne() {
                changed.push(contact);
            }
        }
        join(&mut groups, changed.into_iter());
    }
    Ok(groups)
}

/// The least |t| / n where no function is negative; `None` if n is positive nowhere.
fn least_ratio<T: Ordered>(
    [t, n]: &Pair<LinearFunction<T>>,
    functions: &[LinearFunction<T>],
) -> Result<Option<T>, Unsettled> {
    let mut start = vec![T::zero(); n.coefficients.len()];
    if settled(n.constant)?.is_le() {
        // As n may grow without bound, it grows by one at most.
        let limit = LinearFunction { constant: -T::one(), ..n.clone() }.opposite();
        let bounded: Vec<LinearFunction<T>> = functions.iter().cloned().chain([limit]).collect();
        start = maximize(&bounded, &n.coefficients)?.ok_or(Unsettled)?;
    }
    let pressed = n.at(&start);
    if settled(pressed)?.is_le() {
        return Ok(None);
    }
    // s = (1 - n . w) / pressed, with n = 1 throughout.
    let in_ratios = |function: &LinearFunction<T>| {
        let share = function.at(&start) / pressed;
        let slopes = function.coefficients.iter().zip(&n.coefficients);
        LinearFunction { constant: share, coefficients: slopes.map(|(&own, &slope)| own - share * slope).collect() }
    };
    let mut bounds: Vec<LinearFunction<T>> = functions.iter().map(in_ratios).collect();
    bounds.push(LinearFunction {
        constant: T::one() / pressed,
        coefficients: n.coefficients.iter().map(|&slope| -slope / pressed).collect(),
    });
    let ratio = in_ratios(t);
    let size = if settled(ratio.constant)?.is_lt() { ratio.opposite() } else { ratio };
    let down = size.clone().opposite().coefficients;
    bounds.push(size.clone());
    let best = maximize(&bounds, &down)?.ok_or(Unsettled)?;
    Ok(Some(size.at(&best)))
}

fn sum<'a, T: Real + 'a>(mut functions: impl Iterator<Item = &'a LinearFunction<T>>) -> LinearFunction<T> {
    let first = functions.next().cloned().unwrap_or(LinearFunction { constant: T::zero(), coefficients: Vec::new() });
    functions.fold(first, |sum, next| LinearFunction {
        constant: sum.constant + next.constant,
        coefficients: sum.coefficients.iter().zip(&next.coefficients).map(|(&a, &b)| a + b).collect(),
    })
}

fn magnitude<T: Ordered>(number: T) -> Result<T, Unsettled> {
    Ok(if settled(number)?.is_lt() { -number } else { number })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::linear::tests::{Number, affine};
    use crate::law::Friction;

    fn needed(frictions: [f64; 2], impulses: [Pair<LinearFunction<Number>>; 2]) -> [Option<f64>; 2] {
        let laws = frictions.map(|mu| Law::from(Friction::Finite(mu)));
        let functions: Vec<LinearFunction<Number>> = impulses
            .iter()
            .zip(frictions)
            .flat_map(|([t, n], mu)| {
                let cone = |side: f64| {
                    let slopes = n.coefficients.iter().zip(&t.coefficients);
                    let slope = |(n, t): (&Number, &Number)| mu * n.to_f64() + side * t.to_f64();
                    affine(
                        mu * n.constant.to_f64() + side * t.constant.to_f64(),
                        &slopes.map(slope).collect::<Vec<_>>(),
                    )
                };
                [cone(1.0), cone(-1.0), n.clone()]
            })
            .collect();
        let needed = friction_needed(&[Mode::Stick; 2], &laws, &impulses, &functions).unwrap();
        [0, 1].map(|contact: usize| needed[contact].map(Ordered::to_f64))
    }

    #[test]
    fn flat_foot_needs_the_ratio_of_its_sums() {
        // Together 3 along the ground and 4 down, of which the toe bears 1.
        let impulses = [[affine(0.5, &[1.0]), affine(1.0, &[0.0])], [affine(2.5, &[-1.0]), affine(3.0, &[0.0])]];
        assert_eq!(needed([1.0, 1.0], impulses.clone()), [Some(0.75); 2]);
        // With different frictions each contact needs what the other cannot take over: 3 - 2 * 1, and nothing.
        assert_eq!(needed([2.0, 1.0], impulses.clone()), [Some(0.0), Some(1.0 / 3.0)]);
    }

    #[test]
    fn least_ratio_is_sought_where_the_load_is_shared() {
        // L = (1, 1 + y) and (1, 1 - y): neither contact can press with more than its share at the edge of both cones.
        let impulses = [[affine(1.0, &[0.0]), affine(1.0, &[1.0])], [affine(1.0, &[0.0]), affine(1.0, &[-1.0])]];
        assert_eq!(needed([2.0, 2.5], impulses), [Some(1.0 / 1.6), Some(1.0 / 1.5)]);
        // Nothing presses the first, whatever y is.
        let impulses = [[affine(0.0, &[0.0]), affine(0.0, &[0.0])], [affine(1.0, &[1.0]), affine(1.0, &[0.0])]];
        assert_eq!(needed([1.0, 2.0], impulses), [None, Some(0.0)]);
    }
}
