//! `heelstrike batch`: the answers to many states, in order.

use super::diagnostic::note;
use super::options::{
    ContactOptions, DetailOptions, LoopOptions, SceneOptions, ThreadOptions, from_zero, pipeline_options,
};
use super::output::{apart, named, spare};
use super::page::PageOptions;
use super::progress::Progress;
use super::robot::RobotOptions;
use super::sink::OutputSink;
use super::{Answered, Completion, Failure, input};
use clap::ValueEnum;
use heelstrike::batch::{self, Batch, Broken, Chunks, Question, Recorded, Recording, Summary};
use heelstrike::draw::page::Gait;
use heelstrike::error::Location;
use heelstrike::error::excerpt::Excerpt;
use heelstrike::gait::{self, At, Difference, Dropped, Thresholds, Touching};
use heelstrike::read::table::{Header, Rates};
use heelstrike::state::{Defaults, NamedContact};
use heelstrike::write::{self, Columns};
use heelstrike::{Error, Reason, Robot};
use std::fs::File;
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
    /// The format of the results [default: csv if the output's name ends in .csv, else ndjson]
    #[arg(long, alias = "format", value_name = "FORMAT", value_enum, help_heading = "Output")]
    output_format: Option<RecordFormat>,
    /// Also write the summary to this file, as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    summary: Option<PathBuf>,
    #[command(flatten)]
    plot: PageOptions,
    /// Whether refused states make the exit status 1
    #[arg(long, value_name = "HOW", value_enum, default_value_t = OnRefused::Fail, help_heading = "Output")]
    refused: OnRefused,
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
    /// (--ground-height). The moment of contact is when it is 2 mm above the level at which it stops. For robots
    /// smaller than 0.25 m these thresholds shrink in proportion; the size is the greatest distance from the root's
    /// origin to a foot or center of gravity with all joints at zero. The base is then shifted so that the foot is at z
    /// = 0.
    #[arg(long)]
    touchdowns: bool,
    /// Which state of a touchdown is analyzed
    #[arg(long, value_enum, default_value = "crossing", requires = "touchdowns")]
    at: AtRow,
    /// Which other feet touch the ground at a touchdown: strike (none), slow:SPEED,HEIGHT or near:HEIGHT
    ///
    /// With slow, the lowest point of every other body, if it is slower than SPEED (m/s) and its height differs from
    /// the striking point's by at most HEIGHT (m): standing feet. With near, every point at such a height, at any
    /// speed.
    #[arg(long, value_name = "WHICH", default_value_t, requires = "touchdowns")]
    touching: Touching,
    /// How far a foot must have descended, in metres [default: 0.012, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, requires = "touchdowns")]
    drop: Option<f64>,
    /// How far above z = 0 a foot may stop, in metres [default: 0.02, less for robots below 0.25 m]
    #[arg(long, value_name = "HEIGHT", value_parser = from_zero, requires = "touchdowns")]
    ground_height: Option<f64>,
    /// Compute velocities from the positions and the column "time"
    #[arg(long, value_enum, value_name = "HOW")]
    velocity: Option<Velocity>,
}

