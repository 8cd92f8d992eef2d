//! Outcomes against one or two parameters: the regions of equal outcomes, and what turns at the borders between them.
//!
//! ```text
//!     JSON --[study]--> Study: parameters, expressions     point --[model, variation]--> Robot, State --[pipeline]--> Impact
//!     Impact --[regime]--> which outcomes are valid        inequalities of all combinations --[hunt]--> where they may change
//!     samples --[line]--> borders, bisected to 1e-12 of the range --[turn]--> which inequality of which contact is zero there
//!     one parameter --[survey]--> Survey
//! ```

mod hunt;
mod line;
mod model;
mod parallel;
mod regime;
mod study;
mod survey;
mod turn;
mod variation;

pub use line::{Bracket, Landscape, Point, RESOLUTION, Stretch, brackets, stretches};
pub use model::{Model, Solver, WATCHED_CONTACTS, Watched};
pub use parallel::Workers;
pub use regime::Regime;
pub use study::{Parameter, Study};
pub use survey::{Border, Region, Survey};
pub use turn::{Inequality, Side, Turn, Turns};
