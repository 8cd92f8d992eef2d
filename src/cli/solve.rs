//! `heelstrike solve`: every outcome of a contact problem given as matrices.

use super::diagnostic::note_all;
use super::options::{BudgetOptions, DetailOptions, FrictionOption, ReductionOptions};
use super::output::{Format, OutputOptions, spare};
use super::stream::{SUMMED_UP, answer_all, append};
use super::{Completion, input};
use crate::budget::within;
use crate::impact::{AnalysisOptions, Scratch};
use crate::read::Problem;
use crate::write::{Report, Subject, notes};
use std::path::PathBuf;

/// Find every outcome of a contact problem given as matrices, without a robot
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike solve examples/problems/rod.json
  echo '{\"delassus\": [[2, 1], [1, 2]], \"velocity_before\": [[0.5, -1]], \"friction\": 0.5}' | heelstrike solve -")]
pub struct Args {
    /// The problem, or several after each other or in a list; "-" reads standard input
    #[arg(value_name = "PROBLEM.json")]
    problem: PathBuf,
    #[command(flatten)]
    friction: FrictionOption,
    #[command(flatten)]
    reductions: ReductionOptions,
    #[command(flatten)]
    detail: DetailOptions,
    #[command(flatten)]
    budget: BudgetOptions<false>,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    args.output.check_ending()?;
    spare(args.output.path(), &[Some(&args.problem)])?;
    let to_a_file_or_lines = args.output.path().is_some() || input::is_ndjson(&args.problem);
    let otherwise = if to_a_file_or_lines { Format::Json } else { Format::Text };
    let format = args.output.chosen().unwrap_or(otherwise);
    let (defaults, detail, mut scratch) = (args.friction.defaults(), args.detail.detail(), Scratch::default());
    let mut own_friction = 0;
    let answered = answer_all("problem", &args.problem, format, &args.output, Ok(()), |problem, palette, out| {
        let problem = Problem::from_json(problem, &defaults)?;
        let unlike = |given| problem.contact.friction().any(|friction| friction != given);
        own_friction += u64::from(defaults.friction.is_some_and(unlike));
        let summed_up = palette.is_some() && !detail.brief && problem.contact.contacts() <= SUMMED_UP;
        let options = AnalysisOptions {
            rejections: (detail.explain || summed_up).into(),
            prove: !args.detail.no_proof,
            reductions: args.reductions.reductions(),
            ..AnalysisOptions::default()
        };
        let analysis = within(args.budget.budget(), || scratch.analyze(&problem.contact, &problem, options))?;
        let report = Report::of_problem(&problem, &analysis, detail);
        append(&report, &Subject::of_problem(&problem, &analysis), detail, palette, out);
        Ok(None)
    })?;
    note_all(notes::own_friction(own_friction, "problem"));
    Ok(answered)
}
