//! Feet against a profile: where a foot touches, the normal there, and how deep the foot is in the ground.
//!
//! ```text
//!     what touches                             normal
//!     a corner's rim at a segment              the segment's; in a notch two contacts, one for each segment
//!     a circle at a convex ground corner       from the ground corner to the circle's center
//!     a foot's side across a convex corner     the side's, reversed, as for the edge of a stair under a sole
//!     a foot's corner on a convex corner       the middle of the normals that both allow
//! ```
//!
//! A foot that lies flat on a segment has that segment's normal also at a ground corner. Each corner of one boundary
//! belongs to the side of the other boundary that it is above, or to the corner whose two sides it is past. So each
//! place touches once. Everything within the tolerance touches, so a sole that lies flat on a tread touches with its
//! corner and at the edge that it overhangs. A side at a small angle to a segment may go behind it by twice the
//! tolerance; so may a side at up to 45 degrees that ends above the segment, as on a plane.

use super::face::{Face, PARALLEL, unit};
use super::feet::Foot;
use super::outline::Outline;
use super::placement::Placement;
use super::point::Touch;
use super::sole::sole;
use super::terrain::Terrain;
use crate::planar::Vector;

/// The lengths that decide whether a foot touches.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closeness {
    /// Largest gap, and largest depth, of a contact \[m\].
    pub tolerance: f64,
    /// Largest distance between points that count as the same place \[m\]: the rounding of positions.
    pub rounding: f64,
}

/// Returns the contacts of a foot that is `close` to the ground, ascending in x. Returns the depth \[m\] of a foot that
/// is deeper than the tolerance as an error.
pub(super) fn touching(
    terrain: &Terrain,
    foot: &Foot,
    placement: &Placement,
    close: Closeness,
) -> Result<Vec<Touch>, f64> {
    let Closeness { tolerance, rounding } = close;
    let outline = Outline::new(foot, placement);
    let near = within_reach(terrain, foot, &outline, tolerance);
    let deepest = depth(terrain, &outline, &near);
    if deepest > tolerance {
        return Err(deepest);
    }
    let mut touches: Vec<Touch> = Vec::new();
    for &segment in &near {
        let face = terrain.face(segment);
        let place_of = |corner| {
            let lowest = outline.lowest(corner, face.normal);
            Vector::new(face.past_begin(lowest), face.height(lowest))
        };
        let places: Vec<Vector<f64>> = (0..outline.corners.len()).map(place_of).collect();
        let count = places.len();
        let ends = sole(count, |at| places[at], tolerance, foot.bumps);
        let stands = |corner| {
            ends.is_some_and(|[rear, front]| (corner + count - rear) % count <= (front + count - rear) % count)
        };
        let found = (0..count).filter_map(|corner| {
            let height = if stands(corner) { places[corner].z } else { tolerance };
            on_segment(terrain, segment, &outline, corner, Closeness { tolerance: tolerance.max(height), rounding })
        });
        touches.extend(outer(found.collect(), |touch| face.tangent.dot(placement.touched(touch)), foot.bumps));
    }
    let on_segments = touches.len();
    for corner in corners_of(&near).filter(|&corner| terrain.is_convex(corner)) {
        // A contact at this end of an adjacent segment, up to rounding, already stands for the ground corner.
        let known = |touch: &Touch| {
            let [before, after] = terrain.at_corner(corner);
            let place = placement.touched(touch);
            touch.ground == before.axes() && before.past_end(place).abs() <= 2.0 * rounding
                || touch.ground == after.axes() && after.past_begin(place).abs() <= 2.0 * rounding
        };
        let beneath = || match touches[..on_segments].iter().any(known) {
            true => None,
            false => side_on_corner(terrain, corner, &outline, close),
        };
        let found = corner_on_corner(terrain, corner, &outline, close).or_else(beneath);
        touches.extend(found);
    }
    touches.sort_by(|a, b| placement.touched(a).x.total_cmp(&placement.touched(b).x));
    Ok(touches)
}

