//! Names beside their points, so that none covers another.
//!
//! ```text
//!     names in their order --> the nearest free place about the point, rings outward --> text, and a line where it is far
//! ```

use super::colour::Colour;
use super::font;
use super::frame::Frame;
use super::shape::{Anchor, Stroke, path, text};
use super::{Pixel, Point};
use kuva::render::render::Primitive;

/// Height of the font \[px\].
const SIZE: u32 = 11;
/// From a point to its name \[px\].
const GAP: f64 = 8.0;
/// From one ring of places to the next \[px\].
const RING: f64 = 13.0;
const RINGS: i32 = 8;
/// A name farther from its point has a line to it \[px\].
const FAR: f64 = 20.0;

/// Where something stands that no name may cover \[px\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    left: f64,
    right: f64,
    middle: f64,
    /// Half its height.
    half: f64,
}

impl Place {
    /// What is within so many pixels of a point.
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

/// Draws each name beside its point, clear of the others and of what is `taken`; a name is looked for a place below its
/// point, or beside and above it.
pub(super) fn draw(
    names: &[(Point, String)],
    below: bool,
    frame: &Frame,
    taken: &mut Vec<Place>,
    out: &mut Vec<Primitive>,
) {
    for (point, name) in names {
        let Some(at) = frame.place(*point) else { continue };
        let width = font::width(name, SIZE);
        let is_free = |place: &Place| place.is_inside(frame.size) && !taken.iter().any(|other| other.meets(*place));
        let free = places(at, width, below).find(is_free);
        let Some(place) = free.or_else(|| places(at, width, below).next()) else { continue };
        taken.push(place);
        let near = (at.0.clamp(place.left, place.right), place.middle);
        if libm::hypot(near.0 - at.0, near.1 - at.1) > FAR {
            out.push(path(&[&[at, near]], false, None, Some(Stroke::solid(Colour::Grey, 0.6))));
        }
        let baseline = place.middle + 0.5 * font::CAPITAL * f64::from(SIZE);
        text((place.left, baseline), name, SIZE, Anchor::Start, Colour::Black, true, out);
    }
}

/// Places for a name so wide, the nearest first.
fn places((x, y): Pixel, width: f64, below: bool) -> impl Iterator<Item = Place> {
    // What is named below lies on a line that a name beside it would cover.
    let (nearest, down) = if below { (1, 1.0) } else { (0, -1.0) };
    (nearest..=RINGS).flat_map(move |ring| {
        let reach = f64::from(ring) * RING;
        let middles = [y + down * reach, y - down * reach];
        let lefts = [x + GAP, x - GAP - width, x + GAP + reach, x - GAP - reach - width];
        middles.into_iter().flat_map(move |middle| {
            lefts.into_iter().map(move |left| Place { left, right: left + width, middle, half: 0.5 * RING - 0.5 })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::plot::{Axis, Panel};

    #[test]
    fn names_of_one_point_do_not_cover_each_other() {
        let axis = || Axis { range: Some((0.0, 1.0)), ..Axis::default() };
        let frame = Frame::new(&Panel { size: (300.0, 300.0), ..Panel::new(axis(), axis()) });
        let names: Vec<(Point, String)> = (0..12).map(|at| ((0.5, 0.5), format!("link_{at}"))).collect();
        let mark = Place::about((150.0, 150.0), 4.0);
        let mut taken = vec![mark];
        draw(&names, false, &frame, &mut taken, &mut Vec::new());
        assert_eq!(taken.len(), 13);
        for (at, place) in taken.iter().enumerate() {
            assert!(place.is_inside(frame.size), "{place:?}");
            assert!(!taken[..at].iter().any(|other| other.meets(*place)), "{place:?}");
        }
    }
}
