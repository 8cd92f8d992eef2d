//! Analyzes a contact problem: all outcomes and the verdict.
//!
//! ```text
//!     problem --enumerate--> numbers of each combination --slack, reading--> valid, rejected
//!                                                                     or undecided --escalate--> Analysis
//! ```
//!
//! The signs of each combination are first computed in f64 with error bounds. Signs that the bounds leave open are
//! computed with more digits, so that none is guessed.

use super::collected::{
    AnalysisOptions, Collected, EXPLAINED, Findings, FoundFamilies, ListedRejections, OutcomeMemory,
};
use super::enumerate::{Labels, Tableau};
use super::explanation::explanation;
use super::families::FamiliesPass;
use super::kernel::Kernel;
use super::outcome::{Analysis, Explanation, OpenCombinations, Outcome, Verdict};
use super::passes::{F64Pass, UndecidedPass};
use super::problem::{ContactProblem, Errors, Ladder, Precision, PrecisionTask, Remembered, escalate};
use super::rank::rank_and_condition;
use super::relaxation::Relaxation;
use super::slack::Scale;
use super::survivors::{SEARCHED, Search, combinations};
use crate::budget::is_spent;
use crate::error::{Error, Reason, Result};
use crate::law::{Impulse, Mode};
use crate::planar::Pair;
use crate::scalar::Rounded;

/// The most contacts of a problem that is analyzed: 4^16 combinations are four billion.
pub const CONTACT_LIMIT: usize = 16;

/// The error for a problem with more than [`CONTACT_LIMIT`] contacts.
pub fn too_many_contacts(contacts: usize) -> Error {
    Error::new(Reason::TooManyContacts { contacts, limit: CONTACT_LIMIT })
        .hint("leave out the contacts that matter least")
}

/// A note is given if impulses are this many times larger than the change of motion requires.
const HARD: f64 = 1e3;

impl Analysis {
    /// The notes that a reader of the analysis should see, as sentences. `problem` is the one that was analyzed; `mass`
    /// is the robot's mass \[kg\], or 0 without a robot.
    pub fn notes(&self, problem: &ContactProblem, mass: impl FnOnce() -> f64) -> impl Iterator<Item = String> {
        self.energy_note().into_iter().chain(self.balance_note(problem, mass)).chain(self.unlisted_note())
    }

    /// A note if contacts push against each other so hard that the last digits of the input decide.
    pub(crate) fn balance_note(&self, problem: &ContactProblem, mass: impl FnOnce() -> f64) -> Option<String> {
        if self.verdict == Verdict::NoImpact {
            return None;
        }
        let most = |list: &[Pair<f64>]| list.as_flattened().iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        let fastest = most(problem.velocity_before()).max(most(problem.velocity_free()));
        // A light foot passes its impulse on to the whole robot, so the foot's own mobility would overstate the motion.
        let hardest = |lightest: f64| {
            let excess = |outcome: &Outcome| {
                let rows = outcome.impulse.as_flattened().iter().enumerate();
                let push =
                    rows.map(|(row, entry)| entry.abs() * problem.delassus(row, row).min(lightest)).fold(0.0, f64::max);
                let fastest = fastest.max(most(&outcome.velocity_after));
                if fastest > 0.0 { push / fastest } else { 0.0 }
            };
            self.outcomes.iter().filter(|outcome| outcome.decided).map(excess).fold(0.0, f64::max)
        };
        let is_hard = |push: &f64| *push > HARD;
        let hardest = Some(hardest(f64::INFINITY)).filter(is_hard).map(|_| hardest(1.0 / mass())).filter(is_hard)?;
        Some(format!(
            "contacts push against each other {hardest:.0e} times harder than their motion needs: the last digits of the \
             pose or of the matrices decide, and what follows has fewer digits; a sole that is meant to be flat needs a level \
             pose or finite friction"
        ))
    }
}

