//! Legends: the symbols of a picture and their meanings.

use super::canvas::{Anchor, PlotLayer, Stroke, TextLine};
use super::color::Color;
use super::mark::{MARK, Mark, arrow};
use super::{Pixel, font};

/// A symbol and its meaning.
#[derive(Debug, Clone)]
pub struct LegendEntry {
    /// The meaning in words. It takes several lines if it has line breaks or is too long.
    pub name: String,
    pub key: LegendKey,
}

/// The symbol of an entry. The lengths of arrows and distances are in units of the first panel's x axis.
#[derive(Debug, Clone)]
pub enum LegendKey {
    Line(Stroke),
    Mark(Mark, Color),
    Fill(Color),
    /// A line across areas of these colors, side by side.
    LineIn(Stroke, Vec<Color>),
    Arrow {
        stroke: Stroke,
        length: f64,
    },
    Length(f64),
}

impl LegendEntry {
    pub fn new(name: impl Into<String>, key: LegendKey) -> Self {
        Self { name: name.into(), key }
    }
}

/// Font size, distance between rows, and distance between lines of one entry \[px\].
const SIZE: u32 = 12;
const ROW: f64 = 20.0;
const LINE: f64 = 16.0;
/// The width of a key, long enough for two periods of most dashes \[px\].
const KEY: f64 = 36.0;
/// Distance from a key to its name, and from one column to the next \[px\].
const GAP: f64 = 8.0;
const NEXT: f64 = 22.0;

/// A legend in as many columns as fit below the panels.
pub(super) struct Legend<'p> {
    columns: Vec<Column<'p>>,
    /// The length of one unit of the first panel's x axis \[px\].
    scale: f64,
}

/// Entries below each other with the lines of their names, and the widths of the widest key and line \[px\].
struct Column<'p> {
    entries: &'p [LegendEntry],
    lines: Vec<Vec<String>>,
    key: f64,
    name: f64,
}

impl<'p> Column<'p> {
    /// Creates a column that is at most `most` wide \[px\].
    fn new(entries: &'p [LegendEntry], most: f64, scale: f64) -> Self {
        let key = entries.iter().map(|entry| entry.key.width(scale)).fold(0.0, f64::max);
        let lines: Vec<_> = entries.iter().map(|entry| font::lines(&entry.name, SIZE, most - key - GAP)).collect();
        let name = lines.iter().flatten().map(|line| font::width(line, SIZE)).fold(0.0, f64::max);
        Self { entries, lines, key, name }
    }

    fn width(&self) -> f64 {
        self.key + GAP + self.name
    }

    fn heights(&self) -> impl Iterator<Item = f64> {
        self.lines.iter().map(|lines| ROW + LINE * lines.len().saturating_sub(1) as f64)
    }
}

impl<'p> Legend<'p> {
    /// Creates a legend at most `width` wide \[px\]. One unit of the first panel's x axis has `scale` pixels.
    pub fn new(entries: &'p [LegendEntry], width: f64, scale: f64) -> Self {
        let columns = |rows: usize| -> Vec<Column> {
            entries.chunks(rows).map(|entries| Column::new(entries, width, scale)).collect()
        };
        let fitting = (1..entries.len()).map(columns).find(|columns| total(columns) <= width);
        Self { columns: fitting.unwrap_or_else(|| columns(entries.len().max(1))), scale }
    }

    pub fn size(&self) -> Pixel {
        (total(&self.columns), self.columns.iter().map(|column| column.heights().sum()).fold(0.0, f64::max))
    }

    /// Draws the legend with its upper left corner at this pixel.
    pub fn draw(&self, (mut left, top): Pixel, out: &mut PlotLayer) {
        for column in &self.columns {
            let mut middle = top + 0.5 * ROW;
            for ((entry, lines), height) in column.entries.iter().zip(&column.lines).zip(column.heights()) {
                entry.key.draw((left, middle), self.scale, column.key, out);
                for (at, line) in lines.iter().enumerate() {
                    let baseline = TextLine::baseline(middle, SIZE) + LINE * at as f64;
                    out.text(TextLine::new((left + column.key + GAP, baseline), line, SIZE, Anchor::Start));
                }
                middle += height;
            }
            left += column.width() + NEXT;
        }
    }
}

fn total(columns: &[Column]) -> f64 {
    columns.iter().map(Column::width).sum::<f64>() + NEXT * columns.len().saturating_sub(1) as f64
}

impl LegendKey {
    fn width(&self, scale: f64) -> f64 {
        match self {
            Self::Line(_) | Self::LineIn(..) => KEY,
            Self::Mark(..) => 0.4 * KEY,
            Self::Fill(_) => 0.6 * KEY,
            Self::Arrow { length, .. } | Self::Length(length) => length * scale,
        }
    }

    /// Draws the key to the right of a pixel; a mark is centered in the width `most` \[px\].
    fn draw(&self, (x, y): Pixel, scale: f64, most: f64, out: &mut PlotLayer) {
        let width = self.width(scale);
        let rectangle = |x, width, fill, out: &mut PlotLayer| {
            out.rectangle((x, y - 6.0), (width, 12.0), Some(fill), Some(Stroke::solid(Color::Gray, 0.8)));
        };
        match *self {
            Self::Line(stroke) => out.line(vec![(x, y), (x + width, y)], stroke),
            Self::Mark(mark, color) => mark.draw((x + 0.5 * most, y), color, MARK, out),
            Self::Fill(color) => rectangle(x, width, color, out),
            Self::LineIn(stroke, ref fills) => {
                let part = width / fills.len() as f64;
                let parts = fills.iter().enumerate();
                parts.for_each(|(at, &fill)| rectangle(x + part * at as f64, part, fill, out));
                out.line(vec![(x, y), (x + width, y)], stroke);
            }
            Self::Arrow { stroke, .. } => arrow((x, y), (x + width, y), stroke, out),
            Self::Length(_) => {
                let end = |x: f64| vec![(x, y - 4.0), (x, y + 4.0)];
                let bar = vec![vec![(x, y), (x + width, y)], end(x), end(x + width)];
                out.lines(bar, Stroke::solid(Color::Black, 1.2));
            }
        }
    }
}
