//! Reads the rows of a table as states.

use super::flat;
use super::header::{Header, SpatialColumns, TableColumn, short};
use super::records::{Cell, Form, Record};
#[cfg(feature = "columnar")]
use super::typed::Typed;
use crate::error::{Location, finite};
use crate::gait::spatial::{Spatial, project};
use crate::law::Friction;
use crate::read::json::{self, TOO_LARGE, id_in, id_of};
use crate::robot::Base;
use crate::state::{ByLink, Defaults, State, bolted, check_restitution};
use crate::{Error, Reason, Result, Robot};
#[cfg(feature = "columnar")]
use arrow_array::{Array, RecordBatch};
#[cfg(feature = "columnar")]
use arrow_cast::display::array_value_to_string;
#[cfg(feature = "columnar")]
use arrow_schema::DataType;
use csv::ByteRecord;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::{RawValue, to_raw_value};
use std::borrow::Cow;
use std::io::Cursor;
#[cfg(feature = "columnar")]
use std::sync::Arc;

/// Reads the rows of a table record by record, and reuses memory.
#[derive(Debug)]
pub struct Rows<'h> {
    header: &'h Header,
    /// Reads the bytes of one record after the other, so that its tables are built only once.
    reader: csv::Reader<Cursor<Vec<u8>>>,
    record: ByteRecord,
}

/// One record, with its header.
#[derive(Debug, Clone, Copy)]
pub struct Row<'r> {
    pub(super) header: &'r Header,
    pub(super) source: Source<'r>,
    pub(super) line: usize,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Source<'r> {
    /// Cells, and the bytes from which they were read.
    Text(&'r ByteRecord, &'r [u8]),
    /// Columns, and the row in them.
    #[cfg(feature = "columnar")]
    Columns(&'r Typed, usize),
}

/// The cells of a row that are copied to the result; they outlive the chunk of input.
#[derive(Debug, Clone)]
pub enum Carried {
    /// Cells of text.
    Text(ByteRecord),
    /// JSON values; an empty cell is null.
    Json(ByteRecord),
    /// Columns with types, and the row in them.
    #[cfg(feature = "columnar")]
    Columns(Arc<RecordBatch>, usize),
}

impl Carried {
    /// Creates cells of text.
    pub fn new(fields: impl Iterator<Item = String>) -> Self {
        Self::Text(fields.collect::<Vec<_>>().into())
    }

    /// Returns the number of cells, which are in the order of [`Header::carried`]. In columns with types, the id
    /// follows.
    pub fn len(&self) -> usize {
        match self {
            Self::Text(cells) | Self::Json(cells) => cells.len(),
            #[cfg(feature = "columnar")]
            Self::Columns(columns, _) => columns.num_columns(),
        }
    }

    /// Returns whether there are no cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns a cell as text.
    pub fn text(&self, which: usize) -> Cow<'_, [u8]> {
        match self {
            Self::Text(cells) => cells.get(which).unwrap_or_default().into(),
            Self::Json(cells) => match cells.get(which).unwrap_or_default() {
                cell @ [b'"', ..] => {
                    serde_json::from_slice(cell).map_or(cell.into(), |text: String| text.into_bytes().into())
                }
                cell => cell.into(),
            },
            #[cfg(feature = "columnar")]
            Self::Columns(columns, row) => {
                array_value_to_string(columns.column(which), *row).unwrap_or_default().into_bytes().into()
            }
        }
    }

    /// Returns a cell as a JSON value.
    fn value(&self, which: usize) -> CarriedValue {
        let string = |cell: &[u8]| String::from_utf8_lossy(cell).into_owned();
        let text = |cell: &[u8]| to_raw_value(&string(cell)).unwrap_or_default();
        // For some readers, carriage returns between values end lines.
        let json = |cell: &[u8]| RawValue::from_string(string(cell).replace('\r', " ")).unwrap_or_default();
        CarriedValue(match self {
            Self::Text(cells) => text(cells.get(which).unwrap_or_default()),
            Self::Json(cells) => json(cells.get(which).unwrap_or_default()),
            #[cfg(feature = "columnar")]
            Self::Columns(columns, row) => match self.text(which) {
                _ if columns.column(which).is_null(*row) => Box::default(),
                cell if is_json(columns.column(which).data_type()) => json(&cell),
                cell => text(&cell),
            },
        })
    }

    /// Returns the cells by column: text as text, with a replacement for what is not UTF-8, others unchanged.
    pub fn by_name<'c>(&'c self, header: &'c Header) -> impl Iterator<Item = (&'c str, CarriedValue)> {
        header.carried().zip((0..self.len()).map(|which| self.value(which)))
    }
}

