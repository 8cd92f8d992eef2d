//! Finds the corners of a foot that stand on straight ground.
//!
//! ```text
//!     corners (t, n) of a convex outline --from the lowest in both directions--> corners within the tolerance; of a
//!                                                                                mesh, also along almost level sides
//! ```
//!
//! The sole of a mesh is never quite flat: its facets are about a micrometer apart, and which of them is lowest has no
//! meaning. Corners that are this close to each other along the ground, as on a wheel, are one point and no sole.
//! Straight ground pushes back through the rearmost and the foremost corner that stand on it.

use crate::planar::Vector;

/// Largest slope of a mesh's side that counts as level, because vertices are rounded.
const LEVEL: f64 = 1e-3;

/// Returns the rearmost and the foremost corner that stand; all corners between them stand, too. `None` if no corner
/// does. The outline has `count` corners, counter-clockwise, at the positions (t, n) from `place` \[m\]. Sides of 45
/// degrees and more do not belong to a sole. A corner stands up to the height `highest` \[m\], or along almost level
/// sides up to `bumps` \[m\] above the lowest corner. A sole no longer than `bumps` is only its lowest corner.
pub(super) fn sole(count: usize, place: impl Fn(usize) -> Vector<f64>, highest: f64, bumps: f64) -> Option<[usize; 2]> {
    let low = (0..count).map(|at| (at, place(at))).filter(|(_, place)| place.z <= highest);
    let (lowest, least) = low.min_by(|(_, a), (_, b)| a.z.total_cmp(&b.z))?;
    // From the lowest corner, counter-clockwise is forward.
    let end = |(step, forward): (usize, f64)| {
        let (mut at, mut from) = (lowest, least);
        loop {
            let next = (at + step) % count;
            if next == lowest {
                return at;
            }
            let to = place(next);
            let Vector { x: along, z: rise } = to - from;
            let (run, rise) = (forward * along, rise.abs());
            let joins = run > rise && to.z <= highest || run > 0.0 && rise <= LEVEL * run && to.z - least.z <= bumps;
            if !joins {
                return at;
            }
            (at, from) = (next, to);
        }
    };
    let [rear, front] = [(count - 1, -1.0), (1, 1.0)].map(end);
    let is_point = front == rear || place(front).x - place(rear).x <= bumps;
    Some(if is_point { [lowest; 2] } else { [rear, front] })
}
