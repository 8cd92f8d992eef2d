//! Paths, circles and texts that have their place on the screen, and how SVG writes them.

use super::color::Color;
use super::font;
use std::fmt;

/// A point or a distance on the screen: right and down \[px\].
pub type Pixel = (f64, f64);

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its color.
    pub color: Color,
    /// Its width \[px\].
    pub width: f64,
    /// Its dashes.
    pub dash: Dash,
}

/// Dashes of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// No gaps.
    Solid,
    /// Long dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// A dash and a dot.
    DashDot,
    /// Very long dashes.
    Long,
    /// A dash and two dots.
    DashDotDot,
}

impl Dash {
    /// All, the most different ones first.
    pub const ALL: [Self; 6] = [Self::Solid, Self::Dashed, Self::Dotted, Self::DashDot, Self::Long, Self::DashDotDot];

    /// Lengths of dashes and gaps in turn \[px\].
    pub(super) const fn lengths(self) -> &'static [f32] {
        match self {
            Self::Solid => &[],
            Self::Dashed => &[8.0, 4.0],
            Self::Dotted => &[2.0, 3.0],
            Self::DashDot => &[9.0, 3.0, 2.0, 3.0],
            Self::Long => &[18.0, 4.0],
            Self::DashDotDot => &[9.0, 3.0, 2.0, 3.0, 2.0, 3.0],
        }
    }
}

impl Stroke {
    /// A solid line.
    pub const fn solid(color: Color, width: f64) -> Self {
        Self { color, width, dash: Dash::Solid }
    }
}

/// A picture on the screen.
#[derive(Debug)]
pub(super) struct Canvas {
    /// Width and height.
    pub size: Pixel,
    pub layer: PlotLayer,
}

/// What is drawn, the first element below the others.
#[derive(Debug, Default)]
pub(super) struct PlotLayer(pub Vec<Element>);

#[derive(Debug)]
pub(super) enum Element {
    /// Lines from corner to corner; what lies in an odd number of closed loops is filled.
    Path {
        pieces: Vec<Vec<Pixel>>,
        closed: bool,
        fill: Option<Color>,
        stroke: Option<Stroke>,
    },
    Circle {
        center: Pixel,
        radius: f64,
        fill: Option<Color>,
        stroke: Option<Stroke>,
    },
    Text(TextLine),
    /// A layer that is cut at a rectangle, whose upper left corner is the layer's origin.
    Window {
        corner: Pixel,
        size: Pixel,
        layer: PlotLayer,
    },
}

/// A line of text.
#[derive(Debug)]
pub(super) struct TextLine {
    /// On its baseline.
    pub at: Pixel,
    pub content: String,
    /// Height of the font \[px\].
    pub size: u32,
    pub anchor: Anchor,
    pub color: Color,
    /// Whether a white rim keeps it readable over lines.
    pub rim: bool,
    /// Whether it runs upward.
    pub upward: bool,
}

/// The part of a text that is at its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// The width of a text's white rim on either side \[px\].
pub(super) const RIM: f64 = 1.5;

impl TextLine {
    /// A black text without a rim; without what XML cannot hold.
    pub fn new(at: Pixel, content: &str, size: u32, anchor: Anchor) -> Self {
        let printable = |letter: &char| !letter.is_control() && !matches!(letter, '\u{fffe}' | '\u{ffff}');
        let content = content.chars().filter(printable).collect();
        Self { at, content, size, anchor, color: Color::Black, rim: false, upward: false }
    }

    /// Where its baseline is if its middle is at this height.
    pub fn baseline(middle: f64, size: u32) -> f64 {
        middle + 0.5 * font::CAPITAL * f64::from(size)
    }
}

impl PlotLayer {
    pub fn line(&mut self, points: Vec<Pixel>, stroke: Stroke) {
        self.lines(vec![points], stroke);
    }

    pub fn lines(&mut self, pieces: Vec<Vec<Pixel>>, stroke: Stroke) {
        self.0.push(Element::Path { pieces, closed: false, fill: None, stroke: Some(stroke) });
    }

    pub fn area(&mut self, loops: Vec<Vec<Pixel>>, fill: Option<Color>, stroke: Option<Stroke>) {
        self.0.push(Element::Path { pieces: loops, closed: true, fill, stroke });
    }

    /// A rectangle from its upper left corner.
    pub fn rectangle(&mut self, (x, y): Pixel, (width, height): Pixel, fill: Option<Color>, stroke: Option<Stroke>) {
        self.area(vec![vec![(x, y), (x + width, y), (x + width, y + height), (x, y + height)]], fill, stroke);
    }

    pub fn circle(&mut self, center: Pixel, radius: f64, fill: Option<Color>, stroke: Option<Stroke>) {
        self.0.push(Element::Circle { center, radius, fill, stroke });
    }

    pub fn text(&mut self, text: TextLine) {
        self.0.push(Element::Text(text));
    }

