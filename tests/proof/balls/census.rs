//! Compares the product's answers to many states with those of the oracle, and counts them.

use crate::balls::oracle::{self, Answer, Index, Outcome};
use crate::balls::states::{Model, beside_a_border};
use crate::support::parallel::total;
use crate::support::random::Random;
use heelstrike::impact::{self, Analysis, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::State;

/// How the product's answer compares with the oracle's.
#[derive(Debug, PartialEq, Eq)]
pub enum Finding {
    /// The answers are the same, and the product's is proven.
    Proven,
    /// The answers are the same, but the product's is not proven.
    Same,
    Undecided,
    /// Something that the product calls proven is wrong: the worst that can happen.
    Wrong(String),
    /// Something that the product decided without calling it proven is wrong.
    Different(String),
    /// The oracle has no answer.
    Unknown,
}

/// Compares an analysis with all outcomes of the oracle.
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
    // A proven outcome must exist, even if the rest is not decided.
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

/// Counts of states: all, by finding, on a border, with several outcomes, and with more than the oracle's first
/// precision. Then counts of combinations by the layer of arithmetic that settled them.
const COLUMNS: [&str; 13] = [
    "number", "proven", "same", "open", "unknown", "refused", "border", "several", "deeper", "bound", "ball", "double",
    "precise",
];

/// States are random or near a border.
pub const KINDS: [&str; 2] = ["random", "near"];

/// The counts by kind and column.
pub struct Census([u64; KINDS.len() * COLUMNS.len()]);

/// The index of a count.
fn place(kind: &str, column: &str) -> usize {
    let at = |list: &[&str], name: &str| list.iter().position(|own| *own == name).expect("a known name");
    at(&KINDS, kind) * COLUMNS.len() + at(&COLUMNS, column)
}

/// Number of random states in a block.
const RANDOM_IN_BLOCK: usize = 8;

/// Number of states in a block: two in three are random, four lie next to one border.
const BLOCK: u64 = 12;

impl Census {
    /// Answers at least `states` states, of all robots in turn; they are the same in every run. Panics at a wrong
    /// answer.
    pub fn of(models: &[Model], states: u64) -> Self {
        Self(total(states.div_ceil(BLOCK), |block| answer_block(&models[block as usize % models.len()], block)))
    }

    pub fn count(&self, kind: &str, column: &str) -> u64 {
        self.0[place(kind, column)]
    }

    /// The count of both kinds.
    pub fn all(&self, column: &str) -> u64 {
        KINDS.iter().map(|kind| self.count(kind, column)).sum()
    }

    pub fn print(&self) {
        println!("states {}", COLUMNS.map(|name| format!("{name:>10}")).concat());
        for kind in KINDS {
            println!("{kind:6} {}", COLUMNS.map(|name| format!("{:>10}", self.count(kind, name))).concat());
        }
    }
}

fn answer_block(model: &Model, block: u64) -> [u64; KINDS.len() * COLUMNS.len()] {
    let mut random = Random::new(block);
    let mut pipeline = Pipeline::new(&model.robot, Options::default());
    let mut counts = [0; KINDS.len() * COLUMNS.len()];
    let states = (0..RANDOM_IN_BLOCK).map(|_| ("random", model.random(&mut random))).collect::<Vec<_>>();
    for (kind, state) in states.into_iter().chain(beside_a_border(model, &mut random).map(|state| ("near", state))) {
        let mut add = |column, count| counts[place(kind, column)] += count;
        let finding = answer_state(model, &mut pipeline, &state, &mut add);
        let context = || format!("block {block}, {}", model.named(&state));
        assert!(!matches!(finding, Finding::Wrong(_) | Finding::Different(_)), "{finding:?}, {}", context());
    }
    counts
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
    // The oracle takes the same contacts as exactly at rest. Other tests check that they are slow enough.
    let resting = found.as_ref().map_or(&[][..], |impact| &impact.resting);
    let Some(answer) = oracle::answer(&model.robot, state, resting) else {
        add("unknown", 1);
        return Finding::Unknown;
    };
    let border = answer.outcomes.iter().any(|outcome| outcome.index == Index::Border);
    add("border", u64::from(border));
    add("several", u64::from(answer.outcomes.len() > 1));
    add("deeper", u64::from(answer.bits > 256));
    let sign = |outcome: &Outcome| match outcome.index {
        Index::Sign(sign) => Some(i32::from(sign)),
        Index::Border | Index::Redundant => None,
    };
    let sum: Option<i32> = answer.outcomes.iter().map(sign).sum();
    assert!(
        answer.open > 0 || answer.dependent || border || sum == Some(1),
        "the oracle's own indices do not add up to one: {answer:?}, {}",
        model.named(state)
    );
    let Ok(analysis) = found.and_then(|impact| impact.into_analysis()) else {
        add("refused", 1);
        return Finding::Unknown;
    };
    let effort = analysis.effort;
    let layers = [effort.bound, effort.ball, effort.double_double, effort.precise];
    COLUMNS[9..].iter().zip(layers).for_each(|(layer, settled)| add(layer, settled));
    let finding = compare(&answer, &analysis);
    match finding {
        Finding::Proven => add("proven", 1),
        Finding::Same => add("same", 1),
        Finding::Undecided => add("open", 1),
        Finding::Unknown => add("unknown", 1),
        Finding::Wrong(_) | Finding::Different(_) => {}
    }
    finding
}
