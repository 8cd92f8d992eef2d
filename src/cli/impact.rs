//! `heelstrike impact`: every outcome of one state, or of a few.

use super::diagnostic::{note, note_own_friction};
use super::options::{BudgetOptions, ContactOptions, DetailOptions, LoopOptions, SceneOptions, pipeline_options};
use super::output::{Format, OutputOptions};
use super::picture::PlotOptions;
use super::robot::RobotOptions;
use super::stream::{SUMMED_UP, answer_all, append};
use super::{Completion, Failure, input};
use heelstrike::draw::robot::picture;
use heelstrike::pipeline::Pipeline;
use heelstrike::state::{Defaults, State};
use heelstrike::write::{Report, Subject};
use heelstrike::{Error, Reason};
use std::path::PathBuf;

/// Find every outcome of one state
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike impact urdf/ramone.urdf examples/ramone.json
  heelstrike impact urdf/ramone.urdf examples/ramone.json --explain
  heelstrike impact urdf/minimalistic.urdf examples/minimalistic.json --plot outcomes.svg
  heelstrike impact urdf/block.urdf - --friction 0.5 --format json < examples/block.json")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// The state just before the impact, or several after each other; "-" reads standard input
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
    plot: PlotOptions<false>,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.output.check_ending()?;
    let inputs = [Some(&args.robot.robot), Some(&args.state), args.loops.loops.as_ref()];
    args.plot.claim(&inputs, args.output.path())?;
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let by_input = if input::is_ndjson(&args.state) { Format::Json } else { Format::Text };
    let format = args.output.chosen().unwrap_or(by_input);
    let detail = args.detail.detail();
    let mut options =
        pipeline_options(&args.contacts, feet.clone(), args.detail, &args.robot.reductions, args.budget.budget());
    if format == Format::Text && !detail.brief {
        // The text sums up why the other combinations fail even if it does not list them.
        options.explain_up_to = options.explain_up_to.max(SUMMED_UP);
    }
    let defaults = Defaults {
        loops: args.loops.load(&robot)?,
        place_lowest: args.contacts.place_lowest(&robot)?,
        ..args.scene.defaults()
    };
    let plotted = args.plot.path().is_some();
    let several = Reason::Inconsistent("a picture is drawn of one state, and several are given".into());
    let several = Failure::Usage(Error::new(several).at("--plot").hint("give the states one by one"));
    let several = if plotted { Err(several) } else { Ok(()) };
    let (mut pipeline, mut drawn, mut own_friction) = (Pipeline::new(&robot, options), None, 0);
    let answered = answer_all("state", &args.state, format, &args.output, several, |state, palette, out| {
        let state = State::from_json(state, &robot, &defaults)?;
        own_friction += u64::from(defaults.friction.is_some() && state.scene.friction.default != defaults.friction);
        let impact = pipeline.impact(&state)?;
        if plotted {
            drawn = picture::impact(&robot, &feet, &state, &impact);
        }
        let report = Report::of_state(&robot, &state, &impact, detail)?;
        append(&report, &Subject::of_state(&robot, &state, &impact), detail, palette, out);
        Ok(impact.analyzed().err())
    })?;
    note_own_friction(own_friction, "state");
    match &drawn {
        Some(picture) => args.plot.draw(picture, "the state has no place in the plane")?,
        None if plotted => note("no picture is drawn of a state that is refused"),
        None => {}
    }
    Ok(answered)
}
