//! Pictures of series of points, as SVG and PNG (the only user of kuva and resvg).
//!
//! The same input gives the same bytes everywhere: texts are drawn with one embedded font, never with the system's.

use crate::{Error, Reason, Result};
use kuva::backend::svg::SvgBackend;
use kuva::plot::scatter::{MarkerShape, ScatterPlot};
use kuva::plot::{LegendPosition, LinePlot};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::render_multiple;
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

/// A picture of points over two axes.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Above the picture.
    pub title: String,
    /// Below it.
    pub x: Axis,
    /// Beside it.
    pub y: Axis,
    /// What is drawn, the first one below the others.
    pub series: Vec<Series>,
}

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    /// What is measured, with its unit.
    pub label: String,
    /// Whether its scale is logarithmic.
    pub logarithmic: bool,
}

/// Points that belong together.
#[derive(Debug, Clone)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// x and y; on a logarithmic axis positive.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub mark: Mark,
    /// Which colour of [`COLOURS`] it has.
    pub colour: usize,
}

/// How points are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A dot each.
    Circle,
    /// A square each.
    Square,
    /// A triangle each.
    Triangle,
    /// A line through all.
    Line,
}

/// Colours that people with any colour vision tell apart (Okabe and Ito 2008).
pub const COLOURS: [&str; 8] = ["#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7"];

/// What a mark takes of an axis that spans all points, on either side.
const MARK: f64 = 0.02;
const FONT: &[u8] = include_bytes!("DejaVuSans.ttf");
const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 560.0;

impl Picture {
    /// As SVG; none where no point can be drawn.
    pub fn svg(&self) -> Option<String> {
        let plots: Vec<Plot> = self.series.iter().filter_map(|series| self.plot(series)).collect();
        if plots.is_empty() {
            return None;
        }
        let mut layout = Layout::auto_from_plots(&plots)
            .with_title(&self.title)
            .with_x_label(&self.x.label)
            .with_y_label(&self.y.label)
            .with_width(WIDTH)
            .with_height(HEIGHT)
            .with_font_family("DejaVu Sans, sans-serif")
            .with_box_axes()
            .with_legend_position(LegendPosition::OutsideRightTop);
        let range = |pick: fn(&(f64, f64)) -> f64| self.powers(pick);
        let format = || TickFormat::Custom(Arc::new(power_of_ten));
        if self.x.logarithmic {
            let (low, high, step) = range(|point| point.0);
            let layout_x = layout.with_x_axis_min(low).with_x_axis_max(high).with_x_tick_step(step);
            layout = layout_x.with_x_tick_format(format());
        }
        if self.y.logarithmic {
            let (low, high, step) = range(|point| point.1);
            let layout_y = layout.with_y_axis_min(low).with_y_axis_max(high).with_y_tick_step(step);
            layout = layout_y.with_y_tick_format(format());
        }
        Some(SvgBackend::new().render_scene(&render_multiple(plots, layout)))
    }

    /// As PNG, twice as large as the SVG says; none where no point can be drawn.
    ///
    /// # Errors
    /// [`Reason::Unsupported`] if the picture cannot be rendered.
    pub fn png(&self) -> Result<Option<Vec<u8>>> {
        const SCALE: f32 = 2.0;
        let Some(svg) = self.svg() else { return Ok(None) };
        let refused = |what: &str| Error::new(Reason::Unsupported(format!("a picture {what}"))).hint("take an SVG");
        let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
        options.fontdb_mut().load_font_data(FONT.to_vec());
        let tree = usvg::Tree::from_str(&svg, &options).map_err(|error| refused(&error.to_string()))?;
        let size = tree.size().to_int_size().scale_by(SCALE).ok_or_else(|| refused("of no size"))?;
        let mut pixels = tiny_skia::Pixmap::new(size.width(), size.height()).ok_or_else(|| refused("of no size"))?;
        pixels.fill(tiny_skia::Color::WHITE);
        resvg::render(&tree, tiny_skia::Transform::from_scale(SCALE, SCALE), &mut pixels.as_mut());
        pixels.encode_png().map(Some).map_err(|error| refused(&error.to_string()))
    }

