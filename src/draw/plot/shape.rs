//! What is drawn in a panel, from its data's coordinates to kuva's primitives.

use super::colour::Colour;
use super::frame::Frame;
use super::names::{self, Place};
use super::{Pixel, Point, curve, font, number};
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, TextAnchor};
use std::collections::BTreeSet;

/// Something that is drawn, in the coordinates of its panel's axes.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A line through all points; a point that has no place on the axes interrupts it.
    Line {
        /// From one to the next.
        points: Vec<Point>,
        /// How it is drawn.
        stroke: Stroke,
    },
    /// A mark at each point.
    Marks {
        /// Where.
        points: Vec<Point>,
        /// What.
        mark: Mark,
        /// Of its fill.
        colour: Colour,
        /// Half its width \[px\].
        size: f64,
    },
    /// Closed loops; what lies within an odd number of them is filled.
    Area {
        /// The corners of each.
        loops: Vec<Vec<Point>>,
        /// Its inside.
        fill: Option<Colour>,
        /// Its outline.
        stroke: Option<Stroke>,
    },
    /// A circle; round where both axes have one scale.
    Circle {
        /// Its centre.
        centre: Point,
        /// Its radius, in units of the x axis.
        radius: f64,
        /// Its inside.
        fill: Option<Colour>,
        /// Its outline.
        stroke: Option<Stroke>,
    },
    /// An arrow with a head of fixed size, of a short one a smaller head.
    Arrow {
        /// Its tail.
        from: Point,
        /// Its tip.
        to: Point,
        /// Its shaft.
        stroke: Stroke,
    },
    /// A text.
    Text(Label),
    /// Names of points, which keep clear of each other.
    Names {
        /// Each point and its name.
        names: Vec<(Point, String)>,
        /// Whether a name stands rather below its point than above.
        below: bool,
    },
}

/// A text beside a point.
#[derive(Debug, Clone)]
pub struct Label {
    /// The point.
    pub at: Point,
    /// From the point to the text, right and up \[px\].
    pub offset: Pixel,
    /// What it says.
    pub text: String,
    /// Which part of the text is there.
    pub anchor: Anchor,
    /// Height of the font \[px\].
    pub size: u32,
    /// Of its letters.
    pub colour: Colour,
    /// Whether a white rim keeps it readable over lines.
    pub rim: bool,
}

/// The part of a text that is at its place; up and down its middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub colour: Colour,
    /// Its width \[px\].
    pub width: f64,
    /// Its dashes.
    pub dash: Dash,
}

/// Dashes of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// None.
    Solid,
    /// Long ones.
    Dashed,
    /// Dots.
    Dotted,
    /// One and the other in turn.
    DashDot,
    /// Very long ones.
    Long,
    /// A dash and two dots.
    DashDotDot,
}

/// A mark at a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// A disc.
    Circle,
    /// A disc with a hole.
    Ring,
    /// A square on its side.
    Square,
    /// A triangle, upright.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A star with five points.
    Star,
    /// A cross of two bars.
    Cross,
    /// The sign of a centre of gravity.
    Centre,
}

/// The usual size of a mark \[px\].
pub const MARK: f64 = 4.0;

/// Of an arrow's head \[px\].
const HEAD: f64 = 10.0;
const HALF_HEAD: f64 = 3.6;
/// About an arrow \[px\].
const RIM: f64 = 0.8;
/// The most that a head takes of a short arrow.
const SHORT_HEAD: f64 = 0.6;

impl Dash {
    /// All, the most different ones first.
    pub const ALL: [Self; 6] = [Self::Solid, Self::Dashed, Self::Dotted, Self::DashDot, Self::Long, Self::DashDotDot];

    fn pattern(self) -> Option<String> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some("8 4".into()),
            Self::Dotted => Some("2 3".into()),
            Self::DashDot => Some("9 3 2 3".into()),
            Self::Long => Some("18 4".into()),
            Self::DashDotDot => Some("9 3 2 3 2 3".into()),
        }
    }
}

impl Stroke {
    /// A solid line.
    pub const fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: Dash::Solid }
    }
}

impl Shape {
    /// The points that its panel's axes must span.
    pub(super) fn extent(&self) -> Vec<Point> {
        match self {
            Self::Line { points, .. } | Self::Marks { points, .. } => points.clone(),
            Self::Area { loops, .. } => loops.concat(),
            &Self::Circle { centre: (x, y), radius, .. } => vec![(x - radius, y - radius), (x + radius, y + radius)],
            &Self::Arrow { from, to, .. } => vec![from, to],
            Self::Text(label) => vec![label.at],
            Self::Names { names, .. } => names.iter().map(|(point, _)| *point).collect(),
        }
    }

