//! A loop over a pose: how the outcomes of a touchdown change with the angle between the legs.
//!
//! `cargo run --example sweep_pose`

use heelstrike::impact::Friction;
use heelstrike::pipeline::{Options, Pipeline};
use heelstrike::state::{ByLink, Scene, State};
use heelstrike::{Result, Robot};

fn main() -> Result<()> {
    let robot = Robot::from_urdf(include_str!("../urdf/minimalistic.urdf"))?;
    let scene =
        Scene { stance: robot.link("left_leg"), friction: ByLink::everywhere(Friction::Infinite), ..Scene::default() };
    let mut pipeline = Pipeline::new(&robot, Options::default());

    let mut before = String::new();
    for step in 1..=150 {
        let alpha = 0.01 * f64::from(step);
        // q = [x, z, pitch, hip]; the stance places x and z, and both legs turn about the left foot.
        let state = State {
            position: vec![0.0, 0.0, -alpha, -2.0 * alpha],
            velocity: vec![0.0, 0.0, -1.0, 0.0],
            scene: scene.clone(),
            ..State::default()
        };
        let outcomes = pipeline.impact(&state)?.into_analysis()?.outcomes;
        let modes = |modes: &[_]| format!("{modes:?}");
        let now = outcomes.iter().map(|outcome| modes(&outcome.modes)).collect::<Vec<_>>().join(" or ");
        if now != before {
            println!("from alpha = {alpha:.2}: {now}");
            before = now;
        }
    }
    Ok(())
}
