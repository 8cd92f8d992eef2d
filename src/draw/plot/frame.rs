//! A panel on the screen: its axes by kuva, and within them what is drawn.

use super::axis::Span;
use super::colour::Colour;
use super::shape::{Anchor, Stroke, path, text};
use super::{Band, Panel, Pixel, Point, Window, font};
use kuva::render::axis::{add_axes_and_grid, add_labels_and_title};
use kuva::render::layout::{ComputedLayout, Layout};
use kuva::render::render::{Primitive, Scene};

/// What a panel needs about its axes \[px\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Margins {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    /// What of the left is for the numbers at the ticks.
    pub numbers: f64,
}

/// A panel's axes on the screen.
#[derive(Debug)]
pub(super) struct Frame {
    x: Span,
    y: Span,
    /// Inside of the axes, from their upper left corner \[px\].
    pub size: (f64, f64),
}

/// Heights of fonts \[px\].
const LABEL: u32 = 14;
const TICK: u32 = 12;
const TITLE: u32 = 14;
const LETTER: u32 = 14;
/// From one line of a panel's title to the next \[px\].
const LINE: f64 = 18.0;
/// Letters of bands closer than this stand below each other \[px\].
const ROOM: f64 = 14.0;
/// From the axes to the letters of bands, and from one letter to the next below it \[px\].
const MARGIN: f64 = 6.0;
const STOREY: f64 = 16.0;
/// So many letters stand below each other at most.
const STOREYS: usize = 4;

impl Frame {
    /// The axes of a panel.
    pub fn new(panel: &Panel) -> Self {
        let (width, height) = panel.size;
        let points: Vec<Point> = panel.shapes.iter().flat_map(|shape| shape.extent()).collect();
        let along = points.iter().map(|point| point.0).chain(panel.bands.iter().flat_map(|band| [band.from, band.to]));
        let mut x = Span::new(&panel.x, along, width);
        let mut y = Span::new(&panel.y, points.iter().map(|point| point.1), height);
        if panel.equal {
            let ratio = x.scale(width) / y.scale(height);
            if ratio > 1.0 { x.widen(ratio, width) } else { y.widen(1.0 / ratio, height) }
        }
        let mut frame = Self { x, y, size: panel.size };
        let storeys = frame.letters(&panel.bands).iter().map(|letter| letter.storey + 1).max();
        if let (Some(storeys), None) = (storeys, panel.y.range) {
            // No curve runs through the letters.
            frame.y.leave(MARGIN + storeys as f64 * STOREY, height);
        }
        frame
    }

    /// Where a point is, from the upper left corner of the axes \[px\]; nowhere where it has no place on them.
    pub fn place(&self, (x, y): Point) -> Option<Pixel> {
        let at = (self.size.0 * self.x.share(x), self.size.1 * (1.0 - self.y.share(y)));
        (at.0.is_finite() && at.1.is_finite()).then_some(at)
    }

    /// The inside of the axes, with its upper left corner there.
    pub fn window(&self, corner: Pixel) -> Window {
        Window { corner, size: self.size, x: self.x.ends(), y: self.y.ends() }
    }

    /// Whether a pixel is inside of the axes.
    pub fn holds(&self, (x, y): Pixel) -> bool {
        (0.0..=self.size.0).contains(&x) && (0.0..=self.size.1).contains(&y)
    }

    /// How many pixels a unit of the x axis takes.
    pub fn scale(&self) -> f64 {
        self.x.scale(self.size.0)
    }

    /// What the axes need about them.
    pub fn margins(&self, panel: &Panel) -> Margins {
        let title = panel.title_lines().len() as f64 * LINE;
        let top = if title > 0.0 { title + 10.0 } else { 10.0 };
        if !panel.framed {
            return Margins { left: 6.0, right: 6.0, top, bottom: 6.0, numbers: 0.0 };
        }
        let computed = ComputedLayout::from_layout(&self.layout(panel));
        let bottom = match (panel.x.bare, panel.x.label.is_empty()) {
            (true, _) => 4.0,
            (false, true) => 28.0,
            (false, false) => computed.margin_bottom,
        };
        let left = if panel.y.bare { 10.0 } else { computed.margin_left };
        Margins { left, right: computed.margin_right, top, bottom, numbers: computed.y_tick_label_px }
    }

    /// Axes and their ticks.
    fn layout(&self, panel: &Panel) -> Layout {
        let (x, y) = (&self.x, &self.y);
        let mut layout = Layout::new((x.low, x.high), (y.low, y.high))
            .with_x_axis_min(x.low)
            .with_x_axis_max(x.high)
            .with_y_axis_min(y.low)
            .with_y_axis_max(y.high)
            .with_x_tick_step(x.step)
            .with_y_tick_step(y.step)
            .with_x_tick_format(x.format())
            .with_y_tick_format(y.format())
            .with_label_size(LABEL)
            .with_tick_size(TICK)
            .with_show_grid(panel.bands.is_empty())
            .with_box_axes();
        layout.suppress_x_ticks = panel.x.bare;
        layout.suppress_y_ticks = panel.y.bare;
        if !panel.x.bare && !panel.x.label.is_empty() {
            layout = layout.with_x_label(x.label(&panel.x.label));
        }
        if !panel.y.bare {
            layout = layout.with_y_label(y.label(&panel.y.label));
        }
        layout
    }

