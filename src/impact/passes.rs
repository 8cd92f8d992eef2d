//! The passes over all combinations: first in f64, then with more digits over those that need them.

use super::collected::{Collected, OutcomeLists, Pending};
use super::combination::CombinationSolver;
use super::digits::{Numbers, after, f64_has_digits};
use super::enumerate::{Labels, Leaf, Visitor};
use super::kernel::Kernel;
use super::linear::Unsettled;
use super::outcome::{Motion, Rejection, RejectionReason};
use super::problem::{ContactProblem, Precision, PrecisionTask};
use super::reading::{motion, read, rejects};
use super::singular::Solved;
use super::slack::Scale;
use crate::budget::{ROUNDS, is_spent_after};
use crate::law::{Impulse, Law, Mode};
use crate::planar::Pair;
use crate::scalar::{Ordered, Rounded, Sign};

/// The most combinations that are tried with many digits; the rest would take too long and stay undecided.
const PRECISE_COMBINATIONS: usize = 2_000;

/// The pass over all combinations in f64.
pub struct F64Pass<'a, 'm> {
    pub labels: &'m mut Labels,
    /// Whether modes with the same impulses are visited as one.
    pub shares: bool,
    /// Whether G was shown to be regular.
    pub regular: bool,
    /// The combinations whose signs f64 does not decide, or whose numbers lack digits in f64.
    pub undecided: Vec<Undecided>,
    /// A reference, because the value is large and slow to move.
    pub collected: &'m mut Collected<'a>,
}

impl Visitor<Rounded> for F64Pass<'_, '_> {
    fn ends(&mut self) -> bool {
        is_spent_after(ROUNDS)
    }

    fn drops(&mut self, modes: &[Mode], last: &Pair<Rounded>) -> bool {
        let Self { shares, regular, collected, .. } = self;
        let laws = collected.problem.laws();
        let (Some(&mode), Some(law)) = (modes.last(), laws.last()) else { return false };
        // Needed are leaves that stand for several combinations, and the one that may show that G is regular.
        let is_wanted = *shares || !*regular && is_free(modes, laws) || collected.options.rejections.contain(modes);
        let drops = !is_wanted && rejects(last, mode, law);
        collected.found.visited += u64::from(drops);
        drops
    }

    fn leaf(&mut self, leaf: &Leaf<'_, Rounded>) {
        let Self { labels, shares, regular, undecided, collected } = self;
        let Collected { problem, scale, options, .. } = **collected;
        let laws = problem.laws();
        // If every impulse is unknown, the pivots are those of the whole matrix G.
        *regular = *regular || is_free(leaf.modes, laws) && leaf.is_known();
        labels.visit(leaf.modes, laws, *shares, |modes| {
            collected.found.visited += 1;
            let mut contacts = modes.iter().zip(laws).enumerate();
            let is_rejected = contacts.any(|(contact, (&mode, law))| rejects(leaf.numbers(contact), mode, law));
            if is_rejected && !options.rejections.contain(modes) {
                return;
            }
            let number = modes.iter().fold(0, |number, &mode| 4 * number + mode as u64);
            let reading = read(leaf, modes, laws, scale, collected.at_zero());
            let after = |contact: usize, xi: Pair<Rounded>| after(xi.map(|entry| entry.value), contact, modes, problem);
            let motion = |memory| motion(leaf, after, memory);
            let pending = || Pending { number, modes: modes.to_vec() };
            if reading.sign == Sign::Negative {
                let is_provisional = reading.is_provisional();
                let rejection = || Rejection::read(modes, reading, || motion(Motion::default()));
                return match is_provisional {
                    true => {
                        let imprecise = Some(Solved::Rejected(rejection()));
                        undecided.push(Undecided { pending: pending(), imprecise });
                    }
                    false => collected.reject(number, modes, rejection),
                };
            }
            if reading.sign == Sign::Positive {
                let OutcomeLists { modes: mut own_modes, motion: memory, friction_needed } = collected.lists();
                let motion = motion(memory);
                if f64_has_digits(leaf, modes, (problem, scale), (&motion, reading.margin)) {
                    let sign = |sign: i8, pivot: &Rounded| if pivot.value < 0.0 { -sign } else { sign };
                    let index = leaf.pivots.iter().fold(1, sign);
                    modes.clone_into(&mut own_modes);
                    let numbers = Numbers::of_motion(motion, modes, problem, friction_needed);
                    return collected.push(number, reading.solution(own_modes, index, numbers));
                }
            }
            undecided.push(Undecided { pending: pending(), imprecise: None });
        });
    }
}

/// Whether both entries of every contact's impulse are unknowns.
fn is_free(modes: &[Mode], laws: &[Law]) -> bool {
    modes.iter().zip(laws).all(|(&mode, law)| law.impulse(mode) == Impulse::Free)
}

