//! The shapes in a panel, in the coordinates of its axes.

use super::axis::PlotArea;
use super::canvas::{Anchor, PlotLayer, Stroke, TextLine};
use super::color::Color;
use super::font::{self, TextBox};
use super::mark::{Mark, arrow};
use super::{Pixel, PlotPoint, curve};
use crate::write::words;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// A shape in the coordinates of its panel's axes; fonts, marks and strokes are in px.
#[derive(Debug, Clone)]
pub enum PlotShape {
    /// A line through all points; a point that has no place on the axes interrupts it.
    Line { points: Vec<PlotPoint>, stroke: Stroke },
    /// A mark at each point; `size` is half its width.
    Marks { points: Vec<PlotPoint>, mark: Mark, color: Color, size: f64 },
    /// Closed loops of corners. The points inside an odd number of loops are filled.
    Area { loops: Vec<Vec<PlotPoint>>, fill: Option<Color>, stroke: Option<Stroke> },
    /// A circle whose radius is in units of the x axis.
    Circle { center: PlotPoint, radius: f64, fill: Option<Color>, stroke: Option<Stroke> },
    /// An arrow with its tip at `to`; a short arrow has a smaller head.
    Arrow { from: PlotPoint, to: PlotPoint, stroke: Stroke },
    /// A line of text centered at a point, with a white rim that keeps it readable over lines.
    Text { at: PlotPoint, text: String, size: u32 },
    /// Names of points, which do not overlap: next to or above their points if possible, with `below` below.
    Names { names: Vec<(PlotPoint, String)>, below: bool, color: Color },
}

impl PlotShape {
    /// Returns the points that the axes of its panel must include.
    pub(in crate::draw) fn extent(&self) -> Vec<PlotPoint> {
        match self {
            Self::Line { points, .. } | Self::Marks { points, .. } => points.clone(),
            Self::Area { loops, .. } => loops.concat(),
            &Self::Circle { center: (x, y), radius, .. } => vec![(x - radius, y - radius), (x + radius, y + radius)],
            &Self::Arrow { from, to, .. } => vec![from, to],
            Self::Text { at, .. } => vec![*at],
            Self::Names { names, .. } => names.iter().map(|(point, _)| *point).collect(),
        }
    }

    /// Returns the lines that the shape consists of and their stroke; `None` if it has no lines.
    fn lines(&self) -> Option<(Vec<Vec<PlotPoint>>, Stroke)> {
        match self {
            Self::Line { points, stroke } => Some((vec![points.clone()], *stroke)),
            &Self::Arrow { from, to, stroke } => Some((vec![vec![from, to]], stroke)),
            Self::Area { loops, stroke, .. } => {
                let closed = |corners: &Vec<PlotPoint>| corners.iter().chain(corners.first()).copied().collect();
                Some((loops.iter().map(closed).collect(), (*stroke)?))
            }
            &Self::Circle { center: (x, y), radius, stroke, .. } => {
                let rim = (0..=ROUND).map(|part| libm::sincos(TAU * f64::from(part) / f64::from(ROUND)));
                Some((vec![rim.map(|(sin, cos)| (x + radius * cos, y + radius * sin)).collect()], stroke?))
            }
            _ => None,
        }
    }

    /// Draws the shape into `out`. Names avoid the places that are `taken`, and are added to them.
    pub(super) fn draw(&self, area: &PlotArea, taken: &mut Taken, out: &mut PlotLayer) {
        match self {
            Self::Line { points, stroke } => {
                let placed: Vec<Option<Pixel>> = points.iter().map(|&point| area.place(point)).collect();
                for part in placed.split(Option::is_none) {
                    let part: Vec<Pixel> = part.iter().copied().flatten().collect();
                    curve::visible(&part, area.size()).into_iter().for_each(|piece| out.line(piece, *stroke));
                }
            }
            Self::Marks { points, mark, color, size } => {
                let (mut drawn, (width, height)) = (BTreeSet::new(), area.size());
                let seen = points.iter().filter_map(|&point| area.place(point)).filter(|&(x, y)| {
                    // Only the first of several marks within a tenth of a pixel is drawn.
                    let is_inside = (0.0..=width).contains(&x) && (0.0..=height).contains(&y);
                    is_inside && drawn.insert(((10.0 * x).round() as i64, (10.0 * y).round() as i64))
                });
                seen.for_each(|at| mark.draw(at, *color, *size, out));
            }
            Self::Area { loops, fill, stroke } => {
                let enclosed = |corners: &Vec<PlotPoint>| {
                    let placed: Vec<Pixel> = corners.iter().filter_map(|&corner| area.place(corner)).collect();
                    curve::enclosed(&placed, area.size())
                };
                out.area(loops.iter().map(enclosed).collect(), *fill, *stroke);
            }
            &Self::Circle { center, radius, fill, stroke } => {
                let Some(center) = area.place(center) else { return };
                out.circle(center, radius * area.x.scale(), fill, stroke);
            }
            &Self::Arrow { from, to, stroke } => {
                if let (Some(from), Some(to)) = (area.place(from), area.place(to)) {
                    arrow(from, to, stroke, out);
                }
            }
            Self::Text { at, text, size } => {
                let Some((x, y)) = area.place(*at) else { return };
                let at = (x, TextLine::baseline(y, *size));
                out.text(TextLine { rim: true, ..TextLine::new(at, text, *size, Anchor::Middle) });
            }
            Self::Names { names, below, color } => {
                let names = names.iter().filter_map(|(point, name)| Some((area.place(*point)?, name.as_str())));
                let names = gathered(names.collect());
                names.iter().for_each(|(at, name)| draw_name((*at, name), *below, *color, area, taken, out));
            }
        }
    }
}

