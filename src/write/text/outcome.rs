//! The text of each outcome, and the velocities after all of them.

use super::Writer;
use crate::impact::{Family, Next, Verdict};
use crate::pipeline::{Driven, Sustained, Unrealized};
use crate::planar::Vector;
use crate::write::table::{Table, number, scale};
use crate::write::{Palette, words};
use crate::{Mode, Outcome};
use std::fmt::Write;

impl Writer<'_> {
    pub(super) fn outcome(&mut self, count: usize, outcome: &Outcome) -> std::fmt::Result {
        if outcome.modes.is_empty() {
            return Ok(());
        }
        let Palette { strong, plain, .. } = *self.palette;
        let words = self.in_words(&outcome.modes);
        let open = if outcome.decided { "" } else { ", not excluded" };
        writeln!(self.out, "\n{strong}{count}  {words}{open}{plain}{}", graded(outcome))?;
        if !outcome.decided {
            return writeln!(self.out, "  what it would be is not known");
        }

        let (impulses, speeds) = (scale(outcome.impulse.iter().copied().flatten()), self.speeds());
        let mut table = Table::default()
            .text("contact", self.names())
            .text("mode", outcome.modes.iter().map(Mode::to_string))
            .pairs(self.subject.wording.impulse, impulses, outcome.impulse.iter().copied())
            .pairs(self.subject.wording.after, speeds, outcome.velocity_after.iter().copied());
        if outcome.friction_needed.iter().any(Option::is_some) {
            table = table.numbers("friction needed", 1.0, outcome.friction_needed.iter().copied());
        }
        table.write(&mut self.out);
        self.loops(outcome);
        self.energy(outcome)?;
        if !outcome.impulse_unique {
            writeln!(self.out, "  {}; these are the least", self.subject.wording.others)?;
        }
        if outcome.family {
            self.out.push_str("  a corner of a family\n");
        }
        self.border(outcome)?;
        self.next(outcome)
    }

    /// Writes what happens just after the outcome.
    pub(super) fn next(&mut self, outcome: &Outcome) -> std::fmt::Result {
        let Some(Next { verdict, proven, modes }) = &outcome.next else { return Ok(()) };
        let clauses = |modes: &Vec<Option<Mode>>| {
            let closed = self.names().zip(modes).filter_map(|(name, mode)| Some((name, (*mode)?)));
            let (names, modes): (Vec<&str>, Vec<Mode>) = closed.unzip();
            if modes.is_empty() { "nothing touches the ground".to_owned() } else { words::modes(names, &modes) }
        };
        let all: Vec<String> = modes.iter().map(clauses).collect();
        let words = match (verdict, &all[..]) {
            (Verdict::None, _) => words::NO_FORCES.replace("No", "no"),
            (Verdict::Undecided, []) => "undecided".to_owned(),
            (Verdict::Undecided, all) => format!("undecided; {}", all.join("; or ")),
            (_, all) => all.join("; or "),
        };
        writeln!(self.out, "  just after: {words}{}", if *proven { "" } else { " (not proven)" })
    }

    /// Writes one line per family: its modes and the numbers of the outcomes at its corners.
    pub(super) fn families(&mut self) -> std::fmt::Result {
        if !self.report.families.is_empty() {
            let rates = self.subject.wording.rates;
            writeln!(self.out, "\nFamilies: all {rates} between their corners are outcomes, too")?;
        }
        for Family { modes, dimension, corners } in self.report.families.iter() {
            let corners = corners.iter().map(|corner| (corner + 1).to_string()).collect::<Vec<_>>().join(", ");
            let dimensions = if *dimension == 1 { String::new() } else { format!(", in {dimension} dimensions") };
            writeln!(self.out, "  {}: between outcomes {corners}{dimensions}", self.in_words(modes))?;
        }
        Ok(())
    }

    /// Writes which inequalities are exactly zero, and which modes lie beyond the border.
    fn border(&mut self, outcome: &Outcome) -> std::fmt::Result {
        let Some(border) = &outcome.border else { return Ok(()) };
        write!(self.out, "  exactly on a border: {}", words::at_zero(border))?;
        if !border.neighbours.is_empty() {
            write!(self.out, "; beyond it {}", self.alternatives(border.neighbours.iter()))?;
        }
        writeln!(self.out)
    }

    fn loops(&mut self, outcome: &Outcome) {
        let Some(impulses) = outcome.loop_impulse.as_deref().filter(|list| !list.is_empty()) else { return };
        let size = scale(impulses.iter().copied().flat_map(Vector::components));
        Table::default()
            .text("loop", (0..impulses.len()).map(|index| format!("loops[{index}]")))
            .pairs(self.subject.wording.on_loops, size, impulses.iter().map(|impulse| impulse.components()))
            .write(&mut self.out);
    }

    fn energy(&mut self, outcome: &Outcome) -> std::fmt::Result {
        let loss = outcome.energy_loss;
        let verb = if loss < 0.0 { "gives" } else { "takes" };
        match (loss == 0.0, self.report.sustained) {
            (true, None) => writeln!(self.out, "  no energy is lost"),
            (true, Some(_)) => Ok(()),
            (false, Some(_)) => writeln!(self.out, "  the ground {verb} {} W", number(loss.abs())),
            (false, None) => {
                let energy = self.report.kinetic_energy.filter(|&energy| energy > 0.0 && loss > 0.0);
                let share = energy.map(|energy| format!(", {:.1} % of the kinetic energy", 100.0 * loss / energy));
                writeln!(self.out, "  the ground {verb} {} J{}", number(loss.abs()), share.unwrap_or_default())
            }
        }
    }

    /// Writes what the virtual springs ask for and the joints' torques; nothing for a state without virtual springs.
    pub(super) fn torques(&mut self) {
        let Some((Sustained { driven: Driven { torque, springs, unrealized }, .. }, _)) = self.report.sustained else {
            return;
        };
        if springs.is_empty() {
            return;
        }
        let force = scale(springs.iter().flat_map(|spring| spring.force));
        let moment = scale(springs.iter().map(|spring| spring.moment));
        self.out.push('\n');
        Table::default()
            .text("virtual spring", (0..springs.len()).map(|index| format!("virtual[{index}]")))
            .pairs(["force on a: x [N]", "z [N]"], force, springs.iter().map(|spring| spring.force))
            .numbers("moment [N m]", moment, springs.iter().map(|spring| spring.moment))
            .write(&mut self.out);
        let all = scale(torque.values().iter().copied());
        let of_springs = |joint: usize| springs.iter().map(|spring| spring.torque.values()[joint]).sum::<f64>();
        Table::default()
            .text("torque [N m or N]", torque.iter().map(|(name, _)| name))
            .numbers("all", all, torque.values().iter().copied())
            .numbers("virtual", all, (0..torque.values().len()).map(of_springs))
            .write(&mut self.out);
        if let Some(Unrealized { fx, fz, moment: about }) = *unrealized {
            Table::default()
                .pairs(["unrealized: x [N]", "z [N]"], force, [[fx, fz]])
                .numbers("moment [N m]", all.max(moment), [about])
                .write(&mut self.out);
        }
    }

    /// Writes v after the impact, one column per outcome.
    pub(super) fn velocities(&mut self, outcomes: &[Outcome]) {
        // An undecided outcome has no known numbers.
        let decided = || outcomes.iter().enumerate().filter(|(_, outcome)| outcome.decided);
        let Some(first) = decided().next().map(|(_, first)| coordinates(first)).filter(|names| !names.is_empty())
        else {
            return;
        };
        let mut table =
            Table::default().text(self.subject.wording.coordinates, first).text("", self.subject.units.iter().copied());
        let velocities = scale(decided().flat_map(|(_, outcome)| outcome.velocity())).max(self.speeds());
        for (at, outcome) in decided() {
            let head = if outcomes.len() == 1 { String::new() } else { format!("{}", at + 1) };
            table = table.numbers(&head, velocities, outcome.velocity());
        }
        self.out.push('\n');
        table.write(&mut self.out);
    }
}

/// Returns `   (margin 0.0130, index +1)`, or the part that is known.
pub(super) fn graded(outcome: &Outcome) -> String {
    let grades = words::grades(outcome.margin, outcome.index);
    if grades.is_empty() { grades } else { format!("   ({grades})") }
}

/// Returns the names of the entries of v, base first.
fn coordinates(outcome: &Outcome) -> Vec<&str> {
    let parts = [&outcome.base_velocity_after, &outcome.joint_velocity_after];
    parts.into_iter().flatten().flat_map(|part| part.iter()).map(|(name, _)| name).collect()
}
