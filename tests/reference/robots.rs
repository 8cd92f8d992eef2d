//! Robots of other people's projects against Pinocchio's values (`data/robots`): matrices, energy and contact points
//! for the reference's contacts as named contacts, then the impact of each contact alone. The variant of each reference
//! is the one that the rules of `robot` choose: `default` if the root link floats.

use heelstrike::Mode;
use heelstrike::planar::Vector;
use nalgebra::{DMatrix, DVector};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::support::answers::{answers, named_velocity};
use crate::support::robots::{Contact, ROBOTS, by_name, robot_and_reference};
use crate::support::scaled::{Differences, largest, matrix};

/// Relative to the largest entry.
const TOLERANCE: f64 = 1e-10;

#[derive(Deserialize)]
struct Variant {
    base: Value,
    coordinates: Vec<String>,
    contacts: Vec<Contact>,
    configs: Vec<Config>,
}

/// A configuration with its values; contact rows are x then z.
#[derive(Deserialize)]
#[allow(non_snake_case, reason = "the reference's own names")]
struct Config {
    q: Vec<f64>,
    v: Vec<f64>,
    M: Vec<Vec<f64>>,
    J: Vec<Vec<f64>>,
    G: Vec<Vec<f64>>,
    kinetic_energy: f64,
    contact_points: Vec<[f64; 2]>,
    impacts: Vec<Impact>,
}

/// The impact of one contact alone, without checks of inequalities. `None` if the contact cannot move in both
/// directions.
#[derive(Deserialize)]
struct Impact {
    stick: Option<Struck>,
    normal_only: Option<Struck>,
}

#[derive(Deserialize)]
struct Struck {
    impulse: [f64; 2],
    v_plus: Vec<f64>,
    kinetic_energy_plus: f64,
}

/// A robot of `tests/data/robots`.
struct Robot {
    name: &'static str,
    urdf: String,
    variant: Variant,
}

