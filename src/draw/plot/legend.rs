//! What the signs of a picture mean.

use super::colour::Colour;
use super::font;
use super::shape::{Anchor, Mark, Stroke, arrow, path, text};
use super::{Pixel, shape};
use kuva::render::render::Primitive;

/// What the signs of a picture mean.
#[derive(Debug, Clone, Default)]
pub struct Legend {
    /// One after the other.
    pub entries: Vec<Entry>,
    /// Where they stand.
    pub arrangement: Arrangement,
}

/// Where a legend stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Arrangement {
    /// In a column to the right of all panels.
    #[default]
    Beside,
    /// Below all panels, one entry behind the other, in as few rows as they need.
    Rows,
    /// Below all panels, in as many columns as fit.
    Columns,
}

/// What a sign is.
#[derive(Debug, Clone)]
pub struct Entry {
    /// In words; of several lines where it has line breaks, or no room for one.
    pub name: String,
    /// The sign.
    pub key: Key,
}

/// A sign.
#[derive(Debug, Clone, Copy)]
pub enum Key {
    /// A line.
    Line(Stroke),
    /// A mark.
    Mark(Mark, Colour),
    /// An area or a band.
    Fill(Colour),
    /// An arrow.
    Arrow {
        /// Its shaft.
        stroke: Stroke,
        /// Its length, in units of the first panel's x axis.
        length: f64,
    },
}

/// Height of the font, from one row to the next, and from one line of an entry to the next \[px\].
const SIZE: u32 = 12;
const ROW: f64 = 20.0;
const LINE: f64 = 16.0;
/// Of a key, long enough for two periods of most dashes \[px\].
const KEY: f64 = 36.0;
/// From a key to its name, and from a column to the next one \[px\].
const GAP: f64 = 8.0;
const NEXT: f64 = 22.0;

/// An entry's place and lines, and how much room it takes \[px\].
struct Place {
    at: Pixel,
    lines: Vec<String>,
    size: Pixel,
}

impl Legend {
    /// Where each entry is, and the size of all, in a picture whose panels are so wide \[px\].
    fn places(&self, panels: f64, scale: f64) -> (Vec<Place>, Pixel) {
        let room = if self.arrangement == Arrangement::Beside { f64::INFINITY } else { panels };
        let place = |entry: &Entry| {
            let key = self.key_width(entry, scale) + GAP;
            let lines = font::lines(&entry.name, SIZE, room - key);
            let width = lines.iter().map(|line| font::width(line, SIZE)).fold(0.0, f64::max);
            let height = ROW + LINE * lines.len().saturating_sub(1) as f64;
            Place { at: (0.0, 0.0), lines, size: (key + width, height) }
        };
        let mut places: Vec<Place> = self.entries.iter().map(place).collect();
        let size = match self.arrangement {
            Arrangement::Beside => in_columns(&mut places, 1),
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

    /// How much room the key of an entry has \[px\]: in columns that of the widest, so that all names begin behind them.
    fn key_width(&self, entry: &Entry, scale: f64) -> f64 {
        match self.arrangement {
            Arrangement::Columns => self.entries.iter().map(|entry| entry.key.width(scale)).fold(0.0, f64::max),
            Arrangement::Beside | Arrangement::Rows => entry.key.width(scale),
        }
    }

    /// How much room it takes \[px\].
    pub(super) fn size(&self, panels: f64, scale: f64) -> Pixel {
        self.places(panels, scale).1
    }

    /// Draws it with its upper left corner at `at`; a unit of the first panel's x axis takes `scale` \[px\].
    pub(super) fn draw(&self, at: Pixel, panels: f64, scale: f64, out: &mut Vec<Primitive>) {
        for (entry, Place { at: (x, y), lines, .. }) in self.entries.iter().zip(self.places(panels, scale).0) {
            let (x, middle) = (at.0 + x, at.1 + y + 0.5 * ROW);
            let names = x + self.key_width(entry, scale) + GAP;
            entry.key.draw((x, middle), entry.key.width(scale), out);
            for (line, content) in lines.iter().enumerate() {
                let baseline = middle + 0.5 * font::CAPITAL * f64::from(SIZE) + LINE * line as f64;
                text((names, baseline), content, SIZE, Anchor::Start, Colour::Black, false, out);
            }
        }
    }
}

/// The widths of so many columns.
fn widths(places: &[Place], columns: usize) -> Vec<f64> {
    let width = |column: usize| places.iter().skip(column).step_by(columns).map(|place| place.size.0);
    (0..columns).map(|column| width(column).fold(0.0, f64::max)).collect()
}

/// Puts entries into so many columns, row by row, and gives the size of all.
fn in_columns(places: &mut [Place], columns: usize) -> Pixel {
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

/// Puts entries one behind the other, in rows of at most `room`, and gives the size of all.
fn in_rows(places: &mut [Place], room: f64) -> Pixel {
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

impl Key {
    fn width(self, scale: f64) -> f64 {
        match self {
            Self::Line(_) => KEY,
            Self::Mark(..) => 0.4 * KEY,
            Self::Fill(_) => 0.6 * KEY,
            Self::Arrow { length, .. } => length * scale,
        }
    }

    fn draw(self, (x, y): Pixel, width: f64, out: &mut Vec<Primitive>) {
        match self {
            Self::Line(stroke) => out.push(path(&[&[(x, y), (x + width, y)]], false, None, Some(stroke))),
            Self::Mark(mark, colour) => mark.draw((x + 0.5 * width, y), colour, shape::MARK, out),
            Self::Fill(colour) => {
                let box_of = [(x, y - 6.0), (x + width, y - 6.0), (x + width, y + 6.0), (x, y + 6.0)];
                out.push(path(&[&box_of], true, Some(colour), Some(Stroke::solid(Colour::Grey, 0.8))));
            }
            Self::Arrow { stroke, .. } => arrow((x, y), (x + width, y), stroke, out),
        }
    }
}
