//! The least impulse among those that free impulses leave.
//!
//! ```text
//!     min_y |L0 + D y|^2   with   slack_i(y) = constant + coefficients . y >= 0
//! ```

use super::basis::{dot, solve};
use super::linear::Affine;

/// The y that makes |L0 + D y| least among those with no negative slack; `directions` are the columns of D, and `inside`
/// is a y with no negative slack to begin at.
///
/// A primal active-set method (Nocedal and Wright 2006, section 16.5): few slacks, an answer exact to rounding.
pub fn least_impulse(origin: &[f64], directions: &[Vec<f64>], slacks: &[Affine<f64>], inside: &[f64]) -> Vec<f64> {
    let mut y = inside.to_vec();
    let mut binding: Vec<usize> = Vec::new();
    // Each round adds or drops one slack; rounding could make it turn in circles on a degenerate corner.
    for _ in 0..8 * (slacks.len() + 1) {
        let target = shortest_on_face(origin, directions, slacks, &binding);
        let step: Vec<f64> = target.iter().zip(&y).map(|(to, from)| to - from).collect();
        let reach = |&index: &usize| {
            let slope = dot(&slacks[index].coefficients, &step);
            let room = slacks[index].at(&y).max(0.0);
            (slope < 0.0 && room + slope < -ADMISSIBLE).then(|| (index, room / -slope))
        };
        let open = (0..slacks.len()).filter(|index| !binding.contains(index));
        match open.filter_map(|index| reach(&index)).min_by(|a, b| a.1.total_cmp(&b.1)) {
            Some((blocking, part)) => {
                for (entry, change) in y.iter_mut().zip(&step) {
                    *entry += part.min(1.0) * change;
                }
                binding.push(blocking);
            }
            None => {
                y = target;
                match pulling(origin, directions, slacks, &binding, &y) {
                    Some(place) => drop(binding.swap_remove(place)),
                    None => break,
                }
            }
        }
    }
    y
}

/// The binding slack that keeps L from growing shorter the most: the one with the most negative multiplier.
fn pulling(
    origin: &[f64],
    directions: &[Vec<f64>],
    slacks: &[Affine<f64>],
    binding: &[usize],
    y: &[f64],
) -> Option<usize> {
    let at: Vec<f64> = origin.iter().zip(combination(directions, y, origin.len())).map(|(a, b)| a + b).collect();
    let gradient: Vec<f64> = directions.iter().map(|direction| dot(direction, &at)).collect();
    // gradient = sum of multiplier * coefficients, one equation per entry of y.
    let equations: Vec<Vec<f64>> =
        (0..y.len()).map(|entry| binding.iter().map(|&index| slacks[index].coefficients[entry]).collect()).collect();
    let rows: Vec<&[f64]> = equations.iter().map(Vec::as_slice).collect();
    let (multipliers, _, _) = solve(binding.len(), &rows, &gradient);
    let size = dot(&gradient, &gradient).sqrt() + dot(&at, &at).sqrt();
    let least = (0..binding.len()).min_by(|&i, &j| multipliers[i].total_cmp(&multipliers[j]))?;
    (multipliers[least] < -ADMISSIBLE * size).then_some(least)
}

/// A slack may be negative by this much of its scale and still count as zero.
const ADMISSIBLE: f64 = 1e-11;

/// The y of the shortest L0 + D y with the chosen slacks at zero.
fn shortest_on_face(origin: &[f64], directions: &[Vec<f64>], slacks: &[Affine<f64>], chosen: &[usize]) -> Vec<f64> {
    let rows: Vec<&[f64]> = chosen.iter().map(|&index| slacks[index].coefficients.as_slice()).collect();
    let right: Vec<f64> = chosen.iter().map(|&index| -slacks[index].constant).collect();
    let (mut y, basis, _) = solve(directions.len(), &rows, &right);
    // Along the face: L = start + E z with E = D (complement); shortest where L is orthogonal to every column of E.
    let along: Vec<(Vec<f64>, Vec<f64>)> =
        basis.complement().rows().map(|z| (z.to_vec(), combination(directions, z, origin.len()))).collect();
    let start: Vec<f64> = origin.iter().zip(combination(directions, &y, origin.len())).map(|(a, b)| a + b).collect();
    // Normal equations are fine here: the columns are orthonormal combinations of few directions.
    let gram: Vec<Vec<f64>> = along.iter().map(|a| along.iter().map(|b| dot(&a.1, &b.1)).collect()).collect();
    let load: Vec<f64> = along.iter().map(|a| -dot(&a.1, &start)).collect();
    let largest = gram.iter().flatten().fold(f64::MIN_POSITIVE, |most: f64, entry| most.max(entry.abs()));
    let unit: Vec<Vec<f64>> = gram.iter().map(|row| row.iter().map(|entry| entry / largest).collect()).collect();
    let load: Vec<f64> = load.iter().map(|entry| entry / largest).collect();
    let (z, _, _) = solve(along.len(), &unit.iter().map(Vec::as_slice).collect::<Vec<_>>(), &load);
    for ((direction, _), factor) in along.iter().zip(&z) {
        for (entry, part) in y.iter_mut().zip(direction) {
            *entry += factor * part;
        }
    }
    y
}

fn combination(columns: &[Vec<f64>], factors: &[f64], length: usize) -> Vec<f64> {
    let mut sum = vec![0.0; length];
    for (column, factor) in columns.iter().zip(factors) {
        for (entry, part) in sum.iter_mut().zip(column) {
            *entry += factor * part;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn affine(constant: f64, coefficients: &[f64]) -> Affine<f64> {
        Affine { constant, coefficients: coefficients.to_vec() }
    }

    #[test]
    fn the_least_impulse_lies_on_the_face_that_binds() {
        // L = (1 - y, y); free optimum y = 1/2, but y <= 1/4.
        let found = least_impulse(&[1.0, 0.0], &[vec![-1.0, 1.0]], &[affine(0.25, &[-1.0])], &[0.0]);
        assert!((found[0] - 0.25).abs() < 1e-14, "exact on the face: {found:?}");
        let found = least_impulse(&[1.0, 0.0], &[vec![-1.0, 1.0]], &[affine(0.75, &[-1.0])], &[0.0]);
        assert!((found[0] - 0.5).abs() < 1e-14);
    }

    #[test]
    fn a_slack_that_binds_on_the_way_is_dropped_again() {
        // L = (y1, y2) + (-2, -1) is shortest at (2, 1); y1 + y2 <= 3 touches there, y2 >= 1.5 - y1 does not bind at all,
        // and y1 <= 1 does.
        let slacks = [affine(3.0, &[-1.0, -1.0]), affine(-1.5, &[1.0, 1.0]), affine(1.0, &[-1.0, 0.0])];
        let found = least_impulse(&[-2.0, -1.0], &[vec![1.0, 0.0], vec![0.0, 1.0]], &slacks, &[0.0, 2.9]);
        assert!((found[0] - 1.0).abs() < 1e-13 && (found[1] - 1.0).abs() < 1e-13, "{found:?}");
    }
}
