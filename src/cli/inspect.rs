//! `heelstrike inspect`: what was read of a robot.

use super::output::{Format, OutputOptions};
use super::picture::PlotOptions;
use super::robot::RobotOptions;
use super::{Answered, Outcome};
use heelstrike::draw::robot as drawing;
use heelstrike::write::{self, Inspection};
use std::io::Write;

/// Tell what was read: plane, links, joints, masses, feet, what was left out
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike inspect urdf/ramone.urdf
  heelstrike inspect urdf/ramone.urdf --plot ramone.svg")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    #[command(flatten)]
    plot: PlotOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Outcome {
    args.plot.check()?;
    // Its cautions are part of what is told.
    let robot = args.robot.read()?;
    let feet = args.robot.feet(&robot)?;
    let inspection = Inspection::new(&robot, &feet);
    args.output.spare(&[&args.robot.robot])?;
    args.plot.claim(&[&args.robot.robot], args.output.output.as_deref())?;
    if args.plot.is_asked() {
        args.plot.draw(&drawing::picture::robot(&robot, &feet), "the robot has no place in the plane")?;
    }
    let mut output = args.output.open()?;
    match args.output.chosen().unwrap_or(Format::Text) {
        Format::Text => output.write_all(inspection.text(output.palette()).as_bytes())?,
        Format::Json => {
            let mut line = Vec::new();
            write::append_line(&mut line, &inspection);
            output.write_all(&line)?;
        }
    }
    output.flush()?;
    Ok(Answered::All)
}
