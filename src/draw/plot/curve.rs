//! A curve on the screen, cut where it leaves the panel and without corners that nobody sees.
//!
//! ```text
//!     points [px] --parts inside--> pieces --Douglas and Peucker 1973--> the fewest corners within a tenth of a pixel
//! ```

use super::Pixel;

/// Corners that are left out lie no farther from the curve than this \[px\].
const SEEN: f64 = 0.1;
/// A curve that needs more corners than this is drawn more coarsely.
const MOST: usize = 4000;
/// How far beyond the panel a curve goes on \[px\], so that its end and the corners of wide strokes are not seen.
const BEYOND: f64 = 20.0;

/// The pieces of the curve through `points` that lie within `width` and `height` \[px\], or just beyond.
pub(super) fn visible(points: &[Pixel], (width, height): Pixel) -> Vec<Vec<Pixel>> {
    let mut pieces: Vec<Vec<Pixel>> = Vec::new();
    let mut open = false;
    for pair in points.windows(2) {
        let Some((from, to)) = within(pair[0], pair[1], (width, height)) else {
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

/// The part of the area within a closed loop of `corners` that lies within the panel, or just beyond: its corners.
pub(super) fn enclosed(corners: &[Pixel], (width, height): Pixel) -> Vec<Pixel> {
    let Some((&first, rest)) = corners.split_first() else { return Vec::new() };
    // A loop's ends are one point; where it has gone half its way it is cut, so that each half is a curve with two
    // ends.
    let (once, again) = rest.split_at(rest.len() / 2);
    let turn = once.last().copied().unwrap_or(first);
    let halves = [[&[first], once].concat(), [&[turn], again, &[first]].concat()];
    let thin = halves.iter().flat_map(|half| {
        let mut half = thinned(half);
        half.pop();
        half
    });
    // For each side, how far a point is inside of it.
    let sides: [fn(Pixel, f64, f64) -> f64; 4] = [
        |(x, _), _, _| x + BEYOND,
        |(x, _), width, _| width + BEYOND - x,
        |(_, y), _, _| y + BEYOND,
        |(_, y), _, height| height + BEYOND - y,
    ];
    sides.iter().fold(thin.collect(), |corners, side| cut(&corners, |point| side(point, width, height)))
}

/// The part of a polygon whose points are `inside` by zero or more (Sutherland and Hodgman 1974).
fn cut(corners: &[Pixel], inside: impl Fn(Pixel) -> f64) -> Vec<Pixel> {
    let mut kept = Vec::with_capacity(corners.len());
    for (at, &to) in corners.iter().enumerate() {
        let from = corners[(at + corners.len() - 1) % corners.len()];
        let (before, after) = (inside(from), inside(to));
        if (before < 0.0) != (after < 0.0) {
            let share = before / (before - after);
            kept.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
        }
        if after >= 0.0 {
            kept.push(to);
        }
    }
    kept
}

/// The part of a segment inside of the panel (Liang and Barsky 1984).
fn within(from: Pixel, to: Pixel, (width, height): Pixel) -> Option<(Pixel, Pixel)> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    let sides =
        [(-dx, from.0 + BEYOND), (dx, width + BEYOND - from.0), (-dy, from.1 + BEYOND), (dy, height + BEYOND - from.1)];
    for (speed, distance) in sides {
        if speed == 0.0 {
            if distance < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            first = first.max(distance / speed);
        } else {
            last = last.min(distance / speed);
        }
    }
    let at = |share: f64| (from.0 + share * dx, from.1 + share * dy);
    let start = if first > 0.0 { at(first) } else { from };
    let end = if last < 1.0 { at(last) } else { to };
    (first <= last).then_some((start, end))
}

/// The curve with no more corners than it needs.
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

/// Corners so that no point is farther than `tolerance` from the line through them.
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

/// The distance of a point from a segment.
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
    fn a_bent_line_keeps_its_ends_and_its_corner() {
        let line: Vec<Pixel> = (0..=100).map(|at| (f64::from(at), 2.0 * f64::from(at.min(50)))).collect();
        assert_eq!(visible(&line, (200.0, 200.0)), [[(0.0, 0.0), (50.0, 100.0), (100.0, 100.0)]]);
    }

    #[test]
    fn a_thinned_curve_stays_within_a_tenth_of_a_pixel() {
        let curve: Vec<Pixel> =
            (0..20_000).map(|at| f64::from(at) * 0.03).map(|x| (x, 200.0 + 150.0 * libm::sin(0.05 * x))).collect();
        let pieces = visible(&curve, (600.0, 400.0));
        assert_eq!(pieces.len(), 1);
        let thin = &pieces[0];
        assert!(thin.len() < 400, "{}", thin.len());
        for &point in &curve {
            let nearest = thin.windows(2).map(|pair| distance(point, pair[0], pair[1])).fold(f64::INFINITY, f64::min);
            assert!(nearest <= SEEN, "{point:?} is {nearest} px away");
        }
    }

    #[test]
    fn a_curve_is_cut_at_the_panel() {
        let pole = [(0.0, 50.0), (50.0, 1e12), (100.0, 50.0), (300.0, 50.0)];
        let pieces = visible(&pole, (100.0, 100.0));
        assert_eq!(pieces.len(), 2);
        assert_eq!(pieces[0][0], (0.0, 50.0));
        assert_eq!(pieces[0][1].1, 120.0);
        assert_eq!(pieces[1].last(), Some(&(120.0, 50.0)));
    }

    #[test]
    fn an_area_is_cut_at_the_panel() {
        let square = [(10.0, 10.0), (90.0, 10.0), (90.0, 90.0), (10.0, 90.0)];
        assert_eq!(enclosed(&square, (100.0, 100.0)), square);
        let huge = [(50.0, 50.0), (1e9, 50.0), (1e9, 1e9), (50.0, 1e9)];
        let mut corners = enclosed(&huge, (100.0, 100.0));
        corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert_eq!(corners, [(50.0, 50.0), (50.0, 120.0), (120.0, 50.0), (120.0, 120.0)]);
        assert!(enclosed(&[(200.0, 0.0), (300.0, 0.0), (300.0, 50.0)], (100.0, 100.0)).is_empty());
    }

    #[test]
    fn noise_is_drawn_coarsely() {
        let noise: Vec<Pixel> = (0..50_000).map(|at| (f64::from(at) * 0.01, f64::from(at * 7919 % 400))).collect();
        assert!(visible(&noise, (600.0, 400.0)).iter().map(Vec::len).sum::<usize>() <= MOST);
    }
}
