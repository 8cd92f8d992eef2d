//! Reads the header of a table: the meaning of each column, resolved once against the robot.

use super::flat;
use super::records::{Form, Record};
use super::resemblance::{Compared, plain, without_one_of};
#[cfg(feature = "columnar")]
use super::types::content;
use crate::read::json::{fields_of, line_and_column};
use crate::robot::{Base, FreezeReason, Plane};
use crate::state::bolted;
use crate::{Error, Reason, Result, Robot};
use std::collections::HashSet;

/// The entries of a floating base in the order of q.
const BASE: [&str; 3] = ["base_x", "base_z", "base_pitch"];
/// The orientation of a base in three dimensions, instead of the pitch.
const QUATERNION: [&str; 4] = ["base_qw", "base_qx", "base_qy", "base_qz"];
/// The lateral position of a base in three dimensions.
const SIDEWAYS: &str = "base_y";

/// Where the velocities of a table come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rates {
    /// From columns `v_...`; a table without one is refused.
    #[default]
    Columns,
    /// From the positions over the `time` column; a table with columns `v_...` is refused.
    Time,
}

/// The names of columns other than coordinates.
const OTHERS: [(&str, TableColumn); 5] = [
    ("id", TableColumn::Id),
    ("friction", TableColumn::Friction),
    ("restitution", TableColumn::Restitution),
    ("stance", TableColumn::Stance),
    ("time", TableColumn::Carried),
];

/// The greatest number of columns of a table: each name is compared with those of all coordinates.
const COLUMN_LIMIT: usize = 100_000;

/// The columns of a table of states.
#[derive(Debug, Clone)]
pub struct Header {
    pub(crate) names: Vec<String>,
    pub(crate) columns: Vec<TableColumn>,
    foreign: Vec<String>,
    missing: Vec<String>,
    pub(crate) form: Form,
    /// The columns `id`, `stance` and `time`.
    pub(crate) id: Option<usize>,
    pub(crate) stance: Option<usize>,
    pub(crate) time: Option<usize>,
    pub(crate) spatial: Option<SpatialColumns>,
    /// For typed columns: the schema of the carried ones, and at its end that of the id, if there is one.
    #[cfg(feature = "columnar")]
    pub(crate) types: Option<arrow_schema::SchemaRef>,
}

/// The columns of a base in three dimensions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SpatialColumns {
    /// The columns of the origin's x and y.
    pub origin: [Option<usize>; 2],
    /// The columns of w, x, y and z.
    pub quaternion: [usize; 4],
    /// The robot's plane.
    pub plane: Plane,
}

/// The meaning of a column; coordinates are indices into q.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum TableColumn {
    Id,
    Position(usize),
    Velocity(usize),
    /// y of the origin of a base in three dimensions.
    Sideways,
    /// A component of the quaternion of a base in three dimensions, of w, x, y, z.
    Quaternion(usize),
    /// q or v of a joint that has no coordinate of its own.
    Ignored,
    Friction,
    Restitution,
    Stance,
    Carried,
}

impl Header {
    /// Reads the first record of a table, or the first line of lines of JSON. The columns named in `foreign` are
    /// carried through, whatever they resemble.
    ///
    /// # Errors
    /// Returns an error, with the column's place in `record` on line 1, for: a record that is not UTF-8 or names no
    /// coordinate; a repeated column; a coordinate that the robot does not have; an unread column that resembles a
    /// missing one; a base in three dimensions that is incomplete or also has a pitch; velocities that are missing or
    /// superfluous (see [`Rates`]).
    pub fn read(record: &[u8], form: Form, robot: &Robot, rates: Rates, foreign: &[String]) -> Result<Self> {
        let bytes = record.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(record);
        let record = Record { bytes, form };
        let names = if form == Form::Ndjson { flat::keys(bytes)? } else { names(record)? };
        Self::named(names, record, robot, rates, foreign)
    }

