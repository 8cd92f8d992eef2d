//! Soles of meshes, whose facets are micrometers apart: which corners touch.

use super::*;
use crate::support::impact::is_proven;
use crate::support::mechanism::turned;
use crate::support::random::Random;
use crate::support::scaled::largest;
use heelstrike::description::Description;
use heelstrike::reductions::Reductions;
use heelstrike::robot::Reduction;

/// A biped whose feet, hinged at the ends of straight legs 0.9 m long, have soles through these points \[m\] of OBJ
/// meshes.
fn biped(left: &[[f64; 2]], right: &[[f64; 2]]) -> Robot {
    let vertices = |sole: &[[f64; 2]]| -> String {
        // The top of the foot, and its sole.
        let outline = [[-0.08, 0.05], [0.14, 0.05]].into_iter().chain(sole.iter().copied());
        let vertices: String = outline.map(|[x, z]| format!("v {x} 0.05 {z}\nv {x} -0.05 {z}\n")).collect();
        let face: String = (1..=2 * sole.len() + 4).map(|vertex| format!(" {vertex}")).collect();
        format!("{vertices}f{face}\n")
    };
    let mut elements = vec![urdf::link("torso", 20.0, [0.0, 0.2], 1.0, "")];
    for side in ["left", "right"] {
        let mesh = urdf::collision([0.0; 2], &format!("mesh filename=\"{side}.obj\""));
        elements.push(urdf::link(format!("{side}_leg"), 4.0, [0.0, -0.4], 0.1, ""));
        elements.push(urdf::link(format!("{side}_foot"), 1.0, [0.03, -0.02], 0.01, &mesh));
        let (leg, foot) = (format!("{side}_leg"), format!("{side}_foot"));
        elements.push(urdf::joint(format!("{side}_hip"), urdf::HINGE, ["torso", &leg], [0.0; 2], ""));
        elements.push(urdf::joint(format!("{side}_ankle"), urdf::HINGE, [&leg, &foot], [0.0, -0.9], ""));
    }
    let mut description = Description::from_urdf(&urdf::robot(&elements)).expect("a description");
    let read = |file: &str| Ok(vertices(if file == "left.obj" { left } else { right }).into_bytes());
    description.read_meshes(read);
    Robot::reduce(&description, &Reduction::default()).expect("a robot")
}

/// Soles with facets 1 to 2 micrometers apart, as those of XBot-L, atom01 and MagicBot; the last one is tilted, too.
const UNEVEN: [[[f64; 2]; 4]; 3] = [
    [[-0.071, -0.05 + 1.54e-6], [-0.047, -0.05 + 9e-7], [0.067, -0.05 + 5e-8], [0.131, -0.05]],
    [[-0.071, -0.05 + 2.28e-6], [-0.068, -0.05 + 1.28e-6], [0.030, -0.05], [0.131, -0.05 + 2.28e-6]],
    [[-0.071, -0.05 + 4.0e-5], [0.093, -0.05 + 9.9e-6], [0.130, -0.05], [0.131, -0.05 + 1.9e-7]],
];
const EVEN: [[f64; 2]; 4] = [[-0.071, -0.05], [-0.047, -0.05], [0.067, -0.05], [0.131, -0.05]];

fn falling() -> Value {
    json!({"position": {"base": {"z": 0.95}}, "velocity": {"base": {"z": -1.0}}, "friction": 0.8})
}

#[test]
fn a_symmetric_fall_on_uneven_soles_is_symmetric() {
    for (uneven, profile) in UNEVEN.iter().flat_map(|sole| [(sole, false), (sole, true)]) {
        let mut state = falling();
        if profile {
            state["ground"] = json!({"profile": [[-1.0, 0.0], [1.0, 0.0]]});
        }
        let found = impact(&biped(uneven, &EVEN), &state);
        let names: Vec<&str> = found.contacts.iter().map(|contact| &*contact.name).collect();
        assert_eq!(names, ["left_foot/0", "left_foot/1", "right_foot/0", "right_foot/1"]);
        for (contact, x) in found.contacts.iter().zip([-0.071, 0.131, -0.071, 0.131]) {
            assert_eq!(contact.point.x, x, "{}", contact.name);
        }
        assert!(is_proven(&found) && !outcomes(&found).is_empty());
        for outcome in outcomes(&found) {
            assert_eq!(outcome.modes[..2], outcome.modes[2..]);
            let [left_hip, left_ankle, right_hip, right_ankle] = outcome.velocity().skip(3).collect::<Vec<_>>()[..]
            else {
                panic!("four joints")
            };
            // The soles differ by up to 4e-5 m, with legs of 1 m that fall at 1 m/s; rates may differ by ten times as
            // much.
            assert!(near(&[left_hip, left_ankle], &[right_hip, right_ankle], 4e-4), "{outcome:?}");
        }
    }
}

