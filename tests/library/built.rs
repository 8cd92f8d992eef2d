//! What a program builds without JSON: states and options are refused for the same reasons, and an index that does not
//! exist is an error.

use crate::support::impact::{ramone, reduced};
use heelstrike::description::Description;
use heelstrike::dynamics::plan::{Configuration, Plan};
use heelstrike::dynamics::{Workspace, kinematics, mass_matrix};
use heelstrike::pipeline::{Aspect, Options};
use heelstrike::planar::Vector;
use heelstrike::robot::{Base, Reduction};
use heelstrike::state::{
    AppliedImpulse, ByLink, Ground, LinkPoint, NamedContact, NamedLoop, SpringEnd, SpringLaw, Uncertainty,
    VirtualSpring,
};
use heelstrike::{Defaults, Detail, Error, Friction, Pipeline, Report, Robot, State};
use serde_json::Value;

/// A state that falls on its lower foot, and whose half-widths are zero.
fn falling(robot: &Robot) -> State {
    let mut state = State::zero(robot);
    if robot.base() == Base::Floating {
        state.set_velocity(robot, "z", -1.0).unwrap();
    }
    state.scene.place_lowest = true;
    state.scene.friction = ByLink::everywhere(Friction::from(0.5));
    let zero = || vec![0.0; robot.dofs()];
    let (friction, rotor_inertia) = (ByLink::default(), Vec::new());
    state.uncertainty = Some(Uncertainty { position: zero(), velocity: zero(), friction, rotor_inertia });
    state
}

fn contact(z: f64, radius: f64) -> NamedContact {
    NamedContact { link: 0, offset: [0.0, 0.0, z], radius }
}

/// The error with its place.
fn said(error: &Error) -> String {
    format!("{}: {}", error.place().expect("a place"), error.reason())
}

fn refused(robot: &Robot, change: impl Fn(&mut State)) -> String {
    let mut state = falling(robot);
    change(&mut state);
    let mut errors = [Aspect::Impact, Aspect::Forces].map(|aspect| {
        let mut pipeline = Pipeline::new(robot, Options { aspect, ..Options::default() });
        said(&pipeline.answer(&state).expect_err("refused"))
    });
    // Forces refuse any applied impulse first.
    if state.scene.impulses.is_empty() {
        assert_eq!(errors[0], errors[1]);
    }
    std::mem::take(&mut errors[0])
}

#[test]
fn half_widths_built_in_code_are_checked() {
    let robot = ramone();
    let of = |change: &dyn Fn(&mut Uncertainty)| {
        refused(&robot, |state| change(state.uncertainty.as_mut().expect("an uncertainty")))
    };
    let negative = "a half-width must be 0 or more, not -0.001";
    let nan = "a half-width must be a finite number, not NaN";
    assert_eq!(of(&|own| own.position[3] = f64::NAN), format!("uncertainty.position.joints.left_hip: {nan}"));
    assert_eq!(of(&|own| own.velocity[2] = -1e-3), format!("uncertainty.velocity.base.pitch: {negative}"));
    assert!(of(&|own| own.position[3] = f64::INFINITY).ends_with("not inf"));
    assert_eq!(of(&|own| own.friction = ByLink::everywhere(f64::NAN)), format!("uncertainty.friction: {nan}"));
    let of_foot = [(robot.link("left_foot").unwrap(), -1e-3)].into();
    let friction = ByLink { default: None, links: of_foot };
    assert_eq!(of(&|own| own.friction = friction.clone()), format!("uncertainty.friction.left_foot: {negative}"));
    assert_eq!(
        of(&|own| own.rotor_inertia = vec![0.0, -1e-3, 0.0, 0.0]),
        format!("uncertainty.rotor_inertia.left_knee: {negative}")
    );
    let short = "uncertainty.rotor_inertia: the robot needs 4 entries here, but 1 are given";
    assert_eq!(of(&|own| own.rotor_inertia = vec![0.1]), short);
}