    /// Resolves names that were already read.
    pub(super) fn named(
        names: Vec<String>,
        record: Record,
        robot: &Robot,
        rates: Rates,
        foreign: &[String],
    ) -> Result<Self> {
        if names.len() > COLUMN_LIMIT {
            return Err(Error::new(Reason::TooMany { what: "columns", limit: COLUMN_LIMIT }).on(1, 1));
        }
        if let Some(absent) = foreign.iter().find(|name| !names.contains(name)) {
            let reason = Reason::Missing(format!("column \"{}\", given as foreign,", short(absent)));
            return Err(Error::new(reason).on(1, 1).did_you_mean(absent, names.iter().map(String::as_str)));
        }
        let mut columns = Vec::with_capacity(names.len());
        let mut seen = HashSet::new();
        // Without a coordinate, the line may be a row, in which numbers may repeat; [`Self::check`] refuses it.
        let is_row = !names.iter().any(|name| name.starts_with("q_") || name.starts_with("v_"));
        for (at, name) in names.iter().enumerate() {
            let column = match seen.insert(name.as_str()) || is_row && name.parse::<f64>().is_ok() {
                true if foreign.contains(name) => Ok(TableColumn::Carried),
                true => column(name, robot, &names),
                false => {
                    let twice = Error::new(Reason::Duplicate { what: "column", name: short(name) });
                    Err(if name.is_empty() { twice.hint("name every column") } else { twice })
                }
            };
            columns.push(column.map_err(|error| in_column(error, record, at, name))?);
        }
        let known = |wanted| columns.iter().position(|&column| column == wanted);
        let mut header = Self {
            id: known(TableColumn::Id),
            stance: known(TableColumn::Stance),
            time: names.iter().position(|name| name == "time"),
            names,
            columns,
            foreign: foreign.to_owned(),
            missing: Vec::new(),
            form: record.form,
            spatial: None,
            #[cfg(feature = "columnar")]
            types: None,
        };
        header.spatial = header.spatial(record, robot)?;
        header.missing = header.absent(robot, rates);
        header.check_foreign(record, robot)?;
        header.check(record, robot, rates)?;
        if header.stance.is_some() {
            let placed = ["q_base_x", "q_base_z", "v_base_x", "v_base_z"];
            header.missing.retain(|name| !placed.contains(&name.as_str()));
        }
        Ok(header)
    }

    /// Returns the names of the coordinates' columns that the table lacks: these are 0 in all states. The base's x and
    /// z are not among them if stances may give them, nor are velocities that are computed.
    pub fn missing(&self) -> &[String] {
        &self.missing
    }

