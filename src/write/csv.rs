//! Results as CSV: one row per outcome.

use crate::contact::Feet;
use crate::read::table::{Carried, Header, prefixed};
use crate::state::NamedContact;
use crate::write::{Refused, Report, words};
use crate::{Error, Outcome, Reason, Result, Robot};
use serde_json::Value;
use std::collections::{HashMap, HashSet};

/// The columns before those of the contacts.
const FIRST: [&str; 5] = ["id", "verdict", "outcome", "margin", "proven"];

/// The columns of a touchdown, behind `touchdown_`.
const TOUCHDOWN: [&str; 6] = ["row", "time", "striking", "shift_z", "at", "touching"];

/// The last columns, behind all that the contract orders and the carried ones.
const LAST: [&str; 3] = ["border", "family", "error"];

/// The columns of a table of results, fixed before its first row.
///
/// They are `id, verdict, outcome, margin, proven`, then `mode_<contact>, p_<contact>_t, p_<contact>_n` for every
/// contact that the robot's feet can make, `v_<coordinate>` after the impact, the `touchdown_...` columns if touchdowns
/// were requested, the columns copied from the input, and `border`, `family`, `error`. Outcomes are counted from 1; a
/// state without outcome has a row with these cells empty. A contact is named after its link if it is the only one
/// there, so a link that can touch at several points has columns of its own name and of link/0, link/1, ... A refused
/// state has a row with the verdict `refused`, its id and copied columns if they can be read, and its line and reason
/// in `error`. A copied column whose name the output already has gets the prefix `in_`.
#[derive(Debug, Clone)]
pub struct Columns {
    names: Vec<String>,
    /// Which contact has which three columns.
    contacts: HashMap<String, usize>,
    coordinates: usize,
    touchdowns: bool,
    carried: usize,
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
    /// The columns for states of `robot` with these `feet`, read from the table `input` or found in it as `touchdowns`.
    pub fn new(robot: &Robot, feet: &[NamedContact], input: Option<&Header>, touchdowns: bool) -> Self {
        let through: Vec<&str> = input.into_iter().flat_map(Header::carried).collect();
        Self::with(robot, feet, &[], &through, touchdowns)
    }

