//! `heelstrike batch`: the answers to many states, in order.

use super::diagnostic::{is_quiet, note, note_own_friction, with_flags};
use super::options::{
    BudgetOptions, Choices, ContactOptions, CsvOptions, DetailOptions, LoopOptions, SceneOptions, Seconds,
    ThreadOptions, choice, from_zero, pipeline_options, seconds,
};
use super::origin::{Asked, Origin};
use super::output::{NewFile, apart, check_ending, spare, writable};
use super::picture::PlotOptions;
use super::resume::BatchOutput;
use super::robot::RobotOptions;
use super::sink::{OutputSink, note_part};
use super::{Answered, Completion, Failure, input, progress};
use clap::ValueEnum;
use heelstrike::batch::{self, Batch, Chunks, Question, Recording};
use heelstrike::budget::TotalBudget;
use heelstrike::error::Location;
use heelstrike::error::excerpt::Excerpt;
use heelstrike::gait::{self, At, Difference, Dropped, Heights, Thresholds, Touching};
use heelstrike::pipeline::Options;
use heelstrike::read::table::{Header, Rates};
use heelstrike::state::Defaults;
use heelstrike::write::{self, Columns, RowKind};
use heelstrike::{Error, Reason, Robot};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

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
    /// The format of the input [default: csv if its name ends in .csv, else ndjson]
    #[arg(long, value_name = "FORMAT", value_enum)]
    input_format: Option<RecordFormat>,
    /// Copy this column of a table to the results although its name resembles that of a coordinate [repeatable]
    #[arg(long, value_name = "NAME")]
    foreign: Vec<String>,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    loops: LoopOptions,
    #[command(flatten)]
    contacts: ContactOptions,
    #[command(flatten)]
    recording: RecordingOptions,
    #[command(flatten)]
    detail: DetailOptions,
    /// Write to this file, which is replaced
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,
    /// Continue what an interrupted run has written to the output, which has the ending .part until it is whole
    ///
    /// Robot, input and options must be those of that run, as it left them in a file that ends in .run. Without one, or
    /// with --summary or --plot, all states are answered again, and what is there is only compared. If nothing is there,
    /// this is an ordinary run.
    #[arg(long, requires = "output", help_heading = "Output")]
    resume: bool,
    /// The format of the results [default: csv if the output's name ends in .csv, else ndjson]
    #[arg(long, alias = "format", value_name = "FORMAT", value_enum, help_heading = "Output")]
    output_format: Option<RecordFormat>,
    #[command(flatten)]
    csv: CsvOptions,
    /// Also write the summary to this file, as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    summary: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotOptions<true>,
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

/// Options for rows that follow each other in time.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Recordings")]
struct RecordingOptions {
    /// Answer only touchdowns: the moments at which a foot reaches the ground from above
    ///
    /// A foot touches down if it descends far enough (--drop), faster than 0.05 m/s, and stops low enough
    /// (--ground-height). The moment of contact is when its motion before reaches the level at which it stops, or, if it
    /// slows down, when it is 2 mm above that level. Noise is measured, and lines are laid through it. For robots smaller
    /// than 0.25 m these thresholds shrink in proportion; the size is the greatest distance from the root's origin to a
    /// foot or center of gravity with all joints at zero. The base is then shifted so that the foot is at z = 0.
    #[arg(long, conflicts_with = "place")]
    touchdowns: bool,
    /// Take the heights of a simulation at their word: the ground is z = 0, and a foot touches down when it crosses that
    ///
    /// The moment is where its height is zero as the up to six rows before it go on. For recordings without noise.
    #[arg(long, requires = "touchdowns", conflicts_with = "ground_height")]
    simulated: bool,
    /// Which state of a touchdown is analyzed
    #[arg(long, value_parser = choice(ROWS), default_value = "crossing", requires = "touchdowns")]
    at: At,
    /// Which other feet touch the ground at a touchdown: strike (none), slow:SPEED,HEIGHT or near:HEIGHT
    ///
    /// With slow, the lowest point of every other body, if it is slower than SPEED (m/s) and its height differs from
    /// the striking point's by at most HEIGHT (m): standing feet. With near, every point at such a height, at any
    /// speed.
    #[arg(long, value_name = "WHICH", default_value_t, requires = "touchdowns")]
    touching: Touching,
    /// How far a foot must have descended, in meters [default: 0.012, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, requires = "touchdowns")]
    drop: Option<f64>,
    /// How far above z = 0 a foot may stop, in meters [default: 0.02, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, requires = "touchdowns")]
    ground_height: Option<f64>,
    /// Compute velocities from the positions and the column "time"
    #[arg(long, value_parser = choice(DIFFERENCES), value_name = "HOW")]
    velocity: Option<Difference>,
}