/// Memory of analyses, which is reused from problem to problem.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    tableau: Tableau<Rounded>,
    scale: Scale,
    labels: Labels,
    relaxation: Relaxation,
    memory: OutcomeMemory,
}

/// Analyzes a `problem` given as matrices, each f64 of which is taken exactly. `rejections` selects the rejected
/// combinations that are listed.
///
/// # Errors
/// Returns [`Reason::TooManyContacts`] if there are more than [`CONTACT_LIMIT`] contacts.
pub fn analyze(problem: &ContactProblem, rejections: ListedRejections<'_>) -> Result<Analysis> {
    let options = AnalysisOptions { rejections, ..AnalysisOptions::default() };
    Scratch::default().analyze(problem, problem, options)
}

impl Scratch {
    /// Takes over the memory of outcomes that are no longer needed.
    pub fn recycle(&mut self, outcomes: Vec<Outcome>) {
        self.memory.recycle(outcomes);
    }

    /// Analyzes a `problem` whose f64 numbers were rounded from a `source`, reusing memory.
    ///
    /// # Errors
    /// Returns [`Reason::TooManyContacts`] if there are more than [`CONTACT_LIMIT`] contacts.
    pub fn analyze(
        &mut self,
        problem: &ContactProblem,
        source: &dyn Ladder,
        options: AnalysisOptions<'_>,
    ) -> Result<Analysis> {
        let contacts = problem.contacts();
        if contacts > CONTACT_LIMIT {
            return Err(too_many_contacts(contacts));
        }
        let options = AnalysisOptions { prove: options.prove && source.is_exact(), ..options };
        self.tableau.without_slip = false;
        let remembered = &Remembered::of(source);
        let (findings, regular) = self.find(problem, remembered, options);
        let Findings { outcomes, families, rejected, unlisted, effort, visited, undecided } = findings;
        let combinations = combinations(problem.laws());
        let undecided = undecided + (combinations - visited);
        let open = (undecided > 0).then(|| OpenCombinations { combinations, undecided, beyond_budget: is_spent() });
        let indices = || outcomes.iter().map(|outcome| outcome.index.map(i32::from)).sum();
        let ranked = || rank_and_condition(problem, remembered, &self.scale, regular, options.reductions);
        let (rank, condition) = (!options.brief).then(ranked).flatten().unzip();
        let is_explained = options.rejections == ListedRejections::Everything && rank == Some(2 * contacts);
        Ok(Analysis {
            verdict: verdict(contacts, &outcomes, open.is_some()),
            proven: options.prove && open.is_none() && outcomes.iter().all(|outcome| outcome.proven),
            index_sum: if open.is_none() { indices() } else { None },
            rank,
            condition: condition.flatten(),
            no_slip_consistent: no_slip_consistent(&outcomes, open.as_ref()),
            explanation: if is_explained { self.explain(problem, source) } else { None },
            outcomes,
            open,
            families,
            rejected,
            unlisted,
            effort,
        })
    }

    /// Computes beta, gamma and the regions, for slow contacts from the velocities that decided their outcomes.
    fn explain(&self, problem: &ContactProblem, source: &dyn Ladder) -> Option<Explanation> {
        let velocity = if self.scale.is_slow() { source.velocity() } else { None };
        let moving = velocity.map(|velocity| problem.moving(&velocity).0);
        explanation(moving.as_ref().unwrap_or(problem), &self.scale)
    }

    /// The least friction with which some outcome has no sliding contact; the inner `None` means that contacts slide
    /// whatever the friction is. The outer `None` means that it is not known.
    ///
    /// The friction is the greatest [`Outcome::friction_needed`] of that outcome without sliding contacts which needs
    /// least. `problem` and `source` have infinite friction everywhere. The result is unknown for more contacts than
    /// [`CONTACT_LIMIT`], or if no precision, within the budget, decides an outcome.
    pub fn friction_without_slip(
        &mut self,
        problem: &ContactProblem,
        source: &dyn Ladder,
        options: AnalysisOptions<'_>,
    ) -> Option<Option<f64>> {
        if problem.contacts() > CONTACT_LIMIT {
            return None;
        }
        self.tableau.without_slip = true;
        let (Findings { outcomes, .. }, _) = self.find(problem, &Remembered::of(source), options);
        let is_known = !is_spent() && outcomes.iter().all(|outcome| outcome.decided);
        let least = is_known.then(|| outcomes.iter().map(steepest).min_by(f64::total_cmp));
        self.recycle(outcomes);
        least
    }

