//! `heelstrike batch`: one result line per state, in order.

use super::complaint::complain;
use super::options::{ContactOptions, DetailOptions, SceneOptions, pipeline_options};
use super::output::Output;
use super::robot::RobotOptions;
use super::{Answered, Outcome, input};
use heelstrike::batch::{Answer, Batch};
use std::io::{BufRead, Write};
use std::path::PathBuf;

/// Find every outcome of many states: one line of JSON in, one out, in order
///
/// A refused state is answered by an object with its `error` in its place, and the rest goes on; blank lines are skipped.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  heelstrike batch urdf/ramone.urdf keyframes.ndjson --friction 0.8 -o results.ndjson"
)]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// States, one JSON object per line; "-" reads standard input
    #[arg(value_name = "KEYFRAMES.ndjson")]
    states: PathBuf,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    contacts: ContactOptions,
    #[command(flatten)]
    detail: DetailOptions,
    /// Write to this file, which is replaced
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// The form of the results: JSON, one line each
    #[arg(long, value_name = "FORMAT", value_parser = ["json"], default_value = "json", help_heading = "Output")]
    format: String,
}

pub(super) fn run(args: &Args) -> Outcome {
    let robot = args.robot.load()?;
    let options = pipeline_options(&args.contacts, args.robot.feet(&robot)?, args.detail);
    let mut states = input::open(&args.states)?;
    let mut output = Output::open(args.output.as_deref())?;
    let mut batch = Batch::new(&robot, options, args.scene.defaults(), args.detail.detail());

    let mut answered = Answered::All;
    let (mut line, mut answer) = (Vec::new(), Vec::new());
    for number in 1.. {
        line.clear();
        let length = states.read_until(b'\n', &mut line).map_err(|error| input::cannot_read(&args.states, &error))?;
        if length == 0 {
            break;
        }
        answer.clear();
        if let Answer::Refused(error) = batch.line(number, &line, &mut answer) {
            let column = error.location().map_or(1, |location| location.column);
            complain(&error.on(number, column).in_file(input::name(&args.states)));
            answered = Answered::NotAll;
        }
        output.write_all(&answer)?;
    }
    output.flush()?;
    Ok(answered)
}