const ROWS: Choices<At> = &[
    ("crossing", "The state at the moment of contact, extrapolated from the rows before the impact", At::Crossing),
    ("row", "The last row before that moment, shifted in z", At::Row),
];

const DIFFERENCES: Choices<Difference> = &[
    ("central", "From the rows before and after", Difference::Central),
    ("backward", "From the row before", Difference::Backward),
];

/// The format of an input or output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RecordFormat {
    /// One JSON object per line
    #[value(alias = "json", alias = "jsonl")]
    Ndjson,
    /// A table with a header
    Csv,
}

const ON_REFUSED: Choices<Answered> =
    &[("fail", "The exit status is 1", Answered::NotAll), ("ok", "The exit status is 0", Answered::All)];

impl RecordFormat {
    fn of(path: &Path) -> Self {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) { Self::Csv } else { Self::Ndjson }
    }
}

pub(super) fn run(args: &Args) -> Completion {
    let (output, summary) = (args.output.as_deref(), args.summary.as_deref());
    if args.output_format.is_none() {
        check_ending(output, &["csv"], "results are written as .ndjson or .csv", "--output-format")?;
    }
    if args.input_format.is_none() {
        check_ending(Some(&args.states), &["csv"], "states are read as .ndjson or .csv", "--input-format")?;
    }
    let inputs = [Some(&args.robot.robot), Some(&args.states), args.loops.loops.as_ref()];
    args.plot.claim(&inputs, output)?;
    if let Some(summary) = summary {
        spare(Some(summary), &inputs)?;
        if summary == Path::new("-") {
            let reason = "standard output holds the results alone, and standard error has the summary for people";
            let error = Error::new(Reason::Inconsistent(reason.to_owned())).at("--summary");
            return Err(Failure::Usage(error.hint("name a file")));
        }
        apart([("results", output), ("summary", Some(summary))], "--summary")?;
        apart([("summary", Some(summary)), ("picture", args.plot.path())], "--plot")?;
    }
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let name = input::name(&args.states);
    let in_input = |error: Error| error.in_file(&name);
    let progress = progress::over(&args.states, args.output.is_some());
    let origin = Origin::of(output, args.resume);
    let states: Box<dyn Read + Send> = Box::new(origin.watch(progress.wrap_read(input::stream(&args.states)?)));
    let mut chunks = match args.input_format.unwrap_or_else(|| RecordFormat::of(&args.states)) {
        RecordFormat::Ndjson => Chunks::of_lines(states),
        RecordFormat::Csv => Chunks::of_table(states),
    };
    chunks.check_format().map_err(in_input)?;
    let header = args.header(&robot, &mut chunks)?;
    if chunks.is_empty().map_err(in_input)? {
        let hint = if header.is_some() { "the table has a header and no rows" } else { "the input is empty" };
        return Err(in_input(Error::new(Reason::Missing("a state".into()))).hint(hint).into());
    }
    if let Some(header) = &header {
        note_missing(header);
    }
    let output_format = args.output_format.unwrap_or_else(|| output.map_or(RecordFormat::Ndjson, RecordFormat::of));
    args.csv.check(output_format == RecordFormat::Csv)?;
    let detail = args.detail.detail();
    if output_format == RecordFormat::Csv && (detail.explain || detail.matrices || detail.brief) {
        let reason = "a table has a row per outcome and no room for --explain, --matrices or --brief".to_owned();
        let hint = "write JSON: --output-format ndjson, or -o with that ending";
        return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).hint(hint)));
    }
    let RecordingOptions { touchdowns, simulated, at, touching, drop: least, ground_height, velocity } = args.recording;
    let usual = Thresholds::of(&robot, &feet);
    let (least, ground) = (least.unwrap_or(usual.drop), ground_height.unwrap_or(usual.ground));
    let thresholds = Thresholds { drop: least, ground, ..usual };
    if touchdowns {
        // Before any file is replaced: does this robot have feet to look for?
        let none = std::iter::empty::<gait::Sampled<()>>();
        let refused = gait::find(none, &robot, &feet, at, touching).err();
        refused.map_or(Ok(()), |error| Err(error.in_file(input::name(&args.robot.robot))))?;
    }
    let kind = if touchdowns { RowKind::Touchdown } else { RowKind::State };
    let columns = || args.csv.columns(Columns::new(&robot, &feet, header.as_ref(), kind));
    let columns = (output_format == RecordFormat::Csv).then(columns);
    let question = Question {
        robot: &robot,
        options: pipeline_options(&args.contacts, feet, args.detail, &args.robot.reductions, args.budget.budget()),
        defaults: Defaults {
            loops: args.loops.load(&robot)?,
            place_lowest: args.contacts.place_lowest(&robot)?,
            ..args.scene.defaults()
        },
        detail,
        total: args.budget.of_many(args.budget_total),
        header: header.as_ref(),
        columns: columns.as_ref(),
        keyframes: args.plot.path().is_some(),
    };
    // Tried before the work, which would otherwise be lost.
    writable(summary)?;
    let mut head = Vec::new();
    if let Some(columns) = &columns {
        columns.append_header(&mut head);
    }
    let asked = args.asked(&question, output_format);
    let mut output = match output.filter(|_| args.resume) {
        // Summaries and pictures are of all states.
        Some(path) => BatchOutput::resume(path, &head, summary.is_some() || args.plot.path().is_some(), origin, asked)?,
        None => BatchOutput::create(output, origin, asked)?,
    };
    let ((answered, refused), begun) = (output.kept(), output.is_empty()?);
    let mut sink = OutputSink::new(output, &name, &progress);
    if begun {
        sink.write(&head)?;
    }

    let dropped = Mutex::new(Dropped::default());
    let threads = args.threads.count();
    let batch = || Batch::new(&question);
    match question.header.filter(|_| args.recording.is_in_order()) {
        Some(header) => {
            let samples = batch::samples(chunks, header, &robot, &question.defaults);
            let mut samples: Box<dyn Iterator<Item = _> + Send> = Box::new(samples);
            if header.is_spatial() {
                samples = Box::new(gait::sagittal(samples, &dropped));
            }
            if let Some(difference) = velocity {
                samples = Box::new(gait::rates(samples, difference));
            }
            if touchdowns {
                let heights = if simulated { Heights::True } else { Heights::Recorded };
                let found = gait::find(samples, &robot, &question.options.feet, at, touching)?;
                samples = Box::new(found.with(thresholds).meaning(heights));
            }
            samples = Box::new(samples.skip(answered));
            let answerer = || {
                let mut batch = batch();
                move |samples| batch.samples(samples)
            };
            batch::run(Recording::new(samples), threads, answerer, &mut sink)
        }
        None => {
            chunks.skip(answered).map_err(in_input)?;
            let answerer = || {
                let mut batch = batch();
                move |chunk| batch.records(&chunk)
            };
            batch::run(chunks, threads, answerer, &mut sink)
        }
    }
    .map_err(in_input)
    .inspect_err(|_| note_part(&sink.output))?;
    let OutputSink { output, summary: mut counts, gait, .. } = sink;
    let useful = answered > 0 || counts.refused < counts.states || counts.states == 0 || args.refused == Answered::All;
    output.finish(useful)?;
    counts.missing_columns = header.as_ref().map_or(Vec::new(), |header| header.missing().to_vec());
    progress.finish_and_clear();

    if let Some(header) = &header {
        note_columns(header, &dropped);
    }
    note_own_friction(counts.own_friction, "state");
    if let Some(least) = question.total.as_ref().and_then(TotalBudget::least) {
        let least = least.as_secs_f64();
        note(&format!("answers beyond `budget` took so long together that one had {least:.2e} s: see `budget_total`"));
    }
    if answered > 0 {
        note(&format!("{answered} states were answered by an earlier run, and the summary is of the others"));
    }
    // A failure to write to standard error cannot be reported anywhere.
    let _ = match counts.states {
        0 if simulated && !is_quiet() => writeln!(
            io::stderr(),
            "no touchdown found: a foot must descend {least:.4} m or more and cross z = 0 (see --drop)"
        ),
        0 if touchdowns && !is_quiet() => writeln!(
            io::stderr(),
            "no touchdown found: a foot must descend {least:.4} m or more, faster than {:.4} m/s, to at most \
             {ground:.4} m above the ground (see --drop, --ground-height)",
            thresholds.slow
        ),
        0 | 1 if summary.is_none() => Ok(()),
        _ if is_quiet() => Ok(()),
        _ => write!(io::stderr(), "{}", with_flags(&counts.to_string())),
    };
    if let Some(path) = summary {
        let mut line = Vec::new();
        write::append_line(&mut line, &counts);
        NewFile::write(path, &line)?;
    }
    if args.plot.path().is_some() {
        let page = |rendered| Ok(gait.page(&robot.name, rendered));
        args.plot.draw_or_page(&gait.picture(&robot.name), "the input holds no states", page)?;
    }
    Ok(if counts.refused + refused == 0 { Answered::All } else { args.refused })
}

