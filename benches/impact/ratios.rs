//! The time of an answer against what is possible: code written by hand for this robot alone, and serde_json alone. The
//! two alternate, so that a machine's drift affects both.

use super::closed_form;
use divan::black_box;
use heelstrike::batch::{AHEAD, Batch, Block, Chunks, Question, run};
use heelstrike::dynamics::plan::{Configuration, Plan};
use heelstrike::dynamics::{Workspace, contact_jacobian, delassus, factorize, kinematics, mass_matrix};
use heelstrike::impact::{AnalysisOptions, Friction, Mode, Scratch};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::write::{Brief, append_line};
use heelstrike::{Defaults, Detail, Report, Robot, State};
use serde::{Deserialize, Serialize};
use std::time::Instant;

const WALK: &str = include_str!("../../examples/gait/ramone_walk.ndjson");

pub fn print(rounds: usize) {
    let robot = super::ramone();
    of_one_state(&robot, rounds);
    of_one_line(&robot, rounds);
    of_threads(&robot, rounds.min(20));
}

/// Prints the time of both per line of the walk: the least of alternating rounds.
fn compare(rounds: usize, what: &str, own: impl FnMut(), against: &str, yardstick: impl FnMut()) {
    compare_lines(rounds, WALK.lines().count(), what, own, against, yardstick);
}

/// [`compare`] for work on this many lines.
fn compare_lines(
    rounds: usize,
    lines: usize,
    what: &str,
    mut own: impl FnMut(),
    against: &str,
    mut yardstick: impl FnMut(),
) {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..rounds {
        for (work, least) in [&mut own as &mut dyn FnMut(), &mut yardstick].into_iter().zip(&mut least) {
            let start = Instant::now();
            work();
            *least = least.min(start.elapsed().as_nanos() as f64 / lines as f64);
        }
    }
    let [own, yardstick] = least;
    println!("{what:<34} {own:>7.0} ns   {against:<30} {yardstick:>7.0} ns   ratio {:.2}", own / yardstick);
}

/// Compares the answers to single states. Both feet touch in every pose of the walk.
fn of_one_state(robot: &Robot, rounds: usize) {
    let read = |line: &str| {
        let foot = |side| format!(r#"{{"link": "{side}_foot", "radius": 0.02815}}"#);
        let contacts = format!(r#""friction": 0.6, "contacts": [{}, {}]"#, foot("left"), foot("right"));
        let line = line.replace("\"friction\": 0.6", &contacts);
        State::from_json(&line, robot, &Defaults::default()).expect("a good state")
    };
    let states: Vec<State> = WALK.lines().map(read).collect();
    let numbers = |state: &State| {
        [&state.position, &state.velocity].map(|list| <[f64; 7]>::try_from(&list[..]).expect("seven coordinates"))
    };
    let inputs: Vec<[[f64; 7]; 2]> = states.iter().map(numbers).collect();
    let points: Vec<_> = states.iter().map(|state| super::points(robot, state)).collect();
    let mut problems = Pipeline::new(robot, Options::default());
    let problems: Vec<_> = states.iter().map(|state| problems.unsolved(state).expect("a good state").problem).collect();
    agrees(&inputs, &problems);

    println!("\nA state of RAMone's walk, both feet given:");
    let (plan, mut posture, mut workspace) =
        (Plan::new(robot, &[], &[]), Configuration::default(), Workspace::default());
    let dynamics = || {
        for (state, points) in states.iter().zip(&points) {
            posture.set(&plan, black_box(&state.position));
            kinematics(&plan, &posture, &mut workspace);
            mass_matrix(&plan, &mut workspace);
            factorize(&plan, &mut workspace);
            contact_jacobian(&plan, points, &state.velocity, None, &mut workspace);
            delassus(&plan, &mut workspace);
        }
    };
    let mut by_hand = closed_form::Impact::default();
    let assemble = || {
        for [q, v] in &inputs {
            by_hand.assemble(black_box(q), black_box(v));
            black_box(&by_hand);
        }
    };
    compare(rounds, "M, J, G and c", dynamics, "by hand", assemble);
    let mut scratch = Scratch::default();
    let brief = AnalysisOptions { brief: true, ..AnalysisOptions::default() };
    let analyze = || {
        for problem in &problems {
            let analysis = scratch.analyze(black_box(problem), problem, brief).expect("two contacts");
            scratch.recycle(analysis.outcomes);
        }
    };
    let mut by_hand = closed_form::Impact::default();
    let solve = || {
        for problem in &problems {
            by_hand.take(black_box(problem));
            by_hand.solve(0.6);
            black_box(&by_hand);
        }
    };
    compare(rounds, "all outcomes from G and c", analyze, "16 sign tests by hand", solve);
    for (what, no_proof) in [("the whole impact", false), ("the whole impact without proof", true)] {
        let mut pipeline = Pipeline::new(robot, Options { brief: true, no_proof, ..Options::default() });
        let impact = || {
            for state in &states {
                let impact = pipeline.impact(black_box(state)).expect("a good state");
                pipeline.recycle(impact);
            }
        };
        let mut by_hand = closed_form::Impact::default();
        let both = || {
            for [q, v] in &inputs {
                by_hand.assemble(black_box(q), black_box(v));
                by_hand.solve(0.6);
                black_box(&by_hand);
            }
        };
        compare(rounds, what, impact, "M, J, G and sign tests by hand", both);
    }
}

/// Panics unless the closed form has the same G and the same outcomes.
fn agrees(inputs: &[[[f64; 7]; 2]], problems: &[heelstrike::ContactProblem]) {
    let mut own = closed_form::Impact::default();
    for ([q, v], problem) in inputs.iter().zip(problems) {
        own.assemble(q, v);
        own.solve(0.6);
        for (row, entries) in own.delassus.iter().enumerate() {
            for (column, entry) in entries.iter().enumerate() {
                let scale = (own.delassus[row][row] * own.delassus[column][column]).sqrt();
                assert!((entry - problem.delassus(row, column)).abs() < 1e-12 * scale, "G differs");
            }
        }
        let analysis = heelstrike::analyze(problem, false.into()).expect("two contacts");
        let place = |mode: Mode| Mode::ALL.iter().position(|&other| other == mode).expect("a mode");
        let found = analysis.outcomes.iter().map(|own| 1 << (4 * place(own.modes[0]) + place(own.modes[1])));
        assert!(own.undecided > 0 || own.outcomes == found.sum::<u32>(), "the outcomes differ");
    }
}

/// A line of the walk as serde_json reads it into a type of its own.
#[derive(Deserialize)]
#[expect(dead_code, reason = "it is read and dropped")]
struct Line<'a> {
    id: &'a str,
    position: Coordinates,
    velocity: Coordinates,
    friction: f64,
}

#[derive(Deserialize)]
#[expect(dead_code, reason = "as above")]
struct Coordinates {
    base: Base,
    joints: Joints,
}

#[derive(Deserialize)]
#[expect(dead_code, reason = "as above")]
struct Base {
    x: f64,
    z: f64,
    pitch: f64,
}

#[derive(Deserialize)]
#[expect(dead_code, reason = "as above")]
struct Joints {
    left_hip: f64,
    left_knee: f64,
    right_hip: f64,
    right_knee: f64,
}

fn question(robot: &Robot, brief: bool) -> Question<'_> {
    Question {
        robot,
        options: Options { friction_needed: true, ..Options::default() },
        defaults: Defaults { friction: Some(Friction::Finite(0.6)), ..Defaults::default() },
        detail: Detail { brief, ..Detail::default() },
        total: None,
        header: None,
        columns: None,
        keyframes: false,
    }
}

