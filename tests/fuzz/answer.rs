//! What every answer must be: finite numbers, a verdict that fits its outcomes, JSON without holes.

use crate::open;
use heelstrike::impact::{Analysis, Outcome, Verdict};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::State;
use heelstrike::write::{Detail, Palette, Report, Subject, text};
use heelstrike::{Error, Robot};
use serde_json::Value;
use std::collections::HashSet;

/// All that can be written of a result.
pub const ALL: Detail = Detail { explain: true, matrices: true, brief: false };

/// A refusal says something.
pub fn check_refusal(error: &Error, case: &str) {
    assert!(!error.reason().to_string().is_empty() && error.to_string().len() < 2_000, "{error}\n{case}");
}

/// What was accepted; a refusal says something.
pub fn accepted<T>(result: Result<T, Error>, case: &str) -> Option<T> {
    result.inspect_err(|error| check_refusal(error, case)).ok()
}

/// Checks the result for `contacts` contacts.
pub fn check_analysis(analysis: &Analysis, contacts: usize, case: &str) {
    let context = || format!("{analysis:?}\n{case}");
    let far = open::is_far(case);
    let outcomes = &analysis.outcomes;
    for outcome in outcomes {
        assert_eq!([outcome.modes.len(), outcome.impulse.len(), outcome.velocity_after.len()], [contacts; 3]);
        let ranges = outcome.impulse_range.iter().flatten().flatten().flatten().flatten();
        let motion = outcome.impulse.iter().chain(&outcome.velocity_after).flatten();
        let needed = outcome.friction_needed.iter().flatten();
        let mut numbers = motion.chain(ranges).chain(needed).chain(&outcome.margin).chain([&outcome.energy_loss]);
        assert!(far || numbers.all(|number| number.is_finite()), "a number that is none: {}", context());
        assert!(outcome.decided || !outcome.proven, "proven but not decided: {}", context());
        assert_eq!(outcome.impulse_unique, outcome.impulse_range.is_none(), "{}", context());
        if outcome.decided {
            assert!(far || outcome.margin.is_none_or(|margin| margin >= 0.0), "a negative margin: {}", context());
            let bare = outcome.border.is_none() && !outcome.family;
            assert!(bare || outcome.index.is_none(), "an index on a border: {}", context());
        }
        if let Some(border) = &outcome.border {
            assert!(border.at_zero.iter().all(|zero| !zero.contact.is_empty()), "{}", context());
        }
    }
    for rejection in &analysis.rejected {
        let motion = rejection.motion.iter().flat_map(|motion| motion.impulse.iter().chain(&motion.velocity_after));
        let mut numbers = motion.flatten().chain(&rejection.margin);
        assert!(numbers.all(|number| number.is_finite()), "of {rejection:?}\n{case}");
    }
    assert!(far || analysis.condition.is_none_or(f64::is_finite), "{}", context());

    let decided = outcomes.iter().all(|outcome| outcome.decided);
    assert!(!analysis.proven || outcomes.iter().all(|outcome| outcome.proven), "{}", context());
    let rests = |outcome: &Outcome| outcome.impulse.iter().flatten().all(|&entry| entry == 0.0);
    let expected = match &outcomes[..] {
        _ if contacts == 0 => Verdict::NoContact,
        _ if !decided => Verdict::Undecided,
        [] => Verdict::None,
        [only] if rests(only) => Verdict::NoImpact,
        [_] => Verdict::Unique,
        _ => Verdict::Ambiguous,
    };
    assert_eq!(analysis.verdict, expected, "{}", context());
    let holds = outcomes.iter().any(|outcome| outcome.decided && !outcome.modes.iter().any(|mode| mode.slides()));
    assert_eq!(analysis.no_slip_consistent == Some(true), holds, "{}", context());
    let indices = outcomes.iter().map(|outcome| outcome.index.map(i32::from)).sum::<Option<i32>>();
    assert_eq!(analysis.index_sum, indices, "{}", context());
    for (at, outcome) in outcomes.iter().enumerate() {
        let corner = analysis.families.iter().any(|family| family.corners.contains(&at));
        assert_eq!(outcome.family, corner, "{}", context());
        // Only a family's own corners share its modes.
        let of_family = corner && analysis.families.iter().any(|family| family.modes == outcome.modes);
        let twin = outcomes[..at].iter().any(|other| other.modes == outcome.modes);
        assert!(of_family || !twin, "listed twice: {}", context());
    }
    for family in &analysis.families {
        assert!((1..family.corners.len()).contains(&family.dimension), "{family:?}: {}", context());
    }
    if !analysis.rejected.is_empty() {
        let lists: HashSet<_> = analysis.rejected.iter().map(|rejection| &rejection.modes).collect();
        let valid = outcomes.iter().map(|outcome| &outcome.modes).chain(analysis.families.iter().map(|own| &own.modes));
        let valid: HashSet<_> = valid.collect();
        assert!(lists.is_disjoint(&valid) && lists.len() == analysis.rejected.len(), "{}", context());
        assert_eq!(lists.len() + valid.len(), 1 << (2 * contacts), "{}", context());
    }
}