#[test]
fn an_index_that_the_robot_does_not_have_is_refused() {
    let robot = ramone();
    let of = |change: &dyn Fn(&mut State)| refused(&robot, change);
    let none = |count: usize, what| format!("no index 99: the robot has {count} {what}, counted from 0");
    let (link, joint) = (none(robot.links().len(), "links"), none(robot.joints().len(), "joints"));
    let [base, point] = [0, 99].map(|link| LinkPoint { link, offset: [0.0; 3] });
    let foreign = NamedContact { link: 99, ..contact(0.0, 0.0) };
    assert_eq!(of(&|state| state.scene.stance = Some(99)), format!("stance: {link}"));
    assert_eq!(of(&|state| state.scene.contacts = Some(vec![foreign])), format!("contacts: {link}"));
    assert_eq!(of(&|state| state.scene.loops = vec![NamedLoop { a: base, b: point }]), format!("loops: {link}"));
    assert_eq!(of(&|state| state.scene.braked = vec![99]), format!("held: {joint}"));
    let friction = ByLink { default: None, links: [(99, Friction::ZERO)].into() };
    assert_eq!(of(&|state| state.scene.friction = friction.clone()), format!("friction: {link}"));
    let short = |state: &mut State| state.uncertainty.as_mut().expect("an uncertainty").velocity.clear();
    assert!(of(&short).starts_with("uncertainty.velocity: "));
}