impl Robot {
    fn read(named: (&'static str, &str)) -> Self {
        let (urdf, variant) = robot_and_reference(named);
        Self { name: named.0, urdf, variant }
    }

    /// The state of a configuration with these contacts.
    fn state(&self, id: &str, config: &Config, contacts: &[Contact], friction: f64) -> Value {
        let named = |values: &[f64]| by_name(&self.variant.coordinates, self.base_dofs(), values);
        json!({
            "id": format!("{}, {id}", self.name),
            "position": named(&config.q),
            "velocity": named(&config.v),
            "friction": friction,
            "contacts": contacts,
        })
    }

    /// The base's coordinates x, z and pitch come first if it floats; a joint may have one of these names.
    fn base_dofs(&self) -> usize {
        if self.variant.base["mode"] == "floating" { 3 } else { 0 }
    }
}

#[test]
fn robots_equal_their_references() {
    let mut differences = Differences::default();
    for named in ROBOTS {
        let robot = Robot::read(named);
        compare_matrices(&robot, &mut differences);
        compare_single_contacts(&robot, &mut differences);
    }
    differences.finish();
}

fn compare_matrices(robot: &Robot, differences: &mut Differences) {
    let Variant { configs, contacts, coordinates, .. } = &robot.variant;
    let state = |(at, config): (usize, &Config)| robot.state(&format!("configuration {at}"), config, contacts, 0.8);
    let states: Vec<Value> = configs.iter().enumerate().map(state).collect();
    let answers = answers(&["impact", &robot.urdf, "-", "--format", "json", "--matrices"], &states);
    for ((config, state), answer) in configs.iter().zip(&states).zip(answers) {
        let place = state["id"].as_str().expect("a name");
        let (before, answer) = (answer.velocity_before(), answer.report);
        differences.same(place, answer.coordinates.as_deref(), Some(coordinates));
        differences.compare_matrix(&format!("{place}: M"), &answer.mass_matrix, &matrix(&config.M), TOLERANCE);
        differences.compare_matrix(&format!("{place}: J"), &answer.contact_jacobian, &matrix(&config.J), TOLERANCE);
        differences.compare_matrix(&format!("{place}: G"), &answer.delassus, &matrix(&config.G), TOLERANCE);
        let energy = answer.kinetic_energy.as_slice();
        let within = TOLERANCE * config.kinetic_energy;
        differences.compare(&format!("{place}: kinetic energy"), energy, &[config.kinetic_energy], within);
        let points = answer.contacts.iter().filter_map(|contact| contact.point);
        let points: Vec<f64> = points.flat_map(Vector::components).collect();
        differences.compare(&format!("{place}: points"), &points, &config.contact_points.concat(), TOLERANCE);
        let should = contact_velocity(&config.J, &config.v);
        differences.compare(&format!("{place}: c before"), &before, &should, TOLERANCE * largest(&should));
    }
}

/// `stick` of the reference is the mode stick, valid or rejected; `normal_only` is a slide without friction: the
/// contact point stays on the ground and L_t = 0.
fn compare_single_contacts(robot: &Robot, differences: &mut Differences) {
    let (mut states, mut expected) = (Vec::new(), Vec::new());
    for (index, config) in robot.variant.configs.iter().enumerate() {
        for (at, (contact, impact)) in robot.variant.contacts.iter().zip(&config.impacts).enumerate() {
            for (mode, friction, should) in
                [(Mode::Stick, 0.8, &impact.stick), (Mode::SlidePlus, 0.0, &impact.normal_only)]
            {
                let Some(should) = should else { continue };
                let id = format!("configuration {index}, contact {at} alone, {mode}");
                states.push(robot.state(&id, config, std::slice::from_ref(contact), friction));
                expected.push((mode, &config.J[2 * at..2 * at + 2], config, should));
            }
        }
    }
    let answers = answers(&["impact", &robot.urdf, "-", "--format", "json", "--explain"], &states);
    for ((state, (mode, rows, config, should)), answer) in states.iter().zip(expected).zip(answers) {
        let place = state["id"].as_str().expect("a name");
        let is = |modes: &[Mode]| modes[0] == mode || (mode.slides() && modes[0].slides());
        let outcome = answer.outcomes.iter().find(|outcome| is(&outcome.modes));
        let rejected = answer.report.rejected.iter().flatten().filter(|rejected| is(&rejected.modes));
        let numbers = outcome.map(|outcome| (&*outcome.impulse, &*outcome.velocity_after)).into_iter();
        let rejected = rejected.filter_map(|own| own.impulse.as_deref().zip(own.velocity_after.as_deref()));
        let mut listed = false;
        for (impulse, velocity) in numbers.chain(rejected) {
            listed = true;
            let within = TOLERANCE * largest(&should.impulse);
            differences.compare(&format!("{place}: L"), &impulse.concat(), &should.impulse, within);
            let before = contact_velocity(rows, &config.v);
            let mut after = contact_velocity(rows, &should.v_plus);
            let within = TOLERANCE * largest(&before).max(largest(&after));
            // Zero by definition; the product above leaves rounding there.
            after[1] = 0.0;
            differences.compare(&format!("{place}: c after"), &velocity.concat(), &after, within);
        }
        if !listed {
            differences.note(place, "neither among the outcomes nor among the rejected with its numbers");
        }
        // The whole robot's velocity and energy are listed only for outcomes.
        let Some(outcome) = outcome else { continue };
        // A robot with only as many coordinates as the contact has directions stops, so the velocity before counts as
        // well.
        let within = TOLERANCE * largest(&should.v_plus).max(largest(&config.v));
        let (names, velocity) = named_velocity(outcome);
        differences.same(place, names, robot.variant.coordinates.iter().map(String::as_str).collect());
        differences.compare(&format!("{place}: v after"), &velocity, &should.v_plus, within);
        let after = answer.report.kinetic_energy.map(|before| before - outcome.energy_loss);
        let within = TOLERANCE * config.kinetic_energy;
        differences.compare(&format!("{place}: energy after"), after.as_slice(), &[should.kinetic_energy_plus], within);
    }
}

/// J v.
fn contact_velocity(jacobian: &[Vec<f64>], velocity: &[f64]) -> Vec<f64> {
    let jacobian: DMatrix<f64> = matrix(jacobian);
    (jacobian * DVector::from_column_slice(velocity)).as_slice().to_vec()
}