/// Places that names avoid: always marks, thick lines and other names; thin lines only if another place is free.
#[derive(Debug, Default)]
pub(super) struct Taken {
    marks: Vec<TextBox>,
    thin: Vec<TextBox>,
}

impl Taken {
    /// Returns the places that these shapes take; nothing if no shape has names.
    pub fn by(shapes: &[PlotShape], area: &PlotArea) -> Self {
        let mut taken = Self::default();
        if !shapes.iter().any(|shape| matches!(shape, PlotShape::Names { .. })) {
            return taken;
        }
        for shape in shapes {
            if let PlotShape::Marks { points, size, .. } = shape {
                let placed = points.iter().filter_map(|&point| area.place(point));
                taken.marks.extend(placed.map(|at| TextBox::around(at, *size)));
            }
            let Some((lines, Stroke { width, .. })) = shape.lines() else { continue };
            let placed = |line: &Vec<PlotPoint>| line.iter().filter_map(|&at| area.place(at)).collect::<Vec<Pixel>>();
            let along = |pair: &[Pixel]| {
                let [from, to] = [pair[0], pair[1]];
                let (dx, dy) = (to.0 - from.0, to.1 - from.1);
                let pieces = (libm::hypot(dx, dy) / THICK).min(MOST).ceil().max(1.0);
                let at = move |piece: usize| (from.0 + dx * piece as f64 / pieces, from.1 + dy * piece as f64 / pieces);
                (0..=pieces as usize).map(move |piece| TextBox::around(at(piece), 0.5 * width))
            };
            let kind = if width >= THICK { &mut taken.marks } else { &mut taken.thin };
            lines.iter().map(placed).for_each(|line| kind.extend(line.windows(2).flat_map(along)));
        }
        taken
    }
}

/// The least width of a thick line, and the distance between the points at which a line counts as taken \[px\]. Each
/// segment is divided into at most `MOST` parts.
const THICK: f64 = 4.0;
const MOST: f64 = 400.0;
/// The number of segments that stand for a circle.
const ROUND: u32 = 48;
/// The font size of names \[px\].
const SIZE: u32 = 11;
/// The distance from a point to its name \[px\].
const GAP: f64 = 8.0;
/// The distance from one ring of places to the next \[px\].
const RING: f64 = 13.0;
const RINGS: i32 = 8;
/// The additional distance of a name from later names on its left and right \[px\].
const NEXT: f64 = 4.0;
/// More than `AROUND` names whose points are closer than `SAME` \[px\] become one text of about `LETTERS` letters.
const SAME: f64 = 1.0;
const AROUND: usize = 6;
const LETTERS: usize = 28;
/// A name farther than this from its point has a line to it \[px\].
const FAR: f64 = 22.0;

/// Joins the names of one place into a single text if there are too many to stand around it.
fn gathered(names: Vec<(Pixel, &str)>) -> Vec<(Pixel, String)> {
    let is_near = |a: Pixel, b: Pixel| libm::hypot(a.0 - b.0, a.1 - b.1) < SAME;
    let mut gathered: Vec<(Pixel, String)> = Vec::new();
    for &(at, name) in &names {
        let alike: Vec<&str> = names.iter().filter(|(other, _)| is_near(*other, at)).map(|(_, name)| *name).collect();
        match alike.len() > AROUND {
            true if gathered.iter().any(|(known, _)| is_near(*known, at)) => {}
            true => gathered.push((at, words::list(&alike, LETTERS))),
            false => gathered.push((at, name.to_owned())),
        }
    }
    gathered
}

