//! A ground profile, prepared for queries: its faces and corners, and which of them are near.
//!
//! ```text
//!     points --drop straight points--> faces [wall, segment, ..., segment, wall], corner k between faces k and k + 1
//! ```
//!
//! The solid below the profile is bounded by upright walls below its two ends. The walls limit the directions in which
//! the end points may push, but they are not ground. A corner is convex if the ground falls away on both sides of it,
//! and concave in a notch. parry's polyline finds the segments near a foot and the nearest point, but not which side is
//! solid.

use super::face::{Face, unit, upright};
use super::point::{Circle, Touch};
use crate::planar::{Rotation, Vector};
use crate::state::Profile;
use parry2d::bounding_volume::Aabb;
use parry2d::math::Vector as ParryVector;
use parry2d::query::PointQueryWithLocation;
use parry2d::shape::{Polyline, SegmentPointLocation};

#[derive(Debug, Clone)]
pub(crate) struct Terrain {
    /// The segments between two walls.
    faces: Vec<Face>,
    polyline: Polyline,
}

impl Terrain {
    pub fn new(profile: &Profile) -> Self {
        let points = without_straight_ones(profile.points());
        let mut faces: Vec<Face> = points.windows(2).map(|pair| Face::of_ground(pair[0], pair[1])).collect();
        if let (Some(&first), Some(&last)) = (faces.first(), faces.last()) {
            let below =
                |Vector { x, z }: Vector<f64>, beside: Face| Vector::new(x, z - (beside.to - beside.from).length());
            let [rear, front] = [-1.0, 1.0].map(|side| (Vector::new(0.0, -side), Vector::new(side, 0.0)));
            let rear = Face { from: below(first.from, first), to: first.from, tangent: rear.0, normal: rear.1 };
            let front = Face { from: last.to, to: below(last.to, last), tangent: front.0, normal: front.1 };
            faces.insert(0, rear);
            faces.push(front);
        }
        let vertices = points.iter().map(|&Vector { x, z }| ParryVector::new(x, z)).collect();
        Self { faces, polyline: Polyline::new(vertices, None) }
    }

    pub(super) fn segments(&self) -> &[Face] {
        &self.faces[1..self.faces.len() - 1]
    }

    /// Returns the face of this index; 0 is the wall at the rear end.
    pub(super) fn face(&self, index: usize) -> &Face {
        &self.faces[index]
    }

    /// Returns the faces that meet at a corner; corner 0 is the rear end.
    pub(super) fn at_corner(&self, corner: usize) -> [&Face; 2] {
        [&self.faces[corner], &self.faces[corner + 1]]
    }

    /// Returns whether the ground falls away on both sides of a corner.
    pub(super) fn is_convex(&self, corner: usize) -> bool {
        let [before, after] = self.at_corner(corner);
        before.tangent.x * after.tangent.z < before.tangent.z * after.tangent.x
    }

    pub(super) fn is_wall(&self, index: usize) -> bool {
        index == 0 || index + 1 == self.faces.len()
    }

    /// Returns the indices of the segments that may reach into the box from `low` to `high`, ascending.
    pub(super) fn near(&self, low: Vector<f64>, high: Vector<f64>) -> Vec<usize> {
        let region = Aabb::new(ParryVector::new(low.x, low.z), ParryVector::new(high.x, high.z));
        let mut near: Vec<usize> =
            self.polyline.bvh().intersect_aabb(&region).map(|segment| segment as usize + 1).collect();
        near.sort_unstable();
        near
    }

    /// Returns the depth of a point in the solid \[m\] and the normal of the nearest segment; `None` outside.
    pub(super) fn depth_of(&self, point: Vector<f64>) -> Option<(f64, Vector<f64>)> {
        let (face, corner) = self.is_inside(point).then(|| self.nearest(point))?;
        let depth = match corner {
            None => -self.faces[face].height(point),
            Some(corner) => (point - self.faces[corner].to).length(),
        };
        Some((depth, self.faces[face].normal))
    }

    /// Returns the segment nearest to a point, and its corner if the nearest point is a corner.
    fn nearest(&self, point: Vector<f64>) -> (usize, Option<usize>) {
        let at = ParryVector::new(point.x, point.z);
        let (_, (segment, location)) = self.polyline.project_local_point_and_get_location(at, false);
        let face = segment as usize + 1;
        match location {
            SegmentPointLocation::OnVertex(end) => (face, Some(face - 1 + end as usize)),
            SegmentPointLocation::OnEdge(_) => (face, None),
        }
    }

