//! A foot's outline against the ground line: which of its points can touch, and which do.
//!
//! ```text
//!     bounding circle --reaches the ground?--> polygon without its rim --parry--> corners within reach of the ground
//! ```
//!
//! parry's contact manifolds (ground as half space first, the order in which they are right) say which corners of a polygon
//! are near; the rim reaches equally far from each. The point that touches, its gap and its velocity are those of the
//! exact material point, not parry's.

use super::detect::{Placement, Point};
use super::feet::Foot;
use crate::error::{Error, Reason, Result};
use parry2d::math::Vector as ParryVector;
use parry2d::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry2d::shape::HalfSpace;

/// The points of a foot that can touch.
pub(crate) fn points(foot: &Foot) -> impl Iterator<Item = Point> {
    let corners = foot.outline.corners().iter();
    corners.map(|&centre| Point { body: foot.body, centre, offset: foot.offset, rim: foot.outline.rim() })
}

/// Whether a foot is so high that none of its points can be within `tolerance` \[m\] of the ground.
pub(super) fn is_out_of_reach(foot: &Foot, placement: &Placement, tolerance: f64) -> bool {
    placement.height_of_circle(foot.body, foot.bounding_circle) > tolerance
}

/// The points of a foot within `tolerance` \[m\] of the ground or below it: at most two, the ends of the side that faces it.
///
/// # Errors
/// [`Reason::Unsupported`] for a pair of shapes that parry does not serve; none of ours is.
pub(super) fn touching(foot: &Foot, placement: &Placement, tolerance: f64) -> Result<Vec<Point>> {
    if is_out_of_reach(foot, placement, tolerance) {
        return Ok(Vec::new());
    }
    let Some(polygon) = foot.outline.polygon() else {
        return Ok(points(foot).filter(|&point| placement.height(point) <= tolerance).collect());
    };
    let [x, z] = placement.normal();
    let ground = HalfSpace::new(ParryVector::new(x, z));
    let mut manifolds: Vec<ContactManifold<(), ()>> = Vec::new();
    let prediction = tolerance + placement.reach(foot.body, &foot.outline.rim());
    DefaultQueryDispatcher
        .contact_manifolds(&placement.pose(foot.body), &ground, &*polygon.0, prediction, &mut manifolds, &mut None)
        .map_err(|unsupported| Error::new(Reason::Unsupported(format!("a foot against the ground: {unsupported}"))))?;
    let mut touching: Vec<Point> = Vec::new();
    let near = manifolds.iter().flat_map(|manifold| &manifold.points).filter(|near| near.dist <= prediction);
    for at in near.map(|near| near.local_p2) {
        let far = |point: &Point| libm::hypot(point.centre[0] - at.x, point.centre[1] - at.y);
        let nearest = points(foot).min_by(|a, b| far(a).total_cmp(&far(b)));
        touching.extend(nearest.filter(|point| !touching.contains(point)));
    }
    Ok(touching)
}