    /// Finds all outcomes of the modes that are visited. Also returns whether G was shown to be regular.
    fn find(
        &mut self,
        problem: &ContactProblem,
        remembered: &Remembered<'_>,
        options: AnalysisOptions<'_>,
    ) -> (Findings, bool) {
        let (contacts, source) = (problem.contacts(), remembered.source);
        let errors = source.errors();
        self.scale.measure(problem, errors);
        self.tableau.separately = !options.reductions.frictionless;
        let (delassus, free) = (self.scale.delassus(problem, errors), self.scale.free(problem, errors));
        let mut shared = Vec::new();
        if (0..contacts).any(|contact| source.shared_tangent(contact).is_some()) {
            shared.extend((0..contacts).map(|contact| source.shared_tangent(contact)));
        }
        self.tableau.load_entries(problem.laws(), delassus, free);
        let name = |contact| source.contact_name(contact);
        let mut collected = Collected::new(problem, &self.scale, options, &name, &mut self.memory);
        let mut pass = F64Pass {
            labels: &mut self.labels,
            shares: options.reductions.frictionless
                && problem.laws().iter().any(|law| law.modes().iter().any(|group| group.len() > 1)),
            regular: contacts == 0,
            undecided: Vec::new(),
            collected: &mut collected,
        };
        let lists_all = options.rejections == ListedRejections::Everything;
        let mut kernel = None;
        let is_searched = contacts >= SEARCHED && !(lists_all && contacts <= EXPLAINED);
        if !is_searched {
            self.tableau.visit(&mut pass);
        } else {
            let without_slip = self.tableau.without_slip;
            let posed = (problem, remembered, &*shared);
            let search = Search::of(posed, &self.scale, &mut self.relaxation, without_slip, options.rejections);
            (pass.collected.found.effort, kernel) = (search.effort, search.kernel);
            pass.shares = false;
            for modes in &search.survivors {
                self.tableau.visit_one(modes, &mut pass);
            }
            pass.collected.found.visited = combinations(problem.laws()) - search.unvisited;
            if lists_all {
                pass.collected.found.unlisted = pass.collected.found.visited - search.survivors.len() as u64;
            }
        }
        let F64Pass { mut regular, mut undecided, .. } = pass;
        // For slow contacts often only the velocities lack digits, and these are quick to compute.
        let is_blurred = !undecided.is_empty() && self.scale.is_slow() && !is_spent();
        let sharper = if is_blurred { source.velocity() } else { None }.map(|velocity| problem.moving(&velocity));
        let (mut problem, mut errors, mut scale) = (problem, errors, &self.scale);
        let mut sharp_scale = Scale::default();
        if let Some((moving, off)) = &sharper {
            (problem, errors) = (moving, Errors { velocity: Some(off), likely: [errors.likely[0], 1.0], ..errors });
            sharp_scale.measure(problem, errors);
            scale = &sharp_scale;
            self.tableau.load_entries(problem.laws(), scale.delassus(problem, errors), scale.free(problem, errors));
            collected.found.visited -= undecided.len() as u64;
            (collected.problem, collected.scale) = (problem, scale);
            let again = std::mem::take(&mut undecided);
            let (labels, collected) = (&mut self.labels, &mut collected);
            let mut pass = F64Pass { labels, shares: false, regular, undecided, collected };
            again.iter().for_each(|entry| self.tableau.visit_one(&entry.pending.modes, &mut pass));
            F64Pass { regular, undecided, .. } = pass;
        }
        let is_asked = !(options.brief || self.tableau.without_slip);
        // A visit of all combinations includes the one in which every contact sticks, which shows whether G is regular.
        let is_shown =
            contacts < SEARCHED && problem.laws().iter().all(|law| law.impulse(Mode::Stick) == Impulse::Free);
        if is_asked && !is_shown {
            regular = regular || self.tableau.stick_all().is_known();
        }
        if !undecided.is_empty() {
            let first = Precision::first(regular || is_searched && self.relaxation.is_regular, problem);
            let (known, collected) = (Kernel::of_shared(&shared), &mut collected);
            let (rejected, is_decided) = (Vec::new(), false);
            let mut pass = UndecidedPass { undecided, rejected, is_decided, kernel, shared: known, collected };
            let is_enclosed = !shared.is_empty() && errors.delassus.is_finite() && scale.is_far_from_underflow();
            let enclosed = is_enclosed.then(|| scale.enclosed(problem, errors, shared));
            let climb = |pass: &mut UndecidedPass| {
                if !enclosed.as_ref().is_some_and(|problem| pass.attempt(problem, Precision::Enclosed)) {
                    escalate(remembered, first, pass);
                }
                pass.finish();
            };
            climb(&mut pass);
            let pending = std::mem::take(&mut pass.collected.pending_families);
            if !pending.is_empty() {
                let mut families = FamiliesPass { pending, collected: pass.collected, found: FoundFamilies::default() };
                escalate(remembered, Precision::Ball, &mut families);
                let found = families.found;
                pass.collected.add_families(found);
            }
            // Reasons of rejections are computed last, so that a budget that ends here leaves no outcome open.
            if pass.begin_reasons() {
                climb(&mut pass);
            }
        }
        (collected.finish(), regular)
    }
}

