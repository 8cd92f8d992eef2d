//! `heelstrike inspect`: the model of a robot.

use super::diagnostic::with_flags;
use super::input::InputFile;
use super::output::OutputOptions;
use super::picture::{MirrorOptions, PlotOptions};
use super::robot::RobotOptions;
use super::stream::only_document;
use super::{Completion, Failure};
use crate::contact::Placement;
use crate::draw::robot::picture;
use crate::state::{Defaults, NamedContact, State};
use crate::write::Inspection;
use crate::{Friction, Options, Pipeline, Robot};
use std::path::{Path, PathBuf};

/// Show the model: plane, links, joints, masses, feet, and what was left out
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike inspect urdf/ramone.urdf
  heelstrike inspect urdf/ramone.urdf --plot ramone.svg
  heelstrike inspect urdf/ramone.urdf --state examples/ramone.json --plot pose.svg")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// Show every body, joint and part that was left out, however many
    #[arg(long)]
    all: bool,
    /// Draw the robot as it is in this state; "-" reads standard input
    #[arg(long, value_name = "STATE.json", requires = "plot")]
    state: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotOptions<false>,
    #[command(flatten)]
    mirror: MirrorOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.output.check_ending()?;
    args.plot.claim(&[Some(&args.robot.robot), args.state.as_ref()], args.output.path())?;
    // The cautions of the robot are part of the output, so they are not noted.
    let (_, _, robot) = args.robot.described()?;
    let feet = args.robot.feet(&robot)?;
    let inspection = Inspection::new(&robot, &feet);
    if args.plot.path().is_some() {
        let picture = match &args.state {
            Some(path) => picture::posed(&robot, &feet, &pose(path, &robot, &feet)?, args.mirror.forward()),
            None => picture::robot(&robot, &feet, args.mirror.forward()),
        };
        args.plot.draw(&picture, "the robot has no place in the plane")?;
    }
    args.output.write(&inspection, |palette| with_flags(&inspection.text(palette, args.all)))
}

fn pose(path: &Path, robot: &Robot, feet: &[NamedContact]) -> Result<Placement, Failure> {
    let input = InputFile::read(path, InputFile::LARGE)?;
    let document = only_document(&input)?;
    // A pose does not depend on friction, which the state may omit.
    let defaults = Defaults { friction: Some(Friction::from(0.0)), ..Defaults::default() };
    let posed = State::from_json(document.text, robot, &defaults).and_then(|state| {
        if state.scene.stance.is_none() && !state.scene.place_lowest {
            return Ok(Placement::of_robot(robot, &state.position));
        }
        let options = Options { feet: feet.to_vec(), ..Options::default() };
        Ok(Pipeline::new(robot, options).answer(&state)?.placement)
    });
    posed.map_err(|error| input.refuse(document.locate(error)))
}
