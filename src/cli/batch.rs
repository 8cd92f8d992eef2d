//! `heelstrike batch`: the answers to many states, in order.

use super::diagnostic::{is_quiet, note, note_all, with_flags};
use super::options::{
    BudgetOptions, Choices, CsvOptions, DetailOptions, NextOption, SceneOptions, Seconds, ThreadOptions, choice,
    pipeline_options, seconds,
};
use super::origin::{Asked, Origin};
use super::output::{NewFile, apart, spare, writable};
use super::picture::{MirrorOptions, PlotOptions};
use super::recording::RecordingOptions;
use super::resume::BatchOutput;
use super::robot::RobotOptions;
use super::sink::{OutputSink, note_part};
use super::{Answered, Completion, Failure, format, input, progress};
use crate::batch::{self, AHEAD, Batch, Question, States, Summary};
use crate::contact::Feet;
use crate::draw::page::Gait;
use crate::gait::{Dropped, Seen, Thresholds, unwrapped};
use crate::pipeline::{Aspect, Options, beyond_size};
#[cfg(feature = "columnar")]
use crate::read::table::Parts;
use crate::read::table::{Form, Header, Rates};
use crate::state::Defaults;
#[cfg(feature = "columnar")]
use crate::write::ColumnWriter;
use crate::write::{self, Columns, Layout, notes};
use crate::{Error, Reason, Robot};
use indicatif::ProgressBar;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::AtomicBool;

/// The number of rows that are checked for velocities that do not fit positions.
const FIRST_ROWS: usize = 300;

/// Find every outcome of many states: one line of JSON or row of CSV each, answered in order
///
/// A refused state is answered by an `error` in its place, and the others go on; blank lines are skipped. A summary
/// goes to standard error.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  heelstrike batch urdf/ramone.urdf keyframes.ndjson --friction 0.8 -o results.ndjson
  heelstrike batch urdf/ramone.urdf keyframes.csv --friction 0.8 -o results.csv --summary sum.json
  heelstrike batch urdf/ramone.urdf recorded.csv --touchdowns --velocity backward --friction 0.8")]
pub struct Args {
    #[command(flatten)]
    robot: RobotOptions,
    /// States, one JSON object per line or as CSV; "-" reads standard input
    #[arg(value_name = "KEYFRAMES")]
    states: PathBuf,
    /// The format of the input [default: by its ending, else ndjson]
    #[arg(long, value_name = "FORMAT", value_enum)]
    input_format: Option<Form>,
    /// Copy this column of a table to the results although its name resembles that of a coordinate (repeatable)
    #[arg(long, value_name = "NAME")]
    foreign: Vec<String>,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    recording: RecordingOptions,
    /// Answer each state as `forces` does: the contact forces and accelerations in sustained contact
    #[arg(long, conflicts_with = "next")]
    forces: bool,
    #[command(flatten)]
    next: NextOption,
    #[command(flatten)]
    detail: DetailOptions,
    /// Write to this file, which is replaced
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Continue what an interrupted run has written to the output, which has the ending .part until it is whole
    ///
    /// Robot, input and options must be those of that run, as it left them in a file that ends in .run. Without such a
    /// file, or with --summary or --plot, all states are answered again, and the existing answers are only compared.
    /// Without an output to continue, this is an ordinary run.
    #[arg(long, requires = "output", help_heading = "Output")]
    resume: bool,
    /// The format of the results [default: by the output's ending, else ndjson]
    #[arg(long, alias = "format", value_name = "FORMAT", value_enum, help_heading = "Output")]
    output_format: Option<Form>,
    #[command(flatten)]
    csv: CsvOptions,
    /// Also write the summary to this file, as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    summary: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotOptions<true>,
    #[command(flatten)]
    mirror: MirrorOptions,
    /// Whether refused states make the exit status 1
    #[arg(long, value_name = "HOW", value_parser = choice(ON_REFUSED), default_value = "fail", help_heading = "Output")]
    refused: Answered,
    #[command(flatten)]
    budget: BudgetOptions<false>,
    /// How many seconds of processor time all answers beyond their budget may take together, or "infinite"; each may
    /// take a sixth of what is left [default: six times --budget]
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    budget_total: Option<Seconds>,
    #[command(flatten)]
    threads: ThreadOptions,
}

const ON_REFUSED: Choices<Answered> =
    &[("fail", "The exit status is 1", Answered::NotAll), ("ok", "The exit status is 0", Answered::All)];

