//! Points well inside of areas, for their letters.

use super::map::Area;
use super::regime::Regime;
use crate::planar::Vector;
use std::collections::VecDeque;
use std::sync::Arc;

/// Finds for each connected part of each area, as the grid's `nodes` show it, the node that is farthest from all others.
pub fn find(nodes: &[Arc<Regime>], (xs, ys): (&[f64], &[f64]), areas: &mut [Area]) {
    let (nx, ny) = (xs.len(), ys.len());
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
        let (mut deepest, mut stack) = (start, vec![start]);
        while let Some(k) = stack.pop() {
            deepest = if depth[k] > depth[deepest] { k } else { deepest };
            for other in neighbours(k).into_iter().flatten().filter(|&other| kinds[other] == kinds[k]) {
                if !std::mem::replace(&mut seen[other], true) {
                    stack.push(other);
                }
            }
        }
        let at: Vector<f64> = [xs[deepest % nx], ys[deepest / nx]];
        let part = depth[deepest] as f64 / nx.max(ny) as f64;
        areas[area].middles.push((at, part));
    }
}
