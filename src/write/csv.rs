//! Results as tables with one row per outcome.

use crate::contact::Feet;
use crate::impact::{Analysis, CONTACT_LIMIT, Family, Next};
use crate::pipeline::robust::Robustness;
use crate::pipeline::{AT_REST, Aspect, Impact};
use crate::read::table::{Carried, Form, Header, in_columns};
use crate::state::NamedContact;
use crate::write::{Refused, Touchdown, words};
use crate::{Error, Mode, Outcome, Reason, Result, Robot};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::HashSet;
use std::ops::Range;

/// The columns between those that name the state and those of the contacts.
const FIRST: [&str; 4] = ["verdict", "outcome", "margin", "proven"];

/// Columns that are added by [`Layout::next`].
const NEXT: [&str; 2] = ["next_verdict", "next_modes"];

/// The columns of a touchdown, without their prefix `touchdown_`. q and v before the impact follow them.
const TOUCHDOWN: [&str; 6] = ["row", "time", "striking", "shift_z", "at", "touching"];

/// The last columns, after the carried ones (copied from the input). A brief table omits the first and the last.
const LAST: [&str; 5] = ["border", "family", "families", "error", "notes"];

/// The columns of a table of results, fixed before its first row.
///
/// The columns are, in this order:
///
/// * `id`, and for a batch `line`; `verdict, outcome, margin, proven`; with [`Layout::next`] `next_verdict, next_modes`
/// * `mode_<contact>, p_<contact>_t, p_<contact>_n` for every contact that the robot's feet can make, and
///   `v_after_<coordinate>`; with forces `f_<contact>_t, f_<contact>_n` and `a_<coordinate>` take their place
/// * if touchdowns were requested, the `touchdown_...` columns, and `q_<coordinate>`, `v_<coordinate>` before the
///   impact
/// * the columns copied from the input; a name that the output already has gets the prefix `in_`
/// * `border`, `family`, `families`, `error`, `notes`
///
/// Outcomes are counted from 1; a state without an outcome has one row in which their cells are empty. A link that can
/// touch at several points has columns of its own name, for a single contact, and of link/0, link/1, ... A refused
/// state has a row with the verdict `refused`, its id and copied columns if they can be read, and its line and reason
/// in `error`. A brief table omits impulses, velocities after, `border` and `notes`.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Columns {
    names: Vec<String>,
    kinds: Vec<Kind>,
    /// The number of columns that identify the state.
    named: usize,
    /// The contacts that have columns, in the order of the columns.
    contacts: Vec<String>,
    /// The indices of the columns of velocities, of which a brief table has none.
    velocities: Range<usize>,
    carried: Range<usize>,
    pub(super) layout: Layout,
    /// The Arrow schema of the carried columns and of the id, if they have types.
    #[cfg(feature = "columnar")]
    #[serde(skip)]
    types: Option<arrow_schema::SchemaRef>,
}

/// The type of a column's cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// Text.
    Text,
    /// Numbers with a fraction.
    Number,
    /// Whole numbers from 0 on.
    Integer,
    /// True or false.
    Boolean,
    /// The type of a column of the input that is carried through or has the ids, given by its number in [`Carried`].
    #[cfg(feature = "columnar")]
    Carried(usize),
}

/// Receives the rows of a table of results.
pub trait RowSink {
    /// A row that is being filled.
    type Row: Row;

    /// Appends the next row; `fill` sets each of its cells at most once.
    fn row(&mut self, columns: &Columns, fill: impl FnOnce(&mut Self::Row));
}

