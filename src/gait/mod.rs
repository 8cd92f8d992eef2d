//! Touchdowns in recorded gaits: the moments at which a foot that was above the ground reaches it.
//!
//! ```text
//!     samples in time --[unwrapped]--> --[sagittal, where the base is in 3-D]--> --[rates, where the table has none]-->
//!     --[find]--> touchdowns: time, state, Landing (row, striking contact)
//! ```
//!
//! Recorded feet do not reach z = 0: they float or sink by centimeters, sink slowly while they stand, and may be
//! scuffed over the ground. So a touchdown is recognized by motion: the height of every point that can touch (a
//! circle's lowest, a polygon's corners) is followed. A *descent* is a run of rows in which it falls faster than
//! [`Thresholds::slow`]. It is a touchdown if the point has come down by [`Thresholds::drop`] or more since it was last
//! not falling, ends no higher than [`Thresholds::ground`] above z = 0, and is free toward the ground: the lowest of
//! its body over a ground of some slope m near to level.
//!
//! ```text
//!     z_i - m x_i <= z_j - m x_j  for all points j of the body of i,        with one |m| <= 0.15
//! ```
//!
//! So the toe of a flat foot comes down though the heel is recorded a little lower, and the upper side of a sole or
//! what is inside a round foot does not. The thresholds are lengths, because how far feet float is a matter of
//! recording and not of the robot; they can be set ([`Touchdowns::with`]). A robot smaller than [`SMALL`] lifts its
//! feet less, and has them in proportion.
//!
//! The *noise* of a point's height is measured on the last rows of the clip: the median distance of a row from the
//! polynomial through the six before it, over 0.67 and over what that polynomial makes of a noise of one. If from row
//! to row it is faster than [`Thresholds::slow`], the rate of a row is that of the line of least squares through the
//! last n rows, whose noise is two thirds of that, and the level on which a descent ends is the mean height of the
//! later half of them.
//!
//! The moment of contact is
//!
//! * with noise the one at which the line of least squares through the last n falling rows is down at that level;
//! * of a foot that is stopped at once (that is carried on to the level, at more than twice [`Thresholds::slow`],
//!   before the next row) the one at which the polynomial through the rows before reaches the level: six rows if their
//!   noise is no more than a ten-thousandth of the fall from row to row, else three;
//! * else the one at which the point is [`Thresholds::above`] over that level; before it the foot still has the
//!   velocity with which it strikes.
//!
//! With [`At::Row`] the state is the last row before that moment; without noise, before the third of these moments.
//! With [`At::Crossing`] it is the state at the moment. In the first two cases positions are those of line and
//! polynomial, and velocities their rates if they are differences; recorded velocities are on a line through the same
//! rows with noise, else through the last two. Noise may put the moment up to eight rows behind the impact. So where a
//! point's recorded velocity loses more than half of a fall that is faster than twice [`Thresholds::slow`] from one row
//! to the next, on its level or rebounding from it, the row before that is the last one that counts, in each of the
//! three cases. In the last case:
//!
//! * If the next row is before the impact too (the point goes on falling after it), positions lie on the line between
//!   the two rows.
//! * Else time and positions go on from the last three rows before it by the parabola through them (a line through
//!   two), until the point is where it touches. If it does not get there before the next row, or the next row is far,
//!   they lie on the line between the two rows after all.
//! * Velocities are on the line through those of the two rows around the moment if both are before the impact, else of
//!   the last two, carried on. A velocity from differences belongs to the middle of its rows, and does not count if one
//!   of them is after the impact.
//! * If the descent ends above that height, the row at which it ends is taken as it is.
//!
//! None goes back over two rows of one time: between them another foot may have struck.
//!
//! A row within that distance that is followed by one of the same time is the state just before the impact, and is
//! taken as it is, either way. So is the last row of a clip whose descent ends with the clip, if the point is within
//! [`Thresholds::above`] of z = 0; if it is below, the moment is the one at which it crosses z = 0. In every case the
//! base is then shifted along z so that the striking point is at z = 0 (a base that is fixed to the world is not).
//!
//! A simulation without noise can be taken at its word ([`Heights::True`]): a point touches the ground when it crosses
//! z = 0, or stops within a millionth of the robot's size of it, after a descent of [`Thresholds::drop`] or more. The
//! moment is where its height is zero if all coordinates go on as the polynomial through up to six rows before it, none
//! of them from before the last touchdown or from before two rows of one time. With six rows and more each coordinate and
//! each rate goes on by as many as have foretold its last two values best: accelerations may jump
//! from row to row, as a controller's do.
//! Velocities go on as recorded; differences are replaced by the rates of the polynomial. If that does not reach the
//! ground before the next row, time and positions lie on the line between both rows. A clip that ends aloft ends
//! without a touchdown.
//!
//! A jump back in time starts a new clip, and so does a step more than ten times the longest of the clip so far. A
//! refused sample is passed on in its place and left out of the motion. Touchdowns come in the order of the ends of
//! their descents and, of one time, of the links. Their contacts are named and closed: the striking one, those that
//! strike with it (both ends of a flat foot, both feet of a hop), and those that [`Touching`] adds.

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

