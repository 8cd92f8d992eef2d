//! The summary of a whole batch.

use crate::error::visible;
use crate::impact::{Analysis, Outcome, Verdict};
use crate::law::Mode;
use crate::pipeline::robust::Robustness;
use crate::pipeline::{Aspect, Impact};
use crate::write::{notes, words};
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::fmt;
use std::sync::Arc;

/// The number of states with the smallest margins that are listed.
const NAMED: usize = 10;

/// The number of different lists of modes that are counted separately.
const LISTS: usize = 1000;

/// Counts over the states of a batch. Its size is bounded, and does not depend on how threads share the states.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[non_exhaustive]
pub struct Summary {
    /// The question about the states.
    #[serde(skip_serializing_if = "Aspect::is_impact")]
    pub question: Aspect,
    /// All states, including refused ones.
    pub states: u64,
    /// States that were refused, including those with too many contacts, whose matrices are still written.
    pub refused: u64,
    /// The number of other states with each verdict.
    pub verdicts: Verdicts,
    /// States that are undecided because the budget of work ended.
    #[serde(skip_serializing_if = "is_zero")]
    pub beyond_budget: u64,
    /// The states nearest to another answer, nearest first. Outcomes without impulses are skipped.
    pub smallest_margins: Vec<Nearest>,
    /// States in which feet slide because friction is too small.
    pub more_friction: MoreFriction,
    /// States in which some foot slides in every outcome, whatever the friction is.
    #[serde(skip_serializing_if = "is_zero")]
    pub slides_regardless: u64,
    /// States for which another state within the uncertainty has other outcomes.
    #[serde(skip_serializing_if = "is_zero")]
    pub not_holding: u64,
    /// States with an uncertainty.
    #[serde(skip)]
    pub uncertain: u64,
    /// States with contacts that were taken as exactly at rest because they are slow (`resting_speed`).
    pub resting: u64,
    /// The modes of the contacts, in the order of their first appearance: at most 1,000 different lists.
    pub modes: Vec<ModeCount>,
    /// The number of outcomes with further lists of modes.
    pub other_modes: u64,
    /// States that give friction of their own although one is given for all states.
    #[serde(skip_serializing_if = "is_zero")]
    pub own_friction: u64,
    /// States that name their contacts although feet are given.
    #[serde(skip)]
    pub own_contacts: u64,
    /// States with odd numbers: outside limits, or as if in other units.
    #[serde(skip_serializing_if = "OddStates::is_empty")]
    pub odd_states: OddStates,
    /// States with notes other than on odd numbers and on contacts at rest.
    #[serde(skip_serializing_if = "OddStates::is_empty")]
    pub noted: OddStates,
    /// Touchdowns whose state is taken above the ground, for feet whose heights have no noise.
    #[serde(skip_serializing_if = "is_zero")]
    pub early: u64,
    /// Touchdowns whose feet fell more than twice as fast shortly before.
    #[serde(skip_serializing_if = "is_zero")]
    pub slowed: u64,
    /// Touchdowns of feet that are far below the ground in the recording.
    #[serde(skip_serializing_if = "is_zero")]
    pub deep: u64,
    /// Touchdowns with another one so near that no velocity between both is known.
    #[serde(skip_serializing_if = "is_zero")]
    pub crowded: u64,
    /// Touchdowns whose foot does not come down at the chosen moment, so that nothing strikes.
    #[serde(skip_serializing_if = "is_zero")]
    pub no_strike: u64,
    /// Coordinates that have no column in the table; they are 0 in all states.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub missing_columns: Vec<String>,
}

/// The words for the verdicts in the text.
const WORDS: [&str; 6] = ["unique", "ambiguous", "without outcome", "undecided", "without impact", "without contact"];

/// The number of states with each verdict, written as an object.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Verdicts([u64; 6]);

impl Serialize for Verdicts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(Verdict::ALL.iter().zip(self.0))
    }
}

