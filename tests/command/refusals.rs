//! What is refused: states, problems and their places, reasons and remedies, word for word.

use super::{RAMONE, WALKER, heelstrike_reads};

/// State, place, message and hint; all for RAMone.
const REFUSED_STATES: &[(&str, &str, &str, &str)] = &[
    (r#"{"frictoin": 1}"#, "frictoin", "unknown field \"frictoin\"", "did you mean friction?"),
    (r#"{"position": {"bases": {}}}"#, "position.bases", "unknown field \"bases\"", "did you mean base?"),
    (
        r#"{"position": {"base": {"y": 0}}}"#,
        "position.base.y",
        "unknown field \"y\"",
        "the fields here are x, z, pitch",
    ),
    (
        r#"{"position": {"joints": {"left_hipp": 0}}}"#,
        "position.joints.left_hipp",
        "the robot has no joint named \"left_hipp\"",
        "did you mean left_hip?",
    ),
    (
        r#"{"velocity": {"joints": {"left_hip": "1"}}}"#,
        "velocity.joints.left_hip",
        "expected a number, found a string",
        "",
    ),
    (r#"{"stance": "left_fot"}"#, "stance", "the robot has no link named \"left_fot\"", "did you mean left_foot?"),
    (
        r#"{"stance": "left_foot", "position": {"base": {"x": 0}}}"#,
        "position.base.x",
        "the stance already gives the base's x",
        "leave out either the stance or the base's x and z",
    ),
    (
        r#"{"velocity": {"base": {"z": 0}}, "stance": "left_foot"}"#,
        "velocity.base.z",
        "the stance already gives the base's z",
        "leave out either the stance or the base's x and z",
    ),
    (r#"{"friction": -0.5}"#, "friction", "friction must be 0 or more, not -0.5", ""),
    (
        r#"{"friction": "Infinite"}"#,
        "friction",
        "expected a number or \"infinite\", found a string",
        "did you mean infinite?",
    ),
    (
        r#"{"friction": {"right_fot": 1}}"#,
        "friction.right_fot",
        "the robot has no link named \"right_fot\"",
        "did you mean right_foot?",
    ),
    (r#"{"restitution": 1.5}"#, "restitution", "restitution must be between 0 and 1, not 1.5", ""),
    (r#"{"restitution": {"default": -1}}"#, "restitution.default", "restitution must be between 0 and 1, not -1", ""),
    (
        r#"{"ground": {"slope": 1.5707963267948966}}"#,
        "ground.slope",
        "slope must be between -pi/2 and pi/2, not 1.5707963267948966",
        "",
    ),
    (
        r#"{"ground": {"profile": [[0, 0], [1, 0], [1, 0.2]]}}"#,
        "ground.profile[2]",
        "a profile's x rises from point to point, but 1.0 follows 1.0",
        "give a vertical riser a tiny width, such as 1e-6 m",
    ),
    (
        r#"{"ground": {"profile": [[0, 0]]}}"#,
        "ground.profile",
        "a profile has at least two points, not 1",
        "level ground is \"ground\": {\"slope\": 0}",
    ),
    (
        r#"{"ground": {"profile": [[0, 0], [1]]}}"#,
        "ground.profile[1]",
        "expected a list of 2 numbers, [x, z], found 1 entries",
        "",
    ),
    (
        r#"{"ground": {"slope": 0, "profile": [[0, 0], [1, 0]]}}"#,
        "ground.profile",
        "the ground has either a slope or a profile",
        "leave one of them out: a profile of two points is a slope, too",
    ),
    (r#"{"uncertainty": {"frict": 0.1}}"#, "uncertainty.frict", "unknown field \"frict\"", "did you mean friction?"),
    (r#"{"uncertainty": 0.1}"#, "uncertainty", "expected an object, found a number", ""),
    (r#"{"uncertainty": {"position": -0.1}}"#, "uncertainty.position", "a half-width must be 0 or more, not -0.1", ""),
    (
        r#"{"uncertainty": {"velocity": {"joints": {"left_knie": 0.1}}}}"#,
        "uncertainty.velocity.joints.left_knie",
        "the robot has no joint named \"left_knie\"",
        "did you mean left_knee?",
    ),
    (
        r#"{"uncertainty": {"friction": {"left_foot": "infinite"}}}"#,
        "uncertainty.friction.left_foot",
        "expected a number, found a string",
        "",
    ),
    (
        r#"{"uncertainty": {"rotor_inertia": {"left_hip": -1}}}"#,
        "uncertainty.rotor_inertia.left_hip",
        "a half-width must be 0 or more, not -1",
        "",
    ),
    (
        r#"{"stance": "left_foot", "uncertainty": {"velocity": {"base": {"x": 0.1}}}}"#,
        "uncertainty.velocity.base.x",
        "the stance gives the base's x from the rest",
        "leave out either the stance or this half-width",
    ),
    (r#"{"held": ["left_knie"]}"#, "held[0]", "the robot has no joint named \"left_knie\"", "did you mean left_knee?"),
    (r#"{"held": ["left_hip", "left_hip"]}"#, "held[1]", "joint \"left_hip\" is given twice", ""),
    (r#"{"rotor_inertia": {"left_hip": -1}}"#, "rotor_inertia.left_hip", "rotor inertia must be 0 or more, not -1", ""),
    (r#"{"contacts": [{"offset": [0, 0, 0]}]}"#, "contacts[0]", "\"link\" is missing", ""),
    (
        r#"{"contacts": [{"link": "left_foot", "offset": [0, 0]}]}"#,
        "contacts[0].offset",
        "expected a list of 3 numbers, found 2 entries",
        "",
    ),
    (
        r#"{"contacts": [{"link": "left_foot", "radius": -1}]}"#,
        "contacts[0].radius",
        "radius must be 0 or more, not -1",
        "",
    ),
    (r#"{"impulse": [{"link": "torso"}]}"#, "impulse[0]", "\"vector\" is missing", ""),
    (r#"{"id": null}"#, "id", "expected a string or a number, found null", ""),
    (r#"{"id": [1]}"#, "id", "expected a string or a number, found a list", ""),
    (r#"{"id": 1, "id": 2}"#, "id", "field \"id\" is given twice", ""),
    (
        r#"{"position": {"joints": {"left_hip": 1, "left_hip": 2}}}"#,
        "position.joints.left_hip",
        "joint \"left_hip\" is given twice",
        "",
    ),
    (r#"{"position": {"base": {"pitch": 1e999}}}"#, "position.base.pitch", "number out of range", ""),
    (
        r#"{"position": {"base": {"pitch": NaN}}}"#,
        "position.base.pitch",
        "expected value",
        "JSON has no NaN and no infinity; numbers are finite",
    ),
    (
        r#"{"friction": 1"#,
        "",
        "EOF while parsing an object",
        "each line must hold a whole state; `jq -c .` writes JSON so",
    ),
    ("[1]", "", "expected an object, found a list", "each line must hold one state; `jq -c '.[]'` takes a list apart"),
];

#[test]
fn every_refused_state_is_told_place_reason_and_remedy() {
    let states: String = REFUSED_STATES.iter().map(|(state, ..)| format!("{state}\n")).collect();
    let run = heelstrike_reads(&["batch", RAMONE, "-"], states);
    assert_eq!(run.status, 1);
    let answers = run.lines();
    assert_eq!(answers.len(), REFUSED_STATES.len());
    for ((state, place, message, hint), answer) in REFUSED_STATES.iter().zip(answers) {
        let told = |field: &str| answer["error"][field].as_str().unwrap_or_default().to_owned();
        assert_eq!(
            (told("message"), told("place"), told("hint")),
            (message.to_string(), place.to_string(), hint.to_string()),
            "{state}"
        );
    }
}

#[test]
fn what_a_bolted_robot_cannot_have_is_refused() {
    for (state, place) in [
        (r#"{"position": {"base": {"pitch": 0}}}"#, "position.base"),
        (r#"{"velocity": {"base": {}}}"#, "velocity.base"),
        (r#"{"stance": "right_leg"}"#, "stance"),
    ] {
        let run = heelstrike_reads(&["batch", WALKER, "-", "--base", "fixed"], state);
        assert_eq!((run.status, run.line()["error"]["place"].as_str()), (1, Some(place)), "{state}");
    }
}

/// Problem, place and message.
const REFUSED_PROBLEMS: &[(&str, &str, &str)] = &[
    (r#"{"friction": 1}"#, "", "\"delassus\" is missing"),
    (r#"{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]]}"#, "", "\"friction\" is missing"),
    (
        r#"{"delassus": [[1, 0]], "velocity_before": [[0, -1]], "friction": 1}"#,
        "delassus",
        "1 contacts need a Delassus matrix of 2 x 2, not 1 x 2",
    ),
    (
        r#"{"delassus": [[1, 0], [0]], "velocity_before": [[0, -1]], "friction": 1}"#,
        "delassus[1]",
        "the row has 1 entries, and the first row 2",
    ),
    (
        r#"{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0]], "friction": 1}"#,
        "velocity_before[0]",
        "expected a list of 2 numbers, [tangential, normal], found 1 entries",
    ),
    (
        r#"{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": [1, 1]}"#,
        "friction",
        "2 entries for 1 contacts",
    ),
    (
        r#"{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": [-1]}"#,
        "friction[0]",
        "friction must be 0 or more, not -1",
    ),
    (
        r#"{"delassus": [[1, 0], [0, 1]], "velocity_before": [[0, -1]], "friction": 1, "restitution": 2}"#,
        "restitution",
        "restitution must be between 0 and 1, not 2",
    ),
    (
        r#"{"mass_matrix": [[1]], "contact_jacobian": [[1]], "velocity": [1], "friction": 1}"#,
        "contact_jacobian",
        "two rows per contact are needed, not 1 in all",
    ),
    (
        r#"{"mass_matrix": [[1]], "delassus": [[1, 0], [0, 1]], "friction": 1}"#,
        "mass_matrix",
        "the problem has both \"delassus\" and \"mass_matrix\"",
    ),
];

#[test]
fn every_refused_problem_is_told_place_and_reason() {
    for (problem, place, message) in REFUSED_PROBLEMS {
        let run = heelstrike_reads(&["solve", "-", "--format", "json"], *problem);
        let answer = run.line();
        assert_eq!(run.status, 1);
        assert_eq!(answer["error"]["message"], *message, "{problem}");
        assert_eq!(answer["error"]["place"].as_str().unwrap_or_default(), *place, "{problem}");
    }
}

#[test]
fn an_asymmetric_delassus_matrix_is_refused_and_other_fields_are_ignored() {
    let problem = |delassus: &str| {
        let text = format!(
            r#"{{"delassus": {delassus}, "velocity_before": [[0, -1]], "friction": 1, "source": {{"a": 1, "a": 2}}}}"#
        );
        heelstrike_reads(&["solve", "-", "--format", "json"], text).status
    };
    assert_eq!(problem("[[2, 1], [1, 2]]"), 0);
    assert_eq!(problem("[[2, 1], [0.9, 2]]"), 1);
    assert_eq!(problem("[[1, 2], [2, 1]]"), 1);
}

#[test]
fn a_refusal_shows_file_line_and_place_to_people() {
    let run = heelstrike_reads(&["impact", RAMONE, "-"], "{\"friction\": 1,\n \"stanse\": \"left_foot\"}");
    assert_eq!((run.status, run.stdout.as_str()), (1, ""));
    insta::assert_snapshot!(run.stderr, @r#"
    error: unknown field "stanse"
     --> <stdin>:2:2
      |
    2 |  "stanse": "left_foot"}
      |  ^^^^^^^^ stanse
      |
    hint: did you mean stance?
    "#);
    let robot = "<robot name=\"r\">\n  <link name=\"a\"><inertial><mass value=\"-1\"/></inertial></link>\n</robot>";
    insta::assert_snapshot!(heelstrike_reads(&["inspect", "-"], robot).stderr, @r#"
    error: value of <mass> must be at least 0, not -1
     --> <stdin>:2:28
      |
    2 |   <link name="a"><inertial><mass value="-1"/></inertial></link>
      |                            ^^^^^^^^^^^^^^^^^^ link "a"
    "#);
    let cut = heelstrike_reads(&["solve", "-"], "{\"id\": 1,\n \"delassus\": [[2, 1],\n  [1, 2]");
    insta::assert_snapshot!(cut.stderr, @r#"
    error: EOF while parsing a list
     --> <stdin>:3:8
      |
    3 |   [1, 2]
      |        ^ delassus
      |
    hint: the text ends too early: is it whole?
    "#);
    // Of a long line what is near the place; line and column are those of the file.
    let long = format!("{{\"id\": {}1, \"stanse\": 2}}", " ".repeat(200));
    insta::assert_snapshot!(heelstrike_reads(&["impact", RAMONE, "-"], long).stderr, @r#"
    error: <stdin>:1:211: stanse: unknown field "stanse"
      |
    1 | ...                                               1, "stanse": 2}
      |                                                      ^^^^^^^^ stanse
      |
    hint: did you mean stance?
    "#);
    // In a list the place is that in the whole file.
    let second = "[{\"friction\": 1},\n  {\"friction\": 1, \"held\": [\"left_knie\"]}]";
    insta::assert_snapshot!(heelstrike_reads(&["impact", RAMONE, "-", "--brief"], second).stderr, @r#"
    error: link "left_foot" is 6.043e-1 m deep in the ground, more than the contact tolerance of 6.043e-7 m
     --> <stdin>:1:2
      |
    1 | [{"friction": 1},
      |  ^
      |
    hint: raise the base by 0.604325 m, correct the pose, or accept it by a greater --contact-tolerance
    error: the robot has no joint named "left_knie"
     --> <stdin>:2:28
      |
    2 |   {"friction": 1, "held": ["left_knie"]}]
      |                            ^^^^^^^^^^^ held[0]
      |
    hint: did you mean left_knee?
    "#);
}

#[test]
fn of_many_refusals_the_first_are_shown_with_their_lines_and_the_last_are_counted() {
    let run = heelstrike_reads(&["solve", "-"], "{\"friction\": 1}\n".repeat(50));
    assert_eq!(run.status, 1);
    let count = |what: &str| run.stderr.matches(what).count();
    assert_eq!((count("\"delassus\" is missing"), count(" --> <stdin>:"), count("error: <stdin>:")), (50, 10, 40));
    let more = heelstrike_reads(&["solve", "-"], "{\"friction\": 1} ".repeat(150));
    assert!(more.stderr.ends_with("\nnote: 50 more were refused\n"), "{}", more.stderr);
}
