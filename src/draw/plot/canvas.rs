//! Paths, circles and texts with their places on the screen, and their SVG.

use super::color::Color;
use super::{Pixel, font};
use std::fmt::{self, Display};

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub color: Color,
    /// The width \[px\].
    pub width: f64,
    pub dash: Dash,
}

/// The lengths of a line's dashes and gaps in turn \[px\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dash(pub(super) &'static [f32]);

impl Dash {
    pub const SOLID: Self = Self(&[]);
    pub const DASHED: Self = Self(&[8.0, 4.0]);
    pub const DOTTED: Self = Self(&[2.0, 3.0]);
    const DASH_DOT: Self = Self(&[9.0, 3.0, 2.0, 3.0]);
    const LONG: Self = Self(&[18.0, 4.0]);
    const DASH_DOT_DOT: Self = Self(&[9.0, 3.0, 2.0, 3.0, 2.0, 3.0]);
    /// All dashes, the easiest to distinguish first.
    pub const ALL: [Self; 6] =
        [Self::SOLID, Self::DASHED, Self::DOTTED, Self::DASH_DOT, Self::LONG, Self::DASH_DOT_DOT];
}

impl Stroke {
    pub const fn solid(color: Color, width: f64) -> Self {
        Self { color, width, dash: Dash::SOLID }
    }
}

#[derive(Debug)]
pub(super) struct Canvas {
    /// The SVG's title and its description for screen readers.
    pub title: String,
    pub description: String,
    pub size: Pixel,
    pub layer: PlotLayer,
}

/// Elements; each is drawn above those before it.
#[derive(Debug, Default)]
pub(super) struct PlotLayer(pub Vec<Element>);

/// An element of a layer. A window is a layer that is clipped at a rectangle; the rectangle's upper left corner is the
/// origin of the layer.
#[derive(Debug)]
pub(super) enum Element {
    Shape { outline: CanvasOutline, fill: Option<Color>, stroke: Option<Stroke> },
    Text(TextLine),
    Window { corner: Pixel, size: Pixel, layer: PlotLayer },
}

/// An outline. A path consists of pieces with straight lines between their corners. A fill covers the points inside an
/// odd number of closed pieces.
#[derive(Debug)]
pub(super) enum CanvasOutline {
    Path { pieces: Vec<Vec<Pixel>>, closed: bool },
    Circle { center: Pixel, radius: f64 },
}

#[derive(Debug)]
pub(super) struct TextLine {
    /// The anchor's point on the baseline.
    pub at: Pixel,
    pub content: String,
    /// The font size \[px\].
    pub size: u32,
    pub anchor: Anchor,
    pub color: Color,
    /// Whether a white rim keeps the text readable over lines.
    pub rim: bool,
    /// Whether the text runs upward.
    pub upward: bool,
}

/// The part of a text that is at its point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The width of a text's white rim on each side \[px\].
pub(super) const RIM: f64 = 1.5;

impl TextLine {
    /// Creates a black text without a rim. A very long text loses its middle.
    pub fn new(at: Pixel, content: &str, size: u32, anchor: Anchor) -> Self {
        let content = font::drawn(content).into_owned();
        Self { at, content, size, anchor, color: Color::Black, rim: false, upward: false }
    }

    /// Returns the y of the baseline of a text whose middle is at this y \[px\].
    pub fn baseline(middle: f64, size: u32) -> f64 {
        middle + 0.5 * font::CAPITAL * f64::from(size)
    }
}

impl PlotLayer {
    pub fn line(&mut self, points: Vec<Pixel>, stroke: Stroke) {
        self.lines(vec![points], stroke);
    }

    pub fn lines(&mut self, pieces: Vec<Vec<Pixel>>, stroke: Stroke) {
        let outline = CanvasOutline::Path { pieces, closed: false };
        self.0.push(Element::Shape { outline, fill: None, stroke: Some(stroke) });
    }

    pub fn area(&mut self, pieces: Vec<Vec<Pixel>>, fill: Option<Color>, stroke: Option<Stroke>) {
        self.0.push(Element::Shape { outline: CanvasOutline::Path { pieces, closed: true }, fill, stroke });
    }

    /// Adds a rectangle with this upper left corner.
    pub fn rectangle(&mut self, (x, y): Pixel, (width, height): Pixel, fill: Option<Color>, stroke: Option<Stroke>) {
        self.area(vec![vec![(x, y), (x + width, y), (x + width, y + height), (x, y + height)]], fill, stroke);
    }

    pub fn circle(&mut self, center: Pixel, radius: f64, fill: Option<Color>, stroke: Option<Stroke>) {
        self.0.push(Element::Shape { outline: CanvasOutline::Circle { center, radius }, fill, stroke });
    }

    /// Returns whether all coordinates are finite; they are not if the drawn numbers leave the range of f64.
    pub fn is_placed(&self) -> bool {
        let is_placed = |&(x, y): &Pixel| x.is_finite() && y.is_finite();
        self.0.iter().all(|element| match element {
            Element::Shape { outline: CanvasOutline::Circle { center, radius }, .. } => {
                is_placed(center) && radius.is_finite()
            }
            Element::Shape { outline: CanvasOutline::Path { pieces, .. }, .. } => {
                pieces.iter().flatten().all(is_placed)
            }
            Element::Text(text) => is_placed(&text.at),
            Element::Window { corner, size, layer } => is_placed(corner) && is_placed(size) && layer.is_placed(),
        })
    }

