//! Results as CSV: one row per outcome.

use crate::contact::Feet;
use crate::impact::{Family, Next};
use crate::pipeline::{AT_REST, Aspect};
use crate::read::table::{Carried, Header, prefixed};
use crate::state::NamedContact;
use crate::write::{Refused, Report, words};
use crate::{Error, Mode, Outcome, Reason, Result, Robot};
use serde_json::Value;
use std::collections::{HashMap, HashSet};

/// The columns between those that name the state and those of the contacts.
const FIRST: [&str; 4] = ["verdict", "outcome", "margin", "proven"];

/// With `next` these follow.
const NEXT: [&str; 2] = ["next_verdict", "next_modes"];

/// The columns of a touchdown, behind `touchdown_`; q and v before the impact follow, named as in a table of states.
const TOUCHDOWN: [&str; 6] = ["row", "time", "striking", "shift_z", "at", "touching"];

/// The last columns, behind all that the contract orders and the carried ones.
const LAST: [&str; 5] = ["border", "family", "families", "error", "notes"];

/// The columns of a table of results, fixed before its first row.
///
/// They are `id`, for a batch `line`, `verdict, outcome, margin, proven`, then `mode_<contact>, p_<contact>_t,
/// p_<contact>_n` for every contact that the robot's feet can make, `v_after_<coordinate>`, the `touchdown_...` columns
/// and `q_<coordinate>`, `v_<coordinate>` before the impact if touchdowns were requested, the columns copied from the
/// input, and `border`, `family`, `families`, `error`, `notes`. Outcomes are counted from 1; a state without outcome
/// has a row with these cells empty. A contact is named after its link if it is the only one there, so a link that can
/// touch at several points has columns of its own name and of link/0, link/1, ... A refused state has a row with the
/// verdict `refused`, its id and copied columns if they can be read, and its line and reason in `error`. A copied
/// column whose name the output already has gets the prefix `in_`. Forces have `f_<contact>_t, f_<contact>_n` for the
/// impulses and `a_<coordinate>` for the velocities after.
#[derive(Debug, Clone)]
pub struct Columns {
    names: Vec<String>,
    /// How many columns name the state.
    named: usize,
    /// Which contact has which three columns.
    contacts: HashMap<String, usize>,
    coordinates: usize,
    kind: RowKind,
    carried: usize,
    /// Whether it has columns for what follows an impact.
    next: bool,
    /// Whether cells of text are kept from being formulas.
    guarded: bool,
}

/// What a row of results is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowKind {
    /// A state of the input.
    State,
    /// A touchdown that was found in the input.
    Touchdown,
    /// A state in sustained contact.
    Forces,
}

impl RowKind {
    /// Of states of which this is asked.
    pub fn of(aspect: Aspect) -> Self {
        match aspect {
            Aspect::Impact => Self::State,
            Aspect::Forces => Self::Forces,
        }
    }
}

/// A row in the making; cells that are not set stay empty.
struct Cells(Vec<Vec<u8>>);

impl Cells {
    fn text(&mut self, at: usize, text: impl AsRef<[u8]>) {
        self.0[at] = text.as_ref().to_vec();
    }

    fn number(&mut self, at: usize, number: f64) {
        // The shortest digits that read back as the same number.
        self.text(at, format!("{number:?}"));
    }
}

impl Columns {
    /// The columns for states of `robot` with these `feet`, read from the table `input` or found in it.
    pub fn new(robot: &Robot, feet: &[NamedContact], input: Option<&Header>, kind: RowKind) -> Self {
        let through: Vec<&str> = input.into_iter().flat_map(Header::carried).collect();
        Self::with(robot, &["id", "line"], contacts(robot, feet, kind), &through, kind)
    }

    /// The columns for states that have no line, with columns of these names that are carried through, and for contacts
    /// that states name themselves.
    pub fn without_lines(
        robot: &Robot,
        feet: &[NamedContact],
        named: &[&str],
        through: &[&str],
        kind: RowKind,
    ) -> Self {
        let mut contacts = contacts(robot, feet, kind);
        for name in named {
            if !contacts.iter().any(|known| known == name) {
                contacts.push((*name).to_owned());
            }
        }
        Self::with(robot, &["id"], contacts, through, kind)
    }

    fn with(robot: &Robot, named: &[&str], contacts: Vec<String>, through: &[&str], kind: RowKind) -> Self {
        let mut names: Vec<String> = named.iter().chain(&FIRST).map(|name| (*name).to_owned()).collect();
        let [given, taken] = if kind == RowKind::Forces { ["f", "a"] } else { ["p", "v_after"] };
        for contact in &contacts {
            names.extend([format!("mode_{contact}"), format!("{given}_{contact}_t"), format!("{given}_{contact}_n")]);
        }
        names.extend(robot.coordinates().map(|name| format!("{taken}_{}", prefixed(robot, name))));
        if kind == RowKind::Touchdown {
            names.extend(TOUCHDOWN.map(|name| format!("touchdown_{name}")));
            let coordinates =
                |part: &'static str| robot.coordinates().map(move |name| format!("{part}_{}", prefixed(robot, name)));
            names.extend(coordinates("q").chain(coordinates("v")));
        }
        let own: HashSet<String> = names.iter().cloned().chain(LAST.map(str::to_owned)).collect();
        let taken: HashSet<&str> = through.iter().copied().collect();
        for column in through {
            let mut name = (*column).to_owned();
            while own.contains(&name) || (name != *column && taken.contains(name.as_str())) {
                name.insert_str(0, "in_");
            }
            names.push(name);
        }
        names.extend(LAST.map(str::to_owned));
        let contacts = contacts.into_iter().zip(0..).collect();
        let (named, carried) = (named.len(), through.len());
        Self { names, named, contacts, coordinates: robot.dofs(), kind, carried, next: false, guarded: false }
    }

