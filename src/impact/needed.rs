//! The friction that sticking contacts need if their impulses are not unique.
//!
//! ```text
//!     contacts that depend on each other, with the same friction:  min over the admissible impulses of max |L_t| / L_n
//!         if their sums are unique and they can exchange L_t:      = |sum L_t| / sum L_n, for example for a flat foot
//!     all other contacts:                                          min |L_t| / L_n, each for itself
//! ```
//!
//! The minimum of one ratio is a linear program in w = s y with s = 1 / L_n (Charnes and Cooper 1962). Whether a given
//! friction is enough for several contacts is a linear program as well.

use super::digits::least_friction;
use super::linear::{LinearFunction, Unsettled, settled, solve};
use super::simplex::{join, maximize, widest};
use crate::law::{Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, Real, Sign};
use std::cmp::Ordering;

/// The relative error of the least friction of several contacts: a tenth of the promised one.
const KNOWN: f64 = 1e-11;
/// If this friction does not hold the contacts, infinite friction is taken to be necessary.
const GREATEST: f64 = 1e24;
/// The cap of slacks in linear programs.
const ENOUGH: f64 = 1e3;

/// Returns the friction |L_t| / L_n that each sticking contact needs; `None` if no admissible impulse presses it on the
/// ground. Contacts that depend on each other are left out if all their `shortest` impulses are zero. The impulses are
/// functions of y, admissible where no `functions` are negative; at y = 0 none is.
pub fn friction_needed<T: Ordered>(
    modes: &[Mode],
    laws: &[Law],
    shortest: &[Pair<T>],
    impulses: &[Pair<LinearFunction<T>>],
    functions: &[LinearFunction<T>],
) -> Result<Vec<Option<T>>, Unsettled> {
    let groups = groups(impulses)?;
    let (mut needed, mut common) = (vec![None; modes.len()], vec![None; modes.len()]);
    for contact in (0..modes.len()).filter(|&contact| modes[contact] == Mode::Stick) {
        let members = || (0..modes.len()).filter(|&i| groups[i] == groups[contact] && modes[i] == Mode::Stick);
        if members().all(|i| shortest[i].iter().all(|entry| entry.sign() == Sign::Zero)) {
            continue;
        }
        let [t, n] = [0, 1].map(|entry| sum(members().map(|i| &impulses[i][entry])));
        let are_alike = members().all(|i| laws[i] == laws[contact]);
        if are_alike && t.is_constant()? && n.is_constant()? && exchange(members(), impulses)? {
            if settled(n.constant)?.is_gt() {
                let size = if settled(t.constant)?.is_lt() { -t.constant } else { t.constant };
                needed[contact] = Some(size / n.constant);
            }
            continue;
        }
        needed[contact] = least_ratio(&impulses[contact], functions)?;
        if are_alike && members().count() > 1 {
            if members().next() == Some(contact) {
                common[groups[contact]] = least_common(members().map(|i| &impulses[i]), &laws[contact], functions)?;
            }
            needed[contact] = needed[contact].map(|alone| common[groups[contact]].unwrap_or(alone));
        }
    }
    Ok(needed)
}

/// Whether each of the contacts can take over tangential impulse from the first while nothing else changes.
fn exchange<T: Ordered>(
    mut members: impl Iterator<Item = usize>,
    impulses: &[Pair<LinearFunction<T>>],
) -> Result<bool, Unsettled> {
    let Some(first) = members.next() else { return Ok(true) };
    let directions = impulses[first][0].coefficients.len();
    for other in members {
        // Contacts known to share a tangential row have a direction of their own for the exchange: its entries are
        // exactly zero except in the tangential rows of both.
        let is_one = |direction: usize| {
            impulses.as_flattened().iter().enumerate().all(|(row, entry)| {
                let is_zero = entry.coefficients[direction].sign() == Sign::Zero;
                is_zero != (row == 2 * first || row == 2 * other)
            })
        };
        if (0..directions).any(is_one) {
            continue;
        }
        let equation = |(row, entry): (usize, &LinearFunction<T>)| {
            let given = |place: usize| if row == 2 * place { T::one() } else { T::zero() };
            [&entry.coefficients[..], &[given(first) - given(other)]].concat()
        };
        let rows = impulses.as_flattened().iter().enumerate().map(equation).collect();
        if solve(directions, rows)?.is_none() {
            return Ok(false);
        }
    }
    Ok(true)
}

