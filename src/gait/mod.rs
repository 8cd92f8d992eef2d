//! Touchdowns in recorded gaits: the moments at which a foot that was above the ground reaches it.
//!
//! ```text
//!     samples in time --[unwrapped]--> --[sagittal, where the base is in 3-D]--> --[rates, where the table has none]-->
//!     --[find]--> touchdowns: time, state, Landing (row, striking contact)
//! ```
//!
//! In recordings feet seldom touch exactly at z = 0: they float or sink by centimeters, sink slowly during stance, and
//! may scuff over the ground. A touchdown is therefore detected from the motion of every point that can touch: the
//! lowest point of a circle, the corners of a polygon. A *descent* is a run of rows in which a point falls faster than
//! [`Thresholds::slow`]. It is a touchdown if the point has come down by [`Thresholds::drop`] or more since it last
//! stopped falling, ends no higher than [`Thresholds::ground`] above z = 0, and is free toward the ground: on ground of
//! some slope m near to level, it is the lowest of its body.
//!
//! ```text
//!     z_i - m x_i <= z_j - m x_j  for all points j of the body of i,        with one |m| <= 0.15
//! ```
//!
//! The toe of a flat foot can therefore touch down even if the heel is recorded a little lower; the upper side of a
//! sole and points inside a round foot cannot. The thresholds are lengths ([`Touchdowns::with`]), because the errors of
//! recorded heights depend on the recording and not on the robot. A robot smaller than [`SMALL`] lifts its feet less,
//! so its thresholds are proportionally smaller.
//!
//! The *noise* of a point's height is measured on the last rows of the clip. It is the median distance of a row from
//! the polynomial through the six rows before it, divided by 0.67 (median over standard deviation) and by the factor by
//! which the extrapolation amplifies noise. If the noise from row to row is faster than [`Thresholds::slow`], the rate
//! of a row is the slope of the least-squares line through the last n rows. The noise of this slope is then two thirds
//! of that threshold. The descent then ends on the mean height of the later half of these rows.
//!
//! The moment of contact is one of three:
//!
//! * With noise, it is the moment at which the least-squares line through the last n falling rows reaches that level.
//! * A foot may be stopped at once: its motion, continued at more than twice [`Thresholds::slow`], reaches the level
//!   before the next row. Then it is the moment at which the polynomial through the rows before reaches the level. Six
//!   rows are used if their noise is at most a ten-thousandth of the fall from row to row, else three.
//! * Else it is the moment at which the point is [`Thresholds::above`] over that level. Before that, the foot still has
//!   the velocity with which it strikes.
//!
//! With [`At::Row`] the state is the last row before that moment; without noise, before the third of these moments.
//! With [`At::Crossing`] it is the state at the moment. In the first two cases, positions are on the line or
//! polynomial. Velocities from differences are replaced by its rates; recorded velocities are on a line, with noise
//! through the same rows, else through the last two. Noise may put the moment up to eight rows after the impact.
//! Recorded velocities correct this in all three cases: where a fall faster than twice [`Thresholds::slow`] loses more
//! than half of its speed from one row to the next, on the point's level or rebounding from it, the row before is the
//! last one that counts. In the last case:
//!
//! * If the next row is before the impact, too (the point goes on falling after it), positions are on the line between
//!   the two rows.
//! * Else time and positions are extrapolated by the parabola through the last three rows before the moment (a line
//!   through two) until the point touches. If it does not touch before the next row, or the next row is far away,
//!   positions are on the line between the two rows after all.
//! * Velocities are on the line through the two rows around the moment if both are before the impact; else they are
//!   extrapolated from the last two. A velocity from differences belongs to the middle of its rows. It does not count
//!   if one of these rows is after the impact.
//! * If the descent ends above that height, the row at which it ends is taken as it is.
//!
//! No extrapolation uses rows from before two rows of one time: between those another foot may have struck.
//!
//! If a row within that distance is followed by one of the same time, it is the state just before the impact, and is
//! taken as it is with either [`At`]. So is the last row of a clip whose descent ends with the clip, if the point is
//! within [`Thresholds::above`] of z = 0; if it is below, the moment is its crossing of z = 0. In every case the base
//! is then shifted along z so that the striking point is at z = 0 (a base that is fixed to the world is not).
//!
//! The heights of a simulation without noise can be taken as exact ([`Heights::True`]). A point then touches the ground
//! when it crosses z = 0, or stops within a millionth of the robot's size of it, after a descent of
//! [`Thresholds::drop`] or more. At the moment of contact its height is zero if all coordinates continue on the
//! polynomial through up to six rows before. None of these rows is before the last touchdown, or before two rows of one
//! time. If that leaves one or two rows, the last touchdown is used, too, unless it is too near to them to show a rate.
//! If only a row without recorded velocity is left then, the state is the row before that touchdown. With six rows and
//! more, each coordinate and each rate uses as many rows as have predicted its last two values best, because a
//! controller may make accelerations jump. Recorded velocities are extrapolated; differences are replaced by the rates
//! of the polynomial. If the polynomial does not reach the ground before the next row, time and positions are on the
//! line between both rows. A clip that ends in the air ends without a touchdown. A point that rises between two rows
//! has bounced if its motion before leads into the ground, and no other point into the ground before it.
//!
//! A jump back in time starts a new clip, and so does a step more than ten times the longest of the clip so far. A
//! refused sample is passed on in its place and left out of the motion. Touchdowns come in the order in which their
//! descents end; those of one time come in the order of the links. Their contacts are named and closed: the striking
//! contact, those that strike with it (both ends of a flat foot, both feet of a hop), and those that [`Touching`] adds.

