//! The ground as feet meet it.

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

/// A ground, compiled once for all feet of a state.
pub(crate) enum Surface {
    HalfPlane(HalfPlane),
    Profile(Terrain),
}

/// A foot that is too deep: by how much \[m\], and what to do.
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

    /// The plane on which the foot of a stance is placed, and the point of the ground that it is placed at \[m\].
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

    /// The contact of a circle or point that was named, whatever its height.
    pub(super) fn touch(&self, placement: &Placement, named: Point, tolerance: f64) -> Touch {
        match self {
            Self::HalfPlane(plane) => plane.touch(placement, named),
            Self::Profile(terrain) => {
                // A circle's place is the same whatever the normal.
                let circle = placement.circle(named, Vector::new(0.0, 1.0));
                terrain.nearest_touch(circle, placement.world(circle.body, circle.center), tolerance)
            }
        }
    }

    /// How far heights are off by rounding alone \[m\].
    pub(super) fn rounding(&self, placement: &Placement, size: f64) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.rounding(placement, size),
            Self::Profile(_) => profile::rounding(placement, size),
        }
    }

    /// Finds where a foot is `close` to the ground.
    pub(super) fn touching(
        &self,
        foot: &Foot,
        placement: &Placement,
        close: Closeness,
        found: impl FnMut(Touch),
    ) -> Result<(), Sunk> {
        // How far to move along the vertical for one meter along the normal.
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
            // What is left of the depth, or missing from it, is within the tolerance.
            let enough = shortest_within(depth * along, 0.5 * close.tolerance * along);
            let remedy =
                format!("{how} by {enough:?} m, correct the pose, or accept it by a greater `contact_tolerance`");
            Sunk { depth, remedy }
        })
    }

    /// Whether a foot is so far away that no point of it can be within `tolerance` \[m\] of the ground.
    pub(super) fn is_out_of_reach(&self, foot: &Foot, placement: &Placement, tolerance: f64) -> bool {
        match self {
            Self::HalfPlane(plane) => plane.least_gap(foot, placement) > tolerance,
            Self::Profile(terrain) => {
                profile::within_reach(terrain, foot, &Outline::new(foot, placement), tolerance).is_empty()
            }
        }
    }

    /// What contacts of a link are in the order of: the place along a plane, x along a profile \[m\].
    pub(super) fn along(&self, point: Vector<f64>) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.along(point),
            Self::Profile(_) => point.x,
        }
    }

    /// Whether two contacts of a link are one: the same point, and on a profile the same place with the same normal up
    /// to `rounding` \[m\], because a side's point at a corner is found and not given.
    pub(super) fn is_same(&self, a: &Contact, b: &Contact, rounding: f64) -> bool {
        let same_place = match self {
            Self::HalfPlane(_) => a.center == b.center,
            Self::Profile(_) => {
                (a.center - b.center).length() <= rounding && (a.normal() - b.normal()).length() <= PARALLEL
            }
        };
        same_place && (a.link, a.body, a.radius) == (b.link, b.body, b.radius)
    }

    /// Whether a contact's normal is that of no straight piece of the ground.
    pub fn is_corner(&self, contact: &Contact) -> bool {
        match self {
            Self::HalfPlane(_) => false,
            Self::Profile(terrain) => terrain.segments().iter().all(|face| face.axes() != contact.ground),
        }
    }

    /// How far a foot is from the ground \[m\].
    pub fn clearance(&self, foot: &Foot, placement: &Placement) -> f64 {
        match self {
            Self::HalfPlane(plane) => plane.clearance(foot, placement),
            Self::Profile(terrain) => profile::clearance(terrain, &Outline::new(foot, placement)),
        }
    }
}
