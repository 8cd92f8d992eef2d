//! `heelstrike sweep`: outcomes against one or two parameters.

use super::diagnostic::{note_all, report};
use super::input::InputFile;
use super::options::{
    BudgetOptions, Choices, CsvOptions, DetailOptions, SceneOptions, ThreadOptions, choice, pipeline_options,
};
use super::output::{Output, writable};
use super::picture::{MirrorOptions, PlotOptions};
use super::robot::RobotOptions;
use super::stream::nothing;
use super::{Answered, Completion, Failure, format, progress};
use crate::budget::SharedBudget;
use crate::draw::page::{Page, Stops};
use crate::draw::sweep as picture;
use crate::read::table::Form;
use crate::sweep::{Findings, Regime, RobotStudy, Solver, Study, Workers, letter};
use crate::write::sweep::{Regions, SampleRecord, columns};
#[cfg(feature = "columnar")]
use crate::write::{ColumnBlock, ColumnWriter};
use crate::write::{Layout, notes};
use crate::{Error, Reason};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Find all regions of equal outcomes against one or two parameters, and the borders between them
///
/// Numbers in the study's state and robot may be expressions of its parameters and constants, as "alpha + pi/2".
/// Borders are found to 1e-12 of the range, and thin regions between samples are searched for.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike sweep urdf/minimalistic.urdf examples/paper/figure_7.json
  heelstrike sweep urdf/ramone_paper.urdf examples/paper/table_1.json -o ramone.json --plot ramone.svg
  heelstrike sweep urdf/pdw.urdf examples/paper/inertia_map_0.4.json --plot map.html")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// The study: parameters, constants, and a state whose numbers may be expressions; "-" reads standard input
    #[arg(value_name = "STUDY.json")]
    study: PathBuf,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    detail: DetailOptions,
    /// Write to this file, which is replaced
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotOptions<true>,
    #[command(flatten)]
    mirror: MirrorOptions,
    /// Text lists regions, JSON regions and samples, tables samples [default: by the output's ending, else text]
    #[arg(long, value_parser = choice(FORMATS), help_heading = "Output")]
    format: Option<SweepFormat>,
    #[command(flatten)]
    csv: CsvOptions,
    #[command(flatten)]
    budget: BudgetOptions<true>,
    #[command(flatten)]
    threads: ThreadOptions,
}

/// The format of the output: a format of batches, or `None` for text.
type SweepFormat = Option<Form>;

const FORMATS: Choices<SweepFormat> = &[
    ("text", "Regions and borders for people", None),
    ("json|ndjson", "One object: regions, borders, samples", Some(Form::Ndjson)),
    ("csv", "A table of samples, one row per outcome", Some(Form::Csv)),
    ("tsv", "The same with tabs between columns", Some(Form::Tsv)),
    ("parquet", "The same as a Parquet file", Some(Form::Parquet)),
    ("arrow", "The same as an Arrow IPC file", Some(Form::Arrow)),
    ("arrows", "The same as an Arrow IPC stream", Some(Form::Arrows)),
];

/// Returns the format chosen by the option or by the output's ending. Refuses an ending with another meaning.
fn format(args: &Args) -> Result<SweepFormat, Failure> {
    let ending = args.output.as_deref().and_then(Path::extension).and_then(|ending| ending.to_str());
    let by_ending = match ending.map(str::to_ascii_lowercase).as_deref() {
        None | Some("" | "txt") => Some(None),
        Some(_) => args.output.as_deref().and_then(format::records).map(Some),
    };
    let format = args.format.or(by_ending).ok_or_else(|| {
        let reason = "a study is written as .json, .csv, .tsv, .parquet, .arrow or .txt";
        let hint = "name a file with one of these endings, or say --format; pictures and pages go to --plot";
        Failure::usage("--output", reason, hint)
    })?;
    format::form((args.output.as_deref(), true), format.or(Some(Form::Ndjson)), "--format")?;
    Ok(format)
}