impl RecordingOptions {
    /// Whether rows depend on each other.
    fn is_in_order(&self) -> bool {
        self.touchdowns || self.velocity.is_some()
    }
}

impl Args {
    /// What the answers depend on, apart from the input.
    fn asked(&self, question: &Question<'_>, format: RecordFormat) -> Asked {
        // The address of a budget's clock differs in each run.
        let options = Options { budget: None, ..question.options.clone() };
        let Question { robot, defaults, detail, header, .. } = question;
        Asked::new(
            robot,
            &(options, self.budget, self.budget_total, defaults, detail, header, &self.recording, self.csv, format),
        )
    }

    /// The columns of a table; `None` for lines of JSON and for an empty table.
    fn header(&self, robot: &Robot, chunks: &mut Chunks<impl Read + Send>) -> Result<Option<Header>, Failure> {
        let in_order = self.recording.is_in_order();
        if !chunks.is_table() {
            if in_order || !self.foreign.is_empty() {
                let what = if in_order { "touchdowns and velocities over time need" } else { "--foreign needs" };
                let error = Error::new(Reason::Inconsistent(format!("{what} a table")));
                return Err(Failure::Usage(error.hint("give CSV with a header, or say --input-format csv")));
            }
            return Ok(None);
        }
        let name = input::name(&self.states);
        // A table without any line has no states, like lines of JSON.
        let Some((line, record)) = chunks.first().map_err(|error| error.in_file(&name))? else { return Ok(None) };
        let rates = if self.recording.velocity.is_some() { Rates::Time } else { Rates::Columns };
        let header = Header::read(&record, robot, rates, &self.foreign).map_err(|error| {
            let place = error.location().unwrap_or(Location { line: 1, column: 1 });
            let place = Location { line: line + place.line - 1, ..place };
            let excerpt = Excerpt::around(&record, line, place);
            Failure::Refused(error.on(place.line, place.column).in_file(&name), excerpt)
        })?;
        chunks.expect_columns(header.count());
        if in_order && !header.has_time() {
            let missing = Error::new(Reason::Missing("a column \"time\"".into())).on(line, 1);
            return Err(missing.in_file(name).hint("touchdowns need the time of each row").into());
        }
        Ok(Some(header))
    }
}

/// Notes which coordinates have no column.
fn note_missing(header: &Header) {
    match header.missing() {
        [] => {}
        [only] => note(&format!("a column is missing, and taken as 0: {only}")),
        missing => note(&format!("{} columns are missing, and taken as 0: {}", missing.len(), missing.join(", "))),
    }
}

/// Notes which columns did not enter the analysis.
fn note_columns(header: &Header, dropped: &Mutex<Dropped>) {
    let ignored: Vec<&str> = header.ignored().collect();
    if !ignored.is_empty() {
        let (count, names) = (ignored.len(), ignored.join(", "));
        note(&format!(
            "{count} column{} not read, because their joints have no coordinate (see `heelstrike inspect`): {names}",
            if count == 1 { "" } else { "s" },
        ));
    }
    if let (true, Ok(dropped)) = (header.is_spatial(), dropped.lock()) {
        note(&format!("the base is projected into its plane along the mean heading of each clip; left out: {dropped}"));
    }
}
