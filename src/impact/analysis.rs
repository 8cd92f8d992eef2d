//! Every outcome of a contact problem, and the verdict.
//!
//! ```text
//!     problem --enumerate--> numbers of each combination --bound, sign--> valid | rejected | open --certify--> Analysis
//! ```
//!
//! Each combination is first read in f64 with a bound of its error; what lies within it is settled with more digits
//! ([`super::certify`]). So a sign is told only where it was shown, and nothing is guessed.

use super::border::border;
use super::bound::Bounds;
use super::certify::{Inverse, Layer, Question, Settled, combination, settle};
use super::enumerate::{Leaf, Tableau, Visitor};
use super::kernel::Kernel;
use super::labels::Labels;
use super::lone;
use super::outcome::{Analysis, Effort, Motion, Outcome, Rejection, RejectionReason, Verdict};
use super::problem::{ContactProblem, Source};
use super::reading::{Reading, read_f64};
use super::redundant::{Judged, Member};
use super::region::explanation;
use super::sign::Scale;
use crate::error::{Error, Reason, Result};
use crate::law::{ContactLaw, Impulse, Inequality, Mode};
use crate::reductions::Reductions;
use crate::scalar::{Ordered, Real, Sign};
use nalgebra::DMatrix;

/// All combinations are tried up to this many contacts (4^10 is a million).
pub const CONTACT_LIMIT: usize = 10;

/// Which rejected combinations an analysis lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Explain<'a> {
    /// None.
    Nothing,
    /// All, and the paper's section 4 for each contact.
    Everything,
    /// Those with these modes.
    Only(&'a [Vec<Mode>]),
}

impl Explain<'_> {
    /// Whether a combination is listed if it is rejected.
    fn tells(self, modes: &[Mode]) -> bool {
        match self {
            Self::Nothing => false,
            Self::Everything => true,
            Self::Only(chosen) => chosen.iter().any(|chosen| chosen == modes),
        }
    }
}

impl From<bool> for Explain<'_> {
    fn from(explain: bool) -> Self {
        if explain { Self::Everything } else { Self::Nothing }
    }
}

/// What an analysis is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Asked<'a> {
    /// Which rejected combinations are listed.
    pub explain: Explain<'a>,
    /// Whether the errors of the source are bounds, so that what is decided is proven.
    pub prove: bool,
    /// What of the enumeration is left out where a problem does not need it.
    pub reductions: Reductions,
}

impl Default for Asked<'_> {
    fn default() -> Self {
        Self { explain: Explain::Nothing, prove: true, reductions: Reductions::ALL }
    }
}

/// Memory that is reused from problem to problem.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    tableau: Tableau<f64>,
    scale: Scale,
    bounds: Bounds,
    labels: Labels,
}

/// Every outcome of a `problem` given as matrices, every digit of which is meant; with `explain` also every rejected
/// combination and the paper's section 4 for each contact.
///
/// # Errors
/// [`Reason::TooManyContacts`] beyond [`CONTACT_LIMIT`].
pub fn analyse(problem: &ContactProblem, explain: bool) -> Result<Analysis> {
    Scratch::default().analyse(problem, problem, Asked { explain: explain.into(), ..Asked::default() })
}