/// A row that is being filled; its cells are empty until they are set.
pub trait Row {
    /// Sets the cell of a column.
    fn set(&mut self, at: usize, cell: Cell<'_>);
}

/// The content of a cell.
#[derive(Debug, Clone, Copy)]
pub enum Cell<'c> {
    /// Text; an empty text leaves the cell empty.
    Text(&'c str),
    /// A number with a fraction.
    Number(f64),
    /// A whole number.
    Integer(i64),
    /// True or false.
    Boolean(bool),
    /// A carried cell, given by its number among them.
    Carried(&'c Carried, usize),
}

/// What the rows of a table of results contain, and how they are written.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Layout {
    /// Whether the states are asked about impacts or about forces.
    pub aspect: Aspect,
    /// Whether the states are touchdowns that were found in the input.
    pub touchdowns: bool,
    /// Whether `next_verdict` and `next_modes` follow `proven`. They are the forces just after each outcome; the mode
    /// of a contact that has left the ground is `open`.
    pub next: bool,
    /// Whether to leave out impulses, velocities after, `border` and `notes`.
    pub brief: bool,
    /// Whether to put an apostrophe before every text cell that a spreadsheet would read as a formula: one that begins
    /// with =, +, -, @, a tab or a carriage return. Numbers stay numbers.
    pub guarded: bool,
    /// The file format.
    pub form: Form,
}

impl Columns {
    /// Creates the columns for states of `robot` with these `feet`, read from the table `input` or found in it.
    pub fn new(robot: &Robot, feet: &[NamedContact], input: Option<&Header>, layout: Layout) -> Self {
        let through: Vec<_> = input.into_iter().flat_map(Header::carried).map(|name| (name, Kind::Text)).collect();
        let named = [("id", Kind::Text), ("line", Kind::Integer)];
        let columns = Self::with(robot, &named, contacts(robot, feet, layout), &through, layout);
        #[cfg(feature = "columnar")]
        let columns = columns.with_types(input);
        columns
    }

    /// Takes over the types of the input's carried columns, if the input has types.
    #[cfg(feature = "columnar")]
    fn with_types(mut self, input: Option<&Header>) -> Self {
        let Some(types) = input.and_then(|header| header.types.clone()) else { return self };
        self.carried.clone().zip(0..).for_each(|(at, which)| self.kinds[at] = Kind::Carried(which));
        if types.fields().len() > self.carried.len() && !self.layout.form.is_text() {
            self.kinds[0] = Kind::Carried(self.carried.len());
        }
        Self { types: Some(types), ..self }
    }

    /// Returns the Arrow field of a carried column or of the id. A dictionary becomes its values in Arrow's file, which
    /// holds one for all blocks, and where it has the ids, which all differ.
    #[cfg(feature = "columnar")]
    pub(super) fn carried_field(&self, which: usize) -> arrow_schema::Field {
        let field = self.types.as_ref().and_then(|types| types.fields().get(which));
        let field = field.map_or_else(
            || arrow_schema::Field::new("", arrow_schema::DataType::Null, true),
            |field| field.as_ref().clone(),
        );
        let is_plain = self.form() == Form::Arrow || which == self.carried.len();
        if is_plain { plain(field) } else { field }
    }

    /// Creates the columns for states without a line. `named` are contacts that the states name themselves, and
    /// `through` are the carried columns.
    pub fn without_lines(
        robot: &Robot,
        feet: &[NamedContact],
        named: &[&str],
        through: &[(&str, Kind)],
        layout: Layout,
    ) -> Self {
        let mut contacts = contacts(robot, feet, layout);
        for name in named {
            if !contacts.iter().any(|known| known == name) {
                contacts.push((*name).to_owned());
            }
        }
        Self::with(robot, &[("id", Kind::Text)], contacts, through, layout)
    }