    /// Draws the panel with these margins about its axes, their outer corner at `at`.
    pub fn draw(&self, panel: &Panel, margins: Margins, at: Pixel, scene: &mut Scene) {
        let (width, height) = self.size;
        scene.add(group(at, None));
        let title = panel.title_lines();
        for (line, (content, is_first)) in title.iter().enumerate() {
            let (size, colour) = if *is_first { (TITLE, Colour::Black) } else { (TICK, Colour::Grey) };
            let baseline = margins.top - 8.0 - LINE * (title.len() - 1 - line) as f64;
            let middle = (margins.left + 0.5 * width, baseline);
            text(middle, content, size, Anchor::Middle, colour, false, &mut scene.elements);
        }
        // Whoever puts two pictures onto one page has two such clips: what has the same name is the same.
        let id = format!("clip{width:.0}x{height:.0}");
        let clip = format!(r#"<clipPath id="{id}"><rect width="{width:.2}" height="{height:.2}" /></clipPath>"#);
        if !scene.defs.contains(&clip) {
            scene.defs.push(clip);
        }
        let clipped = || format!(r#"clip-path="url(#{id})" stroke-linejoin="round" fill-rule="evenodd""#);
        let inside = || group((margins.left, margins.top), Some(clipped()));
        if !panel.bands.is_empty() {
            scene.add(inside());
            panel.bands.iter().for_each(|band| self.band(band, &mut scene.elements));
            scene.add(Primitive::GroupEnd);
        }
        if panel.framed {
            let (whole_width, whole_height) =
                (margins.left + width + margins.right, margins.top + height + margins.bottom);
            let mut layout = self
                .layout(panel)
                .with_width(whole_width)
                .with_height(whole_height)
                .with_force_margins(margins.left, margins.right)
                .with_force_margins_y(margins.top, margins.bottom);
            let computed = ComputedLayout::from_layout(&layout);
            // The labels of panels above each other stand in one line.
            layout.y_label_offset.0 += computed.y_tick_label_px - margins.numbers;
            add_axes_and_grid(scene, &computed, &layout);
            add_labels_and_title(scene, &computed, &layout);
        }
        scene.add(inside());
        let mut taken = panel.shapes.iter().flat_map(|shape| shape.marked(self)).collect();
        panel.shapes.iter().for_each(|shape| shape.draw(self, &mut taken, &mut scene.elements));
        self.letters(&panel.bands).iter().for_each(|letter| letter.draw(&mut scene.elements));
        scene.add(Primitive::GroupEnd);
        scene.add(Primitive::GroupEnd);
    }

    /// Where a band begins and ends \[px\].
    fn sides(&self, band: &Band) -> Option<(f64, f64)> {
        let side = |value| Some(self.size.0 * self.x.share(value)).filter(|side| side.is_finite());
        let (from, to) = (side(band.from)?, side(band.to)?);
        Some((from.min(to), from.max(to)))
    }

    fn band(&self, band: &Band, out: &mut Vec<Primitive>) {
        let Some((from, to)) = self.sides(band) else { return };
        let height = self.size.1;
        let edge = Stroke::solid(Colour::Grey, 0.8);
        if to - from < edge.width {
            let middle = 0.5 * (from + to);
            out.push(path(&[&[(middle, 0.0), (middle, height)]], false, None, Some(edge)));
            return;
        }
        out.push(path(&[&[(from, 0.0), (to, 0.0), (to, height), (from, height)]], true, Some(band.fill), None));
        let edges = [[(from, 0.0), (from, height)], [(to, 0.0), (to, height)]];
        out.push(path(&edges.each_ref().map(<[Pixel; 2]>::as_slice), false, None, Some(edge)));
    }

    /// The letters of bands; where bands are narrow, below each other.
    fn letters<'a>(&self, bands: &'a [Band]) -> Vec<Letter<'a>> {
        let mut ends = [f64::NEG_INFINITY; STOREYS];
        let mut letters = Vec::new();
        for band in bands.iter().filter(|band| !band.letter.is_empty()) {
            let Some((from, to)) = self.sides(band) else { continue };
            let (from, to) = (from.max(0.0), to.min(self.size.0));
            if from > to {
                continue;
            }
            let half = 0.5 * font::width(&band.letter, LETTER).max(ROOM);
            let middle = (0.5 * (from + to)).min(self.size.0 - half).max(half);
            let storey = ends.iter().position(|end| middle - half >= *end).unwrap_or(STOREYS - 1);
            ends[storey] = middle + half;
            letters.push(Letter { text: &band.letter, middle, storey, narrow: to - from < 2.0 * half });
        }
        letters
    }
}

/// The letter of a band.
struct Letter<'a> {
    text: &'a str,
    /// Where its middle is \[px\].
    middle: f64,
    /// How many other letters stand above it.
    storey: usize,
    /// Whether it is wider than its band.
    narrow: bool,
}

impl Letter<'_> {
    fn draw(&self, out: &mut Vec<Primitive>) {
        let baseline = MARGIN + font::CAPITAL * f64::from(LETTER) + self.storey as f64 * STOREY;
        text((self.middle, baseline), self.text, LETTER, Anchor::Middle, Colour::Black, self.narrow, out);
    }
}

impl Panel {
    /// The title, broken where the panel ends, and which lines belong to its first one.
    fn title_lines(&self) -> Vec<(String, bool)> {
        let (first, rest) = self.title.split_once('\n').unwrap_or((&self.title, ""));
        let lines = |text, size| font::lines(text, size, self.size.0);
        let first = lines(first, TITLE).into_iter().map(|line| (line, true));
        first.chain(lines(rest, TICK).into_iter().map(|line| (line, false))).collect()
    }
}

fn group((x, y): Pixel, extra_attrs: Option<String>) -> Primitive {
    Primitive::GroupStart { transform: Some(format!("translate({x:.2},{y:.2})")), title: None, extra_attrs }
}