/// The number of samples that are answered before they are written.
const TOGETHER: usize = 4096;

pub(super) fn run(args: &Args) -> Completion {
    let inputs = [Some(&args.robot.robot), Some(&args.study), args.scene.loops.as_ref()];
    args.plot.claim(&inputs, args.output.as_deref())?;
    writable(args.output.as_deref())?;
    let format = format(args)?;
    args.csv.check(matches!(format, Some(Form::Csv | Form::Tsv)))?;
    match format {
        Some(Form::Ndjson) => {}
        Some(_) => args.detail.check_table("--format")?,
        None => args.detail.check_regions(args.plot.path().is_some())?,
    }
    let (description, reduction, robot) = args.robot.described()?;
    note_all(robot.reading.cautions.clone());
    let feet = args.robot.feet(&robot)?;
    let input = InputFile::read(&args.study, InputFile::LARGE)?;
    let refuse = |error: Error| input.refuse(error);
    let read = |text| if str::trim(text).is_empty() { Err(nothing("study", text)) } else { Study::from_json(text) };
    let study = input.text().and_then(read).map_err(refuse)?;
    Findings::check_memory(&study).map_err(refuse)?;
    let model = RobotStudy {
        study: &study,
        description: &description,
        reduction: &reduction,
        robot: &robot,
        options: pipeline_options(&args.scene.contacts, feet, args.detail, &args.robot.reductions, None),
        defaults: args.scene.defaults(&robot)?,
    };
    note_all(notes::own_friction(model.has_own_friction().map_err(refuse)?.into(), "study"));
    note_all(notes::own_contacts(model.has_own_contacts().map_err(refuse)?.into(), "study"));
    note_all(notes::unused(&study));
    let progress = progress::of(Findings::work(&model) + SampleRecord::count(&model));
    let done = || progress.inc(1);
    let workers = Workers { threads: args.threads.count(), done: &done };
    let budget = StudyBudget { shared: args.budget.shared(), study: &study, input: &input };
    let findings = budget.within(|| Findings::of(&model, workers))?;
    let regions = Regions::new(&study, &findings);
    let regimes = findings.regimes();
    if args.plot.path().is_some() {
        progress.inc_length(picture::work(&model, &findings) as u64);
        let picture = budget.within(|| picture::of(&model, &findings, args.mirror.forward(), workers))?;
        let stops = Stops::new(&model, &findings);
        progress.inc_length(if args.plot.is_page() { stops.count() as u64 } else { 0 });
        let page = |rendered| {
            budget.within(|| Page::of_study(&model, &findings, &stops, rendered, args.mirror.forward(), workers))
        };
        args.plot.draw_or_page(&picture, "no region was found", page)?;
    }
    let mut output = Output::open(args.output.as_deref())?;
    let (writer, work) = (&mut output.writer, (workers, &budget));
    let refused = match format {
        None => {
            writer.write_all(regions.text(&robot.name, &output.palette).as_bytes())?;
            samples(&model, work, || (), |solver, sample, ()| sample.is_answered(solver), |()| Ok(()))?
        }
        Some(Form::Ndjson) => {
            let mut head = Vec::new();
            regions.append_head(&mut head);
            writer.write_all(&head)?;
            let append = |solver: &mut Solver, sample: &SampleRecord, out: &mut Vec<u8>| {
                out.extend(if sample.index == 0 { "" } else { "," }.bytes());
                sample.append_json(solver, args.detail.detail(), out)
            };
            let refused = samples(&model, work, Vec::new, append, |out| Ok(writer.write_all(&out)?))?;
            writer.write_all(b"]}\n")?;
            refused
        }
        Some(form) => {
            let (brief, guarded) = (args.detail.brief, args.csv.csv_safe);
            table(&model, work, &regimes, Layout { brief, guarded, form, ..Layout::default() }, writer)?
        }
    };
    output.close(true)?;
    progress.finish_and_clear();
    let refusals: Vec<&Error> = regimes.iter().filter_map(|(_, _, refused)| *refused).collect();
    refusals.iter().for_each(|&error| report(&error.clone().in_file(&input.name)));
    if refused > 0 && refusals.is_empty() {
        // The refused samples are on a line or at a point of the parameters, which is not a region.
        let reason = Reason::Inconsistent(format!("{refused} of {} samples are refused", SampleRecord::count(&model)));
        let hint = match format {
            None => "`format: json` lists the samples with the error of each",
            Some(_) => "the `error` of each is in the output",
        };
        report(&Error::new(reason).in_file(&input.name).hint(hint));
    }
    Ok(if refused == 0 && refusals.is_empty() { Answered::All } else { Answered::NotAll })
}