    pub fn window(&mut self, corner: Pixel, size: Pixel, layer: Self) {
        self.0.push(Element::Window { corner, size, layer });
    }

    fn write(&self, svg: &mut String) {
        for element in &self.0 {
            *svg += &element.to_string();
        }
    }
}

impl Canvas {
    /// The picture as SVG; texts stay texts.
    pub fn svg(&self) -> String {
        let (width, height) = (Short(self.size.0), Short(self.size.1));
        let mut svg = format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="{}""#,
            font::FAMILY
        );
        let white = Color::White.hex();
        svg += &format!(r#" stroke-linejoin="round"><rect width="100%" height="100%" fill="{white}"/>"#);
        let mut sizes: Vec<Pixel> = Vec::new();
        for element in &self.layer.0 {
            if let Element::Window { size, .. } = element
                && !sizes.contains(size)
            {
                sizes.push(*size);
            }
        }
        for size in sizes {
            let (width, height) = (Short(size.0), Short(size.1));
            let id = clip(size);
            svg += &format!(r#"<clipPath id="{id}"><rect width="{width}" height="{height}"/></clipPath>"#);
        }
        self.layer.write(&mut svg);
        svg + "</svg>"
    }
}

/// The name of a clip. If two pictures stand on one page, clips of the same name are the same.
fn clip((width, height): Pixel) -> String {
    format!("clip{}x{}", Short(width), Short(height))
}

impl fmt::Display for Element {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Path { pieces, closed, fill, stroke } => {
                write!(out, r#"<path d=""#)?;
                for piece in pieces.iter().filter(|piece| !piece.is_empty()) {
                    for (at, &(x, y)) in piece.iter().enumerate() {
                        write!(out, "{}{} {}", if at == 0 { 'M' } else { 'L' }, Short(x), Short(y))?;
                    }
                    out.write_str(if *closed { "Z" } else { "" })?;
                }
                write!(out, r#""{}/>"#, Painted(*fill, *stroke))
            }
            Self::Circle { center: (x, y), radius, fill, stroke } => {
                let (cx, cy, r) = (Short(*x), Short(*y), Short(*radius));
                write!(out, r#"<circle cx="{cx}" cy="{cy}" r="{r}"{}/>"#, Painted(*fill, *stroke))
            }
            Self::Text(text) => text.fmt(out),
            Self::Window { corner: (x, y), size, layer } => {
                let (x, y, clip) = (Short(*x), Short(*y), clip(*size));
                write!(out, r#"<g transform="translate({x},{y})" clip-path="url(#{clip})" fill-rule="evenodd">"#)?;
                layer.0.iter().try_for_each(|element| element.fmt(out))?;
                out.write_str("</g>")
            }
        }
    }
}

impl fmt::Display for TextLine {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (x, y) = (Short(self.at.0), Short(self.at.1));
        write!(out, r#"<text x="{x}" y="{y}" font-size="{}" fill="{}""#, self.size, self.color.hex())?;
        match self.anchor {
            Anchor::Start => {}
            Anchor::Middle => out.write_str(r#" text-anchor="middle""#)?,
            Anchor::End => out.write_str(r#" text-anchor="end""#)?,
        }
        if self.upward {
            write!(out, r#" transform="rotate(-90,{x},{y})""#)?;
        }
        if self.rim {
            let (white, width) = (Color::White.hex(), 2.0 * RIM);
            write!(out, r#" stroke="{white}" stroke-width="{width}" paint-order="stroke""#)?;
        }
        let content = self.content.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        write!(out, ">{content}</text>")
    }
}

/// The attributes for a fill and a stroke.
struct Painted(Option<Color>, Option<Stroke>);

impl fmt::Display for Painted {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, r#" fill="{}""#, self.0.map_or("none", Color::hex))?;
        let Some(Stroke { color, width, dash }) = self.1 else { return Ok(()) };
        write!(out, r#" stroke="{}" stroke-width="{}""#, color.hex(), Short(width))?;
        if dash != Dash::Solid {
            let lengths: Vec<String> = dash.lengths().iter().map(f32::to_string).collect();
            write!(out, r#" stroke-dasharray="{}""#, lengths.join(" "))?;
        }
        Ok(())
    }
}

/// A number with two decimals at most: nobody sees a hundredth of a pixel.
struct Short(f64);

impl fmt::Display for Short {
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
    fn numbers_are_short_and_never_minus_zero() {
        let texts = [-0.001, 2.0, 2.5, -7.126, 100.0].map(|value| Short(value).to_string());
        assert_eq!(texts, ["0", "2", "2.5", "-7.13", "100"]);
    }

    #[test]
    fn control_characters_and_markup_do_not_break_a_picture() {
        let text = TextLine::new((0.0, 0.0), "a\u{1}<b> & \"c\" $d$\u{ffff}", 12, Anchor::Start);
        assert!(text.to_string().ends_with(">a&lt;b&gt; &amp; \"c\" $d$</text>"), "{text}");
    }
}
