//! Names next to their points, so that none covers another.
//!
//! ```text
//!     names in their order --> the nearest free place around the point --> text, and a line if it is far away
//! ```

use super::axis::PlotArea;
use super::canvas::{Anchor, PlotLayer, Stroke, TextLine};
use super::color::Color;
use super::font;
use super::text_box::TextBox;
use super::{Pixel, PlotPoint};

/// Height of the font \[px\].
const SIZE: u32 = 11;
/// From a point to its name \[px\].
const GAP: f64 = 8.0;
/// From one ring of places to the next \[px\].
const RING: f64 = 13.0;
const RINGS: i32 = 8;
/// A name farther from its point has a line to it \[px\].
const FAR: f64 = 20.0;

/// Draws each name next to its point, clear of the others and of what is `taken`. It looks for a place below the point
/// first, or next to and above it.
pub(super) fn draw(
    names: &[(PlotPoint, String)],
    below: bool,
    area: &PlotArea,
    taken: &mut Vec<TextBox>,
    out: &mut PlotLayer,
) {
    for (point, name) in names {
        let Some(at) = area.place(*point) else { continue };
        let width = font::width(name, SIZE);
        let is_free = |place: &TextBox| place.is_within(area.size()) && !taken.iter().any(|other| other.meets(place));
        let free = places(at, width, below).find(is_free);
        let Some(place) = free.or_else(|| places(at, width, below).next()) else { continue };
        taken.push(place);
        let (left, right) = (place.middle.0 - place.half.0, place.middle.0 + place.half.0);
        let near = (at.0.clamp(left, right), place.middle.1);
        if libm::hypot(near.0 - at.0, near.1 - at.1) > FAR {
            out.line(vec![at, near], Stroke::solid(Color::Gray, 0.6));
        }
        let baseline = (left, TextLine::baseline(place.middle.1, SIZE));
        out.text(TextLine { rim: true, ..TextLine::new(baseline, name, SIZE, Anchor::Start) });
    }
}

/// Places for a name so wide, the nearest first.
fn places((x, y): Pixel, width: f64, below: bool) -> impl Iterator<Item = TextBox> {
    // A point that is named below lies on a line that a name next to it would cover.
    let (nearest, down) = if below { (1, 1.0) } else { (0, -1.0) };
    (nearest..=RINGS).flat_map(move |ring| {
        let reach = f64::from(ring) * RING;
        let middles = [y + down * reach, y - down * reach];
        let lefts = [x + GAP, x - GAP - width, x + GAP + reach, x - GAP - reach - width];
        middles.into_iter().flat_map(move |middle| {
            let half = (0.5 * width, 0.5 * RING - 0.5);
            lefts.into_iter().map(move |left| TextBox { middle: (left + half.0, middle), half })
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
        let area = PlotArea { x: span(), y: span() };
        let names: Vec<(PlotPoint, String)> = (0..12).map(|at| ((0.5, 0.5), format!("link_{at}"))).collect();
        let mut taken = vec![TextBox::around((150.0, 150.0), 4.0)];
        draw(&names, false, &area, &mut taken, &mut PlotLayer::default());
        assert_eq!(taken.len(), 13);
        for (at, place) in taken.iter().enumerate() {
            assert!(place.is_within(area.size()) && !taken[..at].iter().any(|other| other.meets(place)), "{place:?}");
        }
    }
}
