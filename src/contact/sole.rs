//! What of a foot stands on a straight ground.
//!
//! ```text
//!     corners (t, n) of a convex outline --from the lowest both ways--> those within the tolerance, and of a mesh those
//!                                                                       that almost level sides join
//! ```
//!
//! The sole of a mesh is never quite flat: its facets are a micrometer apart, and which of them is lowest means
//! nothing. A straight ground pushes back through the rearmost and the foremost corner that stand on it.

use crate::planar::Vector;

/// The slope of a side of a mesh that is level but for the rounding of vertices.
const LEVEL: f64 = 1e-3;

/// What stands on the ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    /// Up to which height a corner is on the ground \[m\].
    pub highest: f64,
    /// How far above the lowest corner the rest of an almost level sole may be \[m\].
    pub bumps: f64,
}

/// The corners that stand, from the rearmost to the foremost, of an outline whose corners are at (t, n) `places` \[m\],
/// counter-clockwise. Sides of 45 degrees and more are no sole.
pub(super) fn sole(places: &[Vector<f64>], Reach { highest, bumps }: Reach) -> Vec<usize> {
    let count = places.len();
    let low = (0..count).filter(|&at| places[at].z <= highest);
    let Some(lowest) = low.min_by(|&a, &b| places[a].z.total_cmp(&places[b].z)) else { return Vec::new() };
    let joins = |at: usize, next: usize, forward: f64| {
        let Vector { x: along, z: rise } = places[next] - places[at];
        let (run, rise) = (forward * along, rise.abs());
        run > rise && places[next].z <= highest
            || run > 0.0 && rise <= LEVEL * run && places[next].z - places[lowest].z <= bumps
    };
    let mut standing = vec![lowest];
    // Counter-clockwise from the lowest is forward.
    for (step, forward) in [(count - 1, -1.0), (1, 1.0)] {
        standing.reverse();
        let mut at = lowest;
        while joins(at, (at + step) % count, forward) {
            at = (at + step) % count;
            standing.push(at);
        }
    }
    standing
}