#[test]
fn a_stance_rests_on_the_corners_that_touch() {
    for uneven in &UNEVEN {
        let state = json!({"position": {"joints": {"right_hip": -0.5}}, "velocity": {"joints": {"right_hip": 0.3}},
            "stance": "left_foot", "friction": 0.8});
        let found = impact(&biped(uneven, &EVEN), &state);
        assert_eq!(touches(&found).len(), 2);
        assert_eq!((found.contacts[0].point.x, found.stance), (0.0, Some(0)));
        assert!((found.contacts[1].point.x - 0.202).abs() < 1e-12);
        // The lowest corner is on the ground, and the others are not below it.
        let gaps = [uneven[0], uneven[3]].map(|[_, z]| z + 0.05);
        assert_close(&[found.contacts[0].gap, found.contacts[1].gap], &gaps);
        assert_eq!(found.velocity_before, [[0.0; 2]; 2]);
        assert_eq!(found.analysis.expect("an analysis").verdict, Verdict::NoImpact);
    }
}

/// The corners of a wheel's mesh often come in pairs that are micrometers apart, as those of Unitree's B2-W do.
#[test]
fn corners_that_all_but_coincide_are_one_contact() {
    let tip = [[0.0, -0.05 + 1e-9], [4e-6, -0.05]];
    let touching = |options: &Options, profile: bool| {
        let mut state = falling();
        if profile {
            state["ground"] = json!({"profile": [[-1.0, 0.0], [1.0, 0.0]]});
        }
        let found = try_impact(&biped(&tip, &EVEN), options.clone(), state).expect("an answer");
        found.contacts[..found.contacts.len() - 2].iter().map(|own| own.point.x).collect::<Vec<_>>()
    };
    let given = Options { contact_tolerance: Some(1e-6), ..Options::default() };
    for profile in [false, true] {
        assert_eq!(touching(&Options::default(), profile), [4e-6]);
        assert_eq!(touching(&given, profile), [0.0, 4e-6]);
    }
}

#[test]
fn a_tolerance_that_is_given_is_meant() {
    let within = |tolerance: f64| {
        let options = Options { contact_tolerance: Some(tolerance), ..Options::default() };
        let found = try_impact(&biped(&UNEVEN[0], &EVEN), options, falling()).expect("an answer");
        found.contacts[..found.contacts.len() - 2].iter().map(|contact| contact.point.x).collect::<Vec<_>>()
    };
    assert_eq!(within(0.0), [0.131]);
    assert_eq!(within(3e-7), [0.067, 0.131]);
    assert_eq!(within(1.2e-6), [-0.047, 0.131]);
    assert_eq!(within(2e-6), [-0.071, 0.131]);
    // The upper end of a side steeper than 45 degrees is not part of the sole.
    assert_eq!(within(0.2), [-0.071, 0.131]);
}

#[test]
fn a_foot_that_just_misses_is_noted() {
    let lift = |by: f64| EVEN.map(|[x, z]| [x, z + by]);
    for (by, noted) in [(2e-5, true), (8e-4, true), (2e-2, false)] {
        let found = impact(&biped(&lift(by), &EVEN), falling());
        assert_eq!(found.contacts.len(), 2);
        let note = found.notes.iter().find(|note| note.starts_with("left_foot nearly touches, "));
        assert_eq!(note.is_some(), noted, "{by}: {:?}", found.notes);
    }
}

