//! Pictures and pages of robots, impacts, sweeps and gaits.

#[cfg(feature = "plot")]
pub mod plot;
pub mod robot;
mod keyframe;
#[cfg(feature = "plot")]
pub mod sweep;
#[cfg(all(feature = "accuracy", feature = "plot"))]
mod accuracy;
#[cfg(feature = "plot")]
pub mod page;

pub use keyframe::{Keyframe, KeyframeAnswer, ListedKeyframe};
#[cfg(feature = "plot")]
pub use plot::Picture;
pub use robot::Drawing;