/// The greatest friction that a contact of the outcome needs; infinite if a contact has tangential impulse without
/// normal impulse. The outcome is one of infinite friction.
fn steepest(outcome: &Outcome) -> f64 {
    let contacts = outcome.impulse.iter().zip(&outcome.friction_needed);
    let ratios = contacts.map(|(&[tangential, _], needed)| match needed {
        Some(needed) => *needed,
        None if tangential == 0.0 => 0.0,
        None => f64::INFINITY,
    });
    ratios.fold(0.0, f64::max)
}

fn verdict(contacts: usize, outcomes: &[Outcome], is_open: bool) -> Verdict {
    if contacts == 0 {
        return Verdict::NoContact;
    }
    if is_open {
        return Verdict::Undecided;
    }
    match outcomes {
        [] => Verdict::None,
        [only] if only.impulse.iter().flatten().all(|&entry| entry == 0.0) => Verdict::NoImpact,
        [_] => Verdict::Unique,
        _ => Verdict::Ambiguous,
    }
}

/// Whether some outcome has no sliding contact; `None` if that depends on an undecided combination.
fn no_slip_consistent(outcomes: &[Outcome], open: Option<&OpenCombinations>) -> Option<bool> {
    let without_slip = || outcomes.iter().filter(|outcome| !outcome.modes.iter().any(|mode| mode.slides()));
    let listed = outcomes.iter().filter(|outcome| !outcome.decided).count();
    let all_listed = open.is_none_or(|open| open.undecided == listed as u64);
    match without_slip().any(|outcome| outcome.decided) {
        false if without_slip().next().is_some() || !all_listed => None,
        found => Some(found),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::impact::Source;
    use crate::law::Friction;
    use crate::scalar::{Ordered, Trigonometry};
    use proptest::prelude::*;

    /// A problem of level soles with two contacts each; the source knows the tangential rows that they share.
    struct Soles<'a>(&'a ContactProblem);

    impl Source for Soles<'_> {
        fn problem<T: Ordered + Trigonometry>(&self) -> ContactProblem<T> {
            self.0.problem()
        }

        fn errors(&self) -> Errors<'_> {
            Errors::NONE
        }

        fn shared_tangent(&self, contact: usize) -> Option<usize> {
            contact.checked_sub(contact % 2).filter(|&first| first != contact)
        }
    }

    proptest! {
        #[test]
        fn what_soles_share_changes_no_answer(
            sides in prop::collection::vec(prop::array::uniform3(prop::array::uniform6(-1.0..1.0f64)), 1..=2),
            before in prop::array::uniform3(prop::array::uniform2(-1.0..1.0f64)),
            mu in prop_oneof![Just(Friction::Infinite), (0.05..2.0f64).prop_map(Friction::Finite)],
            bounce in prop_oneof![Just(0.0), 0.1..0.9f64],
            all in any::<bool>(),
        ) {
            let rows: Vec<_> = sides.iter().flat_map(|&[t, first, second]| [t, first, t, second]).collect();
            let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let delassus = rows.iter().flat_map(|a| rows.iter().map(|b| dot(a, b))).collect();
            let velocity = |side: usize| [[before[side][0], before[2][0]], [before[side][0], before[side][1]]];
            let velocity: Vec<_> = (0..sides.len()).flat_map(velocity).collect();
            let contacts = velocity.len();
            let problem = ContactProblem::new(delassus, velocity, vec![mu; contacts], vec![bounce; contacts]).unwrap();
            // A repaired or symmetrized G need not have the exactly equal rows that `Soles` states.
            prop_assume!(problem.is_given());
            let options = AnalysisOptions { rejections: all.into(), ..AnalysisOptions::default() };
            let known = Scratch::default().analyze(&problem, &Soles(&problem), options).unwrap();
            let unknown = analyze(&problem, all.into()).unwrap();
            prop_assert_eq!((known.verdict, known.proven), (unknown.verdict, unknown.proven));
            prop_assert_eq!((known.rank, known.index_sum), (unknown.rank, unknown.index_sum));
            let because = |analysis: &Analysis| -> Vec<_> {
                analysis.rejected.iter().map(|rejection| (rejection.modes.clone(), rejection.because)).collect()
            };
            prop_assert_eq!(because(&known), because(&unknown));
            prop_assert_eq!(known.outcomes.len(), unknown.outcomes.len());
            for (one, other) in known.outcomes.iter().zip(&unknown.outcomes) {
                prop_assert_eq!((&one.modes, one.index, one.impulse_unique), (&other.modes, other.index, other.impulse_unique));
                let numbers = |outcome: &Outcome| -> Vec<f64> {
                    let pairs = outcome.impulse.iter().chain(&outcome.velocity_after).flatten().copied();
                    pairs.chain([outcome.energy_loss, outcome.margin.unwrap_or(0.0)]).collect()
                };
                let (one, other) = (numbers(one), numbers(other));
                let size = other.iter().fold(1.0, |most: f64, number| most.max(number.abs()));
                for (a, b) in one.iter().zip(&other) {
                    prop_assert!((a - b).abs() <= 1e-9 * size, "{one:?} is not {other:?}");
                }
            }
        }
    }

    #[test]
    fn more_contacts_than_are_tried_are_refused() {
        let (contacts, rows) = (CONTACT_LIMIT + 1, 2 * (CONTACT_LIMIT + 1));
        let identity = (0..rows * rows).map(|k| f64::from(u8::from(k % (rows + 1) == 0))).collect();
        let (friction, restitution) = (vec![Friction::Infinite; contacts], vec![0.0; contacts]);
        let problem = ContactProblem::new(identity, vec![[0.0, -1.0]; contacts], friction, restitution).unwrap();
        let refused = analyze(&problem, ListedRejections::Nothing).unwrap_err();
        assert_eq!(refused.reason(), &Reason::TooManyContacts { contacts, limit: CONTACT_LIMIT });
    }
}
