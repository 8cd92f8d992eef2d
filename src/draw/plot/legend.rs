//! The meanings of a picture's signs.

use super::canvas::{Anchor, Layer, Stroke, Text};
use super::color::Color;
use super::mark::{MARK, Mark, arrow};
use super::{Pixel, font};

/// The meanings of a picture's signs.
#[derive(Debug, Clone, Default)]
pub struct Legend {
    /// One after the other.
    pub entries: Vec<LegendEntry>,
    /// Where they stand.
    pub arrangement: Arrangement,
}

/// Where a legend stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Arrangement {
    /// In a column to the right of all panels.
    #[default]
    Right,
    /// Below all panels, one entry after the other, in as few rows as they need.
    Rows,
    /// Below all panels, in as many columns as fit.
    Columns,
}

/// A sign and its meaning.
#[derive(Debug, Clone)]
pub struct LegendEntry {
    /// In words; on several lines if it has line breaks, or is too long for one.
    pub name: String,
    /// The sign.
    pub key: LegendKey,
}

/// A sign.
#[derive(Debug, Clone, Copy)]
pub enum LegendKey {
    /// A line.
    Line(Stroke),
    /// A mark.
    Mark(Mark, Color),
    /// An area or a band.
    Fill(Color),
    /// An arrow.
    Arrow {
        /// Its shaft.
        stroke: Stroke,
        /// Its length, in units of the first panel's x axis.
        length: f64,
    },
}

/// What an entry needs to know of the panels.
#[derive(Debug, Clone, Copy)]
pub(super) struct Panels {
    /// The width of all of them \[px\].
    pub width: f64,
    /// The pixels of one unit of the first one's x axis.
    pub scale: f64,
}

/// Height of the font, from one row to the next, and from one line of an entry to the next \[px\].
const SIZE: u32 = 12;
const ROW: f64 = 20.0;
const LINE: f64 = 16.0;
/// The width of a key, long enough for two periods of most dashes \[px\].
const KEY: f64 = 36.0;
/// From a key to its name, and from one column to the next \[px\].
const GAP: f64 = 8.0;
const NEXT: f64 = 22.0;

/// An entry's lines, its upper left corner and its size.
struct PlacedEntry {
    at: Pixel,
    lines: Vec<String>,
    size: Pixel,
}

impl Legend {
    /// The place of each entry, and the size of all.
    fn places(&self, panels: Panels) -> (Vec<PlacedEntry>, Pixel) {
        let room = if self.arrangement == Arrangement::Right { f64::INFINITY } else { panels.width };
        let place = |entry: &LegendEntry| {
            let key = self.key_width(entry, panels.scale) + GAP;
            let lines = font::lines(&entry.name, SIZE, room - key);
            let width = lines.iter().map(|line| font::width(line, SIZE)).fold(0.0, f64::max);
            let height = ROW + LINE * lines.len().saturating_sub(1) as f64;
            PlacedEntry { at: (0.0, 0.0), lines, size: (key + width, height) }
        };
        let mut places: Vec<PlacedEntry> = self.entries.iter().map(place).collect();
        let size = match self.arrangement {
            Arrangement::Right => in_columns(&mut places, 1),
            Arrangement::Rows => in_rows(&mut places, room),
            Arrangement::Columns => {
                let fits =
                    |count: &usize| widths(&places, *count).iter().sum::<f64>() + NEXT * (count - 1) as f64 <= room;
                let columns = (2..=places.len()).rev().find(fits).unwrap_or(1);
                in_columns(&mut places, columns)
            }
        };
        (places, size)
    }

    /// The width of an entry's key: in columns that of the widest one, so that all names begin behind them.
    fn key_width(&self, entry: &LegendEntry, scale: f64) -> f64 {
        match self.arrangement {
            Arrangement::Columns => self.entries.iter().map(|entry| entry.key.width(scale)).fold(0.0, f64::max),
            Arrangement::Right | Arrangement::Rows => entry.key.width(scale),
        }
    }

    /// Its width and height.
    pub(super) fn size(&self, panels: Panels) -> Pixel {
        self.places(panels).1
    }

    /// Draws it with its upper left corner at `at`.
    pub(super) fn draw(&self, at: Pixel, panels: Panels, out: &mut Layer) {
        for (entry, PlacedEntry { at: (x, y), lines, .. }) in self.entries.iter().zip(self.places(panels).0) {
            let (x, middle) = (at.0 + x, at.1 + y + 0.5 * ROW);
            let names = x + self.key_width(entry, panels.scale) + GAP;
            entry.key.draw((x, middle), entry.key.width(panels.scale), out);
            for (line, content) in lines.iter().enumerate() {
                let baseline = Text::baseline(middle, SIZE) + LINE * line as f64;
                out.text(Text::new((names, baseline), content, SIZE, Anchor::Start));
            }
        }
    }
}

/// The widths of so many columns.
fn widths(places: &[PlacedEntry], columns: usize) -> Vec<f64> {
    let width = |column: usize| places.iter().skip(column).step_by(columns).map(|place| place.size.0);
    (0..columns).map(|column| width(column).fold(0.0, f64::max)).collect()
}

/// Places entries in so many columns, row by row, and returns the size of all.
fn in_columns(places: &mut [PlacedEntry], columns: usize) -> Pixel {
    let widths = widths(places, columns);
    let (mut right, mut y) = (0.0_f64, 0.0);
    for row in places.chunks_mut(columns) {
        let mut x = 0.0;
        for (place, width) in row.iter_mut().zip(&widths) {
            place.at = (x, y);
            right = right.max(x + place.size.0);
            x += width + NEXT;
        }
        y += row.iter().map(|place| place.size.1).fold(0.0, f64::max);
    }
    (right, y)
}

/// Places entries one after the other, in rows of at most `room`, and returns the size of all.
fn in_rows(places: &mut [PlacedEntry], room: f64) -> Pixel {
    let (mut x, mut y, mut row, mut right) = (0.0, 0.0, 0.0_f64, 0.0_f64);
    for place in places {
        if x > 0.0 && x + place.size.0 > room {
            (x, y, row) = (0.0, y + row, 0.0);
        }
        place.at = (x, y);
        row = row.max(place.size.1);
        right = right.max(x + place.size.0);
        x += place.size.0 + NEXT;
    }
    (right, y + row)
}

impl LegendKey {
    fn width(self, scale: f64) -> f64 {
        match self {
            Self::Line(_) => KEY,
            Self::Mark(..) => 0.4 * KEY,
            Self::Fill(_) => 0.6 * KEY,
            Self::Arrow { length, .. } => length * scale,
        }
    }

    fn draw(self, (x, y): Pixel, width: f64, out: &mut Layer) {
        match self {
            Self::Line(stroke) => out.line(vec![(x, y), (x + width, y)], stroke),
            Self::Mark(mark, color) => mark.draw((x + 0.5 * width, y), color, MARK, out),
            Self::Fill(color) => {
                out.rectangle((x, y - 6.0), (width, 12.0), Some(color), Some(Stroke::solid(Color::Gray, 0.8)));
            }
            Self::Arrow { stroke, .. } => arrow((x, y), (x + width, y), stroke, out),
        }
    }
}
