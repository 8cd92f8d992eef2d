//! Reads the rows of a table as states.

use super::header::{Header, SpatialColumns, TableColumn, short};
use super::records::{place_of, quoting_fault};
use crate::gait::spatial::{Spatial, project};
use crate::law::Friction;
use crate::robot::Base;
use crate::state::{ByLink, Defaults, Scene, State};
use crate::{Error, Reason, Result, Robot};
use csv::ByteRecord;
use serde_json::Value;
use std::borrow::Cow;
use std::io::Cursor;

/// Reads the rows of a table one record at a time, in memory that is reused.
#[derive(Debug)]
pub struct Rows<'h> {
    header: &'h Header,
    /// Of the bytes of one record after the other, so that one reader with its tables serves them all.
    reader: csv::Reader<Cursor<Vec<u8>>>,
    record: ByteRecord,
}

/// One record and its header.
#[derive(Debug, Clone, Copy)]
pub struct Row<'r> {
    header: &'r Header,
    record: &'r ByteRecord,
    raw: &'r [u8],
    line: usize,
}

/// The fields of a row to copy to the result, kept longer than their chunk.
#[derive(Debug, Clone, Default)]
pub struct Carried(ByteRecord);

impl Carried {
    pub fn new(fields: impl Iterator<Item = String>) -> Self {
        Self(fields.collect::<Vec<_>>().into())
    }

    /// The fields in the order of [`Header::carried`]; empty if the row could not be read.
    pub fn fields(&self) -> impl Iterator<Item = &[u8]> {
        self.0.iter()
    }

    /// The fields as text by column; bytes that are no UTF-8 are replaced.
    pub fn by_name<'c>(&'c self, header: &'c Header) -> impl Iterator<Item = (&'c str, Cow<'c, str>)> {
        header.carried().zip(self.0.iter().map(String::from_utf8_lossy))
    }
}

impl Header {
    /// A reader of the table's rows.
    pub fn rows(&self) -> Rows<'_> {
        Rows { header: self, reader: reader(), record: ByteRecord::new() }
    }
}

impl<'h> Rows<'h> {
    /// The row in `record`, which begins on `line` of the table and may end with a line break; `None` if it is blank. A
    /// quote that is not closed or followed by text is refused, and a line break outside of quotes.
    pub fn row<'r>(&'r mut self, record: &'r [u8], line: usize) -> Result<Option<Row<'r>>> {
        let raw = record.strip_suffix(b"\n").unwrap_or(record);
        let raw = raw.strip_suffix(b"\r").unwrap_or(raw);
        if raw.trim_ascii().is_empty() {
            return Ok(None);
        }
        let syntax = |reason: String| Error::new(Reason::Syntax(reason)).on(line, 1);
        if let Some((at, fault)) = quoting_fault(raw) {
            let error = refuse(self.header, raw, line, at, Reason::Syntax(fault.into()));
            return Err(error.hint("a cell in quotes ends with its closing quote; a quote inside it is written twice"));
        }
        let bytes = self.reader.get_mut();
        bytes.set_position(0);
        bytes.get_mut().clear();
        bytes.get_mut().extend_from_slice(raw);
        bytes.get_mut().push(b'\n');
        let start = self.reader.position().byte();
        let read = self.reader.read_byte_record(&mut self.record);
        if self.reader.position().byte() - start <= raw.len() as u64 {
            self.reader = reader();
            return Err(syntax("a line break of another kind stands in the row".into()));
        }
        read.map_err(|error| syntax(error.to_string()))?;
        Ok(Some(Row { header: self.header, record: &self.record, raw, line }))
    }
}

fn reader() -> csv::Reader<Cursor<Vec<u8>>> {
    csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(Cursor::default())
}

