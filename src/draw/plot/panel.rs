//! Panels: axes on the screen, and shapes inside them.

use super::axis::{PlotArea, PlotAxis, Span, Tick};
use super::canvas::{Anchor, Element, PlotLayer, Stroke, TextLine};
use super::color::Color;
use super::shape::{PlotShape, Taken};
use super::{Pixel, PlotPoint, font};

#[derive(Debug, Clone)]
pub struct Panel {
    /// The text above the panel; lines after the first are smaller.
    pub title: String,
    pub x: PlotAxis,
    pub y: PlotAxis,
    /// Width and height inside the axes \[px\].
    pub size: Pixel,
    /// Whether the axes are drawn.
    pub framed: bool,
    /// Whether both axes have the same scale. If so, an axis may span more than the shapes need.
    pub equal: bool,
    /// Shaded intervals in the background, in the order of x.
    pub bands: Vec<Band>,
    /// The shapes; each is drawn above those before it.
    pub shapes: Vec<PlotShape>,
}

/// A shaded interval of x with a letter at the top of the panel. A band too narrow to be shaded is drawn as a line.
#[derive(Debug, Clone)]
pub struct Band {
    pub from: f64,
    pub to: f64,
    pub letter: String,
    pub fill: Color,
}

/// The size of a row or a column of panels: inside the axes, and before and after them \[px\].
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Track {
    pub before: f64,
    pub inside: f64,
    pub after: f64,
}

impl Track {
    /// Returns the greatest of each length.
    pub fn most(tracks: impl Iterator<Item = Self>) -> Self {
        tracks.fold(Self::default(), |most, track| Self {
            before: most.before.max(track.before),
            inside: most.inside.max(track.inside),
            after: most.after.max(track.after),
        })
    }

    pub fn whole(&self) -> f64 {
        self.before + self.inside + self.after
    }
}

/// The font size of titles, labels and letters \[px\].
const LABEL: u32 = 14;
/// The smallest font size of the label of a low panel's y axis, and the font size of numbers and smaller titles \[px\].
const SMALL: u32 = 9;
const NUMBER: u32 = 12;
/// The distance between lines of a panel's title \[px\].
const LINE: f64 = 18.0;
/// The length of a tick, and the distance from a tick to its number \[px\].
const TICK: f64 = 5.0;
const NEAR: f64 = 3.0;
/// The room for the labels of the x axis and the y axis \[px\].
const BELOW: f64 = 22.0;
const LEFT: f64 = 30.0;
/// The margin of a panel without axes, and the least margin above and to the right of axes \[px\].
const BARE: f64 = 6.0;
const ABOVE: f64 = 10.0;
/// The distance from the axes to the letters of bands, and from one letter to the letter below it \[px\].
const MARGIN: f64 = 6.0;
const STORY: f64 = 16.0;
/// Letters of bands that are closer than this stand below each other \[px\], in at most `STORIES` rows.
const ROOM: f64 = 14.0;
const STORIES: usize = 4;

const AXIS: Stroke = Stroke::solid(Color::Black, 1.0);
const GRID: Stroke = Stroke::solid(Color::Pale, 1.0);
const EDGE: Stroke = Stroke::solid(Color::Gray, 0.8);

impl Panel {
    /// Creates an empty panel of the usual size with these axes.
    pub fn new(x: PlotAxis, y: PlotAxis) -> Self {
        let (title, bands, shapes) = (String::new(), Vec::new(), Vec::new());
        Self { title, x, y, size: (540.0, 420.0), framed: true, equal: false, bands, shapes }
    }

    /// Returns the title in lines no wider than the panel, each with its font size and color.
    fn title_lines(&self) -> Vec<(String, u32, Color)> {
        let (first, rest) = self.title.split_once('\n').unwrap_or((&self.title, ""));
        let lines =
            |text, size, color| font::lines(text, size, self.size.0).into_iter().map(move |line| (line, size, color));
        lines(first, LABEL, Color::Black).chain(lines(rest, NUMBER, Color::Gray)).collect()
    }
}

/// A panel whose axes have their ranges and lengths.
#[derive(Debug)]
pub(super) struct PlacedPanel<'p> {
    pub panel: &'p Panel,
    pub area: PlotArea,
}

