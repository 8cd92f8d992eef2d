//! A result as text: the contacts, every outcome, and why nothing else happens.

mod outcome;
mod reasons;

use self::outcome::graded;
use super::result::{ContactRecord, NearestRecord, Report};
use super::state::HoldsRecord;
use super::table::{Table, is_residue, number, scale};
use super::words::Wording;
use super::{Detail, Palette, words};
use crate::contact::Feet;
use crate::error::visible;
use crate::impact::{Analysis, ImpulseRegion, Verdict};
use crate::pipeline::Aspect;
use crate::planar::{Pair, Vector};
use crate::read::Problem;
use crate::{Friction, Impact, Mode, Robot, State};
use std::fmt::Write;

/// The room for the list of what was left out, in characters.
const LEFT_OUT: usize = 200;

/// What the text of a report needs in addition to the report.
#[derive(Debug)]
pub struct Subject<'a> {
    /// The title of the text, as in `ramone`.
    title: String,
    /// The robot's size \[m\]; 0 without one.
    size: f64,
    /// Friction of each contact, where it is known.
    friction: Vec<Option<Friction>>,
    /// The unit of each entry of v.
    units: Vec<&'static str>,
    analysis: Option<&'a Analysis>,
    wording: &'static Wording,
}

impl<'a> Subject<'a> {
    /// Creates the subject of a report on a state of a robot.
    pub fn of_state(robot: &Robot, state: &State, impact: &'a Impact) -> Self {
        let unit = |(_, unit): (_, &'static str)| match (impact.aspect(), unit.starts_with('m')) {
            (Aspect::Impact, _) => unit,
            (Aspect::Forces, true) => "m/s^2",
            (Aspect::Forces, false) => "rad/s^2",
        };
        Self {
            title: words::titled(&robot.name, &state.id),
            size: Feet::new(robot, &[]).size(),
            friction: impact.contacts.iter().map(|contact| state.scene.friction.of(contact.link)).collect(),
            units: robot.units().map(unit).collect(),
            analysis: impact.analysis.as_ref(),
            wording: Wording::of(impact.aspect()),
        }
    }

    /// Creates the subject of a report on a contact problem given as matrices.
    pub fn of_problem(problem: &Problem, analysis: &'a Analysis) -> Self {
        Self {
            title: words::titled("contact problem", &problem.id),
            size: 0.0,
            friction: problem.contact.friction().map(Some).collect(),
            units: Vec::new(),
            analysis: Some(analysis),
            wording: Wording::of(Aspect::Impact),
        }
    }
}

/// Returns the report as text that ends with a line break.
pub fn text(report: &Report, subject: &Subject, detail: Detail, palette: &Palette) -> String {
    let mut writer = Writer { out: String::new(), report, subject, palette };
    // Writing into a string cannot fail.
    let _ = writer.write(detail);
    writer.out
}

struct Writer<'w> {
    out: String,
    report: &'w Report<'w>,
    subject: &'w Subject<'w>,
    palette: &'w Palette,
}