#[test]
fn the_tolerance_of_the_note_keeps_uneven_soles_whole() {
    let lifted = UNEVEN[0].map(|[x, z]| [x, z + 1.2e-5]);
    let robot = biped(&lifted, &UNEVEN[1]);
    let found = impact(&robot, falling());
    let note = found.notes.iter().find(|note| note.starts_with("left_foot nearly touches, ")).expect("a note");
    let (_, rest) = note.split_once("`contact_tolerance: ").expect("an option");
    let tolerance = rest.split('`').next().and_then(|own| own.parse().ok()).expect("a number");
    let given = Options { contact_tolerance: Some(tolerance), ..Options::default() };
    let found = try_impact(&robot, given, falling()).expect("an answer");
    assert_eq!(found.contacts.iter().map(|own| own.point.x).collect::<Vec<_>>(), [-0.071, 0.131, -0.071, 0.131]);
}

/// A torso, a leg and a foot with a flat sole; torso and leg are pitched by these angles \[rad\] at q = 0.
fn one_legged([torso, leg]: [f64; 2]) -> Robot {
    let sole = urdf::collision([0.03, -0.04], "box size=\"0.21 0.1 0.03\"");
    robot(&urdf::robot(&[
        urdf::link("torso", 5.0, turned([0.02, 0.1], torso), 0.07, ""),
        urdf::link("leg", 1.3, turned([0.01, -0.2], leg), 0.02, ""),
        urdf::link("foot", 0.4, [0.03, -0.02], 0.001, &sole),
        urdf::joint("hip", urdf::HINGE, ["torso", "leg"], turned([0.0, -0.1], torso), ""),
        urdf::joint("ankle", urdf::HINGE, ["leg", "foot"], turned([0.05, -0.7], leg), ""),
    ]))
}

/// Named points are level only if they are so in all digits; f64 with error bounds then needs no balls to decide.
#[test]
fn named_corners_of_a_level_sole_need_no_more_digits() {
    let robot = one_legged([0.0; 2]);
    let corners = [-0.075, 0.135].map(|x| json!({"link": "foot", "offset": [x, 0, -0.055], "radius": 0}));
    let struck = |pitch: f64, tilt: f64| {
        let state = json!({
            "position": {"base": {"pitch": pitch}, "joints": {"hip": 0.25 - pitch, "ankle": tilt - 0.25}},
            "velocity": {"base": {"x": 0.1, "z": -1.0, "pitch": 0.2}, "joints": {"hip": 0.3}},
            "friction": 0.9, "contacts": corners,
        });
        impact(&robot, state).analysis.expect("an analysis")
    };
    for (pitch, tilt, is_level) in [(0.125, 0.0, true), (-0.5, 0.0, true), (0.125, 1e-9, false), (0.01, 0.0, false)] {
        let analysis = struck(pitch, tilt);
        assert!(analysis.proven && analysis.verdict == Verdict::Unique, "{pitch} {tilt}");
        // 0.25 - 0.01 is rounded, which tilts the last pose by 1e-17 rad.
        assert_eq!((analysis.effort.ball == 0, analysis.rank), (is_level, Some(3)), "{pitch} {tilt}");
    }
}

/// A slope with the sides 3, 4 and 5 has the normal (-0.6, 0.8), whose length in f64 is not exactly one. A circle's
/// point is therefore not exactly level with the point of its body that would be level with exact numbers.
#[test]
fn circles_on_a_profile_are_not_level_with_points() {
    let robot = robot(&urdf::robot(&[
        urdf::link("body", 2.0, [0.1, 0.3], 0.4, ""),
        urdf::link("arm", 1.0, [0.1, 0.2], 0.1, ""),
        urdf::joint("shoulder", urdf::HINGE, ["body", "arm"], [0.1, 0.6], ""),
    ]));
    let state = json!({
        "position": {"base": {"z": 0.5}, "joints": {"shoulder": 0.3}},
        "velocity": {"base": {"x": 0.3, "z": -1.0, "pitch": -3.0}, "joints": {"shoulder": 0.4}},
        "friction": "infinite", "ground": {"profile": [[-4.0, -3.0], [0.0, 0.0], [4.0, 3.0]]},
        "contacts": [{"link": "body", "offset": [0.0, 0.0, 0.0], "radius": 0.0},
            {"link": "body", "offset": [0.0, 0.0, 0.25], "radius": 0.2}],
    });
    let analysis = impact(&robot, state).analysis.expect("an analysis");
    assert!(analysis.proven && analysis.effort.bound < 16);
    // Both also stick in one outcome, with impulses as large as the error of that length is small.
    assert_eq!(analysis.verdict, Verdict::Ambiguous);
}

