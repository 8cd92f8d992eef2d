//! Feet against a profile: where a foot touches, with which normal, and how deep it is.
//!
//! ```text
//!     a corner's rim at a segment              the segment's normal; in a notch two contacts, one for each segment
//!     a circle at a convex corner              from the ground's corner to the circle's center
//!     a foot's side across a convex corner     the side's own normal, turned round: the edge of a stair under a sole
//!     a foot's corner on a convex corner       the middle of the normals that both allow
//! ```
//!
//! Each corner of one boundary belongs to the side of the other that it is above, or to the corner whose sides it is
//! past, so that a spot touches once. What is within the tolerance touches; so a sole that lies flat on a tread touches
//! with its corner and at the edge that it overhangs. At a small angle a side may go behind another by twice it, and at
//! up to 45 degrees, as on a plane, if it ends above it.

use super::face::{Face, PARALLEL, unit};
use super::feet::Foot;
use super::outline::Outline;
use super::placement::Placement;
use super::point::Touch;
use super::sole::sole;
use super::terrain::Terrain;
use crate::planar::Vector;

/// What is touching, and how exactly that is known.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closeness {
    /// What counts as touching \[m\].
    pub tolerance: f64,
    /// What counts as the same place \[m\]: the rounding of positions.
    pub rounding: f64,
}

/// The contacts of a foot that is `close` to the ground, ascending in x, or the depth of a foot that is deeper.
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
        touches.extend(outer(found.collect(), |touch| face.tangent.dot(place(placement, touch)), foot.bumps));
    }
    let on_segments = touches.len();
    for corner in corners_of(&near).filter(|&corner| terrain.is_convex(corner)) {
        // A foot's corner that is at the end of a segment, to rounding, touches there already.
        let known = |touch: &Touch| {
            let [before, after] = terrain.at_corner(corner);
            let place = place(placement, touch);
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
    touches.sort_by(|a, b| place(placement, a).x.total_cmp(&place(placement, b).x));
    Ok(touches)
}

/// The rearmost and the foremost of a foot's contacts on one segment; of several at one end, or no farther than `bumps`
/// \[m\] apart, the lowest.
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

/// The segments that a foot may touch, ascending; all of them for a foot that reaches everywhere.
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

/// The material point of a contact in the world \[m\].
fn place(placement: &Placement, touch: &Touch) -> Vector<f64> {
    let normal = touch.ground.apply(Vector::new(0.0, 1.0));
    placement.world(touch.circle.body, touch.circle.center) - normal * touch.circle.radius
}

/// How far heights are off by rounding alone \[m\]: they are sums of a few terms of this size.
pub(super) fn rounding(placement: &Placement, size: f64) -> f64 {
    let Vector { x, z } = placement.base();
    16.0 * f64::EPSILON * (size + x.abs() + z.abs())
}

/// The corners of these segments, ascending.
fn corners_of(segments: &[usize]) -> impl Iterator<Item = usize> + '_ {
    let new = |at: usize| at == 0 || segments[at - 1] + 1 != segments[at];
    (0..segments.len()).flat_map(move |at| new(at).then(|| segments[at] - 1).into_iter().chain([segments[at]]))
}

/// Where a foot may be deepest in the ground or, above it, nearest to it: at its corners' rims, the ground's corners, and
/// sides that cross.
fn places<'a>(terrain: &'a Terrain, outline: &'a Outline, near: &'a [usize]) -> impl Iterator<Item = Touch> + 'a {
    let corners = (0..outline.corners.len()).filter_map(|corner| place_of_rim(terrain, outline, corner, near));
    let ground = corners_of(near).filter_map(|corner| outline.touch_of(terrain.at_corner(corner)[0].to));
    let across = near.iter().flat_map(move |&segment| {
        (0..outline.bones.len()).filter_map(move |bone| crossing(terrain.face(segment), outline, bone))
    });
    corners.chain(ground).chain(across)
}

/// How deep a foot is in the ground \[m\], negative above it.
fn depth(terrain: &Terrain, outline: &Outline, near: &[usize]) -> f64 {
    places(terrain, outline, near).map(|touch| -touch.gap).fold(f64::NEG_INFINITY, f64::max)
}

/// Where a corner's rim is deepest behind the segments that it is above, or as a whole below the profile.
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

/// Where a foot is nearest to the ground, or deepest in it; `None` of one that is below an end beside it.
pub(super) fn nearest(terrain: &Terrain, outline: &Outline) -> Option<Touch> {
    places(terrain, outline, &all(terrain)).min_by(Touch::by_gap).filter(|touch| touch.ground.cos > -PARALLEL)
}

