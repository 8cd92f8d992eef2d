//! Pictures as PNG. This is the only user of tiny-skia and png.

use super::canvas::{Anchor, Canvas, CanvasOutline, Element, PlotLayer, RIM, Stroke, TextLine};
use super::color::Color;
use super::font;
use crate::{Error, Reason, Result};
use tiny_skia::{FillRule, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect, StrokeDash, Transform};
use ttf_parser::OutlineBuilder;

/// Pixels of the PNG per pixel of the SVG.
const SCALE: f32 = 2.0;

/// Pixels per meter of paper: 192 per inch, as an SVG has 96.
const DENSITY: u32 = 7559;

/// The largest number of pixels, of four bytes each.
const MOST: u64 = 1 << 26;

pub(super) fn png(canvas: &Canvas) -> Result<Vec<u8>> {
    let refused = |what: &str| Error::new(Reason::Unsupported(format!("a picture {what}"))).hint("take an SVG");
    let [width, height] = [canvas.size.0, canvas.size.1].map(|side| (side * f64::from(SCALE)).ceil() as u32);
    let is_small = u64::from(width) * u64::from(height) <= MOST;
    let pixels = Some(()).filter(|()| is_small).and_then(|()| Pixmap::new(width, height));
    let mut pixels = pixels.ok_or_else(|| refused(&format!("of {width} x {height} pixels")))?;
    pixels.fill(tiny_skia::Color::WHITE);
    Brush { pixels: &mut pixels, place: Transform::from_scale(SCALE, SCALE), clip: None }.layer(&canvas.layer);
    encoded(&pixels, &canvas.title).map_err(|error| refused(&error.to_string()))
}

/// Encodes pixels as PNG without transparency.
fn encoded(pixels: &Pixmap, title: &str) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: DENSITY, yppu: DENSITY, unit: png::Unit::Meter }));
    encoder.add_itxt_chunk("Title".to_owned(), title.to_owned())?;
    let colors: Vec<u8> = pixels.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied().collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&colors)?;
    writer.finish()?;
    Ok(bytes)
}

/// Paints a layer into pixels.
struct Brush<'p> {
    pixels: &'p mut Pixmap,
    /// The transformation from the layer to the pixels.
    place: Transform,
    clip: Option<Mask>,
}

impl Brush<'_> {
    fn layer(&mut self, layer: &PlotLayer) {
        for element in &layer.0 {
            match element {
                Element::Shape { outline, fill, stroke } => self.shape(outline, *fill, *stroke),
                Element::Text(text) => self.text(text),
                Element::Window { corner, size, layer } => self.window(*corner, *size, layer),
            }
        }
    }

    fn window(&mut self, corner: (f64, f64), size: (f64, f64), layer: &PlotLayer) {
        let place = self.place.pre_translate(corner.0 as f32, corner.1 as f32);
        let rectangle = Rect::from_xywh(0.0, 0.0, size.0 as f32, size.1 as f32);
        let mask = Mask::new(self.pixels.width(), self.pixels.height());
        let (Some(mut mask), Some(rectangle)) = (mask, rectangle) else { return };
        mask.fill_path(&PathBuilder::from_rect(rectangle), FillRule::Winding, true, place);
        Brush { pixels: self.pixels, place, clip: Some(mask) }.layer(layer);
    }

    fn shape(&mut self, outline: &CanvasOutline, fill: Option<Color>, stroke: Option<Stroke>) {
        let path = match outline {
            &CanvasOutline::Circle { center: (x, y), radius } => {
                PathBuilder::from_circle(x as f32, y as f32, radius as f32)
            }
            CanvasOutline::Path { pieces, closed } => {
                let mut path = PathBuilder::new();
                for piece in pieces {
                    for (at, &(x, y)) in piece.iter().enumerate() {
                        let (x, y) = (x as f32, y as f32);
                        if at == 0 { path.move_to(x, y) } else { path.line_to(x, y) }
                    }
                    if *closed {
                        path.close();
                    }
                }
                path.finish()
            }
        };
        let Some(path) = path else { return };
        if let Some(color) = fill {
            self.fill(&path, color, FillRule::EvenOdd, self.place);
        }
        if let Some(Stroke { color, width, dash }) = stroke {
            self.stroke(&path, color, width as f32, StrokeDash::new(dash.0.to_vec(), 0.0), self.place);
        }
    }

    fn text(&mut self, text: &TextLine) {
        let Some(face) = font::face() else { return };
        let scale = text.size as f32 / f32::from(face.units_per_em());
        let (mut line, mut width) = (PathBuilder::new(), 0.0);
        for (glyph, advance) in font::glyphs(&face, &text.content) {
            let mut outline = GlyphOutline(PathBuilder::new());
            face.outline_glyph(glyph, &mut outline);
            // The y axis of glyphs points up.
            let place = Transform::from_row(scale, 0.0, 0.0, -scale, width, 0.0);
            if let Some(path) = outline.0.finish().and_then(|path| path.transform(place)) {
                line.push_path(&path);
            }
            width += scale * advance as f32;
        }
        let before = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let Some(path) = line.finish() else { return };
        let place = self.place.pre_translate(text.at.0 as f32, text.at.1 as f32);
        let place = if text.upward { place.pre_rotate(-90.0) } else { place }.pre_translate(-before, 0.0);
        if text.rim {
            self.stroke(&path, Color::White, 2.0 * RIM as f32, None, place);
        }
        self.fill(&path, text.color, FillRule::Winding, place);
    }

    fn fill(&mut self, path: &Path, color: Color, rule: FillRule, place: Transform) {
        self.pixels.fill_path(path, &paint(color), rule, place, self.clip.as_ref());
    }

    fn stroke(&mut self, path: &Path, color: Color, width: f32, dash: Option<StrokeDash>, place: Transform) {
        let stroke = tiny_skia::Stroke { width, dash, line_join: LineJoin::Round, ..tiny_skia::Stroke::default() };
        self.pixels.stroke_path(path, &paint(color), &stroke, place, self.clip.as_ref());
    }
}

fn paint(color: Color) -> Paint<'static> {
    let [red, green, blue] = color.rgb();
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(red, green, blue, 255);
    paint
}

/// The outline of a glyph in the font's units.
struct GlyphOutline(PathBuilder);

impl OutlineBuilder for GlyphOutline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
