//! Pictures and pages of robots, impacts, sweeps and gaits.

pub mod robot;
mod keyframe;
#[cfg(feature = "plot")]
pub mod plot;
#[cfg(feature = "plot")]
pub mod sweep;
#[cfg(all(feature = "accuracy", feature = "plot"))]
mod accuracy;
#[cfg(feature = "plot")]
pub mod page;

pub use keyframe::{Answer, Keyframe, ListedKeyframe, Pose};
#[cfg(feature = "plot")]
pub use plot::Picture;
pub use robot::Drawing;