/// Returns the rearmost and the foremost of a foot's contacts on one segment, or only the lowest contact if they are at
/// most `bumps` \[m\] apart. Of several contacts at one end, the lowest counts.
fn outer(touches: Vec<Touch>, along: impl Fn(&Touch) -> f64, bumps: f64) -> Vec<Touch> {
    let lower = |a: &&Touch, b: &&Touch| a.by_gap(b);
    let end = |way: f64| touches.iter().min_by(|a, b| (way * along(a)).total_cmp(&(way * along(b))).then(lower(a, b)));
    match (end(1.0), end(-1.0)) {
        (Some(rear), Some(front)) if along(front) - along(rear) <= bumps => {
            touches.iter().min_by(lower).copied().into_iter().collect()
        }
        (Some(&rear), Some(&front)) => vec![rear, front],
        _ => touches,
    }
}

/// Returns the indices of the segments that a foot may touch, ascending; all of them for an infinite bounding circle.
pub(super) fn within_reach(terrain: &Terrain, foot: &Foot, outline: &Outline, tolerance: f64) -> Vec<usize> {
    if foot.bounding_circle.1.is_infinite() {
        return all(terrain);
    }
    let [low, high] = outline.region(tolerance);
    terrain.near(low, high)
}

fn all(terrain: &Terrain) -> Vec<usize> {
    (1..=terrain.segments().len()).collect()
}

/// Bounds the rounding of heights \[m\], which are sums of a few terms of this size.
pub(super) fn rounding(placement: &Placement, size: f64) -> f64 {
    let Vector { x, z } = placement.base();
    16.0 * f64::EPSILON * (size + x.abs() + z.abs())
}

/// Returns the indices of the corners of these segments, ascending.
fn corners_of(segments: &[usize]) -> impl Iterator<Item = usize> + '_ {
    let new = |at: usize| at == 0 || segments[at - 1] + 1 != segments[at];
    (0..segments.len()).flat_map(move |at| new(at).then(|| segments[at] - 1).into_iter().chain([segments[at]]))
}

/// Returns the places where a foot may be deepest in the ground or, above it, nearest to it: the rims of its corners,
/// the ground's corners, and crossings of its sides with segments.
fn places<'a>(terrain: &'a Terrain, outline: &'a Outline, near: &'a [usize]) -> impl Iterator<Item = Touch> + 'a {
    let corners = (0..outline.corners.len()).filter_map(|corner| place_of_rim(terrain, outline, corner, near));
    let ground = corners_of(near).filter_map(|corner| outline.touch_of(terrain.at_corner(corner)[0].to));
    let across = near.iter().flat_map(move |&segment| {
        (0..outline.bones.len()).filter_map(move |bone| crossing(terrain.face(segment), outline, bone))
    });
    corners.chain(ground).chain(across)
}

/// Returns how deep a foot is in the ground \[m\], negative above it; negative infinity if no place is near.
fn depth(terrain: &Terrain, outline: &Outline, near: &[usize]) -> f64 {
    places(terrain, outline, near).map(|touch| -touch.gap).fold(f64::NEG_INFINITY, f64::max)
}

/// Returns where a corner's rim is deepest in, or nearest to, the segments that the corner is above; `None` if it is
/// above none. If the corner itself is in the ground, the depth is its own plus the reach of the rim.
fn place_of_rim(terrain: &Terrain, outline: &Outline, corner: usize, near: &[usize]) -> Option<Touch> {
    let center = outline.corners[corner];
    if let Some((depth, normal)) = terrain.depth_of(center) {
        return Some(outline.touch(corner, normal, -(depth + outline.reach(-normal))));
    }
    let above = near.iter().filter_map(|&segment| {
        let face = terrain.face(segment);
        let lowest = outline.lowest(corner, face.normal);
        let is_above = face.height(center) >= 0.0 && face.faces(lowest);
        is_above.then(|| outline.touch(corner, face.normal, face.height(lowest)))
    });
    above.min_by(Touch::by_gap)
}

/// Returns where a foot is nearest to the ground, or deepest in it; `None` if the foot is beyond an end of the profile
/// and below that end.
pub(super) fn nearest(terrain: &Terrain, outline: &Outline) -> Option<Touch> {
    places(terrain, outline, &all(terrain)).min_by(Touch::by_gap).filter(|touch| touch.ground.cos > -PARALLEL)
}

pub(super) fn clearance(terrain: &Terrain, outline: &Outline) -> f64 {
    -depth(terrain, outline, &all(terrain))
}

