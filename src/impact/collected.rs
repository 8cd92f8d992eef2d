//! What the passes over all combinations have found so far.

use super::combination::Solved;
use super::outcome::{AtZero, Border, Effort, Motion, Outcome, Rejection, RejectionReason};
use super::problem::ContactProblem;
use super::reading::CombinationReading;
use super::singular::{SingularCase, SingularOutcome};
use super::slack::Scale;
use crate::law::{Inequality, Law, Mode};
use crate::reductions::Reductions;
use crate::scalar::Sign;
use std::cmp::Ordering;

/// Which rejected combinations an analysis lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListedRejections<'a> {
    Nothing,
    /// All, and the paper's section 4 for each contact.
    Everything,
    Only(&'a [Vec<Mode>]),
}

impl ListedRejections<'_> {
    pub fn contain(self, modes: &[Mode]) -> bool {
        match self {
            Self::Nothing => false,
            Self::Everything => true,
            Self::Only(chosen) => chosen.iter().any(|chosen| chosen == modes),
        }
    }
}

impl From<bool> for ListedRejections<'_> {
    fn from(all: bool) -> Self {
        if all { Self::Everything } else { Self::Nothing }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnalysisOptions<'a> {
    pub rejections: ListedRejections<'a>,
    /// Whether the errors of the source are bounds, so that what is decided is proven.
    pub prove: bool,
    /// What of the enumeration is left out if a problem does not need it.
    pub reductions: Reductions,
}

impl Default for AnalysisOptions<'_> {
    fn default() -> Self {
        Self { rejections: ListedRejections::Nothing, prove: true, reductions: Reductions::ALL }
    }
}

/// A combination that needs more digits, with its number among all, from 0.
#[derive(Debug, Clone)]
pub struct Pending {
    pub number: usize,
    pub modes: Vec<Mode>,
}

/// An outcome and the combination that led to it.
struct Numbered {
    number: usize,
    /// An end of a family whose own modes are not those of the combination.
    on_rim: bool,
    outcome: Outcome,
}

/// Outcomes and rejected combinations of a problem.
pub struct Collected<'a> {
    pub problem: &'a ContactProblem,
    pub scale: &'a Scale,
    pub options: AnalysisOptions<'a>,
    name: &'a dyn Fn(usize) -> String,
    pub total: usize,
    pub effort: Effort,
    outcomes: Vec<Numbered>,
    rejected: Vec<(usize, Rejection)>,
}

impl<'a> Collected<'a> {
    pub fn new(
        problem: &'a ContactProblem,
        scale: &'a Scale,
        options: AnalysisOptions<'a>,
        name: &'a dyn Fn(usize) -> String,
    ) -> Self {
        let (outcomes, rejected) = (Vec::new(), Vec::new());
        Self { problem, scale, options, name, total: 0, effort: Effort::default(), outcomes, rejected }
    }

    /// Adds a combination that was solved with more digits than f64 has.
    pub fn add(&mut self, Pending { number, modes }: &Pending, solved: Solved) {
        let number = *number;
        match solved {
            Solved::Regular { reading, index, motion, .. } => {
                self.add_regular(number, modes, reading, index, || motion);
            }
            Solved::Singular(SingularCase::Rejected(rejection)) => self.reject(number, modes, || rejection),
            Solved::Singular(SingularCase::Valid(own)) => {
                let outcome = self.singular_outcome(own);
                self.push(number, outcome);
            }
            Solved::Singular(SingularCase::Family(ends)) => {
                for end in ends {
                    let on_rim = end.modes != *modes;
                    let outcome = Outcome { family: true, ..self.singular_outcome(end) };
                    self.outcomes.push(Numbered { number, on_rim, outcome });
                }
            }
        }
    }

    /// Adds a combination whose equations have one solution.
    pub fn add_regular(
        &mut self,
        number: usize,
        modes: &[Mode],
        reading: CombinationReading,
        index: i8,
        motion: impl FnOnce() -> Motion,
    ) {
        if reading.sign == Sign::Negative {
            let solved = !matches!(reading.because, RejectionReason::NothingHolds { .. });
            self.reject(number, modes, || Rejection {
                margin: reading.margin,
                motion: solved.then(motion),
                ..Rejection::of(modes, reading.because)
            });
            return;
        }
        let mut outcome = self.outcome(modes.to_vec(), motion(), &reading.at_zero);
        outcome.index = reading.at_zero.is_empty().then_some(index);
        outcome.margin = reading.margin.map(|margin| margin + 0.0);
        self.push(number, outcome);
    }

    fn push(&mut self, number: usize, outcome: Outcome) {
        self.outcomes.push(Numbered { number, on_rim: false, outcome });
    }

    /// Adds a combination that no precision decided, with zeros for the impulses that are not known.
    pub fn add_undecided(&mut self, Pending { number, modes }: Pending) {
        let velocity_after = self.problem.velocity_free().to_vec();
        let motion = Motion { impulse: vec![[0.0; 2]; modes.len()], velocity_after };
        let outcome = Outcome { decided: false, proven: false, ..self.outcome(modes, motion, &[]) };
        self.push(number, outcome);
    }

    /// Adds a rejected combination, if it is to be listed.
    pub fn reject(&mut self, number: usize, modes: &[Mode], rejection: impl FnOnce() -> Rejection) {
        if self.options.rejections.contain(modes) {
            let mut rejection = rejection();
            rejection.margin = rejection.margin.filter(|margin| margin.is_finite());
            rejection.motion = rejection.motion.filter(Motion::is_finite);
            self.rejected.push((number, rejection));
        }
    }