/// A combination whose signs or numbers need more digits.
pub struct Undecided {
    pub pending: Pending,
    /// The solution so far, if only its numbers or the reason of a rejection lack digits.
    imprecise: Option<Solved>,
}

/// The pass over the combinations that need more digits than f64 has.
pub struct UndecidedPass<'a, 'c> {
    pub undecided: Vec<Undecided>,
    /// Combinations that are listed but are not outcomes. They are solved only to find the reason of the rejection.
    pub rejected: Vec<Undecided>,
    /// Whether all combinations that may be outcomes are decided, and only reasons are missing.
    pub is_decided: bool,
    /// The relations of dependent contacts, once they are known.
    pub kernel: Option<Kernel>,
    /// The relations of contacts that share a tangential row, which are known before.
    pub shared: Kernel,
    pub collected: &'c mut Collected<'a>,
}

impl UndecidedPass<'_, '_> {
    /// Starts the search for the reasons of the rejected combinations; returns false if there are none.
    pub fn begin_reasons(&mut self) -> bool {
        (self.undecided, self.is_decided) = (std::mem::take(&mut self.rejected), true);
        !self.undecided.is_empty()
    }

    /// Adds the combinations that no precision finished: those whose numbers lack digits, and those with open signs.
    pub fn finish(&mut self) {
        for Undecided { pending, imprecise } in std::mem::take(&mut self.undecided) {
            if let Some(solved) = imprecise {
                self.collected.add(&pending, solved);
            } else if let Some(because) = self.excludes(&pending) {
                let rejection = || Rejection::of(&pending.modes, because);
                self.collected.reject(pending.number, &pending.modes, rejection);
            } else {
                self.collected.add_undecided(pending);
            }
        }
    }

    fn excludes(&self, pending: &Pending) -> Option<RejectionReason> {
        self.kernel.as_ref().unwrap_or(&self.shared).excludes(&pending.modes, self.collected.problem.laws())
    }
}

impl PrecisionTask for UndecidedPass<'_, '_> {
    fn attempt<T: Ordered>(&mut self, exact: &ContactProblem<T>, precision: Precision) -> bool {
        let mut open = std::mem::take(&mut self.undecided);
        let before = open.len();
        // Numbers that are not built around the f64 problem have magnitudes of their own.
        let is_enclosed = precision == Precision::Enclosed;
        let scale = if is_enclosed { self.collected.scale.clone() } else { Scale::of(exact) };
        if !is_enclosed && self.kernel.is_none() {
            self.kernel = T::freeing(|| Kernel::of(exact)).ok();
        }
        let rejections = self.collected.options.rejections;
        if !self.is_decided {
            // Combinations that are rejected, or excluded by the kernel, are solved later, only to find the reason.
            let is_no = |entry: &Undecided| {
                matches!(entry.imprecise, Some(Solved::Rejected(_))) || self.excludes(&entry.pending).is_some()
            };
            let (no, perhaps): (Vec<_>, _) = open.into_iter().partition(is_no);
            self.rejected.extend(no.into_iter().filter(|entry| rejections.contain(&entry.pending.modes)));
            open = perhaps;
        }
        let is_last = precision == Precision::Interval;
        let (rounds, most) = if is_last { (ROUNDS, PRECISE_COMBINATIONS) } else { (1, usize::MAX) };
        let mut solver = CombinationSolver::new(exact, scale);
        for (place, Undecided { pending, imprecise }) in open.into_iter().enumerate() {
            let stops = place >= most || is_spent_after(rounds);
            let solved = if stops { Err(Unsettled) } else { solver.solve(&pending.modes) };
            match solved {
                Ok(solved) if solved.is_provisional() && rejections.contain(&pending.modes) => {
                    let left = if self.is_decided { &mut self.undecided } else { &mut self.rejected };
                    left.push(Undecided { pending, imprecise: Some(solved) });
                }
                // The velocity is that of other combinations because contacts are dependent, not because of a border.
                Ok(Solved::Rejected(Rejection { because: RejectionReason::OnBorder, .. }))
                    if self.excludes(&pending).is_some() =>
                {
                    let twin = Rejection::of(&pending.modes, RejectionReason::RedundantTwin);
                    self.collected.add(&pending, Solved::Rejected(twin));
                }
                Ok(solved) if solved.is_precise() => self.collected.add(&pending, solved),
                Ok(solved) => self.undecided.push(Undecided { pending, imprecise: Some(solved) }),
                Err(Unsettled) => self.undecided.push(Undecided { pending, imprecise }),
            }
        }
        if !self.is_decided {
            *precision.share(&mut self.collected.found.effort) += (before - self.undecided.len()) as u64;
        }
        // For the reasons of combinations that the kernel excludes, the first intervals are precise enough.
        let is_enough = |entry: &Undecided| self.is_decided && is_last && self.excludes(&entry.pending).is_some();
        self.undecided.iter().all(is_enough)
    }
}
