//! Pictures as SVG and PNG.
//!
//! ```text
//!     Picture: rows of panels, a legend
//!       Panel: axes, bands, shapes --axis--> PlotArea --panel, shape, mark, curve--------┐
//!       Legend --legend-------------------------------------------------------------------┴-> Canvas --> SVG
//!                                                                                                 --png--> PNG
//! ```
//!
//! The same input gives the same bytes on every machine. Texts are measured, and drawn in a PNG, with an embedded font;
//! fonts of the system are never used. An SVG contains only the points of a curve that make a visible difference.

mod color;
mod font;
mod canvas;
mod png;
mod axis;
mod curve;
mod mark;
mod shape;
mod panel;
mod legend;

pub(in crate::draw) use axis::significant;
pub use axis::{PlotAxis, range};
pub use canvas::{Dash, Stroke};
pub use color::Color;
pub use font::TextBox;
pub use legend::{LegendEntry, LegendKey};
pub use mark::{MARK, Mark};
pub use panel::{Band, Panel};
pub use shape::PlotShape;

use crate::Result;
use crate::error::visible;
use canvas::{Anchor, Canvas, PlotLayer, TextLine};
use legend::Legend;
use panel::{PlacedPanel, Track};
use serde::Serialize;

/// A point or a distance on the screen: to the right, then down \[px\].
pub type Pixel = (f64, f64);

/// A point in the coordinates of a panel's axes.
pub type PlotPoint = (f64, f64);

/// A title, rows of panels, and a legend below them.
#[derive(Debug, Clone, Default)]
pub struct Picture {
    /// The text above the panels.
    pub title: String,
    /// The rows from top to bottom. The panels of a row are side by side, and the panels of all rows align in columns.
    pub rows: Vec<Vec<Panel>>,
    /// The symbols and their meanings.
    pub legend: Vec<LegendEntry>,
}

/// A picture as SVG, and the places of its panels.
#[derive(Debug, Clone, Default)]
pub struct Rendered {
    pub svg: String,
    /// The area inside the axes of each panel that is drawn, row by row.
    pub windows: Vec<PlotWindow>,
}

/// The area inside a panel's axes, in the picture and in values; it places a cursor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlotWindow {
    /// The upper left corner \[px\].
    pub corner: Pixel,
    /// Width and height \[px\].
    pub size: Pixel,
    /// The values at the left and right end of the x axis, and at the lower and upper end of the y axis.
    pub x: (f64, f64),
    pub y: (f64, f64),
}

/// The margin around the whole picture \[px\].
const EDGE: f64 = 12.0;
/// The gap between panels, and between panels and legend \[px\].
const GAP: f64 = 12.0;
/// The font size of the title \[px\].
const TITLE: u32 = 16;

impl Picture {
    /// Returns the picture as SVG; `None` if nothing in it can be drawn, or if a coordinate or an axis is not finite.
    pub fn svg(&self) -> Option<String> {
        self.render().map(|rendered| rendered.svg)
    }

    /// Returns the picture as SVG with the places of its panels; `None` as for [`Picture::svg`].
    pub fn render(&self) -> Option<Rendered> {
        let (canvas, windows) = self.layout()?;
        Some(Rendered { svg: canvas.svg(), windows })
    }

    /// Returns the picture as PNG, with twice the SVG's width and height in pixels; `None` as for [`Picture::svg`].
    ///
    /// # Errors
    /// Returns an error if the picture has too many pixels or cannot be encoded.
    pub fn png(&self) -> Result<Option<Vec<u8>>> {
        self.layout().map(|(canvas, _)| png::png(&canvas)).transpose()
    }

