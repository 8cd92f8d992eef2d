//! Memory that is allocated from a state to its outcomes. One test alone: the allocator counts what all threads do.

use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::{Defaults, Friction, Robot, State, Verdict};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One to three contacts: RAMone's walk and two blows, each unique and decided in f64.
fn states(robot: &Robot) -> Vec<State> {
    let walk = include_str!("../../examples/gait/ramone_walk.ndjson").lines().map(str::to_owned);
    let foot = |side: &str| format!(r#"{{"link": "{side}_foot", "radius": 0.02815}}"#);
    let (left, right, torso) = (foot("left"), foot("right"), r#"{"link": "torso", "offset": [0.1, 0, 0.1]}"#);
    let blow = |contacts: String| {
        format!(
            r#"{{"position": {{"base": {{"z": 0.4, "pitch": 0.05}},
                "joints": {{"left_hip": 1.2, "left_knee": -1.5, "right_hip": 0.3, "right_knee": -1.6}}}},
            "velocity": {{"base": {{"x": 0.4, "z": -0.3, "pitch": 0.5}}, "joints": {{"left_hip": -0.4}}}},
            "contacts": [{contacts}]}}"#
        )
    };
    let blows = [format!("{left}, {right}"), format!("{left}, {right}, {torso}")].map(blow);
    let defaults = Defaults { friction: Some(Friction::Finite(0.8)), ..Defaults::default() };
    walk.chain(blows).map(|text| State::from_json(&text, robot, &defaults).unwrap()).collect()
}

#[test]
fn brief_answer_recycled_allocates_nothing() {
    let robot = Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).unwrap();
    let states = states(&robot);
    let mut pipeline = Pipeline::new(&robot, Options { brief: true, ..Options::default() });
    let mut contacts = [0; 4];
    for counted in [false, true] {
        for state in &states {
            let region = Region::new(ALLOCATOR);
            let impact = pipeline.answer(state).unwrap();
            let change = region.change();
            let analysis = impact.analyzed().unwrap();
            assert!(matches!(analysis.verdict, Verdict::Unique | Verdict::NoImpact), "{:?}", analysis.verdict);
            if counted && analysis.effort.ball == 0 {
                assert_eq!((change.allocations, change.reallocations), (0, 0), "{:?}", state.id);
                contacts[impact.contacts.len()] += 1;
            }
            pipeline.recycle(impact);
        }
    }
    assert!(contacts[1] > 50 && contacts[2] > 1 && contacts[3] == 1, "{contacts:?}");
}
