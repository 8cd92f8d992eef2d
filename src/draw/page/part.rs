//! Collision shapes in the frames of their bodies: a rigid body has the same ones in all stills.

use super::number::place;
use crate::draw::robot::{Body, Outline};
use crate::planar::Vector;
use serde::Serialize;

/// What is rigid of a body, in its frame.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Part {
    outlines: Vec<Outline>,
    com: Option<Vector<f64>>,
    mass: f64,
    last: bool,
}

/// Different parts, by number.
#[derive(Debug, Default)]
pub(super) struct Parts {
    pub all: Vec<Part>,
    /// The part of each body in the last still.
    latest: Vec<usize>,
}

/// What rounding makes of a rigid shape from one still to the next, in units of the places.
const ROUNDING: f64 = 3.0;

impl Parts {
    /// The number of the part of `body`, the one at this place among the bodies; its frame has the x axis `turn`.
    pub fn number(&mut self, at: usize, body: &Body, turn: Vector<f64>, unit: f64) -> usize {
        let part = Part::of(body, turn, unit);
        let alike = |number: &usize| self.all.get(*number).is_some_and(|known| known.is_same_as(&part, unit));
        let number = self.latest.get(at).copied().filter(alike).unwrap_or_else(|| {
            self.all.push(part);
            self.all.len() - 1
        });
        if self.latest.len() <= at {
            self.latest.resize(at + 1, usize::MAX);
        }
        self.latest[at] = number;
        number
    }
}

impl Part {
    fn of(body: &Body, turn: Vector<f64>, unit: f64) -> Self {
        let across = -turn.perpendicular();
        let local = |point: Vector<f64>| {
            let arm = point - body.origin;
            place(Vector::new(arm.dot(turn), arm.dot(across)), unit)
        };
        let outline = |outline: &Outline| match outline {
            Outline::Disc { center, radius } => {
                Outline::Disc { center: local(*center), radius: super::number::to_unit(*radius, unit) }
            }
            Outline::Polygon(corners) => Outline::Polygon(corners.iter().copied().map(local).collect()),
        };
        Self {
            outlines: body.outlines.iter().map(outline).collect(),
            com: body.com.map(local),
            mass: super::number::significant(body.mass, 5),
            last: body.last,
        }
    }

    /// Whether it is the same but for what rounding made of it.
    fn is_same_as(&self, other: &Self, unit: f64) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= ROUNDING * unit;
        let near_points = |a: &Vector<f64>, b: &Vector<f64>| near(a.x, b.x) && near(a.z, b.z);
        let near_outlines = |(a, b): (&Outline, &Outline)| match (a, b) {
            (Outline::Disc { center: a, radius: s }, Outline::Disc { center: b, radius: r }) => {
                near_points(a, b) && near(*s, *r)
            }
            (Outline::Polygon(a), Outline::Polygon(b)) => {
                a.len() == b.len() && a.iter().zip(b).all(|(a, b)| near_points(a, b))
            }
            _ => false,
        };
        let near_com = match (&self.com, &other.com) {
            (Some(a), Some(b)) => near_points(a, b),
            (None, None) => true,
            _ => false,
        };
        near_com
            && self.mass == other.mass
            && self.last == other.last
            && self.outlines.len() == other.outlines.len()
            && self.outlines.iter().zip(&other.outlines).all(near_outlines)
    }
}
