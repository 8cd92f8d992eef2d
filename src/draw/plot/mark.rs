//! Marks at points, and arrows.

use super::Pixel;
use super::canvas::{Dash, PlotLayer, Stroke};
use super::color::Color;
use std::f64::consts::{FRAC_PI_2, PI};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Mark {
    Circle,
    Ring,
    Square,
    Triangle,
    /// Triangles that point to the right and to the left.
    Right,
    Left,
    /// A square that stands on a corner.
    Diamond,
    Star,
    Cross,
    /// The symbol of a CoG: a disc with two filled quarters.
    Center,
}

/// The usual size of a mark: half its width \[px\].
pub const MARK: f64 = 4.0;

/// Length and half width of an arrow's head \[px\], and the largest share of a short arrow that the head takes.
const HEAD: f64 = 10.0;
const HALF_HEAD: f64 = 3.6;
const SHORT_HEAD: f64 = 0.6;
/// The width of the white rim on each side of an arrow \[px\].
const RIM: f64 = 0.8;

impl Mark {
    /// Draws the mark around a point; `size` is half its width \[px\].
    pub(super) fn draw(self, (x, y): Pixel, color: Color, size: f64, out: &mut PlotLayer) {
        let corners = |directions: &[(f64, f64)]| -> Vec<Pixel> {
            directions.iter().map(|&(right, up)| (x + size * right, y - size * up)).collect()
        };
        let outline = match self {
            Self::Circle => return out.circle((x, y), size, Some(color), None),
            Self::Ring => return out.circle((x, y), size, Some(Color::White), Some(Stroke::solid(color, 1.5))),
            Self::Center => {
                out.circle((x, y), size, Some(Color::White), Some(Stroke::solid(color, 1.0)));
                let quarter = |start: f64| -> Vec<Pixel> {
                    let rim = (0..=8).map(|step| start + f64::from(step) * FRAC_PI_2 / 8.0);
                    let rim = rim.map(|angle| (x + size * libm::cos(angle), y + size * libm::sin(angle)));
                    std::iter::once((x, y)).chain(rim).collect()
                };
                return out.area(vec![quarter(0.0), quarter(PI)], Some(color), None);
            }
            Self::Square => corners(&[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
            Self::Triangle => corners(&[(-1.0, -0.8), (1.0, -0.8), (0.0, 1.0)]),
            Self::Right => corners(&[(-0.8, -1.0), (-0.8, 1.0), (1.0, 0.0)]),
            Self::Left => corners(&[(0.8, -1.0), (0.8, 1.0), (-1.0, 0.0)]),
            Self::Diamond => corners(&[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)]),
            Self::Star => {
                let spike = |at: i32| {
                    let (angle, reach) = (f64::from(at) * PI / 5.0, [1.3, 0.55][at as usize % 2]);
                    (reach * libm::sin(angle), reach * libm::cos(angle))
                };
                corners(&(0..10).map(spike).collect::<Vec<_>>())
            }
            Self::Cross => {
                let bars = [corners(&[(-0.9, -0.9), (0.9, 0.9)]), corners(&[(-0.9, 0.9), (0.9, -0.9)])];
                return out.lines(bars.to_vec(), Stroke::solid(color, 1.6));
            }
        };
        out.area(vec![outline], Some(color), None);
    }
}

pub(super) fn arrow(from: Pixel, to: Pixel, stroke: Stroke, out: &mut PlotLayer) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = libm::hypot(dx, dy);
    // An arrow shorter than a pixel has no visible direction.
    if length < 1.0 {
        return;
    }
    let (along, across) = ((dx / length, dy / length), (-dy / length, dx / length));
    let head = HEAD.min(SHORT_HEAD * length);
    let half = HALF_HEAD * head / HEAD;
    let base = (to.0 - head * along.0, to.1 - head * along.1);
    // The shaft ends inside the head.
    let end = (base.0 + 0.1 * head * along.0, base.1 + 0.1 * head * along.1);
    let side = |sign: f64| (base.0 + sign * half * across.0, base.1 + sign * half * across.1);
    let (shaft, tip) = (vec![from, end], vec![vec![to, side(1.0), side(-1.0)]]);
    // A white rim separates the shaft from the background. Dashed shafts have none: it would show between the dashes.
    if stroke.dash == Dash::SOLID {
        out.line(shaft.clone(), Stroke::solid(Color::White, stroke.width + 2.0 * RIM));
    }
    out.area(tip.clone(), None, Some(Stroke::solid(Color::White, 2.0 * RIM)));
    out.line(shaft, stroke);
    out.area(tip, Some(stroke.color), None);
}
