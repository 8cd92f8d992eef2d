//! The ground: a line through the world's origin, or a profile of segments.
//!
//! ```text
//!     solid below the line          level (slope 0), or uphill toward +x
//!     solid below the profile       (x_0, z_0) -- (x_1, z_1) -- ... -- (x_n, z_n), x rising; no ground beyond the ends
//! ```

use crate::error::{Error, Reason, Result, finite};
use crate::planar::{Rotation, Vector};
use crate::scalar::{Real, Trigonometry};

/// The ground that the robot strikes.
///
/// ```
/// # fn main() -> heelstrike::Result<()> {
/// use heelstrike::{Ground, state::Profile};
///
/// let step = Profile::new(vec![[-1.0, 0.0].into(), [0.5, 0.0].into(), [0.501, 0.1].into(), [2.0, 0.1].into()])?;
/// assert!(matches!(Ground::Profile(step), Ground::Profile(profile) if profile.points().len() == 4));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Ground {
    /// A line through the world's origin, given by its slope \[rad\], uphill toward +x; level ground has slope 0.
    Slope(f64),
    /// Segments: steps, stairs, gaps.
    Profile(Profile),
}

impl Default for Ground {
    fn default() -> Self {
        Self::Slope(0.0)
    }
}

impl Ground {
    /// Returns the rotation from the world's axes to those of a contact (tangent, normal), in numbers of any kind. For
    /// a slope it is computed from the angle; for a profile it is exactly the f64 rotation `found` by detection.
    pub fn axes<T: Real + Trigonometry>(&self, found: Rotation<f64>) -> Rotation<T> {
        match self {
            Self::Slope(slope) => {
                let [cos, sin] = T::cos_sin(-slope);
                Rotation { cos, sin }
            }
            Self::Profile(_) => Rotation { cos: T::from_f64(found.cos), sin: T::from_f64(found.sin) },
        }
    }
}

/// A ground of straight segments between points of rising x. It is solid below, and there is no ground beyond its ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Profile {
    /// At least two points, by rising x \[m\].
    points: Vec<Vector<f64>>,
}

impl Profile {
    /// Creates the profile through `points`, `[x, z]` in the world \[m\].
    ///
    /// # Errors
    /// Returns [`Reason::Inconsistent`] if there are fewer than two points, x does not rise or points are too far apart
    /// for f64, and [`Reason::NotFinite`]. The error's place is the point's index, as in `[3]`.
    pub fn new(points: Vec<Vector<f64>>) -> Result<Self> {
        if points.len() < 2 {
            let reason = format!("a profile has at least two points, not {}", points.len());
            return Err(Error::new(Reason::Inconsistent(reason)).hint("level ground is \"ground\": {\"slope\": 0}"));
        }
        for (at, value) in points.iter().enumerate().flat_map(|(at, point)| point.components().map(|entry| (at, entry)))
        {
            finite(value, || "a profile's point".into()).map_err(|error| error.at(format!("[{at}]")))?;
        }
        for (at, pair) in points.windows(2).enumerate() {
            let [from, to] = [pair[0].x, pair[1].x];
            let refused = |reason: String| Error::new(Reason::Inconsistent(reason)).at(format!("[{}]", at + 1));
            if to <= from {
                let reason = format!("a profile's x rises from point to point, but {to:?} follows {from:?}");
                return Err(refused(reason).hint("give a vertical riser a tiny width, such as 1e-6 m"));
            }
            if !(pair[1] - pair[0]).length().is_finite() {
                let reason = "the distance from the point before is beyond the range of f64".to_owned();
                return Err(refused(reason).hint("give the points in meters"));
            }
        }
        Ok(Self { points })
    }

    /// The points of the profile, ascending in x \[m\].
    pub fn points(&self) -> &[Vector<f64>] {
        &self.points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_has_finite_points_at_a_finite_distance() {
        let profile = |x, z| Profile::new(vec![Vector::new(0.0, 0.0), Vector::new(x, z)]);
        assert_eq!(profile(1.0, f64::NAN).expect_err("no number").place(), Some("[1]"));
        assert!(profile(f64::MIN_POSITIVE, 1e9).is_ok());
    }
}