    /// Returns the names of all columns of coordinates that the table could have but lacks.
    fn absent(&self, robot: &Robot, rates: Rates) -> Vec<String> {
        let absent = |prefix: &'static str, moving: fn(usize) -> TableColumn| {
            let absent = in_columns(robot).enumerate().filter(move |&(at, _)| self.place(moving(at)).is_none());
            absent.map(move |(at, name)| (at, format!("{prefix}{name}")))
        };
        // The quaternion gives the pitch.
        let positions = absent("q_", TableColumn::Position).filter(|(at, _)| self.spatial.is_none() || *at != 2);
        let velocities = absent("v_", TableColumn::Velocity).filter(|_| rates == Rates::Columns);
        let sideways = self.spatial.filter(|spatial| spatial.origin[1].is_none()).map(|_| format!("q_{SIDEWAYS}"));
        positions.chain(velocities).map(|(_, name)| name).chain(sideways).collect()
    }

    /// Refuses a carried column that is named like a field of a state or resembles a missing one, unless it is foreign.
    fn check_foreign(&self, record: Record, robot: &Robot) -> Result<()> {
        let mut without_columns = fields_of("State");
        without_columns.retain(|field| OTHERS.iter().all(|(other, _)| other != field));
        let coordinates = plain_coordinates(robot);
        if let Some(at) = self.unread().find(|&at| is_of_states(&self.names[at], &without_columns, &coordinates)) {
            let name = &self.names[at];
            let reason = format!("\"{}\" is a field of states, and tables have no column for it", short(name));
            let hint = format!("give the states as lines of JSON, or `foreign: {}` to copy the column", quoted(name));
            return Err(self.in_column(Error::new(Reason::Inconsistent(reason)).hint(hint), record, at));
        }
        let others = OTHERS.iter().map(|(name, _)| *name).filter(|name| !self.names.iter().any(|given| given == name));
        let missing = self.missing.iter().map(String::as_str).chain(others);
        let missing: Vec<(&str, Compared)> = missing.map(|name| (name, Compared::new(name))).collect();
        let resembling = self.unread().filter_map(|at| {
            let name = Compared::new(&self.names[at]);
            let mut near: Vec<_> = missing.iter().filter(|(_, missing)| name.resembles(missing)).collect();
            if let Some(&same) = near.iter().find(|(_, near)| near.plain == name.plain) {
                near = vec![same];
            }
            let near: Vec<&str> = near.into_iter().map(|(near, _)| *near).collect();
            (!near.is_empty()).then_some((at, short(&self.names[at]), near))
        });
        let resembling: Vec<(usize, String, Vec<&str>)> = resembling.collect();
        let Some((at, name, near)) = resembling.first() else { return Ok(()) };
        let reason = format!("\"{name}\" is not read, and the table lacks {}", near.join(" and "));
        let others = resembling[1..].iter().map(|(_, name, near)| format!("{} for {name}", near.join(" or ")));
        let others = few(others.collect());
        let also = if others.is_empty() { String::new() } else { format!(" also {others};") };
        let unit =
            if has_other_unit(&self.names[*at], &coordinates) { format!(" {OTHER_UNIT};") } else { String::new() };
        let hint = format!("did you mean {}?{also}{unit} if not, give `foreign: {}`", near.join("? or "), quoted(name));
        let error = Error::new(Reason::Inconsistent(reason)).hint(hint);
        Err(self.in_column(error, record, *at))
    }

    /// The columns that are copied without being named as foreign.
    fn unread(&self) -> impl Iterator<Item = usize> {
        self.places(TableColumn::Carried).filter(|&at| !self.is_foreign(&self.names[at]))
    }

    /// Returns the header, or an error without a line if a column is a joint's torque, on which forces depend.
    pub fn without_torques(self, robot: &Robot) -> Result<Self> {
        let coordinates = plain_coordinates(robot);
        let is_torque = |&at: &usize| is_of_coordinate(&self.names[at], &["torque", "tau", "effort"], &coordinates);
        let torques: Vec<usize> = self.unread().filter(is_torque).collect();
        let Some(first) = torques.first() else { return Ok(self) };
        let name = |&at: &usize| quoted(&self.names[at]);
        let reason = format!("{} is a torque, and tables have no column for it", name(first));
        let foreign = few(torques.iter().map(|at| format!("`foreign: {}`", name(at))).collect());
        let hint = format!("give the states as lines of JSON, or {foreign} to copy the columns");
        Err(Error::new(Reason::Inconsistent(reason)).hint(hint).at(format!("column {}", first + 1)))
    }

    /// Returns the number of columns.
    pub fn count(&self) -> usize {
        self.columns.len()
    }

    /// Returns the header, or an error without a line if there is no column `time`.
    pub fn with_time(self) -> Result<Self> {
        let hint = "touchdowns and velocities over time need that of each row: name its column time, in seconds";
        let missing = || Error::new(Reason::Missing("a column \"time\"".into())).hint(hint);
        self.time.ok_or_else(missing)?;
        #[cfg(feature = "columnar")]
        if let Some(types) = &self.types
            && let Some(time) = types.fields().iter().find(|field| field.name().trim() == "time")
            && let found @ ("dates" | "durations") = content(time.data_type())
        {
            let refused = Error::new(Reason::WrongKind { expected: "seconds", found }).at("time");
            return Err(refused.hint("convert the column to numbers"));
        }
        Ok(self)
    }

    /// Returns the header, or an error without a line if the base's height is missing, which touchdowns need.
    pub fn with_base(self) -> Result<Self> {
        if self.missing.iter().any(|name| name == "q_base_z") {
            let hint = "touchdowns are found by the heights of feet; without the base's, answer the rows themselves, by \
                        `place: lowest` or a column stance, without `touchdowns`";
            return Err(Error::new(Reason::Missing("the base's height, q_base_z,".into())).hint(hint));
        }
        Ok(self)
    }

    /// Returns whether the base is given in three dimensions; its motion must then be projected clip by clip
    /// ([`crate::gait::sagittal`]).
    pub fn is_spatial(&self) -> bool {
        self.spatial.is_some()
    }

    /// Returns the names of the columns that are not read because their joints have no coordinate.
    pub fn ignored(&self) -> impl Iterator<Item = &str> {
        self.places(TableColumn::Ignored).map(|at| self.names[at].as_str())
    }

    /// Returns the names of the columns that are copied to the results.
    pub fn carried(&self) -> impl Iterator<Item = &str> {
        self.places(TableColumn::Carried).map(|at| self.names[at].as_str())
    }

    /// Returns whether a column is copied to all results because it was named as foreign.
    pub fn is_foreign(&self, name: &str) -> bool {
        self.foreign.iter().any(|foreign| foreign == name)
    }

    /// Returns the columns of a kind.
    pub(super) fn places(&self, wanted: TableColumn) -> impl Iterator<Item = usize> {
        (0..self.columns.len()).filter(move |&at| self.columns[at] == wanted)
    }

    /// Returns the first column of a kind.
    pub(super) fn place(&self, wanted: TableColumn) -> Option<usize> {
        self.places(wanted).next()
    }

    /// Returns the columns of a base in three dimensions; `None` if the table has none.
    fn spatial(&self, record: Record, robot: &Robot) -> Result<Option<SpatialColumns>> {
        let components = [0, 1, 2, 3].map(|component| self.place(TableColumn::Quaternion(component)));
        let sideways = self.place(TableColumn::Sideways);
        let Some(first) = components.into_iter().flatten().chain(sideways).min() else { return Ok(None) };
        if let Some(missing) = components.iter().position(Option::is_none) {
            let missing = Error::new(Reason::Missing(format!("column q_{}", QUATERNION[missing])));
            let hint = "a base in three dimensions has all of q_base_qw, q_base_qx, q_base_qy, q_base_qz; one in the plane \
                        q_base_x, q_base_z, q_base_pitch alone";
            return Err(self.in_column(missing.hint(hint), record, first));
        }
        if let Some(pitch) = self.place(TableColumn::Position(2)) {
            let reason = Reason::Inconsistent("the base is turned by a quaternion, and by a pitch besides".into());
            return Err(self.in_column(Error::new(reason).hint("leave out the one or the other"), record, pitch));
        }
        let quaternion = components.map(Option::unwrap_or_default);
        let origin = [self.place(TableColumn::Position(0)), sideways];
        Ok(Some(SpatialColumns { origin, quaternion, plane: robot.reading.plane }))
    }

    fn in_column(&self, error: Error, record: Record, at: usize) -> Error {
        in_column(error, record, at, &self.names[at])
    }

    /// Refuses a table without what every state needs.
    fn check(&self, record: Record, robot: &Robot, rates: Rates) -> Result<()> {
        let first = |wanted: fn(&TableColumn) -> bool| self.columns.iter().position(wanted);
        let velocity = first(|column| matches!(column, TableColumn::Velocity(_)));
        let position = first(|column| matches!(column, TableColumn::Position(_) | TableColumn::Quaternion(_)));
        let missing = |what: &str, prefix: &str, hint: &str| {
            let example = in_columns(robot).next().unwrap_or("base_x".to_owned());
            Err(in_table(Reason::Missing(format!("a column of {what}, such as {prefix}{example},")), hint))
        };
        match (rates, velocity) {
            (_, None) if position.is_none() => {
                let known = few(self.missing.clone());
                let name = if self.form.is_text() { "the first line must name" } else { "name" };
                missing("positions", "q_", &format!("{name} the columns, of {known}"))
            }
            (_, Some(at)) if self.is_spatial() => Err(self.in_column(spatial_velocity(), record, at)),
            (Rates::Columns, None) if self.is_spatial() && self.time.is_some() => Err(in_table(
                Reason::Missing("a source of velocities".into()),
                "give `velocity: central` or backward: those of a base in three dimensions are taken from the time",
            )),
            (Rates::Columns, None) => {
                let hint = match self.time {
                    Some(_) => "add the columns, or give `velocity: central` or backward to take them from the time",
                    None => "add the columns; with a column time they can be computed",
                };
                missing("velocities", "v_", hint)
            }
            (Rates::Time, Some(at)) => {
                let reason = "the table has velocities, and they were to be computed from the time".to_owned();
                let error = Error::new(Reason::Inconsistent(reason));
                Err(self.in_column(error.hint("leave out `velocity`, or the columns v_..."), record, at))
            }
            (Rates::Time, None) if self.time.is_none() => Err(in_table(
                Reason::Missing("a column \"time\"".into()),
                "velocities are computed over the time; add the column, or columns v_...",
            )),
            _ => Ok(()),
        }
    }
}

