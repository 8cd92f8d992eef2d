//! Pictures, as SVG and PNG.
//!
//! ```text
//!     Picture: rows of panels, a legend
//!       Panel: axes, bands, shapes --axis--> PlotArea --panel, shape, mark, names, curve--┐
//!       Legend --legend-------------------------------------------------------------------┴-> Canvas --> SVG
//!                                                                                                 --png--> PNG
//! ```
//!
//! The same input gives the same bytes everywhere: texts are measured, and drawn in a PNG, with one embedded font,
//! never with the system's. However many points a curve has, an SVG has no more of them than are seen.

mod color;
mod font;
mod canvas;
mod text_box;
mod png;
mod axis;
mod curve;
mod mark;
mod names;
mod shape;
mod panel;
mod legend;

pub use axis::PlotAxis;
pub use canvas::{Dash, Pixel, Stroke};
pub use color::Color;
pub use legend::{LegendEntry, LegendKey};
pub use mark::{MARK, Mark};
pub use panel::{Band, Panel};
pub use shape::PlotShape;
pub use text_box::TextBox;

use crate::Result;
use canvas::{Anchor, Canvas, PlotLayer, TextLine};
use legend::Legend;
use panel::{Margins, PlacedPanel};
use serde::Serialize;

/// A point in the coordinates of a panel's axes.
pub type PlotPoint = (f64, f64);

/// Panels in rows, and a legend below them.
#[derive(Debug, Clone, Default)]
pub struct Picture {
    /// Above the picture.
    pub title: String,
    /// From top to bottom; panels of a row stand side by side, those of a column below each other.
    pub rows: Vec<Vec<Panel>>,
    /// The meanings of the signs.
    pub legend: Vec<LegendEntry>,
}

/// A picture as SVG, and where its data are in it.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The picture.
    pub svg: String,
    /// The inside of each panel that is drawn, row by row.
    pub windows: Vec<PlotWindow>,
}

/// The inside of a panel's axes in the picture: what a cursor needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlotWindow {
    /// Its upper left corner \[px\].
    pub corner: Pixel,
    /// Its width and height \[px\].
    pub size: Pixel,
    /// The values at the left and right end of its x axis.
    pub x: (f64, f64),
    /// The values at the lower and upper end of its y axis.
    pub y: (f64, f64),
}

/// Around the whole picture \[px\].
const EDGE: f64 = 12.0;
/// Between panels, and between them and the legend \[px\].
const GAP: f64 = 12.0;
/// Height of the title's font \[px\].
const TITLE: u32 = 16;

impl Picture {
    /// The picture as SVG; `None` if nothing in it can be drawn.
    pub fn svg(&self) -> Option<String> {
        self.render().map(|rendered| rendered.svg)
    }

    /// The picture as SVG, with the places of its panels; `None` if nothing in it can be drawn.
    pub fn render(&self) -> Option<Rendered> {
        let (canvas, windows) = self.layout()?;
        Some(Rendered { svg: canvas.svg(), windows })
    }

    /// The picture as PNG, twice as large as the SVG says; `None` if nothing in it can be drawn.
    ///
    /// # Errors
    /// [`Unsupported`](crate::Reason::Unsupported) if the picture cannot be rendered.
    pub fn png(&self) -> Result<Option<Vec<u8>>> {
        self.layout().map(|(canvas, _)| png::png(&canvas)).transpose()
    }

