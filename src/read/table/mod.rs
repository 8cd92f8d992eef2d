//! States and results as CSV.
//!
//! ```text
//!     first record + Robot --[header]--> Header: what each column is, resolved once
//!     record by record ----[rows]-----> Row --> State, id, time, carried columns
//!     Report --[columns]--> one row per outcome
//! ```
//!
//! # Input
//!
//! The first record names the columns: `id`, `q_base_x`, `q_base_z`, `q_base_pitch`, `q_<joint>`, the same with `v_`,
//! `friction` (a number or `infinite`), `restitution`, `stance` (a link) and `time`; a joint without a column is 0. All
//! others are carried through untouched, `time` too. An empty cell is refused where a number belongs, because programs write
//! NaN so; it means "not given" under `id`, `friction`, `restitution` and `stance`, and it must stand under `q_base_x`,
//! `q_base_z`, `v_base_x` and `v_base_z` in a row that has a stance. Lines without a field are skipped. An `id` is text.
//!
//! Of a base in three dimensions the columns are `q_base_x`, `q_base_y`, `q_base_z` and the quaternion `q_base_qw`,
//! `q_base_qx`, `q_base_qy`, `q_base_qz` in the place of a pitch ([`crate::gait::spatial`]); its velocities come from the time alone.
//! Columns of joints that have no coordinate of their own are not read and not carried through ([`Header::ignored`]).
//!
//! # Output
//!
//! `id, verdict, outcome, margin, proven`, then `mode_<contact>, p_<contact>_t, p_<contact>_n` for every contact that the
//! robot's feet can give, `v_<coordinate>` after the impact, where touchdowns were asked for
//! `touchdown_row, touchdown_time, touchdown_striking, touchdown_shift_z, touchdown_at, touchdown_touching`, the carried
//! columns, and `error`. Outcomes are counted from 1; a state without one has a row in which all about outcomes is empty. A link that can touch at one point
//! has the columns of its own name; one that can touch at several has those and link/0, link/1 ..., because a contact is
//! called by its link where it is alone. A refused state has a row with the verdict `refused`, its id and carried columns
//! where they can be read, and under `error` its line and what is wrong. A carried column whose name the output already has
//! is written with `in_` before it.
//!
//! Nothing here opens a file or starts a thread.

mod header;
mod records;
mod rows;

pub(crate) use header::prefixed;
pub use header::{Header, Rates};
pub use records::Quotes;
pub use rows::{Carried, Row, Rows};