pub(super) fn run(args: &Args) -> Completion {
    let [input_format, format] = args.formats()?;
    args.check_files()?;
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let name = input::name(&args.states);
    let in_input = |error: Error| error.in_file(&name);
    // The bytes of Parquet and Arrow files are not read in order.
    let progress = match input_format.is_text() {
        true => progress::over(&args.states, args.output.is_some()),
        false => ProgressBar::hidden(),
    };
    let origin = Origin::of(args.output.as_deref(), args.resume);
    let mut states = args.open(input_format, &origin, &progress).map_err(in_input)?;
    let header = args.header(&robot, &mut states, input_format)?;
    // With `--refused ok` an empty input is accepted: a workflow engine may pass an empty part.
    if args.refused == Answered::NotAll && states.is_empty().map_err(in_input)? {
        let hint = if header.is_some() { "the table has a header and no rows" } else { "the input is empty" };
        return Err(in_input(Error::new(Reason::Missing("a state".into()))).hint(hint).into());
    }
    note_all(header.as_ref().and_then(notes::missing));
    let misfit = header.as_ref().and_then(|header| args.misfit(&robot, header, input_format));
    note_all(misfit.into_iter().flatten().flatten());
    // This refuses a robot without feet before any file is replaced.
    let thresholds = args.recording.thresholds(&robot, &feet);
    let thresholds = thresholds.map_err(|error| error.in_file(input::name(&args.robot.robot)))?;
    let aspect = if args.forces { Aspect::Forces } else { Aspect::Impact };
    let layout = Layout {
        aspect,
        touchdowns: args.recording.touchdowns,
        next: args.next.next,
        brief: args.detail.brief,
        guarded: args.csv.csv_safe,
        form: format,
    };
    let columns = (format != Form::Ndjson).then(|| Columns::new(&robot, &feet, header.as_ref(), layout));
    let size = Feet::new(&robot, &feet).size();
    // The summary, if it is shown, and the picture need this.
    let friction_needed = args.summary.is_some() || args.plot.path().is_some() || !is_quiet();
    let (budget, contacts) = (args.budget.budget(), &args.scene.contacts);
    let options = pipeline_options(contacts, feet, args.detail, &args.robot.reductions, budget);
    let question = Question {
        robot: &robot,
        options: Options { aspect, next: args.next.next, friction_needed, ..options },
        defaults: args.scene.defaults(&robot)?,
        detail: args.detail.detail(),
        total: args.budget.of_many(args.budget_total),
        header: header.as_ref(),
        columns: columns.as_ref(),
        keyframes: args.plot.path().is_some(),
    };
    // Results that are not brief contain this note themselves.
    let tolerance = question.options.contact_tolerance.filter(|_| args.detail.brief);
    let lengths = args.recording.lengths().chain([("a contact tolerance", tolerance)]);
    note_all(lengths.filter_map(|(what, length)| beyond_size(what, length?, size)));
    // Checked before the work, which would otherwise be lost.
    writable(args.summary.as_deref())?;
    let mut head = Vec::new();
    if let Some(columns) = columns.as_ref().filter(|_| format.is_text()) {
        columns.append_header(&mut head);
    }
    let mut output = args.begin(&question, (input_format, format), &head, origin)?;
    let ((answered, refused), lines) = (output.kept(), output.lines()?);
    let mut sink = OutputSink::new(output, format.is_text().then_some(lines), &name, &progress);
    sink.gait = Gait::new(args.mirror.forward(), args.recording.touchdowns);
    if lines == 0 {
        sink.write(&head)?;
    }
    #[cfg(feature = "columnar")]
    if let Some(columns) = &columns {
        sink.columns = (!format.is_text()).then(|| ColumnWriter::new(columns, format)).transpose()?;
    }

    let (dropped, seen) = (Mutex::new(Dropped::default()), Mutex::new(Seen::default()));
    let done = args.answer(&question, states, answered, (thresholds, &dropped, &seen), &mut sink);
    done.map_err(in_input).inspect_err(|_| note_part(&sink.output))?;
    #[cfg(feature = "columnar")]
    if let Some(columns) = sink.columns.take() {
        sink.write(&columns.finish()?)?;
    }
    let OutputSink { output, summary: mut counts, gait, .. } = sink;
    let useful = answered > 0 || counts.refused < counts.states || counts.states == 0 || args.refused == Answered::All;
    output.finish(useful)?;
    counts.missing_columns = header.as_ref().map_or(Vec::new(), |header| header.missing().to_vec());
    progress.finish_and_clear();

    if let (Some(header), Ok(dropped)) = (&header, dropped.lock()) {
        note_all(notes::left_out(header, &dropped));
    }
    let seen = seen.into_inner().unwrap_or_default();
    note_all(seen.notes(&robot, thresholds));
    args.report(&question, &counts, answered, (thresholds, &seen))?;
    if args.plot.path().is_some() {
        let page = |rendered| Ok(gait.page(&robot.name, rendered));
        args.plot.draw_or_page(&gait.picture(&robot.name), "no state was answered", page)?;
    }
    Ok(if counts.refused + refused == 0 { Answered::All } else { args.refused })
}

