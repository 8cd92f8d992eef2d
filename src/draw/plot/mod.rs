//! Pictures, as SVG and PNG (the only user of kuva, resvg and skrifa).
//!
//! ```text
//!     Picture: rows of panels, a legend
//!       Panel: axes, bands, shapes  --frame, axis-->  kuva's axes and their ticks  ──┐
//!                Shape              --shape, curve--> kuva's primitives            ──┼──> SVG --number--> SVG --png--> PNG
//!       Legend                      --legend-->       kuva's primitives            ──┘
//! ```
//!
//! The same input gives the same bytes everywhere: texts are drawn and measured with one embedded font, never the system's.
//! However many points a curve has, an SVG has no more of them than are seen.

mod axis;
mod colour;
mod curve;
mod font;
mod frame;
mod legend;
mod names;
mod number;
mod png;
mod shape;

pub use axis::Axis;
pub use colour::Colour;
pub use legend::{Arrangement, Entry, Key, Legend};
pub use shape::{Anchor, Dash, Label, MARK, Mark, Shape, Stroke};

use crate::Result;
use frame::{Frame, Margins};
use kuva::backend::svg::SvgBackend;
use kuva::render::render::Scene;
use serde::Serialize;

/// A point in the coordinates of a panel's axes.
pub type Point = (f64, f64);
/// A point or a distance on the screen \[px\].
pub type Pixel = (f64, f64);

/// Panels in rows, and what their signs mean.
#[derive(Debug, Clone, Default)]
pub struct Picture {
    /// Above the picture.
    pub title: String,
    /// From top to bottom; panels of a row stand side by side, those of a column below each other.
    pub rows: Vec<Vec<Panel>>,
    /// What the signs mean.
    pub legend: Legend,
}

/// Shapes over two axes.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Above it; what comes after a line break is smaller.
    pub title: String,
    /// Below it.
    pub x: Axis,
    /// Beside it.
    pub y: Axis,
    /// Width and height inside of the axes \[px\].
    pub size: Pixel,
    /// Whether the axes are drawn.
    pub framed: bool,
    /// Whether a unit is as long on both axes, which then span more than they must.
    pub equal: bool,
    /// What is shaded behind all else, in the order of x.
    pub bands: Vec<Band>,
    /// What is drawn, the first one below the others.
    pub shapes: Vec<Shape>,
}

/// An interval of x that is shaded; a narrow one is a line.
#[derive(Debug, Clone)]
pub struct Band {
    /// Its beginning.
    pub from: f64,
    /// Its end.
    pub to: f64,
    /// What stands at its upper end.
    pub letter: String,
    /// Its colour, a pale one.
    pub fill: Colour,
}

/// How wide and how high a line of text is \[px\].
pub fn text_size(text: &str, size: u32) -> Pixel {
    (font::width(text, size), font::CAPITAL * f64::from(size))
}

/// A picture as SVG, and where its data are in it.
#[derive(Debug, Clone)]
pub struct Rendered {
    /// The picture.
    pub svg: String,
    /// The inside of each panel that is drawn, row by row.
    pub windows: Vec<Window>,
}

/// The inside of a panel's axes in the picture: what a cursor needs to know.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Window {
    /// Its upper left corner \[px\].
    pub corner: Pixel,
    /// Its width and height \[px\].
    pub size: Pixel,
    /// What its x axis has at its left and right end.
    pub x: (f64, f64),
    /// What its y axis has at its lower and upper end.
    pub y: (f64, f64),
}

/// What is about the whole picture \[px\].
const EDGE: f64 = 12.0;
/// Between panels, and between them and the legend \[px\].
const GAP: f64 = 12.0;
/// Height of the title's font \[px\].
const TITLE: u32 = 16;

impl Panel {
    /// A panel of the usual size with these axes and nothing in it.
    pub fn new(x: Axis, y: Axis) -> Self {
        let (title, bands, shapes) = (String::new(), Vec::new(), Vec::new());
        Self { title, x, y, size: (540.0, 420.0), framed: true, equal: false, bands, shapes }
    }

    /// Whether anything in it has a place on its axes.
    fn is_drawn(&self) -> bool {
        let on = |value: f64, axis: &Axis| value.is_finite() && (!axis.logarithmic || value > 0.0);
        let points = || self.shapes.iter().flat_map(Shape::extent);
        points().any(|(x, y)| on(x, &self.x) && on(y, &self.y)) || !self.bands.is_empty()
    }
}

impl Picture {
    /// As SVG; none where nothing can be drawn.
    pub fn svg(&self) -> Option<String> {
        self.render().map(|rendered| rendered.svg)
    }

