//! Collects what the passes over all combinations find.

use super::digits::{Numbers, Solution};
use super::outcome::{AtZero, Border, Effort, Family, Motion, Outcome, Rejection};
use super::problem::ContactProblem;
use super::singular::Solved;
use super::slack::Scale;
use crate::law::{Inequality, Law, Mode};
use crate::reductions::Reductions;
use std::cmp::Ordering;
use std::mem::take;

/// The most contacts for which all rejected combinations are listed, each with its reason.
pub const EXPLAINED: usize = 6;

/// Which rejected combinations an analysis lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ListedRejections<'a> {
    /// No rejected combination.
    Nothing,
    /// All rejected combinations and the paper's section 4 for each contact. With more than [`EXPLAINED`] contacts,
    /// only the combinations that a search does not exclude.
    Everything,
    /// Only the rejected combinations with these modes.
    Only(&'a [Vec<Mode>]),
}

impl ListedRejections<'_> {
    /// Whether a rejected combination with these modes is listed.
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

/// What an analysis computes of a contact problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AnalysisOptions<'a> {
    /// Which rejected combinations are listed.
    pub rejections: ListedRejections<'a>,
    /// Whether the errors of the source are bounds, so that what is decided is proven.
    pub prove: bool,
    /// Whether to leave out the rank and condition of G, and the borders of outcomes.
    pub brief: bool,
    /// The parts of the enumeration that are left out if a problem does not need them.
    pub reductions: Reductions,
}

impl Default for AnalysisOptions<'_> {
    fn default() -> Self {
        Self { rejections: ListedRejections::Nothing, prove: true, brief: false, reductions: Reductions::ALL }
    }
}

/// The most undecided combinations that are listed; there may be 4^n.
const LISTED: u64 = 100;

/// A combination that needs more digits. Its number among all 4^n, from 0, has the modes as digits in base 4.
#[derive(Debug, Clone)]
pub struct Pending {
    pub number: u64,
    pub modes: Vec<Mode>,
}

/// The number of answers whose memory is kept.
pub const RECYCLED: usize = 16;

/// Memory of outcomes that is reused.
#[derive(Debug, Clone, Default)]
pub struct OutcomeMemory {
    outcomes: Vec<Outcome>,
    /// Lists without outcomes.
    spare: Vec<Vec<Outcome>>,
    /// The number of the combination of each outcome.
    numbers: Vec<u64>,
    lists: Vec<OutcomeLists>,
    at_zero: Vec<(usize, Inequality)>,
}

/// The lists of an outcome, as reusable memory.
#[derive(Debug, Clone, Default)]
pub struct OutcomeLists {
    pub modes: Vec<Mode>,
    pub motion: Motion,
    pub friction_needed: Vec<Option<f64>>,
}

impl OutcomeMemory {
    /// Takes the memory of outcomes that are no longer needed.
    pub fn recycle(&mut self, mut outcomes: Vec<Outcome>) {
        let room = (4 * RECYCLED).saturating_sub(self.lists.len());
        // Few states have more than four. Only the lists are moved, because an outcome is large.
        self.lists.extend(outcomes.iter_mut().take(room).map(|old| {
            let motion = Motion { impulse: take(&mut old.impulse), velocity_after: take(&mut old.velocity_after) };
            OutcomeLists { modes: take(&mut old.modes), motion, friction_needed: take(&mut old.friction_needed) }
        }));
        outcomes.clear();
        if self.spare.len() < RECYCLED {
            self.spare.push(outcomes);
        }
    }
}

/// The families of a problem, each with its dimension and the places of its corners in `corners`.
#[derive(Default)]
pub struct FoundFamilies {
    pub families: Vec<(Pending, usize, Vec<usize>)>,
    pub corners: Vec<Corner>,
    /// Combinations that have too many corners, or whose corners are not known.
    pub open: Vec<Pending>,
}

/// A corner that one or more families share.
pub enum Corner {
    /// The outcome at this place: its velocity is the only one of its modes.
    Isolated(usize),
    /// A velocity of the family with this combination number, one of many with its modes.
    OfFamily(u64, Solution),
}