    fn layout(&self) -> Option<(Canvas, Vec<PlotWindow>)> {
        let rows = self.rows.iter().map(|row| row.iter().filter_map(PlacedPanel::new).collect::<Vec<_>>());
        let rows: Vec<Vec<PlacedPanel>> = rows.filter(|row| !row.is_empty()).collect();
        let scale = rows.first()?.first()?.area.x.scale();
        let columns = (0..rows.iter().map(Vec::len).max()?).map(|column| {
            let panels = rows.iter().filter_map(|row| row.get(column));
            Track::most(panels.map(|panel| panel.tracks()[0]))
        });
        let columns: Vec<Track> = columns.collect();
        let width = columns.iter().map(Track::whole).sum::<f64>() + GAP * (columns.len() - 1) as f64;

        let mut layer = PlotLayer::default();
        let title = font::lines(&self.title, TITLE, width);
        for (line, content) in title.iter().enumerate() {
            let baseline = EDGE + f64::from(TITLE) * (0.9 + 1.4 * line as f64);
            layer.text(TextLine::new((EDGE + 0.5 * width, baseline), content, TITLE, Anchor::Middle));
        }
        let mut windows = Vec::new();
        let mut top = EDGE + title.len() as f64 * 1.4 * f64::from(TITLE);
        for row in &rows {
            let (line, mut left) = (Track::most(row.iter().map(|panel| panel.tracks()[1])), EDGE);
            for (panel, column) in row.iter().zip(&columns) {
                let corner = (left + column.before, top + line.before);
                panel.draw(corner, column.before, &mut layer);
                let (size, x, y) = (panel.area.size(), panel.area.x.ends(), panel.area.y.ends());
                windows.push(PlotWindow { corner, size, x, y });
                left += column.whole() + GAP;
            }
            top += line.whole() + GAP;
        }

        let legend = Legend::new(&self.legend, width, scale);
        let (legend_width, height) = legend.size();
        let indent = if legend_width + columns[0].before <= width { columns[0].before } else { 0.0 };
        legend.draw((EDGE + indent, top), &mut layer);
        let size = ((width.max(legend_width) + 2.0 * EDGE).ceil(), (top + height + EDGE).ceil());
        let is_scaled = |window: &PlotWindow| {
            [window.x, window.y].into_iter().all(|(low, high)| low.is_finite() && high.is_finite() && low < high)
        };
        let description = self.description(rows.iter().flatten());
        let [title, description] = [&self.title, &description].map(|text| visible(&font::readable(text)).into_owned());
        let canvas = Canvas { title, description, size, layer };
        (canvas.layer.is_placed() && windows.iter().all(is_scaled)).then_some((canvas, windows))
    }

    /// Describes the panels and the legend in sentences, for the SVG's `desc`.
    fn description<'p>(&self, panels: impl Iterator<Item = &'p PlacedPanel<'p>>) -> String {
        let axes = |Panel { x, y, .. }: &Panel| {
            Some(format!("{} against {}", y.label, x.label)).filter(|_| !y.label.is_empty() && !x.label.is_empty())
        };
        let panel = |placed: &PlacedPanel| {
            let title = Some(placed.panel.title.trim().replace('\n', ", ")).filter(|title| !title.is_empty());
            title.into_iter().chain(axes(placed.panel)).collect::<Vec<_>>().join(": ")
        };
        let legend = self.legend.iter().map(|entry| entry.name.replace('\n', ", "));
        let sentences = panels.map(panel).chain(legend).filter(|sentence| !sentence.is_empty());
        sentences.map(|sentence| sentence + ".").collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn marks(points: Vec<PlotPoint>) -> Picture {
        let axis = |label| PlotAxis { logarithmic: true, ..PlotAxis::new(label) };
        let shapes = vec![PlotShape::Marks { points, mark: Mark::Circle, color: Color::Blue, size: MARK }];
        let panel = Panel { shapes, ..Panel::new(axis("time [s]"), axis("error")) };
        let legend = vec![LegendEntry::new("f64", LegendKey::Mark(Mark::Circle, Color::Blue))];
        Picture { title: "title".into(), rows: vec![vec![panel]], legend }
    }

    #[test]
    fn points_off_the_axes_are_left_out() {
        assert_eq!(marks(vec![(0.0, 1.0), (1.0, f64::NAN)]).svg(), None);
        let svg = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7), (1.0, 0.0)]).svg().unwrap();
        assert!(svg.starts_with("<svg") && !svg.contains("NaN"));
        assert_eq!(svg.matches("<circle").count(), 3, "two points and the key");
    }

    #[test]
    fn picture_without_scale_is_refused_and_none_has_nan() {
        let outline = |size: f64| {
            let points = vec![(0.0, -size), (size, 0.0), (-size, size)];
            let shapes = vec![PlotShape::Marks { points, mark: Mark::Circle, color: Color::Blue, size: MARK }];
            let panel = Panel { shapes, equal: true, ..Panel::new(PlotAxis::new("x [m]"), PlotAxis::new("z [m]")) };
            Picture { title: "title".into(), rows: vec![vec![panel]], legend: Vec::new() }.svg()
        };
        for size in [1e-300, 1e-150, 1.0, 1e17, 1e150, 1e300] {
            let svg = outline(size).unwrap_or_else(|| panic!("{size} can be scaled"));
            assert!(
                !svg.contains("NaN") && !svg.contains("inf") && svg.matches("<circle").count() == 3,
                "{size}: {svg}"
            );
        }
        assert_eq!(outline(1.7e308), None);
    }

    #[test]
    fn a_png_has_the_same_bytes_each_time() {
        let picture = marks(vec![(1e-6, 1e-15), (1e-3, 1e-7)]);
        let png = picture.png().unwrap().unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(picture.png().unwrap().unwrap(), png);
    }
}