    pub fn remove(&mut self, number: usize) {
        self.outcomes.retain(|own| own.number != number);
    }

    /// All outcomes and the listed rejections in the order of the combinations.
    pub fn finish(mut self) -> (Vec<Outcome>, Vec<Rejection>, Effort) {
        self.join_families();
        self.outcomes.sort_by_key(|own| own.number);
        self.rejected.sort_by_key(|(number, _)| *number);
        self.effort.bound = self.total - self.effort.ball - self.effort.double_double - self.effort.precise;
        let outcomes = self.outcomes.into_iter().map(|own| own.outcome).collect();
        (outcomes, self.rejected.into_iter().map(|(_, rejection)| rejection).collect(), self.effort)
    }

    fn singular_outcome(&self, own: SingularOutcome) -> Outcome {
        Outcome {
            index: own.index,
            margin: own.margin,
            impulse_unique: own.range.is_none(),
            impulse_range: own.range,
            ..self.outcome(own.modes, own.motion, &own.at_zero)
        }
    }

    /// A decided outcome with a unique impulse; the caller sets index and margin.
    fn outcome(&self, modes: Vec<Mode>, motion: Motion, at_zero: &[(usize, Inequality)]) -> Outcome {
        let border = border(&modes, self.problem.laws(), at_zero, &motion, self.name);
        let mut outcome = Outcome {
            modes,
            impulse: Vec::new(),
            velocity_after: Vec::new(),
            base_velocity_after: None,
            joint_velocity_after: None,
            loop_impulse: None,
            energy_loss: 0.0,
            impulse_unique: true,
            impulse_range: None,
            friction_needed: Vec::new(),
            index: None,
            margin: None,
            border,
            family: false,
            proven: self.options.prove,
            decided: true,
        };
        outcome.set_motion(motion, self.problem.velocity_before());
        outcome
    }

    /// An end of a family on its rim is the outcome, or the end, of other modes, and is listed once, as theirs.
    fn join_families(&mut self) {
        let same = |a: &Outcome, b: &Outcome| {
            a.modes == b.modes && self.scale.same_velocity(&a.velocity_after, &b.velocity_after)
        };
        let mut index = 0;
        while index < self.outcomes.len() {
            let end = &self.outcomes[index];
            let twin = self.outcomes.iter().enumerate().position(|(other, own)| {
                let again = end.on_rim || own.number == end.number;
                end.outcome.family && other != index && again && same(&own.outcome, &end.outcome)
            });
            if let Some(twin) = twin {
                let outcome = &mut self.outcomes[twin].outcome;
                (outcome.family, outcome.index) = (true, None);
                self.outcomes.remove(index);
            } else {
                index += 1;
            }
        }
    }
}

/// The border of an outcome whose impulse inequalities `at_zero` are zero; `None` if none is.
fn border(
    modes: &[Mode],
    laws: &[Law],
    at_zero: &[(usize, Inequality)],
    motion: &Motion,
    name: impl Fn(usize) -> String,
) -> Option<Border> {
    if at_zero.is_empty() {
        return None;
    }
    let mut border = Border { at_zero: Vec::new(), neighbours: Vec::new() };
    for (contact, (&mode, law)) in modes.iter().zip(laws).enumerate() {
        let own = || at_zero.iter().filter(|(place, _)| *place == contact).map(|&(_, inequality)| inequality);
        // Without pressure the cone is its own tip, and says nothing more.
        let unpressed = own().find(|&inequality| inequality == Inequality::NormalImpulse);
        let Some(inequality) = unpressed.or_else(|| own().next()) else { continue };
        border.at_zero.push(AtZero { contact: name(contact), inequality });
        let tangential = motion.impulse[contact][0].partial_cmp(&0.0).unwrap_or(Ordering::Equal);
        for beyond in law.beyond(mode, inequality, tangential).into_iter().filter(|&beyond| beyond != mode) {
            let mut neighbor = modes.to_vec();
            neighbor[contact] = beyond;
            border.neighbours.push(neighbor);
        }
    }
    Some(border)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;

    #[test]
    fn border_leads_to_its_neighboring_modes() {
        use Inequality::{FrictionCone, NormalImpulse};
        let laws = [Friction::Finite(0.5), Friction::ZERO].map(Law::from);
        for (tangential, at_zero, expected, neighbours) in [
            // A cone's edge leads to the slide that its friction resists.
            (0.5, vec![(0, FrictionCone)], vec![("0", FrictionCone)], vec![[Mode::SlideMinus, Mode::Stick]]),
            // A contact without pressure may do anything next.
            (
                0.0,
                vec![(0, NormalImpulse), (0, FrictionCone), (1, NormalImpulse)],
                vec![("0", NormalImpulse), ("1", NormalImpulse)],
                vec![
                    [Mode::Separate, Mode::Stick],
                    [Mode::SlidePlus, Mode::Stick],
                    [Mode::SlideMinus, Mode::Stick],
                    [Mode::Stick, Mode::Separate],
                ],
            ),
        ] {
            let motion = Motion { impulse: vec![[tangential, 1.0]; 2], velocity_after: vec![[0.0, 0.0]; 2] };
            let found = border(&[Mode::Stick; 2], &laws, &at_zero, &motion, |contact| contact.to_string()).unwrap();
            let zeros: Vec<_> = found.at_zero.iter().map(|zero| (&*zero.contact, zero.inequality)).collect();
            assert_eq!((zeros, found.neighbours), (expected, neighbours.iter().map(|modes| modes.to_vec()).collect()));
        }
    }
}
