//! Projects motions in three dimensions into the robot's plane: row by row ([`project`]), and along the mean heading of
//! each clip ([`sagittal`]).
//!
//! ```text
//!     R = rotation(w, x, y, z) P^T        columns of R: the robot's forward f, normal and up in the world, z up
//!     pitch = asin(-f_z)                  roll = atan2(normal_z, up_z)        heading: (f_x, f_y)
//!     h = sum of (f_x, f_y) over a clip, of length one        x = h . (x, y)
//!     left out: h x (x, y), yaw from h, roll
//! ```
//!
//! P holds the axes of the robot's plane ([`Plane`]). The heading is that of the clip, not of the row: a body that yaws
//! during its stride still walks straight ahead. Turning or shifting a whole clip about the world's z therefore changes
//! only where x begins. The heading is known at the end of a clip, so the whole clip is held in memory.

use super::clip::{Clock, ClockStep};
use super::{Sample, Sampled};
use crate::description::{Matrix, apply};
use crate::robot::Plane;
use crate::{Error, Reason, Result};
use std::fmt;
use std::mem::take;
use std::sync::Mutex;

/// The greatest error of a quaternion's length; rounding to two digits stays below it.
const UNIT: f64 = 0.01;

/// The part of a base's position and orientation that is outside the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spatial {
    /// x and y of the root link's origin \[m\].
    pub origin: [f64; 2],
    /// The horizontal part of the robot's forward axis.
    pub forward: [f64; 2],
    /// The rotation about the forward axis \[rad\].
    pub roll: f64,
}

/// Returns the pitch of a base \[rad\] and its part outside the plane. The base is at x and y `origin` \[m\], with the
/// quaternion `[w, x, y, z]`, which is normalized.
///
/// # Errors
/// Returns [`Reason::OutOfRange`] if the quaternion's length is not one, and [`Reason::Inconsistent`] if the robot is
/// upside down: its pitch is then not between -pi/2 and pi/2, and a quaternion cannot distinguish it from a roll.
pub fn project(origin: [f64; 2], quaternion: [f64; 4], plane: Plane) -> Result<(f64, Spatial)> {
    let length = quaternion.iter().fold(0.0, |length, &part| libm::hypot(length, part));
    if (length - 1.0).abs() > UNIT {
        let reason = Reason::OutOfRange { what: "the length of the quaternion".into(), allowed: "1", value: length };
        return Err(Error::new(reason).hint("its components are qw, qx, qy, qz of a rotation, qw its real part"));
    }
    let rotation = rotation(quaternion.map(|part| part / length));
    let [forward, normal, up] = plane.axes().map(|axis| apply(&rotation, axis));
    if up[2] < 0.0 {
        let reason = "the robot is upside down, and its pitch in the plane is not known".to_owned();
        let hint = "turn the recording so that z is up; where the robot rolls over, cut it, or give q_base_pitch";
        return Err(Error::new(Reason::Inconsistent(reason)).hint(hint));
    }
    let roll = libm::atan2(normal[2], up[2]);
    let pitch = libm::asin((-forward[2]).clamp(-1.0, 1.0));
    Ok((pitch, Spatial { origin, forward: [forward[0], forward[1]], roll }))
}

/// Returns the rotation of a quaternion of length one. The columns are the rotated axes.
fn rotation([w, x, y, z]: [f64; 4]) -> Matrix {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The mean direction of a clip, horizontal and of length one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Heading([f64; 2]);

impl Heading {
    /// Returns the mean of a clip; `None` if it has no direction, as in a whole turn on the spot.
    fn mean<'s>(clip: impl Iterator<Item = &'s Spatial>) -> Option<Self> {
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for Spatial { forward, .. } in clip {
            (x, y, count) = (x + forward[0], y + forward[1], count + 1.0);
        }
        let length = libm::hypot(x, y);
        // A shorter sum is rounding.
        (length > count * count * f64::EPSILON).then(|| Self([x / length, y / length]))
    }

    /// Returns the components of a horizontal vector along the heading and to its left.
    fn along_and_across(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([cos, sin]) = self;
        [cos * x + sin * y, cos * y - sin * x]
    }
}

/// The largest parts of a motion in three dimensions that are not in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dropped {
    /// The rotation about the forward axis \[rad\].
    pub roll: f64,
    /// The rotation about the vertical, from the clip's heading \[rad\].
    pub yaw: f64,
    /// The distance from the line along the heading through the middle of the clip \[m\].
    pub sideways: f64,
}

/// Projects the samples whose base is in three dimensions, in order and one clip late. Adds the parts that are left out
/// to `dropped`. Refuses the samples of a clip without a heading.
pub fn sagittal<S>(
    samples: impl Iterator<Item = Sampled<S>>,
    dropped: &Mutex<Dropped>,
) -> impl Iterator<Item = Sampled<S>> {
    let (mut clock, mut clip) = (Clock::default(), Vec::new());
    samples.map(Some).chain([None]).flat_map(move |next| {
        let ended = match &next {
            None => true,
            Some(Ok(sample)) => clock.step(sample.time) == ClockStep::NewClip,
            Some(Err(_)) => false,
        };
        let whole: Vec<Sampled<S>> = if ended { take(&mut clip) } else { Vec::new() };
        clip.extend(next);
        let bases = || whole.iter().flatten().filter_map(|sample| sample.spatial.as_ref());
        let heading = Heading::mean(bases());
        if let (Some(heading), Ok(mut all)) = (heading, dropped.lock()) {
            all.add(heading, bases);
        }
        whole.into_iter().map(move |sampled| along(heading, sampled?))
    })
}