impl Args {
    /// Returns the formats of input and output. Refuses options that these formats do not support.
    fn formats(&self) -> Result<[Form; 2], Failure> {
        let input = format::form((Some(&self.states), false), self.input_format, "--input-format")?;
        let output = format::form((self.output.as_deref(), true), self.output_format, "--output-format")?;
        self.csv.check(matches!(output, Form::Csv | Form::Tsv))?;
        if output != Form::Ndjson {
            self.detail.check_table("--output-format")?;
        }
        if self.resume && !(input.is_text() && output.is_text()) {
            return Err(Failure::usage("", "--resume continues text, and not Parquet or Arrow", "leave it out"));
        }
        if input == Form::Parquet && self.states == Path::new("-") {
            let reason = "Parquet is read from its end, and standard input has none";
            return Err(Failure::usage("", reason, "name the file, or give an Arrow stream: --input-format arrows"));
        }
        Ok([input, output])
    }

    /// Returns notes if velocities in the first rows do not fit the positions; only a regular file can be read twice.
    fn misfit(&self, robot: &Robot, header: &Header, format: Form) -> Option<[Option<String>; 2]> {
        let has_all = header.missing().is_empty() && !header.is_spatial();
        let is_stream = self.states == Path::new("-") || self.states.starts_with("/dev") || !self.states.is_file();
        if self.recording.is_in_order() || !has_all || is_stream {
            return None;
        }
        let mut states = self.open(format, &Origin::of(None, false), &ProgressBar::hidden()).ok()?;
        let header = states.header(robot, Rates::Columns, &self.foreign, true).ok()??;
        let (defaults, pauses) = (Defaults::default(), AtomicBool::new(false));
        let samples = states.samples(&header, robot, &defaults, &pauses).take(FIRST_ROWS);
        Some(Seen::misfit(unwrapped(samples, robot), robot))
    }

    fn open(&self, format: Form, origin: &Origin, progress: &ProgressBar) -> crate::Result<States> {
        if format.is_text() {
            let states = origin.watch(progress.wrap_read(input::stream(&self.states)?));
            return States::of_text(states, format);
        }
        #[cfg(feature = "columnar")]
        return Ok(States::Columns(match self.states == Path::new("-") {
            true => Parts::arrow_stream(io::stdin())?,
            false => Parts::open(input::file(&self.states)?, format)?,
        }));
        #[cfg(not(feature = "columnar"))]
        Err(format::absent())
    }

    /// Refuses outputs that would replace an input or each other.
    fn check_files(&self) -> Result<(), Failure> {
        let output = self.output.as_deref();
        let inputs = [Some(&self.robot.robot), Some(&self.states), self.scene.loops.as_ref()];
        self.plot.claim(&inputs, output)?;
        let Some(summary) = self.summary.as_deref() else { return Ok(()) };
        spare(Some(summary), &inputs)?;
        if summary == Path::new("-") {
            let reason = "standard output holds the results alone, and standard error has the summary for people";
            return Err(Failure::usage("--summary", reason, "name a file"));
        }
        apart([("results", output), ("summary", Some(summary))], "--summary")?;
        apart([("summary", Some(summary)), ("picture", self.plot.path())], "--plot")
    }

    /// Opens the output for answers, which begin with the header `head` of a table.
    fn begin(
        &self,
        question: &Question<'_>,
        (input, format): (Form, Form),
        head: &[u8],
        origin: Origin,
    ) -> io::Result<BatchOutput> {
        // The address of a budget's clock differs in each run. Needed friction is only for summary and picture.
        let options = Options { budget: None, friction_needed: false, ..question.options.clone() };
        let Question { robot, defaults, detail, header, .. } = question;
        // All that the answers depend on, except the input.
        let asked = Asked::new(
            robot,
            &(options, self.budget, self.budget_total, defaults, detail, header, &self.recording, self.csv, format),
        );
        match self.output.as_deref().filter(|path| self.resume && *path != Path::new("-")) {
            // Summaries and pictures need the answers to all states.
            Some(path) => BatchOutput::resume(path, head, self.summary.is_some() || question.keyframes, origin, asked),
            None => {
                let continued = input.is_text() && format.is_text();
                BatchOutput::create(self.output.as_deref(), origin, continued.then_some(asked))
            }
        }
    }