/// The least friction with which some admissible impulses hold all of these contacts; `None` if only infinite friction
/// does. `law` is the law of each of them. The secant method and bisection enclose the result.
fn least_common<'a, T: Ordered + 'a>(
    members: impl Iterator<Item = &'a Pair<LinearFunction<T>>> + Clone,
    law: &Law,
    functions: &[LinearFunction<T>],
) -> Result<Option<T>, Unsettled> {
    let dimension = functions.first().map_or(0, |function| function.coefficients.len());
    // The largest possible smallest slack with this friction; it is shown to be negative if the friction is not enough.
    let room = |friction: f64| {
        let edge = |side: f64| {
            move |[t, n]: &'a Pair<LinearFunction<T>>| t.with(n, |t, n| n.scaled(friction) + t.scaled(side))
        };
        T::freeing(|| -> Result<f64, Unsettled> {
            let edges = members.clone().map(edge(1.0)).chain(members.clone().map(edge(-1.0)));
            let all: Vec<LinearFunction<T>> = functions.iter().cloned().chain(edges).collect();
            let (_, least) = widest(&all, dimension, T::from_f64(ENOUGH))?;
            let size = least.to_f64().abs().max(f64::MIN_POSITIVE);
            Ok(match settled(least)? {
                Ordering::Less => -size,
                Ordering::Equal => 0.0,
                Ordering::Greater => size,
            })
        })
    };
    let (mut low, mut at_low) = (0.0, room(0.0)?);
    if at_low >= 0.0 {
        return Ok(Some(T::zero()));
    }
    let most = law.friction().limit(GREATEST);
    let mut high = most.min(1.0);
    let mut at_high = room(high)?;
    while at_high < 0.0 {
        if high >= most {
            return Ok(None);
        }
        (low, at_low, high) = (high, at_high, most.min(4.0 * high));
        at_high = room(high)?;
    }
    let between = |low: f64, high: f64, [at_low, at_high]: [f64; 2]| low + (high - low) * (at_low / (at_low - at_high));
    for turn in 1.. {
        let known = KNOWN * f64::max(high, least_friction(law));
        if high - low <= known {
            break;
        }
        let by_halves = turn % 3 == 0 || at_high == 0.0;
        let zero = if by_halves { 0.5 * (low + high) } else { between(low, high, [at_low, at_high]) };
        // The estimate is moved slightly past the zero, away from the nearer end, so that both ends converge.
        let aside = if zero - low < high - zero { 0.4 * known } else { -0.4 * known };
        let friction = (zero + aside).clamp(low + 0.4 * known, high - 0.4 * known);
        match room(friction)? {
            value if value < 0.0 => (low, at_low) = (friction, value),
            value => (high, at_high) = (friction, value),
        }
    }
    // A friction that falls toward zero as impulses grow without bound counts as zero.
    let least = if low > 0.0 { between(low, high, [at_low, at_high]) } else { 0.0 };
    Ok(Some(T::from_f64(least)))
}

/// The group of each contact: contacts whose impulses change together along some direction of y.
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
        // n may be unbounded, so its value is limited to one here.
        let limit = LinearFunction { constant: -T::one(), ..n.clone() }.opposite();
        let bounded: Vec<LinearFunction<T>> = functions.iter().cloned().chain([limit]).collect();
        start = maximize(&bounded, &n.coefficients)?.ok_or(Unsettled)?;
    }
    let pressed = n.at(&start);
    if settled(pressed)?.is_le() {
        return Ok(None);
    }
    // s = (1 - n . w) / pressed; this is n = 1 in the new variables.
    let in_ratios = |function: &LinearFunction<T>| {
        let share = function.at(&start) / pressed;
        let slopes = function.coefficients.iter().zip(&n.coefficients);
        LinearFunction { constant: share, coefficients: slopes.map(|(&slope, &of_n)| slope - share * of_n).collect() }
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
    functions.fold(first, |sum, next| sum.with(next, T::add))
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
        let shortest = [[Number::one(); 2]; 2];
        let needed = friction_needed(&[Mode::Stick; 2], &laws, &shortest, &impulses, &functions).unwrap();
        [0, 1].map(|contact: usize| needed[contact].map(Ordered::to_f64))
    }

    #[test]
    fn flat_foot_needs_the_ratio_of_its_sums() {
        // Together the contacts have 3 along the ground and 4 normal to it, of which the toe bears 1.
        let impulses = [[affine(0.5, &[1.0]), affine(1.0, &[0.0])], [affine(2.5, &[-1.0]), affine(3.0, &[0.0])]];
        assert_eq!(needed([1.0, 1.0], impulses.clone()), [Some(0.75); 2]);
        // With different frictions, each contact needs what the other cannot take over: nothing, and 3 - 2 * 1 = 1.
        assert_eq!(needed([2.0, 1.0], impulses.clone()), [Some(0.0), Some(1.0 / 3.0)]);
    }

    #[test]
    fn contacts_that_jam_need_more_than_their_ratio() {
        // The sums are 1.5 and 2, but directions that shift tangential impulse shift normal impulse, too. At a = -y the
        // frictions (1.5 + a) / (1 + a) and a / (1 - a) are the same.
        let impulses = [[affine(0.0, &[1.0]), affine(1.0, &[1.0])], [affine(1.5, &[-1.0]), affine(1.0, &[-1.0])]];
        let a = (14.25_f64.sqrt() - 1.5) / 4.0;
        let expected = a / (1.0 - a);
        for friction in [5.0, 1e216] {
            for needed in needed([friction; 2], impulses.clone()) {
                let off = needed.expect("pressed") - expected;
                assert!(off.abs() < 2e-11, "{off}");
            }
        }
        // With different frictions each contact is judged alone: at y = 0 the first needs none.
        assert_eq!(needed([5.0, 4.0], impulses)[0], Some(0.0));
    }

    #[test]
    fn least_ratio_is_sought_where_the_load_is_shared() {
        // L = (1, 1 + y) and (1, 1 - y): the cone of each contact limits how much load the other can bear.
        let impulses = [[affine(1.0, &[0.0]), affine(1.0, &[1.0])], [affine(1.0, &[0.0]), affine(1.0, &[-1.0])]];
        assert_eq!(needed([2.0, 2.5], impulses), [Some(1.0 / 1.6), Some(1.0 / 1.5)]);
        // No y presses the first contact on the ground.
        let impulses = [[affine(0.0, &[0.0]), affine(0.0, &[0.0])], [affine(1.0, &[1.0]), affine(1.0, &[0.0])]];
        assert_eq!(needed([1.0, 2.0], impulses), [None, Some(0.0)]);
    }
}
