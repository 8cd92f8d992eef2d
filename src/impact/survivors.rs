//! A search tree over the modes of many contacts, which finds the combinations that are not excluded.
//!
//! The modes of the contacts are decided one after the other. If the [`Relaxation`] shows that the modes chosen so far
//! are impossible, all combinations that begin with them are excluded. If its error bound does not show this, numbers
//! with more digits may. Otherwise the search continues below.

use super::collected::ListedRejections;
use super::kernel::Kernel;
use super::outcome::Effort;
use super::problem::{ContactProblem, Precision, PrecisionTask, Remembered, escalate};
use super::relaxation::{Claim, Lack, Relaxation};
use super::slack::Scale;
use crate::budget::{ROUNDS, is_spent_after};
use crate::law::{Law, Mode};
use crate::scalar::Ordered;

/// From this number of contacts on, combinations are searched as a tree; with fewer contacts all are visited.
pub const SEARCHED: usize = 4;

/// Finds the combinations that may be outcomes.
pub struct Search<'a> {
    relaxation: &'a mut Relaxation,
    laws: &'a [Law],
    without_slip: bool,
    /// Combinations that are kept in any case.
    listed: &'a [Vec<Mode>],
    modes: Vec<Mode>,
    /// The combinations that may be outcomes.
    pub survivors: Vec<Vec<Mode>>,
    /// Claims of f64 that have not been shown yet.
    open: Vec<Claim>,
    /// The relations of dependent contacts, once they were computed.
    pub kernel: Option<Kernel>,
    /// How many combinations were shown to be impossible with more digits than f64 has.
    pub effort: Effort,
    /// How many combinations were neither visited nor excluded.
    pub unvisited: u64,
}

impl<'a> Search<'a> {
    /// Searches all combinations, or those `without_slip`. Combinations that the `rejections` list by name survive.
    pub fn of(
        (problem, remembered, shared): (&'a ContactProblem, &Remembered<'_>, &[Option<usize>]),
        scale: &Scale,
        relaxation: &'a mut Relaxation,
        without_slip: bool,
        rejections: ListedRejections<'a>,
    ) -> Self {
        relaxation.load(problem, scale, remembered.source.errors());
        relaxation.learn_from(&Kernel::of_shared(shared));
        let (modes, survivors, open, kernel) = (Vec::new(), Vec::new(), Vec::new(), None);
        let (laws, effort) = (problem.laws(), Effort::default());
        let listed = if let ListedRejections::Only(listed) = rejections { listed } else { &[] };
        let mut search =
            Self { relaxation, laws, without_slip, listed, modes, survivors, open, kernel, effort, unvisited: 0 };
        search.descend(&mut |relaxation, modes, lack| {
            if relaxation.shows(modes.len() - 1, lack) { Finding::Impossible } else { Finding::Open }
        });
        if !search.open.is_empty() {
            let first = Precision::first(search.relaxation.is_regular, problem);
            escalate(remembered, first, &mut search);
        }
        search.unvisited += search.open.iter().map(|claim| combinations(&laws[claim.modes.len()..])).sum::<u64>();
        search.survivors.sort_unstable();
        search
    }

    /// Searches below the modes that are decided. `shown` checks modes that f64 finds impossible.
    fn descend(&mut self, shown: &mut impl FnMut(&mut Relaxation, &[Mode], Lack) -> Finding) {
        let contact = self.modes.len();
        if contact == self.laws.len() {
            return self.survivors.push(self.modes.clone());
        }
        if is_spent_after(1) {
            self.unvisited += combinations(&self.laws[contact..]);
            return;
        }
        for &mode in self.laws[contact].modes().iter().copied().flatten() {
            if self.without_slip && mode.slides() {
                continue;
            }
            self.modes.push(mode);
            let begins = |modes: &Vec<Mode>| modes.len() == self.laws.len() && modes.starts_with(&self.modes);
            let is_listed = self.listed.iter().any(begins);
            if !is_listed && self.relaxation.excludes(contact, mode) {
                self.modes.pop();
                continue;
            }
            let lack = self.relaxation.decide(contact, mode).filter(|_| !is_listed);
            match lack.map_or(Finding::Possible, |lack| shown(self.relaxation, &self.modes, lack)) {
                Finding::Possible => self.descend(shown),
                Finding::Impossible => {}
                Finding::Open => {
                    self.open.extend(lack.map(|lack| self.relaxation.claim(&self.modes, lack)));
                }
            }
            self.modes.pop();
        }
    }
}

/// What is known about the modes of the first contacts.
enum Finding {
    Possible,
    Impossible,
    Open,
}

/// The number of combinations of the modes that `laws` allow.
pub fn combinations(laws: &[Law]) -> u64 {
    laws.iter().map(|law| law.modes().iter().map(|group| group.len() as u64).sum::<u64>()).product()
}

impl PrecisionTask for Search<'_> {
    fn attempt<T: Ordered>(&mut self, problem: &ContactProblem<T>, precision: Precision) -> bool {
        if !self.relaxation.is_regular && self.kernel.is_none() {
            // A kernel that these numbers do not settle is not used.
            self.kernel = T::freeing(|| Kernel::of(problem)).ok();
            self.kernel.iter().for_each(|kernel| self.relaxation.learn_from(kernel));
        }
        // Claims that even intervals leave open are dropped; each combination below is then decided by itself.
        let is_last = precision == Precision::Interval;
        let mut impossible = 0;
        let mut find = |relaxation: &mut Relaxation, claim: &Claim| match relaxation.confirms(claim, problem) {
            Ok(true) => {
                impossible += combinations(&problem.laws()[claim.modes.len()..]);
                Finding::Impossible
            }
            Err(_) if !is_last || is_spent_after(ROUNDS) => Finding::Open,
            _ => Finding::Possible,
        };
        for claim in std::mem::take(&mut self.open) {
            match find(self.relaxation, &claim) {
                Finding::Impossible => {}
                Finding::Open => self.open.push(claim),
                Finding::Possible => {
                    self.modes.clear();
                    for &mode in &claim.modes {
                        self.relaxation.decide(self.modes.len(), mode);
                        self.modes.push(mode);
                    }
                    self.descend(&mut |relaxation, modes, lack| {
                        let claim = relaxation.claim(modes, lack);
                        find(relaxation, &claim)
                    });
                    self.modes.clear();
                }
            }
        }
        *precision.share(&mut self.effort) += impossible;
        self.open.is_empty()
    }
}