/// Returns whether no point of a foot is on the ground or in it.
pub(super) fn is_clear(terrain: &Terrain, foot: &Foot, placement: &Placement, rounding: f64) -> bool {
    let outline = Outline::new(foot, placement);
    let near = within_reach(terrain, foot, &outline, rounding);
    depth(terrain, &outline, &near) < 0.0
}

/// Returns x of an end of the profile \[m\] if a foot reaches beyond it by more than `tolerance` \[m\], at a height of
/// at most `tolerance` above it.
pub(super) fn left_behind(terrain: &Terrain, outline: &Outline, tolerance: f64) -> Option<f64> {
    let [rear, front] = terrain.ends();
    let hangs = |Vector { x, z }: Vector<f64>, way: f64| {
        let reach = |corner: usize, normal| outline.lowest(corner, normal);
        (0..outline.corners.len()).any(|corner| {
            way * (reach(corner, Vector::new(-way, 0.0)).x - x) > tolerance
                && reach(corner, Vector::new(0.0, 1.0)).z <= z + tolerance
        })
    };
    if hangs(rear, -1.0) { Some(rear.x) } else { hangs(front, 1.0).then_some(front.x) }
}

/// Returns the place where a side of a foot crosses a segment, at the side's corner that is behind the segment; `None`
/// if they do not cross. The depth is the reach of the rim plus the shortest distance that separates side and segment.
fn crossing(face: &Face, outline: &Outline, side: usize) -> Option<Touch> {
    let bone = &outline.bones[side];
    let [from, to] = [face.height(bone.from), face.height(bone.to)];
    let [begin, end] = [bone.height(face.from), bone.height(face.to)];
    let parted = |one: f64, other: f64| one.min(other) < 0.0 && one.max(other) > 0.0;
    let shortest = [from, to, begin, end].map(f64::abs).into_iter().fold(f64::INFINITY, f64::min);
    let behind = if from < 0.0 { side } else { (side + 1) % outline.corners.len() };
    let depth = || outline.reach(-face.normal) + shortest;
    (parted(from, to) && parted(begin, end)).then(|| outline.touch(behind, face.normal, -depth()))
}

/// Returns the contact of a corner's rim with a segment; `None` if there is none or it belongs to another place.
fn on_segment(terrain: &Terrain, segment: usize, outline: &Outline, corner: usize, close: Closeness) -> Option<Touch> {
    let face = terrain.face(segment);
    let center = outline.corners[corner];
    let lowest = outline.lowest(corner, face.normal);
    let gap = face.height(lowest);
    if gap.abs() > close.tolerance {
        return None;
    }
    // In a notch the foot may be behind the other segment by the tolerance; past a convex corner it belongs elsewhere.
    let [rear, front] = [segment - 1, segment].map(|end| terrain.is_convex(end));
    let reach = |convex: bool| if convex { 0.0 } else { close.tolerance };
    let above = face.past_begin(lowest) >= -reach(rear) && face.past_end(lowest) <= reach(front);
    let at_corner = |end: Vector<f64>, convex: bool| convex && (lowest - end).length() <= close.rounding;
    if !above || at_corner(face.from, rear) || at_corner(face.to, front) {
        return None;
    }
    let clear = |face: &Face| {
        let slack = 2.0 * close.tolerance;
        let beside = outline.beside_corner(corner);
        beside.is_none_or(|beside| beside.into_iter().all(|neighbor| face.clears(center, neighbor, slack, true)))
    };
    // If the point is behind both segments at a convex corner, the contact belongs to the segment that is nearer.
    let height = face.height(center);
    let nearer = |other: usize, convex: bool| {
        let beside = terrain.face(other);
        let shorter = |other_height: f64| other_height > height || (other_height == height && other < segment);
        let behind_both = convex && height < 0.0 && !terrain.is_wall(other) && beside.faces(center);
        behind_both && shorter(beside.height(center)) && clear(beside)
    };
    if !clear(face) || nearer(segment - 1, rear) || nearer(segment + 1, front) {
        return None;
    }
    Some(outline.touch(corner, face.normal, gap))
}