    fn with(
        robot: &Robot,
        named: &[(&str, Kind)],
        contacts: Vec<String>,
        through: &[(&str, Kind)],
        layout: Layout,
    ) -> Self {
        use Kind::{Boolean, Integer, Number, Text};
        let Layout { aspect, touchdowns, next, brief, .. } = layout;
        let [given, taken] = if aspect == Aspect::Forces { ["f", "a"] } else { ["p", "v_after"] };
        let next = NEXT.into_iter().filter(|_| next).map(|name| (name, Text));
        let first = FIRST.into_iter().zip([Text, Integer, Number, Boolean]).chain(next);
        // Each column with whether a brief table keeps it.
        let columns = named.iter().copied().chain(first).map(|(name, kind)| (name.to_owned(), kind, true));
        let mut columns: Vec<(String, Kind, bool)> = columns.collect();
        let is_shown = |&(.., in_brief): &(String, Kind, bool)| in_brief || !brief;
        let count = |columns: &[_]| columns.iter().filter(|column| is_shown(column)).count();
        for contact in &contacts {
            columns.push((format!("mode_{contact}"), Text, true));
            columns.extend(["t", "n"].map(|entry| (format!("{given}_{contact}_{entry}"), Number, false)));
        }
        let coordinates = |part: &'static str, in_brief| {
            in_columns(robot).map(move |name| (format!("{part}_{name}"), Number, in_brief))
        };
        let start = count(&columns);
        columns.extend(coordinates(taken, false));
        let velocities = start..count(&columns);
        if touchdowns {
            let kinds = [Integer, Number, Text, Number, Text, Text];
            let touchdown = TOUCHDOWN.into_iter().zip(kinds);
            columns.extend(touchdown.map(|(name, kind)| (format!("touchdown_{name}"), kind, true)));
            columns.extend(coordinates("q", true).chain(coordinates("v", true)));
        }
        let names: HashSet<String> =
            columns.iter().map(|(name, ..)| name.clone()).chain(LAST.map(str::to_owned)).collect();
        let taken: HashSet<&str> = through.iter().map(|(name, _)| *name).collect();
        let start = count(&columns);
        for &(column, kind) in through {
            let mut name = column.to_owned();
            while names.contains(&name) || (name != column && taken.contains(name.as_str())) {
                name.insert_str(0, "in_");
            }
            columns.push((name, kind, true));
        }
        let last = LAST.into_iter().zip([Text, Boolean, Text, Text, Text]).zip([false, true, true, true, false]);
        columns.extend(last.map(|((name, kind), in_brief)| (name.to_owned(), kind, in_brief)));
        let (names, kinds) = columns.into_iter().filter(is_shown).map(|(name, kind, _)| (name, kind)).unzip();
        Self {
            names,
            kinds,
            named: named.len(),
            contacts,
            velocities,
            carried: start..start + through.len(),
            layout,
            #[cfg(feature = "columnar")]
            types: None,
        }
    }

    /// The file format.
    pub fn form(&self) -> Form {
        self.layout.form
    }

    /// The names of all columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The types of all columns.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// The contacts that have columns, in the order of the columns.
    pub fn contacts(&self) -> &[String] {
        &self.contacts
    }

    /// Appends the row of names.
    pub fn append_header(&self, out: &mut Vec<u8>) {
        out.row(self, |row| (0..).zip(&self.names).for_each(|(at, name)| row.set(at, Cell::Text(name))));
    }

    /// Appends the rows of a result, one per outcome, with the state's id, line and touchdown.
    ///
    /// # Errors
    /// Returns an error, and appends nothing, if the outcomes were refused, or if a contact has no column because the
    /// state names it and the robot has no foot of that name.
    pub fn append_result(
        &self,
        (id, line, touchdown): (Option<&Value>, Option<usize>, Option<&Touchdown>),
        impact: &Impact,
        carried: Option<&Carried>,
        out: &mut impl RowSink,
    ) -> Result<()> {
        let analysis = impact.analyzed()?;
        let mut places = [0; CONTACT_LIMIT];
        for (place, contact) in places.iter_mut().zip(&impact.contacts) {
            *place = self.place(&contact.name)?;
        }
        if analysis.outcomes.is_empty() {
            out.row(self, |row| {
                self.state((id, line, touchdown), (impact, analysis), carried, row);
                row.set(self.named + 3, Cell::Boolean(analysis.proven));
            });
        }
        for (at, outcome) in analysis.outcomes.iter().enumerate() {
            out.row(self, |row| {
                self.state((id, line, touchdown), (impact, analysis), carried, row);
                self.outcome(at + 1, outcome, &places, row);
                if !analysis.families.is_empty() {
                    row.set(self.family() + 1, Cell::Text(&families(&analysis.families, at)));
                }
            });
        }
        Ok(())
    }

    /// Appends the row of a refused state.
    pub fn append_refused(&self, refused: &Refused, carried: Option<&Carried>, out: &mut impl RowSink) {
        let error = format!("line {}: {}", refused.line, refused.error);
        self.append_error((refused.id.as_ref(), Some(refused.line), carried), &error, out);
    }