/// The same numbers in JSON are refused for the same reason at the same place.
#[test]
fn a_state_built_in_code_is_refused_as_in_json() {
    let robot = ramone();
    let alike = |json: &str, change: &dyn Fn(&mut State)| {
        let read = State::from_json(json, &robot, &Defaults::default()).expect_err(json);
        assert_eq!(refused(&robot, change), said(&read));
    };
    alike(r#"{"rotor_inertia": {"left_hip": -0.01}}"#, &|state| state.scene.rotor_inertia = vec![-0.01; 4]);
    alike(r#"{"contacts": [{"link": "torso"}, {"link": "torso", "radius": -0.5}]}"#, &|state| {
        state.scene.contacts = Some(vec![contact(0.0, 0.0), contact(0.0, -0.5)]);
    });
    alike(r#"{"ground": {"slope": 10}}"#, &|state| state.scene.ground = Ground::Slope(10.0));
    alike(r#"{"stance": "left_foot", "place": "lowest"}"#, &|state| state.scene.stance = robot.link("left_foot"));
    alike(r#"{"held": ["left_hip", "left_hip"]}"#, &|state| {
        state.scene.braked = vec![robot.joint("left_hip").unwrap(); 2];
    });
    let torso = LinkPoint { link: 0, offset: [0.0; 3] };
    let loops = vec![r#"{"a": {"link": "torso"}, "b": {"link": "torso"}}"#; 257].join(", ");
    alike(&format!(r#"{{"loops": [{loops}]}}"#), &|state| {
        state.scene.loops = vec![NamedLoop { a: torso, b: torso }; 257];
    });
    alike(r#"{"friction": -0.5}"#, &|state| state.scene.friction = ByLink::everywhere(Friction::Finite(-0.5)));
    alike(r#"{"restitution": {"torso": 1.5}}"#, &|state| {
        state.scene.restitution.links.insert(0, 1.5);
    });
}

#[test]
fn a_number_that_is_not_finite_is_refused_with_its_place() {
    let robot = ramone();
    let at = |change: &dyn Fn(&mut State)| refused(&robot, change).split(": ").next().unwrap_or_default().to_owned();
    let velocity = "velocity.base.x: a velocity must be a finite number, not NaN";
    assert_eq!(refused(&robot, |state| state.velocity[0] = f64::NAN), velocity);
    assert_eq!(at(&|state| state.position[4] = f64::INFINITY), "position.joints.left_knee");
    assert_eq!(at(&|state| state.scene.rotor_inertia = vec![0.0, 0.0, f64::NAN, 0.0]), "rotor_inertia.right_hip");
    assert_eq!(at(&|state| state.scene.torque = vec![f64::NAN; 4]), "torque.left_hip");
    assert_eq!(at(&|state| state.scene.torque = vec![1.0]), "torque");
    assert_eq!(at(&|state| state.scene.rotor_inertia = vec![0.01]), "rotor_inertia");
    assert_eq!(at(&|state| state.scene.gravity = Some(f64::NAN)), "gravity");
    assert_eq!(at(&|state| state.scene.ground = Ground::Slope(f64::NAN)), "ground.slope");
    assert_eq!(at(&|state| state.scene.contacts = Some(vec![contact(f64::NAN, 0.0)])), "contacts[0].offset[2]");
    assert_eq!(at(&|state| state.scene.contacts = Some(vec![contact(0.0, f64::NAN)])), "contacts[0].radius");
    let [sound, broken] = [0.0, f64::NAN].map(|y| LinkPoint { link: 0, offset: [0.0, y, 0.0] });
    assert_eq!(at(&|state| state.scene.loops = vec![NamedLoop { a: sound, b: broken }]), "loops[0].b.offset[1]");
    let impulse = |x, y| AppliedImpulse { link: 0, offset: [0.0, y, 0.0], vector: Vector::new(x, 0.0) };
    assert_eq!(at(&|state| state.scene.impulses = vec![impulse(1.0, f64::NAN)]), "impulse[0].offset[1]");
    assert_eq!(at(&|state| state.scene.impulses = vec![impulse(f64::NAN, 0.0)]), "impulse[0].vector[0]");
    let spring = |b, damping| {
        let laws = [SpringLaw { damping, ..SpringLaw::default() }; 3];
        move |state: &mut State| state.scene.springs = vec![VirtualSpring { a: sound, b, laws }]
    };
    assert_eq!(at(&spring(SpringEnd::Link(broken), 0.0)), "virtual[0].b.offset[1]");
    assert_eq!(at(&spring(SpringEnd::World(Vector::new(0.0, f64::NAN)), 0.0)), "virtual[0].b.world[1]");
    assert_eq!(at(&spring(SpringEnd::Link(sound), f64::NAN)), "virtual[0].laws[1]");
}

#[test]
fn placeholders_of_a_stance_may_be_anything() {
    let robot = ramone();
    let impact = |entry: f64| {
        let mut state = State { uncertainty: None, ..falling(&robot) };
        (state.scene.stance, state.scene.place_lowest) = (robot.link("left_foot"), false);
        state.position[..2].fill(entry);
        state.velocity[..2].fill(entry);
        state.set_velocity(&robot, "pitch", -1.0).unwrap();
        let impact = Pipeline::new(&robot, Options::default()).impact(&state).expect("a stance");
        format!("{:?}", (impact.analysis, impact.kinetic_energy, impact.notes))
    };
    assert_eq!(impact(f64::NAN), impact(0.0));
}

#[test]
fn bolted_robots_built_in_code_are_not_placed() {
    let bolted = reduced(
        include_str!("../../urdf/minimalistic.urdf"),
        &Reduction { base: Some(Base::Fixed), ..Reduction::default() },
    );
    let reason = "the robot is bolted to the world";
    let lowest = |state: &mut State| state.scene.stance = None;
    assert_eq!(refused(&bolted, lowest), format!("place: {reason}, it cannot be placed"));
    assert_eq!(
        refused(&bolted, |state| state.scene.stance = Some(0)),
        format!("stance: {reason}, a stance cannot place it")
    );
}

#[test]
fn options_built_in_code_are_checked() {
    let robot = ramone();
    let state = State { uncertainty: None, ..falling(&robot) };
    let of = |options: Options| said(&Pipeline::new(&robot, options).impact(&state).expect_err("refused"));
    for (value, rule) in [(f64::NAN, "a finite number, not NaN"), (-1e-3, "0 or more, not -0.001")] {
        let tolerance = Options { contact_tolerance: Some(value), ..Options::default() };
        assert_eq!(of(tolerance), format!("contact_tolerance: the tolerance must be {rule}"));
        let speed = Options { resting_speed: Some(value), ..Options::default() };
        assert_eq!(of(speed), format!("resting_speed: the speed must be {rule}"));
        let feet = Options { feet: vec![contact(0.0, 0.1), contact(0.0, value)], ..Options::default() };
        assert_eq!(of(feet), format!("feet[1].radius: radius must be {rule}"));
    }
    let feet = |foot| of(Options { feet: vec![foot], ..Options::default() });
    assert_eq!(feet(contact(f64::NAN, 0.1)), "feet[0].offset[2]: a number must be a finite number, not NaN");
    let foreign = NamedContact { link: 99, ..contact(0.0, 0.0) };
    let links = robot.links().len();
    assert_eq!(feet(foreign), format!("feet: no index 99: the robot has {links} links, counted from 0"));
}

#[test]
fn a_description_that_fits_no_robot_is_refused() {
    let refused = |reduction: &Reduction, change: &dyn Fn(&mut Description)| {
        let mut description = Description::from_urdf(include_str!("../../urdf/ramone.urdf")).expect("a description");
        change(&mut description);
        Robot::reduce(&description, reduction).expect_err("no robot").reason().to_string()
    };
    let held = Reduction { hold: vec![(99, 0.0)], ..Reduction::default() };
    assert!(refused(&held, &|_| {}).starts_with("no index 99: the robot has "));
    let of = |change: &dyn Fn(&mut Description)| refused(&Reduction::default(), change);
    assert!(of(&|own| own.joints[0].child = 99).starts_with("no index 99: the robot has "));
    assert!(of(&|own| own.joints[0].parent = own.joints[1].child).contains("is its own ancestor"));
    assert!(of(&|own| own.joints.truncate(1)).contains("are both roots"));
    assert!(of(&|own| own.links.clear()).starts_with("no index "));
    for change in [|own: &mut Description| own.root = 1, |own: &mut Description| own.links[1].joint = None] {
        assert!(of(&change).starts_with("`root` and each link's `joint` are not those"));
    }
}

/// What belongs to another robot is refused, not indexed.
#[test]
fn states_and_answers_of_other_robots_are_refused() {
    let (robot, other) = (ramone(), reduced(include_str!("../../urdf/minimalistic.urdf"), &Reduction::default()));
    let mut state = State { uncertainty: None, ..falling(&robot) };
    state.scene.braked = vec![3];
    state.scene.contacts = Some(vec![contact(0.0, 0.0)]);
    let impact = Pipeline::new(&robot, Options::default()).impact(&state).expect("an impact");
    let report = Report::of_state(&other, &state, &impact, Detail::default()).expect_err("another robot");
    assert_eq!(report.to_string(), "no index 3: the robot has 1 joints, counted from 0");
    assert!(state.to_json(&other).expect_err("another robot").to_string().contains("position"));
    state.scene.friction.links.insert(99, Friction::ZERO);
    assert!(state.to_json(&robot).expect_err("no such link").to_string().contains("no index 99"));
}

/// Read where states have loops by default, a written state without loops still has none.
#[test]
fn a_written_state_without_loops_has_none_anywhere() {
    let robot = ramone();
    let state = State { uncertainty: None, ..falling(&robot) };
    let end = LinkPoint { link: 0, offset: [0.0; 3] };
    let closed = Defaults { loops: vec![NamedLoop { a: end, b: end }], ..Defaults::default() };
    let written = state.to_json(&robot).expect("a state of the robot");
    assert_eq!(State::from_json(&written, &robot, &closed).expect("a state"), state);
}

/// All ways of writing a report of forces give the names of forces.
#[test]
fn forces_have_their_own_names_however_they_are_written() {
    let robot = ramone();
    let mut state = State { uncertainty: None, ..falling(&robot) };
    state.velocity.fill(0.0);
    let forces = Pipeline::new(&robot, Options::default()).forces(&state).expect("forces");
    let report = Report::of_state(&robot, &state, &forces, Detail::default()).expect("a report");
    let (mut lines, mut whole) = (Vec::new(), Vec::new());
    heelstrike::write::append_line(&mut lines, &report);
    report.append_json(Detail::default(), &mut whole);
    assert_eq!(String::from_utf8(lines), String::from_utf8(whole.clone()));
    assert_eq!(serde_json::to_value(&report).unwrap(), serde_json::from_slice::<Value>(&whole).unwrap());
    assert!(serde_json::to_string(&report).unwrap().contains(r#""contact_acceleration""#));
}

/// M in the order of q, as a result has it, from the columns of a plan.
#[test]
fn columns_of_a_plan_have_coordinates() {
    let robot = ramone();
    let braked = robot.joint("left_hip").expect("a joint");
    let mut state = State { uncertainty: None, ..falling(&robot) };
    state.scene.braked = vec![braked];
    let mut pipeline = Pipeline::new(&robot, Options { matrices: true, ..Options::default() });
    let expected = pipeline.impact(&state).expect("an impact").matrices.expect("matrices");

    let plan: Plan = Plan::new(&robot, &[braked], &[]);
    let (mut configuration, mut workspace) = (Configuration::default(), Workspace::default());
    configuration.set(&plan, &state.position);
    kinematics(&plan, &configuration, &mut workspace);
    mass_matrix(&plan, &mut workspace);
    let coordinates = plan.coordinates();
    let mut order: Vec<usize> = (0..plan.columns()).collect();
    order.sort_by_key(|&column| coordinates[column]);
    let names: Vec<&str> = robot.coordinates().collect();
    assert_eq!(expected.coordinates, order.iter().map(|&column| names[coordinates[column]]).collect::<Vec<_>>());
    let entry = |i: usize, j: usize| workspace.mass_matrix[i.max(j) * plan.columns() + i.min(j)];
    let found: Vec<Vec<f64>> = order.iter().map(|&i| order.iter().map(|&j| entry(i, j)).collect()).collect();
    assert_eq!(found, expected.mass_matrix);
}
