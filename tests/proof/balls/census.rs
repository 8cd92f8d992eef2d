//! The product's answers to many states compared with the oracle's, and counted.

use crate::balls::oracle::{self, Answer, Index, Outcome};
use crate::balls::states::{Model, beside_a_border};
use crate::support::random::Random;
use heelstrike::impact::{self, Analysis, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::State;
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// How a product's answer stands to the oracle's.
#[derive(Debug, PartialEq, Eq)]
pub enum Finding {
    /// They are the same and proven.
    Proven,
    /// They are the same, but not proven.
    Same,
    Undecided,
    /// Something that the product calls proven is not so: the worst that can happen.
    Wrong(String),
    /// Something that the product decided without calling it proven is not so.
    Different(String),
    /// The oracle has no answer.
    Unknown,
}

/// Compares an analysis with all outcomes.
pub fn compare(answer: &Answer, analysis: &Analysis) -> Finding {
    if answer.open > 0 {
        return Finding::Unknown;
    }
    let same = |right: &Outcome, found: &impact::Outcome| {
        let index = match right.index {
            Index::Sign(sign) => found.index == Some(sign),
            Index::Border => found.index.is_none() && found.border.is_some(),
            Index::Redundant => true,
        };
        index && right.modes == found.modes
    };
    let decided: Vec<&impact::Outcome> = analysis.outcomes.iter().filter(|outcome| outcome.decided).collect();
    let is_one = |found: &impact::Outcome| answer.outcomes.iter().any(|right| same(right, found));
    let difference = || {
        let found: Vec<_> = decided.iter().map(|outcome| (&outcome.modes, outcome.index)).collect();
        format!("{}, outcomes {found:?}\nnot {:?}", analysis.verdict, answer.outcomes)
    };
    // An outcome that is proven must be one, whatever the rest is.
    let refuted = decided.iter().any(|outcome| outcome.proven && !is_one(outcome));
    let complete = decided.len() == answer.outcomes.len() && analysis.verdict != Verdict::Undecided;
    let found = |right: &Outcome| decided.iter().any(|outcome| same(right, outcome));
    let differs = !complete || !decided.iter().all(|outcome| is_one(outcome)) || !answer.outcomes.iter().all(found);
    let verdict = match answer.outcomes.len() {
        0 => analysis.verdict == Verdict::None,
        1 => matches!(analysis.verdict, Verdict::Unique | Verdict::NoImpact),
        _ => analysis.verdict == Verdict::Ambiguous,
    };
    match analysis.proven {
        true if differs || !verdict => Finding::Wrong(difference()),
        _ if refuted => Finding::Wrong(difference()),
        true if !analysis.outcomes.iter().all(|outcome| outcome.proven) => Finding::Wrong(difference()),
        true => Finding::Proven,
        false if analysis.verdict == Verdict::Undecided => Finding::Undecided,
        false if differs || !verdict => Finding::Different(difference()),
        false => Finding::Same,
    }
}

/// What is counted: states, what became of them, those on a border, with several outcomes, and for which the oracle's
/// first precision was not enough; then combinations, by the layer that settled them.
const COLUMNS: [&str; 15] = [
    "number",
    "proven",
    "same",
    "undecided",
    "wrong",
    "different",
    "refused",
    "unknown",
    "border",
    "ambiguous",
    "deeper",
    "bound",
    "ball",
    "double",
    "precise",
];

/// States are random or near a border.
const KINDS: [&str; 2] = ["random", "near"];

/// As many failures as a reader can take.
const FAILURES: usize = 20;

/// The counts of all robots, and the first states that something is wrong with.
#[derive(Default)]
pub struct Census {
    /// By robot, kind and column.
    counts: BTreeMap<(&'static str, &'static str, &'static str), u64>,
    failures: Vec<Failure>,
}

/// A state that is answered wrongly; wrong proofs are sorted first.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Failure {
    unproven: bool,
    block: u64,
    text: String,
}

impl Census {
    /// The count of all robots.
    pub fn count(&self, kind: &str, column: &str) -> u64 {
        let own = self.counts.iter().filter(|((_, own, name), _)| (*own, *name) == (kind, column));
        own.map(|(_, count)| count).sum()
    }

    fn extend(&mut self, other: Self) {
        other.counts.into_iter().for_each(|(place, count)| *self.counts.entry(place).or_default() += count);
        self.failures.extend(other.failures);
        self.failures.sort();
        self.failures.truncate(FAILURES);
    }
}

impl fmt::Display for Census {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{:14} {:6} {}", "robot", "states", COLUMNS.map(|name| format!("{name:>10}")).concat())?;
        let mut robots: Vec<&str> = self.counts.keys().map(|&(robot, ..)| robot).collect();
        robots.dedup();
        for (robot, kind) in robots.into_iter().flat_map(|robot| KINDS.map(|kind| (robot, kind))) {
            let count = |column| self.counts.get(&(robot, kind, column)).copied().unwrap_or(0);
            writeln!(f, "{robot:14} {kind:6} {}", COLUMNS.map(|column| format!("{:>10}", count(column))).concat())?;
        }
        for kind in KINDS {
            let counts = COLUMNS.map(|column| format!("{:>10}", self.count(kind, column)));
            writeln!(f, "{:14} {kind:6} {}", "all", counts.concat())?;
        }
        for Failure { unproven, block, text } in &self.failures {
            let claim = if *unproven { "not proven, and wrong" } else { "proven, but wrong" };
            writeln!(f, "\nblock {block}, {claim}: {text}")?;
        }
        Ok(())
    }
}