mod carry;
mod clip;
mod points;
mod window;
mod noise;
mod strike;
mod arrival;
mod seen;
mod find;
mod rates;
mod turns;
pub mod spatial;

pub use find::{Touchdowns, find};
pub use rates::{Difference, rates};
pub use seen::Seen;
pub use spatial::{Dropped, sagittal};
pub use turns::unwrapped;

use crate::contact::Feet;
use crate::state::{NamedContact, State};
use crate::{Error, Reason, Robot};
use std::fmt;
use std::str::FromStr;

/// Robots of this size and larger have the same thresholds \[m\]. The size is the greatest distance from the root's
/// origin to a foot or CoG with all joints at zero.
pub const SMALL: f64 = 0.25;

/// The thresholds of a touchdown. For a robot smaller than [`SMALL`], each is smaller in proportion to its size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholds {
    /// The least height of a descent \[m\]: 12 mm.
    pub drop: f64,
    /// The speed below which a falling point has ended its descent \[m/s\]: 0.05 m/s.
    pub slow: f64,
    /// The greatest height at which a descent may end \[m\]: 20 mm.
    pub ground: f64,
    /// The height above the end of its descent at which a point that slows down touches the ground \[m\]: 2 mm.
    pub above: f64,
    /// The greatest difference in height of points that strike together at one row \[m\]: 1 um.
    pub together: f64,
}

impl Thresholds {
    /// Returns the thresholds for `robot` with its additional `feet`.
    pub fn of(robot: &Robot, feet: &[NamedContact]) -> Self {
        let part = (Feet::new(robot, feet).size() / SMALL).min(1.0);
        Self { drop: 0.012 * part, slow: 0.05 * part, ground: 0.02 * part, above: 0.002 * part, together: 1e-6 * part }
    }
}

/// A state of a recording, with its time.
#[derive(Debug, Clone)]
pub struct Sample<S> {
    /// The time \[s\].
    pub time: f64,
    /// The state. It has no stance, and no contacts before it becomes a touchdown.
    pub state: State,
    /// The times between which its velocity was measured \[s\]: both its own time, or those of a difference's rows.
    pub rate_over: [f64; 2],
    /// The motion outside the plane of a three-dimensional base, until it is projected (`sagittal`).
    pub spatial: Option<spatial::Spatial>,
    /// How the foot reaches the ground, if this is a touchdown.
    pub landing: Option<Landing>,
    /// The caller's reference for it; for a touchdown between two rows, that of the first row.
    pub source: S,
}