    /// The same with columns `next_verdict` and `next_modes`, behind `proven`: the forces just after each outcome, in
    /// whose modes a contact that has left the ground is `open`.
    pub fn with_next(mut self) -> Self {
        let at = self.contacts_start();
        self.names.splice(at..at, NEXT.map(str::to_owned));
        Self { next: true, ..self }
    }

    /// The same with an apostrophe before every cell of text that a spreadsheet would take as a formula: one that
    /// begins with =, +, -, @, a tab or a carriage return. Numbers stay numbers.
    pub fn guarded(self) -> Self {
        Self { guarded: true, ..self }
    }

    /// The names of all columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The contacts that have columns, in their order.
    pub fn contacts(&self) -> impl Iterator<Item = &str> {
        let modes = self.names[self.contacts_start()..self.velocities()].iter().step_by(3);
        modes.filter_map(|name| name.strip_prefix("mode_"))
    }

    pub fn append_header(&self, out: &mut Vec<u8>) {
        self.append(&self.names, out);
    }

    /// Appends the rows of a result, one per outcome; nothing and an error if a contact has no column, because
    /// the state names it and the robot has no such foot.
    pub fn append_result(&self, report: &Report, carried: Option<&Carried>, out: &mut Vec<u8>) -> Result<()> {
        let mut cells = self.cells(report.id.as_deref(), report.line, carried);
        cells.text(self.named, report.verdict.map_or(String::new(), |verdict| verdict.to_string()));
        cells.text(self.named + 3, report.proven.map_or(String::new(), |proven| proven.to_string()));
        if let Some(touchdown) = report.touchdown.as_ref().filter(|_| self.kind == RowKind::Touchdown) {
            let start = self.velocities() + self.coordinates;
            cells.text(start, touchdown.row.to_string());
            cells.number(start + 1, touchdown.time);
            cells.text(start + 2, &*touchdown.striking);
            cells.number(start + 3, touchdown.shift_z);
            cells.text(start + 4, &*touchdown.at);
            cells.text(start + 5, &touchdown.touching);
            let coordinates = (start + TOUCHDOWN.len()..).zip(&touchdown.coordinates);
            coordinates.for_each(|(at, &number)| cells.number(at, number));
        }
        cells.text(self.last() + 3, report.error.as_ref().map_or(String::new(), ToString::to_string));
        cells.text(self.last() + 4, notes(&report.notes));
        let places = report.contacts.iter().map(|contact| self.place(&contact.name));
        let places: Vec<usize> = places.collect::<Result<_>>()?;
        let outcomes = report.outcomes.as_deref().unwrap_or_default();
        if outcomes.is_empty() {
            self.append(&cells.0, out);
        }
        for (at, outcome) in outcomes.iter().enumerate() {
            // Every outcome sets the same cells.
            self.outcome(at + 1, outcome, &places, &mut cells);
            cells.text(self.last() + 2, families(&report.families, at));
            self.append(&cells.0, out);
        }
        Ok(())
    }

    pub fn append_refused(&self, refused: &Refused, carried: Option<&Carried>, out: &mut Vec<u8>) {
        let error = format!("line {}: {}", refused.line, refused.error);
        self.append_error(self.cells(refused.id.as_ref(), Some(refused.line), carried), &error, out);
    }

    /// Appends the row of a state without an id that has an error in place of outcomes.
    pub fn append_unnamed(&self, error: &str, carried: &Carried, out: &mut Vec<u8>) {
        self.append_error(self.cells(None, None, Some(carried)), error, out);
    }

    fn append_error(&self, mut cells: Cells, error: &str, out: &mut Vec<u8>) {
        cells.text(self.named, "refused");
        cells.text(self.last() + 3, error);
        self.append(&cells.0, out);
    }

    /// A row with the id, the line and what is carried through.
    fn cells(&self, id: Option<&Value>, line: Option<usize>, carried: Option<&Carried>) -> Cells {
        let mut cells = Cells(vec![Vec::new(); self.names.len()]);
        cells.text(0, id.map_or(String::new(), words::id));
        if let Some(line) = line {
            cells.text(1, line.to_string());
        }
        let carried = carried.into_iter().flat_map(Carried::fields).take(self.carried);
        carried.zip(self.last() - self.carried..).for_each(|(field, at)| cells.text(at, field));
        cells
    }