impl Scratch {
    /// As [`analyse`], with memory that is kept, of a `problem` that was rounded from a `source`.
    ///
    /// # Errors
    /// [`Reason::TooManyContacts`] beyond [`CONTACT_LIMIT`].
    pub fn analyse<S: Source>(&mut self, problem: &ContactProblem, source: &S, asked: Asked<'_>) -> Result<Analysis> {
        let contacts = problem.contacts();
        if contacts > CONTACT_LIMIT {
            return Err(Error::new(Reason::TooManyContacts { contacts, limit: CONTACT_LIMIT })
                .hint("name the contacts that matter by hand, or lower the contact tolerance"));
        }
        let asked = Asked { prove: asked.prove && source.is_exact(), ..asked };
        let errors = source.errors();
        self.scale.measure(problem, errors);
        self.tableau.share_equal_impulses(asked.reductions.frictionless);
        self.tableau.load(problem);
        self.bounds.load(&self.tableau, &self.scale, errors.delassus, self.scale.noise);
        let mut first = FirstLook {
            problem,
            scale: &self.scale,
            bounds: &mut self.bounds,
            labels: &mut self.labels,
            number: 0,
            regular: contacts == 0,
            open: Vec::new(),
            coarse: Vec::new(),
            found: Found { asked, ..Found::default() },
        };
        self.tableau.visit(&mut first);
        let FirstLook { regular, open, coarse, mut found, .. } = first;
        let unheld = problem.laws().iter().any(|law| law.impulse(Mode::Stick) != Impulse::Free);
        let regular = regular || (unheld && shows_regular(&mut self.tableau, &mut self.bounds, contacts));
        let scale = &self.scale;
        let was_open = !open.is_empty();
        let mut coarse = coarse;
        if was_open {
            let mut question = Open { problem, scale, open, coarse, found: &mut found };
            settle(source, Layer::Ball, &mut question);
            coarse = question.coarse;
            for (number, modes) in question.open {
                found.leave_open(number, &modes, problem);
            }
        }
        let refined = !coarse.is_empty();
        if refined {
            settle(source, Layer::DoubleDouble, &mut Coarse { problem, scale, coarse, found: &mut found });
        }
        found.join_families(scale);
        let (rank, condition) = rank_and_condition(problem, source, scale, regular, asked.reductions);
        let Found { mut outcomes, mut rejected, mut effort, total, .. } = found;
        if was_open || refined {
            outcomes.sort_by_key(|own| own.number);
            rejected.sort_by_key(|(number, _)| *number);
        }
        effort.bound = total - effort.ball - effort.double_double - effort.precise;
        let outcomes: Vec<Outcome> = outcomes.into_iter().map(|own| own.outcome).collect();
        let decided = outcomes.iter().all(|outcome| outcome.decided);
        Ok(Analysis {
            verdict: verdict(contacts, &outcomes),
            proven: asked.prove && decided,
            index_sum: outcomes.iter().map(|outcome| outcome.index.map(i32::from)).sum(),
            rank,
            condition,
            no_slip_consistent: no_slip_consistent(&outcomes),
            explanation: if asked.explain == Explain::Everything && rank == 2 * contacts {
                explanation(problem, scale)
            } else {
                None
            },
            outcomes,
            rejected: rejected.into_iter().map(|(_, rejection)| rejection).collect(),
            effort,
        })
    }
}

/// All combinations in f64.
struct FirstLook<'a, 'f> {
    problem: &'a ContactProblem,
    scale: &'a Scale,
    bounds: &'a mut Bounds,
    labels: &'a mut Labels,
    /// Of the next list of modes.
    number: usize,
    /// Whether G was shown to be regular.
    regular: bool,
    /// What f64 does not decide.
    open: Vec<(usize, Vec<Mode>)>,
    /// Outcomes that f64 decides, but with few digits.
    coarse: Vec<(usize, Vec<Mode>)>,
    found: Found<'f>,
}

impl Visitor<f64> for FirstLook<'_, '_> {
    fn eliminated(&mut self, tableau: &Tableau<f64>, contact: usize, source: usize) {
        self.bounds.follow(tableau, contact, source);
    }

    fn leaf(&mut self, leaf: &Leaf<'_, f64>) {
        let bound = self.bounds.at(leaf.depth());
        // Where all contacts stick, the pivots are those of the whole matrix.
        self.regular |= bound.impulse_error().is_finite()
            && leaf.modes.iter().zip(self.problem.laws()).all(|(&mode, law)| law.impulse(mode) == Impulse::Free);
        self.labels.start(leaf.modes, self.problem.laws(), self.found.asked.reductions.frictionless);
        while let Some(modes) = self.labels.next() {
            let reading = read_f64(leaf, modes, self.problem, self.scale, bound, self.found.asked.explain.tells(modes));
            match reading.sign {
                Sign::Undecided => self.open.push((self.number, modes.to_vec())),
                sign => {
                    if sign != Sign::Negative && bound.growth() > F64_SERVES {
                        self.coarse.push((self.number, modes.to_vec()));
                    }
                    let motion = || motion(leaf, modes, self.problem, |number| number);
                    self.found.take_regular(self.number, modes, self.problem, reading, index_of(leaf.pivots), motion);
                }
            }
            self.number += 1;
        }
        self.found.total = self.number;
    }
}

/// Beyond this growth of rounding, f64 has lost the digits that an answer is expected to have.
const F64_SERVES: f64 = 1e4;