/// The format of an input or output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RecordFormat {
    /// One JSON object per line
    #[value(alias = "json", alias = "jsonl")]
    Ndjson,
    /// A table with a header
    Csv,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OnRefused {
    /// The exit status is 1
    Fail,
    /// The exit status is 0
    Ok,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum AtRow {
    /// The state at the moment of contact, extrapolated from the rows before the impact
    Crossing,
    /// The last row before that moment, shifted in z
    Row,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Velocity {
    /// From the rows before and after
    Central,
    /// From the row before
    Backward,
}

impl RecordFormat {
    fn of(path: &Path) -> Self {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) { Self::Csv } else { Self::Ndjson }
    }
}

impl RecordingOptions {
    fn touchdowns(&self) -> Option<(At, Touching)> {
        let at = match self.at {
            AtRow::Crossing => At::Crossing,
            AtRow::Row => At::Row,
        };
        self.touchdowns.then_some((at, self.touching))
    }

    fn thresholds(&self, robot: &Robot, feet: &[NamedContact]) -> Thresholds {
        let usual = Thresholds::of(robot, feet);
        let (drop, ground) = (self.drop.unwrap_or(usual.drop), self.ground_height.unwrap_or(usual.ground));
        Thresholds { drop, ground, ..usual }
    }

    fn difference(&self) -> Option<Difference> {
        self.velocity.map(|velocity| match velocity {
            Velocity::Central => Difference::Central,
            Velocity::Backward => Difference::Backward,
        })
    }
}

pub(super) fn run(args: &Args) -> Completion {
    args.plot.check()?;
    let inputs = [Some(&args.robot.robot), Some(&args.states), args.loops.loops.as_ref()];
    let inputs: Vec<&Path> = inputs.into_iter().flatten().map(PathBuf::as_path).collect();
    spare(args.output.as_deref(), &inputs)?;
    args.summary.as_deref().map_or(Ok(()), |summary| spare(Some(summary), &inputs))?;
    if args.summary.as_deref() == Some(Path::new("-")) {
        let reason =
            "standard output holds the results alone, and standard error has the summary for people".to_owned();
        return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).at("--summary").hint("name a file")));
    }
    let (output, summary) = (args.output.as_deref(), args.summary.as_deref());
    apart([("results", output), ("summary", summary)], "--summary")?;
    if summary.is_some() {
        apart([("summary", summary), ("picture", args.plot.path())], "--plot")?;
    }
    args.plot.claim(&inputs, output)?;
    let robot = args.robot.load()?;
    let feet = args.robot.feet(&robot)?;
    let name = input::name(&args.states);
    let progress = Progress::over(&args.states, args.output.is_some());
    let states = progress.watch(input::stream(&args.states)?);
    let mut chunks = match args.input_format.unwrap_or_else(|| RecordFormat::of(&args.states)) {
        RecordFormat::Ndjson => Chunks::of_lines(states),
        RecordFormat::Csv => Chunks::of_table(states),
    };
    let foreign = chunks.foreign().map_err(|error| input::cannot_read(&args.states, &error))?;
    foreign.map_or(Ok(()), |error| Err(error.in_file(&name)))?;
    let header = args.header(&robot, &mut chunks)?;
    let output_format =
        args.output_format.unwrap_or_else(|| args.output.as_deref().map_or(RecordFormat::Ndjson, RecordFormat::of));
    let detail = args.detail.detail();
    if output_format == RecordFormat::Csv && (detail.explain || detail.matrices || detail.brief) {
        let reason = "a table has a row per outcome and no room for --explain, --matrices or --brief".to_owned();
        let hint = "write JSON: --output-format ndjson, or -o with that ending";
        return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).hint(hint)));
    }
    let touchdowns = args.recording.touchdowns();
    if let Some((at, touching)) = touchdowns {
        // Before any file is replaced: does this robot have feet to look for?
        let none = std::iter::empty::<gait::Sampled<()>>();
        let refused = gait::find(none, &robot, &feet, at, touching).err();
        refused.map_or(Ok(()), |error| Err(error.in_file(input::name(&args.robot.robot))))?;
    }
    let thresholds = args.recording.thresholds(&robot, &feet);
    let columns = || Columns::new(&robot, &feet, header.as_ref(), touchdowns.is_some());
    let columns = (output_format == RecordFormat::Csv).then(columns);
    let question = Question {
        robot: &robot,
        options: pipeline_options(&args.contacts, feet, args.detail, &args.robot.reductions),
        defaults: Defaults { loops: args.loops.load(&robot)?, ..args.scene.defaults() },
        detail,
        header: header.as_ref(),
        columns: columns.as_ref(),
        touchdowns,
        keyframes: args.plot.is_asked(),
    };
    // Created before the work, which would otherwise be lost.
    let summary = args.summary.as_deref().map(|path| File::create(path).map_err(|error| named(path, error)));
    let summary = summary.transpose()?;

    let mut sink = OutputSink::new(args.open()?, &name, &progress);
    if let Some(columns) = &columns {
        let mut line = Vec::new();
        columns.append_header(&mut line);
        sink.write(&line)?;
    }
    let dropped = Mutex::new(Dropped::default());
    args.answer(&question, chunks, thresholds, &dropped, &mut sink)?;
    let summary_of_all = std::mem::take(&mut sink.summary);
    let gait = std::mem::take(&mut sink.gait);
    drop(sink);
    drop(progress);
    header.as_ref().inspect(|header| note_columns(header, &dropped));
    args.report(&summary_of_all, summary, thresholds)?;
    args.draw(&gait, &robot)?;
    Ok(if summary_of_all.refused == 0 || args.refused == OnRefused::Ok { Answered::All } else { Answered::NotAll })
}

type Input = Chunks<Box<dyn Read + Send>>;