/// Locates an error where column `at`, which has this name, begins in the first record.
fn in_column(error: Error, record: Record, at: usize, name: &str) -> Error {
    let (lines, column) = match record.form {
        Form::Ndjson => (0, flat::column_of(record.bytes, name, true)),
        _ => record.place_of(at, name),
    };
    error.at(format!("column {}", at + 1)).on(1 + lines, column)
}

/// Returns an error about the whole table.
fn in_table(reason: Reason, hint: &str) -> Error {
    Error::new(reason).on(1, 1).hint(hint)
}

/// Refuses velocities of a base in three dimensions: engines give them in the world's axes or the body's.
fn spatial_velocity() -> Error {
    let reason = "velocities of a robot whose base is in three dimensions are not read".to_owned();
    let hint = "leave out the columns v_..., and give `velocity: central` to take velocities from the time";
    Error::new(Reason::Unsupported(reason)).hint(hint)
}

/// Returns the names in the first record, without surrounding space.
fn names(record: Record) -> Result<Vec<String>> {
    let Record { bytes, form } = record;
    if let Some((at, fault)) = record.quoting_fault() {
        return Err(in_column(Error::new(Reason::Syntax(fault.into())), record, at, ""));
    }
    let mut reader = form.csv().from_reader(bytes);
    let mut fields = csv::ByteRecord::new();
    let read = reader.read_byte_record(&mut fields);
    if !read.map_err(|error| Error::new(Reason::Syntax(error.to_string())).on(1, 1))? {
        return Err(in_table(Reason::Missing("the line that names the columns".into()), "the table is empty"));
    }
    let end = usize::try_from(reader.position().byte()).unwrap_or(usize::MAX);
    if end < bytes.trim_ascii_end().len() {
        let (line, column) = line_and_column(bytes, end);
        let error = Error::new(Reason::Syntax("a line break that is not one of this table".into())).on(line, column);
        return Err(error.hint("save the table with line ends \\n or \\r\\n"));
    }
    let name = |(at, field): (usize, &[u8])| match std::str::from_utf8(field) {
        Ok(name) => Ok(name.trim().to_owned()),
        Err(_) => {
            let error = Error::new(Reason::Syntax("the column's name is not UTF-8".into()));
            Err(in_column(error.hint("save the table as UTF-8"), record, at, ""))
        }
    };
    let names: Vec<String> = fields.iter().enumerate().map(name).collect::<Result<_>>()?;
    match names.as_slice() {
        [only] if only.contains([';', if form == Form::Tsv { ',' } else { '\t' }]) => {
            let (by, remedy) = match form {
                Form::Tsv => ("other characters, not by tabs", "if these are commas, say `input_format: csv`"),
                _ if only.contains('\t') => ("tabs, not by commas", "say `input_format: tsv`"),
                _ => ("semicolons, not by commas", "save the table with commas between columns and points in numbers"),
            };
            Err(in_table(Reason::Syntax(format!("the columns are separated by {by}")), remedy))
        }
        [first, ..] if first.starts_with('{') => Err(in_table(
            Reason::Syntax("expected the names of the columns, found JSON".into()),
            "are these lines of JSON? then say `input_format: ndjson`",
        )),
        _ => Ok(names),
    }
}

