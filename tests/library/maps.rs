//! Studies of two parameters: areas and curves of maps, compared with the answers to single states.

use crate::support::random::Random;
use crate::support::urdf::{body, collision};
use crate::sweep::command::straight;
use crate::sweep::studies::with;
use heelstrike::sweep::{Area, BorderCurve, Findings, Map, Regime, RobotStudy, Solver, Workers};
use serde_json::{Value, json};
use std::sync::LazyLock;

const PDW: &str = include_str!("../../urdf/pdw.urdf");
const MINIMALISTIC: &str = include_str!("../../urdf/minimalistic.urdf");
const WORKERS: Workers<'static> = Workers { threads: 2, done: &|| () };

/// A study of the walker over its leg angle and its legs' moment of inertia.
fn inertia() -> Value {
    let mut study = straight(None);
    study["parameters"] = json!({"alpha": {"from": 0.001, "to": 1.5697, "steps": 33},
        "j": {"from": 0, "to": 0.5, "steps": 17}});
    let leg = json!({"inertia": "j", "com": [0, 0, -0.4]});
    study["robot"] = json!({"links": {"left_leg": leg, "right_leg": leg}});
    study
}

/// The map of that study, computed once for all tests of this file.
static INERTIA: LazyLock<Map> = LazyLock::new(|| with(PDW, &inertia(), 0, |model| Map::of(model, WORKERS)));

/// Calls `ask` with the model of a study and its map.
fn with_map<T>(urdf: &str, study: &Value, ask: impl FnOnce(&RobotStudy, &Map) -> T) -> T {
    with(urdf, study, 0, |model| match Findings::of(model, WORKERS) {
        Findings::Map(map) => ask(model, &map),
        Findings::Along(_) => panic!("two parameters make a map"),
    })
}

/// The winding number of an area's loops about a point: 1 inside the area, 0 outside.
fn winding(area: &Area, [x, y]: [f64; 2]) -> i32 {
    let mut turns = 0;
    for points in &area.loops {
        for (a, b) in points.iter().zip(points.iter().cycle().skip(1)) {
            let left = (b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1]);
            if a[1] <= y && y < b[1] && left > 0.0 {
                turns += 1;
            } else if b[1] <= y && y < a[1] && left < 0.0 {
                turns -= 1;
            }
        }
    }
    turns
}

/// Random points of the ranges lie in exactly one area, and have its regime except in a thin seam along its curves.
#[test]
fn points_lie_in_the_area_of_their_outcomes() {
    // A study in whose map many areas meet.
    let mut many = straight(None);
    many["parameters"] = json!({"alpha": {"from": 0, "to": "pi/2", "steps": 20},
        "mu": {"from": 0, "to": 2, "steps": 20}});
    many["state"]["friction"] = json!("mu");
    let check = |model: &RobotStudy, map: &Map| {
        let mut solver = Solver::new(model);
        let [first, second] = model.study.parameters() else { panic!("two parameters") };
        let (mut random, mut wrong, count) = (Random::new(0), 0, 2_000);
        for _ in 0..count {
            let [x, y] = [first, second].map(|parameter| random.between(parameter.from, parameter.to));
            let inside: Vec<&Area> = map.areas.iter().filter(|area| winding(area, [x, y]) != 0).collect();
            let [only] = inside[..] else { panic!("{x}, {y} lies in {} areas", inside.len()) };
            assert_eq!(winding(only, [x, y]), 1, "holes run the other way");
            wrong += usize::from(solver.regime(&[x, y]) != only.regime);
        }
        // Curves are polylines with points at most 1/64 of the ranges apart, which leaves up to 0.2 % on the wrong
        // side.
        assert!(wrong * 500 < count, "{wrong} of {count} points are not in the area of their outcomes");
    };
    with(PDW, &inertia(), 0, |model| check(model, &INERTIA));
    with_map(MINIMALISTIC, &many, check);
}

#[test]
fn a_map_is_the_same_for_any_number_of_threads() {
    let places = |map: &Map| {
        let loops: Vec<_> = map.areas.iter().map(|area| (area.loops.clone(), area.middles.clone())).collect();
        let curves: Vec<_> = map.curves.iter().map(|curve| (curve.sides, curve.points.clone())).collect();
        (loops, curves)
    };
    let alone = with(PDW, &inertia(), 0, |model| Map::of(model, Workers { threads: 1, done: &|| () }));
    assert_eq!(places(&alone), places(&INERTIA), "of one thread and of two");
}

#[test]
fn curves_and_areas_have_what_turns_and_what_holds() {
    with(PDW, &inertia(), 0, |model| {
        let mut solver = Solver::new(model);
        for area in &INERTIA.areas {
            assert!(!area.middles.is_empty());
            for (middle, _) in &area.middles {
                assert_eq!(solver.regime(middle), area.regime);
            }
            assert!(matches!(*area.regime, Regime::Answered { .. }) && area.refused.is_none());
        }
        for curve in &INERTIA.curves {
            assert_ne!(curve.sides[0], curve.sides[1]);
            assert!(!curve.transition.ended.is_empty());
        }
    });
}

