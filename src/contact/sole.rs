//! What of a foot stands on a straight ground.
//!
//! ```text
//!     corners (t, n) of a convex outline --from the lowest both ways--> those within the tolerance, and of a mesh those
//!                                                                       that almost level sides join
//! ```
//!
//! The sole of a mesh is never quite flat: its facets are a micrometer apart, and which of them is lowest means
//! nothing. Nor are corners that are as close to each other along the ground, as on a wheel, a sole. A straight ground
//! pushes back through the rearmost and the foremost corner that stand on it.

use crate::planar::Vector;

/// The slope of a side of a mesh that is level but for the rounding of vertices.
const LEVEL: f64 = 1e-3;

/// The rearmost and the foremost corner that stands, of an outline whose `count` corners are at the (t, n) `place` \[m\],
/// counter-clockwise: those from one to the other stand. Sides of 45 degrees and more are no sole. A corner is on the
/// ground up to the height `highest`; the rest of an almost level sole, up to `bumps` above the lowest corner \[m\]. A
/// sole no longer than `bumps` is its lowest corner.
pub(super) fn sole(count: usize, place: impl Fn(usize) -> Vector<f64>, highest: f64, bumps: f64) -> Option<[usize; 2]> {
    let low = (0..count).map(|at| (at, place(at))).filter(|(_, place)| place.z <= highest);
    let (lowest, least) = low.min_by(|(_, a), (_, b)| a.z.total_cmp(&b.z))?;
    // Counter-clockwise from the lowest is forward.
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
