//! What is drawn in a panel, in the coordinates of its axes.

use super::axis::PlotArea;
use super::canvas::{Anchor, PlotLayer, Stroke, TextLine};
use super::color::Color;
use super::mark::{Mark, arrow};
use super::names;
use super::text_box::TextBox;
use super::{Pixel, PlotPoint, curve};
use std::collections::BTreeSet;

/// Something that is drawn, in the coordinates of its panel's axes; fonts, marks and strokes are in px.
#[derive(Debug, Clone)]
pub enum PlotShape {
    /// A line through all points; a point that has no place on the axes interrupts it.
    Line { points: Vec<PlotPoint>, stroke: Stroke },
    /// A mark of half this width at each point.
    Marks { points: Vec<PlotPoint>, mark: Mark, color: Color, size: f64 },
    /// Closed loops of corners; what lies within an odd number of them is filled.
    Area { loops: Vec<Vec<PlotPoint>>, fill: Option<Color>, stroke: Option<Stroke> },
    /// A circle, its radius in units of the x axis; round if both axes have one scale.
    Circle { center: PlotPoint, radius: f64, fill: Option<Color>, stroke: Option<Stroke> },
    /// An arrow to its tip; a short one has a smaller head.
    Arrow { from: PlotPoint, to: PlotPoint, stroke: Stroke },
    /// A line of text with its middle at a point, with a white rim that keeps it readable over lines.
    Text { at: PlotPoint, text: String, size: u32 },
    /// Names of points, which keep clear of each other, and may stand rather below their points than above.
    Names { names: Vec<(PlotPoint, String)>, below: bool },
}

impl PlotShape {
    /// The points that its panel's axes must span.
    pub(in crate::draw) fn extent(&self) -> Vec<PlotPoint> {
        match self {
            Self::Line { points, .. } | Self::Marks { points, .. } => points.clone(),
            Self::Area { loops, .. } => loops.concat(),
            &Self::Circle { center: (x, y), radius, .. } => vec![(x - radius, y - radius), (x + radius, y + radius)],
            &Self::Arrow { from, to, .. } => vec![from, to],
            Self::Text { at, .. } => vec![*at],
            Self::Names { names, .. } => names.iter().map(|(point, _)| *point).collect(),
        }
    }

    /// Where it has marks, which no name may cover.
    pub(super) fn marked(&self, area: &PlotArea) -> Vec<TextBox> {
        let Self::Marks { points, size, .. } = self else { return Vec::new() };
        points.iter().filter_map(|&point| Some(TextBox::around(area.place(point)?, *size))).collect()
    }

    /// Draws it into `out`; names keep clear of what is `taken`.
    pub(super) fn draw(&self, area: &PlotArea, taken: &mut Vec<TextBox>, out: &mut PlotLayer) {
        match self {
            Self::Line { points, stroke } => {
                let placed: Vec<Option<Pixel>> = points.iter().map(|&point| area.place(point)).collect();
                for part in placed.split(Option::is_none) {
                    let part: Vec<Pixel> = part.iter().copied().flatten().collect();
                    curve::visible(&part, area.size()).into_iter().for_each(|piece| out.line(piece, *stroke));
                }
            }
            Self::Marks { points, mark, color, size } => {
                let mut drawn = BTreeSet::new();
                let seen = points.iter().filter_map(|&point| area.place(point)).filter(|&(x, y)| {
                    // A mark within a tenth of a pixel of another one is not seen.
                    area.holds((x, y)) && drawn.insert(((10.0 * x).round() as i64, (10.0 * y).round() as i64))
                });
                seen.for_each(|at| mark.draw(at, *color, *size, out));
            }
            Self::Area { loops, fill, stroke } => {
                let enclosed = |corners: &Vec<PlotPoint>| {
                    let placed: Vec<Pixel> = corners.iter().filter_map(|&corner| area.place(corner)).collect();
                    curve::enclosed(&placed, area.size())
                };
                out.area(loops.iter().map(enclosed).collect(), *fill, *stroke);
            }
            &Self::Circle { center, radius, fill, stroke } => {
                let Some(center) = area.place(center) else { return };
                out.circle(center, radius * area.x.scale(), fill, stroke);
            }
            &Self::Arrow { from, to, stroke } => {
                if let (Some(from), Some(to)) = (area.place(from), area.place(to)) {
                    arrow(from, to, stroke, out);
                }
            }
            Self::Text { at, text, size } => {
                let Some((x, y)) = area.place(*at) else { return };
                let at = (x, TextLine::baseline(y, *size));
                out.text(TextLine { rim: true, ..TextLine::new(at, text, *size, Anchor::Middle) });
            }
            Self::Names { names, below } => names::draw(names, *below, area, taken, out),
        }
    }
}
