//! The Rust library on the states that `figures.py` gives to Python and to tables: the other side of its ratios.
//!
//! `library ROBOT.urdf STATES FRICTION` reads rows of q and v as f64 from the file STATES. For each line of standard
//! input, `arrays` or `brief`, it answers all rows on one thread, with the lowest foot on the ground, and prints the
//! number of outcomes.

use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::State;
use heelstrike::write::{Arrays, Columns, Layout};
use heelstrike::{Friction, Robot};
use std::error::Error;
use std::io::stdin;

fn main() -> Result<(), Box<dyn Error>> {
    let [urdf, states, friction] = [1, 2, 3].map(|at| std::env::args().nth(at).unwrap_or_default());
    let robot = Robot::from_urdf(&std::fs::read_to_string(urdf)?)?;
    let bytes = std::fs::read(states)?;
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|&number| f64::from_le_bytes(number)).collect();
    let columns = Columns::without_lines(&robot, &[], &[], &[], Layout::default());
    let mut state = State::zero(&robot);
    state.scene.place_lowest = true;
    state.scene.friction.default = Some(friction.parse::<Friction>()?);
    for line in stdin().lines() {
        let brief = line? == "brief";
        let mut pipeline = Pipeline::new(&robot, Options { brief, ..Options::default() });
        let (mut arrays, mut outcomes) = (Arrays::new(&columns), 0);
        for row in numbers.chunks_exact(2 * robot.dofs()) {
            let (q, v) = row.split_at(robot.dofs());
            state.position.copy_from_slice(q);
            state.velocity.copy_from_slice(v);
            let answer = pipeline.impact(&state);
            if !brief {
                arrays.push(answer.as_deref().map_err(Clone::clone));
            }
            if let Ok(impact) = answer {
                outcomes += impact.analyzed()?.outcomes.len();
                pipeline.recycle(impact);
            }
        }
        println!("{outcomes}");
    }
    Ok(())
}
