//! Options for rows that are successive samples in time.

use super::options::{Choices, choice, from_zero};
use crate::batch::RowOrigin;
use crate::gait::{self, At, Difference, Dropped, Heights, Sampled, Seen, Thresholds, Touching};
use crate::read::table::{Header, Rates};
use crate::state::NamedContact;
use crate::{Result, Robot};
use std::sync::Mutex;

/// Options that conflict with `--touchdowns`. All options that require it have this list, too: clap does not demand a
/// required option that is in conflict with a given one.
const OTHERS: &[&str] = &["place", "forces", "contact_tolerance"];

/// Options for rows that follow each other in time.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Recordings")]
pub struct RecordingOptions {
    /// Answer only touchdowns: the moments at which a foot reaches the ground from above
    ///
    /// A foot touches down if it descends far enough (--drop), faster than 0.05 m/s, and stops low enough
    /// (--ground-height). The moment of contact is when its motion before reaches the level at which it stops, or, if
    /// it slows down, when it is 2 mm above that level. Noise is measured and fitted by lines. For robots smaller than
    /// 0.25 m these thresholds shrink in proportion; the size is the greatest distance from the root's origin to a foot
    /// or center of gravity with all joints at zero. The base is then shifted so that the foot is at z = 0.
    #[arg(long, conflicts_with_all = OTHERS)]
    pub touchdowns: bool,
    /// Trust the heights of a simulation: the ground is z = 0, and a foot touches down when it crosses it
    ///
    /// The moment of contact is extrapolated from up to six rows before it. For recordings without noise.
    #[arg(long, requires = "touchdowns", conflicts_with_all = [&["ground_height"][..], OTHERS].concat())]
    pub simulated: bool,
    /// Which state of a touchdown is analyzed
    #[arg(long, value_parser = choice(ROWS), default_value = "crossing", requires = "touchdowns", conflicts_with_all = OTHERS)]
    pub at: At,
    /// Which other feet touch the ground at a touchdown: strike (none), slow:SPEED,HEIGHT or near:HEIGHT
    ///
    /// With slow, the lowest point of every other body, if it is slower than SPEED (m/s) and its height differs from
    /// the striking point's by at most HEIGHT (m): standing feet. With near, every point at such a height, at any
    /// speed.
    #[arg(long, value_name = "WHICH", default_value_t, requires = "touchdowns", conflicts_with_all = OTHERS)]
    pub touching: Touching,
    /// How far a foot must have descended, in meters [default: 0.012, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, allow_hyphen_values = true)]
    #[arg(requires = "touchdowns", conflicts_with_all = OTHERS)]
    pub drop: Option<f64>,
    /// How far above z = 0 a foot may stop, in meters [default: 0.02, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, allow_hyphen_values = true)]
    #[arg(requires = "touchdowns", conflicts_with_all = OTHERS)]
    pub ground_height: Option<f64>,
    /// Compute velocities from the positions and the column "time"
    #[arg(long, value_parser = choice(DIFFERENCES), value_name = "HOW")]
    pub velocity: Option<Difference>,
}

/// The values of `--at`: which state of a touchdown is analyzed.
pub const ROWS: Choices<At> = &[
    ("crossing", "The state at the moment of contact, extrapolated from the rows before the impact", At::Crossing),
    ("row", "The last row before that moment, shifted in z", At::Row),
];

/// The values of `--velocity`: how velocities are computed.
pub const DIFFERENCES: Choices<Difference> = &[
    ("central", "From the rows before and after", Difference::Central),
    ("backward", "From the row before", Difference::Backward),
];

/// The samples of a recording, in order.
pub type Samples<'a> = Box<dyn Iterator<Item = Sampled<RowOrigin>> + Send + 'a>;

impl RecordingOptions {
    /// Returns whether the answer to a row depends on other rows.
    pub fn is_in_order(&self) -> bool {
        self.touchdowns || self.velocity.is_some()
    }

    /// Returns the names and values of the lengths that define touchdowns \[m\]; `None` for a length that is not given.
    pub fn lengths(&self) -> impl Iterator<Item = (&'static str, Option<f64>)> {
        let height = match self.touching {
            Touching::Slow { height, .. } | Touching::Near { height } => Some(height),
            Touching::Strike => None,
        };
        [("`drop`", self.drop), ("`ground_height`", self.ground_height), ("`touching`", height)].into_iter()
    }

    /// Returns where velocities come from: the columns, or the positions over time.
    pub fn rates(&self) -> Rates {
        if self.velocity.is_some() { Rates::Time } else { Rates::Columns }
    }

    /// Returns the thresholds that define a touchdown.
    ///
    /// # Errors
    /// Returns an error if touchdowns are requested and the robot has no feet.
    pub fn thresholds(&self, robot: &Robot, feet: &[NamedContact]) -> Result<Thresholds> {
        if self.touchdowns {
            gait::find(std::iter::empty::<Sampled<()>>(), robot, feet, self.at, self.touching)?;
        }
        let usual = Thresholds::of(robot, feet);
        let (drop, ground) = (self.drop.unwrap_or(usual.drop), self.ground_height.unwrap_or(usual.ground));
        Ok(Thresholds { drop, ground, ..usual })
    }

    /// Returns the samples to be answered. The parts of motion that a projection of the base omits are added to
    /// `dropped`, and observations of the recording to `seen`.
    ///
    /// # Errors
    /// Returns an error if touchdowns are requested and the robot has no feet.
    pub fn chosen<'a>(
        &self,
        mut samples: Samples<'a>,
        header: &Header,
        (robot, feet): (&'a Robot, &[NamedContact]),
        thresholds: Thresholds,
        (dropped, seen): (&'a Mutex<Dropped>, &'a Mutex<Seen>),
    ) -> Result<Samples<'a>> {
        if self.is_in_order() {
            samples = Box::new(gait::unwrapped(samples, robot));
        }
        if header.is_spatial() {
            samples = Box::new(gait::sagittal(samples, dropped));
        }
        if let Some(difference) = self.velocity {
            if !self.touchdowns {
                // Of three rows of one time, the one in the middle gets no velocity.
                samples = Box::new(Seen::watching(samples, (robot, seen)));
            }
            samples = Box::new(gait::rates(samples, difference));
        }
        if self.touchdowns {
            let found = gait::find(samples, robot, feet, self.at, self.touching)?;
            samples = Box::new(found.with(thresholds).meaning(self.heights()).noting(seen));
        }
        Ok(samples)
    }

    /// Returns the message for a recording without touchdowns.
    pub fn nothing_found(&self, thresholds: Thresholds, seen: &Seen) -> String {
        seen.nothing_found(thresholds, self.heights())
    }

    fn heights(&self) -> Heights {
        if self.simulated { Heights::True } else { Heights::Recorded }
    }
}
