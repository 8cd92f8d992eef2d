//! One RAMone state (7 coordinates, 2 contacts) from (q, v) to its outcomes, stage by stage.
//!
//! `cargo bench --bench impact` prints times and allocations; compare stages within one run, not runs with each other.
//! Unless stages are chosen, the ratios to code written by hand for this robot, and to serde_json alone, follow at the
//! end.

mod closed_form;
mod ratios;

use divan::{AllocProfiler, Bencher, black_box};
use heelstrike::Robot;
use heelstrike::dynamics::plan::{Configuration, Plan};
use heelstrike::dynamics::{
    ContactPoint, PointImpulse, Workspace, add_articulated_impulse, articulated_inertias, contact_jacobian, delassus,
    factorize, kinematics, mass_matrix,
};
use heelstrike::impact::enumerate::{Leaf, Tableau};
use heelstrike::impact::{AnalysisOptions, ContactProblem, Mode, Scratch};
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::planar::{Rotation, Vector};
use heelstrike::state::{Defaults, NamedContact, State};

const STATE: &str = r#"{"position": {"base": {"z": 0.4, "pitch": 0.05},
    "joints": {"left_hip": 1.2, "left_knee": -1.5, "right_hip": 0.3, "right_knee": -1.6}},
  "velocity": {"base": {"x": 0.4, "z": -0.3, "pitch": 0.5}, "joints": {"left_hip": -0.4, "right_knee": 0.7}},
  "contacts": [{"link": "left_foot", "offset": [0, 0, 0], "radius": 0.02815},
               {"link": "right_foot", "offset": [0, 0, 0], "radius": 0.02815}],
  "friction": 0.8}"#;

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

fn main() {
    divan::main();
    match std::env::args().skip(1).collect::<Vec<_>>().join(" ").as_str() {
        "" | "--bench" => ratios::print(100),
        "--test" => ratios::print(1),
        _ => {}
    }
}

fn ramone() -> Robot {
    Robot::from_urdf(include_str!("../../urdf/ramone.urdf")).expect("a good robot")
}

fn state(robot: &Robot) -> State {
    State::from_json(STATE, robot, &Defaults::default()).expect("a good state")
}

fn points(robot: &Robot, state: &State) -> Vec<ContactPoint> {
    let contacts: &[NamedContact] = state.scene.contacts.as_deref().expect("named contacts");
    let point = |contact: &NamedContact| {
        let link = &robot.links()[contact.link];
        let ground = Rotation { cos: 1.0, sin: 0.0 };
        ContactPoint { body: link.body, center: link.point(contact.offset), radius: contact.radius, ground }
    };
    contacts.iter().map(point).collect()
}

fn problem(robot: &Robot, state: &State) -> ContactProblem {
    Pipeline::new(robot, Options::default()).unsolved(state).expect("a good state").problem
}

/// From q to its cosines and sines, and to M, J, G and c.
#[divan::bench]
fn dynamics(bencher: Bencher) {
    let robot = ramone();
    let state = state(&robot);
    let points = points(&robot, &state);
    let (plan, mut posture, mut workspace) =
        (Plan::new(&robot, &[], &[]), Configuration::default(), Workspace::default());
    bencher.bench_local(move || {
        posture.set(&plan, black_box(&state.position));
        kinematics(&plan, &posture, &mut workspace);
        mass_matrix(&plan, &mut workspace);
        factorize(&plan, &mut workspace);
        contact_jacobian(&plan, &points, &state.velocity, None, &mut workspace);
        delassus(&plan, &mut workspace);
        workspace.delassus[0]
    });
}

/// From impulses at both feet to the velocities of base and joints after them.
#[divan::bench]
fn velocity_after(bencher: Bencher) {
    let robot = ramone();
    let state = state(&robot);
    let points = points(&robot, &state);
    let (plan, mut posture, mut workspace) =
        (Plan::new(&robot, &[], &[]), Configuration::default(), Workspace::default());
    posture.set(&plan, &state.position);
    kinematics(&plan, &posture, &mut workspace);
    let (mut rates, mut motions) = (Vec::new(), Vec::new());
    bencher.bench_local(move || {
        let mut after = black_box(&state.velocity).clone();
        articulated_inertias(&plan, &mut workspace);
        for point in &points {
            let (arm, vector) = (point.arm(&workspace), Vector::new(0.1, 0.2));
            let impulse = PointImpulse { body: point.body, arm, vector };
            add_articulated_impulse(&plan, &workspace, impulse, &mut rates, &mut motions, &mut after);
        }
        after
    });
}

/// The numbers of all 16 combinations.
#[divan::bench]
fn enumeration(bencher: Bencher) {
    let robot = ramone();
    let problem = problem(&robot, &state(&robot));
    let mut tableau = Tableau::default();
    bencher.bench_local(move || {
        tableau.load(black_box(&problem));
        let mut sum = 0.0;
        tableau.visit(&mut |leaf: &Leaf<'_, f64>| {
            sum += leaf.numbers(0)[0] + f64::from(u8::from(leaf.modes[1] == Mode::Stick));
        });
        sum
    });
}

/// From a contact problem to its analysis.
#[divan::bench]
fn analysis(bencher: Bencher) {
    let robot = ramone();
    let problem = problem(&robot, &state(&robot));
    let mut scratch = Scratch::default();
    bencher.bench_local(move || scratch.analyze(black_box(&problem), black_box(&problem), AnalysisOptions::default()));
}

