//! `heelstrike accuracy`: error against run time, of a state or of a suite of stiff and extreme cases.

use super::diagnostic::note;
use super::input::InputFile;
use super::options::{BudgetOptions, ContactOptions, FrictionOption};
use super::output::OutputOptions;
use super::picture::PlotOptions;
use super::progress::Stopwatch;
use super::robot::RobotOptions;
use super::stream::only_document;
use super::{Completion, Failure, input};
use crate::accuracy::compliant::compare;
use crate::accuracy::{Case, CaseStudy, CaseSubject, Sampling, cases, of_state, study};
use crate::pipeline::Options;
use crate::state::{Defaults, State};
use crate::write::{Accuracy, Compliant, titled};
use crate::{Reason, Robot};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Options that apply only to a state: the cases of the suite have settings of their own.
const OF_A_STATE: [&str; 6] = ["friction", "contact_tolerance", "strict_limits", "place", "resting_speed", "budget"];

/// Show error against run time, for a robot's state or for a suite of stiff and extreme cases
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike accuracy
  heelstrike accuracy --case chain --plot chains.svg
  heelstrike accuracy urdf/ramone.urdf examples/ramone.json --plot ramone.png")]
#[command(mut_args(|arg| match OF_A_STATE.contains(&arg.get_id().as_str()) {
    true => arg.requires("robot").conflicts_with_all(["case", "list"]),
    false => arg,
}))]
pub struct Args {
    /// The robot's URDF file [default: the suite]
    #[arg(value_name = "ROBOT.urdf", requires = "state", conflicts_with = "case")]
    robot: Option<PathBuf>,
    /// The state just before the impact; "-" reads standard input
    #[arg(value_name = "STATE.json")]
    state: Option<PathBuf>,
    /// Run only the cases of the suite whose name contains this text
    #[arg(long, value_name = "TEXT")]
    case: Option<String>,
    /// List the names of the suite's cases, and run none
    #[arg(long, conflicts_with_all = ["robot", "case", "plot", "time", "no_proof"])]
    list: bool,
    /// How long each method is timed, in milliseconds
    #[arg(long, value_name = "MILLISECONDS", default_value_t = 20)]
    time: u64,
    /// Leave out the proofs and their cost
    #[arg(long)]
    no_proof: bool,
    #[command(flatten)]
    friction: FrictionOption,
    #[command(flatten)]
    contacts: ContactOptions,
    #[command(flatten)]
    budget: BudgetOptions<false>,
    #[command(flatten)]
    plot: PlotOptions<false>,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.output.check_ending()?;
    if args.list {
        let names: Vec<String> = cases()?.into_iter().map(|case| case.name).collect();
        return args.output.write(&names, |_| names.iter().flat_map(|name| [name, "\n"]).collect());
    }
    let sampling = Sampling { time: Duration::from_millis(args.time), ..Sampling::default() };
    args.plot.claim(&[args.robot.as_ref(), args.state.as_ref()], args.output.path())?;
    let clock = Stopwatch::start();
    let accuracy = match (&args.robot, &args.state) {
        (Some(robot), Some(state)) => one_state(args, robot, state, sampling)?,
        _ => suite(args.case.as_deref().unwrap_or_default(), args.no_proof, sampling)?,
    };
    drop(clock);
    args.plot.draw(&accuracy.picture(), "no method has both a time and an error here")?;
    let written = args.output.write(&accuracy, |palette| accuracy.text(palette))?;
    // Refused cases of the suite are intended; a refused state of the user is an error.
    match accuracy.studies.as_slice() {
        [CaseStudy { refused: Some(error), .. }] if args.robot.is_some() => {
            let state = args.state.as_deref().map_or_else(String::new, input::name);
            Err(error.clone().in_file(state).into())
        }
        _ => Ok(written),
    }
}

fn one_state(args: &Args, robot: &Path, state: &Path, sampling: Sampling) -> Result<Accuracy, Failure> {
    let robot = RobotOptions { robot: robot.to_owned(), ..RobotOptions::default() }.load()?;
    let input = InputFile::read(state, InputFile::LARGE)?;
    let document = only_document(&input)?;
    let defaults = Defaults { place_lowest: args.contacts.place_lowest(&robot)?, ..args.friction.defaults() };
    let state = State::from_json(document.text, &robot, &defaults);
    let state = state.map_err(|error| input.refuse(document.locate(error)))?;
    let options = Options {
        contact_tolerance: args.contacts.contact_tolerance,
        resting_speed: args.contacts.resting_speed,
        strict_limits: args.contacts.strict_limits,
        no_proof: args.no_proof,
        budget: args.budget.budget(),
        ..Options::default()
    };
    let called = titled(&robot.name, &state.id);
    let study = of_state(&called, &robot, &state, &options, sampling);
    let compliant = match study.refused {
        Some(_) => None,
        None => compliant(&called, &robot, &state, &options)?,
    };
    Ok(Accuracy::new(vec![study], compliant))
}

/// The case whose compliant contact is shown with the suite.
const WALKER: &str = "friction infinite, biped";

fn suite(part: &str, no_proof: bool, sampling: Sampling) -> Result<Accuracy, Failure> {
    let chosen: Vec<Case> = cases()?.into_iter().filter(|case| case.name.contains(part)).collect();
    if chosen.is_empty() {
        let hint = "`heelstrike accuracy --list` shows the names of all cases";
        return Err(Failure::usage("--case", format!("no case has \"{part}\" in its name"), hint));
    }
    let options = Options { no_proof, ..Options::default() };
    let studies = chosen.iter().map(|case| study(&case.name, &case.subject, &options, sampling)).collect();
    let walker = chosen.iter().find(|case| case.name == WALKER);
    let compliant = match walker.map(|case| &case.subject) {
        Some(CaseSubject::State(case)) => compliant(WALKER, &case.0, &case.1, &options)?,
        _ => None,
    };
    Ok(Accuracy::new(studies, compliant))
}

/// Compares compliant contact with the outcomes of a state; `None` if there is nothing to compare.
fn compliant(name: &str, robot: &Robot, state: &State, options: &Options) -> Result<Option<Compliant>, Failure> {
    let why = match compare(robot, state, options) {
        Err(error) if *error.reason() == Reason::BeyondBudget => {
            "the budget of work ended before all of its runs (`budget`)".to_owned()
        }
        // The integrator gave up. The errors and times of the state are still valid.
        Err(error) if matches!(error.reason(), Reason::Unsupported(_)) => error.to_string(),
        comparison => return Ok(comparison?.map(|comparison| Compliant { name: name.to_owned(), comparison })),
    };
    note(&format!("compliant contact is left out: {why}"));
    Ok(None)
}