    /// Appends the row of a state whose outcomes were replaced by an error, with its id and line if it has them.
    pub fn append_error(
        &self,
        (id, line, carried): (Option<&Value>, Option<usize>, Option<&Carried>),
        error: &str,
        out: &mut impl RowSink,
    ) {
        out.row(self, |row| {
            self.name_state((id, line, carried), row);
            row.set(self.named, Cell::Text("refused"));
            row.set(self.family() + 2, Cell::Text(error));
        });
    }

    /// Sets the id, the line and the carried cells.
    fn name_state(&self, (id, line, carried): (Option<&Value>, Option<usize>, Option<&Carried>), row: &mut impl Row) {
        #[cfg(feature = "columnar")]
        if let (Kind::Carried(which), Some(carried)) = (self.kinds[0], carried) {
            row.set(0, Cell::Carried(carried, which));
        }
        if let (Kind::Text, Some(id)) = (self.kinds[0], id) {
            row.set(0, Cell::Text(&words::id(id)));
        }
        if let Some(line) = line {
            row.set(1, Cell::Integer(line as i64));
        }
        if let Some(carried) = carried {
            let places = self.carried.clone().zip(0..carried.len());
            places.for_each(|(at, which)| row.set(at, Cell::Carried(carried, which)));
        }
    }

    /// Sets the cells that are the same for all outcomes of a state.
    fn state(
        &self,
        (id, line, touchdown): (Option<&Value>, Option<usize>, Option<&Touchdown>),
        (impact, analysis): (&Impact, &Analysis),
        carried: Option<&Carried>,
        row: &mut impl Row,
    ) {
        self.name_state((id, line, carried), row);
        row.set(self.named, Cell::Text(analysis.verdict.name()));
        if let Some(touchdown) = touchdown.filter(|_| self.layout.touchdowns) {
            let Touchdown { row: line, time, striking, shift_z, at, touching, coordinates, .. } = touchdown;
            let (line, time, shift) = (Cell::Integer(*line as i64), Cell::Number(*time), Cell::Number(*shift_z));
            let found = [line, time, Cell::Text(striking), shift, Cell::Text(at), Cell::Text(touching)];
            let coordinates = coordinates.iter().map(|&number| Cell::Number(number));
            let cells = (self.velocities.end..).zip(found.into_iter().chain(coordinates));
            cells.for_each(|(at, cell)| row.set(at, cell));
        }
        if !self.layout.brief {
            row.set(self.family() + 3, Cell::Text(&notes(impact)));
        }
    }

    fn outcome(&self, count: usize, outcome: &Outcome, places: &[usize], row: &mut impl Row) {
        row.set(self.named + 1, Cell::Integer(count as i64));
        outcome.margin.into_iter().for_each(|margin| row.set(self.named + 2, Cell::Number(margin)));
        row.set(self.named + 3, Cell::Boolean(outcome.proven));
        for ((&place, mode), impulse) in places.iter().zip(&outcome.modes).zip(&outcome.impulse) {
            row.set(place, Cell::Text(mode.name()));
            // An undecided outcome has no known numbers.
            if outcome.decided && !self.layout.brief {
                impulse.iter().zip(place + 1..).for_each(|(&entry, at)| row.set(at, Cell::Number(entry)));
            }
        }
        if let Some(Next { verdict, modes, .. }) = outcome.next.as_ref().filter(|_| self.layout.next) {
            let name = |mode: &Option<Mode>| mode.map_or("open", Mode::name);
            let modes = modes.iter().map(|combination| combination.iter().map(name).collect::<Vec<_>>().join("/"));
            row.set(self.named + FIRST.len(), Cell::Text(verdict.name()));
            row.set(self.named + FIRST.len() + 1, Cell::Text(&modes.collect::<Vec<_>>().join("; ")));
        }
        if outcome.decided {
            let velocities = self.velocities.clone().zip(outcome.velocity());
            velocities.for_each(|(at, velocity)| row.set(at, Cell::Number(velocity)));
        }
        if !self.layout.brief {
            row.set(self.carried.end, Cell::Text(&border(outcome)));
        }
        row.set(self.family(), Cell::Boolean(outcome.family));
    }

    /// The index of the column `family`, which is one of the last columns.
    fn family(&self) -> usize {
        self.carried.end + usize::from(!self.layout.brief)
    }