/// Returns the contact of a foot's corner, or of the rim about it, with a convex corner of the ground.
fn corner_on_corner(terrain: &Terrain, corner: usize, outline: &Outline, close: Closeness) -> Option<Touch> {
    let [before, after] = terrain.at_corner(corner);
    let at = before.to;
    let on = |foot: usize| {
        let beyond = outline.beyond_rim(foot, at);
        let together = outline.is_sharp() && beyond.is_none_or(|(_, far)| far <= close.rounding);
        // Both segments leave a point at the ground corner, up to rounding, to that corner.
        let past_both = || {
            let [rear, front] = [before, after].map(|face| outline.lowest(foot, face.normal));
            let left = |past: bool, lowest: Vector<f64>| past || (lowest - at).length() <= close.rounding;
            left(before.past_end(rear) > 0.0, rear) && left(after.past_begin(front) < 0.0, front)
        };
        let is_nearest_foot = outline.at_corner(foot).is_none_or(|[ending, beginning]| {
            ending.past_end(at) >= -close.rounding && beginning.past_begin(at) <= close.rounding
        });
        let far = beyond.map_or(0.0, |(_, far)| far);
        if far > close.tolerance || !is_nearest_foot || !(together || past_both()) {
            return None;
        }
        let (normal, gap) = match beyond {
            Some((out, far)) if !outline.is_sharp() => (-out, far),
            _ => {
                let normal = common_normal([before, after], outline.at_corner(foot));
                (normal, normal.dot(outline.corners[foot] - at))
            }
        };
        Some(outline.touch(foot, normal, gap))
    };
    (0..outline.corners.len()).find_map(on)
}

/// Returns the middle of the normals that a convex corner of the ground and a corner of the foot both allow. If the
/// foot lies flat on a segment, it is that segment's normal.
fn common_normal(ground: [&Face; 2], foot: Option<[&Face; 2]>) -> Vector<f64> {
    // The ground allows the normals from the rear face's clockwise to the front face's. Those of a foot are reversed,
    // because they point into the ground.
    let ground = ground.map(|face| face.normal);
    let Some(foot) = foot.map(|[before, after]| [before, after].map(|side| -side.normal)) else {
        return unit(ground[0] + ground[1]);
    };
    // A foot's sides run counter-clockwise, so its normals run clockwise from the second to the first.
    let foot = [foot[1], foot[0]];
    let sine = |a: Vector<f64>, b: Vector<f64>| a.z * b.x - a.x * b.z;
    let within = |[first, last]: [Vector<f64>; 2], normal: Vector<f64>| {
        sine(first, normal) >= -PARALLEL && sine(normal, last) >= -PARALLEL && normal.dot(first + last) >= -PARALLEL
    };
    // The common range goes from the later beginning to the earlier end.
    let first = if within(ground, foot[0]) { foot[0] } else { ground[0] };
    let last = if within(ground, foot[1]) { foot[1] } else { ground[1] };
    let flat =
        ground.into_iter().find(|&normal| sine(first, last).abs() <= PARALLEL && sine(normal, last).abs() <= PARALLEL);
    flat.unwrap_or_else(|| unit(first + last))
}

/// Returns the contact of a foot's side with a convex corner of the ground.
fn side_on_corner(terrain: &Terrain, corner: usize, outline: &Outline, close: Closeness) -> Option<Touch> {
    let [before, after] = terrain.at_corner(corner);
    let at = before.to;
    let across = |side: usize| {
        let face = &outline.sides[side];
        let (gap, slack) = (face.height(at), 2.0 * close.tolerance);
        let beneath = face.past_begin(at) >= -close.rounding && face.past_end(at) <= close.rounding;
        // A line has no inside: the ground's segments decide which of its two sides touches.
        let solid = outline.sides.len() > 2;
        let clear = |side: &Face| [before.from, after.to].into_iter().all(|end| side.clears(at, end, slack, false));
        let nearer = |other: &Face| solid && gap < 0.0 && other.faces(at) && other.height(at) > gap && clear(other);
        if gap.abs() > close.tolerance || !beneath || !clear(face) || outline.beside(side).into_iter().any(nearer) {
            return None;
        }
        // A side that lies flat on a segment gets that segment's normal.
        let is_flat = |segment: &&Face| {
            segment.normal.dot(face.normal) < 0.0 && segment.normal.dot(face.tangent).abs() <= PARALLEL
        };
        let touch = outline.on_side(side, at);
        let ground = [before, after].into_iter().find(is_flat).map_or(touch.ground, Face::axes);
        Some(Touch { ground, ..touch })
    };
    (0..outline.sides.len()).find_map(across)
}
