//! The base of a three-dimensional recording, projected into the robot's plane.
//!
//! ```text
//!     R = rotation(w, x, y, z) P^T        columns of R: the robot's forward f, normal and up in the world, z up
//!     pitch = asin(-f_z)                  roll = atan2(normal_z, up_z)        heading: (f_x, f_y)
//!     h = sum of (f_x, f_y) over a clip, of length one        along = h . (x, y)        across = h x (x, y)
//! ```
//!
//! P are the axes of the robot's plane ([`Plane`]). Heading is the clip's, not the row's: a body that yaws in its
//! stride does not walk in circles. So turning or shifting a whole clip about the world's z changes nothing but where x
//! begins.

use crate::description::{Matrix, apply};
use crate::robot::Plane;
use crate::{Error, Reason, Result};

/// A quaternion whose length is off one by more is none of a rotation: rounding to two digits does not reach it.
const UNIT: f64 = 0.01;

/// Where a base is and points in the world, as far as the plane does not hold it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spatial {
    /// x and y of the root link's origin \[m\].
    pub origin: [f64; 2],
    /// The horizontal part of the robot's forward axis.
    pub forward: [f64; 2],
    /// The turn about the forward axis \[rad\].
    pub roll: f64,
}

/// The pitch \[rad\] of a base at x and y `origin` \[m\] with the quaternion `[w, x, y, z]`, which is normalised, and
/// the rest.
///
/// # Errors
/// [`Reason::OutOfRange`] for a quaternion that is not of length one, [`Reason::Inconsistent`] for a robot upside down:
/// its pitch is not between -pi/2 and pi/2, and a quaternion cannot distinguish a roll from it.
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
        return Err(Error::new(Reason::Inconsistent(reason)).hint("cut the recording there, or give q_base_pitch"));
    }
    let roll = libm::atan2(normal[2], up[2]);
    let pitch = libm::asin((-forward[2]).clamp(-1.0, 1.0));
    Ok((pitch, Spatial { origin, forward: [forward[0], forward[1]], roll }))
}

