//! Curves on the screen, clipped at the panel and reduced to the corners that are visible.
//!
//! ```text
//!     points [px] --parts inside--> pieces --Douglas and Peucker 1973--> the fewest corners within a tenth of a pixel
//! ```

use super::Pixel;

/// Omitted corners lie no farther than this from the drawn curve \[px\].
const SEEN: f64 = 0.1;
/// The largest number of corners of a piece. If more are needed, it is drawn more coarsely.
const MOST: usize = 4000;
/// How far a curve continues beyond the panel \[px\], which hides its end and the corners of wide strokes.
const BEYOND: f64 = 20.0;

/// For each side of a panel of this size, the distance of a point from the line [`BEYOND`] outside that side \[px\];
/// negative outside.
const SIDES: [fn(Pixel, Pixel) -> f64; 4] = [
    |(x, _), _| x + BEYOND,
    |(x, _), (width, _)| width + BEYOND - x,
    |(_, y), _| y + BEYOND,
    |(_, y), (_, height)| height + BEYOND - y,
];

/// Returns the pieces of the curve through `points` that lie within a panel of this size \[px\], or just beyond.
pub(super) fn visible(points: &[Pixel], size: Pixel) -> Vec<Vec<Pixel>> {
    let mut pieces: Vec<Vec<Pixel>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((from, to)) = within(pair[0], pair[1], size) else {
            open = false;
            continue;
        };
        match pieces.last_mut() {
            Some(piece) if open && piece.last() == Some(&from) => piece.push(to),
            _ => pieces.push(vec![from, to]),
        }
        open = to == pair[1];
    }
    pieces.iter().map(|piece| thinned(piece)).collect()
}

/// Clips the area inside a closed loop of `corners` just beyond a panel of this size \[px\]. Returns the new corners.
pub(super) fn enclosed(corners: &[Pixel], size: Pixel) -> Vec<Pixel> {
    let Some((&first, rest)) = corners.split_first() else { return Vec::new() };
    // The ends of a loop are the same point. It is cut in half, so that each half is a curve with two ends.
    let (once, again) = rest.split_at(rest.len() / 2);
    let turn = once.last().copied().unwrap_or(first);
    let halves = [[&[first], once].concat(), [&[turn], again, &[first]].concat()];
    let thin = halves.iter().flat_map(|half| {
        let mut half = thinned(half);
        half.pop();
        half
    });
    SIDES.iter().fold(thin.collect(), |corners, side| cut(&corners, |point| side(point, size)))
}

/// Clips a polygon to the points at which `inside` is not negative (Sutherland and Hodgman 1974).
fn cut(corners: &[Pixel], inside: impl Fn(Pixel) -> f64) -> Vec<Pixel> {
    let mut kept = Vec::with_capacity(corners.len());
    for (at, &to) in corners.iter().enumerate() {
        let from = corners[(at + corners.len() - 1) % corners.len()];
        let (before, after) = (inside(from), inside(to));
        if (before < 0.0) != (after < 0.0) {
            let share = before / (before - after);
            kept.push(between(from, to, share));
        }
        if after >= 0.0 {
            kept.push(to);
        }
    }
    kept
}

/// Clips a segment to the panel, or just beyond (Liang and Barsky 1984); `None` if nothing of it remains.
fn within(from: Pixel, to: Pixel, size: Pixel) -> Option<(Pixel, Pixel)> {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for side in SIDES {
        let (before, after) = (side(from, size), side(to, size));
        let share = before / (before - after);
        match (before < 0.0, after < 0.0) {
            (true, true) => return None,
            (true, false) => first = first.max(share),
            (false, true) => last = last.min(share),
            (false, false) => {}
        }
    }
    let start = if first > 0.0 { between(from, to, first) } else { from };
    let end = if last < 1.0 { between(from, to, last) } else { to };
    (first <= last).then_some((start, end))
}

fn between(from: Pixel, to: Pixel, share: f64) -> Pixel {
    (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1))
}

fn thinned(points: &[Pixel]) -> Vec<Pixel> {
    let mut tolerance = SEEN;
    loop {
        let corners = corners(points, tolerance);
        if corners.len() <= MOST {
            return corners;
        }
        tolerance *= 2.0;
    }
}

/// Returns corners whose connecting line is nowhere farther than `tolerance` from a point.
fn corners(points: &[Pixel], tolerance: f64) -> Vec<Pixel> {
    let Some(end) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept: Vec<bool> = (0..=end).map(|at| at == 0 || at == end).collect();
    let mut spans = vec![(0, end)];
    while let Some((first, last)) = spans.pop() {
        let distances = (first + 1..last).map(|at| (at, distance(points[at], points[first], points[last])));
        let Some((far, most)) = distances.max_by(|(_, a), (_, b)| a.total_cmp(b)) else { continue };
        if most > tolerance {
            kept[far] = true;
            spans.extend([(first, far), (far, last)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(&point, _)| point).collect()
}

fn distance(point: Pixel, from: Pixel, to: Pixel) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (px, py) = (point.0 - from.0, point.1 - from.1);
    let square = dx * dx + dy * dy;
    let share = if square > 0.0 { ((px * dx + py * dy) / square).clamp(0.0, 1.0) } else { 0.0 };
    libm::hypot(px - share * dx, py - share * dy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_that_nobody_sees_are_left_out() {
        let line: Vec<Pixel> = (0..=100).map(|at| (f64::from(at), 2.0 * f64::from(at.min(50)))).collect();
        assert_eq!(visible(&line, (200.0, 200.0)), [[(0.0, 0.0), (50.0, 100.0), (100.0, 100.0)]]);
        let wave = (0..20_000).map(|at| f64::from(at) * 0.03).map(|x| (x, 200.0 + 150.0 * libm::sin(0.05 * x)));
        let wave: Vec<Pixel> = wave.collect();
        let [thin] = &visible(&wave, (600.0, 400.0))[..] else { panic!("one piece") };
        assert!(thin.len() < 400, "{}", thin.len());
        for &point in &wave {
            let nearest = thin.windows(2).map(|pair| distance(point, pair[0], pair[1])).fold(f64::INFINITY, f64::min);
            assert!(nearest <= SEEN, "{point:?} is {nearest} px away");
        }
        let noise: Vec<Pixel> = (0..50_000).map(|at| (f64::from(at) * 0.01, f64::from(at * 7919 % 400))).collect();
        assert!(visible(&noise, (600.0, 400.0)).iter().map(Vec::len).sum::<usize>() <= MOST);
    }

    #[test]
    fn curves_and_areas_are_cut_at_the_panel() {
        let pole = [(0.0, 50.0), (50.0, 1e12), (100.0, 50.0), (300.0, 50.0)];
        let [before, after] = &visible(&pole, (100.0, 100.0))[..] else { panic!("two pieces") };
        assert_eq!((before[0], before[1].1, after.last()), ((0.0, 50.0), 120.0, Some(&(120.0, 50.0))));
        let square = [(10.0, 10.0), (90.0, 10.0), (90.0, 90.0), (10.0, 90.0)];
        assert_eq!(enclosed(&square, (100.0, 100.0)), square);
        let mut corners = enclosed(&[(50.0, 50.0), (1e9, 50.0), (1e9, 1e9), (50.0, 1e9)], (100.0, 100.0));
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [(50.0, 50.0), (50.0, 120.0), (120.0, 50.0), (120.0, 120.0)]);
        assert!(enclosed(&[(200.0, 0.0), (300.0, 0.0), (300.0, 50.0)], (100.0, 100.0)).is_empty());
    }
}
