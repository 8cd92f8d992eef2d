//! The text that says why no other combination is an outcome.

use super::Writer;
use crate::impact::{Outcome, RejectionReason};
use crate::law::Mode;
use crate::planar::Pair;
use crate::write::result::Rejected;
use crate::write::table::{Table, scale};
use crate::write::words;
use std::collections::BTreeSet;
use std::fmt::Write;

/// The greatest number of rejected combinations that are listed.
const LISTED: usize = 20;

impl Writer<'_> {
    /// Writes one line: how many other combinations there are, and why they fail.
    pub(super) fn why_nothing_else(&mut self, outcomes: &[Outcome]) -> std::fmt::Result {
        let Some(analysis) = self.subject.analysis.filter(|_| !self.report.contacts.is_empty()) else { return Ok(()) };
        // Corners of a family may share their modes, and a family may have those of a corner: each list counts once.
        let families = self.report.families.iter().map(|family| &family.modes);
        let outcomes = outcomes.iter().map(|outcome| &outcome.modes).chain(families).collect::<BTreeSet<_>>().len();
        let others = analysis.effort.combinations().saturating_sub(outcomes as u64);
        // An open combination may be an outcome; the verdict says how many are open.
        if analysis.open.is_some() {
            return Ok(());
        }
        match (others, outcomes) {
            (0, _) => return Ok(()),
            (1, 0) => write!(self.out, "\nThe only combination of modes fails")?,
            (1, _) => write!(self.out, "\nNothing else: the other combination of modes fails")?,
            (_, 0) => write!(self.out, "\nAll {others} combinations of modes fail")?,
            _ => write!(self.out, "\nNothing else: the other {others} combinations of modes fail")?,
        }
        // If some rejections are not listed, the reasons of the others do not describe all.
        let rejected = analysis.rejected.iter().filter(|_| analysis.unlisted == 0);
        let mut reasons = words::grouped(rejected.map(|rejection| (in_general(rejection.because), ())));
        // The most frequent reason comes first.
        reasons.sort_by_key(|(_, all)| std::cmp::Reverse(all.len()));
        match &reasons[..] {
            [] => writeln!(self.out, "."),
            [(reason, _)] => writeln!(self.out, " because {reason}."),
            reasons => {
                let listed = reasons.iter().map(|(reason, all)| format!("{} because {reason}", all.len()));
                writeln!(self.out, ": {}.", listed.collect::<Vec<_>>().join(", "))
            }
        }
    }

    pub(super) fn rejected(&mut self) -> std::fmt::Result {
        let Some(all) = self.report.rejected.as_deref().filter(|list| !list.is_empty()) else { return Ok(()) };
        let mut rejected: Vec<&Rejected> = all.iter().collect();
        if all.len() > LISTED {
            let distance = |rejection: &Rejected| rejection.margin.map_or(f64::INFINITY, f64::abs);
            rejected.sort_by(|one, other| distance(one).total_cmp(&distance(other)));
            rejected.truncate(LISTED);
        }
        let mut table = Table::default();
        for (contact, name) in self.names().enumerate() {
            table = table.text(name, rejected.iter().map(|rejection| rejection.modes[contact].to_string()));
        }
        table = table
            .numbers("margin", 1.0, rejected.iter().map(|rejection| rejection.margin))
            .text("fails, because", rejected.iter().map(|rejection| rejection.because.as_str()));
        self.out.push('\n');
        table.write(&mut self.out);
        if let more @ 1.. = all.len() - rejected.len() {
            writeln!(self.out, "  ... {more} more, none closer to zero; JSON has all of them (`format: json`)")?;
        }

        self.out.push_str("\n  what each would have been\n");
        let impulses = || rejected.iter().map(|rejection| rejection.impulse.as_deref());
        let after = || rejected.iter().map(|rejection| rejection.velocity_after.as_deref());
        let largest = scale(impulses().flatten().flatten().copied().flatten());
        let speeds = scale(after().flatten().flatten().copied().flatten()).max(self.speeds());
        for (contact, name) in self.names().enumerate() {
            let of_contact = |list: Option<&[Pair<f64>]>| list.map(|list| list[contact]);
            let modes = |modes: &[Mode]| modes.iter().map(Mode::to_string).collect::<Vec<_>>().join(", ");
            self.out.push('\n');
            Table::default()
                .text(name, rejected.iter().map(|rejection| modes(&rejection.modes)))
                .pairs(self.subject.wording.impulse, largest, impulses().map(of_contact))
                .pairs(self.subject.wording.after, speeds, after().map(of_contact))
                .write(&mut self.out);
        }
        Ok(())
    }
}

/// Returns the reason without the contact, as a clause to follow `because`.
fn in_general(because: RejectionReason) -> &'static str {
    match because {
        RejectionReason::Violated { inequality, .. } => inequality.violation(),
        RejectionReason::NothingHolds { .. } => "a contact would stick without friction",
        RejectionReason::NoSolution => "the conditions contradict each other",
        RejectionReason::RedundantTwin => "a redundant twin already has that motion",
        RejectionReason::OnBorder => "its velocity is that of other modes, on their border",
    }
}
