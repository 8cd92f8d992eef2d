//! Points well inside areas, for the letters of the areas.

use crate::planar::Vector;
use std::collections::VecDeque;

/// Returns, for each connected part of the nodes of one kind in a grid, the kind and the nodes farthest (in steps) from
/// other kinds. Nodes are given row by row, with `columns` nodes in each.
pub fn deepest_nodes(kinds: &[Option<usize>], columns: usize) -> Vec<(usize, Vec<usize>)> {
    let neighbors = |k: usize| {
        let column = k % columns;
        let left = (column > 0).then(|| k - 1);
        let right = (column + 1 < columns).then(|| k + 1);
        let below = k.checked_sub(columns);
        let above = (k + columns < kinds.len()).then(|| k + columns);
        [left, right, below, above]
    };
    let alike = |k: usize| neighbors(k).into_iter().flatten().filter(move |&other| kinds[other] == kinds[k]);
    // The number of steps to the nearest node of another kind, or to the frame.
    let at_edge = |&k: &usize| alike(k).count() < 4;
    let mut queue: VecDeque<usize> = (0..kinds.len()).filter(at_edge).collect();
    let mut depth = vec![0_usize; kinds.len()];
    queue.iter().for_each(|&k| depth[k] = 1);
    while let Some(k) = queue.pop_front() {
        for other in alike(k) {
            if depth[other] == 0 {
                depth[other] = depth[k] + 1;
                queue.push_back(other);
            }
        }
    }
    let mut seen = vec![false; kinds.len()];
    let mut parts = Vec::new();
    for start in 0..kinds.len() {
        let (false, Some(kind)) = (seen[start], kinds[start]) else { continue };
        seen[start] = true;
        let (mut part, mut next) = (vec![start], 0);
        while let Some(&k) = part.get(next) {
            next += 1;
            part.extend(alike(k).filter(|&other| !std::mem::replace(&mut seen[other], true)));
        }
        let deepest = part.iter().map(|&k| depth[k]).max().unwrap_or(0);
        part.retain(|&k| depth[k] + 1 >= deepest);
        parts.push((kind, part));
    }
    parts
}

/// Returns the distance of a point from loops, as a fraction of the ranges.
pub fn distance(point: [f64; 2], loops: &[Vec<[f64; 2]>], ranges: [f64; 2]) -> f64 {
    let relative = |at: [f64; 2]| Vector::new((at[0] - point[0]) / ranges[0], (at[1] - point[1]) / ranges[1]);
    let edges = loops.iter().flat_map(|points| points.iter().zip(points.iter().cycle().skip(1)));
    let away = edges.map(|(a, b)| {
        let (a, b) = (relative(*a), relative(*b));
        let along = b - a;
        let share = (-a.dot(along) / along.dot(along)).clamp(0.0, 1.0);
        let nearest = if share.is_nan() { a } else { a + along * share };
        nearest.length()
    });
    away.fold(f64::INFINITY, f64::min)
}