/// The rotation of a quaternion of length one; its columns are the turned axes.
fn rotation([w, x, y, z]: [f64; 4]) -> Matrix {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

/// The mean direction of a clip, horizontal and of length one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heading([f64; 2]);

impl Heading {
    /// The mean of all these; `None` if it has no direction, as in a whole turn on the spot.
    pub fn mean<'s>(clip: impl Iterator<Item = &'s Spatial>) -> Option<Self> {
        let (mut x, mut y, mut count) = (0.0, 0.0, 0.0);
        for Spatial { forward, .. } in clip {
            (x, y, count) = (x + forward[0], y + forward[1], count + 1.0);
        }
        let length = libm::hypot(x, y);
        // Below that it is the rounding of the sum.
        (length > count * count * f64::EPSILON).then(|| Self([x / length, y / length]))
    }

    /// A horizontal vector along the heading and to the left of it.
    pub fn along_and_across(self, [x, y]: [f64; 2]) -> [f64; 2] {
        let Self([cos, sin]) = self;
        [cos * x + sin * y, cos * y - sin * x]
    }

    /// The yaw of a base from the heading, left is positive \[rad\].
    pub fn yaw(self, base: &Spatial) -> f64 {
        let [along, across] = self.along_and_across(base.forward);
        libm::atan2(across, along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// The quaternion of a turn by `angle` about a unit `axis`.
    fn turn(angle: f64, axis: [f64; 3]) -> [f64; 4] {
        let (sin, cos) = (0.5 * angle).sin_cos();
        [cos, sin * axis[0], sin * axis[1], sin * axis[2]]
    }

    /// The turn `b` and then, about the world's axes, `a`.
    fn after(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        let ([aw, ax, ay, az], [bw, bx, by, bz]) = (a, b);
        [
            aw * bw - ax * bx - ay * by - az * bz,
            aw * bx + ax * bw + ay * bz - az * by,
            aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw,
        ]
    }

    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];

    fn close(found: f64, expected: f64) {
        // A handful of roundings of numbers of order one.
        assert!((found - expected).abs() < 1e-15, "{found} {expected}");
    }

    #[test]
    fn a_turn_about_y_is_the_pitch_alone() {
        for pitch in [-1.5, -0.3, 0.0, 0.2, 1.4] {
            let (found, Spatial { forward, roll, .. }) = project([0.0; 2], turn(pitch, Y), Plane::XZ).unwrap();
            // The arcsine loses digits near its ends.
            assert!((found - pitch).abs() < 1e-14, "{found} {pitch}");
            close(forward[0], pitch.cos());
            close(forward[1], 0.0);
            close(roll, 0.0);
        }
    }

    #[test]
    fn yaw_pitch_and_roll_come_apart() {
        let (yaw, pitch, roll) = (2.5, 0.4, -0.3);
        let turned = after(turn(yaw, Z), after(turn(pitch, Y), turn(roll, X)));
        let (found, spatial) = project([3.0, 4.0], turned, Plane::XZ).unwrap();
        close(found, pitch);
        close(spatial.roll, roll);
        close(libm::atan2(spatial.forward[1], spatial.forward[0]), yaw);
        assert_eq!(spatial.origin, [3.0, 4.0]);
    }

    #[test]
    fn a_robot_in_another_plane_stands_on_the_worlds_floor_all_the_same() {
        // One that faces its own y axis dips its nose about -x, and heads along the world's y.
        let (pitch, spatial) = project([0.0; 2], turn(-0.3, X), Plane::YZ).unwrap();
        close(pitch, 0.3);
        close(spatial.forward[0], 0.0);
        close(spatial.forward[1], 0.3_f64.cos());
        // One whose own y axis is up stands upright after a quarter turn about x.
        let upright = turn(FRAC_PI_2, X);
        let (pitch, spatial) = project([0.0; 2], after(turn(0.3, Y), upright), Plane::XY).unwrap();
        close(pitch, 0.3);
        close(spatial.roll, 0.0);
        close(spatial.forward[0], 0.3_f64.cos());
    }

    #[test]
    fn rounded_quaternions_are_normalised_and_others_refused() {
        let exact = turn(0.7, Y);
        let (pitch, _) = project([0.0; 2], exact.map(|part| 0.995 * part), Plane::XZ).unwrap();
        close(pitch, 0.7);
        let negative = exact.map(|part| -part);
        close(project([0.0; 2], negative, Plane::XZ).unwrap().0, 0.7);
        for other in [[0.0; 4], [1.0, 0.2, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [1e200, 0.0, 0.0, 0.0]] {
            let error = project([0.0; 2], other, Plane::XZ).unwrap_err();
            assert!(matches!(error.reason(), Reason::OutOfRange { .. }), "{error}");
        }
        let error = project([0.0; 2], turn(PI - 0.1, Y), Plane::XZ).unwrap_err();
        assert!(error.to_string().contains("upside down"), "{error}");
    }

    #[test]
    fn the_heading_is_the_mean_of_a_turning_clip() {
        let facing = |yaw: f64| project([0.0; 2], turn(yaw, Z), Plane::XZ).unwrap().1;
        // A quarter turn from yaw 0.2, in even steps: half way.
        let clip: Vec<Spatial> = (0..=90).map(|step| facing(0.2 + f64::from(step) * FRAC_PI_2 / 90.0)).collect();
        let heading = Heading::mean(clip.iter()).unwrap();
        let half = 0.2 + 0.25 * PI;
        let [along, across] = heading.along_and_across([half.cos(), half.sin()]);
        assert!((along - 1.0).abs() < 1e-14 && across.abs() < 1e-14, "{along} {across}");
        assert!((heading.yaw(&clip[0]) + 0.25 * PI).abs() < 1e-14);
        // A whole turn has none.
        let circle: Vec<Spatial> = (0..360).map(|step| facing(f64::from(step) * PI / 180.0)).collect();
        assert_eq!(Heading::mean(circle.iter()), None);
        assert_eq!(Heading::mean([].iter()), None);
    }
}