/// Returns the meaning of the column `name`, one of `names`.
fn column(name: &str, robot: &Robot, names: &[String]) -> Result<TableColumn> {
    match name.split_at_checked(2) {
        Some(("q_", name)) => coordinate("q_", name, (robot, names), TableColumn::Position),
        Some(("v_", name)) => coordinate("v_", name, (robot, names), TableColumn::Velocity),
        _ => Ok(OTHERS.iter().find(|(other, _)| *other == name).map_or(TableColumn::Carried, |&(_, column)| column)),
    }
}

/// Returns whether a column is named like one of these fields of a state, or like an entry of one.
fn is_of_states(name: &str, fields: &[String], coordinates: &HashSet<String>) -> bool {
    let name = plain(name);
    let entry = |field: &str| name.strip_prefix(field)?.strip_prefix('_');
    let of_joint = |field: &&str| entry(field).is_some_and(|joint| coordinates.contains(joint));
    fields.contains(&name)
        || matches!(name.as_str(), "slope" | "ground_slope")
        || entry("gravity").is_some_and(|axis| matches!(axis, "x" | "y" | "z"))
        || ["held", "rotor_inertia"].iter().any(of_joint)
}

/// Returns whether a name consists of the name of one of the `coordinates` and one of the `words`.
fn is_of_coordinate(name: &str, words: &[&str], coordinates: &HashSet<String>) -> bool {
    without_one_of(&plain(name), words).iter().any(|rest| coordinates.contains(rest))
}