    /// Where it has marks, which no name may cover.
    pub(super) fn marked(&self, frame: &Frame) -> Vec<Place> {
        let Self::Marks { points, size, .. } = self else { return Vec::new() };
        points.iter().filter_map(|&point| Some(Place::about(frame.place(point)?, *size))).collect()
    }

    /// Draws it into `out`; names keep clear of what is `taken`.
    pub(super) fn draw(&self, frame: &Frame, taken: &mut Vec<Place>, out: &mut Vec<Primitive>) {
        match self {
            Self::Line { points, stroke } => {
                let placed: Vec<Option<Pixel>> = points.iter().map(|&point| frame.place(point)).collect();
                for part in placed.split(Option::is_none) {
                    let part: Vec<Pixel> = part.iter().copied().flatten().collect();
                    for piece in curve::visible(&part, frame.size) {
                        out.push(path(&[&piece], false, None, Some(*stroke)));
                    }
                }
            }
            Self::Marks { points, mark, colour, size } => {
                let mut drawn = BTreeSet::new();
                let seen = points.iter().filter_map(|&point| frame.place(point)).filter(|&(x, y)| {
                    // What lies on another one within a tenth of a pixel is not seen.
                    frame.holds((x, y)) && drawn.insert(((10.0 * x).round() as i64, (10.0 * y).round() as i64))
                });
                seen.for_each(|at| mark.draw(at, *colour, *size, out));
            }
            Self::Area { loops, fill, stroke } => {
                let placed = |corners: &Vec<Point>| corners.iter().filter_map(|&corner| frame.place(corner)).collect();
                let loops: Vec<Vec<Pixel>> = loops.iter().map(placed).collect();
                let loops: Vec<Vec<Pixel>> = loops.iter().map(|corners| curve::enclosed(corners, frame.size)).collect();
                let loops: Vec<&[Pixel]> = loops.iter().map(Vec::as_slice).collect();
                out.push(path(&loops, true, *fill, *stroke));
            }
            &Self::Circle { centre, radius, fill, stroke } => {
                let Some((cx, cy)) = frame.place(centre) else { return };
                let r = radius * frame.scale();
                out.push(circle((cx, cy), r, fill, stroke));
            }
            &Self::Arrow { from, to, stroke } => {
                if let (Some(from), Some(to)) = (frame.place(from), frame.place(to)) {
                    arrow(from, to, stroke, out);
                }
            }
            Self::Text(label) => {
                let Some((x, y)) = frame.place(label.at) else { return };
                let at = (x + label.offset.0, y - label.offset.1 + 0.5 * font::CAPITAL * f64::from(label.size));
                text(at, &label.text, label.size, label.anchor, label.colour, label.rim, out);
            }
            Self::Names { names, below } => names::draw(names, *below, frame, taken, out),
        }
    }
}

impl Mark {
    /// Draws it about a point.
    pub(super) fn draw(self, (x, y): Pixel, colour: Colour, size: f64, out: &mut Vec<Primitive>) {
        let corners = |directions: &[(f64, f64)]| -> Vec<Pixel> {
            directions.iter().map(|&(right, up)| (x + size * right, y - size * up)).collect()
        };
        let outline = match self {
            Self::Circle => return out.push(circle((x, y), size, Some(colour), None)),
            Self::Ring => {
                return out.push(circle((x, y), size, Some(Colour::White), Some(Stroke::solid(colour, 1.5))));
            }
            Self::Centre => {
                out.push(circle((x, y), size, Some(Colour::White), Some(Stroke::solid(colour, 1.0))));
                let arc = |start: f64| -> Vec<Pixel> {
                    let turn = |step: i32| start + f64::from(step) * std::f64::consts::FRAC_PI_2 / 8.0;
                    let rim = (0..=8).map(|step| (x + size * libm::cos(turn(step)), y + size * libm::sin(turn(step))));
                    std::iter::once((x, y)).chain(rim).collect()
                };
                let quarters = [arc(0.0), arc(std::f64::consts::PI)];
                return out.push(path(&quarters.each_ref().map(Vec::as_slice), true, Some(colour), None));
            }
            Self::Square => corners(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            Self::Triangle => corners(&[(-1.0, -0.8), (1.0, -0.8), (0.0, 1.0)]),
            Self::Diamond => corners(&[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)]),
            Self::Star => {
                let spike = |at: i32| {
                    let (angle, reach) = (f64::from(at) * std::f64::consts::PI / 5.0, [1.3, 0.55][at as usize % 2]);
                    (reach * libm::sin(angle), reach * libm::cos(angle))
                };
                corners(&(0..10).map(spike).collect::<Vec<_>>())
            }
            Self::Cross => {
                let stroke = Some(Stroke::solid(colour, 1.6));
                let bars = [corners(&[(-0.9, -0.9), (0.9, 0.9)]), corners(&[(-0.9, 0.9), (0.9, -0.9)])];
                return out.push(path(&bars.each_ref().map(Vec::as_slice), false, None, stroke));
            }
        };
        out.push(path(&[&outline], true, Some(colour), None));
    }
}