impl<'p> PlacedPanel<'p> {
    /// Computes the axes of a panel; `None` if nothing in it has a place on them.
    pub fn new(panel: &'p Panel) -> Option<Self> {
        let (width, height) = panel.size;
        let points: Vec<PlotPoint> = panel.shapes.iter().flat_map(PlotShape::extent).collect();
        let along = points.iter().map(|point| point.0).chain(panel.bands.iter().flat_map(|band| [band.from, band.to]));
        let mut x = Span::new(&panel.x, along, width);
        let mut y = Span::new(&panel.y, points.iter().map(|point| point.1), height);
        if panel.equal {
            let ratio = x.scale() / y.scale();
            if ratio > 1.0 { x.widen(ratio) } else { y.widen(1.0 / ratio) }
        }
        let mut placed = Self { panel, area: PlotArea { x, y } };
        let stories = placed.letters().iter().map(|letter| letter.story + 1).max();
        if let (Some(stories), None) = (stories, panel.y.range) {
            // The y axis leaves room for the letters above the curves.
            placed.area.y.leave(MARGIN + stories as f64 * STORY);
        }
        let on = |value: f64, axis: &PlotAxis| value.is_finite() && (!axis.logarithmic || value > 0.0);
        let is_drawn = points.iter().any(|&(x, y)| on(x, &panel.x) && on(y, &panel.y)) || !panel.bands.is_empty();
        is_drawn.then_some(placed)
    }

    /// Returns the room that the panel needs horizontally and vertically.
    pub fn tracks(&self) -> [Track; 2] {
        let Panel { x, y, framed, size: (width, height), .. } = self.panel;
        let title = self.panel.title_lines().len() as f64 * LINE;
        let top = if title > 0.0 { title + ABOVE } else { ABOVE };
        let (mut left, mut right, mut bottom) = (BARE, BARE, BARE);
        if *framed {
            let label = |axis: &PlotAxis, room: f64| if axis.label.is_empty() { 0.0 } else { room };
            bottom = if x.bare { 4.0 } else { TICK + NEAR + f64::from(NUMBER) + BARE + label(x, BELOW) };
            let width = |tick: Tick| font::width(&tick.text, NUMBER);
            let widest = self.area.y.ticks().map(width).fold(0.0, f64::max);
            left = if y.bare { ABOVE } else { widest + TICK + NEAR + label(y, LEFT) };
            // Half of the last number may extend beyond the axis.
            right = self.area.x.ticks().last().map_or(0.0, |tick| 0.5 * width(tick)).max(ABOVE);
        }
        [Track { before: left, inside: *width, after: right }, Track { before: top, inside: *height, after: bottom }]
    }

    /// Draws the panel. `corner` is the upper left corner of the axes; the y axis's label is `left` px to their left.
    pub fn draw(&self, corner: Pixel, left: f64, out: &mut PlotLayer) {
        let panel = self.panel;
        let title = panel.title_lines();
        for (line, (content, size, color)) in title.iter().enumerate() {
            let baseline = corner.1 - 8.0 - LINE * (title.len() - 1 - line) as f64;
            let at = (corner.0 + 0.5 * panel.size.0, baseline);
            out.text(TextLine { color: *color, ..TextLine::new(at, content, *size, Anchor::Middle) });
        }
        let mut inside = PlotLayer::default();
        if panel.bands.is_empty() {
            self.grid(&mut inside);
        }
        panel.bands.iter().for_each(|band| self.band(band, &mut inside));
        let mut taken = Taken::by(&panel.shapes, &self.area);
        panel.shapes.iter().for_each(|shape| shape.draw(&self.area, &mut taken, &mut inside));
        for BandLetter { text, middle, story, is_wide } in self.letters() {
            let baseline = MARGIN + font::CAPITAL * f64::from(LABEL) + story as f64 * STORY;
            inside.text(TextLine { rim: is_wide, ..TextLine::new((middle, baseline), text, LABEL, Anchor::Middle) });
        }
        out.0.push(Element::Window { corner, size: panel.size, layer: inside });
        if panel.framed {
            self.axes(corner, left, out);
        }
    }