    fn outcome(&self, number: usize, outcome: &Outcome, places: &[usize], cells: &mut Cells) {
        cells.text(self.named + 1, number.to_string());
        cells.text(self.named + 2, outcome.margin.map_or(String::new(), |margin| format!("{margin:?}")));
        cells.text(self.named + 3, outcome.proven.to_string());
        for ((&place, mode), impulse) in places.iter().zip(&outcome.modes).zip(&outcome.impulse) {
            cells.text(place, mode.to_string());
            impulse.iter().zip(place + 1..).for_each(|(&entry, at)| cells.number(at, entry));
        }
        if let Some(Next { verdict, modes, .. }) = outcome.next.as_ref().filter(|_| self.next) {
            let name = |mode: &Option<Mode>| mode.map_or_else(|| "open".to_owned(), |mode| mode.to_string());
            let modes = modes.iter().map(|own| own.iter().map(name).collect::<Vec<_>>().join("/"));
            cells.text(self.named + FIRST.len(), verdict.to_string());
            cells.text(self.named + FIRST.len() + 1, modes.collect::<Vec<_>>().join("; "));
        }
        let velocities = outcome.velocity().take(self.coordinates);
        velocities.zip(self.velocities()..).for_each(|(velocity, at)| cells.number(at, velocity));
        cells.text(self.last(), border(outcome));
        cells.text(self.last() + 1, outcome.family.to_string());
    }

    fn append<F: AsRef<[u8]>>(&self, fields: &[F], out: &mut Vec<u8>) {
        let mut writer = csv::WriterBuilder::new().buffer_capacity(1 << 10).from_writer(out);
        // Writing into memory cannot fail.
        for field in fields {
            let text = field.as_ref();
            let _ = match self.guarded && is_formula(text) {
                true => writer.write_field([b"'", text].concat()),
                false => writer.write_field(text),
            };
        }
        let _ = writer.write_record(None::<&[u8]>);
        let _ = writer.flush();
    }

    /// The first of the last columns.
    fn last(&self) -> usize {
        self.names.len() - LAST.len()
    }

    /// The first column of a velocity.
    fn velocities(&self) -> usize {
        self.contacts_start() + 3 * self.contacts.len()
    }

    /// The first column of a contact.
    fn contacts_start(&self) -> usize {
        self.named + FIRST.len() + if self.next { NEXT.len() } else { 0 }
    }

    /// The first of a contact's columns.
    fn place(&self, contact: &str) -> Result<usize> {
        self.contacts.get(contact).map(|at| self.contacts_start() + 3 * at).ok_or_else(|| no_column(contact))
    }
}

/// The names of all contacts that the feet can give: of a polygon two corners at once, of touchdowns all of them. A
/// link of several has its plain name as well, for when a single one of them touches.
fn contacts(robot: &Robot, feet: &[NamedContact], kind: RowKind) -> Vec<String> {
    let mut counts = vec![0; robot.links.len()];
    for foot in Feet::new(robot, feet).iter() {
        let corners = foot.outline.corners().len();
        counts[foot.link] += if kind == RowKind::Touchdown { corners } else { corners.min(2) };
    }
    let mut names = Vec::new();
    for (link, count) in robot.links.iter().zip(counts).filter(|&(_, count)| count > 0) {
        names.push(link.name.clone());
        if count > 1 {
            names.extend((0..count).map(|at| format!("{}/{at}", link.name)));
        }
    }
    names
}

/// Whether a spreadsheet would compute the text of a cell.
fn is_formula(text: &[u8]) -> bool {
    let is_number = || std::str::from_utf8(text).is_ok_and(|text| text.parse::<f64>().is_ok());
    matches!(text.first(), Some(b'=' | b'+' | b'-' | b'@' | b'\t' | b'\r')) && !is_number()
}

/// The refusal of a state with a contact that the robot's feet cannot make.
pub(super) fn no_column(contact: &str) -> Error {
    let reason = Reason::Unsupported(format!("the table of results has no columns for contact \"{contact}\""));
    Error::new(reason).hint("write NDJSON instead, or add the foot by `feet`")
}

/// What is zero on the border that an outcome is, as one cell.
pub(super) fn border(outcome: &Outcome) -> String {
    let at_zero = outcome.border.iter().flat_map(|border| &border.at_zero);
    at_zero.map(|zero| format!("{}: {}", zero.contact, zero.inequality)).collect::<Vec<_>>().join("; ")
}

/// The modes of the families that have outcome `at` as a corner, as one cell.
pub(super) fn families(families: &[Family], at: usize) -> String {
    let modes = |family: &Family| family.modes.iter().map(Mode::to_string).collect::<Vec<_>>().join("/");
    let of_outcome = families.iter().filter(|family| family.corners.contains(&at));
    of_outcome.map(modes).collect::<Vec<_>>().join("; ")
}

/// Notes as one cell.
pub(super) fn notes(notes: &[String]) -> String {
    notes.iter().map(|note| short(note)).collect::<Vec<_>>().join("; ")
}

/// A note without the speeds of a resting contact: in a walk every row has such a contact.
fn short(note: &str) -> &str {
    note.find(AT_REST).map_or(note, |end| &note[..end + AT_REST.len()])
}
