//! Time budgets: what stays open when one ends, and that usual states never read the clock.

use crate::support::impact::{ramone, try_impact};
use crate::support::nearly::nearly_dependent;
use crate::sweep::studies::with;
use heelstrike::budget::{BudgetSpent, SharedBudget};
use heelstrike::impact::{Analysis, AnalysisOptions, ListedRejections, OpenCombinations, Scratch};
use heelstrike::pipeline::Options;
use heelstrike::read::{Problem, Study};
use heelstrike::sweep::{Findings, Workers};
use heelstrike::{Budget, Defaults, Reason, Verdict};
use serde_json::json;
use std::cell::Cell;
use std::time::Duration;

thread_local!(static LOOKS: Cell<u32> = const { Cell::new(0) });

/// A clock that advances by one second at each reading.
fn ticking() -> Duration {
    Duration::from_secs(LOOKS.replace(LOOKS.get() + 1).into())
}

/// A budget of `count` readings of that clock; the first reading starts it.
fn looks(count: u64) -> Budget {
    LOOKS.set(0);
    Budget { time: Duration::from_secs(count), clock: ticking }
}

fn analyzed(contacts: usize, budget: Option<Budget>) -> Analysis {
    let problem = Problem::from_json(&nearly_dependent(contacts).to_string(), &Defaults::default()).expect("a problem");
    let analyze = || Scratch::default().analyze(&problem.contact, &problem, AnalysisOptions::default());
    budget.map_or_else(analyze, |budget| budget.within(analyze)).expect("an analysis")
}

#[test]
fn what_a_budget_leaves_open_is_undecided() {
    for (contacts, count) in [(10, 2), (10, 0), (12, 2)] {
        let Analysis { verdict, proven, outcomes, open, index_sum, no_slip_consistent, .. } =
            analyzed(contacts, Some(looks(count)));
        let OpenCombinations { combinations, undecided, beyond_budget, .. } = open.expect("something is open");
        assert_eq!((verdict, proven, index_sum), (Verdict::Undecided, false, None));
        assert_eq!((combinations, beyond_budget), (4_u64.pow(contacts as u32), true));
        let listed = outcomes.iter().filter(|outcome| !outcome.decided).count() as u64;
        assert!(listed <= undecided.min(100) && undecided <= combinations, "{listed} of {undecided}");
        // No slip may be one of the undecided outcomes that are not listed.
        assert!(no_slip_consistent != Some(false) || listed == undecided);
    }
}

#[test]
fn a_budget_that_suffices_changes_nothing() {
    let [without, with] = [None, Some(looks(1_000_000))].map(|budget| analyzed(3, budget));
    assert_eq!(without, with);
    assert!(without.open.is_none() && without.verdict != Verdict::Undecided);
}

/// A plank that slides on supports of unequal friction has a family, and combinations that are solved only for their
/// reasons.
#[test]
fn families_are_decided_before_reasons() {
    let rows = [-1.0, 0.0, 1.0].map(|x| [[1.0, 0.0, -1.0], [0.0, 1.0, x]]).concat();
    let plank = json!({"mass_matrix": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "contact_jacobian": rows, "velocity": [5, -1, 0],
        "friction": [0.1, 0.5, 0.9]});
    let problem = Problem::from_json(&plank.to_string(), &Defaults::default()).expect("a problem");
    let options = AnalysisOptions { rejections: ListedRejections::Everything, ..AnalysisOptions::default() };
    let analyze = || Scratch::default().analyze(&problem.contact, &problem, options).expect("an analysis");
    let whole = analyze();
    let decided = |own: &Analysis| own.open.is_none();
    let first = (0..100_000).map(|count| looks(count).within(analyze)).find(decided).expect("a budget");
    assert_eq!((first.outcomes, first.families.len()), (whole.outcomes, 1));
    assert_ne!(first.rejected, whole.rejected, "all reasons are known by then");
}

const STRIKE: &str = include_str!("../../examples/ramone.json");

#[test]
fn a_usual_state_never_reads_the_clock() {
    let options = Options { budget: Some(looks(0)), ..Options::default() };
    let impact = try_impact(&ramone(), options, STRIKE).expect("an answer");
    assert_eq!((impact.analysis.expect("outcomes").proven, LOOKS.get()), (true, 0));
}

#[test]
fn a_box_beyond_the_budget_is_unknown() {
    let wide = include_str!("../../examples/ramone_measured.json");
    let [free, bound] = [None, Some(looks(0))].map(|budget| {
        let impact = try_impact(&ramone(), Options { budget, ..Options::default() }, wide).expect("an answer");
        (format!("{:?}", impact.holds), impact.notes.iter().any(|note| note.contains("`budget`")))
    });
    assert!(free.0 != "Some(Unknown)" && !free.1, "{free:?}");
    assert_eq!(bound, ("Some(Unknown)".to_owned(), true));
}

#[test]
fn a_study_beyond_the_budget_is_refused() {
    let study = |parameters: serde_json::Value| {
        let position = json!({"base": {"pitch": "-alpha"}, "joints": {"hip": "-2*alpha"}});
        let velocity = json!({"base": {"pitch": -1.0}});
        let state = json!({"position": position, "velocity": velocity, "stance": "left_leg", "friction": "mu"});
        json!({"parameters": parameters, "constants": {"one": 1}, "state": state})
    };
    for (parameters, place) in [
        (json!({"alpha": {"from": 0, "to": 1e17, "steps": 300}, "mu": {"from": 0, "to": 1, "steps": 2}}), "alpha"),
        (json!({"alpha": {"from": 0.1, "to": 1, "steps": 5}, "mu": {"from": 0, "to": 1, "steps": 90}}), "mu"),
    ] {
        with(include_str!("../../urdf/minimalistic.urdf"), &study(parameters), 0, |model| {
            let shared = SharedBudget::new(looks(4));
            let workers = Workers { threads: 2, done: &|| () };
            let spent = shared.within(|| Findings::of(model, workers)).expect_err("too long");
            assert_eq!(spent, BudgetSpent(Duration::from_secs(4)));
            let refused = model.study.beyond(spent);
            let place = format!("parameters.{place}.steps");
            assert_eq!((refused.reason(), refused.place()), (&Reason::BeyondBudget, Some(&*place)));
            assert!(refused.location().is_some());
            assert!(refused.remedy().is_some_and(|remedy| remedy.contains("`budget: 40.0`")));
        });
    }
}

#[test]
fn a_map_beyond_its_memory_is_refused_at_once() {
    let study = |steps: [usize; 2]| {
        let parameter = |steps| json!({"from": 0, "to": 1, "steps": steps});
        json!({"parameters": {"a": parameter(steps[0]), "b": parameter(steps[1])}, "state": {}}).to_string()
    };
    for (steps, place) in [([400_000, 2], "parameters.a.steps"), ([2, 400_000], "parameters.b.steps")] {
        let text = study(steps);
        let refused = Findings::check_memory(&Study::from_json(&text).expect("a study")).expect_err("too large");
        assert!(matches!(refused.reason(), Reason::TooLarge { needed: 5_000.., .. }), "{refused}");
        assert_eq!(refused.place(), Some(place));
    }
    Findings::check_memory(&Study::from_json(&study([700, 700])).expect("a study")).expect("not too large");
}
