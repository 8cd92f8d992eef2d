//! Points well inside of areas, for their letters.

use super::map::Area;
use super::regime::Regime;
use crate::planar::{Vector, difference, dot, sum};
use std::collections::VecDeque;
use std::sync::Arc;

/// Finds for each connected part of each area, as the grid's `nodes` show it, the node that is farthest from its borders.
pub fn find(nodes: &[Arc<Regime>], (xs, ys): (&[f64], &[f64]), areas: &mut [Area]) {
    let (nx, ny) = (xs.len(), ys.len());
    let ranges = [xs[nx - 1] - xs[0], ys[ny - 1] - ys[0]];
    let kind = |k: usize| areas.iter().position(|area| area.regime == nodes[k]);
    let kinds: Vec<Option<usize>> = (0..nodes.len()).map(kind).collect();
    let neighbours = |k: usize| {
        let (column, row) = (k % nx, k / nx);
        let left = (column > 0).then(|| k - 1);
        let right = (column + 1 < nx).then(|| k + 1);
        let below = (row > 0).then(|| k - nx);
        let above = (row + 1 < ny).then(|| k + nx);
        [left, right, below, above]
    };
    // Steps to the nearest node of another kind, or to the frame.
    let mut depth = vec![0_usize; nodes.len()];
    let mut queue: VecDeque<usize> = VecDeque::new();
    for k in 0..nodes.len() {
        let at_edge = neighbours(k).iter().any(|other| other.is_none_or(|other| kinds[other] != kinds[k]));
        if at_edge {
            depth[k] = 1;
            queue.push_back(k);
        }
    }
    while let Some(k) = queue.pop_front() {
        for other in neighbours(k).into_iter().flatten().filter(|&other| kinds[other] == kinds[k]) {
            if depth[other] == 0 {
                depth[other] = depth[k] + 1;
                queue.push_back(other);
            }
        }
    }
    let mut seen = vec![false; nodes.len()];
    for start in 0..nodes.len() {
        let (false, Some(area)) = (seen[start], kinds[start]) else { continue };
        seen[start] = true;
        let (mut part, mut next) = (vec![start], 0);
        while let Some(&k) = part.get(next) {
            next += 1;
            for other in neighbours(k).into_iter().flatten().filter(|&other| kinds[other] == kinds[k]) {
                if !std::mem::replace(&mut seen[other], true) {
                    part.push(other);
                }
            }
        }
        let deepest = part.iter().map(|&k| depth[k]).max().unwrap_or(0);
        let inner = part.iter().filter(|&&k| depth[k] + 1 >= deepest).map(|&k| [xs[k % nx], ys[k / nx]]);
        let room = inner.map(|at| (at, distance(at, &areas[area].loops, ranges)));
        if let Some(middle) = room.max_by(|a, b| a.1.total_cmp(&b.1)) {
            areas[area].middles.push(middle);
        }
    }
}

/// How far a point is from loops, as part of the ranges.
fn distance(point: Vector<f64>, loops: &[Vec<Vector<f64>>], ranges: Vector<f64>) -> f64 {
    let scaled = |at: Vector<f64>| [(at[0] - point[0]) / ranges[0], (at[1] - point[1]) / ranges[1]];
    let mut least = f64::INFINITY;
    for points in loops {
        for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
            let (a, b) = (scaled(*a), scaled(*b));
            let along = difference(b, a);
            let share = (-dot(a, along) / dot(along, along)).clamp(0.0, 1.0);
            let nearest = if share.is_nan() { a } else { sum(a, crate::planar::scaled(share, along)) };
            least = least.min(libm::hypot(nearest[0], nearest[1]));
        }
    }
    least
}