    pub fn text(&mut self, text: TextLine) {
        self.0.push(Element::Text(text));
    }
}

impl Canvas {
    /// Returns the picture as SVG, with texts as text elements.
    pub fn svg(&self) -> String {
        let mut clips: Vec<String> = Vec::new();
        for element in &self.layer.0 {
            let &Element::Window { size: (width, height), .. } = element else { continue };
            let (id, width, height) = (clip((width, height)), Short(width), Short(height));
            let clip = format!(r#"<clipPath id="{id}"><rect width="{width}" height="{height}"/></clipPath>"#);
            if !clips.contains(&clip) {
                clips.push(clip);
            }
        }
        let (width, height, white) = (Short(self.size.0), Short(self.size.1), Color::White.hex());
        let size = format!(r#"width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="img""#);
        let [title, description] = [&self.title, &self.description].map(|text| escaped(text));
        let head = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="{}" stroke-linejoin="round"><title>{title}</title><desc>{description}</desc>"#,
            font::FAMILY
        );
        let paper = format!(r#"<rect width="100%" height="100%" fill="{white}"/>"#);
        format!("{head}{paper}{}{}</svg>", clips.concat(), self.layer)
    }
}

/// Returns the id of a clip. If two pictures are on one page, clips with the same id are equal.
fn clip((width, height): Pixel) -> String {
    format!("clip{}x{}", Short(width), Short(height))
}

impl Display for PlotLayer {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|element| match element {
            Element::Shape { outline, fill, stroke } => {
                write!(out, r#"<{outline} fill="{}""#, fill.map_or("none", Color::hex))?;
                if let Some(Stroke { color, width, dash }) = stroke {
                    write!(out, r#" stroke="{}" stroke-width="{}""#, color.hex(), Short(*width))?;
                    if *dash != Dash::SOLID {
                        let lengths: Vec<String> = dash.0.iter().map(f32::to_string).collect();
                        write!(out, r#" stroke-dasharray="{}""#, lengths.join(" "))?;
                    }
                }
                out.write_str("/>")
            }
            Element::Text(text) => text.fmt(out),
            Element::Window { corner: (x, y), size, layer } => {
                let (x, y, clip) = (Short(*x), Short(*y), clip(*size));
                write!(out, r#"<g transform="translate({x},{y})" clip-path="url(#{clip})" fill-rule="evenodd">"#)?;
                write!(out, "{layer}</g>")
            }
        })
    }
}

impl Display for CanvasOutline {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Circle { center: (x, y), radius } => {
                write!(out, r#"circle cx="{}" cy="{}" r="{}""#, Short(*x), Short(*y), Short(*radius))
            }
            Self::Path { pieces, closed } => {
                out.write_str(r#"path d=""#)?;
                for piece in pieces.iter().filter(|piece| !piece.is_empty()) {
                    for (at, &(x, y)) in piece.iter().enumerate() {
                        write!(out, "{}{} {}", if at == 0 { 'M' } else { 'L' }, Short(x), Short(y))?;
                    }
                    out.write_str(if *closed { "Z" } else { "" })?;
                }
                out.write_str("\"")
            }
        }
    }
}

impl Display for TextLine {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = (Short(self.at.0), Short(self.at.1));
        write!(out, r#"<text x="{x}" y="{y}" font-size="{}" fill="{}""#, self.size, self.color.hex())?;
        out.write_str(match self.anchor {
            Anchor::Start => "",
            Anchor::Middle => r#" text-anchor="middle""#,
            Anchor::End => r#" text-anchor="end""#,
        })?;
        if self.upward {
            write!(out, r#" transform="rotate(-90,{x},{y})""#)?;
        }
        if self.rim {
            let (white, width) = (Color::White.hex(), 2.0 * RIM);
            write!(out, r#" stroke="{white}" stroke-width="{width}" paint-order="stroke""#)?;
        }
        write!(out, ">{}</text>", escaped(&self.content))
    }
}

/// Escapes a text for XML and removes control characters and others that XML does not allow.
fn escaped(text: &str) -> String {
    let printable = |letter: &char| !letter.is_control() && !matches!(letter, '\u{fffe}' | '\u{ffff}');
    let text: String = text.chars().filter(printable).collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A number that is written with at most two decimals: a hundredth of a pixel is invisible.
struct Short(f64);

impl Display for Short {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = format!("{:.2}", self.0);
        let short = text.trim_end_matches('0').trim_end_matches('.');
        out.write_str(if short == "-0" { "0" } else { short })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_texts_without_markup() {
        let texts = [-0.001, 2.0, 2.5, -7.126, 100.0].map(|value| Short(value).to_string());
        assert_eq!(texts, ["0", "2", "2.5", "-7.13", "100"]);
        let text = TextLine::new((0.0, 0.0), "a\u{1}<b> & \"c\" $d$\u{ffff}", 12, Anchor::Start);
        assert!(text.to_string().ends_with(r#">a\u{1}&lt;b&gt; &amp; "c" $d$</text>"#), "{text}");
    }
}