/// The remedy for a column in other units.
const OTHER_UNIT: &str = "numbers are in m, radians and s: convert the column, and give it the name of its coordinate";

/// Returns whether a name is that of one of the `coordinates`, and of a unit of which it is not.
fn has_other_unit(name: &str, coordinates: &HashSet<String>) -> bool {
    const UNITS: [&str; 10] = ["deg_s", "deg_per_s", "dps", "rpm", "mm", "mm_s", "mm_per_s", "cm", "cm_s", "cm_per_s"];
    let flat = plain(&name.replace(['[', '('], "_"));
    let coordinate = |unit: &&str| Some(flat.strip_suffix(unit)?.strip_suffix('_')?.trim_end_matches('_').to_owned());
    is_of_coordinate(name, &["deg", "degree", "degrees"], coordinates)
        || ["[deg", "(deg"].iter().any(|unit| name.contains(unit))
        || UNITS.iter().filter_map(coordinate).any(|coordinate| coordinates.contains(&coordinate))
}

/// Returns the names of the coordinates in the form in which [`plain`] compares them.
fn plain_coordinates(robot: &Robot) -> HashSet<String> {
    in_columns(robot).map(|name| plain(&name)).collect()
}

/// Returns a name as it is written in an option.
fn quoted(name: &str) -> String {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | '/');
    if name.chars().all(is_word) { name.to_owned() } else { format!("\"{name}\"") }
}

