//! What is refused of loops: names, poses and velocities that leave them open, coordinates that they alone would hold.

use crate::constraints::four_bar::{WIDTH, bolted, parallelogram, pin, state};
use crate::constraints::mechanism::{Part, try_impact};
use serde_json::{Value, json};

/// Place, reason and remedy of the refusal.
fn refused(change: impl FnOnce(&mut Value)) -> (String, String, String) {
    let mechanism = parallelogram(&[("front", 0.0), ("rear", WIDTH)]);
    let mut state = state(&mechanism, 0.6, -2.0, json!([pin("rear", WIDTH)]));
    change(&mut state);
    let error = try_impact(&bolted(&mechanism), &state).expect_err("refused");
    let text = |text: Option<&str>| text.unwrap_or_default().to_owned();
    (text(error.place()), error.reason().to_string(), text(error.remedy()))
}

#[track_caller]
fn assert_refused(change: impl FnOnce(&mut Value), [place, reason, remedy]: [&str; 3]) {
    assert_eq!(refused(change), (place.to_owned(), reason.to_owned(), remedy.to_owned()));
}

#[test]
fn names_and_shapes() {
    assert_refused(
        |state| state["loops"][0]["a"]["link"] = json!("raer"),
        ["loops[0].a.link", "the robot has no link named \"raer\"", "did you mean rear?"],
    );
    assert_refused(
        |state| state["loops"][0]["c"] = json!({}),
        ["loops[0].c", "unknown field \"c\"", "the fields here are a, b"],
    );
    assert_refused(|state| state["loops"] = json!([{"a": {"link": "rear"}}]), ["loops[0]", "\"b\" is missing", ""]);
    assert_refused(|state| state["loops"][0]["b"] = json!({}), ["loops[0].b", "\"link\" is missing", ""]);
    assert_refused(
        |state| state["loops"][0]["b"]["offset"] = json!([0, 0]),
        ["loops[0].b.offset", "expected a list of 3 numbers, found 2 entries", ""],
    );
    assert_refused(
        |state| state["loops"] = vec![state["loops"][0].clone(); 257].into(),
        ["loops", "more than 256 loops are not accepted", ""],
    );
    assert_refused(|state| state["loops"] = json!({}), ["loops", "expected a list, found an object", ""]);
}

#[test]
fn a_pose_that_leaves_a_loop_open() {
    // The rear crank 0.1 rad further: its end is 2 l sin(0.05) away.
    assert_refused(
        |state| state["position"]["joints"]["rear"] = json!(0.7),
        [
            "loops[0]",
            "the pose leaves loops[0] (rear - coupler) open: its points are 4.9979e-2 m apart",
            "the position must close every loop to 0.0001 of the robot's size (8.4e-5 m)",
        ],
    );
}

#[test]
fn a_velocity_that_opens_a_loop() {
    assert_refused(
        |state| state["velocity"]["joints"]["rear"] = json!(-1.0),
        [
            "loops[0]",
            "the velocities open loops[0] (rear - coupler) at 5.000e-1 m/s",
            "give rates of all joints of the loop, such that both points move alike",
        ],
    );
}

/// A held joint's rate is what it is: a loop of held joints alone must already be kept by them.
#[test]
fn held_joints_that_drive_a_loop_apart() {
    assert_refused(
        |state| {
            state["held"] = json!(["front", "rear", "coupler"]);
            state["velocity"]["joints"]["rear"] = json!(-1.0);
        },
        [
            "loops[0]",
            "the velocities open loops[0] (rear - coupler) at 5.000e-1 m/s",
            "give rates of all joints of the loop, such that both points move alike",
        ],
    );
}

#[test]
fn a_massless_coordinate_that_only_a_loop_holds() {
    let mut mechanism = parallelogram(&[("front", 0.0), ("rear", WIDTH)]);
    mechanism.parts[1] = Part { mass: 0.0, moment: 0.0, ..mechanism.parts[1].clone() };
    let state = state(&mechanism, 0.6, -2.0, json!([pin("rear", WIDTH)]));
    let error = try_impact(&bolted(&mechanism), &state).expect_err("refused");
    assert_eq!(
        (error.reason().to_string().as_str(), error.remedy()),
        (
            "the mass matrix is singular: nothing resists a motion of joint \"rear\"",
            Some(
                "it needs inertia of its own, whatever the loops hold: give its links a mass or it a `rotor_inertia`, however \
                 small, or name it in `held`"
            )
        )
    );
}
