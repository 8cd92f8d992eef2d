//! `heelstrike impact`: every outcome of one state, or of a few.

use super::diagnostic::note;
use super::options::{ContactOptions, DetailOptions, LoopOptions, SceneOptions, pipeline_options};
use super::output::{Format, OutputOptions};
use super::picture::PlotOptions;
use super::robot::RobotOptions;
use super::stream::{Answers, SUMMED_UP, answer_all};
use super::{Completion, Failure, input};
use heelstrike::draw::{Picture, robot as drawing};
use heelstrike::pipeline::{Impact, Pipeline};
use heelstrike::state::{Defaults, NamedContact, State};
use heelstrike::write::{Detail, Palette, Report, Subject, text};
use heelstrike::{Error, Reason, Result, Robot};
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
    plot: PlotOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.plot.check()?;
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let by_input = if input::is_ndjson(&args.state) { Format::Json } else { Format::Text };
    let format = args.output.chosen().unwrap_or(by_input);
    let mut options = pipeline_options(&args.contacts, feet.clone(), args.detail, &args.robot.reductions);
    if format == Format::Text && !args.detail.brief {
        // The text sums up why the other combinations fail even if it does not list them.
        options.explain_up_to = options.explain_up_to.max(SUMMED_UP);
    }
    let mut impacts = Impacts {
        robot: &robot,
        pipeline: Pipeline::new(&robot, options),
        defaults: Defaults { loops: args.loops.load(&robot)?, ..args.scene.defaults() },
        detail: args.detail.detail(),
        feet,
        plot: args.plot.is_asked(),
        picture: None,
    };
    let inputs = [Some(&args.robot.robot), Some(&args.state), args.loops.loops.as_ref()];
    let inputs: Vec<_> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    args.output.spare(&inputs)?;
    args.plot.claim(&inputs, args.output.output.as_deref())?;
    let answered = answer_all(&mut impacts, &args.state, format, &args.output)?;
    match &impacts.picture {
        Some(picture) => args.plot.draw(picture, "the state has no place in the plane")?,
        None if args.plot.is_asked() => note("no picture is drawn of a state that is refused"),
        None => {}
    }
    Ok(answered)
}

struct Impacts<'r> {
    robot: &'r Robot,
    pipeline: Pipeline<'r>,
    defaults: Defaults,
    detail: Detail,
    /// Added to the robot's own.
    feet: Vec<NamedContact>,
    /// Whether a picture is requested, and the picture.
    plot: bool,
    picture: Option<Picture>,
}

impl Impacts<'_> {
    fn draw(&mut self, state: &State, impact: &Impact) {
        if self.plot {
            self.picture = drawing::picture::impact(self.robot, &self.feet, state, impact);
        }
    }
}

impl Answers for Impacts<'_> {
    const WHAT: &'static str = "state";

    fn check(&self, several: bool) -> std::result::Result<(), Failure> {
        if !(several && self.plot) {
            return Ok(());
        }
        let reason = Reason::Inconsistent("a picture is drawn of one state, and several are given".into());
        Err(Failure::Usage(Error::new(reason).at("--plot").hint("give the states one by one")))
    }

    fn json(&mut self, state: &str, out: &mut Vec<u8>) -> Result<Option<Error>> {
        let state = State::from_json(state, self.robot, &self.defaults)?;
        let impact = self.pipeline.impact(&state)?;
        self.draw(&state, &impact);
        Report::of_state(self.robot, &state, &impact, self.detail)?.append_json(self.detail, out);
        Ok(impact.analysed().err())
    }

    fn text(&mut self, state: &str, palette: &Palette) -> Result<(String, Option<Error>)> {
        let state = State::from_json(state, self.robot, &self.defaults)?;
        let impact = self.pipeline.impact(&state)?;
        self.draw(&state, &impact);
        let report = Report::of_state(self.robot, &state, &impact, self.detail)?;
        let text = text(&report, &Subject::of_state(self.robot, &state, &impact), self.detail, palette);
        Ok((text, impact.analysed().err()))
    }
}