/// Random states for each four that lie next to one border.
const RANDOM_IN_BLOCK: u64 = 8;

/// States of a block: two in three are random.
const BLOCK: u64 = 12;

/// Answers at least `states` states of all robots in turn, in `threads` threads; the same ones each time.
pub fn census(models: &[Model], states: u64, threads: usize) -> Census {
    let (next, census) = (AtomicU64::new(0), Mutex::<Census>::default());
    let work = || {
        loop {
            let block = next.fetch_add(1, Ordering::Relaxed);
            if block * BLOCK >= states {
                return;
            }
            let own = answer_block(&models[(block % models.len() as u64) as usize], block);
            census.lock().expect("no thread panics with it").extend(own);
        }
    };
    thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    census.into_inner().expect("no thread panicked")
}

fn answer_block(model: &Model, block: u64) -> Census {
    let mut random = Random::new(block);
    let mut pipeline = Pipeline::new(&model.robot, Options::default());
    let mut census = Census::default();
    let states = (0..RANDOM_IN_BLOCK).map(|_| ("random", model.random(&mut random))).collect::<Vec<_>>();
    for (kind, state) in states.into_iter().chain(beside_a_border(model, &mut random).map(|state| ("near", state))) {
        let mut add = |column, count| *census.counts.entry((model.name, kind, column)).or_default() += count;
        let (unproven, difference) = match answer_state(model, &mut pipeline, &state, &mut add) {
            Finding::Wrong(difference) => (false, difference),
            Finding::Different(difference) => (true, difference),
            _ => continue,
        };
        let text = format!("{}, {difference}\n{}", model.name, state.to_json(&model.robot));
        census.failures.push(Failure { unproven, block, text });
    }
    census
}

/// Answers one state and counts what becomes of it.
fn answer_state(
    model: &Model,
    pipeline: &mut Pipeline<'_>,
    state: &State,
    add: &mut impl FnMut(&'static str, u64),
) -> Finding {
    add("number", 1);
    let found = pipeline.impact(state);
    // What the product takes as exactly at rest is so; that it is slow enough for that is tested elsewhere.
    let resting = found.as_ref().map_or(&[][..], |impact| &impact.resting);
    let Some(answer) = oracle::answer(&model.robot, state, resting) else {
        add("unknown", 1);
        return Finding::Unknown;
    };
    let border = answer.outcomes.iter().any(|outcome| outcome.index == Index::Border);
    add("border", u64::from(border));
    add("ambiguous", u64::from(answer.outcomes.len() > 1));
    add("deeper", u64::from(answer.bits > 256));
    let sign = |outcome: &Outcome| match outcome.index {
        Index::Sign(sign) => Some(i32::from(sign)),
        Index::Border | Index::Redundant => None,
    };
    let sum: Option<i32> = answer.outcomes.iter().map(sign).sum();
    assert!(
        answer.open > 0 || answer.dependent || border || sum == Some(1),
        "the oracle's own indices do not add up to one: {answer:?}\n{}",
        state.to_json(&model.robot)
    );
    let Ok(analysis) = found.and_then(|impact| impact.into_analysis()) else {
        add("refused", 1);
        return Finding::Unknown;
    };
    let effort = analysis.effort;
    let layers = [effort.bound, effort.ball, effort.double_double, effort.precise];
    COLUMNS[11..].iter().zip(layers).for_each(|(layer, settled)| add(layer, settled));
    let finding = compare(&answer, &analysis);
    let column = match finding {
        Finding::Proven => "proven",
        Finding::Same => "same",
        Finding::Undecided => "undecided",
        Finding::Unknown => "unknown",
        Finding::Wrong(_) => "wrong",
        Finding::Different(_) => "different",
    };
    add(column, 1);
    finding
}