/// A state of the batch, and its smallest margin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nearest {
    /// The state.
    #[serde(flatten)]
    pub state: StateRef,
    /// The margin that is nearest to zero among its outcomes, free of units.
    pub margin: f64,
}

/// A reference to a state of the input.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StateRef {
    /// The id of the state, shortened if it is long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub id: Option<Value>,
    /// The line of the state, from 1.
    pub line: usize,
}

/// States in which a foot slides because friction is too small. They are unique or ambiguous, every outcome has a
/// sliding contact, and with infinite friction some outcome has none.
///
/// The friction that a state needs is the greatest |L_t| / L_n of the sticking contacts in an outcome without sliding.
/// Among several, the outcome that needs least counts.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MoreFriction {
    /// The number of these states.
    pub states: u64,
    /// The state that needs most friction; among equal ones the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greatest: Option<Needed>,
}

/// States with odd numbers (see [`State::oddities`](crate::State::oddities)), or with other notes.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct OddStates {
    /// The number of these states.
    pub states: u64,
    /// The first of these states.
    pub first: Option<Oddity>,
}

/// A state of the batch, and its first oddity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Oddity {
    /// The state.
    #[serde(flatten)]
    pub state: StateRef,
    /// The oddity in words.
    pub what: String,
}

impl OddStates {
    fn is_empty(&self) -> bool {
        self.states == 0
    }

    /// Adds the counts of the states that follow.
    pub fn add(&mut self, following: Self) {
        self.states += following.states;
        self.first = self.first.take().or(following.first);
    }
}

/// A state of the batch, and the friction that it needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Needed {
    /// The state.
    #[serde(flatten)]
    pub state: StateRef,
    /// The coefficient, or "infinite" if a contact sticks without a normal impulse.
    #[serde(serialize_with = "coefficient")]
    pub friction: f64,
}

/// How often a list of modes occurs among the outcomes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ModeCount {
    /// The names of the contacts.
    #[serde(serialize_with = "strings")]
    pub contacts: Vec<Arc<str>>,
    /// The mode of each contact.
    pub modes: Vec<Mode>,
    /// How many outcomes have these modes.
    pub outcomes: u64,
    /// A hash of the lists, so that they are compared quickly.
    #[serde(skip)]
    key: u64,
}

impl Summary {
    /// Counts a state that was analyzed.
    pub fn count(&mut self, state: impl Fn() -> StateRef, impact: &Impact, analysis: &Analysis) {
        self.states += 1;
        self.verdicts.0[analysis.verdict as usize] += 1;
        self.beyond_budget += u64::from(analysis.open.is_some_and(|open| open.beyond_budget));
        self.uncertain += u64::from(impact.holds.is_some());
        self.not_holding += u64::from(matches!(impact.holds, Some(Robustness::Not(_))));
        self.resting += u64::from(impact.resting.contains(&true));
        self.near(&state, &analysis.outcomes);
        if let Some(friction) = impact.friction_needed {
            self.more_friction.add(MoreFriction { states: 1, greatest: Some(Needed { state: state(), friction }) });
        }
        self.slides_regardless += u64::from(impact.slides_regardless);
        for outcome in analysis.outcomes.iter().filter(|outcome| outcome.decided) {
            let names = impact.contacts.iter().map(|contact| &contact.name);
            let ends = impact.contacts.iter().zip(&outcome.modes);
            let ends = ends.map(|(contact, &mode)| 4 * contact.link as u64 + mode as u64);
            let key = ends.fold(0, |key: u64, end| key.rotate_left(7) ^ end);
            // Most equal names share one allocation.
            let is_named = |(known, name): (&Arc<str>, &Arc<str>)| Arc::ptr_eq(known, name) || known == name;
            let known = |list: &&mut ModeCount| {
                let is_alike = list.key == key && list.modes == outcome.modes;
                is_alike && list.contacts.iter().zip(names.clone()).all(is_named)
            };
            match self.modes.iter_mut().find(known) {
                Some(list) => list.outcomes += 1,
                None => self.modes.push(ModeCount {
                    contacts: names.cloned().collect(),
                    modes: outcome.modes.clone(),
                    outcomes: 1,
                    key,
                }),
            }
        }
    }