/// What an answer's numbers may be off by, in the scale of margins.
const DIGITS: f64 = 1e-12;

/// Combinations whose signs hang on more digits.
struct Open<'a, 'f> {
    problem: &'a ContactProblem,
    scale: &'a Scale,
    open: Vec<(usize, Vec<Mode>)>,
    /// Outcomes that were settled with fewer digits than an answer is expected to have.
    coarse: Vec<(usize, Vec<Mode>)>,
    found: &'a mut Found<'f>,
}

impl Question for Open<'_, '_> {
    fn ask<T: Ordered>(&mut self, exact: &ContactProblem<T>, layer: Layer) -> bool {
        let mut tableau = Tableau::<T>::new();
        tableau.load(exact);
        let before = self.open.len();
        let Self { problem, scale, open, coarse, found } = self;
        // What the contacts' dependence excludes is not solved for; where it cannot be told, all is.
        let kernel = T::freeing(|| Kernel::of(exact)).unwrap_or_default();
        let mut left = layer.combinations();
        open.retain(|(number, modes)| {
            if let Some(because) = kernel.excludes(modes) {
                found.reject(*number, modes, because, None, None);
                return false;
            }
            if left == 0 {
                return true;
            }
            left -= 1;
            match T::freeing(|| combination(&mut tableau, exact, problem, scale, modes)) {
                Ok(settled) if found.asked.explain.tells(modes) && layer != Layer::Precise && settled.is_vague() => {
                    true
                }
                Ok(settled) => {
                    if settled.error().is_some_and(|error| error > DIGITS) {
                        coarse.push((*number, modes.clone()));
                    }
                    found.take(*number, modes, problem, settled);
                    false
                }
                Err(_) => true,
            }
        });
        layer.count(&mut self.found.effort, before - self.open.len());
        self.open.is_empty()
    }
}

/// Outcomes whose numbers are worth more digits.
struct Coarse<'a, 'f> {
    problem: &'a ContactProblem,
    scale: &'a Scale,
    coarse: Vec<(usize, Vec<Mode>)>,
    found: &'a mut Found<'f>,
}

impl Question for Coarse<'_, '_> {
    fn ask<T: Ordered>(&mut self, exact: &ContactProblem<T>, _: Layer) -> bool {
        let mut tableau = Tableau::<T>::new();
        tableau.load(exact);
        let Self { problem, scale, coarse, found } = self;
        coarse.retain(|(number, modes)| match T::freeing(|| combination(&mut tableau, exact, problem, scale, modes)) {
            Ok(settled) if settled.error().is_some_and(|error| error <= DIGITS) => {
                found.outcomes.retain(|own| own.number != *number);
                found.take(*number, modes, problem, settled);
                false
            }
            _ => true,
        });
        coarse.is_empty()
    }
}

fn verdict(contacts: usize, outcomes: &[Outcome]) -> Verdict {
    if contacts == 0 {
        return Verdict::NoContact;
    }
    if outcomes.iter().any(|outcome| !outcome.decided) {
        return Verdict::Undecided;
    }
    match outcomes {
        [] => Verdict::None,
        // A family too short for f64 to tell its ends apart is one all the same.
        [only] if only.family => Verdict::Ambiguous,
        [only] if only.impulse.iter().flatten().all(|&entry| entry == 0.0) => Verdict::NoImpact,
        [_] => Verdict::Unique,
        _ => Verdict::Ambiguous,
    }
}

/// Whether some outcome has no sliding contact; none where that hangs on an undecided combination.
fn no_slip_consistent(outcomes: &[Outcome]) -> Option<bool> {
    let without_slip = || outcomes.iter().filter(|outcome| !outcome.modes.iter().any(|mode| mode.slides()));
    match without_slip().any(|outcome| outcome.decided) {
        false if without_slip().next().is_some() => None,
        found => Some(found),
    }
}

/// Whether f64 shows that G is regular: for problems with a frictionless contact, none of whose combinations solves for all
/// impulses.
fn shows_regular(tableau: &mut Tableau<f64>, bounds: &mut Bounds, contacts: usize) -> bool {
    tableau.stick_all(|tableau, contact| bounds.follow(tableau, contact, contact));
    bounds.at(contacts).impulse_error().is_finite()
}