/// Draws a name next to or above its point, with `below` below it, and if possible away from the places `taken`.
fn draw_name(
    (at, name): (Pixel, &str),
    below: bool,
    color: Color,
    area: &PlotArea,
    taken: &mut Taken,
    out: &mut PlotLayer,
) {
    let places = || places(at, font::width(name, SIZE), below);
    let clear = |place: &TextBox, of: &[TextBox]| !of.iter().any(|other| other.meets(place));
    let is_free = |place: &TextBox| place.is_within(area.size()) && clear(place, &taken.marks);
    let free = places().find(|place| is_free(place) && clear(place, &taken.thin)).or_else(|| places().find(is_free));
    let Some(place) = free.or_else(|| places().next()) else { return };
    taken.marks.push(TextBox { half: (place.half.0 + NEXT, place.half.1), ..place });
    let (left, right) = (place.middle.0 - place.half.0, place.middle.0 + place.half.0);
    let near = (at.0.clamp(left, right), place.middle.1);
    if libm::hypot(near.0 - at.0, near.1 - at.1) > FAR {
        out.line(vec![at, near], Stroke::solid(Color::Gray, 0.6));
    }
    let baseline = (left, TextLine::baseline(place.middle.1, SIZE));
    out.text(TextLine { rim: true, color, ..TextLine::new(baseline, name, SIZE, Anchor::Start) });
}

/// Returns places for a name of this `width` \[px\], nearest first.
fn places((x, y): Pixel, width: f64, below: bool) -> impl Iterator<Item = TextBox> {
    // Points that are named below lie on a line, such as the ground, that a name at their height would cover.
    let (nearest, down, level) = if below { (1, 1.0, 1.0) } else { (0, -1.0, 0.0) };
    (nearest..=RINGS).flat_map(move |ring| {
        let reach = f64::from(ring) * RING;
        let middles = [level, down, -down].map(|way| y + way * reach);
        let across = if below { x - 0.5 * width } else { x + GAP };
        let lefts = [x + GAP, x - GAP - width, across, x + GAP + reach, x - GAP - reach - width];
        middles.into_iter().flat_map(move |middle| {
            let half = (0.5 * width, 0.5 * RING - 0.5);
            lefts.into_iter().map(move |left| TextBox { middle: (left + half.0, middle), half })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::plot::axis::{PlotAxis, Span};

    #[test]
    fn names_of_one_point_do_not_cover_each_other() {
        let axis = PlotAxis { range: Some((0.0, 1.0)), ..PlotAxis::default() };
        let span = || Span::new(&axis, std::iter::empty(), 300.0);
        let area = PlotArea { x: span(), y: span() };
        let names = (0..6).map(|at| ((0.5, 0.5), format!("link_{at}"))).collect();
        let names = PlotShape::Names { names, below: false, color: Color::Black };
        let marked = PlotShape::Marks { points: vec![(0.5, 0.5)], mark: Mark::Circle, color: Color::Black, size: 4.0 };
        let edge = PlotShape::Line { points: vec![(0.6, 0.0), (0.6, 1.0)], stroke: Stroke::solid(Color::Gray, 1.0) };
        let mut taken = Taken::by(&[marked, edge, names.clone()], &area);
        names.draw(&area, &mut taken, &mut PlotLayer::default());
        let Taken { marks, thin } = taken;
        assert_eq!(marks.len(), 7);
        // The additional distance of a name applies to later names, not to the mark.
        let bare = |at: usize, TextBox { middle, half }| match at {
            0 => TextBox { middle, half },
            _ => TextBox { middle, half: (half.0 - NEXT, half.1) },
        };
        for (at, place) in marks.iter().enumerate() {
            let (others, place) = (marks[..at].iter().chain(&thin), bare(at, *place));
            assert!(place.is_within(area.size()) && others.clone().all(|other| !other.meets(&place)), "{place:?}");
        }
    }

    #[test]
    fn many_names_of_one_point_are_one() {
        let names: Vec<String> = (0..10).map(|at| format!("foot_{at}")).collect();
        let places = names.iter().map(|name| ((5.0, 5.0), name.as_str()));
        let gathered = gathered(places.chain([((9.0, 5.0), "knee")]).collect());
        assert_eq!(
            gathered,
            [((5.0, 5.0), "foot_0, foot_1, foot_2 and 7 more".into()), ((9.0, 5.0), "knee".to_owned())]
        );
    }
}