    /// Answers all states except the first `answered`.
    fn answer(
        &self,
        question: &Question<'_>,
        states: States,
        answered: usize,
        (thresholds, dropped, seen): (Thresholds, &Mutex<Dropped>, &Mutex<Seen>),
        sink: &mut OutputSink<'_>,
    ) -> crate::Result<()> {
        let threads = self.threads.count();
        let (robot, defaults) = (question.robot, &question.defaults);
        let sink = |block| sink.block(block);
        let Some(header) = question.header.filter(|_| self.recording.is_in_order()) else {
            return match states {
                States::Text(mut chunks, _) => {
                    chunks.skip(answered)?;
                    let answerer = || {
                        let mut batch = Batch::new(question);
                        move |chunk| batch.records(&chunk)
                    };
                    batch::run(move || chunks.task(), threads, AHEAD, answerer, sink)
                }
                #[cfg(feature = "columnar")]
                States::Columns(mut parts) => {
                    let answerer = || {
                        let mut batch = Batch::new(question);
                        move |part| batch.part(&part)
                    };
                    // Parts are long, so few are read ahead.
                    batch::run(move || parts.part(), threads, 2, answerer, sink)
                }
            };
        };
        let pauses = AtomicBool::new(false);
        let samples = states.samples(header, robot, defaults, &pauses);
        let known = (robot, &question.options.feet[..]);
        let samples = self.recording.chosen(samples, header, known, thresholds, (dropped, seen))?.skip(answered);
        let answerer = || {
            let mut batch = Batch::new(question);
            move |samples| batch.samples(samples)
        };
        batch::run(batch::recorded(samples, &pauses), threads, AHEAD, answerer, sink)
    }

    /// Writes notes about all answers, and the summary.
    fn report(
        &self,
        question: &Question<'_>,
        counts: &Summary,
        answered: usize,
        (thresholds, seen): (Thresholds, &Seen),
    ) -> io::Result<()> {
        note_all(notes::own_friction(counts.own_friction, "state"));
        note_all(notes::own_contacts(counts.own_contacts, "state"));
        note_all(
            question.columns.filter(|_| question.detail.brief).and_then(|_| notes::without_holds(counts.uncertain)),
        );
        note_all(notes::beyond_budget(question.total.as_ref()).map(|note| note + ": see `budget_total`"));
        if answered > 0 {
            note(&format!("{answered} states were answered by an earlier run, and the summary is of the others"));
        }
        // A failure to write to standard error cannot be reported anywhere.
        let _ = match counts.states {
            _ if is_quiet() => Ok(()),
            0 if self.recording.touchdowns => {
                writeln!(io::stderr(), "{}", with_flags(&self.recording.nothing_found(thresholds, seen)))
            }
            0 | 1 if self.summary.is_none() => {
                let odd = counts.odd_states.first.as_ref().map(|odd| &odd.what);
                note_all(odd.or(seen.oddity.as_ref()).cloned());
                note_all(counts.of_touchdowns());
                Ok(())
            }
            _ => write!(io::stderr(), "{}", with_flags(&counts.to_string())),
        };
        let Some(path) = &self.summary else { return Ok(()) };
        let mut line = Vec::new();
        write::append_line(&mut line, counts);
        NewFile::write(path, &line)
    }

    fn header(&self, robot: &Robot, states: &mut States, format: Form) -> Result<Option<Header>, Failure> {
        let in_order = self.recording.is_in_order();
        let header = states.header(robot, self.recording.rates(), &self.foreign, in_order);
        let in_input = |error: Error| error.in_file(input::name(&self.states));
        let header = header.map_err(|refused| Failure::Refused(in_input(refused.error), refused.excerpt))?;
        // Only for JSON: an input in a table format without a header has no states at all.
        if header.is_none() && format == Form::Ndjson && (in_order || !self.foreign.is_empty()) {
            let what = if in_order { "touchdowns and velocities over time need" } else { "--foreign needs" };
            let hint = "nested states have no columns: give a flat object with keys q_..., v_... on each line (`jq -c '.[]'` \
                        takes a list of these apart), or CSV with a header (--input-format csv)";
            return Err(Failure::usage("", format!("{what} a table"), hint));
        }
        let checked = |header: Header| {
            let header = if self.recording.touchdowns { header.with_base()? } else { header };
            if self.forces || self.next.next { header.without_torques(robot) } else { Ok(header) }
        };
        Ok(header.map(checked).transpose().map_err(in_input)?)
    }
}