/// Rank of G and, where it is regular, the condition number of G scaled to a unit diagonal.
fn rank_and_condition<S: Source>(
    problem: &ContactProblem,
    source: &S,
    scale: &Scale,
    regular: bool,
    reductions: Reductions,
) -> (usize, Option<f64>) {
    let rows = 2 * problem.contacts();
    if rows == 0 {
        return (0, None);
    }
    let mobility = &scale.mobility;
    let [least, greatest] = match problem.contacts() {
        1 if reductions.lone => lone::eigenvalues(problem, mobility),
        _ => {
            let scaled = DMatrix::from_fn(rows, rows, |i, j| problem.delassus(i, j) / (mobility[i] * mobility[j]));
            let values = scaled.symmetric_eigenvalues();
            [values.min(), values.max()]
        }
    };
    if regular && greatest < F64_CONDITION_LIMIT * least {
        return (rows, Some(greatest / least));
    }
    let mut inverse = Inverse { mobility: mobility.clone(), ..Inverse::default() };
    settle(source, Layer::Ball, &mut inverse);
    match inverse.rank {
        Some(rank) if rank < rows => (rank, None),
        Some(rank) => {
            let inverse = DMatrix::from_fn(rows, rows, |i, j| 0.5 * (inverse.rows[i][j] + inverse.rows[j][i]));
            let condition = greatest * inverse.symmetric_eigenvalues().max();
            (rank, condition.is_finite().then_some(condition))
        }
        // No precision tells a rank that is not the whole from one that is.
        None => (rows, None),
    }
}

/// Beyond this the least eigenvalue of G has lost half of its digits.
const F64_CONDITION_LIMIT: f64 = 1e8;

/// The sign of the product of the pivots.
pub(super) fn index_of(pivots: &[f64]) -> i8 {
    pivots.iter().fold(1, |sign, &pivot| if pivot < 0.0 { -sign } else { sign })
}

/// Impulses and velocities of a leaf.
pub(super) fn motion<T: Real>(
    leaf: &Leaf<'_, T>,
    modes: &[Mode],
    problem: &ContactProblem,
    nearest: impl Fn(T) -> f64,
) -> Motion {
    let contacts = 0..problem.contacts();
    let velocity = |contact: usize| {
        let [c_t, xi_n] = leaf.velocity(contact).map(&nearest);
        let c_t = if modes[contact] == Mode::Stick { 0.0 } else { c_t };
        [c_t, xi_n - problem.bounce(contact)]
    };
    Motion {
        impulse: contacts.clone().map(|contact| leaf.impulse(contact).map(&nearest)).collect(),
        velocity_after: contacts.map(velocity).collect(),
    }
}

/// An outcome and where it was found.
struct Numbered {
    /// The number of the list of modes that led to it.
    number: usize,
    /// An end of a family whose own modes are not those.
    on_rim: bool,
    outcome: Outcome,
}

/// What has been found so far.
struct Found<'a> {
    asked: Asked<'a>,
    outcomes: Vec<Numbered>,
    rejected: Vec<(usize, Rejection)>,
    effort: Effort,
    /// Lists of modes in all.
    total: usize,
}

impl Default for Found<'_> {
    fn default() -> Self {
        let asked = Asked::default();
        Self { asked, outcomes: Vec::new(), rejected: Vec::new(), effort: Effort::default(), total: 0 }
    }
}

