//! Why there is nothing else.

use super::Writer;
use crate::impact::RejectionReason;
use crate::law::Mode;
use crate::write::table::{Table, scale};
use std::fmt::Write;

impl Writer<'_> {
    /// One line: how many other combinations there are, and what is wrong with them.
    pub(super) fn why_nothing_else(&mut self, outcomes: usize) -> std::fmt::Result {
        let contacts = self.report.contacts.len();
        if contacts == 0 || self.report.verdict.is_none() {
            return Ok(());
        }
        // 4^n; the number of contacts is bounded long before this overflows.
        let others = 4usize.saturating_pow(contacts as u32).saturating_sub(outcomes);
        let nothing = if outcomes == 0 { "" } else { "Nothing else: " };
        let fail = if others == 1 { "the other combination of modes fails" } else { "combinations of modes fail" };
        match (others, outcomes) {
            (0, _) => return Ok(()),
            (1, _) => write!(self.out, "\n{nothing}{fail}")?,
            (_, 0) => write!(self.out, "\nAll {others} {fail}")?,
            _ => write!(self.out, "\n{nothing}the other {others} {fail}")?,
        }
        let reasons = self.counted_reasons();
        let listed: Vec<String> = match &reasons[..] {
            [(_, reason)] => vec![format!("because {reason}")],
            reasons => reasons.iter().map(|(count, reason)| format!("{count} because {reason}")).collect(),
        };
        let joint = match reasons.len() {
            0 => "",
            1 => " ",
            _ => ": ",
        };
        writeln!(self.out, "{joint}{}.", listed.join(", "))
    }

    /// What is wrong with the rejected combinations, the most frequent first.
    pub(super) fn counted_reasons(&self) -> Vec<(usize, &'static str)> {
        let mut reasons: Vec<(usize, &str)> = Vec::new();
        for rejection in self.subject.analysis.map_or(&[][..], |analysis| &analysis.rejected) {
            let reason = in_general(rejection.because);
            match reasons.iter_mut().find(|(_, known)| *known == reason) {
                Some((count, _)) => *count += 1,
                None => reasons.push((1, reason)),
            }
        }
        reasons.sort_by_key(|&(count, _)| std::cmp::Reverse(count));
        reasons
    }

    /// Every rejected combination with what it would have been.
    pub(super) fn rejected(&mut self) {
        let Some(rejected) = self.report.rejected.as_ref().filter(|rejected| !rejected.is_empty()) else {
            return;
        };
        let mut table = Table::default();
        for (contact, name) in self.names().enumerate() {
            table = table.text(name, rejected.iter().map(|rejection| rejection.modes[contact].to_string()));
        }
        table = table
            .numbers("margin", 1.0, rejected.iter().map(|rejection| rejection.margin))
            .text("fails, because", rejected.iter().map(|rejection| rejection.because.as_str()));
        self.out.push('\n');
        table.write(&mut self.out);

        self.out.push_str("\n  what each would have been\n");
        let impulses =
            scale(rejected.iter().filter_map(|rejection| rejection.impulse.as_deref()).flatten().copied().flatten());
        let after =
            rejected.iter().filter_map(|rejection| rejection.velocity_after.as_deref()).flatten().copied().flatten();
        let speeds = scale(after).max(self.speeds());
        for (contact, name) in self.names().enumerate() {
            let impulse =
                |axis: usize| rejected.iter().map(move |r| r.impulse.as_deref().map(|list| list[contact][axis]));
            let after =
                |axis: usize| rejected.iter().map(move |r| r.velocity_after.as_deref().map(|list| list[contact][axis]));
            self.out.push('\n');
            Table::default()
                .text(name, rejected.iter().map(|rejection| modes_listed(&rejection.modes)))
                .numbers("impulse: t [N s]", impulses, impulse(0))
                .numbers("n [N s]", impulses, impulse(1))
                .numbers("after: t [m/s]", speeds, after(0))
                .numbers("n [m/s]", speeds, after(1))
                .write(&mut self.out);
        }
    }
}

/// A reason without its contact, to stand after `because`.
fn in_general(because: RejectionReason) -> &'static str {
    match because {
        RejectionReason::Violated { inequality, .. } => inequality.violation(),
        RejectionReason::NothingHolds { .. } => "a contact would stick without friction",
        RejectionReason::NoSolution => "the conditions contradict each other",
        RejectionReason::RedundantTwin => "a redundant twin already has that velocity",
        RejectionReason::OnBorder => "its velocity is that of other modes, on their border",
    }
}

fn modes_listed(modes: &[Mode]) -> String {
    modes.iter().map(Mode::to_string).collect::<Vec<_>>().join(", ")
}
