//! Joins segments end to end, to polylines and to loops around areas.

use super::edge::Segment;
use super::regime::Regime;
use std::collections::HashMap;
use std::sync::Arc;

/// The bits of a point: ends that meet have exactly the same numbers.
type PointKey = [u64; 2];

fn key(point: [f64; 2]) -> PointKey {
    point.map(f64::to_bits)
}

/// Joins segments of the same regimes and transitions to curves. Each curve comes with one of its segments, and its
/// points are in the direction of that segment.
pub fn polylines(segments: &[Segment]) -> Vec<(&Segment, Vec<[f64; 2]>)> {
    let mut starts: HashMap<PointKey, Vec<(usize, bool)>> = HashMap::new();
    for (index, segment) in segments.iter().enumerate() {
        starts.entry(key(segment.from)).or_default().push((index, true));
        starts.entry(key(segment.to)).or_default().push((index, false));
    }
    let mut used = vec![false; segments.len()];
    let mut polylines = Vec::new();
    for first in 0..segments.len() {
        if std::mem::replace(&mut used[first], true) {
            continue;
        }
        let segment = &segments[first];
        // Extends the curve from the segment's end, then from its beginning. Other segments may have either direction.
        let mut grow = |mut point: [f64; 2], forward: bool| {
            let mut points = Vec::new();
            loop {
                let next = starts[&key(point)].iter().find(|&&(index, at_start)| {
                    let sides = &segments[index].sides;
                    let along = at_start == forward;
                    !used[index] && segment.sides.is_same_as(&if along { sides.clone() } else { sides.reversed() })
                });
                let Some(&(index, at_start)) = next else { return points };
                used[index] = true;
                point = if at_start { segments[index].to } else { segments[index].from };
                points.push(point);
            }
        };
        let onward = grow(segment.to, true);
        let back = grow(segment.from, false);
        polylines.push((segment, back.into_iter().rev().chain([segment.from, segment.to]).chain(onward).collect()));
    }
    polylines
}

/// Returns the closed loops, of borders and of the frame, that have `regime` on their left.
pub fn loops<'s>(segments: &'s [Segment], frame: &'s [Segment], regime: &Arc<Regime>) -> Vec<Vec<[f64; 2]>> {
    let mut next: HashMap<PointKey, Vec<[f64; 2]>> = HashMap::new();
    let mut order = Vec::new();
    let onward = |Segment { from, to, sides }: &'s Segment| (&sides.left, *from, *to);
    let back = |Segment { from, to, sides }: &'s Segment| (&sides.right, *to, *from);
    let ways = segments.iter().flat_map(|segment| [onward(segment), back(segment)]);
    for (left, from, to) in ways.chain(frame.iter().map(onward)) {
        if left == regime {
            next.entry(key(from)).or_default().push(to);
            order.push(from);
        }
    }
    let mut loops = Vec::new();
    for start in order {
        let mut points = Vec::new();
        let mut at = start;
        while let Some(to) = next.get_mut(&key(at)).and_then(Vec::pop) {
            points.push(at);
            at = to;
        }
        if points.len() > 2 {
            loops.push(points);
        }
    }
    loops
}