/// The state with a stance on `foot` or, given the base's velocity [x, z], with `place: lowest`.
fn placed(mut state: Value, base: Option<[f64; 2]>) -> Value {
    match base {
        None => state["stance"] = json!("foot"),
        Some([x, z]) => {
            state["place"] = json!("lowest");
            (state["velocity"]["base"]["x"], state["velocity"]["base"]["z"]) = (json!(x), json!(z));
        }
    }
    state
}

/// A foot turns about its heel, and its toe lands. The heel rests up to rounding, or up to the digits of the rates: the
/// answer is that of a heel that stands.
#[test]
fn a_toe_lands_about_a_heel_that_rests_to_rounding() {
    let robot = one_legged([0.0; 2]);
    let joints = ["hip", "ankle"];
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let mut number = || random.between(-1.0, 1.0);
        let (pitch, hip, rates) = (number(), number(), [number(), number(), number()]);
        let turn = rates.iter().sum::<f64>();
        let friction = &[json!("infinite"), json!(0.8), json!(0.1)][seed as usize % 3];
        let state = |digits: Option<usize>, base: Option<[f64; 2]>| {
            let written = |rate: f64| digits.map_or(rate, |digits| format!("{rate:.digits$}").parse().unwrap());
            let state = json!({
                "position": {"base": {"pitch": pitch}, "joints": {"hip": hip, "ankle": -(pitch + hip)}},
                "velocity": {"base": {"pitch": written(rates[0])},
                    "joints": {joints[0]: written(rates[1]), joints[1]: written(rates[2])}},
                "friction": friction,
            });
            placed(state, base.map(|base| base.map(written)))
        };
        let options = Options { matrices: true, ..Options::default() };
        let standing = try_impact(&robot, options, state(None, None)).expect("an answer");
        let jacobian = &standing.matrices.as_ref().expect("asked for").contact_jacobian;
        // Columns 0 and 1 are the base's x and z, which move the heel one to one.
        let along = |row: &Vec<f64>| -row[2..].iter().zip(&rates).map(|(own, rate)| own * rate).sum::<f64>();
        let base = [along(&jacobian[0]), along(&jacobian[1])];
        for (digits, within) in [(None, 1e-12), (Some(9), 1e-7)] {
            let resting = impact(&robot, state(digits, Some(base)));
            assert!(resting.resting[0] && is_proven(&resting));
            assert_eq!(modes(&resting), modes(&standing), "seed {seed}, {digits:?}, turning at {turn}");
            for (one, other) in velocities_after(&resting).iter().zip(velocities_after(&standing)) {
                assert!(near(one, &other, within * largest(one).max(1.0)), "seed {seed}: {one:?} is not {other:?}");
            }
        }
    }
}

