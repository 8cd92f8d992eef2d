//! `heelstrike inspect`: what was read of a robot.

use super::output::{Format, OutputOptions};
use super::robot::RobotOptions;
use super::{Answered, Outcome};
use heelstrike::report::{self, Inspection};
use std::io::Write;

/// Tell what was read: plane, links, joints, masses, feet, what was left out
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  heelstrike inspect urdf/ramone.urdf")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Outcome {
    // Its cautions are part of what is told.
    let robot = args.robot.read()?;
    let inspection = Inspection::new(&robot, &args.robot.feet(&robot)?);
    args.output.spare(&[&args.robot.robot])?;
    let mut output = args.output.open()?;
    match args.output.chosen().unwrap_or(Format::Text) {
        Format::Text => output.write_all(inspection.text(output.palette()).as_bytes())?,
        Format::Json => {
            let mut line = Vec::new();
            report::append_line(&mut line, &inspection);
            output.write_all(&line)?;
        }
    }
    output.flush()?;
    Ok(Answered::All)
}
