//! Where texts have room between curves.

use crate::draw::plot::{Pixel, text_size};
use std::f64::consts::TAU;

/// The rectangle that a text takes \[px\].
#[derive(Debug, Clone, Copy)]
pub struct Box {
    /// Its middle.
    pub middle: Pixel,
    /// Half its width and height.
    pub half: Pixel,
}

impl Box {
    /// Half the width and height of a text in letters of this size, and a little about it.
    pub fn half_of(text: &str, letters: u32) -> Pixel {
        let (width, height) = text_size(text, letters);
        (0.5 * width + 3.0, 0.5 * height + 3.0)
    }

    /// Whether it lies within a panel of this size.
    pub fn is_within(&self, (width, height): Pixel) -> bool {
        let ((x, y), (across, up)) = (self.middle, self.half);
        across <= x && x <= width - across && up <= y && y <= height - up
    }

    /// How far a point is from its edge; negative inside.
    fn distance(&self, (x, y): Pixel) -> f64 {
        let (across, up) = ((x - self.middle.0).abs() - self.half.0, (y - self.middle.1).abs() - self.half.1);
        if across > 0.0 || up > 0.0 { libm::hypot(across.max(0.0), up.max(0.0)) } else { across.max(up) }
    }
}

/// A segment is looked at in pieces of this length \[px\].
const PIECE: f64 = 2.0;

/// How far curves are from a text \[px\]; negative where they run into it.
pub fn clear_of(text: &Box, curves: &[Vec<Pixel>]) -> f64 {
    let reach = libm::hypot(text.half.0, text.half.1);
    let mut least = f64::INFINITY;
    for pair in curves.iter().flat_map(|curve| curve.windows(2)) {
        let [a, b] = [pair[0], pair[1]];
        let length = libm::hypot(b.0 - a.0, b.1 - a.1);
        // No point of the segment is nearer than its ends are, less its length.
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

/// A text that has so much room on all sides is well placed \[px\].
const ENOUGH: f64 = 12.0;
/// A text is moved so often, by so much at most \[px\], into one of so many directions.
const MOVES: usize = 60;
const STEP: f64 = 4.0;
const DIRECTIONS: usize = 8;

/// Where about `start` a text of this half size has the most room, without a curve in between.
pub fn freest(start: Pixel, half: Pixel, curves: &[Vec<Pixel>]) -> Pixel {
    let room = |middle: Pixel| clear_of(&Box { middle, half }, curves);
    let (mut middle, mut best) = (start, room(start));
    for _ in 0..MOVES {
        if best >= ENOUGH {
            break;
        }
        let step = STEP.min(0.9 * clear_of(&Box { middle, half: (0.0, 0.0) }, curves));
        let moved = (0..DIRECTIONS).map(|direction| {
            let angle = direction as f64 * TAU / DIRECTIONS as f64;
            (middle.0 + step * libm::cos(angle), middle.1 + step * libm::sin(angle))
        });
        let freer = moved.map(|at| (room(at), at)).max_by(|(a, _), (b, _)| a.total_cmp(b));
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
    fn the_distance_to_a_text_counts_from_its_edge() {
        let text = Box { middle: (50.0, 50.0), half: (20.0, 5.0) };
        assert_eq!(clear_of(&text, &[vec![(0.0, 70.0), (100.0, 70.0)]]), 15.0);
        assert_eq!(clear_of(&text, &[vec![(50.0, 0.0), (50.0, 100.0)]]), -5.0);
        assert_eq!(clear_of(&text, &[vec![(73.0, 59.0), (73.0, 59.0)]]), 5.0);
        assert!(text.is_within((70.0, 55.0)) && !text.is_within((69.0, 55.0)));
    }

    #[test]
    fn a_text_moves_to_where_a_wedge_has_room_for_it() {
        let wedge = [vec![(0.0, 0.0), (200.0, 40.0)], vec![(0.0, 0.0), (200.0, -40.0)]];
        let (x, y) = freest((40.0, 0.0), (6.0, 6.0), &wedge);
        assert!(clear_of(&Box { middle: (x, y), half: (6.0, 6.0) }, &wedge) > 1.0, "{x} {y}");
    }

    #[test]
    fn a_text_moves_away_from_the_nearer_wall_and_through_none() {
        let walls = [0.0, 30.0, 100.0].map(|x| vec![(x, -100.0), (x, 100.0)]);
        let (x, _) = freest((9.0, 0.0), (5.0, 5.0), &walls);
        assert!((x - 15.0).abs() < STEP, "{x}");
        assert_eq!(freest((60.0, 0.0), (5.0, 5.0), &walls), (60.0, 0.0));
    }
}