    /// Returns the segment at `x`; `None` beyond the ends. Where two segments meet, it is the less steep one, or the
    /// rear one if both are equally steep.
    pub(super) fn segment_at(&self, x: f64) -> Option<&Face> {
        let segments = self.segments();
        let next = segments.partition_point(|face| face.to.x < x);
        let face = segments.get(next).filter(|face| face.from.x <= x)?;
        let after = segments.get(next + 1).filter(|after| after.from.x <= x && after.normal.z > face.normal.z);
        Some(after.unwrap_or(face))
    }

    fn is_inside(&self, point: Vector<f64>) -> bool {
        self.segment_at(point.x).is_some_and(|face| face.height(point) < 0.0)
    }

    pub(super) fn ends(&self) -> [Vector<f64>; 2] {
        let segments = self.segments();
        [segments[0].from, segments[segments.len() - 1].to]
    }

    /// Returns the contact of a named circle or point with the ground nearest to its `center` in the world. At a convex
    /// corner, a point within `tolerance` \[m\] gets the middle of the corner's normals. Beyond an end, the last
    /// segment is extended.
    pub(super) fn nearest_touch(&self, circle: Circle, center: Vector<f64>, tolerance: f64) -> Touch {
        let (face, corner) = self.nearest(center);
        let inner = corner.filter(|&corner| corner > 0 && corner + 2 < self.faces.len() && self.is_convex(corner));
        let (ground, height) = match inner {
            Some(corner) if !self.is_inside(center) => {
                let [before, after] = self.at_corner(corner);
                let way = center - before.to;
                let far = way.length();
                let meets = far == 0.0 || circle.radius == 0.0 && far <= tolerance;
                let normal = unit(if meets { before.normal + after.normal } else { way });
                (upright(normal), normal.dot(way))
            }
            _ => (self.faces[face].axes(), self.faces[face].height(center)),
        };
        Touch { circle, ground, gap: height - circle.radius }
    }

    /// Returns the number of the part at `point` where contacts have these `axes`: even for a segment, which gives its
    /// own axes to all its contacts, and odd for a corner.
    pub(super) fn part(&self, axes: Rotation<f64>, point: Vector<f64>) -> usize {
        let segments = (1..self.faces.len() - 1).filter(|&at| self.faces[at].axes() == axes);
        // The treads of stairs have the same axes.
        let off = |face: &Face| face.past_end(point).max(-face.past_begin(point)).max(0.0) + face.height(point).abs();
        let corners = 0..self.faces.len() - 1;
        nearest_part(segments.map(|at| (2 * at, off(&self.faces[at]))))
            .or_else(|| nearest_part(corners.map(|at| (2 * at + 1, (point - self.faces[at].to).length()))))
            .unwrap_or_default()
    }

    /// Returns the ground's axes and point at x = 0, which define the plane of a stance; `None` if there is no ground.
    pub(super) fn at_origin(&self) -> Option<(Rotation<f64>, Vector<f64>)> {
        let face = self.segment_at(0.0)?;
        // The height at x = 0, interpolated from the nearer end.
        let [near, far] = if -face.from.x <= face.to.x { [face.from, face.to] } else { [face.to, face.from] };
        let z = near.z - near.x * ((far.z - near.z) / (far.x - near.x));
        Some((face.axes(), Vector::new(0.0, z)))
    }
}

/// Returns the part of the least distance, from parts with their distances.
fn nearest_part(parts: impl Iterator<Item = (usize, f64)>) -> Option<usize> {
    parts.min_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(part, _)| part)
}

/// Returns the points without those that lie, up to rounding, on the straight line between their neighbors.
fn without_straight_ones(points: &[Vector<f64>]) -> Vec<Vector<f64>> {
    let mut kept: Vec<Vector<f64>> = Vec::with_capacity(points.len());
    for (at, &point) in points.iter().enumerate() {
        let straight = match (kept.last(), points.get(at + 1)) {
            (Some(&before), Some(&after)) => {
                let scale = [before, point, after]
                    .into_iter()
                    .flat_map(Vector::components)
                    .fold(0.0, |size: f64, entry| size.max(entry.abs()));
                Face::of_ground(before, after).height(point).abs() <= 8.0 * f64::EPSILON * scale
            }
            _ => false,
        };
        if !straight {
            kept.push(point);
        }
    }
    kept
}
