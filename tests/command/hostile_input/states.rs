//! States and problems that are refused.

use super::{assert_refused, case};
use heelstrike::Robot;
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::read::Problem;
use heelstrike::state::{Defaults, State};

#[test]
fn states_are_refused_word_for_word() {
    let ramone = std::fs::read_to_string("urdf/ramone.urdf").expect("the file");
    let ramone = Robot::from_urdf(&ramone).expect("a robot");
    let cases = vec![
        case("no object", "[1]".into(), "1:1: expected an object, found a list"),
        case("no object", "1".into(), "1:1: expected an object, found a number"),
        case("no object", "\"friction\"".into(), "1:1: expected an object, found a string"),
        case("no object", "null".into(), "1:1: expected an object, found null"),
        case("no object", "friction: 1".into(), "1:2: expected value"),
        case("cut", String::new(), "1:1: EOF while parsing a value | the text ends too early: is it whole?"),
        case("cut", "{".into(), "1:1: EOF while parsing an object | the text ends too early: is it whole?"),
        case(
            "cut",
            "{\"friction\": 1".into(),
            "1:14: EOF while parsing an object | the text ends too early: is it whole?",
        ),
        case(
            "cut",
            "{\"position\": {\"base\": {\"x\":".into(),
            "1:27: position.base.x: EOF while parsing a value | the text ends too early: is it whole?",
        ),
        case(
            "cut",
            "{\"stance\": \"left_fo".into(),
            "1:19: stance: EOF while parsing a string | the text ends too early: is it whole?",
        ),
        case(
            "numbers",
            "{\"velocity\": {\"base\": {\"x\": NaN}}}".into(),
            "1:29: velocity.base.x: expected value | JSON has no NaN and no infinity; numbers are finite",
        ),
        case(
            "numbers",
            "{\"velocity\": {\"base\": {\"x\": Infinity}}}".into(),
            "1:29: velocity.base.x: expected value | JSON has no NaN and no infinity; numbers are finite",
        ),
        case(
            "numbers",
            "{\"velocity\": {\"base\": {\"x\": -1e999}}}".into(),
            "1:34: velocity.base.x: number out of range",
        ),
        case("numbers", "{\"velocity\": {\"base\": {\"x\": 01}}}".into(), "1:30: velocity.base.x: invalid number"),
        case(
            "numbers",
            "{\"contacts\": [{\"link\": \"left_foot\", \"offset\": [0, 0, 1e400]}]}".into(),
            "1:58: contacts[0].offset[2]: number out of range",
        ),
        case("given twice", "{\"id\": 1,\n \"id\": 2}".into(), "2:2: id: field \"id\" is given twice"),
        case("given twice", "{\"id\": 1, \"i\\u0064\": 2}".into(), "1:1: id: field \"id\" is given twice"),
        case(
            "given twice",
            "{\"position\": {\"joints\": {\"left_hip\": 1, \"left_hip\": 1}}}".into(),
            "1:41: position.joints.left_hip: joint \"left_hip\" is given twice",
        ),
        case(
            "given twice",
            "{\"position\": {\"base\": {\"x\": 1, \"z\": 1, \"x\": 1}}}".into(),
            "1:40: position.base.x: base entry \"x\" is given twice",
        ),
        case(
            "given twice",
            "{\"held\": [\"left_hip\", \"left_hip\"]}".into(),
            "1:23: held[1]: joint \"left_hip\" is given twice",
        ),
        case("nesting", "[".repeat(200_000), "1:128: brackets are nested too deep"),
        case("nesting", "{\"position\":".repeat(200_000), "1:1525: brackets are nested too deep"),
        case(
            "nesting",
            format!("{{\"position\": {}{}}}", "[".repeat(200), "]".repeat(200)),
            "1:140: brackets are nested too deep",
        ),
        case(
            "unknown fields",
            "{\"frictoin\": 1}".into(),
            "1:2: frictoin: unknown field \"frictoin\" | did you mean friction?",
        ),
        case(
            "unknown fields",
            "{\"position\": {\"base\": {\"y\": 0}}}".into(),
            "1:24: position.base.y: unknown field \"y\" | the fields here are x, z, pitch",
        ),
        case(
            "unknown fields",
            "{\"velocity\": {\"base\": {\"qw\": 1}}}".into(),
            "1:24: velocity.base.qw: unknown field \"qw\" | the fields here are x, z, pitch",
        ),
        case(
            "unknown fields",
            "{\"position\": [0, 0.44, 0]}".into(),
            "1:2: position: expected an object, found a list",
        ),
        case(
            "unknown fields",
            format!("{{\"{}\": 1}}", "x".repeat(1_000_000)),
            "1:2: xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx: unknown field \"xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx\" | the fields here are id, position, velocity, friction, restitution, ground, stance, held, rotor_inertia, contacts, loops, uncertainty, impulse",
        ),
        case(
            "names",
            "{\"stance\": \"left_fot\"}".into(),
            "1:12: stance: the robot has no link named \"left_fot\" | did you mean left_foot?",
        ),
        case(
            "names",
            "{\"position\": {\"joints\": {\"left_hipp\": 0}}}".into(),
            "1:26: position.joints.left_hipp: the robot has no joint named \"left_hipp\" | did you mean left_hip?",
        ),
        case(
            "names",
            "{\"friction\": {\"left_leg\": 1}}".into(),
            "1:15: friction.left_leg: the robot has no link named \"left_leg\" | did you mean left_thigh?",
        ),
        case("names", "{\"held\": [\"torso\"]}".into(), "1:11: held[0]: the robot has no joint named \"torso\""),
        case(
            "names",
            format!("{{\"stance\": \"{}\"}}", "é".repeat(500_000)),
            "1:12: stance: the robot has no link named \"éééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééééé...éééééééééééééééééééééééééééééééééééééééé\"",
        ),
        case("ids", "{\"id\": null}".into(), "1:2: id: expected a string or a number, found null"),
        case("ids", "{\"id\": [1]}".into(), "1:2: id: expected a string or a number, found a list"),
        case("ids", "{\"id\": {\"k\": 1}}".into(), "1:2: id: expected a string or a number, found an object"),
        case("ids", "{\"id\": true}".into(), "1:2: id: expected a string or a number, found true or false"),
        case(
            "slopes",
            "{\"ground\": {\"slope\": 1.5707963267948966}}".into(),
            "1:13: ground.slope: slope must be between -pi/2 and pi/2, not 1.5707963267948966",
        ),
        case(
            "slopes",
            "{\"ground\": {\"slope\": -2}}".into(),
            "1:13: ground.slope: slope must be between -pi/2 and pi/2, not -2",
        ),
        case(
            "slopes",
            "{\"ground\": {\"slope\": \"steep\"}}".into(),
            "1:22: ground.slope: expected a number, found a string",
        ),
        case(
            "profiles",
            "{\"ground\": {\"profile\": [[0, 0], [1, 1e999]]}}".into(),
            "1:41: ground.profile[1][1]: number out of range",
        ),
        case(
            "profiles",
            "{\"ground\": {\"profile\": [[1, 0], [0, 0]]}}".into(),
            "1:13: ground.profile[1]: a profile's x rises from point to point, but 0.0 follows 1.0 | give a vertical riser a tiny width, such as 1e-6 m",
        ),
        case(
            "profiles",
            "{\"ground\": {\"profile\": [[-1e308, 0], [1e308, 0]]}}".into(),
            "1:13: ground.profile[1]: the distance from the point before is beyond the range of f64 | give the points in metres",
        ),
        case(
            "profiles",
            "{\"ground\": {\"profile\": []}}".into(),
            "1:13: ground.profile: a profile has at least two points, not 0 | level ground is \"ground\": {\"slope\": 0}",
        ),
        case("slopes", "{\"ground\": 0.1}".into(), "1:2: ground: expected an object, found a number"),
        case(
            "restitution",
            "{\"restitution\": 1.5}".into(),
            "1:2: restitution: restitution must be between 0 and 1, not 1.5",
        ),
        case(
            "restitution",
            "{\"restitution\": -1e-300}".into(),
            "1:2: restitution: restitution must be between 0 and 1, not -1e-300",
        ),
        case(
            "restitution",
            "{\"restitution\": {\"left_foot\": 2}}".into(),
            "1:18: restitution.left_foot: restitution must be between 0 and 1, not 2",
        ),
        case("restitution", "{\"restitution\": \"1\"}".into(), "1:17: restitution: expected a number, found a string"),
        case("friction", "{\"friction\": -0.5}".into(), "1:2: friction: friction must be 0 or more, not -0.5"),
        case(
            "friction",
            "{\"friction\": \"Infinite\"}".into(),
            "1:14: friction: expected a number or \"infinite\", found a string | did you mean infinite?",
        ),
        case("friction", "{\"friction\": [1]}".into(), "1:2: friction: expected a number, found a list"),
        case(
            "shapes of values",
            "{\"contacts\": [{\"link\": \"left_foot\", \"radius\": -1}]}".into(),
            "1:37: contacts[0].radius: radius must be 0 or more, not -1",
        ),
        case(
            "shapes of values",
            "{\"contacts\": [{\"offset\": [0, 0, 0]}]}".into(),
            "1:2: contacts[0]: \"link\" is missing",
        ),
        case(
            "shapes of values",
            "{\"impulse\": [{\"link\": \"torso\", \"vector\": [0, 0, 0]}]}".into(),
            "1:32: impulse[0].vector: expected a list of 2 numbers, [x, z], found 3 entries",
        ),
        case(
            "shapes of values",
            "{\"rotor_inertia\": {\"left_hip\": -1}}".into(),
            "1:20: rotor_inertia.left_hip: rotor inertia must be 0 or more, not -1",
        ),
        case(
            "contradictions",
            "{\"stance\": \"left_foot\", \"position\": {\"base\": {\"x\": 0}}}".into(),
            "1:47: position.base.x: the stance already gives the base's x | leave out either the stance or the base's x and z",
        ),
        case(
            "beyond f64",
            "{\"friction\": 1, \"contacts\": [{\"link\": \"left_foot\", \"offset\": [1e200, 0, 0]}]}".into(),
            "an entry of the Delassus matrix must be a finite number, not inf | positions and velocities are too large for f64: are they in SI units?",
        ),
        case(
            "beyond f64",
            "{\"friction\": 1, \"contacts\": [], \"velocity\": {\"joints\": {\"left_hip\": 1e200}}}".into(),
            "velocity.joints.left_hip: the kinetic energy must be a finite number, not inf | positions and velocities are too large for f64: are they in SI units?",
        ),
        case(
            "beyond f64",
            "{\"friction\": 1, \"contacts\": [], \"velocity\": {\"base\": {\"x\": -1e200}, \"joints\": {\"left_hip\": 1e9}}}".into(),
            "velocity.base.x: the kinetic energy must be a finite number, not inf | positions and velocities are too large for f64: are they in SI units?",
        ),
        case(
            "too many",
            format!("{{\"friction\": 1, \"contacts\": [{}]}}", vec!["{\"link\": \"left_foot\"}"; 200_000].join(", ")),
            "200000 contacts are closed, and matrices are formed for 500 at most | name the contacts that matter by hand, or lower the contact tolerance",
        ),
        case(
            "too many",
            format!("{{\"friction\": 1, \"contacts\": [{}]}}", ["{\"link\": \"left_foot\"}"; 11].join(", ")),
            "11 contacts are closed, and every combination of modes is tried for 10 at most | name the contacts that matter by hand, or lower the contact tolerance",
        ),
    ];
    assert_refused(cases, 50, &["impact", "urdf/ramone.urdf", "-"], |text| {
        let state = State::from_json(text, &ramone, &Defaults::default())?;
        Pipeline::new(&ramone, Options::default()).impact(&state)?.analysis.map(drop)
    });
}