    fn grid(&self, out: &mut PlotLayer) {
        let Panel { x, y, framed: true, size: (width, height), .. } = self.panel else { return };
        if !x.bare {
            let lines = self.area.x.ticks().map(|tick| width * tick.share);
            lines.for_each(|x| out.line(vec![(x, 0.0), (x, *height)], GRID));
        }
        if !y.bare {
            let lines = self.area.y.ticks().map(|tick| height * (1.0 - tick.share));
            lines.for_each(|y| out.line(vec![(0.0, y), (*width, y)], GRID));
        }
    }

    /// Draws both axes with their ticks, numbers and labels.
    fn axes(&self, (left, top): Pixel, room: f64, out: &mut PlotLayer) {
        let Panel { x, y, size: (width, height), .. } = self.panel;
        let (middle, bottom) = ((left + 0.5 * width, top + 0.5 * height), top + height);
        if !x.bare {
            let baseline = bottom + TICK + NEAR + font::CAPITAL * f64::from(NUMBER);
            for tick in self.area.x.ticks() {
                let at = left + width * tick.share;
                out.line(vec![(at, bottom), (at, bottom + TICK)], AXIS);
                out.text(TextLine::new((at, baseline), &tick.text, NUMBER, Anchor::Middle));
            }
            let label = self.area.x.label(&x.label);
            out.text(TextLine::new((middle.0, baseline + BELOW), &label, LABEL, Anchor::Middle));
        }
        if !y.bare {
            for tick in self.area.y.ticks() {
                let at = bottom - height * tick.share;
                out.line(vec![(left - TICK, at), (left, at)], AXIS);
                let baseline = (left - TICK - NEAR, TextLine::baseline(at, NUMBER));
                out.text(TextLine::new(baseline, &tick.text, NUMBER, Anchor::End));
            }
            let at = (left - room + font::CAPITAL * f64::from(LABEL), middle.1);
            let label = self.area.y.label(&y.label);
            let fits = |size: &u32| font::width(&label, *size) <= height + BELOW;
            let size = (SMALL..=LABEL).rev().find(fits).unwrap_or(SMALL);
            out.text(TextLine { upward: true, ..TextLine::new(at, &label, size, Anchor::Middle) });
        }
        out.rectangle((left, top), (*width, *height), None, Some(AXIS));
    }

    /// Returns where a band begins and ends \[px\]; `None` if it has no place on the axis.
    fn sides(&self, band: &Band) -> Option<(f64, f64)> {
        let side = |value| Some(self.panel.size.0 * self.area.x.share(value)).filter(|side| side.is_finite());
        let (from, to) = (side(band.from)?, side(band.to)?);
        Some((from.min(to), from.max(to)))
    }

    fn band(&self, band: &Band, out: &mut PlotLayer) {
        let Some((from, to)) = self.sides(band) else { return };
        let edge = |x: f64| vec![(x, 0.0), (x, self.panel.size.1)];
        if to - from < EDGE.width {
            return out.line(edge(0.5 * (from + to)), EDGE);
        }
        out.rectangle((from, 0.0), (to - from, self.panel.size.1), Some(band.fill), None);
        out.lines(vec![edge(from), edge(to)], EDGE);
    }

    /// Places the letters of bands. The letters of narrow bands stand below each other.
    fn letters(&self) -> Vec<BandLetter<'p>> {
        let width = self.panel.size.0;
        let mut ends = [f64::NEG_INFINITY; STORIES];
        let mut letters = Vec::new();
        for band in self.panel.bands.iter().filter(|band| !band.letter.is_empty()) {
            let inside = self.sides(band).map(|(from, to)| (from.max(0.0), to.min(width)));
            let Some((from, to)) = inside.filter(|(from, to)| from <= to) else { continue };
            let half = 0.5 * font::width(&band.letter, LABEL).max(ROOM);
            let middle = (0.5 * (from + to)).min(width - half).max(half);
            let story = ends.iter().position(|end| middle - half >= *end).unwrap_or(STORIES - 1);
            ends[story] = middle + half;
            letters.push(BandLetter { text: &band.letter, middle, story, is_wide: to - from < 2.0 * half });
        }
        letters
    }
}

struct BandLetter<'a> {
    text: &'a str,
    /// The x of the letter's middle \[px\].
    middle: f64,
    /// The row of the letter, from 0 at the top.
    story: usize,
    /// Whether the letter is wider than its band.
    is_wide: bool,
}
