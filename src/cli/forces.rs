//! `heelstrike forces`: every consistent set of contact forces and accelerations of one state, or of a few.

use super::diagnostic::note_own_friction;
use super::options::{BudgetOptions, ContactOptions, DetailOptions, LoopOptions, SceneOptions, pipeline_options};
use super::output::{Format, OutputOptions, spare};
use super::robot::RobotOptions;
use super::stream::{SUMMED_UP, answer_all, append};
use super::{Completion, input};
use heelstrike::pipeline::Pipeline;
use heelstrike::state::{Defaults, State};
use heelstrike::write::{Report, Subject};
use std::path::PathBuf;

/// Find every consistent set of contact forces and accelerations of a state in sustained contact
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike forces urdf/ramone.urdf examples/ramone_stands.json
  heelstrike forces urdf/block.urdf examples/painleve.json --explain
  heelstrike forces urdf/ramone.urdf - --friction 0.5 --format json < examples/ramone_stands.json")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// The state in sustained contact, or several after each other; "-" reads standard input
    #[arg(value_name = "STATE.json")]
    state: PathBuf,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    loops: LoopOptions,
    #[command(flatten)]
    contacts: ContactOptions,
    #[command(flatten)]
    detail: DetailOptions,
    #[command(flatten)]
    budget: BudgetOptions<false>,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.output.check_ending()?;
    spare(args.output.path(), &[Some(&args.robot.robot), Some(&args.state), args.loops.loops.as_ref()])?;
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let by_input = if input::is_ndjson(&args.state) { Format::Json } else { Format::Text };
    let (format, detail) = (args.output.chosen().unwrap_or(by_input), args.detail.detail());
    let mut options = pipeline_options(&args.contacts, feet, args.detail, &args.robot.reductions, args.budget.budget());
    if format == Format::Text && !detail.brief {
        options.explain_up_to = options.explain_up_to.max(SUMMED_UP);
    }
    let defaults = Defaults {
        loops: args.loops.load(&robot)?,
        place_lowest: args.contacts.place_lowest(&robot)?,
        ..args.scene.defaults()
    };
    let (mut pipeline, mut own_friction) = (Pipeline::new(&robot, options), 0);
    let answered = answer_all("state", &args.state, format, &args.output, Ok(()), |state, palette, out| {
        let state = State::from_json(state, &robot, &defaults)?;
        own_friction += u64::from(defaults.friction.is_some() && state.scene.friction.default != defaults.friction);
        let forces = pipeline.forces(&state)?;
        let report = Report::of_forces(&robot, &state, &forces, detail)?;
        append(&report, &Subject::of_forces(&robot, &state, &forces), detail, palette, out);
        Ok(forces.answer.analyzed().err())
    })?;
    note_own_friction(own_friction, "state");
    Ok(answered)
}
