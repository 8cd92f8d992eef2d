//! A foot's outline in the world: a convex polygon of corners, each with a rim about it.
//!
//! ```text
//!     nearest part of the outline to a point outside of the polygon:
//!         a side, moved out by the rim's reach, if the point is above it     else the corner with the nearest rim
//! ```

use super::face::{Face, unit, upright};
use super::feet::Foot;
use super::placement::Placement;
use super::point::{Point, Touch, points};
use crate::planar::Vector;
use crate::robot::Rim;

#[derive(Debug, Clone)]
pub(super) struct Outline<'p> {
    placement: &'p Placement,
    body: usize,
    rim: Rim,
    /// The corners with their rims, in the body's frame.
    points: Vec<Point>,
    /// The same corners in the world \[m\], counter-clockwise where forward points right and up points up.
    pub corners: Vec<Vector<f64>>,
    /// The polygon's side from each corner to the next; none for a single corner, two for a line.
    pub bones: Vec<Face>,
    /// The same sides, moved out by the rim.
    pub sides: Vec<Face>,
}

impl<'p> Outline<'p> {
    pub fn new(foot: &Foot, placement: &'p Placement) -> Self {
        let points: Vec<Point> = points(foot).collect();
        let corners: Vec<Vector<f64>> = points.iter().map(|point| placement.world(point.body, point.center)).collect();
        let bones: Vec<Face> = match corners[..] {
            [_] => Vec::new(),
            _ => (0..corners.len()).map(|at| Face::of_foot(corners[at], corners[(at + 1) % corners.len()])).collect(),
        };
        let rim = foot.outline.rim;
        let mut outline = Self { placement, body: foot.body, rim, points, corners, bones, sides: Vec::new() };
        let moved = |bone: &Face| {
            let out = outline.support(bone.normal);
            Face { from: bone.from + out, to: bone.to + out, ..*bone }
        };
        outline.sides = outline.bones.iter().map(moved).collect();
        outline
    }

    /// Returns the rim's point that is farthest along a unit vector of the world, relative to the corner \[m\].
    pub fn support(&self, direction: Vector<f64>) -> Vector<f64> {
        match self.rim {
            Rim::Circle { radius } => direction * radius,
            Rim::Ellipse { .. } => {
                let local = self.rim.support(self.placement.turned_back(self.body, direction));
                self.placement.turned(self.body, local)
            }
        }
    }

    /// Returns how far the rim extends from the corner along a unit vector of the world \[m\].
    pub fn reach(&self, direction: Vector<f64>) -> f64 {
        self.rim.reach(self.placement.turned_back(self.body, direction))
    }

    /// Returns whether the corners have no rim.
    pub fn is_sharp(&self) -> bool {
        self.rim == Rim::Circle { radius: 0.0 }
    }

    /// Returns the lowest point of a corner's rim along a unit normal of the ground, in the world \[m\].
    pub fn lowest(&self, corner: usize, normal: Vector<f64>) -> Vector<f64> {
        self.corners[corner] + self.support(-normal)
    }

    /// Returns a corner's contact with ground of this normal.
    pub fn touch(&self, corner: usize, normal: Vector<f64>, gap: f64) -> Touch {
        Touch { circle: self.placement.circle(self.points[corner], normal), ground: upright(normal), gap }
    }

    /// Returns the sides that end and begin at a corner; `None` for a single corner.
    pub fn at_corner(&self, corner: usize) -> Option<[&Face; 2]> {
        let count = self.sides.len();
        (count > 0).then(|| [&self.sides[(corner + count - 1) % count], &self.sides[corner]])
    }

    pub fn beside_corner(&self, corner: usize) -> Option<[Vector<f64>; 2]> {
        let count = self.bones.len();
        (count > 0).then(|| [self.bones[(corner + count - 1) % count].from, self.bones[corner].to])
    }

    pub fn beside(&self, side: usize) -> [&Face; 2] {
        let count = self.sides.len();
        [&self.sides[(side + count - 1) % count], &self.sides[(side + 1) % count]]
    }

    /// Returns a side's contact with a corner of the ground at the point `at`.
    pub fn on_side(&self, side: usize, at: Vector<f64>) -> Touch {
        let face = &self.sides[side];
        let (from, to) = (self.points[side], self.points[(side + 1) % self.points.len()]);
        let (behind, ahead) = (face.past_begin(at), -face.past_end(at));
        let along = (to.center - from.center) * (behind / (behind + ahead));
        let point = Point { center: from.center + along, offset: None, ..from };
        let normal = -face.normal;
        Touch { circle: self.placement.circle(point, normal), ground: upright(normal), gap: face.height(at) }
    }

    /// Returns the low and the high end of the box about the outline, grown by `margin` \[m\].
    pub fn region(&self, margin: f64) -> [Vector<f64>; 2] {
        let (margin, far) = (self.rim.bound() + margin, Vector::new(f64::INFINITY, f64::INFINITY));
        let corners = || self.corners.iter().copied();
        let (low, high) = (corners().fold(far, Vector::least), corners().fold(-far, Vector::greatest));
        [low.map(|entry| entry - margin), high.map(|entry| entry + margin)]
    }

    /// Returns the outward normal of a corner's rim toward a point, and the point's distance beyond the rim \[m\],
    /// negative inside; `None` if the point is the corner itself or the distance is not finite.
    ///
    /// For an ellipse `cos(s) a + sin(s) b` the normal is that where the line from the corner to the point crosses the
    /// rim, and the distance is that from the tangent there. At distance zero this is the nearest point of the rim.
    pub fn beyond_rim(&self, corner: usize, point: Vector<f64>) -> Option<(Vector<f64>, f64)> {
        let way = point - self.corners[corner];
        let far = way.length();
        if far == 0.0 {
            return None;
        }
        match self.rim {
            Rim::Circle { radius } => Some((unit(way), far - radius)),
            Rim::Ellipse { half_diameters: [a, b] } => {
                let Vector { x, z } = self.placement.turned_back(self.body, way);
                // way = k (cos(s) a + sin(s) b), where k is `size`. The gradient of k has the direction of the normal.
                let area = a.x * b.z - a.z * b.x;
                let [along_a, along_b] = [(x * b.z - z * b.x) / area, (a.x * z - a.z * x) / area];
                let gradient = Vector::new(along_a * b.z - along_b * a.z, along_b * a.x - along_a * b.x);
                let normal = unit(gradient * area.signum());
                let size = libm::hypot(along_a, along_b);
                let beyond = normal.dot(Vector::new(x, z)) * (1.0 - 1.0 / size);
                beyond.is_finite().then(|| (self.placement.turned(self.body, normal), beyond))
            }
        }
    }

    /// Returns the contact of a ground corner with the outline: with the side that is nearest if the corner is inside
    /// of the polygon, else with the nearest side or rim.
    pub fn touch_of(&self, corner: Vector<f64>) -> Option<Touch> {
        let on = |side: usize| self.on_side(side, corner);
        if self.bones.len() > 2 && self.bones.iter().all(|bone| bone.height(corner) < 0.0) {
            return (0..self.sides.len()).map(on).max_by(Touch::by_gap);
        }
        let is_above = |side: &usize| self.bones[*side].height(corner) >= 0.0 && self.sides[*side].faces(corner);
        let rims = (0..self.corners.len()).map(|at| match self.beyond_rim(at, corner) {
            Some((out, beyond)) => self.touch(at, -out, beyond),
            None => self.touch(at, Vector::new(0.0, 1.0), 0.0 - self.rim.bound()),
        });
        (0..self.sides.len()).filter(is_above).map(on).chain(rims).min_by(Touch::by_gap)
    }
}
