//! The projection of a box: `{c + sum of s_i g_i, |s_i| <= 1}` with the projected half axes g_i, a polygon with
//! parallel sides (a zonogon).
//!
//! Walking along the half sides in the order of their angles gives the corners, so those of a shape that is not turned
//! come from its center and half sizes by one sum each.

use crate::planar::Vector;

/// Half sides shorter than this part of the longest, or as nearly parallel, are rounding (a quarter turn, whose cosine
/// is 6e-17 in f64, leaves them) and would tear one corner into two.
const ROUNDING: f64 = 1e-12;

/// The corners about `center` with these half sides, counter-clockwise from the lowest: one if all vanish, two if all
/// are parallel.
pub(super) fn corners(center: Vector<f64>, half_sides: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let sides = distinct(half_sides);
    // From the lowest corner up along all sides, and back down along them.
    let count = sides.len();
    let corner = |step: usize| {
        let forward = |index: usize| index < step && step <= index + count;
        let signed = sides.iter().enumerate().map(|(index, &side)| if forward(index) { side } else { -side });
        signed.fold(Vector::zero(), |corner, side| corner + side)
    };
    (0..(2 * count).max(1)).map(|step| center + corner(step)).collect()
}

/// The half sides that remain when rounding is dropped and parallel ones are joined, all pointing up (or level and
/// forward), by rising angle from level.
fn distinct(half_sides: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let longest = half_sides.iter().map(|side| side.length()).fold(0.0, f64::max);
    let mut sides: Vec<Vector<f64>> = Vec::with_capacity(half_sides.len());
    for &side in half_sides {
        if side.length() <= ROUNDING * longest {
            continue;
        }
        let parallel = sides.iter_mut().find(|known| sine(**known, side).abs() <= ROUNDING);
        match parallel {
            Some(known) if known.dot(side) > 0.0 => *known += side,
            Some(known) => *known = *known - side,
            None => sides.push(side),
        }
    }
    for side in &mut sides {
        if side.z < 0.0 || (side.z == 0.0 && side.x < 0.0) {
            *side = side.map(|component| 0.0 - component);
        }
    }
    sides.sort_by(|&a, &b| 0.0_f64.total_cmp(&sine(a, b)));
    sides
}

/// Sine of the angle from `a` to `b`; positive where `b` points to the left of `a`, seen with forward to the right and
/// up upward.
fn sine(a: Vector<f64>, b: Vector<f64>) -> f64 {
    let (la, lb) = (a.length(), b.length());
    (a.x / la) * (b.z / lb) - (a.z / la) * (b.x / lb)
}
