//! Output: results, sweeps and inspections as JSON (a contract), tables, and text for people.
//!
//! ```text
//!     Impact (a robot's state)  ──┐
//!     Analysis (matrices alone) ──┴──> Report ──> one line of JSON      result
//!                                         └────> text for people        text
//!     Impact ───────────────────────> Arrays                            arrays.rs
//! Impact (sustained contact) ───> Report ──> JSON with names for forces      forces.rs
//!     Robot ──> Inspection ──> JSON, text                               inspection.rs
//!     Header, Study ──> sentences                                       notes.rs
//!     Survey, Map ──> Regions, samples ──> JSON, CSV, text              sweep
//!     CaseStudy, Comparison ──> Accuracy ──> JSON, text                 accuracy
//! ```

pub(crate) mod table;
pub(crate) mod words;
mod state;
mod result;
mod forces;
mod text;
mod csv;
mod text_row;
#[cfg(feature = "columnar")]
mod columnar;
mod arrays;
mod inspection;
pub mod notes;
pub mod sweep;
#[cfg(feature = "accuracy")]
pub mod accuracy;
#[cfg(feature = "schema")]
pub mod schema;

#[cfg(feature = "accuracy")]
pub use accuracy::{Accuracy, Compliant};
pub use arrays::{Arrays, Texts};
#[cfg(feature = "columnar")]
pub use columnar::{ColumnBlock, ColumnWriter};
pub use csv::{Cell, Columns, Kind, Layout, Row, RowSink};
pub use forces::{ForceOutcome, ForcesRecord, RejectedForces, SustainedContact};
pub use inspection::{BodyRecord, FootRecord, FrozenRecord, Inspection, JointRecord, LinkRecord, MimicRecord};
pub(crate) use result::short_id;
pub use result::{
    Brief, ContactInBrief, ContactRecord, ErrorObject, LeftOutRecord, NearestRecord, OutcomeInBrief, Refused, Rejected,
    Report, Touchdown,
};
pub use state::{CounterexampleRecord, HoldsRecord};
pub use text::{Subject, text};
pub use words::titled;

use serde::Serialize;

/// Escape sequences that mark text on a terminal; empty for plain text.
#[derive(Debug, Clone, Copy, Default)]
pub struct Palette {
    /// Begins emphasized text.
    pub strong: &'static str,
    /// Begins secondary text.
    pub faint: &'static str,
    /// Ends emphasized and secondary text.
    pub plain: &'static str,
}

/// Returns the text that `write` writes.
fn written(write: impl FnOnce(&mut String) -> std::fmt::Result) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let _ = write(&mut out);
    out
}

/// How much of a result is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Detail {
    /// Whether to list why each rejected combination fails.
    pub explain: bool,
    /// Whether to write the matrices.
    pub matrices: bool,
    /// Whether to write only the verdict and each outcome's modes, index and margin.
    pub brief: bool,
}

/// Appends `value` to `out` as one line of JSON.
pub fn append_line<T: Serialize>(out: &mut Vec<u8>, value: &T) {
    let start = out.len();
    // Writing into memory cannot fail, and every key of a report is a string. A failure would append nothing.
    match serde_json::to_writer(&mut *out, value) {
        Ok(()) => out.push(b'\n'),
        Err(_) => out.truncate(start),
    }
}
