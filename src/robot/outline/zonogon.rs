//! Projection of a box: the zonogon `{c + sum of s_i g_i, |s_i| <= 1}` with the projected half axes g_i.
//!
//! A walk along the half sides, ordered by angle, gives the corners. So each corner of an unrotated shape is computed
//! from its center and half sizes by a single sum.

use crate::planar::Vector;

/// Half sides that are shorter than this fraction of the longest, or parallel to within this angle, are rounding errors
/// (of a quarter turn, whose cosine is 6e-17 in f64). They would split one corner into two.
const ROUNDING: f64 = 1e-12;

/// Returns the corners about `center`, counter-clockwise from the lowest: one if all sides vanish, two if parallel.
pub(super) fn corners(center: Vector<f64>, half_sides: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let sides = distinct(half_sides);
    // The walk goes up from the lowest corner along all sides, and back down along all sides.
    let count = sides.len();
    let corner = |step: usize| {
        let forward = |index: usize| index < step && step <= index + count;
        let signed = sides.iter().enumerate().map(|(index, &side)| if forward(index) { side } else { -side });
        signed.fold(Vector::zero(), |corner, side| corner + side)
    };
    (0..(2 * count).max(1)).map(|step| center + corner(step)).collect()
}

/// Drops rounding errors and joins parallel half sides. They point up, or forward if level, by the angle from level.
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

/// Returns the sine of the angle from `a` to `b`, positive if `b` points to the left of `a`.
fn sine(a: Vector<f64>, b: Vector<f64>) -> f64 {
    let (la, lb) = (a.length(), b.length());
    (a.x / la) * (b.z / lb) - (a.z / la) * (b.x / lb)
}