/// Everything that was found, in the order of the combinations.
#[derive(Default)]
pub struct Findings {
    pub outcomes: Vec<Outcome>,
    pub families: Vec<Family>,
    /// The rejected combinations that are listed, and the number of those that were requested but are not listed.
    pub rejected: Vec<Rejection>,
    pub unlisted: u64,
    pub effort: Effort,
    /// How many combinations were visited, and how many of these no precision decided.
    pub visited: u64,
    pub undecided: u64,
}

/// The outcomes, families and rejected combinations of a problem while they are found.
pub struct Collected<'a> {
    pub problem: &'a ContactProblem,
    pub scale: &'a Scale,
    pub options: AnalysisOptions<'a>,
    name: &'a dyn Fn(usize) -> String,
    /// Counts; the lists stay empty until [`Self::finish`].
    pub found: Findings,
    memory: &'a mut OutcomeMemory,
    /// Combinations whose velocities form a set.
    pub pending_families: Vec<Pending>,
    /// With the number of each family's combination. Until [`Self::finish`], corners are in the order of discovery.
    families: Vec<(u64, Family)>,
    rejected: Vec<(u64, Rejection)>,
}

impl<'a> Collected<'a> {
    pub fn new(
        problem: &'a ContactProblem,
        scale: &'a Scale,
        options: AnalysisOptions<'a>,
        name: &'a dyn Fn(usize) -> String,
        memory: &'a mut OutcomeMemory,
    ) -> Self {
        memory.outcomes = memory.spare.pop().unwrap_or_default();
        memory.numbers.clear();
        Self {
            problem,
            scale,
            options,
            name,
            found: Findings::default(),
            memory,
            pending_families: Vec::new(),
            families: Vec::new(),
            rejected: Vec::new(),
        }
    }

    /// Adds a combination that was solved with more digits than f64 has.
    pub fn add(&mut self, pending: &Pending, solved: Solved) {
        let &Pending { number, ref modes } = pending;
        match solved {
            Solved::Outcome(outcome) => self.push(number, outcome),
            Solved::Rejected(rejection) => self.reject(number, modes, || rejection),
            Solved::Family(()) => self.pending_families.push(pending.clone()),
        }
    }

    /// Takes memory for the `at_zero` of a reading.
    pub fn at_zero(&mut self) -> Vec<(usize, Inequality)> {
        take(&mut self.memory.at_zero)
    }

    /// Takes memory for the lists of an outcome.
    pub fn lists(&mut self) -> OutcomeLists {
        self.memory.lists.pop().unwrap_or_default()
    }

    /// Counts a combination that no precision decided, and lists the first ones with zeros for the unknown impulses.
    pub fn add_undecided(&mut self, Pending { number, modes }: Pending) {
        self.found.undecided += 1;
        if self.found.undecided > LISTED {
            return;
        }
        let velocity_after = self.problem.velocity_free().to_vec();
        let motion = Motion { impulse: vec![[0.0; 2]; modes.len()], velocity_after };
        let numbers = Numbers::of_motion(motion, &modes, self.problem, Vec::new());
        self.push(number, Solution { modes, numbers, index: None, margin: None, range: None, at_zero: Vec::new() });
        if let Some(outcome) = self.memory.outcomes.last_mut() {
            (outcome.decided, outcome.proven) = (false, false);
        }
    }

    /// Adds a rejected combination, if it is to be listed.
    pub fn reject(&mut self, number: u64, modes: &[Mode], rejection: impl FnOnce() -> Rejection) {
        if self.options.rejections.contain(modes) {
            let mut rejection = rejection();
            rejection.margin = rejection.margin.filter(|margin| margin.is_finite()).map(|margin| margin + 0.0);
            rejection.motion = rejection.motion.filter(Motion::is_finite).map(Motion::unsigned);
            self.rejected.push((number, rejection));
        }
    }

    /// The place of the decided outcome with these modes.
    pub fn place_of(&self, modes: &[Mode]) -> Option<usize> {
        self.memory.outcomes.iter().position(|outcome| outcome.decided && outcome.modes == modes)
    }

