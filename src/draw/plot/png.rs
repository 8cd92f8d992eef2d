//! A picture's SVG as pixels.

use super::font;
use crate::{Error, Reason, Result};
use resvg::{tiny_skia, usvg};

/// How much larger it is than the SVG says.
const SCALE: f32 = 2.0;

/// The PNG of an SVG.
///
/// # Errors
/// [`Reason::Unsupported`] if it cannot be rendered.
pub(super) fn png(svg: &str) -> Result<Vec<u8>> {
    let refused = |what: &str| Error::new(Reason::Unsupported(format!("a picture {what}"))).hint("take an SVG");
    let mut options = usvg::Options { font_family: font::NAME.into(), ..usvg::Options::default() };
    options.fontdb_mut().load_font_data(font::BYTES.to_vec());
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| refused(&error.to_string()))?;
    let size = tree.size().to_int_size().scale_by(SCALE).ok_or_else(|| refused("of no size"))?;
    let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or_else(|| refused("of no size"))?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| refused(&error.to_string()))
}