impl Row<'_> {
    /// The line on which the row begins, counted from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Its id, if it can be read.
    pub fn id(&self) -> Option<Value> {
        let text = std::str::from_utf8(self.record.get(self.header.place(TableColumn::Id)?)?).ok()?;
        (!text.is_empty()).then(|| Value::String(text.to_owned()))
    }

    /// The fields to copy to the result, if the row has as many as the header.
    pub fn carried(&self) -> Carried {
        if self.record.len() != self.header.columns.len() {
            return Carried::default();
        }
        Carried(self.header.places(TableColumn::Carried).filter_map(|at| self.record.get(at)).collect())
    }

    /// The time \[s\].
    pub fn time(&self) -> Result<f64> {
        let missing = || Error::new(Reason::Missing("a column \"time\"".into())).on(1, 1);
        self.number(self.header.time.ok_or_else(missing)?)
    }

    /// The state of `robot`; what the row and `defaults` leave open is 0, of the friction unknown. Its x is that of the
    /// table also where the base is given in three dimensions; along the heading it is put by
    /// [`crate::gait::sagittal`].
    ///
    /// # Errors
    /// A row with more or fewer fields than the header, a cell that does not hold what its column is for, a base that
    /// is both placed by a stance and given, an invalid quaternion. The error gives column, line and place.
    pub fn state(&self, robot: &Robot, defaults: &Defaults) -> Result<State> {
        let (fields, columns) = (self.record.len(), self.header.columns.len());
        if fields != columns {
            let plural = if fields == 1 { "" } else { "s" };
            let reason = Reason::Inconsistent(format!("the row has {fields} field{plural}, the header {columns}"));
            return Err(Error::new(reason).on(self.line, 1));
        }
        let stance = self.stance(robot)?;
        let place_lowest = defaults.place_lowest && stance.is_none();
        let scene = Scene { stance, place_lowest, loops: defaults.loops.clone(), ..Scene::default() };
        let mut state = State { id: self.id(), scene, ..State::zero(robot) };
        let mut friction = None;
        for (at, &column) in self.header.columns.iter().enumerate() {
            match column {
                TableColumn::Position(to @ 0..2) | TableColumn::Velocity(to @ 0..2) if stance.is_some() => {
                    self.placed_base(at, ["x", "z"][to])?
                }
                TableColumn::Sideways if stance.is_some() => self.placed_base(at, "y")?,
                TableColumn::Sideways | TableColumn::Quaternion(_) => drop(self.number(at)?),
                TableColumn::Position(to) => state.position[to] = self.number(at)?,
                TableColumn::Velocity(to) => state.velocity[to] = self.number(at)?,
                TableColumn::Friction => friction = self.given(at)?.map(|text| self.friction(at, text)).transpose()?,
                TableColumn::Restitution => {
                    if self.given(at)?.is_some() {
                        state.scene.restitution = ByLink::everywhere(self.restitution(at)?);
                    }
                }
                TableColumn::Id => drop(self.given(at)?),
                TableColumn::Stance | TableColumn::Carried | TableColumn::Ignored => {}
            }
        }
        if let Some((pitch, _)) = self.projected()? {
            state.position[2] = pitch;
        }
        state.scene.friction.default = friction.or(defaults.friction);
        Ok(state)
    }

    /// The part of a base in three dimensions that is not in the plane.
    pub fn spatial(&self) -> Result<Option<Spatial>> {
        Ok(self.projected()?.map(|(_, spatial)| spatial))
    }

    /// The pitch of a base in three dimensions, and the rest.
    fn projected(&self) -> Result<Option<(f64, Spatial)>> {
        let Some(SpatialColumns { origin, quaternion, plane }) = self.header.spatial else { return Ok(None) };
        // A stance leaves x and y open.
        let length = |at: Option<usize>| match at {
            Some(at) if self.given(at)?.is_some() => self.number(at),
            _ => Ok(0.0),
        };
        let origin = [length(origin[0])?, length(origin[1])?];
        let [w, x, y, z] = quaternion.map(|at| self.number(at));
        let (lines, column) = place_of(self.raw, quaternion[0]);
        let refused = |error: Error| error.at("q_base_qw").on(self.line + lines, column);
        project(origin, [w?, x?, y?, z?], plane).map(Some).map_err(refused)
    }

    fn stance(&self, robot: &Robot) -> Result<Option<usize>> {
        let Some(at) = self.header.place(TableColumn::Stance) else { return Ok(None) };
        let Some(name) = self.given(at)? else { return Ok(None) };
        if robot.base == Base::Fixed {
            let reason = "the robot is bolted to the world, a stance cannot place it".to_owned();
            let error = self.refuse(at, Reason::Inconsistent(reason));
            return Err(error.hint("leave it out, or give `base: floating`"));
        }
        let unknown = || {
            let known = robot.links.iter().map(|link| link.name.as_str());
            self.refuse(at, Reason::UnknownName { what: "link", name: short(name) }).did_you_mean(name, known)
        };
        robot.link(name).map(Some).ok_or_else(unknown)
    }

    /// Refuses a coordinate of the base that the stance already gives.
    fn placed_base(&self, at: usize, coordinate: &str) -> Result<()> {
        if self.given(at)?.is_none() {
            return Ok(());
        }
        let reason = Reason::Inconsistent(format!("the stance already gives the base's {coordinate}"));
        Err(self.refuse(at, reason).hint("empty either the stance's cell or the base's x and z"))
    }

    fn friction(&self, at: usize, text: &str) -> Result<Friction> {
        if text == "infinite" {
            return Ok(Friction::Infinite);
        }
        let value: f64 = text.parse().map_err(|_| {
            let reason = Reason::Syntax(format!("expected a number or infinite, found \"{}\"", short(text)));
            self.refuse(at, reason).did_you_mean(text, ["infinite"])
        })?;
        let what = "friction".to_owned();
        match value {
            0.0..=f64::MAX => Ok(Friction::Finite(value)),
            f64::INFINITY => Err(self.refuse(at, Reason::NotFinite { what, value }).hint("did you mean infinite?")),
            _ if value.is_nan() => Err(self.refuse(at, Reason::NotFinite { what, value })),
            _ => Err(self.refuse(at, Reason::OutOfRange { what, allowed: "0 or more", value })),
        }
    }

    fn restitution(&self, at: usize) -> Result<f64> {
        let value = self.number(at)?;
        if (0.0..=1.0).contains(&value) {
            return Ok(value);
        }
        Err(self.refuse(at, Reason::OutOfRange { what: "restitution".into(), allowed: "between 0 and 1", value }))
    }

    /// The number in a cell.
    fn number(&self, at: usize) -> Result<f64> {
        let Some(text) = self.given(at)? else {
            let reason = Reason::WrongKind { expected: "a number", found: "an empty cell" };
            return Err(self.refuse(at, reason).hint("write 0 where it is 0, or leave the column out"));
        };
        let value: f64 = text.parse().map_err(|_| {
            let error = self.refuse(at, Reason::Syntax(format!("expected a number, found \"{}\"", short(text))));
            if text.contains(',') { error.hint("write decimals with a point") } else { error }
        })?;
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.refuse(at, Reason::NotFinite { what: "a cell".into(), value }))
    }

    /// The text in a cell that is not empty.
    fn given(&self, at: usize) -> Result<Option<&str>> {
        let field = self.record.get(at).unwrap_or_default().trim_ascii();
        match std::str::from_utf8(field) {
            Ok(text) => Ok((!text.is_empty()).then_some(text)),
            Err(_) => Err(self.refuse(at, Reason::Syntax("the cell is not UTF-8".into()))),
        }
    }

    fn refuse(&self, at: usize, reason: Reason) -> Error {
        refuse(self.header, self.raw, self.line, at, reason)
    }
}

/// Refuses cell `at` of the record `raw`, which begins on `line`.
fn refuse(header: &Header, raw: &[u8], line: usize, at: usize, reason: Reason) -> Error {
    let (lines, column) = place_of(raw, at);
    let name = header.names.get(at).map_or("", String::as_str);
    Error::new(reason).at(short(name)).on(line + lines, column)
}
