//! Pictures of series of points, as SVG and PNG (the only user of kuva and resvg).
//!
//! The same input gives the same bytes everywhere: texts are drawn with one embedded font, never with the system's.

use crate::{Error, Reason, Result};
use kuva::backend::svg::SvgBackend;
use kuva::plot::LinePlot;
use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::scatter::{MarkerShape, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

/// Panels side by side, each of points over two axes.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Above the picture.
    pub title: String,
    /// From left to right; the y axes of two are the same where both are logarithmic.
    pub panels: Vec<Panel>,
    /// What the marks are, to the right of all panels.
    pub legend: Vec<Entry>,
}

/// Points over two axes.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Below it.
    pub x: Axis,
    /// Beside it.
    pub y: Axis,
    /// What is drawn, the first one below the others.
    pub series: Vec<Series>,
}

/// What a mark is.
#[derive(Debug, Clone)]
pub struct Entry {
    /// In words.
    pub name: String,
    /// The mark.
    pub mark: Mark,
    /// Which colour of [`COLOURS`] it has.
    pub colour: usize,
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
    /// A diamond each.
    Diamond,
    /// A star each.
    Star,
    /// A cross each.
    Cross,
    /// A line through all.
    Line,
}

/// Colours that people with any colour vision tell apart (Okabe and Ito 2008), and grey for marks of any colour.
pub const COLOURS: [&str; 9] =
    ["#000000", "#E69F00", "#56B4E9", "#009E73", "#F0E442", "#0072B2", "#D55E00", "#CC79A7", "#999999"];

/// What a mark takes of an axis that spans all points, on either side.
const MARK: f64 = 0.02;
const FONT: &[u8] = include_bytes!("DejaVuSans.ttf");
/// Of a panel.
const WIDTH: f64 = 620.0;
const HEIGHT: f64 = 520.0;

impl Picture {
    /// As SVG; none where no point can be drawn.
    pub fn svg(&self) -> Option<String> {
        let drawn: Vec<&Panel> = self.panels.iter().filter(|panel| !panel.plots().is_empty()).collect();
        if drawn.is_empty() {
            return None;
        }
        let entry = |entry: &Entry| LegendEntry {
            label: entry.name.clone(),
            color: COLOURS[entry.colour % COLOURS.len()].into(),
            shape: entry.mark.shape().map_or(LegendShape::Line, LegendShape::Marker),
            dasharray: None,
        };
        let figure = Figure::new(1, drawn.len())
            .with_title(&self.title)
            .with_plots(drawn.iter().map(|panel| panel.plots()).collect())
            .with_layouts(drawn.iter().map(|panel| panel.layout(&drawn)).collect())
            .with_shared_legend_right_top()
            .with_shared_legend_entries(self.legend.iter().map(entry).collect())
            .with_cell_size(WIDTH, HEIGHT);
        Some(SvgBackend::new().render_scene(&figure.render()))
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
}

impl Panel {
    /// Axes and their ticks; a logarithmic y axis is that of all `panels`.
    fn layout(&self, panels: &[&Self]) -> Layout {
        let mut layout = Layout::auto_from_plots(&self.plots())
            .with_x_label(&self.x.label)
            .with_y_label(&self.y.label)
            .with_font_family("DejaVu Sans, sans-serif")
            .with_box_axes();
        let format = || TickFormat::Custom(Arc::new(power_of_ten));
        if self.x.logarithmic {
            let (low, high, step) = powers(self.drawn().map(|point| point.0));
            let layout_x = layout.with_x_axis_min(low).with_x_axis_max(high).with_x_tick_step(step);
            layout = layout_x.with_x_tick_format(format());
        }
        if self.y.logarithmic {
            let beside = panels.iter().filter(|panel| panel.y.logarithmic);
            let (low, high, step) = powers(beside.flat_map(|panel| panel.drawn()).map(|point| point.1));
            let layout_y = layout.with_y_axis_min(low).with_y_axis_max(high).with_y_tick_step(step);
            layout = layout_y.with_y_tick_format(format());
        }
        layout
    }

    fn plots(&self) -> Vec<Plot> {
        self.series.iter().filter_map(|series| self.plot(series)).collect()
    }

    /// All points that can be drawn.
    fn drawn(&self) -> impl Iterator<Item = (f64, f64)> + use<'_> {
        self.series.iter().flat_map(|series| self.placed(series))
    }

    /// The points that can be drawn, on logarithmic axes by their exponents: kuva's own logarithmic axis ends at 1e-10.
    fn placed(&self, series: &Series) -> Vec<(f64, f64)> {
        let place = |value: f64, axis: &Axis| if axis.logarithmic { libm::log10(value) } else { value };
        let points = series.points.iter().map(|&(x, y)| (place(x, &self.x), place(y, &self.y)));
        points.filter(|(x, y)| x.is_finite() && y.is_finite()).collect()
    }

    fn plot(&self, series: &Series) -> Option<Plot> {
        let points = self.placed(series);
        if points.is_empty() {
            return None;
        }
        let colour = COLOURS[series.colour % COLOURS.len()];
        Some(match series.mark.shape() {
            None => Plot::Line(LinePlot::new().with_data(points).with_color(colour).with_stroke_width(2.0)),
            Some(shape) => {
                Plot::Scatter(ScatterPlot::new().with_data(points).with_color(colour).with_marker(shape).with_size(4.0))
            }
        })
    }
}

impl Mark {
    /// kuva's marker; none for a line.
    fn shape(self) -> Option<MarkerShape> {
        Some(match self {
            Self::Circle => MarkerShape::Circle,
            Self::Square => MarkerShape::Square,
            Self::Triangle => MarkerShape::Triangle,
            Self::Diamond => MarkerShape::Diamond,
            Self::Star => MarkerShape::Star,
            Self::Cross => MarkerShape::Cross,
            Self::Line => return None,
        })
    }
}

/// First and last exponent of a logarithmic axis and the step between its ticks.
fn powers(exponents: impl Iterator<Item = f64>) -> (f64, f64, f64) {
    let (least, most) = exponents
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), exponent| (least.min(exponent), most.max(exponent)));
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
        let series = Series { points, mark: Mark::Circle, colour: 1 };
        let panel = Panel { x: axis("time [s]"), y: axis("error"), series: vec![series] };
        let entry = Entry { name: "f64".into(), mark: Mark::Circle, colour: 1 };
        Picture { title: "title".into(), panels: vec![panel], legend: vec![entry] }
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