/// Returns the meaning of a coordinate's column: `moving` of the coordinate's index in q if the robot has it.
fn coordinate(
    prefix: &str,
    name: &str,
    (robot, names): (&Robot, &[String]),
    moving: fn(usize) -> TableColumn,
) -> Result<TableColumn> {
    if let Some(joint) = robot.joint(name).filter(|_| robot.base == Base::Fixed || !BASE.contains(&name)) {
        return Ok(moving(robot.base_dofs() + joint));
    }
    let in_base = BASE.iter().position(|entry| *entry == name);
    if let Some(at) = in_base.filter(|_| robot.base == Base::Floating) {
        return Ok(moving(at));
    }
    let in_space = QUATERNION.iter().position(|entry| *entry == name);
    let spatial = in_space.map(TableColumn::Quaternion).or((name == SIDEWAYS).then_some(TableColumn::Sideways));
    if robot.base == Base::Fixed && (in_base.is_some() || spatial.is_some()) {
        return Err(bolted("its base has no coordinates").hint("leave the column out, or give `base: floating`"));
    }
    if let Some(column) = spatial {
        return if prefix == "q_" { Ok(column) } else { Err(spatial_velocity()) };
    }
    match robot.frozen(name) {
        Some(held) if held.reason == FreezeReason::Base => {
            let reason = Reason::Inconsistent(format!("joint \"{}\" is {}", short(name), held.why()));
            let hint = format!("give {prefix}base_x, {prefix}base_z and {prefix}base_pitch");
            return Err(Error::new(reason).hint(hint));
        }
        Some(_) => return Ok(TableColumn::Ignored),
        None if robot.mimic_joints.iter().any(|mimic| mimic.joint.name == name) => return Ok(TableColumn::Ignored),
        None => {}
    }
    if prefix == "v_" && name.starts_with("after_") {
        let reason = Reason::Inconsistent("a velocity after an impact is not one of a state".into());
        let hint = format!("write results with `brief`, or give `foreign: {prefix}{}` to copy the column", short(name));
        return Err(Error::new(reason).hint(hint));
    }
    // Columns of frozen joints are accepted, too.
    let frozen = robot.reading.frozen.iter().map(|frozen| frozen.name.clone());
    let is_spatial = names.iter().any(|name| name.starts_with("q_base_q"));
    let in_space = QUATERNION.iter().filter(|_| prefix == "q_" && is_spatial).map(|known| (*known).to_owned());
    let mut known: Vec<String> =
        in_columns(robot).chain(in_space).chain(frozen).map(|known| format!("{prefix}{known}")).collect();
    known.retain(|known| !names.contains(known));
    let unknown = Error::new(Reason::UnknownName { what: "coordinate", name: short(name) });
    if has_other_unit(name, &plain_coordinates(robot)) {
        return Err(unknown.hint(OTHER_UNIT));
    }
    let name = short(name).replace("height", "z");
    Err(unknown.did_you_mean(&format!("{prefix}{name}"), known.iter().map(String::as_str)))
}

/// Returns the coordinates' names as they follow `q_` and `v_` in columns.
pub(crate) fn in_columns(robot: &Robot) -> impl Iterator<Item = String> {
    let of_base = |at| if at < robot.base_dofs() { "base_" } else { "" };
    robot.coordinates().enumerate().map(move |(at, name)| format!("{}{name}", of_base(at)))
}

/// Joins names, of which there may be many, for a message.
fn few(mut names: Vec<String>) -> String {
    const MOST: usize = 200;
    let mut room = MOST;
    let fits = |name: &String| room.checked_sub(name.len()).map(|left| room = left).is_some();
    let more = names.len() - names.iter().map(fits).take_while(|fits| *fits).count();
    if more > 0 {
        names.truncate(names.len() - more);
        names.push(format!("{more} more"));
    }
    names.join(", ")
}

/// Returns the beginning of a text that may be long, for a message.
pub(crate) fn short(text: &str) -> String {
    const MOST: usize = 60;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}