    /// The index of the first column of `contact`.
    fn place(&self, contact: &str) -> Result<usize> {
        let at = self.contacts.iter().position(|known| known == contact).ok_or_else(|| no_column(contact))?;
        let of_contact = if self.layout.brief { 1 } else { 3 };
        Ok(self.velocities.start - of_contact * (self.contacts.len() - at))
    }
}

/// Returns the field with the values of dictionaries in place of these, also inside lists and structures.
#[cfg(feature = "columnar")]
fn plain(field: arrow_schema::Field) -> arrow_schema::Field {
    use arrow_schema::{DataType, FieldRef};
    let inner = |item: &FieldRef| FieldRef::new(plain(item.as_ref().clone()));
    let values = match field.data_type() {
        DataType::Dictionary(_, values) => return plain(field.clone().with_data_type(values.as_ref().clone())),
        DataType::List(item) => DataType::List(inner(item)),
        DataType::LargeList(item) => DataType::LargeList(inner(item)),
        DataType::FixedSizeList(item, size) => DataType::FixedSizeList(inner(item), *size),
        DataType::Map(item, is_sorted) => DataType::Map(inner(item), *is_sorted),
        DataType::Struct(fields) => DataType::Struct(fields.iter().map(inner).collect()),
        _ => return field,
    };
    field.with_data_type(values)
}

/// Returns the names of all contacts that the feet can make: two corners of a polygon at once, or with touchdowns all
/// corners. A link with several contacts also has its plain name, for states in which only one of them touches.
fn contacts(robot: &Robot, feet: &[NamedContact], layout: Layout) -> Vec<String> {
    let (mut counts, feet) = (vec![0; robot.links.len()], Feet::new(robot, feet));
    for foot in feet.iter() {
        let corners = foot.outline.corners().len();
        counts[foot.link] += if layout.touchdowns { corners } else { corners.min(2) };
    }
    let mut names = Vec::new();
    for (link, count) in robot.links.iter().zip(counts).filter(|&(_, count)| count > 0) {
        names.push(link.name.clone());
        if count > 1 {
            names.extend((0..count).map(|at| feet.numbered(&link.name, at)));
        }
    }
    names
}

/// Returns the refusal of a state with a contact that the robot's feet cannot make.
pub(super) fn no_column(contact: &str) -> Error {
    let reason = Reason::Unsupported(format!("the table of results has no columns for contact \"{contact}\""));
    Error::new(reason).hint("write NDJSON instead, or add the foot by `feet`")
}

/// Returns the inequalities that are zero on the outcome's border as one cell, empty without a border.
pub(super) fn border(outcome: &Outcome) -> String {
    let at_zero = outcome.border.iter().flat_map(|border| &border.at_zero);
    at_zero.map(|zero| format!("{}: {}", zero.contact, zero.inequality)).collect::<Vec<_>>().join("; ")
}

/// Returns the modes of the families that have outcome `at` as a corner, as one cell.
pub(super) fn families(families: &[Family], at: usize) -> String {
    let modes = |family: &Family| family.modes.iter().map(|mode| mode.name()).collect::<Vec<_>>().join("/");
    let of_outcome = families.iter().filter(|family| family.corners.contains(&at));
    of_outcome.map(modes).collect::<Vec<_>>().join("; ")
}

/// Returns the notes as one cell, with whether the outcomes hold on the state's box, and whether the budget ended.
pub(super) fn notes(impact: &Impact) -> String {
    let holds = impact.holds.as_ref().map(|holds| match holds {
        Robustness::Everywhere => "holds: true",
        Robustness::Not(_) => "holds: false",
        Robustness::Unknown => "holds: unknown",
    });
    let open = impact.analysis.as_ref().and_then(|analysis| analysis.open).filter(|open| open.beyond_budget);
    let open = open.map(|_| "the budget of work ended (`budget`)");
    impact.notes.iter().map(|note| short(note)).chain(holds).chain(open).collect::<Vec<_>>().join("; ")
}

/// Cuts the speeds from a note on a resting contact, because in a walk every row has that note.
fn short(note: &str) -> &str {
    memchr::memmem::find(note.as_bytes(), AT_REST.as_bytes()).map_or(note, |end| &note[..end + AT_REST.len()])
}
