//! The product's answers to many states beside the oracle's, counted.

use crate::balls::oracle::{self, Answer, Index, Outcome};
use crate::balls::states::{Model, beside_a_border};
use crate::support::random::Random;
use heelstrike::impact::{self, Analysis, Verdict};
use heelstrike::pipeline::{Impact, Options, Pipeline};
use heelstrike::state::State;
use std::fmt;
use std::ops::AddAssign;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;

/// How a product's answer stands to the oracle's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// They are the same, and the product says that it is proven.
    Proven,
    /// They are the same, but not proven.
    Same,
    /// The product says `undecided`.
    Undecided,
    /// Something that the product calls proven is not so: the worst that can happen.
    Wrong(String),
    /// Something that the product decided without calling it proven is not so.
    Different(String),
    /// The oracle cannot tell.
    Unknown,
}

/// Compares an analysis with all outcomes.
pub fn compare(answer: &Answer, analysis: &Analysis) -> Finding {
    if answer.open > 0 {
        return Finding::Unknown;
    }
    let same = |told: &Outcome, found: &impact::Outcome| {
        let index = match told.index {
            Index::Sign(sign) => found.index == Some(sign),
            Index::Border => found.index.is_none() && found.border.is_some(),
            Index::Redundant => true,
        };
        index && told.modes == found.modes
    };
    let decided: Vec<&impact::Outcome> = analysis.outcomes.iter().filter(|outcome| outcome.decided).collect();
    let is_one = |found: &impact::Outcome| answer.outcomes.iter().any(|told| same(told, found));
    let difference = || {
        let found: Vec<_> = decided.iter().map(|outcome| (&outcome.modes, outcome.index)).collect();
        format!("{}, outcomes {found:?}\nnot {:?}", analysis.verdict, answer.outcomes)
    };
    // An outcome that is proven must be one, whatever the rest is.
    let refuted = decided.iter().any(|outcome| outcome.proven && !is_one(outcome));
    let complete = decided.len() == answer.outcomes.len() && analysis.verdict != Verdict::Undecided;
    let found = |told: &Outcome| decided.iter().any(|outcome| same(told, outcome));
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

/// How many states came to what.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// All states.
    pub states: u64,
    /// Rightly proven.
    pub proven: u64,
    /// Right, but not proven.
    pub same: u64,
    /// Left undecided by the product.
    pub undecided: u64,
    /// Wrongly proven.
    pub wrong: u64,
    /// Wrongly decided without a proof.
    pub different: u64,
    /// Refused by the product.
    pub refused: u64,
    /// Not told by the oracle: contacts that depend on each other, or a singular mass matrix.
    pub unknown: u64,
    /// On a border, by the oracle.
    pub border: u64,
    /// With several outcomes.
    pub ambiguous: u64,
    /// That took the oracle more than its first precision.
    pub deeper: u64,
    /// Combinations that the product settled by each layer: bound, balls, pairs of f64, more digits.
    pub layers: [u64; 4],
}

impl Counts {
    fn columns(&self) -> [(&'static str, u64); 15] {
        let [bound, ball, double, precise] = self.layers;
        [
            ("number", self.states),
            ("proven", self.proven),
            ("same", self.same),
            ("undecided", self.undecided),
            ("wrong", self.wrong),
            ("different", self.different),
            ("refused", self.refused),
            ("unknown", self.unknown),
            ("border", self.border),
            ("ambiguous", self.ambiguous),
            ("deeper", self.deeper),
            ("bound", bound),
            ("ball", ball),
            ("double", double),
            ("precise", precise),
        ]
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.states += other.states;
        self.proven += other.proven;
        self.same += other.same;
        self.undecided += other.undecided;
        self.wrong += other.wrong;
        self.different += other.different;
        self.refused += other.refused;
        self.unknown += other.unknown;
        self.border += other.border;
        self.ambiguous += other.ambiguous;
        self.deeper += other.deeper;
        for (own, other) in self.layers.iter_mut().zip(other.layers) {
            *own += other;
        }
    }
}

/// Counts of one robot: of its random states, and of those beside borders.
#[derive(Debug, Clone, Copy, Default)]
pub struct Row {
    /// Random states.
    pub random: Counts,
    /// States beside a border.
    pub near: Counts,
}

/// The counts of all robots, and the first states that something is wrong with.
pub struct Census {
    /// Name and counts of each robot.
    pub rows: Vec<(&'static str, Row)>,
    /// What is wrong and where, the worst first.
    pub failures: Vec<Failure>,
}

/// A state that is answered wrongly.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Failure {
    /// Whether it is only decided, not proven.
    unproven: bool,
    /// The block of states it is in.
    block: u64,
    /// What the answers are, and the state.
    text: String,
}

/// As many as a reader can take.
const FAILURES: usize = 20;

impl Census {
    /// The counts of all robots.
    pub fn total(&self) -> Row {
        self.rows.iter().fold(Row::default(), |mut total, (_, row)| {
            total.random += row.random;
            total.near += row.near;
            total
        })
    }
}

impl fmt::Display for Census {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Counts::default().columns().map(|(name, _)| format!("{name:>10}"));
        writeln!(f, "{:14} {:6} {}", "robot", "states", names.concat())?;
        let total = ("all", self.total());
        for (name, row) in self.rows.iter().chain([&total]) {
            for (kind, counts) in [("random", row.random), ("near", row.near)] {
                let numbers = counts.columns().map(|(_, number)| format!("{number:>10}"));
                writeln!(f, "{name:14} {kind:6} {}", numbers.concat())?;
            }
        }
        for Failure { unproven, block, text } in &self.failures {
            let claim = if *unproven { "not proven, and wrong" } else { "proven, but wrong" };
            writeln!(f, "\nblock {block}, {claim}: {text}")?;
        }
        Ok(())
    }
}