fn delassus(matrix: &str) -> String {
    format!("{{\"delassus\": {matrix}, \"velocity_before\": [[0, -1]], \"friction\": 1}}")
}

fn dynamics(mass_matrix: &str, contact_jacobian: &str) -> String {
    format!(
        "{{\"mass_matrix\": {mass_matrix}, \"velocity\": [1], \"friction\": 1, \"contact_jacobian\": {contact_jacobian}}}"
    )
}

#[test]
fn problems_are_refused_word_for_word() {
    let cases = vec![
        case("no object", "[[]]".into(), "1:1: expected an object, found a list"),
        case(
            "cut",
            "{\"delassus\": [[2, 1], [1".into(),
            "1:24: delassus[1]: EOF while parsing a list | the text ends too early: is it whole?",
        ),
        case(
            "missing",
            "{\"friction\": 1}".into(),
            "1:1: \"delassus\" is missing | give \"delassus\" and \"velocity_before\", or \"mass_matrix\", \"contact_jacobian\" and \"velocity\"",
        ),
        case(
            "missing",
            "{\"delassus\": [[1, 0], [0, 1]], \"friction\": 1}".into(),
            "1:1: \"velocity_before\" is missing",
        ),
        case(
            "missing",
            "{\"delassus\": [[1, 0], [0, 1]], \"velocity_before\": [[0, -1]]}".into(),
            "1:1: \"friction\" is missing | add \"friction\" to the problem, or give --friction",
        ),
        case(
            "shapes",
            delassus("[[1, 0]]"),
            "1:2: delassus: 1 contacts need a Delassus matrix of 2 x 2, not 1 x 2 | two rows and columns per contact, tangential and normal",
        ),
        case("shapes", delassus("[[1, 0], [0]]"), "1:2: delassus[1]: the row has 1 entries, and the first row 2"),
        case(
            "shapes",
            delassus("[]"),
            "1:2: delassus: 1 contacts need a Delassus matrix of 2 x 2, not 0 x 0 | two rows and columns per contact, tangential and normal",
        ),
        case("shapes", delassus("[[1, 0], [0, \"1\"]]"), "1:27: delassus[1][1]: expected a number, found a string"),
        case(
            "shapes",
            "{\"delassus\": [[1, 0], [0, 1]], \"velocity_before\": [0, -1], \"friction\": 1}".into(),
            "1:32: velocity_before[0]: expected a list of 2 numbers, [tangential, normal], found a number",
        ),
        case(
            "no Delassus matrix",
            delassus("[[2, 1], [0.9, 2]]"),
            "1:2: delassus[1][0]: the Delassus matrix is not symmetric: 0.9 against 1 | G = J M^-1 J^T is symmetric; check the order of rows and columns",
        ),
        case(
            "no Delassus matrix",
            delassus("[[1, 2], [2, 1]]"),
            "1:2: delassus[1][0]: the Delassus matrix is indefinite: an impulse there would gain energy | G = J M^-1 J^T is positive semidefinite; check signs and units",
        ),
        case(
            "no Delassus matrix",
            delassus("[[1, 0], [0, -1]]"),
            "1:2: delassus[1][1]: the Delassus matrix is indefinite: an impulse there would gain energy | G = J M^-1 J^T is positive semidefinite; check signs and units",
        ),
        case(
            "no Delassus matrix",
            dynamics("[[0]]", "[[1], [0]]"),
            "1:2: mass_matrix[0][0]: the mass matrix is singular: nothing resists a motion of coordinate 0 | every coordinate needs inertia: add a mass, or a rotor inertia on the diagonal",
        ),
        case(
            "no Delassus matrix",
            dynamics("[[1, 0], [0, 1]]", "[[1], [0]]"),
            "1:2: mass_matrix: mass_matrix must have 1 rows of 1 numbers | its columns are the entries of `velocity`",
        ),
        case("numbers", delassus("[[1e999, 0], [0, 1]]"), "1:20: delassus[0][0]: number out of range"),
        case(
            "numbers",
            dynamics("[[1]]", "[[1e200], [1e200]]"),
            "entry [0][0] of J M^-1 J^T must be a finite number, not inf",
        ),
        case(
            "too many",
            dynamics("[[1]]", &format!("[{}]", vec!["[1]"; 1_000_000].join(","))),
            "500000 contacts are closed, and matrices are formed for 500 at most | name the contacts that matter by hand, or lower the contact tolerance",
        ),
    ];
    assert_refused(cases, 15, &["solve", "-"], |text| {
        let problem = Problem::from_json(text, &Defaults::default())?;
        heelstrike::impact::analyse(&problem.contact, false).map(drop)
    });
}