/// Writes all samples as a table and returns the number of refused ones.
fn table(
    model: &RobotStudy,
    work: (Workers, &StudyBudget),
    regimes: &[(&Arc<Regime>, usize, Option<&Error>)],
    layout: Layout,
    writer: &mut impl Write,
) -> Result<usize, Failure> {
    let contacts = regimes.iter().flat_map(|(regime, ..)| regime.contacts()).map(String::as_str);
    let columns = columns(model, &model.options.feet, contacts, layout);
    let kind = |regime: &Regime| regimes.iter().find(|(known, ..)| ***known == *regime);
    let letter = |regime: &Regime| kind(regime).map_or_else(String::new, |(_, kind, _)| letter(*kind));
    #[cfg(feature = "columnar")]
    if !layout.form.is_text() {
        let mut typed = ColumnWriter::new(&columns, layout.form)?;
        let append = |solver: &mut Solver, sample: &SampleRecord, out: &mut ColumnBlock| {
            sample.append_rows(solver, &columns, letter, out)
        };
        let write = |out| Ok(writer.write_all(&typed.write(out)?)?);
        let refused = samples(model, work, || ColumnBlock::new(&columns, 1), append, write)?;
        writer.write_all(&typed.finish()?)?;
        return Ok(refused);
    }
    let mut head = Vec::new();
    columns.append_header(&mut head);
    writer.write_all(&head)?;
    let append = |solver: &mut Solver, sample: &SampleRecord, out: &mut Vec<u8>| {
        sample.append_rows(solver, &columns, letter, out)
    };
    samples(model, work, Vec::new, append, |out| Ok(writer.write_all(&out)?))
}

/// The budget for all work on a study.
struct StudyBudget<'a> {
    shared: SharedBudget,
    study: &'a Study<'a>,
    input: &'a InputFile,
}

impl StudyBudget<'_> {
    /// Returns the result of `work`; refuses the study if the budget ends first.
    fn within<R>(&self, work: impl FnOnce() -> R) -> Result<R, Failure> {
        self.shared.within(work).map_err(|spent| self.input.refuse(self.study.beyond(spent)))
    }
}

/// Writes all samples in order and returns the number of refused ones. Each sample is appended to a value of `new`.
fn samples<T: Send>(
    model: &RobotStudy,
    (workers, budget): (Workers, &StudyBudget),
    new: impl Fn() -> T + Sync,
    append: impl Fn(&mut Solver, &SampleRecord, &mut T) -> bool + Sync,
    mut write: impl FnMut(T) -> Result<(), Failure>,
) -> Result<usize, Failure> {
    let (count, mut refused) = (SampleRecord::count(model), 0);
    for start in (0..count).step_by(TOGETHER) {
        let answer = |solver: &mut Solver, index: usize| {
            let mut out = new();
            let answered = append(solver, &SampleRecord::new(model, start + index), &mut out);
            (out, answered)
        };
        let answers = || workers.map(TOGETHER.min(count - start), || Solver::new(model), answer);
        for (out, answered) in budget.within(answers)? {
            write(out)?;
            refused += usize::from(!answered);
        }
    }
    Ok(refused)
}