/// From a state in numbers to its whole answer.
#[divan::bench]
fn whole_state(bencher: Bencher) {
    let robot = ramone();
    let state = state(&robot);
    let mut pipeline = Pipeline::new(&robot, Options::default());
    bencher.bench_local(|| pipeline.impact(black_box(&state)));
}

/// From the same pose, at rest or sliding on both feet, to all forces and accelerations.
#[divan::bench(args = [0.0, 0.4])]
fn whole_state_in_sustained_contact(bencher: Bencher, speed: f64) {
    let robot = ramone();
    let mut state = state(&robot);
    state.velocity.fill(0.0);
    state.velocity[0] = speed;
    state.scene.torque = vec![1.0, -3.0, 0.5, 2.0];
    let mut pipeline = Pipeline::new(&robot, Options::default());
    bencher.bench_local(|| pipeline.forces(black_box(&state)));
}

/// [`whole_state`] without bounds of the dynamics' rounding, and so without a proof.
#[divan::bench]
fn whole_state_without_proof(bencher: Bencher) {
    let robot = ramone();
    let state = state(&robot);
    let mut pipeline = Pipeline::new(&robot, Options { no_proof: true, ..Options::default() });
    bencher.bench_local(|| pipeline.impact(black_box(&state)));
}

/// From a state as JSON text to its whole answer.
#[divan::bench]
fn whole_state_from_json(bencher: Bencher) {
    let robot = ramone();
    let mut pipeline = Pipeline::new(&robot, Options::default());
    bencher.bench_local(|| {
        let state = State::from_json(black_box(STATE), &robot, &Defaults::default())?;
        pipeline.impact(&state)
    });
}

/// From a zigzag chain of `links` links that strikes with both ends to its outcomes.
#[divan::bench(args = [10, 30, 100, 300, 1000])]
fn chain(bencher: Bencher, links: usize) {
    let (length, mass) = (2.0 / links as f64, 10.0 / links as f64);
    let link = |at: usize| {
        let com = format!("<origin xyz=\"0 0 {}\"/><mass value=\"{mass}\"/>", -length / 2.0);
        let moment = mass * length * length / 12.0;
        format!(
            "<link name=\"l{at}\"><inertial>{com}<inertia ixx=\"{moment}\" iyy=\"{moment}\" izz=\"{moment}\"/></inertial></link>"
        )
    };
    let joint = |at: usize| {
        let ends = format!("<parent link=\"l{}\"/><child link=\"l{at}\"/>", at - 1);
        let place = format!("<origin xyz=\"0 0 {}\"/><axis xyz=\"0 -1 0\"/>", -length);
        format!("<joint name=\"j{at}\" type=\"continuous\">{ends}{place}</joint>")
    };
    let parts: String = (0..links).map(link).chain((1..links).map(joint)).collect();
    let robot = Robot::from_urdf(&format!("<robot name=\"chain\">{parts}</robot>")).expect("a good robot");
    let bend = if links < 50 { 0.3 } else { 0.1 };
    let joint = |at: usize| format!("\"j{at}\": {}", if at.is_multiple_of(2) { bend } else { -bend });
    let joints = (1..links).map(joint).collect::<Vec<_>>().join(", ");
    let state = format!(
        r#"{{"position": {{"base": {{"z": 1, "pitch": 0.1}}, "joints": {{{joints}}}}},
            "velocity": {{"base": {{"x": 0.3, "z": -1, "pitch": 0.2}}}}, "friction": 0.7,
            "contacts": [{{"link": "l{}", "offset": [0, 0, {}]}}, {{"link": "l0"}}]}}"#,
        links - 1,
        -length
    );
    let state = State::from_json(&state, &robot, &Defaults::default()).expect("a good state");
    let mut pipeline = Pipeline::new(&robot, Options { brief: true, ..Options::default() });
    let impact = pipeline.impact(&state).expect("an answer");
    assert!(impact.analyzed().expect("two contacts").proven);
    bencher.bench_local(|| pipeline.impact(black_box(&state)));
}

/// From a body with 24 boxes, two of which stand on the ground, to its contacts and outcomes.
#[divan::bench]
fn many_shapes(bencher: Bencher) {
    let shape = |at: usize| {
        let (x, z) = if at < 2 { (0.4 * at as f64 - 0.2, 0.0) } else { (0.0, 0.1 * at as f64) };
        format!("<collision><origin xyz=\"{x} 0 {z}\"/><geometry><box size=\"0.1 0.1 0.1\"/></geometry></collision>")
    };
    let shapes: String = (0..24).map(shape).collect();
    let inertial = "<inertial><mass value=\"2\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>";
    let urdf = format!("<robot name=\"r\"><link name=\"body\">{inertial}{shapes}</link></robot>");
    let robot = Robot::from_urdf(&urdf).expect("a good robot");
    let state = r#"{"position": {"base": {"z": 0.05, "pitch": 1e-3}}, "velocity": {"base": {"z": -1}}, "friction": 1}"#;
    let state = State::from_json(state, &robot, &Defaults::default()).expect("a good state");
    let options = Options { contact_tolerance: Some(1e-3), ..Options::default() };
    let mut pipeline = Pipeline::new(&robot, options);
    assert!(!pipeline.impact(&state).expect("an answer").contacts.is_empty());
    bencher.bench_local(|| pipeline.impact(black_box(&state)));
}
