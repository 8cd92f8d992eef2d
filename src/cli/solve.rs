//! `heelstrike solve`: every outcome of a contact problem that is given as matrices.

use super::options::{DetailOptions, ReductionOptions, SceneOptions};
use super::output::{Format, OutputOptions};
use super::stream::{Answers, SUMMED_UP, answer_all};
use super::{Completion, input};
use heelstrike::impact::{Analysis, AnalysisOptions, Scratch};
use heelstrike::read::Problem;
use heelstrike::reductions::Reductions;
use heelstrike::state::Defaults;
use heelstrike::write::{Detail, Palette, Report, Subject, text};
use heelstrike::{Error, Result};
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
    scene: SceneOptions,
    #[command(flatten)]
    reductions: ReductionOptions,
    #[command(flatten)]
    detail: DetailOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub(super) fn run(args: &Args) -> Completion {
    let to_a_file_or_lines = args.output.output.is_some() || input::is_ndjson(&args.problem);
    let otherwise = if to_a_file_or_lines { Format::Json } else { Format::Text };
    let format = args.output.chosen().unwrap_or(otherwise);
    let mut problems = Problems {
        defaults: args.scene.defaults(),
        detail: args.detail.detail(),
        prove: !args.detail.no_proof,
        reductions: args.reductions.reductions(),
        scratch: Scratch::default(),
    };
    args.output.spare(&[&args.problem])?;
    answer_all(&mut problems, &args.problem, format, &args.output)
}

struct Problems {
    defaults: Defaults,
    detail: Detail,
    prove: bool,
    reductions: Reductions,
    scratch: Scratch,
}

impl Problems {
    fn analyse(&mut self, problem: &Problem, explain: bool) -> Result<Analysis> {
        let asked = AnalysisOptions { rejections: explain.into(), prove: self.prove, reductions: self.reductions };
        self.scratch.analyse(&problem.contact, problem, asked)
    }
}

impl Answers for Problems {
    const WHAT: &'static str = "problem";

    fn json(&mut self, problem: &str, out: &mut Vec<u8>) -> Result<Option<Error>> {
        let problem = Problem::from_json(problem, &self.defaults)?;
        let analysis = self.analyse(&problem, self.detail.explain)?;
        Report::of_problem(&problem, &analysis, self.detail).append_json(self.detail, out);
        Ok(None)
    }

    fn text(&mut self, problem: &str, palette: &Palette) -> Result<(String, Option<Error>)> {
        let problem = Problem::from_json(problem, &self.defaults)?;
        let summed_up = !self.detail.brief && problem.contact.contacts() <= SUMMED_UP;
        let analysis = self.analyse(&problem, self.detail.explain || summed_up)?;
        let report = Report::of_problem(&problem, &analysis, self.detail);
        Ok((text(&report, &Subject::of_problem(&problem, &analysis), self.detail, palette), None))
    }
}