/// Draws an arrow from pixel to pixel.
pub(super) fn arrow(from: Pixel, to: Pixel, stroke: Stroke, out: &mut Vec<Primitive>) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = libm::hypot(dx, dy);
    // Less than a pixel has no direction.
    if length < 1.0 {
        return;
    }
    let (along, across) = ((dx / length, dy / length), (-dy / length, dx / length));
    let head = HEAD.min(SHORT_HEAD * length);
    let half = HALF_HEAD * head / HEAD;
    let base = (to.0 - head * along.0, to.1 - head * along.1);
    // The shaft ends inside of the head.
    let end = (base.0 + 0.1 * head * along.0, base.1 + 0.1 * head * along.1);
    let side = |sign: f64| (base.0 + sign * half * across.0, base.1 + sign * half * across.1);
    let (shaft, tip) = ([from, end], [to, side(1.0), side(-1.0)]);
    // A white rim sets it off from what it lies on; between dashes that is to be seen.
    if stroke.dash == Dash::Solid {
        out.push(path(&[&shaft], false, None, Some(Stroke::solid(Colour::White, stroke.width + 2.0 * RIM))));
    }
    out.push(path(&[&tip], true, None, Some(Stroke::solid(Colour::White, 2.0 * RIM))));
    out.push(path(&[&shaft], false, None, Some(stroke)));
    out.push(path(&[&tip], true, Some(stroke.colour), None));
}

/// A path through pixels.
pub(super) fn path(pieces: &[&[Pixel]], closed: bool, fill: Option<Colour>, stroke: Option<Stroke>) -> Primitive {
    let mut d = String::new();
    for piece in pieces {
        for (at, &(x, y)) in piece.iter().enumerate() {
            d.push(if at == 0 { 'M' } else { 'L' });
            number::append(&mut d, x);
            d.push(' ');
            number::append(&mut d, y);
        }
        if closed && !piece.is_empty() {
            d.push('Z');
        }
    }
    Primitive::Path(Box::new(PathData {
        d,
        fill: fill.map(colour),
        stroke: stroke.map_or(Color::None, |stroke| colour(stroke.colour)),
        stroke_width: stroke.map_or(0.0, |stroke| stroke.width),
        opacity: None,
        stroke_dasharray: stroke.and_then(|stroke| stroke.dash.pattern()),
    }))
}

fn circle((cx, cy): Pixel, r: f64, fill: Option<Colour>, stroke: Option<Stroke>) -> Primitive {
    Primitive::Circle {
        cx,
        cy,
        r,
        fill: fill.map_or(Color::None, colour),
        fill_opacity: None,
        stroke: stroke.map(|stroke| colour(stroke.colour)),
        stroke_width: stroke.map(|stroke| stroke.width),
    }
}

/// Draws a text whose baseline is at `at`.
pub(super) fn text(
    (x, y): Pixel,
    content: &str,
    size: u32,
    anchor: Anchor,
    colour_of: Colour,
    rim: bool,
    out: &mut Vec<Primitive>,
) {
    if rim {
        let attributes = r##"stroke="#FFFFFF" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##;
        out.push(Primitive::GroupStart { transform: None, title: None, extra_attrs: Some(attributes.into()) });
    }
    out.push(Primitive::Text {
        x,
        y,
        content: font::printable(content),
        size,
        anchor: match anchor {
            Anchor::Start => TextAnchor::Start,
            Anchor::Middle => TextAnchor::Middle,
            Anchor::End => TextAnchor::End,
        },
        rotate: None,
        bold: false,
        color: Some(colour(colour_of)),
    });
    if rim {
        out.push(Primitive::GroupEnd);
    }
}

fn colour(colour: Colour) -> Color {
    Color::from(colour.hex())
}