    /// Adds the summary of the states that follow.
    pub fn merge(&mut self, following: Self) {
        self.question = following.question;
        self.states += following.states;
        self.refused += following.refused;
        self.beyond_budget += following.beyond_budget;
        self.verdicts.0.iter_mut().zip(following.verdicts.0).for_each(|(count, more)| *count += more);
        for near in following.smallest_margins {
            self.insert(near);
        }
        self.more_friction.add(following.more_friction);
        self.slides_regardless += following.slides_regardless;
        self.uncertain += following.uncertain;
        self.not_holding += following.not_holding;
        self.resting += following.resting;
        for list in following.modes {
            let known = |known: &&mut ModeCount| known.modes == list.modes && known.contacts == list.contacts;
            // The limit applies only here: if it applied to parts, the result would depend on how states are divided.
            let room = self.modes.len() < LISTS;
            match self.modes.iter_mut().find(known) {
                Some(known) => known.outcomes += list.outcomes,
                None if room => self.modes.push(list),
                None => self.other_modes += list.outcomes,
            }
        }
        self.other_modes += following.other_modes;
        self.own_friction += following.own_friction;
        self.own_contacts += following.own_contacts;
        self.odd_states.add(following.odd_states);
        self.noted.add(following.noted);
        self.early += following.early;
        self.slowed += following.slowed;
        self.deep += following.deep;
        self.crowded += following.crowded;
        self.no_strike += following.no_strike;
    }

    /// Returns notes on the touchdowns.
    pub fn of_touchdowns(&self) -> impl Iterator<Item = String> {
        let Self { early, slowed, deep, crowded, no_strike, .. } = *self;
        notes::odd_touchdowns([early, slowed, deep, crowded, no_strike])
    }

    fn near(&mut self, state: impl Fn() -> StateRef, outcomes: &[Outcome]) {
        let farthest = self.smallest_margins.get(NAMED - 1).map(|farthest| farthest.margin.abs());
        let is_near = |margin: &f64| farthest.is_none_or(|farthest| margin.abs() < farthest);
        // An outcome without any impulse has only slacks of zero, which mean nothing.
        let pressed = |outcome: &Outcome| outcome.impulse.iter().flatten().any(|&entry| entry != 0.0);
        let near = outcomes.iter().filter_map(|outcome| {
            let margin = outcome.margin.filter(is_near)?;
            (outcome.decided && pressed(outcome)).then_some(margin)
        });
        if let Some(margin) = near.min_by(|a, b| a.abs().total_cmp(&b.abs())) {
            self.insert(Nearest { state: state(), margin });
        }
    }

    /// Inserts after states that are equally near, which come earlier in the input.
    fn insert(&mut self, near: Nearest) {
        let at = self.smallest_margins.partition_point(|other| other.margin.abs() <= near.margin.abs());
        if at < NAMED {
            self.smallest_margins.truncate(NAMED - 1);
            self.smallest_margins.insert(at, near);
        }
    }
}