    /// The points that can be drawn, on logarithmic axes by their exponents: kuva's own logarithmic axis ends at 1e-10.
    fn drawn(&self, series: &Series) -> Vec<(f64, f64)> {
        let place = |value: f64, axis: &Axis| if axis.logarithmic { libm::log10(value) } else { value };
        let points = series.points.iter().map(|&(x, y)| (place(x, &self.x), place(y, &self.y)));
        points.filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
    }

    /// First and last exponent of a logarithmic axis and the step between its ticks.
    fn powers(&self, pick: fn(&(f64, f64)) -> f64) -> (f64, f64, f64) {
        let exponents: Vec<f64> = self.series.iter().flat_map(|series| self.drawn(series)).map(|p| pick(&p)).collect();
        let least = exponents.iter().copied().fold(f64::INFINITY, f64::min);
        let most = exponents.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // No mark lies on an axis.
        let room = MARK * (most - least);
        let low = (least - room).floor();
        let high = (most + room).ceil().max(low + 1.0);
        let step = match high - low {
            span if span <= 8.0 => 1.0,
            span if span <= 16.0 => 2.0,
            span => (span / 40.0).ceil() * 5.0,
        };
        ((low / step).floor() * step, (high / step).ceil() * step, step)
    }

    fn plot(&self, series: &Series) -> Option<Plot> {
        let points = self.drawn(series);
        if points.is_empty() {
            return None;
        }
        let colour = COLOURS[series.colour % COLOURS.len()];
        let marker = match series.mark {
            Mark::Line => {
                let line = LinePlot::new().with_data(points).with_color(colour).with_stroke_width(2.0);
                return Some(Plot::Line(line.with_legend(&series.name)));
            }
            Mark::Circle => MarkerShape::Circle,
            Mark::Square => MarkerShape::Square,
            Mark::Triangle => MarkerShape::Triangle,
        };
        let scatter = ScatterPlot::new().with_data(points).with_color(colour).with_marker(marker).with_size(4.0);
        Some(Plot::Scatter(scatter.with_legend(&series.name)))
    }
}

/// The power of ten of an exponent, as in 10⁻⁶.
fn power_of_ten(exponent: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let exponent = exponent.round();
    let digits = format!("{}", exponent.abs()).chars().filter_map(|digit| digit.to_digit(10)).collect::<Vec<_>>();
    let sign = if exponent < 0.0 { "⁻" } else { "" };
    format!("10{sign}{}", digits.into_iter().map(|digit| DIGITS[digit as usize]).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(points: Vec<(f64, f64)>) -> Picture {
        let axis = |label: &str| Axis { label: label.into(), logarithmic: true };
        let series = Series { name: "f64".into(), points, mark: Mark::Circle, colour: 1 };
        Picture { title: "title".into(), x: axis("time [s]"), y: axis("error"), series: vec![series] }
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        assert_eq!(picture(vec![(0.0, 1.0), (1.0, f64::NAN)]).svg(), None);
        let svg = picture(vec![(1e-6, 1e-15), (1e-3, 1e-7), (1.0, 0.0)]).svg().unwrap();
        assert!(svg.starts_with("<svg"));
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn a_png_is_one_and_the_same_bytes_each_time() {
        let picture = picture(vec![(1e-6, 1e-15), (1e-3, 1e-7)]);
        let png = picture.png().unwrap().unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(picture.png().unwrap().unwrap(), png);
    }

    #[test]
    fn powers_are_written_as_such() {
        assert_eq!(power_of_ten(-16.0), "10⁻¹⁶");
        assert_eq!(power_of_ten(2.0), "10²");
    }
}
