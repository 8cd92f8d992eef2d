//! The ground in the form that feet are tested against.

use super::Contact;
use super::face::PARALLEL;
use super::feet::Foot;
use super::outline::Outline;
use super::placement::Placement;
use super::plane::HalfPlane;
use super::point::{Point, Touch};
use super::profile::{self, Closeness};
use super::terrain::Terrain;
use crate::error::{Error, Reason, shortest_within};
use crate::planar::Vector;
use crate::state::Ground;

/// The ground, prepared once for all feet of a state.
pub(crate) enum Surface {
    HalfPlane(HalfPlane),
    Profile(Terrain),
}

/// The error for a foot that is too deep in the ground: its depth \[m\] and a remedy.
pub(super) struct Sunk {
    pub depth: f64,
    pub remedy: String,
}

impl Surface {
    pub fn new(ground: &Ground) -> Self {
        match ground {
            Ground::Slope(slope) => Self::HalfPlane(HalfPlane::sloped(*slope)),
            Ground::Profile(profile) => Self::Profile(Terrain::new(profile)),
        }
    }

    /// Returns the plane on which a stance places its foot, and the ground's point at x = 0 \[m\]. Returns an error if
    /// there is no ground at x = 0.
    pub(super) fn stance(&self) -> crate::Result<(HalfPlane, Vector<f64>)> {
        match self {
            Self::HalfPlane(plane) => Ok((*plane, Vector::zero())),
            Self::Profile(terrain) => {
                let (axes, point) = terrain.at_origin().ok_or_else(|| {
                    let [Vector { x: rear, .. }, Vector { x: front, .. }] = terrain.ends();
                    let reason =
                        format!("a stance is at x = 0, and the ground's profile goes from {rear:?} to {front:?}");
                    Error::new(Reason::Inconsistent(reason))
                        .at("stance")
                        .hint("shift the profile along x, or give the base's x and z instead of a stance")
                })?;
                Ok((HalfPlane::turned(axes), point))
            }
        }
    }

    /// Returns the contact of a named circle or point at any height.
    pub(super) fn touch(&self, placement: &Placement, named: Point, tolerance: f64) -> Touch {
        match self {
            Self::HalfPlane(plane) => plane.touch(placement, named),
            Self::Profile(terrain) => {
                // A named contact is a circle, so its center is the same for every normal.
                let circle = placement.circle(named, Vector::new(0.0, 1.0));
                terrain.nearest_touch(circle, placement.world(circle.body, circle.center), tolerance)
            }
        }
    }

    /// Bounds the rounding of heights \[m\].
    pub(super) fn rounding(&self, placement: &Placement, size: f64) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.rounding(placement, size),
            Self::Profile(_) => profile::rounding(placement, size),
        }
    }

    /// Passes to `found` each contact of a foot that is `close` to the ground.
    pub(super) fn touching(
        &self,
        foot: &Foot,
        placement: &Placement,
        close: Closeness,
        found: impl FnMut(Touch),
    ) -> Result<(), Sunk> {
        // `along` is the vertical distance for one meter along the normal.
        let (touching, how, along) = match self {
            Self::HalfPlane(plane) => {
                (plane.touching(foot, placement, close.tolerance, found), "raise the base", 1.0 / plane.normal.z)
            }
            Self::Profile(terrain) => {
                let touches = profile::touching(terrain, foot, placement, close);
                (touches.map(|touches| touches.into_iter().for_each(found)), "move the base or the profile", 1.0)
            }
        };
        touching.map_err(|depth| {
            // The remedy is rounded by less than the tolerance.
            let enough = shortest_within(depth * along, 0.5 * close.tolerance * along);
            let remedy =
                format!("{how} by {enough:?} m, correct the pose, or accept it by a greater `contact_tolerance`");
            Sunk { depth, remedy }
        })
    }

    /// Returns whether a foot is so far away that no point of it can be within `tolerance` \[m\] of the ground.
    pub(super) fn is_out_of_reach(&self, foot: &Foot, placement: &Placement, tolerance: f64) -> bool {
        match self {
            Self::HalfPlane(plane) => plane.least_gap(foot, placement) > tolerance,
            Self::Profile(terrain) => {
                profile::within_reach(terrain, foot, &Outline::new(foot, placement), tolerance).is_empty()
            }
        }
    }

    /// Returns the coordinate by which the contacts of a link are sorted \[m\]: along the tangent of a plane, or x on a
    /// profile.
    pub(super) fn along(&self, point: Vector<f64>) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.along(point),
            Self::Profile(_) => point.x,
        }
    }

    /// Returns whether two contacts of a link are the same: on a plane the same point; on a profile the same position
    /// up to `rounding` \[m\] and the same normal, because the point of a side at a ground corner is computed.
    pub(super) fn is_same(&self, a: &Contact, b: &Contact, rounding: f64) -> bool {
        let same_place = match self {
            Self::HalfPlane(_) => a.center == b.center,
            Self::Profile(_) => {
                (a.center - b.center).length() <= rounding && (a.normal() - b.normal()).length() <= PARALLEL
            }
        };
        same_place && (a.link, a.body, a.radius) == (b.link, b.body, b.radius)
    }

    /// Returns whether a contact's normal differs from those of all segments of the ground.
    pub fn is_corner(&self, contact: &Contact) -> bool {
        match self {
            Self::HalfPlane(_) => false,
            Self::Profile(terrain) => terrain.segments().iter().all(|face| face.axes() != contact.ground),
        }
    }

    /// Returns the number of the part of the ground that a contact touches: 0 for a plane; for a profile, that of the
    /// segment or corner, counted together along x.
    pub fn part(&self, contact: &Contact) -> usize {
        match self {
            Self::HalfPlane(_) => 0,
            Self::Profile(terrain) => terrain.part(contact.ground, contact.point),
        }
    }

    /// Returns the distance of a foot from the ground \[m\], negative in it.
    pub fn clearance(&self, foot: &Foot, placement: &Placement) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.clearance(foot, placement),
            Self::Profile(terrain) => profile::clearance(terrain, &Outline::new(foot, placement)),
        }
    }
}