/// A value that is copied to the result: JSON as it was in the input, or a cell of text as a string.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(transparent)]
pub struct CarriedValue(Box<RawValue>);

impl CarriedValue {
    /// Returns the number that the value is, or that its text contains.
    pub fn number(&self) -> Option<f64> {
        let text: Option<String> = serde_json::from_str(self.0.get()).ok();
        text.as_deref().unwrap_or(self.0.get()).trim().parse().ok()
    }
}

impl Header {
    /// Returns the id in a record that cannot be read as a row, if the record is JSON.
    pub fn id_in(&self, record: &[u8]) -> Option<Value> {
        str::from_utf8(record).ok().filter(|_| self.form == Form::Ndjson).and_then(id_in)
    }

    /// Creates a reader of the table's rows.
    pub fn rows(&self) -> Rows<'_> {
        Rows { header: self, reader: reader(self.form), record: ByteRecord::new() }
    }
}

impl<'h> Rows<'h> {
    /// Returns the row in `record`, which begins on `line` of the table and may end with a line break; `None` if it is
    /// blank. Refuses a quote that is not closed, text after a closing quote, and a line break outside of quotes.
    pub fn row<'r>(&'r mut self, record: &'r [u8], line: usize) -> Result<Option<Row<'r>>> {
        let raw = record.strip_suffix(b"\n").unwrap_or(record);
        let raw = raw.strip_suffix(b"\r").unwrap_or(raw);
        let quotes = self.header.form.quotes();
        if raw.iter().all(|&byte| quotes.is_blank(byte)) {
            return Ok(None);
        }
        if self.header.form == Form::Ndjson {
            let read = flat::read(raw, &self.header.names, &mut self.record);
            read.map_err(|error| error.relocated(|place| Location { line, ..place }))?;
            return Ok(Some(Row { header: self.header, source: Source::Text(&self.record, raw), line }));
        }
        if let Some((at, fault)) = (Record { bytes: raw, form: self.header.form }).quoting_fault() {
            let error = place(Error::new(Reason::Syntax(fault.into())), self.header, raw, line, at);
            return Err(error.hint("a cell in quotes ends with its closing quote; a quote inside it is written twice"));
        }
        let bytes = self.reader.get_mut();
        bytes.set_position(0);
        bytes.get_mut().clear();
        bytes.get_mut().extend_from_slice(raw);
        bytes.get_mut().push(b'\n');
        let start = self.reader.position().byte();
        let read = self.reader.read_byte_record(&mut self.record);
        let syntax = |reason: String| Error::new(Reason::Syntax(reason)).on(line, 1);
        if self.reader.position().byte() - start <= raw.len() as u64 {
            self.reader = reader(self.header.form);
            return Err(syntax("a line break of another kind stands in the row".into()));
        }
        read.map_err(|error| syntax(error.to_string()))?;
        Ok(Some(Row { header: self.header, source: Source::Text(&self.record, raw), line }))
    }
}

fn reader(form: Form) -> csv::Reader<Cursor<Vec<u8>>> {
    form.csv().from_reader(Cursor::default())
}

/// Returns whether values of this type are numbers or truth values in JSON.
#[cfg(feature = "columnar")]
fn is_json(data_type: &DataType) -> bool {
    match data_type {
        DataType::Dictionary(_, values) => is_json(values),
        _ => data_type.is_numeric() || *data_type == DataType::Boolean,
    }
}