    fn layout(&self) -> Option<(Canvas, Vec<PlotWindow>)> {
        let rows: Vec<Vec<PlacedPanel>> =
            self.rows.iter().map(|row| row.iter().filter_map(PlacedPanel::new).collect()).collect();
        let rows: Vec<Vec<PlacedPanel>> = rows.into_iter().filter(|row| !row.is_empty()).collect();
        let scale = rows.first()?.first()?.area.scale();
        let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
        let columns: Vec<Track> =
            (0..columns).map(|column| Track::of(rows.iter().filter_map(|row| row.get(column)))).collect();
        let lines: Vec<Track> = rows.iter().map(|row| Track::of(row.iter())).collect();
        let width = columns.iter().map(Track::width).sum::<f64>() + GAP * (columns.len() - 1) as f64;

        let mut layer = PlotLayer::default();
        let title = font::lines(&self.title, TITLE, width);
        for (line, content) in title.iter().enumerate() {
            let baseline = EDGE + f64::from(TITLE) * (0.9 + 1.4 * line as f64);
            layer.text(TextLine::new((EDGE + 0.5 * width, baseline), content, TITLE, Anchor::Middle));
        }
        let mut windows = Vec::new();
        let mut top = EDGE + title.len() as f64 * 1.4 * f64::from(TITLE);
        for (row, line) in rows.iter().zip(&lines) {
            let mut left = EDGE;
            for (panel, column) in row.iter().zip(&columns) {
                let corner = (left + column.margins.left, top + line.margins.top);
                panel.draw(corner, column.margins.left, &mut layer);
                windows.push(panel.area.window(corner));
                left += column.width() + GAP;
            }
            top += line.height() + GAP;
        }

        let legend = Legend::new(&self.legend, width, scale);
        let (legend_width, height) = if self.legend.is_empty() { (0.0, 0.0) } else { legend.size() };
        let indent = columns.first().map_or(0.0, |column| column.margins.left);
        let indent = if legend_width + indent <= width { indent } else { 0.0 };
        legend.draw((EDGE + indent, top), &mut layer);
        let size = ((width.max(legend_width) + 2.0 * EDGE).ceil(), (top + height + EDGE).ceil());
        Some((Canvas { size, layer }, windows))
    }
}

/// A row or a column of panels: the most that they need around their axes and inside of them.
struct Track {
    margins: Margins,
    size: Pixel,
}

impl Track {
    fn of<'p>(panels: impl Iterator<Item = &'p PlacedPanel<'p>>) -> Self {
        let empty = Self { margins: Margins::default(), size: (0.0, 0.0) };
        panels.fold(empty, |Self { margins: most, size }, panel| {
            let margins = panel.margins();
            Self {
                margins: Margins {
                    left: most.left.max(margins.left),
                    right: most.right.max(margins.right),
                    top: most.top.max(margins.top),
                    bottom: most.bottom.max(margins.bottom),
                },
                size: (size.0.max(panel.area.size.0), size.1.max(panel.area.size.1)),
            }
        })
    }

    fn width(&self) -> f64 {
        self.margins.left + self.size.0 + self.margins.right
    }

    fn height(&self) -> f64 {
        self.margins.top + self.size.1 + self.margins.bottom
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(label: &str, logarithmic: bool) -> PlotAxis {
        PlotAxis { label: label.into(), logarithmic, ..PlotAxis::default() }
    }

    fn marks(points: Vec<PlotPoint>) -> Picture {
        let shapes = vec![PlotShape::Marks { points, mark: Mark::Circle, color: Color::Blue, size: MARK }];
        let panel = Panel { shapes, ..Panel::new(axis("time [s]", true), axis("error", true)) };
        let entry = LegendEntry { name: "f64".into(), key: LegendKey::Mark(Mark::Circle, Color::Blue) };
        Picture { title: "title".into(), rows: vec![vec![panel]], legend: vec![entry] }
    }

    #[test]
    fn points_off_the_axes_are_left_out() {
        assert_eq!(marks(vec![(0.0, 1.0), (1.0, f64::NAN)]).svg(), None);
        let svg = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7), (1.0, 0.0)]).svg().unwrap();
        assert!(svg.starts_with("<svg"));
        assert!(!svg.contains("NaN"));
        assert_eq!(svg.matches("<circle").count(), 3, "two points and the key");
    }

    #[test]
    fn a_png_has_the_same_bytes_each_time() {
        let picture = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7)]);
        let png = picture.png().unwrap().unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(picture.png().unwrap().unwrap(), png);
    }
}