    /// The same with columns of these names that are carried through, and for contacts that states name themselves.
    pub fn with(robot: &Robot, feet: &[NamedContact], named: &[&str], through: &[&str], touchdowns: bool) -> Self {
        let mut contacts = contacts(robot, feet, touchdowns);
        for name in named {
            if !contacts.iter().any(|known| known == name) {
                contacts.push((*name).to_owned());
            }
        }
        let mut names: Vec<String> = FIRST.map(str::to_owned).into();
        for contact in &contacts {
            names.extend([format!("mode_{contact}"), format!("p_{contact}_t"), format!("p_{contact}_n")]);
        }
        names.extend(robot.coordinates().map(|name| format!("v_{}", prefixed(robot, name))));
        if touchdowns {
            names.extend(TOUCHDOWN.map(|name| format!("touchdown_{name}")));
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
        Self { names, contacts, coordinates: robot.dofs(), touchdowns, carried: through.len() }
    }

    pub fn append_header(&self, out: &mut Vec<u8>) {
        append(&self.names, out);
    }

    /// Appends the rows of a result, one per outcome; nothing and an error if a contact has no column, because
    /// the state names it and the robot has no such foot.
    pub fn append_result(&self, report: &Report, carried: Option<&Carried>, out: &mut Vec<u8>) -> Result<()> {
        let mut cells = self.cells(report.id.as_deref(), carried);
        cells.text(1, report.verdict.map_or(String::new(), |verdict| verdict.to_string()));
        cells.text(4, report.proven.map_or(String::new(), |proven| proven.to_string()));
        if let Some(touchdown) = report.touchdown.as_ref().filter(|_| self.touchdowns) {
            let start = self.velocities() + self.coordinates;
            cells.text(start, touchdown.row.to_string());
            cells.number(start + 1, touchdown.time);
            cells.text(start + 2, &*touchdown.striking);
            cells.number(start + 3, touchdown.shift_z);
            cells.text(start + 4, &*touchdown.at);
            cells.text(start + 5, &touchdown.touching);
        }
        cells.text(self.last() + 2, report.error.as_ref().map_or(String::new(), ToString::to_string));
        let places = report.contacts.iter().map(|contact| self.place(&contact.name));
        let places: Vec<usize> = places.collect::<Result<_>>()?;
        let outcomes = report.outcomes.as_deref().unwrap_or_default();
        if outcomes.is_empty() {
            append(&cells.0, out);
        }
        for (at, outcome) in outcomes.iter().enumerate() {
            // Every outcome sets the same cells.
            self.outcome(at + 1, outcome, &places, &mut cells);
            append(&cells.0, out);
        }
        Ok(())
    }

    pub fn append_refused(&self, refused: &Refused, carried: Option<&Carried>, out: &mut Vec<u8>) {
        let error = format!("line {}: {}", refused.line, refused.error);
        self.append_error(refused.id.as_ref(), &error, carried, out);
    }

    /// Appends the row of a state that has an error in place of outcomes.
    pub fn append_error(&self, id: Option<&Value>, error: &str, carried: Option<&Carried>, out: &mut Vec<u8>) {
        let mut cells = self.cells(id, carried);
        cells.text(1, "refused");
        cells.text(self.last() + 2, error);
        append(&cells.0, out);
    }

    /// A row with the id and what is carried through.
    fn cells(&self, id: Option<&Value>, carried: Option<&Carried>) -> Cells {
        let mut cells = Cells(vec![Vec::new(); self.names.len()]);
        cells.text(0, id.map_or(String::new(), words::id));
        let carried = carried.into_iter().flat_map(Carried::fields).take(self.carried);
        carried.zip(self.last() - self.carried..).for_each(|(field, at)| cells.text(at, field));
        cells
    }

    fn outcome(&self, number: usize, outcome: &Outcome, places: &[usize], cells: &mut Cells) {
        cells.text(2, number.to_string());
        cells.text(3, outcome.margin.map_or(String::new(), |margin| format!("{margin:?}")));
        cells.text(4, outcome.proven.to_string());
        for ((&place, mode), impulse) in places.iter().zip(&outcome.modes).zip(&outcome.impulse) {
            cells.text(place, mode.to_string());
            impulse.iter().zip(place + 1..).for_each(|(&entry, at)| cells.number(at, entry));
        }
        let velocities = outcome.velocity().take(self.coordinates);
        velocities.zip(self.velocities()..).for_each(|(velocity, at)| cells.number(at, velocity));
        let at_zero = outcome.border.iter().flat_map(|border| &border.at_zero);
        let at_zero: Vec<String> = at_zero.map(|zero| format!("{}: {}", zero.contact, zero.inequality)).collect();
        cells.text(self.last(), at_zero.join("; "));
        cells.text(self.last() + 1, outcome.family.to_string());
    }

    /// The first of the last columns.
    fn last(&self) -> usize {
        self.names.len() - LAST.len()
    }

    /// The first column of a velocity.
    fn velocities(&self) -> usize {
        FIRST.len() + 3 * self.contacts.len()
    }

    /// The first of a contact's columns.
    fn place(&self, contact: &str) -> Result<usize> {
        self.contacts.get(contact).map(|at| FIRST.len() + 3 * at).ok_or_else(|| {
            let reason = Reason::Unsupported(format!("the table of results has no columns for contact \"{contact}\""));
            Error::new(reason).hint("write NDJSON instead, or add the foot by `feet`")
        })
    }
}

/// The names of all contacts that the feet can give: of a polygon two corners at once, with `every_corner` all of them.
/// A link of several has its plain name as well, for when a single one of them touches.
fn contacts(robot: &Robot, feet: &[NamedContact], every_corner: bool) -> Vec<String> {
    let mut counts = vec![0; robot.links.len()];
    for foot in Feet::new(robot, feet).iter() {
        let corners = foot.outline.corners().len();
        counts[foot.link] += if every_corner { corners } else { corners.min(2) };
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

fn append<F: AsRef<[u8]>>(fields: &[F], out: &mut Vec<u8>) {
    let mut writer = csv::WriterBuilder::new().buffer_capacity(1 << 10).from_writer(out);
    // Writing into memory cannot fail.
    let _ = writer.write_record(fields);
    let _ = writer.flush();
}