impl Row<'_> {
    /// Returns the line on which the row begins, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Returns the row's id; `None` if it has none that can be read.
    pub fn id(&self) -> Option<Value> {
        let mut id = None;
        self.read_id(&mut id);
        id
    }

    /// Reads the id, in the memory of the id of another row.
    fn read_id(&self, id: &mut Option<Value>) {
        let Some(at) = self.header.id else { return *id = None };
        let text = match self.source {
            Source::Text(cells, _) => cells.get(at).and_then(|text| std::str::from_utf8(text).ok()),
            #[cfg(feature = "columnar")]
            Source::Columns(columns, row) => columns.text(at, row),
        };
        match (text, id.as_mut()) {
            (Some(""), _) => *id = None,
            (Some(text), _) if self.header.form == Form::Ndjson => *id = id_of(text),
            (Some(text), Some(Value::String(previous))) => text.clone_into(previous),
            (Some(text), _) => *id = Some(text.into()),
            (None, _) => {
                *id = None;
                #[cfg(feature = "columnar")]
                if let Source::Columns(columns, row) = self.source {
                    *id = columns.id(at, row);
                }
            }
        }
    }

    /// Returns the cells to copy to the result, if there are any and the row has as many fields as the header. Columns
    /// with types have the id at their end.
    pub fn carried(&self) -> Option<Carried> {
        let cells = match self.source {
            Source::Text(cells, _) if cells.len() == self.header.columns.len() => cells,
            Source::Text(..) => return None,
            #[cfg(feature = "columnar")]
            Source::Columns(columns, row) => return Some(Carried::Columns(columns.carried.clone()?, row)),
        };
        self.header.place(TableColumn::Carried)?;
        let cells = self.header.places(TableColumn::Carried).filter_map(|at| cells.get(at)).collect();
        Some(if self.header.form == Form::Ndjson { Carried::Json(cells) } else { Carried::Text(cells) })
    }

    /// Returns the time \[s\].
    pub fn time(&self) -> Result<f64> {
        let missing = || Error::new(Reason::Missing("a column \"time\"".into())).on(1, 1);
        self.number(self.header.time.ok_or_else(missing)?)
    }

    /// Returns the state of `robot`; what the row and `defaults` leave open is 0, except that friction stays unknown.
    /// If the base is given in three dimensions, x is that of the table until [`crate::gait::sagittal`] puts it along
    /// the heading.
    ///
    /// # Errors
    /// Returns an error with column, line and place for a row with more or fewer fields than the header, a cell that
    /// does not hold what its column is for, a base that is both placed by a stance and given, or an invalid
    /// quaternion.
    pub fn state(&self, robot: &Robot, defaults: &Defaults) -> Result<State> {
        let mut state = State::zero(robot);
        self.read(robot, defaults, &mut state).map(|()| state)
    }

    /// Reads the state into one that was only ever read from rows of this table.
    pub(crate) fn read(&self, robot: &Robot, defaults: &Defaults, state: &mut State) -> Result<()> {
        let columns = self.header.columns.len();
        if let Source::Text(cells, _) = self.source
            && cells.len() != columns
        {
            let fields = cells.len();
            let plural = if fields == 1 { "" } else { "s" };
            let reason = Reason::Inconsistent(format!("the row has {fields} field{plural}, the header {columns}"));
            return Err(Error::new(reason).on(self.line, 1));
        }
        let stance = self.stance(robot)?;
        let place_lowest = defaults.place_lowest && stance.is_none();
        self.read_id(&mut state.id);
        state.scene.restitution.default = None;
        (state.scene.stance, state.scene.place_lowest) = (stance, place_lowest);
        state.scene.loops.clone_from(&defaults.loops);
        if self.header.stance.is_some() {
            // Otherwise every row gives the same coordinates, and the others stay 0.
            state.position.fill(0.0);
            state.velocity.fill(0.0);
        }
        let mut friction = None;
        match self.source {
            Source::Text(..) => (0..columns).try_for_each(|at| self.read_cell(at, state, &mut friction))?,
            #[cfg(feature = "columnar")]
            Source::Columns(typed, row) => {
                typed.read(row, state);
                typed.open.iter().try_for_each(|&at| self.read_cell(at, state, &mut friction))?;
            }
        }
        if let Some((pitch, _)) = self.projected()? {
            state.position[2] = pitch;
        }
        state.scene.friction.default = friction.or(defaults.friction);
        Ok(())
    }

    /// Reads a cell according to its column.
    fn read_cell(&self, at: usize, state: &mut State, friction: &mut Option<Friction>) -> Result<()> {
        match self.header.columns[at] {
            TableColumn::Position(to @ 0..2) | TableColumn::Velocity(to @ 0..2) if state.scene.stance.is_some() => {
                self.placed_base(at, ["x", "z"][to])?
            }
            TableColumn::Sideways if state.scene.stance.is_some() => self.placed_base(at, "y")?,
            TableColumn::Sideways | TableColumn::Quaternion(_) => drop(self.number(at)?),
            TableColumn::Position(to) => state.position[to] = self.number(at)?,
            TableColumn::Velocity(to) => state.velocity[to] = self.number(at)?,
            TableColumn::Friction => *friction = self.friction(at)?,
            TableColumn::Restitution if self.is_given(at)? => {
                let value = check_restitution(self.number(at)?).map_err(|error| self.place(error, at))?;
                state.scene.restitution = ByLink::everywhere(value);
            }
            TableColumn::Id if state.id.is_none() && self.is_given(at)? => {
                let reason = Reason::WrongKind { expected: "a string or a number", found: "something else" };
                return Err(self.refuse(at, reason));
            }
            TableColumn::Restitution | TableColumn::Id | TableColumn::Stance => {}
            TableColumn::Carried | TableColumn::Ignored => {}
        }
        Ok(())
    }

    /// Returns the part of a base in three dimensions that is not in the plane.
    pub fn spatial(&self) -> Result<Option<Spatial>> {
        Ok(self.projected()?.map(|(_, spatial)| spatial))
    }

    /// Returns the pitch of a base in three dimensions, and its part outside of the plane.
    fn projected(&self) -> Result<Option<(f64, Spatial)>> {
        let Some(SpatialColumns { origin, quaternion, plane }) = self.header.spatial else { return Ok(None) };
        // With a stance, x and y may be empty.
        let length = |at: Option<usize>| match at {
            Some(at) if self.is_given(at)? => self.number(at),
            _ => Ok(0.0),
        };
        let origin = [length(origin[0])?, length(origin[1])?];
        let [w, x, y, z] = quaternion.map(|at| self.number(at));
        let refused = |error: Error| self.place(error, quaternion[0]);
        project(origin, [w?, x?, y?, z?], plane).map(Some).map_err(refused)
    }

    fn stance(&self, robot: &Robot) -> Result<Option<usize>> {
        let Some(at) = self.header.stance else { return Ok(None) };
        let name = match self.cell(at)? {
            Cell::Empty => return Ok(None),
            Cell::Text(name) => name,
            Cell::Number(_) => {
                return Err(self.refuse(at, Reason::WrongKind { expected: "a link's name", found: "a number" }));
            }
        };
        if robot.base == Base::Fixed {
            return Err(self.place(bolted("a stance cannot place it"), at));
        }
        let unknown = || {
            let known = robot.links.iter().map(|link| link.name.as_str());
            self.refuse(at, Reason::UnknownName { what: "link", name: short(&name) }).did_you_mean(&name, known)
        };
        robot.link(&name).map(Some).ok_or_else(unknown)
    }

    /// Refuses a coordinate of the base that the stance already gives.
    fn placed_base(&self, at: usize, coordinate: &str) -> Result<()> {
        if !self.is_given(at)? {
            return Ok(());
        }
        let reason = Reason::Inconsistent(format!("the stance already gives the base's {coordinate}"));
        Err(self.refuse(at, reason).hint("empty either the stance's cell or those of the base's x and z, q and v"))
    }

    fn friction(&self, at: usize) -> Result<Option<Friction>> {
        // Columns of numbers express infinite friction as an infinite number; digits that are infinite are a mistake.
        let (value, in_digits) = match self.cell(at)? {
            Cell::Empty => return Ok(None),
            Cell::Text(text) if text == "infinite" => return Ok(Some(Friction::Infinite)),
            Cell::Number(value) => (value, self.header.form == Form::Ndjson),
            Cell::Text(text) => match text.parse() {
                Ok(value) => (value, text.contains(|letter: char| letter.is_ascii_digit())),
                Err(_) => {
                    let reason = Reason::Syntax(format!("expected a number or infinite, found \"{}\"", short(&text)));
                    return Err(self.refuse(at, reason).did_you_mean(&text, ["infinite"]));
                }
            },
        };
        let what = || "friction".to_owned();
        match value {
            f64::INFINITY if in_digits => {
                Err(self.refuse(at, Reason::NotFinite { what: what(), value }).hint(TOO_LARGE))
            }
            0.0..=f64::INFINITY => Ok(Some(value.into())),
            _ if value.is_nan() => Err(self.refuse(at, Reason::NotFinite { what: what(), value })),
            _ => Err(self.refuse(at, Reason::OutOfRange { what: what(), allowed: "0 or more", value })),
        }
    }

    /// Returns the number in a cell, by a shortcut for numbers from typed columns.
    #[inline]
    fn number(&self, at: usize) -> Result<f64> {
        #[cfg(feature = "columnar")]
        if let Source::Columns(columns, row) = self.source
            && let Some(value) = columns.number(at, row)
            && value.is_finite()
        {
            return Ok(value);
        }
        self.checked_number(at)
    }

    /// Returns the number in a cell, or the reason why it holds none.
    fn checked_number(&self, at: usize) -> Result<f64> {
        let value: f64 = match self.cell(at)? {
            Cell::Empty => {
                let error = self.refuse(at, Reason::WrongKind { expected: "a number", found: "an empty cell" });
                let hint = "write 0 where it is 0, or leave out the column, or a row that was not recorded";
                return Err(error.hint(hint));
            }
            Cell::Number(value) => value,
            Cell::Text(text) if self.header.form == Form::Ndjson => {
                let error = self.refuse(at, Reason::WrongKind { expected: "a number", found: "a string" });
                return Err(if is_number(&text) { error.hint("leave out the quotes") } else { error });
            }
            Cell::Text(text) => text.parse().map_err(|_| {
                let error = self.refuse(at, Reason::Syntax(format!("expected a number, found \"{}\"", short(&text))));
                match (text.find('.'), text.rfind(',')) {
                    (None, Some(_)) => error.hint("write decimals with a point"),
                    (Some(point), Some(comma)) if comma < point && is_number(&text.replace(',', "")) => {
                        error.hint("leave out the commas between thousands")
                    }
                    (Some(_), Some(_)) if is_number(&text.replace('.', "").replace(',', ".")) => {
                        error.hint("write decimals with a point, and nothing between thousands")
                    }
                    _ => error,
                }
            })?,
        };
        finite(value, || "a cell".into()).map_err(|error| self.place(error, at))
    }

    /// Returns whether a cell is not empty.
    fn is_given(&self, at: usize) -> Result<bool> {
        Ok(!matches!(self.cell(at)?, Cell::Empty))
    }

    fn cell(&self, at: usize) -> Result<Cell<'_>> {
        let field = match self.source {
            Source::Text(cells, _) => cells.get(at).unwrap_or_default().trim_ascii(),
            #[cfg(feature = "columnar")]
            Source::Columns(columns, row) => return Ok(columns.cell(at, row)),
        };
        let Ok(text) = std::str::from_utf8(field) else {
            return Err(self.refuse(at, Reason::Syntax("the cell is not UTF-8".into())));
        };
        Ok(match (self.header.form, field.first()) {
            (_, None) => Cell::Empty,
            (Form::Ndjson, Some(b'"')) => Cell::Text(serde_json::from_str(text).unwrap_or_default()),
            (Form::Ndjson, Some(b'-' | b'0'..=b'9')) => Cell::Number(text.parse().unwrap_or(f64::NAN)),
            (Form::Ndjson, _) => {
                let found = json::Value::parse(text).map_or("something else", |value| value.kind());
                return Err(self.refuse(at, Reason::WrongKind { expected: "a string or a number", found }));
            }
            _ => Cell::Text(text.into()),
        })
    }

    fn refuse(&self, at: usize, reason: Reason) -> Error {
        self.place(Error::new(reason), at)
    }

    /// Locates an error where cell `at` begins.
    fn place(&self, error: Error, at: usize) -> Error {
        let raw = match self.source {
            Source::Text(_, raw) => raw,
            #[cfg(feature = "columnar")]
            Source::Columns(..) => b"",
        };
        place(error, self.header, raw, self.line, at)
    }
}

fn is_number(text: &str) -> bool {
    text.trim().parse::<f64>().is_ok()
}

/// Locates an error where cell `at` of the record `raw` begins; the record begins on `line`.
fn place(error: Error, header: &Header, raw: &[u8], line: usize, at: usize) -> Error {
    let name = header.names.get(at).map_or("", String::as_str);
    let (lines, column) = Record { bytes: raw, form: header.form }.place_of(at, name);
    error.at(short(name)).on(line + lines, column)
}