/// The index theorem (paper, section 2) for a positive definite Delassus matrix; a border or a family hides indices.
pub fn keeps_index_theorem(analysis: &Analysis, contacts: usize) -> bool {
    let hides = |outcome: &Outcome| outcome.border.is_some() || outcome.family || !outcome.decided;
    let applies = analysis.rank == Some(2 * contacts) && !analysis.outcomes.iter().any(hides);
    !applies || contacts == 0 || analysis.index_sum == Some(1)
}

/// Fields that may be null.
const MAY_BE_NULL: &str = "condition explain friction_needed impulse impulse_range index index_sum margin \
                           no_slip_consistent velocity_after";

/// One line of JSON, in which nothing is null that is a number.
pub fn check_json(line: &[u8], case: &str) {
    let value: Value = serde_json::from_slice(line).unwrap_or_else(|error| panic!("{error}: {line:?}\n{case}"));
    assert!(line.ends_with(b"\n") && value.is_object(), "{value}\n{case}");
    let mut places = vec![("", "", &value)];
    while let Some((above, field, value)) = places.pop() {
        match value {
            Value::Null => {
                // What a rejected combination would have been may be nothing.
                let wrong = ["impulse", "velocity_after"].contains(&field) && above != "rejected";
                let may_be = MAY_BE_NULL.split(' ').any(|may_be| may_be == field) && !wrong;
                let excused = open::is_far(case);
                assert!(may_be || excused, "{field} is null: {value}\n{case}");
            }
            Value::Array(entries) => places.extend(entries.iter().map(|entry| (above, field, entry))),
            Value::Object(fields) => places.extend(fields.iter().map(|(key, entry)| (field, key.as_str(), entry))),
            Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
        }
    }
}

/// Answers a state in kept memory and in fresh, and checks both; false where it is refused.
pub fn check_state(state: &State, robot: &Robot, kept: &mut Pipeline, options: &Options, case: &str) -> bool {
    let fresh = Pipeline::new(robot, options.clone()).impact(state);
    let impact = kept.impact(state);
    let lines = [&fresh, &impact].map(|impact| {
        let report = impact.as_ref().map_err(Clone::clone).and_then(|impact| {
            let report = Report::of_state(robot, state, impact, ALL)?;
            let mut line = Vec::new();
            report.append_json(ALL, &mut line);
            Ok((line, text(&report, &Subject::of_state(robot, state, impact), ALL, &Palette::default())))
        });
        report.map_err(|error| error.to_string())
    });
    assert_eq!(lines[0], lines[1], "reused memory gives another answer\n{case}");
    match &impact {
        Err(error) => check_refusal(error, case),
        Ok(impact) => {
            let after: Vec<f64> =
                impact.analysis.iter().flat_map(|own| &own.outcomes).flat_map(Outcome::velocity).collect();
            let mut numbers =
                after.iter().chain(impact.velocity_before.iter().flatten()).chain([&impact.kinetic_energy]);
            assert!(numbers.all(|number| number.is_finite()) || open::is_far(case), "{impact:?}\n{case}");
            if let Some(analysis) = accepted(impact.analyzed(), case) {
                check_analysis(analysis, impact.contacts.len(), case);
                let kept = keeps_index_theorem(analysis, impact.contacts.len());
                assert!(kept || open::is_far(case), "the indices do not sum to 1: {analysis:?}\n{case}");
            }
            if let Ok((line, text)) = &lines[0] {
                check_json(line, case);
                assert!(!text.is_empty(), "{case}");
            }
        }
    }
    impact.is_ok_and(|impact| impact.analysis.is_some())
}
