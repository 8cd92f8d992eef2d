//! A foot's outline in the world: a convex polygon of corners, each with a circle of the same radius about it.

use super::feet::Foot;
use super::face::Face;
use super::placement::Placement;
use super::point::{Point, points};
use crate::planar::{Vector, difference, scaled, sum};

/// The outline of a foot where it is.
#[derive(Debug, Clone)]
pub(super) struct Outline {
    /// The corners with their circles, in their body's frame.
    points: Vec<Point>,
    /// The same corners in the world, counter-clockwise seen with forward to the right and up upward \[m\].
    corners: Vec<Vector<f64>>,
    /// The side from each corner to the next; none of a single corner, two of a line.
    sides: Vec<Face>,
    /// Of the circles \[m\].
    pub radius: f64,
}

impl Outline {
    pub fn new(foot: &Foot, placement: &Placement) -> Self {
        let points = points(foot);
        let corners: Vec<Vector<f64>> =
            points.iter().map(|point| placement.world(point.body, point.centre)).collect();
        let sides = match corners[..] {
            [_] => Vec::new(),
            _ => (0..corners.len()).map(|at| Face::of_foot(corners[at], corners[(at + 1) % corners.len()])).collect(),
        };
        let radius = points.first().map_or(0.0, |point| point.radius);
        Self { points, corners, sides, radius }
    }

    pub fn corners(&self) -> &[Vector<f64>] {
        &self.corners
    }

    /// The corner with its circle.
    pub fn point(&self, corner: usize) -> Point {
        self.points[corner]
    }

    pub fn sides(&self) -> &[Face] {
        &self.sides
    }

    /// The sides that end and begin at a corner; none of a single corner.
    pub fn at_corner(&self, corner: usize) -> Option<[&Face; 2]> {
        let count = self.sides.len();
        (count > 0).then(|| [&self.sides[(corner + count - 1) % count], &self.sides[corner]])
    }

    /// The sides next to a side.
    pub fn beside(&self, side: usize) -> [&Face; 2] {
        let count = self.sides.len();
        [&self.sides[(side + count - 1) % count], &self.sides[(side + 1) % count]]
    }

    /// The circle about the point of a side that is nearest to `at`, in the body's frame.
    pub fn on_side(&self, side: usize, at: Vector<f64>) -> Point {
        let face = &self.sides[side];
        let (from, to) = (self.points[side], self.points[(side + 1) % self.points.len()]);
        let (behind, ahead) = (face.past_begin(at), -face.past_end(at));
        let along = scaled(behind / (behind + ahead), difference(to.centre, from.centre));
        Point { centre: sum(from.centre, along), offset: None, ..from }
    }

    /// The box about the corners, grown by `margin` \[m\]: its low and its high end.
    pub fn region(&self, margin: f64) -> [Vector<f64>; 2] {
        let end = |axis: usize, extreme: fn(f64, f64) -> f64, start: f64| {
            self.corners.iter().map(|corner| corner[axis]).fold(start, extreme)
        };
        [
            [0, 1].map(|axis| end(axis, f64::min, f64::INFINITY) - margin),
            [0, 1].map(|axis| end(axis, f64::max, f64::NEG_INFINITY) + margin),
        ]
    }

    /// How deep a point is in the foot \[m\], negative outside.
    pub fn depth_of(&self, point: Vector<f64>) -> f64 {
        let far = |corner: &Vector<f64>| super::face::distance(*corner, point);
        let outside = match self.sides[..] {
            [] => self.corners.iter().map(far).fold(f64::INFINITY, f64::min),
            _ => self.sides.iter().map(|side| side.distance(point)).fold(f64::INFINITY, f64::min),
        };
        let inside = self.sides.len() > 2 && self.sides.iter().all(|side| side.height(point) < 0.0);
        if inside { self.radius + outside } else { self.radius - outside }
    }
}