impl Found<'_> {
    fn take(&mut self, number: usize, modes: &[Mode], problem: &ContactProblem, settled: Settled) {
        match settled {
            Settled::Regular { reading, index, motion, .. } => {
                self.take_regular(number, modes, problem, reading, index, || motion);
            }
            Settled::Singular(Judged::Rejected { because, margin, motion }) => {
                self.reject(number, modes, because, margin, motion);
            }
            Settled::Singular(Judged::Valid(member)) => {
                let outcome = self.outcome_of(member, problem);
                self.outcomes.push(Numbered { number, on_rim: false, outcome });
            }
            Settled::Singular(Judged::Family(ends)) => {
                for end in ends {
                    let on_rim = end.modes != modes;
                    let outcome = Outcome { family: true, ..self.outcome_of(end, problem) };
                    self.outcomes.push(Numbered { number, on_rim, outcome });
                }
            }
        }
    }

    fn take_regular(
        &mut self,
        number: usize,
        modes: &[Mode],
        problem: &ContactProblem,
        reading: Reading,
        index: i8,
        motion: impl FnOnce() -> Motion,
    ) {
        if reading.sign == Sign::Negative {
            let solved = !matches!(reading.because, RejectionReason::NothingHolds { .. });
            let motion = (self.asked.explain.tells(modes) && solved).then(motion);
            self.reject(number, modes, reading.because, reading.margin, motion);
            return;
        }
        let mut outcome = self.outcome(modes, problem, motion(), &reading.at_zero);
        outcome.index = reading.at_zero.is_empty().then_some(index);
        outcome.margin = reading.margin.map(|margin| margin + 0.0);
        self.outcomes.push(Numbered { number, on_rim: false, outcome });
    }

    fn outcome_of(&self, member: Member, problem: &ContactProblem) -> Outcome {
        Outcome {
            index: member.index,
            margin: member.margin,
            impulse_unique: member.range.is_none(),
            impulse_range: member.range,
            ..self.outcome(&member.modes, problem, member.motion, &member.at_zero)
        }
    }

    /// A decided outcome with a unique impulse; index and margin are the caller's.
    fn outcome(
        &self,
        modes: &[Mode],
        problem: &ContactProblem,
        motion: Motion,
        at_zero: &[(usize, Inequality)],
    ) -> Outcome {
        let border = border(modes, problem.laws(), at_zero, &motion);
        let mut outcome = Outcome {
            modes: modes.to_vec(),
            impulse: Vec::new(),
            velocity_after: Vec::new(),
            energy_loss: 0.0,
            impulse_unique: true,
            impulse_range: None,
            friction_needed: Vec::new(),
            index: None,
            margin: None,
            border,
            family: false,
            proven: self.asked.prove,
            decided: true,
        };
        outcome.set_motion(motion, problem.velocity_before());
        outcome
    }

    /// Lists a combination that no layer settled, with the impulse zero in place of one that is not known.
    fn leave_open(&mut self, number: usize, modes: &[Mode], problem: &ContactProblem) {
        let motion = Motion { impulse: vec![[0.0; 2]; modes.len()], velocity_after: problem.velocity_free().to_vec() };
        let outcome = Outcome { decided: false, proven: false, ..self.outcome(modes, problem, motion, &[]) };
        self.outcomes.push(Numbered { number, on_rim: false, outcome });
    }

    /// An end of a family on its rim is the outcome, or the end, of other modes: it is told once, and as theirs.
    fn join_families(&mut self, scale: &Scale) {
        let same =
            |a: &Outcome, b: &Outcome| a.modes == b.modes && scale.same_velocity(&a.velocity_after, &b.velocity_after);
        let mut index = 0;
        while index < self.outcomes.len() {
            let end = &self.outcomes[index];
            let twin = self.outcomes.iter().enumerate().position(|(other, own)| {
                let again = end.on_rim || own.number == end.number;
                end.outcome.family && other != index && again && same(&own.outcome, &end.outcome)
            });
            match twin {
                Some(twin) => {
                    let outcome = &mut self.outcomes[twin].outcome;
                    outcome.family = true;
                    outcome.index = None;
                    self.outcomes.remove(index);
                }
                None => index += 1,
            }
        }
    }

    fn reject(
        &mut self,
        number: usize,
        modes: &[Mode],
        because: RejectionReason,
        margin: Option<f64>,
        motion: Option<Motion>,
    ) {
        if self.asked.explain.tells(modes) {
            let (margin, motion) = (margin.filter(|margin| margin.is_finite()), motion.filter(Motion::is_finite));
            self.rejected.push((number, Rejection { modes: modes.to_vec(), because, margin, motion }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Friction;

    #[test]
    fn more_contacts_than_are_tried_are_refused() {
        let contacts = CONTACT_LIMIT + 1;
        let rows = 2 * contacts;
        let identity = (0..rows * rows).map(|k| f64::from(u8::from(k % (rows + 1) == 0))).collect();
        let problem = ContactProblem::new(
            identity,
            vec![[0.0, -1.0]; contacts],
            vec![Friction::Infinite; contacts],
            vec![0.0; contacts],
        )
        .unwrap();
        let refused = analyse(&problem, false).unwrap_err();
        assert_eq!(refused.reason(), &Reason::TooManyContacts { contacts, limit: CONTACT_LIMIT });
    }
}