/// A foot with a hinged toe turns about its heel: of the three points on two bodies the last one lands. A braked toe is
/// part of the foot, whether its column is left out or not.
#[test]
fn a_hinged_toe_lands_about_a_heel_that_rests() {
    let point = |x: f64| urdf::collision([x, -0.05], urdf::POINT);
    let robot = robot(&urdf::robot(&[
        urdf::link("torso", 8.0, [0.0, 0.2], 0.3, ""),
        urdf::link("leg", 1.0, [0.0, -0.4], 0.05, ""),
        urdf::link("foot", 0.5, [0.02, 0.0], 0.002, &(point(-0.07) + &point(0.1))),
        urdf::link("toe", 0.1, [0.02, -0.03], 0.0002, &point(0.06)),
        urdf::joint("hip", urdf::HINGE, ["torso", "leg"], [0.0; 2], ""),
        urdf::joint("ankle", urdf::HINGE, ["leg", "foot"], [0.0, -0.8], ""),
        urdf::joint("ball", urdf::HINGE, ["foot", "toe"], [0.1, 0.0], ""),
    ]));
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let mut number = || random.between(-1.0, 1.0);
        let (pitch, hip, rates) = (number(), number(), [number(), number(), 1.5 - number(), number()]);
        let held = if seed % 2 == 0 { json!([]) } else { json!(["ball"]) };
        let state = |base: Option<[f64; 2]>| {
            let state = json!({
                "position": {"base": {"pitch": pitch}, "joints": {"hip": hip, "ankle": -(pitch + hip)}},
                "velocity": {"base": {"pitch": rates[0]},
                    "joints": {"hip": rates[1], "ankle": rates[2], "ball": rates[3]}},
                "friction": if seed % 3 == 0 { json!(0.8) } else { json!("infinite") }, "held": held,
            });
            placed(state, base)
        };
        for kept in [false, true] {
            let mut options = Options { matrices: true, ..Options::default() };
            options.reductions.held = !kept;
            // With all columns, to find the base's velocity with which the heel rests.
            let whole = Options { reductions: Reductions { held: false, ..Reductions::ALL }, ..options.clone() };
            let jacobian = try_impact(&robot, whole, state(None)).expect("an answer").matrices.expect("asked for");
            let along = |row: &[f64]| -row[2..].iter().zip(&rates).map(|(own, rate)| own * rate).sum::<f64>();
            let base = [0, 1].map(|row| along(&jacobian.contact_jacobian[row]));
            let standing = try_impact(&robot, options.clone(), state(None)).expect("an answer");
            let resting = try_impact(&robot, options, state(Some(base))).expect("an answer");
            assert!(resting.resting[0], "seed {seed}");
            assert_eq!(modes(&resting), modes(&standing), "seed {seed}, kept {kept}");
            for (one, other) in velocities_after(&resting).iter().zip(velocities_after(&standing)) {
                assert!(near(one, &other, 1e-11 * largest(one).max(1.0)), "seed {seed}: {one:?} is not {other:?}");
            }
        }
    }
}

/// The rounding of angles tilts a sole by 1e-16 rad, which must not give impulses of 1e16 N s: the answer is that of a
/// sole that no rounding tilts.
#[test]
fn a_flat_sole_is_level_in_every_pose() {
    for seed in 0..40 {
        let mut random = Random::new(seed);
        let mut numbers = |size: f64| -> [f64; 5] { std::array::from_fn(|_| random.between(-size, size)) };
        let ([torso, leg, ..], [x, pitch, hip, ankle, bounce]) = (numbers(0.6), numbers(1.0));
        let state = |pose: [f64; 3], stands: bool| {
            let mut state = json!({
                "position": {"base": {"pitch": pose[0]}, "joints": {"hip": pose[1], "ankle": pose[2]}},
                "velocity": {"base": {"x": x, "z": -1.0, "pitch": pitch}, "joints": {"hip": hip, "ankle": ankle}},
                "friction": if seed % 3 == 0 { json!(0.7) } else { json!("infinite") },
                "restitution": bounce.abs(), "place": "lowest",
            });
            if stands {
                state["stance"] = json!("foot");
                state["velocity"]["base"] = json!({"pitch": pitch});
                state.as_object_mut().expect("an object").remove("place");
            }
            state
        };
        let stands = seed % 4 == 0;
        let posed = impact(&one_legged([0.0; 2]), state([torso, leg - torso, -leg], stands));
        let drawn = impact(&one_legged([torso, leg]), state([0.0; 3], stands));
        assert!(is_proven(&posed) && is_proven(&drawn), "seed {seed}");
        assert_eq!((modes(&posed), posed.contacts.len()), (modes(&drawn), 2), "seed {seed}");
        for (one, other) in velocities_after(&posed).iter().zip(velocities_after(&drawn)) {
            assert!(near(one, &other, 1e-12 * largest(one)), "seed {seed}: {one:?} is not {other:?}");
        }
    }
}

