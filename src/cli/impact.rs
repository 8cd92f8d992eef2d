//! `heelstrike impact` and `heelstrike forces`: every outcome of one state, or of a few.

use super::diagnostic::{note, note_all};
use super::options::{BudgetOptions, DetailOptions, NextOption, SceneOptions, pipeline_options};
use super::output::{Format, OutputOptions};
use super::picture::{MirrorOptions, PlotOptions};
use super::robot::RobotOptions;
use super::stream::{SUMMED_UP, answer_all, append};
use super::{Completion, Failure, input};
use crate::draw::robot::picture;
use crate::pipeline::{Aspect, Pipeline};
use crate::state::State;
use crate::write::{Report, Subject, notes};
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
    state: StateArgs,
    #[command(flatten)]
    next: NextOption,
}

/// A robot, states of it, and what is asked about them.
#[derive(Debug, clap::Args)]
pub(super) struct StateArgs {
    #[command(flatten)]
    robot: RobotOptions,
    /// The state, or several after each other; "-" reads standard input
    #[arg(value_name = "STATE.json")]
    state: PathBuf,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    detail: DetailOptions,
    #[command(flatten)]
    budget: BudgetOptions<false>,
    #[command(flatten)]
    plot: PlotOptions<false>,
    #[command(flatten)]
    mirror: MirrorOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.state.run(Aspect::Impact, args.next.next)
}

impl StateArgs {
    /// Answers every state; with `next`, also with the forces just after each outcome.
    pub fn run(&self, aspect: Aspect, next: bool) -> Completion {
        self.output.check_ending()?;
        let inputs = [Some(&self.robot.robot), Some(&self.state), self.scene.loops.as_ref()];
        self.plot.claim(&inputs, self.output.path())?;
        let robot = self.robot.load()?;
        let feet = self.robot.feet(&robot)?;
        let by_input = if input::is_ndjson(&self.state) { Format::Json } else { Format::Text };
        let format = self.output.chosen().unwrap_or(by_input);
        let (detail, contacts, budget) = (self.detail.detail(), &self.scene.contacts, self.budget.budget());
        let mut options = pipeline_options(contacts, feet.clone(), self.detail, &self.robot.reductions, budget);
        if format == Format::Text && !detail.brief {
            // The text sums up why the other combinations are rejected, even if it does not list them.
            options.explain_up_to = options.explain_up_to.max(SUMMED_UP);
        }
        (options.aspect, options.next) = (aspect, next);
        let defaults = self.scene.defaults(&robot)?;
        let plotted = self.plot.path().is_some();
        let several = "a picture is drawn of one state, and several are given";
        let several = Failure::usage("--plot", several, "give the states one by one");
        let several = if plotted { Err(several) } else { Ok(()) };
        let (mut pipeline, mut drawn) = (Pipeline::new(&robot, options), None);
        let (mut own_friction, mut own_contacts) = (0, 0);
        let answered = answer_all("state", &self.state, format, &self.output, several, |state, palette, out| {
            let state = State::from_json(state, &robot, &defaults)?;
            own_friction += u64::from(state.scene.has_own_friction(defaults.friction));
            own_contacts += u64::from(state.scene.contacts.is_some() && !feet.is_empty());
            let impact = pipeline.answer(&state)?;
            if plotted {
                drawn = picture::impact(&robot, &feet, &state, &impact, self.mirror.forward());
            }
            let report = Report::of_state(&robot, &state, &impact, detail)?;
            append(&report, &Subject::of_state(&robot, &state, &impact), detail, palette, out);
            Ok(impact.analyzed().err())
        })?;
        note_all(notes::own_friction(own_friction, "state"));
        note_all(notes::own_contacts(own_contacts, "state"));
        match &drawn {
            Some(picture) => self.plot.draw(picture, "the state has no place in the plane")?,
            None if plotted => note("no picture is drawn of a state that is refused"),
            None => {}
        }
        Ok(answered)
    }
}
