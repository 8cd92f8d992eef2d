//! Every outcome of one state, with the library: `cargo run --example one_state`.

use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::{Defaults, State};
use heelstrike::{Result, Robot};

fn main() -> Result<()> {
    let robot = Robot::from_urdf(include_str!("../urdf/minimalistic.urdf"))?;
    let state = State::from_json(include_str!("minimalistic.json"), &robot, &Defaults::default())?;

    let mut pipeline = Pipeline::new(&robot, Options::default());
    let impact = pipeline.impact(&state)?;
    let analysis = impact.analyzed()?;

    println!("{:?}", analysis.verdict);
    for outcome in &analysis.outcomes {
        for (contact, mode) in impact.contacts.iter().zip(&outcome.modes) {
            print!("{}: {mode:10}", contact.name);
        }
        println!("energy lost: {:.6} J", outcome.energy_loss);
    }
    Ok(())
}