/// Robots of this size and larger \[m\] have the same thresholds; the size is the greatest distance from the root's
/// origin to a foot or CoG with all joints at zero.
pub const SMALL: f64 = 0.25;

/// What counts as a touchdown; of a robot smaller than [`SMALL`] the same part of each as its size is of that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholds {
    /// The least height of a descent: 12 mm \[m\].
    pub drop: f64,
    /// A point that falls more slowly has ended its descent: 0.05 m/s \[m/s\].
    pub slow: f64,
    /// The highest level on which a descent may end: 20 mm \[m\].
    pub ground: f64,
    /// How far above the level on which its descent ends a point touches the ground if it slows down: 2 mm \[m\].
    pub above: f64,
    /// Points that strike at the same row and are no more apart in height strike together: 1 um \[m\].
    pub together: f64,
}

impl Thresholds {
    /// Those for `robot` with the `feet` that were added to it.
    pub fn of(robot: &Robot, feet: &[NamedContact]) -> Self {
        let part = (Feet::new(robot, feet).size() / SMALL).min(1.0);
        Self { drop: 0.012 * part, slow: 0.05 * part, ground: 0.02 * part, above: 0.002 * part, together: 1e-6 * part }
    }
}

/// A state of a recording.
#[derive(Debug, Clone)]
pub struct Sample<S> {
    /// When \[s\].
    pub time: f64,
    /// The state; without a stance, and without contacts until it is that of a touchdown.
    pub state: State,
    /// From when to when its velocity was taken \[s\]: at its own time alone, or of differences between two rows.
    pub rate_over: [f64; 2],
    /// What the plane does not hold of a base in three dimensions, until the motion is projected (`sagittal`).
    pub spatial: Option<spatial::Spatial>,
    /// How it reaches the ground, of a touchdown.
    pub landing: Option<Landing>,
    /// What the caller knows it by; for a touchdown between two rows the first of them.
    pub source: S,
}

/// A sample, or what stands in its place where it was refused.
pub type Sampled<S> = std::result::Result<Sample<S>, (S, Error)>;

/// How a foot reaches the ground, just after a state.
#[derive(Debug, Clone)]
pub struct Landing {
    /// The sample that it is, or the last one before it, counted from 0 with the refused ones.
    pub row: usize,
    /// The name of the contact that reaches the ground, as in the result; of several at once the first.
    pub striking: String,
    /// What was added to the base's z \[m\].
    pub shift_z: f64,
    /// Which state was taken.
    pub at: At,
    /// Which other points were taken to touch the ground.
    pub touching: Touching,
    /// Whether the foot slows down to the ground and its height has no noise, as in a simulation: the state is then one
    /// before the impact.
    pub is_early: bool,
    /// Whether the foot has fallen more than twice as fast shortly before, as on soft ground: the state may be one after
    /// the impact.
    pub is_slowed: bool,
    /// Whether it is far under z = 0, as in a recording of other axes or units.
    pub is_deep: bool,
}

/// How recorded heights are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Heights {
    /// Feet float and sink: the ground is where a descent ends.
    #[default]
    Recorded,
    /// As a simulator has them: the ground is z = 0.
    True,
}

/// Which state of a touchdown is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum At {
    /// At the moment of contact, between two rows.
    #[default]
    Crossing,
    /// The last row before it.
    Row,
}

impl At {
    /// As it is spelled on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::Row => "row",
        }
    }
}

/// Which points touch the ground in addition to the striking one.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the text of each variant names its fields")]
pub enum Touching {
    /// None.
    Strike,
    /// Of every other body the lowest point, if it is slower than `speed` \[m/s\] and its height differs from the
    /// striking point's by no more than `height` \[m\]. Where heights are true ([`Heights::True`]), also every point
    /// on the ground, or in it by up to `height`, that is slower or goes down: of each body the outer two.
    Slow { speed: f64, height: f64 },
    /// Every point free toward the ground whose height differs from the striking point's by no more than `height`
    /// \[m\], however it moves.
    Near { height: f64 },
}

impl Default for Touching {
    /// Feet that stand in recorded data: slower than 0.35 m/s and within 2 cm.
    fn default() -> Self {
        Self::Slow { speed: 0.35, height: 0.02 }
    }
}

impl fmt::Display for Touching {
    /// As it is read.
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