/// Two feet of braked legs act as feet of one body: rounding tilts the line between them by 1e-16 rad, which must not
/// give impulses of 1e16 N s.
#[test]
fn feet_of_held_legs_are_level_as_one_body_is() {
    // The axes of torso and legs have these pitches if the feet are level.
    let biped = |torso: f64, legs: [f64; 2], hip: urdf::Axis| {
        let mut elements = vec![urdf::link("torso", 5.0, turned([0.02, 0.1], -torso), 0.07, "")];
        for (at, side) in ["left", "right"].into_iter().enumerate() {
            let [com, foot] =
                [0.5, 1.0].map(|part| turned([[0.3, -0.75], [-0.2, -0.75]][at].map(|own| part * own), -legs[at]));
            let sole = urdf::collision(foot, "sphere radius=\"0.02\"");
            elements.push(urdf::link(side, 1.0, com, 0.02, &sole));
            let place = turned([0.05, -0.1], -torso);
            elements.push(urdf::joint(format!("{side}_hip"), hip, ["torso", side], place, ""));
        }
        robot(&urdf::robot(&elements))
    };
    for seed in 0..60 {
        let mut random = Random::new(seed);
        let [torso, left, right] = std::array::from_fn(|_| random.between(-0.6, 0.6));
        let [x, pitch, bounce] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        let state = |pitch_now: f64| {
            json!({
                "position": {"base": {"x": 40.0, "pitch": pitch_now}},
                "velocity": {"base": {"x": x, "z": -1.0, "pitch": pitch}},
                "friction": if seed % 3 == 0 { json!(0.7) } else { json!("infinite") },
                "restitution": if seed % 4 == 0 { bounce.abs() } else { 0.0 }, "place": "lowest",
            })
        };
        let mut held = state(torso);
        held["position"]["joints"] = json!({"left_hip": left - torso, "right_hip": right - torso});
        held["held"] = json!(["left_hip", "right_hip"]);
        let struck = |robot: &Robot, state: &Value| {
            try_impact(robot, Options { next: true, ..Options::default() }, state).expect("an answer")
        };
        let welded = biped(0.0, [0.0; 2], urdf::Axis::Fixed);
        let [posed, welded] = [struck(&biped(torso, [left, right], urdf::HINGE), &held), struck(&welded, &state(0.0))];
        assert!(is_proven(&posed) && is_proven(&welded), "seed {seed}");
        assert_eq!((modes(&posed), posed.contacts.len()), (modes(&welded), 2), "seed {seed}");
        for (one, other) in velocities_after(&posed).iter().zip(velocities_after(&welded)) {
            assert!(near(&one[..3], &other, 1e-12 * largest(one).max(1.0)), "seed {seed}: {one:?} is not {other:?}");
        }
        let next =
            |impact: &Impact| -> Vec<_> { outcomes(impact).iter().map(|outcome| outcome.next.clone()).collect() };
        assert_eq!(next(&posed), next(&welded), "seed {seed}");
        for impulse in outcomes(&posed).iter().flat_map(|outcome| &outcome.impulse) {
            assert!(impulse.iter().all(|own| own.abs() < 1e3), "seed {seed}: {impulse:?}");
        }
    }
}

#[test]
fn a_sole_that_few_digits_tilt_is_noted() {
    for (pitch, is_noted) in [(0.0, false), (-1e-12, true), (-1e-8, true), (-1e-3, false)] {
        let state = json!({"position": {"base": {"pitch": pitch}}, "velocity": {"base": {"x": 0.3, "z": -1, "pitch": 0.8}},
            "place": "lowest", "friction": "infinite"});
        let options = Options { contact_tolerance: Some(1e-3), ..Options::default() };
        let found = try_impact(&sole(), options, state).expect("an answer");
        assert_eq!(found.contacts.len(), 2);
        assert_eq!(is_hard(&found), is_noted, "{pitch}: {:?}", found.notes);
    }
    // A foot of 0.1 g that passes on the momentum of a robot pushes far harder than its own motion needs.
    let foot = urdf::link("foot", 1e-4, [0.0; 2], 1e-9, &urdf::collision([0.0; 2], "sphere radius=\"0.01\""));
    let ankle = urdf::joint("ankle", urdf::HINGE, ["body", "foot"], [0.1, -0.5], "");
    let light = robot(&urdf::robot(&[urdf::link("body", 50.0, [0.0; 2], 1.0, ""), foot, ankle]));
    for friction in [json!(0.5), json!("infinite")] {
        let state =
            json!({"velocity": {"base": {"x": 0.3, "z": -1, "pitch": 0.8}}, "place": "lowest", "friction": friction});
        let found = impact(&light, state);
        assert!(!is_hard(&found), "{:?}", found.notes);
    }
}

fn is_hard(found: &Impact) -> bool {
    found.notes.iter().any(|note| note.starts_with("contacts push against each other"))
}