/// The normal velocity of a block's only contact is zero on a circle, so that the size of the area inside is known.
#[test]
fn an_island_has_its_size() {
    for (radius, room) in [(0.03_f64, 2e-2), (0.1, 5e-3), (0.4, 1e-3)] {
        let range = json!({"from": -1, "to": 1, "steps": 20});
        let z = format!("(g - 0.15)^2 + (h - 0.25)^2 - {radius}^2");
        let study = json!({"parameters": {"g": range, "h": range},
            "state": {"friction": 0.9, "velocity": {"base": {"x": 0.5, "z": z}}}});
        with_map(include_str!("../../urdf/block.urdf"), &study, |_, map| {
            let inside = |area: &&Area| winding(area, [0.15, 0.25]) == 1;
            let island = map.areas.iter().find(inside).expect("an island");
            let points = &island.loops[0];
            let next = points.iter().cycle().skip(1);
            let size: f64 = points.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum();
            let whole = std::f64::consts::PI * radius * radius;
            assert!((size / whole - 1.0).abs() < room, "{radius}: {size} of {whole}");
            let off = points.iter().map(|p| ((p[0] - 0.15).hypot(p[1] - 0.25) - radius).abs());
            assert!(off.fold(0.0, f64::max) < 1e-8, "{radius}");
        });
    }
}

/// For the curves along the border p = border(q) of a study: the largest distance of points in p, the largest distance
/// of the middles of chords at right angles to them, and the largest p.
fn along(study: &Value, urdf: &str, border: impl Fn(f64) -> f64) -> [f64; 3] {
    with_map(urdf, study, |_, map| {
        let mut off = [0.0_f64, 0.0, 0.0];
        let is_along = |curve: &&BorderCurve| (curve.points[0][0] - border(curve.points[0][1])).abs() < 1e-3;
        for curve in map.curves.iter().filter(is_along) {
            for &[p, q] in &curve.points {
                off = [off[0].max((p - border(q)).abs()), off[1], off[2].max(p)];
            }
            for pair in curve.points.windows(2) {
                let [dp, dq] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
                let [p, q] = [0, 1].map(|axis| 0.5 * (pair[0][axis] + pair[1][axis]));
                off[1] = off[1].max((p - border(q)).abs() * dq.abs() / dp.hypot(dq));
            }
        }
        off
    })
}

#[test]
fn curves_follow_bulges_and_keep_beside_thin_regions() {
    let range = json!({"from": 0, "to": 1, "steps": 2});
    let parameters = json!({"p": range, "q": range});
    // The block sticks at friction 1 or more: in a tip that is narrower than a cell, and deeper than half its width.
    let bulge = json!({"parameters": parameters, "state": {"velocity": {"base": {"x": 1, "z": -1}},
        "friction": "max(0, 1.32 - p - 400*(q - 0.508)^2)"}});
    let tip = |q: f64| 0.32 - 400.0 * (q - 0.508).powi(2);
    let [off, bent, most] = along(&bulge, include_str!("../../urdf/block.urdf"), tip);
    assert!(off < 1e-6 && bent < 1e-4 && (most - 0.32).abs() < 1e-4, "{off:e} {bent:e} {most}");
    // Both legs touch in a band 1e-6 wide about pitch = 0.3, which is p = 0.8 - 0.2 sin(20 q).
    let bend = json!({"parameters": parameters, "state": {"position": {"base": {"pitch": "p - 0.5 + 0.2*sin(20*q)"},
        "joints": {"hip": 0.6}}, "velocity": {"base": {"z": -1}}, "place": "lowest", "friction": 0.5}});
    let [off, bent, most] = along(&bend, MINIMALISTIC, |q| 0.8 - 0.2 * (20.0 * q).sin());
    assert!(off < 1e-5 && bent < 1e-4 && most > 0.9, "{off:e} {bent:e}");
}

/// A cube that rolls from edge to edge touches with both in a band of 1e-6 rad of pitch. A map leaves this band out.
#[test]
fn a_map_leaves_out_where_a_foot_rolls() {
    let range = |from, to| json!({"from": from, "to": to, "steps": 12});
    let study = json!({"parameters": {"s": range(-0.53, 0.67), "w": range(1.1, 5.0)}, "state": {"friction": 0.2,
        "place": "lowest", "position": {"base": {"pitch": "s"}}, "velocity": {"base": {"x": "w", "z": -1}}}});
    with_map(&body(0.3, &collision([0.0; 2], "box size=\"1 1 1\"")), &study, |_, map| {
        let loops: usize = map.areas.iter().map(|area| area.loops.len()).sum();
        assert!(
            (1..10).contains(&map.curves.len()) && (1..10).contains(&loops),
            "{} curves, {loops} loops",
            map.curves.len()
        );
    });
}
