//! Names next to their points, so that none covers another.
//!
//! ```text
//!     names in their order --> the nearest free place about the point, rings outward --> text, and a line where it is far
//! ```

use super::axis::PlotArea;
use super::canvas::{Anchor, Layer, Stroke, Text};
use super::color::Color;
use super::{Pixel, PlotPoint, font};

/// Height of the font \[px\].
const SIZE: u32 = 11;
/// From a point to its name \[px\].
const GAP: f64 = 8.0;
/// From one ring of places to the next \[px\].
const RING: f64 = 13.0;
const RINGS: i32 = 8;
/// A name farther from its point has a line to it \[px\].
const FAR: f64 = 20.0;

/// The place of something that no name may cover \[px\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Footprint {
    left: f64,
    right: f64,
    middle: f64,
    /// Half its height.
    half: f64,
}

impl Footprint {
    /// All within so many pixels of a point.
    pub fn about((x, y): Pixel, reach: f64) -> Self {
        Self { left: x - reach, right: x + reach, middle: y, half: reach }
    }

    fn meets(self, other: Self) -> bool {
        let apart = (self.middle - other.middle).abs();
        self.left < other.right + 2.0 && other.left < self.right + 2.0 && apart < self.half + other.half
    }

    fn is_inside(self, (width, height): Pixel) -> bool {
        let Self { left, right, middle, half } = self;
        left >= 0.0 && right <= width && middle >= half && middle <= height - half
    }
}

/// Draws each name next to its point, clear of the others and of what is `taken`. It looks for a place below the point
/// first, or next to and above it.
pub(super) fn draw(
    names: &[(PlotPoint, String)],
    below: bool,
    area: &PlotArea,
    taken: &mut Vec<Footprint>,
    out: &mut Layer,
) {
    for (point, name) in names {
        let Some(at) = area.place(*point) else { continue };
        let width = font::width(name, SIZE);
        let is_free = |place: &Footprint| place.is_inside(area.size) && !taken.iter().any(|other| other.meets(*place));
        let free = places(at, width, below).find(is_free);
        let Some(place) = free.or_else(|| places(at, width, below).next()) else { continue };
        taken.push(place);
        let near = (at.0.clamp(place.left, place.right), place.middle);
        if libm::hypot(near.0 - at.0, near.1 - at.1) > FAR {
            out.line(vec![at, near], Stroke::solid(Color::Gray, 0.6));
        }
        let baseline = (place.left, Text::baseline(place.middle, SIZE));
        out.text(Text { rim: true, ..Text::new(baseline, name, SIZE, Anchor::Start) });
    }
}

/// Places for a name so wide, the nearest first.
fn places((x, y): Pixel, width: f64, below: bool) -> impl Iterator<Item = Footprint> {
    // A point that is named below lies on a line that a name next to it would cover.
    let (nearest, down) = if below { (1, 1.0) } else { (0, -1.0) };
    (nearest..=RINGS).flat_map(move |ring| {
        let reach = f64::from(ring) * RING;
        let middles = [y + down * reach, y - down * reach];
        let lefts = [x + GAP, x - GAP - width, x + GAP + reach, x - GAP - reach - width];
        middles.into_iter().flat_map(move |middle| {
            lefts.into_iter().map(move |left| Footprint { left, right: left + width, middle, half: 0.5 * RING - 0.5 })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::plot::axis::{PlotAxis, Span};

    #[test]
    fn names_of_one_point_do_not_cover_each_other() {
        let axis = PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let span = || Span::new(&axis, std::iter::empty(), 300.0);
        let area = PlotArea { x: span(), y: span(), size: (300.0, 300.0) };
        let names: Vec<(PlotPoint, String)> = (0..12).map(|at| ((0.5, 0.5), format!("link_{at}"))).collect();
        let mark = Footprint::about((150.0, 150.0), 4.0);
        let mut taken = vec![mark];
        draw(&names, false, &area, &mut taken, &mut Layer::default());
        assert_eq!(taken.len(), 13);
        for (at, place) in taken.iter().enumerate() {
            assert!(place.is_inside(area.size), "{place:?}");
            assert!(!taken[..at].iter().any(|other| other.meets(*place)), "{place:?}");
        }
    }
}