impl Args {
    /// The columns of a table; `None` for lines of JSON and for an empty table.
    fn header(&self, robot: &Robot, chunks: &mut Input) -> Result<Option<Header>, Failure> {
        let in_order = self.recording.touchdowns || self.recording.velocity.is_some();
        if !chunks.is_table() {
            if in_order {
                let reason = "touchdowns and velocities over time need a table".to_owned();
                let hint = "give CSV with a column time, or say --input-format csv";
                return Err(Failure::Usage(Error::new(Reason::Inconsistent(reason)).hint(hint)));
            }
            return Ok(None);
        }
        let name = input::name(&self.states);
        let first = chunks.first().map_err(|error| input::cannot_read(&self.states, &error))?;
        // A table without any line has no states, like lines of JSON.
        let Some(first) = first else { return Ok(None) };
        let (line, record) = first.map_err(|error| error.in_file(&name))?;
        let rates = if self.recording.velocity.is_some() { Rates::Time } else { Rates::Columns };
        let header = Header::read(&record, robot, rates).map_err(|error| {
            let place = error.location().unwrap_or(Location { line: 1, column: 1 });
            let place = Location { line: line + place.line - 1, ..place };
            let excerpt = Excerpt::around(&record, line, place);
            Failure::RefusedAt(error.on(place.line, place.column).in_file(&name), excerpt)
        })?;
        if in_order && !header.has_time() {
            let missing = Error::new(Reason::Missing("a column \"time\"".into())).on(line, 1);
            return Err(missing.in_file(name).hint("touchdowns need the time of each row").into());
        }
        Ok(Some(header))
    }

    /// Opens the output without a buffer; blocks of results are large enough.
    fn open(&self) -> io::Result<Box<dyn Write>> {
        match self.output.as_ref().filter(|path| path.as_os_str() != "-") {
            Some(path) => Ok(Box::new(File::create(path).map_err(|error| named(path, error))?)),
            None => standard_output(),
        }
    }

    fn answer<W: Write>(
        &self,
        question: &Question,
        chunks: Input,
        thresholds: Thresholds,
        dropped: &Mutex<Dropped>,
        sink: &mut OutputSink<W>,
    ) -> Result<(), Failure> {
        let threads = self.threads.count();
        let form = || Batch::new(question);
        let ended = match (question.header, self.recording.difference(), question.touchdowns) {
            (Some(header), difference, touchdowns) if difference.is_some() || touchdowns.is_some() => {
                let samples = batch::samples(chunks, header, question.robot, &question.defaults);
                let samples: Box<dyn Iterator<Item = _> + Send> = match header.is_spatial() {
                    true => Box::new(gait::sagittal(samples, dropped)),
                    false => Box::new(samples),
                };
                let samples: Box<dyn Iterator<Item = _> + Send> = match difference {
                    Some(difference) => Box::new(gait::rates(samples, difference)),
                    None => samples,
                };
                let states: Box<dyn Iterator<Item = Recorded> + Send> = match touchdowns {
                    Some((at, touching)) => {
                        let feet = &question.options.feet;
                        let found = gait::find(samples, question.robot, feet, at, touching);
                        let found = found.map_err(|error| error.in_file(input::name(&self.robot.robot)))?;
                        Box::new(found.with(thresholds).map(Recorded::from))
                    }
                    None => Box::new(samples.map(Recorded::from)),
                };
                batch::run(Recording::new(states), threads, form, sink)
            }
            _ => batch::run(chunks, threads, form, sink),
        };
        ended.map_err(|broken| match broken {
            Broken::Input(error) => Failure::Refused(input::cannot_read(&self.states, &error)),
            Broken::Output(error) => Failure::Output(error),
        })
    }

    /// Draws the margins or writes the page, if requested.
    fn draw(&self, gait: &Gait, robot: &Robot) -> Result<(), Failure> {
        if !self.plot.is_asked() {
            return Ok(());
        }
        let page = |rendered| gait.page(&robot.name, rendered);
        self.plot.draw(&gait.picture(&robot.name), "the input holds no states", page)
    }

    /// Writes the summary to standard error, for more than one state or if a file is requested, and to that file.
    fn report(&self, summary: &Summary, file: Option<File>, thresholds: Thresholds) -> io::Result<()> {
        if self.recording.touchdowns && summary.states == 0 {
            let Thresholds { drop, slow, ground, .. } = thresholds;
            // A failure to write to standard error cannot be reported anywhere.
            let _ = writeln!(
                io::stderr(),
                "no touchdown found: a foot must descend {drop:.4} m or more, faster than {slow:.4} m/s, to at most \
                 {ground:.4} m above the ground (see --drop, --ground-height)",
            );
        } else if summary.states > 1 || file.is_some() {
            let _ = write!(io::stderr(), "{summary}");
        }
        if let (Some(mut file), Some(path)) = (file, &self.summary) {
            let mut line = Vec::new();
            write::append_line(&mut line, summary);
            file.write_all(&line).map_err(|error| named(path, error))?;
        }
        Ok(())
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

/// Standard output without the line buffer of std, which would hide how much reached a full disk.
#[cfg(unix)]
fn standard_output() -> io::Result<Box<dyn Write>> {
    use std::os::fd::AsFd;
    Ok(Box::new(File::from(io::stdout().as_fd().try_clone_to_owned()?)))
}

#[cfg(not(unix))]
fn standard_output() -> io::Result<Box<dyn Write>> {
    Ok(Box::new(io::stdout()))
}
