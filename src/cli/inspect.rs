//! `heelstrike inspect`: the model of a robot.

use super::Completion;
use super::diagnostic::with_flags;
use super::output::OutputOptions;
use super::picture::PlotOptions;
use super::robot::RobotOptions;
use crate::draw::robot as drawing;
use crate::write::Inspection;

/// Show the model: plane, links, joints, masses, feet, and what was left out
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike inspect urdf/ramone.urdf
  heelstrike inspect urdf/ramone.urdf --plot ramone.svg")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// Show every body, joint and part that was left out, however many
    #[arg(long)]
    all: bool,
    #[command(flatten)]
    plot: PlotOptions<false>,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.output.check_ending()?;
    args.plot.claim(&[Some(&args.robot.robot)], args.output.path())?;
    // Its cautions are part of the output.
    let (_, _, mut robot) = args.robot.described()?;
    robot.reading.cautions.iter_mut().for_each(|caution| *caution = with_flags(caution));
    let feet = args.robot.feet(&robot)?;
    let inspection = Inspection::new(&robot, &feet);
    if args.plot.path().is_some() {
        args.plot.draw(&drawing::picture::robot(&robot, &feet), "the robot has no place in the plane")?;
    }
    args.output.write(&inspection, |palette| with_flags(&inspection.text(palette, args.all)))
}
