//! `heelstrike impact`: every outcome of one state, or of a few.

use super::options::{ContactOptions, DetailOptions, LoopOptions, SceneOptions, pipeline_options};
use super::output::{Format, OutputOptions};
use super::robot::RobotOptions;
use super::stream::{Answers, SUMMED_UP, answer_all};
use super::{Outcome, input};
use heelstrike::pipeline::Pipeline;
use heelstrike::report::{Detail, Palette, Report, Subject, text};
use heelstrike::state::{Defaults, State};
use heelstrike::{Error, Result, Robot};
use std::path::PathBuf;

/// Find every outcome of one state
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike impact urdf/ramone.urdf examples/ramone.json
  heelstrike impact urdf/ramone.urdf examples/ramone.json --explain
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
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Outcome {
    let robot = args.robot.load()?;
    let by_input = if input::is_ndjson(&args.state) { Format::Json } else { Format::Text };
    let format = args.output.chosen().unwrap_or(by_input);
    let mut options = pipeline_options(&args.contacts, args.robot.feet(&robot)?, args.detail, &args.robot.reductions);
    if format == Format::Text && !args.detail.brief {
        // What is wrong with the other combinations is summed up for people also where they are not listed.
        options.explain_up_to = options.explain_up_to.max(SUMMED_UP);
    }
    let mut impacts = Impacts {
        robot: &robot,
        pipeline: Pipeline::new(&robot, options),
        defaults: Defaults { loops: args.loops.load(&robot)?, ..args.scene.defaults() },
        detail: args.detail.detail(),
    };
    let inputs = [Some(&args.robot.robot), Some(&args.state), args.loops.loops.as_ref()];
    args.output.spare(&inputs.into_iter().flatten().map(PathBuf::as_path).collect::<Vec<_>>())?;
    answer_all(&mut impacts, &args.state, format, &args.output)
}

struct Impacts<'r> {
    robot: &'r Robot,
    pipeline: Pipeline<'r>,
    defaults: Defaults,
    detail: Detail,
}

impl Answers for Impacts<'_> {
    const WHAT: &'static str = "state";

    fn json(&mut self, state: &str, out: &mut Vec<u8>) -> Result<Option<Error>> {
        let state = State::from_json(state, self.robot, &self.defaults)?;
        let impact = self.pipeline.impact(&state)?;
        Report::of_state(self.robot, &state, &impact, self.detail)?.append_json(self.detail, out);
        Ok(impact.analysis.err())
    }

    fn text(&mut self, state: &str, palette: &Palette) -> Result<(String, Option<Error>)> {
        let state = State::from_json(state, self.robot, &self.defaults)?;
        let impact = self.pipeline.impact(&state)?;
        let report = Report::of_state(self.robot, &state, &impact, self.detail)?;
        let text = text(&report, &Subject::of_state(self.robot, &state, &impact), self.detail, palette);
        Ok((text, impact.analysis.err()))
    }
}