/// Sets the sample's x to the distance along the heading.
fn along<S>(heading: Option<Heading>, mut sample: Sample<S>) -> Sampled<S> {
    match (sample.spatial.take(), heading) {
        (Some(Spatial { origin, .. }), Some(heading)) => {
            [sample.state.position[0], _] = heading.along_and_across(origin);
            Ok(sample)
        }
        (Some(_), None) => {
            let reason = "the robot turns all the way round in its clip, which has no mean heading".to_owned();
            let error = Error::new(Reason::Inconsistent(reason)).at("q_base_qw");
            Err((sample.source, error.hint("cut the clip: a jump back in time begins another")))
        }
        (None, _) => Ok(sample),
    }
}

impl Dropped {
    /// Adds the bases of a clip.
    fn add<'s, B: Iterator<Item = &'s Spatial>>(&mut self, heading: Heading, bases: impl Fn() -> B) {
        let across = |base: &Spatial| heading.along_and_across(base.origin)[1];
        let (sum, count) = bases().fold((0.0, 0.0), |(sum, count), base| (sum + across(base), count + 1.0));
        for base in bases() {
            self.roll = self.roll.max(base.roll.abs());
            let [along, left] = heading.along_and_across(base.forward);
            self.yaw = self.yaw.max(libm::atan2(left, along).abs());
            self.sideways = self.sideways.max((across(base) - sum / count).abs());
        }
    }
}

impl fmt::Display for Dropped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { roll, yaw, sideways } = self;
        write!(f, "roll up to {roll:.3} rad, yaw up to {yaw:.3} rad, {sideways:.3} m to the side")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// A base rotated by roll about x, then by pitch about y, then by yaw about z, all of them axes of the world.
    fn turned([yaw, pitch, roll]: [f64; 3], plane: Plane) -> (f64, Spatial) {
        project([3.0, 4.0], quaternion([yaw, pitch, roll]), plane).unwrap()
    }

    fn quaternion(angles: [f64; 3]) -> [f64; 4] {
        let [(sy, cy), (sp, cp), (sr, cr)] = angles.map(|angle| (0.5 * angle).sin_cos());
        let [w, x] = [cy * cp * cr + sy * sp * sr, cy * cp * sr - sy * sp * cr];
        [w, x, cy * sp * cr + sy * cp * sr, sy * cp * cr - cy * sp * sr]
    }

    fn close(found: f64, expected: f64) {
        // Allows a few roundings of numbers of order one; the arcsine loses digits near its ends.
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
    }

    #[test]
    fn yaw_pitch_and_roll_come_apart() {
        let about_y = [-1.5, -0.3, 0.0, 0.2, 1.4].map(|pitch| [0.0, pitch, 0.0]);
        for [yaw, pitch, roll] in about_y.into_iter().chain([[2.5, 0.4, -0.3]]) {
            let (found, spatial) = turned([yaw, pitch, roll], Plane::XZ);
            close(found, pitch);
            close(spatial.roll, roll);
            close(libm::atan2(spatial.forward[1], spatial.forward[0]), yaw);
            assert_eq!(spatial.origin, [3.0, 4.0]);
        }
    }

    #[test]
    fn robot_in_another_plane_keeps_the_floor() {
        // This robot faces its own y axis, so its nose dips about -x and it heads along the world's y.
        let (pitch, spatial) = turned([0.0, 0.0, -0.3], Plane::YZ);
        close(pitch, 0.3);
        close(spatial.forward[0], 0.0);
        close(spatial.forward[1], 0.3_f64.cos());
        // This robot's own y axis is up, so a quarter turn about x puts it upright.
        let (pitch, spatial) = turned([0.0, 0.3, FRAC_PI_2], Plane::XY);
        close(pitch, 0.3);
        close(spatial.roll, 0.0);
        close(spatial.forward[0], 0.3_f64.cos());
    }

    #[test]
    fn rounded_quaternions_are_normalized() {
        let of = |quaternion: [f64; 4]| project([0.0; 2], quaternion, Plane::XZ);
        for factor in [0.995, -1.0] {
            close(of(quaternion([0.0, 0.7, 0.0]).map(|part| factor * part)).unwrap().0, 0.7);
        }
        for other in [[0.0; 4], [1.0, 0.2, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [1e200, 0.0, 0.0, 0.0]] {
            let error = of(other).unwrap_err();
            assert!(matches!(error.reason(), Reason::OutOfRange { .. }), "{error}");
        }
        let error = of(quaternion([0.0, PI - 0.1, 0.0])).unwrap_err();
        assert!(error.to_string().contains("upside down"), "{error}");
    }
}