    /// As SVG, with the places of its panels; none where nothing can be drawn.
    pub fn render(&self) -> Option<Rendered> {
        let rows: Vec<Vec<(&Panel, Frame)>> =
            self.rows.iter().map(|row| drawn(row)).filter(|row| !row.is_empty()).collect();
        let (_, first) = rows.first()?.first()?;
        let columns = rows.iter().map(Vec::len).max().unwrap_or_default();
        let across: Vec<(Margins, f64)> =
            (0..columns).map(|column| widest(rows.iter().filter_map(|row| row.get(column)))).collect();
        let down: Vec<(Margins, f64)> = rows.iter().map(|row| highest(row)).collect();
        let widths = across.iter().map(|(margins, width)| margins.left + width + margins.right);
        let heights = down.iter().map(|(margins, height)| margins.top + height + margins.bottom);
        let panels = (
            widths.sum::<f64>() + GAP * (across.len() - 1) as f64,
            heights.sum::<f64>() + GAP * (down.len() - 1) as f64,
        );

        let scale = first.scale();
        let title = font::lines(&self.title, TITLE, panels.0);
        let above = EDGE + title.len() as f64 * 1.4 * f64::from(TITLE);
        let legend = self.legend.size(panels.0, scale);
        let below = self.legend.arrangement != Arrangement::Beside;
        let (width, height) = match (self.legend.entries.is_empty(), below) {
            (true, _) => panels,
            (false, true) => (panels.0.max(legend.0), panels.1 + GAP + legend.1),
            (false, false) => (panels.0 + GAP + legend.0, panels.1.max(legend.1 + GAP)),
        };
        let mut scene = Scene::new((width + 2.0 * EDGE).ceil(), (above + height + EDGE).ceil());
        scene.font_family = Some(font::FAMILY.into());
        for (line, content) in title.iter().enumerate() {
            let baseline = EDGE + f64::from(TITLE) * (0.9 + 1.4 * line as f64);
            let middle = (EDGE + 0.5 * panels.0, baseline);
            shape::text(middle, content, TITLE, Anchor::Middle, Colour::Black, false, &mut scene.elements);
        }
        let mut windows = Vec::new();
        let mut y = above;
        for (row, (row_margins, row_height)) in rows.iter().zip(&down) {
            let mut x = EDGE;
            for ((panel, frame), (margins, column_width)) in row.iter().zip(&across) {
                let margins = Margins { top: row_margins.top, bottom: row_margins.bottom, ..*margins };
                frame.draw(panel, margins, (x, y), &mut scene);
                windows.push(frame.window((x + margins.left, y + margins.top)));
                x += margins.left + column_width + margins.right + GAP;
            }
            y += row_margins.top + row_height + row_margins.bottom + GAP;
        }
        let first_margins = across.first().map_or(0.0, |(margins, _)| margins.left);
        let at = if below {
            (EDGE + if legend.0 + first_margins <= panels.0 { first_margins } else { 0.0 }, above + panels.1 + GAP)
        } else {
            (EDGE + panels.0 + GAP, above + GAP)
        };
        self.legend.draw(at, panels.0, scale, &mut scene.elements);
        Some(Rendered { svg: number::shortened(&SvgBackend::new().render_scene(&scene)), windows })
    }

    /// As PNG, twice as large as the SVG says; none where nothing can be drawn.
    ///
    /// # Errors
    /// [`Unsupported`](crate::Reason::Unsupported) if the picture cannot be rendered.
    pub fn png(&self) -> Result<Option<Vec<u8>>> {
        self.svg().map(|svg| png::png(&svg)).transpose()
    }
}

/// The panels of a row in which anything can be drawn.
fn drawn(row: &[Panel]) -> Vec<(&Panel, Frame)> {
    row.iter().filter(|panel| panel.is_drawn()).map(|panel| (panel, Frame::new(panel))).collect()
}

/// What the panels of a column need to their left and right, and the greatest width.
fn widest<'a>(column: impl Iterator<Item = &'a (&'a Panel, Frame)>) -> (Margins, f64) {
    column.fold((Margins::default(), 0.0), |(most, width), (panel, frame)| {
        let margins = frame.margins(panel);
        let (left, right) = (most.left.max(margins.left), most.right.max(margins.right));
        (Margins { left, right, numbers: most.numbers.max(margins.numbers), ..most }, width.max(panel.size.0))
    })
}

/// What the panels of a row need above and below, and the greatest height.
fn highest(row: &[(&Panel, Frame)]) -> (Margins, f64) {
    row.iter().fold((Margins::default(), 0.0), |(most, height), (panel, frame)| {
        let margins = frame.margins(panel);
        let (top, bottom) = (most.top.max(margins.top), most.bottom.max(margins.bottom));
        (Margins { top, bottom, ..most }, height.max(panel.size.1))
    })
}

#[cfg(test)]
mod tests;
