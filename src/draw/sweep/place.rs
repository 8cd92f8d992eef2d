//! Places for texts between curves.

use crate::draw::plot::{Pixel, TextBox};
use std::f64::consts::TAU;

/// The largest distance between the points at which the distance from a segment is measured \[px\].
const PIECE: f64 = 2.0;

/// Returns the distance of a text from the nearest curve \[px\]; negative if a curve crosses the text.
pub fn clear_of(text: &TextBox, curves: &[Vec<Pixel>]) -> f64 {
    let reach = libm::hypot(text.half.0, text.half.1);
    let mut least = f64::INFINITY;
    for pair in curves.iter().flat_map(|curve| curve.windows(2)) {
        let [a, b] = [pair[0], pair[1]];
        let length = libm::hypot(b.0 - a.0, b.1 - a.1);
        // No point of the segment is nearer to the text than its first end by more than the segment's length.
        if libm::hypot(a.0 - text.middle.0, a.1 - text.middle.1) - length - reach > least {
            continue;
        }
        let pieces = (length / PIECE).ceil().max(1.0);
        for k in 0..=pieces as usize {
            let share = k as f64 / pieces;
            least = least.min(text.distance((a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))));
        }
    }
    least
}

/// Returns whether a point is inside a loop.
pub fn encloses(corners: &[Pixel], (x, y): Pixel) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crosses =
        |&(a, b): &(&Pixel, &Pixel)| (a.1 > y) != (b.1 > y) && x < a.0 + (b.0 - a.0) * (y - a.1) / (b.1 - a.1);
    edges.filter(crosses).count() % 2 == 1
}

/// Returns the points at this distance \[px\] in `directions` evenly spaced directions.
pub fn around((x, y): Pixel, distance: f64, directions: usize) -> impl Iterator<Item = Pixel> {
    let angle = move |direction: usize| direction as f64 * TAU / directions as f64;
    (0..directions).map(angle).map(move |angle| (x + distance * libm::cos(angle), y + distance * libm::sin(angle)))
}

/// A text with at least this much room on all sides is well placed \[px\].
pub const ENOUGH: f64 = 12.0;
/// The largest number of moves of a text, the largest distance of a move \[px\], and the number of directions.
const MOVES: usize = 60;
const STEP: f64 = 4.0;
const DIRECTIONS: usize = 8;

/// Moves a text of this half size from `start` toward more room, without crossing a curve. Returns its middle \[px\].
pub fn freest(start: Pixel, half: Pixel, curves: &[Vec<Pixel>]) -> Pixel {
    let room = |middle: Pixel| clear_of(&TextBox { middle, half }, curves);
    let (mut middle, mut best) = (start, room(start));
    for _ in 0..MOVES {
        if best >= ENOUGH {
            break;
        }
        let step = STEP.min(0.9 * clear_of(&TextBox { middle, half: (0.0, 0.0) }, curves));
        let moved = around(middle, step, DIRECTIONS).map(|at| (room(at), at));
        let freer = moved.max_by(|(a, _), (b, _)| a.total_cmp(b));
        match freer.filter(|(room, _)| *room > best) {
            Some((room, at)) => (middle, best) = (at, room),
            None => break,
        }
    }
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_count_from_the_edge_of_a_text() {
        let text = TextBox { middle: (50.0, 50.0), half: (20.0, 5.0) };
        assert_eq!(clear_of(&text, &[vec![(0.0, 70.0), (100.0, 70.0)]]), 15.0);
        assert_eq!(clear_of(&text, &[vec![(50.0, 0.0), (50.0, 100.0)]]), -5.0);
        assert_eq!(clear_of(&text, &[vec![(73.0, 59.0), (73.0, 59.0)]]), 5.0);
        assert!(text.is_within((70.0, 55.0)) && !text.is_within((69.0, 55.0)));
    }

    #[test]
    fn a_text_in_a_wedge_moves_to_where_it_fits() {
        let wedge = [vec![(0.0, 0.0), (200.0, 40.0)], vec![(0.0, 0.0), (200.0, -40.0)]];
        let (x, y) = freest((40.0, 0.0), (6.0, 6.0), &wedge);
        assert!(clear_of(&TextBox { middle: (x, y), half: (6.0, 6.0) }, &wedge) > 1.0, "{x} {y}");
    }

    #[test]
    fn a_text_moves_through_no_wall() {
        let walls = [0.0, 30.0, 100.0].map(|x| vec![(x, -100.0), (x, 100.0)]);
        let (x, _) = freest((9.0, 0.0), (5.0, 5.0), &walls);
        assert!((x - 15.0).abs() < STEP, "{x}");
        assert_eq!(freest((60.0, 0.0), (5.0, 5.0), &walls), (60.0, 0.0));
    }
}