impl<'w> Writer<'w> {
    fn write(&mut self, detail: Detail) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *self.palette;
        writeln!(self.out, "{strong}{}{plain}: {}", self.subject.title, touching(&self.report.contacts))?;
        if let Some(energy) = self.report.kinetic_energy {
            writeln!(self.out, "{}: {} J.", self.subject.wording.energy, number(energy))?;
        }
        if !detail.brief && !self.report.contacts.is_empty() {
            self.out.push('\n');
            self.contacts();
        }
        self.out.push('\n');
        self.verdict()?;
        let outcomes = self.report.outcomes.as_deref().unwrap_or_default();
        if detail.brief {
            for (at, outcome) in outcomes.iter().enumerate().filter(|(_, outcome)| !outcome.modes.is_empty()) {
                let border = if outcome.border.is_some() { ", on a border" } else { "" };
                let family = if outcome.family { ", a corner of a family" } else { "" };
                let open = if outcome.decided { "" } else { ", not excluded" };
                let words = self.in_words(&outcome.modes);
                writeln!(self.out, "  {}  {words}{open}{border}{family}{}", at + 1, graded(outcome))?;
                self.next(outcome)?;
            }
            self.families()?;
            return self.notes();
        }
        for (at, outcome) in outcomes.iter().enumerate() {
            self.outcome(at + 1, outcome)?;
        }
        self.families()?;
        self.velocities(outcomes);
        self.torques();
        self.why_nothing_else(outcomes)?;
        self.rejected()?;
        self.regions();
        self.matrices()?;
        self.closing()
    }

    fn names(&self) -> impl Iterator<Item = &'w str> + use<'w> {
        self.report.contacts.iter().map(|contact| &*contact.name)
    }

    /// The greatest contact velocity before or after the impact; with forces, the greatest contact acceleration.
    fn speeds(&self) -> f64 {
        let before = self.report.contacts.iter().map(|contact| contact.velocity_before);
        let before = before.filter(|_| self.report.sustained.is_none()).chain(self.free().copied());
        let outcomes = self.report.outcomes.as_deref().unwrap_or_default().iter();
        scale(before.chain(outcomes.flat_map(|outcome| outcome.velocity_after.iter().copied())).flatten())
    }

    /// The contacts' accelerations without contact forces; empty for an impact.
    fn free(&self) -> impl Iterator<Item = &'w Pair<f64>> + use<'w> {
        self.report.sustained.iter().flat_map(|(_, free)| *free)
    }

    fn contacts(&mut self) {
        let contacts = &self.report.contacts;
        let mut table = Table::default().text("contact", self.names());
        let points = || contacts.iter().map(|contact| contact.point.map(Vector::components));
        // With the robot's size: a point may lie at the origin, up to rounding and the residue of closed loops.
        let lengths = scale(points().flatten().flatten()).max(10.0 * self.subject.size);
        if points().all(|point| point.is_some()) {
            table = table.pairs(["x [m]", "z [m]"], lengths, points());
        }
        let gaps = || contacts.iter().map(|contact| contact.gap);
        if gaps().flatten().any(|gap| gap != 0.0 && !is_residue(gap, lengths)) {
            table = table.numbers("gap [m]", lengths, gaps());
        }
        // On a profile the normals of the contacts may differ.
        let normals = || contacts.iter().map(|contact| contact.normal.map(Vector::components));
        if normals().any(|normal| Some(normal) != normals().next()) {
            table = table.pairs(["n: x", "z"], 1.0, normals());
        }
        let before = || contacts.iter().map(|contact| contact.velocity_before);
        let friction = self.subject.friction.iter().map(|friction| friction.map_or("-".into(), |mu| mu.to_string()));
        table = match self.report.sustained {
            None => table.pairs(self.subject.wording.before, self.speeds(), before()),
            Some(_) => table.pairs(self.subject.wording.before, scale(before().flatten()), before()).pairs(
                ["unforced: t [m/s^2]", "n [m/s^2]"],
                self.speeds(),
                self.free().copied(),
            ),
        };
        table.text("friction", friction.collect::<Vec<String>>()).write(&mut self.out);
        let Palette { faint, plain, .. } = *self.palette;
        self.out.extend(["  ", faint, "t: along the ground, forward; n: away from the ground", plain, "\n"]);
    }

    fn verdict(&mut self) -> std::fmt::Result {
        let Palette { strong, plain, .. } = *self.palette;
        let sentence = match (self.report.verdict, &self.report.outcomes) {
            (Some(Verdict::None), _) if self.report.sustained.is_some() => self.no_forces(),
            (Some(verdict), Some(outcomes)) => {
                self.subject.wording.verdict(verdict, outcomes, self.report.open.as_ref())
            }
            _ => "No outcomes are known.".to_owned(),
        };
        writeln!(self.out, "{strong}{sentence}{plain}")?;
        if let Some(error) = &self.report.error {
            writeln!(self.out, "{}", error.message)?;
        }
        self.holds()
    }

    /// Returns the sentence for the verdict `none` of forces, with the outcomes of the impact by which velocities jump.
    fn no_forces(&self) -> String {
        let sentence = format!("{}, by an impact without approach", words::NO_FORCES);
        match self.report.sustained.and_then(|(sustained, _)| sustained.shock.as_deref()) {
            None => format!("{sentence} whose outcomes are not decided."),
            Some([]) => format!("{sentence}, for which there is none with an impulse, either."),
            Some(shock) => format!("{sentence}: {}.", self.alternatives(shock.iter().map(|outcome| &outcome.modes))),
        }
    }

    fn holds(&mut self) -> std::fmt::Result {
        let Some(HoldsRecord(holds)) = self.report.holds else { return Ok(()) };
        let answer = match (holds, &self.report.counterexample) {
            (Some(true), _) => "yes".to_owned(),
            (Some(false), Some(other)) => {
                format!("no; a state in it (`format: json`) has: {}", self.alternatives(other.outcomes.iter()))
            }
            (Some(false), None) => "no".to_owned(),
            (None, _) => "unknown".to_owned(),
        };
        writeln!(self.out, "Holds on the whole box of the uncertainty: {answer}.")
    }

    /// Writes beta, gamma and region of each contact (paper section 4).
    fn regions(&mut self) {
        if let Some(Some(explained)) = &self.report.explain {
            self.out.push_str("\nWith infinite friction, while all other contacts stick:\n");
            Table::default()
                .text("contact", self.names())
                .numbers("beta [rad]", 1.0, explained.beta.iter().copied())
                .numbers("gamma [rad]", 1.0, explained.gamma.iter().copied())
                .text("region", explained.region.iter().map(|region| described(*region)))
                .write(&mut self.out);
        } else if self.report.explain.is_some() && !self.report.contacts.is_empty() {
            self.out.push_str("\nNo beta, gamma and region: the contacts depend on each other.\n");
        }
    }

    fn matrices(&mut self) -> std::fmt::Result {
        if let Some(coordinates) = &self.report.coordinates {
            writeln!(self.out, "\ncoordinates: {}", visible(&coordinates.join(", ")))?;
        }
        let matrices = [
            ("mass matrix", &self.report.mass_matrix),
            ("contact Jacobian, rows t and n per contact", &self.report.contact_jacobian),
            ("Delassus matrix, rows and columns t and n per contact", &self.report.delassus),
        ];
        for (name, matrix) in matrices {
            let Some(rows) = matrix.as_deref().filter(|rows| !rows.is_empty()) else { continue };
            writeln!(self.out, "\n{name}")?;
            Table::matrix(rows).write(&mut self.out);
        }
        Ok(())
    }

    /// Writes what else a reader should know before trusting the answer.
    fn closing(&mut self) -> std::fmt::Result {
        if (self.report.explain.is_some() || self.report.delassus.is_some()) && self.report.verdict.is_some() {
            self.out.push('\n');
        }
        let struck = !self.report.contacts.is_empty();
        if struck && self.report.no_slip_consistent == Some(Some(false)) && self.report.verdict != Some(Verdict::None) {
            let infinite = |friction: &Option<Friction>| *friction == Some(Friction::Infinite);
            self.out.push_str(if self.subject.friction.iter().all(infinite) {
                "No outcome in which every contact sticks or lifts off exists: it slides whatever the friction.\n"
            } else {
                "In every outcome some contact slides.\n"
            });
        }
        if struck && let Some(is_proven) = self.report.proven {
            let rank = match (self.report.rank, self.report.condition.flatten()) {
                (Some(rank), Some(condition)) => format!("{rank}, condition {}", number(condition)),
                (Some(rank), None) => format!("{rank} of {}, redundant", 2 * self.report.contacts.len()),
                (None, _) => "not known".to_owned(),
            };
            let hidden = match (self.report.verdict, self.subject.analysis) {
                (Some(Verdict::Undecided), _) => "unknown",
                (_, Some(analysis)) if !analysis.families.is_empty() => "not defined with families",
                _ => "hidden by a border",
            };
            let sum = self.report.index_sum.map(|sum| sum.map_or(hidden.to_owned(), |sum| sum.to_string()));
            let sum = sum.map_or(String::new(), |sum| format!("; sum of indices {sum}"));
            let proven = if is_proven { "proven" } else { "not proven" };
            writeln!(self.out, "Contacts: rank {rank}{sum}; {proven}.")?;
        }
        if !struck && !self.report.notes.is_empty() {
            self.out.push('\n');
        }
        // If nothing touches, a note already gives these numbers.
        if let Some(NearestRecord { name, height, velocity: [_, normal] }) =
            self.report.nearest.as_ref().filter(|_| struck)
        {
            let way = if *normal < 0.0 { "toward the ground" } else { "away from the ground" };
            let (height, speed) = (number(*height), number(normal.abs()));
            writeln!(self.out, "Nearest open foot: {}, {height} m high, moves {way} at {speed} m/s.", visible(name))?;
        }
        self.notes()?;
        if let Some(left_out) = self.report.left_out.as_ref().filter(|left_out| !left_out.is_empty()) {
            let Palette { faint, plain, .. } = *self.palette;
            let what: Vec<&str> = left_out.iter().map(|left| &*left.what).collect();
            writeln!(self.out, "{faint}Left out (see `heelstrike inspect`): {}.{plain}", words::list(&what, LEFT_OUT))?;
        }
        Ok(())
    }

    fn notes(&mut self) -> std::fmt::Result {
        self.report.notes.iter().try_for_each(|note| writeln!(self.out, "Note: {}", visible(note)))
    }

    fn in_words(&self, modes: &[Mode]) -> String {
        words::modes(self.names(), modes)
    }

    fn alternatives<'m>(&self, all: impl Iterator<Item = &'m Vec<Mode>>) -> String {
        all.map(|modes| self.in_words(modes)).collect::<Vec<_>>().join("; or ")
    }
}

fn touching(contacts: &[ContactRecord]) -> String {
    let names: Vec<_> = contacts.iter().map(|contact| visible(&contact.name)).collect();
    match &names[..] {
        [] => "nothing touches the ground.".to_owned(),
        [name] => format!("{name} touches the ground."),
        [names @ .., last] => format!("{} and {last} touch the ground.", names.join(", ")),
    }
}

fn described(region: ImpulseRegion) -> &'static str {
    match region {
        ImpulseRegion::A => "A: lifts off",
        ImpulseRegion::B => "B: slides whatever the friction",
        ImpulseRegion::C => "C: stays",
        ImpulseRegion::E => "E: three outcomes are valid",
    }
}
