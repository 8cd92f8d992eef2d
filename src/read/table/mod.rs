//! Reads states from tables: CSV, TSV, and flat lines of JSON; with the feature `columnar` also Parquet and Arrow.
//!
//! ```text
//! first record + Robot --[header]--> Header: the meaning of each column, resolved once
//!     record by record ----[rows]-----> Row --> State, id, time, carried columns
//! ```
//!
//! The first record names the columns: `id`, `q_base_x`, `q_base_z`, `q_base_pitch`, `q_<joint>`, the same with `v_`,
//! `friction` (a number or `infinite`), `restitution`, `stance` (a link) and `time`; a joint without a column is 0. All
//! other columns, and `time`, are copied to the results; a column that resembles a missing one is refused. An empty
//! cell is refused where a number belongs, because some programs write NaN as an empty cell. It means "not given" in
//! `id`, `friction`, `restitution` and `stance`. In a row with a stance the cells of `q_base_x`, `q_base_z`, `v_base_x`
//! and `v_base_z` must be empty. A base in three dimensions also has `q_base_y`, and a quaternion instead of the pitch
//! ([`crate::gait::spatial`]); its velocities are computed from the time.
//!
//! The row of a line is refused if it has a quote that is not closed, that closes before further text, or that contains
//! whole rows. The next line then begins the next row.

mod flat;
mod records;
mod resemblance;
#[cfg(feature = "columnar")]
mod types;
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
