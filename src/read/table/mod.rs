//! Reads states from tables: CSV, TSV, and lines of JSON that are flat.
//!
//! ```text
//!     first record + Robot --[header]--> Header: what each column is, resolved once
//!     record by record ----[rows]-----> Row --> State, id, time, carried columns
//! ```
//!
//! The first record names the columns: `id`, `q_base_x`, `q_base_z`, `q_base_pitch`, `q_<joint>`, the same with `v_`,
//! `friction` (a number or `infinite`), `restitution`, `stance` (a link) and `time`; a joint without a column is 0. All
//! others, and `time`, are copied to the results; one that resembles a missing column is refused. An empty cell is
//! refused where a number belongs, because some programs write NaN so. It means "not given" in `id`, `friction`,
//! `restitution` and `stance`. In a row with a stance the cells of `q_base_x`, `q_base_z`, `v_base_x` and `v_base_z`
//! must be empty. A base in three dimensions has also
//! `q_base_y`, and a quaternion instead of the pitch ([`crate::gait::spatial`]); its velocities come from the time.
//!
//! A quote that is not closed, is closed and followed by text, or has whole rows before its end refuses the row of its
//! line, and the next line begins the next row.

mod flat;
mod records;
mod header;
#[cfg(feature = "columnar")]
mod typed;
mod rows;
#[cfg(feature = "columnar")]
mod columns;

#[cfg(feature = "columnar")]
pub use columns::{Part, Parts};
pub use flat::is_flat;
pub(crate) use header::in_columns;
pub use header::{Header, Rates};
pub use records::{Form, Quotes, Quoting};
pub use rows::{Carried, CarriedValue, Row, Rows};