/// A sample, or the error of a refused one with its source.
pub type Sampled<S> = std::result::Result<Sample<S>, (S, Error)>;

/// Data of a touchdown.
#[derive(Debug, Clone)]
pub struct Landing {
    /// Index of the sample, or of the last sample before the touchdown. It counts from 0 and includes refused samples.
    pub row: usize,
    /// The name of the contact that reaches the ground, as in the result; the first one if there are several.
    pub striking: String,
    /// The shift of the base along z \[m\].
    pub shift_z: f64,
    /// The state that was taken.
    pub at: At,
    /// The other points that were taken to touch the ground.
    pub touching: Touching,
    /// Whether the foot slows down toward the ground while its height has no noise, as in a simulation. The state is
    /// then one before the impact.
    pub is_early: bool,
    /// Whether the foot fell more than twice as fast shortly before, as on soft ground. The state may then be one after
    /// the impact.
    pub is_slowed: bool,
    /// Whether the foot is far below z = 0, as in a recording with other axes or units.
    pub is_deep: bool,
    /// Whether another touchdown is so near that true heights show no velocity between both. The state is then the one
    /// before both.
    pub is_crowded: bool,
}

/// The meaning of recorded heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Heights {
    /// Inexact: feet float and sink, so the ground is where a descent ends.
    #[default]
    Recorded,
    /// Exact, as in a simulator: the ground is z = 0.
    True,
}

/// The state that is taken for a touchdown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum At {
    /// The state at the moment of contact, between two rows.
    #[default]
    Crossing,
    /// The last row before that moment.
    Row,
}

impl At {
    /// Returns the name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::Row => "row",
        }
    }
}

/// The points that touch the ground in addition to the striking one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Touching {
    /// No other points.
    Strike,
    /// The lowest point of every other body, if it is slower than `speed` \[m/s\] and its height differs from the
    /// striking point's by at most `height` \[m\]. With [`Heights::True`], also every point on the ground, or in it by
    /// up to `height`, that is slower than `speed` or goes down; only the outer two of each body.
    Slow { speed: f64, height: f64 },
    /// Every point that is free toward the ground and within `height` \[m\] of the striking point's, however it moves.
    Near { height: f64 },
}

impl Default for Touching {
    /// Feet that stand in recorded data: slower than 0.35 m/s and within 2 cm.
    fn default() -> Self {
        Self::Slow { speed: 0.35, height: 0.02 }
    }
}

impl fmt::Display for Touching {
    /// Writes the format that `from_str` reads.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Strike => f.write_str("strike"),
            Self::Slow { speed, height } => write!(f, "slow:{speed},{height}"),
            Self::Near { height } => write!(f, "near:{height}"),
        }
    }
}

impl FromStr for Touching {
    type Err = Error;

    /// Reads `strike`, `slow:SPEED,HEIGHT` or `near:HEIGHT`; `slow` alone is the default.
    fn from_str(text: &str) -> Result<Self, Error> {
        let (kind, bounds) = text.split_once(':').map_or((text, None), |(kind, bounds)| (kind, Some(bounds)));
        let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
        let bounds: Option<Vec<f64>> = bounds.into_iter().flat_map(|bounds| bounds.split(',')).map(number).collect();
        match (kind, bounds.as_deref()) {
            ("strike", Some([])) => Ok(Self::Strike),
            ("slow", Some([])) => Ok(Self::default()),
            ("slow", Some(&[speed, height])) => Ok(Self::Slow { speed, height }),
            ("near", Some(&[height])) => Ok(Self::Near { height }),
            _ => {
                let found = format!("expected strike, slow:SPEED,HEIGHT or near:HEIGHT, found \"{text}\"");
                Err(Error::new(Reason::Syntax(found)).hint("as in slow:0.35,0.02, in m/s and m"))
            }
        }
    }
}