impl MoreFriction {
    fn add(&mut self, following: Self) {
        self.states += following.states;
        if let Some(needed) = following.greatest
            && self.greatest.as_ref().is_none_or(|greatest| needed.friction > greatest.friction)
        {
            self.greatest = Some(needed);
        }
    }
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

fn strings<S: Serializer>(names: &[Arc<str>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(names.iter().map(|name| &**name))
}

fn coefficient<S: Serializer>(friction: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if friction.is_finite() { serializer.serialize_f64(*friction) } else { serializer.serialize_str("infinite") }
}

impl fmt::Display for StateRef {
    /// `k17 (line 17)`, or `line 17`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let line = self.line;
        match &self.id {
            Some(id) => write!(f, "{} (line {line})", visible(&words::id(id))),
            None => write!(f, "line {line}"),
        }
    }
}

/// Formats a margin with two digits.
fn two_digits(margin: f64) -> String {
    if (0.01..10.0).contains(&margin.abs()) { format!("{margin:.2}") } else { format!("{margin:.1e}") }
}

/// How many entries of each kind the text shows.
const SHOWN: usize = 5;

impl fmt::Display for Summary {
    /// A few lines for people.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let counts =
            self.verdicts.0.into_iter().zip(WORDS).chain([(self.refused, "refused")]).filter(|(count, _)| *count > 0);
        let counts = counts.map(|(count, what)| format!("{count} {what}"));
        let plural = if self.states == 1 { "" } else { "s" };
        writeln!(f, "{} state{plural}: {}", self.states, counts.collect::<Vec<_>>().join(", "))?;
        let counted = |f: &mut fmt::Formatter<'_>, what: &str, count: u64| match count {
            0 => Ok(()),
            _ => writeln!(f, "{what}: {count}"),
        };
        counted(f, "undecided because the budget of work ended (`budget`)", self.beyond_budget)?;
        if !self.smallest_margins.is_empty() {
            let near = self.smallest_margins.iter().take(SHOWN);
            let near = near.map(|Nearest { state, margin }| format!("{} {state}", two_digits(*margin)));
            let given = if self.question == Aspect::Forces { "a force" } else { "an impulse" };
            writeln!(f, "smallest margins with {given}: {}", near.collect::<Vec<_>>().join(", "))?;
        }
        if let Some(Needed { state, friction }) = &self.more_friction.greatest {
            let states = self.more_friction.states;
            let friction = match *friction {
                f64::INFINITY => "infinite".to_owned(),
                ..0.001 => two_digits(*friction),
                _ => format!("{friction:.3}"),
            };
            writeln!(
                f,
                "all outcomes slide because friction is too small: {states}; most is needed by {state}: {friction}"
            )?;
        }
        counted(f, "some foot slides whatever the friction", self.slides_regardless)?;
        counted(f, "outcomes that do not hold within the state's uncertainty", self.not_holding)?;
        if self.resting > 0 {
            let states = self.resting;
            writeln!(f, "slow contacts are taken as exactly at rest: {states}; `resting_speed: 0` turns this off")?;
        }
        for (with, odd) in [("odd numbers", &self.odd_states), ("notes", &self.noted)] {
            if let OddStates { states, first: Some(Oddity { state, what }) } = odd {
                writeln!(f, "states with {with}: {states}, the first {state}: {}", visible(what))?;
            }
        }
        if self.states > 1 && self.verdicts.0[Verdict::NoContact as usize] == self.states {
            writeln!(f, "no foot touches the ground in any state (see `place`, and `touchdowns` of recordings)")?;
        }
        self.of_touchdowns().try_for_each(|note| writeln!(f, "{note}"))?;
        let mut lists: Vec<&ModeCount> = self.modes.iter().filter(|list| !list.modes.is_empty()).collect();
        lists.sort_by_key(|list| std::cmp::Reverse(list.outcomes));
        for list in lists.iter().take(SHOWN) {
            let ends =
                list.contacts.iter().zip(&list.modes).map(|(contact, mode)| format!("{} {mode}", visible(contact)));
            writeln!(f, "{:>8} x {}", list.outcomes, ends.collect::<Vec<_>>().join(", "))?;
        }
        let rest: u64 = lists.iter().skip(SHOWN).map(|list| list.outcomes).sum::<u64>() + self.other_modes;
        if rest > 0 {
            writeln!(f, "{rest:>8} x other modes")?;
        }
        Ok(())
    }
}