/// Calls `write` with the answers to `lines`.
fn answer(question: &Question, lines: &str, threads: usize, mut write: impl FnMut(&[u8]) + Send) {
    let answerer = || {
        let mut batch = Batch::new(question);
        move |chunk| batch.records(&chunk)
    };
    let mut chunks = Chunks::of_lines(lines.as_bytes());
    let sink = |block: Block| {
        write(&block.out);
        Ok(())
    };
    run(|| chunks.task(), threads, AHEAD, answerer, sink).expect("good lines");
}

fn of_one_line(robot: &Robot, rounds: usize) {
    println!("\nA line of RAMone's walk, one thread:");
    for (what, brief) in [("batch --brief", true), ("batch", false)] {
        let question = question(robot, brief);
        let answers = || {
            let mut written = Vec::new();
            answer(&question, WALK, 1, |bytes| written.extend(bytes));
            written
        };
        let written = String::from_utf8(answers()).expect("text");
        let mut out = Vec::new();
        let own = || drop(black_box(answers()));
        match brief {
            true => compare(rounds, what, own, SERDE, parse_and_format::<Brief>(&written, &mut out)),
            false => compare(rounds, what, own, SERDE, parse_and_format::<Report>(&written, &mut out)),
        }
        assert_eq!(out, written.as_bytes());
    }
}

/// Compares two threads with one.
fn of_threads(robot: &Robot, rounds: usize) {
    println!("\nA line of 40,800, two threads:");
    let lines = WALK.repeat(400);
    for (what, brief) in [("batch --brief", true), ("batch", false)] {
        let question = question(robot, brief);
        let with = |threads| {
            let (question, lines) = (&question, &lines);
            move || answer(question, lines, threads, |bytes| _ = black_box(bytes))
        };
        compare_lines(rounds, lines.lines().count(), what, with(2), "one thread", with(1));
    }
}

const SERDE: &str = "parse and format by serde_json";

/// The work of serde_json alone: parse the lines of the walk as [`Line`], and format the parsed `answers`.
fn parse_and_format<'a, T: Deserialize<'a> + Serialize>(answers: &'a str, out: &mut Vec<u8>) -> impl FnMut() {
    let read = |line| serde_json::from_str(line).expect("a result");
    let answers: Vec<T> = answers.lines().map(read).collect();
    move || {
        out.clear();
        for (line, answer) in WALK.lines().zip(&answers) {
            black_box(serde_json::from_str::<Line>(black_box(line)).expect("a good line"));
            append_line(out, black_box(answer));
        }
    }
}