/// Random states for each four that lie beside one border.
const RANDOM_IN_BLOCK: u64 = 8;

/// States of a block: two in three are random.
pub const BLOCK: u64 = 12;

/// Answers at least `states` states of all robots in turn, in `threads` threads; the same ones each time.
pub fn census(models: &[Model], states: u64, threads: usize) -> Census {
    let next = AtomicU64::new(0);
    let census = Mutex::new(Census {
        rows: models.iter().map(|model| (model.name, Row::default())).collect(),
        failures: Vec::new(),
    });
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let block = next.fetch_add(1, Ordering::Relaxed);
                    if block * BLOCK >= states {
                        return;
                    }
                    let number = (block % models.len() as u64) as usize;
                    let (row, failures) = answer_block(&models[number], block);
                    let mut census = census.lock().expect("no thread panics with it");
                    census.rows[number].1.random += row.random;
                    census.rows[number].1.near += row.near;
                    census.failures.extend(failures);
                    // Wrong proofs first, then the order of the blocks.
                    census.failures.sort();
                    census.failures.truncate(FAILURES);
                }
            });
        }
    });
    census.into_inner().expect("no thread panicked")
}

fn answer_block(model: &Model, block: u64) -> (Row, Vec<Failure>) {
    let mut random = Random::new(block);
    let mut pipeline = Pipeline::new(&model.robot, Options::default());
    let mut failures = Vec::new();
    let mut counted = |state: &State| {
        let (counts, failure) = answer_state(model, &mut pipeline, state);
        failures.extend(failure.map(|text| {
            let text = format!("{}, {text}\n{}", model.name, state.to_json(&model.robot));
            Failure { unproven: counts.wrong == 0, block, text }
        }));
        counts
    };
    let mut row = Row::default();
    for _ in 0..RANDOM_IN_BLOCK {
        row.random += counted(&model.random(&mut random));
    }
    for state in beside_a_border(model, &mut random) {
        row.near += counted(&state);
    }
    (row, failures)
}

/// Counts one state and reports what is wrong with it.
fn answer_state(model: &Model, pipeline: &mut Pipeline<'_>, state: &State) -> (Counts, Option<String>) {
    let mut counts = Counts { states: 1, ..Counts::default() };
    let Some(answer) = oracle::answer(&model.robot, state) else {
        counts.unknown += 1;
        return (counts, None);
    };
    let border = answer.outcomes.iter().any(|outcome| outcome.index == Index::Border);
    counts.border += u64::from(border);
    counts.ambiguous += u64::from(answer.outcomes.len() > 1);
    counts.deeper += u64::from(answer.bits > 256);
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
    let analysis = match pipeline.impact(state).and_then(Impact::into_analysis) {
        Ok(analysis) => analysis,
        Err(_) => {
            counts.refused += 1;
            return (counts, None);
        }
    };
    let effort = analysis.effort;
    counts.layers = [effort.bound, effort.ball, effort.double_double, effort.precise].map(|settled| settled as u64);
    match compare(&answer, &analysis) {
        Finding::Proven => counts.proven += 1,
        Finding::Same => counts.same += 1,
        Finding::Undecided => counts.undecided += 1,
        Finding::Unknown => counts.unknown += 1,
        Finding::Wrong(difference) => {
            counts.wrong += 1;
            return (counts, Some(difference));
        }
        Finding::Different(difference) => {
            counts.different += 1;
            return (counts, Some(difference));
        }
    }
    (counts, None)
}