pub(super) fn clearance(terrain: &Terrain, outline: &Outline) -> f64 {
    -depth(terrain, outline, &all(terrain))
}

/// Whether no point of a foot is on the ground or in it.
pub(super) fn is_clear(terrain: &Terrain, foot: &Foot, placement: &Placement, rounding: f64) -> bool {
    let outline = Outline::new(foot, placement);
    let near = within_reach(terrain, foot, &outline, rounding);
    depth(terrain, &outline, &near) < 0.0
}

/// The x of the end that a foot reaches beyond, not higher than `tolerance` above it.
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

/// The corner of a side that is behind a segment which the side crosses, as deep as the shortest way that takes one off
/// the other; `None` if they do not cross.
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

/// A corner's rim at a segment.
fn on_segment(terrain: &Terrain, segment: usize, outline: &Outline, corner: usize, close: Closeness) -> Option<Touch> {
    let face = terrain.face(segment);
    let center = outline.corners[corner];
    let lowest = outline.lowest(corner, face.normal);
    let gap = face.height(lowest);
    if gap.abs() > close.tolerance {
        return None;
    }
    // In a notch the foot may be a little behind the other segment; beyond a convex corner it is not above this one.
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
    // Behind both sides of a convex corner the one that is left by the shorter way counts.
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

/// A foot's corner, or the rim about it, on a convex corner of the ground.
fn corner_on_corner(terrain: &Terrain, corner: usize, outline: &Outline, close: Closeness) -> Option<Touch> {
    let [before, after] = terrain.at_corner(corner);
    let at = before.to;
    let on = |foot: usize| {
        let beyond = outline.beyond_rim(foot, at);
        let together = outline.is_sharp() && beyond.is_none_or(|(_, far)| far <= close.rounding);
        // A point that is at the corner, to rounding, is left to it by both segments.
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

/// The middle of the normals that a convex corner of the ground and a corner of the foot both allow; where the foot
/// lies flat on a segment, that segment's normal.
fn common_normal(ground: [&Face; 2], foot: Option<[&Face; 2]>) -> Vector<f64> {
    // From the rear face's normal clockwise to the front one's. A foot pushes the ground the other way.
    let ground = ground.map(|face| face.normal);
    let Some(foot) = foot.map(|[before, after]| [before, after].map(|side| -side.normal)) else {
        return unit(ground[0] + ground[1]);
    };
    // A foot's sides run counter-clockwise: its normals, turned round, go clockwise from the second to the first.
    let foot = [foot[1], foot[0]];
    let sine = |a: Vector<f64>, b: Vector<f64>| a.z * b.x - a.x * b.z;
    let within = |[first, last]: [Vector<f64>; 2], normal: Vector<f64>| {
        sine(first, normal) >= -PARALLEL && sine(normal, last) >= -PARALLEL && normal.dot(first + last) >= -PARALLEL
    };
    // The later of both beginnings and the earlier of both ends.
    let first = if within(ground, foot[0]) { foot[0] } else { ground[0] };
    let last = if within(ground, foot[1]) { foot[1] } else { ground[1] };
    let flat =
        ground.into_iter().find(|&normal| sine(first, last).abs() <= PARALLEL && sine(normal, last).abs() <= PARALLEL);
    flat.unwrap_or_else(|| unit(first + last))
}

/// A foot's side across a convex corner of the ground.
fn side_on_corner(terrain: &Terrain, corner: usize, outline: &Outline, close: Closeness) -> Option<Touch> {
    let [before, after] = terrain.at_corner(corner);
    let at = before.to;
    let across = |side: usize| {
        let face = &outline.sides[side];
        let (gap, slack) = (face.height(at), 2.0 * close.tolerance);
        let beneath = face.past_begin(at) >= -close.rounding && face.past_end(at) <= close.rounding;
        // A line is all surface; the way along the ground decides its side.
        let solid = outline.sides.len() > 2;
        let clear = |side: &Face| [before.from, after.to].into_iter().all(|end| side.clears(at, end, slack, false));
        let nearer = |other: &Face| solid && gap < 0.0 && other.faces(at) && other.height(at) > gap && clear(other);
        if gap.abs() > close.tolerance || !beneath || !clear(face) || outline.beside(side).into_iter().any(nearer) {
            return None;
        }
        // Where it lies flat on a segment, that segment's normal.
        let is_flat = |own: &&Face| own.normal.dot(face.normal) < 0.0 && own.normal.dot(face.tangent).abs() <= PARALLEL;
        let touch = outline.on_side(side, at);
        let ground = [before, after].into_iter().find(is_flat).map_or(touch.ground, Face::axes);
        Some(Touch { ground, ..touch })
    };
    (0..outline.sides.len()).find_map(across)
}