    /// Adds families and their corners, once all other outcomes are known.
    pub fn add_families(&mut self, found: FoundFamilies) {
        let mut places = Vec::new();
        for corner in found.corners {
            let place = match corner {
                Corner::Isolated(place) => place,
                Corner::OfFamily(number, outcome) => {
                    self.push(number, outcome);
                    self.memory.outcomes.len() - 1
                }
            };
            let outcome = &mut self.memory.outcomes[place];
            (outcome.family, outcome.index) = (true, None);
            places.push(place);
        }
        for (Pending { number, modes }, dimension, corners) in found.families {
            let corners = corners.into_iter().map(|corner| places[corner]).collect();
            self.families.push((number, Family { modes, dimension, corners }));
        }
        for pending in found.open {
            self.add_undecided(pending);
        }
    }

    pub fn finish(mut self) -> Findings {
        let found = &mut self.found;
        found.effort.bound = found.visited - found.effort.ball - found.effort.double_double - found.effort.precise;
        if !self.families.is_empty() {
            let numbers = &self.memory.numbers;
            let mut order: Vec<usize> = (0..numbers.len()).collect();
            order.sort_by_key(|&found| numbers[found]);
            let mut places = vec![0; order.len()];
            for (place, found) in order.into_iter().enumerate() {
                places[found] = place;
            }
            for (_, family) in &mut self.families {
                family.corners.iter_mut().for_each(|corner| *corner = places[*corner]);
                family.corners.sort_unstable();
            }
            self.families.sort_by_key(|(number, _)| *number);
        }
        let mut outcomes = take(&mut self.memory.outcomes);
        if !self.memory.numbers.is_sorted() {
            let mut numbered: Vec<_> = self.memory.numbers.iter().zip(outcomes.drain(..)).collect();
            numbered.sort_by_key(|&(number, _)| number);
            outcomes.extend(numbered.into_iter().map(|(_, outcome)| outcome));
        }
        self.rejected.sort_by_key(|(number, _)| *number);
        let (families, rejected) = (unnumbered(self.families), unnumbered(self.rejected));
        Findings { outcomes, families, rejected, ..self.found }
    }

    /// Adds an outcome. It is built in place, because a large value that was just written is slow to move.
    pub fn push(&mut self, number: u64, Solution { modes, numbers, index, margin, range, mut at_zero }: Solution) {
        let Numbers { motion, energy_loss, friction_needed, are_precise } = numbers;
        let border = match self.options.brief {
            true => None,
            false => border(&modes, self.problem.laws(), &at_zero, &motion, self.name),
        };
        at_zero.clear();
        self.memory.at_zero = at_zero;
        let Motion { impulse, velocity_after } = motion.unsigned();
        self.memory.numbers.push(number);
        self.memory.outcomes.push(Outcome {
            modes,
            impulse,
            velocity_after,
            base_velocity_after: None,
            joint_velocity_after: None,
            loop_impulse: None,
            energy_loss: energy_loss + 0.0,
            impulse_unique: range.is_none(),
            impulse_range: range,
            friction_needed,
            index,
            margin,
            border,
            family: false,
            proven: self.options.prove && are_precise,
            decided: true,
            next: None,
        });
    }
}

/// Removes the numbers of a list. The list is nearly always empty, and collecting in place is slow to begin.
fn unnumbered<T>(listed: Vec<(u64, T)>) -> Vec<T> {
    if listed.is_empty() { Vec::new() } else { listed.into_iter().map(|(_, entry)| entry).collect() }
}

/// The border of an outcome, where the impulse inequalities `at_zero` are zero; `None` if there are none.
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
        let of_contact = || at_zero.iter().filter(|(place, _)| *place == contact).map(|&(_, inequality)| inequality);
        // Without normal impulse, the slack of the friction cone is zero as well.
        let unpressed = of_contact().find(|&inequality| inequality == Inequality::NormalImpulse);
        let Some(inequality) = unpressed.or_else(|| of_contact().next()) else { continue };
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
            // At the edge of its cone, a contact may begin the slide that its friction resists.
            (0.5, vec![(0, FrictionCone)], vec![("0", FrictionCone)], vec![[Mode::SlideMinus, Mode::Stick]]),
            // Without normal impulse, any mode may follow.
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
